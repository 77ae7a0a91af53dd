"""The five input signals of the Reading notes: step, uniform noise, ARMA process, sum of sinusoids, feedback."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from scipy.signal import lfilter

from labsid._arrays import FloatArray, as_signal, as_signals, freeze
from labsid.model_structures.prediction import free_run
from labsid.model_structures.structures import PolynomialModel


@dataclass(frozen=True, slots=True, eq=False)
class ClosedLoop:
    """A record taken under feedback ``u(k) = r(k) - F(q^-1) y(k)``.

    Attributes
    ----------
    r : ndarray, shape (N,)
        Set-point signal.
    u, y : ndarray, shape (N,)
        Input and output of the process.
    """

    r: FloatArray
    u: FloatArray
    y: FloatArray

    def __post_init__(self) -> None:
        freeze(self, r=self.r, u=self.u, y=self.y)


def step(samples: int, amplitude: float = 1.0, at: int = 0) -> FloatArray:
    """Make a step.

    Parameters
    ----------
    samples : int
        Length N.
    amplitude : float
        The level u0 after the step; zero before.
    at : int
        Sample of the step.

    Returns
    -------
    ndarray, shape (N,)
        Persistently exciting of order 1 if it steps at the first sample. A later step has the order
        ``min(at + 1, N - at)`` over this record, but only about its edge: more samples do not add information about
        the dynamics.

    Raises
    ------
    ValueError
        If `samples` is below 1 or `at` is out of range.

    Notes
    -----
    Reading notes, lecture 6, input signal 1. Rise time, overshoot and static gain can be read off the response.
    """
    _check_samples(samples)
    if not 0 <= at < samples:
        raise ValueError(f"at must lie within the {samples} samples; got {at}.")
    return np.where(np.arange(samples) < at, 0.0, float(amplitude))


def uniform_noise(rng: np.random.Generator, samples: int, levels: tuple[float, float] = (-2.0, 2.0)) -> FloatArray:
    """Draw independent numbers, uniform between two levels.

    Parameters
    ----------
    rng : numpy.random.Generator
    samples : int
        Length N.
    levels : tuple of float
        Lower and upper limit; the notes' ``2-4*rand`` is (-2, 2).

    Returns
    -------
    ndarray, shape (N,)
        Persistently exciting of any order.

    Raises
    ------
    ValueError
        If `samples` is below 1 or the levels are not in order.

    Notes
    -----
    Reading notes, lecture 6, input signal 2, and Examples 3-1, 6-1, 6-2. The mean is zero only for symmetric levels;
    MATLAB's ``rand`` alone has mean 1/2.
    """
    _check_samples(samples)
    if not levels[0] < levels[1]:
        raise ValueError(f"levels must be in order; got {levels[0]} and {levels[1]}.")
    return rng.uniform(*levels, samples)


def arma_process(rng: np.random.Generator, samples: int, c: ArrayLike, d: ArrayLike, sigma: float = 1.0) -> FloatArray:
    """Filter white Gaussian noise: ``C(q^-1) u = D(q^-1) e``.

    Parameters
    ----------
    rng : numpy.random.Generator
    samples : int
        Length N.
    c, d : array_like
        ``[1, c1, ...]`` and ``[1, d1, ...]``; C has its roots inside the unit circle. Here C is the denominator, as
        in the notes.
    sigma : float
        Standard deviation of e.

    Returns
    -------
    ndarray, shape (N,)
        Persistently exciting of any order, with the spectrum ``sigma^2 |D/C|^2``. The filter starts from rest.

    Raises
    ------
    ValueError
        If `samples` is below 1, `sigma` is not positive, a polynomial does not start with 1, or C is not stable.

    Notes
    -----
    Reading notes, lecture 6, input signal 3 (MATLAB's ``filter``).
    """
    _check_samples(samples)
    c, d = as_signal("c", c), as_signal("d", d)
    if c[0] != 1 or d[0] != 1:
        raise ValueError(f"c and d must start with 1; got {c[0]:g} and {d[0]:g}.")
    if not sigma > 0:
        raise ValueError(f"sigma must be positive; got {sigma}.")
    largest = float(np.max(np.abs(np.roots(c)), initial=0.0))
    if largest >= 1:
        raise ValueError(f"c must have its roots within the unit circle; got one of magnitude {largest:.4g}.")
    u: FloatArray = lfilter(d, c, sigma * rng.standard_normal(samples))
    return u


def sinusoids(samples: int, amplitudes: ArrayLike, omegas: ArrayLike, phases: ArrayLike) -> FloatArray:
    """Make a sum of sinusoids, ``u(t) = sum a_j sin(omega_j t + phi_j)``, t = 0 .. N-1.

    Parameters
    ----------
    samples : int
        Length N.
    amplitudes : array_like, shape (m,)
    omegas : array_like, shape (m,)
        Angular frequencies in radians per sample, increasing, from 0 to pi.
    phases : array_like, shape (m,)
        In radians.

    Returns
    -------
    ndarray, shape (N,)
        Persistently exciting of order 2 m. A frequency of 0 or pi contributes 1 instead of 2, and nothing if its phase
        is a multiple of pi: its samples are then zero.

    Raises
    ------
    ValueError
        If `samples` is below 1, the lengths differ, or the frequencies do not increase from 0 to pi.

    Notes
    -----
    Reading notes, lecture 6, input signal 4; Examples 7-1 and 8-1. For equal amplitudes and a low crest factor see
    `labsid.lab.excitation.sum_of_sinusoids`.
    """
    _check_samples(samples)
    amplitudes, omegas, phases = as_signals(amplitudes=amplitudes, omegas=omegas, phases=phases)
    if omegas[0] < 0 or omegas[-1] > np.pi or np.any(np.diff(omegas) <= 0):
        raise ValueError(f"omegas must increase, from 0 to pi radians per sample; got {omegas.tolist()}.")
    angles = omegas * np.arange(samples)[:, np.newaxis] + phases
    signal: FloatArray = np.sin(angles) @ amplitudes
    return signal


def feedback(model: PolynomialModel, r: ArrayLike, f: ArrayLike, e: ArrayLike | None = None) -> ClosedLoop:
    """Simulate a process under the known feedback ``u(k) = r(k) - F(q^-1) y(k)``, from rest.

    Parameters
    ----------
    model : PolynomialModel
        The process, with an input and a delay of at least one sample.
    r : array_like, shape (N,)
        Set-point signal.
    f : array_like
        Feedback polynomial, lowest delay first; ``[K]`` is a gain.
    e : array_like, shape (N,), optional
        Noise; default: none.

    Returns
    -------
    ClosedLoop

    Raises
    ------
    ValueError
        If the model has no input or no delay, the lengths differ, or the loop is unstable.

    Notes
    -----
    Reading notes, lecture 6, input signal 5. The loop is ``(A + q^-d B F) y = q^-d B r + C e``. With r = 0 and a
    constant gain, u is a multiple of y: Phi has dependent columns, and the model is not identifiable. It is
    identifiable with an exciting r or an F of higher order than the model.
    """
    f = as_signal("f", f)
    if not model.b.size or model.delay < 1:
        raise ValueError(
            "model must have an input with a delay of at least 1; otherwise u(k) and y(k) depend on each other."
        )
    loop = np.zeros(max(model.a.size, model.delay + model.b.size + f.size - 1))
    loop[: model.a.size] = model.a
    through = np.convolve(model.delayed_b, f)
    loop[: through.size] += through
    y = free_run(PolynomialModel(loop, model.b, model.c, model.delay, model.Ts), r, e)
    r = as_signal("r", r)
    return ClosedLoop(r, r - lfilter(f, 1.0, y), y)


def _check_samples(samples: int) -> None:
    if samples < 1:
        raise ValueError(f"samples must be at least 1; got {samples}.")
