"""Another record of coupled tanks: other tanks, another rest level, other times and sizes of the steps."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from labsid._arrays import FloatArray, freeze
from labsid.lab.offset import find_offsets
from labsid.lab.step_response import FirstOrderDelay, cut_held_step, first_order_response, fit_step_response
from labsid.records.record import Record
from labsid.rig.lab.lab_record import log_run
from labsid.rig.lab.log import LabLog, lab_record_bytes
from labsid.rig.lab.plan import STAND_IN
from labsid.rig.lab.tanks import GRAVITY, TankParameters, pump_flow, steady_levels
from labsid.rig.seeds import uniform_samples

GAIN_APART = 0.12
"""Smallest relative difference of the gains: three times the tolerance of `K_tank` in ``step-6-model``."""

RESPONSE_APART = 0.09
"""Smallest root mean square difference of responses that differ in the time constant alone, as a share of the change:
three times the allowance of ``step-6-model``."""

LEVEL_APART = 0.03
"""Smallest difference of the output offsets as a share of the range of y: three times the tolerance of ``lab-1c``."""

SHORTEST_REST, FEWEST_APART = 25, 3  # samples
DRAWS = 40
_SETTLED = 4.5  # time constants that a step is held, so that its response settles
_JITTERED = 40  # samples; shorter holds stay as they are
_PLAN, _NOISE = 0, 1
_NUMBERS = 12


@dataclass(frozen=True, slots=True)
class ShownRig:
    """What a record shows of its rig: the rest, and the response to the first step."""

    u0: float
    y0: float
    model: FirstOrderDelay
    reading_gain: float
    amplitude: float
    held: float
    range: float
    noise: float
    n_first: int
    is_settled: bool


def make_other(own: Record, entropy: int) -> bytes:
    """Draw a record of other tanks in the place of `own`; see `labsid.checks.other_records.another_record`."""
    return draw_apart(own, entropy, _draw)


def draw_apart(
    own: Record, entropy: int, draw_log: Callable[[Record, ShownRig, np.random.SeedSequence], LabLog]
) -> bytes:
    """The first log that is drawn far enough from `own`, as a file; `ValueError` if there is none."""
    rig = _rig_of(own)
    problem = "no draw was far enough from it"
    for draw in range(DRAWS):
        seed = np.random.SeedSequence(entropy=entropy, spawn_key=(draw,))
        try:
            log = draw_log(own, rig, seed)
            if _is_apart(_rig_of_log(log), rig):
                return lab_record_bytes(log)
        except ValueError as error:
            problem = str(error)
    raise ValueError(f"no other record can be drawn in the place of {own.name or 'this one'}: {problem}")


def _rig_of(record: Record) -> ShownRig:
    measured = record.y if record.y_measured is None else record.y_measured
    return _read(record.u, record.y, measured, record.Ts)


def _rig_of_log(log: LabLog) -> ShownRig:
    return _read(log.u, log.y_noise_reduced, log.y_measured, log.Ts)


def _read(u: FloatArray, y: FloatArray, measured: FloatArray, Ts: float) -> ShownRig:
    offsets = find_offsets(u, y)
    first, n = offsets.settled
    t, step, amplitude = cut_held_step(u, y, Ts, 0, before=n - first)
    fit = fit_step_response(t, step, amplitude)
    return ShownRig(
        u0=offsets.u_offset,
        y0=offsets.y_offset,
        model=fit.model,
        reading_gain=fit.reading.K,
        amplitude=amplitude,
        held=float(t[-1]),
        range=float(np.ptp(y[first:])),
        noise=float(np.std(np.diff(measured, 2)) / np.sqrt(6)),  # white noise; the rig itself is smooth
        n_first=n,
        is_settled=first == 0,
    )


def _is_apart(other: ShownRig, own: ShownRig) -> bool:
    gains = [abs(own.model.K - K) / abs(K) for K in (other.model.K, other.reading_gain)]
    t = np.linspace(0.0, other.held, 200)
    K, tau, td = other.model.K, other.model.tau, other.model.td
    responses = [
        first_order_response(FirstOrderDelay(1.0, time_constant, td), t, 1.0) for time_constant in (tau, own.model.tau)
    ]
    difference = float(np.sqrt(np.mean((responses[0] - responses[1]) ** 2)))
    return (
        min(gains) >= GAIN_APART
        and K * own.model.K > 0
        and difference >= RESPONSE_APART
        and abs(other.y0 - own.y0) >= LEVEL_APART * max(other.range, own.range)
        and other.is_settled == own.is_settled
        and other.n_first != own.n_first
    )


def _draw(own: Record, rig: ShownRig, seed: np.random.SeedSequence) -> LabLog:
    changes = draw_changes(own, rig, seed)
    u = changes.u
    u_before, u_after = float(u[0]), float(u[np.flatnonzero(np.diff(u))[0] + 1])
    K = rig.model.K * changes.gain
    parameters = _tanks(u_before, u_after, K, rig.model.tau * changes.slower, rig.y0 + changes.y0, *changes.tanks)
    upper, _ = steady_levels(parameters, min(u_before, u_after))
    fastest = parameters.upper_area / parameters.upper_orifice * np.sqrt(2 * upper / GRAVITY)
    return log_run(
        parameters,
        u,
        changes.noise_seed,
        own.name,
        own.Ts,
        changes.quieter * rig.noise,
        rig.is_settled,
        max_step=min(own.Ts, 1.2 * float(fastest)),  # stable, and as exact as another rig is alike,
    )


@dataclass(frozen=True, slots=True, eq=False)
class Changes:
    """What another rig and its input differ in; see `draw_changes`.

    Attributes
    ----------
    u : ndarray, shape (N,)
        Its input.
    gain, slower : float
        Ratio of the gains and of the time constants to those of the own rig.
    y0 : float
        Difference of the outputs at rest.
    quieter : float
        Ratio of the noise.
    tanks : tuple of float
        Further draws, between 0 and 1.
    noise_seed : SeedSequence
    """

    u: FloatArray
    gain: float
    slower: float
    y0: float
    quieter: float
    tanks: tuple[float, ...]
    noise_seed: np.random.SeedSequence

    def __post_init__(self) -> None:
        freeze(self, u=self.u)


def draw_changes(own: Record, rig: ShownRig, seed: np.random.SeedSequence, volt: float = 1.0) -> Changes:
    """Draw another rig and input; `volt` is the unit in which changes of the input are drawn, in units of u."""
    plan = np.random.SeedSequence(entropy=seed.entropy, spawn_key=(*seed.spawn_key, _PLAN))
    noise = np.random.SeedSequence(entropy=seed.entropy, spawn_key=(*seed.spawn_key, _NOISE))
    changes = np.flatnonzero(np.diff(own.u)) + 1
    numbers = uniform_samples(plan, _NUMBERS + changes.size)
    gain, side, slower, zero, sign, *tanks = numbers[:8].tolist()
    u = volt * _other_input(own.u / volt, changes, numbers[8:])
    u_before, u_after = float(u[0]), float(u[np.flatnonzero(np.diff(u))[0] + 1])
    ratio = 0.72 + 0.12 * gain if side < 0.5 else 1.19 + 0.16 * gain
    louder = min(1.0, abs(ratio * (u_after - u_before)) / abs(rig.amplitude))
    return Changes(
        u,
        ratio,
        _other_time_constant(rig, own.Ts, slower) / rig.model.tau,
        (1 if sign < 0.5 else -1) * (0.08 + 0.15 * zero) * rig.range,
        0.9 * louder,
        tuple(tanks),
        noise,
    )


def _tanks(
    before: float, after: float, K: float, tau: float, y0: float, area: float, orifice: float, pump: float
) -> TankParameters:
    """Tanks with this gain and time constant between two pump voltages, and this output at rest."""
    made = STAND_IN.parameters
    made = replace(
        made,
        upper_area=made.upper_area * (0.8 + 0.4 * area),
        lower_orifice=made.lower_orifice * (0.9 + 0.2 * orifice),
        pump_gain=made.pump_gain * (0.9 + 0.2 * pump),
        upper_height=1e3,  # no brim: the levels follow from the gain
        lower_height=1e3,
    )
    (_, low), (_, high) = steady_levels(made, before), steady_levels(made, after)
    middle = pump_flow(made, (before + after) / 2) / made.lower_orifice / GRAVITY
    sensor_gain = K * (after - before) / (high - low) if high != low else 0.0
    lower_area = tau * made.lower_orifice / middle if middle else 0.0
    return replace(made, lower_area=lower_area, sensor_gain=sensor_gain, sensor_zero=y0 - sensor_gain * low)


def _other_time_constant(rig: ShownRig, Ts: float, draw: float) -> float:
    """A time constant whose response differs enough, faster if that is possible; the step must settle, too."""
    own = rig.model.tau
    for ratio in (*np.arange(0.9, 0.2, -0.02), *np.arange(1.1, 4.0, 0.05)):
        other = own * float(ratio)
        apart = np.sqrt((own / 2 + other / 2 - 2 * own * other / (own + other)) / rig.held)
        if apart >= 1.25 * RESPONSE_APART and 5 * Ts <= other <= rig.held / _SETTLED:
            further = 1 - 0.12 * draw if ratio < 1 else 1 + 0.06 * draw
            return other * further
    raise ValueError(f"its first step is held too briefly, {rig.held:g} s, for another time constant to be seen")


def _other_input(u: FloatArray, changes: np.ndarray, draws: FloatArray) -> FloatArray:
    """The same staircase with another rest level, larger steps, and other times: as many samples and steps."""
    shift, size, side, first, *jitters = draws.tolist()
    level = np.round(u[0] + (1 if side < 0.5 else -1) * (0.03 + 0.05 * shift), 2)
    volts = level + _rounded((1.04 + 0.08 * size) * (u[[0, *changes]] - u[0]))
    holds = np.diff([0, *changes, u.size])
    jittered = np.zeros(holds.size, dtype=int)
    turn = 1 if jitters[0] < 0.5 else -1
    for k in range(1, holds.size - 1):
        if holds[k] >= _JITTERED:
            jittered[k] = turn * (FEWEST_APART + int(6 * jitters[k % len(jitters)]))
            turn = -turn
    jittered[0] = _first_jitter(int(holds[0]), first)
    jittered[-1] = -int(jittered.sum())
    others = holds + jittered
    if others.min() < 1:
        raise ValueError("the last level of its input is held too briefly")
    return np.repeat(volts, others)


def _rounded(steps: FloatArray) -> FloatArray:
    """Steps of the input in hundredths of a volt, if they are that large."""
    smallest = np.min(np.abs(steps[steps != 0]), initial=np.inf)
    return np.round(steps, 2) if smallest >= 0.05 else steps


def _first_jitter(n: int, draw: float) -> int:
    most = min(10, n - SHORTEST_REST)
    if most >= FEWEST_APART:
        return -(FEWEST_APART + int(draw * (most - FEWEST_APART + 1)))
    return FEWEST_APART + int(4 * draw)
