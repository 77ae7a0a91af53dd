"""Experiments of the sealed check, which can be repeated exactly or with new input and noise, and its cases."""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from labsid._arrays import FloatArray
from labsid.records.record import Record
from labsid.rig.ordinary.record_files import OrdinaryRecord
from labsid.rig.switchable.inputs import draw_input
from labsid.rig.switchable.plants import Scales
from labsid.rig.switchable.setup import Setup
from labsid.rig.switchable.simulation import Noise, SimulatedRun, simulate_setup


@dataclass(frozen=True, slots=True)
class Experiment:
    """A rig, its input and its noise: everything needed to reproduce a record.

    Attributes
    ----------
    setup : Setup
        The rig with its effects.
    plain : Setup
        The rig without effects.
    scales : Scales
    noise : Noise
    input : str
        Kind of input.
    input_seed : int
    samples : int
    time : float
        Time scale of the rig in samples.
    from_rest : bool
        Whether the input begins at rest.
    start : tuple of float
        Initial states of the plant.
    """

    setup: Setup
    plain: Setup
    scales: Scales
    noise: Noise
    input: str
    input_seed: int
    samples: int
    time: float
    from_rest: bool
    start: tuple[float, float]


@dataclass(frozen=True, slots=True, eq=False)
class Case:
    """One record of the sealed check with its withheld label.

    Attributes
    ----------
    record : Record
    name : str
        Random name, independent of the label.
    row : str
        Row of the table.
    labels : tuple of str
        Effects in the record; empty for none, ``("unknown",)`` for an effect outside the table.
    truth : dict
        Parameters of the effects in the record's units; without labelled effects, the kind of the case.
    sigma : float
        True standard deviation of the sensor noise, in the record's units.
    level : str
        ``none``, ``faint``, ``hard`` or ``clear``.
    ratio : float
        Rms error of the best linear model on the noise-free output, divided by `sigma`.
    experiment : Experiment
    sim : dict, optional
        Simulation given to the diagnosis, in the format of MODEL.json.
    holdout : Record, optional
        Second record given to the diagnosis.
    others : tuple of Record
        Further runs of the rig, diagnosed together with `record`, which is also diagnosed alone.
    """

    record: Record
    name: str
    row: str
    labels: tuple[str, ...]
    truth: dict[str, Any]
    sigma: float
    level: str
    ratio: float
    experiment: Experiment
    sim: dict[str, Any] | None = None
    holdout: Record | None = None
    others: tuple[Record, ...] = ()

    @property
    def alone(self) -> str:
        """Name under which `record` is diagnosed alone beside its `others`."""
        return f"{self.name}-alone"


@dataclass(frozen=True, slots=True, eq=False)
class OrdinaryCase:
    """One ordinary record of the sealed check with what is to be answered.

    Attributes
    ----------
    name : str
        Random name, independent of the answer.
    row : str
        Row of the table.
    kind : str
        One of `labsid.rig.ordinary.kinds.KINDS`.
    made : OrdinaryRecord
    """

    name: str
    row: str
    kind: str
    made: OrdinaryRecord

    @property
    def options(self) -> tuple[str, ...]:
        """Further words of the command line, without which the diagnosis does not find the simulation."""
        return tuple(word.replace("NAME", self.name) for word in self.made.options)


def input_signal(experiment: Experiment) -> FloatArray:
    """Input of an experiment in rig units.

    Parameters
    ----------
    experiment : Experiment

    Returns
    -------
    ndarray, shape (N,)
    """
    rng = np.random.default_rng(experiment.input_seed)
    return draw_input(rng, experiment.input, experiment.samples, experiment.time, experiment.from_rest)


def run_experiment(experiment: Experiment, setup: Setup | None = None) -> SimulatedRun:
    """Run an experiment.

    Parameters
    ----------
    experiment : Experiment
    setup : Setup, optional
        Rig to use instead of the experiment's own.

    Returns
    -------
    SimulatedRun
    """
    return simulate_setup(
        experiment.setup if setup is None else setup, input_signal(experiment), experiment.noise, experiment.start
    )


def to_record(simulated: SimulatedRun, scales: Scales, name: str, clean: bool = False) -> Record:
    """Convert a run to a record in the record's units.

    Parameters
    ----------
    simulated : SimulatedRun
    scales : Scales
    name : str
    clean : bool
        Whether to omit the noise.

    Returns
    -------
    Record
    """
    t = scales.Ts * np.arange(simulated.v.size, dtype=np.float64)
    y = simulated.clean if clean else simulated.y
    return Record(t=t, u=scales.u0 + scales.us * simulated.v, y=scales.y0 + scales.ys * y, Ts=scales.Ts, name=name)


def redraw(experiment: Experiment, number: int) -> Experiment:
    """Keep rig and effect, and draw a new input of the same kind and new noise.

    Parameters
    ----------
    experiment : Experiment
    number : int
        Index of the new record, from 0.

    Returns
    -------
    Experiment
        Effects that depend on time, such as an onset or a drift, recur; outliers, dropouts and coloured noise are
        drawn again.
    """
    seed = np.random.SeedSequence([experiment.input_seed, experiment.noise.seed, number])
    input_seed, noise_seed, sensor_seed = (int(s) for s in seed.generate_state(3))
    sensor = replace(experiment.setup.sensor, seed=sensor_seed)
    return replace(
        experiment,
        setup=replace(experiment.setup, sensor=sensor),
        input_seed=input_seed,
        noise=replace(experiment.noise, seed=noise_seed),
    )
