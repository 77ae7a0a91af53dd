"""The post-lab's checks in the notebook, and the parts that read text and judge a function."""

import re
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from labsid.checks.assignments.lab_identification import simulated_output
from labsid.checks.assignments.lab_identification.lab_data import LabData
from labsid.checks.assignments.postlab_model_order import ASSIGNMENT
from labsid.checks.assignments.postlab_model_order.first_order_model import _numbers
from labsid.lab.arx import arx_from_theta
from labsid.lab.offset import find_offsets
from labsid.lab.simulation import simulate
from labsid.records.record import load_record

NAME = "postlab-model-order"
SECRET = b"a secret of the tests"
QUESTIONS = [question.id for question in ASSIGNMENT.questions]


def test_every_check_of_an_empty_release_fails_kindly(shipped_record_path: Path, run_notebook) -> None:
    said = run_notebook(NAME, shipped_record_path, release=True)
    assert list(said) == QUESTIONS
    for question, text in said.items():
        assert re.match(rf"{question}:", text), text
        assert "Error" not in text


@pytest.mark.parametrize("name", ["SysIdenData_StudentVersion", "SysIdenData_8", "SysIdenData_4"])
def test_the_given_offset_agrees_with_the_reference(name: str, shared_data: Path, notebook_cells) -> None:
    path = shared_data / "unsw-water-tank" / f"{name}.mat"
    record = load_record(path)
    (given,) = (source for words, source in notebook_cells(NAME) if words["grade_id"] == "postlab-record")
    variables: dict[str, object] = {"np": np, "load_record": lambda _: record}
    exec(given, variables)
    offset = float(np.mean(record.y - variables["y"]))
    assert abs(offset - find_offsets(record.u, record.y).y_offset) < 0.01
    if name == "SysIdenData_StudentVersion":
        assert variables["k_settled"] == 0


def test_another_offset_in_the_notebook_is_judged_on_the_reference(shipped_record_path: Path, run_notebook) -> None:
    spoilt = "y = y + 0.3\nPhi_1 = np.column_stack([y[: half - 1], u[: half - 1]])\nY_1 = y[1:half]"
    said = run_notebook(NAME, shipped_record_path, {"postlab-1-phi-answer": spoilt})
    assert said["postlab-1-phi"] != ""


def test_no_known_mistake_is_simulated_for_a_right_answer(
    shipped_record_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """That took an eighth of the judge's time for this assignment."""
    record = load_record(shipped_record_path)
    data = LabData(record.u, record.y, record.y, record.u[0], 0.0, record.Ts)
    model = arx_from_theta(np.array([0.9, 0.1]), record.Ts)
    monkeypatch.setattr(simulated_output, "predict_one_step", lambda *_: pytest.fail("it was simulated"))
    ask = SimpleNamespace(value=lambda name: simulate(model, data.u))
    assert simulated_output.judge_entire_run(ask, "y_sim_1", data, model).passed


def test_points_sum_to_one() -> None:
    text = (Path(__file__).parents[3] / "notebooks" / NAME / f"{NAME}.md").read_text(encoding="utf-8")
    points = re.findall(r"grade_id\"?: [^,]+, \"?points\"?: ([\d.]+)", text)
    assert sum(round(1000 * float(each)) for each in points) == 1000


@pytest.mark.parametrize(
    "text",
    [
        "MSE = 8.945e-04 V^2",
        "MSE = 8.945×10⁻⁴ V²",
        r"MSE = $8.945 \times 10^{-4}$ V$^2$",
        "MSE=8.945*10^-4",
        "MSE=8.945*10**-4",
        "MSE: 0.0008945",
        "MSE: 8.945E-4",
    ],
)
def test_numbers_are_read_however_they_are_written(text: str) -> None:
    assert any(abs(float(number) - 8.945e-4) < 1e-12 for number in _numbers(text))


def test_a_text_without_a_number_has_none() -> None:
    assert _numbers("mean squared error") == []
