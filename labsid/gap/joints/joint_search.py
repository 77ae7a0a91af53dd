"""Search for the effects in a model of several joints, one joint at a time."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from labsid._arrays import FloatArray
from labsid.gap.effects.base import InputEffect
from labsid.gap.fits.fitting import Fit
from labsid.gap.fits.linear_fits import fit_baseline
from labsid.gap.joints.views import ArmRecord, JointView, joint_view
from labsid.gap.search.beam_search import Progress, candidates_on, residual_is_white
from labsid.gap.search.candidates import is_compatible, trial_fits
from labsid.gap.search.explanation import Explanation, explain
from labsid.simulators.mjcf.one_joint import PREFIX

MOST_EFFECTS = 3
SEARCHED = 6  # best effects of a joint in brief trials, which are then searched there
CLOSE = 0.5  # of the logarithm of the mean square error: a joint whose best trial is as near to the best of all
RIVAL = 2.0  # the same of an effect at one joint over the best one there: a rival
OF_STATES = (
    "start",
    "start_speed",
    "start_lag",
    "start_play",
)  # numbers of an initial state, which every view estimates


@dataclass(frozen=True, slots=True, eq=False)
class AtJoint:
    """What was found at a joint.

    Attributes
    ----------
    view : JointView
        With what was found at the other joints in the simulation.
    explanation : Explanation
    """

    view: JointView
    explanation: Explanation

    @property
    def fit(self) -> Fit:
        """The accepted fit."""
        return self.explanation.best

    @property
    def found(self) -> bool:
        """Whether there is an effect."""
        return len(self.explanation.path) > 1

    @property
    def error(self) -> float:
        """Mean square error, over the noise."""
        return self.fit.free_run * self.view.data.y_scale.unit**2

    @property
    def numbers(self) -> dict[str, float]:
        """Numbers of the simulation that differ from the model, without the initial state."""
        plant = self.fit.hypothesis.plant
        own = plant.numbers(self.fit.plant_theta)
        return {name: value for name, value in own.items() if not is_state(name)}

    @property
    def command(self) -> FloatArray:
        """The command of its actuator after the effects found there, shape (N,)."""
        data = self.view.data
        driven = self.fit.hypothesis.actuator(self.fit.theta, data.u)[: len(self.view.arm.signals)]
        return np.asarray(data.u_scale.back(driven))

    @property
    def at_command(self) -> frozenset[str]:
        """Names of the effects that act on the command, a gain that drifts among them."""
        return frozenset(effect.name for effect in self.fit.hypothesis.found if isinstance(effect, InputEffect))

    @property
    def changes_command(self) -> bool:
        """Whether an effect acts on the command."""
        return bool(self.at_command)


def is_state(name: str) -> bool:
    """Whether a number of a simulation is one of its initial state."""
    return name.startswith(PREFIX) and name.rpartition(":")[2].removeprefix(PREFIX) in OF_STATES


@dataclass(frozen=True, slots=True)
class JointTrial:
    """The error that an effect at a joint leaves after a few steps.

    Attributes
    ----------
    joint : int
    name : str
    error : float
        Mean square, over the noise.
    score : float
        BIC under white noise.
    """

    joint: int
    name: str
    error: float
    score: float


@dataclass(frozen=True, slots=True, eq=False)
class Found:
    """The effects that explain a record of several joints.

    Attributes
    ----------
    at : tuple of AtJoint
        The joints with effects, in the order in which they were found; without effects that of the best view.
    trials : tuple of JointTrial
        Single effects at all joints, best first.
    """

    at: tuple[AtJoint, ...]
    trials: tuple[JointTrial, ...]


def find_at_joints(arm: ArmRecord, most: int = MOST_EFFECTS, progress: Progress | None = None) -> Found:
    """Search for the effects at the joints of a model: single ones first, then beside those found at other joints.

    Parameters
    ----------
    arm : ArmRecord
    most : int
        Largest number of effects.
    progress : callable, optional
        Called with a description of the current step and the completed share of it.
    """
    first = _tried(arm, [], progress)
    found: list[AtJoint] = []
    trials = first
    for _ in range(most):
        better = _next(arm, found, trials, progress)
        if better is None:
            break
        found = better
        if residual_is_white(found[-1].explanation.data, found[-1].fit):
            break
        trials = _tried(arm, found, progress)
    if not found:
        found = [_at(arm, first[0].joint if first else 0, [], 0, frozenset(), None)]
    return Found(tuple(found), tuple(first))


def _tried(arm: ArmRecord, found: Sequence[AtJoint], progress: Progress | None) -> list[JointTrial]:
    """One more effect at each joint, after a few steps, best first."""
    trials = []
    count = len(arm.joints.joints)
    for joint in range(count):
        own = next((one for one in found if one.view.joint == joint), None)
        view = _view(arm, joint, found) if own is None else own.view
        data = view.data
        parent = fit_baseline(data, view.base.structure, view.base.start) if own is None else own.fit
        groups = [group for group in candidates_on(data) if group[0].name not in parent.hypothesis.names]
        for number, group in enumerate(groups):
            if progress is not None:
                name = arm.joints.joints[joint].joint
                progress(f"effects at the joint {name}", (joint + number / len(groups)) / count)
            if any(is_compatible(parent, effect) for effect in group):
                best = next(iter(trial_fits(data, parent, group, parent, brief=True)), None)
                if best is not None:
                    error = best.point.cost * data.y_scale.unit**2
                    # The unit of the score is that of the noise, so that those of all views compare.
                    score = best.score + 2.0 * best.problem.count * float(np.log(data.y_scale.unit))
                    trials.append(JointTrial(joint, group[0].name, error, score))
    return sorted(trials, key=lambda one: one.score)


def _next(
    arm: ArmRecord, found: Sequence[AtJoint], trials: Sequence[JointTrial], progress: Progress | None
) -> list[AtJoint] | None:
    """What was found, with one more effect at the joint of the best trials; None if none improves on it."""
    if not trials:
        return None
    close = [one for one in trials if np.log(one.error) < np.log(trials[0].error) + CLOSE]
    candidates = []
    for joint in dict.fromkeys(one.joint for one in close):
        own = next((one for one in found if one.view.joint == joint), None)
        before = 0 if own is None else len(own.explanation.path) - 1
        there = [one for one in trials if one.joint == joint][:SEARCHED]
        names = [one.name for one in there if np.log(one.error) < np.log(there[0].error) + RIVAL]
        names += [] if own is None else list(own.fit.hypothesis.names)
        one = _at(arm, joint, found, before + 1, frozenset(names), progress)
        if len(one.explanation.path) - 1 > before:
            candidates.append(one)
    best = min(candidates, key=lambda one: one.error, default=None)
    if best is None:
        return None
    others = [one for one in found if one.view.joint != best.view.joint]
    return _in_turn(arm, [*others, best], progress)


def _in_turn(arm: ArmRecord, found: list[AtJoint], progress: Progress | None) -> list[AtJoint]:
    """What was found at each joint, again beside what has been found at the others since."""
    for _ in range(2 if len(found) > 1 else 0):
        for number, one in enumerate(found):
            others = [other for other in found if other is not one]
            most = len(one.explanation.path) - 1
            names = frozenset(one.fit.hypothesis.names)
            again = _at(arm, one.view.joint, others, most, names, progress)
            if again.found:
                found[number] = again
    return found


def _at(
    arm: ArmRecord,
    joint: int,
    found: Sequence[AtJoint],
    most: int,
    names: frozenset[str],
    progress: Progress | None,
) -> AtJoint:
    """The effects of these names that explain the record at a joint, beside those at the others."""
    view = _view(arm, joint, found)
    data = replace(view.data, tried=names)
    return AtJoint(view, explain(data, view.base.structure, view.base.start, most, progress))


def _view(arm: ArmRecord, joint: int, found: Sequence[AtJoint]) -> JointView:
    """The record as seen at a joint, beside what was found at the others."""
    others = [one for one in found if one.view.joint != joint]
    return joint_view(
        arm, joint, numbers_of(others), {one.view.main: one.command for one in others if one.changes_command}
    )


def numbers_of(found: Sequence[AtJoint]) -> Mapping[str, float]:
    """All numbers of the simulation that differ from the model."""
    changed = (one for one in found if one.found or one.fit.hypothesis.plant.free)
    return {name: value for one in changed for name, value in one.numbers.items()}
