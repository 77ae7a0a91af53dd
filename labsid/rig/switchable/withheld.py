"""Individual two-tank rigs with one withheld effect, for the assignment ``sim-to-real-gap``.

Rig, effect, input and noise are derived from HMAC-SHA256(secret, ID). Without the course's secret the effect can only
be found from the record.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from math import inf
from statistics import NormalDist

import numpy as np

from labsid._arrays import FloatArray
from labsid.records.record import Record
from labsid.rig.seeds import student_entropy, uniform_samples
from labsid.rig.switchable._motion import TWO_TANKS
from labsid.rig.switchable.actuator import limited
from labsid.rig.switchable.plants import Scales
from labsid.rig.switchable.setup import Actuator, Sensor, Setup, plain_motion
from labsid.rig.switchable.simulation import Noise, plant_output, simulate_setup
from labsid.rig.switchable.truth import true_parameters
from labsid.rig.switchable.withheld_effects import EFFECT_PARAMETERS, EFFECT_PATHS, RECORD_FILE

TS = 0.75
SAMPLES = 1600
AT_REST = 120
"""Samples at the rest level at the start of every record."""

SENSOR_NOISE = 0.007
"""Standard deviation of the level sensor's noise (V)."""

_RIG, _RECORD_INPUT, _RECORD_NOISE, _TRIAL_INPUT = range(4)
_PURPOSE = "sim-to-real-gap"
_STRATA = 8
_SHORTEST_HOLD, _LONGEST_HOLD = 14, 52


@dataclass(frozen=True, slots=True)
class WithheldRig:
    """A rig with the facts that are withheld from the student.

    Attributes
    ----------
    effect, path : str
        Name of the effect, and the part of the loop in which it acts.
    parameters : dict
        Parameters of the effect, named as in `labsid.rig.switchable.withheld_effects`.
    setup : Setup
        The rig with the effect.
    scales : Scales
        Conversion from rig units to volts and seconds.
    entropy : int
        Seed of inputs and noise.
    """

    effect: str
    path: str
    parameters: Mapping[str, float]
    setup: Setup
    scales: Scales
    entropy: int


def withheld_rig(student: str, secret: bytes) -> WithheldRig:
    """Make one student's rig.

    Parameters
    ----------
    student : str
        The student's ID as the course writes it.
    secret : bytes
        The course's secret, at least 16 bytes.

    Returns
    -------
    WithheldRig

    Raises
    ------
    ValueError
        If the ID or the secret is invalid.
    """
    entropy = student_entropy(student, secret, _PURPOSE)
    which, T0, T1, u0, us, y0, ys, *draws = uniform_samples(_stream(entropy, _RIG), 10).tolist()
    scales = Scales(
        Ts=TS,
        u0=round(2.2 + 0.4 * u0, 1),
        us=round(0.8 + 0.2 * us, 1),
        y0=2.4 + 0.4 * y0,
        ys=1.3 + 0.4 * ys,
    )
    plain = Setup("two tanks", plain_motion(TWO_TANKS, 4.0 + 4.0 * T0, 14.0 + 10.0 * T1))
    effect = list(EFFECT_PATHS)[int(which * len(EFFECT_PATHS))]
    setup = _with_effect(effect, plain, _command(entropy, _RECORD_INPUT, scales), draws)
    return WithheldRig(effect, EFFECT_PATHS[effect], _parameters(effect, setup, scales), setup, scales, entropy)


def withheld_record(rig: WithheldRig, noise: float = SENSOR_NOISE) -> Record:
    """Make the record that the student receives; it begins at rest.

    Parameters
    ----------
    rig : WithheldRig
    noise : float
        Standard deviation of the level sensor's noise (V).

    Returns
    -------
    Record
        1600 samples at 0.75 s, with the output rounded to 0.1 mV.
    """
    quantile = NormalDist().inv_cdf
    white = [quantile(p) for p in uniform_samples(_stream(rig.entropy, _RECORD_NOISE), SAMPLES).tolist()]
    v = _command(rig.entropy, _RECORD_INPUT, rig.scales)
    u, y = _logged(rig, v, noise * np.array(white))
    t: FloatArray = TS * np.arange(SAMPLES, dtype=np.float64)
    return Record(t=t, u=u, y=np.round(y, 4), Ts=TS, name=RECORD_FILE.removesuffix(".csv"))


def withheld_validation_data(rig: WithheldRig) -> tuple[FloatArray, FloatArray]:
    """Simulate a second run of the same rig, on which a student's simulation is graded.

    Parameters
    ----------
    rig : WithheldRig

    Returns
    -------
    tuple of ndarray, each of shape (1600,)
        Input and noise-free output (V), from rest.
    """
    v = _command(rig.entropy, _TRIAL_INPUT, rig.scales)
    return _logged(rig, v, np.zeros(v.size))


def withheld_record_bytes(student: str, secret: bytes) -> bytes:
    """Encode the student's record as delimited text with the columns t, u and y.

    Parameters
    ----------
    student : str
    secret : bytes
        As for `withheld_rig`.

    Returns
    -------
    bytes

    Raises
    ------
    ValueError
        As for `withheld_rig`.
    """
    return csv_bytes(withheld_record(withheld_rig(student, secret)))


def csv_bytes(record: Record) -> bytes:
    """Encode a record of a withheld rig as delimited text with the columns t, u and y."""
    rows = (f"{t:.2f},{u:.2f},{y:.4f}" for t, u, y in zip(record.t, record.u, record.y, strict=True))
    return "\n".join(["t,u,y", *rows, ""]).encode()


def _with_effect(effect: str, plain: Setup, v: FloatArray, draws: list[float]) -> Setup:
    """Add one effect to the plain rig, clearly visible above the noise for an input like `v`."""
    first, second, third = draws
    sign = 1.0 if third < 0.5 else -1.0
    shown = plant_output(plain, v)
    match effect:
        case "input-delay":
            return replace(plain, actuator=Actuator(delay=float(12 + int(7 * first))))
        case "input-saturation":
            return replace(plain, actuator=Actuator(low=-0.35 - 0.25 * first, high=0.35 + 0.25 * second))
        case "input-dead-zone":
            return replace(plain, actuator=Actuator(dead_low=-0.25 - 0.25 * first, dead_high=0.25 + 0.25 * second))
        case "input-nonlinearity":
            return replace(plain, actuator=Actuator(c2=sign * (0.25 + 0.15 * first)))
        case "sqrt-outflow":
            return replace(plain, motion=plain.motion._replace(outflow_curvature=0.75 + 0.15 * first))
        case "overflow":
            return replace(plain, motion=plain.motion._replace(brim_lower=(0.3 + 0.25 * first) * float(shown.max())))
        case "output-saturation":
            low, high = float(shown.min()), float(shown.max())
            return replace(plain, sensor=Sensor(low=(0.35 + 0.25 * first) * low, high=(0.35 + 0.25 * second) * high))
    return replace(plain, sensor=Sensor(c2=sign * (0.22 + 0.1 * first)))


def _parameters(effect: str, setup: Setup, scales: Scales) -> dict[str, float]:
    truth = true_parameters(effect, setup, scales, SAMPLES)
    if effect == "sqrt-outflow":
        truth["empty"] = truth["zero"]
    return {name: float(truth[name]) for name in EFFECT_PARAMETERS[effect]}


def _logged(rig: WithheldRig, v: FloatArray, noise: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Logged input and output; the sensor saturates after its noise."""
    sensor = rig.setup.sensor
    unclipped = replace(rig.setup, sensor=replace(sensor, low=-inf, high=inf))
    s = rig.scales
    x = simulate_setup(unclipped, v, Noise(0.0)).clean + noise / s.ys
    return np.round(s.u0 + s.us * v, 2), s.y0 + s.ys * limited(x, sensor.low, sensor.high, 0.0)


def _command(entropy: int, stream: int, scales: Scales) -> FloatArray:
    """Input that starts at rest and then steps through random levels, one in each eighth of the range per round."""
    moving = SAMPLES - AT_REST
    rounds = moving // (_STRATA * _SHORTEST_HOLD) + 1
    draws = uniform_samples(_stream(entropy, stream), 3 * _STRATA * rounds).reshape(3, rounds, _STRATA)
    strata = np.argsort(draws[0], axis=1)
    levels = (-1.0 + 2.0 * (strata + draws[1]) / _STRATA).reshape(-1)
    holds = (_SHORTEST_HOLD + draws[2] * (_LONGEST_HOLD - _SHORTEST_HOLD)).astype(int).reshape(-1)
    volts = np.concatenate([np.zeros(AT_REST), np.round(scales.us * np.repeat(levels, holds), 2)])[:SAMPLES]
    return volts / scales.us


def _stream(entropy: int, stream: int) -> np.random.SeedSequence:
    return np.random.SeedSequence(entropy=entropy, spawn_key=(stream,))
