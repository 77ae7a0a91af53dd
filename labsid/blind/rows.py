"""Random draws of the cases of each row. A draw that fails returns None and is repeated with the next seed."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from labsid.blind.distinct import is_distinct
from labsid.blind.draws import (
    complete_case,
    distance_from_rig,
    draw_experiment,
    draw_mild_colour,
    draw_noise_colour,
    draw_partial_colour,
    example_rig,
    log_uniform,
    merge_effects,
    with_unexercised_effect,
)
from labsid.blind.experiment import Case, OrdinaryCase, input_signal, redraw, run_experiment, to_record
from labsid.blind.honest import draw_honest
from labsid.blind.joints import draw_joint
from labsid.blind.loops import draw_loop
from labsid.blind.output_error import discrete_poles, fit_linear
from labsid.blind.placed_effects import SIGNAL_ROWS
from labsid.blind.signals import draw_signals_clear, draw_signals_hard, draw_signals_none
from labsid.blind.strength import (
    CLEAR_RATIOS,
    FAINT_RATIOS,
    HARD_RATIOS,
    NEGLIGIBLE_RATIO,
    STRONGEST_NOISE,
    WEAKEST_NOISE,
    clean_output,
    linear_model_gap,
    output_spread,
    scale_to_ratio,
)
from labsid.rig.switchable.effects import EFFECTS, FAMILIES, draw_effect, effect_context, supports_effect
from labsid.rig.switchable.inputs import INPUT_KINDS, RICH_INPUTS
from labsid.rig.switchable.plants import RIGS
from labsid.rig.switchable.setup import Setup
from labsid.rig.switchable.simulation import poles
from labsid.rig.switchable.truth import true_linear_model
from labsid.rig.switchable.unlisted import UNLISTED_EFFECTS, draw_unlisted_effect, supports_unlisted_effect
from labsid.rig.switchable.variants import VARIANTS, draw_variant

EFFECTS_BESIDE_UNLISTED = tuple(
    name
    for name in EFFECTS
    if name not in ("output-quantization", "output-outliers", "output-dropout", "coloured-noise")
)
"""Effects that are found by simulation."""

Draw = Callable[[np.random.Generator, int, str], Case | OrdinaryCase | None]

_MANY_LEVELS = (*RICH_INPUTS, "staircase")
_KEEPS_MOVING = (*RICH_INPUTS, "two-level", "square")
_SUITABLE_INPUTS: dict[str, tuple[str, ...]] = {
    "input-saturation": RICH_INPUTS,
    "input-dead-zone": RICH_INPUTS,
    "input-backlash": RICH_INPUTS,
    "input-rate-limit": ("levels", "multisine"),
    "input-nonlinearity": RICH_INPUTS,
    "output-nonlinearity": RICH_INPUTS,
    "output-saturation": _MANY_LEVELS,
    "sqrt-outflow": _MANY_LEVELS,
    "overflow": _MANY_LEVELS,
    "coulomb-friction": _KEEPS_MOVING,
    "cubic-stiffness": _MANY_LEVELS,
    "parameter-drift": _KEEPS_MOVING,
    "output-drift": _KEEPS_MOVING,
    "end-stop": RICH_INPUTS,
    "quadratic-drag": RICH_INPUTS,
    "slow-mode": _MANY_LEVELS,
    "output-backlash": RICH_INPUTS,
}
"""Inputs that distinguish an effect from every other; two levels, for example, do not determine a static curve."""

_INDISTINGUISHABLE = {
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
"""Pairs of effects that a single record need not distinguish."""

TIME_INVARIANT_EFFECTS = {
    *(name for name in EFFECTS if name.startswith("input-")),
    *("extra-lag", "resonance", "sqrt-outflow", "overflow", "coulomb-friction", "cubic-stiffness"),
    *("output-saturation", "output-nonlinearity", "output-quantization"),
    *FAMILIES,
}
"""Effects that do not depend on time and recur in every record of the rig."""


def draw_single_clear(rng: np.random.Generator, i: int, name: str) -> Case | None:
    """One clear effect."""
    return _single(rng, EFFECTS[i % len(EFFECTS)], name, "single-clear", CLEAR_RATIOS)


def draw_single_hard(rng: np.random.Generator, i: int, name: str) -> Case | None:
    """One hard effect."""
    return _single(rng, EFFECTS[i % len(EFFECTS)], name, "single-hard", HARD_RATIOS)


def draw_short(rng: np.random.Generator, i: int, name: str) -> Case | None:
    """One effect in a short, noisy record with few levels, a fast additional pole and rounded corners."""
    return _short(rng, EFFECTS[i % len(EFFECTS)], name, "short", (3.0, 12.0))


def draw_pair(rng: np.random.Generator, i: int, name: str) -> Case | None:
    """Two effects, each clear alone and visible beside the other."""
    first_name = EFFECTS[i % len(EFFECTS)]
    second_name = str(rng.choice(EFFECTS))
    if first_name == second_name or frozenset((first_name, second_name)) in _INDISTINGUISHABLE:
        return None
    rigs = [rig for rig in RIGS if all(supports_effect(example_rig(rig), e) for e in (first_name, second_name))]
    suited = [
        x
        for x in _SUITABLE_INPUTS.get(first_name, _KEEPS_MOVING)
        if x in _SUITABLE_INPUTS.get(second_name, _KEEPS_MOVING) and x in _KEEPS_MOVING
    ]
    if not rigs or not suited:
        return None
    experiment = draw_experiment(rng, first_name, int(rng.integers(1200, 3001)), tuple(suited), tuple(rigs))
    at = effect_context(experiment.plain, input_signal(experiment))
    first, second = draw_effect(rng, first_name, at), draw_effect(rng, second_name, at)
    ratio = log_uniform(rng, 6.0, 18.0)
    scaled = scale_to_ratio(experiment, first, ratio, (WEAKEST_NOISE, 0.02), rng)
    if scaled is None:
        return None
    alone, sigma = scaled
    if not is_distinct(first_name, experiment, alone, sigma):
        return None
    share = sigma / output_spread(experiment)
    second_scaled = scale_to_ratio(experiment, second, log_uniform(rng, 6.0, 18.0), (0.8 * share, 1.25 * share), rng)
    if second_scaled is None or not is_distinct(second_name, experiment, *second_scaled):
        return None
    both = merge_effects(experiment.plain, alone, second_scaled[0])
    start = discrete_poles(poles(experiment.plain.motion))
    v, y = input_signal(experiment), clean_output(experiment, both)
    for part in (alone, second_scaled[0]):
        remaining = fit_linear(v, y - clean_output(experiment, part), start)
        if remaining.rmse < 3.0 * sigma:
            return None
    if fit_linear(v, y, start).rmse < CLEAR_RATIOS[0] * sigma:
        return None
    return complete_case(rng, experiment, both, sigma, name, "pair", (first_name, second_name), draw_noise_colour(rng))


def draw_none(rng: np.random.Generator, i: int, name: str) -> Case | None:
    """No effect, an effect that the record does not exercise, or negligible dynamics."""
    kind = ("plain", "coloured", "fast pole", "part of a sample", "not exercised", "fine converter")[i % 6]
    samples = int(rng.integers(300, 5001)) if rng.random() < 0.3 else int(rng.integers(1000, 3001))
    effect = str(rng.choice(_MAY_STAY_UNEXERCISED))
    experiment = draw_experiment(rng, effect, samples, INPUT_KINDS)
    sigma = output_spread(experiment) * log_uniform(rng, WEAKEST_NOISE, STRONGEST_NOISE)
    setup, taps = experiment.plain, 2
    if kind == "fast pole":
        lag: dict[str, Any] = {str(rng.choice(["actuator_lag", "sensor_lag"])): float(rng.uniform(0.05, 0.5))}
        setup = replace(setup, motion=setup.motion._replace(**lag))
    elif kind == "part of a sample":
        setup = replace(setup, actuator=replace(setup.actuator, delay=float(rng.integers(1, 8)) / 16))
        taps = 3
    elif kind == "fine converter":
        setup = replace(setup, sensor=replace(setup.sensor, step=0.3 * sigma))
    elif kind == "not exercised":
        setup = with_unexercised_effect(rng, experiment, effect)
    invisible = NEGLIGIBLE_RATIO * sigma
    gap = linear_model_gap(experiment, setup, taps)
    if gap > invisible:
        return None
    noise = draw_mild_colour(rng) if kind == "coloured" else draw_noise_colour(rng)
    absent = effect if kind == "not exercised" else None
    return complete_case(rng, experiment, setup, sigma, name, "none", (), noise, {"kind": kind, "hidden": absent})


def draw_unknown(rng: np.random.Generator, i: int, name: str) -> Case | None:
    """A clear effect outside the table."""
    effect = UNLISTED_EFFECTS[i % len(UNLISTED_EFFECTS)]
    rigs = tuple(rig for rig in RIGS if supports_unlisted_effect(example_rig(rig), effect))
    experiment = draw_experiment(rng, "", int(rng.integers(1200, 4001)), RICH_INPUTS, rigs)
    apply = draw_unlisted_effect(rng, effect, effect_context(experiment.plain, input_signal(experiment)))
    found = scale_to_ratio(experiment, apply, log_uniform(rng, 6.0, 25.0), (WEAKEST_NOISE, 0.03), rng)
    if found is None:
        return None
    return complete_case(
        rng, experiment, *found, name, "unknown", ("unknown",), draw_noise_colour(rng), {"kind": effect}
    )


def draw_partial(rng: np.random.Generator, i: int, name: str) -> Case | None:
    """A clear effect beside a smaller one outside the table, which stays larger than the noise."""
    listed = EFFECTS_BESIDE_UNLISTED[i % len(EFFECTS_BESIDE_UNLISTED)]
    unlisted = str(rng.choice(UNLISTED_EFFECTS))
    rigs = tuple(
        rig
        for rig in RIGS
        if supports_effect(example_rig(rig), listed) and supports_unlisted_effect(example_rig(rig), unlisted)
    )
    if not rigs:
        return None
    inputs = _SUITABLE_INPUTS.get(listed, RICH_INPUTS)
    experiment = draw_experiment(rng, listed, int(rng.integers(1200, 3001)), inputs, rigs)
    at = effect_context(experiment.plain, input_signal(experiment))
    ratio = log_uniform(rng, 10.0, 40.0)
    scaled = scale_to_ratio(experiment, draw_effect(rng, listed, at), ratio, (WEAKEST_NOISE, 0.02), rng)
    if scaled is None or not is_distinct(listed, experiment, *scaled):
        return None
    setup, sigma = scaled
    share = sigma / output_spread(experiment)
    apply = draw_unlisted_effect(rng, unlisted, at)
    beside = scale_to_ratio(experiment, apply, rng.uniform(0.15, 0.4) * ratio, (0.8 * share, 1.25 * share), rng)
    if beside is None:
        return None
    both = merge_effects(experiment.plain, setup, beside[0])
    noise = draw_noise_colour(rng)
    return complete_case(rng, experiment, both, sigma, name, "partial", (listed,), noise, {"kind": unlisted})


def draw_with_sim(rng: np.random.Generator, i: int, name: str) -> Case | None:
    """A record with a simulation: the true linear model, or one with wrong parameters."""
    kind = ("mismatch", "none", "effect")[i % 3]
    if kind == "effect":
        effect = EFFECTS[(i // 3) % len(EFFECTS)]
        case = _single(rng, effect, name, "with-sim", CLEAR_RATIOS)
        return (
            None
            if case is None
            else replace(case, sim=true_linear_model(case.experiment.plain, case.experiment.scales))
        )
    experiment = draw_experiment(rng, "", int(rng.integers(1200, 3001)), _KEEPS_MOVING)
    sigma = output_spread(experiment) * log_uniform(rng, WEAKEST_NOISE, 0.03)
    if kind == "none":
        steps = 0 if i % 2 else int(rng.integers(8, 33))
        sim = true_linear_model(experiment.plain, experiment.scales, steps)
        if distance_from_rig(sim, experiment) > NEGLIGIBLE_RATIO * sigma:
            return None
        what = {"kind": "another integrator" if steps else "true model"}
        return replace(
            complete_case(rng, experiment, experiment.plain, sigma, name, "with-sim", (), draw_noise_colour(rng), what),
            sim=sim,
        )
    m = experiment.plain.motion
    factor = np.exp(rng.choice([-1.0, 1.0], 3) * rng.uniform(0.08, 0.5, 3))
    wrong = replace(experiment.plain, motion=m._replace(T0=m.T0 * factor[0], T1=m.T1 * factor[1]))
    scales = replace(experiment.scales, ys=experiment.scales.ys * float(factor[2]))
    away = clean_output(experiment, wrong) * factor[2] - clean_output(experiment, experiment.plain)
    if np.std(away) < CLEAR_RATIOS[0] * sigma:
        return None
    labels = ("parameter-mismatch",)
    truth: dict[str, Any] = {"T0": float(factor[0]), "T1": float(factor[1]), "gain": float(factor[2])}
    case = complete_case(
        rng, experiment, experiment.plain, sigma, name, "with-sim", labels, draw_noise_colour(rng), truth
    )
    return replace(case, sim=true_linear_model(wrong, scales), level="clear", ratio=float(np.std(away) / sigma))


def draw_families(rng: np.random.Generator, i: int, name: str) -> Case | None:
    """One clear effect of those that the other rows do not draw."""
    return _single(rng, FAMILIES[i % len(FAMILIES)], name, "families", CLEAR_RATIOS)


def draw_variants(rng: np.random.Generator, i: int, name: str) -> Case | None:
    """Another form of an effect, clear, or end stops that the motion does not reach."""
    kind = (*VARIANTS, NOT_REACHED)[i % (len(VARIANTS) + 1)]
    effect = VARIANTS.get(kind, "end-stop")
    samples = int(rng.integers(1200, 4001))
    experiment = draw_experiment(rng, effect, samples, RICH_INPUTS)
    if kind == NOT_REACHED:
        sigma = output_spread(experiment) * log_uniform(rng, WEAKEST_NOISE, STRONGEST_NOISE)
        setup = with_unexercised_effect(rng, experiment, effect)
        if linear_model_gap(experiment, setup) > NEGLIGIBLE_RATIO * sigma:
            return None
        what = {"kind": "not exercised", "hidden": effect}
        return complete_case(rng, experiment, setup, sigma, name, "variants", (), draw_noise_colour(rng), what)
    apply = draw_variant(rng, kind, effect_context(experiment.plain, input_signal(experiment)))
    ratio = log_uniform(rng, *CLEAR_RATIOS)
    scaled = scale_to_ratio(experiment, apply, ratio, (WEAKEST_NOISE, STRONGEST_NOISE), rng)
    if scaled is None or not is_distinct(effect, experiment, *scaled):
        return None
    case = complete_case(rng, experiment, *scaled, name, "variants", (effect,), draw_noise_colour(rng))
    return replace(case, truth={**case.truth, "kind": kind})


def draw_runs(rng: np.random.Generator, i: int, name: str) -> Case | None:
    """Three short, noisy runs of one rig with a hard effect that does not depend on time."""
    effect = _RECURRING[i % len(_RECURRING)]
    case = _short(rng, effect, name, "runs", HARD_RATIOS)
    if case is None:
        return None
    experiments = [redraw(case.experiment, number) for number in (1, 2)]
    others = tuple(to_record(run_experiment(one), one.scales, name) for one in experiments)
    return replace(case, others=others)


def draw_faint(rng: np.random.Generator, i: int, name: str) -> Case | None:
    """One effect that is hardly visible."""
    return _single(rng, EFFECTS[i % len(EFFECTS)], name, "faint", FAINT_RATIOS)


def draw_several(rng: np.random.Generator, i: int, name: str) -> Case | None:
    """Two or three effects of different strength beside a small one outside the table; every other one has two records.

    Each of them leaves at least three times the noise if it is missing.
    """
    chosen = [EFFECTS_BESIDE_UNLISTED[i % len(EFFECTS_BESIDE_UNLISTED)]]
    for _ in range(1 + i % 2):
        apart = [
            e
            for e in _RECURRING
            if all(
                e != chosen_effect and frozenset((e, chosen_effect)) not in _INDISTINGUISHABLE
                for chosen_effect in chosen
            )
        ]
        chosen.append(str(rng.choice([e for e in apart if e in EFFECTS_BESIDE_UNLISTED])))
    unlisted = str(rng.choice(UNLISTED_EFFECTS))
    rigs = tuple(
        rig
        for rig in RIGS
        if supports_unlisted_effect(example_rig(rig), unlisted)
        and all(supports_effect(example_rig(rig), effect) for effect in chosen)
    )
    if not rigs:
        return None
    experiment = draw_experiment(rng, chosen[0], int(rng.integers(1200, 3001)), ("levels", "multisine"), rigs)
    at = effect_context(experiment.plain, input_signal(experiment))
    ratio = log_uniform(rng, 12.0, 40.0)
    scaled = scale_to_ratio(experiment, draw_effect(rng, chosen[0], at), ratio, (WEAKEST_NOISE, 0.02), rng)
    if scaled is None or not is_distinct(chosen[0], experiment, *scaled):
        return None
    setup, sigma = scaled
    share = sigma / output_spread(experiment)
    noises = (0.8 * share, 1.25 * share)
    parts = [setup]
    for effect in chosen[1:]:
        part = scale_to_ratio(experiment, draw_effect(rng, effect, at), rng.uniform(0.3, 0.8) * ratio, noises, rng)
        if part is None or not is_distinct(effect, experiment, *part):
            return None
        parts.append(part[0])
    rest = scale_to_ratio(
        experiment, draw_unlisted_effect(rng, unlisted, at), rng.uniform(0.08, 0.2) * ratio, noises, rng
    )
    if rest is None:
        return None
    parts.append(rest[0])
    whole = _merged(experiment.plain, parts)
    y = clean_output(experiment, whole)
    start = discrete_poles(poles(experiment.plain.motion))
    for part_alone in parts[:-1]:
        output_without = clean_output(
            experiment, _merged(experiment.plain, [part for part in parts if part is not part_alone])
        )
        if fit_linear(input_signal(experiment), y - output_without, start).rmse < 3.0 * sigma:
            return None
    case = complete_case(
        rng, experiment, whole, sigma, name, "several", tuple(chosen), draw_noise_colour(rng), {"kind": unlisted}
    )
    if i % 4 < 2 or chosen[0] not in TIME_INVARIANT_EFFECTS:
        return case
    again = redraw(case.experiment, 1000)
    return replace(case, holdout=to_record(run_experiment(again), experiment.scales, f"{name}.holdout"))


def _merged(plain: Setup, parts: Sequence[Setup]) -> Setup:
    """All effects of the parts."""
    whole = plain
    for part in parts:
        whole = merge_effects(plain, whole, part)
    return whole


ROWS: dict[str, Draw] = {
    "single-clear": draw_single_clear,
    "single-hard": draw_single_hard,
    "short": draw_short,
    "pair": draw_pair,
    "none": draw_none,
    "unknown": draw_unknown,
    "with-sim": draw_with_sim,
    "partial": draw_partial,
    "families": draw_families,
    "variants": draw_variants,
    "runs": draw_runs,
    "honest": draw_honest,
    "faint": draw_faint,
    "joints": draw_joint,
    "several": draw_several,
    "signals": draw_signals_clear,
    "signals-hard": draw_signals_hard,
    "signals-none": draw_signals_none,
    "loop": draw_loop,
}
"""The order determines the seeds: a new row comes last."""

ON_REQUEST: tuple[str, ...] = SIGNAL_ROWS
"""Rows that are made only if they are named, until the diagnosis reads several signals and references."""

DEFAULT_ROWS = tuple(row for row in ROWS if row not in ON_REQUEST)

NOT_REACHED = "end stops, not reached"

_RECURRING = tuple(name for name in EFFECTS if name in TIME_INVARIANT_EFFECTS)

_MAY_STAY_UNEXERCISED = ("input-saturation", "input-backlash", "coulomb-friction", "overflow", "output-saturation")


def _short(rng: np.random.Generator, effect: str, name: str, row: str, between: tuple[float, float]) -> Case | None:
    experiment = draw_experiment(rng, effect, int(rng.integers(300, 601)), ("staircase", "two-level"))
    plain = replace(
        experiment.plain, motion=experiment.plain.motion._replace(actuator_lag=float(rng.uniform(0.1, 0.5)))
    )
    experiment = replace(experiment, plain=plain)
    at = effect_context(plain, input_signal(experiment), rounding=float(rng.uniform(0.01, 0.05)))
    ratio = log_uniform(rng, *between)
    found = scale_to_ratio(experiment, draw_effect(rng, effect, at), ratio, (0.02, 0.05), rng)
    if found is None or not is_distinct(effect, experiment, *found):
        return None
    return complete_case(rng, experiment, *found, name, row, (effect,), draw_partial_colour(rng))


def _single(rng: np.random.Generator, effect: str, name: str, row: str, between: tuple[float, float]) -> Case | None:
    samples = int(np.exp(rng.uniform(np.log(1200), np.log(5000))))
    experiment = draw_experiment(rng, effect, samples, _SUITABLE_INPUTS.get(effect, INPUT_KINDS))
    apply = draw_effect(rng, effect, effect_context(experiment.plain, input_signal(experiment)))
    found = scale_to_ratio(experiment, apply, log_uniform(rng, *between), (WEAKEST_NOISE, STRONGEST_NOISE), rng)
    if found is None or not is_distinct(effect, experiment, *found):
        return None
    case = complete_case(rng, experiment, *found, name, row, (effect,), draw_noise_colour(rng))
    if effect in TIME_INVARIANT_EFFECTS and rng.random() < 0.25:
        again = redraw(case.experiment, 1000)
        return replace(case, holdout=to_record(run_experiment(again), experiment.scales, f"{name}.holdout"))
    return case
