"""Which inputs move an output, and how fast."""

import numpy as np
from two_by_two import LAGS, lagged, random_steps

from labsid.gap.record.data import Data, scaled
from labsid.gap.signals.input_responses import linear_parts


def _pairs(u: np.ndarray, y: np.ndarray) -> list[Data]:
    return [scaled(column, y, np.ones(y.size, bool), 1.0) for column in u.T.copy()]


def test_rates_and_strengths_of_both_responses_are_found() -> None:
    rng = np.random.default_rng(0)
    u = np.column_stack([random_steps(rng, 800) for _ in range(2)])
    responses = [lagged(u[:, i], *LAGS[0][i]) for i in range(2)]
    y = sum(responses) + 0.005 * rng.standard_normal(800)
    parts = linear_parts(_pairs(u, y))
    assert parts.moves.all()
    assert parts.strongest == int(np.argmax([one.std() for one in responses]))
    for (c, k), (first, second, _) in zip(parts.rates, LAGS[0], strict=True):
        assert abs(np.log(k * first * second)) < 0.15
        assert abs(np.log(c / (1.0 / first + 1.0 / second))) < 0.15


def test_an_input_without_influence_does_not_move_the_output() -> None:
    rng = np.random.default_rng(3)
    u = np.column_stack([random_steps(rng, 800) for _ in range(2)])
    y = lagged(u[:, 0], 9.0, 4.0, 1.0) + 0.02 * rng.standard_normal(800)
    parts = linear_parts(_pairs(u, y))
    assert parts.moves.tolist() == [True, False]
    assert parts.strongest == 0
