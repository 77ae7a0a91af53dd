"""The smallest size at which each effect is visible, named, and not excluded by a record."""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from itertools import chain

import numpy as np

from labsid._arrays import FloatArray
from labsid._cores import mapped
from labsid.gap.effects.base import InputEffect, Planted
from labsid.gap.effects.context import Context
from labsid.gap.effects.dynamics import Placed, SlowMode
from labsid.gap.effects.families import FAMILIES
from labsid.gap.effects.input import Delay
from labsid.gap.fits.fitting import Fit, Point, minimize
from labsid.gap.fits.profile import with_held
from labsid.gap.limits.distances import Refit, Rivals, Trace
from labsid.gap.limits.planting import Plantation, plantations
from labsid.gap.record.data import Data
from labsid.gap.search.beam_search import BIC_MARGIN
from labsid.gap.search.candidates import is_compatible
from labsid.gap.search.explanation import MIN_NAMED_CHANGE, change_place

LEAST_SHARE = 5e-5  # smallest planted size over the whole; set by hand
COARSE = 4.0  # ratio of planted sizes that are far from invisible; numerics
FINE = 2.0  # ratio of the other planted sizes; numerics
PLAIN = 1e4  # squared distance over the variance of the noise, far from invisible; set by hand
INVISIBLE = 0.3  # the same, below which smaller sizes are not planted; set by hand
CLEAR = 60.0  # the same, at which the linearized refit is compared with an exact one; set by hand
FAINT = 8.0  # the same, from which a limit may lie there, so that exact refits are used; set by hand
FAR = 300.0  # the same, up to which a limit may lie there; set by hand
MOST_REFITS = 10  # iterations of a refit with an effect of one size; numerics
BETWEEN = 12  # interpolated sizes between two planted ones; numerics
SURE = 1.28  # standard errors; statistics: one of ten records exceeds them, so limits hold in nine
SEARCH_LOSS = 1.15  # over these sizes, for refits from more starts than `Refit`; measured: 75 % named without it
MOVED_POLES = Delay, Placed, SlowMode
"""Effects that the poles of a fit may have absorbed already, which a profile about that fit does not show: 3 of 3
planted ones of seed 11 were excluded wrongly, and 0 of 15 of the others."""
EXCLUDED = 1.64**2  # squared distance beyond which a size is excluded; statistics: 95 % on one side


@dataclass(frozen=True, slots=True)
class Limits:
    """What a record can show of one effect.

    Attributes
    ----------
    name : str
        Of the effect.
    parameter, unit : str
        The one that states its size.
    whole : str
        Of what `shares` are shares: the range of "u" or "y", the slowest "time" constant, or the "gain".
    detect, named, excluded : float or None
        The smallest visible size, the smallest that is named, and the smallest that the record excludes.
    shares : dict
        The same as shares of the whole.
    rival : str or None
        The effect that is nearest to it.
    at : dict
        Other parameters of the planted effect, in the units of the record.
    reason : str
        Why it is not visible at any size: "levels" of the input are too few, "closed" simulation, not tried in a
        "stabilised" one or "beside" the dynamics found, or "hidden" from this record; empty if it is.
    """

    name: str
    parameter: str
    unit: str
    whole: str
    detect: float | None
    named: float | None
    excluded: float | None
    shares: dict[str, float | None]
    rival: str | None
    at: dict[str, float]
    reason: str = ""


def find_smallest_sizes(data: Data, fit: Fit, noise: float, measured: bool = True) -> tuple[Limits, ...]:
    """What a record can show of each effect that is not in the simulation, about the fitted simulation.

    Parameters
    ----------
    data : Data
    fit : Fit
        The accepted simulation, with its noise.
    noise : float
        Rms error of the fit.
    measured : bool
        Whether the record can exclude a size: the output is measured, and the simulation leaves nothing but noise.

    Returns
    -------
    tuple of Limits
        In the order of the families; of effects with two parameters that state a size, one for each.
    """
    refit = Refit.about(data, fit, noise)
    if refit is None:
        return ()
    traced = mapped(lambda plantation: _traced(plantation, refit), plantations(data, fit), (data, fit))
    sown = list(chain.from_iterable(traced))
    rows: dict[tuple[str, str], list[_Sown]] = {}
    for planted in sown:
        if planted.parameter == next(same.parameter for same in sown if same.plantation is planted.plantation):
            rows.setdefault((planted.trace.name, planted.parameter), []).append(planted)
    margins = _Margins.of(data, fit)
    rivals = Rivals([planted.trace for planted in sown]) if sown else None
    starts = dict(zip(sown, rivals.starts, strict=False)) if rivals else {}
    limits_of_rows = [
        _limits(row, rivals, starts, margins, refit if measured else None) for row in rows.values() if rivals
    ]
    missing = [
        Limits(name, "", "", "", None, None, None, {}, None, {}, reason) for name, reason in _missing(data, fit, rows)
    ]
    order = list(dict.fromkeys(family.name for family in FAMILIES))
    return tuple(sorted([*limits_of_rows, *missing], key=lambda limits: order.index(limits.name)))


@dataclass(frozen=True, slots=True, eq=False)
class _Sown:
    """A form of an effect at one place, at all sizes."""

    plantation: Plantation
    place: int
    parameter: str
    trace: Trace

    def planted(self, share: float) -> Planted:
        return self.plantation.places(share)[self.place]


@dataclass(frozen=True, slots=True)
class _Margins:
    """What the verdict asks of an effect: of its likelihood, and of the size of its change."""

    rows: int
    change: float

    @classmethod
    def of(cls, data: Data, fit: Fit) -> "_Margins":
        change = MIN_NAMED_CHANGE[change_place(len(fit.hypothesis.names) + 1)]
        return cls(fit.noise.rows, SEARCH_LOSS * (change + SURE / np.sqrt(data.rows.sum())))

    def distance(self, added: FloatArray | int) -> FloatArray:
        """Distance at which the margin is exceeded in nine of ten records, for a number of added parameters."""
        return np.asarray(SEARCH_LOSS * (np.sqrt(np.maximum(BIC_MARGIN + added * np.log(self.rows), 0.0)) + SURE))


@dataclass(frozen=True, slots=True, eq=False)
class _Change:
    """An effect at one share: its change of the output, and what a refit leaves of it."""

    share: float
    output: FloatArray
    vector: FloatArray
    size: float

    @property
    def power(self) -> float:
        return float(self.vector @ self.vector)

    def with_left(self, vector: FloatArray, size: float) -> "_Change":
        return replace(self, vector=vector, size=size)


def _traced(plantation: Plantation, refit: Refit) -> list[_Sown]:
    """The traces of all places of one form."""
    seen: dict[int, list[_Change]] = {}
    parameters: dict[int, str] = {}
    share, going, visible = 1.0, True, False
    while going and share >= LEAST_SHARE:
        strongest = 0.0
        planted_at = plantation.places(share)
        for place, change in enumerate(plantation.changes(share)):
            if change is None:
                continue
            vector, size = refit.left(change)
            power = float(vector @ vector)
            strongest = max(strongest, power)
            if np.isfinite(power) and power > 0.0:
                seen.setdefault(place, []).append(_Change(share, change, vector, size))
                parameters[place] = planted_at[place].parameter
        visible |= strongest > INVISIBLE
        going = not plantation.is_linear and (strongest > INVISIBLE or not visible)
        share /= COARSE if strongest > PLAIN else FINE
    planted = []
    exact = bool(seen) and not plantation.is_linear and _needs_refits(next(iter(seen.values()))[::-1], refit)
    for place, points in seen.items():
        points = _refitted(points[::-1], refit) if exact else points[::-1]
        shares, vectors, sizes = (np.array([getattr(p, x) for p in points]) for x in ("share", "vector", "size"))
        trace = Trace(plantation.effect.name, shares, vectors, sizes, plantation.added, plantation.is_linear)
        planted.append(_Sown(plantation, place, parameters[place], trace))
    return planted


def _needs_refits(points: list[_Change], refit: Refit) -> bool:
    """Whether a linearized refit is wrong about the first change that is clearly visible."""
    clear = next((one for one in points if one.power > CLEAR), points[-1])
    return not refit.is_linear_at(clear.output, clear.vector)


def _refitted(points: list[_Change], refit: Refit) -> list[_Change]:
    """The changes with what exact refits leave, up to a size that is far from every limit."""
    found: list[_Change] = []
    last = None
    for one in points:
        near = one.power > FAINT and (not found or found[-1].power < FAR)
        if near:
            vector, size, last = refit.left_exactly(one.output, last)
            one = one.with_left(vector, size)
        found.append(one)
    return found


def _limits(
    row: list[_Sown], rivals: Rivals, starts: Mapping[_Sown, int], margins: _Margins, refit: Refit | None
) -> Limits:
    """The limits of one parameter of an effect; the first form and place of the row that is visible states them."""
    first = next(
        (planted for planted in row if _crossing(planted.trace, _seen(planted.trace, margins)) is not None), row[0]
    )
    trace, start = first.trace, starts[first]
    seen = _seen(trace, margins)
    others = rivals.names != trace.name
    known, nearest = np.zeros(seen.size), np.full(seen.size, -1)
    for i in range(seen.size):
        if others.any():
            far = np.sqrt(rivals.distances(start + i)) / margins.distance(trace.added - rivals.added)
            nearest[i] = int(np.flatnonzero(others)[np.argmin(far[others])])
            known[i] = min(seen[i], far[nearest[i]])
        else:
            known[i] = seen[i]
    detect, named = _crossing(trace, seen), _crossing(trace, known)
    at = -1 if named is None else int(np.searchsorted(trace.shares, min(named, trace.shares[-1])))
    rival = str(rivals.names[nearest[at]]) if nearest[at] >= 0 else None
    excluded = None
    if refit is not None and detect is not None and not isinstance(first.plantation.effect, MOVED_POLES):
        excluded = _excluded_in_every_form(row, refit, margins)
    shares = {
        "detect": detect,
        "named": named,
        "excluded_above": excluded,
    }
    sizes = {
        name: None if share is None else first.plantation.size(first.planted(share)).value
        for name, share in shares.items()
    }
    typical = first.planted(detect or float(trace.shares[-1]))
    unit = first.plantation.size(typical).unit
    return Limits(
        trace.name,
        first.parameter,
        unit,
        first.plantation.effect.whole,
        sizes["detect"],
        sizes["named"],
        sizes["excluded_above"],
        shares,
        rival,
        first.plantation.others(typical),
        "" if detect is not None else "hidden",
    )


def _seen(trace: Trace, margins: _Margins) -> FloatArray:
    """Distance and change of each size over what the verdict asks for: visible from one on."""
    distances = np.sqrt((trace.vectors**2).sum(axis=1))
    return np.minimum(distances / margins.distance(trace.added), trace.changes / margins.change)


def _crossing(trace: Trace, score: FloatArray) -> float | None:
    """Size from which a score exceeds one, interpolated on logarithmic axes; None if it never does."""
    if trace.is_linear:
        return float(trace.shares[0] / score[0]) if score[0] >= 1.0 else None
    above = np.flatnonzero(score >= 1.0)
    if not above.size:
        return None
    i = int(above[0])
    if i == 0 or score[i - 1] <= 0.0:
        return float(trace.shares[i])
    return float(np.exp(np.interp(0.0, np.log(score[i - 1 : i + 1]), np.log(trace.shares[i - 1 : i + 1]))))


def _excluded_in_every_form(row: list[_Sown], refit: Refit, margins: _Margins) -> float | None:
    """The size that is excluded whichever form the effect has: friction of a mass on a spring, or of a motor."""
    ends = []
    for plantation in dict.fromkeys(planted.plantation for planted in row):
        forms = [planted for planted in row if planted.plantation is plantation]
        detect = _crossing(forms[0].trace, _seen(forms[0].trace, margins))
        end = None if detect is None else _excluded(forms, refit, detect)
        if end is not None and plantation.turns_into("speed"):
            end = _excluded_by_refits(forms[0], refit, end)
        if end is None:
            return None
        ends.append(end)
    return max(ends)


def _excluded_by_refits(one: _Sown, refit: Refit, least: float) -> float | None:
    """The same by refits, from a size on: gain and poles of a motor have absorbed the most of its friction.

    About the fit without friction its profile is too narrow: 7 of 8 true sizes were excluded.
    """
    form, data, ar = one.plantation.form, refit.data, refit.fit.noise.ar
    names = [parameter.name for parameter in form.parameters]

    def refitted(share: float, near: Point | None, is_free: bool = False) -> Point | None:
        planted = one.planted(share)
        places = [names.index(name) for name in planted.values]
        theta = one.plantation.theta(planted) if near is None else near.theta.copy()
        theta[places] = list(planted.values.values())
        held = form if is_free else with_held(form, places, theta[places])
        gains = None if near is None else near.gains
        return minimize(data, held, theta, gains, iterations=MOST_REFITS, ar=ar, tolerance=1e-4)

    best = refitted(least, None, is_free=True)
    if best is None:
        return least
    name, whole = next(iter(one.planted(1.0).values.items()))
    lowest = min(best.cost, refit.sigma**2)
    last: Point | None = best
    share = max(least, float(best.theta[names.index(name)]) / whole)
    while share < 1.0:
        last = refitted(share, last)
        if last is None or refit.fit.noise.rows * (last.cost / lowest - 1.0) > EXCLUDED:
            return share
        share *= FINE**0.25
    return None


def _excluded(row: list[_Sown], refit: Refit, detect: float) -> float | None:
    """Upper 95 % end of the profile likelihood of the size; None beyond the largest one.

    Every larger size up to the one that is visible in nearly every record is excluded, too. Beyond it the likelihood
    may rise again: an actuator that is off is a small gain.
    """
    first = row[0]
    same = [planted for planted in row if planted.plantation is first.plantation]
    same = [planted for planted in same if not planted.trace.is_linear or _place(planted) == _place(first)]
    profiles = [_profile(planted.trace, refit.residual) for planted in same]
    below = [max(int(np.searchsorted(shares, detect)), 1) for shares, _ in profiles]
    least = min(0.0, *(float(loss[:n].min()) for n, (_, loss) in zip(below, profiles, strict=True)))
    ends = []
    for n, (shares, loss) in zip(below, profiles, strict=True):
        allowed = np.flatnonzero(loss[:n] - least <= EXCLUDED)
        end = int(allowed[-1]) + 1 if allowed.size else 0
        if end == loss.size:
            return None
        ends.append(float(shares[end]))
    return max(ends)


def _place(one: _Sown) -> dict[str, float]:
    return dict(one.planted(1.0).values)


def _profile(trace: Trace, residual: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Sizes, and twice the loss of log likelihood at each over that at size zero."""
    norms = np.sqrt((trace.vectors**2).sum(axis=1))
    cosines = trace.vectors @ residual / norms
    if trace.is_linear:
        sizes = np.geomspace(LEAST_SHARE, 1.0, 400)
        norm, cosine = sizes * norms[-1], np.full(sizes.size, abs(float(cosines[-1])))
        return sizes, norm**2 - 2.0 * norm * cosine
    at = np.linspace(0.0, trace.shares.size - 1.0, BETWEEN * (trace.shares.size - 1) + 1)
    index = np.arange(trace.shares.size)
    sizes, norm = (np.exp(np.interp(at, index, np.log(values))) for values in (trace.shares, norms))
    return sizes, norm**2 - 2.0 * norm * np.interp(at, index, cosines)


def _missing(data: Data, fit: Fit, rows: Iterable[tuple[str, str]]) -> Iterator[tuple[str, str]]:
    """Effects without limits that are not in the simulation, and why."""
    there = {name for name, _ in rows} | set(fit.hypothesis.names)
    context = Context(data, fit)
    for name in dict.fromkeys(family.name for family in FAMILIES if family.planted_variants):
        if name in there:
            continue
        forms = [form for family in FAMILIES if family.name == name for form in family.searched()]
        forms = [form for form in forms if is_compatible(fit, form)]
        if not forms:
            stabilised, given = fit.hypothesis.feedback is not None, fit.hypothesis.plant.kind == "given"
            yield name, "stabilised" if stabilised else "closed" if given else "beside"
        elif all(isinstance(form, InputEffect) and not form.applies(context) for form in forms):
            yield name, "levels"
        else:
            yield name, "hidden"
