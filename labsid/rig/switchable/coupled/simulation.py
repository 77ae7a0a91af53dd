"""Simulation of a rig of several signals: actuators, plant with load, sensors, noise and loggers."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from labsid._arrays import FloatArray, freeze
from labsid.rig.switchable.actuator import actuator_output, backlash_output
from labsid.rig.switchable.coupled._motion import move_coupled
from labsid.rig.switchable.coupled.setup import CoupledSetup, linearised, within_limits
from labsid.rig.switchable.setup import STEPS_PER_SAMPLE
from labsid.rig.switchable.simulation import (
    Noise,
    UnboundedOutputError,
    dropout_intervals,
    load_signals,
    logged_output,
    noise_samples,
)

LARGEST_OUTPUT = 1e6


@dataclass(frozen=True, slots=True, eq=False)
class CoupledRun:
    """Signals of one run, as deviations from the operating point.

    Attributes
    ----------
    v : ndarray, shape (N, nu)
        Commanded inputs.
    clean : ndarray, shape (N, ny)
        Logged outputs without sensor noise, with every effect.
    y : ndarray, shape (N, ny)
        Logged outputs.
    """

    v: FloatArray
    clean: FloatArray
    y: FloatArray

    def __post_init__(self) -> None:
        freeze(self, v=self.v, clean=self.clean, y=self.y)


def simulate_coupled(setup: CoupledSetup, v: FloatArray, noises: Sequence[Noise]) -> CoupledRun:
    """Simulate a rig and log its outputs.

    It begins at the steady state that its first inputs have without effects, or at the limits that it then exceeds.

    Parameters
    ----------
    setup : CoupledSetup
    v : ndarray, shape (N, nu)
        Commanded inputs in rig units, held over each sample.
    noises : sequence of Noise
        One for each output.

    Returns
    -------
    CoupledRun

    Raises
    ------
    UnboundedOutputError
        If an output diverges.
    """
    shown = plant_outputs(setup, v)
    n = v.shape[0]
    clean, y = np.empty_like(shown), np.empty_like(shown)
    for j, (sensor, noise) in enumerate(zip(setup.sensors, noises, strict=True)):
        dropouts = dropout_intervals(sensor, n)
        clean[:, j] = logged_output(sensor, shown[:, j], np.zeros(n), dropouts)
        y[:, j] = logged_output(sensor, shown[:, j], noise_samples(noise, n), dropouts)
    return CoupledRun(v=v, clean=clean, y=y)


def plant_outputs(setup: CoupledSetup, v: FloatArray) -> FloatArray:
    """Outputs at the start of each sample, after the backlash and before the sensors.

    Parameters
    ----------
    setup : CoupledSetup
    v : ndarray, shape (N, nu)

    Returns
    -------
    ndarray, shape (N, ny)

    Raises
    ------
    UnboundedOutputError
        If an output diverges.
    """
    y = plant_states(setup, v) @ setup.plant.C.T
    if not np.all(np.abs(y) < LARGEST_OUTPUT):
        raise UnboundedOutputError(f"the {setup.rig} must stay bounded; an output diverges. Reduce the effect.")
    for j, play in enumerate(setup.plays):
        if play:
            y[:, j] = backlash_output(y[:, j].copy(), 0.5 * play, float(y[0, j]))
    return np.ascontiguousarray(y[::STEPS_PER_SAMPLE])


def plant_states(setup: CoupledSetup, v: FloatArray) -> FloatArray:
    """States of the plant at the start of every integration step.

    Parameters
    ----------
    setup : CoupledSetup
    v : ndarray, shape (N, nu)

    Returns
    -------
    ndarray, shape (N * STEPS_PER_SAMPLE, n)
    """
    acting = [actuator_output(a, np.ascontiguousarray(v[:, i])) for i, a in enumerate(setup.actuators)]
    begin, end = (np.column_stack([pair[side] for pair in acting]) for side in (0, 1))
    load, _, _ = load_signals(setup.load, v.shape[0])
    A, B, _ = linearised(setup.plant)
    return moved_states(setup, within_limits(setup.plant, np.linalg.solve(A, -B @ v[0])), begin, end, load)[:-1]


def moved_states(
    setup: CoupledSetup, x0: FloatArray, begin: FloatArray, end: FloatArray, load: FloatArray
) -> FloatArray:
    """States of the plant before every integration step and after the last one.

    Parameters
    ----------
    setup : CoupledSetup
    x0 : ndarray, shape (n,)
    begin, end : ndarray, shape (steps, nu)
        Actuator outputs at the beginning and at the end of each step.
    load : ndarray, shape (steps,)

    Returns
    -------
    ndarray, shape (steps + 1, n)
    """
    p = setup.plant
    return move_coupled(
        p.A,
        p.flow,
        p.B,
        p.curvature,
        p.brim,
        p.cubic,
        p.friction,
        p.stop_low,
        p.stop_high,
        p.speed_of,
        x0,
        begin,
        end,
        load,
        setup.load_gain,
        STEPS_PER_SAMPLE,
    )
