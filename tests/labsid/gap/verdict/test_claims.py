"""What a decision may claim: an effect that hardly adds to others is less likely than not."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from scipy.signal import lfilter

from labsid.gap.effects.drifts import GainDrift
from labsid.gap.effects.families import magnitudes_of
from labsid.gap.fits.fitting import fit_from
from labsid.gap.fits.linear_fits import fit_baseline
from labsid.gap.record.data import scaled
from labsid.gap.verdict.decision import (
    SWITCH_PROBABILITY,
    Decision,
    without_doubtful_parts,
    without_sizeless,
    without_small_additions,
)

FRICTION, MODE = "coulomb-friction", "resonance"


def fit(*names: str, error: float) -> Any:
    """A fit of these effects with this rms error."""
    return SimpleNamespace(hypothesis=SimpleNamespace(names=names), output=np.full(400, error))


def explanation(without_mode: float, without_friction: float) -> Any:
    """Two effects that leave an error of 0.1, of 1 before; and what each of them leaves alone."""
    data = SimpleNamespace(y=np.zeros(400), rows=np.ones(400, bool))
    one = {(FRICTION,): fit(FRICTION, error=without_mode), (MODE,): fit(MODE, error=without_friction)}
    both = fit(FRICTION, MODE, error=0.1)
    return SimpleNamespace(
        data=data, best=both, path=(fit(error=1.0), both), levels=({}, one, {(FRICTION, MODE): both})
    )


@pytest.mark.parametrize(
    ("without_mode", "limited"), [(0.105, True), (0.11, True), (0.12, False), (0.4, False)], ids=str
)
def test_an_effect_that_hardly_adds_to_another_is_less_likely_than_not(without_mode: float, limited: bool) -> None:
    decision = Decision("effect", (FRICTION, MODE), {FRICTION: 0.9, MODE: 0.9}, (), {}, 1.0)
    after = without_small_additions(decision, explanation(without_mode, 0.9))
    assert after.probability == {FRICTION: 0.9, MODE: SWITCH_PROBABILITY if limited else 0.9}
    assert after.names == decision.names


def test_an_effect_alone_and_a_partial_explanation_are_not_limited() -> None:
    partial = Decision("partial", (FRICTION, MODE), {FRICTION: 0.9, MODE: 0.9}, (), {}, 1.0)
    assert without_small_additions(partial, explanation(0.1, 0.9)) == partial


@pytest.mark.parametrize(("closed", "limited"), [((0.0, 1.0), True), ((0.1, 0.9), False), (None, False)])
def test_a_partial_explanation_that_may_close_nothing_is_less_likely_than_not(
    closed: tuple[float, float] | None, limited: bool
) -> None:
    partial = Decision("partial", (FRICTION,), {FRICTION: 0.8}, (), {}, 0.5)
    after = without_doubtful_parts(partial, closed)
    assert after.probability == {FRICTION: SWITCH_PROBABILITY if limited else 0.8}


@pytest.mark.parametrize(("closed", "limited"), [((-6.0, -1.0), True), ((-1.0, 0.4), False), (None, False)])
def test_an_effect_that_enlarges_the_gap_elsewhere_is_less_likely_than_not(
    closed: tuple[float, float] | None, limited: bool
) -> None:
    """A converter is seen in the samples."""
    converter = "output-quantization"
    decision = Decision("effect", (FRICTION, converter), {FRICTION: 0.8, converter: 0.8}, (), {}, 1.0)
    after = without_doubtful_parts(decision, closed)
    assert after.probability == {FRICTION: SWITCH_PROBABILITY if limited else 0.8, converter: 0.8}


@pytest.mark.parametrize(("change", "limited"), [(0.0, True), (0.5, False)], ids=["none", "half"])
def test_an_effect_whose_every_size_is_within_its_error_is_less_likely_than_not(change: float, limited: bool) -> None:
    rng = np.random.default_rng(3)
    u = np.repeat(rng.uniform(0.0, 4.0, 30), 20)
    drifting = u * (1.0 + change * np.linspace(-0.5, 0.5, u.size))
    y = lfilter([0.0, 0.1], [1.0, -0.9], drifting) + 0.05 * rng.standard_normal(u.size)
    data = scaled(u, y, np.ones(u.size, bool), 0.1)
    base = fit_baseline(data)
    drift = GainDrift("1")
    found = fit_from(data, base.hypothesis.plus(drift), np.append(base.theta, [0.05, 0.1]), iterations=25)
    assert found is not None
    decision = Decision("effect", (drift.name,), {drift.name: 0.9}, (), {}, 1.0)
    after = without_sizeless(decision, data, found)
    assert after.probability == {drift.name: SWITCH_PROBABILITY if limited else 0.9}


def test_sizes_are_no_places_on_an_axis() -> None:
    assert magnitudes_of("parameter-drift") == {"drift", "pole"}
    assert magnitudes_of("input-dead-zone") == frozenset()
