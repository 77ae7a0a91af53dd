"""A given simulation of several signals: seen as one output and one input, and the paths that it lacks."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from labsid._arrays import FloatArray
from labsid.gap.dynamics.record_start import RecordStart
from labsid.gap.dynamics.responses import denominator, free_responses
from labsid.gap.effects.further_inputs import FurtherInput
from labsid.gap.fits.fitting import Fit, fit_from
from labsid.gap.fits.hypothesis import Hypothesis
from labsid.gap.model_file import ExportedModel
from labsid.gap.record.data import Data, Scale
from labsid.gap.search.beam_search import is_improvement
from labsid.gap.signals.input_responses import LinearParts
from labsid.gap.simulations.baseline import (
    AnySimulation,
    Baseline,
    as_simulation,
    check_bounded,
    simulator_baseline,
)
from labsid.gap.simulations.model_json import started
from labsid.gap.simulations.simulated_output import SimulatedOutput
from labsid.gap.system_file import SYSTEM_SCHEMA, system_from_json
from labsid.gap.system_pairs import in_order, one_pair, output_places, pair_simulation, unscaled_inputs
from labsid.gap.verdict.decision import mismatch_probability
from labsid.records.record import Record
from labsid.simulators.control_systems import FreeResponses, is_control_system, read_system_of_several
from labsid.simulators.simulator import Simulator
from labsid.simulators.stepper import callable_simulator

NO_PATH = 1e-6  # of the standard deviation of an output: a smaller response to an input is none; numerics
COUPLING_ITERATIONS = 40  # of the fit of a coupling; numerics


_KINDS: dict[type, str] = {
    dict: "MODEL.json or an exported JSON",
    SimulatedOutput: "a simulated output",
    np.ndarray: "a simulated output",
    ExportedModel: "an exported simulation",
}


@dataclass(frozen=True, slots=True, eq=False)
class Coupling:
    """A path from an input to an output that the rig has and the simulation lacks.

    Attributes
    ----------
    input : int
    effect : FurtherInput
        The response of second order that stands for it.
    gain : float
        Static gain, in units of the output over that of the input.
    probability : float
        That the simulation with it is better than without.
    left : float
        Mean square of the error with it and those before it, over that without.
    bic : float
        With it and those before it.
    """

    input: int
    effect: FurtherInput
    gain: float
    probability: float
    left: float
    bic: float


@dataclass(frozen=True, slots=True, eq=False)
class GivenSystem:
    """A given simulation of the inputs and outputs of a record.

    Attributes
    ----------
    simulator : Simulator
        ``simulator(t, u, numbers) -> y`` for u of shape (N, nu), y of shape (N, ny), in the order of the record.
    free : callable or None
        ``free(samples, j)``: what initial states leave of output j, shape (samples, n), of a linear system. Its numbers
        are then fitted to the record to see if they are wrong.
    paths : ndarray of bool, shape (ny, nu)
        Which input moves which output in it.
    couplings : tuple of tuple of Coupling
        For each output, the paths that it lacks.
    """

    simulator: Simulator
    free: FreeResponses | None
    paths: np.ndarray
    couplings: tuple[tuple[Coupling, ...], ...] = ()

    @property
    def linear(self) -> bool:
        """Whether it is a linear system."""
        return self.free is not None

    def states(self, samples: int, j: int, rates: tuple[float, float]) -> FloatArray:
        """What initial states leave of output j; of second order with these rates, unless the system is linear."""
        return free_responses(samples, *rates) if self.free is None else self.free(samples, j)

    def lacking(self, j: int, signals: FloatArray) -> tuple[FurtherInput, ...]:
        """Responses of output j to inputs that it lacks, for scaled inputs of shape (N, nu)."""
        found = self.couplings[j] if self.couplings else ()
        return tuple(replace(one.effect, signal=np.ascontiguousarray(signals[:, one.input])) for one in found)


def as_system(
    simulation: AnySimulation | None, record: Record, outputs: Sequence[str], free: Sequence[str] = ()
) -> GivenSystem | None:
    """Convert a function, a simulator or a system of python-control to a simulation of the signals of a record.

    Parameters
    ----------
    simulation : callable, Simulator, system of python-control or None
    record : Record
        The samples and the outputs that are diagnosed.
    outputs : sequence of str
        All outputs that the simulation has, in its order.
    free : sequence of str
        Numbers of it that may be fitted.

    Raises
    ------
    ValueError
        If it is none of these, has other signals or no such numbers, or cannot be run on the record.
    """
    responses: FreeResponses | None = None
    if is_control_system(simulation):
        simulation, responses = read_system_of_several(simulation, record.Ts)
    elif callable(simulation) and not isinstance(simulation, Simulator):
        simulation = callable_simulator(simulation)
    elif isinstance(simulation, dict) and simulation.get("schema") == SYSTEM_SCHEMA:
        simulation = _exported_simulator(simulation)
    if simulation is None or (responses is not None and free):
        as_simulation(None, record.Ts, free)  # refuses free numbers
        return None
    if not isinstance(simulation, Simulator) or simulation.joint is not None:  # of several joints: `labsid.gap.joints`
        kind = "a model of MuJoCo" if isinstance(simulation, Simulator) else _KINDS.get(type(simulation), "this")
        raise ValueError(
            f"a record of several signals needs a simulation of all of them: a function simulate(t, u) with u of shape "
            f"(N, {record.input_columns.shape[1]}), an FMU or a system of python-control; got {kind}. Give one of "
            "these, or choose one input and one output."
        )
    return read_system(simulation.with_free(free) if free else simulation, responses, record, outputs)


def _exported_simulator(content: dict[str, Any]) -> Simulator:
    """An exported simulation of several signals, from rest."""
    system = system_from_json(content)
    return Simulator(
        lambda t, u, numbers: system.simulate(u),
        "the exported simulation",
        inputs=system.inputs,
        outputs=tuple(system.outputs),
    )


def read_system(
    simulator: Simulator, free: FreeResponses | None, record: Record, outputs: Sequence[str]
) -> GivenSystem:
    """A simulation with its signals in the order of those of a record, run once for each input.

    Parameters
    ----------
    simulator : Simulator
        Signals with the names of the record are taken by name, others in their order.
    free : callable or None
        Of a linear system; see `GivenSystem`. Its outputs are in the order of `outputs`.
    record : Record
        The samples and the outputs that are diagnosed.
    outputs : sequence of str
        All outputs that the simulation has, in its order.

    Raises
    ------
    ValueError
        If it has another number of inputs or outputs, cannot be run on the record, or an output diverges.
    """
    ordered = in_order(simulator, record.inputs, outputs, record.outputs)
    u = record.input_columns
    y = ordered(record.t, u)
    for simulated, measured in zip(y.T, record.output_columns.T, strict=True):
        check_bounded(simulated, measured[~np.isnan(measured)])
    paths = np.zeros((y.shape[1], u.shape[1]), bool)
    for i, first in enumerate(u[0]):
        still = u.copy()
        still[:, i] = first
        moved = np.std(y - ordered(record.t, still), axis=0)
        paths[:, i] = moved > NO_PATH * np.nanstd(record.output_columns, axis=0)
    if free is None:
        return GivenSystem(ordered, None, paths)
    rows = output_places(simulator, outputs, record.outputs)
    return GivenSystem(ordered, lambda samples, j: free(samples, rows[j]), paths)


def given_baseline(
    system: GivenSystem,
    data: Data,
    t: FloatArray,
    inputs: FloatArray,
    pair: tuple[int, int],
    names: tuple[str, ...],
    scales: Sequence[Scale],
    rates: tuple[float, float],
) -> Baseline:
    """Baseline of one output that a given simulation sees through one input, without the paths that it lacks.

    Parameters
    ----------
    system : GivenSystem
    data : Data
        Of this input and output.
    t : ndarray, shape (N,)
    inputs : ndarray, shape (N, nu)
        All inputs after the actuators, scaled.
    pair : (int, int)
        Input and output.
    names : tuple of str
        Of the inputs.
    scales : sequence of Scale
        Of the inputs.
    rates : tuple of float
        c and k of the response of the rig to the input, for its initial state and its loads.
    """
    u = unscaled_inputs(inputs, names, scales, {})
    states = system.states(data.samples, pair[1], rates)
    base = simulator_baseline(data, t, one_pair(system.simulator, u, *pair), rates, states)
    assert base.structure.given is not None
    about = names, scales, data.y_scale, data.Ts, rates, float(t[0])
    beside = pair_simulation(system.simulator, inputs, pair, *about)
    simulation = replace(base.structure.given.simulation, others=beside.others, beside=beside.beside)
    given = replace(base.structure.given, simulation=simulation)
    return replace(base, structure=Hypothesis(base.structure.effects, base.structure.n_given, given))


def simulate_elsewhere(
    system: GivenSystem,
    t: FloatArray,
    u: FloatArray,
    j: int,
    rates: tuple[float, float],
    record: Record,
    start: RecordStart | None = None,
) -> FloatArray:
    """Output j of the simulation on another record, its initial state estimated from the samples that `start` states.

    Parameters
    ----------
    system : GivenSystem
    t : ndarray, shape (N,)
    u : ndarray, shape (N, nu)
        All inputs of the other record.
    j : int
    rates : tuple of float
        c and k of the responses to the initial state.
    record : Record
        The other record, seen as one input and output j.
    start : RecordStart, optional

    Returns
    -------
    ndarray, shape (N,)
    """
    used = (start or RecordStart(rates)).used(len(record))
    simulated = system.simulator(t, u)[:, j]
    return started(simulated, system.states(len(record), j, rates), record.y, used)


def find_couplings(
    system: GivenSystem, pairs: Sequence[Data], base: Baseline, j: int, parts: LinearParts, names: tuple[str, ...]
) -> tuple[Coupling, ...]:
    """The paths to an output that the rig has and the simulation lacks, the strongest first.

    Each is a response of second order to the input, added to the output of the simulation as it is.

    Parameters
    ----------
    system : GivenSystem
    pairs : sequence of Data
        The input through which `base` is seen with this output, then each input with it.
    base : Baseline
        Of this output.
    j : int
    parts : LinearParts
        Of this output.
    names : tuple of str
        Of the inputs.
    """
    data, *pairs = pairs
    before = fit_from(data, base.structure, np.zeros(len(base.structure.parameters)))
    if before is None:
        return ()
    couplings: list[Coupling] = []
    at_first = before.cost
    for i in np.argsort(-parts.strength).tolist():
        if system.paths[j, i] or not parts.seen[i]:
            continue
        further = FurtherInput(names[i], parts.rates[i], float(pairs[i].u[0]), False, pairs[i].u)
        after = _with(data, before, further)
        if after is None or not is_improvement(data, before, after):
            continue
        gain = _static_gain(after, further) * data.y_scale.unit / pairs[i].u_scale.unit
        left_share = after.cost / max(at_first, np.finfo(float).tiny)
        couplings.append(Coupling(i, further, gain, mismatch_probability(before, after), left_share, after.bic))
        before = after
    return tuple(couplings)


def _with(data: Data, before: Fit, effect: FurtherInput) -> Fit | None:
    """A fit with one more response."""
    hypothesis = Hypothesis(
        (*before.hypothesis.effects, effect), before.hypothesis.n_given + 1, before.hypothesis.given
    )
    theta = np.zeros(len(hypothesis.parameters))
    for key, place in before.hypothesis.slices.items():
        theta[hypothesis.slices[key]] = before.theta[place]
    return fit_from(data, hypothesis, theta, iterations=COUPLING_ITERATIONS)


def _static_gain(fit: Fit, effect: FurtherInput) -> float:
    """Scaled steady output for a unit of the input."""
    c, k = np.multiply(effect.about, np.exp(fit.theta[fit.hypothesis.slices[effect.key]]))
    a1, a2 = denominator(float(c), float(k))
    own = next(one for one in fit.hypothesis.additive if one.key == effect.key)
    return float(np.sum(fit.hypothesis.gains_of(fit.gains, own)[:2]) / (1.0 + a1 + a2))
