"""Candidates: every effect refitted jointly with the linear part, alone or on top of others."""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from labsid._arrays import FloatArray
from labsid.gap.context import Context, Data
from labsid.gap.effects import disturbance, drifting, dynamics, input, output
from labsid.gap.effects.base import Effect, Fitted, InputEffect, PlantEffect
from labsid.gap.fitting import Fit, Point, at_start, finish, search
from labsid.gap.hypothesis import Hypothesis
from labsid.gap.plants import Plant

LINEAR = Hypothesis()
PROMISING = 8  # starts of one variant that are followed
BRIEFLY = 3  # of all variants of a second or third effect

CANDIDATES: tuple[tuple[Effect, ...], ...] = (
    (input.Delay(), input.Delay("no-zero")),
    (input.Saturation("high"), input.Saturation("low"), input.Saturation("both")),
    (input.DeadZone(),),
    (input.Backlash(),),
    (input.RateLimit(),),
    (input.Nonlinearity(),),
    (dynamics.ExtraLag(),),
    (dynamics.Resonance(),),
    tuple(dynamics.SqrtOutflow(which + side) for which in ("both", "upper", "lower") for side in ("", "-flipped")),
    tuple(dynamics.Overflow(which + side) for which in ("upper", "lower") for side in ("", "-flipped")),
    tuple(dynamics.CoulombFriction(which) for which in ("position", "speed", "speed-lag")),
    (dynamics.CubicStiffness(),),
    (drifting.GainDrift("1"), drifting.GainDrift("4"), drifting.PoleDrift("1"), drifting.PoleDrift("3")),
    tuple(output.Drift(variant) for variant in ("1", "3", "6", "10", "settle")),
    (output.Saturation("high"), output.Saturation("low"), output.Saturation("both")),
    (output.Nonlinearity(),),
    (disturbance.LoadStep(), disturbance.Leak("leak")),
    (disturbance.Periodic(),),
)

PLACES: tuple[tuple[Effect, ...], ...] = (
    (dynamics.ExtraLag(), dynamics.ExtraLag("ahead")),
    (dynamics.Resonance(), dynamics.Resonance("ahead"), dynamics.Resonance("beside")),
    (dynamics.CoulombFriction("speed"), dynamics.CoulombFriction("speed-lag")),
)
"""What may stand at several places of the chain, which are the same to linear dynamics."""
ORDERS: tuple[tuple[Effect, ...], ...] = (
    (input.RateLimit(), input.RateLimit("behind")),
    (input.Nonlinearity(), input.Nonlinearity("first")),
)
"""What may stand at several places of the actuator, which are the same where nothing else bends the command."""
SIMPLER: dict[Effect, Effect] = {disturbance.Leak("leak"): disturbance.LoadStep()}
"""Special cases that the search of the general one may miss."""


def rearranged(hypothesis: Hypothesis) -> list[Hypothesis]:
    """The same effects in another form: a lag or a mode at another place to a nonlinear state, or a special case."""
    found = []
    for i, effect in enumerate(hypothesis.effects[hypothesis.known :], hypothesis.known):
        forms = [SIMPLER[effect]] if effect in SIMPLER else []
        groups = PLACES if hypothesis.plant.nonlinear else ()
        groups += ORDERS if sum(e.name != "input-delay" for e in hypothesis.inputs) > 1 else ()
        forms += [form for group in groups if effect in group for form in group if form != effect]
        for form in forms:
            effects = (*hypothesis.effects[:i], form, *hypothesis.effects[i + 1 :])
            found.append(Hypothesis(effects, hypothesis.known, hypothesis.given))
    return found


def carried(fit: Fit, other: Hypothesis) -> FloatArray:
    """Numbers of a fit for a hypothesis of other forms: of the same part, or, by name, of a part that it has not."""
    old = fit.hypothesis
    theta = np.zeros(len(other.parameters))
    spare: dict[str, float] = {}
    for key, place in old.slices.items():
        if key == "plant" or key not in other.slices:
            spare |= {p.name: x for p, x in zip(old.parameters[place], fit.theta[place], strict=True)}
    for i, parameter in enumerate(other.parameters):
        theta[i] = spare.get(parameter.name, 0.0)
    for key, place in other.slices.items():
        if key != "plant" and key in old.slices:
            theta[place] = fit.theta[old.slices[key]]
    if not other.slices_has_delay:
        theta[0] = fit.theta[0]
    return theta


def without(data: Data, fit: Fit, which: int) -> Fit | None:
    """A fit as it is but for one of its effects; None where that cannot be simulated."""
    old = fit.hypothesis
    other = Hypothesis((*old.effects[:which], *old.effects[which + 1 :]), old.known, old.given)
    starts = [carried(fit, other)]
    place, before, now = other.slices["plant"], old.plant, other.plant
    if (before.kind, before.upper_root, before.lower_root) != (now.kind, now.upper_root, now.lower_root):
        rates = [base[:2] for base in now.starts(*fit.rates)]
        starts = [starts[0].copy() for _ in rates]
        for start, pair in zip(starts, rates, strict=True):
            start[place][:2] = pair
    points = [point for start in starts if (point := search(data, other, start, iterations=0)) is not None]
    return finish(data, other, min(points, key=lambda point: point.cost)) if points else None


def baseline(data: Data, hypothesis: Hypothesis = LINEAR, known: FloatArray | None = None) -> Fit:
    """Fit a structure, unless given the lab's (second order, strictly proper), by output error.

    A structure with its effects' numbers `known` begins from there.
    """
    best = None if known is None else search(data, hypothesis, known, iterations=12)
    for slow, fast in ((0.02, 0.3), (0.1, 0.5), (0.005, 0.05), (0.3, 1.5)):
        start = _linear_theta(hypothesis, slow + fast, slow * fast)
        best = _better(best, search(data, hypothesis, start, iterations=12))
    for frequency in (0.05, 0.2, 0.8):
        start = _linear_theta(hypothesis, 0.4 * frequency, frequency**2)
        best = _better(best, search(data, hypothesis, start, iterations=12))
    if best is None:
        raise ValueError("no second-order model can be simulated on this record.")
    best = search(data, hypothesis, best.theta, iterations=30, tolerance=1e-8) or best
    return finish(data, hypothesis, best)


def _linear_theta(hypothesis: Hypothesis, c: float, k: float) -> FloatArray:
    """A start at given rates; a further pole or mode of the structure a little faster."""
    theta = np.zeros(len(hypothesis.parameters))
    names = [parameter.name for parameter in hypothesis.parameters]
    guess = {
        "delay": 0.2,
        "log_c": np.log(c),
        "log_k": np.log(k),
        "log_lag": 0.0,
        "log_frequency": 0.5 * np.log(k) + 0.7,
        "log_damping": -1.5,
    }
    for i, name in enumerate(names):
        theta[i] = guess.get(name, 0.0)
    return theta


def swift_fit(data: Data, base: Fit) -> Fit:
    """The same structure fitted to what changes from sample to sample: drifts and load steps hardly reach it."""
    hypothesis = Hypothesis((output.Drift("10"),))
    ar = np.array([0.9])
    best: Point | None = None
    known = base.theta if base.theta.size == len(hypothesis.parameters) else _linear_theta(hypothesis, *base.rates)
    for theta in (known, _linear_theta(hypothesis, 0.3, 0.01), _linear_theta(hypothesis, 1.0, 0.1)):
        best = _better(best, search(data, hypothesis, theta, iterations=12, ar=ar))
    return base if best is None else finish(data, hypothesis, best)


def _better(a: Point | None, b: Point | None) -> Point | None:
    if a is None or (b is not None and b.cost < a.cost):
        return b
    return a


@dataclass(frozen=True, slots=True, eq=False)
class Sketch:
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


def sketches(data: Data, parent: Fit, group: tuple[Effect, ...], swift: Fit, brief: bool = False) -> list[Sketch]:
    """The parent with one effect more: a few steps from the promising starts of every variant, best first.

    Empty where the record cannot show the effect; `brief` takes fewer starts and steps.
    """
    context = Context(data, parent, swift)
    looked = []
    for effect in group:
        if effect.applies(context) and compatible(parent, effect):
            hypothesis = parent.hypothesis.plus(effect)
            tried = [
                (at_start(data, hypothesis, theta), hypothesis, theta) for theta in starts(context, hypothesis, effect)
            ]
            looked += sorted(tried, key=_first)[:PROMISING]
    if brief:
        looked = sorted(looked, key=_first)[:BRIEFLY]
    found = []
    for _, hypothesis, theta in looked:
        point = search(data, hypothesis, theta, iterations=2 if brief else 3, tolerance=1e-2)
        if point is not None:
            found.append(_sketch(data, hypothesis, point))
    return sorted(found, key=lambda sketch: sketch.score)


def onward(data: Data, tried: list[Sketch]) -> list[Sketch]:
    """The same sketches, the best of them a few steps further."""
    first = tried[0]
    point = search(data, first.hypothesis, first.point.theta, first.point.gains, iterations=4, tolerance=1e-2)
    return [first if point is None else _sketch(data, first.hypothesis, point), *tried[1:]]


def _sketch(data: Data, hypothesis: Hypothesis, point: Point) -> Sketch:
    count = int(data.rows.sum())
    free = point.theta.size + np.count_nonzero(point.gains)
    return Sketch(hypothesis, point, count * np.log(point.cost) + free * np.log(count))


def _first(item: tuple[float, Hypothesis, FloatArray]) -> float:
    return item[0]


def finished(data: Data, tried: list[Sketch], kept: int = 3) -> Fit | None:
    """The best of a few sketches, taken to the end; None where none of them is the effect it says it is."""
    best: Fit | None = None
    for sketch in _various(tried, kept):
        end = search(data, sketch.hypothesis, sketch.point.theta, sketch.point.gains, iterations=12, tolerance=1e-5)
        if end is not None:
            fit = finish(data, sketch.hypothesis, end)
            effect = sketch.hypothesis.effects[-1]
            if effect.holds(Fitted(sketch.hypothesis, fit.theta, fit.gains, data)) and (
                best is None or price(fit) < price(best)
            ):
                best = fit
    return best


def price(fit: Fit) -> float:
    """BIC, and what a form of an effect has to gain over a simpler one."""
    return fit.bic + sum(effect.surplus for effect in fit.hypothesis.effects)


def _various(tried: list[Sketch], kept: int) -> list[Sketch]:
    """The first few sketches; the last of them is of another variant than the first one."""
    chosen = tried[:kept]
    if chosen and all(sketch.hypothesis == chosen[0].hypothesis for sketch in chosen):
        other = next((sketch for sketch in tried if sketch.hypothesis != chosen[0].hypothesis), None)
        if other is not None:
            chosen = [*chosen[: max(kept - 1, 1)], other]
    return chosen


def compatible(parent: Fit, effect: Effect) -> bool:
    """Whether the effect's kind of dynamics can hold what the parent's already has."""
    old = parent.hypothesis.plant
    if old.kind == "given":
        return old.takes_input if isinstance(effect, InputEffect) else not isinstance(effect, PlantEffect)
    if not isinstance(effect, PlantEffect):
        return True
    new = effect.shape(old)
    return old.kind == "linear" or (new.kind == old.kind and new.flipped == old.flipped)


def starts(context: Context, hypothesis: Hypothesis, effect: Effect) -> Iterable[FloatArray]:
    """Full thetas: the parent's numbers where it has them, the effect's starts where it brings new ones."""
    parent = context.parent
    common = np.zeros(len(hypothesis.parameters))
    if not hypothesis.slices_has_delay and not parent.hypothesis.slices_has_delay:
        common[0] = parent.theta[0]
    for key, place in parent.hypothesis.slices.items():
        if key != "plant":
            common[hypothesis.slices[key]] = parent.theta[place]
    place = hypothesis.slices["plant"]
    in_plant = isinstance(effect, PlantEffect)
    named_starts = effect.plant_starts(context) if isinstance(effect, PlantEffect) else [{}]
    own_starts = [np.zeros(0)] if in_plant else effect.starts(context)
    for base in _plant_bases(context, hypothesis.plant):
        for named in named_starts:
            for own in own_starts:
                full = common.copy()
                full[place] = _with(hypothesis.plant, base, named)
                if not in_plant:
                    full[hypothesis.slices[effect.key]] = own
                yield full


def _plant_bases(context: Context, new: Plant) -> list[FloatArray]:
    """The parent's plant carried over to the new kind of plant, at its own rates and at those of the swift part."""
    parent = context.parent
    old = parent.hypothesis.plant
    kept = {p.name: value for p, value in zip(old.parameters, parent.plant_theta, strict=True)}
    rates = [context.rates]
    if np.abs(np.log(np.divide(context.swift_rates, context.rates))).max() > 0.2:
        rates.append(context.swift_rates)
    bases = []
    for n, (c, k) in enumerate(rates):
        for base in new.starts(c, k):
            for i, parameter in enumerate(new.parameters):
                if parameter.name in kept and not (i < 2 and (n or old.kind != new.kind)):
                    base[i] = kept[parameter.name]
            bases.append(base)
            if old.kind == new.kind:
                break
    return bases


def _with(plant: Plant, base: FloatArray, named: dict[str, float]) -> FloatArray:
    """`base` with the named parameters set; a name that ends in "+" is added to."""
    theta = base.copy()
    names = [p.name for p in plant.parameters]
    for name, value in named.items():
        if name.endswith("+"):
            theta[names.index(name[:-1])] += value
        elif name in names:
            theta[names.index(name)] = value
    return theta
