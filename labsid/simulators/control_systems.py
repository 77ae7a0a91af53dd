"""Systems of python-control as simulations."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from labsid._arrays import FloatArray
from labsid.simulators.simulator import Run, Simulator

_JUMP = 1e-6  # samples: in which a held input changes
_SOLVER = {"rtol": 1e-6, "atol": 1e-9}


def is_control_system(simulation: object) -> bool:
    """Whether an object is a system of python-control, without an import of it."""
    return any(base.__module__.split(".")[0] == "control" for base in type(simulation).__mro__)


def read_control_system(system: Any, Ts: float) -> dict[str, Any] | Simulator:
    """A MODEL.json object of a linear system, or a simulator of a nonlinear one that starts from rest at zero.

    Parameters
    ----------
    system : StateSpace, TransferFunction, NonlinearIOSystem or InterconnectedSystem
        With one input and one output. Numbers in the ``params`` of a nonlinear one are its nominal numbers. The input
        of a continuous system is held between samples.
    Ts : float
        Sampling time of the record, in seconds; a discrete system must have the same.

    Raises
    ------
    ValueError
        If it has several inputs or outputs, or another sampling time.
    """
    import control as ct

    name = type(system).__name__
    if not isinstance(system, ct.InputOutputSystem):
        raise ValueError(f"got a {name} of python-control, expected a system that can be simulated in time.")
    if system.ninputs != 1 or system.noutputs != 1:
        raise ValueError(
            f"got a {name} with {system.ninputs} inputs and {system.noutputs} outputs, expected one of each. "
            "Select them first, such as system[0, 0]."
        )
    if not system.isctime() and system.dt not in (True, None) and abs(system.dt - Ts) > 1e-6 * Ts:
        raise ValueError(f"the system has dt = {system.dt:g} s, the record {Ts:g} s. Resample one of them.")
    if isinstance(system, ct.StateSpace | ct.TransferFunction):
        discrete = ct.tf(ct.c2d(system, Ts) if system.isctime() else system)
        num, den = discrete.num[0][0], discrete.den[0][0]
        return {"num": num.tolist(), "den": den.tolist(), "dt": Ts}
    numbers = {key: float(value) for key, value in system.params.items() if isinstance(value, int | float)}
    return Simulator(_run_continuous(system) if system.isctime() else _run_discrete(system), f"the {name}", numbers)


def _run_discrete(system: Any) -> Run:
    import control as ct

    def run(t: FloatArray, u: FloatArray, numbers: Mapping[str, float]) -> FloatArray:
        return np.asarray(ct.input_output_response(system, t - t[0], u, params=dict(numbers)).outputs)

    return run


def _run_continuous(system: Any) -> Run:
    import control as ct

    def run(t: FloatArray, u: FloatArray, numbers: Mapping[str, float]) -> FloatArray:
        # python-control interpolates the input linearly: a held one has two points for each sample.
        times = t - t[0]
        ends = times[1:] - _JUMP * times[1]
        points = np.sort(np.concatenate([times, ends]))
        solver = _SOLVER | {"max_step": times[1]}
        inputs = np.repeat(u, 2)[:-1]
        response = ct.input_output_response(system, points, inputs, params=dict(numbers), solve_ivp_kwargs=solver)
        return np.asarray(response.outputs)[::2]

    return run
