"""Which signal leads: found on plants of either kind, never claimed where it is not certain."""

import numpy as np
import pytest
from scipy.signal import chirp, lfilter
from scipy.stats import f

from labsid.records.direction import LAGS, feedback_statistic, gain_from_past, look_swapped


def plant(rng, u, delay=1, pole=0.9, noise=0.02):
    y = lfilter(np.r_[np.zeros(delay), 0.1], [1, -pole], u - u[0])
    return y + noise * np.std(y) * rng.standard_normal(y.size)


def test_white_noise_follows_the_f_distribution():
    """The oracle: independent signals give F(8, rows - 17), so its mean and its 95 % point are known."""
    rng = np.random.default_rng(3)
    rows = 200 - LAGS
    gains = np.array([gain_from_past(*rng.standard_normal((2, 200))) for _ in range(400)])
    law = f(LAGS, rows - 2 * LAGS - 1)
    assert np.mean(gains) == pytest.approx(law.mean(), abs=0.1)
    assert np.mean(gains > law.ppf(0.95)) == pytest.approx(0.05, abs=0.03)


def test_the_input_leads():
    rng = np.random.default_rng(4)
    u = np.repeat(rng.choice([1.6, 2.0, 2.2], 40), 20)
    y = plant(rng, u)
    assert gain_from_past(u, y) > 30
    assert gain_from_past(y, u) < 4
    assert gain_from_past(u[:39], y[:39]) == 0.0


def smooth_input(rng, lines, samples=800):
    """A sum of sinusoids; of no lines, a chirp."""
    k = np.arange(samples)
    if not lines:
        return chirp(k, 0.001, samples, rng.uniform(0.02, 0.2))
    waves = zip(rng.uniform(0.002, 0.08, lines), rng.uniform(0, 6, lines), strict=True)
    return sum(np.sin(2 * np.pi * f * k + phase) for f, phase in waves)


@pytest.mark.parametrize("noise", [0.0, 1e-4, 0.02])
@pytest.mark.parametrize("lines", [0, 6, 20])
def test_a_smooth_input_is_not_fed_back(lines, noise):
    """What it was is in the output, too, and helps to predict what it will be: the noise of the output does not."""
    alone = []
    for seed in range(8):
        rng = np.random.default_rng(seed)
        u = smooth_input(rng, lines)
        y = lfilter([0.8, -0.72], np.poly([rng.uniform(0.8, 0.98), rng.uniform(0.6, 0.95)]), u)
        y += noise * np.std(y) * rng.standard_normal(y.size)
        alone.append(gain_from_past(y, u))
        assert feedback_statistic(u, y) < 10
    assert max(alone) > 10


@pytest.mark.parametrize("seed", range(5))
def test_a_controller_is_seen_by_the_noise_that_it_passes_on(seed):
    """A PI controller with a filtered measurement: no linear law of a few samples gives its output."""
    rng = np.random.default_rng(seed)
    r, e = np.repeat([0.2, 1.0], 500), 0.05 * rng.standard_normal(1000)
    u, y, x, seen, integral = np.zeros(1000), np.zeros(1000), 0.0, 0.0, 0.0
    for k in range(1000):
        y[k] = x + e[k]
        seen = 0.5 * seen + 0.5 * y[k]
        integral += 0.1 * (r[k] - seen)
        u[k] = 2 * (r[k] - seen) + integral
        x = 0.9 * x + 0.1 * u[k]
    assert feedback_statistic(u, y) > 10


def test_exact_signals_do_not_divide_by_zero():
    u = np.repeat([0.0, 1.0, 0.0], 30)
    assert gain_from_past(u, np.zeros(90)) == 0.0
    assert gain_from_past(u, lfilter([0, 1.0], [1, -0.5], u)) > 30


@pytest.mark.parametrize("hold", [7, 30, 90])
def test_swapped_staircases_are_seen(hold):
    rng = np.random.default_rng(hold)
    u = np.repeat(rng.choice([1.6, 2.0, 2.2], 900 // hold), hold)
    y = plant(rng, u)
    assert look_swapped(y, u)
    assert not look_swapped(u, y)


@pytest.mark.parametrize("delay", [1, 4, 12])
@pytest.mark.parametrize("seed", range(10))
def test_a_coarse_output_is_no_command(seed, delay):
    """Few levels of y alone prove nothing: here the converter is coarse, and u a random signal or a multisine."""
    rng = np.random.default_rng(seed)
    k = np.arange(800)
    u = rng.standard_normal(k.size) if seed % 2 else np.sin(k / 9) + np.sin(k / 31 + seed)
    y = plant(rng, u, delay, noise=0.0)
    step = np.ptp(y) / 6
    assert not look_swapped(u, np.round(y / step) * step)
