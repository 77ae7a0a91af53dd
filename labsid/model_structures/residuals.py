"""Is the model good enough? The residual must be white and uncorrelated with the input."""

from dataclasses import dataclass

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import ArrayLike
from scipy.special import chdtrc, ndtri

from labsid._arrays import FloatArray, as_signals, freeze
from labsid.least_squares.linear_algebra import singular_values


@dataclass(frozen=True, slots=True, eq=False)
class Correlation:
    """Correlation coefficients by lag, with the band that chance alone keeps to.

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
        """Lags, other than 0 of an autocorrelation, at which the band is left; ``1 - confidence`` of them by chance."""
        beyond = np.abs(self.values) > self.band
        return self.lags[beyond & ~((self.lags == 0) & (self.values == 1))]


@dataclass(frozen=True, slots=True)
class PortmanteauTest:
    """All lags in one number.

    Attributes
    ----------
    statistic : float
        Chi-square distributed, for large N, if there is no correlation.
    degrees_of_freedom : int
    p_value : float
        How likely so large a statistic would be without correlation: a small one rejects the model.
    """

    statistic: float
    degrees_of_freedom: int
    p_value: float


def autocorrelation(e: ArrayLike, lags: int = 20, confidence: float = 0.95) -> Correlation:
    """Estimate the autocorrelation coefficients of a residual and their band if it is white.

    Parameters
    ----------
    e : array_like, shape (N,)
        Prediction errors. Their mean is removed.
    lags : int
        Largest lag; the result holds lags 0 .. `lags`.
    confidence : float
        Of the band, at each lag by itself.

    Returns
    -------
    Correlation
        ``r(k) = sum e(t) e(t-k) / sum e(t)^2``, with the band ``z / sqrt(N)``.

    Raises
    ------
    ValueError
        If e is constant, `lags` does not fit the record, or `confidence` is not between 0 and 1.

    Notes
    -----
    Reading notes, Fig. 12. Of *prediction* errors: those of a simulation are coloured even for the true model.
    """
    (e,) = _centred(lags, e=e)
    values = _covariances(e, e, lags) / (e @ e)
    return Correlation(np.arange(lags + 1.0), values, _quantile(confidence) / np.sqrt(e.size), confidence)


def cross_correlation(u: ArrayLike, e: ArrayLike, lags: int = 20, confidence: float = 0.95) -> Correlation:
    """Estimate how a residual depends on the input, and the band if it does not.

    Parameters
    ----------
    u, e : array_like, shape (N,)
        Input and prediction errors. Their means are removed.
    lags : int
        Largest lag; the result holds lags -`lags` .. `lags`.
    confidence : float
        Of the band, at each lag by itself.

    Returns
    -------
    Correlation
        ``r(k) = sum e(t) u(t-k) / sqrt(sum e^2 sum u^2)``. At k >= 0 it tells dynamics that the model misses; at k < 0
        feedback from the output to the input.

    Raises
    ------
    ValueError
        If the lengths differ, a signal is constant, `lags` does not fit the record, or `confidence` is not between 0
        and 1.

    Notes
    -----
    The companion of Fig. 12 for the input. The band is ``z sqrt(P / N)``, ``P = sum r_e(k) r_u(k)``: where both
    signals are coloured, neighbouring samples count as fewer. The sum is tapered up to `lags`, which keeps P positive.
    Least squares makes the lags of u that are in phi exactly zero.
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
        How many lags, 1 .. `lags`, to put together.
    parameters : int
        Parameters of the noise model fitted to this record (na + nc); they use up degrees of freedom.

    Returns
    -------
    PortmanteauTest
        ``Q = N (N + 2) sum r(k)^2 / (N - k)``.

    Raises
    ------
    ValueError
        If e is constant, `lags` does not fit the record, or `parameters` leaves no degree of freedom.

    Notes
    -----
    Reading notes, lecture 1, step 5, "Model validation": the assumption "e(t) is white" of lecture 6, tested.
    """
    if not 0 <= parameters < lags:
        raise ValueError(f"parameters must lie between 0 and lags - 1 = {lags - 1}; got {parameters}. Use more lags.")
    return ljung_box(autocorrelation(e, lags).values[1:], np.size(e), parameters)


def ljung_box(r: ArrayLike, samples: int, parameters: int = 0) -> PortmanteauTest:
    """Test autocorrelation coefficients that are already estimated, for example from a record with gaps.

    Parameters
    ----------
    r : array_like, shape (m,)
        Coefficients at the lags 1 .. m.
    samples : int
        Number of samples N behind them.
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
    """Test whether several past inputs together explain anything of a white residual.

    Parameters
    ----------
    u, e : array_like, shape (N,)
        Input and prediction errors. Their means are removed.
    first : int
        First lag, 0 or more. Those of u that are in phi are zero by construction and tell nothing: start after them
        (delay + nb).
    lags : int
        How many lags, first .. first + lags - 1, to put together.

    Returns
    -------
    PortmanteauTest
        ``e'U (U'U)^-1 U'e / s^2``, the columns of U being the lags of u, in other words ``N r' R^-1 r`` of the
        cross-correlations r and the autocorrelation matrix R of u. The degrees of freedom are the rank of U: of a
        single sinusoid all lags say the same as two.

    Raises
    ------
    ValueError
        If the lengths differ, a signal is constant, or the lags do not fit the record.

    Notes
    -----
    Needs a white residual (`whiteness_test` first). The fitted parameters have already taken up some of the
    correlation, so that a true model is rejected somewhat less often than the p-value says.
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
            f"lags must be at least 1 and reach less far than the {arrays[0].size} samples; got {lags}. Use fewer lags."
        )
    for name, array in zip(signals, arrays, strict=True):
        if np.ptp(array) == 0:
            raise ValueError(f"{name} must vary to have a correlation; got {array[0]:g} throughout.")
    return [array - array.mean() for array in arrays]


def _quantile(confidence: float) -> float:
    if not 0 < confidence < 1:
        raise ValueError(f"confidence must lie between 0 and 1; got {confidence}. For 95 % give 0.95.")
    return float(ndtri((1 + confidence) / 2))
