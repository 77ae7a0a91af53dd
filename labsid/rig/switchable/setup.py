"""Description of a rig: plant, actuator, load and sensor with their unmodelled effects, which are off by default."""

from dataclasses import dataclass, field
from math import inf
from typing import NamedTuple

import numpy as np

from labsid._arrays import FloatArray
from labsid.rig.switchable._motion import NO_MODE, Motion

STEPS_PER_SAMPLE = 16
"""Integration steps per sample; every delay and every onset is a whole number of steps."""


class Profile(NamedTuple):
    """Slow change along a record: the kind of curve, its shape parameter and a seed."""

    kind: str = "ramp"
    number: float = 1.0
    seed: int = 0


STRAIGHT = Profile()


@dataclass(frozen=True, slots=True)
class Actuator:
    """Path from the command to the plant; levels are deviations from the operating point.

    Attributes
    ----------
    delay : float
        Transport delay in samples.
    delay_swing, delay_period : float
        Amplitude and period of a sinusoidal variation of the delay, in samples.
    low, high : float
        Limits.
    dead_low, dead_high : float
        Ends of the dead zone.
    dead_jump : float
        Share of the dead zone by which the output jumps where the command leaves it.
    rounding : float
        Corner radius of limits and dead zone.
    backlash : float
        Width of the backlash.
    slew : float
        Largest change per sample.
    c2, c3 : float
        Static curve ``v + c2 v^2 + c3 v^3``.
    relays : tuple of (float, float, float)
        Relays with hysteresis in parallel to the direct path: lower threshold, upper threshold and height.
    failures : tuple of (int, int)
        Intervals of samples in which commands are ignored.
    stick_band : float
        Sticking valve: it jumps to the command when the difference exceeds this value.
    valve_spread, valve_hold, seed : float, float, int
        Unmeasured second valve in the same line: random gain factors of this spread about one, each held for about
        `valve_hold` samples.
    zero : float
        True zero of the input, about which a gain change acts.
    gain_change, gain_profile : float, Profile
        Relative change of the gain along the record.
    step : float
        Step in which the command acts.
    off_start, off_stop, off_level : float
        Interval in samples in which the command does not act, and the level that acts instead.
    """

    delay: float = 0.0
    delay_swing: float = 0.0
    delay_period: float = 100.0
    low: float = -inf
    high: float = inf
    dead_low: float = 0.0
    dead_high: float = 0.0
    dead_jump: float = 0.0
    rounding: float = 0.0
    backlash: float = 0.0
    slew: float = inf
    c2: float = 0.0
    c3: float = 0.0
    relays: tuple[tuple[float, float, float], ...] = ()
    failures: tuple[tuple[int, int], ...] = ()
    stick_band: float = 0.0
    valve_spread: float = 0.0
    valve_hold: float = 10.0
    seed: int = 0
    zero: float = 0.0
    gain_change: float = 0.0
    gain_profile: Profile = STRAIGHT
    step: float = 0.0
    off_start: float = inf
    off_stop: float = inf
    off_level: float = 0.0


@dataclass(frozen=True, slots=True)
class Load:
    """Unmeasured load on the plant, and change of the plant's slower pole.

    Attributes
    ----------
    onset : float
        Onset of the load in samples.
    size : float
        Additive load (torque, flow, heat).
    leak : float
        Load proportional to the level or the speed.
    rise : float
        Rise time of the load in samples.
    amplitude, frequency, phase : float
        Periodic load; frequency in cycles per sample.
    pole_change, pole_profile : float, Profile
        Relative change of the slower pole along the record.
    """

    onset: float = inf
    size: float = 0.0
    leak: float = 0.0
    rise: float = 0.0
    amplitude: float = 0.0
    frequency: float = 0.0
    phase: float = 0.0
    pole_change: float = 0.0
    pole_profile: Profile = STRAIGHT


@dataclass(frozen=True, slots=True)
class Sensor:
    """Path from the plant to the log; levels are deviations from the operating point.

    Attributes
    ----------
    c2, c3 : float
        Static curve ``y + c2 y^2 + c3 y^3``.
    fold : float
        Level from which the sensor shows the absolute value; minus infinity if it shows the sign.
    drift, drift_profile : float, Profile
        Drift of the zero.
    amplitude, frequency, phase : float
        Additive sinusoid; frequency in cycles per sample.
    low, high : float
        Saturation levels.
    rounding : float
        Corner radius of the saturation.
    clips_noise : bool
        Whether the noise is added before the saturation.
    step : float
        Quantisation step of the converter.
    outlier_share, outlier_size : float
        Share of outliers among the samples, and their size.
    dropout_share, dropout_length : float
        Share of the samples in which the logger repeats the last value, and mean length of such an interval.
    colour, colour_time : float
        Standard deviation and correlation time (in samples) of the strongly coloured noise.
    seed : int
        Seed of outliers, dropouts and coloured noise.
    """

    c2: float = 0.0
    c3: float = 0.0
    fold: float = -inf
    drift: float = 0.0
    drift_profile: Profile = STRAIGHT
    amplitude: float = 0.0
    frequency: float = 0.0
    phase: float = 0.0
    low: float = -inf
    high: float = inf
    rounding: float = 0.0
    clips_noise: bool = True
    step: float = 0.0
    outlier_share: float = 0.0
    outlier_size: float = 0.0
    dropout_share: float = 0.0
    dropout_length: float = 10.0
    colour: float = 0.0
    colour_time: float = 10.0
    seed: int = 0


@dataclass(frozen=True, slots=True)
class Setup:
    """Description of one rig with its effects.

    Attributes
    ----------
    rig : str
        Name of the rig.
    motion : Motion
        The plant and the effects on its states.
    actuator : Actuator
    load : Load
    sensor : Sensor
    """

    rig: str
    motion: Motion
    actuator: Actuator = field(default_factory=Actuator)
    load: Load = field(default_factory=Load)
    sensor: Sensor = field(default_factory=Sensor)


def plain_motion(kind: int, T0: float, T1: float) -> Motion:
    """Parameters of the equations of motion without effects.

    Parameters
    ----------
    kind : int
        One of the kinds in `labsid.rig.switchable._motion`.
    T0, T1 : float
        The two time constants in samples; a mass on a spring has only T0, the inverse of its natural frequency.

    Returns
    -------
    Motion
    """
    return Motion(
        kind=kind,
        T0=T0,
        T1=T1,
        damping=0.0,
        coupling=1.0,
        loss=0.0,
        speed_zero=0.0,
        level_zero=0.0,
        actuator_lag=0.0,
        sensor_lag=0.0,
        sensor_fall_lag=0.0,
        mode=NO_MODE,
        mode_frequency=1.0,
        mode_damping=0.05,
        mode_share=0.0,
        outflow_curvature=0.0,
        brim_upper=inf,
        brim_lower=inf,
        spill_share=0.0,
        dry_friction=0.0,
        cubic=0.0,
        bilinear=0.0,
        fall_rate=1.0,
        switch_level=inf,
        switch_rate=1.0,
        drag=0.0,
        stop_low=-inf,
        stop_high=inf,
        restitution=0.0,
        slow_time=0.0,
        slow_share=0.0,
        play=0.0,
        play_start=0.0,
        friction_back=0.0,
        friction_peak=0.0,
        friction_speed=0.0,
    )


def profile_values(profile: Profile, x: FloatArray) -> FloatArray:
    """Values of a slow change at the instants `x`, which run from 0 to 1 along the record; their maximum is about one.

    Parameters
    ----------
    profile : Profile
        ``ramp``; ``settle``, an exponential with time constant `number`; ``half-sine``; ``sine`` with `number`
        cycles; ``wander``, a smoothed random walk.
    x : ndarray
        Instants.

    Returns
    -------
    ndarray
        Zero at 0, except for ``sine``, whose phase is random.

    Raises
    ------
    ValueError
        If there is no such curve.
    """
    if profile.kind == "ramp":
        return x.copy()
    if profile.kind == "settle":
        return (1 - np.exp(-x / profile.number)) / (1 - np.exp(-1 / profile.number))
    if profile.kind == "half-sine":
        return np.sin(np.pi * x)
    if profile.kind == "sine":
        phase = np.random.default_rng(profile.seed).uniform(0, 2 * np.pi)
        return np.sin(2 * np.pi * profile.number * x + phase)
    if profile.kind == "wander":
        knots = np.linspace(0, 1, 400)
        rng = np.random.default_rng(profile.seed)
        walk = np.cumsum(rng.standard_normal(knots.size))
        width = 24  # standard deviation of the smoothing Gaussian in knots: 6 % of the record
        window = np.exp(-0.5 * (np.arange(-3 * width, 3 * width + 1) / width) ** 2)
        smooth = np.convolve(np.pad(walk, 3 * width, mode="edge"), window / window.sum(), mode="valid")
        smooth = smooth - smooth[0]
        return np.interp(x, knots, smooth / np.max(np.abs(smooth)))
    raise ValueError(
        f"profile must be ramp, settle, half-sine, sine or wander; got {profile.kind!r}. Name one of these."
    )
