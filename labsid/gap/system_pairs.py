"""A simulation of several signals: in the order of the signals of a record, and seen as one input and one output."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from labsid._arrays import FloatArray
from labsid.gap.dynamics.given_simulation import GivenSimulation
from labsid.gap.effects.further_inputs import extended
from labsid.gap.record.data import Scale
from labsid.simulators.simulator import Simulator, SimulatorError, as_outputs

CACHED_RUNS = 32  # every output of a run is asked for


def in_order(simulator: Simulator, inputs: Sequence[str], outputs: Sequence[str], kept: Sequence[str]) -> Simulator:
    """A simulation with its signals in the order of those of a record.

    Parameters
    ----------
    simulator : Simulator
        Signals with the names of the record are taken by name, others in their order.
    inputs : sequence of str
    outputs : sequence of str
        All that the simulation has.
    kept : sequence of str
        Those that are returned.

    Returns
    -------
    Simulator
        ``simulator(t, u) -> y`` for u of shape (N, nu) and y of shape (N, ny), of the outputs `kept`.

    Raises
    ------
    ValueError
        If it has another number of inputs or outputs; of a function that is seen when it runs.
    """
    columns = _order(simulator.inputs, inputs, "input", simulator.label)
    rows = output_places(simulator, outputs, kept)
    back = [columns.index(i) for i in range(len(columns))]  # the column of the record for each input of the simulation
    ny = len(outputs)

    done: dict[tuple[int, bytes, tuple[tuple[str, float], ...]], FloatArray] = {}

    def run(t: FloatArray, u: FloatArray, numbers: Mapping[str, float]) -> FloatArray:
        key = len(t), u.tobytes(), tuple(numbers.items())
        if key not in done:
            y = as_outputs(simulator.run(t, np.ascontiguousarray(u[:, back]), numbers), len(t), simulator.label)
            if y.shape[1] != ny:
                raise SimulatorError(
                    f"{simulator.label} returns {_counted(y.shape[1])} for {', '.join(outputs)}; it must return an "
                    f"array of shape ({len(t)}, {ny}). Choose the outputs of the record with --outputs."
                )
            if len(done) == CACHED_RUNS:
                del done[next(iter(done))]
            done[key] = y[:, rows]
        return done[key]

    return replace(simulator, run=run, inputs=tuple(inputs), outputs=tuple(kept))


def output_places(simulator: Simulator, outputs: Sequence[str], kept: Sequence[str]) -> list[int]:
    """For each output in `kept` its place among those of a simulation that has all `outputs`; see `in_order`."""
    places = dict(zip(outputs, _order(simulator.outputs, outputs, "output", simulator.label), strict=True))
    return [places[name] for name in kept]


def _counted(count: int) -> str:
    return "one output" if count == 1 else f"{count} outputs"


def _order(names: Sequence[str], wanted: Sequence[str], what: str, label: str) -> list[int]:
    """For each signal of a record its place in a simulation: by name if all names agree, else in order."""
    if names and len(names) != len(wanted):
        raise ValueError(
            f"{label} has {len(names)} {what}s ({', '.join(names)}); the record has {len(wanted)} "
            f"({', '.join(wanted)}). Choose the columns with --{what}s."
        )
    return [names.index(name) for name in wanted] if set(names) == set(wanted) else list(range(len(wanted)))


def one_pair(simulator: Simulator, u: FloatArray, i: int, j: int) -> Simulator:
    """The simulation as one of input i and output j.

    Parameters
    ----------
    simulator : Simulator
        From `in_order`.
    u : ndarray, shape (N, nu)
        All inputs, in units of the record. Past their end the other inputs hold their last values.
    i, j : int
    """

    def run(t: FloatArray, own: FloatArray, numbers: Mapping[str, float]) -> FloatArray:
        columns = [own if k == i else extended(u[:, k], own.size) for k in range(u.shape[1])]
        return np.asarray(simulator.run(t, np.column_stack(columns), numbers))[:, j]

    return replace(simulator, run=run, inputs=(), outputs=())


def pair_simulation(
    simulator: Simulator,
    inputs: FloatArray,
    pair: tuple[int, int],
    names: Sequence[str],
    scales: Sequence[Scale],
    y_scale: Scale,
    Ts: float,
    rates: tuple[float, float],
    start: float = 0.0,
) -> GivenSimulation:
    """The simulation of one output that depends on one input, the others as recorded or exchanged by their names.

    Parameters
    ----------
    simulator : Simulator
        From `in_order`.
    inputs : ndarray, shape (N, nu)
        All inputs, scaled.
    pair : (int, int)
        Input and output.
    names : sequence of str
        Of the inputs.
    scales : sequence of Scale
        Of the inputs.
    y_scale : Scale
    Ts : float
    rates : tuple of float
        c and k of the response of the rig.
    start : float
        Time of the first sample, in seconds.
    """
    i, j = pair

    def with_others(signals: Mapping[str, FloatArray]) -> GivenSimulation:
        one = one_pair(simulator, unscaled_inputs(inputs, names, scales, signals), i, j)
        return GivenSimulation.of(one, (scales[i], y_scale), Ts, rates, start)

    others = tuple(name for k, name in enumerate(names) if k != i)
    return replace(with_others({}), others=others, beside=lambda signals: with_others(signals).simulate)


def unscaled_inputs(
    inputs: FloatArray, names: Sequence[str], scales: Sequence[Scale], signals: Mapping[str, FloatArray]
) -> FloatArray:
    """All inputs in units of the record, shape (N, nu), some of them exchanged by their names."""
    scaled = [signals.get(name, inputs[:, k]) for k, name in enumerate(names)]
    size = max(signal.size for signal in scaled)
    columns = [np.asarray(scale.back(extended(w, size))) for scale, w in zip(scales, scaled, strict=True)]
    return np.column_stack(columns)
