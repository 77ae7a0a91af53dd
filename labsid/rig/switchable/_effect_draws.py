"""Random draws of the effects that the diagnosis names, for a rig and an input: one function per effect.

Each draw returns ``apply(setup, strength) -> setup``. Strength 0 changes nothing and strength 1 is the strongest that
occurs in a laboratory; the drawn parameters do not depend on the strength.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from scipy.signal import lfilter

from labsid._arrays import FloatArray
from labsid.rig.switchable._motion import (
    HEATED_FAR,
    HEATED_NEAR,
    MASS,
    MOTOR_SPEED,
    PARALLEL_MODE,
    SERIES_MODE,
    TWO_TANKS,
)
from labsid.rig.switchable.setup import STEPS_PER_SAMPLE, Profile, Setup
from labsid.rig.switchable.simulation import poles

SLOW_NOISE_SHARE = 0.3  # of the slowest time constant of the rig: faster noise is that of a sensor, and no effect

ApplyEffect = Callable[[Setup, float], Setup]


@dataclass(frozen=True, slots=True, eq=False)
class EffectContext:
    """Information for drawing an effect: the rig without effects, the input and the resulting output.

    Attributes
    ----------
    setup : Setup
    v : ndarray, shape (N,)
        Command.
    y : ndarray, shape (N,)
        Output of the rig without effects.
    time : float
        Time scale of the rig in samples.
    rounding : float
        Corner radius of limits and dead zones, relative to the range.
    """

    setup: Setup
    v: FloatArray
    y: FloatArray
    time: float
    rounding: float = 0.0


def _in(part: str, **fields: Callable[[float], Any]) -> ApplyEffect:
    """Effect that sets fields of one part of the setup, each a function of the strength."""

    def apply(setup: Setup, s: float) -> Setup:
        if s == 0.0:
            return setup
        values = {name: value(s) for name, value in fields.items()}
        old = getattr(setup, part)
        new = old._replace(**values) if part == "motion" else replace(old, **values)
        return replace(setup, **{part: new})

    return apply


def _fixed(value: Any) -> Callable[[float], Any]:
    return lambda s: value


def _times(value: float) -> Callable[[float], float]:
    return lambda s: float(s * value)


def _delay(rng: np.random.Generator, at: EffectContext) -> ApplyEffect:
    most = float(rng.uniform(0.6, 1.2) * min(30.0, 1.2 * at.time))

    def apply(setup: Setup, s: float) -> Setup:
        delay = setup.actuator.delay + round(s * most * STEPS_PER_SAMPLE) / STEPS_PER_SAMPLE
        return replace(setup, actuator=replace(setup.actuator, delay=delay))

    return apply


def _limits(rng: np.random.Generator, low: float, high: float) -> dict[str, Callable[[float], Any]]:
    """One or both limits, which move inwards from `low` and `high` as the strength grows."""
    sides = rng.choice(["low", "high", "both"])
    middle, half = 0.5 * (low + high), 0.5 * (high - low)
    reach = rng.uniform(0.6, 1.0, 2)
    fields: dict[str, Callable[[float], Any]] = {}
    if sides != "high":
        fields["low"] = lambda s: middle - half * (1 - 0.85 * s * reach[0])
    if sides != "low":
        fields["high"] = lambda s: middle + half * (1 - 0.85 * s * reach[1])
    return fields


def _input_saturation(rng: np.random.Generator, at: EffectContext) -> ApplyEffect:
    corner = at.rounding * np.ptp(at.v)
    return _in("actuator", rounding=_fixed(corner), **_limits(rng, at.v.min(), at.v.max()))


def _dead_zone(rng: np.random.Generator, at: EffectContext) -> ApplyEffect:
    low, high = rng.uniform(0.35, 0.75, 2)
    corner = at.rounding * np.ptp(at.v)
    return _in("actuator", dead_low=_times(-low), dead_high=_times(high), rounding=_times(corner))


def _backlash(rng: np.random.Generator, at: EffectContext) -> ApplyEffect:
    return _in("actuator", backlash=_times(0.6 * np.ptp(at.v)))


def _rate_limit(rng: np.random.Generator, at: EffectContext) -> ApplyEffect:
    longest = rng.uniform(0.7, 1.3) * min(2.0 * at.time, 80.0)
    return _in("actuator", slew=lambda s: float(np.ptp(at.v) / (s * longest)))


def _curve(rng: np.random.Generator, x: FloatArray) -> dict[str, Callable[[float], Any]]:
    """A quadratic term, a cubic term or both, monotone over the range of x."""
    most = float(np.max(np.abs(x)))
    share = {"quadratic": 1.0, "cubic": 0.0, "both": float(rng.uniform(0.3, 0.7))}[
        str(rng.choice(["quadratic", "cubic", "both"]))
    ]
    bend = rng.choice([-1.0, 1.0], 2)
    return {
        "c2": _times(bend[0] * 0.45 * share / most),
        "c3": _times((1.5 if bend[1] > 0 else -0.3) * (1 - share) / most**2),
    }


def _input_nonlinearity(rng: np.random.Generator, at: EffectContext) -> ApplyEffect:
    return _in("actuator", **_curve(rng, at.v))


def _output_nonlinearity(rng: np.random.Generator, at: EffectContext) -> ApplyEffect:
    return _in("sensor", **_curve(rng, at.y))


def _extra_lag(rng: np.random.Generator, at: EffectContext) -> ApplyEffect:
    place = str(rng.choice(["actuator_lag", "sensor_lag"]))
    return _in("motion", **{place: _times(float(min(1.2 * at.time, 40.0)))})


def _resonance(rng: np.random.Generator, at: EffectContext) -> ApplyEffect:
    damping = float(np.exp(rng.uniform(np.log(0.01), np.log(0.08))))
    if rng.random() < 0.6:
        period = rng.uniform(4.0, max(min(1.5 * at.time, 40.0), 6.0))
        return _in(
            "motion",
            mode=_fixed(PARALLEL_MODE),
            mode_frequency=_fixed(float(2 * np.pi / period)),
            mode_damping=_fixed(damping),
            mode_share=_times(0.8 * float(rng.choice([-1.0, 1.0]))),
        )
    longest = max(min(2.0 * at.time, 45.0), 6.0)
    return _in(
        "motion",
        mode=_fixed(SERIES_MODE),
        mode_frequency=lambda s: float(2 * np.pi / (3.0 + s * (longest - 3.0))),
        mode_damping=_fixed(damping),
    )


def _sqrt_outflow(rng: np.random.Generator, at: EffectContext) -> ApplyEffect:
    return _in("motion", outflow_curvature=_times(0.95 / max(-float(at.y.min()), 0.2)))


def _overflow(rng: np.random.Generator, at: EffectContext) -> ApplyEffect:
    upper = at.setup.motion.kind == TWO_TANKS and rng.random() < 0.5
    level = at.y
    if upper:
        pole = np.exp(-1 / at.setup.motion.T0)
        level = lfilter([0, 1 - pole], [1, -pole], at.v)
    top = float(level.max())
    spill_share = float(rng.choice([0.0, 0.0, rng.uniform(0.2, 0.8)]))
    brim = {"brim_upper" if upper else "brim_lower": lambda s: top * (1 - 0.8 * s)}
    return _in("motion", spill_share=_fixed(spill_share if upper else 0.0), **brim)


def _coulomb(rng: np.random.Generator, at: EffectContext) -> ApplyEffect:
    return _in("motion", dry_friction=_times(0.6 * float(np.std(at.v)) + 0.2))


def _cubic(rng: np.random.Generator, at: EffectContext) -> ApplyEffect:
    hardening = rng.random() < 0.7
    return _in("motion", cubic=_times((3.0 if hardening else -0.12) / float(np.max(np.abs(at.y))) ** 2))


def _parameter_drift(rng: np.random.Generator, at: EffectContext) -> ApplyEffect:
    profile = Profile(str(rng.choice(["ramp", "settle", "half-sine"])), float(rng.uniform(0.15, 0.4)))
    sign = float(rng.choice([-1.0, 1.0]))
    if rng.random() < 0.6:
        return _in("actuator", gain_change=_times(0.6 * sign), gain_profile=_fixed(profile))
    return _in("load", pole_change=lambda s: float(3.0 ** (sign * s) - 1), pole_profile=_fixed(profile))


def _output_drift(rng: np.random.Generator, at: EffectContext) -> ApplyEffect:
    kind = str(rng.choice(["ramp", "settle", "sine", "wander"]))
    number = float(rng.uniform(0.15, 0.4) if kind == "settle" else rng.uniform(0.6, 1.6))
    profile = Profile(kind, number, int(rng.integers(2**31)))
    size = float(rng.choice([-1.0, 1.0]) * 0.8 * np.ptp(at.y))
    return _in("sensor", drift=_times(size), drift_profile=_fixed(profile))


def _output_saturation(rng: np.random.Generator, at: EffectContext) -> ApplyEffect:
    corner = at.rounding * float(np.ptp(at.y))
    return _in(
        "sensor",
        rounding=_fixed(corner),
        clips_noise=_fixed(bool(rng.random() < 0.6)),
        **_limits(rng, float(at.y.min()), float(at.y.max())),
    )


def _quantization(rng: np.random.Generator, at: EffectContext) -> ApplyEffect:
    return _in("sensor", step=_times(float(np.ptp(at.y)) / 3))


def _outliers(rng: np.random.Generator, at: EffectContext) -> ApplyEffect:
    size = 2.5 * float(np.ptp(at.y))
    share = float(np.exp(rng.uniform(np.log(0.004), np.log(0.02))))
    return _in("sensor", outlier_share=_fixed(share), outlier_size=_times(size), seed=_fixed(int(rng.integers(2**31))))


def _dropout(rng: np.random.Generator, at: EffectContext) -> ApplyEffect:
    length = float(rng.uniform(0.3, 1.2) * max(at.time, 8.0))
    return _in(
        "sensor", dropout_share=_times(0.4), dropout_length=_fixed(length), seed=_fixed(int(rng.integers(2**31)))
    )


def _load_step(rng: np.random.Generator, at: EffectContext) -> ApplyEffect:
    onset = float(round(rng.uniform(0.2, 0.8) * at.v.size * STEPS_PER_SAMPLE) / STEPS_PER_SAMPLE)
    rise = at.rounding * 4 * at.time
    if rng.random() < 0.35:
        leak = _times(1.0 if at.setup.actuator.zero else 0.8)
        return _in("load", onset=_fixed(onset), leak=leak, rise=_fixed(rise))
    size = _times(float(rng.choice([-1.0, 1.0])))
    return _in("load", onset=_fixed(onset), size=size, rise=_fixed(rise))


def _periodic(rng: np.random.Generator, at: EffectContext) -> ApplyEffect:
    cycles = np.exp(rng.uniform(np.log(8.0), np.log(at.v.size / 8)))
    frequency, phase = float(cycles / at.v.size), float(rng.uniform(0, 2 * np.pi))
    at_load = rng.random() < 0.5
    size = 0.5 * float(np.ptp(at.y)) * (1.0 + 2 * np.pi * frequency * at.time if at_load else 1.0)
    part = "load" if at_load else "sensor"
    return _in(part, amplitude=_times(size), frequency=_fixed(frequency), phase=_fixed(phase))


def _coloured(rng: np.random.Generator, at: EffectContext) -> ApplyEffect:
    slowest = float(np.max(-1.0 / poles(at.setup.motion).real))
    least = max(6.0, SLOW_NOISE_SHARE * slowest)
    time = float(np.exp(rng.uniform(np.log(least), np.log(max(at.v.size / 40, 1.7 * least)))))
    size = 0.8 * float(np.std(at.y))
    return _in("sensor", colour=_times(size), colour_time=_fixed(time), seed=_fixed(int(rng.integers(2**31))))


DRAWS: dict[str, Callable[[np.random.Generator, EffectContext], ApplyEffect]] = {
    "input-delay": _delay,
    "input-saturation": _input_saturation,
    "input-dead-zone": _dead_zone,
    "input-backlash": _backlash,
    "input-rate-limit": _rate_limit,
    "input-nonlinearity": _input_nonlinearity,
    "extra-lag": _extra_lag,
    "resonance": _resonance,
    "sqrt-outflow": _sqrt_outflow,
    "overflow": _overflow,
    "coulomb-friction": _coulomb,
    "cubic-stiffness": _cubic,
    "parameter-drift": _parameter_drift,
    "output-drift": _output_drift,
    "output-saturation": _output_saturation,
    "output-nonlinearity": _output_nonlinearity,
    "output-quantization": _quantization,
    "output-outliers": _outliers,
    "output-dropout": _dropout,
    "load-step": _load_step,
    "periodic-disturbance": _periodic,
    "coloured-noise": _coloured,
}


def _end_stop(rng: np.random.Generator, at: EffectContext) -> ApplyEffect:
    """One or two stops, which move towards the rest position as the strength grows, and a nearly plastic impact."""
    sides = rng.choice(["low", "high", "both"], p=[0.25, 0.25, 0.5])
    reach_low, reach_high = (0.85 * rng.uniform(0.6, 1.0, 2)).tolist()
    margin = 0.1 * float(np.ptp(at.y))
    low, high = min(float(at.y.min()), -margin), max(float(at.y.max()), margin)
    restitution = float(rng.choice([0.0, rng.uniform(0.05, 0.25)], p=[0.7, 0.3]))
    stops: dict[str, Callable[[float], Any]] = {}
    if sides != "high":
        stops["stop_low"] = lambda s: low * (1 - s * reach_low)
    if sides != "low":
        stops["stop_high"] = lambda s: high * (1 - s * reach_high)
    return _in("motion", restitution=_fixed(restitution), **stops)


def _quadratic_drag(rng: np.random.Generator, at: EffectContext) -> ApplyEffect:
    """At strength 1 the drag at the highest speed takes 1.5 times the whole input range."""
    if at.setup.motion.kind == MOTOR_SPEED:
        fastest = float(np.max(np.abs(at.y + at.setup.motion.speed_zero)))
    else:
        fastest = float(np.max(np.abs(np.diff(at.y))))
    return _in("motion", drag=_times(1.5 / fastest**2))


def _slow_mode(rng: np.random.Generator, at: EffectContext) -> ApplyEffect:
    """A time constant of 6 to 30 times the rig's own, and at most a quarter of the record.

    Creep of a spring and a second heat store add to the output; the warming of a motor or the second volume of a tank
    may also take from it.
    """
    longest = min(30.0 * at.time, 0.25 * at.v.size)
    shortest = min(6.0 * at.time, longest)
    time = float(np.exp(rng.uniform(np.log(shortest), np.log(longest))))
    adds = at.setup.motion.kind in (MASS, HEATED_FAR, HEATED_NEAR)
    sign = 1.0 if adds else float(rng.choice([-1.0, 1.0]))
    return _in("motion", slow_time=_fixed(time), slow_share=_times(0.6 * sign))


def _output_backlash(rng: np.random.Generator, at: EffectContext) -> ApplyEffect:
    start = float(rng.choice([0.0, rng.uniform(-1.0, 1.0)]))
    return _in("motion", play=_times(0.6 * float(np.ptp(at.y))), play_start=_fixed(start))


FAMILY_DRAWS: dict[str, Callable[[np.random.Generator, EffectContext], ApplyEffect]] = {
    "end-stop": _end_stop,
    "quadratic-drag": _quadratic_drag,
    "slow-mode": _slow_mode,
    "output-backlash": _output_backlash,
}
"""The later effects of the table; they have rows of their own, because the cases of a row depend on its effects."""
