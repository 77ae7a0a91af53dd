"""A model of several joints with the effects that were found, as a simulation."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from labsid._arrays import FloatArray
from labsid.gap.dynamics.record_start import RecordStart
from labsid.gap.fits.hypothesis import Hypothesis
from labsid.gap.joints.joint_search import AtJoint, numbers_of
from labsid.gap.joints.views import initial_states
from labsid.gap.model_file import minimize_state
from labsid.gap.record.data import Scale
from labsid.gap.signals.roles import Signals
from labsid.simulators.mjcf.one_joint import prefix_of
from labsid.simulators.mjcf.several_joints import SeveralJoints
from labsid.simulators.simulator import Simulator

OF_ONE_RECORD = ("load", "onset", "wave_cos", "wave_sin", "frequency")  # changes that belong to the fitted record


@dataclass(frozen=True, slots=True, eq=False)
class ChangedCommand:
    """Effects on the command of an actuator.

    Attributes
    ----------
    input : int
    hypothesis : Hypothesis
    theta : ndarray
    scale : Scale
        Of the input.
    """

    input: int
    hypothesis: Hypothesis
    theta: FloatArray
    scale: Scale

    def applied(self, u: FloatArray) -> FloatArray:
        """The command after them, shape (N,)."""
        return np.asarray(self.scale.back(self.hypothesis.actuator(self.theta, self.scale.of(u))))


@dataclass(frozen=True, slots=True, eq=False)
class MendedArm:
    """A model of several joints with changes.

    Attributes
    ----------
    simulator : Simulator
    numbers : dict
        Numbers that differ from the model, changes among them.
    commands : tuple of ChangedCommand
    noise : ndarray, shape (ny,)
        Of the outputs.
    zeros : ndarray, shape (ny,)
        Readings of the sensors at zero.
    start : RecordStart
        Which samples of a record determine its initial state.
    """

    simulator: Simulator
    numbers: Mapping[str, float]
    commands: tuple[ChangedCommand, ...]
    noise: FloatArray
    zeros: FloatArray
    start: RecordStart

    def simulate(self, signals: Signals, of_record: bool = False) -> FloatArray:
        """Outputs on a record, shape (N, ny), whose first samples determine the initial state.

        Parameters
        ----------
        signals : Signals
        of_record : bool
            Whether loads and waves of the fitted record act.
        """
        joints = self.simulator.joint
        assert isinstance(joints, SeveralJoints)
        u = signals.u.copy()
        for one in self.commands:
            u[:, one.input] = one.applied(u[:, one.input])
        t = np.asarray(signals.Ts * np.arange(len(signals)), np.float64)
        numbers = {
            name: value
            for name, value in self.numbers.items()
            if of_record or name.rpartition(":")[2] not in OF_ONE_RECORD
        }
        ahead = [prefix_of(one.joint) for one in joints.joints]
        names = [f"{joint}{state}" for joint in ahead for state in ("start", "start_speed")]
        shown = initial_states(joints, signals)
        used = self.start.used(len(signals))
        rows, y = signals.rows[:used], signals.y[:used]

        def output(x: FloatArray, samples: int) -> FloatArray:
            state = dict(zip(names, x.tolist(), strict=True))
            return np.asarray(self.simulator(t[:samples], u[:samples], numbers | state) + self.zeros)

        def error(x: FloatArray) -> FloatArray:
            return np.asarray(((y - output(x, used)) / self.noise)[rows])

        free = np.full(len(names), np.inf)
        state = minimize_state(error, np.array([shown.get(name, 0.0) for name in names]), -free, free)
        return output(state, len(signals))


def mended_arm(named: Sequence[AtJoint], last: AtJoint, start: RecordStart) -> MendedArm:
    """The model with the effects that are named.

    Parameters
    ----------
    named : sequence of AtJoint
        The joints with effects.
    last : AtJoint
        The view whose fit tells the zeros of the sensors.
    start : RecordStart
        Which samples of a record determine its initial state.
    """
    view, fit, arm = last.view, last.fit, last.view.arm
    offsets = np.zeros(len(arm.scales))
    additive = fit.gains[fit.gains.size - sum(effect.width for effect in fit.hypothesis.additive) :]
    unit = view.data.y_scale.unit
    for number, j in enumerate(view.order):
        further = additive[number - 1] if number else 0.0
        offsets[j] = arm.scales[j].unit * unit * (fit.gains[1] + further)
    commands = tuple(
        ChangedCommand(one.view.main, _alone(one), _theta_alone(one), one.view.data.u_scale)
        for one in named
        if one.changes_command
    )
    noise = np.array([scale.unit for scale in arm.scales])
    return MendedArm(replace(arm.simulator, free=()), dict(numbers_of(named)), commands, noise, offsets, start)


def _alone(one: AtJoint) -> Hypothesis:
    return Hypothesis(one.fit.hypothesis.inputs)


def _theta_alone(one: AtJoint) -> FloatArray:
    """Parameters of the effects on the command."""
    whole, alone = one.fit.hypothesis, _alone(one)
    theta = np.zeros(len(alone.parameters))
    for effect in whole.inputs:
        theta[alone.slices[effect.key]] = one.fit.theta[whole.slices[effect.key]]
    if not whole.delay_is_an_effect:
        theta[0] = one.fit.theta[0]
    return theta
