"""Digits of printed numbers are found, and exact records get noise of that size, others none."""

import numpy as np
import pytest
from gap_search import searched
from hypothesis import given
from hypothesis import strategies as st
from representatives import mostly_exhaustive
from scipy.signal import lfilter

from labsid._arrays import FloatArray
from labsid.gap.diagnosis import diagnose
from labsid.gap.fits.floor import SIMULATION_ERROR, digit_step, is_printed, with_floor
from labsid.gap.record.data import scaled
from labsid.records.record import Record

pytestmark = pytest.mark.usefixtures("without_limits")

FEW = (
    "input-delay",
    "input-dead-zone",
    "input-nonlinearity",
    "input-quantization",
    "extra-lag",
    "resonance",
    "output-nonlinearity",
    "output-drift",
)
"""What digits may be taken for."""


def exact(seed: int = 0, delay: int = 0) -> tuple[FloatArray, FloatArray]:
    """A rig of two poles without noise."""
    rng = np.random.default_rng(seed)
    u = np.repeat(rng.uniform(-1.0, 1.0, 60), 20)
    late = np.concatenate([np.full(delay, u[0]), u[: u.size - delay]])
    return u, lfilter([0.0, 0.02, 0.018], [1.0, -1.7, 0.738], late)


def printed(values: FloatArray, form: str) -> FloatArray:
    return np.array([float(form % value) for value in values])


@pytest.mark.parametrize(
    ("form", "step"), [("%.2f", 1e-2), ("%.5f", 1e-5), ("%.3e", None), ("%.6g", None), ("%d", 1.0)]
)
def test_the_step_of_printed_digits(form: str, step: float | None) -> None:
    values = printed(250.0 * np.random.default_rng(1).standard_normal(2000), form)
    if step is None:  # relative: that of each number's last digit
        digits = 4 if form == "%.3e" else 6
        step = float(np.sqrt(np.mean(10.0 ** (2.0 * (np.floor(np.log10(np.abs(values))) - digits + 1)))))
    assert digit_step(values) == pytest.approx(step)


@pytest.mark.parametrize(
    "values", [np.random.default_rng(2).standard_normal(500), np.zeros(500), np.pi * np.arange(9.0)]
)
def test_numbers_that_are_not_printed_have_no_step(values: FloatArray) -> None:
    assert digit_step(values) == 0.0


@given(st.floats(1e-6, 1e6), st.integers(0, 1000))
def test_the_step_follows_the_unit(unit: float, seed: int) -> None:
    decade = 10.0 ** np.round(np.log10(unit))
    values = np.round(1e3 * np.random.default_rng(seed).standard_normal(300)) / 1e3
    assert digit_step(values * decade) == pytest.approx(1e-3 * decade, rel=1e-6)


def test_a_coarse_step_is_a_converter_and_a_fine_decimal_one_is_not() -> None:
    values = np.linspace(0.0, 1.0, 5001)
    assert is_printed(1e-4, values)
    assert not is_printed(1e-2, values)
    assert not is_printed(2.44e-4, values)  # 12 bits


def added(u: FloatArray, y: FloatArray) -> float:
    data = scaled(u, y, np.ones(u.size, bool), 0.1)
    return float(np.std(with_floor(data).y - data.y))


def test_an_exact_record_gets_noise_of_its_digits() -> None:
    u, y = exact()
    assert added(u, y) == pytest.approx(SIMULATION_ERROR, rel=0.1)
    four = added(u, printed(y, "%.3f"))
    assert 1e-3 < four * np.std(y) < 2e-3


def test_noise_of_the_record_itself_makes_digits_irrelevant() -> None:
    u, y = exact()
    noisy = printed(y + 0.02 * np.random.default_rng(3).standard_normal(y.size), "%.3f")
    assert added(u, noisy) == pytest.approx(SIMULATION_ERROR, rel=0.1)


@pytest.mark.slow
@pytest.mark.parametrize("form", mostly_exhaustive(["%.17g", "%.6g", "%.4g", "float32"], ["%.4g"]))
@pytest.mark.parametrize("rig", mostly_exhaustive(["two poles", "gain"], ["two poles"]))
@searched(*FEW)
def test_an_exact_record_has_no_gap(rig: str, form: str) -> None:
    u, y = exact(4)
    y = y if rig == "two poles" else -0.8 * u + 0.3
    y = y.astype(np.float32).astype(float) if form == "float32" else printed(y, form)
    report = diagnose(Record(np.arange(u.size) * 0.1, u, y, 0.1)).report
    assert report["verdict"] == "none"


@pytest.mark.slow
@searched(*FEW)
def test_a_delay_of_an_exact_record_is_found() -> None:
    u, y = exact(4, delay=5)
    report = diagnose(Record(np.arange(u.size) * 0.1, u, y, 0.1)).report
    (effect,) = report["effects"]
    assert effect["name"] == "input-delay"
    # A zero of the dynamics can stand for a part of a sample.
    assert effect["parameters"]["delay"]["value"] == pytest.approx(0.5, abs=0.1)


@pytest.mark.parametrize("gain", [-5.0, 16.0])
@searched(*FEW)
def test_the_digits_of_a_rig_that_responds_at_once_are_no_gap(gain: float) -> None:
    """A jump of the input that acts within the sample is no noise beside which digits do not matter."""
    rng = np.random.default_rng(4)
    u = printed(np.repeat(rng.uniform(-1.0, 1.0, 120), rng.integers(3, 12, 120)), "%.4g")
    y = printed(gain * u, "%.4g")
    assert diagnose(Record(0.5 * np.arange(u.size), u, y, 0.5)).report["verdict"] == "none"
