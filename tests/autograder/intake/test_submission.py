"""Whatever is handed in is taken in, mended or quarantined, and said to be; nothing raises."""

import json
import os
import re
from collections.abc import Callable
from decimal import Decimal
from pathlib import Path
from typing import Any

import nbformat
import pytest

from autograder.course.layout import Course, read_template
from autograder.intake.submission import (
    MAX_CELLS,
    MAX_NOTE_CHARACTERS,
    MAX_NOTEBOOK_BYTES,
    MAX_NOTES,
    UNTOUCHED,
    VERSIONS_FILE,
    NotebookCell,
    Submission,
    is_handed_in,
    is_untouched,
    read_submission,
)
from labsid.checks.cells import Cell, Template
from labsid.checks.time_limit import limit_time

TEMPLATE = Template(
    "tiny",
    "Tiny",
    (
        Cell("setup", "given", "import numpy", True, None),
        Cell("q-answer", "answer", "# Your code here\n...", True, None),
        Cell("q", "question", 'check("q")', True, Decimal("0.1")),
        Cell("open", "manual", "*Your answer here*", False, Decimal("0.3")),
        Cell("p-answer", "answer", "# Your code here\n...", True, None),
        Cell("p", "question", 'check("p")', True, Decimal("0.2")),
    ),
)
IDS = [cell.id for cell in TEMPLATE.cells]
WORK = {"q-answer": "a = 3", "open": "Because.", "p-answer": "b = 4"}


def cell(grade_id: str | None, source: Any, kind: str = "code") -> dict[str, Any]:
    metadata = {} if grade_id is None else {"nbgrader": {"grade_id": grade_id, "schema_version": 3}}
    return {"cell_type": kind, "metadata": metadata, "source": source, "outputs": [], "execution_count": None}


def cells() -> list[dict[str, Any]]:
    """A hand-in as it should be."""
    return [cell(c.id, WORK.get(c.id, c.source), "code" if c.code else "markdown") for c in TEMPLATE.cells]


def notebook(inside: Any) -> str:
    return json.dumps({"nbformat": 4, "nbformat_minor": 5, "metadata": {}, "cells": inside})


def hand_in(folder: Path, content: str | bytes | list, name: str = "tiny.ipynb") -> Submission:
    if isinstance(content, list):
        content = notebook(content)
    folder.mkdir(exist_ok=True)
    (folder / name).write_bytes(content.encode() if isinstance(content, str) else content)
    return read_submission(folder, "s", TEMPLATE)


def sources(submission: Submission) -> dict[str, str]:
    return {cell.id: cell.source for cell in submission.cells if cell.id is not None}


def as_released(**changed: str) -> dict[str, str]:
    return {c.id: c.source for c in TEMPLATE.cells} | {key.replace("_", "-"): value for key, value in changed.items()}


WHOLE = as_released(q_answer="a = 3", open="Because.", p_answer="b = 4")


def test_a_hand_in_as_it_should_be(tmp_path: Path) -> None:
    submission = hand_in(tmp_path, cells())
    assert (submission.student, submission.assignment, submission.status) == ("s", "tiny", "ready")
    assert submission.notes == ()
    assert [cell.id for cell in submission.cells] == IDS
    assert sources(submission) == WHOLE
    assert submission.cells[3] == NotebookCell("open", "manual", "Because.", False)


def test_the_release_itself_needs_no_mending_but_is_no_hand_in(course: Course, tmp_path: Path) -> None:
    for name in course.assignments():
        template = read_template(course, name)
        submission = read_submission(course.release / name, "s", template)
        assert (submission.status, submission.notes) == ("missing", (UNTOUCHED,))
        assert not is_handed_in(course.release / name, template)
        notebook = json.loads((course.release / name / f"{name}.ipynb").read_text(encoding="utf-8"))
        (tmp_path / name).mkdir()
        notebook["cells"].append(cell(None, "Done.", "markdown"))
        (tmp_path / name / f"{name}.ipynb").write_text(json.dumps(notebook), encoding="utf-8")
        submission = read_submission(tmp_path / name, "s", template)
        assert (submission.status, submission.notes) == ("ready", ())
        assert [cell.source for cell in submission.cells if cell.id] == [cell.source for cell in template.cells]


@pytest.mark.parametrize(
    ("change", "untouched"),
    [
        pytest.param(lambda parts: None, True, id="as released"),
        pytest.param(lambda parts: parts[1].update(source="  # Your code here\n...\n"), True, id="blanks"),
        pytest.param(lambda parts: parts[1].update(source=""), True, id="an answer deleted"),
        pytest.param(lambda parts: parts.pop(3), True, id="a cell deleted"),
        pytest.param(lambda parts: parts[0].update(source="import os"), True, id="a given cell, which is restored"),
        pytest.param(lambda parts: parts.append(cell(None, " ")), True, id="an empty cell added"),
        pytest.param(lambda parts: parts[0].update(outputs=["x"], execution_count=3), True, id="executed"),
        pytest.param(lambda parts: parts[1].update(source="a = 1"), False, id="an answer"),
        pytest.param(lambda parts: parts[3].update(source="Because."), False, id="a free text"),
        pytest.param(lambda parts: parts.append(cell(None, "a = 1")), False, id="code in a cell of its own"),
        pytest.param(lambda parts: parts.append(cell(None, "Hm.", "markdown")), False, id="text in a cell of its own"),
        pytest.param(lambda parts: parts.append(cell("q-answer", "a = 2")), False, id="an answer in a copied cell"),
    ],
)
def test_a_notebook_as_released_is_no_hand_in(
    tmp_path: Path, change: Callable[[list[dict[str, Any]]], object], untouched: bool
) -> None:
    parts = [cell(c.id, c.source, "code" if c.code else "markdown") for c in TEMPLATE.cells]
    change(parts)
    submission = hand_in(tmp_path, parts)
    assert (submission.status == "missing") == untouched
    assert is_untouched(notebook(parts).encode(), TEMPLATE) == untouched
    assert is_handed_in(tmp_path, TEMPLATE) != untouched


def test_what_cannot_be_read_is_not_untouched(tmp_path: Path) -> None:
    for content in (b"", b"{", b"[]", notebook([]).encode(), notebook([cell(None, "Of another course.")]).encode()):
        assert not is_untouched(content, TEMPLATE)
        assert hand_in(tmp_path, content).status == "quarantined"
        assert is_handed_in(tmp_path, TEMPLATE)
    assert not is_handed_in(tmp_path / "nosuch", TEMPLATE)


def test_nothing_handed_in(tmp_path: Path) -> None:
    (tmp_path / "report.pdf").write_bytes(b"%PDF")
    (tmp_path / "file").write_bytes(b"")
    for folder in (tmp_path, tmp_path / "nosuch", tmp_path / "file"):
        submission = read_submission(folder, "s", TEMPLATE)
        assert (submission.status, submission.cells) == ("missing", ())
        assert submission.notes == ("no notebook was submitted",)


def test_a_renamed_notebook_is_taken(tmp_path: Path) -> None:
    submission = hand_in(tmp_path, cells(), "my work (1).ipynb")
    assert sources(submission) == WHOLE
    assert submission.notes == ("my work (1).ipynb was graded as tiny.ipynb",)


def test_of_several_notebooks_the_one_of_the_right_name_is_taken(tmp_path: Path) -> None:
    hand_in(tmp_path, "not this one", "a.ipynb")
    hand_in(tmp_path, "nor this", "tiny-old.ipynb")
    submission = hand_in(tmp_path, cells())
    assert (submission.status, submission.notes) == ("ready", ())


def test_of_several_other_notebooks_the_closest_name_is_taken(tmp_path: Path) -> None:
    hand_in(tmp_path, "not this one", "a.ipynb")
    submission = hand_in(tmp_path, cells(), "my-tiny.ipynb")
    assert submission.status == "ready"
    assert submission.notes == ("my-tiny.ipynb was graded as tiny.ipynb",)


def test_a_folder_of_the_notebooks_name_is_no_notebook(tmp_path: Path) -> None:
    (tmp_path / "tiny.ipynb").mkdir()
    assert read_submission(tmp_path, "s", TEMPLATE).status == "missing"
    assert hand_in(tmp_path, cells(), "other.ipynb").status == "ready"


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="this system has no named pipes")
def test_a_pipe_is_no_notebook(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "tiny.ipynb")
    (tmp_path / "link.ipynb").symlink_to(tmp_path / "nosuch")
    assert read_submission(tmp_path, "s", TEMPLATE).status == "missing"


@pytest.mark.parametrize(
    ("content", "said"),
    [
        pytest.param("", "broken JSON at line 1", id="an empty file"),
        pytest.param("a = 3", "broken JSON at line 1", id="a program"),
        pytest.param(notebook(cells())[:300], "broken JSON", id="cut off"),
        pytest.param(notebook(cells()).replace('"cells"', '<<<<<<< HEAD\n"cells"'), "broken JSON", id="merge marks"),
        pytest.param(b"\x89PNG\r\n\x1a\n\0\xff", "not text in UTF-8", id="binary"),
        pytest.param(notebook(cells()).encode("utf-16"), "not text in UTF-8", id="UTF-16"),
        pytest.param("[]", "JSON but not a notebook", id="a list"),
        pytest.param("null", "JSON but not a notebook", id="null"),
        pytest.param("{}", "JSON but not a notebook", id="an empty object"),
        pytest.param('{"nbformat": "4"}', "JSON but not a notebook", id="a version of text"),
        pytest.param('{"nbformat": true, "cells": []}', "JSON but not a notebook", id="a version that is true"),
        pytest.param('{"nbformat": 4}', "it has no cells", id="no cells"),
        pytest.param('{"nbformat": 4, "cells": {"a": 1}}', "it has no cells", id="cells that are an object"),
        pytest.param(notebook([]), "contains no cell of tiny", id="an empty list of cells"),
        pytest.param(notebook([1, None, "x", []]), "contains no cell of tiny", id="cells that are none"),
        pytest.param(notebook([cell(None, "a = 3")]), "contains no cell of tiny", id="a notebook of one's own"),
        pytest.param(notebook([cell("lab-1a", "a = 3")]), "contains no cell of tiny", id="another assignment"),
        pytest.param('{"nbformat": 3}', "invalid notebook of the old format 3", id="format 3 without worksheets"),
        pytest.param('{"nbformat": 2, "worksheets": 7}', "invalid notebook of the old format 2", id="broken format 2"),
        pytest.param('{"nbformat": -1, "cells": []}', "invalid notebook of the old format -1", id="format -1"),
        pytest.param("[" * 100_000, "recursion", id="nesting without end"),
        pytest.param('{"nbformat": ' + "9" * 5000 + "}", "digits", id="a number of 5000 digits"),
    ],
)
def test_what_cannot_be_read_is_quarantined_and_said(tmp_path: Path, content: str | bytes, said: str) -> None:
    submission = hand_in(tmp_path, content)
    assert (submission.status, submission.cells) == ("quarantined", ())
    (note,) = submission.notes
    assert note.startswith("tiny.ipynb ")
    assert said in note
    assert "\n" not in note


def test_a_huge_file_is_quarantined_unread(tmp_path: Path) -> None:
    with (tmp_path / "tiny.ipynb").open("wb") as file:
        file.truncate(MAX_NOTEBOOK_BYTES + 1)
    submission = read_submission(tmp_path, "s", TEMPLATE)
    assert submission.notes == ("tiny.ipynb cannot be read: it is larger than 50 MiB",)


def test_a_byte_order_mark_is_read_over(tmp_path: Path) -> None:
    assert sources(hand_in(tmp_path, notebook(cells()).encode("utf-8-sig"))) == WHOLE


def test_a_notebook_of_format_3_is_read(tmp_path: Path) -> None:
    now = nbformat.from_dict(json.loads(notebook(cells())) | {"nbformat_minor": 4})
    old = nbformat.convert(now, 3)
    assert "worksheets" in old
    submission = hand_in(tmp_path, json.dumps(old))
    assert submission.status == "ready"
    assert sources(submission) == WHOLE


def test_sources_may_be_lists_of_lines(tmp_path: Path) -> None:
    listed = [{**one, "source": one["source"].splitlines(keepends=True)} for one in cells()]
    assert sources(hand_in(tmp_path, listed)) == WHOLE


@pytest.mark.parametrize("twice", [False, True])
def test_of_a_duplicated_cell_the_one_that_was_worked_in_counts(tmp_path: Path, twice: bool) -> None:
    """Jupyter copies a cell with its grade_id. nbgrader gives up the whole class over it."""
    handed_in = cells()
    stub = cell("q-answer", "# Your code here\n...")
    handed_in.insert(2 if twice else 1, stub)
    submission = hand_in(tmp_path, handed_in)
    assert sources(submission) == WHOLE
    assert [cell.id for cell in submission.cells] == IDS
    assert len(submission.notes) == 1
    assert submission.notes[0].startswith("the cell q-answer is duplicated")


def test_of_two_cells_that_were_worked_in_both_run_where_they_stand(tmp_path: Path) -> None:
    handed_in = cells()
    handed_in.insert(2, cell("q-answer", "a = a + 1"))
    handed_in.insert(4, cell("q", "a = a + 2"))
    submission = hand_in(tmp_path, handed_in)
    assert sources(submission) == WHOLE
    ran = [(cell.id, cell.source) for cell in submission.cells]
    assert ran[1:5] == [("q-answer", "a = 3"), (None, "a = a + 1"), ("q", 'check("q")'), (None, "a = a + 2")]
    assert submission.notes == (
        "the cell q-answer is duplicated: both were kept",
        "the cell q is duplicated: both were kept",
    )


def test_a_copied_check_is_dropped(tmp_path: Path) -> None:
    handed_in = cells()
    handed_in.append(cell("q", 'check("q")'))
    submission = hand_in(tmp_path, handed_in)
    assert [cell.id for cell in submission.cells] == IDS


def test_deleted_cells_are_put_back(tmp_path: Path) -> None:
    submission = hand_in(tmp_path, [one for one in cells() if one["metadata"]["nbgrader"]["grade_id"] in ("open", "p")])
    assert [cell.id for cell in submission.cells] == IDS
    assert sources(submission) == as_released(q_answer="", open="Because.", p_answer="")
    assert submission.notes == (
        "the cell setup was restored to the released version",
        "the cell q-answer is missing: it counts as not answered",
        "the cell q was restored to the released version",
        "the cell p-answer is missing: it counts as not answered",
    )


def test_edited_given_cells_and_checks_are_put_back(tmp_path: Path) -> None:
    handed_in = cells()
    handed_in[0]["source"] = "import numpy\nnumpy.allclose = lambda *a: True"
    handed_in[2]["source"] = "pass"
    submission = hand_in(tmp_path, handed_in)
    assert sources(submission) == WHOLE
    assert submission.notes == (
        "the cell setup was restored to the released version",
        "the cell q was restored to the released version",
    )


def test_reordered_cells_are_put_in_order(tmp_path: Path) -> None:
    submission = hand_in(tmp_path, cells()[::-1])
    assert [cell.id for cell in submission.cells] == IDS
    assert sources(submission) == WHOLE
    assert submission.notes == ()


def test_cells_that_the_student_added_stay_where_they_are(tmp_path: Path) -> None:
    handed_in = cells()
    handed_in.insert(0, cell(None, "first"))
    handed_in.insert(3, cell(None, "between", "markdown"))
    handed_in.insert(4, cell("of-another-course", "foreign"))
    handed_in.append(cell(None, "last"))
    submission = hand_in(tmp_path, handed_in)
    assert [cell.id or cell.source for cell in submission.cells] == [
        "first", "setup", "q-answer", "between", "foreign", "q", "open", "p-answer", "p", "last",
    ]  # fmt: skip
    assert [cell.code for cell in submission.cells if cell.kind == "extra"] == [True, False, True, True]
    assert submission.notes == ()


def test_an_answer_keeps_its_kind_whatever_the_notebook_says(tmp_path: Path) -> None:
    handed_in = cells()
    handed_in[1]["cell_type"] = "markdown"
    handed_in[1]["metadata"]["nbgrader"] |= {"points": 100, "grade": True, "locked": True}
    submission = hand_in(tmp_path, handed_in)
    assert submission.cells[1] == NotebookCell("q-answer", "answer", "a = 3", True)


NONSENSE = [None, 3, "x", [], [[]], {}, {"a": 1}, True]


@pytest.mark.parametrize("value", NONSENSE, ids=str)
@pytest.mark.parametrize("field", ["metadata", "nbgrader", "grade_id", "source", "cell_type"])
def test_nonsense_in_a_cell_does_no_harm(tmp_path: Path, field: str, value: Any) -> None:
    strange = cell("q-answer", "a = 5")
    if field == "nbgrader":
        strange["metadata"]["nbgrader"] = value
    elif field == "grade_id":
        strange["metadata"]["nbgrader"]["grade_id"] = value
    else:
        strange[field] = value
    submission = hand_in(tmp_path, [*cells()[:1], strange, *cells()[2:]])
    assert submission.status == "ready"
    got = sources(submission)
    assert set(got) == set(IDS)
    assert got["p-answer"] == "b = 4"
    assert all(isinstance(cell.source, str) for cell in submission.cells)


def test_parts_of_a_source_that_are_no_text_are_left_out(tmp_path: Path) -> None:
    handed_in = cells()
    handed_in[1]["source"] = ["a = 3\n", None, 5, ["x"], "b = 4"]
    assert sources(hand_in(tmp_path, handed_in))["q-answer"] == "a = 3\nb = 4"


def test_fields_that_are_missing_do_no_harm(tmp_path: Path) -> None:
    submission = hand_in(tmp_path, [{}, {"metadata": {"nbgrader": {"grade_id": "q-answer"}}}, *cells()[2:]])
    assert submission.status == "ready"
    assert sources(submission)["q-answer"] == ""


def test_a_notebook_with_very_many_cells_is_refused_before_anything_is_run(tmp_path: Path) -> None:
    many = [{"cell_type": "code", "source": f"x = {n}", "metadata": {}} for n in range(MAX_CELLS + 1)]
    found = hand_in(tmp_path / "a", [*cells(), *many])
    assert found.status == "quarantined"
    assert found.notes == (f"tiny.ipynb cannot be read: it has {len(many) + 6} cells; at most {MAX_CELLS} are graded",)
    old = {"nbformat": 3, "nbformat_minor": 0, "metadata": {}, "worksheets": [{"cells": many[:3000]}] * 2}
    assert "it has 6000 cells" in hand_in(tmp_path / "b", json.dumps(old)).notes[0]
    for count in (300_000, 900_000):
        text = '{"nbformat": 4, "nbformat_minor": 5, "metadata": {}, "cells": [' + "{}," * count + "{}]}"
        with limit_time(60.0):  # it takes a second
            assert hand_in(tmp_path / "c", text).status == "quarantined"


def test_the_notes_are_limited(tmp_path: Path) -> None:
    twice = [cell("q-answer", f"a = {n}") for n in range(1000)]
    found = hand_in(tmp_path / "a", [*cells(), *twice])
    assert found.status == "ready"
    assert len(found.notes) == MAX_NOTES + 1
    assert found.notes[-1] == f"and {1000 - MAX_NOTES} more"
    assert max(map(len, found.notes)) <= MAX_NOTE_CHARACTERS + 4


@pytest.mark.parametrize("error", [KeyError, MemoryError, RecursionError, AssertionError, OverflowError])
def test_whatever_a_parser_raises_is_a_quarantine(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, error: type[Exception]
) -> None:
    def broken(*_: object) -> None:
        raise error("bad")

    monkeypatch.setattr("autograder.intake.submission.read_json", broken)
    found = hand_in(tmp_path / "a", cells())
    assert found.status == "quarantined"
    assert found.notes[0].startswith("tiny.ipynb cannot be read: ")


def test_what_collect_noted_on_copies_is_a_note(tmp_path: Path) -> None:
    hand_in(tmp_path / "a", cells())
    (tmp_path / "a" / VERSIONS_FILE).write_text("x.ipynb has a\nlater time", encoding="utf-8")
    assert read_submission(tmp_path / "a", "s", TEMPLATE).notes == ("x.ipynb has a later time",)


def stripped(raw: dict[str, Any], **changed: str) -> dict[str, Any]:
    """A notebook as another program writes it: without metadata and ids, with other line ends and blanks."""
    cells = []
    for one in raw["cells"]:
        source = changed.get(one["id"].replace("-", "_"), "".join(one["source"]))
        text = "\r\n".join(f"{line}  " for line in source.split("\n")) + "\n\n"
        outputs = {"outputs": [], "execution_count": None} if one["cell_type"] == "code" else {}
        cells.append({"cell_type": one["cell_type"], "metadata": {}, "source": text, **outputs})
    return {"nbformat": 4, "nbformat_minor": 5, "metadata": {}, "cells": cells}


def built(course: Course, name: str, folder: str = "release") -> dict[str, Any]:
    found: dict[str, Any] = json.loads((getattr(course, folder) / name / f"{name}.ipynb").read_bytes())
    return found


def read_back(course: Course, tmp_path: Path, name: str, raw: dict[str, Any]) -> Submission:
    folder = tmp_path / "s" / name
    folder.mkdir(parents=True, exist_ok=True)
    (folder / f"{name}.ipynb").write_text(json.dumps(raw), encoding="utf-8")
    return read_submission(folder, "s", read_template(course, name))


def test_a_notebook_without_its_metadata_is_aligned_by_the_given_cells(course: Course, tmp_path: Path) -> None:
    for name in course.assignments():
        solved = built(course, name, "source")
        expected = read_back(course, tmp_path / "with", name, solved)
        found = read_back(course, tmp_path / "without", name, stripped(solved))
        assert found.status == "ready", found.notes
        assert found.notes[0].startswith("the notebook had lost its metadata: its cells were told apart by")
        own = [(one.id, one.source.split()) for one in expected.cells if one.kind in ("answer", "manual")]
        assert [(one.id, one.source.split()) for one in found.cells if one.kind in ("answer", "manual")] == own
        given = [(one.id, one.source) for one in expected.cells if one.kind not in ("answer", "manual", "extra")]
        assert [(one.id, one.source) for one in found.cells if one.kind not in ("answer", "manual", "extra")] == given
        assert not [one for one in found.cells if one.kind == "extra" and one.code]


PRELAB = "prelab-sinusoids"


def test_without_metadata_and_without_an_answer_it_is_as_released(course: Course, tmp_path: Path) -> None:
    found = read_back(course, tmp_path, PRELAB, stripped(built(course, PRELAB)))
    assert (found.status, found.notes) == ("missing", (UNTOUCHED,))


def test_a_given_cell_that_was_altered_is_restored_and_named(course: Course, tmp_path: Path) -> None:
    raw = built(course, PRELAB, "source")
    setup = next(one for one in raw["cells"] if one["id"].endswith("setup"))
    text = "".join(setup["source"])
    for altered in (text.replace("globals()", "dict()"), "check = print"):
        found = read_back(course, tmp_path, PRELAB, stripped(raw, **{setup["id"].replace("-", "_"): altered}))
        assert found.status == "ready"
        assert f"the cell {setup['id']} was restored to the released version" in found.notes
        assert next(one.source for one in found.cells if one.id == setup["id"]) == text


def test_an_answer_that_is_not_there_counts_as_none(course: Course, tmp_path: Path) -> None:
    raw = built(course, PRELAB, "source")
    raw["cells"] = [one for one in raw["cells"] if one["id"] != "prelab-3-cut-answer"]
    found = read_back(course, tmp_path, PRELAB, stripped(raw))
    assert "the cell prelab-3-cut-answer is missing: it counts as not answered" in found.notes
    assert next(one.source for one in found.cells if one.id == "prelab-3-cut-answer") == ""


def test_the_cell_that_keeps_what_the_release_gives_is_the_answer(course: Course, tmp_path: Path) -> None:
    raw = stripped(built(course, PRELAB, "source"))
    at = next(i for i, one in enumerate(raw["cells"]) if "def cut_off" in one["source"])
    raw["cells"].insert(at, {"cell_type": "code", "metadata": {}, "source": "x = 3", "outputs": []})
    found = read_back(course, tmp_path, PRELAB, raw)
    assert found.status == "ready"
    assert "def cut_off" in next(one.source for one in found.cells if one.id == "prelab-4-function-answer")
    assert [one.source for one in found.cells if one.kind == "extra" and one.code] == ["x = 3"]


def without(raw: dict[str, Any], *ids: str) -> dict[str, Any]:
    return {**raw, "cells": [one for one in raw["cells"] if one["id"] not in ids]}


def moved(raw: dict[str, Any]) -> dict[str, Any]:
    """The answers to two questions below one another, where nothing tells whose they are."""
    cells = {one["id"]: one for one in raw["cells"]}
    return without({**raw, "cells": list(cells.values())}, "prelab-1-time", *between(raw))


def between(raw: dict[str, Any]) -> list[str]:
    ids = [one["id"] for one in raw["cells"]]
    return ids[ids.index("prelab-1-time") : ids.index("prelab-2-noise-answer")]


def doubled(raw: dict[str, Any]) -> dict[str, Any]:
    cells = list(raw["cells"])
    at = next(i for i, one in enumerate(cells) if one["id"] == "prelab-3-cut-answer")
    return {
        **raw,
        "cells": [*cells[:at], {**cells[at], "source": [*cells[at]["source"], "\nx = 1"], "id": "more"}, *cells[at:]],
    }


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (moved, "it is not clear which cell is the answer to prelab-1-time-answer, prelab-2-noise-answer"),
        (doubled, "it is not clear which cell is the answer to prelab-3-cut-answer: several stand where one is"),
        (
            lambda raw: {**raw, "cells": raw["cells"][:20]},
            r"and only \d+ of \d+ given cells are in it",
        ),
        (lambda raw: {**raw, "cells": raw["cells"][::-1]}, r"and only \d+ of \d+ given cells are in it"),
    ],
)
def test_where_it_is_not_clear_which_cell_is_which_nothing_is_graded(
    course: Course, tmp_path: Path, change: Callable[[dict[str, Any]], dict[str, Any]], said: str
) -> None:
    found = read_back(course, tmp_path, PRELAB, stripped(change(built(course, PRELAB, "source"))))
    assert found.status == "quarantined"
    assert re.search(said, found.notes[0]), found.notes


def test_metadata_of_another_assignment_are_none_that_were_lost(course: Course, tmp_path: Path) -> None:
    raw = stripped(built(course, PRELAB, "source"))
    raw["cells"][0]["metadata"] = {"nbgrader": {"grade_id": "lab-1a-extract"}}
    assert read_back(course, tmp_path, PRELAB, raw).status == "quarantined"


def test_aligning_is_fast_for_whatever_is_handed_in(course: Course, tmp_path: Path) -> None:
    raw = stripped(built(course, PRELAB))
    noise = [{"cell_type": "markdown", "metadata": {}, "source": f"{i} " + "x y " * 500} for i in range(3000)]
    with limit_time(20):
        assert read_back(course, tmp_path, PRELAB, {**raw, "cells": raw["cells"][:3] + noise}).status == "quarantined"
