"""The simulation under test: its output on the record, and the structure from which the search starts."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np

from labsid._arrays import FloatArray
from labsid.gap.dynamics.given_simulation import GivenSimulation, by_record
from labsid.gap.dynamics.plants import Plant
from labsid.gap.dynamics.record_start import RecordStart
from labsid.gap.dynamics.responses import free_responses, single_pole
from labsid.gap.effects.dynamics import DirectFeedthrough, ExtraLag, Resonance
from labsid.gap.effects.input import Delay
from labsid.gap.effects.output_feedback import GAIN
from labsid.gap.effects.restarts import Restarts
from labsid.gap.fits.direct_term import estimate_direct_term
from labsid.gap.fits.fitting import Fit, fit_from
from labsid.gap.fits.hypothesis import Hypothesis
from labsid.gap.fits.linear_fits import fit_baseline
from labsid.gap.fits.noise_model import noise_of
from labsid.gap.fits.unstable_poles import find_stabilising_feedback
from labsid.gap.model_file import SCHEMA, ExportedModel, read_exported_model
from labsid.gap.record.controllers import find_control_law, is_one_line, is_relay
from labsid.gap.record.data import Data
from labsid.gap.simulations.model_json import TransferFunction, read_transfer_function, started
from labsid.gap.simulations.number_sizes import is_rough, number_units
from labsid.gap.simulations.opened import fit_as_it_is, opened_structure, simulate_other
from labsid.gap.simulations.simulated_output import OutputModel, SimulatedOutput, identify_output
from labsid.records.record import Record
from labsid.simulators.control_systems import is_control_system, read_control_system
from labsid.simulators.meter import RunMeter
from labsid.simulators.simulator import Simulator, one_of_each
from labsid.simulators.stepper import callable_simulator

FASTEST_POLE = 1e-3  # smaller ones are indistinguishable from zero; numerics
SLOWEST_RATES = 1e-6, 1e-9  # of c and k; numerics
UNSTABLE_RATIO = 1e6  # distance from the mean, in ranges of the measured output; numerics


Simulation = dict[str, Any] | ExportedModel | SimulatedOutput | Simulator
AnySimulation = Simulation | FloatArray | Callable[..., Any] | Any


@dataclass(frozen=True, slots=True, eq=False)
class Baseline:
    """The simulation whose error is the gap.

    Attributes
    ----------
    before : callable or None
        ``before(data) -> Fit``: the given simulation on the record, with only its offset and initial state estimated
        from the rows of `data`; None without one.
    structure : Hypothesis
        The structure from which the search starts.
    simulate_record : callable, optional
        ``simulate_record(record, start=None) -> y``: the output of a given simulation on another record, shape (N,),
        with its initial state estimated from the samples that a `RecordStart` states; by default by its own poles.
    start : ndarray, optional
        Initial parameters for the search, if the given simulation defines them.
    alternative : Hypothesis, optional
        The linear structure with a direct term, if only its fit can tell whether the record asks for one.
    output : SimulatedOutput, optional
        The simulated output, if that was given.
    model : OutputModel, optional
        The linear model that reproduces it, if there is one.
    regulated : bool
        Whether a controller with a constant reference gives the input.
    transfer_function : TransferFunction, optional
        The given simulation, if it is one.
    """

    before: Callable[[Data], Fit] | None
    structure: Hypothesis
    simulate_record: Callable[..., FloatArray] | None = None
    start: FloatArray | None = None
    alternative: Hypothesis | None = None
    output: SimulatedOutput | None = None
    model: OutputModel | None = None
    regulated: bool = False
    transfer_function: TransferFunction | None = None

    @property
    def given(self) -> bool:
        """Whether a simulation was given."""
        return self.before is not None

    @property
    def output_only(self) -> bool:
        """Whether only its output is known, so that only effects at the output can be added."""
        return self.structure.plant.kind == "given" and not self.structure.plant.simulation.takes_input

    @property
    def is_run(self) -> bool:
        """Whether a given simulation is run by the search."""
        return self.structure.plant.simulation.takes_input

    @property
    def meter(self) -> RunMeter:
        """Counts the runs of a given simulation."""
        return self.structure.plant.simulation.meter


def linear_structure(order: int) -> Hypothesis:
    """Linear structure of a given order.

    Orders 1 and 2 use the two poles of the plant, order 3 adds a lag, and orders from 4 add a second-order mode, so a
    given model of higher order is refitted with four poles.

    Raises
    ------
    ValueError
        If the order is not positive.
    """
    if order < 1:
        raise ValueError(f"--order must be at least 1; got {order}. The lab's model has order 2.")
    effects = (ExtraLag(),) if order == 3 else (Resonance(),) if order > 3 else ()
    return Hypothesis(effects, n_given=len(effects))


def _linear_baseline(data: Data, order: int, direct: bool = False, plant: Plant | None = None) -> Baseline:
    """Linear structures of a given order: strictly proper, or with a direct term if `direct` or the record asks."""
    structure = replace(linear_structure(order), given=plant)
    proper = Hypothesis((DirectFeedthrough(), *structure.effects), structure.n_given + 1, plant)
    structure, proper = with_restarts(structure, data), with_restarts(proper, data)
    u, y = data.u[data.rows], data.y[data.rows]
    law = find_control_law(u, y)
    regulated = law is not None and law.has_constant_reference
    stabilised = None if data.pieces or order != 2 else find_stabilising_feedback(data)
    if stabilised is not None:
        feedback, gain = stabilised
        structure = Hypothesis((feedback, *structure.effects), structure.n_given + 1)
        start = {"log_c": np.log(feedback.closed[0]), "log_k": np.log(feedback.closed[1]), GAIN: gain}
        theta = np.array([start.get(parameter.name, parameter.start) for parameter in structure.parameters])
        return Baseline(None, structure, start=theta, regulated=regulated)
    if not direct and not is_one_line(u, y) and (law is not None or is_relay(u, y)):
        return Baseline(None, structure, regulated=regulated)
    term = estimate_direct_term(data)
    if direct or term.present:
        return Baseline(None, proper)
    return Baseline(None, structure, alternative=None if term.decides else proper)


def with_restarts(structure: Hypothesis, data: Data) -> Hypothesis:
    """The structure with the offsets and initial states of several records; unchanged for one."""
    if not data.pieces:
        return structure
    return Hypothesis((Restarts(records=data.pieces[1:]), *structure.effects), structure.n_given + 1, structure.given)


def make_baseline(data: Data, t: FloatArray, simulation: Simulation | None, order: int = 2) -> Baseline:
    """Make the baseline of a record.

    Parameters
    ----------
    data : Data
    t : ndarray, shape (N,)
        Times, for a callable simulation.
    simulation : dict, ExportedModel, SimulatedOutput, Simulator or None
        MODEL.json or an exported simulation, as content or as a model; the output of any simulator on the record; or
        a simulator.
    order : int
        Order of the fitted model if no simulation is given, 1 to 4.

    Raises
    ------
    ValueError
        If the simulation does not match the record, or the order is out of range.
    """
    if simulation is None:
        if order > 4:
            raise ValueError(f"--order must be at most 4; got {order}. Give a larger model with --sim.")
        return _linear_baseline(data, order)
    simulation = read_exported(simulation, data.Ts)
    if isinstance(simulation, ExportedModel):
        return _exported(data, simulation)
    if isinstance(simulation, dict):
        return _transfer_function(data, read_transfer_function(simulation, data.Ts))
    if isinstance(simulation, Simulator):
        return simulator_baseline(data, t, simulation)
    assert simulation is not None
    return _simulated_output(data, simulation)


def as_simulation(simulation: AnySimulation | None, Ts: float, free: Sequence[str] = ()) -> Simulation | None:
    """Convert a function or a system of python-control to a simulation, with some of its numbers free.

    Parameters
    ----------
    simulation : dict, ExportedModel, ndarray, callable, Simulator, system of python-control or None
    Ts : float
        Sampling time of the record, in seconds.
    free : sequence of str

    Raises
    ------
    ValueError
        If it is none of these, or has no such numbers.
    """
    if is_control_system(simulation):
        simulation = read_control_system(simulation, Ts)
    elif callable(simulation) and not isinstance(simulation, Simulator):
        simulation = callable_simulator(simulation)
    elif isinstance(simulation, np.ndarray | list):
        simulation = SimulatedOutput(np.asarray(simulation, float))
    if isinstance(simulation, SimulatedOutput) and simulation.y.size and np.ptp(simulation.y) == 0.0:
        raise ValueError(
            f"the simulated output is {simulation.y[0]:.4g} throughout: it does not respond to the input, so it "
            "simulates nothing. Check the run of the simulator, or leave out --sim."
        )
    if isinstance(simulation, Simulator):
        one_of_each(simulation)
        return simulation.with_free(free) if free else simulation
    if free:
        what = "the fitted model" if simulation is None else "this simulation"
        raise ValueError(
            f"got free numbers ({', '.join(free)}), but {what} has none by name. Give a function with keyword defaults "
            "or an FMU as the simulation, or omit them."
        )
    return simulation


def read_exported(simulation: Simulation | None, Ts: float) -> Simulation | None:
    """Convert the content of an exported simulation to a model; return any other simulation unchanged.

    Raises
    ------
    ValueError
        If the content is invalid, or its sampling time is not `Ts`.
    """
    if isinstance(simulation, dict) and simulation.get("schema") == SCHEMA:
        return read_exported_model(simulation, Ts)
    return simulation


def check_bounded(y: FloatArray, measured: FloatArray) -> FloatArray:
    """Return a simulated output unless it diverges from the measured one.

    Raises
    ------
    ValueError
        If it diverges or is not finite.
    """
    if not np.all(np.abs(y - np.mean(measured)) <= UNSTABLE_RATIO * np.ptp(measured)):  # NaN is rejected, too
        raise ValueError("the simulation is unstable on this record: its output diverges. Check its poles.")
    return y


def _transfer_function(data: Data, model: TransferFunction) -> Baseline:
    u, y = _unscaled(data)
    output = check_bounded(model.response(u), y)
    before = partial(_fit_given, output, model.free_response(u.size), fit_baseline(data).rates)
    # Of first order with one pole: a further one of the rig is an effect that the simulation lacks.
    free = _linear_baseline(data, max(model.order, 1), model.direct, Plant(single=True) if model.order < 2 else None)

    def simulate_record(record: Record, start: RecordStart | None = None) -> FloatArray:
        return model.simulate(record.u, record.y, start)

    free = replace(free, before=before, simulate_record=simulate_record, transfer_function=model)
    if not model.dead_time:
        return free
    # It is a part of the simulation, so that a search does not find it again.
    structure = Hypothesis((Delay(), *free.structure.effects), free.structure.n_given + 1, free.structure.given)
    return replace(free, structure=structure, start=_delayed_start(data, structure, model), alternative=None)


def _delayed_start(data: Data, structure: Hypothesis, model: TransferFunction) -> FloatArray | None:
    """Parameters of a structure with the dead time of a simulation, fitted to its output."""
    guess = np.zeros(len(structure.parameters))
    guess[structure.slices[Delay.name]] = model.dead_time
    poles = np.roots(np.trim_zeros(model.den, "b")).astype(complex)
    rates = -np.log(np.where(np.abs(poles) > FASTEST_POLE, poles, FASTEST_POLE))
    slow = rates[np.argsort(np.abs(rates))[:2]]
    c, k = single_pole(float(np.abs(slow).max(initial=1.0))) if slow.size < 2 else (slow.sum().real, slow.prod().real)
    at = structure.slices["plant"].start
    guess[at : at + 2] = np.log(np.maximum([c, k], SLOWEST_RATES))
    output = data.y_scale.of(model.response(_unscaled(data)[0]))
    fit = fit_from(replace(data, y=output, rows=np.arange(data.samples) >= model.dead_time), structure, guess)
    return None if fit is None else fit.theta


def _exported(data: Data, model: ExportedModel) -> Baseline:
    u, y = _unscaled(data)
    output = check_bounded(by_record(data.samples, data.pieces, lambda at: model.simulate(u[at], y[at])), y)
    hypothesis = model.hypothesis.beside_output(model.y_scale.of(y))
    rates = hypothesis.plant.linear_rates(model.theta[hypothesis.slices["plant"]])
    before = partial(_fit_given, output, np.zeros((data.samples, 0)), rates)
    structure = with_restarts(Hypothesis(hypothesis.effects, len(hypothesis.effects), hypothesis.given), data)
    start = model.theta if (model.u_scale, model.y_scale) == (data.u_scale, data.y_scale) else None

    def simulate_record(record: Record, begun: RecordStart | None = None) -> FloatArray:
        return replace(model, start=begun or model.start).simulate(record.u, record.y)

    return Baseline(before, structure, simulate_record, start)


def simulator_baseline(
    data: Data,
    t: FloatArray,
    simulate: Simulator,
    rates: tuple[float, float] | None = None,
    states: FloatArray | None = None,
) -> Baseline:
    """Baseline of a simulator that is run.

    Parameters
    ----------
    data : Data
    t : ndarray, shape (N,)
        Times in seconds.
    simulate : Simulator
    rates : tuple of float, optional
        c and k of a linear model of the rig, for its initial state and its loads; by default those of the record, or of
        the simulation.
    states : ndarray, shape (N, n), optional
        What unit initial states leave of its output; by default responses of second order with these rates.
    """
    if simulate.joint is not None:
        return _opened(data, simulate)
    u, y = _unscaled(data)
    output = check_bounded(by_record(data.samples, data.pieces, lambda at: simulate(t[: u[at].size], u[at])), y)
    if rates is None:
        rates = fit_baseline(data).rates if simulate.free else _linear_rates(data, output)
    states = free_responses(data.samples, *rates) if states is None else states
    before = partial(_fit_given, output, states, rates)
    scales = data.u_scale, data.y_scale
    given = GivenSimulation.of(simulate, scales, data.Ts, rates, float(t[0]), data.pieces)
    given = replace(given, units=number_units(given, data.u))
    given = replace(given, rough=is_rough(given, data.u))
    structure = with_restarts(Hypothesis((), 0, Plant(kind="given", simulation=given)), data)

    def simulate_record(record: Record, start: RecordStart | None = None) -> FloatArray:
        used = (start or RecordStart(rates)).used(len(record))
        return started(simulate(record.t, record.u), free_responses(len(record), *rates), record.y, used)

    return Baseline(before, structure, simulate_record)


def _opened(data: Data, simulate: Simulator) -> Baseline:
    """Baseline of a simulation that opens: nothing but its initial state and the zero of the sensor is estimated."""
    rates = fit_baseline(data).rates
    plain, start = opened_structure(data, replace(simulate, free=()), rates)
    structure, begun = opened_structure(data, simulate, rates) if simulate.free else (plain, start)
    before = partial(fit_as_it_is, plain, start)
    return Baseline(before, structure, partial(simulate_other, before, data), begun)


def _linear_rates(data: Data, output: FloatArray) -> tuple[float, float]:
    """c and k of a linear model of a simulation, from its output on the record: neither noise nor a load is in it."""
    return fit_baseline(replace(data, y=data.y_scale.of(output))).rates


def _simulated_output(data: Data, output: SimulatedOutput) -> Baseline:
    """Baseline of a simulated output: the linear model that reproduces it, or the output as it is."""
    if data.pieces:
        raise ValueError("a simulated output belongs to one record. Give a model or a function for several records.")
    if output.y.shape != data.u.shape:
        raise ValueError(f"the simulated output must have the record's {data.samples} samples; got {output.y.size}.")
    u, y = _unscaled(data)
    series = check_bounded(output.y, y)
    model = identify_output(u, series, data.Ts)
    if model is not None:
        base = _transfer_function(data, model.function)
        before = partial(_fit_given, series, model.function.free_response(data.samples), _linear_rates(data, series))
        return replace(base, before=before, output=output, model=model)
    scaled_series, rates = data.y_scale.of(series), _linear_rates(data, series)
    given = GivenSimulation(lambda w, numbers: scaled_series, rates)
    structure = Hypothesis((), 0, Plant(kind="given", simulation=given))
    return Baseline(partial(_fit_given, series, np.zeros((data.samples, 0)), rates), structure, output=output)


def _unscaled(data: Data) -> tuple[FloatArray, FloatArray]:
    """Input and output in the record's units."""
    return np.asarray(data.u_scale.back(data.u)), np.asarray(data.y_scale.back(data.y))


def _fit_given(output: FloatArray, states: FloatArray, rates: tuple[float, float], data: Data) -> Fit:
    """The given simulation as a fit in which only the offset and the initial state are estimated.

    `rates` are those of a linear model of the rig.
    """
    columns = np.column_stack([np.ones(data.samples), states])
    own = [np.zeros_like(columns) for _ in data.pieces[1:]]
    for block, (start, stop) in zip(own, data.pieces[1:], strict=True):
        block[start:stop] = columns[: stop - start]
    columns = np.column_stack([columns, *own])
    y = data.y - data.y_scale.of(output)
    scale = np.sqrt((columns[data.rows] ** 2).sum(axis=0))
    scale[scale == 0.0] = 1.0
    gains = np.linalg.lstsq(columns[data.rows] / scale, y[data.rows], rcond=None)[0] / scale
    fitted = data.y_scale.of(output) + columns @ gains
    noise = noise_of(data, data.y - fitted)
    cost = float(np.mean((data.y - fitted)[data.rows] ** 2))
    bic = noise.score + gains.size * np.log(noise.rows)
    given = GivenSimulation(lambda w, numbers: data.y_scale.of(output), rates)
    hypothesis = Hypothesis((), 0, Plant(kind="given", simulation=given))
    return Fit(hypothesis, np.zeros(0), gains, fitted, cost, noise, float(bic))
