"""The solution passes every check in the notebook, on whatever record lies beside it."""

from pathlib import Path

import pytest

from labsid.checks.notebook import load_assignment
from labsid.rig import make_empty_start_record, make_lab_record, write_lab_record

SECRET = b"a secret of the tests"
ON_A_RECORD = pytest.mark.parametrize("name", ["lab-identification", "postlab-model-order", "step-response"])


def all_passed(name: str) -> dict[str, str]:
    return {question.id: "" for question in load_assignment(name).questions}


@ON_A_RECORD
def test_on_the_stand_in(name: str, shipped_record_path: Path, run_notebook) -> None:
    assert run_notebook(name, shipped_record_path) == all_passed(name)


@ON_A_RECORD
@pytest.mark.parametrize("student", ["z5000001", "z5000002", "z5000003"])
def test_on_individual_records(name: str, student: str, tmp_path: Path, run_notebook) -> None:
    path = tmp_path / "own.mat"
    write_lab_record(path, make_lab_record(student, SECRET))
    assert run_notebook(name, path) == all_passed(name)


@ON_A_RECORD
def test_where_the_tanks_start_empty(name: str, tmp_path: Path, run_notebook) -> None:
    path = tmp_path / "empty.mat"
    write_lab_record(path, make_empty_start_record())
    assert run_notebook(name, path) == all_passed(name)


@ON_A_RECORD
@pytest.mark.parametrize("record", ["SysIdenData_StudentVersion", "SysIdenData_8", "SysIdenData_4"])
def test_on_real_records(name: str, record: str, shared_data: Path, run_notebook) -> None:
    assert run_notebook(name, shared_data / "unsw-water-tank" / f"{record}.mat") == all_passed(name)
