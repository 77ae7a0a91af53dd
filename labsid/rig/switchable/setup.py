"""What a rig is set up with: plant, actuator, load and sensor, each with its effects, all of them absent unless set."""

from dataclasses import dataclass, field
from math import inf
from typing import NamedTuple

import numpy as np

from labsid._arrays import FloatArray
from labsid.rig.switchable._motion import NO_MODE, Motion

STEPS_PER_SAMPLE = 16
"""Integration steps in a sample; every delay and every instant is a whole number of them."""


class Profile(NamedTuple):
    """How something changes slowly along a record: what kind of curve, its shape number, and a seed."""

    kind: str = "ramp"
    number: float = 1.0
    seed: int = 0


STRAIGHT = Profile()


@dataclass(frozen=True, slots=True)
class Actuator:
    """The path from the command to the plant; levels are deviations from the operating point.

    Attributes
    ----------
    delay : float
        Transport delay in samples.
    delay_swing, delay_period : float
        The delay also swings by so many samples, with this period in samples.
    low, high : float
        Limits.
    dead_low, dead_high : float
        Dead band.
    rounding : float
        Radius of the corners of limits and dead band.
    backlash : float
        Width of the backlash.
    slew : float
        Largest change in a sample.
    c2, c3 : float
        Static curve ``v + c2 v^2 + c3 v^3``.
    relays : tuple of (float, float, float)
        Relays with hysteresis in parallel to the straight path: lower and upper threshold, and height.
    failures : tuple of (int, int)
        Stretches of samples in which commands are ignored.
    stick_band : float
        A valve that sticks until the command is so far away, and then jumps to it.
    valve_spread, valve_hold, seed : float, float, int
        An unmeasured valve in the same line: random factors of this spread about one, each held about so many samples.
    zero : float
        Where the true zero of the input lies; a changing gain acts from there.
    gain_change, gain_profile : float, Course
        Relative change of the gain along the record.
    """

    delay: float = 0.0
    delay_swing: float = 0.0
    delay_period: float = 100.0
    low: float = -inf
    high: float = inf
    dead_low: float = 0.0
    dead_high: float = 0.0
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


@dataclass(frozen=True, slots=True)
class Load:
    """What acts on the plant unmeasured, and how the plant itself changes.

    Attributes
    ----------
    onset : float
        When the load begins, in samples.
    size : float
        Additive load (torque, flow, heat).
    leak : float
        Load that grows with the level or the speed.
    rise : float
        The load comes within so many samples.
    amplitude, frequency, phase : float
        A periodic load: its frequency in cycles a sample.
    pole_change, pole_profile : float, Course
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
    """The path from the plant to the log, in deviations from the operating point.

    Attributes
    ----------
    c2, c3 : float
        Static curve ``y + c2 y^2 + c3 y^3``.
    drift, drift_profile : float, Course
        Additive wander of the zero.
    amplitude, frequency, phase : float
        A sinusoid added at the sensor: its frequency in cycles a sample.
    low, high : float
        Where the sensor clips.
    rounding : float
        Radius of the corners.
    clips_noise : bool
        Whether the noise comes before the clipping: then the plateaus are flat.
    step : float
        Converter step.
    outlier_share, outlier_size : float
        Share of the samples that are outliers, and their size.
    dropout_share, dropout_length : float
        Share of the samples in which the log holds its last value, and the mean length of such a stretch.
    colour, colour_time : float
        Standard deviation and correlation time in samples of the strongly coloured noise.
    seed : int
        Seeds spikes, held stretches and coloured noise.
    """

    c2: float = 0.0
    c3: float = 0.0
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
    """One rig as it stands on the bench.

    Attributes
    ----------
    rig : str
        What it is, for people.
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
    """Equations of motion without any effect.

    Parameters
    ----------
    kind : int
        One of the kinds in `labsid.rig.switchable._motion`.
    T0, T1 : float
        Its two times in samples; a mass on a spring has T0 alone, one over its natural frequency.

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
    )


def profile_values(profile: Profile, x: FloatArray) -> FloatArray:
    """Values of a slow change at the instants `x`, which run from 0 to 1 along the record; of order one.

    Parameters
    ----------
    profile : Course
        ``ramp``; ``settle``, exponential with `number` the time constant; ``half-sine``; ``sine``, with `number`
        cycles; ``wander``, a smoothed random walk.
    x : ndarray
        Instants.

    Returns
    -------
    ndarray
        Zero at 0, except the sine's phase, which the seed draws.

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
        width = 24  # of the Gaussian that smooths, in knots: 6 % of the record
        window = np.exp(-0.5 * (np.arange(-3 * width, 3 * width + 1) / width) ** 2)
        smooth = np.convolve(np.pad(walk, 3 * width, mode="edge"), window / window.sum(), mode="valid")
        smooth = smooth - smooth[0]
        return np.interp(x, knots, smooth / np.max(np.abs(smooth)))
    raise ValueError(
        f"course must be ramp, settle, half-sine, sine or wander; got {profile.kind!r}. Name one of these."
    )
