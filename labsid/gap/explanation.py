"""Which effects: single ones first, then a second and a third on top of the best, as long as it gains enough."""

from dataclasses import dataclass, replace

import numpy as np

from labsid._arrays import FloatArray
from labsid.gap.beam_search import MIN_CHANGE, Levels, Progress, best_path, differ, rms_difference, search_effects
from labsid.gap.data import Data
from labsid.gap.effects.base import AdditiveEffect
from labsid.gap.fitting import Fit, power, refit, rms
from labsid.gap.holdout import BLOCKS, held_out_samples
from labsid.gap.hypothesis import Hypothesis
from labsid.gap.leftover import SLOW, slow_colour
from labsid.gap.linear_fits import LINEAR, baseline
from labsid.gap.sample_faults import SampleFaults, find_held, find_lattice, find_spikes

CONVERTER_LIMITED = 1.3**2  # of the variance that is no rounding: from here on the converter is what limits the record
CONVERTER_LIMITED_HELD = 0.7  # the same where the logger holds values: on a coarse lattice some of that is never found
MAX_FALSE_SPIKES = 0.03  # of the samples: spikes that the baseline's error made, for which the search is repeated
MIN_NAMED_CHANGE = (MIN_CHANGE, 1.0, 2.0)  # the same, for a first, second and third effect that is named
MIN_SHARE_OF_GAP = (
    0.07  # the same over the error of the baseline, for a second and a third effect: true ones make up 0.14
)
MIN_UNRIVALLED_CHANGE = 0.6  # the same, below which a first effect that is not told from others is none
UNDECIDED_BIC = 6.0  # BIC
BAD_SAMPLE_RATIO = 1.3  # mean square error with the bad samples over that without them
COLOUR_RATIO = 1.3  # standard deviation of the noise over that of its innovations
ROUNDING_RATIO = 1.3  # mean square error over that of the converter alone
SLOW_RESIDUAL_RATIO = 4.0  # standard deviation of the residual over that of its innovations
MAX_ERROR_RATIO = 0.8  # of the error on blocks that were not fitted


@dataclass(frozen=True, slots=True, eq=False)
class Explanation:
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
    unsimulated : tuple of str
        Effects that no simulation shows: of single samples, and coloured noise.
    trimmed : tuple of Fit
        What the search went on to from there: steps that gain significantly, but too little to be named.
    """

    data: Data
    faults: SampleFaults
    levels: Levels
    path: tuple[Fit, ...]
    unsimulated: tuple[str, ...]
    trimmed: tuple[Fit, ...] = ()

    @property
    def best(self) -> Fit:
        """The accepted hypothesis."""
        return self.path[-1]

    def up_to(self, level: int) -> "Explanation":
        """The same without the effects beyond a level of the path."""
        return replace(self, path=self.path[: level + 1], trimmed=())

    def untrimmed(self) -> "Explanation":
        """The same with the steps that are too small to be named."""
        return replace(self, path=self.path + self.trimmed, trimmed=())

    @property
    def names(self) -> tuple[str, ...]:
        """All effects."""
        return (*self.best.hypothesis.names, *self.unsimulated)


def explain(
    data: Data,
    structure: Hypothesis = LINEAR,
    start: FloatArray | None = None,
    most: int = 3,
    progress: Progress | None = None,
) -> Explanation:
    """Search for the effects that explain a record.

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
    y = np.asarray(data.y_scale.back(data.y))
    lattice, off = find_lattice(y)
    stretches = find_held(y, lattice)
    step = 0.0 if lattice is None else lattice / data.y_scale.unit
    data = replace(data, lattice=step)
    held = np.zeros(data.samples, bool)
    for stretch in stretches:
        held[slice(*stretch)] = True
    usable = data.rows & ~held
    clean, spikes, levels, path = _search_without_spikes(data, usable, off, structure, start, most, progress)
    faults = SampleFaults(held, stretches, spikes, None if lattice is None else step)
    if residual_is_slow(clean, path[-1]):
        other_levels, other = search_effects(replace(clean, by_free_run=True), structure, start, min(most, 2), progress)
        if power(clean, other[-1]) > COLOUR_RATIO**2 * other[-1].noise.sigma2:
            other = cross_validated(clean, other)  # what leaves hardly any colour needs no other proof
        if len(other) > 1 and power(clean, other[-1]) < 0.5 * power(clean, path[-1]):
            levels, path = other_levels, other
    whole, path = path, without_small_steps(clean, path)
    cut = whole[len(path) :]
    if len(path) == 2 and is_nuisance(clean, levels[1], path):
        path, cut = path[:1], ()
    return Explanation(clean, faults, levels, path, unsimulated_effects(data, clean, faults, path[-1]), cut)


def _search_without_spikes(
    data: Data,
    usable: np.ndarray,
    off: np.ndarray,
    structure: Hypothesis,
    start: FloatArray | None,
    most: int,
    progress: Progress | None,
) -> tuple[Data, np.ndarray, Levels, tuple[Fit, ...]]:
    """The beam search without the spikes, which are judged beside the best explanation: it may be what makes them.

    Samples `off` the lattice on which all others lie are spikes in any case.
    """
    first = baseline(replace(data, rows=usable), structure, start)
    spikes = off | find_spikes(data.y - first.output, usable, data.lattice)
    clean = replace(data, rows=usable & ~spikes)
    levels, path = search_effects(clean, structure, start, most, progress)
    again = off | find_spikes(data.y - path[-1].output, usable, data.lattice)
    hidden, made = (again & ~spikes).sum(), (spikes & ~again).sum()  # by the baseline's error
    if hidden > 0.2 * max(again.sum(), 10) or made > MAX_FALSE_SPIKES * data.samples:
        clean = replace(data, rows=usable & ~again)
        levels, path = search_effects(clean, structure, start, most, progress)
        spikes, again = again, off | find_spikes(data.y - path[-1].output, usable, data.lattice)
    if (again ^ spikes).any():
        clean = replace(data, rows=usable & ~again)
        new = {fit: refit(clean, fit) for level in levels for fit in level.values()}
        levels = tuple({names: new[fit] for names, fit in level.items()} for level in levels)
        return clean, again, levels, best_path(clean, levels)
    return clean, spikes, levels, path


def is_nuisance(data: Data, level: dict[tuple[str, ...], Fit], path: tuple[Fit, ...]) -> bool:
    """Whether a first effect is small beside the noise, and another one does as well: then it is a nuisance."""
    rivals = [fit for fit in level.values() if fit is not path[1] and fit.bic - path[1].bic < UNDECIDED_BIC]
    return bool(rivals) and not differ(data, path[0], path[1], MIN_UNRIVALLED_CHANGE)


def residual_is_slow(data: Data, fit: Fit) -> bool:
    """Whether most of what is left is slow: the innovations then say little about the free run."""
    e = data.y - fit.output
    return power(data, fit) > SLOW_RESIDUAL_RATIO**2 * fit.noise.sigma2 and slow_colour(e, data.rows) > SLOW


def cross_validated(data: Data, path: tuple[Fit, ...]) -> tuple[Fit, ...]:
    """The steps of a path that also help on blocks which their refits have not seen: chance and mere wander do not."""
    blocks = held_out_samples(data.samples)
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
        if better < BLOCKS - 1 or sum(errors[1]) > MAX_ERROR_RATIO * sum(errors[0]):
            continue
        kept.append(fit)
        simpler = fuller
    return tuple(kept)


def without_small_steps(data: Data, path: tuple[Fit, ...]) -> tuple[Fit, ...]:
    """The path without the steps at its end that are significant but small: they mend what another effect is not quite.

    Two real effects each leave a mark; a further one that only trims the residual is more often a patch.
    """
    last = len(path) - 1
    patch = MIN_SHARE_OF_GAP * rms(data, path[0])
    while last > 0:
        named = differ(data, path[last - 1], path[last], MIN_NAMED_CHANGE[min(last, len(MIN_NAMED_CHANGE)) - 1])
        if named and (last == 1 or rms_difference(data, path[last - 1], path[last]) > patch):
            break
        last -= 1
    return path[: last + 1]


def unsimulated_effects(data: Data, clean: Data, faults: SampleFaults, best: Fit) -> tuple[str, ...]:
    """Effects that explain a gap without changing the simulation's course."""
    e = data.y - best.output
    floor = float(np.mean(e[clean.rows] ** 2))
    found = []
    for name, bad in (("output-dropout", faults.held), ("output-outliers", faults.spikes)):
        bad = bad & data.rows
        if bad.any() and float(np.mean(e[clean.rows | bad] ** 2)) > BAD_SAMPLE_RATIO * floor:
            found.append(name)
    white = best.noise.sigma2
    rounding = 0.0 if faults.lattice is None else faults.lattice**2 / 12.0
    beside = CONVERTER_LIMITED_HELD if "output-dropout" in found else CONVERTER_LIMITED
    if rounding > beside * max(white - rounding, 1e-3 * rounding) and white < 3.0 * rounding:
        found.append("output-quantization")
        if "output-dropout" in found and _held_by_rounding(data, clean, faults, best):
            found.remove("output-dropout")
    else:
        rounding = 0.0
    wanders = {"output-drift", "parameter-drift"} & set(best.hypothesis.names)
    coloured = np.sqrt(floor / white) > COLOUR_RATIO and slow_colour(e, clean.rows) > SLOW
    if coloured and floor > ROUNDING_RATIO * rounding and not wanders:  # what they and a converter leave is slow too
        found.append("coloured-noise")
    return tuple(found)


def _held_by_rounding(data: Data, clean: Data, faults: SampleFaults, best: Fit) -> bool:
    """Whether the held values are only those of a slow motion on the converter's lattice."""
    assert faults.lattice is not None
    held = faults.held & data.rows
    e = data.y - refit(replace(clean, rows=clean.rows | held), best).output
    return float(np.mean(e[held] ** 2)) < 0.5 * faults.lattice**2
