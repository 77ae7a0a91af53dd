"""What the model answers to an input: free run, one-step prediction, and the initial state."""

import numpy as np
from numpy.typing import ArrayLike
from scipy.signal import lfilter

from labsid._arrays import FloatArray, as_signal, as_signals
from labsid.lab.arx import ArxModel, canonical_form

LARGEST = 1e150  # beyond this the square of a sample, and with it the mean squared error, overflows


def simulate(model: ArxModel, u: ArrayLike, x0: ArrayLike | None = None) -> FloatArray:
    """Let the model run freely on an input: it sees its own past outputs, never the measured ones.

    Parameters
    ----------
    model : ArxModel
    u : array_like, shape (N,)
        Offset-free input.
    x0 : array_like, shape (n,), optional
        State of eq. (2) at the first sample; at rest (zero) unless given.

    Returns
    -------
    y : ndarray, shape (N,)
        Offset-free simulated output.

    Raises
    ------
    ValueError
        If `x0` does not have one entry a state, or an unstable model leaves the range of numbers.

    Notes
    -----
    UNSW lab, exercise 3a (MATLAB's ``filter`` or ``lsim``).
    """
    u = as_signal("u", u)
    state = np.zeros(model.order) if x0 is None else as_signal("x0", x0)
    if state.size != model.order:
        raise ValueError(f"x0 must have one entry a state ({model.order}); got {state.size}.")
    numerator = np.concatenate([[0.0], model.b])
    y: FloatArray = lfilter(numerator, model.a, u, zi=_filter_state(model) @ state)[0]
    bounded = np.abs(y) < LARGEST
    if not np.all(bounded):
        raise ValueError(
            f"the model must stay within the range of numbers; its simulated output passes {LARGEST:g} at "
            f"sample {np.argmin(bounded)}. Its largest pole has magnitude {abs(model.poles[0]):.4g}: it is "
            "unstable. Check the data, or try another order."
        )
    return y


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
    UNSW lab, eq. (4). This is *not* simulation: it leans on the measured output at every step and so looks
    good even with a poor model. Verification asks for `simulate`.
    """
    u, y = as_signals(u=u, y=y)
    y_hat: FloatArray = lfilter(np.concatenate([[0.0], -model.a[1:]]), 1.0, y)
    return y_hat + lfilter(np.concatenate([[0.0], model.b]), 1.0, u)


def free_response(model: ArxModel, samples: int) -> FloatArray:
    """Return the outputs of the undriven model from each unit state: rows ``C G^k``.

    Parameters
    ----------
    model : ArxModel
    samples : int
        How many samples k = 0 .. samples - 1.

    Returns
    -------
    ndarray, shape (samples, n)
        Times a state of eq. (2), the output that this state alone would cause.
    """
    quiet = np.zeros(samples)
    return np.column_stack([simulate(model, quiet, state) for state in np.eye(model.order)])


def estimate_initial_state(model: ArxModel, u: ArrayLike, y: ArrayLike, samples: int | None = None) -> FloatArray:
    """Estimate the state at the first sample from what the model at rest leaves unexplained.

    Parameters
    ----------
    model : ArxModel
    u, y : array_like, shape (N,)
        Offset-free input and output of the stretch that starts with the sought state.
    samples : int, optional
        How many samples, from the first, to fit; all unless given.

    Returns
    -------
    x0 : ndarray, shape (n,)
        State of eq. (2), by least squares on the simulated output; of minimum norm where the output does not
        determine it.

    Raises
    ------
    ValueError
        If the lengths differ or `samples` is not between n and N.

    Notes
    -----
    The remedy to the question of UNSW exercise 3b. The output is linear in the state: it is the output from
    rest plus ``C G^k x0``.
    """
    u, y = as_signals(u=u, y=y)
    samples = y.size if samples is None else samples
    if not model.order <= samples <= y.size:
        raise ValueError(
            f"samples must lie between the order {model.order} and the {y.size} samples given; got {samples}."
        )
    unexplained = y[:samples] - simulate(model, u[:samples])
    return np.linalg.lstsq(free_response(model, samples), unexplained, rcond=None)[0].astype(np.float64)


def _filter_state(model: ArxModel) -> FloatArray:
    """Matrix that turns the state of eq. (2) into that of ``lfilter`` (transposed direct form II).

    The undriven output f(k) = C G^k x0 runs off the filter's state z as f(0) = z0, f(1) = z1 - a1 f(0), ...:
    z_j = a_0 f(j) + a_1 f(j-1) + ... + a_j f(0).
    """
    n = model.order
    G, _, C, _ = canonical_form(model)
    observability = np.vstack([C @ np.linalg.matrix_power(G, k) for k in range(n)])
    lower = sum((np.diag(np.full(n - k, model.a[k]), -k) for k in range(n)), np.zeros((n, n)))
    return lower @ observability
