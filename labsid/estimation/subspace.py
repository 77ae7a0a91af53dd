"""State-space models of several signals by a subspace method, from input and output alone."""

from dataclasses import dataclass

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import ArrayLike, NDArray

from labsid._arrays import FloatArray, as_matrix, freeze
from labsid.model_structures.state_space import StateSpaceModel, free_responses

BLOCK_ROWS = 10  # of the data matrices, unless the order asks for more or the record is too short


@dataclass(frozen=True, slots=True, eq=False)
class SubspaceFit:
    """An identified state-space model.

    Attributes
    ----------
    model : StateSpaceModel
        Strictly proper, D = 0.
    x0 : ndarray, shape (n,)
        State at the first sample.
    singular_values : ndarray
        Of the data projected on the past, largest first; a drop after n of them suggests the order n.
    reflected : int
        Eigenvalues of G outside the unit circle that were replaced by their mirror images inside.
    """

    model: StateSpaceModel
    x0: FloatArray
    singular_values: FloatArray
    reflected: int

    def __post_init__(self) -> None:
        freeze(self, x0=self.x0, singular_values=self.singular_values)


def fit_subspace(
    u: ArrayLike,
    y: ArrayLike,
    Ts: float,
    order: int,
    block_rows: int | None = None,
    measured: NDArray[np.bool_] | None = None,
) -> SubspaceFit:
    """Identify a stable state-space model of given order: the dynamics by PO-MOESP, the inputs by least squares.

    Parameters
    ----------
    u : array_like, shape (N, nu)
        Offset-free inputs.
    y : array_like, shape (N, ny)
        Offset-free outputs, with any finite value where one was not measured.
    Ts : float
        Sampling time in seconds.
    order : int
        Number of states n.
    block_rows : int, optional
        Rows of samples in the past and in the future; more than n / ny. Default: 10, or n + 1 if that is more.
    measured : ndarray of bool, shape (N, ny), optional
        Outputs that were measured; windows with another one are left out. Default: all.

    Returns
    -------
    SubspaceFit

    Raises
    ------
    ValueError
        If the lengths differ, or the record is too short for the order.

    Notes
    -----
    Verhaegen and Dewilde, Int. J. Control 56 (1992), with the past inputs and outputs as instruments (Verhaegen 1994).
    For windows of past p and future f,

        [Uf]   [L11   0    0 ] [Q1]
        [Wp] = [L21  L22   0 ] [Q2] ,   Wp = [Up; Yp]
        [Yf]   [L31  L32  L33] [Q3]

    the columns of L32 span the extended observability matrix ``[C; C G; C G^2; ...]``, which gives C and G. The outputs
    are then linear in H and x0.
    """
    u, y = as_matrix("u", u), as_matrix("y", y)
    if len(u) != len(y):
        raise ValueError(f"u and y must have equal length; got {len(u)} and {len(y)}. Cut them to the same samples.")
    (samples, nu), ny = u.shape, y.shape[1]
    there = np.ones(y.shape, bool) if measured is None else measured
    longest = (samples + 1) // (2 * (nu + ny) + 2)  # as many windows as there are rows of data
    rows = min(max(BLOCK_ROWS, order + 1), longest) if block_rows is None else block_rows
    if order < 1 or rows > longest or rows * ny <= order:
        raise ValueError(
            f"order must be at least 1 and below block_rows * ny; got order {order}, {rows} block rows and ny = {ny}; "
            f"{samples} samples allow {max(longest, 0)} block rows. Use a longer record or a lower order."
        )
    u_scale, y_scale = _scale(u), _scale(y)
    u, y = u / u_scale, y / y_scale
    past_u, future_u = _windows(u, rows)
    past_y, future_y = _windows(y, rows)
    whole = np.vstack(_windows(there, rows)).all(axis=0)
    stacked = np.vstack([future_u, past_u, past_y, future_y])[:, whole]
    L = np.transpose(np.asarray(np.linalg.qr(stacked.T, mode="r")))
    before, after = rows * nu, rows * (2 * nu + ny)
    left, s, _ = np.linalg.svd(L[after:, before:after], full_matrices=False)
    observability = left[:, :order] * np.sqrt(s[:order])
    G = np.linalg.lstsq(observability[:-ny], observability[ny:], rcond=None)[0]
    G, reflected = _stable(G)
    C = observability[:ny]
    H, x0 = _input_matrix(G, C, u, y, there, Ts)
    model = StateSpaceModel(G, H / u_scale, C * y_scale[:, np.newaxis], np.zeros((ny, nu)), Ts)
    return SubspaceFit(model, x0, s, reflected)


def _scale(x: FloatArray) -> FloatArray:
    deviation: FloatArray = np.std(x, axis=0)
    return np.where(deviation > 0, deviation, 1.0)


def _windows(x: NDArray, rows: int) -> tuple[NDArray, NDArray]:
    """Past and future of each window of 2 * rows samples: a column for each, shape (rows * signals, windows)."""
    windows = sliding_window_view(x, 2 * rows, axis=0)  # (windows, signals, 2 * rows)
    stacked = windows.transpose(2, 1, 0).reshape(-1, windows.shape[0])
    return stacked[: rows * x.shape[1]], stacked[rows * x.shape[1] :]


def _stable(G: FloatArray) -> tuple[FloatArray, int]:
    """The matrix with eigenvalues outside the unit circle mirrored inside, and their number."""
    values, vectors = np.linalg.eig(G)
    outside = np.abs(values) > 1
    if not outside.any():
        return G, 0
    mirrored = np.where(outside, 1 / np.conj(values), values)
    return np.real(vectors @ np.diag(mirrored) @ np.linalg.inv(vectors)), int(outside.sum())


def _input_matrix(
    G: FloatArray, C: FloatArray, u: FloatArray, y: FloatArray, there: NDArray[np.bool_], Ts: float
) -> tuple[FloatArray, FloatArray]:
    """H and x0 of least squared simulation error, given G and C."""
    (samples, nu), n = u.shape, len(G)
    responses = np.empty((samples, len(C), nu, n))  # of each output to u_j entering state s
    state = np.zeros((nu, n, n))
    for k in range(samples):
        responses[k] = np.moveaxis(C @ state, 0, 1)
        state = G @ state + u[k, :, np.newaxis, np.newaxis] * np.eye(n)
    model = StateSpaceModel(G, np.zeros((n, nu)), C, np.zeros((len(C), nu)), Ts)
    Phi = np.concatenate([responses.reshape(samples, len(C), nu * n), free_responses(model, samples)], axis=2)
    theta = np.linalg.lstsq(Phi[there], y[there], rcond=None)[0]
    return theta[: nu * n].reshape(nu, n).T, theta[nu * n :]
