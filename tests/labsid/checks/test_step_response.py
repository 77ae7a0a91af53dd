"""The appendix's checks in the notebook, on many records, and how fairly a reading is judged."""

import re
from collections.abc import Callable
from pathlib import Path

import control
import numpy as np
import pytest
from scipy.optimize import curve_fit

from labsid._arrays import FloatArray
from labsid.checks.assignments.step_response import ASSIGNMENT
from labsid.checks.assignments.step_response.example_step import _recorded, _trial_steps
from labsid.checks.assignments.step_response.readings import Step, judge_reading
from labsid.rig import make_empty_start_record, write_lab_record

NAME = "step-response"
SECRET = b"a secret of the tests"
QUESTIONS = [question.id for question in ASSIGNMENT.questions]
SEEDS = range(40)

Reading = tuple[float, float, float]
Reader = Callable[[FloatArray, FloatArray, float], Reading]


def test_the_mean_over_a_first_period_that_has_not_settled_is_named(tmp_path: Path, run_notebook) -> None:
    path = tmp_path / "empty.mat"
    write_lab_record(path, make_empty_start_record())
    code = (
        "first, second = np.flatnonzero(np.diff(u_act))[:2] + 1\n"
        "t_held = t_act[first:second] - t_act[first]\n"
        "y_held = y_act[first:second] - y_act[:first].mean()\n"
        "a_held = u_act[first] - u_act[0]\n"
    )
    said = run_notebook(NAME, path, {"step-6-cut-answer": code})
    assert "is not settled at first" in said["step-6-cut"]


def test_every_check_of_an_empty_release_fails_kindly(shipped_record_path: Path, run_notebook) -> None:
    said = run_notebook(NAME, shipped_record_path, release=True)
    assert list(said) == QUESTIONS
    for question, text in said.items():
        assert re.match(rf"{question}:", text), text
        assert "Error" not in text


def test_the_recorded_response_is_the_one_that_the_notebook_makes() -> None:
    t, y = _recorded()
    simulated = control.forced_response(control.tf([3], [5, 6, 1]), t, np.full(t.size, 2.0)).outputs
    np.testing.assert_allclose(y, simulated, atol=1e-9)


def crossing(t: FloatArray, way: FloatArray, level: float) -> float:
    return float(t[np.argmax(way >= level)])


def way_of(y: FloatArray) -> tuple[float, FloatArray]:
    change = float(np.mean(y[-len(y) // 10 :]) - y[0])
    return change, (y - y[0]) / change


def two_instants(t: FloatArray, y: FloatArray, a: float) -> Reading:
    change, way = way_of(y)
    tau = 1.5 * (crossing(t, way, 0.632) - crossing(t, way, 0.283))
    return change / a, tau, crossing(t, way, 0.632) - tau


def departure(level: float) -> Reader:
    def reader(t: FloatArray, y: FloatArray, a: float) -> Reading:
        change, way = way_of(y)
        td = crossing(t, way, level)
        return change / a, crossing(t, way, 0.632) - td, td

    return reader


def fitted(t: FloatArray, y: FloatArray, a: float) -> Reading:
    def model(t: FloatArray, K: float, tau: float, td: float, start: float) -> FloatArray:
        return start + K * a * (1 - np.exp(-np.maximum(t - td, 0) / tau))

    found, _ = curve_fit(model, t, y, [(y[-1] - y[0]) / a, t[-1] / 8, t[-1] / 20, y[0]])
    return tuple(found[:3])


def straight_line(t: FloatArray, y: FloatArray, a: float) -> Reading:
    change, way = way_of(y)
    used = (way > 0.1) & (way < 0.9)
    slope, at_zero = np.polyfit(t[used], np.log(1 - way[used]), 1)
    return change / a, -1 / slope, -at_zero / slope


def tangent_for_the_delay(t: FloatArray, y: FloatArray, a: float) -> Reading:
    change, way = way_of(y)
    slope = np.gradient(way, t)
    k = int(np.argmax(slope))
    td = float(t[k] - way[k] / slope[k])
    return change / a, crossing(t, way, 0.632) - td, td


@pytest.mark.parametrize(
    "reader",
    [two_instants, departure(0.02), departure(0.03), departure(0.05), fitted, straight_line, tangent_for_the_delay],
)
def test_every_fair_way_of_reading_passes(reader: Reader) -> None:
    for seed in SEEDS:
        for step in _trial_steps(np.random.default_rng(seed)):
            verdict = judge_reading(np.array(reader(step.t, step.y, step.amplitude)), step, "", "")
            assert verdict.passed, (seed, verdict.reason)


def spoilt(change: Callable[[Reading, Step], Reading]) -> Reader:
    def reader(t: FloatArray, y: FloatArray, a: float) -> Reading:
        return change(two_instants(t, y, a), Step(t, y, a, 0.0))

    return reader


@pytest.mark.parametrize(
    ("reader", "slip"),
    [
        (spoilt(lambda r, s: (r[0] * s.amplitude, r[1], r[2])), "amplitude not divided out"),
        (spoilt(lambda r, s: (r[0] * np.sign(s.amplitude), r[1], r[2])), "sign of the gain"),
        (spoilt(lambda r, s: (s.y[-1] / s.amplitude, r[1], r[2])), "initial level left in"),
        (spoilt(lambda r, s: (r[0], s.t[np.argmax(s.y >= 0.632 * s.y[-1])] - r[2], r[2])), "initial level left in"),
        (spoilt(lambda r, s: (0.632 * r[0], r[1], r[2])), "63.2 % taken for the end"),
        (spoilt(lambda r, s: (r[0], r[1] + r[2], r[2])), "tau measured from the step"),
        (spoilt(lambda r, s: (r[0], r[1] + r[2], 0.0)), "no delay"),
        (spoilt(lambda r, s: (r[0], r[1], -r[2])), "delay with the wrong sign"),
        (spoilt(lambda r, s: (r[0], r[1], r[1] + r[2])), "63.2 % taken for the delay"),
        (spoilt(lambda r, s: (r[0], 3 * r[1], r[2])), "settling time in place of the time constant"),
        (spoilt(lambda r, s: (r[0], r[1] / 1.5, r[1] / 3 + r[2])), "the factor 3/2 forgotten"),
        (spoilt(lambda r, s: (r[0], 1 / r[1], r[2])), "time constant inverted"),
        (spoilt(lambda r, s: (r[0], r[1] / s.t[1], r[2] / s.t[1])), "time in samples"),
    ],
)
def test_a_slip_is_named_whatever_the_trial(reader: Reader, slip: str) -> None:
    for seed in SEEDS:
        verdicts = (
            judge_reading(np.array(reader(step.t, step.y, step.amplitude)), step, "", "")
            for step in _trial_steps(np.random.default_rng(seed))
        )
        first = next(verdict for verdict in verdicts if not verdict.passed)
        assert first.slip == slip, (seed, first.reason)


def test_what_is_off_is_said_where_no_slip_is_known() -> None:
    t, y = _recorded()
    step = Step(t, y, 2.0, 0.02)
    for reading, says in (
        ((2.5, 5.3, 0.8), "K is not the change of the output"),
        ((3.0, -3.0, 0.8), "tau is not positive"),
        ((3.0, 7.5, 0.8), "63.2 % at 8.3 s, too late"),
        ((3.0, 4.0, 0.8), "63.2 % at 4.8 s, too early"),
    ):
        assert says in judge_reading(np.array(reading), step, "", "").reason


def test_a_function_that_gives_one_answer_for_all_steps_earns_nothing(shipped_record_path: Path, run_notebook) -> None:
    answers = {
        "step-5-function-answer": "def read_step(t, y, amplitude):\n    return 1.0, 2.0, 3.0\n",
        "step-2-response-answer": "def first_order_response(t, K, tau, td, amplitude):\n    return np.zeros(len(t))\n",
    }
    said = run_notebook(NAME, shipped_record_path, answers)
    failed = {"step-2-response", "step-3-mse", "step-3-figure", "step-5-function", "step-6-model"}
    assert {question for question, text in said.items() if text} == failed
    assert said["step-3-figure"].startswith("step-3-figure: it starts from step-3-mse")


@pytest.mark.parametrize("answer", ["'yes'", "[True, False]", "2.5"])
def test_is_unique_has_to_say_true_or_false(answer: str, shipped_record_path: Path, run_notebook) -> None:
    said = run_notebook(
        NAME, shipped_record_path, {"step-9-unique-answer": f"def is_unique(Phi):\n    return {answer}"}
    )
    assert "should return True or False" in said["step-9-unique"]
