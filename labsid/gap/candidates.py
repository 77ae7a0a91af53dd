"""Candidates: every effect refitted jointly with the linear part, alone or on top of others."""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from labsid._arrays import FloatArray
from labsid.gap.data import Data
from labsid.gap.effects import drifts, dynamics, input, output
from labsid.gap.effects.base import Effect, Fitted, InputEffect, PlantEffect
from labsid.gap.effects.context import Context
from labsid.gap.fitting import Fit, Point, finish, minimize, start_cost
from labsid.gap.forms import (
    INNER_LOAD,
    INNER_PERIODIC,
    LAGS,
    LEAK,
    LOAD,
    MODES,
    PERIODIC,
    SENSOR_DRIFTS,
    extended_hypotheses,
    leak_form,
    leak_starts,
)
from labsid.gap.hypothesis import Hypothesis
from labsid.gap.plants import Plant
from labsid.gap.responses import real_rates, single_pole
from labsid.gap.undriven_poles import has_undriven_pole

STARTS_PER_VARIANT = 8  # starts of one variant that are followed
MAX_OBSERVED_RATE, RESTART_RATE = 2.0, 0.5  # rates, a sample
MASS_FREQUENCIES = 0.1, 0.4  # frequencies of a mass, a sample
MIN_STIFFNESS_RATIO = 4.0  # times k, from which another search begins
MAX_SINGLE_RATE = 1.0  # rate, a sample, of a state that could hardly be seen to be nonlinear
SINUSOID_STEP, MAX_SINUSOID = (
    0.1,
    3.0,
)  # size of a wave inside: with which what it does is tried, and where a search begins
QUICK_STARTS = 4  # of all variants of a second or third effect

CANDIDATES: tuple[tuple[Effect, ...], ...] = (
    (input.Delay(), input.Delay("no-zero")),
    (input.Saturation("high"), input.Saturation("low"), input.Saturation("both")),
    (input.DeadZone(),),
    (input.Backlash(),),
    (input.RateLimit(),),
    (input.Nonlinearity(),),
    LAGS,
    MODES,
    tuple(dynamics.SqrtOutflow(which + side) for which in ("both", "upper", "lower") for side in ("", "-flipped")),
    tuple(dynamics.Overflow(which + side) for which in ("upper", "lower") for side in ("", "-flipped")),
    tuple(dynamics.CoulombFriction(which) for which in ("position", "unsprung", "speed", "speed-lag")),
    (dynamics.CubicStiffness(), dynamics.CubicStiffness("sampled")),
    tuple(
        drift(bends) for drift in (drifts.GainDrift, drifts.PoleDrift, drifts.InnerPoleDrift) for bends in ("1", "4")
    ),
    SENSOR_DRIFTS,
    (output.Saturation("high"), output.Saturation("low"), output.Saturation("both")),
    (output.Nonlinearity(),),
    (LOAD, LEAK, INNER_LOAD),
    (PERIODIC, INNER_PERIODIC),
)


@dataclass(frozen=True, slots=True, eq=False)
class Trial:
    """One effect on top of a parent after a few steps of the search.

    Attributes
    ----------
    hypothesis : Hypothesis
    point : Point
    score : float
        BIC of its error taken as white; lower is better.
    """

    hypothesis: Hypothesis
    point: Point
    score: float


def trial_fits(data: Data, parent: Fit, group: tuple[Effect, ...], highpass: Fit, brief: bool = False) -> list[Trial]:
    """The parent with one effect more: a few steps from the promising starts of every variant, best first.

    Empty where the record cannot show the effect; `brief` takes fewer starts and steps.
    """
    context = Context(data, parent, highpass)
    looked = []
    for effect in group:
        if effect.applies(context) and is_compatible(parent, effect):
            for hypothesis in extended_hypotheses(parent.hypothesis, effect):
                tried = [
                    (start_cost(data, hypothesis, theta), hypothesis, theta)
                    for theta in start_points(context, hypothesis, effect)
                ]
                looked += sorted(tried, key=_first)[:STARTS_PER_VARIANT]
    if brief:
        looked = _quick_selection(looked)
    found = []
    for _, hypothesis, theta in looked:
        point = minimize(data, hypothesis, theta, iterations=2 if brief else 3, tolerance=1e-2)
        if point is not None:
            found.append(_trial(data, hypothesis, point))
    return sorted(found, key=lambda trial: trial.score)


def _quick_selection(looked: list[tuple[float, Hypothesis, FloatArray]]) -> list[tuple[float, Hypothesis, FloatArray]]:
    """A few starts: the best one of each of the best variants, then the next best."""
    ranked = sorted(looked, key=_first)
    seen: set[Hypothesis] = set()
    first = [not (item[1] in seen or seen.add(item[1])) for item in ranked]  # type: ignore[func-returns-value]
    order = sorted(range(len(ranked)), key=lambda i: not first[i])
    return [ranked[i] for i in order[:QUICK_STARTS]]


def refine_first(data: Data, tried: list[Trial]) -> list[Trial]:
    """The same trials, the best of them a few steps further."""
    return [_continued(data, tried[0], 4), *tried[1:]]


def _trial(data: Data, hypothesis: Hypothesis, point: Point) -> Trial:
    count = int(data.rows.sum())
    free = point.theta.size + np.count_nonzero(point.gains)
    return Trial(hypothesis, point, count * np.log(point.cost) + free * np.log(count))


def _first(item: tuple[float, Hypothesis, FloatArray]) -> float:
    return item[0]


def best_fit(data: Data, tried: list[Trial], kept: int = 3) -> Fit | None:
    """The best of a few trials, taken to the end; None where none of them is the effect it says it is."""
    best: Fit | None = None
    for trial in _two_variants(_reranked(data, tried, 2 * kept), kept):
        end = minimize(data, trial.hypothesis, trial.point.theta, trial.point.gains, iterations=25, tolerance=1e-5)
        if end is None:
            continue
        fit = finish(data, trial.hypothesis, end)
        for one in (fit, _as_leak(data, fit)):
            if (
                one is not None
                and is_plausible(data, one)
                and (best is None or penalized_bic(one) < penalized_bic(best))
            ):
                best = one
    return best


def _reranked(data: Data, tried: list[Trial], count: int) -> list[Trial]:
    """The first few trials some steps further, in their new order: the best start is not always ahead at once."""
    if len(tried) <= count // 2:
        return tried
    return sorted((_continued(data, trial, 6) for trial in tried[:count]), key=lambda trial: trial.score)


def _continued(data: Data, trial: Trial, iterations: int) -> Trial:
    start = trial.point
    point = minimize(data, trial.hypothesis, start.theta, start.gains, iterations=iterations, tolerance=1e-2)
    return trial if point is None else _trial(data, trial.hypothesis, point)


def is_plausible(data: Data, fit: Fit, last: int = 1) -> bool:
    """Whether the `last` effects are, by their numbers, the ones that they say they are."""
    fitted = Fitted(fit.hypothesis, fit.theta, fit.gains, data)
    effects = fit.hypothesis.effects[-last:]
    if any(effect in (*LAGS, *MODES) for effect in effects) and has_undriven_pole(data, fit):
        return False  # the rig has taken the new pole, and the old ones are a drift or a wave
    return all(effect.is_plausible(fitted) for effect in effects)


def _as_leak(data: Data, fit: Fit) -> Fit | None:
    """A load step as one that grows, from where it has brought the dynamics; None where they cannot hold one."""
    old = fit.hypothesis
    grown = leak_form(old.plant)
    if old.effects[-1] != LOAD or grown is None:
        return None
    other = Hypothesis((*old.effects[:-1], grown), old.n_given, old.given)
    points = (minimize(data, other, start, iterations=12, tolerance=1e-5) for start in leak_starts(fit, other))
    return min((finish(data, other, point) for point in points if point is not None), key=penalized_bic, default=None)


def penalized_bic(fit: Fit) -> float:
    """BIC, and what a form of an effect has to gain over a simpler one."""
    return fit.bic + sum(effect.bic_penalty.get(effect.variant, 0.0) for effect in fit.hypothesis.effects)


def _two_variants(tried: list[Trial], kept: int) -> list[Trial]:
    """The first few trials; the last of them is of another variant than the first one."""
    chosen = tried[:kept]
    if chosen and all(trial.hypothesis == chosen[0].hypothesis for trial in chosen):
        other = next((trial for trial in tried if trial.hypothesis != chosen[0].hypothesis), None)
        if other is not None:
            chosen = [*chosen[: max(kept - 1, 1)], other]
    return chosen


def is_compatible(parent: Fit, effect: Effect) -> bool:
    """Whether the effect's kind of dynamics can hold what the parent's already has."""
    old = parent.hypothesis.plant
    if old.kind == "given":
        return old.takes_input if isinstance(effect, InputEffect) else not isinstance(effect, PlantEffect)
    if not isinstance(effect, PlantEffect):
        return True
    new = effect.extend(old)
    if old.kind == "varying" and old.course == "slow" and new.nonlinear:
        return True
    return old.kind == "linear" or (new.kind == old.kind and new.flipped == old.flipped)


def start_points(context: Context, hypothesis: Hypothesis, effect: Effect) -> Iterable[FloatArray]:
    """Full thetas: the parent's numbers where it has them, the effect's starts where it brings new ones."""
    parent = context.parent
    common = np.zeros(len(hypothesis.parameters))
    if not hypothesis.delay_is_an_effect and not parent.hypothesis.delay_is_an_effect:
        common[0] = parent.theta[0]
    for key, place in parent.hypothesis.slices.items():
        if key != "plant" and key in hypothesis.slices:
            common[hypothesis.slices[key]] = parent.theta[place]
    place = hypothesis.slices["plant"]
    load = _inner_load_start(context) if INNER_LOAD in hypothesis.effects and LOAD in parent.hypothesis.effects else {}
    shaken = INNER_PERIODIC in hypothesis.effects and INNER_PERIODIC not in parent.hypothesis.effects
    load |= _inner_cycles(context) if shaken and effect != INNER_PERIODIC else {}
    in_plant = isinstance(effect, PlantEffect)
    named_starts = effect.plant_starts(context) if isinstance(effect, PlantEffect) else [{}]
    own_starts = [np.zeros(0)] if in_plant else effect.starts(context)
    for base in _plant_starts(context, hypothesis.plant):
        for named in named_starts:
            for own in own_starts:
                full = common.copy()
                full[place] = _updated(hypothesis.plant, base, load | named)
                if not in_plant:
                    full[hypothesis.slices[effect.key]] = own
                yield _with_linear_sinusoid(context.data, hypothesis, full) if shaken else full


def _inner_load_start(context: Context) -> dict[str, float]:
    """A load step of the parent as the change of the input that would do the same to the output."""
    fit = context.parent
    size = LOAD.change(Fitted(fit.hypothesis, fit.theta, fit.gains, context.data))
    gain = context.gain
    onset = float(fit.theta[fit.hypothesis.slices[LOAD.key]][0])
    return {"onset": onset, "load": float(np.clip(-size / gain, -20.0, 20.0)) if gain else 0.0}


def _inner_cycles(context: Context) -> dict[str, float]:
    """How often the wave of the parent swings in the record."""
    fit = context.parent
    wave = next(effect for effect in fit.hypothesis.effects if effect.name == INNER_PERIODIC.name)
    return {"cycles": float(fit.theta[fit.hypothesis.slices[wave.key]][0])}


def _with_linear_sinusoid(data: Data, hypothesis: Hypothesis, theta: FloatArray) -> FloatArray:
    """The same numbers with size and phase of a wave inside, as they should be if the dynamics were linear."""
    at = [hypothesis.slices["plant"].start + hypothesis.plant.index(name) for name in ("shake_cos", "shake_sin")]
    still = hypothesis.design(theta, data.u).columns
    moved = []
    for i in at:
        one = theta.copy()
        one[i] = SINUSOID_STEP
        moved.append((hypothesis.design(one, data.u).columns[:, 0] - still[:, 0]) / SINUSOID_STEP)
    columns = np.column_stack([still, *moved])[data.rows]
    if not np.isfinite(columns).all():
        return theta
    gains = np.linalg.lstsq(columns, data.y[data.rows])[0]
    out = theta.copy()
    out[at] = np.clip(gains[-2:] / (gains[0] or np.inf), -MAX_SINUSOID, MAX_SINUSOID)
    return out


def _plant_starts(context: Context, new: Plant) -> list[FloatArray]:
    """The parent's plant carried over to the new kind of plant, at its own rates and at those of the highpass part."""
    parent = context.parent
    old = parent.hypothesis.plant
    kept = {p.name: value for p, value in zip(old.parameters, parent.plant_theta, strict=True)}
    rates = [context.rates]
    if np.abs(np.log(np.divide(context.highpass_rates, context.rates))).max() > 0.2:
        rates.append(context.highpass_rates)
    slow, fast = real_rates(*context.rates)
    if fast > MAX_OBSERVED_RATE:  # a pole that a fit has lost: nothing would draw it back
        rates.append((slow + RESTART_RATE, slow * RESTART_RATE))
    if new.kind in ("tanks", "speed") and old.kind == "linear":  # one tank, one inertia
        rates += [single_pole(rate) for rate in _single_pole_rates(context, slow, fast)]
    if new.friction and new.kind == "mechanics" and old.kind == "linear":  # to which linear dynamics are sluggish
        rates += [(w, w**2) for w in MASS_FREQUENCIES if w**2 > MIN_STIFFNESS_RATIO * context.rates[1]]
    bases = []
    for n, (c, k) in enumerate(rates):
        for base in new.starts(c, k):
            for i, parameter in enumerate(new.parameters):
                if parameter.name in kept and not (i < 2 and (n or old.kind != new.kind)):
                    base[i] = kept[parameter.name]
            bases.append(base)
            if old.kind == new.kind:
                if new.kind == "tanks" and not (old.upper_root or old.lower_root):
                    swapped = base.copy()  # without roots the order of the two tanks hardly matters
                    swapped[:2] = base[1::-1]
                    bases.append(swapped)
                break
    return bases


def _single_pole_rates(context: Context, slow: float, fast: float) -> list[float]:
    """Rates of one state that may have to do for both: that of the whole, and either pole, without near equals."""
    found: list[float] = []
    for rate in (1.0 / max(context.response_time, 1e-9), fast, slow):
        if 1.0 / context.data.samples < rate < MAX_SINGLE_RATE and all(
            abs(np.log(rate / other)) > 0.5 for other in found
        ):
            found.append(rate)
    return found


def _updated(plant: Plant, base: FloatArray, named: dict[str, float]) -> FloatArray:
    """`base` with the named parameters set; a name that ends in "+" is added to."""
    theta = base.copy()
    names = [p.name for p in plant.parameters]
    for name, value in named.items():
        if name.endswith("+"):
            theta[names.index(name[:-1])] += value
        elif name in names:
            theta[names.index(name)] = value
    return theta
