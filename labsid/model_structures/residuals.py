"""Residual tests of a model: the residual must be white and uncorrelated with the input."""

from dataclasses import dataclass

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import ArrayLike
from scipy.special import chdtrc, ndtri

from labsid._arrays import FloatArray, as_signals, freeze
from labsid.least_squares.linear_algebra import singular_values


@dataclass(frozen=True, slots=True, eq=False)
class Correlation:
    """Correlation coefficients by lag, with their confidence band for uncorrelated signals.

    Attributes
    ----------
    lags : ndarray, shape (m,)
        In samples.
    values : ndarray, shape (m,)
        Correlation coefficients, -1 to 1.
    band : float
        Half width: uncorrelated signals stay within ``+-band`` at each lag with probability `confidence`.
    confidence : float
    """

    lags: FloatArray
    values: FloatArray
    band: float
    confidence: float

    def __post_init__(self) -> None:
        freeze(self, lags=self.lags, values=self.values)

    @property
    def outside(self) -> FloatArray:
        """Lags outside the band, except lag 0 of an autocorrelation; a share of ``1 - confidence`` is expected."""
        beyond = np.abs(self.values) > self.band
        return self.lags[beyond & ~((self.lags == 0) & (self.values == 1))]


@dataclass(frozen=True, slots=True)
class PortmanteauTest:
    """Result of a joint test of several lags.

    Attributes
    ----------
    statistic : float
        Asymptotically chi-square distributed if there is no correlation.
    degrees_of_freedom : int
    p_value : float
        Probability of an equal or larger statistic without correlation; a small value rejects the model.
    """

    statistic: float
    degrees_of_freedom: int
    p_value: float


def autocorrelation(e: ArrayLike, lags: int = 20, confidence: float = 0.95) -> Correlation:
    """Estimate the autocorrelation coefficients of a residual, with their band for a white one.

    Parameters
    ----------
    e : array_like, shape (N,)
        Prediction errors. Their mean is removed.
    lags : int
        Largest lag; the result contains lags 0 .. `lags`.
    confidence : float
        Of the band, at each lag.

    Returns
    -------
    Correlation
        ``r(k) = sum e(t) e(t-k) / sum e(t)^2``, with the band ``z / sqrt(N)``.

    Raises
    ------
    ValueError
        If e is constant, `lags` exceeds the record, or `confidence` is not between 0 and 1.

    Notes
    -----
    Reading notes, Fig. 12. Use *prediction* errors: simulation errors are coloured even for the true model.
    """
    (e,) = _centred(lags, e=e)
    values = _covariances(e, e, lags) / (e @ e)
    return Correlation(np.arange(lags + 1.0), values, _quantile(confidence) / np.sqrt(e.size), confidence)


def cross_correlation(u: ArrayLike, e: ArrayLike, lags: int = 20, confidence: float = 0.95) -> Correlation:
    """Estimate the cross-correlation coefficients of input and residual, with their band for independent signals.

    Parameters
    ----------
    u, e : array_like, shape (N,)
        Input and prediction errors. Their means are removed.
    lags : int
        Largest lag; the result contains lags -`lags` .. `lags`.
    confidence : float
        Of the band, at each lag.

    Returns
    -------
    Correlation
        ``r(k) = sum e(t) u(t-k) / sqrt(sum e^2 sum u^2)``. Correlation at k >= 0 indicates unmodelled dynamics, at
        k < 0 feedback from the output to the input.

    Raises
    ------
    ValueError
        If the lengths differ, a signal is constant, `lags` exceeds the record, or `confidence` is not between 0
        and 1.

    Notes
    -----
    As Fig. 12, for the input. The band is ``z sqrt(P / N)``, ``P = sum r_e(k) r_u(k)``: it is wider if both signals
    are coloured. The sum is tapered up to `lags`, which keeps P positive. Least squares makes the
    sum of e(t) u(t-k) over its own rows zero at the lags k of u that are in phi. The coefficients at these lags are
    therefore small, but not exactly zero, since the means are removed and the sums are cut at the ends.
    """
    u, e = _centred(lags, u=u, e=e)
    ahead, behind = _covariances(e, u, lags), _covariances(u, e, lags)
    values = np.concatenate([behind[:0:-1], ahead]) / np.sqrt((e @ e) * (u @ u))
    products = (_covariances(e, e, lags) / (e @ e)) * (_covariances(u, u, lags) / (u @ u))
    taper = 1 - np.arange(lags + 1) / (lags + 1)
    P = 2 * float(taper @ products) - 1
    return Correlation(np.arange(-lags, lags + 1.0), values, _quantile(confidence) * np.sqrt(P / e.size), confidence)


def whiteness_test(e: ArrayLike, lags: int = 20, parameters: int = 0) -> PortmanteauTest:
    """Test all autocorrelations up to a lag at once (Ljung and Box).

    Parameters
    ----------
    e : array_like, shape (N,)
        Prediction errors. Their mean is removed.
    lags : int
        Number of lags, 1 .. `lags`.
    parameters : int
        Parameters of the noise model fitted to this record (na + nc); they reduce the degrees of freedom.

    Returns
    -------
    PortmanteauTest
        ``Q = N (N + 2) sum r(k)^2 / (N - k)``.

    Raises
    ------
    ValueError
        If e is constant, `lags` exceeds the record, or `parameters` leaves no degree of freedom.

    Notes
    -----
    Reading notes, lecture 1, step 5, "Model validation"; a test of the assumption "e(t) is white" of lecture 6.
    """
    if not 0 <= parameters < lags:
        raise ValueError(f"parameters must lie between 0 and lags - 1 = {lags - 1}; got {parameters}. Use more lags.")
    return ljung_box(autocorrelation(e, lags).values[1:], np.size(e), parameters)


def ljung_box(r: ArrayLike, samples: int, parameters: int = 0) -> PortmanteauTest:
    """Test given autocorrelation coefficients, for example those of a record with gaps.

    Parameters
    ----------
    r : array_like, shape (m,)
        Coefficients at the lags 1 .. m.
    samples : int
        Number of samples N from which they were estimated.
    parameters : int
        As in `whiteness_test`.

    Returns
    -------
    PortmanteauTest
    """
    r = np.asarray(r)
    statistic = samples * (samples + 2) * float(np.sum(r**2 / (samples - np.arange(1, r.size + 1))))
    free = r.size - parameters
    return PortmanteauTest(statistic, free, float(chdtrc(free, statistic)))


def input_residual_test(u: ArrayLike, e: ArrayLike, first: int, lags: int = 20) -> PortmanteauTest:
    """Test whether a white residual is correlated with several past inputs.

    Parameters
    ----------
    u, e : array_like, shape (N,)
        Input and prediction errors. Their means are removed.
    first : int
        First lag, 0 or more. Start after the lags of u that are in phi (at delay + nb): their correlation is
        nearly zero by construction.
    lags : int
        Number of lags, first .. first + lags - 1.

    Returns
    -------
    PortmanteauTest
        ``e'U (U'U)^-1 U'e / s^2`` with the lags of u as columns of U; this is ``N r' R^-1 r`` for the
        cross-correlations r and the autocorrelation matrix R of u. The degrees of freedom are the rank of U: two for
        a single sinusoid.

    Raises
    ------
    ValueError
        If the lengths differ, a signal is constant, or the lags exceed the record.

    Notes
    -----
    Valid for a white residual (apply `whiteness_test` first). The fitted parameters absorb some of the correlation, so
    that a true model is rejected somewhat less often than the p-value indicates.
    """
    if first < 0 or lags < 1:
        raise ValueError(f"first must be at least 0 and lags at least 1; got {first} and {lags}.")
    u, e = _centred(first + 2 * lags, u=u, e=e)
    U = sliding_window_view(u[: u.size - first], lags)
    rows = e[first + lags - 1 :] - e[first + lags - 1 :].mean()
    parts = singular_values(U - U.mean(axis=0))
    explained = parts.U[:, : parts.rank].T @ rows
    statistic = float(explained @ explained) / float(np.mean(rows**2))
    return PortmanteauTest(statistic, parts.rank, float(chdtrc(parts.rank, statistic)))


def _covariances(x: FloatArray, w: FloatArray, lags: int) -> FloatArray:
    """``sum x(t) w(t-k)``, k = 0 .. lags."""
    return np.array([x[k:] @ w[: w.size - k] for k in range(lags + 1)])


def _centred(lags: int, **signals: ArrayLike) -> list[FloatArray]:
    arrays = as_signals(1, **signals)
    if not 1 <= lags < arrays[0].size:
        raise ValueError(
            f"lags must be at least 1 and less than the {arrays[0].size} samples; got {lags}. Use fewer lags."
        )
    for name, array in zip(signals, arrays, strict=True):
        if np.ptp(array) == 0:
            raise ValueError(f"{name} must vary to have a correlation; got {array[0]:g} throughout.")
    return [array - array.mean() for array in arrays]


def _quantile(confidence: float) -> float:
    if not 0 < confidence < 1:
        raise ValueError(f"confidence must lie between 0 and 1; got {confidence}. For 95 % give 0.95.")
    return float(ndtri((1 + confidence) / 2))
