"""Simulation of a rig: actuator, plant with load, sensor, noise, converter and logger."""

from dataclasses import dataclass

import numpy as np
from scipy.signal import lfilter

from labsid._arrays import FloatArray, as_signal, freeze
from labsid.rig.switchable._motion import MASS, MOTOR_POSITION, STATE_COUNT, Motion, move
from labsid.rig.switchable.actuator import actuator_output, limited
from labsid.rig.switchable.setup import STEPS_PER_SAMPLE, Load, Sensor, Setup, profile_values


class UnboundedOutputError(ValueError):
    """The simulated output diverges: an effect is too strong for the input."""


@dataclass(frozen=True, slots=True)
class Noise:
    """Sensor noise: the sum of white noise and AR(1) noise.

    Attributes
    ----------
    sd : float
        Standard deviation of the sum.
    share : float
        Share of the AR(1) part in the variance.
    colour : float
        Pole of the AR(1) part.
    seed : int
    """

    sd: float
    share: float = 0.0
    colour: float = 0.0
    seed: int = 0


@dataclass(frozen=True, slots=True, eq=False)
class SimulatedRun:
    """Signals of one run, as deviations from the operating point.

    Attributes
    ----------
    v : ndarray, shape (N,)
        Commanded input.
    clean : ndarray, shape (N,)
        Logged output without sensor noise, with every effect.
    y : ndarray, shape (N,)
        Logged output.
    dropouts : tuple of (int, int)
        Intervals of samples in which the logger repeats the last value.
    """

    v: FloatArray
    clean: FloatArray
    y: FloatArray
    dropouts: tuple[tuple[int, int], ...]

    def __post_init__(self) -> None:
        freeze(self, v=self.v, clean=self.clean, y=self.y)


def simulate_setup(setup: Setup, v: FloatArray, noise: Noise, start: tuple[float, float] = (0.0, 0.0)) -> SimulatedRun:
    """Simulate a rig and log its output.

    Parameters
    ----------
    setup : Setup
    v : array_like, shape (N,)
        Commanded input in rig units, held over each sample.
    noise : Noise
    start : tuple of float
        Initial values of the plant's two states, as deviations; (0, 0) is rest.

    Returns
    -------
    SimulatedRun

    Raises
    ------
    ValueError
        If `v` is not a finite signal.
    UnboundedOutputError
        If the output diverges.
    """
    v = as_signal("v", v)
    shown = plant_output(setup, v, start)
    dropouts = dropout_intervals(setup.sensor, v.size)
    clean = logged_output(setup.sensor, shown, np.zeros(v.size), dropouts)
    y = logged_output(setup.sensor, shown, noise_samples(noise, v.size), dropouts)
    return SimulatedRun(v=v, clean=clean, y=y, dropouts=dropouts)


def plant_output(setup: Setup, v: FloatArray, start: tuple[float, float] = (0.0, 0.0)) -> FloatArray:
    """Simulate the plant's output at the start of each sample, before the effects of the sensor.

    Parameters
    ----------
    setup : Setup
    v : ndarray, shape (N,)
    start : tuple of float
        Initial values of the plant's two states.

    Returns
    -------
    ndarray, shape (N,)

    Raises
    ------
    ValueError
        If the rig has end stops where there is no position, or beside dry friction.
    UnboundedOutputError
        If the output diverges.
    """
    m = setup.motion
    if (m.stop_low, m.stop_high) != (-np.inf, np.inf) and (m.kind not in (MASS, MOTOR_POSITION) or m.dry_friction):
        raise ValueError(
            f"end stops need a position without dry friction; got a {setup.rig} with friction {m.dry_friction:g}. "
            "Leave one of the two effects out."
        )
    begin, end = actuator_output(setup.actuator, v)
    x0 = np.zeros(STATE_COUNT)
    x0[:2] = start
    x0[2] = x0[4] = x0[6] = begin[0]
    x0[3] = x0[0 if setup.motion.kind == MASS else 1]
    load, rate, leak = load_signals(setup.load, v.size)
    y = move(setup.motion, x0, begin, end, load, rate, leak, STEPS_PER_SAMPLE)
    if not np.all(np.abs(y) < 1e6):
        raise UnboundedOutputError(
            f"the {setup.rig} must stay bounded; its output diverges on this input. Reduce the effect."
        )
    return y


def poles(motion: Motion) -> FloatArray:
    """Poles of the linearised plant without effects, in continuous time with a sample as the unit.

    Parameters
    ----------
    motion : Motion

    Returns
    -------
    ndarray of complex, shape (2,)
    """
    m = motion
    if m.kind == MASS:
        return np.roots([m.T0**2, 2 * m.damping * m.T0, 1.0]).astype(complex)
    slope = 1.0
    if m.kind in (4, 5):
        A = np.array(
            [
                [-(m.coupling + m.loss) / m.T0, m.coupling / m.T0],
                [m.coupling / m.T1, -(m.coupling + 1 - m.loss) / m.T1],
            ]
        )
        return np.linalg.eigvals(A).astype(complex)
    return np.array([-slope / m.T0, -slope / m.T1], dtype=complex)


def noise_samples(noise: Noise, samples: int) -> FloatArray:
    """Generate sensor noise.

    Parameters
    ----------
    noise : Noise
    samples : int

    Returns
    -------
    ndarray, shape (samples,)
    """
    rng = np.random.default_rng(noise.seed)
    white = rng.standard_normal(samples)
    coloured = _ar1(rng, samples, noise.colour)
    return noise.sd * (np.sqrt(1 - noise.share) * white + np.sqrt(noise.share) * coloured)


def dropout_intervals(sensor: Sensor, samples: int) -> tuple[tuple[int, int], ...]:
    """Intervals of samples in which the logger repeats the last value, in order and separate from each other.

    Parameters
    ----------
    sensor : Sensor
    samples : int

    Returns
    -------
    tuple of (int, int)
        Zero-based, half-open.
    """
    if sensor.dropout_share == 0.0:
        return ()
    rng = np.random.default_rng([sensor.seed, 1])
    count = max(2, round(sensor.dropout_share * samples / sensor.dropout_length))
    room = samples / count
    stretches = []
    for i in range(count):
        length = int(np.clip(rng.uniform(0.6, 1.4) * sensor.dropout_share * room, 3, room - 3))
        start = int(i * room + rng.uniform(1, room - length - 1))
        stretches.append((max(start, 1), start + length))
    return tuple(stretches)


def _ar1(rng: np.random.Generator, samples: int, pole: float) -> FloatArray:
    """Stationary AR(1) noise of unit variance."""
    e = rng.standard_normal(samples + 1)
    y, _ = lfilter([np.sqrt(1 - pole**2)], [1, -pole], e[1:], zi=[pole * e[0]])
    return np.asarray(y)


def load_signals(load: Load, samples: int) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Signals of a load at every integration step.

    Parameters
    ----------
    load : Load
    samples : int

    Returns
    -------
    tuple of ndarray, each of shape (N * STEPS,)
        Additive load, factor of the slower pole, and load per unit of level or speed.
    """
    steps = samples * STEPS_PER_SAMPLE
    k = np.arange(steps) / STEPS_PER_SAMPLE
    on = np.zeros(steps)
    if np.isfinite(load.onset):
        on = np.clip((k - load.onset) / load.rise, 0, 1) if load.rise > 0 else (k >= load.onset).astype(float)
    force = load.size * on + load.amplitude * np.sin(2 * np.pi * load.frequency * k + load.phase)
    rate = np.ones(steps)
    if load.pole_change:
        rate = (1 + load.pole_change) ** profile_values(load.pole_profile, k / samples)
    return force, rate, load.leak * on


def logged_output(
    sensor: Sensor, shown: FloatArray, noise: FloatArray, dropouts: tuple[tuple[int, int], ...]
) -> FloatArray:
    """Logged values of a plant output: sensor, noise, converter and logger.

    Parameters
    ----------
    sensor : Sensor
    shown : ndarray, shape (N,)
        Plant output at the sampling instants.
    noise : ndarray, shape (N,)
    dropouts : tuple of (int, int)
        From `dropout_intervals`.

    Returns
    -------
    ndarray, shape (N,)
    """
    y = shown
    if sensor.c2 or sensor.c3:
        y = y + sensor.c2 * y**2 + sensor.c3 * y**3
    if np.isfinite(sensor.fold):
        y = sensor.fold + np.abs(y - sensor.fold)
    n = y.size
    k = np.arange(n)
    if sensor.drift:
        y = y + sensor.drift * profile_values(sensor.drift_profile, k / n)
    if sensor.amplitude:
        y = y + sensor.amplitude * np.sin(2 * np.pi * sensor.frequency * k + sensor.phase)
    rng = np.random.default_rng([sensor.seed, 0])
    if sensor.colour:
        y = y + sensor.colour * _ar1(rng, n, float(np.exp(-1 / sensor.colour_time)))
    y = y + noise if sensor.clips_noise else y
    y = limited(y, sensor.low, sensor.high, sensor.rounding)
    y = y if sensor.clips_noise else y + noise
    if sensor.step:
        y = sensor.step * np.rint(y / sensor.step)
    if sensor.outlier_share:
        y = y + _outliers(sensor, n)
    y = np.array(y)
    for start, stop in dropouts:
        y[start:stop] = y[start - 1]
    return y


def _outliers(sensor: Sensor, samples: int) -> FloatArray:
    rng = np.random.default_rng([sensor.seed, 3])
    count = max(3, round(sensor.outlier_share * samples))
    places = rng.choice(np.arange(2, samples), size=count, replace=False)
    y = np.zeros(samples)
    y[places] = sensor.outlier_size * rng.uniform(0.6, 1.4, count) * rng.choice([-1.0, 1.0], count)
    return y
