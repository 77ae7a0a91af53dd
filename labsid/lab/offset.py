"""DC offsets of a record: mean of the first input period, or of its settled part."""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from labsid._arrays import FloatArray, as_signal, as_signals, freeze
from labsid.records.resampling import is_held

SETTLING_BAND = 0.02  # share of the range of y: the usual 2 % band of the settling time
STEADY_TAIL = 0.01  # share of the range of y: largest rise of the tail after a start-up
SHORTEST_TAIL = 8  # samples; fewer do not distinguish a trend from noise


@dataclass(frozen=True, slots=True, eq=False)
class Offsets:
    """The operating point that is subtracted from a record.

    Attributes
    ----------
    u_offset, y_offset : float
        Input and output offset, in the units of the record (volts in the lab).
    settled : tuple of int
        (k0, k1): `y_offset` is the mean of samples k0..k1-1 of the output.
    first_period : int
        Samples before the first change of the input; equals k1.
    status : {"settled", "not settled", "too short"}
        "settled": those samples show no significant trend. "not settled": even the last quarter of the period
        shows a trend; its mean is used. "too short": the period has fewer than 8 samples; all are averaged.
    """

    u_offset: float
    y_offset: float
    settled: tuple[int, int]
    first_period: int
    status: Literal["settled", "not settled", "too short"] = "settled"


@dataclass(frozen=True, slots=True, eq=False)
class SignalOffsets:
    """The operating point of a record of several signals.

    Attributes
    ----------
    u_offset : ndarray, shape (nu,)
    y_offset : ndarray, shape (ny,)
    first : int
        Place of the input that changes first.
    outputs : tuple of Offsets
        Of each output, with that input.
    status : {"rest", "means"}
        "rest": from the period before any input changes, as in the lab. "means": there is no such period, because the
        inputs move from sample to sample; the means of the stretch that is fitted.
    """

    u_offset: FloatArray
    y_offset: FloatArray
    first: int
    outputs: tuple[Offsets, ...]
    status: Literal["rest", "means"]

    def __post_init__(self) -> None:
        freeze(self, u_offset=self.u_offset, y_offset=self.y_offset)


def first_period_length(u: ArrayLike) -> int:
    """Count the samples before the first change of the input, with the loop required by the lab.

    Parameters
    ----------
    u : array_like, shape (N,)
        The commanded input (exact levels, no measurement noise).

    Returns
    -------
    int
        The index of the first sample that differs from ``u[0]``.

    Raises
    ------
    ValueError
        If the input never changes.

    Notes
    -----
    UNSW lab, exercise 1c.
    """
    u = as_signal("u", u, at_least=2)
    k = 0
    while k < len(u) and u[k] == u[0]:
        k += 1
    if k == len(u):
        raise ValueError(
            f"u must change at least once; got the constant {u[0]:g} over all {len(u)} samples. "
            "A constant input excites nothing: record a run in which the input changes."
        )
    return k


def mean_of_first_period(u: ArrayLike, y: ArrayLike) -> float:
    """Average the output over the first input period: the lab's output offset.

    Parameters
    ----------
    u, y : array_like, shape (N,)
        Input and output as recorded.

    Returns
    -------
    float
        The mean of y over the samples before the first change of u, in the unit of y.

    Raises
    ------
    ValueError
        If the lengths differ or the input never changes.

    Notes
    -----
    UNSW lab, exercise 1c. Valid only if the rig is settled before the first change; see `find_offsets`.
    """
    u, y = as_signals(at_least=2, u=u, y=y)
    return float(np.mean(y[: first_period_length(u)]))


def mid_range(u: ArrayLike) -> float:
    """Return the middle of the input range, which the lab defines as the input offset.

    Parameters
    ----------
    u : array_like, shape (N,)
        The input as recorded.

    Returns
    -------
    float
        ``(max(u) + min(u)) / 2``.

    Notes
    -----
    UNSW lab, "DC Offset Compensation". The exercise uses the first value of u instead, as does `find_offsets`:
    the record shows where y settles at the first value, but the input may never have rested at the middle of the
    range. The two agree only for symmetric ranges (2.0 V and 1.9 V on the lab's own file).
    """
    u = as_signal("u", u)
    return float((u.max() + u.min()) / 2)


def find_offsets(u: ArrayLike, y: ArrayLike) -> Offsets:
    """Find the offsets of a record: the first input, and the mean output over the settled tail of its period.

    Parameters
    ----------
    u, y : array_like, shape (N,)
        Input and output as recorded.

    Returns
    -------
    Offsets

    Raises
    ------
    ValueError
        If the lengths differ or the input never changes.

    Notes
    -----
    UNSW lab, exercise 1c, extended to records that start from an empty tank (see the errata).

    The whole first period is averaged, as in the lab, if it stays within 2 % of the range of y about its mean and
    a straight line through it rises by at most the same 2 %. Otherwise the record contains a start-up: the longest
    tail is averaged that stays within the same band and rises by at most 1 %. The tail has at least 8 samples and a
    quarter of the period.

    "settled" does not exclude a bias. If y still approaches its level exponentially and rises by r within the tail, the
    mean of a tail of x time constants is biased by 1.0 r for x = 1, 0.4 r for x = 3, 0.2 r for x = 10, and r / 6 for a
    long tail. A record that starts with empty tanks is called settled from about 6 time constants in the first period
    on; the bias is then up to 0.7 % of the range of y. A first period that is short compared with the time constant
    does not show that y still moves: it is called settled with a bias of several times the rise.

    Noise widens these limits: the band to four standard deviations, the rise to two standard errors. For a tail,
    two standard errors must not exceed 2 % of the range, because larger noise could hide a trend. The noise is the
    standard deviation about a straight line through the last quarter.
    """
    u, y = as_signals(at_least=2, u=u, y=y)
    n = first_period_length(u)
    k0 = 0
    status: Literal["settled", "not settled", "too short"] = "too short"
    if n >= SHORTEST_TAIL:
        k0, is_settled = _settled_from(y[:n], float(np.ptp(y)))
        status = "settled" if is_settled else "not settled"
    return Offsets(float(u[0]), float(np.mean(y[k0:n])), (k0, n), n, status)


def find_signal_offsets(u: ArrayLike, y: ArrayLike, stop: int | None = None) -> SignalOffsets:
    """Find the offsets of a record of several signals: `find_offsets` for each output, or means.

    Parameters
    ----------
    u : array_like, shape (N, nu)
        Inputs as recorded, of which at least one changes.
    y : array_like, shape (N, ny)
        Outputs as recorded, without missing samples.
    stop : int, optional
        End of the stretch whose means are taken; default: all samples.

    Returns
    -------
    SignalOffsets

    Raises
    ------
    ValueError
        If no input changes.

    Notes
    -----
    The first period ends where the first input changes. It has fewer than 8 samples and the inputs are not held
    between changes: such a record has no rest to take the offsets from.
    """
    u, y = np.asarray(u, np.float64), np.asarray(y, np.float64)
    changes = [np.flatnonzero(column != column[0]) for column in u.T]
    first = min(range(len(changes)), key=lambda j: changes[j][0] if changes[j].size else len(u))
    by_output = tuple(find_offsets(u[:, first], column) for column in y.T)
    if by_output[0].status == "too short" and not all(map(is_held, u.T)):
        return SignalOffsets(u[:stop].mean(axis=0), y[:stop].mean(axis=0), first, by_output, "means")
    return SignalOffsets(u[0], np.array([offsets.y_offset for offsets in by_output]), first, by_output, "rest")


def remove_offsets(u: ArrayLike, y: ArrayLike, offsets: Offsets) -> tuple[FloatArray, FloatArray]:
    """Subtract the offsets.

    Parameters
    ----------
    u, y : array_like, shape (N,)
        Input and output as recorded.
    offsets : Offsets

    Returns
    -------
    u, y : ndarray, shape (N,)
        Offset-free input and output (the lab's Fig. 6).

    Raises
    ------
    ValueError
        If the lengths differ.
    """
    u, y = as_signals(u=u, y=y)
    return u - offsets.u_offset, y - offsets.y_offset


def _settled_from(y: FloatArray, y_range: float) -> tuple[int, bool]:
    """First sample of the longest settled tail and True, or of the last quarter and False."""
    n = y.size
    shortest = max(SHORTEST_TAIL, -(-n // 4))
    backwards = y[::-1] - y[-1]
    length = np.arange(1, n + 1)
    total = np.cumsum(backwards)
    mean = total / length
    # Least-squares line through the last `length` samples, for every length at once.
    moment = np.cumsum(np.arange(n) * backwards) - (length - 1) / 2 * total
    rise = np.abs(moment) * 12 / np.maximum(length**2 - 1.0, 1)

    last = backwards[:shortest]
    index = np.arange(shortest)
    sigma = np.std(last - np.polyval(np.polyfit(index, last, 1), index), ddof=2)

    band = SETTLING_BAND * y_range
    spread = np.maximum(np.maximum.accumulate(backwards) - mean, mean - np.minimum.accumulate(backwards))
    close = spread <= max(band, 4 * sigma)
    error = 2 * sigma * np.sqrt(12 / length)
    steady = (rise <= np.maximum(error, STEADY_TAIL * y_range)) & (error <= band)
    steady[-1] = rise[-1] <= max(error[-1], band)
    settled = np.flatnonzero(steady & close & (length >= shortest))
    return (n - int(length[settled[-1]]), True) if settled.size else (n - shortest, False)
