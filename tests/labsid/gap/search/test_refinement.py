"""Refinement of a fit out of a local minimum."""

import numpy as np
import pytest

from labsid.gap.effects import dynamics, periodic
from labsid.gap.fits.fitting import Fit, Problem, finish, minimize
from labsid.gap.fits.hypothesis import Hypothesis
from labsid.gap.record.data import Data, scaled
from labsid.gap.search.forms import transfer_theta
from labsid.gap.search.refinement import converge, retried_without_one, valley_directions

INNER_PERIODIC = periodic.InnerPeriodic("inside")

STICKING = Hypothesis((dynamics.CoulombFriction("position"), dynamics.ExtraLag()))
NAMES = [parameter.name for parameter in STICKING.parameters]
TRUE = {"log_c": np.log(0.0536), "log_k": np.log(0.0307), "friction": 0.8, "log_lag": 1.527}


def sticking(seed: int) -> tuple[Data, Fit]:
    """A sticking mass with a slow sensor, and a fit started with a wrong delay."""
    rng = np.random.default_rng(seed)
    u = np.repeat(rng.choice([-1.0, 1.0], 60), rng.integers(15, 60, 60))
    theta = np.array([TRUE.get(name, 0.0) for name in NAMES])
    y = STICKING.output(theta, np.array([1.0, 0.0, 0.0]), u) + 0.02 * rng.standard_normal(u.size)
    data = scaled(u, y, np.ones(u.size, bool), 1.0)
    began = np.array([(TRUE | {"delay": 0.45, "log_lag": 1.4}).get(name, 0.0) for name in NAMES])
    point = minimize(data, STICKING, began, iterations=40)
    assert point is not None
    return data, finish(data, STICKING, point)


@pytest.mark.parametrize("seed", [0, 3])
def test_refinement_corrects_a_delay_hidden_by_friction(seed: int) -> None:
    data, fit = sticking(seed)
    assert fit.theta[0] > 0.4
    found = converge(data, fit)
    assert found.bic < fit.bic - 20.0
    assert found.theta[0] < 0.05
    assert found.theta[NAMES.index("log_lag")] == pytest.approx(TRUE["log_lag"], abs=0.03)


def test_the_cost_rises_least_along_a_valley() -> None:
    data, fit = sticking(3)
    problem = Problem(data, STICKING)
    at = problem.point(converge(data, fit).theta)
    assert at is not None
    valleys = valley_directions(problem, at)
    np.testing.assert_allclose(valleys.diagonal(), 1.0)
    for name in ("log_c", "log_k", "log_lag", "z0"):
        i = NAMES.index(name)
        ahead, back = (problem.point(at.theta + 0.02 * way * valleys[i]) for way in (1.0, -1.0))
        alone = problem.point(at.theta + 0.02 * np.eye(at.theta.size)[i])
        assert ahead is not None
        assert back is not None
        assert alone is not None
        assert ahead.cost < alone.cost
        assert min(ahead.cost, back.cost) < at.cost * 1.05


def test_one_effect_is_tried_again_from_its_parameters_in_a_pair() -> None:
    """Friction with a lag, and a wave that the record does not contain."""
    data, fit = sticking(3)
    fit = converge(data, fit)
    pair = fit.hypothesis.plus(INNER_PERIODIC)
    theta = transfer_theta(fit, pair)
    theta[pair.slices["plant"].start + pair.plant.index("cycles")] = 7.3
    point = minimize(data, pair, theta, iterations=1)
    assert point is not None
    found = retried_without_one(data, finish(data, pair, point))
    assert {one.hypothesis.names for one in found} >= {fit.hypothesis.names}
    again = next(one for one in found if one.hypothesis.names == fit.hypothesis.names)
    assert again.cost == pytest.approx(fit.cost, rel=0.01)
