"""The regression model of the lab: rows of past outputs and inputs, eq. (4) to (7)."""

from dataclasses import dataclass

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import ArrayLike

from labsid._arrays import FloatArray, as_signals, freeze


@dataclass(frozen=True, slots=True, eq=False)
class Regression:
    """The matrices of ``Y = Phi theta``.

    Attributes
    ----------
    Phi : ndarray, shape (n, 2 * order)
        Row k - start is ``[y(k-1) .. y(k-order), u(k-1) .. u(k-order)]``.
    Y : ndarray, shape (n,)
        ``y(k)`` for k = start .. stop - 1.
    order : int
        Order of the difference equation.
    start, stop : int
        The rows are the samples k = start .. stop - 1 (zero-based).
    """

    Phi: FloatArray
    Y: FloatArray
    order: int
    start: int
    stop: int

    def __post_init__(self) -> None:
        freeze(self, Phi=self.Phi, Y=self.Y)


def build_phi(
    u: ArrayLike, y: ArrayLike, order: int = 2, start: int | None = None, stop: int | None = None
) -> Regression:
    """Stack past outputs and inputs into Phi and the outputs into Y.

    Parameters
    ----------
    u, y : array_like, shape (N,)
        Offset-free input and output.
    order : int
        Order of the model; a row has 2 * order entries.
    start : int, optional
        First sample k that gets a row; `order` unless given, the first for which every lag was recorded.
        Below that, the lags before sample 0 are taken as zero: the rig at rest at its operating point.
    stop : int, optional
        One past the last sample that gets a row; all samples unless given.

    Returns
    -------
    Regression

    Raises
    ------
    ValueError
        If the lengths differ, `order`, `start` or `stop` is out of range, or there are fewer rows than
        unknowns.

    Notes
    -----
    UNSW lab, eq. (4) to (7), exercise 2a. With ``start=1`` and ``order=2`` the first row is the printed one,
    with y(-1) = u(-1) = 0.
    """
    u, y = as_signals(u=u, y=y)
    if order < 1:
        raise ValueError(f"order must be at least 1; got {order}.")
    start = order if start is None else start
    stop = y.size if stop is None else stop
    if not 0 <= start < stop <= y.size:
        raise ValueError(
            f"start and stop must satisfy 0 <= start < stop <= {y.size} (the number of samples); "
            f"got start {start} and stop {stop}. For order {order}, give a longer record."
        )
    if stop - start < 2 * order:
        raise ValueError(
            f"order {order} has {2 * order} unknowns and needs at least as many rows; got {stop - start} "
            f"(samples {start} to {stop - 1}). Give more samples or lower the order."
        )
    Phi = np.hstack([_lags(y, order, start, stop), _lags(u, order, start, stop)])
    return Regression(Phi, y[start:stop], order, start, stop)


def _lags(x: FloatArray, order: int, start: int, stop: int) -> FloatArray:
    """Rows ``[x(k-1) .. x(k-order)]``, k = start .. stop - 1, with zeros before sample 0."""
    at_rest = np.concatenate([np.zeros(order), x[: stop - 1]])
    return sliding_window_view(at_rest, order)[start:stop, ::-1]
