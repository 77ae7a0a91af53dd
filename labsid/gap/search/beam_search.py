"""Beam search over combinations of effects: add up to three effects one by one, replace single ones, then prune."""

from collections.abc import Callable, Collection, Iterable, Sequence
from dataclasses import replace
from operator import attrgetter

import numpy as np

from labsid._arrays import FloatArray
from labsid._cores import mapped
from labsid.gap.effects.base import Effect, InputEffect
from labsid.gap.effects.disturbance import Leak, LoadStep
from labsid.gap.effects.families import CANDIDATES
from labsid.gap.effects.inside import Inside
from labsid.gap.effects.restarts import in_records
from labsid.gap.fits.fitting import Fit, finish, fit_from, mean_square, minimize, refit, rms
from labsid.gap.fits.hypothesis import Hypothesis
from labsid.gap.fits.linear_fits import fit_baseline, fit_driven_pole, fit_highpass
from labsid.gap.fits.profile import has_size
from labsid.gap.fits.residual_tests import explained_share
from labsid.gap.fits.undriven_poles import has_undriven_pole, lag_became_mode
from labsid.gap.record.data import Data
from labsid.gap.search.candidates import (
    SLOW_RATIO,
    Trial,
    best_fit,
    best_form,
    is_compatible,
    is_plausible,
    penalized_bic,
    plausible_forms,
    refined_groups,
    trial_fits,
)
from labsid.gap.search.forms import remove_effect, transfer_theta
from labsid.gap.search.instants import fits_with_instants, may_change_at_an_instant
from labsid.gap.search.pendulum import pendulum_from_spring
from labsid.gap.search.pole_replacement import replace_undriven_pole
from labsid.gap.search.refinement import converge, polish, retried_without_one
from labsid.gap.search.sets import SETS, set_fits

Progress = Callable[[str, float], None]
Level = dict[tuple[str, ...], Fit]
Levels = tuple[Level, ...]

BEAM_WIDTH = 3  # best one-effect fits that get a second effect; only the best pair gets a third; set by hand
FREE_RUN_TOLERANCE = 1.2
"""Free-run error over that of the baseline, up to which a whiter baseline is accepted; set by hand."""
EXTRA_PARENTS = 2  # further one-effect fits: those with the smallest free-run error; set by hand
REFINED_EFFECTS = 12  # second and third effects per parent whose trials are refined; set by hand
FITTED_EFFECTS = 6  # second and third effects per parent that are fitted completely; set by hand
FITTED_REPLACEMENTS = 3  # effects fitted completely in place of another one; set by hand
POLISHED_FITS = 6  # best fits of a level; set by hand
POLISHED_REACH = 100.0
"""BIC over that of the best fit of a level, up to which a fit is polished; measured: of 82 fits farther from it, none
came within 12 of the best."""
REACH_SHARE = 0.05  # the same over the number of samples, where that is larger: an error 5 % higher; set by hand
BIC_MARGIN = 12.0  # smallest BIC gain of one more effect; set by hand
ROUNDING_ERROR = 1e-6  # scaled units: smaller differences are rounding, of the file included; numerics
ROUNDING_ONLY = 0.06
"""Rms excess over half a converter step, in half steps: below, the residual is rounding; set by hand."""
NOT_ROUNDING = 0.3  # the same excess, above which refitting cannot bring the residual within rounding; set by hand
ROUNDING_PASSES = 4  # refits towards the interval that rounding allows; numerics
MIN_CHANGE = 0.3  # smallest change of the output, over the standard deviation of the residual; set by hand


def search_effects(
    data: Data, structure: Hypothesis, start: FloatArray | None, most: int, progress: Progress | None
) -> tuple[Levels, tuple[Fit, ...]]:
    """Search for the effects that explain a record.

    Parameters
    ----------
    data : Data
    structure : Hypothesis
        Structure of the simulation under test, with the effects it already contains.
    start : ndarray, optional
        Parameters of that structure, if known.
    most : int
        Largest number of effects.
    progress : callable, optional
        Called with a description of the current step and the completed share of it.

    Returns
    -------
    levels : tuple of dict
        The best fit of every combination tried, by number of effects.
    path : tuple of Fit
        From the baseline to the accepted fit, one effect more at each step.
    """
    base = fit_baseline(data, structure, start)
    highpass = fit_highpass(data, base)
    base = whiter_baseline(data, polish(data, base), highpass)
    levels, path = _with_driven_poles(data, structure, base, highpass, most, progress)
    levels, path = _with_instants(data, levels, path, highpass, most)
    return levels, nested_path(levels, path)


def _with_instants(
    data: Data, levels: Levels, path: tuple[Fit, ...], highpass: Fit, most: int
) -> tuple[Levels, tuple[Fit, ...]]:
    """The same with a change at an instant, where it explains more with as many effects, or all with one more."""
    sizes = range(1, min(most, 2) + 1)
    if not sizes or (residual_is_white(data, path[-1]) and not may_change_at_an_instant(path[-1])):
        return levels, path
    gained = len(path) - 2  # effects, by which the smallest ones may be fewer
    fits = fits_with_instants(data, levels[: len(sizes)], highpass, path[-1].bic + BIC_MARGIN * gained)
    for size in sizes:
        found = _of_size(fits, size)
        white = [fit for fit in found if residual_is_white(data, fit)]
        if size < len(path):
            highest = penalized_bic(path[-1]) + BIC_MARGIN * (len(path) - 1 - size)
            better = [fit for fit in found if penalized_bic(fit) < highest]
        else:
            better = [fit for fit in white if is_improvement(data, path[-1], fit)]
        levels = tuple(dict(levels[n]) if n < len(levels) else {} for n in range(max(len(levels), size + 1)))
        keep_best(levels[size], [*white, *better])
        if better:
            best = min(better, key=penalized_bic)
            parents = [one for names, one in levels[1].items() if set(names) < set(best.hypothesis.names)]
            path = _pruned(data, levels, [path[0], *parents[: size - 1], best])
            if residual_is_white(data, best):
                break
    return levels, path


def nested_path(levels: Levels, path: tuple[Fit, ...]) -> tuple[Fit, ...]:
    """The path whose every step has the effects of the step before: the search may have exchanged one."""
    steps = [path[-1]]
    for fit in path[-2:0:-1]:
        names = set(steps[0].hypothesis.names)
        parts = [one for tried, one in levels[len(fit.hypothesis.found)].items() if set(tried) < names]
        is_part = set(fit.hypothesis.names) < names or not parts
        steps.insert(0, fit if is_part else min(parts, key=attrgetter("bic")))
    return (path[0], *steps) if len(path) > 1 else path


def _with_driven_poles(
    data: Data, structure: Hypothesis, base: Fit, highpass: Fit, most: int, progress: Progress | None
) -> tuple[Levels, tuple[Fit, ...]]:
    """Levels and accepted path of the search, whose poles the input excites as far as that explains as much."""
    levels, path = _search_from(data, base, highpass, most, progress)
    if not has_undriven_pole(data, path[-1]):
        return levels, path
    if len(path) == 1:
        other = fit_driven_pole(data, structure)
        if other is not None:
            other_levels, other_path = _search_from(data, polish(data, other), highpass, most, progress, driven=True)
            if len(other_path) > 1 and other_path[-1].bic < base.bic + BIC_MARGIN:
                return other_levels, other_path
    elif len(path) <= most:
        steps = replace_undriven_pole(data, path[-1], path[-1].bic + BIC_MARGIN)
        if steps is not None and steps[-1].bic < path[-1].bic + BIC_MARGIN:
            found = ({tuple(sorted(fit.hypothesis.names)): fit} for fit in steps)
            return (*levels[: len(path) - 1], *found), (*path[:-1], *steps)
    return levels, path


def _search_from(
    data: Data, base: Fit, highpass: Fit, most: int, progress: Progress | None, driven: bool = False
) -> tuple[Levels, tuple[Fit, ...]]:
    """Levels and accepted path of the search from one baseline; if `driven`, the input must excite every pole."""

    def disguised(fit: Fit) -> bool:
        return lag_became_mode(base, fit) or (driven and has_undriven_pole(data, fit))

    levels: list[Level] = [{(): base}]
    path = [base]
    beam = [base]
    together: list[Fit] = []
    for step in range(most):
        level: Level = {}
        for number, parent in enumerate(beam):
            fits = _extensions(data, parent, highpass, step, 3, progress, (number, len(beam)))
            keep_best(level, (fit for fit in fits if fit is not None and not disguised(fit)))
        keep_best(level, _of_size(together, step + 1))
        if step == 0:
            keep_best(level, [pendulum_from_spring(data, base, highpass, level.get(("cubic-stiffness",)))])
        if not level:
            break
        _polish_best(data, level)
        levels.append(level)
        best = _best_accepted(data, path[-1], level)
        if step == 0 and most > 1 and best is not None and _is_a_change(data, best, levels, highpass):
            path.append(best)
            break
        if step == 0 and most > 1 and not residual_is_white(data, best or base):
            sets = set_fits(data, base, highpass, candidates_on(data))
            together = [fit for fit in sets if not disguised(fit)]
        best = best or _towards_a_set(data, path[-1], level, together)
        if best is None:
            break
        if step == 1:
            known = set(level.values())
            keep_best(level, _replacements(data, best, highpass))
            _polish_best(data, level, known)
            best = _best_accepted(data, path[-1], level) or best
        path.append(best)
        if residual_is_white(data, best):
            break
        if step == 1:
            keep_best(levels[1], retried_without_one(data, best))
        beam = select_parents(data, level) if step == 0 else [min(level.values(), key=attrgetter("bic"))]
    for size in range(len(levels), max((len(fit.hypothesis.names) for fit in together), default=0) + 1):
        levels.append({})
        keep_best(levels[-1], _of_size(together, size))
    return tuple(levels), _pruned(data, levels, path)


def _is_a_change(data: Data, best: Fit, levels: list[Level], highpass: Fit) -> bool:
    """Whether a change at an instant explains all that the best single effect, which varies in time, does not."""
    if residual_is_white(data, best) or not may_change_at_an_instant(best):
        return False
    return any(residual_is_white(data, fit) for fit in fits_with_instants(data, levels[:1], highpass, best.bic))


def _of_size(fits: Iterable[Fit], size: int) -> list[Fit]:
    """The fits with so many effects."""
    return [fit for fit in fits if len(fit.hypothesis.names) == size]


def _towards_a_set(data: Data, simpler: Fit, level: Level, together: list[Fit]) -> Fit | None:
    """The best fit of a level whose effects belong to a larger set that improves on `simpler`; None without one."""
    for fit in sorted(together, key=attrgetter("bic")):
        names = set(fit.hypothesis.names)
        parts = [one for tried, one in level.items() if set(tried) < names]
        if parts and is_improvement(data, simpler, fit):
            return min(parts, key=attrgetter("bic"))
    return None


def rather_a_set(data: Data, levels: Levels, path: tuple[Fit, ...]) -> tuple[Fit, ...]:
    """The path to a set of effects that belong together, if it improves on the end of a path without its last steps."""
    names = {frozenset(one.names) for one in SETS}
    sets = [fit for level in levels[2:] for fit in level.values() if frozenset(fit.hypothesis.names) in names]
    best = min(sets, key=attrgetter("bic"), default=None)
    if best is None or not is_improvement(data, path[-1], best) or not has_size(data, best):
        return path
    chain = [path[0]]
    for level in levels[1 : len(best.hypothesis.names)]:
        parts = [fit for tried, fit in level.items() if set(tried) < set(best.hypothesis.names)]
        if not parts:
            return path
        chain.append(min(parts, key=attrgetter("bic")))
    return (*chain, polish(data, best))


def whiter_baseline(data: Data, base: Fit, highpass: Fit) -> Fit:
    """The baseline, or its refit from the differenced record if that leaves whiter residuals.

    Strongly coloured noise biases the rates of a free-run fit.
    """
    if highpass.hypothesis.parameters != base.hypothesis.parameters:
        return base
    point = minimize(data, base.hypothesis, highpass.theta, iterations=12, ar=highpass.noise.ar)
    other = base if point is None else polish(data, finish(data, base.hypothesis, point))
    return other if other.bic < base.bic and rms(data, other) < FREE_RUN_TOLERANCE * rms(data, base) else base


def select_parents(data: Data, level: Level) -> list[Fit]:
    """One-effect fits to which a second effect is added: those of lowest BIC, and those of lowest free-run error.

    Free-run error counts if the residual is slow: the innovations then say little about one effect of a pair.
    """
    ranked = sorted(level.values(), key=attrgetter("bic"))
    free = sorted(ranked[BEAM_WIDTH:], key=lambda fit: mean_square(data, fit))
    slow = mean_square(data, ranked[0]) > SLOW_RATIO * ranked[0].noise.sigma2
    return [*ranked[:BEAM_WIDTH], *(free[:EXTRA_PARENTS] if slow else [])]


def keep_best(level: Level, fits: Iterable[Fit | None]) -> None:
    """Keep the fit of lowest BIC for each combination of names."""
    for fit in fits:
        if fit is not None:
            names = tuple(sorted(fit.hypothesis.names))
            if names not in level or fit.bic < level[names].bic:
                level[names] = fit


def _extensions(
    data: Data, parent: Fit, highpass: Fit, step: int, tries: int, progress: Progress | None, place: tuple[int, int]
) -> list[Fit | None]:
    """The best fit with each further effect; from the second effect on, only of the effects with the best trials.

    `tries` are the trials of an effect that are fitted; `place` is that of the parent among all.
    """
    plain = with_constant_load(data, parent)
    shared = _shared(data, parent, plain)

    def begun(number: int, count: int) -> None:
        if progress is not None:
            progress("one effect" if step == 0 else f"{step + 1} effects", (place[0] + number / count) / place[1])

    def tried(group: tuple[Effect, ...]) -> list[Trial]:
        host = parent if any(is_compatible(parent, effect) for effect in group) else plain
        return trial_fits(data, host, group, highpass, brief=step > 0)

    groups = [group for group in candidates_on(data) if group[0].name not in parent.hypothesis.names]
    if step == 0:
        return mapped(lambda group: best_fit(data, tried(group), tries), groups, shared, begun)
    few = refined_groups(mapped(tried, groups, shared, begun), REFINED_EFFECTS, FITTED_EFFECTS)
    return mapped(lambda trials: best_fit(data, trials, tries), few, shared)


def _shared(data: Data, *fits: Fit) -> tuple[object, ...]:
    """What fits of a record refer to: it, and their simulation."""
    return data, *fits, *(fit.hypothesis.plant.simulation for fit in fits[:1])


def candidates_on(data: Data) -> tuple[tuple[Effect, ...], ...]:
    """The forms that are added, in a group for each name; with an initial state of their own in each record."""
    groups = CANDIDATES
    if data.at_input:
        groups = tuple(group for group in groups if isinstance(group[0], InputEffect))
    if data.beside:
        forms = (tuple(effect for effect in group if isinstance(effect, InputEffect | Inside)) for group in groups)
        groups = tuple(group for group in forms if group)
    if data.tried:
        groups = tuple(group for group in groups if group[0].name in data.tried)
    if not data.pieces:
        return groups
    return tuple(tuple(in_records(effect, data.pieces[1:]) for effect in group) for group in groups)


def extended_fits(data: Data, parent: Fit, highpass: Fit, step: int, progress: Progress | None) -> list[Fit]:
    """The best fit with each further effect; from the second effect on, only of the effects with the best trials."""
    found = [fit for fit in _extensions(data, parent, highpass, step, 2, progress, (0, 1)) if fit is not None]
    return mapped(lambda fit: converge(data, fit), found, _shared(data, parent))


def with_constant_load(data: Data, parent: Fit) -> Fit:
    """The parent with a constant load in place of a state-dependent one.

    The dynamics of a state-dependent load cannot be combined with a nonlinear state.
    """
    old = parent.hypothesis
    other = old.with_effects(tuple(LoadStep() if isinstance(effect, Leak) else effect for effect in old.effects))
    if other == old:
        return parent
    return fit_from(data, other, transfer_theta(parent, other)) or parent


def _replacements(data: Data, fit: Fit, highpass: Fit) -> Iterable[Fit | None]:
    """Fits with one of the effects replaced by another, started from the parameters of the remaining effects."""
    groups = [group for group in candidates_on(data) if group[0].name not in fit.hypothesis.names]
    shared = _shared(data, fit)
    for i in range(fit.hypothesis.n_given, len(fit.hypothesis.effects)):
        parent = remove_effect(data, fit, i)
        if parent is not None:
            tried = mapped(_brief_trials(data, parent, highpass), groups, (parent, *shared))
            few = refined_groups(tried, REFINED_EFFECTS, FITTED_REPLACEMENTS)
            yield from mapped(lambda trials: best_fit(data, trials, kept=1), few, shared)


def _brief_trials(data: Data, parent: Fit, highpass: Fit) -> Callable[[tuple[Effect, ...]], list[Trial]]:
    return lambda group: trial_fits(data, parent, group, highpass, brief=True)


def _pruned(data: Data, levels: Sequence[Level], path: list[Fit]) -> tuple[Fit, ...]:
    """The path without effects that a later one has made redundant."""
    while len(path) > 2:
        best = path[-1]
        fewer = []
        for i in range(best.hypothesis.n_given, len(best.hypothesis.effects)):
            parent = remove_effect(data, best, i)
            if parent is not None:
                fewer.append(_in_best_form(data, parent))
        simpler = min(fewer, key=attrgetter("bic"), default=None)
        if simpler is None or (is_improvement(data, simpler, best) and not within_rounding(data, simpler)):
            break
        keep_best(levels[len(path) - 2], [simpler])
        path = [*path[:-2], simpler]
    return tuple(path)


def _polish_best(data: Data, level: Level, done: Collection[Fit] = ()) -> None:
    """Polish the best fits of a level in their best form, except those in `done`, and those far from the first one."""
    best = sorted(level.items(), key=lambda item: item[1].bic)[:POLISHED_FITS]
    first = best[0][1]
    highest = first.bic + max(POLISHED_REACH, REACH_SHARE * first.noise.rows)
    rough = {names: fit for names, fit in best if fit not in done}
    polished = mapped(lambda fit: _in_best_form(data, fit, highest), rough.values(), _shared(data, *rough.values()))
    level.update(zip(rough, polished, strict=True))


def _in_best_form(data: Data, fit: Fit, highest: float = np.inf) -> Fit:
    """The polished fit, in the best of its equivalent forms; as it is if their BIC is above `highest`."""
    forms = [form for form in plausible_forms(data, fit) if form.bic < highest]
    if not forms:
        return fit
    first, *others = (converge(data, one) for one in forms)
    found = len(fit.hypothesis.found)
    return polish(data, best_form([first, *(one for one in others if is_plausible(data, one, found))]))


def _best_accepted(data: Data, simpler: Fit, level: Level) -> Fit | None:
    """The best fit of a level that improves on `simpler`; None if there is none."""
    if within_rounding(data, simpler):
        return None
    ranked = sorted(level.values(), key=attrgetter("bic"))
    return next((fit for fit in ranked if is_improvement(data, simpler, fit) and has_size(data, fit)), None)


def best_path(data: Data, levels: Levels) -> tuple[Fit, ...]:
    """The accepted path through levels whose fits have been repeated."""
    path = list(levels[0].values())
    for level in levels[1:]:
        best = _best_accepted(data, path[-1], level)
        if best is None:
            break
        path.append(best)
    return tuple(path)


def residual_is_white(data: Data, fit: Fit) -> bool:
    """Whether the residual is white and independent of the input, so that no further effect can gain anything."""
    if within_rounding(data, fit):
        return True
    return mean_square(data, fit) < 1.03 * fit.noise.sigma2 and explained_share(data, fit, data.y - fit.output) < 0.01


def is_improvement(data: Data, simpler: Fit, fit: Fit) -> bool:
    """Whether `fit` gains enough BIC over `simpler` and changes the output by more than the noise hides."""
    return bool(simpler.bic - fit.bic > BIC_MARGIN and differ(data, simpler, fit, MIN_CHANGE))


def within_rounding(data: Data, fit: Fit) -> bool:
    """Whether the residual may be quantization alone, so that any further gain would fit the rounding.

    The true output lies within half a step of each reading; the fit is repeated on the nearest such output.
    """
    half = 0.5 * data.lattice
    for _ in range(ROUNDING_PASSES):
        beyond = np.maximum(np.abs(data.y - fit.output)[data.rows] - half, 0.0)
        share = float(np.sqrt(np.mean(beyond**2))) / half if half else np.inf
        if share < ROUNDING_ONLY:
            return True
        if share > NOT_ROUNDING:
            return False
        fit = refit(replace(data, y=np.clip(fit.output, data.y - half, data.y + half)), fit)
    return False


def differ(data: Data, simpler: Fit, fit: Fit, size: float) -> bool:
    """Whether two outputs differ by more than `size` standard deviations of the residual of the second."""
    return bool(rms_difference(data, simpler, fit) > max(size * rms(data, fit), ROUNDING_ERROR))


def rms_difference(data: Data, simpler: Fit, fit: Fit) -> float:
    """Rms difference of two outputs over the counted rows."""
    return float(np.sqrt(np.mean((fit.output - simpler.output)[data.rows] ** 2)))
