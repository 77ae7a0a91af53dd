"""Hand-ins out of Moodle's zip: what belongs to whom, which version counts, and nothing outside of the folder."""

import contextlib
import io
import json
import re
import shutil
import tempfile
import warnings
import zipfile
from collections.abc import Mapping, Sequence
from datetime import UTC, datetime
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from autograder.batch.fingerprint import submission_hash
from autograder.batch.selection import handed_in_by
from autograder.course import archive
from autograder.course.layout import Course, read_template
from autograder.course.students import Student, read_students
from autograder.intake.collect import collect_submissions
from autograder.intake.submission import NOT_SUBMITTED, UNTOUCHED, read_submission
from autograder.intake.worksheet import Worksheet, folder_name, read_worksheet
from labsid.hand_in.saved_work import read_saved
from labsid.hand_in.submission_file import pack

PRELAB, LAB = "prelab-sinusoids", "lab-identification"
ADA, BEN = "Ada Lovelace_1001_assignsubmission_file_", "Ben O'Neil_1002_assignsubmission_file_"


def entry(name: str, minute: int = 0, mode: int = 0) -> zipfile.ZipInfo:
    info = zipfile.ZipInfo(name, (2026, 11, 20, 12, minute, 0))
    info.external_attr = mode << 16
    info.compress_type = zipfile.ZIP_DEFLATED
    return info


def moodle(path: Path, files: Sequence[tuple[zipfile.ZipInfo, bytes]]) -> Path:
    with zipfile.ZipFile(path, "w") as packed:
        for info, content in files:
            packed.writestr(info, content)
    return path


def there(folder: Path) -> list[str]:
    """All files but the table of the students."""
    files = (path for path in folder.rglob("*") if path.is_file() and path.name != "students.csv")
    return sorted(path.relative_to(folder).as_posix() for path in files)


@pytest.fixture
def notebooks(course: Course) -> Mapping[str, bytes]:
    """Released notebooks with one added cell: what is as released is not collected."""
    return {
        name: with_mark((course.release / name / f"{name}.ipynb").read_bytes(), "Done.")
        for name in course.assignments()
    }


def with_mark(notebook: bytes, mark: str) -> bytes:
    changed = json.loads(notebook)
    changed["cells"].append({"cell_type": "markdown", "metadata": {}, "source": mark, "id": "mark"})
    return json.dumps(changed).encode()


def test_folders_and_flat_names_and_nested_zips(course: Course, notebooks: Mapping[str, bytes], tmp_path: Path) -> None:
    for name in (PRELAB, LAB):
        (tmp_path / "work" / name).mkdir(parents=True)
        (tmp_path / "work" / name / f"{name}.ipynb").write_bytes(notebooks[name])
    pack([read_saved(tmp_path / "work" / name / f"{name}.ipynb") for name in (PRELAB, LAB)], tmp_path / "hand-in.zip")
    path = moodle(
        tmp_path / "m.zip",
        [
            (entry(f"{ADA}/Untitled1.ipynb"), notebooks[LAB]),
            (entry(f"{ADA}/essay.pdf"), b"%PDF"),
            (entry(f"{BEN}hand-in.zip"), (tmp_path / "hand-in.zip").read_bytes()),
            (entry("C_3_assignsubmission_file_/sub/folder/__MACOSX/._x.ipynb"), b""),
            (entry("C_3_assignsubmission_onlinetext_/onlinetext.html"), b"<p>See attached</p>"),
            (entry("readme.txt"), b""),
        ],
    )
    lines = list(collect_submissions(course, path, tmp_path / "out"))
    assert lines == [
        f"1001 (Ada Lovelace): {LAB}; skipped: essay.pdf",
        f"1002 (Ben O'Neil): {LAB}, {PRELAB}",
        "3 (C): no notebook of this course; skipped: onlinetext.html",
        "files of no participant: readme.txt",
    ]
    assert there(tmp_path / "out") == [
        f"1001/{LAB}/{LAB}.ipynb", f"1002/{LAB}/{LAB}.ipynb", f"1002/{PRELAB}/{PRELAB}.ipynb",
    ]  # fmt: skip
    assert (tmp_path / "out" / "1001" / LAB / f"{LAB}.ipynb").read_bytes() == notebooks[LAB]


def test_tries_are_taken_without_a_word_and_go_with_a_hand_in_that_lacks_them(
    course: Course, notebooks: Mapping[str, bytes], tmp_path: Path
) -> None:
    name = f"{LAB}-tries.json"
    files = [(entry(f"{ADA}/{LAB}/{LAB}.ipynb"), notebooks[LAB]), (entry(f"{ADA}/{LAB}/{name}"), b"{}")]
    target = tmp_path / "out" / "1001" / LAB / name
    silent = list(collect_submissions(course, moodle(tmp_path / "m.zip", files[:1]), tmp_path / "out"))
    assert not target.exists()
    assert list(collect_submissions(course, moodle(tmp_path / "m.zip", files), tmp_path / "out")) == silent
    assert target.read_bytes() == b"{}"
    large = [files[0], (files[1][0], b" " * 500_000)]
    for fewer in (large, files[:1]):
        target.write_bytes(b"{}")
        assert list(collect_submissions(course, moodle(tmp_path / "m.zip", fewer), tmp_path / "out")) == silent
        assert not target.exists()


@pytest.mark.parametrize("ending", [".txt", ".json", ".TXT", ".", " (1).ipynb"])
def test_a_notebook_that_a_browser_saved_as_text_is_one(
    ending: str, course: Course, notebooks: Mapping[str, bytes], tmp_path: Path
) -> None:
    path = moodle(tmp_path / "m.zip", [(entry(f"{ADA}/{LAB}.ipynb{ending}"), notebooks[LAB])])
    assert list(collect_submissions(course, path, tmp_path / "out")) == [f"1001 (Ada Lovelace): {LAB}"]


def test_the_latest_version_counts_and_it_is_said(
    course: Course, notebooks: Mapping[str, bytes], tmp_path: Path
) -> None:
    old, new = (with_mark(notebooks[LAB], mark) for mark in ("old", "new"))
    for names in (
        (("lab.ipynb", 5), ("a/final.ipynb", 9)),
        (("lab.ipynb", 5), ("lab (2).ipynb", 5)),
        (("lab (9).ipynb", 5), ("lab (10).ipynb", 5)),
    ):
        for order in (1, -1):
            pairs = zip(names, (old, new), strict=True)
            versions = [(entry(f"{ADA}/{name}", minute), data) for (name, minute), data in pairs]
            out = tmp_path / "out"
            (line,) = collect_submissions(course, moodle(tmp_path / "m.zip", versions[::order]), out)
            assert line == f"1001 (Ada Lovelace): {LAB} (the latest of 2 versions: {names[1][0]})"
            assert (out / "1001" / LAB / f"{LAB}.ipynb").read_bytes() == new
            shutil.rmtree(out)


def test_running_again_touches_nothing_and_takes_what_is_new(
    course: Course, notebooks: Mapping[str, bytes], tmp_path: Path
) -> None:
    path = moodle(tmp_path / "m.zip", [(entry(f"{ADA}/a.ipynb"), notebooks[LAB]), (entry(f"{BEN}/a.ipynb"), b"{")])
    list(collect_submissions(course, path, tmp_path / "out"))
    target = tmp_path / "out" / "1001" / LAB / f"{LAB}.ipynb"
    before = target.stat().st_mtime_ns
    list(collect_submissions(course, path, tmp_path / "out"))
    assert target.stat().st_mtime_ns == before
    newer = with_mark(notebooks[LAB], "newer")
    list(collect_submissions(course, moodle(path, [(entry(f"{ADA}/a.ipynb"), newer)]), tmp_path / "out"))
    assert target.read_bytes() == newer


def test_a_notebook_handed_in_as_released_is_not_taken_for_none(
    course: Course, notebooks: Mapping[str, bytes], tmp_path: Path
) -> None:
    template = read_template(course, LAB)
    released = (course.release / LAB / f"{LAB}.ipynb").read_bytes()
    path, out = tmp_path / "m.zip", tmp_path / "out"
    (line,) = collect_submissions(course, moodle(path, [(entry(f"{ADA}/{LAB}.ipynb"), released)]), out)
    assert line == f"1001 (Ada Lovelace): as released, not collected: {LAB}"
    found = read_submission(out / "1001" / LAB, "1001", template)
    assert (found.status, found.notes) == ("missing", (UNTOUCHED,))
    assert read_submission(out / "1001" / PRELAB, "1001", template).notes == (NOT_SUBMITTED,)
    assert handed_in_by(course, out) == {}
    untouched = submission_hash(out / "1001" / LAB, ".mat")

    list(collect_submissions(course, moodle(path, [(entry(f"{ADA}/{LAB}.ipynb"), notebooks[LAB])]), out))
    assert there(out) == [f"1001/{LAB}/{LAB}.ipynb"]
    assert read_submission(out / "1001" / LAB, "1001", template).status == "ready"
    assert submission_hash(out / "1001" / LAB, ".mat") != untouched
    list(collect_submissions(course, moodle(path, [(entry(f"{ADA}/{LAB}.ipynb"), released)]), out))
    assert there(out) == [f"1001/{LAB}/{LAB}.ipynb"]  # an untouched copy does not replace work


def test_a_later_zip_does_not_replace_the_hand_ins_of_earlier_weeks(
    course: Course, notebooks: Mapping[str, bytes], tmp_path: Path
) -> None:
    """A zip of `labsid submit` holds all notebooks with work in them."""

    def sheet(day: int) -> Worksheet:
        when = f"{day} November 2026, 4:05 PM"
        return worksheet(tmp_path / "w.csv", [{"Identifier": "Participant 1001", "Last modified (submission)": when}])

    first = moodle(tmp_path / "1.zip", [(entry(f"{ADA}/a.ipynb"), notebooks[PRELAB])])
    both = [(entry(f"{ADA}/a.ipynb"), notebooks[PRELAB]), (entry(f"{ADA}/b.ipynb"), notebooks[LAB])]
    second, out = moodle(tmp_path / "2.zip", both), tmp_path / "out"
    (line,) = collect_submissions(course, first, out, sheet(10), UTC, [PRELAB])
    assert line == f"1001 (Ada Lovelace): {PRELAB}"
    (line,) = collect_submissions(course, second, out, sheet(20), UTC, [LAB])
    assert line == f"1001 (Ada Lovelace): {LAB}; other assignments, not collected: {PRELAB}"
    stamps = {path.parent.name: path.read_text(encoding="utf-8") for path in out.glob("*/*/timestamp.txt")}
    assert stamps == {PRELAB: "2026-11-10 16:05:00 UTC\n", LAB: "2026-11-20 16:05:00 UTC\n"}
    (line,) = collect_submissions(course, second, out, sheet(20), UTC)
    assert line == f"1001 (Ada Lovelace): {LAB}, {PRELAB} (replaces what was collected before)"
    with pytest.raises(ValueError, match="there is no assignment 'holiday'"):
        list(collect_submissions(course, second, out, assignments=["holiday"]))


def test_a_broken_notebook_is_taken_for_what_it_is_called(course: Course, tmp_path: Path) -> None:
    path = moodle(tmp_path / "m.zip", [(entry(f"{ADA}/My {LAB} final.ipynb"), b"{"), (entry(f"{BEN}/x.ipynb"), b"[]")])
    assert list(collect_submissions(course, path, tmp_path / "out")) == [
        f"1001 (Ada Lovelace): {LAB} (cannot be read as a notebook)",
        "1002 (Ben O'Neil): no notebook of this course; skipped: x.ipynb: not a notebook of this course",
    ]
    assert (tmp_path / "out" / "1001" / LAB / f"{LAB}.ipynb").read_bytes() == b"{"


def test_a_strange_cell_does_not_hide_the_others(
    course: Course, notebooks: Mapping[str, bytes], tmp_path: Path
) -> None:
    strange = json.loads(notebooks[LAB])
    strange["cells"] += ["text", {"metadata": {"nbgrader": None}}, {"metadata": {"nbgrader": {"grade_id": []}}}, None]
    path = moodle(tmp_path / "m.zip", [(entry(f"{ADA}/x.ipynb"), json.dumps(strange).encode())])
    assert list(collect_submissions(course, path, tmp_path / "out")) == [f"1001 (Ada Lovelace): {LAB}"]


def test_links_bombs_and_paths_that_lead_out_are_left_alone(
    course: Course, notebooks: Mapping[str, bytes], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(archive, "MAX_FILE_BYTES", 1_000_000)
    bomb = io.BytesIO()
    with zipfile.ZipFile(bomb, "w", zipfile.ZIP_DEFLATED) as packed:
        packed.writestr("bomb.ipynb", bytes(30_000_000))
    path = moodle(
        tmp_path / "m.zip",
        [
            (entry(f"{ADA}/link.ipynb", mode=0o120777), b"/etc/passwd"),
            (entry(f"{ADA}/../../../../evil.ipynb"), notebooks[PRELAB]),
            (entry(f"{ADA}/{LAB}.ipynb"), bytes(2_000_000)),
            (entry(f"{BEN}/bomb.zip"), bomb.getvalue()),
            (entry(f"/etc/{BEN}/C:\\x\\lab.ipynb"), notebooks[LAB]),
            (entry(f"{BEN}/none.zip"), b"PK\x03\x04nothing"),
        ],
    )
    ada, ben = collect_submissions(course, path, tmp_path / "deep" / "out")
    assert ada.startswith(f"1001 (Ada Lovelace): {PRELAB}; skipped: link.ipynb: it is a link or a device")
    assert f"{LAB}.ipynb: it is too large" in ada
    assert "bomb.zip/bomb.ipynb: it is too large" in ben
    assert "none.zip is not a zip file, or not a complete one" in ben
    assert there(tmp_path) == [
        f"deep/out/1001/{LAB}/not-read.txt", "deep/out/1001/not-read.txt", f"deep/out/1001/{PRELAB}/{PRELAB}.ipynb",
        f"deep/out/1002/{LAB}/{LAB}.ipynb", "deep/out/1002/not-read.txt", "m.zip",
    ]  # fmt: skip


def test_why_a_hand_in_was_not_collected_stands_in_its_grades(
    course: Course, notebooks: Mapping[str, bytes], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Not that there was none; a hand-in that can be read takes the note away."""
    monkeypatch.setattr(archive, "MAX_FILE_BYTES", 2_000_000)
    files = [
        (entry(f"{ADA}/{LAB}.ipynb"), bytes(3_000_000)),
        (entry(f"{BEN}/work.zip"), b"PK\x03\x04nothing"),
    ]
    out, template = tmp_path / "out", read_template(course, LAB)
    list(collect_submissions(course, moodle(tmp_path / "m.zip", files), out))
    for student, why in (("1001", f"{LAB}.ipynb: it is too large (more than 1 MB)"), ("1002", "work.zip is not a")):
        found = read_submission(out / student / LAB, student, template)
        assert found.status == "quarantined"
        assert found.notes[0].startswith(f"what was handed in could not be read: {why}")
    assert handed_in_by(course, out) == {LAB: ["1001"]}
    before = submission_hash(out / "1002" / LAB, ".mat")
    files = [(entry(f"{owner}/{LAB}.ipynb"), notebooks[LAB]) for owner in (ADA, BEN)]
    list(collect_submissions(course, moodle(tmp_path / "m.zip", files), out))
    assert {read_submission(out / one / LAB, one, template).status for one in ("1001", "1002")} == {"ready"}
    assert submission_hash(out / "1002" / LAB, ".mat") != before
    assert not list(out.rglob("not-read.txt"))


@pytest.mark.parametrize(
    "name",
    [
        "hand-in without __MACOSX.zip",
        f".{LAB}.ipynb",
        f"my.ipynb_checkpoints_{LAB}.ipynb",
        f"my__MACOSX/{LAB}.ipynb",
        f".hidden/{LAB}.ipynb",
    ],
)
def test_names_that_resemble_those_of_automatic_copies_are_collected(
    name: str, course: Course, notebooks: Mapping[str, bytes], tmp_path: Path
) -> None:
    inner = io.BytesIO()
    with zipfile.ZipFile(inner, "w") as packed:
        packed.writestr(f"{LAB}.ipynb", notebooks[LAB])
    content = inner.getvalue() if name.endswith(".zip") else notebooks[LAB]
    lines = list(collect_submissions(course, moodle(tmp_path / "m.zip", [(entry(f"{ADA}/{name}"), content)]), tmp_path))
    assert lines == [f"1001 (Ada Lovelace): {LAB}"]


def test_automatic_copies_are_no_hand_in_and_named_where_nothing_else_is(
    course: Course, notebooks: Mapping[str, bytes], tmp_path: Path
) -> None:
    copies = [(entry(f"{ADA}/{one}/{LAB}.ipynb"), notebooks[LAB]) for one in (".ipynb_checkpoints", "a/__MACOSX")]
    junk = [(entry(f"{ADA}/{one}"), b"") for one in (f"._{LAB}.ipynb", ".DS_Store")]
    (line,) = collect_submissions(course, moodle(tmp_path / "m.zip", copies + junk), tmp_path / "one")
    made = "a copy that a program made by itself"
    listed = f".ipynb_checkpoints/{LAB}.ipynb: {made}, a/__MACOSX/{LAB}.ipynb: {made}"
    assert line == f"1001 (Ada Lovelace): no notebook of this course; skipped: {listed}"
    own = [(entry(f"{ADA}/x.ipynb"), notebooks[LAB])]
    (line,) = collect_submissions(course, moodle(tmp_path / "m.zip", copies + junk + own), tmp_path / "two")
    assert line == f"1001 (Ada Lovelace): {LAB}"


def test_a_copy_that_can_be_read_comes_before_one_that_cannot(
    course: Course, notebooks: Mapping[str, bytes], tmp_path: Path
) -> None:
    broken = (entry(f"{ADA}/{LAB}.ipynb", 9), notebooks[LAB][:-500])
    whole = (entry(f"{ADA}/{LAB} (1).ipynb", 5), notebooks[LAB])
    out = tmp_path / "out"
    (line,) = collect_submissions(course, moodle(tmp_path / "m.zip", [broken, whole]), out)
    assert f"not clear which is the latest: {LAB}.ipynb cannot be read" in line
    assert (out / "1001" / LAB / f"{LAB}.ipynb").read_bytes() == notebooks[LAB]
    found = read_submission(out / "1001" / LAB, "1001", read_template(course, LAB))
    assert (found.status, f"but {LAB}.ipynb cannot be read" in found.notes[0]) == ("ready", True)


def test_one_students_flood_costs_nobody_else_anything(
    course: Course, notebooks: Mapping[str, bytes], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("autograder.intake.collect.MOST", 1_000_000)
    flood = [(entry(f"{ADA}/{index}.ipynb"), bytes(300_000)) for index in range(5)]
    path = moodle(tmp_path / "m.zip", [*flood, (entry(f"{BEN}/x.ipynb"), notebooks[LAB])])
    ada, ben = collect_submissions(course, path, tmp_path / "out")
    assert ada.startswith("1001 (Ada Lovelace): no notebook of this course; not everything was read: its files take")
    assert ben == f"1002 (Ben O'Neil): {LAB}"


def test_a_link_in_the_folder_is_not_followed(course: Course, notebooks: Mapping[str, bytes], tmp_path: Path) -> None:
    path = moodle(tmp_path / "m.zip", [(entry(f"{ADA}/x.ipynb"), notebooks[LAB])])
    (tmp_path / "elsewhere").mkdir()
    (tmp_path / "out").mkdir()
    (tmp_path / "out" / "1001").symlink_to(tmp_path / "elsewhere", target_is_directory=True)
    with pytest.raises(ValueError, match="is a symbolic link, or is below one"):
        list(collect_submissions(course, path, tmp_path / "out"))
    assert there(tmp_path / "elsewhere") == []


def test_an_encrypted_file_is_left_out(course: Course, tmp_path: Path) -> None:
    path = moodle(tmp_path / "m.zip", [(entry(f"{ADA}/x.ipynb"), b"{}")])
    raw = bytearray(path.read_bytes())
    for signature, offset in ((b"PK\x03\x04", 6), (b"PK\x01\x02", 8)):
        raw[raw.index(signature) + offset] |= 1
    path.write_bytes(raw)
    (line,) = collect_submissions(course, path, tmp_path / "out")
    assert "x.ipynb: it cannot be unpacked (" in line


@pytest.mark.parametrize("content", [b"", b"not a zip", b"PK\x05\x06" + bytes(18)])
def test_what_is_not_moodles_is_said(course: Course, tmp_path: Path, content: bytes) -> None:
    (tmp_path / "m.zip").write_bytes(content)
    with pytest.raises(ValueError, match=r"is not a zip file|contains no submission"):
        list(collect_submissions(course, tmp_path / "m.zip", tmp_path / "out"))
    (tmp_path / "out").touch()
    with pytest.raises(ValueError, match="is a file"):
        list(collect_submissions(course, tmp_path / "m.zip", tmp_path / "out"))


# ---- the worksheet


def worksheet(path: Path, rows: Sequence[Mapping[str, str]]) -> Worksheet:
    columns = list(dict.fromkeys(column for row in rows for column in row))
    lines = [",".join(f'"{text}"' for text in columns)]
    lines += [",".join('"{}"'.format(row.get(column, "")) for column in columns) for row in rows]
    path.write_text("\ufeff" + "\r\n".join(lines) + "\r\n", encoding="utf-8", newline="")
    return read_worksheet(path)


def test_the_worksheet_gives_ids_and_times(course: Course, notebooks: Mapping[str, bytes], tmp_path: Path) -> None:
    sheet = worksheet(
        tmp_path / "w.csv",
        [
            {"Identifier": "Participant 1001", "Full name": "Ada Lovelace", "ID number": "z5000001",
             "Email address": "ada@x.edu", "Last modified (submission)": "Friday, 20 November 2026, 4:05 PM"},
            {"Identifier": "Participant 1002", "Full name": "Ben O'Neil", "ID number": "../evil",
             "Email address": "ben@x.edu", "Last modified (submission)": "-"},
            {"Identifier": "Participant 3", "Full name": "Cat", "Username": "cat3"},
        ],
    )  # fmt: skip
    files = [(entry(f"{folder}/x.ipynb"), notebooks[LAB]) for folder in (ADA, BEN)]
    files += [(entry(f"{who}_assignsubmission_file_/x.ipynb"), notebooks[LAB]) for who in ("Cat_0003", "Dan_4")]
    out = tmp_path / "out"
    lines = list(collect_submissions(course, moodle(tmp_path / "m.zip", files), out, sheet, UTC))
    assert lines == [
        f"z5000001 (Ada Lovelace): {LAB}",
        f"ben@x.edu (Ben O'Neil): {LAB}",
        f"cat3 (Cat): {LAB}",
        f"4 (Dan): {LAB}; not in the worksheet: the participant number is the ID",
    ]
    assert (out / "z5000001" / LAB / "timestamp.txt").read_text(encoding="utf-8") == "2026-11-20 16:05:00 UTC\n"
    assert not (out / "ben@x.edu" / LAB / "timestamp.txt").exists()


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (b"", "is not a grading worksheet"),
        (b"Name,Grade\nx,1\n", "is not a grading worksheet: it has no column Identifier"),
        (b"Identifier,Grade\nParticipant 1\n", "has 1 fields in row 2, but 2 columns"),
        (b"Identifier,Grade,Grade\n", "has two columns with the same name"),
        (b'Identifier,"Gra', "is not CSV"),
        (b"\xff\xfe", "is not text in UTF-8"),
    ],
)
def test_a_worksheet_that_is_none_is_said(tmp_path: Path, content: bytes, said: str) -> None:
    (tmp_path / "w.csv").write_bytes(content)
    with pytest.raises(ValueError, match=re.escape(said)):
        read_worksheet(tmp_path / "w.csv")


@given(st.text(max_size=120))
def test_an_id_is_one_folder_or_none(text: str) -> None:
    name = folder_name(text)
    assert name is None or (
        name and not set("/\\:\0") & set(name) and name not in (".", "..") and Path(name).name == name
    )


names = st.text(st.sampled_from(["a", "_", "1", ".", "/", "\\", " ", "é", "\x07", ":"]), max_size=12)
paths = st.builds(
    lambda before, name, number, rest: f"{before}{name}_{number}_assignsubmission_file_{rest}",
    st.sampled_from(["", "../", "/", "C:\\", "x/"]),
    names,
    st.integers(0, 12),
    st.builds(
        "{}{}{}".format, st.sampled_from(["", "/", "/../../", "\\..\\"]), names, st.sampled_from([".ipynb", ".zip", ""])
    ),
)
contents = st.sampled_from(
    [b"", b"{}", b"PK", b'{"cells": []}', b'{"cells": [{"metadata": {"nbgrader": {"grade_id": 1}}}]}']
)


@settings(max_examples=60)
@given(
    files=st.lists(st.tuples(paths | names, contents, st.sampled_from([0, 0o100644, 0o120777, 0o040755])), max_size=6)
)
def test_nothing_is_ever_written_outside_of_the_folder(course: Course, files: Sequence[tuple[str, bytes, int]]) -> None:
    with tempfile.TemporaryDirectory() as scratch:
        root = Path(scratch) / "a" / "b"
        root.mkdir(parents=True)
        path = root / "m.zip"
        with zipfile.ZipFile(path, "w") as packed, warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of two entries with one name, which an archive can have
            for name, content, mode in files:
                if not name.strip("/"):
                    continue
                data = (course.release / LAB / f"{LAB}.ipynb").read_bytes() if content == b"{}" else content
                packed.writestr(entry(name, mode=mode), data)
        lines = []
        with contextlib.suppress(ValueError):  # nothing in it is anybody's
            lines = list(collect_submissions(course, path, root / "out"))
        written = [one for one in there(Path(scratch)) if one != "a/b/m.zip"]
        for one in written:
            parts = one.split("/")
            assert parts[:3] == ["a", "b", "out"]
            assert parts[3].isdigit()
            assert len(parts) == 6 or parts[4:] == ["not-read.txt"]
        assert all(len(line.splitlines()) == 1 for line in lines)


def test_a_time_is_written_in_utc() -> None:
    from autograder.intake.worksheet import utc_timestamp

    assert utc_timestamp(datetime(2026, 11, 20, 16, 5, tzinfo=UTC)) == "2026-11-20 16:05:00 UTC"


def test_a_name_with_the_marker_of_another_participant_reaches_nobody_else(
    course: Course, notebooks: Mapping[str, bytes], tmp_path: Path
) -> None:
    """As a folder, and as a prefix with folders disabled; students choose their names and those of their files."""
    mine, planted = with_mark(notebooks[LAB], "mine"), with_mark(notebooks[LAB], "planted")
    files = [
        (entry(f"{ADA}/{LAB}.ipynb"), mine),
        (entry(f"Eve_1001_assignsubmission_file__7_assignsubmission_file_/{LAB}.ipynb", 9), planted),
        (entry(f"Eve_1001_assignsubmission_file__8_assignsubmission_file_{LAB}.ipynb", 9), planted),
        (entry(f"Eve_9_assignsubmission_file_{ADA}{LAB}.ipynb", 9), planted),
    ]
    lines = list(collect_submissions(course, moodle(tmp_path / "m.zip", files), tmp_path / "out"))
    assert there(tmp_path / "out") == [f"1001/{LAB}/{LAB}.ipynb", f"7/{LAB}/{LAB}.ipynb"]
    assert (tmp_path / "out" / "1001" / LAB / f"{LAB}.ipynb").read_bytes() == mine
    assert lines[-1].startswith("files of no participant: Eve_1001")


def test_without_a_clear_id_nothing_is_written(course: Course, notebooks: Mapping[str, bytes], tmp_path: Path) -> None:
    ids = {"1": "2", "2": ""}
    sheet = worksheet(
        tmp_path / "w.csv",
        [{"Identifier": f"Participant {n}", "Full name": f"S{n}", "ID number": id} for n, id in ids.items()],
    )
    files = [(entry(f"S{n}_{n}_assignsubmission_file_/x.ipynb"), with_mark(notebooks[LAB], f"of {n}")) for n in ids]
    packed = moodle(tmp_path / "m.zip", files)
    with pytest.raises(ValueError, match=r"S1 \(2\), participant 1 and S2 \(2\), participant 2 have the same ID"):
        list(collect_submissions(course, packed, tmp_path / "out", sheet, UTC))
    assert not (tmp_path / "out").exists()


def test_an_id_stays_as_it_was_decided(course: Course, notebooks: Mapping[str, bytes], tmp_path: Path) -> None:
    """Whatever worksheet comes later, and for a participant of another assignment by the username."""
    out, files = tmp_path / "out", [(entry(f"{ADA}/x.ipynb"), notebooks[LAB])]
    row = {"Identifier": "Participant 1001", "Full name": "=Ada", "Username": "ada", "ID number": "+z1"}
    packed = moodle(tmp_path / "m.zip", files)
    list(collect_submissions(course, packed, out, worksheet(tmp_path / "w.csv", [row])))
    assert "\n'+z1,'=Ada,,ada,1001\n" in (out / "students.csv").read_text(encoding="utf-8")  # no formula
    assert read_students(out / "students.csv") == [Student("+z1", "=Ada", "", "ada", "1001")]
    for changed in ({"ID number": ""}, {"ID number": "z2"}, {"Identifier": "Participant 7", "ID number": "z2"}):
        again = worksheet(tmp_path / "w.csv", [{**row, **changed}])
        number = again.rows[0]["Identifier"].split()[1]
        packed = moodle(tmp_path / "m.zip", [(entry(f"Ada_{number}_assignsubmission_file_/x.ipynb"), notebooks[LAB])])
        (line,) = collect_submissions(course, packed, out, again)
        assert line.startswith("+z1 (Ada")
    (line,) = collect_submissions(course, moodle(tmp_path / "m.zip", files), out)
    assert line.startswith("+z1 (Ada Lovelace)")


def test_a_hand_in_whose_time_is_not_known_does_not_keep_that_of_another(
    course: Course, notebooks: Mapping[str, bytes], tmp_path: Path
) -> None:
    times = ("Friday, 20 November 2026, 4:05 PM", "-")
    first, second = (
        worksheet(tmp_path / f"{n}.csv", [{"Identifier": "Participant 1001", "Last modified (submission)": when}])
        for n, when in enumerate(times)
    )
    out, stamp = tmp_path / "out", tmp_path / "out" / "1001" / LAB / "timestamp.txt"
    packed = moodle(tmp_path / "m.zip", [(entry(f"{ADA}/x.ipynb"), notebooks[LAB])])
    list(collect_submissions(course, packed, out, first, UTC))
    list(collect_submissions(course, packed, out, second, UTC))
    assert stamp.is_file()  # the same hand-in
    moodle(packed, [(entry(f"{ADA}/x.ipynb"), with_mark(notebooks[LAB], "late"))])
    (line,) = collect_submissions(course, packed, out, second, UTC)
    assert "the time of the hand-in is not known, that of the one before was removed" in line
    assert not stamp.exists()


def test_a_participant_who_is_twice_in_the_worksheet_is_said(
    course: Course, notebooks: Mapping[str, bytes], tmp_path: Path
) -> None:
    sheet = worksheet(tmp_path / "w.csv", [{"Identifier": "Participant 1001"}, {"Identifier": "Participant 01001"}])
    packed = moodle(tmp_path / "m.zip", [(entry(f"{ADA}/x.ipynb"), notebooks[LAB])])
    with pytest.raises(ValueError, match="the worksheet has participant 1001 twice"):
        list(collect_submissions(course, packed, tmp_path / "out", sheet, UTC))
