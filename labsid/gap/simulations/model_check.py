"""Whether a record and a simulation that opens speak of the same thing: units, signs, clocks, limits, contacts."""

from dataclasses import dataclass, replace

import numpy as np

from labsid._arrays import FloatArray
from labsid.gap.simulations.opened import initial_state
from labsid.gap.simulations.stepper_port import as_read
from labsid.lab.findings import Finding
from labsid.records.record import Record
from labsid.simulators.mjcf.loop_constants import FREE
from labsid.simulators.mjcf.one_joint import OneJoint, substeps
from labsid.simulators.mjcf.simulation import CONTACTS
from labsid.simulators.simulator import Simulator
from labsid.simulators.stepper import Stepper

TOPIC = "model"
FACTORS = {
    180.0 / np.pi: "degrees",
    np.pi / 180.0: "radians, and the model degrees",
    1000.0: "thousandths",
    1e-3: "units",
}
NEAR = 0.1  # relative distance from one of these factors; set by hand
RATIO = 1.5  # of the motions, from which a factor that has no name is said; set by hand
WINDOWS = (1.0, 0.3, 0.1)  # of the record: a model that loses its phase agrees at the beginning only; numerics
ALIKE = 0.5, 0.9  # shares of the variance that the simulation explains: enough for a sign, and for a zero; set by hand
MIN_ZERO = 0.1  # of the range of the output; set by hand
AHEAD = 8  # later samples of the command that are tried as causes; set by hand
BEHIND = 12  # earlier samples of the command that are tried as causes; set by hand
MIN_T = 5.0  # of the effect of a later command; set by hand
LATE = 20  # samples by which what follows a goal may be late; set by hand
FOLLOWS = 0.93  # correlation of a goal with what follows it; set by hand
MAX_CONTACT = 0.5  # share of a record in contact; definition: a record with more is refused


@dataclass(frozen=True, slots=True)
class Match:
    """How the numbers of a log become those of a model.

    Attributes
    ----------
    u : float
        Command of the model for a unit of the log.
    y : float
        Reading of the log for a unit of the model.
    zero : float
        Reading of the log at the zero of the model.
    shift : int
        Samples by which the output is logged too early.
    """

    u: float = 1.0
    y: float = 1.0
    zero: float = 0.0
    shift: int = 0


def read_match(text: str) -> Match:
    """Read ``y=-57.3,zero=0.1,u=2,shift=3``, of which any part may be missing.

    Raises
    ------
    ValueError
        If it has another form.
    """
    found: dict[str, float] = {}
    for part in text.split(","):
        name, equals, value = (one.strip() for one in part.partition("="))
        try:
            found[name] = float(value)
        except ValueError:
            found[name] = np.nan
        if name not in ("u", "y", "zero", "shift") or not equals or not np.isfinite(found[name]):
            raise ValueError(f"--match must be like y=57.3,zero=0.1,u=-1,shift=2; got {part.strip()!r}.")
    shift = found.pop("shift", 0.0)
    if shift != int(shift) or shift < 0.0 or not found.get("u", 1.0) or not found.get("y", 1.0):
        raise ValueError("--match: shift is a number of samples from 0 on, and neither u nor y may be zero.")
    return Match(**found, shift=int(shift))


def matched(record: Record, match: Match) -> Record:
    """The record in the numbers of the model."""
    late = match.shift
    y = (record.y - match.zero) / match.y
    if not late:
        return replace(record, u=match.u * record.u, y=y)
    return replace(record, t=record.t[late:], u=match.u * record.u[late:], y=y[:-late])


def check_model(record: Record, simulate: Simulator) -> list[Finding]:
    """What of a record and a model does not fit together, each with the option that mends it.

    Parameters
    ----------
    record : Record
    simulate : Simulator
        With a joint.

    Raises
    ------
    ValueError
        If the timestep of the model does not divide the sampling time, the model is in contact for most of it, or a
        class cannot be run on the record.
    """
    one = simulate.joint
    assert one is not None
    t = np.asarray(record.Ts * np.arange(len(record)), np.float64)
    if isinstance(one, Stepper):
        return _check_stepper(
            record, simulate, as_read(one, simulate, t, record.u, initial_state(one, record.y, record.Ts))
        )
    substeps(record.Ts, one.timestep)
    start = initial_state(one, record.y, record.Ts)
    found = limit_findings(record, one)
    pairs = np.asarray(simulate.run(t, record.u, simulate.nominal | start | {CONTACTS: 1.0}))
    found += contact_findings(pairs, one)
    if one.output in ("position", "speed"):
        found += check_output(record, np.asarray(one.run(t, record.u, start)), one)
    return found


def check_output(record: Record, q: FloatArray, one: OneJoint, driven: bool = True) -> list[Finding]:
    """Mode of the actuator, time, sign, unit and zero of one output.

    Parameters
    ----------
    record : Record
        With the command of the joint's actuator, if it is `driven`.
    q : ndarray, shape (N,)
        The output in the simulation.
    one : OneJoint
    driven : bool
    """
    found = [*_mode(record, one), *_time(record, q)] if driven else []
    if np.isfinite(q).all() and np.ptp(q) > 0.0:
        found += _scales(record, q, one)
    return found


def _check_stepper(record: Record, simulate: Simulator, one: Stepper) -> list[Finding]:
    """Whether the output of a class has the time, the sign, the unit and the zero of the record."""
    t = np.asarray(record.Ts * np.arange(len(record)), np.float64)
    y = simulate(t, record.u, initial_state(one, record.y, record.Ts))
    found = _time(record, y)
    return found + (_scales(record, y, one) if np.ptp(y) > 0.0 else [])


def limit_findings(record: Record, one: OneJoint) -> list[Finding]:
    """Commands beyond the range of the actuator."""
    low, high = one.ctrlrange
    if high >= FREE:
        return []
    share = float(np.mean((record.u < low - 1e-9) | (record.u > high + 1e-9)))
    if not share:
        return []
    text = (
        f"{100.0 * share:.2g}% of the commands lie beyond the ctrlrange {low:g} to {high:g} of the actuator "
        f"{one.actuator}, and act as its ends. If they are in another unit, --match u=FACTOR mends it."
    )
    return [Finding("warning", TOPIC, text)]


def contact_findings(pairs: FloatArray, one: OneJoint) -> list[Finding]:
    """The time in which geoms of the model touch; an error if it is most of the record."""
    touching = pairs >= 0.0
    if not touching.any():
        return []
    share, pair = float(np.mean(touching)), int(pairs[touching][0])
    names = " and ".join(one.geoms[i] for i in divmod(pair, len(one.geoms)))
    if share > MAX_CONTACT:
        raise ValueError(
            f"the geoms {names} of the model touch for {100.0 * share:.0f} % of the record. Set contype and "
            "conaffinity of geoms that do not touch on the rig to 0, or exclude the contact from the record."
        )
    text = (
        f"the geoms {names} of the model touch for {100.0 * share:.2g}% of the record. If they do not on the rig, set "
        "their contype and conaffinity to 0; if they do, leave that time out with --exclude."
    )
    return [Finding("warning", TOPIC, text)]


def _mode(record: Record, one: OneJoint) -> list[Finding]:
    """Whether the command looks like a goal of another kind than that of the actuator."""
    y = record.y if one.output == "position" else np.cumsum(record.y) * record.Ts
    speed = np.gradient(y, record.Ts)
    fitting = {"position": (record.u, y), "velocity": (record.u, speed)}
    for kind, (u, signal) in fitting.items():
        if kind == one.kind or not np.std(signal):
            continue
        r = _following(u, signal)
        slope = r * float(np.std(signal) / np.std(u))
        own = fitting.get(one.kind)
        better = own is None or _following(*own) < 0.9 * r
        if r > FOLLOWS and 0.67 < slope < 1.5 and better:
            goal = "position" if kind == "position" else "speed"
            text = (
                f"the {goal} follows the command, as with a {kind} servo; the actuator {one.actuator} takes "
                f"a {one.kind}. Use <{kind}> in the model, or log its {one.kind}."
            )
            return [Finding("warning", TOPIC, text)]
    return []


def _following(u: FloatArray, signal: FloatArray) -> float:
    """Largest correlation of a command with what may follow it, within a few samples."""
    lags = range(min(LATE, u.size // 4))
    return max(float(np.corrcoef(u[: u.size - lag], signal[lag:])[0, 1]) for lag in lags)


def _time(record: Record, q: FloatArray) -> list[Finding]:
    """Whether the output answers commands that come later."""
    u, y = record.u, record.y
    k = np.arange(BEHIND, len(record) - AHEAD - 1)
    columns = [y[k], y[k - 1], y[k - 2], np.ones(k.size)]
    columns += [u[k + lag] for lag in range(-BEHIND + 2, AHEAD + 1)]
    matrix = np.column_stack(columns)
    if np.linalg.matrix_rank(matrix) < matrix.shape[1]:
        return []
    solution, *_ = np.linalg.lstsq(matrix, y[k + 1], rcond=None)
    e = y[k + 1] - matrix @ solution
    cov = np.linalg.pinv(matrix.T @ matrix) * float(e @ e) / max(k.size - matrix.shape[1], 1)
    ratios = np.abs(solution) / np.sqrt(np.maximum(np.diag(cov), 1e-300))
    if not (ratios[-AHEAD:] > MIN_T).any():
        return []
    count = y.size - AHEAD  # the shift at which the simulation agrees best
    alike = [abs(np.corrcoef(y[:count], q[late : late + count])[0, 1]) for late in range(1, AHEAD + 1)]
    shift = 1 + int(np.argmax(alike))
    text = f"the output answers commands that are logged later, by {shift} samples. --match shift={shift} mends it."
    return [Finding("warning", TOPIC, text)]


def _scales(record: Record, q: FloatArray, one: OneJoint | Stepper) -> list[Finding]:
    """Sign, unit, ratio and zero of the output."""
    best, slope, level = -1.0, 1.0, 0.0
    for share in WINDOWS:
        count = max(int(share * q.size), 50)
        a, b = q[:count] - q[:count].mean(), record.y[:count] - record.y[:count].mean()
        if not a.any() or not b.any():
            continue
        explained = float(np.corrcoef(a, b)[0, 1]) ** 2
        if explained > max(best, ALIKE[0]):
            best, slope = explained, float(a @ b / (a @ a))
            level = float(record.y[:count].mean() - slope * q[:count].mean())
    if best < 0.0:
        return []
    named = next((f for f in FACTORS if abs(abs(slope) / f - 1.0) < NEAR), None)
    size = named or (abs(slope) if not 1.0 / RATIO < abs(slope) < RATIO and best > ALIKE[1] else 1.0)
    factor = size if slope > 0.0 else -size
    if named is None and size != 1.0:
        how = f"{size:.3g} times as far as the {_output(one)} in the simulation"
        how += ", and against it" if factor < 0.0 else ""
        why = "by a gear, or because numbers of the model are wrong"
        text = f"the output moves {how}: {why}. Only for a gear, use --match y={factor:.6g}."
        return [Finding("note", TOPIC, text)]
    found = []
    if factor < 0.0:
        found.append(f"the output moves against the {_output(one)}")
    if named is not None:
        found.append(f"the log seems to be in {FACTORS[named]}")
    if found:
        text = f"{' and '.join(found)}. --match y={factor:.6g} mends it."
        return [Finding("warning", TOPIC, text)]
    anchored = isinstance(one, OneJoint) and (one.kind == "position" or one.passive["stiffness"])
    if anchored and one.output == "position" and best > ALIKE[1] and abs(level) > MIN_ZERO * float(np.ptp(record.y)):
        text = f"the output reads about {level:.3g} at the zero of {one.place}. "
        text += f"--match zero={level:.3g} mends it."
        return [Finding("note", TOPIC, text)]
    return []


def _output(one: OneJoint | Stepper) -> str:
    """What the simulation puts out, in words."""
    return f"output of {one.label}" if isinstance(one, Stepper) else f"{one.output} of {one.place}"
