import os
import stat
from pathlib import Path

import pytest

from autograder.batch.grading_inputs import DataStore, inputs_for
from autograder.course.layout import Course, read_template
from autograder.course.own_secret import PUBLIC_SECRET, make_own_secret, read_own_secret, shared_file
from labsid.rig.switchable.withheld import withheld_record_bytes
from labsid.rig.switchable.withheld_effects import RECORD_FILE, STAND_IN_STUDENT

GAP = "sim-to-real-gap"


@pytest.fixture
def mine(course: Course, tmp_path: Path) -> Course:
    """The same course in another place, with a secret of its own."""
    for name in ("notebooks", "data", "autograder/release"):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).symlink_to(course.root / name)
    assert make_own_secret(Course(tmp_path))
    return Course(tmp_path)


def test_a_course_makes_its_secret_once(mine: Course) -> None:
    made = read_own_secret(mine)
    assert len(made) == 64
    assert not make_own_secret(mine)
    assert read_own_secret(mine) == made
    if os.name == "posix":
        assert stat.S_IMODE(mine.secret_file.stat().st_mode) == 0o600


def test_without_a_secret_of_its_own_a_course_uses_the_public_one(course: Course) -> None:
    assert read_own_secret(course) == PUBLIC_SECRET
    assert shared_file(course, RECORD_FILE) == course.data / RECORD_FILE


def test_what_is_withheld_cannot_be_computed_from_what_is_public(mine: Course, course: Course) -> None:
    path = shared_file(mine, RECORD_FILE)
    assert path.read_bytes() == withheld_record_bytes(STAND_IN_STUDENT, read_own_secret(mine))
    assert path.read_bytes() != shared_file(course, RECORD_FILE).read_bytes()
    assert shared_file(mine, "SysIdenData_StudentVersion.mat").parent == mine.data


def test_the_shared_record_is_graded_with_the_secret_of_its_course(mine: Course, tmp_path: Path) -> None:
    inputs = inputs_for(DataStore(mine, None, tmp_path / "records"), read_template(mine, GAP), "ann")
    assert inputs.files == {RECORD_FILE: shared_file(mine, RECORD_FILE)}
    assert inputs.assets.origin is not None
    assert (inputs.assets.origin.student, inputs.assets.origin.secret) == (STAND_IN_STUDENT, read_own_secret(mine))
    assert inputs.assets.secret == read_own_secret(mine)
