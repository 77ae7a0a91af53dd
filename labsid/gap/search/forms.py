"""Moves between hypotheses: an effect in another form, one effect more, or one fewer."""

from collections.abc import Iterator
from itertools import product

import numpy as np

from labsid._arrays import FloatArray
from labsid.gap.effects.base import Effect
from labsid.gap.effects.context import Structure
from labsid.gap.fits.fitting import Fit, finish, minimize
from labsid.gap.fits.hypothesis import Hypothesis
from labsid.gap.record.data import Data

REMOVAL_ITERATIONS = 6  # after an effect was removed; numerics


def alternative_forms(hypothesis: Hypothesis) -> list[Hypothesis]:
    """Hypotheses with one of the found effects in another form."""
    places = range(hypothesis.n_given, len(hypothesis.effects))
    return [other for i in places for _, other in forms_at(hypothesis, i)]


def forms_at(hypothesis: Hypothesis, i: int, forms: list[Effect] | None = None) -> Iterator[tuple[Effect, Hypothesis]]:
    """Other forms of effect i, by default all, that its dynamics allow, each with the hypothesis."""
    before, after = hypothesis.effects[:i], hypothesis.effects[i + 1 :]
    for form in hypothesis.effects[i].alternatives(hypothesis) if forms is None else forms:
        other = hypothesis.with_effects((*before, form, *after))
        if other.plant.keeps_feedback:
            yield form, other


def plain_forms(hypothesis: Hypothesis) -> list[Hypothesis]:
    """Hypotheses with one of the found effects in the form that its own makes richer."""
    return [
        hypothesis.with_effects((*hypothesis.effects[:i], plain, *hypothesis.effects[i + 1 :]))
        for i, effect in enumerate(hypothesis.effects)
        if i >= hypothesis.n_given and (plain := effect.plain_form) is not None
    ]


def transfer_theta(fit: Fit, other: Hypothesis) -> FloatArray:
    """Transfer theta of a fit to another hypothesis: by effect, or by parameter name for effects without one."""
    old = fit.hypothesis
    shared = shared_keys(old, other)
    spare: dict[str, float] = {}
    for key, place in old.slices.items():
        if key not in shared:
            spare |= {p.name: x for p, x in zip(old.parameters[place], fit.theta[place], strict=True)}
    theta = np.array([spare.get(parameter.name, parameter.start) for parameter in other.parameters])
    for key in shared:
        theta[other.slices[key]] = fit.theta[old.slices[key]]
    if not other.delay_is_an_effect:
        theta[0] = fit.theta[0]
    for effect in other.effects:
        effect.carry_over(fit, other, theta)
    return theta


def shared_keys(one: Structure, other: Structure) -> list[str]:
    """Keys of the effects that have the same parameters in both."""
    both = (key for key in one.slices if key != "plant" and key in other.slices)
    return [key for key in both if one.parameters[one.slices[key]] == other.parameters[other.slices[key]]]


def extended_hypotheses(old: Hypothesis, effect: Effect) -> list[Hypothesis]:
    """Hypotheses with one more effect: several if a state is nonlinear and others have several forms beside it."""
    if not old.plus(effect).plant.nonlinear:
        return [old.plus(effect)]
    return [old.with_effects((*inner, effect)) for inner in product(*(one.inner_forms() for one in old.effects))]


def remove_named_effect(data: Data, fit: Fit, name: str) -> Fit | None:
    """Refit without the effect of this name that was found; None if the result cannot be simulated."""
    hypothesis = fit.hypothesis
    return remove_effect(data, fit, [effect.name for effect in hypothesis.found].index(name) + hypothesis.n_given)


def remove_effect(data: Data, fit: Fit, which: int) -> Fit | None:
    """Refit without the effect of index `which`; None if the result cannot be simulated."""
    old = fit.hypothesis
    other = old.with_effects((*old.effects[:which], *old.effects[which + 1 :]))
    if not other.plant.nonlinear:
        other = other.with_effects(tuple(effect.outer_form() for effect in other.effects))
    starts = [transfer_theta(fit, other)]
    place, before, now = other.slices["plant"], old.plant, other.plant
    if (before.kind, before.roots) != (now.kind, now.roots):
        rates = [base[:2] for base in now.starts(*fit.rates)]
        starts = [starts[0].copy() for _ in rates]
        for start, pair in zip(starts, rates, strict=True):
            start[place][:2] = pair
    points = [
        point for start in starts if (point := minimize(data, other, start, iterations=REMOVAL_ITERATIONS)) is not None
    ]
    return finish(data, other, min(points, key=lambda point: point.cost)) if points else None
