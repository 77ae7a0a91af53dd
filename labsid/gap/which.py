"""Which effects: single ones first, then a second and a third on top of the best, as long as it gains enough."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from labsid.gap.candidates import (
    CANDIDATES,
    LINEAR,
    baseline,
    carried,
    finished,
    price,
    rearranged,
    sketches,
    swift_fit,
)
from labsid.gap.context import Data
from labsid.gap.effects.base import AdditiveEffect
from labsid.gap.fitting import Fit, finish, polish, power, refit, rms, search, settle
from labsid.gap.holdout import BLOCKS, held_out
from labsid.gap.hypothesis import Hypothesis
from labsid.gap.leftover import SLOW, explained_share, slow_colour
from labsid.gap.raw import RawFaults, find_held, find_spikes
from labsid.signal_quality import lattice_step

Progress = Callable[[str, float], None]
Levels = tuple[dict[tuple[str, ...], Fit], ...]

BEAM = 3  # best first effects on top of which a second one is tried; a third one only on the best pair
FOLLOWED = 6  # second and third effects that are taken to the end, of each parent
POLISHED = 6
MARGIN = 12.0  # BIC: what one effect more has to gain
NOTHING = 1e-9  # scaled: a difference of rounding
EFFECT_SIZE = 0.3  # change of the simulation over the standard deviation of what is left
NAMED_SIZE = (EFFECT_SIZE, 1.0, 2.0)  # the same, for a first, second and third effect that is named
FAINT = 0.6  # the same, below which a first effect that is not told from others is none
TOSS_UP = 6.0  # BIC
RAW_SIZE = 1.3  # mean square error with the bad samples over that without them
STRONG_COLOUR = 1.3  # standard deviation of the noise over that of its innovations
VERY_SLOW = 4.0  # standard deviation of the residual over that of its innovations
HELPS = 0.8  # of the error on blocks that were not fitted


@dataclass(frozen=True, slots=True, eq=False)
class Explained:
    """Everything that was tried on a record.

    Attributes
    ----------
    data : Data
        With the rows that the fits counted.
    faults : RawFaults
    levels : tuple of dict
        Level n: the best fit of every combination of n names that was tried, by its sorted names; 0 the baseline.
    path : tuple of Fit
        From the baseline to the accepted hypothesis, one effect more at each step.
    added : tuple of str
        Effects that no simulation shows: of single samples, and coloured noise.
    """

    data: Data
    faults: RawFaults
    levels: Levels
    path: tuple[Fit, ...]
    added: tuple[str, ...]

    @property
    def best(self) -> Fit:
        """The accepted hypothesis."""
        return self.path[-1]

    @property
    def names(self) -> tuple[str, ...]:
        """All effects."""
        return (*self.best.hypothesis.names, *self.added)


def explain(data: Data, structure: Hypothesis = LINEAR, most: int = 3, progress: Progress | None = None) -> Explained:
    """Search for the effects that explain a record.

    Parameters
    ----------
    data : Data
    structure : Hypothesis
        What the simulation under test already holds.
    most : int
        How many effects at most.
    progress : callable, optional
        Called with what is being done and the share of it that is done.
    """
    y = np.asarray(data.y_scale.back(data.y))
    lattice = lattice_step(y)
    stretches = find_held(y, lattice)
    held = np.zeros(data.samples, bool)
    for start, stop in stretches:
        held[start:stop] = True
    usable = data.rows & ~held
    clean, spikes, levels, path = _beside_spikes(data, usable, structure, most, progress)
    faults = RawFaults(held, stretches, spikes, None if lattice is None else lattice / data.y_scale.unit)
    if slow_leftover(clean, path[-1]):
        other_levels, other = search_tree(replace(clean, by_free_run=True), structure, min(most, 2), progress)
        other = confirmed(clean, other)
        if len(other) > 1 and power(clean, other[-1]) < 0.5 * power(clean, path[-1]):
            levels, path = other_levels, other
    path = trimmed(clean, path)
    if len(path) == 2 and faint(clean, levels[1], path):
        path = path[:1]
    return Explained(clean, faults, levels, path, unsimulated(data, clean, faults, path[-1]))


def _beside_spikes(
    data: Data, usable: np.ndarray, structure: Hypothesis, most: int, progress: Progress | None
) -> tuple[Data, np.ndarray, Levels, tuple[Fit, ...]]:
    """The beam search without the spikes, which are judged beside the best explanation: it may be what makes them."""
    first = baseline(replace(data, rows=usable), structure)
    spikes = find_spikes(data.y - first.output, usable)
    clean = replace(data, rows=usable & ~spikes)
    levels, path = search_tree(clean, structure, most, progress)
    again = find_spikes(data.y - path[-1].output, usable)
    few = 0.2 * max(again.sum(), 3)
    if (again & ~spikes).sum() > few:  # the baseline's error had hidden them
        clean = replace(data, rows=usable & ~again)
        levels, path = search_tree(clean, structure, most, progress)
        spikes, again = again, find_spikes(data.y - path[-1].output, usable)
    if (again ^ spikes).sum() > few:  # or had made them
        clean = replace(data, rows=usable & ~again)
        new = {fit: refit(clean, fit) for level in levels for fit in level.values()}
        levels = tuple({names: new[fit] for names, fit in level.items()} for level in levels)
        return clean, again, levels, tuple(new[fit] for fit in path)
    return clean, spikes, levels, path


def search_tree(
    data: Data, structure: Hypothesis, most: int, progress: Progress | None
) -> tuple[Levels, tuple[Fit, ...]]:
    """The beam search: all levels that were tried, and the accepted path."""
    base = baseline(data, structure)
    swift = swift_fit(data, base)
    base = polish(data, base)
    levels: list[dict[tuple[str, ...], Fit]] = [{(): base}]
    path = [base]
    beam = [base]
    for step in range(most):
        level: dict[tuple[str, ...], Fit] = {}
        for number, parent in enumerate(beam):
            tried = []
            for place, group in enumerate(CANDIDATES):
                if progress is not None:
                    done = (number + place / len(CANDIDATES)) / len(beam)
                    progress("one effect" if step == 0 else f"{step + 1} effects", done)
                if group[0].name not in parent.hypothesis.names:
                    tried.append(sketches(data, parent, group, swift, brief=step > 0))
            if step > 0:
                tried = sorted(filter(None, tried), key=lambda sketched: sketched[0].score)[:FOLLOWED]
            for sketched in tried:
                fit = finished(data, sketched, kept=1 if step > 0 else 3)
                if fit is not None:
                    names = tuple(sorted(fit.hypothesis.names))
                    if names not in level or fit.bic < level[names].bic:
                        level[names] = fit
        if not level:
            break
        for names, fit in sorted(level.items(), key=lambda item: item[1].bic)[:POLISHED]:
            level[names] = polish(data, min((settle(data, one) for one in _forms(data, fit)), key=price))
        levels.append(level)
        ranked = sorted(level.values(), key=_bic)
        beam = ranked[: BEAM if step == 0 else 1]
        best = next((fit for fit in ranked if worth(data, path[-1], fit)), None)
        if best is None:
            break
        path.append(best)
        if nothing_left(data, best):
            break
    return tuple(levels), tuple(path)


def _forms(data: Data, fit: Fit) -> list[Fit]:
    """The fit, and the same effects in other forms."""
    points = [(other, search(data, other, carried(fit, other), iterations=8)) for other in rearranged(fit.hypothesis)]
    return [fit, *(finish(data, other, point) for other, point in points if point is not None)]


def _bic(fit: Fit) -> float:
    return fit.bic


def faint(data: Data, level: dict[tuple[str, ...], Fit], path: tuple[Fit, ...]) -> bool:
    """Whether a first effect is small beside the noise, and another one does as well: then it is a nuisance."""
    rivals = [fit for fit in level.values() if fit is not path[1] and fit.bic - path[1].bic < TOSS_UP]
    return bool(rivals) and not changes(data, path[0], path[1], FAINT)


def slow_leftover(data: Data, fit: Fit) -> bool:
    """Whether most of what is left is slow: the innovations then say little about the free run."""
    e = data.y - fit.output
    return power(data, fit) > VERY_SLOW**2 * fit.noise.sigma2 and slow_colour(e, data.rows) > SLOW


def confirmed(data: Data, path: tuple[Fit, ...]) -> tuple[Fit, ...]:
    """The steps of a path that also help on blocks which their refits have not seen: chance and mere wander do not."""
    blocks = held_out(data.samples)
    fitted = replace(data, rows=data.rows & ~blocks)
    kept = [path[0]]
    simpler = refit(fitted, path[0])
    for fit in path[1:]:
        if any(isinstance(effect, AdditiveEffect) for effect in fit.hypothesis.effects):
            continue
        fuller = refit(fitted, fit)
        errors = [
            [
                float(np.mean((data.y - one.output)[part] ** 2))
                for part in np.array_split(np.flatnonzero(blocks), BLOCKS)
            ]
            for one in (simpler, fuller)
        ]
        better = sum(after < before for before, after in zip(*errors, strict=True))
        if better < BLOCKS - 1 or sum(errors[1]) > HELPS * sum(errors[0]):
            continue
        kept.append(fit)
        simpler = fuller
    return tuple(kept)


def nothing_left(data: Data, fit: Fit) -> bool:
    """Whether the residual is white and the input has no part in it: no further effect could gain anything."""
    return power(data, fit) < 1.03 * fit.noise.sigma2 and explained_share(data, fit, data.y - fit.output) < 0.01


def worth(data: Data, simpler: Fit, fit: Fit) -> bool:
    """Whether `fit` explains significantly more than `simpler`, and something that matters."""
    return bool(simpler.bic - fit.bic > MARGIN and changes(data, simpler, fit, EFFECT_SIZE))


def changes(data: Data, simpler: Fit, fit: Fit, size: float) -> bool:
    """Whether two simulations differ by more than `size` standard deviations of what the second one leaves."""
    change = np.sqrt(np.mean((fit.output - simpler.output)[data.rows] ** 2))
    return bool(change > max(size * rms(data, fit), NOTHING))


def trimmed(data: Data, path: tuple[Fit, ...]) -> tuple[Fit, ...]:
    """The path without the steps at its end that are significant but small: they mend what another effect is not quite.

    Two real effects each leave a mark; a further one that only trims the residual is more often a patch.
    """
    last = len(path) - 1
    while last > 0 and not changes(data, path[last - 1], path[last], NAMED_SIZE[min(last, len(NAMED_SIZE)) - 1]):
        last -= 1
    return path[: last + 1]


def unsimulated(data: Data, clean: Data, faults: RawFaults, best: Fit) -> tuple[str, ...]:
    """Effects that explain a gap without changing the simulation's course."""
    e = data.y - best.output
    floor = float(np.mean(e[clean.rows] ** 2))
    found = []
    for name, bad in (("output-dropout", faults.held), ("output-outliers", faults.spikes)):
        bad = bad & data.rows
        if bad.any() and float(np.mean(e[clean.rows | bad] ** 2)) > RAW_SIZE * floor:
            found.append(name)
    white = best.noise.sigma2
    rounding = 0.0 if faults.lattice is None else faults.lattice**2 / 12.0
    if rounding > 1.3**2 * max(white - rounding, 1e-3 * rounding) and white < 3.0 * rounding:
        found.append("output-quantization")
        if "output-dropout" in found and _rounded(data, clean, faults, best):
            found.remove("output-dropout")
    else:
        rounding = 0.0
    wanders = {"output-drift", "parameter-drift"} & set(best.hypothesis.names)
    coloured = np.sqrt(floor / white) > STRONG_COLOUR and slow_colour(e, clean.rows) > SLOW
    if coloured and floor > 3.0 * rounding and not wanders:  # what they leave, and a converter's steps, is slow too
        found.append("coloured-noise")
    return tuple(found)


def _rounded(data: Data, clean: Data, faults: RawFaults, best: Fit) -> bool:
    """Whether the held values are only those of a slow motion on the converter's lattice."""
    assert faults.lattice is not None
    held = faults.held & data.rows
    e = data.y - refit(replace(clean, rows=clean.rows | held), best).output
    return float(np.mean(e[held] ** 2)) < 0.5 * faults.lattice**2
