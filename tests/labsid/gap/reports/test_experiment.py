"""The proposed experiment: within the range of the record, and separating two explanations."""

from dataclasses import replace

import numpy as np
import pytest

from labsid.gap.fits.fitting import minimize
from labsid.gap.reports.experiment import Experiment, next_experiment
from labsid.gap.search.explanation import Explanation


@pytest.fixture(scope="module")
def proposed(banded: Explanation) -> Experiment:
    """The experiment that separates the dead zone from its best rival."""
    rivals = [fit for names, fit in banded.levels[1].items() if names != ("input-dead-zone",)]
    rival = min(rivals, key=lambda fit: fit.bic)
    found = next_experiment(banded.data, banded.best, rival, np.random.default_rng(0))
    assert found is not None
    return found


def test_it_names_what_it_separates(banded: Explanation, proposed: Experiment) -> None:
    assert proposed.separates[0] == "input-dead-zone"
    assert (proposed.separates[1],) in banded.levels[1]
    assert proposed.why


def test_it_stays_in_the_range_of_the_record_and_uses_it(banded: Explanation, proposed: Experiment) -> None:
    u = np.asarray(banded.data.u_scale.back(banded.data.u))
    assert proposed.u.size == u.size
    assert u.min() - 1e-9 <= proposed.u.min() <= proposed.u.max() <= u.max() + 1e-9
    assert np.ptp(proposed.u) > 0.7 * np.ptp(u)


def test_its_margin_is_what_the_second_explanation_misses_over_the_noise(
    banded: Explanation, proposed: Experiment
) -> None:
    """The BIC of white noise: the error that the refitted rival leaves of the first one's output, and the noise."""
    data, first, second = banded.data, banded.best, banded.levels[1][(proposed.separates[1],)]
    u = data.u_scale.of(proposed.u)
    played = replace(data, u=u, y=first.hypothesis.output(first.theta, first.gains, u), rows=np.ones(u.size, bool))
    point = minimize(played, second.hypothesis, second.theta, second.gains, iterations=10)
    assert point is not None
    sigma2 = first.noise.sigma2
    assert proposed.margin == pytest.approx(u.size * (np.log(point.cost + sigma2) - np.log(sigma2)), rel=1e-6)
    assert proposed.margin > 12.0


def test_nothing_separates_an_explanation_from_itself(banded: Explanation) -> None:
    """An input of which the outcome would be a coin toss is not worth playing."""
    assert next_experiment(banded.data, banded.best, banded.best, np.random.default_rng(0)) is None


def test_the_same_seed_proposes_the_same_input(banded: Explanation, proposed: Experiment) -> None:
    rival = banded.levels[1][(proposed.separates[1],)]
    again = next_experiment(banded.data, banded.best, rival, np.random.default_rng(0))
    assert again is not None
    np.testing.assert_array_equal(again.u, proposed.u)
    assert again.margin == proposed.margin


def test_an_explanation_that_runs_away_proposes_nothing(banded: Explanation) -> None:
    """Its output would leave the range that the record has seen."""
    wild = replace(banded.path[0], gains=100.0 * banded.path[0].gains)
    assert next_experiment(banded.data, wild, banded.best, np.random.default_rng(0)) is None
