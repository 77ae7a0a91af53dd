"""From the fits of a record to the answer."""

from dataclasses import replace

import numpy as np
import pytest
from gap_answers import answered

from labsid.gap.search.explanation import Explanation


def test_an_explanation_of_all_but_noise_is_an_effect(banded: Explanation) -> None:
    answer = answered(banded)
    assert answer.decision.verdict == "effect"
    assert answer.decision.names == ("input-dead-zone",)
    assert answer.tried == {}
    assert answer.closed == (0.0, answer.score.closed)
    assert answer.score.closed is not None
    assert answer.score.closed > 0.9
    assert answer.explanation.best is banded.best  # of the whole record


def test_a_step_that_is_the_last_one_already_closes_as_much(banded: Explanation) -> None:
    longer = replace(banded, path=(*banded.path, banded.best))
    first, middle, last = answered(longer).closed
    assert (first, last) == (0.0, pytest.approx(middle, abs=1e-3))
    same = replace(banded, path=(banded.path[0], *banded.path))
    closed = answered(same).closed
    assert closed[1] is not None
    assert closed[1] < 0.1  # nothing is added; the linear model before may be another one


def test_a_record_without_a_gap_needs_nothing(plain: Explanation) -> None:
    answer = answered(plain)
    assert answer.decision.verdict == "none"
    assert answer.remaining is None
    assert answer.score.before == answer.score.after
    assert answer.score.closed is None
    assert answer.closed == (None,) * len(answer.explanation.path)
    before, after = answer.outputs
    np.testing.assert_allclose(before, after, atol=0.05 * np.ptp(before))


def test_a_rest_that_is_no_noise_leaves_a_part(banded: Explanation) -> None:
    """A product of states that no effect of the table describes is added to the dead zone."""
    z = banded.best.output
    added = z * np.gradient(z)
    data = replace(banded.data, y=banded.data.y + 0.25 * added / added.std())
    answer = answered(replace(banded, data=data))
    assert answer.decision.verdict == "partial"
    assert "input-dead-zone" in (*answer.decision.names, *answer.decision.ambiguous)
    assert len(answer.closed) == len(answer.decision.names) + 1
    assert answer.closed[-1] == answer.score.closed
    assert answer.score.after < answer.score.before
    assert answer.tried
    assert answer.remaining is not None
    assert 0.0 < answer.share_left < 1.0
    assert answer.share_left == pytest.approx(1.0 - answer.score.closed)
    # The accepted fit has not seen the held-out samples.
    assert answer.explanation.best.noise.rows < data.samples - answer.score.scored.sum()
