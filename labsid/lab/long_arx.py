"""Least squares for long records: Phi'Phi is computed from u and y without building Phi."""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from labsid._arrays import FloatArray, as_signals, freeze, read_only
from labsid.lab.arx import ArxModel, arx_from_theta, fit_arx

MAX_CONDITION = 1e5  # of Phi: its square times the machine epsilon of 1e-16 leaves six digits
MIN_LOSS = 1e-8  # of E'E over Y'Y: below it, cancellation spoils sigma2


@dataclass(frozen=True, slots=True, eq=False)
class LongArxFit:
    """A model of a long record; as `LeastSquares`, but without arrays of the length of the record.

    Attributes
    ----------
    model : ArxModel
    rows : int
        Number of equations: samples less the order.
    loss : float
        ``V = 1/2 E'E``.
    condition_number : float
        Of Phi.
    sigma2 : float
        Estimated variance of the equation error, ``E'E / (rows - 2 order)``; NaN without degrees of freedom.
    covariance : ndarray, shape (2 * order, 2 * order)
        ``sigma2 (Phi'Phi)^-1``; NaN if theta is not unique.
    stderr : ndarray, shape (2 * order,)
        Standard errors of theta.
    status : {"unique", "rank-deficient"}
        As in `LeastSquares`.
    solved_by : {"gram", "svd"}
        Whether theta was computed from Phi'Phi or, for a badly conditioned problem, from Phi.
    """

    model: ArxModel
    rows: int
    loss: float
    condition_number: float
    sigma2: float
    covariance: FloatArray
    stderr: FloatArray
    status: Literal["unique", "rank-deficient"]
    solved_by: Literal["gram", "svd"]

    def __post_init__(self) -> None:
        freeze(self, covariance=self.covariance, stderr=self.stderr)


def fit_long_arx(u: ArrayLike, y: ArrayLike, Ts: float, order: int = 2) -> LongArxFit:
    """Identify the same model as `fit_arx` in one pass over the record.

    Parameters
    ----------
    u, y : array_like, shape (N,)
        Offset-free input and output.
    Ts : float
        Sampling time in seconds.
    order : int
        Order of the model; the rows are the samples from `order` on.

    Returns
    -------
    LongArxFit

    Raises
    ------
    ValueError
        As `fit_arx`.

    Notes
    -----
    UNSW lab, eq. (8). An entry of Phi'Phi is a sum of ``y(k-i) u(k-j)``. Apart from the two ends of the record it
    depends on the lag j - i only, so that 4 order + 1 sums give all entries. Phi'Phi has the squared condition number
    of Phi; above cond(Phi) = 1e5, or if the residual is almost zero, Phi is built and decomposed.
    """
    u, y = (np.ascontiguousarray(x, dtype=np.float64) for x in (u, y))
    enough = u.ndim == y.ndim == 1 and u.size == y.size and order >= 1 and y.size >= 3 * order
    if not enough:
        return _by_svd(u, y, Ts, order)
    G, g, yy = _gram(u, y, order)
    if not (np.isfinite(yy) and np.all(np.isfinite(G)) and np.isfinite(u[-1])):
        as_signals(u=u, y=y)
    eigenvalues = np.linalg.eigvalsh(G) if np.all(np.isfinite(G)) else np.zeros(2 * order)
    if not eigenvalues[0] * MAX_CONDITION**2 > eigenvalues[-1]:
        return _by_svd(u, y, Ts, order)
    scale = 1 / np.sqrt(np.diag(G))
    inverse = scale[:, np.newaxis] * np.linalg.inv(scale[:, np.newaxis] * G * scale) * scale
    theta = inverse @ g
    squares = yy - float(theta @ g)
    if squares < MIN_LOSS * yy:
        return _by_svd(u, y, Ts, order)
    rows, p = y.size - order, 2 * order
    sigma2 = squares / (rows - p) if rows > p else np.nan
    return LongArxFit(
        model=arx_from_theta(theta, Ts),
        rows=rows,
        loss=squares / 2,
        condition_number=float(np.sqrt(eigenvalues[-1] / eigenvalues[0])),
        sigma2=sigma2,
        covariance=sigma2 * inverse,
        stderr=np.sqrt(sigma2 * np.diag(inverse)),
        status="unique",
        solved_by="gram",
    )


def _gram(u: FloatArray, y: FloatArray, n: int) -> tuple[FloatArray, FloatArray, float]:
    """Phi'Phi, Phi'Y and Y'Y over the rows k = n .. N - 1."""
    from labsid.lab._lagged_sums import lagged_sums

    # With m = k - i, the entry for lags i and j sums x(m) z(m - (j - i)) over m = n - i .. N - 1 - i. The samples
    # m = n .. N - 1 - n are common to all entries; the others are added to each entry separately.
    N = y.size
    yy, uu, yu = np.zeros(n + 1), np.zeros(n), np.zeros(2 * n)
    lagged_sums(read_only(u), read_only(y), n, n, N - n, yy, uu, yu)

    def entry(x: FloatArray, i: int, z: FloatArray, j: int, middle: float) -> float:
        before, after = slice(n - i, n), slice(N - n, N - i)
        lag = j - i
        ends = (
            x[before] @ z[before.start - lag : before.stop - lag] + x[after] @ z[after.start - lag : after.stop - lag]
        )
        return float(middle + ends)

    past, all_y = range(1, n + 1), range(n + 1)
    Y = np.array([[entry(y, min(i, j), y, max(i, j), yy[abs(j - i)]) for j in all_y] for i in all_y])
    U = np.array([[entry(u, min(i, j), u, max(i, j), uu[abs(j - i)]) for j in past] for i in past])
    C = np.array([[entry(y, i, u, j, yu[j - i + n - 1]) for j in past] for i in all_y])
    G = np.block([[Y[1:, 1:], C[1:]], [C[1:].T, U]])
    return G, np.concatenate([Y[0, 1:], C[0]]), float(Y[0, 0])


def _by_svd(u: FloatArray, y: FloatArray, Ts: float, order: int) -> LongArxFit:
    arx = fit_arx(u, y, Ts, order)
    fit = arx.fit
    return LongArxFit(
        model=arx.model,
        rows=arx.regression.Y.size,
        loss=fit.loss,
        condition_number=fit.condition_number,
        sigma2=fit.sigma2,
        covariance=fit.covariance,
        stderr=fit.stderr,
        status=fit.status,
        solved_by="svd",
    )
