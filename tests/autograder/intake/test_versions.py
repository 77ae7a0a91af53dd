"""Which of several copies of a notebook is graded: the usual ways in which students keep copies."""

from datetime import datetime

import pytest

from autograder.intake.versions import Version, newest_version

NAME = "lab-identification"
NOON, LATER = datetime(2026, 11, 20, 12, 0), datetime(2026, 11, 20, 12, 30)
NONE = datetime(1980, 1, 1)  # as `labsid submit` writes it


def version(path: str, outer: datetime | None = NOON, inner: datetime | None = None, work: str = "") -> Version:
    return Version(path, NAME, outer, inner, work or path, b"")


CASES = {
    "a folder old/": (version(f"h.zip/old/{NAME}.ipynb", NOON, NONE), version(f"h.zip/{NAME}.ipynb", NOON, NONE)),
    "_old": (version(f"{NAME}_old.ipynb"), version(f"{NAME}.ipynb")),
    "_v1 beside the plain name": (version(f"{NAME}_v1.ipynb"), version(f"{NAME}.ipynb")),
    "_v9 before _v10": (version(f"{NAME}_v9.ipynb"), version(f"{NAME}_v10.ipynb")),
    "hand-in.zip before hand-in (1).zip": (
        version(f"hand-in.zip/{NAME}/{NAME}.ipynb", NOON, NONE),
        version(f"hand-in (1).zip/{NAME}/{NAME}.ipynb", NOON, NONE),
    ),
    "times in the zip file": (
        version("h.zip/b/work.ipynb", NOON, NOON), version("h.zip/a/work.ipynb", NOON, LATER),
    ),
    "a folder backup/": (version(f"h.zip/{NAME}/backup/{NAME}.ipynb"), version(f"h.zip/{NAME}/{NAME}.ipynb")),
    "Copy of": (version(f"Copy of {NAME}.ipynb"), version(f"{NAME}.ipynb")),
    "-Copy1 of Jupyter": (version(f"{NAME}-Copy1.ipynb"), version(f"{NAME}.ipynb")),
    "(1) of a browser": (version(f"{NAME}.ipynb"), version(f"{NAME} (1).ipynb")),
    "handed in again later": (version("work.ipynb", NOON), version("final work.ipynb", LATER)),
    "final": (version("lab.ipynb"), version("lab_final.ipynb")),
    "numbers of zip files": (version(f"lab-2.zip/{NAME}.ipynb"), version(f"lab-10.zip/{NAME}.ipynb")),
}  # fmt: skip


@pytest.mark.parametrize("case", CASES)
@pytest.mark.parametrize("order", [1, -1])
def test_the_newest_copy_is_graded(case: str, order: int) -> None:
    old, new = CASES[case]
    assert newest_version([old, new][::order])[0] is new


@pytest.mark.parametrize(
    ("graded", "other", "why"),
    [
        (version(f"{NAME}.ipynb"), version("x.ipynb", LATER), "x.ipynb has a later time"),
        (version(f"{NAME}.ipynb"), version(f"old/{NAME}.ipynb", LATER), f"old/{NAME}.ipynb has a later time"),
        (version(f"{NAME}.ipynb"), version(f"{NAME}_v2.ipynb"), f"{NAME}_v2.ipynb has a later number"),
        (version(f"{NAME}.ipynb"), version(f"{NAME}_final.ipynb"), f"{NAME}_final.ipynb has a later number"),
        (version(f"b/{NAME}.ipynb"), version(f"a/{NAME}.ipynb"), f"a/{NAME}.ipynb differs, and neither name nor time"),
        (version(f"b/{NAME}.ipynb", None), version(f"a/{NAME}.ipynb"), ""),
        (
            version(f"hand-in.zip/{NAME}.ipynb", LATER, NONE),
            version(f"hand-in (1).zip/{NAME}.ipynb", NOON, NONE),
            f"hand-in (1).zip/{NAME}.ipynb has a later number",
        ),
    ],
)
def test_what_is_not_clear_is_named(graded: Version, other: Version, why: str) -> None:
    for pair in ([graded, other], [other, graded]):
        chosen, doubts = newest_version(pair)
        if why:
            assert chosen is graded
            assert len(doubts) == 1
            assert doubts[0].startswith(why)
        else:
            assert doubts or chosen is other


def test_equal_copies_are_no_doubt() -> None:
    same = [version(f"{name}/{NAME}.ipynb", LATER if name == "a" else NOON, work="same") for name in "abc"]
    assert newest_version(same)[1] == ()
    many = [version(f"{letter}/{NAME}.ipynb") for letter in "abcdefgh"]
    assert len(newest_version(many)[1]) == 3


def test_a_long_name_takes_no_time() -> None:
    many = [version("-" * 60_000 + f"{n}v.ipynb") for n in range(200)]
    assert all(len(doubt) < 400 for doubt in newest_version(many)[1])
