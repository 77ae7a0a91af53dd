"""The closure after each effect is scored like that of the whole explanation."""

from dataclasses import replace

import numpy as np
import pytest

from labsid.gap.closure_by_step import closed_by_step
from labsid.gap.explanation import Explanation
from labsid.gap.scores import GapScore, score_explanation
from labsid.records.record import Record


def _amount(explained: Explanation, holdout: Record | None) -> GapScore:
    data = explained.data
    other = None if holdout is None else (data.u_scale.of(holdout.u), data.y_scale.of(holdout.y))
    return score_explanation(explained, None, other, np.random.default_rng(0))


@pytest.fixture
def other(banded: Explanation) -> Record:
    """Another record of the same rig: the first part of it."""
    data = banded.data
    u, y = (np.asarray(scale.back(x))[:300] for scale, x in ((data.u_scale, data.u), (data.y_scale, data.y)))
    return Record(7.0 + np.arange(300) * data.Ts, u, y, data.Ts)


@pytest.mark.parametrize("elsewhere", [False, True])
def test_a_step_that_is_the_last_one_already_closes_as_much(
    banded: Explanation, other: Record, elsewhere: bool
) -> None:
    holdout = other if elsewhere else None
    longer = replace(banded, path=(*banded.path, banded.best))
    amount = _amount(longer, holdout)
    first, middle, last = closed_by_step(longer, amount, holdout)
    assert (first, last) == (0.0, amount.closed)
    assert middle == pytest.approx(amount.closed, abs=1e-6)
    assert middle is not None
    assert middle > 0.9


@pytest.mark.parametrize("elsewhere", [False, True])
def test_a_step_without_effect_has_zero_closure(banded: Explanation, other: Record, elsewhere: bool) -> None:
    holdout = other if elsewhere else None
    longer = replace(banded, path=(banded.path[0], *banded.path))
    _, middle, _ = closed_by_step(longer, _amount(longer, holdout), holdout)
    assert middle == pytest.approx(0.0, abs=1e-6)


def test_without_a_gap_no_step_closes_any(banded: Explanation) -> None:
    amount = replace(_amount(banded, None), closed=None)
    assert closed_by_step(banded, amount, None) == [None] * len(banded.path)
    alone = replace(banded, path=banded.path[:1])
    assert closed_by_step(alone, replace(amount, closed=0.4), None) == [0.4]
