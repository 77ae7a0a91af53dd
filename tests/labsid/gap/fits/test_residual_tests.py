"""Residual measures: white or coloured noise is accepted, dependence on the past input is not."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from gap_search import searched
from scipy.signal import lfilter
from scipy.stats import kurtosis

from labsid._arrays import FloatArray
from labsid.gap.diagnosis import diagnose
from labsid.gap.effects import output
from labsid.gap.fits.fitting import Fit, finish, minimize
from labsid.gap.fits.hypothesis import Hypothesis
from labsid.gap.fits.linear_fits import fit_baseline
from labsid.gap.fits.noise_model import fit_noise
from labsid.gap.fits.residual_tests import (
    comes_and_goes,
    explained_share,
    input_history,
    is_noise,
    measure_residual,
    nonlinear_features,
    repeatability,
    slow_autocorrelation,
)
from labsid.gap.record.data import Data, complete_rows, scaled
from labsid.records.record import Record

pytestmark = pytest.mark.usefixtures("without_limits")

Fitted = Callable[[FloatArray], tuple[Data, Fit]]


@pytest.fixture(scope="module")
def fitted(levels: FloatArray, two_poles: Callable[..., FloatArray]) -> Fitted:
    """The linear structure fitted to two poles plus something, in units of the output's spread."""
    u = np.concatenate([levels, levels[::-1]])[:800]
    y = two_poles(u)

    def made(something: FloatArray) -> tuple[Data, Fit]:
        data = scaled(u, y + y.std() * something[: u.size], np.ones(u.size, bool), 1.0)
        return data, fit_baseline(data)

    return made


def noise(pole: float, seed: int, size: float = 0.1) -> FloatArray:
    """Autoregressive noise of a given standard deviation."""
    e = lfilter([1.0], [1.0, -pole], np.random.default_rng(seed).standard_normal(900))[100:]
    return size * e / e.std()


@pytest.mark.parametrize("pole", [0.0, 0.5, 0.8])
@pytest.mark.parametrize("seed", [1, 2, 3])
def test_coloured_noise_is_accepted_as_noise(fitted: Fitted, pole: float, seed: int) -> None:
    left = measure_residual(*fitted(noise(pole, seed)))
    assert is_noise(left, converted=False)
    assert left.rms == pytest.approx(0.1, rel=0.15)
    assert left.colour == pytest.approx(1.0 / np.sqrt(1.0 - pole**2), rel=0.15)
    assert left.slow == pytest.approx(pole**6, abs=0.2)
    assert left.tails == pytest.approx(3.0, abs=0.8)


@pytest.mark.parametrize("turn", [0.4, 0.9])
def test_noise_that_swings_is_slow_although_it_is_nought_at_one_lag(turn: float) -> None:
    """Autocorrelation of a narrow band: a slowly fading cosine, of either sign."""
    fade = 0.98
    e = lfilter([1.0], [1.0, -2.0 * fade * np.cos(turn), fade**2], np.random.default_rng(3).standard_normal(9000))[
        1000:
    ]
    rows = np.ones(e.size, bool)
    lags = np.arange(6, 25)
    expected = np.abs([np.mean(e[lag:] * e[:-lag]) / np.mean(e**2) for lag in lags]).max()
    assert slow_autocorrelation(e, rows) == pytest.approx(expected, rel=1e-3)
    assert slow_autocorrelation(e, rows) > 0.6
    assert np.abs(fade**lags * np.cos(turn * lags)).max() == pytest.approx(expected, abs=0.08)


def test_white_noise_and_noise_that_forgets_itself_are_not_slow() -> None:
    rng = np.random.default_rng(5)
    rows = np.ones(4000, bool)
    for pole in (0.0, 0.7):
        assert slow_autocorrelation(lfilter([1.0], [1.0, -pole], rng.standard_normal(4000)), rows) < 0.15
    assert slow_autocorrelation(lfilter([1.0], [1.0, -0.95], rng.standard_normal(4000)), rows) > 0.3


def test_rows_that_do_not_count_have_no_part_in_the_slowness() -> None:
    e = np.random.default_rng(5).standard_normal(2000)
    rows = np.ones(2000, bool)
    rows[300:900] = False
    still = slow_autocorrelation(e, rows)
    e[300:900] += 20.0
    assert slow_autocorrelation(e, rows) == still
    assert slow_autocorrelation(e[:100], np.ones(100, bool)) == 0.0  # too few pairs


def test_colour_compares_power_and_innovations_on_the_same_rows(fitted: Fitted) -> None:
    """White noise that is loud where no rows count has no colour."""
    data, fit = fitted(noise(0.0, 1) * np.where(np.arange(800) < 400, 1.0, 8.0))
    quiet = replace(data, rows=np.arange(800) < 400)
    assert measure_residual(quiet, fit).colour == pytest.approx(1.0, abs=0.12)
    assert measure_residual(data, fit).colour == pytest.approx(1.0, abs=0.12)


def test_a_function_of_the_past_of_the_input_is_no_noise(fitted: Fitted, levels: FloatArray) -> None:
    """The square of a filtered input, which two poles cannot give."""
    u = np.concatenate([levels, levels[::-1]])[:800]
    state = lfilter([0.2], [1.0, -0.8], u)
    data, fit = fitted(0.3 * state**2 + noise(0.0, 1, 0.03))
    left = measure_residual(data, fit)
    assert not is_noise(left, converted=False)
    assert left.explained > 0.5
    assert left.repeats > 0.3
    assert left.repeats_z > 4.0


def test_noise_that_grows_with_the_input_is_no_noise(fitted: Fitted, levels: FloatArray) -> None:
    u = np.concatenate([levels, levels[::-1]])[:800]
    left = measure_residual(*fitted(noise(0.0, 1, 0.1) * np.where(u > 0.3, 5.0, 0.2)))
    assert left.activity > 0.2
    assert left.activity_z > 4.0
    assert not is_noise(left, converted=False)


def test_tails_are_those_of_the_innovations(fitted: Fitted) -> None:
    e = np.random.default_rng(4).standard_t(3, 800) * 0.1
    data, fit = fitted(e)
    left = measure_residual(data, fit)
    assert left.tails > 4.5
    white = (data.y - fit.output)[data.complete]
    if fit.noise.ar.size == 0:
        assert left.tails == pytest.approx(kurtosis(white, fisher=False), rel=0.05)


@pytest.mark.parametrize(
    "worse",
    [{"repeats": 0.5, "repeats_z": 9.0}, {"explained": 0.6}, {"activity": 0.5, "activity_z": 9.0}, {"tails": 9.0}],
)
def test_every_measure_counts_unless_quantization_explains_it(fitted: Fitted, worse: dict[str, float]) -> None:
    """The quantization error repeats with the input."""
    left = measure_residual(*fitted(noise(0.0, 1)))
    assert is_noise(left, converted=False)
    assert not is_noise(replace(left, **worse), converted=False)
    assert is_noise(replace(left, **worse), converted=True)


def test_features_exclude_the_input_of_the_same_sample(fitted: Fitted) -> None:
    """The present input cannot act yet, and in a loop it depends on the noise."""
    data, fit = fitted(noise(0.0, 5))
    u = data.u.copy()
    u[400] += 3.0
    other = replace(data, u=u)
    for told in (nonlinear_features, input_history):
        before, after = told(data, fit), told(other, fit)
        np.testing.assert_array_equal(before[:401], after[:401])
        assert np.all(np.any(before[401:403] != after[401:403], axis=1))


def test_explained_share_is_that_of_unseen_blocks(fitted: Fitted) -> None:
    data, fit = fitted(noise(0.0, 5))
    share = explained_share(data, fit, data.y - fit.output)
    assert share < 0.02
    X = nonlinear_features(data, fit)
    e = X @ np.random.default_rng(1).standard_normal(X.shape[1])
    assert explained_share(data, fit, e) > 0.9
    half = explained_share(data, fit, e + e.std() * np.random.default_rng(2).standard_normal(e.size))
    assert half == pytest.approx(0.5, abs=0.12)


def test_repetition_sees_any_function_of_the_pasts(fitted: Fitted) -> None:
    """Also of a discontinuous function: the sign of the last change of the input."""
    data, fit = fitted(noise(0.0, 5))
    moved = np.sign(input_history(data, fit)[:, -1])
    value, z = repeatability(data, fit, moved + 0.2 * np.random.default_rng(1).standard_normal(data.samples))
    assert value > 0.5
    assert z > 4.0
    value, z = repeatability(data, fit, np.random.default_rng(6).standard_normal(data.samples))
    assert abs(value) < 0.12
    assert abs(z) < 3.5


def clipped(levels: FloatArray, two_poles: Callable[..., FloatArray], pole: float, share: float) -> tuple[Data, Fit]:
    """Noise ahead of a sensor that clips so much of the record, and the fit that knows it."""
    u = np.concatenate([levels, levels[::-1]])[:800]
    z = two_poles(u)
    high = np.quantile(z, 1.0 - share)
    data = scaled(u, np.minimum(z + z.std() * noise(pole, 1), high), np.ones(u.size, bool), 1.0)
    hypothesis = Hypothesis((output.Saturation("high"),))
    numbers = {
        "log_c": np.log(0.5),
        "log_k": np.log(0.05),
        "high": (float(high) - data.y_scale.centre) / data.y_scale.unit,
    }
    theta = np.array([numbers.get(p.name, 0.0) for p in hypothesis.parameters])
    point = minimize(data, hypothesis, theta)
    assert point is not None
    return data, finish(data, hypothesis, point)


@pytest.mark.parametrize("pole", [0.0, 0.6, 0.85])
def test_noise_is_measured_off_the_stops_of_the_sensor(
    levels: FloatArray, two_poles: Callable[..., FloatArray], pole: float
) -> None:
    """At the limits the noise is hidden, which would look like heavy tails and dependence on the input."""
    data, fit = clipped(levels, two_poles, pole, 0.3)
    left = measure_residual(data, fit)
    assert left.tails == pytest.approx(3.0, abs=0.5)
    assert left.activity < 0.08
    assert is_noise(left, converted=False)
    everywhere = kurtosis((data.y - fit.output)[data.complete], fisher=False)
    assert everywhere > left.tails + 0.5


def test_every_row_counts_if_the_sensor_is_mostly_at_its_limit(
    levels: FloatArray, two_poles: Callable[..., FloatArray]
) -> None:
    data, fit = clipped(levels, two_poles, 0.0, 0.8)
    assert np.mean(fit.output < fit.output.max()) < 0.3
    assert measure_residual(data, fit).rms == pytest.approx(np.sqrt(np.mean((data.y - fit.output) ** 2)))


def test_no_residual_at_all_is_explained_by_nothing(fitted: Fitted) -> None:
    """As on a record without noise, which a model can fit exactly."""
    data, fit = fitted(np.zeros(900))
    nothing = np.zeros(data.y.size)
    assert explained_share(data, fit, nothing) == 0.0
    assert slow_autocorrelation(nothing, data.complete) == 0.0


@pytest.mark.parametrize("pole", [0.0, 0.6, 0.94, 0.99])
def test_gaussian_noise_does_not_come_and_go(pole: float) -> None:
    drawn = np.random.default_rng(0).standard_normal((200, 1200))
    called = [
        comes_and_goes(e, fit_noise(e, complete_rows(np.ones(e.size, bool)))) for e in lfilter([1], [1, -pole], drawn)
    ]
    assert sum(called) <= 2


@searched("output-drift", "output-nonlinearity", "load-step", "parameter-drift", "periodic-disturbance")
def test_bumps_at_the_sensor_come_and_go_and_are_no_coloured_noise(fitted: Fitted) -> None:
    bump = 0.4 * np.sin(np.linspace(0.0, np.pi, 25))
    something = 0.02 * np.random.default_rng(1).standard_normal(800)
    for start, sign in ((90, 1), (210, 1), (400, -1), (530, 1), (660, 1)):
        something[start : start + 25] += sign * bump
    data, fit = fitted(something)
    assert comes_and_goes(data.y - fit.output, fit.noise)
    assert not is_noise(measure_residual(data, fit), converted=False)
    record = Record(np.arange(800.0), data.u, data.y, 1.0)
    assert [effect["name"] for effect in diagnose(record).report["effects"] if effect["probability"] > 0.5] == []
