"""A command that is logged with noise: its levels act, and no limit of the command is taken for them."""

import numpy as np
import pytest
from gap_search import searched
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.signal import lfilter

from labsid import Record
from labsid.gap.diagnosis import diagnose
from labsid.gap.fits.noisy_command import levels_behind_noise, with_levels

pytestmark = pytest.mark.usefixtures("without_limits")

TS = 0.1


def _two_levels(rng: np.random.Generator, samples: int = 1200, hold: int = 20) -> np.ndarray:
    return np.repeat(rng.integers(0, 2, samples // hold) * 10.0, hold)


def _record(rng: np.random.Generator, noise: float, acts: bool) -> tuple[Record, np.ndarray]:
    """A first-order rig under two levels that are logged with noise, and the levels."""
    levels = _two_levels(rng)
    logged = levels + noise * rng.standard_normal(levels.size)
    y = lfilter([0.0, 0.2], [1.0, -0.9], logged if acts else levels) + 0.05 * rng.standard_normal(levels.size)
    return Record(np.arange(levels.size) * TS, logged, y, TS), levels


def test_levels_are_used_where_the_rig_followed_them():
    record, levels = _record(np.random.default_rng(0), 0.5, acts=False)
    cleaned, notes = with_levels(record)
    assert np.abs(cleaned.u - levels).max() < 0.1
    assert "noise of the log" in notes[0]
    assert f"noise of {np.std(record.u - levels):.2g} rms" in notes[0]


def test_noise_that_acts_stays_in_the_input():
    record, _ = _record(np.random.default_rng(0), 0.5, acts=True)
    cleaned, notes = with_levels(record)
    assert cleaned is record
    assert not notes


def test_noise_that_acts_at_once_stays_in_the_input():
    rng = np.random.default_rng(1)
    logged = _two_levels(rng) + 0.5 * rng.standard_normal(1200)
    record = Record(np.arange(1200) * TS, logged, 2.0 * logged + 0.1 * rng.standard_normal(1200), TS)
    assert with_levels(record)[0] is record


@pytest.mark.parametrize(
    "u",
    [
        np.sin(0.05 * np.arange(1000)),
        np.sin(0.05 * np.arange(1000)) + 0.05 * np.random.default_rng(0).standard_normal(1000),
        np.linspace(0.0, 10.0, 1000) + 0.2 * np.random.default_rng(0).standard_normal(1000),
        np.random.default_rng(0).standard_normal(1000),
        np.repeat([0.0, 5.0] * 10, 50),
        lfilter([0.3], [1.0, -0.7], np.repeat([0.0, 5.0] * 10, 50))
        + 0.1 * np.random.default_rng(0).standard_normal(1000),
        np.repeat([0.0, 5.0] * 10, 50) + lfilter([0.1], [1.0, -0.9], np.random.default_rng(0).standard_normal(1000)),
    ],
    ids=["sine", "sine-and-noise", "ramp", "white", "exact", "filtered-levels", "slow-noise"],
)
def test_other_inputs_have_no_levels(u: np.ndarray):
    assert levels_behind_noise(u) is None


@settings(deadline=None, max_examples=30)
@given(seed=st.integers(0, 10**6), scale=st.floats(1e-6, 1e6), offset=st.floats(-1e3, 1e3))
def test_units_do_not_matter(seed: int, scale: float, offset: float):
    rng = np.random.default_rng(seed)
    u = _two_levels(rng) + 0.3 * rng.standard_normal(1200)
    levels, other = levels_behind_noise(u), levels_behind_noise(scale * (u + offset))
    assert (levels is None) == (other is None)
    if levels is not None and other is not None:
        np.testing.assert_allclose(other / scale - offset, levels, atol=1e-6)


@searched(
    "input-saturation", "input-dead-zone", "input-nonlinearity", "extra-lag", "output-saturation", "parameter-drift"
)
def test_no_limit_is_named_and_the_report_says_whose_noise_it_is():
    record, _ = _record(np.random.default_rng(3), 0.5, acts=False)
    report = diagnose(record).report
    assert report["verdict"] == "none"
    assert not report["effects"]
    assert any("noise of the log" in one for one in report["screen"])
