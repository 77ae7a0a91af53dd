"""A simulation of a rig that is a black box: a function of time, input and named numbers."""

import inspect
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from traceback import extract_tb
from typing import Any

import numpy as np

from labsid._arrays import FloatArray
from labsid.simulators.meter import BudgetSpentError, RunMeter

ALL = "all"
NAMES_OF_INPUT = {"u", "us", "input", "inputs", "command", "commands"}
NAMES_OF_TIME = {"t", "ts", "dt", "h", "time", "times", "tt"}
Run = Callable[[FloatArray, FloatArray, Mapping[str, float]], Any]


class SimulatorError(ValueError):
    """A simulation that stops, takes too long, or returns no output; `ended` if it cannot be run again."""

    def __init__(self, text: str, ended: bool = False) -> None:
        super().__init__(text)
        self.ended = ended


@dataclass(frozen=True, slots=True, eq=False)
class Simulator:
    """A simulation of a rig.

    Attributes
    ----------
    run : callable
        ``run(t, u, numbers) -> y`` for times in seconds and an input, each of shape (N,), and all numbers by name; of
        several signals u has the shape (N, nu) and y (N, ny).
    label : str
        What messages call it, such as ``rig.py:simulate``.
    nominal : dict
        Its numbers by name, with their nominal values.
    free : tuple of str
        The numbers that may be fitted.
    ranges : dict
        The lower and upper limits of some of them.
    source : str
        The file from which it can be opened again, as ``rig.py:simulate``; empty without one.
    meter : RunMeter
        Counts its runs.
    joint : OneJoint, Stepper or None
        Where effects can be put inside: of a model of one joint the same model as a compiled loop, of a class what it
        can do.
    inputs, outputs : tuple of str
        Names of its signals, in their order; empty if unknown.
    """

    run: Run
    label: str
    nominal: dict[str, float] = field(default_factory=dict)
    free: tuple[str, ...] = ()
    ranges: dict[str, tuple[float, float]] = field(default_factory=dict)
    source: str = ""
    meter: RunMeter = field(default_factory=RunMeter)
    joint: Any = None
    inputs: tuple[str, ...] = ()
    outputs: tuple[str, ...] = ()

    def __call__(self, t: FloatArray, u: FloatArray, numbers: Mapping[str, float] | None = None) -> FloatArray:
        """Simulated output, shape (N,), with other values of some numbers; (N, ny) for inputs of shape (N, nu).

        Raises
        ------
        SimulatorError
            If the simulation stops with an error, or does not return one finite number for each sample.
        BudgetSpentError
            If a search has spent its budget of runs.
        """
        wanted = self.nominal | dict(numbers or {})
        try:
            returned = self.meter.measured(lambda: self.run(t, u, wanted))
        except (SimulatorError, BudgetSpentError):
            raise
        except Exception as error:
            raise SimulatorError(f"{self.label} stopped with {type(error).__name__}: {error}{_place(error)}") from error
        return as_output(returned, u.size, self.label) if u.ndim == 1 else as_outputs(returned, len(u), self.label)

    def with_free(self, wanted: Sequence[str]) -> "Simulator":
        """The simulation with some of its numbers free.

        Parameters
        ----------
        wanted : sequence of str
            Their names, with a range of their own as ``gain=0:5``; the name of a joint or an actuator for all of its
            numbers, "all" for all.

        Raises
        ------
        ValueError
            If it has no such number, or a range is none that contains the nominal value.
        """
        free, ranges = [], dict(self.ranges)
        for text in wanted:
            name, equals, limits = (part.strip() for part in text.partition("="))
            group = [number for number in self.nominal if name == ALL or number.startswith(f"{name}:")]
            if group and name not in self.nominal and not equals:
                free += group
                continue
            if name not in self.nominal:
                known = f"it has {', '.join(self.nominal)}" if self.nominal else "it has none with a nominal value"
                raise ValueError(f"{self.label} has no number {name!r} that could be free; {known}.")
            free.append(name)
            if equals:
                ranges[name] = _range(name, limits, self.nominal[name])
        chosen = tuple(dict.fromkeys(free))
        return replace(self, free=chosen, ranges={name: ranges[name] for name in chosen if name in ranges})


def _range(name: str, text: str, nominal: float) -> tuple[float, float]:
    """The limits of a free number, ``LOW:HIGH``."""
    low, colon, high = text.partition(":")
    try:
        limits = float(low), float(high)
    except ValueError:
        limits = np.nan, np.nan
    if not colon or not -np.inf < limits[0] < limits[1] < np.inf:
        raise ValueError(f"the range of {name} must be LOW:HIGH with LOW < HIGH; got {text!r}. Write {name}=0:5.")
    if not limits[0] <= nominal <= limits[1]:
        raise ValueError(
            f"the range of {name}, {limits[0]:g} to {limits[1]:g}, must contain its nominal value {nominal:g}. "
            "Widen it, or change the nominal value."
        )
    return limits


def one_of_each(simulator: Simulator) -> Simulator:
    """The simulator, if it is not known to have several inputs or outputs.

    Raises
    ------
    ValueError
        If it has.
    """
    for names, what in ((simulator.inputs, "input"), (simulator.outputs, "output")):
        if len(names) > 1:
            raise ValueError(f"{simulator.label} has {len(names)} ({', '.join(names)}) as real {what}, expected one.")
    return simulator


def as_outputs(returned: Any, samples: int, label: str) -> FloatArray:
    """Validate what a simulation of several signals returned.

    Parameters
    ----------
    returned : object
        Shape (N, ny), or (N,) for one output.
    samples : int
        N.
    label : str
        What messages call the simulation.

    Raises
    ------
    SimulatorError
        If it is not finite numbers with a row for each sample.
    """
    try:
        shape = np.shape(returned)
    except ValueError:
        raise SimulatorError(
            f"{label} returns rows of different lengths; it must return the outputs, with a row for each sample."
        ) from None
    if shape and (len(shape) > 2 or shape[0] != samples):
        raise SimulatorError(
            f"{label} returns an array of shape {shape} for {samples} samples; it must return the outputs, with a "
            f"row for each sample and a column for each output, shape ({samples}, ny)."
        )
    return as_output(returned, int(np.prod(shape)) if shape else samples, label).reshape(samples, -1)


def as_output(returned: Any, samples: int, label: str) -> FloatArray:
    """Validate what a simulation returned.

    Parameters
    ----------
    returned : object
    samples : int
        Expected number of samples.
    label : str
        What messages call the simulation.

    Raises
    ------
    SimulatorError
        If it is not one finite number for each sample.
    """
    if returned is None:
        raise SimulatorError(f"{label} returns nothing; it must return the output, {samples} numbers.")
    if inspect.isgenerator(returned):
        raise SimulatorError(f"{label} returns a generator; it must return the output, {samples} numbers.")
    if np.iscomplexobj(returned):
        raise SimulatorError(f"{label} returns complex numbers; it must return the output, {samples} real numbers.")
    try:
        y = np.asarray(returned, float)
    except (TypeError, ValueError):
        kind = type(returned).__name__
        raise SimulatorError(f"{label} returns a {kind} that is not numbers; it must return the output.") from None
    if y.size != samples:
        raise SimulatorError(
            f"{label} returns {y.size} numbers for {samples} samples; it must return the output at each time."
        )
    if not np.isfinite(y).all():
        raise SimulatorError(f"{label} returns numbers that are not finite; the first is sample {_first_bad(y)}.")
    return np.ascontiguousarray(y.reshape(-1))


def function_simulator(function: Callable[..., Any], label: str | None = None) -> Simulator:
    """A simulation from a Python function.

    Parameters
    ----------
    function : callable
        ``function(t, u, **numbers) -> y``; its parameters after the first two that have a number as default are its
        nominal numbers.
    label : str, optional
        What messages call it; by default its name.

    Raises
    ------
    ValueError
        If it cannot be called with a time and an input, or names them the other way round.
    """
    label = label or str(getattr(function, "__name__", type(function).__name__))
    nominal: dict[str, float] = {}
    try:
        signature = inspect.signature(function)
        signature.bind(None, None)
    except TypeError as error:
        raise ValueError(f"{label} cannot be called as {label.split(':')[-1]}(t, u): {error}.") from None
    except ValueError:  # a builtin without a signature
        return Simulator(lambda t, u, numbers: function(t, u), label)
    first, second = list(signature.parameters)[:2] if len(signature.parameters) > 1 else ("", "")
    if first.lower() in NAMES_OF_INPUT and second.lower() in NAMES_OF_TIME:
        call = label.split(":")[-1]
        raise ValueError(
            f"{label} takes ({first}, {second}), and is called with the times first. Write it as {call}(t, u): t are "
            "the times of the samples in seconds, u the input at these times."
        )
    for parameter in list(signature.parameters.values())[2:]:
        default = parameter.default
        if isinstance(default, int | float | np.number) and not isinstance(default, bool):
            nominal[parameter.name] = float(default)
    return Simulator(lambda t, u, numbers: function(t, u, **numbers), label, nominal)


def _place(error: Exception) -> str:
    """File and line of the user's code at which an error was raised."""
    own = [frame for frame in extract_tb(error.__traceback__)[1:] if "site-packages" not in frame.filename]
    return f" ({Path(own[-1].filename).name}, line {own[-1].lineno})" if own else ""


def _first_bad(y: FloatArray) -> int:
    return int(np.argmin(np.isfinite(y.reshape(-1))))
