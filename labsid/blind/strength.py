"""Strength of an effect at which the error of the best linear model is a given multiple of the noise."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from labsid._arrays import FloatArray
from labsid.blind.experiment import Experiment, input_signal
from labsid.blind.output_error import discrete_poles, fit_linear
from labsid.rig.switchable.effects import ApplyEffect
from labsid.rig.switchable.setup import Setup
from labsid.rig.switchable.simulation import Noise, poles, simulate_setup

WEAKEST_NOISE, STRONGEST_NOISE = 0.005, 0.05
CLEAR_RATIOS, HARD_RATIOS = (5.2, 25.0), (1.55, 4.9)
NEGLIGIBLE_RATIO = 0.1
FAINT_RATIOS = (NEGLIGIBLE_RATIO, HARD_RATIOS[0])


def clean_output(experiment: Experiment, setup: Setup) -> FloatArray:
    """Noise-free logged output in rig units.

    Parameters
    ----------
    experiment : Experiment
    setup : Setup
        Rig to use instead of the experiment's own.

    Returns
    -------
    ndarray, shape (N,)
    """
    return simulate_setup(setup, input_signal(experiment), Noise(0.0), experiment.start).clean


def linear_model_gap(experiment: Experiment, setup: Setup, taps: int = 2, thorough: bool = True) -> float:
    """Rms error of the best second-order linear model on the noise-free output, in rig units.

    Parameters
    ----------
    experiment : Experiment
    setup : Setup
        Rig to use instead of the experiment's own.
    taps : int
        Numerator coefficients: 2, or 3 to allow for a fractional delay.
    thorough : bool
        Whether the fit starts from several initial values.

    Returns
    -------
    float
    """
    start = discrete_poles(poles(experiment.plain.motion))
    return fit_linear(input_signal(experiment), clean_output(experiment, setup), start, None, taps, thorough).rmse


def output_spread(experiment: Experiment) -> float:
    """Standard deviation of the output without effects.

    Parameters
    ----------
    experiment : Experiment

    Returns
    -------
    float
    """
    return float(np.std(clean_output(experiment, experiment.plain)))


def scale_to_ratio(
    experiment: Experiment,
    apply: ApplyEffect,
    ratio: float,
    sigma_share: tuple[float, float],
    rng: np.random.Generator,
) -> tuple[Setup, float] | None:
    """Choose the strength of an effect and the noise so that the gap is `ratio` times the noise.

    Parameters
    ----------
    experiment : Experiment
    apply : callable
        The effect.
    ratio : float
    sigma_share : tuple of float
        Smallest and largest noise, relative to the output's standard deviation.
    rng : Generator

    Returns
    -------
    tuple of Setup and float, or None
        The rig with the effect, and the standard deviation of the noise in rig units; None if the effect cannot
        reach the ratio on this rig and input.
    """

    def gap_at(s: float, thorough: bool) -> float:
        return linear_model_gap(experiment, apply(experiment.plain, s), thorough=thorough)

    strength = find_strength(gap_at, output_spread(experiment), ratio, sigma_share, rng)
    return None if strength is None else (apply(experiment.plain, strength[0]), strength[1])


def find_strength(
    gap_at: Callable[[float, bool], float],
    spread: float,
    ratio: float,
    sigma_share: tuple[float, float],
    rng: np.random.Generator,
) -> tuple[float, float] | None:
    """Strength of an effect, and noise, for which the gap is `ratio` times the noise.

    Parameters
    ----------
    gap_at : callable
        ``gap_at(strength, thorough)``, the error of the best linear model; infinite where the output diverges.
    spread : float
        Standard deviation of the output without effects.
    ratio : float
    sigma_share : tuple of float
        Smallest and largest noise over `spread`.
    rng : Generator

    Returns
    -------
    tuple of float, or None
        Strength and standard deviation of the noise; None if the effect cannot reach the ratio.
    """
    low, high = sigma_share
    strongest = gap_at(1.0, False) / (ratio * spread)
    if strongest < low:
        return None
    wanted = ratio * spread * float(np.exp(rng.uniform(np.log(low), np.log(min(high, strongest)))))
    bracket, size = [0.0, 1.0], strongest * ratio * spread
    if size <= 1.15 * wanted:
        return _checked(gap_at, 1.0, ratio, sigma_share, spread)
    s = float(np.clip(wanted / size, 0.02, 0.95))
    for _ in range(10):
        size = gap_at(s, False)
        if abs(size / wanted - 1) < 0.2:
            return _checked(gap_at, s, ratio, sigma_share, spread)
        if size < wanted:
            bracket[0] = s
        else:
            bracket[1] = s
        guess = s * wanted / size if size > 0 else bracket[1]
        inside = bracket[0] < guess < bracket[1]
        s = guess if inside else 0.5 * (bracket[0] + bracket[1])
    return None


def _checked(
    gap_at: Callable[[float, bool], float], s: float, ratio: float, sigma_share: tuple[float, float], spread: float
) -> tuple[float, float] | None:
    """Noise for the exact ratio by a thorough fit; None if it is outside `sigma_share`."""
    sigma = gap_at(s, True) / ratio
    return (s, sigma) if 0.9 * sigma_share[0] <= sigma / spread <= 1.1 * sigma_share[1] else None


def with_noise(experiment: Experiment, setup: Setup, noise: Noise) -> Experiment:
    """Replace the rig and the noise of an experiment.

    Parameters
    ----------
    experiment : Experiment
    setup : Setup
    noise : Noise

    Returns
    -------
    Experiment
    """
    return replace(experiment, setup=setup, noise=noise)
