"""How the cases of each row of the bars are drawn. A draw may fail (None): then it is made again with the next seed."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from labsid.blind.draws import (
    any_noise,
    bench,
    distance,
    example,
    finished,
    hidden,
    log_uniform,
    merged,
    mildly_coloured,
    partly_coloured,
)
from labsid.blind.experiment import Case, Recipe, command, follow, fresh, to_record
from labsid.blind.output_error import discrete_poles, fit_linear
from labsid.blind.strength import (
    CLEAR,
    HARD,
    INVISIBLE,
    STRONGEST_NOISE,
    WEAKEST_NOISE,
    at_ratio,
    clean_output,
    gap,
    output_spread,
)
from labsid.rig.switchable.effects import EFFECTS, can_have, draw_effect, look_at
from labsid.rig.switchable.inputs import INPUTS, RICH
from labsid.rig.switchable.plants import RIGS
from labsid.rig.switchable.setup import Setup
from labsid.rig.switchable.simulation import poles
from labsid.rig.switchable.truth import true_linear
from labsid.rig.switchable.unlisted import OUTSIDE, can_have_outside, draw_outside

Draw = Callable[[np.random.Generator, int, str], Case | None]

_MANY = (*RICH, "staircase")
_MOVING = (*RICH, "two-level", "square")
_SUITED: dict[str, tuple[str, ...]] = {
    "input-saturation": RICH,
    "input-dead-zone": RICH,
    "input-backlash": RICH,
    "input-rate-limit": ("levels", "multisine"),
    "input-nonlinearity": RICH,
    "output-nonlinearity": RICH,
    "output-saturation": _MANY,
    "sqrt-outflow": _MANY,
    "overflow": _MANY,
    "coulomb-friction": _MOVING,
    "cubic-stiffness": _MANY,
    "parameter-drift": _MOVING,
    "output-drift": _MOVING,
}
"""Inputs under which an effect differs from every other one: a static curve seen at two levels is any curve."""

_TOO_ALIKE = {
    frozenset(pair)
    for group in (
        ("input-delay", "extra-lag", "input-rate-limit"),
        ("output-drift", "load-step", "parameter-drift", "coloured-noise", "periodic-disturbance"),
        ("input-nonlinearity", "output-nonlinearity", "sqrt-outflow", "cubic-stiffness"),
        ("input-saturation", "input-nonlinearity", "input-dead-zone", "input-backlash"),
        ("output-saturation", "overflow", "output-nonlinearity"),
        ("input-backlash", "coulomb-friction", "input-dead-zone"),
        ("output-outliers", "output-dropout", "coloured-noise"),
    )
    for pair in [(a, b) for a in group for b in group if a != b]
}
"""Pairs of effects of which one record cannot be expected to tell both."""

TIMELESS = {
    *(name for name in EFFECTS if name.startswith("input-")),
    *("extra-lag", "resonance", "sqrt-outflow", "overflow", "coulomb-friction", "cubic-stiffness"),
    *("output-saturation", "output-nonlinearity", "output-quantization"),
}
"""Effects that are the same in another record of the rig."""

REPEATABLE = TIMELESS | {"load-step", "parameter-drift", "periodic-disturbance", "output-drift"}
"""And those that come by the clock: they happen again where the record begins at the same time."""


def draw_single_clear(rng: np.random.Generator, i: int, name: str) -> Case | None:
    """One effect, clear."""
    return _single(rng, EFFECTS[i % len(EFFECTS)], name, "single-clear", CLEAR)


def draw_single_hard(rng: np.random.Generator, i: int, name: str) -> Case | None:
    """One effect, hard."""
    return _single(rng, EFFECTS[i % len(EFFECTS)], name, "single-hard", HARD)


def draw_short(rng: np.random.Generator, i: int, name: str) -> Case | None:
    """One effect in a short, noisy record of few levels, with a fast nuisance pole and rounded corners."""
    effect = EFFECTS[i % len(EFFECTS)]
    recipe = bench(rng, effect, int(rng.integers(300, 601)), ("staircase", "two-level"))
    plain = replace(recipe.plain, motion=recipe.plain.motion._replace(actuator_lag=float(rng.uniform(0.1, 0.5))))
    recipe = replace(recipe, plain=plain)
    at = look_at(plain, command(recipe), rounding=float(rng.uniform(0.01, 0.05)))
    ratio = log_uniform(rng, 3.0, 12.0)
    found = at_ratio(recipe, draw_effect(rng, effect, at), ratio, (0.02, 0.05), rng)
    if found is None or not _worth_the_name(effect, recipe, found[0]):
        return None
    return finished(rng, recipe, *found, name, "short", (effect,), partly_coloured(rng))


def draw_pair(rng: np.random.Generator, i: int, name: str) -> Case | None:
    """Two effects, each of which would be clear alone and leaves its mark beside the other."""
    one = EFFECTS[i % len(EFFECTS)]
    two = str(rng.choice(EFFECTS))
    if one == two or frozenset((one, two)) in _TOO_ALIKE:
        return None
    rigs = [rig for rig in RIGS if all(can_have(example(rig), e) for e in (one, two))]
    suited = [x for x in _SUITED.get(one, _MOVING) if x in _SUITED.get(two, _MOVING) and x in _MOVING]
    if not rigs or not suited:
        return None
    recipe = bench(rng, one, int(rng.integers(1200, 3001)), tuple(suited), tuple(rigs))
    at = look_at(recipe.plain, command(recipe))
    first, second = draw_effect(rng, one, at), draw_effect(rng, two, at)
    ratio = log_uniform(rng, 6.0, 18.0)
    found = at_ratio(recipe, first, ratio, (WEAKEST_NOISE, 0.02), rng)
    if found is None:
        return None
    alone, sigma = found
    if not _worth_the_name(one, recipe, alone):
        return None
    share = sigma / output_spread(recipe)
    other = at_ratio(recipe, second, log_uniform(rng, 6.0, 18.0), (0.8 * share, 1.25 * share), rng)
    if other is None or not _worth_the_name(two, recipe, other[0]):
        return None
    both = merged(recipe.plain, alone, other[0])
    start = discrete_poles(poles(recipe.plain.motion))
    v, y = command(recipe), clean_output(recipe, both)
    for part in (alone, other[0]):
        left = fit_linear(v, y - clean_output(recipe, part), start)
        if left.rmse < 3.0 * sigma:
            return None
    if fit_linear(v, y, start).rmse < CLEAR[0] * sigma:
        return None
    return finished(rng, recipe, both, sigma, name, "pair", (one, two), any_noise(rng))


def draw_none(rng: np.random.Generator, i: int, name: str) -> Case | None:
    """No effect, or one that the record does not exercise, or dynamics too small to matter."""
    kind = ("plain", "coloured", "fast pole", "part of a sample", "not exercised", "fine converter")[i % 6]
    samples = int(rng.integers(300, 5001)) if rng.random() < 0.3 else int(rng.integers(1000, 3001))
    effect = str(rng.choice(_HIDEABLE))
    recipe = bench(rng, effect, samples, INPUTS)
    sigma = output_spread(recipe) * log_uniform(rng, WEAKEST_NOISE, STRONGEST_NOISE)
    setup, taps = recipe.plain, 2
    if kind == "fast pole":
        lag: dict[str, Any] = {str(rng.choice(["actuator_lag", "sensor_lag"])): float(rng.uniform(0.05, 0.5))}
        setup = replace(setup, motion=setup.motion._replace(**lag))
    elif kind == "part of a sample":
        setup = replace(setup, actuator=replace(setup.actuator, delay=float(rng.integers(1, 8)) / 16))
        taps = 3
    elif kind == "fine converter":
        setup = replace(setup, sensor=replace(setup.sensor, step=0.3 * sigma))
    elif kind == "not exercised":
        setup = hidden(rng, recipe, effect)
    invisible = INVISIBLE * sigma
    left = gap(recipe, setup, taps)
    if left > invisible:
        return None
    noise = mildly_coloured(rng) if kind == "coloured" else any_noise(rng)
    absent = effect if kind == "not exercised" else None
    return finished(rng, recipe, setup, sigma, name, "none", (), noise, {"kind": kind, "hidden": absent})


def draw_unknown(rng: np.random.Generator, i: int, name: str) -> Case | None:
    """An effect outside the table, clear."""
    effect = OUTSIDE[i % len(OUTSIDE)]
    rigs = tuple(rig for rig in RIGS if can_have_outside(example(rig), effect))
    recipe = bench(rng, "", int(rng.integers(1200, 4001)), RICH, rigs)
    enter = draw_outside(rng, effect, look_at(recipe.plain, command(recipe)))
    found = at_ratio(recipe, enter, log_uniform(rng, 6.0, 25.0), (WEAKEST_NOISE, 0.03), rng)
    if found is None:
        return None
    return finished(rng, recipe, *found, name, "unknown", ("unknown",), any_noise(rng), {"kind": effect})


def draw_with_sim(rng: np.random.Generator, i: int, name: str) -> Case | None:
    """A simulation comes with the record: of the undisturbed rig, or one with wrong numbers."""
    kind = ("mismatch", "none", "effect")[i % 3]
    if kind == "effect":
        effect = EFFECTS[(i // 3) % len(EFFECTS)]
        case = _single(rng, effect, name, "with-sim", CLEAR)
        return None if case is None else replace(case, sim=true_linear(case.recipe.plain, case.recipe.scales))
    recipe = bench(rng, "", int(rng.integers(1200, 3001)), _MOVING)
    sigma = output_spread(recipe) * log_uniform(rng, WEAKEST_NOISE, 0.03)
    if kind == "none":
        steps = 0 if i % 2 else int(rng.integers(8, 33))
        sim = true_linear(recipe.plain, recipe.scales, steps)
        if distance(sim, recipe) > INVISIBLE * sigma:
            return None
        what = {"kind": "another integrator" if steps else "true model"}
        return replace(finished(rng, recipe, recipe.plain, sigma, name, "with-sim", (), any_noise(rng), what), sim=sim)
    m = recipe.plain.motion
    factor = np.exp(rng.choice([-1.0, 1.0], 3) * rng.uniform(0.08, 0.5, 3))
    wrong = replace(recipe.plain, motion=m._replace(T0=m.T0 * factor[0], T1=m.T1 * factor[1]))
    scales = replace(recipe.scales, ys=recipe.scales.ys * float(factor[2]))
    away = clean_output(recipe, wrong) * factor[2] - clean_output(recipe, recipe.plain)
    if np.std(away) < CLEAR[0] * sigma:
        return None
    labels = ("parameter-mismatch",)
    truth: dict[str, Any] = {"T0": float(factor[0]), "T1": float(factor[1]), "gain": float(factor[2])}
    case = finished(rng, recipe, recipe.plain, sigma, name, "with-sim", labels, any_noise(rng), truth)
    return replace(case, sim=true_linear(wrong, scales), level="clear", ratio=float(np.std(away) / sigma))


ROWS: dict[str, Draw] = {
    "single-clear": draw_single_clear,
    "single-hard": draw_single_hard,
    "short": draw_short,
    "pair": draw_pair,
    "none": draw_none,
    "unknown": draw_unknown,
    "with-sim": draw_with_sim,
}

_HIDEABLE = ("input-saturation", "input-backlash", "coulomb-friction", "overflow", "output-saturation")


def _single(rng: np.random.Generator, effect: str, name: str, row: str, between: tuple[float, float]) -> Case | None:
    samples = int(np.exp(rng.uniform(np.log(1200), np.log(5000))))
    recipe = bench(rng, effect, samples, _SUITED.get(effect, INPUTS))
    enter = draw_effect(rng, effect, look_at(recipe.plain, command(recipe)))
    found = at_ratio(recipe, enter, log_uniform(rng, *between), (WEAKEST_NOISE, STRONGEST_NOISE), rng)
    if found is None or not _worth_the_name(effect, recipe, found[0]):
        return None
    case = finished(rng, recipe, *found, name, row, (effect,), any_noise(rng))
    if effect in TIMELESS and rng.random() < 0.25:
        again = fresh(case.recipe, 1000)
        return replace(case, holdout=to_record(follow(again), recipe.scales, f"{name}.holdout"))
    return case


def _worth_the_name(effect: str, recipe: Recipe, setup: Setup) -> bool:
    """Whether the effect is one, and not a nuisance or another effect in disguise.

    A delay below a sample is nuisance, and so is a lag or a mode that such a delay would do for, or any other delay
    but in the short records; a dead band that the input leaves on one side alone is a limit.
    """
    a = setup.actuator
    if effect == "input-dead-zone":
        v = command(recipe)
        return bool(min(np.mean(v > a.dead_high), np.mean(v < a.dead_low)) > 0.08)
    if effect in ("extra-lag", "resonance"):
        left = gap(recipe, setup)
        if gap(recipe, setup, taps=3) <= 0.5 * left:
            return False
        return recipe.samples < 1000 or _left_by_delays(recipe, setup) > 0.3 * left
    return effect != "input-delay" or a.delay >= 1.0


def _left_by_delays(recipe: Recipe, setup: Setup) -> float:
    """What the best linear model with a delay of up to eight samples leaves; a third tap makes it any real one."""
    v, y = command(recipe), clean_output(recipe, setup)
    start = discrete_poles(poles(recipe.plain.motion))
    late = [np.concatenate([np.full(n, v[0]), v[:-n]]) for n in range(1, 8)]
    return min(fit_linear(u, y, start, taps=3, thorough=False).rmse for u in late)
