"""Shift-operator calculus: polynomials in q^-1, and the z-transform.

A polynomial ``P(q^-1) = p0 + p1 q^-1 + ... + pn q^-n`` is the array ``[p0, p1, ..., pn]``. For python-control and
numpy's ``roots``, which take descending powers of z, the same array is ``z^n P(z^-1)``.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from scipy.signal import lfilter

from labsid._arrays import FloatArray, as_signal, as_signals

System = Callable[[FloatArray], FloatArray]


@dataclass(frozen=True, slots=True)
class ZPair:
    """A sequence and its z-transform.

    Attributes
    ----------
    name : str
    sequence : callable
        Takes k (array of 0, 1, ...), returns x(kT).
    transform : callable
        Takes z (complex), returns X(z).
    radius : float
        The transform converges for ``|z| > radius``.
    """

    name: str
    sequence: Callable[[FloatArray], FloatArray]
    transform: Callable[[complex], complex]
    radius: float


def shift_back(x: ArrayLike, n: int = 1) -> FloatArray:
    """Apply ``q^-n``: the value n samples ago, zero before the first sample.

    Parameters
    ----------
    x : array_like, shape (N,)
    n : int
        Samples, 0 to N.

    Returns
    -------
    ndarray, shape (N,)
        ``q^-n x(k) = x(k-n)``.

    Raises
    ------
    ValueError
        If `n` is not between 0 and N.

    Notes
    -----
    Reading notes, eq. (2).
    """
    x = as_signal("x", x)
    _check_shift(n, x.size)
    return np.concatenate([np.zeros(n), x[: x.size - n]])


def shift_forward(x: ArrayLike, n: int = 1) -> FloatArray:
    """Apply ``q^n``: the value n samples ahead.

    Parameters
    ----------
    x : array_like, shape (N,)
    n : int
        Samples, 0 to N.

    Returns
    -------
    ndarray, shape (N - n,)
        ``q^n x(k) = x(k+n)``, without the last n samples, which would lie beyond the record.

    Raises
    ------
    ValueError
        If `n` is not between 0 and N.

    Notes
    -----
    Reading notes, eq. (1).
    """
    x = as_signal("x", x)
    _check_shift(n, x.size)
    return x[n:].copy()


def multiply(P: ArrayLike, Q: ArrayLike) -> FloatArray:
    """Multiply two polynomials in q^-1.

    Parameters
    ----------
    P, Q : array_like
        Coefficients, lowest delay first. ``[0, 0, 1]`` is q^-2.

    Returns
    -------
    ndarray, shape (len(P) + len(Q) - 1,)
    """
    return np.convolve(as_signal("P", P), as_signal("Q", Q))


def add(P: ArrayLike, Q: ArrayLike) -> FloatArray:
    """Add two polynomials in q^-1.

    Parameters
    ----------
    P, Q : array_like
        Coefficients, lowest delay first.

    Returns
    -------
    ndarray, shape (max(len(P), len(Q)),)
    """
    P, Q = as_signal("P", P), as_signal("Q", Q)
    total = np.zeros(max(P.size, Q.size))
    total[: P.size] += P
    total[: Q.size] += Q
    return total


def series(B: ArrayLike, A: ArrayLike, terms: int) -> FloatArray:
    """Expand ``B(q^-1) / A(q^-1)`` in powers of q^-1: the impulse response.

    Parameters
    ----------
    B, A : array_like
        Coefficients, lowest delay first; ``A[0]`` not zero.
    terms : int
        Number of coefficients h0, h1, ...

    Returns
    -------
    ndarray, shape (terms,)
        ``h`` with ``A h = B`` up to that power. ``series([1], A, terms)`` is the inverse of A.

    Raises
    ------
    ValueError
        If ``A[0]`` is zero or `terms` below 1.

    Notes
    -----
    Reading notes, lecture 1. Long division: h_k = (b_k - a1 h_(k-1) - ...) / a0. An ARX model is thus an FIR model of
    infinite length.
    """
    B, A = as_signal("B", B), as_signal("A", A)
    if A[0] == 0:
        raise ValueError("A must have a nonzero A[0]; otherwise 1/A is not causal. Remove the delay of A first.")
    if terms < 1:
        raise ValueError(f"terms must be at least 1; got {terms}.")
    h = np.zeros(terms)
    for k in range(terms):
        reach = min(k, A.size - 1)
        past = A[1 : reach + 1] @ h[k - reach : k][::-1]
        h[k] = ((B[k] if k < B.size else 0.0) - past) / A[0]
    return h


def apply(P: ArrayLike, x: ArrayLike) -> FloatArray:
    """Apply a polynomial to a signal: ``p0 x(k) + p1 x(k-1) + ...``, with x zero before the first sample.

    Parameters
    ----------
    P : array_like
        Coefficients, lowest delay first.
    x : array_like, shape (N,)

    Returns
    -------
    ndarray, shape (N,)

    Notes
    -----
    Reading notes, eq. (3) and (4): ``A(q^-1) y(k) = B(q^-1) u(k)`` means ``apply(A, y) == apply(B, u)``.
    """
    filtered: FloatArray = lfilter(as_signal("P", P), 1.0, as_signal("x", x))
    return filtered


def evaluate(P: ArrayLike, z: complex) -> complex:
    """Evaluate ``p0 + p1 z^-1 + ... + pn z^-n`` at a number z, such as ``exp(i omega)``.

    Parameters
    ----------
    P : array_like
        Coefficients, lowest delay first.
    z : complex
        Not zero.

    Returns
    -------
    complex

    Raises
    ------
    ValueError
        If z is zero.
    """
    if z == 0:
        raise ValueError("z must not be zero: z^-1 is infinite there.")
    return complex(np.polynomial.polynomial.polyval(1 / complex(z), as_signal("P", P)))


def z_transform(x: ArrayLike, z: complex) -> complex:
    """Sum ``x(kT) z^-k`` over a record, k = 0 .. N-1.

    Parameters
    ----------
    x : array_like, shape (N,)
        Samples from time zero; x is zero after the last.
    z : complex
        Not zero.

    Returns
    -------
    complex
        The z-transform of the N samples.

    Raises
    ------
    ValueError
        If z is zero.

    Notes
    -----
    Reading notes, lecture 1, "Z-transform". A delay multiplies it by z^-1, as `shift_back` shows.
    """
    return evaluate(as_signal("x", x), z)


def z_pairs(Ts: float, a: float, omega: float) -> tuple[ZPair, ...]:
    """List common z-transforms.

    Parameters
    ----------
    Ts : float
        Sampling time in seconds, for the ramp and the sine.
    a : float
        Ratio of the geometric sequence.
    omega : float
        Angular frequency of the sine in rad/s.

    Returns
    -------
    tuple of ZPair
        Impulse, step, ramp, geometric sequence, sine.

    Notes
    -----
    The Reading notes give only the definition.
    """
    s, c = np.sin(omega * Ts), np.cos(omega * Ts)
    return (
        ZPair("impulse", lambda k: np.where(k == 0, 1.0, 0.0), lambda z: 1 + 0j, 0.0),
        ZPair("step", lambda k: np.ones(k.size), lambda z: z / (z - 1), 1.0),
        ZPair("ramp", lambda k: Ts * k, lambda z: Ts * z / (z - 1) ** 2, 1.0),
        ZPair("geometric", lambda k: np.power(a, k), lambda z: z / (z - a), abs(a)),
        ZPair(
            "sine", lambda k: np.sin(omega * Ts * k).astype(np.float64), lambda z: z * s / (z * z - 2 * c * z + 1), 1.0
        ),
    )


def superposition_error(system: System, u1: ArrayLike, u2: ArrayLike, alpha: float, beta: float) -> float:
    """Largest violation of superposition by a system, for two inputs.

    Parameters
    ----------
    system : callable
        Takes an input of shape (N,), returns an output of shape (N,).
    u1, u2 : array_like, shape (N,)
    alpha, beta : float
        Factors.

    Returns
    -------
    float
        Largest ``|S(alpha u1 + beta u2) - alpha S(u1) - beta S(u2)|``; a rounding error for a linear system.

    Notes
    -----
    Reading notes, lecture 1. Errata: homogeneity alone is printed as the definition; linearity is homogeneity *and*
    additivity.
    """
    u1, u2 = as_signals(u1=u1, u2=u2)
    return float(np.max(np.abs(system(alpha * u1 + beta * u2) - alpha * system(u1) - beta * system(u2))))


def shift_error(system: System, u: ArrayLike, n: int) -> float:
    """Largest violation of time invariance by a system, for one input.

    Parameters
    ----------
    system : callable
        Takes an input of shape (N,), returns an output of shape (N,), from rest.
    u : array_like, shape (N,)
    n : int
        Samples by which to delay, 0 to N.

    Returns
    -------
    float
        Largest ``|S(q^-n u) - q^-n S(u)|``; a rounding error for a time-invariant system.

    Notes
    -----
    Reading notes, lecture 1. Errata: time-invariant means that the system commutes with shifts.
    """
    u = as_signal("u", u)
    return float(np.max(np.abs(system(shift_back(u, n)) - shift_back(system(u), n))))


def _check_shift(n: int, samples: int) -> None:
    if not 0 <= n <= samples:
        raise ValueError(f"n must be between 0 and the {samples} samples of x; got {n}.")
