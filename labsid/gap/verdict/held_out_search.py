"""Effects that reduce the free-run error on held-out samples, for records that no combination explains completely.

Where the residual is no noise, the whitened one-step criterion of the beam search ranks candidates by what none of them
describes. Here the combinations are compared by their free-run error on samples that no fit has used, and an effect is
kept only if it pays there: if the error without it, part by part of those samples, is larger by more than chance.
"""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field, replace

import numpy as np

from labsid._arrays import FloatArray
from labsid._cores import mapped
from labsid.gap.effects.families import names_where
from labsid.gap.effects.inside import MISMATCH
from labsid.gap.fits.fitting import Fit, fit_from, mean_square
from labsid.gap.fits.linear_fits import fit_highpass
from labsid.gap.record.data import Data
from labsid.gap.search.beam_search import Progress, extended_fits
from labsid.gap.search.explanation import Explanation
from labsid.gap.search.forms import plain_forms, remove_named_effect, transfer_theta
from labsid.gap.search.sets import set_around
from labsid.gap.verdict.held_out_errors import MAX_FACTOR, HeldOut, Reduction, compare_errors, hold_out

MOST_EFFECTS = 3  # of a partial explanation; set by hand
COMPARED = 8  # combinations of two and of three effects that are refitted: those of least error; set by hand
NOT_WORSE = 1.02  # error on another record with an effect over that without it, where it may act; set by hand
MOST_ROUNDS = 4  # of additions and exchanges; numerics


@dataclass(frozen=True, slots=True, eq=False)
class Candidate:
    """A combination of effects, fitted to the samples that are not held out.

    Attributes
    ----------
    fit : Fit
    errors : ndarray
        Mean square errors in the parts of the held-out samples.
    total : float
        Their mean, over that of the simulation before. Beside another record, the mean of this share and of that of the
        mean square error to be expected on further samples of the fitted record: in both records all of the gap counts
        alike.
    """

    fit: Fit
    errors: FloatArray
    total: float

    @property
    def names(self) -> frozenset[str]:
        """The effects."""
        return frozenset(self.fit.hypothesis.names)


@dataclass(frozen=True, slots=True, eq=False)
class Step:
    """One more effect.

    Attributes
    ----------
    name : str
        The effect.
    fit : Fit
        With this effect, to the rows that are not held out.
    errors : ndarray
        Mean square errors in the parts of the held-out samples.
    alone : Reduction or None
        This effect alone compared with the simulation before; None if it was not tried alone.
    lead : float
        Rms error of the best other effect alone over that of this effect alone; 1 if it was not tried alone.
    agreement : int
        1 if the beam search, which ranks by BIC, found this effect, too; -1 if it found others, 0 if it found none.
    rivals : tuple of (str, float)
        Other effects in its place, best first, with their rms error over that of this one.
    mates : frozenset of str
        The other effects of the explanation that belong to a set with it, and are tried together with it.
    together : Reduction or None
        The whole set compared with the simulation before; None without mates.
    missed : float
        Rms error of the explanation over that without this effect.
    """

    name: str
    fit: Fit
    errors: FloatArray
    alone: Reduction | None
    lead: float
    agreement: int
    rivals: tuple[tuple[str, float], ...] = ()
    mates: frozenset[str] = frozenset()
    together: Reduction | None = None
    missed: float = 1.0


@dataclass(frozen=True, slots=True)
class Judgement:
    """Whether every effect of a combination pays.

    Attributes
    ----------
    weakest : str
        The effect without which the error grows least.
    reduction : Reduction
        What it reduces.
    kept : bool
        Whether it pays, by itself or together with the effects of its set.
    """

    weakest: str
    reduction: Reduction
    kept: bool


@dataclass(frozen=True, slots=True, eq=False)
class HeldOutSearch:
    """Result of `search_held_out`.

    Attributes
    ----------
    steps : tuple of Step
        The effects that pay, in the order in which each reduces the error most.
    tried : dict
        By sorted names: mean square error on the held-out samples of every combination tried.
    elsewhere : Fit or None
        The best fit without effects whose time course belongs to this record, if some of `steps` are such effects.
    mismatch : Reduction or None
        Of a given simulation: what other values of its parameters reduce, if that pays.
    fits : dict
        By sorted names: the fit of every combination tried.
    totals : dict
        By sorted names: `Candidate.total` of every combination tried.
    judged : dict
        By sorted names: the combinations whose effects were examined; of a given simulation also other values of its
        parameters, as `parameter-mismatch`.
    """

    steps: tuple[Step, ...]
    tried: dict[tuple[str, ...], float]
    elsewhere: Fit | None
    mismatch: Reduction | None = None
    fits: dict[tuple[str, ...], Fit] = field(default_factory=dict)
    totals: dict[tuple[str, ...], float] = field(default_factory=dict)
    judged: dict[tuple[str, ...], Judgement] = field(default_factory=dict)


class _Pool:
    """The best candidate of every combination of names."""

    def __init__(self, held_out: HeldOut, start: Fit, before: FloatArray, progress: Progress | None) -> None:
        self.held_out, self.progress = held_out, progress
        mean, self.own = float(np.mean(before)), held_out.expected(start)
        self.before = max(mean, 1e-300) if np.isfinite(mean) else 1.0  # of a simulation that diverges elsewhere
        self.start = Candidate(start, before, 1.0 if np.isfinite(mean) else np.inf)
        self.best: dict[frozenset[str], Candidate] = {self.start.names: self.start}
        self.data = replace(held_out.data, by_free_run=True)
        self.highpass = fit_highpass(self.data, start)
        self.extended = {self.start.names}  # combinations to which every further effect has been added
        self.removed: set[tuple[Fit, str]] = set()  # effects of a fit without which it has been refitted
        self.blocks = hold_out(self.data, None) if held_out.other is not None else None
        self.on_blocks: dict[Fit, FloatArray] = {}
        self.judged: dict[tuple[str, ...], Judgement] = {}

    def add(self, fits: Iterable[Fit]) -> None:
        """Keep the fits that are the best of their names; none where the budget of runs did not suffice for its fit."""
        meter = self.start.fit.hypothesis.plant.simulation.meter
        for fit in fits:
            if meter is not None and meter.exhausted:
                break
            if self.held_out.elsewhere and names_where("of_one_record") & set(fit.hypothesis.names):
                continue  # not in the other record
            candidate = self._scored(fit)
            known = self.best.get(candidate.names)
            if np.isfinite(candidate.total) and (known is None or candidate.total < known.total):
                self.best[candidate.names] = candidate

    def _scored(self, fit: Fit) -> Candidate:
        errors = self.held_out.errors(fit)
        shares = [float(np.mean(errors)) / self.before]
        if self.own is not None:
            shares.append((self.held_out.expected(fit) or 0.0) / max(self.own, 1e-300))
        return Candidate(fit, errors, float(np.mean(shares)))

    def reduction(self, fewer: Candidate, fuller: Candidate) -> Reduction:
        """What the effects of a candidate reduce that another one lacks.

        Beside another record, blocks of the fitted one count alike, by fits that have not used them: which effects act
        in the other record is chance. On that record alone the error must not grow.
        """
        found = compare_errors(fewer.errors, fuller.errors)
        if self.blocks is None:
            return found
        factor = _rms_ratio(fuller, fewer)
        if found.pays:
            return replace(found, factor=factor)
        if found.factor > NOT_WORSE:
            return Reduction(factor, min(found.t, 0.0))
        both = [np.append(one.errors, self._errors_on_blocks(one.fit)) for one in (fewer, fuller)]
        return Reduction(factor, compare_errors(*both).t)

    def _errors_on_blocks(self, fit: Fit) -> FloatArray:
        assert self.blocks is not None
        if fit not in self.on_blocks:
            self.on_blocks[fit] = self.blocks.errors(self.blocks.refit(fit))
        return self.on_blocks[fit]

    def without(self, candidate: Candidate, name: str) -> Candidate:
        """The best candidate with one effect less."""
        names = candidate.names - {name}
        if names and (candidate.fit, name) not in self.removed:
            self.removed.add((candidate.fit, name))
            fewer = remove_named_effect(self.held_out.data, candidate.fit, name)
            self.add([] if fewer is None else [fewer])
        return self.best.get(names, self.start)

    def extend(self, candidate: Candidate) -> None:
        """Add every further effect to a candidate, once."""
        if candidate.names not in self.extended:
            self.extended.add(candidate.names)
            self.add(extended_fits(self.data, candidate.fit, self.highpass, len(candidate.names), self.progress))


def search_held_out(
    held_out: HeldOut,
    explanation: Explanation,
    start: Fit,
    before: FloatArray,
    given: bool = False,
    progress: Progress | None = None,
) -> HeldOutSearch:
    """Find the combination of least error on the held-out samples in which every effect pays.

    From the best combination of the beam search, effects are added and exchanged while that reduces the error.

    Parameters
    ----------
    held_out : HeldOut
    explanation : Explanation
        Result of the beam search, whose combinations are compared.
    start : Fit
        The fit to which effects are added, to the rows that are not held out.
    before : ndarray
        Errors of the simulation before in the parts of the held-out samples.
    given : bool
        Whether `start` is a given simulation with fitted parameters, `before` without: an effect then has to pay beside
        the fitted parameters.
    progress : callable, optional

    Returns
    -------
    HeldOutSearch
    """
    refitted = held_out.errors(start) if given else before
    mismatch = compare_errors(before, refitted)
    pool = _Pool(held_out, start, min(before, refitted, key=np.sum), progress)
    if given:
        pool.judged[MISMATCH,] = Judgement(MISMATCH, mismatch, mismatch.pays)
    for number, level in enumerate(explanation.levels[1:]):
        fits = sorted(level.values(), key=lambda fit: mean_square(explanation.data, fit))
        kept = fits if number == 0 else fits[:COMPARED]
        pool.add(_refitted(held_out, kept))
        pool.add(_plain_fits(held_out.data, level.values()))
    best = _best_paying(pool)
    for _ in range(MOST_ROUNDS):
        if len(best.names) < MOST_EFFECTS:
            pool.extend(best)
        for name in best.names if len(best.names) > 1 else ():
            pool.extend(pool.without(best, name))
        other = _best_paying(pool)
        if other.total >= best.total:
            break
        best = other
    tried = {tuple(sorted(names)): float(np.mean(one.errors)) for names, one in pool.best.items() if names}
    elsewhere = None
    if best.names & names_where("of_one_record"):
        lasting = (one for names, one in pool.best.items() if not names & names_where("of_one_record"))
        elsewhere = _paying(pool, min(lasting, key=lambda one: one.total)).fit
    every = {tuple(sorted(names)): one.fit for names, one in pool.best.items()}
    steps = _steps(pool, best, explanation.best.hypothesis.names)
    return HeldOutSearch(
        steps,
        tried,
        elsewhere,
        mismatch if mismatch.pays else None,
        every,
        {tuple(sorted(names)): one.total for names, one in pool.best.items() if names},
        pool.judged,
    )


def _refitted(held_out: HeldOut, fits: list[Fit]) -> Iterable[Fit]:
    """The fits to the rows that are not held out; one after the other where each takes from a budget of runs."""
    simulations = [fit.hypothesis.plant.simulation for fit in fits[:1]]
    if any(one.meter.budget is not None for one in simulations):
        return map(held_out.refit, fits)
    return mapped(held_out.refit, fits, (held_out.data, *simulations))


def _plain_fits(data: Data, fits: Iterable[Fit]) -> Iterator[Fit]:
    """Fits whose effects have the form that another one makes richer, which need not predict better."""
    for fit in fits:
        for other in plain_forms(fit.hypothesis):
            plain = fit_from(data, other, transfer_theta(fit, other))
            if plain is not None:
                yield plain


def _best_paying(pool: _Pool) -> Candidate:
    """The candidate of least error in which every effect pays: one of the best, without the effects that do not."""
    best = pool.start
    for candidate in sorted(pool.best.values(), key=lambda one: one.total)[:COMPARED]:
        if candidate.total < best.total:
            best = min(best, _paying(pool, candidate), key=lambda one: one.total)
    return best


def _paying(pool: _Pool, candidate: Candidate) -> Candidate:
    """The candidate without the effects that do not pay.

    Those of a set pay together; each of them has to reduce the error.
    """
    while candidate.names:
        name, fewer = _least_missed(pool, candidate)
        found = pool.reduction(fewer, candidate)
        kept = found.pays or (found.factor < MAX_FACTOR and _pays_as_a_set(pool, candidate, name))
        pool.judged[tuple(sorted(candidate.names))] = Judgement(name, found, kept)
        if kept:
            return candidate
        candidate = fewer
    return candidate


def _pays_as_a_set(pool: _Pool, candidate: Candidate, name: str) -> bool:
    """Whether an effect belongs to a set whose effects together pay."""
    together = set_around(name, candidate.names)
    return bool(together) and pool.reduction(_without_all(pool, candidate, together), candidate).pays


def _without_all(pool: _Pool, candidate: Candidate, names: frozenset[str]) -> Candidate:
    """The best candidate without several effects."""
    for name in sorted(names):
        candidate = pool.without(candidate, name)
    return candidate


def _least_missed(pool: _Pool, candidate: Candidate) -> tuple[str, Candidate]:
    """The effect without which the error grows least, and the candidate without it."""
    fewer = {name: pool.without(candidate, name) for name in sorted(candidate.names)}
    name = min(fewer, key=lambda name: fewer[name].total)
    return name, fewer[name]


def _steps(pool: _Pool, best: Candidate, searched: tuple[str, ...]) -> tuple[Step, ...]:
    """The effects of a candidate, the one that reduces the error least at the end."""
    steps: list[Step] = []
    whole = best
    while best.names:
        name, fewer = _least_missed(pool, best)
        single = pool.best.get(frozenset({name}))
        alone = None if single is None else pool.reduction(pool.start, single)
        rivals = _rivals(pool, whole, name)
        agreement = 1 if name in searched else -1 if searched else 0
        whole_set = set_around(name, whole.names)
        known = pool.best.get(whole_set) if whole_set else None
        together = None if known is None else pool.reduction(pool.start, known)
        mates = whole_set - {name} if together else frozenset[str]()
        lead = _lead(pool, name)
        missed = _rms_ratio(whole, pool.without(whole, name))
        steps.append(Step(name, best.fit, best.errors, alone, lead, agreement, rivals, mates, together, missed))
        best = fewer
    return tuple(reversed(steps))


def _rms_ratio(one: Candidate, other: Candidate) -> float:
    return float(np.sqrt(one.total / max(other.total, 1e-300)))


def _lead(pool: _Pool, name: str) -> float:
    """Rms error of the best other effect alone over that of one alone; 1 if it was not tried alone."""
    single = {one: candidate for names, candidate in pool.best.items() if len(names) == 1 for one in names}
    others = [candidate for one, candidate in single.items() if one != name]
    if not others or name not in single:
        return 1.0
    return _rms_ratio(min(others, key=lambda candidate: candidate.total), single[name])


def _rivals(pool: _Pool, best: Candidate, name: str) -> tuple[tuple[str, float], ...]:
    """Other effects in the place of one, beside the same others, best first."""
    rest = best.names - {name}
    found = []
    for names, one in pool.best.items():
        if len(names) == len(best.names) and rest < names and name not in names:
            (rival,) = names - rest
            found.append((rival, _rms_ratio(one, best)))
    return tuple(sorted(found, key=lambda item: item[1]))
