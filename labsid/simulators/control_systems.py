"""Systems of python-control as simulations."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from labsid._arrays import FloatArray
from labsid.model_structures.state_space import StateSpaceModel, free_responses, simulate_states
from labsid.simulators.simulator import Run, Simulator

_JUMP = 1e-6  # samples: in which a held input changes
_Pair = tuple[FloatArray, FloatArray]  # numerator and denominator
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
    _check_kind(system)
    if system.ninputs != 1 or system.noutputs != 1:
        raise ValueError(
            f"got a {name} with {system.ninputs} inputs and {system.noutputs} outputs, expected one of each. "
            "Select them first, such as system[0, 0]."
        )
    _check_sampling_time(system, Ts)
    if isinstance(system, ct.StateSpace | ct.TransferFunction):
        discrete = ct.tf(ct.c2d(system, Ts) if system.isctime() else system)
        num, den = discrete.num[0][0], discrete.den[0][0]
        return {"num": num.tolist(), "den": den.tolist(), "dt": Ts}
    return _nonlinear(system)


FreeResponses = Callable[[int, int], FloatArray]
"""``free(samples, j)``: what unit initial states leave of output j of a linear system, shape (samples, n)."""


def read_system_of_several(system: Any, Ts: float) -> tuple[Simulator, FreeResponses | None]:
    """A simulator of a system with any number of inputs and outputs, and the free responses of a linear one.

    A linear system starts from rest at its first inputs, a nonlinear one from rest at zero.

    Parameters
    ----------
    system : StateSpace, TransferFunction, NonlinearIOSystem or InterconnectedSystem
        The inputs of a continuous system are held between samples.
    Ts : float
        Sampling time of the record, in seconds; a discrete system must have the same.

    Raises
    ------
    ValueError
        If it is no such system, or has another sampling time.
    """
    import control as ct

    _check_kind(system)
    _check_sampling_time(system, Ts)
    inputs, outputs = tuple(map(str, system.input_labels)), tuple(map(str, system.output_labels))
    label = f"the {type(system).__name__}"
    if isinstance(system, ct.StateSpace):
        discrete = ct.c2d(system, Ts) if system.isctime() else system
        model = StateSpaceModel(discrete.A, discrete.B, discrete.C, discrete.D, Ts)
        run: Run = partial(_run_states, model)
        simulator = Simulator(run, label, inputs=inputs, outputs=outputs)
        return simulator, lambda samples, j: free_responses(model, samples)[:, j]
    if isinstance(system, ct.TransferFunction):
        pairs = [[_delays(system[j, i], Ts) for i in range(system.ninputs)] for j in range(system.noutputs)]
        run = partial(_run_pairs, pairs)
        return Simulator(run, label, inputs=inputs, outputs=outputs), lambda samples, j: _free(pairs[j], samples)
    return replace(_nonlinear(system), inputs=inputs, outputs=outputs), None


def _check_kind(system: Any) -> None:
    import control as ct

    if not isinstance(system, ct.InputOutputSystem):
        name = type(system).__name__
        raise ValueError(f"got a {name} of python-control, expected a system that can be simulated in time.")


def _check_sampling_time(system: Any, Ts: float) -> None:
    if not system.isctime() and system.dt not in (True, None) and abs(system.dt - Ts) > 1e-6 * Ts:
        raise ValueError(f"the system has dt = {system.dt:g} s, the record {Ts:g} s. Resample one of them.")


def _nonlinear(system: Any) -> Simulator:
    """A simulator of a nonlinear system, with its numbers."""
    numbers = {key: float(value) for key, value in system.params.items() if isinstance(value, int | float)}
    run = _run_continuous(system) if system.isctime() else _run_discrete(system)
    return Simulator(run, f"the {type(system).__name__}", numbers)


def _run_states(model: StateSpaceModel, t: FloatArray, u: FloatArray, numbers: Mapping[str, float]) -> FloatArray:
    """A discrete state-space system, from rest at its first inputs."""
    return simulate_states(model, u - u[0])


def _run_pairs(
    pairs: Sequence[Sequence[_Pair]], t: FloatArray, u: FloatArray, numbers: Mapping[str, float]
) -> FloatArray:
    """A matrix of transfer functions, each pair for itself, from rest at its first inputs."""
    from scipy.signal import lfilter  # slow to import

    moved = [[lfilter(num, den, u[:, i] - u[0, i]) for i, (num, den) in enumerate(row)] for row in pairs]
    return np.column_stack([np.sum(row, axis=0) for row in moved])


def _free(row: Sequence[_Pair], samples: int) -> FloatArray:
    """Free responses of all pairs of an output that have a path, poles in common counted once."""
    from scipy.signal import lfilter  # slow to import

    distinct = {den.tobytes(): den for num, den in row if np.any(num)}.values()
    columns = [
        lfilter([1.0], den, np.zeros(samples), zi=state)[0] for den in distinct for state in np.eye(den.size - 1)
    ]
    return np.column_stack(columns) if columns else np.zeros((samples, 0))


def _delays(system: Any, Ts: float) -> _Pair:
    """Numerator and denominator of one pair in powers of 1/z, of equal length, the latter beginning with one."""
    model = read_control_system(system, Ts)
    assert isinstance(model, dict)
    num, den = (np.atleast_1d(np.asarray(model[key], np.float64)) for key in ("num", "den"))
    return np.concatenate([np.zeros(den.size - num.size), num]) / den[0], den / den[0]


def _run_discrete(system: Any) -> Run:
    import control as ct

    def run(t: FloatArray, u: FloatArray, numbers: Mapping[str, float]) -> FloatArray:
        return np.asarray(ct.input_output_response(system, t - t[0], u.T, params=dict(numbers)).outputs).T

    return run


def _run_continuous(system: Any) -> Run:
    import control as ct

    def run(t: FloatArray, u: FloatArray, numbers: Mapping[str, float]) -> FloatArray:
        # python-control interpolates the input linearly: a held one has two points for each sample.
        times = t - t[0]
        ends = times[1:] - _JUMP * times[1]
        points = np.sort(np.concatenate([times, ends]))
        solver = _SOLVER | {"max_step": times[1]}
        inputs = np.repeat(u, 2, axis=0)[:-1].T
        response = ct.input_output_response(system, points, inputs, params=dict(numbers), solve_ivp_kwargs=solver)
        return np.asarray(response.outputs).T[::2]

    return run
