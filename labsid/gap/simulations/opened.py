"""A simulation that opens: a model of one joint, or a class that is stepped, in which effects are put."""

from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np

from labsid._arrays import FloatArray
from labsid.gap.dynamics.given_simulation import GivenSimulation
from labsid.gap.dynamics.inside_parts import PREFIX, InsidePort
from labsid.gap.dynamics.plants import Plant
from labsid.gap.dynamics.record_start import RecordStart
from labsid.gap.effects.restarts import Restarts
from labsid.gap.fits.fitting import Fit, fit_from
from labsid.gap.fits.hypothesis import Hypothesis
from labsid.gap.model_file import export_model
from labsid.gap.record.data import Data
from labsid.gap.simulations.number_sizes import motion_units, number_units
from labsid.gap.simulations.stepper_port import as_read, make_stepper_port
from labsid.records.record import Record
from labsid.simulators.mjcf.one_joint import OneJoint
from labsid.simulators.simulator import Simulator, SimulatorError
from labsid.simulators.stepper import Stepper

SAME = 1e-6  # of the range of the output: largest difference of the compiled loop from MuJoCo; numerics
FIRST = 8  # samples that give the initial state; numerics
LEAST_UNIT = 1e-9  # of a signal that does not move; numerics
OF_GEAR = ("play", "seen_play")  # changes of the compiled loop, of a rotor with inertia of its own (armature)
OF_ACTUATOR = ("transmitted", "gain", "lag", "limit", *OF_GEAR)  # changes that a joint without an actuator has not
START_ITERATIONS = 30  # of the fit of the initial state; numerics


def opened_structure(data: Data, simulate: Simulator, rates: tuple[float, float]) -> tuple[Hypothesis, FloatArray]:
    """The structure of a simulation that opens, and parameters with the initial state that the record shows.

    Parameters
    ----------
    data : Data
    simulate : Simulator
        With a joint.
    rates : tuple of float
        c and k of a linear model of the record.

    Raises
    ------
    ValueError
        If the model diverges on the record, or its timestep does not divide the sampling time.
    """
    one = simulate.joint
    assert one is not None
    t = np.asarray(data.Ts * np.arange(data.samples), np.float64)
    u, y = np.asarray(data.u_scale.back(data.u)), np.asarray(data.y_scale.back(data.y))
    scales = data.u_scale, data.y_scale
    if isinstance(one, Stepper):
        one = as_read(one, simulate, t, u, initial_state(one, y, data.Ts))
        start = initial_state(one, y, data.Ts)
        port = make_stepper_port(one, data, simulate, (t, u, start))
        given = GivenSimulation.of(simulate, scales, data.Ts, rates, float(data.start), data.pieces)
        given = replace(given, port=port, units=number_units(given, data.u, start))
    else:
        start = initial_state(one, y, data.Ts)
        motion = _motion(one, t, u, start)
        fast = _agreeing(simulate, one, t, u, start)
        port = make_port(one, data, motion, compiled=fast is not simulate)
        given = GivenSimulation.of(fast, scales, data.Ts, rates, float(data.start), data.pieces)
        given = replace(given, port=port, units=sizes_of_numbers(one, port))
    plant = Plant(kind="given", simulation=given)
    own = (Restarts(records=data.pieces[1:]),) if data.pieces else ()
    hypothesis = Hypothesis(own, len(own), plant)
    theta = np.zeros(len(hypothesis.parameters))
    names = [parameter.name for parameter in hypothesis.parameters]
    starts = [initial_state(one, y[begin:end], data.Ts) for begin, end in data.pieces or ((0, data.samples),)]
    for number, state in enumerate(starts, 1):
        of_record = f" {number}" if number > 1 else ""
        theta[names.index(f"z0{of_record}")] = state[PREFIX + "start"] / port.units["position"]
        if port.takes_speed:
            theta[names.index(f"v0{of_record}")] = state[PREFIX + "start_speed"] / port.units["speed"]
    return hypothesis, theta


def initial_state(one: OneJoint | Stepper, y: FloatArray, Ts: float) -> dict[str, float]:
    """Position from the model's default and speed at the first sample, from a straight line through the first ones."""
    first = y[:FIRST]
    slope, level = np.polyfit(np.arange(first.size) * Ts, first, 1)
    if one.output == "position":
        return {PREFIX + "start": float(level) - one.position, PREFIX + "start_speed": float(slope)}
    return {PREFIX + "start": 0.0, PREFIX + "start_speed": float(level) if one.output == "speed" else 0.0}


def _motion(one: OneJoint, t: FloatArray, u: FloatArray, start: Mapping[str, float]) -> FloatArray:
    """Position, speed and force of the actuator, shape (N, 3)."""
    columns = [replace(one, output=output).run(t, u, start) for output in ("position", "speed", "force")]
    motion = np.column_stack(columns)
    if not np.isfinite(motion).all():
        raise ValueError(
            f"the model is unstable on this record: the joint {one.joint} diverges. Check the signs and gains of its "
            f"actuator {one.actuator}."
        )
    return motion


def _agreeing(
    simulate: Simulator, one: OneJoint, t: FloatArray, u: FloatArray, start: Mapping[str, float]
) -> Simulator:
    """The simulator by the compiled loop, if it agrees with MuJoCo on the record; else the simulator itself."""
    loop = replace(simulate, run=one.run)
    try:
        played, looped = simulate(t, u, start), loop(t, u, start)
    except SimulatorError:
        return simulate
    return loop if np.abs(played - looped).max() <= SAME * max(float(np.ptp(played)), LEAST_UNIT) else simulate


def make_port(one: OneJoint, data: Data, motion: FloatArray, reads: bool = True, compiled: bool = True) -> InsidePort:
    """Where effects are put, with sizes that matter on a record.

    Parameters
    ----------
    one : OneJoint
    data : Data
    motion : ndarray, shape (N, 3)
        Position, speed and force of the actuator of the simulation.
    reads : bool
        Whether the output is one of this joint.
    compiled : bool
        Whether the compiled loop plays the model.
    """
    measured = np.asarray(data.y_scale.back(data.y))
    reads = reads and one.output == "position"
    position = measured if reads else motion[:, 0]
    nominal_spread = max(float(np.std(motion[:, 0])), LEAST_UNIT)
    spread = max(float(np.std(position)), LEAST_UNIT)
    ratio = spread / nominal_spread if reads else 1.0
    speed = max(ratio * float(np.sqrt(np.mean(motion[:, 1] ** 2))), LEAST_UNIT)
    acceleration = ratio * float(np.sqrt(np.mean(np.diff(motion[:, 1]) ** 2))) / data.Ts
    force = max(float(np.sqrt(np.mean(motion[:, 2] ** 2))), LEAST_UNIT)
    gear = abs(one.gear) or 1.0
    torque = max(gear * force, LEAST_UNIT)
    acceleration = max(acceleration, LEAST_UNIT)
    heavy = float(np.hypot(one.tip[1], one.tip[2])) + abs(one.tip[3])
    units = motion_units(data, torque, speed, spread, reads) | {
        "force": force,
        "inertia": torque / acceleration,
        "mass": torque / max(heavy + one.tip[0] * acceleration, LEAST_UNIT),
        "place": float(np.ptp(position)),
    }
    nominal = one.nominal()
    gain = {"position": "kp", "velocity": "kv", "torque": "gain"}[one.kind]
    of_joint = {what: f"{one.joint}:{what}" for what in ("damping", "armature", "stiffness")}
    names = of_joint | {"gain": f"{one.actuator}:{gain}", "mass": f"{one.link}:mass"}
    names = {what: name for what, name in names.items() if name in nominal}
    return InsidePort(
        joint=one.joint,
        actuator=one.actuator,
        kind=one.kind,
        slides=one.slides,
        units=units,
        place=float(np.median(position)),
        nominal=nominal,
        position=one.position,
        names=names,
        has_state=one.dynamics != "none",
        reads=reads,
        scale=(float(data.y_scale.centre), float(data.y_scale.unit)),
        forces=np.abs(motion[:, 2]) / force,
        unable=(() if compiled and one.armature else OF_GEAR) if one.actuator else OF_ACTUATOR,
    )


def sizes_of_numbers(one: OneJoint, port: InsidePort) -> dict[str, float]:
    """Sizes at which numbers begin to act that are nominally zero."""
    unit = {
        "damping": "damping",
        "drag": "drag",
        "stiffness": "stiffness",
        "cubic": "cubic",
        "frictionloss": "torque",
        "armature": "inertia",
        "springref": "position",
        "kv": "damping",
    }
    found = {}
    for name in one.nominal():
        of = unit.get(name.rpartition(":")[2])
        if of is not None:
            found[name] = 0.01 * port.units[of]
    return found


def fit_as_it_is(structure: Hypothesis, start: FloatArray, data: Data) -> Fit:
    """The simulation with nothing fitted but its initial state and the zero of the sensor.

    Raises
    ------
    ValueError
        If it cannot be run on the record.
    """
    fit = fit_from(data, structure, start, START_ITERATIONS)
    if fit is None:
        raise ValueError(f"the model is unstable on this record: {structure.plant.simulation.meter.failure}")
    return fit


def simulate_other(
    before: Callable[[Data], Fit], data: Data, record: Record, start: RecordStart | None = None
) -> FloatArray:
    """Output of the simulation on another record, its initial state estimated from the first samples."""
    fit = before(data)
    return export_model(data, fit, start=start or RecordStart(fit.slowest_rates)).simulate(record.u, record.y)
