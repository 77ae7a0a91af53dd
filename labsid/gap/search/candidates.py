"""Fit a parent hypothesis with one more effect, jointly with its linear part."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from operator import attrgetter

import numpy as np

from labsid._arrays import FloatArray
from labsid.gap.dynamics.plants import Plant
from labsid.gap.dynamics.responses import MAX_OBSERVED_RATE, real_rates, single_pole
from labsid.gap.effects.base import Effect, Fitted, InputEffect, PlantEffect
from labsid.gap.effects.context import Context
from labsid.gap.effects.dynamics import Placed
from labsid.gap.effects.inside import INSIDE_NAMES, Inside
from labsid.gap.fits.fitting import Fit, Point, Problem, descend, evaluate, finish, fit_from, mean_square
from labsid.gap.fits.hypothesis import Hypothesis
from labsid.gap.fits.undriven_poles import has_undriven_pole
from labsid.gap.record.data import Data
from labsid.gap.search.forms import alternative_forms, extended_hypotheses, forms_at, shared_keys, transfer_theta
from labsid.gap.search.growing_window import grown_starts, loses_phase
from labsid.gap.search.part import LONG, beginning, on_part

STARTS_PER_VARIANT = 8  # best start points that are minimized; measured: the right one was up to the eighth
RESTART_RATE = 0.5  # per sample: start value for such a pole; numerics
MASS_FREQUENCIES = 0.1, 0.4  # radians per sample: start values of a mass with friction; numerics
MIN_STIFFNESS_RATIO = 4.0  # stiffness of such a start over that of the parent; numerics
MAX_SINGLE_RATE = 1.0  # per sample: nonlinearity of a faster state is hardly observable; set by hand
SLOW_RATIO = 4.0  # mean square error over the variance of its innovations, from which a residual is slow; set by hand
QUICK_STARTS = 4  # start points of all variants of a second or third effect; numerics


@dataclass(frozen=True, slots=True, eq=False)
class Trial:
    """A parent with one more effect, at a start or after a few iterations.

    Attributes
    ----------
    problem : Problem
        On the record, or on the beginning of a long one.
    point : Point
    scale : (float, float)
        Of the score: a number of samples, and the logarithm of a mean square error. Those of the whole record, and of
        the parent on the same samples, where scores on a long record are compared with scores on its beginning.
    """

    problem: Problem
    point: Point
    scale: tuple[int, float] | None = None

    @property
    def hypothesis(self) -> Hypothesis:
        """The hypothesis."""
        return self.problem.hypothesis

    @property
    def score(self) -> float:
        """BIC under white noise; lower is better."""
        count, error = self.scale or (self.problem.count, 0.0)
        free = self.point.theta.size + np.count_nonzero(self.point.gains)
        return float(count * (np.log(self.point.cost) - error) + free * np.log(count))

    def continued(self, iterations: int) -> "Trial":
        """The trial after some more iterations."""
        return replace(self, point=descend(self.problem, self.point, iterations, tolerance=1e-2))

    def on(self, data: Data) -> "Trial | None":
        """The trial on the whole record; None if it cannot be simulated there."""
        if self.problem.data is data:
            return self
        problem = Problem(data, self.hypothesis)
        point = problem.start(self.point.theta, self.point.gains)
        return None if point is None else Trial(problem, point)


def trial_fits(data: Data, parent: Fit, group: tuple[Effect, ...], highpass: Fit, brief: bool = False) -> list[Trial]:
    """Add one effect of a group to the parent: a few iterations from the best starts of every variant, best first.

    The list is empty if the record cannot identify the effect. `brief` uses fewer starts and iterations.
    """
    whole, data = data, beginning(data, parent, (group[0].name,))
    parent, highpass = (on_part(whole, data, fit) for fit in (parent, highpass))
    scale = (whole.samples, float(np.log(mean_square(data, parent)))) if whole.samples >= LONG else None
    context = Context(data, parent, highpass)
    selected: list[Trial] = []
    lost = not brief and loses_phase(data, parent)
    for effect in group:
        if effect.applies(context) and is_compatible(parent, effect):
            for hypothesis in extended_hypotheses(parent.hypothesis, effect):
                problem = Problem(data, hypothesis)
                thetas = list(start_points(context, hypothesis, effect))
                if lost and isinstance(effect, Inside) and not hypothesis.plant.changes_in_time:
                    thetas += list(grown_starts(data, hypothesis, thetas))
                points = evaluate(problem, thetas)
                starts = [Trial(problem, point, scale) for point in sorted(points, key=attrgetter("cost"))]
                selected += _in_turn(starts)[:STARTS_PER_VARIANT]
    return _continued(_quick_selection(selected), 2) if brief else _continued(selected, 3)


def _continued(trials: list[Trial], iterations: int) -> list[Trial]:
    """The trials after some more iterations, best first."""
    return sorted((trial.continued(iterations) for trial in trials), key=attrgetter("score"))


def _in_turn(ranked: list[Trial]) -> list[Trial]:
    """The start points in turn from every centre: about a wrong one a motor never reverses and is nearly linear."""
    if not ranked or "centre" not in (names := [p.name for p in ranked[0].hypothesis.parameters]):
        return ranked
    at = names.index("centre")
    taken: dict[float, int] = {}
    turns = []
    for start in ranked:
        centre = start.point.theta[at]
        taken[centre] = taken.get(centre, 0) + 1
        turns.append(taken[centre])
    return [ranked[i] for i in sorted(range(len(ranked)), key=turns.__getitem__)]


def _quick_selection(starts: list[Trial]) -> list[Trial]:
    """A few starts: first the best one of each variant, then the others."""
    ranked = sorted(starts, key=attrgetter("point.cost"))
    seen: set[Problem] = set()
    first = [not (one.problem in seen or seen.add(one.problem)) for one in ranked]  # type: ignore[func-returns-value]
    order = sorted(range(len(ranked)), key=lambda i: not first[i])
    return [ranked[i] for i in order[:QUICK_STARTS]]


def refine_first(trials: list[Trial]) -> list[Trial]:
    """Continue the first trial for a few iterations."""
    return [trials[0].continued(4), *trials[1:]]


def refined_groups(tried: list[list[Trial]], looked_at: int, count: int) -> list[list[Trial]]:
    """The `count` groups with the best trials, best first, after their first trial was continued.

    Only the `looked_at` best groups are.
    """
    return _best_groups([refine_first(few) for few in _best_groups(tried, looked_at)], count)


def _best_groups(tried: list[list[Trial]], count: int) -> list[list[Trial]]:
    return sorted(filter(None, tried), key=lambda sketched: sketched[0].score)[:count]


def best_fit(data: Data, trials: list[Trial], kept: int = 3) -> Fit | None:
    """The best plausible fit after minimizing a few trials to convergence; None if none is plausible."""
    found: list[Fit] = []
    for trial in _two_variants(reranked(trials, 2 * kept), kept):
        if (begun := trial if trial.problem.data is data else trial.continued(25).on(data)) is not None:
            fit = finish(data, trial.hypothesis, descend(begun.problem, begun.point, iterations=25))
            found += [one for one in (fit, *_grown(data, fit)) if is_plausible(data, one)]
    return best_form(found) if found else None


def best_form(fits: Sequence[Fit]) -> Fit:
    """The best of several forms of the same effects, or of several fits of one form.

    By BIC; where the best one leaves a slow residual, by free-run error, because the innovations then describe what no
    form models. Its number of independent samples is that of the slow residual.
    """
    best = min(fits, key=penalized_bic)
    white = best.noise.sigma2
    if best.free_run <= SLOW_RATIO * white:
        return best
    count = best.noise.rows * float(np.sqrt(white / best.free_run))
    return min(fits, key=lambda fit: count * np.log(fit.free_run) + fit.n_free * np.log(count) + _penalty(fit))


def reranked(trials: list[Trial], count: int) -> list[Trial]:
    """Continue the first trials for some iterations and sort them again: the best one need not lead from the start."""
    if len(trials) <= count // 2:
        return trials
    return _continued(trials[:count], 6)


def is_plausible(data: Data, fit: Fit, last: int = 1) -> bool:
    """Whether the fitted parameters of the `last` effects are plausible."""
    effects = fit.hypothesis.effects[-last:]
    if any(isinstance(effect, Placed) for effect in effects) and has_undriven_pole(data, fit):
        return False  # the new pole models the rig, and one of the others a drift or a sinusoid
    return all(effect.is_plausible(Fitted.of(fit, data)) for effect in effects)


def plausible_forms(data: Data, fit: Fit) -> list[Fit]:
    """The fit, and fits of the same effects in other forms."""
    others = alternative_forms(fit.hypothesis)
    forms = (fit_from(data, other, transfer_theta(fit, other), iterations=8) for other in others)
    found = len(fit.hypothesis.found)
    return [fit, *(form for form in forms if form is not None and is_plausible(data, form, found))]


def _grown(data: Data, fit: Fit) -> list[Fit]:
    """The best refit with a form into which the last effect grows, if there is one."""
    last, found = len(fit.hypothesis.effects) - 1, []
    grown = fit.hypothesis.effects[last].grown_forms(fit.hypothesis)
    for form, other in forms_at(fit.hypothesis, last, grown):
        starts = form.grown_starts(fit, other, transfer_theta(fit, other))
        found += [one for start in starts if (one := fit_from(data, other, start, iterations=12)) is not None]
    return [min(found, key=penalized_bic)] if found else []


def penalized_bic(fit: Fit) -> float:
    """BIC plus the penalties of richer forms of effects."""
    return fit.bic + _penalty(fit)


def _penalty(fit: Fit) -> float:
    return sum(effect.bic_penalty for effect in fit.hypothesis.effects)


def _two_variants(trials: list[Trial], kept: int) -> list[Trial]:
    """The first `kept` trials, at least one of them of another variant than the first, if there is one."""
    chosen = trials[:kept]
    if chosen and all(trial.hypothesis == chosen[0].hypothesis for trial in chosen):
        other = next((trial for trial in trials if trial.hypothesis != chosen[0].hypothesis), None)
        if other is not None:
            chosen = [*chosen[: max(kept - 1, 1)], other]
    return chosen


def is_compatible(parent: Fit, effect: Effect) -> bool:
    """Whether the effect can be added to the dynamics of the parent."""
    old = parent.hypothesis.plant
    if not effect.extend(old).keeps_feedback:
        return False
    if old.kind == "given":
        if old.simulation.port is not None and effect.name in INSIDE_NAMES and not isinstance(effect, Inside):
            return False
        if not isinstance(effect, PlantEffect):
            return old.simulation.takes_input or not isinstance(effect, InputEffect)
        return old.simulation.takes_input and effect.before_given
    if not isinstance(effect, PlantEffect):
        return True
    if effect.only_given:
        return False
    new = effect.extend(old)
    if old.kind == "varying" and new.nonlinear:
        return True
    return old.kind == "linear" or (new.kind == old.kind and new.flipped == old.flipped)


def start_points(context: Context, hypothesis: Hypothesis, effect: Effect) -> Iterable[FloatArray]:
    """Start values of theta: those of the parent, combined with every start of the new effect."""
    parent = context.parent
    common = np.zeros(len(hypothesis.parameters))
    if not hypothesis.delay_is_an_effect and not parent.hypothesis.delay_is_an_effect:
        common[0] = parent.theta[0]
    for key in shared_keys(parent.hypothesis, hypothesis):
        common[hypothesis.slices[key]] = parent.theta[parent.hypothesis.slices[key]]
    place = hypothesis.slices["plant"]
    moved = [one for one in parent.hypothesis.effects if one not in hypothesis.effects]
    inner = {name: value for one in moved for name, value in one.inner_start(context).items()}
    new = [one for one in hypothesis.effects if one not in parent.hypothesis.effects]
    in_plant = isinstance(effect, PlantEffect)
    named_starts = effect.plant_starts(context) if isinstance(effect, PlantEffect) else [{}]
    own_starts = [np.zeros(0)] if in_plant else effect.starts(context)
    for base in _plant_starts(context, hypothesis.plant, effect.rates(context)):
        for named in named_starts:
            for own in own_starts:
                full = common.copy()
                full[place] = _updated(hypothesis.plant, base, inner | named)
                if not in_plant:
                    full[hypothesis.slices[effect.key]] = own
                for one in new:
                    full = one.with_linear_gains(context.data, hypothesis, full)
                yield full


def _plant_starts(context: Context, new: Plant, others: list[tuple[float, float]]) -> list[FloatArray]:
    """Start values of the new plant: parameters of the parent's plant, with its rates, `others` and other estimates."""
    parent = context.parent
    old = parent.hypothesis.plant
    kept = {p.name: value for p, value in zip(old.parameters, parent.plant_theta, strict=True)}
    rates = [context.rates, *others]
    if np.abs(np.log(np.divide(context.highpass_rates, context.rates))).max() > 0.2:
        rates.append(context.highpass_rates)
    slow, fast = real_rates(*context.rates)
    if fast > MAX_OBSERVED_RATE:  # the cost has no gradient that would return such a pole
        rates.append((slow + RESTART_RATE, slow * RESTART_RATE))
    if new.kind in ("tanks", "speed") and old.kind == "linear":  # a rig with a single tank or inertia
        rates += [single_pole(rate) for rate in _single_pole_rates(context, slow, fast)]
    if new.friction and new.kind == "mechanics" and old.kind == "linear":  # friction makes a linear fit too slow
        rates += [(w, w**2) for w in MASS_FREQUENCIES if w**2 > MIN_STIFFNESS_RATIO * context.rates[1]]
    bases = []
    for n, (c, k) in enumerate(rates):
        for base in new.starts(c, k):
            for i, parameter in enumerate(new.parameters):
                if parameter.name in kept and not (i < 2 and (n or old.kind != new.kind)):
                    base[i] = kept[parameter.name]
            bases.append(base)
            if old.kind == new.kind:
                if new.kind == "tanks" and not old.has_root:
                    swapped = base.copy()  # linear tanks may be in either order
                    swapped[:2] = base[1::-1]
                    bases.append(swapped)
                break
    return bases


def _single_pole_rates(context: Context, slow: float, fast: float) -> list[float]:
    """Rates of a single-state rig: inverse response time and either pole, without near duplicates."""
    rates: list[float] = []
    for rate in (1.0 / max(context.response_time, 1e-9), fast, slow):
        in_range = 1.0 / context.data.samples < rate < MAX_SINGLE_RATE
        if in_range and all(abs(np.log(rate / other)) > 0.5 for other in rates):
            rates.append(rate)
    return rates


def _updated(plant: Plant, base: FloatArray, named: dict[str, float]) -> FloatArray:
    """A copy of `base` with the named parameters set, or increased if the name ends in "+"."""
    theta = base.copy()
    names = [p.name for p in plant.parameters]
    for name, value in named.items():
        if name.endswith("+"):
            theta[names.index(name[:-1])] += value
        elif name in names:
            theta[names.index(name)] = value
    return theta
