"""Effects that are added together, because each of them alone explains little where the others act, too."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from operator import attrgetter

import numpy as np

from labsid._cores import mapped
from labsid.gap.effects.base import Effect
from labsid.gap.effects.context import Context
from labsid.gap.fits.fitting import Fit, Point, Problem, evaluate, finish
from labsid.gap.fits.switching import only_switches
from labsid.gap.record.data import Data
from labsid.gap.search.candidates import (
    Trial,
    best_form,
    is_compatible,
    is_plausible,
    plausible_forms,
    start_points,
)
from labsid.gap.search.forms import extended_hypotheses
from labsid.gap.search.inverse_dynamics import joint_trials
from labsid.gap.search.part import beginning, on_part

KEPT_STARTS = 8  # start points to which the next effect of a set is added; numerics
SKETCHED = 4  # of them that are minimized for a few iterations; numerics
FITTED = 2  # of these that are minimized to convergence; numerics
JOINT_TRIALS = 3  # fits from the inverse dynamics, beside these; numerics


@dataclass(frozen=True, slots=True)
class EffectSet:
    """Effects of one kind of rig.

    Attributes
    ----------
    names : tuple of str
        In the order in which start values are combined.
    reason : str
        Why one of them alone explains little.
    holds : callable, optional
        ``holds(data, fit) -> bool``: whether a fit is of this kind of rig; by default every one is.
    """

    names: tuple[str, ...]
    reason: str
    holds: Callable[[Data, Fit], bool] | None = None


SETS = (
    EffectSet(
        ("gravity", "coulomb-friction"),
        "In the spring of its loop an arm seems to hang from a stiffer or a softer spring; friction holds it off its "
        "equilibrium by an angle that depends on this stiffness.",
    ),
    EffectSet(
        ("coulomb-friction", "force-limit"),
        "At its limit a drive has the less force left to move, the more friction takes.",
    ),
    EffectSet(
        ("gravity", "force-limit"),
        "A drive at its limit moves with the difference of this limit and the weight, and stalls where it is zero.",
    ),
    EffectSet(
        ("gravity", "coulomb-friction", "force-limit"),
        "Joints of robots have all three.",
    ),
    EffectSet(
        ("sqrt-outflow", "overflow"),
        "Up to the brim the outflow of a tank goes with the root of the level; a linear tank has its brim elsewhere.",
    ),
    EffectSet(
        ("input-dead-zone", "input-nonlinearity"),
        "Valves and pumps start late and then follow a curve; either alone imitates a part of the other.",
    ),
    EffectSet(
        ("input-backlash", "input-saturation"),
        "A relay with hysteresis is a play between limits hardly wider than it: without it, they have no width.",
        only_switches,
    ),
)


def set_around(name: str, names: frozenset[str]) -> frozenset[str]:
    """The largest set that contains an effect and is part of an explanation; empty if there is none.

    Parameters
    ----------
    name : str
        The effect.
    names : frozenset of str
        All effects of the explanation.
    """
    sets = (frozenset(one.names) for one in SETS)
    return max((one for one in sets if name in one and one <= names), key=len, default=frozenset())


def set_fits(data: Data, base: Fit, highpass: Fit, groups: Sequence[tuple[Effect, ...]]) -> list[Fit]:
    """The best fit of each set whose effects the record can identify.

    Parameters
    ----------
    data : Data
    base : Fit
        The simulation to which the sets are added.
    highpass : Fit
        A linear fit to the high-pass filtered record.
    groups : sequence of tuple of Effect
        The forms that the search adds, in a group for each name; a set with another name is left out.

    Returns
    -------
    list of Fit
    """
    if base.hypothesis.plant.kind != "linear":
        return []  # the dynamics of a given simulation are not replaced
    forms = {group[0].name: group for group in groups}
    sets = [one for one in SETS if set(one.names) <= forms.keys() - set(base.hypothesis.names)]
    kept = data, base, base.hypothesis.plant.simulation
    joints = mapped(lambda one: _of_joint(data, base, highpass, one.names), sets, kept)
    starts: dict[tuple[str, ...], list[Trial]] = {(): [_unchanged(data, base)]}
    found: dict[frozenset[str], Fit] = {}
    for one, of_joint in zip(sets, joints, strict=True):
        for size, name in enumerate(one.names, 1):
            if one.names[:size] not in starts:
                before = starts[one.names[: size - 1]]
                starts[one.names[:size]] = _with_one_more(data, before, base, forms[name], highpass)
        trials = starts[one.names][:SKETCHED]
        for names, fit in found.items():
            if names < set(one.names) and len(names) == len(one.names) - 1:
                (missing,) = set(one.names) - names
                trials = [*trials, *_with_one_more(data, [_unchanged(data, fit)], base, forms[missing], highpass)[:1]]
        best = _best(data, [*trials, *of_joint], len(one.names))
        if best is not None and (one.holds is None or one.holds(data, best)):
            found[frozenset(one.names)] = best
    return list(found.values())


def _of_joint(data: Data, base: Fit, highpass: Fit, names: tuple[str, ...]) -> list[Trial]:
    """The best fits of a joint from its inverse dynamics."""
    part = beginning(data, base, names)
    base, highpass = (on_part(data, part, fit) for fit in (base, highpass))
    found = (one.on(data) for one in joint_trials(part, base, highpass, names)[:JOINT_TRIALS])
    return [one for one in found if one is not None]


def _unchanged(data: Data, fit: Fit) -> Trial:
    problem = Problem(data, fit.hypothesis)
    point = problem.point(fit.theta, fit.gains)
    assert point is not None
    return Trial(problem, point)


def _with_one_more(data: Data, before: list[Trial], base: Fit, group: tuple[Effect, ...], highpass: Fit) -> list[Trial]:
    """The start points with one more effect, of least error."""
    found = [trial for one in before for trial in _extended(data, _as_fit(one, base), group, highpass)]
    return sorted(found, key=attrgetter("point.cost"))[:KEPT_STARTS]


def _extended(data: Data, parent: Fit, group: tuple[Effect, ...], highpass: Fit) -> Iterator[Trial]:
    context = Context(data, parent, highpass)
    for effect in group:
        if is_compatible(parent, effect) and effect.applies(context):
            for hypothesis in extended_hypotheses(parent.hypothesis, effect):
                problem = Problem(data, hypothesis)
                points = evaluate(problem, start_points(context, hypothesis, effect))
                yield from (Trial(problem, point) for point in points)


def _as_fit(trial: Trial, base: Fit) -> Fit:
    """A start point as the fit to which another effect is added, without a model of its noise."""
    at: Point = trial.point
    return Fit(trial.hypothesis, at.theta, at.gains, at.output, at.cost, base.noise, np.inf)


def _best(data: Data, starts: list[Trial], count: int) -> Fit | None:
    """The best plausible fit from a few start points; None if none is plausible."""
    sketched = sorted((one.continued(4) for one in starts), key=attrgetter("score"))
    fits = [finish(data, one.hypothesis, one.continued(25).point) for one in sketched[:FITTED]]
    plausible = [fit for fit in fits if is_plausible(data, fit, count)]
    if not plausible:
        return None
    return best_form(plausible_forms(data, best_form(plausible)))
