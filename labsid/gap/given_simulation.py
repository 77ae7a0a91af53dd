"""The dynamics of a given simulation: its output, its free numbers, and responses to its initial state."""

from collections.abc import Callable, Sequence

import numpy as np

from labsid._arrays import FloatArray
from labsid.gap.data import Scale
from labsid.gap.plant_form import free_number
from labsid.gap.plants import Plant
from labsid.gap.reactions import Reaction, output_with
from labsid.simulators.meter import BudgetSpentError
from labsid.simulators.simulator import Simulator, SimulatorError

CACHED_RUNS = 64  # the search often repeats an input


def given_plant(
    simulate: Simulator,
    scales: tuple[Scale, Scale],
    Ts: float,
    rates: tuple[float, float],
    start: float = 0.0,
    pieces: Sequence[tuple[int, int]] = (),
) -> Plant:
    """The dynamics of a simulator.

    Parameters
    ----------
    simulate : Simulator
    scales : tuple of Scale
        Of input and output.
    Ts : float
        Sampling time, in seconds.
    rates : tuple of float
        c and k of a linear model of the rig, for responses to the initial state and to loads.
    start : float
        Time of the first sample, in seconds.
    pieces : sequence of (int, int)
        Several records that are joined end to end: each is simulated by itself.
    """
    u_scale, y_scale = scales
    free = tuple(free_number(name, simulate.nominal[name]) for name in simulate.free)

    def run(w: FloatArray, values: FloatArray) -> FloatArray:
        """NaN where the simulation fails with this input or these numbers: it has worked with those of the record.

        NaN, too, where a search has spent its budget, so that it ends with what it has found.
        """
        u, t = np.asarray(u_scale.back(w)), np.asarray(start + Ts * np.arange(w.size), np.float64)
        numbers = {one.given_name: one.number(value) for one, value in zip(free, values.tolist(), strict=True)}
        joined = pieces if pieces and w.size == pieces[-1][1] else ()
        try:
            output = by_record(w.size, joined, lambda at: simulate(t[: u[at].size], u[at], numbers))
        except BudgetSpentError:
            return np.full(w.size, np.nan)
        except SimulatorError as error:
            if error.ended:
                raise
            simulate.meter.note_failure(str(error))
            return np.full(w.size, np.nan)
        return y_scale.of(output)

    cached = _cached(run)
    pulses: dict[bytes, FloatArray] = {}
    longest = max((end - begin for begin, end in pieces), default=None)

    def pulse(values: FloatArray, samples: int) -> FloatArray:
        samples = samples if longest is None else min(samples, longest)  # a longer input would be that of all records
        key = values.tobytes()
        if key not in pulses or pulses[key].size < samples:
            at_zero = np.zeros(samples)
            response = run(at_zero + (np.arange(samples) == 0), values) - run(at_zero, values)
            if not np.isfinite(response).all():
                return response
            pulses[key] = response
        return pulses[key][:samples]

    def react(w: FloatArray, values: FloatArray, reaction: Reaction) -> FloatArray:
        def one_record(at: slice) -> FloatArray:
            part = w[at]
            return output_with(lambda driven: cached(driven, values), part, pulse(values, part.size), reaction)

        return by_record(w.size, pieces if pieces and w.size == pieces[-1][1] else (), one_record)

    return Plant(
        kind="given",
        run=cached,
        pulse=pulse,
        react=react,
        standstill=-y_scale.centre / y_scale.unit,
        free=free,
        source=simulate.source,
        meter=simulate.meter,
        takes_input=True,
        given_rates=rates,
    )


def by_record(samples: int, pieces: Sequence[tuple[int, int]], run: Callable[[slice], FloatArray]) -> FloatArray:
    """Outputs of a given simulation on each of several records; between two, the first value of the next one."""
    output = np.empty(samples)
    stop = 0
    for start, end in pieces or ((0, samples),):
        output[start:end] = run(slice(start, end))
        output[stop:start] = output[start]
        stop = end
    return output


def _cached(run: Callable[[FloatArray, FloatArray], FloatArray]) -> Callable[[FloatArray, FloatArray], FloatArray]:
    """Keep the last outputs of a simulation, but no failure: it may be that of a budget."""
    kept: dict[tuple[bytes, bytes], FloatArray] = {}

    def cached(w: FloatArray, values: FloatArray) -> FloatArray:
        key = w.tobytes(), values.tobytes()
        if key in kept:
            return kept[key]
        output = run(w, values)
        if np.isfinite(output[-1]):
            if len(kept) == CACHED_RUNS:
                del kept[next(iter(kept))]
            kept[key] = output
        return output

    return cached
