"""A record of several joints as the search at one of them sees it: all outputs end to end, that joint's first.

The command of the joint's actuator is the input, the other commands act as they are logged. Each output is counted in
units of its noise, so that one score holds for all of them.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from labsid._arrays import FloatArray
from labsid.gap.dynamics.given_simulation import GivenSimulation
from labsid.gap.dynamics.inside_parts import PREFIX, InsidePort
from labsid.gap.dynamics.plants import Plant
from labsid.gap.effects.further_inputs import extended
from labsid.gap.effects.sensor_zeros import SensorZeros
from labsid.gap.fits.hypothesis import Hypothesis
from labsid.gap.fits.linear_fits import fit_baseline
from labsid.gap.fits.noise_model import noise_of
from labsid.gap.record.data import Data, Scale, scaled
from labsid.gap.signals.roles import Signals
from labsid.gap.simulations.baseline import Baseline, check_bounded
from labsid.gap.simulations.opened import LEAST_UNIT, fit_as_it_is, initial_state, make_port, sizes_of_numbers
from labsid.gap.system_pairs import in_order
from labsid.records.record import Record
from labsid.simulators.meter import BudgetSpentError
from labsid.simulators.mjcf.one_joint import prefix_of
from labsid.simulators.mjcf.several_joints import SeveralJoints
from labsid.simulators.simulator import Simulator, SimulatorError

BRIDGE = 20  # samples between two outputs: more than the noise model looks back
SAME = (
    1e-3  # of the range of an output: largest difference of the compiled loop; MuJoCo's solver leaves 1e-4 in friction
)
NOISELESS = 1e-6  # of the standard deviation of an output: the least noise that it is counted in


@dataclass(frozen=True, slots=True, eq=False)
class ArmRecord:
    """A record of several joints, with their simulation.

    Attributes
    ----------
    signals : Signals
    simulator : Simulator
        The compiled loop, or MuJoCo where they differ.
    joints : SeveralJoints
    start : dict
        Initial positions and speeds among the numbers of the simulation, from the first samples.
    motion : ndarray, shape (N, n, 3)
        Position, speed and force of the actuator of each joint, as simulated.
    scales : tuple of Scale
        Of the outputs: their means and their noise.
    """

    signals: Signals
    simulator: Simulator
    joints: SeveralJoints
    start: Mapping[str, float]
    motion: FloatArray
    scales: tuple[Scale, ...]


@dataclass(frozen=True, slots=True, eq=False)
class JointView:
    """The record as seen at one joint.

    Attributes
    ----------
    arm : ArmRecord
    joint : int
        Its place.
    main : int
        The input through which it is seen.
    order : tuple of int
        The outputs in the order in which they are joined.
    data : Data
    base : Baseline
    """

    arm: ArmRecord
    joint: int
    main: int
    order: tuple[int, ...]
    data: Data
    base: Baseline

    @property
    def record(self) -> Record:
        """The joined outputs, in units of their noise."""
        data = self.data
        t = np.asarray(data.start + data.Ts * np.arange(data.samples), np.float64)
        u, y = (np.asarray(scale.back(x)) for scale, x in ((data.u_scale, data.u), (data.y_scale, data.y)))
        return Record(t, u, y, data.Ts, name=self.arm.signals.name)

    def outputs(self, joined: FloatArray) -> FloatArray:
        """The outputs in their own units and order, shape (N, ny), from joined ones in scaled units."""
        back = np.asarray(self.data.y_scale.back(joined))
        columns = {j: back[slice(*piece)] for j, piece in zip(self.order, self.data.beside, strict=True)}
        return np.column_stack([np.asarray(scale.back(columns[j])) for j, scale in enumerate(self.arm.scales)])


def arm_record(signals: Signals, simulate: Simulator) -> ArmRecord:
    """A record of several joints with its simulation, its initial state, and the noise of each output.

    Raises
    ------
    ValueError
        If the model diverges on the record, or its timestep does not divide the sampling time.
    """
    joints = simulate.joint
    assert isinstance(joints, SeveralJoints)
    t = np.asarray(signals.Ts * np.arange(len(signals)), np.float64)
    start = initial_states(joints, signals)
    motion = joints.motion(t, signals.u, start)
    if not np.isfinite(motion).all():
        raise ValueError(
            "the model is unstable on this record: a joint diverges. Check the signs and gains of its actuators, and "
            "the order of --inputs."
        )
    simulate = _faster(simulate, joints, t, signals.u, start)
    y = simulate(t, signals.u, start)
    for simulated, measured in zip(y.T, signals.y.T, strict=True):
        check_bounded(simulated, measured)
    scales = tuple(
        Scale(float(np.mean(own)), _noise(signals.data(0, j), signals, j, simulated))
        for j, (own, simulated) in enumerate(zip(signals.y.T, y.T, strict=True))
    )
    return ArmRecord(signals, simulate, joints, start, motion, scales)


def matching(simulate: Simulator, record: Record, kept: Sequence[str]) -> Simulator:
    """The simulator with its signals in the order of those of a record."""
    ordered = in_order(simulate, record.inputs, record.outputs, kept)
    joints = simulate.joint
    assert isinstance(joints, SeveralJoints)
    inputs = (
        [simulate.inputs.index(name) for name in record.inputs] if set(simulate.inputs) == set(record.inputs) else None
    )
    of = dict(zip(record.outputs, _places(simulate.outputs, record.outputs), strict=True))
    changed = replace(
        joints,
        inputs=joints.inputs if inputs is None else tuple(joints.inputs[i] for i in inputs),
        outputs=tuple(joints.outputs[of[name]] for name in kept),
        names=tuple(kept),
    )
    return replace(ordered, joint=changed)


def _places(names: Sequence[str], wanted: Sequence[str]) -> list[int]:
    return [names.index(name) for name in wanted] if set(names) == set(wanted) else list(range(len(wanted)))


def initial_states(joints: SeveralJoints, signals: Signals) -> dict[str, float]:
    """Positions and speeds of the joints at the first sample, as far as outputs show them."""
    found: dict[str, float] = {}
    for (place, what), y in zip(joints.outputs, signals.y.T, strict=True):
        one = replace(joints.joints[place], output=what)
        ahead = prefix_of(one.joint)
        own = {ahead + name.removeprefix(PREFIX): x for name, x in initial_state(one, y, signals.Ts).items()}
        if what == "position":
            found |= own
        elif what == "speed":
            found = own | found
    return found


def _faster(
    simulate: Simulator, joints: SeveralJoints, t: FloatArray, u: FloatArray, start: Mapping[str, float]
) -> Simulator:
    """The simulator by the compiled loop, if it agrees with MuJoCo on the record; else the simulator itself."""
    try:
        played = simulate(t, u, start)
    except SimulatorError:
        return simulate
    apart = np.abs(played - joints.run(t, u, start)).max(axis=0)
    return replace(simulate, run=joints.run) if (apart <= SAME * np.ptp(played, axis=0)).all() else simulate


def _noise(data: Data, signals: Signals, j: int, simulated: FloatArray) -> float:
    """Standard deviation of what is unforeseen in the error of the simulation."""
    e = signals.y[:, j] - simulated
    e = e - e[signals.rows[:, j]].mean()
    return float(max(np.sqrt(noise_of(data, e).sigma2), NOISELESS * np.std(signals.y[:, j])))


def joint_view(arm: ArmRecord, joint: int, fixed: Mapping[str, float], commands: Mapping[int, FloatArray]) -> JointView:
    """The record as seen at one joint.

    Parameters
    ----------
    arm : ArmRecord
    joint : int
        Its place.
    fixed : dict
        Numbers of the simulation that hold: changes at the other joints.
    commands : dict
        By input: commands of the other actuators after the effects found at them, shape (N,).
    """
    signals, joints = arm.signals, arm.joints
    main = joints.input_of(joint)
    own = [j for j, (place, what) in enumerate(joints.outputs) if place == joint]
    own.sort(key=lambda j: joints.outputs[j][1] != "position")
    order = (*own, *(j for j in range(len(joints.outputs)) if j not in own))
    data = _joined(arm, main, order)
    inputs = signals.u.copy()
    for i, command in commands.items():
        if i != main:
            inputs[:, i] = command
    plain, start = _structure(arm, replace(arm.simulator, free=()), joint, data, main, order, signals.u)
    simulate = replace(arm.simulator, nominal=arm.simulator.nominal | dict(fixed))
    structure, begun = _structure(arm, simulate, joint, data, main, order, inputs)
    return JointView(
        arm, joint, main, order, data, Baseline(partial(fit_as_it_is, plain, start), structure, start=begun)
    )


def _joined(arm: ArmRecord, main: int, order: tuple[int, ...]) -> Data:
    """The outputs end to end, mirrored between two of them."""
    signals = arm.signals
    u, y, rows = [], [], []
    pieces: list[tuple[int, int]] = []
    at = 0
    for j in order:
        measured = np.asarray(arm.scales[j].of(signals.y[:, j]))
        if pieces:
            u.append(np.full(BRIDGE, signals.u[0, main]))
            y.append(measured[BRIDGE:0:-1])
            rows.append(np.zeros(BRIDGE, bool))
            at += BRIDGE
        u.append(signals.u[:, main])
        y.append(measured)
        rows.append(signals.rows[:, j])
        pieces.append((at, at + len(signals)))
        at += len(signals)
    data = scaled(np.concatenate(u), np.concatenate(y), np.concatenate(rows), signals.Ts, float(signals.t[0]))
    return replace(data.about_zero_command(), beside=tuple(pieces))


def _structure(
    arm: ArmRecord,
    simulate: Simulator,
    joint: int,
    data: Data,
    main: int,
    order: tuple[int, ...],
    inputs: FloatArray,
) -> tuple[Hypothesis, FloatArray]:
    """The structure of the simulation as seen at a joint, and parameters with the initial state."""
    signals, joints = arm.signals, arm.joints
    own_data = signals.data(main, order[0])
    rates = fit_baseline(own_data).rates
    port = _port(arm, joint, data, own_data, order[0])
    y_scale, first = data.y_scale, order[0]

    def run(w: FloatArray, numbers: dict[str, float]) -> FloatArray:
        """All outputs for the joined input, the first one for any other; NaN where the simulation fails."""
        whole = w.size == data.samples
        command = np.asarray(data.u_scale.back(w[: len(signals)] if whole else w))
        u = np.column_stack(
            [command if i == main else extended(inputs[:, i], command.size) for i in range(inputs.shape[1])]
        )
        t = np.asarray(signals.t[0] + signals.Ts * np.arange(command.size), np.float64)
        try:
            y = simulate(t, u, numbers)
        except BudgetSpentError:
            return np.full(w.size, np.nan)
        except SimulatorError as error:
            if error.ended:
                raise
            simulate.meter.note_failure(str(error))
            return np.full(w.size, np.nan)
        if not whole:
            return np.asarray(y_scale.of(np.asarray(arm.scales[first].of(y[:, first]))))
        joined = np.empty(w.size)
        stop = 0
        for j, (begin, end) in zip(order, data.beside, strict=True):
            joined[begin:end] = arm.scales[j].of(y[:, j])
            joined[stop:begin] = joined[begin]
            stop = end
        return np.asarray(y_scale.of(joined))

    units = {name: size for place in range(len(joints.joints)) for name, size in _sizes(arm, place).items()}
    given = GivenSimulation(
        run,
        rates,
        takes_input=True,
        nominal={name: simulate.nominal[name] for name in simulate.free},
        ranges=dict(simulate.ranges),
        units=units,
        source=simulate.source,
        meter=simulate.meter,
        port=port,
    )
    zeros = (SensorZeros(outputs=data.beside[1:]),) if len(order) > 1 else ()
    hypothesis = Hypothesis(zeros, len(zeros), Plant(kind="given", simulation=given))
    theta = np.zeros(len(hypothesis.parameters))
    at = hypothesis.slices["plant"].start
    for state in port.states(()):
        number, size = port.state_number(state)
        theta[at + hypothesis.plant.index(state.name)] = arm.start.get(number, 0.0) / size
    return hypothesis, theta


def _port(arm: ArmRecord, joint: int, data: Data, own: Data, output: int) -> InsidePort:
    """Where effects are put at a joint."""
    joints, scale = arm.joints, arm.scales[output]
    reads = joints.outputs[output] == (joint, "position")
    port = make_port(joints.joint(joint), own, arm.motion[:, joint], reads, arm.simulator.run == joints.run)
    others = {}
    for place, one in enumerate(joints.joints):
        if place != joint:
            spread, speed = (float(np.std(arm.motion[:, place, column])) for column in (0, 1))
            others[one.joint] = (max(spread, LEAST_UNIT), max(speed, LEAST_UNIT))
    centre = scale.centre + scale.unit * data.y_scale.centre
    return replace(
        port,
        prefix=prefix_of(port.joint),
        others=others,
        scale=(float(centre), float(scale.unit * data.y_scale.unit)),
        samples=own.samples,
    )


def _sizes(arm: ArmRecord, joint: int) -> dict[str, float]:
    """Sizes at which numbers of a joint begin to act that are nominally zero."""
    signals = arm.signals
    main = arm.joints.input_of(joint)
    own = next((j for j, one in enumerate(arm.joints.outputs) if one[0] == joint), 0)
    one = arm.joints.joint(joint)
    return sizes_of_numbers(one, make_port(one, signals.data(main, own), arm.motion[:, joint], False))
