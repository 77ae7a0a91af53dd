"""Which effects: single ones first, then a second and a third on top of the best, as long as it gains enough."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from labsid.gap.candidates import CANDIDATES, LINEAR, add, baseline, swift_fit
from labsid.gap.context import Data
from labsid.gap.effects.base import AdditiveEffect
from labsid.gap.fitting import Fit, polish, power, refit, rms, settle
from labsid.gap.holdout import BLOCKS, held_out
from labsid.gap.hypothesis import Hypothesis
from labsid.gap.leftover import SLOW, explained_share, slow_colour
from labsid.gap.raw import RawFaults, find_held, find_spikes
from labsid.signal_quality import lattice_step

Progress = Callable[[str, float], None]

BEAM = 3
POLISHED = 6
MARGIN = 12.0  # BIC: what one effect more has to gain
NOTHING = 1e-9  # scaled: a difference of rounding
EFFECT_SIZE = 0.3  # change of the simulation over the standard deviation of what is left
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
    levels: tuple[dict[tuple[str, ...], Fit], ...]
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
    first = baseline(replace(data, rows=usable), structure)
    spikes = find_spikes(data.y - first.output, usable)
    for _ in range(2):
        clean = replace(data, rows=usable & ~spikes)
        levels, path = search_tree(clean, structure, most, progress)
        again = find_spikes(data.y - path[-1].output, usable)
        if (again ^ spikes).sum() <= 0.2 * max(again.sum(), 3):
            break
        spikes = again
    faults = RawFaults(held, stretches, spikes, None if lattice is None else lattice / data.y_scale.unit)
    if slow_leftover(clean, path[-1]):
        other_levels, other = search_tree(replace(clean, by_free_run=True), structure, most, progress)
        other = confirmed(clean, other)
        if len(other) > 1 and power(clean, other[-1]) < 0.5 * power(clean, path[-1]):
            levels, path = other_levels, other
    return Explained(clean, faults, levels, path, unsimulated(data, clean, faults, path[-1]))


def search_tree(
    data: Data, structure: Hypothesis, most: int, progress: Progress | None
) -> tuple[tuple[dict[tuple[str, ...], Fit], ...], tuple[Fit, ...]]:
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
            for place, group in enumerate(CANDIDATES):
                if progress is not None:
                    done = (number + place / len(CANDIDATES)) / len(beam)
                    progress("one effect" if step == 0 else f"{step + 1} effects", done)
                names = tuple(sorted((*parent.hypothesis.names, group[0].name)))
                if group[0].name in parent.hypothesis.names:
                    continue
                fit = add(data, parent, group, swift, *((3, 3) if step == 0 else (2, 1)))
                if fit is not None and (names not in level or fit.bic < level[names].bic):
                    level[names] = fit
        if not level:
            break
        for names, fit in sorted(level.items(), key=lambda item: item[1].bic)[:POLISHED]:
            level[names] = polish(data, settle(data, fit))
        levels.append(level)
        ranked = sorted(level.values(), key=lambda fit: fit.bic)
        beam = ranked[:BEAM]
        best = next((fit for fit in ranked if worth(data, path[-1], fit)), None)
        if best is None:
            break
        path.append(best)
        if nothing_left(data, best):
            break
    return tuple(levels), tuple(path)


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
    change = np.sqrt(np.mean((fit.output - simpler.output)[data.rows] ** 2))
    left = rms(data, fit)
    return bool(simpler.bic - fit.bic > MARGIN and change > max(EFFECT_SIZE * left, NOTHING))


def unsimulated(data: Data, clean: Data, faults: RawFaults, best: Fit) -> tuple[str, ...]:
    """Effects that explain a gap without changing the simulation's course."""
    e = data.y - best.output
    floor = float(np.mean(e[clean.rows] ** 2))
    found = []
    for name, bad in (("output-dropout", faults.held), ("output-outliers", faults.spikes)):
        bad = bad & data.rows
        if bad.any() and float(np.mean(e[clean.rows | bad] ** 2)) > RAW_SIZE * floor:
            found.append(name)
    if faults.lattice is not None:
        rounding = faults.lattice**2 / 12.0
        white = best.noise.sigma2
        if rounding > 1.3**2 * max(white - rounding, 1e-3 * rounding) and white < 3.0 * rounding:
            found.append("output-quantization")
    ratio = np.sqrt(floor / best.noise.sigma2)
    if ratio > STRONG_COLOUR and slow_colour(e, clean.rows) > SLOW:
        found.append("coloured-noise")
    return tuple(found)
