"""Persistent excitation, and the three input signals that the lab recommends."""

from bisect import bisect_left
from dataclasses import dataclass

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import ArrayLike

from labsid._arrays import FloatArray, as_signal, freeze


@dataclass(frozen=True, slots=True, eq=False)
class Excitation:
    """Measures of the excitation by the regressors.

    Attributes
    ----------
    eigenvalues : ndarray, shape (p,)
        Eigenvalues of ``Phi'Phi / n``, largest first.
    rank : int
        Numerical rank of Phi.
    positive_definite : bool
        Whether ``Phi'Phi`` is positive definite, so that eq. (8) has a unique solution.
    condition_number : float
        Of Phi; that of ``Phi'Phi`` is its square. Infinite if the smallest eigenvalue is zero.
    """

    eigenvalues: FloatArray
    rank: int
    positive_definite: bool
    condition_number: float

    def __post_init__(self) -> None:
        freeze(self, eigenvalues=self.eigenvalues)


def persistent_excitation(Phi: ArrayLike) -> Excitation:
    """Test whether ``Phi'Phi`` has full rank and is positive definite.

    Parameters
    ----------
    Phi : array_like, shape (n, p)
        Regressors.

    Returns
    -------
    Excitation

    Raises
    ------
    ValueError
        If Phi is not a finite matrix.

    Notes
    -----
    UNSW lab, after eq. (8). Computed from the singular values s of Phi (the eigenvalues are s^2 / n); those
    below ``max(n, p) * eps`` times the largest count as zero. Measurement noise alone makes Phi'Phi positive
    definite, so check the condition number as well.
    """
    Phi = np.asarray(Phi, dtype=np.float64)
    if Phi.ndim != 2 or 0 in Phi.shape or not np.all(np.isfinite(Phi)):
        raise ValueError(f"Phi must be a finite matrix with one row per equation; got shape {Phi.shape}.")
    n, p = Phi.shape
    s = np.zeros(p)
    s[: min(n, p)] = np.linalg.svd(Phi, compute_uv=False)
    rank = int(np.sum(s > max(n, p) * np.finfo(float).eps * s[0]))
    return Excitation(
        eigenvalues=s**2 / n,
        rank=rank,
        positive_definite=rank == p,
        condition_number=float(s[0] / s[-1]) if s[-1] > 0 else np.inf,
    )


def excited_in_other_units(Phi: ArrayLike) -> bool:
    """Whether Phi has full rank once each column has length 1: then only the units make it singular.

    Parameters
    ----------
    Phi : array_like, shape (n, p)
        Regressors.

    Returns
    -------
    bool

    Raises
    ------
    ValueError
        If Phi is not a finite matrix.
    """
    Phi = np.asarray(Phi, dtype=np.float64)
    lengths = np.linalg.norm(Phi, axis=0)
    return bool(np.all(lengths > 0)) and persistent_excitation(Phi / lengths).positive_definite


def excitation_order(u: ArrayLike, largest: int = 50, rounding: float = 0.0) -> int:
    """Find the order to which a signal is persistently exciting.

    Parameters
    ----------
    u : array_like, shape (N,)
        The input, without its offset: a constant has order 1.
    largest : int
        Largest order to test.
    rounding : float
        Step to which the samples are rounded, in the unit of u; what it alone can make counts as zero.

    Returns
    -------
    int
        The largest n <= `largest` for which the matrix with the rows ``[u(k) .. u(k+n-1)]`` has full column
        rank; at most (N + 1) / 2. Order 2 n determines the 2 n unknowns of a model of order n. Less can suffice: order
        n if noise excites the past outputs, and a sinusoid of order 2 if the record begins with a transient.

    Raises
    ------
    ValueError
        If `largest` is below 1.

    Notes
    -----
    UNSW lab, "Selection of a Suitable Input". Zero has order 0, a constant 1, a sum of m sinusoids 2 m, a
    PRBS its period, a step at sample k the smaller of k + 1 and N - k. Singular values
    below ``N * eps`` times the largest count as zero; noise and transients therefore raise the order, however
    small they are.
    """
    u = as_signal("u", u)
    if largest < 1:
        raise ValueError(f"largest must be at least 1; got {largest}.")
    candidates = range(1, min(largest, (u.size + 1) // 2) + 1)
    return bisect_left(candidates, True, key=lambda n: _window_rank(u, n, rounding) < n)


def prbs(
    samples: int,
    levels: tuple[float, float] = (-1.0, 1.0),
    register: int = 9,
    hold: int = 1,
    rng: np.random.Generator | None = None,
) -> FloatArray:
    """Make a pseudo-random binary signal from a shift register with feedback.

    Parameters
    ----------
    samples : int
        Length N.
    levels : tuple of float
        The two levels.
    register : int
        Bits of the register, 2 to 32; the period is ``2**register - 1`` times `hold`.
    hold : int
        Samples for which each bit is held, so that slow systems have time to respond.
    rng : numpy.random.Generator, optional
        Draws the initial state of the register, which shifts the signal in time. The default state is all ones.

    Returns
    -------
    ndarray, shape (N,)

    Raises
    ------
    ValueError
        If a count is out of range.

    Notes
    -----
    UNSW lab, "Selection of a Suitable Input".
    """
    from scipy.signal import max_len_seq  # slow to import

    _check_count("samples", samples)
    _check_count("hold", hold)
    if not 2 <= register <= 32:
        raise ValueError(f"register must have 2 to 32 bits; got {register}.")
    state = None
    if rng is not None:
        bits = int(rng.integers(1, 2**register))
        state = [(bits >> place) & 1 for place in range(register)]
    sequence = max_len_seq(register, state=state, length=-(-samples // hold))[0]
    return np.where(np.repeat(sequence, hold)[:samples] == 1, levels[1], levels[0]).astype(np.float64)


def square_wave(samples: int, period: int, levels: tuple[float, float] = (-1.0, 1.0)) -> FloatArray:
    """Make a square wave that starts at its second level and spends half of each period at each level.

    Parameters
    ----------
    samples : int
        Length N.
    period : int
        Period in samples; at least 2.
    levels : tuple of float
        The two levels.

    Returns
    -------
    ndarray, shape (N,)

    Raises
    ------
    ValueError
        If a count is out of range.

    Notes
    -----
    UNSW lab, "Selection of a Suitable Input".
    """
    _check_count("samples", samples)
    _check_count("period", period, 2)
    return np.where(2 * (np.arange(samples) % period) < period, levels[1], levels[0]).astype(np.float64)


def sum_of_sinusoids(samples: int, periods: ArrayLike, amplitude: float = 1.0) -> FloatArray:
    """Make a sum of sinusoids of equal amplitude.

    Parameters
    ----------
    samples : int
        Length N.
    periods : array_like, shape (m,)
        The m periods in samples, each above 2.
    amplitude : float
        Amplitude of each sinusoid.

    Returns
    -------
    ndarray, shape (N,)
        Persistently exciting of order 2 m if the periods differ.

    Raises
    ------
    ValueError
        If `samples` is below 1 or a period is not above 2.

    Notes
    -----
    UNSW lab, "Selection of a Suitable Input". Schroeder's phases ``-pi i (i - 1) / m`` reduce the crest factor.
    """
    _check_count("samples", samples)
    periods = as_signal("periods", periods)
    if np.any(periods <= 2):
        raise ValueError(f"periods must be above 2 samples; got {periods.min():g}. Faster ones alias.")
    i = np.arange(1, periods.size + 1)
    phases = -np.pi * i * (i - 1) / periods.size
    angles = 2 * np.pi * np.arange(samples)[:, np.newaxis] / periods + phases
    return amplitude * np.cos(angles).sum(axis=1)


def _window_rank(u: FloatArray, n: int, rounding: float) -> int:
    s = np.linalg.svd(sliding_window_view(u, n), compute_uv=False)
    # White noise of variance rounding^2 / 12 has singular values up to its deviation times sqrt(N) + sqrt(n).
    by_rounding = 2.0 * rounding / np.sqrt(12.0) * (np.sqrt(u.size) + np.sqrt(n))
    return int(np.sum(s > max(u.size * np.finfo(float).eps * s[0], by_rounding)))


def _check_count(name: str, value: int, least: int = 1) -> None:
    if value < least:
        raise ValueError(f"{name} must be at least {least}; got {value}.")
