"""A given simulation as dynamics: its output, its free numbers, and forces that react to its motion."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, Self

import numpy as np

from labsid._arrays import FloatArray
from labsid.gap.dynamics.reaction_forces import Reaction, output_with
from labsid.gap.record.data import Scale
from labsid.simulators.meter import BudgetSpentError, RunMeter
from labsid.simulators.simulator import Simulator, SimulatorError

CACHED_RUNS = 64  # the search often repeats an input; numerics

Pieces = Sequence[tuple[int, int]]


@dataclass(frozen=True, slots=True, eq=False)
class GivenSimulation:
    """A given simulation, in scaled units.

    Attributes
    ----------
    simulate : callable
        ``simulate(w, numbers) -> y``, both signals of shape (N,), for values of its free numbers by name; NaN where it
        fails.
    rates : tuple of float
        c and k of a linear model of the rig, for responses to the initial state and to loads.
    takes_input : bool
        Whether it can be run with another input.
    nominal : dict
        The numbers that may be fitted, by name, with their nominal values.
    ranges : dict
        The lower and upper limits of some of them.
    units : dict
        Sizes at which those begin to act that are nominally zero.
    rough : bool
        Whether its output jumps as a free number changes, because it rounds one of them or has a coarse tolerance.
    standstill : float
        Output at which it reads zero.
    pieces : sequence of (int, int)
        Several records that are joined end to end: each is simulated by itself.
    source : str
        Its file, as ``rig.py:simulate``, for export; empty without one.
    meter : RunMeter
        Counts its runs.
    port : InsidePort or None
        Where effects are put inside it; None for a simulation that is a whole.
    others : tuple of str
        Names of its other inputs, of a simulation of several signals.
    beside : callable or None
        ``beside(signals)`` is `simulate` with other scaled signals at these inputs, by name.
    _outputs, _pulses : dict
        The last outputs, and the responses to a unit pulse.
    """

    simulate: Callable[[FloatArray, dict[str, float]], FloatArray]
    rates: tuple[float, float] = (0.5, 0.05)
    takes_input: bool = False
    nominal: dict[str, float] = field(default_factory=dict)
    ranges: dict[str, tuple[float, float]] = field(default_factory=dict)
    units: dict[str, float] = field(default_factory=dict)
    rough: bool = False
    standstill: float = 0.0
    pieces: Pieces = ()
    source: str = ""
    meter: RunMeter = field(default_factory=RunMeter)
    port: Any = None
    others: tuple[str, ...] = ()
    beside: Callable[[Mapping[str, FloatArray]], Callable[[FloatArray, dict[str, float]], FloatArray]] | None = None
    _outputs: dict[tuple[bytes, tuple[tuple[str, float], ...]], FloatArray] = field(
        default_factory=dict, init=False, repr=False
    )
    _pulses: dict[tuple[float, ...], FloatArray] = field(default_factory=dict, init=False, repr=False)

    @classmethod
    def of(
        cls,
        simulator: Simulator,
        scales: tuple[Scale, Scale],
        Ts: float,
        rates: tuple[float, float],
        start: float = 0.0,
        pieces: Pieces = (),
    ) -> Self:
        """A simulator in the scales of input and output.

        Parameters
        ----------
        simulator : Simulator
        scales : tuple of Scale
            Of input and output.
        Ts : float
            Sampling time, in seconds.
        rates : tuple of float
            c and k of a linear model of the rig.
        start : float
            Time of the first sample, in seconds.
        pieces : sequence of (int, int)
            Several records that are joined end to end.
        """
        u_scale, y_scale = scales

        def simulate(w: FloatArray, numbers: dict[str, float]) -> FloatArray:
            """NaN where the simulation fails with this input or these numbers: it has worked with those of the record.

            NaN, too, where a search has spent its budget, so that it ends with what it has found.
            """
            u, t = np.asarray(u_scale.back(w)), np.asarray(start + Ts * np.arange(w.size), np.float64)
            try:
                return y_scale.of(by_record(w.size, pieces, lambda at: simulator(t[: u[at].size], u[at], numbers)))
            except BudgetSpentError:
                return np.full(w.size, np.nan)
            except SimulatorError as error:
                if error.ended:
                    raise
                simulator.meter.note_failure(str(error))
                return np.full(w.size, np.nan)

        return cls(
            simulate,
            rates,
            takes_input=True,
            nominal={name: simulator.nominal[name] for name in simulator.free},
            ranges=dict(simulator.ranges),
            standstill=-y_scale.centre / y_scale.unit,
            pieces=pieces,
            source=simulator.source,
            meter=simulator.meter,
        )

    def with_signals(self, signals: Mapping[str, FloatArray]) -> "GivenSimulation":
        """The simulation with other scaled signals at its other inputs, by name; itself where it has none."""
        return self if self.beside is None else replace(self, simulate=self.beside(signals))

    def run(self, w: FloatArray, numbers: dict[str, float]) -> FloatArray:
        """Output for the input `w`. The last outputs are kept, but no failure: it may be that of a budget."""
        key = w.tobytes(), tuple(numbers.items())
        if key in self._outputs:
            return self._outputs[key]
        output = self.simulate(w, numbers)
        if np.isfinite(output[-1]):
            if len(self._outputs) == CACHED_RUNS:
                del self._outputs[next(iter(self._outputs))]
            self._outputs[key] = output
        return output

    def pulse(self, numbers: dict[str, float], samples: int) -> FloatArray:
        """Response to a unit pulse of the input at sample 0, at most as long as a record."""
        samples = min(samples, max((end - begin for begin, end in self.pieces), default=samples))
        key = tuple(numbers.values())
        if key not in self._pulses or self._pulses[key].size < samples:
            at_zero = np.zeros(samples)
            response = self.simulate(at_zero + (np.arange(samples) == 0), numbers) - self.simulate(at_zero, numbers)
            if not np.isfinite(response).all():
                return response
            self._pulses[key] = response
        return self._pulses[key][:samples]

    def react(self, w: FloatArray, numbers: dict[str, float], reaction: Reaction) -> FloatArray:
        """Output with forces at the input that react to it."""

        def one_record(at: slice) -> FloatArray:
            part = w[at]
            return output_with(lambda driven: self.run(driven, numbers), part, self.pulse(numbers, part.size), reaction)

        return by_record(w.size, self.pieces, one_record)


def is_joined(samples: int, pieces: Pieces) -> bool:
    """Whether a signal is that of several records; another number of samples than that of all of them is one record."""
    return bool(pieces) and samples == pieces[-1][1]


def by_record(samples: int, pieces: Pieces, run: Callable[[slice], FloatArray]) -> FloatArray:
    """Outputs of a given simulation on each of several records; between two, the first value of the next one."""
    output = np.empty(samples)
    stop = 0
    for start, end in pieces if is_joined(samples, pieces) else ((0, samples),):
        output[start:end] = run(slice(start, end))
        output[stop:start] = output[start]
        stop = end
    return output
