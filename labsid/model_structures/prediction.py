"""Simulation and prediction with a model of any structure.

`free_run` uses the inputs alone; `one_step_prediction` also uses the measured outputs before each sample.
"""

import numpy as np
from numpy.typing import ArrayLike
from scipy.signal import lfilter

from labsid._arrays import FloatArray, as_signal, as_signals
from labsid.model_structures.realisation import controllable_form, transfer_function
from labsid.model_structures.structures import PolynomialModel

LARGEST = 1e150  # the squares of larger values, and with them the mean squared error, may overflow


def free_run(
    model: PolynomialModel, u: ArrayLike | None, e: ArrayLike | None = None, x0: ArrayLike | None = None
) -> FloatArray:
    """Simulate the model from its inputs alone: ``y = (q^-d B u + C e) / A``.

    Parameters
    ----------
    model : PolynomialModel
    u : array_like, shape (N,), or None
        Input; None without one.
    e : array_like, shape (N,), optional
        White noise, to generate data; default: none.
    x0 : array_like, shape (n,), optional
        State of `controllable_form` at the first sample; default: zero (at rest).

    Returns
    -------
    y : ndarray, shape (N,)

    Raises
    ------
    ValueError
        If the input is missing, neither signal is given, the lengths differ, `x0` does not have one entry for each
        state, or the output of an unstable model overflows.

    Notes
    -----
    Reading notes, lecture 3. No measured output is used; compare `one_step_prediction`.
    """
    if model.b.size and u is None:
        raise ValueError("u must be given: the model has an input.")
    signals = {name: x for name, x in (("u", u), ("e", e)) if x is not None}
    if not signals:
        raise ValueError("e must be given: a model without input is driven by noise alone.")
    driving = dict(zip(signals, as_signals(1, **signals), strict=True))
    forced = sum(lfilter({"u": model.delayed_b, "e": model.c}[name], 1.0, x) for name, x in driving.items())
    if x0 is None:
        return _within_range(lfilter([1.0], model.a, forced), "simulated output", model.a)
    undriven = _filter_state(model, as_signal("x0", x0))
    a = np.pad(model.a, (0, undriven.size + 1 - model.a.size))
    return _within_range(lfilter([1.0], a, forced, zi=undriven)[0], "simulated output", model.a)


def prediction_errors(model: PolynomialModel, u: ArrayLike | None, y: ArrayLike) -> FloatArray:
    """Compute the prediction errors: ``epsilon = (A y - q^-d B u) / C``.

    Parameters
    ----------
    model : PolynomialModel
    u : array_like, shape (N,), or None
        Input; None without one.
    y : array_like, shape (N,)
        Measured output.

    Returns
    -------
    epsilon : ndarray, shape (N,)
        ``y - one_step_prediction``, from rest; for the true model, the noise.

    Raises
    ------
    ValueError
        If the input is missing, the lengths differ, or the errors overflow because C has a root outside the unit
        circle.

    Notes
    -----
    Reading notes, lecture 7; for C = 1 the residual of the regression.
    """
    if model.b.size and u is None:
        raise ValueError("u must be given: the model has an input.")
    y = as_signal("y", y)
    unexplained = lfilter(model.a, 1.0, y)
    if u is not None:
        unexplained = unexplained - lfilter(model.delayed_b, 1.0, as_signals(u=u, y=y)[0])
    return _within_range(lfilter([1.0], model.c, unexplained), "prediction errors", model.c)


def one_step_prediction(model: PolynomialModel, u: ArrayLike | None, y: ArrayLike) -> FloatArray:
    """Predict each sample from the *measured* outputs before it: ``y_hat(k | theta) = phi'(k) theta``.

    Parameters
    ----------
    model : PolynomialModel
    u : array_like, shape (N,), or None
        Input; None without one.
    y : array_like, shape (N,)
        Measured output.

    Returns
    -------
    y_hat : ndarray, shape (N,)
        From rest: lags before sample 0 are zero.

    Raises
    ------
    ValueError
        As for `prediction_errors`.

    Notes
    -----
    SUSTech lecture, "One-step predictor"; Reading notes, Fig. 8. This is *not* simulation: see `free_run`.
    """
    errors = prediction_errors(model, u, y)
    return as_signal("y", y) - errors


def _filter_state(model: PolynomialModel, x0: FloatArray) -> FloatArray:
    """The state of ``lfilter`` (transposed direct form II) with the same free response as `x0`.

    The free response f(k) = C G^k x0 follows from the state z of the filter as f(0) = z0, f(1) = z1 - a1 f(0), ...:
    z_j = a_0 f(j) + a_1 f(j-1) + ... + a_j f(0).
    """
    num, a = transfer_function(model)
    G, _, C, _ = controllable_form(num, a)
    n = a.size - 1
    if x0.size != n:
        raise ValueError(f"x0 must have one entry for each state ({n}); got {x0.size}.")
    observability = np.vstack([C @ np.linalg.matrix_power(G, k) for k in range(n)])
    lower = sum((np.diag(np.full(n - k, a[k]), -k) for k in range(n)), np.zeros((n, n)))
    return np.asarray(lower @ observability @ x0)


def _within_range(x: FloatArray, what: str, denominator: FloatArray) -> FloatArray:
    bounded = np.abs(x) < LARGEST
    if not np.all(bounded):
        root = np.max(np.abs(np.roots(denominator)))
        raise ValueError(
            f"the {what} must stay within the range of numbers; got more than {LARGEST:g} at sample "
            f"{np.argmin(bounded)}. The polynomial in the denominator has a root of magnitude {root:.4g}, "
            "outside the unit circle: it is unstable. Check the data, or try another order."
        )
    return x
