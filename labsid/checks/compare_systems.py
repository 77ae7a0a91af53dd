"""Read an answer as a system with one input and one output, and compare systems by their responses."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from labsid.checks.compare import kind_of
from labsid.checks.values import StateSpaceValue, TransferFunctionValue, Value
from labsid.checks.verdict import NoAnswer

SystemValue = TransferFunctionValue | StateSpaceValue

MAX_ORDER = 100
"""Largest order of a system that is compared; the plants of the course have far lower orders."""


def as_system(name: str, value: Value) -> SystemValue:
    """Read a transfer function or a state space with one input and one output."""
    if not isinstance(value, (TransferFunctionValue, StateSpaceValue)):
        is_data = isinstance(value, tuple | int | float | np.ndarray | str)
        made = " Make it with `ct.tf(...)` or `ct.ss(...)`." if is_data else ""
        raise NoAnswer(f"`{name}` should be a transfer function or a state space; it is {kind_of(value)}.{made}")
    if isinstance(value, StateSpaceValue):
        order, inputs, outputs = value.A.shape[0], value.B.shape[1], value.C.shape[0]
        if (inputs, outputs) != (1, 1):
            raise NoAnswer(f"`{name}` should have one input and one output; it has {inputs} and {outputs}.")
        fitting = (order, order), (order, 1), (1, order), (1, 1)
        if tuple(matrix.shape for matrix in (value.A, value.B, value.C, value.D)) != fitting:
            shapes = ", ".join(f"{part} {getattr(value, part).shape}" for part in "ABCD")
            raise NoAnswer(f"The matrices of `{name}` do not fit together: {shapes}.")
    else:
        order = max(value.num.size, value.den.size) - 1
    if order > MAX_ORDER:
        raise NoAnswer(f"`{name}` has order {order}, far above the order of this plant.")
    return value


def frequency_response(system: SystemValue, points: int = 64) -> NDArray[np.complex128]:
    """Response at logarithmically spaced frequencies up to Nyquist (over eight decades in continuous time)."""
    continuous = 1j * np.logspace(-4, 4, points)
    z = continuous if system.dt is None else np.exp(1j * np.pi * np.logspace(-3, 0, points))
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        if isinstance(system, TransferFunctionValue):
            return np.asarray(np.polyval(system.num, z) / np.polyval(system.den, z), complex)
        eye = np.eye(system.A.shape[0])
        states = np.linalg.solve(
            z[:, None, None] * eye - system.A, np.broadcast_to(system.B, (points, *system.B.shape))
        )
        return np.asarray((system.C @ states + system.D)[:, 0, 0], complex)


def same_response(relative: float = 1e-6) -> Callable[[SystemValue, SystemValue], bool]:
    """Make a comparison of two systems: equal sampling time and frequency response, in any realization."""

    def same(a: SystemValue, b: SystemValue) -> bool:
        if (a.dt is None) != (b.dt is None) or (a.dt is not None and not abs(a.dt - (b.dt or 0)) <= 1e-9):
            return False
        try:
            x, y = frequency_response(a), frequency_response(b)
        except (ValueError, np.linalg.LinAlgError):
            return False
        return bool(np.all(np.isfinite(x)) and np.max(np.abs(x - y)) <= relative * np.max(np.abs(y)))

    return same
