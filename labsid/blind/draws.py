"""Random draws shared by the rows: experiments without effects, complete cases and kinds of noise."""

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.signal import lfilter

from labsid.blind.experiment import Case, Experiment, input_signal, run_experiment, to_record
from labsid.blind.strength import CLEAR_RATIOS, clean_output, linear_model_gap, with_noise
from labsid.rig.switchable._motion import MASS
from labsid.rig.switchable.effects import supports_effect
from labsid.rig.switchable.plants import RIGS, draw_rig, draw_scales, time_scale
from labsid.rig.switchable.setup import Setup
from labsid.rig.switchable.simulation import Noise
from labsid.rig.switchable.truth import true_parameters

LIMITS = ("input-saturation", "output-saturation", "end-stop")
"""Effects whose label holds only the limits that the record reaches."""


def draw_experiment(
    rng: np.random.Generator, effect: str, samples: int, inputs: tuple[str, ...], rigs: tuple[str, ...] = RIGS
) -> Experiment:
    """Draw a rig without effects, its units and its input.

    Parameters
    ----------
    rng : Generator
    effect : str
        Effect of the table that the rig must support; empty for any rig.
    samples : int
    inputs : tuple of str
        Kinds of input to draw from.
    rigs : tuple of str
        Rigs to draw from.

    Returns
    -------
    Experiment
    """
    if effect:
        rigs = tuple(rig for rig in rigs if supports_effect(example_rig(rig), effect))
    plain = draw_rig(rng, samples, rigs)
    from_rest = bool(rng.random() < 0.75)
    start = (0.0, 0.0) if from_rest else (float(rng.uniform(-0.4, 0.4)), float(rng.uniform(-0.4, 0.4)))
    if plain.motion.kind == MASS:
        start = (start[0], 0.0)
    return Experiment(
        setup=plain,
        plain=plain,
        scales=draw_scales(rng),
        noise=Noise(0.0),
        input=str(rng.choice(inputs)),
        input_seed=int(rng.integers(2**31)),
        samples=samples,
        time=time_scale(plain),
        from_rest=from_rest,
        start=start,
    )


def example_rig(rig: str) -> Setup:
    """A rig of the given kind, to test which effects it supports."""
    return draw_rig(np.random.default_rng(0), 1500, (rig,))


def complete_case(
    rng: np.random.Generator,
    experiment: Experiment,
    setup: Setup,
    sigma: float,
    name: str,
    row: str,
    labels: tuple[str, ...],
    noise: tuple[float, float],
    truth: dict[str, Any] | None = None,
) -> Case:
    """Add the noise, run the experiment and attach the label.

    Parameters
    ----------
    rng : Generator
    experiment : Experiment
    setup : Setup
        The rig with its effects.
    sigma : float
        Standard deviation of the noise in rig units.
    name, row : str
    labels : tuple of str
    noise : tuple of float
        Share of the coloured part in the variance, and its pole.
    truth : dict, optional
        True parameters; by default those of the labels.

    Returns
    -------
    Case
    """
    share, colour = noise
    made = with_noise(experiment, setup, Noise(sigma, share, colour, int(rng.integers(2**31))))
    ratio = linear_model_gap(experiment, setup) / sigma
    if truth is None:
        truth = {e: true_parameters(e, setup, experiment.scales, experiment.samples) for e in labels}
        truth |= {e: _reached(e, truth[e], experiment, setup) for e in labels if e in LIMITS}
    strength = "faint" if row == "faint" else "clear" if ratio >= CLEAR_RATIOS[0] else "hard"
    return Case(
        record=to_record(run_experiment(made), experiment.scales, name),
        name=name,
        row=row,
        labels=labels,
        truth=truth,
        sigma=sigma * abs(experiment.scales.ys),
        level=strength if labels else "none",
        ratio=float(ratio),
        experiment=made,
    )


def on_stops(experiment: Experiment, setup: Setup) -> NDArray[np.bool_]:
    """Samples in which a motion rests on its low and on its high stop, with shape (2, N)."""
    y, motion = clean_output(experiment, setup), setup.motion
    return np.array([y <= motion.stop_low, y >= motion.stop_high])


def _reached(effect: str, ends: dict[str, float], experiment: Experiment, setup: Setup) -> dict[str, float]:
    """The limits that are active in at least 1 % of the samples."""
    scales = experiment.scales
    if effect == "end-stop":
        beyond = dict(zip(("low", "high"), on_stops(experiment, setup)[:: 1 if scales.ys > 0 else -1], strict=True))
    else:
        if effect == "input-saturation":
            x = scales.u0 + scales.us * input_signal(experiment)
        else:
            free = replace(setup, sensor=replace(setup.sensor, low=-np.inf, high=np.inf))
            x = scales.y0 + scales.ys * clean_output(experiment, free)
        beyond = {"low": x < ends.get("low", -np.inf), "high": x > ends.get("high", np.inf)}
    return {name: level for name, level in ends.items() if np.mean(beyond[name]) >= 0.01}


def with_unexercised_effect(rng: np.random.Generator, experiment: Experiment, effect: str) -> Setup:
    """Add an effect outside the range of the record, so the record does not exercise it."""
    v, y = input_signal(experiment), clean_output(experiment, experiment.plain)
    setup, away = experiment.plain, float(rng.uniform(1.05, 1.5))
    match effect:
        case "input-saturation":
            return replace(setup, actuator=replace(setup.actuator, high=away * float(v.max()) + 0.01))
        case "input-backlash":
            return replace(setup, actuator=replace(setup.actuator, backlash=float(rng.uniform(0.05, 0.3))))
        case "output-saturation":
            return replace(setup, sensor=replace(setup.sensor, high=float(y.max() + 0.2 * away * np.ptp(y))))
        case "end-stop":
            low, high = away * min(float(y.min()), 0.0) - 0.01, away * max(float(y.max()), 0.0) + 0.01
            return replace(setup, motion=setup.motion._replace(stop_low=low, stop_high=high))
        case "overflow":
            level = float(y.max() + 0.1 * away * np.ptp(y))
            return replace(setup, motion=setup.motion._replace(brim_lower=level))
        case _:
            speed = -1.2 * float(np.min(y)) + 0.3
            return replace(setup, motion=setup.motion._replace(dry_friction=0.1, speed_zero=speed))


def distance_from_rig(sim: dict[str, Any], experiment: Experiment) -> float:
    """Rms difference between a simulation from rest and the rig without effects, in rig units."""
    at_rest = replace(experiment, start=(0.0, 0.0))
    gain = experiment.scales.us / experiment.scales.ys
    run = lfilter(np.array(sim["num"]) * gain, sim["den"], input_signal(experiment))
    return float(np.sqrt(np.mean((run - clean_output(at_rest, experiment.plain)) ** 2)))


def merge_effects(plain: Setup, one: Setup, two: Setup) -> Setup:
    """Combine two effects: apply every field that either of them changed."""
    motion = plain.motion._replace(
        **{k: v for part in (one, two) for k, v in part.motion._asdict().items() if v != getattr(plain.motion, k)}
    )
    parts = {}
    for name in ("actuator", "load", "sensor"):
        old = getattr(plain, name)
        changed = {
            field: getattr(getattr(part, name), field)
            for part in (one, two)
            for field in old.__dataclass_fields__
            if getattr(getattr(part, name), field) != getattr(old, field)
        }
        parts[name] = replace(old, **changed)
    return replace(plain, motion=motion, **parts)


def log_uniform(rng: np.random.Generator, low: float, high: float) -> float:
    """Draw a number between `low` and `high` with a uniform logarithm."""
    return float(np.exp(rng.uniform(np.log(low), np.log(high))))


def draw_noise_colour(rng: np.random.Generator) -> tuple[float, float]:
    """White or mildly coloured noise, as variance share and pole of the AR(1) part."""
    return (0.0, 0.0) if rng.random() < 0.65 else draw_mild_colour(rng)


def draw_mild_colour(rng: np.random.Generator) -> tuple[float, float]:
    """AR(1) noise with a pole of at most 0.7, so the innovations have at least 0.7 of its standard deviation."""
    return 1.0, float(rng.uniform(0.2, 0.7))


def draw_partial_colour(rng: np.random.Generator) -> tuple[float, float]:
    """White noise with a slower AR(1) part of 20 to 50 % of the variance."""
    return float(rng.uniform(0.2, 0.5)), float(rng.uniform(0.4, 0.8))
