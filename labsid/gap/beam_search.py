"""The search among combinations: one effect, a second and a third on top of the best, exchanged and left out again."""

from collections.abc import Callable, Collection, Iterable
from dataclasses import replace

import numpy as np

from labsid._arrays import FloatArray
from labsid.gap.candidates import (
    CANDIDATES,
    Sketch,
    compatible,
    finished,
    holds,
    onward,
    price,
    sketches,
)
from labsid.gap.data import Data
from labsid.gap.fitting import Fit, finish, power, refit, rms, search
from labsid.gap.forms import LEAK, LOAD, carried, rearranged, without
from labsid.gap.freeing import freed
from labsid.gap.hypothesis import Hypothesis
from labsid.gap.leftover import explained_share
from labsid.gap.linear_fits import baseline, driven_baseline, swift_fit
from labsid.gap.own_motion import goes_on_alone, has_become_a_mode
from labsid.gap.settling import polish, settle

Progress = Callable[[str, float], None]
Level = dict[tuple[str, ...], Fit]
Levels = tuple[Level, ...]

BEAM_WIDTH = 3  # best first effects on top of which a second one is tried; a third one only on the best pair
FREE_RUN_TOLERANCE = 1.2  # of the error of the free run
EXTRA_PARENTS = 2  # and those with the smallest error of the free run
SLOW_RATIO = 4.0  # mean square error over the variance of its innovations
REFINED_EFFECTS = 12  # second and third effects that are taken further than a sketch, of each parent
FITTED_EFFECTS = 6  # second and third effects that are taken to the end, of each parent
FITTED_REPLACEMENTS = 3  # the same, in the place of another
POLISHED_FITS = 6
BIC_MARGIN = 12.0  # BIC: what one effect more has to gain
ROUNDING_ERROR = 1e-6  # scaled: a difference of rounding, the file's own included
ROUNDING_ONLY = 0.06  # of half a converter step: what may lie beyond it
NOT_ROUNDING = 0.3  # the same, from which no fit is drawn within
ROUNDING_PASSES = 4  # times
MIN_CHANGE = 0.3  # change of the simulation over the standard deviation of what is left


def search_effects(
    data: Data, structure: Hypothesis, start: FloatArray | None, most: int, progress: Progress | None
) -> tuple[Levels, tuple[Fit, ...]]:
    """All levels that were tried, and the accepted path.

    Parameters
    ----------
    data : Data
    structure : Hypothesis
        What the simulation under test already holds.
    start : ndarray, optional
        Its numbers, where they are known.
    most : int
        How many effects at most.
    progress : callable, optional
        Called with what is being done and the share of it that is done.
    """
    base = baseline(data, structure, start)
    swift = swift_fit(data, base)
    base = _whiter_baseline(data, polish(data, base), swift)
    levels, path = _search_from(data, base, swift, most, progress)
    if not goes_on_alone(data, path[-1]):
        return levels, path
    if len(path) == 1:
        other = driven_baseline(data, structure)
        if other is not None:
            other_levels, other_path = _search_from(data, polish(data, other), swift, most, progress, driven=True)
            if len(other_path) > 1 and other_path[-1].bic < base.bic + BIC_MARGIN:
                return other_levels, other_path
    elif len(path) <= most:
        steps = freed(data, path[-1])
        if steps is not None and steps[-1].bic < path[-1].bic + BIC_MARGIN:
            found = ({tuple(sorted(fit.hypothesis.names)): fit} for fit in steps)
            return (*levels[: len(path) - 1], *found), (*path[:-1], *steps)
    return levels, path


def _search_from(
    data: Data, base: Fit, swift: Fit, most: int, progress: Progress | None, driven: bool = False
) -> tuple[Levels, tuple[Fit, ...]]:
    """All levels tried on top of a baseline, and the accepted path; where `driven`, no pole goes on alone."""

    def disguised(fit: Fit) -> bool:
        return has_become_a_mode(base, fit) or (driven and goes_on_alone(data, fit))

    levels: list[Level] = [{(): base}]
    path = [base]
    beam = [base]
    for step in range(most):
        level: Level = {}
        for number, parent in enumerate(beam):
            tried = _extensions(data, parent, swift, step, progress, (number, len(beam)))
            fits = [finished(data, few, kept=3) for few in tried]
            keep_best(level, (fit for fit in fits if fit is not None and not disguised(fit)))
        if not level:
            break
        _polish_best(data, level)
        levels.append(level)
        best = _best_accepted(data, path[-1], level)
        if best is None:
            break
        if step == 1:
            known = set(map(id, level.values()))
            keep_best(level, _replacements(data, best, swift))
            _polish_best(data, level, known)
            best = _best_accepted(data, path[-1], level) or best
        path.append(best)
        if residual_is_white(data, best):
            break
        beam = _parents(data, level) if step == 0 else [min(level.values(), key=_bic)]
    return tuple(levels), _pruned(data, levels, path)


def _whiter_baseline(data: Data, base: Fit, swift: Fit) -> Fit:
    """The baseline, from where the swift part of the record has brought it if that leaves whiter noise.

    Strongly coloured noise pulls a free run to rates that follow the noise.
    """
    if swift.theta.size != base.theta.size:
        return base
    point = search(data, base.hypothesis, swift.theta, iterations=12, ar=swift.noise.ar)
    other = base if point is None else polish(data, finish(data, base.hypothesis, point))
    return other if other.bic < base.bic and rms(data, other) < FREE_RUN_TOLERANCE * rms(data, base) else base


def _parents(data: Data, level: Level) -> list[Fit]:
    """First effects on top of which a second one is tried: the best, and those that run free best.

    Where much of the residual is slow, the innovations say little about an effect without its companion.
    """
    ranked = sorted(level.values(), key=_bic)
    free = sorted(ranked[BEAM_WIDTH:], key=lambda fit: power(data, fit))
    slow = power(data, ranked[0]) > SLOW_RATIO * ranked[0].noise.sigma2
    return [*ranked[:BEAM_WIDTH], *(free[:EXTRA_PARENTS] if slow else [])]


def keep_best(level: Level, fits: Iterable[Fit | None]) -> None:
    """Take into a level the fits that are the best of their names."""
    for fit in fits:
        if fit is not None:
            names = tuple(sorted(fit.hypothesis.names))
            if names not in level or fit.bic < level[names].bic:
                level[names] = fit


def _extensions(
    data: Data, parent: Fit, swift: Fit, step: int, progress: Progress | None, place: tuple[int, int]
) -> list[list[Sketch]]:
    """Sketches of one effect more, by effect; of a second or third one only those that promise most."""
    tried = []
    plain = _with_constant_load(data, parent)
    for number, group in enumerate(CANDIDATES):
        if progress is not None:
            done = (place[0] + number / len(CANDIDATES)) / place[1]
            progress("one effect" if step == 0 else f"{step + 1} effects", done)
        if group[0].name not in parent.hypothesis.names:
            host = parent if any(compatible(parent, effect) for effect in group) else plain
            tried.append(sketches(data, host, group, swift, brief=step > 0))
    return tried if step == 0 else _refined_groups(data, tried, FITTED_EFFECTS)


def _with_constant_load(data: Data, parent: Fit) -> Fit:
    """The parent with a load that does not grow with the state in the place of one that does.

    The latter's dynamics hold no nonlinear state; beside one, it grows again.
    """
    old = parent.hypothesis
    if LEAK not in old.effects:
        return parent
    other = Hypothesis(tuple(LOAD if effect == LEAK else effect for effect in old.effects), old.known, old.given)
    point = search(data, other, carried(parent, other))
    return parent if point is None else finish(data, other, point)


def _refined_groups(data: Data, tried: list[list[Sketch]], count: int) -> list[list[Sketch]]:
    return _best_groups([onward(data, few) for few in _best_groups(tried, REFINED_EFFECTS)], count)


def _best_groups(tried: list[list[Sketch]], count: int) -> list[list[Sketch]]:
    """The groups with the best sketches, best first."""
    return sorted(filter(None, tried), key=lambda sketched: sketched[0].score)[:count]


def _replacements(data: Data, fit: Fit, swift: Fit) -> Iterable[Fit | None]:
    """Another effect in the place of each of a fit's own, from where that one has brought the others."""
    for i in range(fit.hypothesis.known, len(fit.hypothesis.effects)):
        parent = without(data, fit, i)
        if parent is not None:
            names = fit.hypothesis.names
            tried = [
                sketches(data, parent, group, swift, brief=True) for group in CANDIDATES if group[0].name not in names
            ]
            for few in _refined_groups(data, tried, FITTED_REPLACEMENTS):
                yield finished(data, few, kept=1)


def _pruned(data: Data, levels: list[Level], path: list[Fit]) -> tuple[Fit, ...]:
    """The path without an effect that a later one has made superfluous."""
    while len(path) > 2:
        best = path[-1]
        fewer = []
        for i in range(best.hypothesis.known, len(best.hypothesis.effects)):
            parent = without(data, best, i)
            if parent is not None:
                fewer.append(_in_best_form(data, parent))
        simpler = min(fewer, key=_bic, default=None)
        if simpler is None or (is_improvement(data, simpler, best) and not within_rounding(data, simpler)):
            break
        keep_best(levels[len(path) - 2], [simpler])
        path = [*path[:-2], simpler]
    return tuple(path)


def _polish_best(data: Data, level: Level, done: Collection[int] = ()) -> None:
    """Take the best of a level to the end, in the form that suits them, but for those that are `done`, by identity."""
    for names, fit in sorted(level.items(), key=lambda item: item[1].bic)[:POLISHED_FITS]:
        if id(fit) in done:
            continue
        level[names] = _in_best_form(data, fit)


def _in_best_form(data: Data, fit: Fit) -> Fit:
    """The fit in the form that suits it, taken to the end."""
    return polish(data, min((settle(data, one) for one in _alternative_forms(data, fit)), key=price))


def _alternative_forms(data: Data, fit: Fit) -> list[Fit]:
    """The fit, and the same effects in other forms."""
    points = [(other, search(data, other, carried(fit, other), iterations=8)) for other in rearranged(fit.hypothesis)]
    forms = [finish(data, other, point) for other, point in points if point is not None]
    found = len(fit.hypothesis.effects) - fit.hypothesis.known
    return [fit, *(form for form in forms if holds(data, form, found))]


def _best_accepted(data: Data, simpler: Fit, level: Level) -> Fit | None:
    """The best of a level that is worth its further effect."""
    if within_rounding(data, simpler):
        return None
    return next((fit for fit in sorted(level.values(), key=_bic) if is_improvement(data, simpler, fit)), None)


def best_path(data: Data, levels: Levels) -> tuple[Fit, ...]:
    """The path through levels that were fitted anew."""
    path = list(levels[0].values())
    for level in levels[1:]:
        best = _best_accepted(data, path[-1], level)
        if best is None:
            break
        path.append(best)
    return tuple(path)


def _bic(fit: Fit) -> float:
    return fit.bic


def residual_is_white(data: Data, fit: Fit) -> bool:
    """Whether the residual is white and the input has no part in it: no further effect could gain anything."""
    if within_rounding(data, fit):
        return True
    return power(data, fit) < 1.03 * fit.noise.sigma2 and explained_share(data, fit, data.y - fit.output) < 0.01


def is_improvement(data: Data, simpler: Fit, fit: Fit) -> bool:
    """Whether `fit` explains significantly more than `simpler`, and something that matters."""
    return bool(simpler.bic - fit.bic > BIC_MARGIN and differ(data, simpler, fit, MIN_CHANGE))


def within_rounding(data: Data, fit: Fit) -> bool:
    """Whether all that a fit leaves may be the converter's rounding: what betters it further fits the rounding.

    The true output may lie anywhere within half a step of a reading; the fit is drawn towards the nearest such point.
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
    """Whether two simulations differ by more than `size` standard deviations of what the second one leaves."""
    return bool(rms_difference(data, simpler, fit) > max(size * rms(data, fit), ROUNDING_ERROR))


def rms_difference(data: Data, simpler: Fit, fit: Fit) -> float:
    """By how much two simulations differ, rms over the rows that count."""
    return float(np.sqrt(np.mean((fit.output - simpler.output)[data.rows] ** 2)))
