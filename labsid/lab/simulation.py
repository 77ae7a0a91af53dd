"""Simulation of the model: free run, one-step prediction, and the initial state."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from labsid._arrays import FloatArray, as_signals
from labsid.lab.arx import ArxModel
from labsid.model_structures.prediction import free_run, one_step_prediction


def simulate(model: ArxModel, u: ArrayLike, x0: ArrayLike | None = None) -> FloatArray:
    """Simulate the model from its input (free run): past outputs are simulated, not measured.

    Parameters
    ----------
    model : ArxModel
    u : array_like, shape (N,)
        Offset-free input.
    x0 : array_like, shape (n,), optional
        State of eq. (2) at the first sample; default: zero (at rest).

    Returns
    -------
    y : ndarray, shape (N,)
        Offset-free simulated output.

    Raises
    ------
    ValueError
        If `x0` does not have n entries, or the output of an unstable model overflows.

    Notes
    -----
    UNSW lab, exercise 3a (MATLAB's ``filter`` or ``lsim``).
    """
    return free_run(model.polynomials, u, x0=x0)


def predict_one_step(model: ArxModel, u: ArrayLike, y: ArrayLike) -> FloatArray:
    """Predict each sample from the *measured* samples before it: ``y_hat(k) = phi'(k) theta``.

    Parameters
    ----------
    model : ArxModel
    u, y : array_like, shape (N,)
        Offset-free input and measured output.

    Returns
    -------
    y_hat : ndarray, shape (N,)
        Lags before sample 0 are taken as zero.

    Raises
    ------
    ValueError
        If the lengths differ.

    Notes
    -----
    UNSW lab, eq. (4). This is *not* simulation: it uses the measured output at every step, and its error is small
    even for a poor model. Verification requires `simulate`.
    """
    return one_step_prediction(model.polynomials, u, y)


def free_response(model: ArxModel, samples: int) -> FloatArray:
    """Return the outputs of the undriven model from each unit state: rows ``C G^k``.

    Parameters
    ----------
    model : ArxModel
    samples : int
        Number of samples, k = 0 .. samples - 1.

    Returns
    -------
    ndarray, shape (samples, n)
        Its product with a state of eq. (2) is the free response from that state.
    """
    quiet = np.zeros(samples)
    return np.column_stack([simulate(model, quiet, state) for state in np.eye(model.order)])


def estimate_initial_state(
    model: ArxModel,
    u: ArrayLike,
    y: ArrayLike,
    samples: int | None = None,
    measured: NDArray[np.bool_] | None = None,
) -> FloatArray:
    """Estimate the state at the first sample by least squares on the simulated output.

    Parameters
    ----------
    model : ArxModel
    u, y : array_like, shape (N,)
        Offset-free input and output, from the sample of the unknown state.
    samples : int, optional
        Number of samples to fit, from the first; default: all.
    measured : ndarray of bool, shape (N,), optional
        Which of them to fit; default: all.

    Returns
    -------
    x0 : ndarray, shape (n,)
        State of eq. (2); of minimum norm if the output does not determine it.

    Raises
    ------
    ValueError
        If the lengths differ or `samples` is not between n and N.

    Notes
    -----
    UNSW lab, exercise 3b. The output is linear in the initial state: it is the output from rest plus ``C G^k x0``.
    """
    u, y = as_signals(u=u, y=y)
    samples = y.size if samples is None else samples
    if not model.order <= samples <= y.size:
        raise ValueError(
            f"samples must lie between the order {model.order} and the {y.size} samples given; got {samples}."
        )
    unexplained = y[:samples] - simulate(model, u[:samples])
    rows = slice(None) if measured is None else measured[:samples]
    return np.linalg.lstsq(free_response(model, samples)[rows], unexplained[rows], rcond=None)[0].astype(np.float64)
