"""Linear rigs of higher order have lags; they neither swing nor have a rate limit."""

import numpy as np
import pytest
from gap_search import searched
from scipy.signal import butter, lfilter

from labsid._arrays import FloatArray
from labsid.gap.diagnosis import diagnose
from labsid.records.record import Record

pytestmark = pytest.mark.usefixtures("without_limits")


def rod(u: FloatArray) -> FloatArray:
    """Temperature at the far end of a heated rod of 20 elements."""
    state, y = np.zeros(20), np.zeros(u.size)
    for k in range(u.size):
        y[k] = state[-1]
        for _ in range(10):
            flow = 0.5 * np.diff(state)
            state = state + 0.3 * (np.append(flow, 0.0) - np.append(0.0, flow))
            state[0] += 0.03 * u[k]
            state *= 0.9995
    return y


def moving_mean(u: FloatArray) -> FloatArray:
    return lfilter(np.ones(9) / 9.0, [1.0], lfilter([0.0, 0.1], [1.0, -0.9], u))


def filtered(u: FloatArray) -> FloatArray:
    return lfilter(*butter(4, 0.06), np.append(0.0, u[:-1]))


@pytest.mark.parametrize("rig", [pytest.param(rod, marks=pytest.mark.exhaustive), moving_mean, filtered])
@searched("input-delay", "input-rate-limit", "extra-lag", "resonance", "slow-mode", "output-drift", "output-backlash")
def test_lags_are_named_or_nothing_is(rig) -> None:
    """The command switches between two values."""
    rng = np.random.default_rng(3)
    u = np.repeat(rng.choice([0.0, 1.0], 90), 15)
    y = rig(u)
    y += 0.01 * np.std(y) * rng.standard_normal(u.size)
    report = diagnose(Record(0.1 * np.arange(u.size), u, y, 0.1)).report
    likely = {effect["name"] for effect in report["effects"] if effect["probability"] > 0.5}
    assert likely <= {"extra-lag", "input-delay", "slow-mode"}


@searched("parameter-drift", "output-drift", "load-step", "output-nonlinearity")
def test_a_drift_of_the_gain_alone_has_no_drift_of_the_sensor_beside_it() -> None:
    """Its neutral input is no command, far from the mean."""
    rng = np.random.default_rng(0)
    u = np.repeat(rng.uniform(1.0, 5.0, 60), 20)
    y = (
        np.linspace(1.0, 0.7, u.size) * lfilter([0.0, 0.15], [1.0, -0.85], u - u[0])
        + np.linspace(1.0, 0.7, u.size) * u[0]
    )
    report = diagnose(Record(0.1 * np.arange(u.size), u, y + 0.01 * rng.standard_normal(u.size), 0.1)).report
    (effect,) = report["effects"]
    assert effect["name"] == "parameter-drift"
    assert effect["parameters"]["drift"]["value"] == pytest.approx(-0.3, abs=0.02)
