"""The closed share: by hand, on held-out samples, and its interval."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from scipy.signal import lfilter
from scipy.stats import chi2

from labsid._arrays import FloatArray
from labsid.gap.fits.fitting import Fit
from labsid.gap.record.holdout import held_out_samples
from labsid.gap.search.explanation import Explanation
from labsid.gap.verdict.held_out_errors import hold_out
from labsid.gap.verdict.scores import GapScore, _closure_interval, closed_share, noise_power, score_fits


@pytest.mark.parametrize(
    ("before", "after", "floor", "expected"),
    [
        (5.0, 1.0, 1.0, 1.0),  # down to the noise
        (5.0, 5.0, 1.0, 0.0),  # nothing
        (5.0, 2.0, 1.0, 0.5),  # half of the amplitude
        (5.0, 0.5, 1.0, 1.0),  # below the noise counts as the noise
        (5.0, 17.0, 1.0, -1.0),  # worse
        (1.0, 0.5, 1.0, None),  # no gap before
        (0.5, 0.4, 1.0, None),
    ],
)
def test_closure_by_hand(before: float, after: float, floor: float, expected: float | None) -> None:
    assert closed_share(before, after, floor) == expected


@pytest.mark.parametrize("samples", [100, 480, 601, 3000])
def test_blocks_spread_over_the_record_hold_at_least_three_tenths(samples: int) -> None:
    out = held_out_samples(samples)
    assert 0.3 <= out.mean() < 0.36
    starts = np.flatnonzero(np.diff(np.concatenate([[0], out.astype(int)])) == 1)
    assert starts.size >= 5
    assert starts[0] > 0.05 * samples  # the fits see the beginning
    assert np.ptp(np.diff(starts)) <= 0.2 * samples
    assert np.all(np.array([out[: samples // 2].mean(), out[samples // 2 :].mean()]) > 0.25)


@pytest.mark.parametrize("samples", [100, 480, 601, 3000])
def test_the_fits_see_both_sides_of_every_block(samples: int) -> None:
    out = held_out_samples(samples)
    assert not out[: samples // 20].any()
    assert not out[-(samples // 20) :].any()
    for sixth in np.array_split(out, 6):
        assert np.flatnonzero(sixth).mean() == pytest.approx(0.5 * sixth.size, abs=2.0)


@pytest.mark.parametrize("sixth", [0, 3, 5])
@pytest.mark.parametrize("place", [0.1, 0.3, 0.33, 0.35, 0.5, 0.64, 0.7, 0.9])
def test_an_instant_is_not_among_the_samples_that_no_fit_sees(sixth: int, place: float) -> None:
    out = held_out_samples(3000, (sixth + place) / 6)
    at = round((sixth + place) * 500)
    assert not out[at - 3 : at + 4].any()
    assert out.mean() == pytest.approx(held_out_samples(3000).mean(), abs=0.01)
    assert not out[:60].any()  # where it begins, the state in which it begins is found


def amount_of(explained: Explanation, seed: int = 0) -> GapScore:
    """The closure on blocks of the record."""
    held_out = hold_out(explained.data, None)
    before, after = (held_out.refit(fit) for fit in (explained.path[0], explained.best))
    return score_fits(held_out, before.output, after, np.random.default_rng(seed))


def test_the_gap_closes_on_held_out_samples(banded: Explanation) -> None:
    amount = amount_of(banded)
    np.testing.assert_array_equal(amount.scored, held_out_samples(banded.data.samples))
    for output, rmse in zip(amount.outputs, (amount.before, amount.after), strict=True):
        error = banded.data.y - output
        assert rmse == pytest.approx(np.sqrt(np.mean(error[amount.scored] ** 2)))
    assert amount.after_fit.noise.rows < (~amount.scored).sum()  # no fit has seen them
    assert amount.after_fit.hypothesis.names == ("input-dead-zone",)
    assert amount.closed is not None
    assert amount.closed == pytest.approx(closed_share(amount.before**2, amount.after**2, amount.floor**2))
    assert amount.closed > 0.9


def test_the_interval_contains_the_point_and_repeats_with_its_seed(banded: Explanation) -> None:
    amount = amount_of(banded)
    assert amount.ci95 is not None
    assert amount.closed is not None
    assert amount.ci95[0] <= amount.closed <= amount.ci95[1] <= 1.0
    assert amount.ci95[0] < amount.ci95[1]
    assert amount_of(banded).ci95 == amount.ci95
    assert amount_of(banded, seed=1).ci95 != amount.ci95


def test_the_floor_is_the_noise(banded: Explanation, two_poles: Callable[..., FloatArray]) -> None:
    u = np.asarray(banded.data.u_scale.back(banded.data.u))
    y = two_poles(np.maximum(u - 0.3, 0.0) + np.minimum(u + 0.4, 0.0))
    assert amount_of(banded).floor * banded.data.y_scale.unit == pytest.approx(0.02 * y.std(), rel=0.15)
    assert noise_power(banded.data, banded.best) == pytest.approx(banded.best.noise.sigma2, rel=0.1)


def told_by_the_input(explained: Explanation, noise: float) -> FloatArray:
    """The square of the filtered input up to the sample before, standard deviation one, and noise."""
    state = lfilter([0.0, 0.2], [1.0, -0.8], explained.data.u) ** 2
    return (state - state.mean()) / state.std() + noise * np.random.default_rng(4).standard_normal(state.size)


def test_the_input_dependent_part_is_excluded_from_the_noise_floor(plain: Explanation) -> None:
    e = told_by_the_input(plain, 0.5)
    power = noise_power(replace(plain.data, y=plain.best.output + e), plain.best)
    assert 0.5**2 * 0.8 < power < 0.6 * np.mean(e**2)


def test_closure_is_undefined_without_a_gap(plain: Explanation) -> None:
    amount = amount_of(plain)
    assert amount.closed is None or abs(amount.closed) < 1e-9
    assert (amount.closed is None) == (amount.ci95 is None)
    assert amount.before == amount.after


def test_a_given_simulation_is_scored_as_it_is(banded: Explanation) -> None:
    given = replace(banded.path[0], output=0.8 * banded.path[0].output)
    held_out = hold_out(banded.data, None)
    amount = score_fits(held_out, given.output, held_out.refit(banded.best), np.random.default_rng(0))
    assert amount.outputs[0] is given.output
    assert amount.before > amount_of(banded).before
    other = held_out.measured + 3.0
    amount = score_fits(held_out, other, held_out.refit(banded.best), np.random.default_rng(0))
    assert amount.before == pytest.approx(3.0)
    np.testing.assert_array_equal(amount.outputs[0], other)


def test_a_holdout_is_scored_after_its_first_samples(banded: Explanation, two_poles: Callable[..., FloatArray]) -> None:
    """Nothing is refitted; the first samples give the initial state and are not scored."""
    u = np.repeat(np.random.default_rng(9).uniform(-1.5, 1.5, 40), 8)
    y = two_poles(np.maximum(u - 0.3, 0.0) + np.minimum(u + 0.4, 0.0))
    data = banded.data
    # two_poles counts from its own first input; the model from the first one of the fit's record.
    bend = [np.maximum(x - 0.3, 0.0) + np.minimum(x + 0.4, 0.0) for x in (u[0], data.u_scale.back(data.u[0]))]
    y = y + bend[0] - bend[1] + 0.01 * np.random.default_rng(3).standard_normal(u.size)
    held_out = hold_out(data, (u, y))
    amount = score_fits(held_out, held_out.output(banded.path[0]), banded.best, np.random.default_rng(0))
    assert amount.scored.tolist() == [False] * 50 + [True] * (u.size - 50)
    assert amount.after_fit is banded.best
    assert amount.after * data.y_scale.unit < 0.02
    assert amount.closed is not None
    assert amount.closed > 0.85


def even(before: float, after: float, floor: float, explanation: Fit, seed: int = 0) -> tuple[float, float]:
    """The interval for errors of constant size, 300 samples fitted and 100 scored."""
    scored, fitted = np.full(100, 1.0), np.full(300, after)
    return _closure_interval(before * scored, after * scored, fitted, floor, explanation, np.random.default_rng(seed))


def with_numbers(fit: Fit, count: int, sigma2: float) -> Fit:
    """The fit with `count` parameters and innovations of variance `sigma2`."""
    return replace(fit, theta=np.zeros(count), gains=np.zeros(3), noise=replace(fit.noise, sigma2=sigma2))


@pytest.mark.parametrize(("before", "after", "floor"), [(2.0, 1.0, 0.5), (3.0, 2.0, 1.0), (1.0, 2.0, 0.5)])
def test_the_interval_has_a_minimum_width(plain: Explanation, before: float, after: float, floor: float) -> None:
    closed = closed_share(before**2, after**2, floor)
    assert closed is not None
    low, high = even(before, after, floor, with_numbers(plain.best, 2, floor))
    assert low == pytest.approx(closed - 0.005)
    assert high == pytest.approx(closed + 0.005)


@pytest.mark.parametrize(("count", "colour"), [(3, 1.0), (30, 1.0), (30, 2.0)])
def test_the_interval_includes_the_uncertainty_of_the_parameters(plain: Explanation, count: int, colour: float) -> None:
    """The lower end is the expected error of the parameters, which coloured noise increases."""
    low, high = even(2.0, 1.0, 1.0, with_numbers(plain.best, count, 1.0 / colour))
    inexact = colour * chi2.ppf(0.975, count) / 300
    assert high == 1.0
    assert low + 0.005 == pytest.approx(1.0 - np.sqrt(inexact / 3.0), rel=0.03)


def test_an_interval_repeats_with_its_seed(plain: Explanation) -> None:
    fit = with_numbers(plain.best, 30, 1.0)
    assert even(2.0, 1.0, 1.0, fit) == even(2.0, 1.0, 1.0, fit)
    assert even(2.0, 1.0, 1.0, fit) != even(2.0, 1.0, 1.0, fit, seed=1)
