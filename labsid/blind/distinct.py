"""Whether a record exercises an effect in a way that a linear model or another effect cannot reproduce."""

import numpy as np

from labsid.blind.draws import on_stops
from labsid.blind.experiment import Experiment, input_signal
from labsid.blind.output_error import discrete_poles, fit_linear
from labsid.blind.strength import clean_output, linear_model_gap
from labsid.rig.switchable._motion import LAGGED_TANK
from labsid.rig.switchable.setup import Setup, plain_motion
from labsid.rig.switchable.simulation import plant_output, poles

LEAST_TIME_ON_STOPS = 0.03
"""Share of the samples from which a record exercises an end stop."""

FEWEST_CROSSINGS, LEAST_TIME_MOVING = 6, 0.4
"""Crossings of the play, and share of the samples in which the sensor moves, from which a record exercises it."""

LEAST_SLOW_SHARE = 0.15
"""Share of the static gain from which a slow mode counts as one."""


def is_distinct(effect: str, experiment: Experiment, setup: Setup, sigma: float) -> bool:
    """Whether a linear model or another effect cannot reproduce most of the effect.

    A delay below one sample does not count, nor does a lag or a mode that such a delay reproduces; except in short
    records, neither does one that a longer delay reproduces. A dead zone that the input leaves on one side only is a
    limit. A slow mode has at least 0.15 of the static gain, and its time constant is at least 6 times the rig's own. A
    motion rests on its end stops in at least 3 % of the samples, and an overflow leaves more than the noise of that.
    The sensor moves in at least 40 % of the samples and crosses its play at least six times.

    Parameters
    ----------
    effect : str
    experiment : Experiment
    setup : Setup
        The rig with the effect.
    sigma : float
        Standard deviation of the noise in rig units.

    Returns
    -------
    bool
    """
    a, m = setup.actuator, setup.motion
    if effect == "end-stop":
        rests = float(np.mean(on_stops(experiment, setup).any(axis=0)))
        return rests >= LEAST_TIME_ON_STOPS and left_by_overflow(experiment, setup) > sigma
    if effect == "output-backlash":
        moves = np.sign(np.diff(clean_output(experiment, setup)))
        turns = np.count_nonzero(np.diff(moves[moves != 0]))
        return bool(turns >= FEWEST_CROSSINGS and np.mean(moves != 0) >= LEAST_TIME_MOVING)
    if effect == "slow-mode":
        return abs(m.slow_share) >= LEAST_SLOW_SHARE and m.slow_time >= 6.0 * experiment.time
    if effect == "input-dead-zone":
        v = input_signal(experiment)
        return bool(min(np.mean(v > a.dead_high), np.mean(v < a.dead_low)) > 0.08)
    if effect in ("extra-lag", "resonance"):
        gap = linear_model_gap(experiment, setup)
        if linear_model_gap(experiment, setup, taps=3) <= 0.5 * gap:
            return False
        return experiment.samples < 1000 or _left_by_delays(experiment, setup) > 0.3 * gap
    return effect != "input-delay" or a.delay >= 1.0


def left_by_overflow(experiment: Experiment, setup: Setup) -> float:
    """Rms difference of an overdamped motion with one stop from two lags whose second one overflows there.

    Parameters
    ----------
    experiment : Experiment
    setup : Setup
        The rig with the end stop.

    Returns
    -------
    float
        In rig units, with gain and offset fitted and the lags in the better order; infinite with two stops or an
        oscillating motion, which no overflow resembles.
    """
    m, times = setup.motion, -1 / poles(experiment.plain.motion)
    if np.any(times.imag) or (np.isfinite(m.stop_low) and np.isfinite(m.stop_high)):
        return np.inf
    sign = 1.0 if np.isfinite(m.stop_high) else -1.0
    v, y = sign * input_signal(experiment), sign * clean_output(experiment, setup)
    brim = m.stop_high if sign > 0 else -m.stop_low
    start = (float(y[0]), float(y[0]))
    residuals = []
    for first, second in (times.real, times.real[::-1]):
        tank = plain_motion(LAGGED_TANK, float(first), float(second))._replace(brim_lower=brim)
        basis = np.column_stack([plant_output(Setup("tank with a lag", tank), v, start), np.ones(y.size)])
        residuals.append(y - basis @ np.linalg.lstsq(basis, y)[0])
    return float(np.sqrt(np.mean(np.square(residuals), axis=1).min()))


def _left_by_delays(experiment: Experiment, setup: Setup) -> float:
    """Rms error of the best linear model with a delay of up to eight samples; a third tap adds the fraction."""
    v, y = input_signal(experiment), clean_output(experiment, setup)
    start = discrete_poles(poles(experiment.plain.motion))
    late = [np.concatenate([np.full(n, v[0]), v[:-n]]) for n in range(1, 8)]
    return min(fit_linear(u, y, start, taps=3, thorough=False).rmse for u in late)
