"""A model of a measured rig, identified from one of its records, and records that are made with it."""

from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import least_squares
from scipy.signal import lfilter

from labsid._arrays import FloatArray
from labsid.lab.offset import find_offsets
from labsid.records.record import Record
from labsid.records.signal_quality import lattice_step
from labsid.rig.lab.instruments import AVERAGED, gaussian_samples, noise_reduced
from labsid.rig.lab.log import LabLog
from labsid.rig.lab.plan import staircase
from labsid.rig.seeds import student_entropy, uniform_samples

_DAMPING = 0.4, 1.0, 2.5
_PERIODS, _LONGEST_DELAY = 8, 10
_SPREAD = {"gain": 0.08, "period": 0.15, "rest": 0.05}
"""Largest relative deviation of a student's rig from the measured one; of the rest, as a share of the range of y."""
_SMALLEST_STEP = 0.9
"""Smallest size of the steps in a student's record, as a share of those in the record of the rig."""
_LEVELS = 2 / 3, 0.0, 1.0, 2 / 3, 0.0, 1.0
"""Levels of the lab's input as shares of its range."""
_REST, _HOLD = 51, 200
"""Shortest first and other holds of the lab's input, in samples."""
_SETTLED = 5.0
"""Time constants that a level is held."""
_JITTERS, _LARGEST_JITTER = 8, 0.05
"""Draws for the times of the steps, and the largest change of a hold as a share of it."""
_SAME_REST, _DRAWS = 0.004, 20
"""Largest difference of means over parts of the rest, as a share of the range of y, and draws of the noise."""


@dataclass(frozen=True, slots=True)
class RigModel:
    """A rig of second order with a delay, about a point at rest, and its sensor.

    ``G(s) = gain e^(-delay s) / (period^2 s^2 + 2 damping period s + 1)``.

    Attributes
    ----------
    gain : float
        Unit of y over unit of u.
    period : float
        Inverse of the natural frequency, in seconds.
    damping : float
        Damping ratio; above 1 the two modes do not oscillate.
    delay : int
        In samples.
    u_rest, y_rest : float
        Levels at rest.
    y_start : float
        Output at sample 0; `y_rest` if the record begins at rest.
    noise, correlation : float
        Standard deviation of the sensor noise, and its correlation from one sample to the next.
    lattice : float
        Distance of the values that the sensor can show; 0 if they are not on a lattice.
    Ts : float
        Sampling time in seconds.
    """

    gain: float
    period: float
    damping: float
    delay: int
    u_rest: float
    y_rest: float
    y_start: float
    noise: float
    correlation: float
    lattice: float
    Ts: float

    @property
    def time_constant(self) -> float:
        """Of the slowest mode, in seconds."""
        slowest = self.damping - np.sqrt(max(self.damping**2 - 1, 0.0))
        return float(self.period / slowest)

    def settled_at(self, u: float) -> "RigModel":
        """The rig at rest at another level of the input."""
        y = self.y_rest + self.gain * (u - self.u_rest)
        return replace(self, u_rest=u, y_rest=y, y_start=y)

    def respond(self, u: FloatArray) -> FloatArray:
        """The output without noise, for an input that starts at rest; shape (N,)."""
        return self.y_rest + self.gain * _unit_run(self.period, self.damping, self.delay, self.Ts, u - self.u_rest)


def identify_rig(record: Record) -> RigModel:
    """Identify the model from the whole record: the free run that is nearest to the measured output.

    Parameters
    ----------
    record : Record
        With one input and one output.

    Returns
    -------
    RigModel

    Raises
    ------
    ValueError
        If the input never changes, or the output follows no such model.
    """
    measured = record.y if record.y_measured is None else record.y_measured
    offsets = find_offsets(record.u, measured)
    first, n = offsets.settled
    u, y = (record.u - offsets.u_offset)[first:], (measured - offsets.y_offset)[first:]

    def errors(parameters: FloatArray, delay: int) -> FloatArray:
        period, damping = np.exp(parameters)
        run = _unit_run(period, damping, delay, record.Ts, u)
        return y - float(run @ y) / max(float(run @ run), 1e-300) * run

    longest = record.Ts * y.size / 2
    low, high = np.log((0.3 * record.Ts, 0.05)), np.log((longest, 20.0))
    starts = [(T, zeta) for T in np.geomspace(record.Ts, longest / 2, _PERIODS) for zeta in _DAMPING]
    fits = []
    for delay in range(max(2, min(_LONGEST_DELAY, y.size // 20))):
        costs = [float(np.sum(errors(np.log(start), delay) ** 2)) for start in starts]
        start = np.clip(np.log(starts[int(np.argmin(costs))]), low, high)
        fits.append((least_squares(errors, start, bounds=(low, high), args=(delay,)), delay))
    best, delay = min(fits, key=lambda fit: float(fit[0].cost))
    period, damping = (float(value) for value in np.exp(best.x))
    run = _unit_run(period, damping, delay, record.Ts, u)
    rest = measured[first:n] - offsets.y_offset
    model = RigModel(
        float(run @ y / (run @ run)),
        period,
        damping,
        delay,
        offsets.u_offset,
        offsets.y_offset,
        offsets.y_offset if first == 0 else float(measured[0]),
        *_noise(rest, measured),
        lattice_step(measured) or 0.0,
        record.Ts,
    )
    if best.cost > 0.25 * np.sum(y**2) / 2 or model.time_constant > longest:
        raise ValueError(
            f"no model of second order follows {record.name or 'the record'}: with the best one, "
            f"{2 * best.cost / np.sum(y**2):.0%} of the square of the output is left, and its time constant is "
            f"{model.time_constant:.3g} s. Record steps that are held until the output settles."
        )
    return model


def _unit_run(period: float, damping: float, delay: int, Ts: float, u: FloatArray) -> FloatArray:
    """Response of the model of gain 1 to a deviation from rest, held from sample to sample."""
    root = np.emath.sqrt(damping**2 - 1 or 1e-9)
    one, two = (-damping + root) / period, (-damping - root) / period

    def step(t: float) -> float:
        return float(np.real(1 + (two * np.exp(one * t) - one * np.exp(two * t)) / (one - two)))

    z = np.exp(np.array([one, two]) * Ts)
    a1, a2 = float(np.real(-z.sum())), float(np.real(z.prod()))
    b1 = step(Ts)
    run: FloatArray = lfilter([0.0] * delay + [0.0, b1, step(2 * Ts) + (a1 - 1) * b1], [1.0, a1, a2], u)
    return run


def _noise(rest: FloatArray, measured: FloatArray) -> tuple[float, float]:
    """Standard deviation and correlation of the noise: from the rest, or from second differences if that is short."""
    if rest.size < 20:
        return float(np.std(np.diff(measured, 2)) / np.sqrt(6)), 0.0
    square = float(rest @ rest)
    return float(np.std(rest)), float(np.clip(rest[1:] @ rest[:-1] / square, 0.0, 0.95)) if square else 0.0


def make_rig_log(
    model: RigModel, u: FloatArray, seed: np.random.SeedSequence, name: str, units: tuple[str, str]
) -> LabLog:
    """Log one run of a rig: measured output with noise of its kind, and its mean over five samples.

    Parameters
    ----------
    model : RigModel
    u : ndarray, shape (N,)
        Input.
    seed : SeedSequence
        Of the noise.
    name : str
        Name of the record.
    units : tuple of str
        Units of input and output.
    """
    before = AVERAGED - 1
    earlier = model.settled_at(model.u_rest + (model.y_start - model.y_rest) / model.gain)
    clean = earlier.respond(np.concatenate([np.full(before, earlier.u_rest), u]))
    white = gaussian_samples(seed, clean.size)
    coloured = lfilter([np.sqrt(1 - model.correlation**2)], [1.0, -model.correlation], white)
    measured = clean + model.noise * coloured
    if model.lattice:
        measured = model.lattice * np.rint(measured / model.lattice)
    t: FloatArray = model.Ts * np.arange(u.size, dtype=np.float64)
    return LabLog(t, u, measured[before:], noise_reduced(measured[before:], measured[:before]), model.Ts, name, units)


def lab_input(model: RigModel, record: Record) -> FloatArray:
    """The lab's staircase for a rig: levels in the range of its record, held until the output settles."""
    low, span = float(record.u.min()), float(np.ptp(record.u))
    hold = max(_HOLD, int(np.ceil(_SETTLED * model.time_constant / model.Ts)) + model.delay)
    rest = max(_REST, hold // 4)
    starts = (0, *(rest + k * hold for k in range(len(_LEVELS) - 1)))
    levels = tuple(float(f"{low + share * span:.3g}") for share in _LEVELS)
    return staircase(levels, starts, starts[-1] + rest)


def make_student_log(model: RigModel, log: LabLog, student: str, secret: bytes) -> LabLog:
    """Make one student's record: a rig of other gain, speed and rest, and an input with other steps and times.

    Parameters
    ----------
    model : RigModel
        Identified from `log`.
    log : LabLog
        The record that all students share, whose input is varied.
    student : str
        The student's ID, as for `labsid.rig.seeds.student_entropy`.
    secret : bytes
        The course's secret, at least 16 bytes.

    Raises
    ------
    ValueError
        If the ID or the secret is invalid.
    """
    entropy = student_entropy(student, secret, "rig")
    plan, *noises = [np.random.SeedSequence(entropy=entropy, spawn_key=(stream,)) for stream in range(1 + _DRAWS)]
    gain, period, rest, size, *times = (2 * uniform_samples(plan, 4 + _JITTERS) - 1).tolist()
    own = replace(
        model,
        gain=model.gain * (1 + _SPREAD["gain"] * gain),
        period=model.period * (1 + _SPREAD["period"] * period),
    )
    moved = _SPREAD["rest"] * rest * float(np.ptp(log.y_measured))
    own = replace(own, y_rest=own.y_rest + moved, y_start=own.y_start + moved)
    smaller = _SMALLEST_STEP + (1 - _SMALLEST_STEP) * (size + 1) / 2
    varied = _with_other_times(log.u[0] + smaller * (log.u - log.u[0]), times)
    made = (make_rig_log(own, varied, noise, log.name, log.units) for noise in noises)
    return next(one for k, one in enumerate(made, 1) if k == _DRAWS or rests_alike(one, log))


def rests_alike(made: LabLog, other: LabLog | Record) -> bool:
    """Whether a log begins as another one does, at rest or with a start-up, and shows the level of its rest.

    Slow noise moves the mean of a part of the rest; every right choice of that part must give the same offset.
    """
    begun = find_offsets(made.u, made.y_noise_reduced)
    own = find_offsets(other.u, other.y if isinstance(other, Record) else other.y_noise_reduced)
    n, y = begun.first_period, made.y_noise_reduced
    parts = [y[n - n // 3 : n]] if begun.settled[0] else [y[: n // 2], y[n // 2 : n], y[n - n // 3 : n]]
    within = _SAME_REST * float(np.ptp(y))
    return (begun.settled[0] > 0) == (own.settled[0] > 0) and all(
        abs(float(np.mean(part)) - begun.y_offset) <= within for part in parts
    )


def _with_other_times(u: FloatArray, draws: list[float]) -> FloatArray:
    """The same levels with other holds; the number of samples stays, so the last hold takes the difference."""
    starts = np.concatenate([[0], np.flatnonzero(np.diff(u)) + 1])
    holds = np.diff([*starts, u.size])
    jitter = np.array([int(_LARGEST_JITTER * hold * draws[k % len(draws)]) for k, hold in enumerate(holds)])
    jitter[-1] = 0
    surplus = int(jitter.sum())
    jitter[-1] = -surplus if surplus < holds[-1] else 0
    others = holds + jitter
    return np.repeat(u[starts], others)[: u.size] if others.sum() >= u.size else u
