"""Conversions between transfer function, difference equation, state space, and python-control systems."""

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from labsid._arrays import FloatArray, as_signal
from labsid.model_structures.structures import PolynomialModel

if TYPE_CHECKING:
    import control

# python-control imports matplotlib, so it is imported inside functions only.


def model_from_transfer_function(num: ArrayLike, den: ArrayLike, Ts: float = 1.0) -> PolynomialModel:
    """Convert ``G(z) = num(z) / den(z)`` to a difference equation.

    Parameters
    ----------
    num, den : array_like
        Coefficients in descending powers of z; num of no higher degree than den.
    Ts : float
        Sampling time in seconds.

    Returns
    -------
    PolynomialModel
        ARX or FIR; its `delay` is the degree of den minus that of num.

    Raises
    ------
    ValueError
        If den is zero, num is zero, or G is not proper.

    Notes
    -----
    SUSTech lecture, system id example 1: ``(z^2 + b)/(z^3 + a z)`` is ``(z^-1 + b z^-3)/(1 + a z^-2)``, hence
    ``y(k) + a y(k-2) = u(k-1) + b u(k-3)``. Errata: printed as ``Y(z) = G(z) H(z)`` for ``G(z) U(z)``.
    """
    num, den = _proper(num, den)
    if num.size == 1 and num[0] == 0:
        raise ValueError("num must not be zero: there would be no input.")
    return PolynomialModel(den / den[0], num / den[0], np.ones(1), den.size - num.size, Ts)


def controllable_form(num: ArrayLike, den: ArrayLike) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Realise ``num(z) / den(z)`` as x(k+1) = G x(k) + H u(k), y(k) = C x(k) + D u(k) in controllable canonical form.

    Parameters
    ----------
    num, den : array_like
        Coefficients in descending powers of z; den of degree n, at least 1, and num of no higher degree.

    Returns
    -------
    G : ndarray, shape (n, n)
    H : ndarray, shape (n, 1)
    C : ndarray, shape (1, n)
    D : ndarray, shape (1, 1)

    Raises
    ------
    ValueError
        If den is a constant or zero, or the transfer function is not proper.

    Notes
    -----
    SUSTech lecture, first slides. The form of UNSW's eq. (2), with a direct path D: num = D den + a remainder of lower
    degree.
    """
    num, den = _proper(num, den)
    n = den.size - 1
    if n == 0:
        raise ValueError("den must be of degree 1 or more; got a constant. A static gain has no state.")
    a = den / den[0]
    b = np.concatenate([np.zeros(n + 1 - num.size), num]) / den[0]
    # G = [  0    1  ...   0  ]   H = [0]   C = [bn - b0 an, ..., b1 - b0 a1]   D = b0
    #     [  .         .   .  ]       [.]
    #     [-an  ...  -a2  -a1 ]       [1]
    G = np.eye(n, k=1)
    G[-1] = -a[:0:-1]
    C = (b - b[0] * a)[np.newaxis, :0:-1].copy()
    return G, np.eye(n)[:, -1:], C, np.full((1, 1), b[0])


def transfer_function(model: PolynomialModel) -> tuple[FloatArray, FloatArray]:
    """Return the transfer function ``num(z) / den(z)`` from u to y.

    Parameters
    ----------
    model : PolynomialModel
        With an input.

    Returns
    -------
    num, den : ndarray, shape (n + 1,)
        Coefficients in descending powers of z, padded to equal length: ``q^-d B`` and A.

    Raises
    ------
    ValueError
        If the model has no input.
    """
    if not model.b.size:
        raise ValueError("the model must have an input for a transfer function. Use noise_tf for the noise.")
    return _padded(model.delayed_b, model.a)


def input_tf(model: PolynomialModel) -> "control.TransferFunction":
    """Return the transfer function ``q^-d B / A`` from input to output as a system of python-control.

    Parameters
    ----------
    model : PolynomialModel
        With an input.

    Returns
    -------
    control.TransferFunction

    Raises
    ------
    ValueError
        If the model has no input.
    """
    import control

    num, den = transfer_function(model)
    return control.tf(num, den, model.Ts, name="G", inputs="u", outputs="y")


def noise_tf(model: PolynomialModel) -> "control.TransferFunction":
    """Return the transfer function ``C / A`` from noise to output as a system of python-control.

    Parameters
    ----------
    model : PolynomialModel

    Returns
    -------
    control.TransferFunction

    Notes
    -----
    Reading notes, lecture 3: the coloured disturbance is white noise passed through this filter.
    """
    import control

    num, den = _padded(model.c, model.a)
    return control.tf(num, den, model.Ts, name="H", inputs="e", outputs="v")


def input_ss(model: PolynomialModel) -> "control.StateSpace":
    """Return the controllable canonical form from input to output as a state-space system of python-control.

    Parameters
    ----------
    model : PolynomialModel
        With an input and at least one lag; a static gain has no state.

    Returns
    -------
    control.StateSpace

    Raises
    ------
    ValueError
        If the model has no input or no lag.

    Notes
    -----
    SUSTech lecture, first slides. A delay adds states that only store past inputs.
    """
    import control

    return control.ss(*controllable_form(*transfer_function(model)), model.Ts, name="G", inputs="u", outputs="y")


def _proper(num: ArrayLike, den: ArrayLike) -> tuple[FloatArray, FloatArray]:
    num, den = as_signal("num", num), as_signal("den", den)
    if not np.any(den):
        raise ValueError("den must not be zero.")
    num, den = np.trim_zeros(num, "f"), np.trim_zeros(den, "f")
    num = num if num.size else np.zeros(1)
    if num.size > den.size:
        raise ValueError(
            f"num must be of no higher degree than den; got degrees {num.size - 1} and {den.size - 1}: the transfer "
            "function is not causal."
        )
    return num, den


def _padded(p: FloatArray, q: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Two polynomials in q^-1 as polynomials in z, multiplied by the same power of z."""
    length = max(p.size, q.size)
    return np.pad(p, (0, length - p.size)), np.pad(q, (0, length - q.size))
