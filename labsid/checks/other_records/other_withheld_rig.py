"""Another record of a withheld rig: other tanks, another operating point, another effect, less noise."""

import numpy as np
from scipy.optimize import least_squares

from labsid._arrays import FloatArray
from labsid.checks.assignments.sim_to_real_gap.linear_model import NEAREST, free_run, nearest_free_run
from labsid.lab.arx import fit_arx
from labsid.lab.offset import first_period_length
from labsid.records.record import Record
from labsid.rig.seeds import uniform_samples
from labsid.rig.switchable.withheld import SENSOR_NOISE, csv_bytes, withheld_record, withheld_rig

LEVEL_APART = 0.03
"""Smallest difference of the output offsets as a share of the range of y: three times the tolerance of ``gap-1``."""

NOISE = 0.45, 0.75
"""Range of the noise as a share of the student's own; the tolerance of `noise_sd` is 0.05 of it."""

PARTS = 16
DRAWS = 60


def make_other(own: Record, entropy: int) -> bytes:
    """Draw a record of another rig in the place of `own`; see `labsid.checks.other_records.another_record`."""
    secret = entropy.to_bytes(32, "big")
    own_noise = min(SENSOR_NOISE, _noise(own))
    low, high = NOISE
    for draw in range(DRAWS):
        seed = np.random.SeedSequence(entropy=entropy, spawn_key=(draw,))
        noise = own_noise * (low + (high - low) * float(uniform_samples(seed, 1)[0]))
        other = withheld_record(withheld_rig(str(draw), secret), noise)
        if _is_apart(other, own) and _is_fair(other):
            return csv_bytes(other)
    raise ValueError(f"no other record was far enough from {own.name or 'this one'}")


def _noise(record: Record) -> float:
    return float(np.std(record.y[: first_period_length(record.u)]))


def _is_apart(other: Record, own: Record) -> bool:
    if abs(other.u[0] - own.u[0]) < 0.05:
        return False
    rests = [float(np.mean(one.y[: first_period_length(one.u)])) for one in (other, own)]
    if abs(rests[0] - rests[1]) < LEVEL_APART * max(np.ptp(other.y), np.ptp(own.y)):
        return False
    return _worst(other) != _worst(own)


def _worst(record: Record) -> int:
    """The stretch with the largest error of the linear model."""
    u, y = _signals(record)
    half = y.size // 2
    e = y - free_run(nearest_free_run(u[:half], y[:half], record.Ts), u)
    stretches = e[: e.size - e.size % PARTS].reshape(PARTS, -1)
    return int(np.argmax(np.sum(stretches**2, axis=1)))


def _is_fair(record: Record) -> bool:
    """Whether the search that the notebook gives, from the lab's estimate, ends at the nearest free run."""
    u, y = _signals(record)
    half = y.size // 2
    u, y = u[:half], y[:half]
    nearest = nearest_free_run(u, y, record.Ts)

    def errors(theta: FloatArray) -> FloatArray:
        found = free_run(theta, u) - y
        return np.asarray(np.nan_to_num(found, nan=1e3, posinf=1e3, neginf=-1e3).clip(-1e3, 1e3))

    fitted = least_squares(errors, fit_arx(u, y, record.Ts).model.theta, x_scale="jac", max_nfev=100).x
    best, given = (float(np.sum(errors(theta) ** 2)) for theta in (nearest, fitted))
    return given <= (1 + (NEAREST - 1) / 4) * best


def _signals(record: Record) -> tuple[FloatArray, FloatArray]:
    return record.u - record.u[0], record.y - float(np.mean(record.y[: first_period_length(record.u)]))
