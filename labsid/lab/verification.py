"""Model verification: free runs on the recorded input, and their mean squared errors."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from labsid._arrays import FloatArray, as_signals, freeze
from labsid.lab.arx import ArxModel
from labsid.lab.simulation import estimate_initial_state, simulate


@dataclass(frozen=True, slots=True, eq=False)
class Verification:
    """Free runs of a model on a record, from four initial states.

    Attributes
    ----------
    y_all : ndarray, shape (N,)
        The whole record from rest (Fig. 7b).
    y_second_half : ndarray, shape (N - half,)
        The second half from rest at its first sample (Fig. 7a).
    y_second_half_carried : ndarray, shape (N - half,)
        The second half of `y_all`: the state is carried over from the first half.
    y_second_half_estimated : ndarray, shape (N - half,)
        The second half from the estimated state `x0`.
    half : int
        First sample of the second half, N // 2.
    mse_all, mse_second_half, mse_second_half_carried, mse_second_half_estimated : float
        Mean squared error of each, in the square of the unit of y.
    x0 : ndarray, shape (n,)
        State of eq. (2) at sample `half`, estimated from the second half.
    """

    y_all: FloatArray
    y_second_half: FloatArray
    y_second_half_carried: FloatArray
    y_second_half_estimated: FloatArray
    half: int
    mse_all: float
    mse_second_half: float
    mse_second_half_carried: float
    mse_second_half_estimated: float
    x0: FloatArray

    def __post_init__(self) -> None:
        freeze(
            self,
            y_all=self.y_all,
            y_second_half=self.y_second_half,
            y_second_half_carried=self.y_second_half_carried,
            y_second_half_estimated=self.y_second_half_estimated,
            x0=self.x0,
        )


def mse(y: ArrayLike, y_sim: ArrayLike, measured: ArrayLike | None = None) -> float:
    """Mean squared error between measured and simulated output.

    Parameters
    ----------
    y, y_sim : array_like, shape (N,)
        Measured and simulated output.
    measured : array_like of bool, shape (N,), optional
        Samples to score; default: all.

    Returns
    -------
    float
        In the square of the unit of y.

    Raises
    ------
    ValueError
        If the lengths differ.

    Notes
    -----
    UNSW lab, "Model Verification" and post-lab 3.
    """
    y, y_sim = as_signals(y=y, y_sim=y_sim)
    return float(np.mean((y - y_sim)[_rows(measured, y.size)] ** 2))


def verify(model: ArxModel, u: ArrayLike, y: ArrayLike, measured: ArrayLike | None = None) -> Verification:
    """Simulate the second half and the whole of a record and compare with the measured output.

    Parameters
    ----------
    model : ArxModel
    u, y : array_like, shape (N,)
        Offset-free input and output.
    measured : array_like of bool, shape (N,), optional
        Samples of y to score; default: all.

    Returns
    -------
    Verification

    Raises
    ------
    ValueError
        If the lengths differ or there are fewer than 2 n samples.

    Notes
    -----
    UNSW lab, exercise 3. In 3a the second half is simulated from rest although the rig was not at rest at that
    instant; this explains the different starting point asked for in 3b. The difference vanishes if the state is
    carried over from the first half or estimated.
    """
    u, y = as_signals(at_least=2 * model.order, u=u, y=y)
    half = y.size // 2
    u_half, y_half = u[half:], y[half:]
    there = _rows(measured, y.size)
    x0 = estimate_initial_state(model, u_half, y_half, measured=there[half:])
    y_all = simulate(model, u)
    from_rest, estimated = simulate(model, u_half), simulate(model, u_half, x0)
    return Verification(
        y_all=y_all,
        y_second_half=from_rest,
        y_second_half_carried=y_all[half:],
        y_second_half_estimated=estimated,
        half=half,
        mse_all=mse(y, y_all, there),
        mse_second_half=mse(y_half, from_rest, there[half:]),
        mse_second_half_carried=mse(y_half, y_all[half:], there[half:]),
        mse_second_half_estimated=mse(y_half, estimated, there[half:]),
        x0=x0,
    )


def _rows(measured: ArrayLike | None, samples: int) -> NDArray[np.bool_]:
    return np.ones(samples, bool) if measured is None else np.asarray(measured, bool)
