"""Other records in the place of a student's own: reproducible, far enough from it, and no harder."""

from functools import cache
from pathlib import Path

import numpy as np
import pytest
from one_answer import SECRET
from record_draws import NOT_OF_THE_RIG, draw, typed_variants, with_record
from representatives import mostly_exhaustive

from autograder.course.individual_data import individual_file
from labsid.checks.notebook import load_assignment
from labsid.checks.other_records import another_record, can_be_drawn
from labsid.checks.other_records.other_tanks import SHORTEST_REST
from labsid.lab.offset import find_offsets, first_period_length
from labsid.records.record import Record, load_record

DATA = Path(__file__).resolve().parents[3] / "data"
LAB, GAP = "SysIdenData_StudentVersion.mat", "WithheldRig.csv"
OWN = ("shared", "ann", "bob", "empty start")


def read(content: bytes, name: str, folder: Path) -> Record:
    path = folder / name
    path.write_bytes(content)
    return load_record(path)


@cache
def own_content(name: str, who: str) -> bytes:
    if who == "empty start":
        return (DATA / "SysIdenData_EmptyStart.mat").read_bytes()
    return (DATA / name).read_bytes() if who == "shared" else individual_file(name, who, SECRET)


def own_record(name: str, who: str, folder: Path) -> Record:
    return read(own_content(name, who), name, folder)


@pytest.mark.parametrize("name", [LAB, GAP])
def test_equal_seeds_give_equal_records_and_others_do_not(name: str, tmp_path: Path) -> None:
    own = own_record(name, "ann", tmp_path)
    first = another_record(name, own, 1)
    assert another_record(name, own, 1) == first
    assert another_record(name, own, 2) != first
    assert another_record(name, own_record(name, "bob", tmp_path), 1) != first


@pytest.mark.parametrize("who", OWN)
def test_another_lab_record_is_no_harder(who: str, tmp_path: Path) -> None:
    own = own_record(LAB, who, tmp_path)
    for seed in range(6):
        other = read(another_record(LAB, own, seed), LAB, tmp_path)
        assert (len(other), other.Ts) == (len(own), own.Ts)
        assert np.count_nonzero(np.diff(other.u)) == np.count_nonzero(np.diff(own.u))
        steps = [np.abs(np.diff(one.u))[np.flatnonzero(np.diff(one.u))] for one in (other, own)]
        assert np.all(steps[0] >= steps[1] - 1e-9)
        starts = [find_offsets(one.u, one.y) for one in (other, own)]
        assert (starts[0].settled[0] == 0) == (starts[1].settled[0] == 0)
        assert starts[0].first_period >= SHORTEST_REST
        assert starts[0].first_period != starts[1].first_period
        noise = [np.std(np.diff(one.y_measured, 2)) for one in (other, own)]
        assert noise[0] < noise[1]


def test_another_withheld_record_is_no_harder(tmp_path: Path) -> None:
    own = own_record(GAP, "ann", tmp_path)
    for seed in range(3):
        other = read(another_record(GAP, own, seed), GAP, tmp_path)
        assert (len(other), other.Ts, len(other) % 16) == (len(own), own.Ts, 0)
        rest = [one.y[: first_period_length(one.u)] for one in (other, own)]
        assert rest[0].size >= SHORTEST_REST
        assert np.std(rest[0]) < np.std(rest[1])


def test_a_record_without_a_settled_step_has_no_other(tmp_path: Path) -> None:
    own = own_record(LAB, "shared", tmp_path)
    brief = Record(t=own.t[:60], u=own.u[:60], y=own.y[:60], Ts=own.Ts)
    with pytest.raises(ValueError, match="at least 10 after it"):
        another_record(LAB, brief, 1)


def test_other_files_have_no_other_records(tmp_path: Path) -> None:
    assert not can_be_drawn("HairDryer.csv")
    with pytest.raises(ValueError, match=r"no other records in the place of HairDryer\.csv"):
        another_record("HairDryer.csv", own_record(LAB, "shared", tmp_path), 1)


@pytest.mark.parametrize("name", mostly_exhaustive(with_record(), ["lab-identification"]))
def test_typed_in_values_are_wrong_on_a_draw_and_right_styles_right(name: str) -> None:
    found = draw(name, "z0000007", 20261127)
    assert found.tried > 20
    assert (found.passed, found.refused) == ((), ())


def test_every_question_on_values_of_the_record_is_tried_with_typed_in_values() -> None:
    assert with_record() == ["lab-identification", "postlab-model-order", "sim-to-real-gap", "step-response"]
    tried = {question for name in with_record() for question in typed_variants(name, "z0000007")}
    assert len(tried) == 27, sorted(tried)
    assert "td_tank" in NOT_OF_THE_RIG
    assert all(load_assignment(name).record_file for name in with_record())
