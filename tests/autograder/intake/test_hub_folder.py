"""Hand-ins from a folder of a hub: whose they are, when they were made, and which of several counts.

All folders here belong to one user, as on a hub of containers; `tests/hub` has users of their own.
"""

import io
import json
import os
import re
import sys
import time
import zipfile
from pathlib import Path

import pytest

from autograder.course.layout import Course
from autograder.course.students import Student
from autograder.intake.collect_hub import collect_hub_folder

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="hubs run on Linux")

PRELAB, LAB = "prelab-sinusoids", "lab-identification"


def notebook(course: Course, name: str, mark: str) -> bytes:
    """A released notebook with one added cell."""
    changed = json.loads((course.release / name / f"{name}.ipynb").read_bytes())
    changed["cells"].append({"cell_type": "markdown", "metadata": {}, "source": mark, "id": "mark"})
    return json.dumps(changed).encode()


def hand_in(**notebooks: bytes) -> bytes:
    """A zip file as `labsid submit` makes it; `_` in a name stands for `-`."""
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w") as archive:
        for key, content in notebooks.items():
            name = key.replace("_", "-")
            archive.writestr(f"{name}/{name}.ipynb", content)
    return packed.getvalue()


def put(path: Path, content: bytes) -> None:
    """Write a file, at a later time than what was written before."""
    path.parent.mkdir(parents=True, exist_ok=True)
    time.sleep(0.02)
    path.write_bytes(content)


def mark_of(out: Path, student: str, name: str) -> str:
    cells = json.loads((out / student / name / f"{name}.ipynb").read_bytes())["cells"]
    return str(cells[-1]["source"])


def timestamp(out: Path, student: str, name: str) -> str:
    return (out / student / name / "timestamp.txt").read_text(encoding="utf-8")


def test_of_each_assignment_the_last_hand_in_counts_whatever_it_is_called(course: Course, tmp_path: Path) -> None:
    shared, out = tmp_path / "shared", tmp_path / "out"
    both = {"prelab_sinusoids": notebook(course, PRELAB, "one"), "lab_identification": notebook(course, LAB, "one")}
    put(shared / "ada" / "z.zip", hand_in(**both))
    put(shared / "ada-2" / "y.zip", hand_in(lab_identification=notebook(course, LAB, "other")))
    put(shared / "ada" / "a.zip", hand_in(prelab_sinusoids=notebook(course, PRELAB, "two")))
    for path in shared.rglob("*.zip"):
        os.utime(path, (0, 0))  # the time that a student can set
        time.sleep(0.02 if path.name == "a.zip" else 0)
    os.utime(shared / "ada" / "a.zip", (0, 0))
    assert list(collect_hub_folder(course, shared, out)) == [f"ada: {LAB}, {PRELAB}", f"ada-2: {LAB}"]
    assert mark_of(out, "ada", PRELAB) == "two"
    assert mark_of(out, "ada", LAB) == "one"
    year = str(time.gmtime().tm_year)
    assert all(timestamp(out, "ada", name).startswith(year) for name in (PRELAB, LAB))
    again = list(collect_hub_folder(course, shared, out, assignments=[PRELAB]))
    assert again[0] == f"ada: {PRELAB}; other assignments, not collected: {LAB}"


def test_a_user_of_the_hub_is_the_student_with_this_username(course: Course, tmp_path: Path) -> None:
    shared, out = tmp_path / "shared", tmp_path / "out"
    for user in ("jupyter-ada", "eve"):
        put(shared / user / "a.zip", hand_in(prelab_sinusoids=notebook(course, PRELAB, user)))
    known = [Student("z1", "Ada", username="jupyter-ada"), Student("z2", "Ben")]
    assert list(collect_hub_folder(course, shared, out, known=known)) == [
        f"eve: {PRELAB}; not in the students file",
        f"z1 (jupyter-ada): {PRELAB}",
    ]
    assert mark_of(out, "z1", PRELAB) == "jupyter-ada"
    assert list(collect_hub_folder(course, shared, out)) == [f"eve: {PRELAB}", f"z1 (jupyter-ada): {PRELAB}"]


def test_a_broken_last_hand_in_is_said_and_the_one_before_is_taken(course: Course, tmp_path: Path) -> None:
    shared, out = tmp_path / "shared", tmp_path / "out"
    put(shared / "ada" / "1.zip", hand_in(prelab_sinusoids=notebook(course, PRELAB, "one")))
    put(shared / "ada" / f"{PRELAB}.zip", b"PK broken")
    put(shared / "ben" / "0.zip", b"PK broken")
    put(shared / "ben" / "1.zip", hand_in(prelab_sinusoids=notebook(course, PRELAB, "one")))
    said = list(collect_hub_folder(course, shared, out))
    assert said[0].startswith(f"ada: {PRELAB} (not clear which is the latest: ")
    assert f"{PRELAB}.zip is not a zip file, or not a complete one" in said[0]
    assert said[1] == f"ben: {PRELAB}"
    assert mark_of(out, "ada", PRELAB) == "one"


def test_links_pipes_and_hidden_files_are_nobody_s_hand_in(course: Course, tmp_path: Path) -> None:
    shared, out = tmp_path / "shared", tmp_path / "out"
    secret = tmp_path / "secret.ipynb"
    secret.write_bytes(notebook(course, PRELAB, "secret"))
    put(shared / "ada" / "1.zip", hand_in(prelab_sinusoids=notebook(course, PRELAB, "own")))
    put(shared / "ada" / ".half.partial", b"PK")
    (shared / "ada" / "2.ipynb").symlink_to(secret)
    os.mkfifo(shared / "ada" / "3.zip")
    os.mkfifo(shared / "4.zip")
    (shared / "eve").symlink_to(tmp_path)
    put(shared / "5.zip", b"of the owner of the folder")
    assert list(collect_hub_folder(course, shared, out)) == [
        f"ada: {PRELAB}",
        "belongs to nobody, or cannot be read: 4.zip (neither a file nor a folder), 5.zip (it belongs to the owner of "
        "the folder), eve (neither a file nor a folder)",
    ]
    assert mark_of(out, "ada", PRELAB) == "own"


def test_a_folder_of_nbgrader_is_one_hand_in_of_the_user_in_its_name(course: Course, tmp_path: Path) -> None:
    inbound, out = tmp_path / "inbound", tmp_path / "out"
    for number, mark in (("2099-01-01 00:00:00 UTC+b", "one"), ("2020-01-01 00:00:00 UTC+a", "two")):
        folder = inbound / f"ada+{PRELAB}+{number}"
        put(folder / f"{PRELAB}.ipynb", notebook(course, PRELAB, mark))
        put(folder / "timestamp.txt", number.encode())
        put(folder / "submission_secret.txt", b"secret")
    assert list(collect_hub_folder(course, inbound, out)) == [f"ada: {PRELAB}"]
    assert mark_of(out, "ada", PRELAB) == "two"
    assert not re.match("2020|2099", timestamp(out, "ada", PRELAB))


def test_a_file_that_is_too_large_is_left_out_with_a_word(
    course: Course, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("autograder.intake.collect_hub.MAX_FILE_BYTES", 1_000_000)
    put(tmp_path / "shared" / "ada" / "1.zip", b"0" * 1_000_001)
    (said,) = collect_hub_folder(course, tmp_path / "shared", tmp_path / "out")
    assert said == "ada: no notebook of this course; skipped: 1.zip: it has more than 1 MB"


def test_nothing_is_written_if_two_users_are_one_student(course: Course, tmp_path: Path) -> None:
    for user in ("ada", "z1"):
        put(tmp_path / "shared" / user / "1.zip", b"PK")
    with pytest.raises(ValueError, match="same ID"):
        list(collect_hub_folder(course, tmp_path / "shared", tmp_path / "out", known=[Student("z1", username="ada")]))
    assert not (tmp_path / "out").exists()
