"""A controller is seen in what it does, and a designed input is not taken for one."""

from dataclasses import dataclass

import numpy as np
import pytest
from gap_search import searched
from hypothesis import assume, given
from hypothesis import strategies as st
from scipy.signal import lfilter

from labsid.gap.diagnosis import diagnose
from labsid.gap.record.controllers import find_control_law, has_controller, is_relay, switches_with_hysteresis
from labsid.gap.record.record_findings import about_controller
from labsid.gap.reports.text_report import format_report
from labsid.records.record import Record

pytestmark = pytest.mark.usefixtures("without_limits")


@dataclass(frozen=True)
class Loop:
    """A PI controller on a first-order rig."""

    kp: float = 2.0
    ki: float = 0.1
    noise: float = 0.02
    load: float = 0.0

    def run(self, reference: np.ndarray, seed: int = 0) -> tuple[np.ndarray, np.ndarray]:
        rng = np.random.default_rng(seed)
        u, y, state, total = np.zeros(reference.size), np.zeros(reference.size), 0.0, 0.0
        for k in range(reference.size):
            y[k] = state + self.noise * rng.standard_normal()
            total += self.ki * (reference[k] - y[k])
            u[k] = self.kp * (reference[k] - y[k]) + total
            state = 0.9 * state + 0.1 * (u[k] + (self.load if k > reference.size // 2 else 0.0))
        return u, y


def thermostat(samples: int = 900, seed: int = 0) -> tuple[np.ndarray, np.ndarray]:
    """On below 20, off above 21; outside it is warmer by day."""
    rng = np.random.default_rng(seed)
    u, y, state = np.zeros(samples), np.zeros(samples), 20.0
    for k in range(samples):
        y[k] = state + 0.02 * rng.standard_normal()
        u[k] = 1.0 if y[k] < 20.0 else 0.0 if y[k] > 21.0 else u[k - 1]
        outside = 5.0 + 4.0 * np.sin(2.0 * np.pi * k / samples)
        state += 0.01 * (outside + 30.0 * u[k] - state)
    return u, y


@pytest.mark.parametrize("ki", [0.0, 0.02, 0.3])
def test_the_law_of_a_controller_is_found(ki: float) -> None:
    reference = np.repeat([1.0, 2.0, 0.5, 1.5], 200)
    law = find_control_law(*Loop(ki=ki).run(reference))
    assert law is not None
    assert law.gain == pytest.approx(-(2.0 + ki), rel=1e-6)
    assert not law.has_constant_reference
    resting = find_control_law(*Loop(ki=ki).run(np.ones(800)))
    assert resting is not None
    assert resting.has_constant_reference


@given(seed=st.integers(0, 10**6), direct=st.floats(-2.0, 2.0), held=st.integers(1, 30), noise=st.floats(0.001, 0.2))
def test_a_designed_input_follows_no_law(seed: int, direct: float, held: int, noise: float) -> None:
    """Of a rig with dynamics, with or without a direct term of either sign, steps or noise at its input."""
    assume(abs(direct + 1.0) > 0.2)  # with hardly a static gain, and noise at its input, it obeys a law
    rng = np.random.default_rng(seed)
    u = np.repeat(rng.standard_normal(600 // held + 1), held)[:600]
    y = lfilter([0.0, 0.3], [1.0, -0.7], u) + direct * u
    y += noise * np.std(y) * rng.standard_normal(600)
    assert find_control_law(u, y) is None
    assert not switches_with_hysteresis(np.sign(u), y)


def test_an_inverting_amplifier_without_noise_is_no_controller() -> None:
    """It obeys the law of a P controller; its input, a sum of sinusoids, is designed."""
    t = np.arange(800)
    u = np.sin(0.05 * t) + np.sin(0.13 * t)
    assert find_control_law(u, -2.0 * u) is None


@pytest.mark.parametrize("digits", [6, 15])
def test_ramps_are_designed(digits: int) -> None:
    rng = np.random.default_rng(3)
    ends = np.cumsum(rng.integers(5, 15, 80))
    u = np.round(np.interp(np.arange(ends[-1]), ends, rng.uniform(-1, 1, ends.size)), digits)
    assert find_control_law(u, -2.0 * u) is None


def test_a_thermostat_is_seen() -> None:
    u, y = thermostat()
    assert switches_with_hysteresis(u, y)
    assert is_relay(u, y)
    assert has_controller(u, y)
    (finding,) = about_controller(u, y)
    assert "relay" in finding.text


@pytest.mark.parametrize("pole", [0.5, 0.9, 0.98])
@pytest.mark.parametrize("held", [1, 8, 25])
def test_a_random_switching_input_is_no_thermostat(pole: float, held: int) -> None:
    rng = np.random.default_rng(held)
    u = np.repeat(rng.choice([0.0, 1.0], 1200 // held + 1), held)[:1200]
    y = lfilter([0.0, 1.0 - pole], [1.0, -pole], u) + 0.02 * rng.standard_normal(1200)
    assert not switches_with_hysteresis(u, y)


@searched("parameter-drift", "output-drift", "load-step", "periodic-disturbance")
def test_the_wave_outside_is_named_where_a_thermostat_compensates_it() -> None:
    """It is larger than the whole output, which the thermostat holds; a drift of the rig is not taken for it."""
    u, y = thermostat()
    report = diagnose(Record(60.0 * np.arange(u.size), u, y, 60.0)).report
    (effect,) = report["effects"]
    assert effect["name"] in ("output-drift", "periodic-disturbance")
    assert not any("unstable" in text for text in report["screen"])


@searched("input-dead-zone", "parameter-drift", "output-drift", "load-step")
def test_a_regulated_record_is_unknown_and_says_why() -> None:
    """Its controller explains it to the last digit; that is not called a rig without a gap."""
    u, y = Loop().run(np.ones(500))
    report = diagnose(Record(0.1 * np.arange(500), u, y, 0.1)).report
    assert report["verdict"] == "unknown"
    assert report["effects"] == []
    assert "whose reference does not move" in " ".join(format_report(report).split())
    assert not any("direct feedthrough" in text for text in report["screen"])


@searched("input-saturation", "input-dead-zone", "coulomb-friction", "parameter-drift", "output-drift", "load-step")
def test_a_load_on_a_regulated_rig_is_named() -> None:
    u, y = Loop(load=-1.5).run(np.ones(500))
    report = diagnose(Record(0.1 * np.arange(500), u, y, 0.1)).report
    assert [effect["name"] for effect in report["effects"]] == ["load-step"]


@searched("input-dead-zone", "parameter-drift", "output-drift", "load-step")
def test_a_loop_whose_reference_moves_has_no_gap() -> None:
    u, y = Loop().run(np.repeat([1.0, 2.0, 0.5, 1.5, 0.8], 100))
    report = diagnose(Record(0.1 * np.arange(500), u, y, 0.1)).report
    assert report["verdict"] == "none"
    assert report["noise"]["sd"] == pytest.approx(0.02, rel=0.2)
