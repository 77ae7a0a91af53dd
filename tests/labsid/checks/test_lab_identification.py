"""The lab's checks in the notebook: on the stand-in, on individual records, and on real ones."""

import re
from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pytest
from scipy.signal import lfilter

from labsid.checks import NoAnswer
from labsid.checks.assignments.lab_identification import ASSIGNMENT
from labsid.checks.assignments.lab_identification.lab_data import LabData
from labsid.checks.assignments.lab_identification.part_1 import _staircases
from labsid.checks.assignments.lab_identification.part_2 import judge_transfer_function, require_sampling_time
from labsid.checks.assignments.lab_identification.phi_and_theta import judge_equations, judge_theta
from labsid.checks.assignments.lab_identification.simulated_output import judge_entire_run, judge_mse, read_output
from labsid.checks.values import StateSpaceValue, TransferFunctionValue, Unreadable, Value
from labsid.lab.arx import ArxModel
from labsid.lab.offset import find_offsets, first_period_length
from labsid.lab.regressor import build_phi
from labsid.records.record import load_record

NAME = "lab-identification"
SECRET = b"a secret of the tests"
QUESTIONS = [question.id for question in ASSIGNMENT.questions]


class FakeAsk:
    """Hands out the values that a test sets."""

    def __init__(self, values: Mapping[str, Value], seed: int = 1) -> None:
        self._values = values
        self.rng = np.random.default_rng(seed)

    def value(self, name: str) -> Value:
        return self._values[name]

    known = value


def data_of(path: Path) -> LabData:
    record = load_record(path)
    offsets = find_offsets(record.u, record.y)
    assert record.y_measured is not None
    return LabData(record.u, record.y, record.y_measured, offsets.u_offset, offsets.y_offset, record.Ts)


def judge_phi(data: LabData, Phi: Value, Y: Value):
    return judge_equations(FakeAsk({"Phi": Phi, "Y": Y}), ("Phi", "Y"), data, 2)


@pytest.mark.parametrize("name", ["SysIdenData_8", "SysIdenData_4"])
def test_the_mean_over_an_unsettled_period_is_named(name: str, shared_data: Path, run_notebook) -> None:
    naive = "y_offset, u_offset = y_act[:n_first].mean(), u_act[0]\ny, u = y_act - y_offset, u_act - u_offset\n"
    path = shared_data / "unsw-water-tank" / f"{name}.mat"
    said = run_notebook(NAME, path, {"lab-1c-offsets-answer": naive})
    assert "is not settled at its start" in said["lab-1c-offsets"]
    assert "lab-1c-offsets" in said["lab-2a-phi"]


def test_every_check_of_an_empty_release_fails_kindly(shipped_record_path: Path, run_notebook) -> None:
    said = run_notebook(NAME, shipped_record_path, release=True)
    assert list(said) == QUESTIONS
    for question, text in said.items():
        assert re.match(rf"{question}:", text), text
        assert "Error" not in text


def test_points_sum_to_two_in_three_parts() -> None:
    text = (Path(__file__).parents[3] / "notebooks" / NAME / f"{NAME}.md").read_text(encoding="utf-8")
    tenths = {"1": 0, "2": 0, "3": 0}
    for part, points in re.findall(r"lab-(\d)\S*?\"?,[ \"]+points\"?: ([\d.]+)", text):
        tenths[part] += round(1000 * float(points))
    assert tenths == {"1": 600, "2": 600, "3": 800}


def test_every_question_has_its_cell_after_its_answer(notebook_cells) -> None:
    order = [str(words["grade_id"]) for words, _ in notebook_cells(NAME)]
    for question in QUESTIONS:
        assert order[order.index(question) - 1] == f"{question}-answer"


def test_given_cells_keep_to_what_students_may_use(notebook_cells) -> None:
    for words, source in notebook_cells(NAME):
        for module in re.findall(r"(?:from|import) labsid\.?(\w*)", source):
            assert module in ("", "checks"), f"{words['grade_id']} uses labsid.{module}"


def test_loop_is_tried_on_inputs_that_tell_the_slips_apart() -> None:
    trials = _staircases(np.random.default_rng(3))
    periods = [first_period_length(u) for u in trials]
    assert periods[-1] == 1
    assert len({bool(u[n] > u[0]) for u, n in zip(trials, periods, strict=True)}) == 2
    assert any(np.count_nonzero(u == u[0]) > n for u, n in zip(trials, periods, strict=True))


@pytest.mark.parametrize("start", [0, 1, 2, 3, 10, 100])
@pytest.mark.parametrize("end", [-1, 0, 1])
def test_any_sensible_rows_pass(start: int, end: int, shipped_record_path: Path) -> None:
    data = data_of(shipped_record_path)
    made = build_phi(data.u, data.y, 2, start, data.half + end)
    verdict = judge_phi(data, made.Phi, made.Y[:, np.newaxis])
    assert verdict.passed, verdict.reason


def test_rows_that_miss_the_half_do_not_pass(shipped_record_path: Path) -> None:
    data = data_of(shipped_record_path)
    for stop in (data.half - 5, data.half + 5, data.y.size):
        made = build_phi(data.u, data.y, 2, 2, stop)
        assert not judge_phi(data, made.Phi, made.Y).passed


@pytest.mark.parametrize("value", [0.0, 1.0])
def test_constant_equations_do_not_pass(value: float, shipped_record_path: Path) -> None:
    data = data_of(shipped_record_path)
    assert not judge_phi(data, np.full((449, 4), value), np.full(449, value)).passed


def test_a_few_equations_are_refused(shipped_record_path: Path) -> None:
    data = data_of(shipped_record_path)
    made = build_phi(data.u, data.y, 2, 2, 6)
    with pytest.raises(NoAnswer, match="fewer than the 4 unknowns"):
        judge_phi(data, made.Phi[:3], made.Y[:3])


def test_theta_of_another_order_is_refused(shipped_record_path: Path) -> None:
    data = data_of(shipped_record_path)
    made = build_phi(data.u, data.y, 2, 2, data.half)
    with pytest.raises(NoAnswer, match="should have 4 elements"):
        judge_theta(FakeAsk({"theta_hat": np.ones(2)}), "theta_hat", made.Phi, made.Y, data, 2)


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (Unreadable("TimeResponseData"), "take its `.outputs`"),
        ((np.ones(3), np.ones((3, 2))), "several values"),
        ({"outputs": np.ones(3)}, "several values"),
        (np.vstack([np.arange(50), np.ones(50)]), "time and output"),
        (np.ones((2, 50)), "as `.states` has"),
        (None, "nothing"),
        ("y", "text"),
    ],
)
def test_outputs_that_are_none_are_named(value: Value, text: str) -> None:
    with pytest.raises(NoAnswer, match=re.escape(text)):
        read_output("y_sim", value)


def test_one_row_of_output_counts_as_output() -> None:
    assert read_output("y_sim", np.ones((1, 7))).shape == (7,)


def test_an_output_of_zeros_is_not_told_a_cause_that_nothing_proves(shipped_record_path: Path) -> None:
    data, model = data_of(shipped_record_path), ArxModel([1.0, -1.5, 0.6], [0.1, 0.05], 0.1)
    column = lfilter([0, *model.b], model.a, data.u.reshape(-1, 1))
    for zeros, slip in ((column, "filtered along the wrong axis"), (np.zeros(data.u.size), "zero output")):
        verdict = judge_entire_run(FakeAsk({"y_sim": zeros}), "y_sim", data, model)
        assert (verdict.passed, verdict.slip) == (False, slip)
    assert verdict.reason.endswith("print the input and the coefficients that your line hands over, and their shapes.")
    for constant in (0.1, -3.0):
        verdict = judge_entire_run(FakeAsk({"y_sim": np.full(data.u.size, constant)}), "y_sim", data, model)
        assert not verdict.passed
        assert "lfilter" not in verdict.reason


def test_mean_squared_error_by_hand() -> None:
    y, y_sim = np.array([1.0, 2.0, 3.0]), np.array([1.0, 0.0, 4.0])
    assert judge_mse("mse", 5 / 3, y, y_sim).passed
    assert judge_mse("mse", 5.0, y, y_sim).slip == "sum in place of the mean"
    assert judge_mse("mse", 2.5, y, y_sim).slip in ("loss V in place of the mean", "second half only")


@pytest.mark.parametrize("dt", [None, 1.0])
def test_sampling_time_of_a_model(dt: float | None) -> None:
    with pytest.raises(NoAnswer, match="sampling time"):
        require_sampling_time("G", TransferFunctionValue(np.ones(1), np.ones(2), dt), 0.75)


def test_a_transfer_function_with_a_pole_on_the_circle_is_no_error(shipped_record_path: Path) -> None:
    from labsid.lab.arx import arx_from_theta

    model = arx_from_theta(np.array([1.4, -0.4, 0.0, 0.05]), 0.75)
    got = TransferFunctionValue(np.zeros(2), np.array([1.0, -1.0, 0.0]), 0.75)
    assert not judge_transfer_function("G", got, model, "eq. (1)").passed
    with pytest.raises(NoAnswer, match="state space"):
        judge_transfer_function(
            "G", StateSpaceValue(np.eye(1), np.eye(1), np.eye(1), np.eye(1), 0.75), model, "eq. (1)"
        )
