"""The rows `signals`, `signals-hard` and `signals-none`: rigs of several signals with an effect at one of them."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from labsid._arrays import FloatArray
from labsid.blind.draws import draw_mild_colour, draw_noise_colour, log_uniform
from labsid.blind.exercised import is_exercised
from labsid.blind.experiment import OrdinaryCase
from labsid.blind.output_error import discrete_poles
from labsid.blind.placed_effects import placed_label
from labsid.blind.several_inputs import linear_error
from labsid.blind.strength import CLEAR_RATIOS, HARD_RATIOS, NEGLIGIBLE_RATIO, find_strength
from labsid.rig.ordinary.record_files import OrdinaryRecord, table_text
from labsid.rig.switchable.coupled.effects import EFFECTS, coupled_context, draw_placed_effect, rigs_with
from labsid.rig.switchable.coupled.inputs import draw_inputs
from labsid.rig.switchable.coupled.placed_effect import PlacedEffect
from labsid.rig.switchable.coupled.plants import RIGS, coupled_poles, coupled_time_scale, draw_coupled_rig
from labsid.rig.switchable.coupled.setup import CoupledSetup
from labsid.rig.switchable.coupled.simulation import plant_states, simulate_coupled
from labsid.rig.switchable.coupled.units import draw_units
from labsid.rig.switchable.inputs import RICH_INPUTS
from labsid.rig.switchable.setup import STEPS_PER_SAMPLE
from labsid.rig.switchable.simulation import Noise

FEWEST_SAMPLES, MOST_SAMPLES = 600, 2500
NOISE_SHARES = (0.0065, 0.0235)
"""Standard deviation of the noise over that of the output without effects; with `_UNEQUAL` 0.5 to 3 %."""

_UNEQUAL = 0.2
"""Largest logarithm of the factor by which the noise of an output differs."""

MOST_LOUDER = 2.0
"""Largest standard deviation of an output over that without the effect."""

MOST_ALIKE = 0.5
"""Largest correlation of two inputs that count as independent."""

SHARE_IN_TURN = 0.2
"""Share of the records in which one input moves at a time."""

SPARE_DELAY = 4
"""Samples of delay of a linear model that must not reproduce a lag or a mode."""

MOST_REPRODUCED = 0.7
"""Share of its gap that such a model may explain."""

TWO_LEVELS_SUFFICE = (
    *("input-delay", "input-off", "extra-lag", "resonance", "output-dropout", "output-outliers", "output-drift"),
    *("load-step", "periodic-disturbance"),
)
"""Effects that inputs of two levels show."""

NONE_KINDS = ("plain", "coloured", "part of a sample", "not exercised", "fine converter")


@dataclass(frozen=True, slots=True, eq=False)
class CoupledExperiment:
    """A rig without effects and its inputs.

    Attributes
    ----------
    plain : CoupledSetup
    v : ndarray, shape (N, nu)
    spread : ndarray, shape (ny,)
        Standard deviation of each output, times a factor by which their noises differ.
    in_turn : bool
        Whether one input moves at a time.
    """

    plain: CoupledSetup
    v: FloatArray
    spread: FloatArray
    in_turn: bool


def draw_signals(
    rng: np.random.Generator, i: int, name: str, row: str, between: tuple[float, float]
) -> OrdinaryCase | None:
    """One effect at one signal, or at one place in the dynamics.

    Parameters
    ----------
    rng : Generator
    i : int
        Number of the case, which determines the effect.
    name, row : str
    between : tuple of float
        Least and largest error of the best linear model over the noise.

    Returns
    -------
    OrdinaryCase or None
    """
    effect = EFFECTS[i % len(EFFECTS)]
    kinds = ("levels", "multisine") if effect == "input-rate-limit" else RICH_INPUTS
    kinds = (*kinds, "two-level") if effect in TWO_LEVELS_SUFFICE else kinds
    experiment = _draw_experiment(rng, str(rng.choice(rigs_with(effect))), kinds)
    if experiment is None:
        return None
    placed = draw_placed_effect(rng, effect, coupled_context(experiment.plain, experiment.v))

    def gap_at(s: float, thorough: bool) -> float:
        return float(np.max(linear_gaps(experiment, placed.apply(experiment.plain, s), thorough)))

    strength = find_strength(gap_at, 1.0, log_uniform(rng, *between), NOISE_SHARES, rng)
    if strength is None:
        return None
    setup, sigma = placed.apply(experiment.plain, strength[0]), strength[1] * experiment.spread
    clean = _clean(setup, experiment.v)
    if np.any(np.std(clean, axis=0) > MOST_LOUDER * np.std(_clean(experiment.plain, experiment.v), axis=0)):
        return None
    states = plant_states(setup, experiment.v)[::STEPS_PER_SAMPLE]
    if not is_exercised(effect, setup, experiment.v, states, clean):
        return None
    if effect in ("extra-lag", "resonance") and _is_delay(experiment, setup):
        return None
    return _complete(rng, experiment, setup, sigma, draw_noise_colour(rng), name, row, placed)


def draw_signals_none(rng: np.random.Generator, i: int, name: str) -> OrdinaryCase | None:
    """No effect, one that the record does not exercise, or less than a sample of delay."""
    kind = NONE_KINDS[i % len(NONE_KINDS)]
    experiment = _draw_experiment(rng, RIGS[i % len(RIGS)], (*RICH_INPUTS, "two-level"))
    if experiment is None:
        return None
    plain = experiment.plain
    sigma = log_uniform(rng, *NOISE_SHARES) * experiment.spread
    setup = plain
    if kind == "part of a sample":
        at = int(rng.integers(len(plain.inputs)))
        late = replace(plain.actuators[at], delay=float(rng.integers(1, 8)) / STEPS_PER_SAMPLE)
        setup = replace(plain, actuators=(*plain.actuators[:at], late, *plain.actuators[at + 1 :]))
    elif kind == "fine converter":
        setup = replace(
            plain,
            sensors=tuple(
                replace(sensor, step=0.3 * float(sd)) for sensor, sd in zip(plain.sensors, sigma, strict=True)
            ),
        )
    elif kind == "not exercised":
        setup = _with_limit_beyond(rng, experiment)
    spare = 1 if kind == "part of a sample" else 0
    if np.any(_scaled_gaps(experiment, setup, delay=spare) > NEGLIGIBLE_RATIO * sigma / experiment.spread):
        return None
    colour = draw_mild_colour(rng) if kind == "coloured" else draw_noise_colour(rng)
    return _complete(rng, experiment, setup, sigma, colour, name, "signals-none", None, {"case": kind})


def draw_signals_clear(rng: np.random.Generator, i: int, name: str) -> OrdinaryCase | None:
    """One clear effect at one of several signals, or at one place in the dynamics."""
    return draw_signals(rng, i, name, "signals", CLEAR_RATIOS)


def draw_signals_hard(rng: np.random.Generator, i: int, name: str) -> OrdinaryCase | None:
    """One hard effect at one of several signals, or at one place in the dynamics."""
    return draw_signals(rng, i, name, "signals-hard", HARD_RATIOS)


def linear_gaps(experiment: CoupledExperiment, setup: CoupledSetup, thorough: bool = True) -> FloatArray:
    """Rms error of the best linear model of each output, without noise, over the spread of the output.

    Parameters
    ----------
    experiment : CoupledExperiment
    setup : CoupledSetup
        Rig to use instead of the one without effects.
    thorough : bool
        Whether the fit starts from several initial values.

    Returns
    -------
    ndarray, shape (ny,)
    """
    return _scaled_gaps(experiment, setup, thorough=thorough)


def signal_files(
    header: Sequence[str], t: FloatArray, columns: Sequence[FloatArray], options: tuple[str, ...]
) -> dict[str, str]:
    """The record as a table, and the words of the command line that it needs.

    Parameters
    ----------
    header : sequence of str
        Names of the columns after the time.
    t : ndarray, shape (N,)
    columns : sequence of ndarray, each of shape (N,)
    options : tuple of str

    Returns
    -------
    dict
        Text by the ending of the file's name.
    """
    files = {".csv": table_text(",".join(["t", *header]), "%.8g", t, *columns)}
    return files | ({".options": " ".join(options) + "\n"} if options else {})


def _draw_experiment(rng: np.random.Generator, rig: str, kinds: tuple[str, ...]) -> CoupledExperiment | None:
    """A rig that starts at rest or in the steady state of its first inputs, with names of its own or u1, u2, ..."""
    samples = int(rng.integers(FEWEST_SAMPLES, MOST_SAMPLES + 1))
    plain = draw_coupled_rig(rng, samples, rig)
    if rng.random() < 0.5:
        inputs = tuple(f"u{i + 1}" for i in range(len(plain.inputs)))
        plain = replace(plain, inputs=inputs, outputs=tuple(f"y{j + 1}" for j in range(len(plain.outputs))))
    in_turn = bool(rng.random() < SHARE_IN_TURN)
    time = coupled_time_scale(plain.plant)
    v = draw_inputs(rng, kinds, len(plain.inputs), samples, time, in_turn)
    if np.any(np.ptp(v, axis=0) < 0.5) or abs(np.asarray(np.corrcoef(v.T))[0, 1]) > MOST_ALIKE:
        return None
    spread = np.std(_clean(plain, v), axis=0) * np.exp(rng.uniform(-_UNEQUAL, _UNEQUAL, len(plain.outputs)))
    return CoupledExperiment(plain, v, spread, in_turn)


def _clean(setup: CoupledSetup, v: FloatArray) -> FloatArray:
    return simulate_coupled(setup, v, [Noise(0.0)] * len(setup.outputs)).clean


def _scaled_gaps(
    experiment: CoupledExperiment, setup: CoupledSetup, delay: int = 0, thorough: bool = True
) -> FloatArray:
    y = _clean(setup, experiment.v) / experiment.spread
    start = discrete_poles(coupled_poles(experiment.plain.plant))
    return np.array([linear_error(experiment.v, one, start, delay, thorough) for one in y.T])


def _is_delay(experiment: CoupledExperiment, setup: CoupledSetup) -> bool:
    """Whether numerator coefficients for a short delay reproduce most of the gap."""
    with_delay = np.max(_scaled_gaps(experiment, setup, SPARE_DELAY))
    return bool(with_delay < (1 - MOST_REPRODUCED) * np.max(linear_gaps(experiment, setup)))


def _with_limit_beyond(rng: np.random.Generator, experiment: CoupledExperiment) -> CoupledSetup:
    """With a limit of an actuator or a sensor that no signal reaches."""
    plain, away = experiment.plain, float(rng.uniform(1.05, 1.5))
    if rng.random() < 0.5:
        i = int(rng.integers(len(plain.inputs)))
        actuator = replace(plain.actuators[i], high=away * float(experiment.v[:, i].max()) + 0.01)
        return replace(plain, actuators=(*plain.actuators[:i], actuator, *plain.actuators[i + 1 :]))
    j = int(rng.integers(len(plain.outputs)))
    y = _clean(plain, experiment.v)[:, j]
    sensor = replace(plain.sensors[j], high=float(y.max() + 0.2 * away * np.ptp(y)))
    return replace(plain, sensors=(*plain.sensors[:j], sensor, *plain.sensors[j + 1 :]))


def _complete(
    rng: np.random.Generator,
    experiment: CoupledExperiment,
    setup: CoupledSetup,
    sigma: FloatArray,
    colour: tuple[float, float],
    name: str,
    row: str,
    placed: PlacedEffect | None,
    also: dict[str, Any] | None = None,
) -> OrdinaryCase:
    noises = [Noise(float(sd), *colour, int(rng.integers(2**31))) for sd in sigma]
    units = draw_units(rng, len(setup.inputs), len(setup.outputs))
    run = simulate_coupled(setup, experiment.v, noises)
    u, y = units.u(run.v), units.y(run.y)
    gaps = linear_gaps(experiment, setup) * experiment.spread / sigma
    changes = np.sqrt(np.mean((run.clean - _clean(experiment.plain, experiment.v)) ** 2, axis=0)) / sigma
    changes = np.where(changes > 1e-6, changes, 0.0)
    by_output = dict(zip(setup.outputs, changes.tolist(), strict=True))
    options: tuple[str, ...] = ()
    if setup.inputs[0] != "u1":
        options = ("--inputs", ",".join(setup.inputs), "--outputs", ",".join(setup.outputs))
    header = (*setup.inputs, *setup.outputs)
    t = units.Ts * np.arange(u.shape[0], dtype=np.float64)
    effects = [] if placed is None else [placed_label(placed, setup, units, by_output)]
    truth = {
        "effects": effects,
        "ratio": float(np.max(gaps)),
        "ratios": dict(zip(setup.outputs, gaps.tolist(), strict=True)),
        "noise": {output: abs(ys) * float(sd) for output, ys, sd in zip(setup.outputs, units.ys, sigma, strict=True)},
        "inputs": list(setup.inputs),
        "outputs": list(setup.outputs),
        "samples": u.shape[0],
        "Ts": units.Ts,
        "in_turn": experiment.in_turn,
        **(also or {}),
    }
    made = OrdinaryRecord(
        answers=(tuple(effect["name"] for effect in effects),),
        files=signal_files(header, t, [*u.T, *y.T], options),
        truth=truth,
        options=options,
    )
    return OrdinaryCase(name=name, row=row, kind=setup.rig, made=made)
