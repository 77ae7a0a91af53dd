"""The port of a class that is stepped: where effects are put, with sizes that matter on a record."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from labsid._arrays import FloatArray
from labsid.gap.dynamics.inside_parts import PREFIX, InsidePort
from labsid.gap.record.data import Data
from labsid.gap.simulations.number_sizes import motion_units
from labsid.simulators.simulator import Simulator, SimulatorError
from labsid.simulators.stepper import COLUMN, COLUMNS, LONGEST_UNSOLVED, Stepper

OF_THE_DRIVE = ("transmitted", "limit", "gain", "armature", "mass", "play", "seen_play")
"""Changes that need the force of the drive, the inertia, or a rotor apart from what it moves."""
HOLDING = ("friction", "peak", "low", "high")
SAME = 1e-9  # of the range of the output; numerics
LEAST_UNIT = 1e-9  # of a signal that does not move; numerics
SMALL_DAMPING = 0.01  # of that which stops the motion within the record; set by hand
Run = tuple[FloatArray, FloatArray, Mapping[str, float]]


def as_read(one: Stepper, simulate: Simulator, t: FloatArray, u: FloatArray, start: Mapping[str, float]) -> Stepper:
    """The class with what its output is: its position, its speed, or another signal.

    Raises
    ------
    ValueError
        If it cannot be run on the record.
    """
    if not one.has_motion:
        return one
    y, *motion = (_column(simulate, (t, u, start), column) for column in COLUMNS[:3])
    for output, signal in zip(("position", "speed"), motion, strict=True):
        if np.abs(y - signal).max() <= SAME * max(float(np.ptp(y)), LEAST_UNIT):
            return replace(one, output=output)
    return replace(one, output="other")


def _column(simulate: Simulator, run: Run, column: str) -> FloatArray:
    t, u, numbers = run
    return simulate(t, u, {**numbers, COLUMN: float(COLUMNS.index(column))})


def make_stepper_port(one: Stepper, data: Data, simulate: Simulator, run: Run) -> InsidePort:
    """The port, with sizes from the motion of the simulation.

    Parameters
    ----------
    one : Stepper
    data : Data
    simulate : Simulator
    run : tuple
        Times, input and the numbers of a run on the record.

    Raises
    ------
    ValueError
        If a force at the port does not move it.
    """
    t, u, start = run
    y, position, speed, mobility = (_column(simulate, run, column) for column in COLUMNS)
    measured = np.asarray(data.y_scale.back(data.y))
    reads = one.output == "position"
    q = measured if reads else position
    spread, nominal_spread = (max(float(np.std(x)), LEAST_UNIT) for x in (q, position))
    ratio = spread / nominal_spread if reads else 1.0
    fast = max(ratio * float(np.sqrt(np.mean(speed**2))), LEAST_UNIT)
    inertia = data.Ts / float(mobility[0])
    accelerating = inertia * ratio * float(np.sqrt(np.mean(np.diff(speed) ** 2))) / data.Ts
    # A little damping shows the force against the motion that moves the output by its own spread.
    damping = SMALL_DAMPING * inertia / max(data.samples * data.Ts, data.Ts)
    try:
        moved = float(np.std(simulate(t, u, {**start, PREFIX + "damping": damping}) - y))
    except SimulatorError:
        moved = 0.0
    resisting = damping * fast * max(float(np.std(y)), LEAST_UNIT) / moved if moved > 0.0 else accelerating
    force = max(float(np.sqrt(accelerating * resisting)), LEAST_UNIT)
    return InsidePort(
        joint="",
        actuator="",
        kind="unknown",
        slides=False,
        units=motion_units(data, force, fast, spread, reads)
        | {"force": force, "place": max(float(np.ptp(q)), LEAST_UNIT)},
        place=float(np.median(q)),
        nominal={},
        reads=reads,
        scale=(float(data.y_scale.centre), float(data.y_scale.unit)),
        stepper=one.label,
        unable=OF_THE_DRIVE if one.holds(data.Ts) else OF_THE_DRIVE + HOLDING,
        takes_speed=one.takes_speed,
    )


def untried_inside(one: Stepper, Ts: float) -> str:
    """What cannot be tried inside a class, and what it would take, in sentences."""
    texts = [
        f"Inside {one.label}, a limit of the force of its drive, a wrong gain, a wrong inertia and friction that grows "
        "with the load cannot be tried: they need the force of the drive. Free its numbers (--free) for the others."
    ]
    if not one.has_motion:
        texts.append("Without motion() -> (position, speed), neither can dry friction and stops.")
    elif not one.holds(Ts):
        texts.append(
            f"Without save() and restore(state), or mobility(), neither can dry friction and stops at a sampling time "
            f"above {1e3 * LONGEST_UNSOLVED:g} ms."
        )
    return " ".join(texts)
