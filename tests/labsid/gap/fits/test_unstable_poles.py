"""Rigs that fall without their controller: their poles, the feedback beside which they are simulated, the diagnosis."""

import json
from collections.abc import Callable
from functools import cache

import numpy as np
import pytest
from gap_reports import report as made_report
from gap_search import searched
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.linalg import solve_continuous_are
from scipy.signal import chirp, lfilter

from labsid import Record
from labsid.gap import diagnose
from labsid.gap.diagnosis import Diagnosis
from labsid.gap.effects.output_feedback import OutputFeedback
from labsid.gap.fits.unstable_poles import find_stabilising_feedback
from labsid.gap.model_file import from_json_dict
from labsid.gap.record.data import Data, scaled
from labsid.gap.reports.html_report import render_html

pytestmark = pytest.mark.usefixtures("without_limits")

TS, SUBSTEPS = 0.02, 8
FALL, DAMPING, FORCE = 4.0, 0.6, 7.0  # y'' = FALL y - DAMPING y' + FORCE v


def upright(
    actuator: Callable[[float], float] = float, friction: float = 0.0, samples: int = 1200, seed: int = 1
) -> Record:
    """An inverted pendulum near its upright position, held by a controller with a filtered derivative."""
    rng = np.random.default_rng(seed)
    r = np.repeat(rng.uniform(-0.3, 0.3, samples // 40 + 1), 40)[:samples]
    noise = 0.002 * rng.standard_normal(samples)
    u, y = np.empty(samples), np.empty(samples)
    angle = speed = slope = before = 0.0
    h = TS / SUBSTEPS
    for k in range(samples):
        y[k] = angle + noise[k]
        slope = 0.7 * slope + 0.3 * (y[k] - before) / TS
        before = y[k]
        u[k] = 3.0 * (r[k] - y[k]) - 0.6 * slope
        v = actuator(u[k])
        for _ in range(SUBSTEPS):
            pull = FALL * angle - DAMPING * speed + FORCE * v
            if abs(speed) < 1e-9 and abs(pull) <= friction:
                continue
            way = np.sign(speed) if abs(speed) >= 1e-9 else np.sign(pull)
            new = speed + h * (pull - friction * way)
            speed = 0.0 if friction and speed * new < 0.0 else new
            angle += h * speed
    return Record(TS * np.arange(samples), u, y, TS, name="upright")


def as_data(record: Record) -> Data:
    return scaled(record.u, record.y, np.ones(len(record), bool), record.Ts)


def found_in(record: Record) -> tuple[OutputFeedback, float]:
    found = find_stabilising_feedback(as_data(record))
    assert found is not None
    return found


def drifting_loop(seed: int) -> Record:
    """A stable first-order rig whose gain falls by 45 %, in the loop of a controller that follows ramps."""
    rng = np.random.default_rng(seed)
    samples, pole = 1200, np.exp(-1.0 / 38.0)
    turns = np.arange(0, samples + 70, 70)
    r = np.interp(np.arange(samples), turns, rng.uniform(-0.5, 0.9, turns.size))
    gain = np.linspace(1.0, 0.55, samples)
    noise = 0.003 * rng.standard_normal(samples)
    u, y = np.empty(samples), np.empty(samples)
    level = integral = before = 0.0
    for k in range(samples):
        y[k] = level + noise[k]
        error = r[k] - y[k]
        integral += 0.03 * error
        u[k] = 1.5 * error + integral + (3.0 * (error - before) if seed % 2 else 0.0)
        before = error
        level = pole * level + (1.0 - pole) * gain[k] * u[k]
    return Record(TS * np.arange(samples), u, y, TS)


@pytest.mark.parametrize("seed", range(6))
def test_a_gain_that_falls_in_a_loop_makes_no_rig_unstable(seed: int) -> None:
    assert find_stabilising_feedback(as_data(drifting_loop(seed))) is None


def test_the_poles_are_those_of_the_rig_and_the_feedback_is_the_regulator_of_least_energy() -> None:
    record = upright()
    feedback, gain = found_in(record)
    A, B = np.array([[0.0, 1.0], [FALL, -DAMPING]]), np.array([[0.0], [1.0]])
    P = solve_continuous_are(A, B, np.zeros((2, 2)), np.eye(1))
    closed = np.poly(np.linalg.eigvals(A - B @ B.T @ P))
    c, k = feedback.closed
    assert np.allclose([c / TS, k / TS**2], closed[1:], rtol=0.05)
    position, speed = (B.T @ P)[0]
    assert np.allclose([k * feedback.gains[0] / TS**2, k * feedback.gains[1] / TS], [position, speed], rtol=0.08)
    data = as_data(record)
    assert gain * k / TS**2 == pytest.approx(FORCE * data.u_scale.unit / data.y_scale.unit, rel=0.05)


@settings(max_examples=20, deadline=None)
@given(st.integers(0, 10_000), st.floats(0.05, 1.5), st.floats(0.3, 5.0), st.booleans())
def test_a_rig_that_does_not_fall_is_simulated_freely(seed: int, damping: float, rate: float, in_loop: bool) -> None:
    rng = np.random.default_rng(seed)
    samples = 800
    r = np.repeat(rng.standard_normal(samples // 40), 40)
    u, y = np.empty(samples), np.empty(samples)
    angle = speed = 0.0
    for k in range(samples):
        y[k] = angle + 0.01 * rng.standard_normal()
        u[k] = r[k] - 0.5 * in_loop * y[k]
        for _ in range(SUBSTEPS):
            speed += TS / SUBSTEPS * (rate**2 * (u[k] - angle) - 2.0 * damping * rate * speed)
            angle += TS / SUBSTEPS * speed
    assert find_stabilising_feedback(as_data(Record(TS * np.arange(samples), u, y, TS))) is None


def test_an_unstable_equation_without_a_controller_is_a_drift() -> None:
    rng = np.random.default_rng(5)
    u = np.repeat(rng.standard_normal(20), 40)
    t = np.linspace(0.0, 1.0, u.size)
    y = (
        np.convolve(u, np.exp(-np.arange(80) / 20.0) / 20.0)[: u.size]
        + np.exp(3.0 * t)
        + 0.01 * rng.standard_normal(u.size)
    )
    assert find_stabilising_feedback(scaled(u, y, np.ones(u.size, bool), 1.0)) is None


def dead_zone(u: float) -> float:
    return np.sign(u) * max(abs(u) - 0.15, 0.0)


@cache
def diagnosed(kind: str) -> Diagnosis:
    rigs: dict[str, Callable[[], Record]] = {
        "none": upright,
        "coulomb-friction": lambda: upright(friction=0.6),
        "input-dead-zone": lambda: upright(dead_zone),
    }
    with searched("input-delay", "input-dead-zone", "input-saturation", "coulomb-friction", "load-step"):
        return diagnose(rigs[kind]())


@pytest.mark.slow
@pytest.mark.parametrize(
    "kind", ["none", pytest.param("coulomb-friction", marks=pytest.mark.exhaustive), "input-dead-zone"]
)
def test_the_cause_in_an_unstable_rig_is_named(kind: str) -> None:
    report = diagnosed(kind).report
    named = [effect["name"] for effect in report["effects"] if effect["probability"] > 0.5]
    assert named == ([] if kind == "none" else [kind])
    assert report["gap"]["mode"] == "stabilised"
    assert report["gap"]["after"] < 1.15 * 0.002
    assert report["gap"]["corrected"] < 0.1
    assert "stability" in [finding["kind"] for finding in report["findings"]]
    assert report["reference"] == "outside"  # no unstable rig is among those on which probabilities were measured
    assert all(effect["probability"] < 0.9 for effect in report["effects"])
    assert report["replay"] is None
    json.dumps(report)


@pytest.mark.slow
@searched("input-dead-zone", "coulomb-friction")
def test_friction_beside_a_feedback_is_in_units_of_the_command() -> None:
    found = diagnose(upright(friction=0.6)).effects["coulomb-friction"]["friction"]
    assert found["unit"] == "u"
    assert found["value"] == pytest.approx(0.6 / FORCE, rel=0.1)


@pytest.mark.slow
def test_the_simulation_of_an_unstable_rig_needs_its_measured_output() -> None:
    record, model = upright(dead_zone), diagnosed("input-dead-zone").model
    read = from_json_dict(json.loads(json.dumps(model.to_json_dict())))
    error = record.y - read.simulate(record.u, record.y)
    assert np.std(error) < 1.15 * 0.002
    assert np.array_equal(read.simulate(record.u, record.y), model.simulate(record.u, record.y))
    with pytest.raises(ValueError, match=r"the rig is unstable: .* Give the measured output as well"):
        model.simulate(record.u)
    other = upright(dead_zone, seed=2)
    assert np.std(other.y - read.simulate(other.u, other.y)) < 1.3 * 0.002


@pytest.mark.slow
@searched("input-dead-zone", "coulomb-friction")
def test_a_second_run_of_an_unstable_rig_scores() -> None:
    report = diagnose(upright(dead_zone), holdout=upright(dead_zone, seed=3)).report
    assert [effect["name"] for effect in report["effects"]] == ["input-dead-zone"]
    assert report["gap"]["after"] < 1.3 * 0.002 < 0.5 * report["gap"]["before"]


@pytest.mark.slow
@searched("input-dead-zone", "coulomb-friction")
def test_the_exported_simulation_of_an_unstable_rig_has_no_gap() -> None:
    report = diagnose(upright(dead_zone), diagnosed("input-dead-zone").model.to_json_dict()).report
    assert report["verdict"] == "none"


@pytest.mark.slow
@pytest.mark.usefixtures("undrawn")
def test_the_page_of_an_unstable_rig_says_that_its_simulation_is_corrected() -> None:
    page = render_html(diagnosed("input-dead-zone").report)
    assert "a correction by its measured output" in page
    assert "free-running simulation, which receives" not in page
    assert "free-running simulation, which receives" in render_html(made_report("input-dead-zone"))


@pytest.mark.parametrize("noise", [0.0, 1e-3, 0.02])
@pytest.mark.parametrize("lines", [0, 6, 9, 20])
def test_a_stable_rig_with_a_direct_term_is_not_unstable(lines: int, noise: float) -> None:
    """A sum of sinusoids, or a chirp, is as smooth as the output, which therefore seems to come first."""
    k = np.arange(900)
    for seed in range(12):
        rng = np.random.default_rng(seed)
        waves = zip(rng.uniform(0.002, 0.08, lines), rng.uniform(0, 6, lines), strict=True)
        u = sum((np.sin(2 * np.pi * f * k + phase) for f, phase in waves), np.zeros(k.size))
        u = u if lines else chirp(k, 0.001, k.size, rng.uniform(0.02, 0.2))
        poles, zeros = np.exp(-1 / np.exp(rng.uniform(np.log(2), np.log(60), (2, 2))))
        y = lfilter(np.poly(zeros), np.poly(poles), u)
        y += noise * np.std(y) * rng.standard_normal(y.size)
        assert find_stabilising_feedback(scaled(u, y, np.ones(k.size, bool), 1.0)) is None


def test_past_its_end_the_feedback_holds_its_last_value() -> None:
    y = np.sin(np.arange(30) / 5.0)
    signal = OutputFeedback(gains=(2.0, 5.0), closed=(0.1, 0.01)).on(y).added(y.size + 5)
    assert np.all(signal[30:] == signal[29])
    assert signal[29] == pytest.approx(2.0 * y[-1])


def test_a_rig_whose_reading_stays_at_a_limit_is_not_shown_to_be_unstable() -> None:
    k = np.arange(1000)
    u = np.sin(2.0 * np.pi * (0.004 + 1e-5 * k) * k)
    y = np.clip(lfilter([0.0, 0.12], [1.0, -0.94], u) * 1.4, -0.8, 0.75)
    record = Record(0.05 * k, u, y + 0.0, 0.05)
    assert find_stabilising_feedback(as_data(record)) is None
