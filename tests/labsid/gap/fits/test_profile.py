"""Profile of the cost over one parameter: its value is kept, and the cost is lowest at the fit."""

import numpy as np
import pytest

from labsid._arrays import FloatArray
from labsid.gap.effects.disturbance import LoadStep
from labsid.gap.effects.dynamics import CoulombFriction
from labsid.gap.fits.fitting import Fit, finish, minimize
from labsid.gap.fits.hypothesis import Hypothesis
from labsid.gap.fits.profile import Profile, has_size, profile_likelihood
from labsid.gap.record.data import Data, Scale

ONSET = 0.6


@pytest.fixture(scope="module")
def fitted(levels: FloatArray) -> tuple[Data, Fit]:
    u = levels[:400]
    hypothesis = Hypothesis((LoadStep(),))
    theta = np.array([0.25, np.log(0.5), np.log(0.05), ONSET])
    gains = np.array([0.03, 0.02, 0.0, 0.0, 0.0, 0.1, 0.1, 0.02])
    y = hypothesis.output(theta, gains, u) + 0.1 * np.random.default_rng(0).standard_normal(u.size)
    data = Data(u, y, np.ones(u.size, bool), 1.0, Scale(0.0, 1.0), Scale(0.0, 1.0))
    point = minimize(data, hypothesis, theta, gains)
    assert point is not None
    return data, finish(data, hypothesis, point)


@pytest.fixture(scope="module")
def seen(fitted: tuple[Data, Fit]) -> Profile:
    data, fit = fitted
    found = profile_likelihood(data, fit, 3)
    assert found is not None
    return found


def test_the_others_are_fitted_again_at_every_place(fitted: tuple[Data, Fit], seen: Profile) -> None:
    data, fit = fitted
    where = np.array([point.theta[3] for point in seen.points])
    assert np.all(np.diff(where) > 0.0)
    assert fit.theta[3] in where
    for point in seen.points[:: len(seen.points) - 1]:
        alone = data.y - fit.hypothesis.output(np.array([*fit.theta[:3], point.theta[3]]), fit.gains, data.u)
        assert point.cost < np.mean(alone**2)


def test_the_likely_places_lie_about_the_one_that_was_found(fitted: tuple[Data, Fit], seen: Profile) -> None:
    _, fit = fitted
    where = np.array([point.theta[3] for point in seen.points])
    assert seen.weights.sum() == pytest.approx(1.0)
    assert np.all(seen.weights >= 0.0)
    assert abs(seen.weights @ where - fit.theta[3]) < 5 / 400
    assert seen.weights[0] < 0.01
    assert seen.weights[-1] < 0.01


def test_the_hypothesis_of_the_fit_keeps_its_bounds(fitted: tuple[Data, Fit], seen: Profile) -> None:
    _, fit = fitted
    lower, upper = fit.hypothesis.bounds
    assert (lower[3], upper[3]) == (0.0, 1.0)


@pytest.mark.parametrize(("friction", "expected"), [(0.4, True), (0.0, False)])
def test_an_effect_has_the_size_that_the_record_asks_for(levels: FloatArray, friction: float, expected: bool) -> None:
    hypothesis = Hypothesis((CoulombFriction("position"),))
    u = levels[:800]
    names = [parameter.name for parameter in hypothesis.parameters]
    values = {"log_c": np.log(0.3), "log_k": np.log(0.04), "friction": friction}
    theta = np.array([values.get(name, 0.0) for name in names])
    gains = np.array([1.0, 0.0])
    clean = hypothesis.output(theta, gains, u)
    y = clean + 0.02 * np.std(clean) * np.random.default_rng(1).standard_normal(u.size)
    data = Data(u, y, np.ones(u.size, bool), 1.0, Scale(0.0, 1.0), Scale(0.0, 1.0))
    theta[names.index("friction")] = max(friction, 0.01)
    point = minimize(data, hypothesis, theta, gains)
    assert point is not None
    assert has_size(data, finish(data, hypothesis, point)) is expected
