"""Verification of a model of several signals: free runs on the recorded inputs, errors by output and by pair."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from labsid._arrays import FloatArray, as_matrix, freeze
from labsid.lab.verification import mse
from labsid.model_structures.state_space import StateSpaceModel, estimate_state, simulate_states


@dataclass(frozen=True, slots=True, eq=False)
class SystemVerification:
    """Free runs of a model of several signals on a record, as `Verification` for one input and one output.

    Attributes
    ----------
    y_all : ndarray, shape (N, ny)
        The whole record from rest.
    y_second_half : ndarray, shape (N - half, ny)
        The second half from rest at its first sample.
    y_second_half_carried : ndarray, shape (N - half, ny)
        The second half of `y_all`.
    y_second_half_estimated : ndarray, shape (N - half, ny)
        The second half from the estimated state `x0`.
    half : int
        First sample of the second half, N // 2.
    mse_all, mse_second_half, mse_second_half_carried, mse_second_half_estimated : ndarray, shape (ny,)
        Mean squared error of each output, in the square of its unit.
    mse_without : ndarray, shape (ny, nu)
        That of output i, second half carried, if input j stays at its offset: what the pair contributes.
    x0 : ndarray, shape (n,)
        State at sample `half`, estimated from the second half.
    """

    y_all: FloatArray
    y_second_half: FloatArray
    y_second_half_carried: FloatArray
    y_second_half_estimated: FloatArray
    half: int
    mse_all: FloatArray
    mse_second_half: FloatArray
    mse_second_half_carried: FloatArray
    mse_second_half_estimated: FloatArray
    mse_without: FloatArray
    x0: FloatArray

    def __post_init__(self) -> None:
        freeze(self, **{name: getattr(self, name) for name in self.__slots__ if name != "half"})


def verify_system(
    model: StateSpaceModel, u: ArrayLike, y: ArrayLike, measured: NDArray[np.bool_] | None = None
) -> SystemVerification:
    """Simulate the second half and the whole of a record and compare with the measured outputs.

    Parameters
    ----------
    model : StateSpaceModel
    u : array_like, shape (N, nu)
        Offset-free inputs.
    y : array_like, shape (N, ny)
        Offset-free outputs.
    measured : ndarray of bool, shape (N, ny), optional
        Outputs to score; default: all.

    Returns
    -------
    SystemVerification

    Raises
    ------
    ValueError
        If the lengths differ, or the output of an unstable model overflows.

    Notes
    -----
    UNSW lab, exercise 3, for each output.
    """
    u, y = as_matrix("u", u), as_matrix("y", y)
    if len(u) != len(y):
        raise ValueError(f"u and y must have equal length; got {len(u)} and {len(y)}. Cut them to the same samples.")
    half = len(y) // 2
    there = np.ones(y.shape, bool) if measured is None else measured
    u_half, y_half, there_half = u[half:], y[half:], there[half:]
    x0 = estimate_state(model, u_half, y_half, there_half)
    y_all = simulate_states(model, u)
    from_rest, estimated = simulate_states(model, u_half), simulate_states(model, u_half, x0)
    alone = [simulate_states(model, u * only) for only in np.eye(u.shape[1])]
    return SystemVerification(
        y_all=y_all,
        y_second_half=from_rest,
        y_second_half_carried=y_all[half:],
        y_second_half_estimated=estimated,
        half=half,
        mse_all=mse_by_output(y, y_all, there),
        mse_second_half=mse_by_output(y_half, from_rest, there_half),
        mse_second_half_carried=mse_by_output(y_half, y_all[half:], there_half),
        mse_second_half_estimated=mse_by_output(y_half, estimated, there_half),
        mse_without=np.transpose([mse_by_output(y_half, (y_all - part)[half:], there_half) for part in alone]),
        x0=x0,
    )


def mse_by_output(y: FloatArray, y_sim: FloatArray, measured: NDArray[np.bool_]) -> FloatArray:
    """Mean squared error of each output, shape (ny,); NaN for one without a measured sample."""
    with np.errstate(invalid="ignore"):
        columns = zip(y.T, y_sim.T, measured.T, strict=True)
        return np.array([mse(column, sim, there) if there.any() else np.nan for column, sim, there in columns])
