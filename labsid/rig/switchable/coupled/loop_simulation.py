"""Simulation of a rig in a closed loop: reference, logged input and logged output."""

from dataclasses import dataclass

import numpy as np

from labsid._arrays import FloatArray, freeze
from labsid.rig.switchable.actuator import acting_command, backlash_output, moved_actuator
from labsid.rig.switchable.coupled.loop_rigs import Controller
from labsid.rig.switchable.coupled.setup import CoupledSetup
from labsid.rig.switchable.coupled.simulation import moved_states
from labsid.rig.switchable.setup import STEPS_PER_SAMPLE
from labsid.rig.switchable.simulation import Noise, UnboundedOutputError, load_signals, logged_output, noise_samples

LARGEST_ANGLE = 10.0
"""Output, over the amplitude of the reference, above which the loop counts as unstable."""


@dataclass(frozen=True, slots=True, eq=False)
class LoopRun:
    """Signals of one run in a closed loop, as deviations from the operating point.

    Attributes
    ----------
    r : ndarray, shape (N,)
        Reference.
    u : ndarray, shape (N,)
        Output of the controller after its limit, as logged.
    clean : ndarray, shape (N,)
        Output of this run as the sensor would show it without its noise, which acts on the run through the controller.
    y : ndarray, shape (N,)
        Logged output, which the controller reads.
    states : ndarray, shape (N, n)
    """

    r: FloatArray
    u: FloatArray
    clean: FloatArray
    y: FloatArray
    states: FloatArray

    def __post_init__(self) -> None:
        freeze(self, r=self.r, u=self.u, clean=self.clean, y=self.y, states=self.states)


def simulate_loop(setup: CoupledSetup, controller: Controller, r: FloatArray, noise: Noise) -> LoopRun:
    """Simulate a rig of one input and one output with its controller, from rest.

    Parameters
    ----------
    setup : CoupledSetup
        Of the sensor, only its curve, limits and quantisation act in the loop.
    controller : Controller
    r : ndarray, shape (N,)
        Reference.
    noise : Noise
        Sensor noise, which the controller reads as well.

    Returns
    -------
    LoopRun

    Raises
    ------
    UnboundedOutputError
        If the controller does not hold the rig.
    """
    n = r.size
    e = noise_samples(noise, n)
    load, _, _ = load_signals(setup.load, n)
    actuator, sensor, play = setup.actuators[0], setup.sensors[0], setup.plays[0]
    lag = round(actuator.delay * STEPS_PER_SAMPLE)
    u, clean, y, acting = (np.zeros(n) for _ in range(4))
    states = np.zeros((n, setup.plant.A.shape[0]))
    x, shown = states[0], 0.0
    last: tuple[float, float] | None = None
    command, derivative = 0.0, 0.0
    for k in range(n):
        states[k], u[k] = x, command
        clean[k] = logged_output(sensor, np.array([shown]), np.zeros(1), ())[0]
        y[k] = logged_output(sensor, np.array([shown]), e[k : k + 1], ())[0]
        if not abs(y[k]) < LARGEST_ANGLE:
            raise UnboundedOutputError(f"the controller must hold the {setup.rig}; it falls. Reduce the effect.")
        derivative = controller.filter_pole * derivative + controller.kd * (1 - controller.filter_pole) * (
            y[k] - y[k - 1] if k else 0.0
        )
        command = float(np.clip(controller.kp * (r[k] - y[k]) - derivative, -controller.limit, controller.limit))
        acting[k] = acting_command(actuator, u[k : k + 1], k)[0]
        steps = np.arange(k * STEPS_PER_SAMPLE, (k + 1) * STEPS_PER_SAMPLE)
        source = np.clip((steps - lag) // STEPS_PER_SAMPLE, 0, None)
        begin, end, last = moved_actuator(actuator, acting[source], last)
        path = moved_states(setup, x, begin[:, np.newaxis], end[:, np.newaxis], load[steps])
        x = path[-1]
        out = path[1:] @ setup.plant.C[0]
        shown = float((backlash_output(out, 0.5 * play, shown) if play else out)[-1])
    return LoopRun(r=r, u=u, clean=clean, y=y, states=states)
