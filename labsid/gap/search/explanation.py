"""The explanation of a record: screen its samples, run the beam search, keep the effects large enough to be named."""

from dataclasses import dataclass, replace

import numpy as np

from labsid._arrays import FloatArray
from labsid.gap.effects.base import AdditiveEffect
from labsid.gap.effects.families import names_where
from labsid.gap.effects.output import Drift
from labsid.gap.fits.fitting import Fit, mean_square, refit, rms
from labsid.gap.fits.floor import SIMULATION_ERROR, digit_steps, is_printed, with_floor
from labsid.gap.fits.hypothesis import Hypothesis
from labsid.gap.fits.linear_fits import LINEAR, fit_baseline, fit_highpass
from labsid.gap.fits.log_rounding import log_rounding_error
from labsid.gap.fits.residual_tests import SLOW_CORRELATION, comes_and_goes, slow_autocorrelation
from labsid.gap.fits.undriven_poles import slowest_driven_rate
from labsid.gap.record.data import Data
from labsid.gap.record.holdout import BLOCKS, held_out_samples
from labsid.gap.record.sample_faults import (
    SampleFaults,
    find_bad_start,
    find_lattice,
    find_spikes,
    flat_samples,
    reading_errors,
    without_limited,
    without_responses,
    without_rest,
    without_slow_ends,
)
from labsid.gap.search.beam_search import (
    MIN_CHANGE,
    Levels,
    Progress,
    best_path,
    differ,
    rather_a_set,
    residual_is_white,
    rms_difference,
    search_effects,
)
from labsid.gap.search.candidates import trial_fits
from labsid.records.signal_quality import find_held, shortest_repeat
from labsid.simulators.meter import BudgetSpentError

MOST_EFFECTS = 3  # of an explanation; set by hand
CONVERTER_LIMITED = 1.3**2
"""Rounding variance over that of other noise, where the converter limits the record; set by hand."""
CONVERTER_LIMITED_HELD = 0.7
"""The same if the logger holds values, not all of which a coarse lattice shows; set by hand."""
MAX_FALSE_SPIKES = 0.03
"""Share of the samples: more spikes are the baseline's error; the search is repeated; set by hand."""
MIN_NAMED_CHANGE = (MIN_CHANGE, 1.0, 2.0)  # for a first, second and third effect to be named; set by hand
MIN_SHARE_OF_GAP = 0.07
"""Change of the output over the baseline's error, of further effects; measured: true ones reach 0.14."""
MIN_SPIKES = 2  # one sample may be anything; the fits exclude it; set by hand
MIN_UNRIVALLED_CHANGE = 0.6  # for a first effect that has rivals of nearly the same BIC; set by hand
UNDECIDED_BIC = 6.0
"""BIC difference of fits that are not told apart; measured: below it 43 % were right, in a prototype."""
BAD_SAMPLE_RATIO = 1.3  # mean square error with the bad samples over that without them; set by hand
COLOUR_RATIO = 1.3  # standard deviation of coloured noise over that of its innovations, at least; set by hand
ROUNDING_RATIO = 1.3
"""Mean square error over that of the converter alone, above which it is more than rounding; set by hand."""
LOGGED_RATIO = 2.0
"""Mean square error, less white noise, over that of the log of the input, of more than this log; set by hand."""
SLOW_NOISE = 5.0  # samples: correlation time from which coloured noise is an effect; definition
SLOW_NOISE_SHARE = 0.25  # the same over the slowest time constant of the rig: faster noise is no gap; definition
SLOW_RESIDUAL_RATIO = 4.0  # standard deviation of the residual over that of its innovations; set by hand
MAX_ERROR_RATIO = 0.8  # error on the blocks left out, with an effect over without it; set by hand


@dataclass(frozen=True, slots=True, eq=False)
class Explanation:
    """All fits of a record, and the accepted ones.

    Attributes
    ----------
    data : Data
        With the rows that were fitted.
    faults : SampleFaults
    levels : tuple of dict
        Level n holds the best fit of every combination of n effects tried, by sorted names; level 0 is the baseline.
    path : tuple of Fit
        From the baseline to the accepted fit, one effect more at each step.
    unsimulated : tuple of str
        Effects found in the samples, not by simulation: held samples, spikes, quantization, coloured noise.
    floor : float
        Rms of the noise that was added to the output of `data`, for what digits and simulators leave; scaled.
    """

    data: Data
    faults: SampleFaults
    levels: Levels
    path: tuple[Fit, ...]
    unsimulated: tuple[str, ...]
    floor: float = 0.0

    @property
    def best(self) -> Fit:
        """The accepted fit."""
        return self.path[-1]

    @property
    def names(self) -> tuple[str, ...]:
        """Names of all effects."""
        return (*self.best.hypothesis.names, *self.unsimulated)


@dataclass(frozen=True, slots=True, eq=False)
class _Screened:
    """What the readings alone show, before any fit: held values, the step of a converter, the digits of the log.

    Attributes
    ----------
    data : Data
        With the step, and with at least the noise that digits and simulators leave.
    measured : ndarray
        The output without that noise.
    held : ndarray of bool
        The held samples.
    stretches : tuple of (int, int)
        The same, as half-open ranges of readings.
    off, flat : ndarray of bool
        Readings off the lattice of the others or at a bad start, and readings that have no noise.
    step : float or None
        Of the converter, scaled.
    resolution : ndarray or None
        Error of each reading from its printed digits; None if there is a step.
    """

    data: Data
    measured: FloatArray
    held: np.ndarray
    stretches: tuple[tuple[int, int], ...]
    off: np.ndarray
    flat: np.ndarray
    step: float | None
    resolution: FloatArray | None

    @property
    def usable(self) -> np.ndarray:
        """The rows without held values."""
        return self.data.rows & ~self.held

    @property
    def floor(self) -> float:
        """Rms of the noise that was added."""
        return float(np.sqrt(np.mean((self.data.y - self.measured)[self.data.rows] ** 2)))

    def spikes_of(self, fit: Fit) -> np.ndarray:
        """Samples off the lattice of the others, and isolated errors of the readings."""
        readings = self.data.readings
        e, looked_at = readings(self.measured - fit.output), readings(self.usable) & ~self.flat
        isolated = find_spikes(e, looked_at, self.step or 0.0, self.resolution)
        isolated = without_responses(isolated, readings(self.data.u))
        isolated = without_limited(isolated, e, readings(self.measured))
        return self.data.among_samples(self.off | isolated)


@dataclass(frozen=True, slots=True, eq=False)
class _Found:
    """What a search found on some samples: the best fit of each combination, and the path to the accepted one."""

    data: Data
    levels: Levels
    path: tuple[Fit, ...]


@dataclass(frozen=True, slots=True, eq=False)
class _Search:
    """The beam search, with all that it is told but the samples."""

    structure: Hypothesis
    start: FloatArray | None
    most: int
    progress: Progress | None

    def on(self, data: Data) -> _Found:
        """What is found on some samples."""
        return _Found(data, *search_effects(data, self.structure, self.start, self.most, self.progress))

    def again_on(self, data: Data) -> _Found | None:
        """The same on other samples; None if it spends the budget of runs, and is less complete than the first."""
        try:
            found = self.on(data)
        except BudgetSpentError:
            return None
        return None if self.structure.plant.simulation.meter.exhausted else found


def explain(
    data: Data,
    structure: Hypothesis = LINEAR,
    start: FloatArray | None = None,
    most: int = MOST_EFFECTS,
    progress: Progress | None = None,
) -> Explanation:
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

    Notes
    -----
    There is one search, on the samples without held values and spikes. It is run again in two cases only: on other
    samples, if the baseline's error hid spikes or looked like some; and by the error of the free run, if what is left
    is slow and an effect halves it. Neither repeat can be foreseen: the residual of the first search decides.
    """
    screened, search = _screen(data), _Search(structure, start, most, progress)
    found, spikes = _search_without_spikes(screened, search)
    found = _by_free_run(found, search)
    path = _large_enough(found)
    faults = SampleFaults(screened.held, screened.stretches, spikes, screened.step, screened.resolution)
    unsimulated = unsimulated_effects(screened.data, found.data, faults, path)
    return Explanation(found.data, faults, found.levels, path, unsimulated, screened.floor)


def _screen(data: Data) -> _Screened:
    """Look at the readings alone."""
    u, scaled = data.sampled
    y = np.asarray(data.y_scale.back(scaled))
    unit = data.y_scale.unit
    lattice, off = find_lattice(y)
    digits = digit_steps(y)
    stretches = find_held(y, lattice, shortest_repeat(y, max(lattice or 0.0, digits.max())))
    stretches = without_rest(without_slow_ends(stretches, y, SIMULATION_ERROR * unit), u)
    if lattice is not None and is_printed(lattice, y):
        lattice = None
    held = np.zeros(y.size, bool)
    for stretch in stretches:
        held[slice(*stretch)] = True
    return _Screened(
        data=with_floor(replace(data, lattice=0.0 if lattice is None else lattice / unit)),
        measured=data.y,
        held=data.among_samples(held),
        stretches=stretches,
        off=off | find_bad_start(y),
        flat=flat_samples(y) if lattice is None else np.zeros(y.size, bool),
        step=None if lattice is None else lattice / unit,
        resolution=None if lattice is not None else reading_errors(y, digits) / unit,
    )


def _search_without_spikes(screened: _Screened, search: _Search) -> tuple[_Found, np.ndarray]:
    """Run the beam search without the spikes, and detect the spikes again on the residual of the best fit."""
    data, usable = screened.data, screened.usable
    spikes = screened.spikes_of(fit_baseline(replace(data, rows=usable), search.structure, search.start))
    found = search.on(replace(data, rows=usable & ~spikes))
    again = screened.spikes_of(found.path[-1])
    hidden, made = (again & ~spikes).sum(), (spikes & ~again).sum()  # because of the baseline's error
    if hidden > 0.2 * max(again.sum(), 10) or made > MAX_FALSE_SPIKES * data.samples:
        clean = replace(data, rows=usable & ~again)
        found = search.again_on(clean) or replace(found, data=clean)
        spikes, again = again, screened.spikes_of(found.path[-1])
    if (again ^ spikes).any():
        clean = replace(data, rows=usable & ~again)
        new = {fit: refit(clean, fit) for level in found.levels for fit in level.values()}
        levels = tuple({names: new[fit] for names, fit in level.items()} for level in found.levels)
        return _Found(clean, levels, best_path(clean, levels)), again
    return found, spikes


def _by_free_run(found: _Found, search: _Search) -> _Found:
    """What a search by the error of the free run finds, where the residual is slow and it halves the error."""
    clean, path = found.data, found.path
    if not residual_is_slow(clean, path[-1]):
        return found
    if not (halved_by_drift(clean, path) or halved_inside(clean, found.levels, path)):
        return found
    briefly = replace(search, most=min(search.most, 2))
    other = briefly.again_on(replace(clean, by_free_run=True)) or replace(found, path=path[:1])
    steps = other.path
    if mean_square(clean, steps[-1]) > COLOUR_RATIO**2 * steps[-1].noise.sigma2:
        steps = cross_validated(clean, steps)  # an explanation with nearly white residuals needs no validation
    better = len(steps) > 1 and mean_square(clean, steps[-1]) < 0.5 * mean_square(clean, path[-1])
    return _Found(clean, other.levels, steps) if better else found


def _large_enough(found: _Found) -> tuple[Fit, ...]:
    """The path with the effects that are large enough to be named, or with a set of them."""
    clean, path = found.data, found.path
    shorter = without_small_steps(clean, path)
    path = path if shorter == path else rather_a_set(clean, found.levels, shorter)
    is_small = len(path) == 2 and is_nuisance(clean, found.levels[1], path)
    return path[:1] if is_small or (len(path) > 1 and is_rounding_of_log(clean, path[0], path[-1])) else path


def is_nuisance(data: Data, level: dict[tuple[str, ...], Fit], path: tuple[Fit, ...]) -> bool:
    """Whether a single effect is small compared with the noise and has a rival of similar BIC."""
    rivals = [fit for fit in level.values() if fit is not path[1] and fit.bic - path[1].bic < UNDECIDED_BIC]
    return bool(rivals) and not differ(data, path[0], path[1], MIN_UNRIVALLED_CHANGE)


def is_rounding_of_log(data: Data, before: Fit, after: Fit) -> bool:
    """Whether the rounding of the log of the input leaves all of an error but the noise `after` the effects found."""
    logged = log_rounding_error(data, before, after, residual_is_white(data, after))
    return logged > 0.0 and mean_square(data, before) < logged + after.noise.sigma2


def residual_is_slow(data: Data, fit: Fit) -> bool:
    """Whether most of the residual is slow, so that the innovations say little about the free run."""
    e = data.y - fit.output
    return (
        mean_square(data, fit) > SLOW_RESIDUAL_RATIO**2 * fit.noise.sigma2
        and slow_autocorrelation(data.readings(e), data.readings(data.rows)) > SLOW_CORRELATION
    )


def halved_by_drift(data: Data, path: tuple[Fit, ...]) -> bool:
    """Whether a drift of the sensor halves the error; a search by innovations need not find it beside other effects."""
    if Drift.name in path[-1].hypothesis.names:
        return False
    trials = trial_fits(data, path[-1], Drift.searched(), fit_highpass(data, path[0]), brief=True)
    return bool(trials) and trials[0].point.cost < 0.5 * mean_square(data, path[-1])


def halved_inside(data: Data, levels: Levels, path: tuple[Fit, ...]) -> bool:
    """Whether an effect inside a simulation that opens halves the error, which the innovations hardly show."""
    if path[0].hypothesis.plant.simulation.port is None or len(levels) < 2:
        return False
    least = min((mean_square(data, fit) for fit in levels[1].values()), default=np.inf)
    return bool(least < 0.5 * mean_square(data, path[-1]))


def cross_validated(data: Data, path: tuple[Fit, ...]) -> tuple[Fit, ...]:
    """The steps of a path that also reduce the error on blocks left out of their refits."""
    blocks = held_out_samples(data.samples)
    parts = np.array_split(np.flatnonzero(blocks), BLOCKS)
    fitted = replace(data, rows=data.rows & ~blocks)
    kept = [path[0]]
    simpler = refit(fitted, path[0])
    for fit in path[1:]:
        if any(isinstance(effect, AdditiveEffect) for effect in fit.hypothesis.found):
            continue
        fuller = refit(fitted, fit)
        left = [data.y - one.output for one in (simpler, fuller)]
        errors = [[float(np.mean(e[part] ** 2)) for part in parts] for e in left]
        better = sum(after < before for before, after in zip(*errors, strict=True))
        if better < BLOCKS - 1 or sum(errors[1]) > MAX_ERROR_RATIO * sum(errors[0]):
            continue
        kept.append(fit)
        simpler = fuller
    return tuple(kept)


def without_small_steps(data: Data, path: tuple[Fit, ...]) -> tuple[Fit, ...]:
    """The path without the significant but small steps at its end.

    Such a step usually corrects an error in the model of another effect.
    """
    last = len(path) - 1
    patch = MIN_SHARE_OF_GAP * rms(data, path[0])
    while last > 0:
        named = differ(data, path[last - 1], path[last], MIN_NAMED_CHANGE[change_place(last)])
        if named and (last == 1 or rms_difference(data, path[last - 1], path[last]) > patch):
            break
        last -= 1
    return path[: last + 1]


def change_place(effects: int) -> int:
    """Place in `MIN_NAMED_CHANGE` of the last of so many effects."""
    return min(effects, len(MIN_NAMED_CHANGE)) - 1


def unsimulated_effects(data: Data, clean: Data, faults: SampleFaults, path: tuple[Fit, ...]) -> tuple[str, ...]:
    """Effects that cause a gap without changing the simulated output: sample faults, quantization, coloured noise."""
    best = path[-1]
    e = data.y - best.output
    floor = float(np.mean(e[clean.rows] ** 2))
    found = []
    spikes = faults.spikes.copy()
    spikes[0] = False  # the logger's start-up, or the step to the first input
    if spikes.sum() < MIN_SPIKES:
        spikes[:] = False
    for name, bad in (("output-dropout", faults.held), ("output-outliers", spikes)):
        beyond = data.among_samples(faults.beyond_resolution(data.readings(e)))
        bad = bad & data.rows & beyond
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
    wanders = names_where("wanders") & set(best.hypothesis.names)
    coloured = (
        np.sqrt(floor / white) > COLOUR_RATIO
        and slow_autocorrelation(data.readings(e), data.readings(clean.rows)) > SLOW_CORRELATION
    )
    if len(path) > 1:  # what a law that is not quite right leaves of an effect is slow, too
        coloured &= floor - white > MIN_SHARE_OF_GAP**2 * mean_square(clean, path[0])
    if (
        coloured
        and noise_is_slow(clean, best)
        and floor > ROUNDING_RATIO * rounding
        and not wanders
        and not comes_and_goes(e[clean.rows], best.noise)
    ):  # drift and rounding leave a slow residual, too
        logged = log_rounding_error(clean, best)
        if not logged or floor > LOGGED_RATIO * logged + white:
            found.append("coloured-noise")
    return tuple(found)


def noise_is_slow(data: Data, fit: Fit) -> bool:
    """Whether the noise is too slow to be that of a sensor: compared with the sampling time, and with the rig."""
    return fit.noise.correlation_time > max(SLOW_NOISE, SLOW_NOISE_SHARE / slowest_driven_rate(data, fit))


def _held_by_rounding(data: Data, clean: Data, faults: SampleFaults, best: Fit) -> bool:
    """Whether the held values are explained by slow motion within one converter step."""
    assert faults.lattice is not None
    held = faults.held & data.rows
    e = data.y - refit(replace(clean, rows=clean.rows | held), best).output
    return float(np.mean(e[held] ** 2)) < 0.5 * faults.lattice**2
