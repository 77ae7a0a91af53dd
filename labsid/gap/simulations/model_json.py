"""MODEL.json: a discrete transfer function about an operating point."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from labsid._arrays import FloatArray
from labsid.gap.dynamics.record_start import RecordStart

FASTEST = 1e-12  # smallest pole of which a time constant is told; numerics
SLOWEST = 1.0 - 1e-9  # largest pole of which a time constant is told; numerics


@dataclass(frozen=True, slots=True, eq=False)
class TransferFunction:
    """MODEL.json: a discrete transfer function about an operating point."""

    num: FloatArray
    den: FloatArray
    dt: float
    u0: float
    y0: float

    @property
    def order(self) -> int:
        """Number of poles, without those at zero: these are a dead time."""
        return np.trim_zeros(self.den, "b").size - 1

    @property
    def direct(self) -> bool:
        """Whether the output responds within the sample in which the input changes."""
        return self.num.size == self.den.size

    @property
    def dead_time(self) -> int:
        """Dead time in samples, beyond the one of a strictly proper model."""
        return max(self.den.size - self.num.size - 1, 0)

    @property
    def start(self) -> RecordStart:
        """Which samples of a record determine its initial state."""
        poles = np.abs(np.roots(np.trim_zeros(self.den, "b")))
        rates = np.sort(-np.log(np.clip(poles, FASTEST, SLOWEST)))
        slow, fast = np.append(rates, [-np.log(FASTEST)] * 2)[:2]
        return RecordStart((float(slow + fast), float(slow * fast)))

    def response(self, u: FloatArray) -> FloatArray:
        """Response from rest at u0, shape (N,)."""
        from scipy.signal import lfilter  # slow to import

        padded = np.concatenate([np.zeros(self.den.size - self.num.size), self.num])
        return np.asarray(lfilter(padded / self.den[0], self.den / self.den[0], u - self.u0)) + self.y0

    def simulate(self, u: FloatArray, y: FloatArray, start: RecordStart | None = None) -> FloatArray:
        """Free-run output, shape (N,), with the initial state estimated from the first samples of `y`.

        `start` states which samples; by default, two of its own slowest time constants.
        """
        used = (start or self.start).used(u.size)
        forced, states = self.response(u), self.free_response(u.size)
        if not np.isfinite(forced[:used]).all() or not np.isfinite(states[:used]).all():
            return np.full(u.size, np.nan)
        return started(forced, states, y, used)

    def free_response(self, samples: int) -> FloatArray:
        """Free responses to the unit initial states, shape (samples, n)."""
        from scipy.signal import lfilter  # slow to import

        n = self.den.size - 1
        if n == 0:
            return np.zeros((samples, 0))
        return np.column_stack(
            [lfilter([1.0], self.den / self.den[0], np.zeros(samples), zi=state)[0] for state in np.eye(n)]
        )


def read_transfer_function(content: dict[str, Any], Ts: float) -> TransferFunction:
    """Read and check MODEL.json.

    Raises
    ------
    ValueError
        If it is not a proper transfer function with the record's sampling time.
    """
    try:
        num, den = np.atleast_1d(np.array(content["num"], float)), np.atleast_1d(np.array(content["den"], float))
        dt, u0, y0 = float(content["dt"]), float(content.get("u0", 0.0)), float(content.get("y0", 0.0))
    except KeyError as error:
        raise ValueError(
            f"the model has no {error.args[0]!r}; it needs num, den and dt (u0 and y0 default to 0)."
        ) from None
    except (TypeError, ValueError, OverflowError):
        raise ValueError(
            "num and den must be lists of numbers in descending powers of z; dt, u0 and y0 must be numbers."
        ) from None
    if (
        num.ndim != 1
        or den.ndim != 1
        or not den.size
        or not num.size
        or not np.isfinite([*num, *den, dt, u0, y0]).all()
    ):
        raise ValueError("num and den must be lists of finite numbers in descending powers of z.")
    if den[0] == 0.0:
        raise ValueError("den must begin with the highest power of z, not with 0. Remove leading zeros.")
    num = np.trim_zeros(num, "f") if np.any(num) else np.zeros(1)
    if num.size > den.size:
        raise ValueError(f"num has degree {num.size - 1}, den {den.size - 1}: the model must be proper.")
    if abs(dt - Ts) > 1e-6 * Ts:
        raise ValueError(f"dt must be the record's sampling time {Ts:g} s; got {dt:g} s. Resample the model.")
    return TransferFunction(num, den, dt, u0, y0)


def started(forced: FloatArray, states: FloatArray, y: FloatArray, used: int) -> FloatArray:
    """A simulated output with responses `states`, shape (N, n), to the initial state that `used` samples show."""
    state = np.linalg.lstsq(states[:used], (y - forced)[:used], rcond=None)[0]
    return np.asarray(forced + states @ state)
