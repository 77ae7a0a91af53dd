"""A direct term is told from a pole without a model of the dynamics, whatever the input; in a loop nothing is said."""

import numpy as np
import pytest
from gap_search import searched
from hypothesis import given
from hypothesis import strategies as st
from scipy.signal import cont2discrete, lfilter

from labsid._arrays import FloatArray
from labsid.gap.diagnosis import diagnose
from labsid.gap.fits.direct_term import estimate_direct_term, innovations
from labsid.gap.record.data import Data, scaled
from labsid.records.record import Record

pytestmark = pytest.mark.usefixtures("without_limits")

TS = 0.1  # s
RIGS = {  # numerator and denominator in s, and whether the output responds within the sample
    "gain": ([1.5], [1.0], True),
    "lead": ([2.0, 1.0], [0.7, 1.0], True),
    "washout": ([3.0, 0.0], [3.0, 1.0], True),
    "acceleration": ([2.0, 0.0, 0.0], [1.0, 0.8, 2.0], True),
    "lag": ([1.5], [0.7, 1.0], False),
    "two lags": ([1.5], [0.7, 1.7, 1.0], False),
    "mode": ([3.0], [1.0, 0.3, 4.0], False),
    "integrator": ([1.0], [1.0, 0.5, 0.0], False),
}


def data_of(u: FloatArray, y: FloatArray) -> Data:
    return scaled(u, y, np.ones(u.size, bool), TS)


def input_of(kind: str, rng: np.random.Generator, samples: int = 1200) -> FloatArray:
    if kind == "few steps":
        return np.repeat(rng.uniform(-1.0, 1.0, 6), samples // 6)
    if kind == "random":
        return np.repeat(rng.uniform(-1.0, 1.0, samples // 12), 12)
    t = np.arange(samples) * TS
    if kind == "chirp":
        return np.sin(0.05 * t + 0.004 * t**2)
    waves = rng.choice(np.arange(2, 40), 12, replace=False) / t[-1]
    return sum((np.cos(2.0 * np.pi * wave * t + rng.uniform(0.0, 6.0)) for wave in waves), np.zeros(samples))


def record_of(rig: str, kind: str, seed: int) -> tuple[FloatArray, FloatArray]:
    """Input, held between samples, and output with 1 % of noise."""
    rng = np.random.default_rng(seed)
    numerator, denominator, _ = RIGS[rig]
    u = input_of(kind, rng)
    b, a, _ = cont2discrete((numerator, denominator), TS, "zoh")
    y = lfilter(np.ravel(b), a, u)
    return u, y + 0.01 * np.std(y) * rng.standard_normal(u.size)


@pytest.mark.parametrize("rig", RIGS)
@pytest.mark.parametrize("kind", ["few steps", "random"])
def test_an_input_that_jumps_shows_whether_there_is_a_direct_term(rig: str, kind: str) -> None:
    terms = [estimate_direct_term(data_of(*record_of(rig, kind, seed))) for seed in range(5)]
    assert all(term.decides for term in terms)
    assert [term.present for term in terms] == [RIGS[rig][2]] * 5


@pytest.mark.parametrize("rig", RIGS)
@pytest.mark.parametrize("kind", ["chirp", "multisine"])
def test_a_smooth_input_decides_nothing(rig: str, kind: str) -> None:
    assert not estimate_direct_term(data_of(*record_of(rig, kind, 1))).decides


@given(gain=st.floats(-5.0, 5.0), seed=st.integers(0, 50))
def test_the_term_is_the_gain_within_the_sample(gain: float, seed: int) -> None:
    u, y = record_of("lag", "random", seed)
    data = data_of(u, y + gain * u)
    term = estimate_direct_term(data)
    expected = gain * data.u_scale.unit / data.y_scale.unit
    assert term.value == pytest.approx(expected, abs=5.0 * term.stderr)


@pytest.mark.parametrize("noise", [0.02, 0.1])
def test_a_controller_that_responds_to_the_sample_is_no_direct_term(noise: float) -> None:
    rng = np.random.default_rng(5)
    u, y = np.zeros(800), np.zeros(800)
    wanted, state = np.repeat(rng.uniform(-1.0, 1.0, 80), 10), 0.0
    for k, e in enumerate(noise * rng.standard_normal(u.size)):
        y[k] = state + e
        u[k] = 4.0 * (wanted[k] - y[k])
        state = 0.9 * state + 0.1 * u[k]
    assert not estimate_direct_term(data_of(u, y)).present


def test_a_term_below_the_noise_is_not_claimed() -> None:
    u, y = record_of("lag", "random", 3)
    y = y + 0.001 * u + 0.1 * np.random.default_rng(0).standard_normal(u.size)
    assert not estimate_direct_term(data_of(u, y)).present


def test_a_record_shorter_than_the_regressors_says_nothing() -> None:
    u, y = record_of("lag", "random", 3)
    data = data_of(u[:30], y[:30])
    assert innovations(data)[2] == 0
    assert not estimate_direct_term(data).decides


@pytest.mark.slow
@pytest.mark.parametrize(
    ("rig", "kind"),
    [
        ("gain", "chirp"),
        pytest.param("lead", "multisine", marks=pytest.mark.exhaustive),
        ("washout", "few steps"),
        pytest.param("acceleration", "chirp", marks=pytest.mark.exhaustive),
    ],
)
@searched("input-delay", "extra-lag", "resonance", "slow-mode", "input-nonlinearity", "output-drift")
def test_a_direct_term_is_no_effect(rig: str, kind: str) -> None:
    u, y = record_of(rig, kind, 7)
    report = diagnose(Record(np.arange(u.size) * TS, u, y, TS)).report
    assert report["verdict"] == "none"
    said = [text for text in report["screen"] if "within the sample" in text]
    assert len(said) == 1
    assert kind != "few steps" or "has a direct feedthrough" in said[0]
