"""A case of the sealed check, and the recipe by which it can be made again, or once more with fresh input and noise."""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from labsid._arrays import FloatArray
from labsid.records.record import Record
from labsid.rig.switchable.inputs import draw_input
from labsid.rig.switchable.plants import Scales
from labsid.rig.switchable.setup import Setup
from labsid.rig.switchable.simulation import Noise, SimulatedRun, simulate_setup


@dataclass(frozen=True, slots=True)
class Experiment:
    """All that makes a record.

    Attributes
    ----------
    setup : Setup
        The rig with its effects.
    plain : Setup
        The rig without them.
    scales : Scales
    noise : Noise
    input : str
        Kind of input.
    input_seed : int
    samples : int
    time : float
        The rig's time scale in samples.
    from_rest : bool
    start : tuple of float
        The plant's states at the start.
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
    """One record of the sealed check, with what is withheld.

    Attributes
    ----------
    record : Record
    name : str
        Says nothing about the label.
    row : str
        Row of the table of bars.
    labels : tuple of str
        Effects in it; empty for none, ``("unknown",)`` for one outside the table.
    truth : dict
        Their parameters in the record's units; for the others, what is in the record all the same.
    sigma : float
        True standard deviation of the noise floor, in the record's units.
    level : str
        ``none``, ``hard`` or ``clear``.
    ratio : float
        What the best linear model leaves of the noise-free output, over `sigma`.
    experiment : Recipe
    sim : dict, optional
        A simulation that is handed over too, as MODEL.json.
    holdout : Record, optional
        A second record that is handed over too.
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


def input_signal(experiment: Experiment) -> FloatArray:
    """The input of a recipe, in the rig's own units.

    Parameters
    ----------
    experiment : Recipe

    Returns
    -------
    ndarray, shape (N,)
    """
    rng = np.random.default_rng(experiment.input_seed)
    return draw_input(rng, experiment.input, experiment.samples, experiment.time, experiment.from_rest)


def run_experiment(experiment: Experiment, setup: Setup | None = None) -> SimulatedRun:
    """Run a recipe.

    Parameters
    ----------
    experiment : Recipe
    setup : Setup, optional
        Another rig in the place of the recipe's own.

    Returns
    -------
    Played
    """
    return simulate_setup(
        experiment.setup if setup is None else setup, input_signal(experiment), experiment.noise, experiment.start
    )


def to_record(simulated: SimulatedRun, scales: Scales, name: str, clean: bool = False) -> Record:
    """A run in the record's units.

    Parameters
    ----------
    simulated : Played
    scales : Scales
    name : str
    clean : bool
        Whether to leave the noise out.

    Returns
    -------
    Record
    """
    t = scales.Ts * np.arange(simulated.v.size, dtype=np.float64)
    y = simulated.clean if clean else simulated.y
    return Record(t=t, u=scales.u0 + scales.us * simulated.v, y=scales.y0 + scales.ys * y, Ts=scales.Ts, name=name)


def redraw(experiment: Experiment, number: int) -> Experiment:
    """The same rig and effect with a fresh input of the same kind, and fresh noise.

    Parameters
    ----------
    experiment : Recipe
    number : int
        Which of the fresh records, from 0.

    Returns
    -------
    Recipe
        What happens by the clock (an onset, a drift) happens again; spikes, held stretches and coloured noise
        fall elsewhere.
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
