"""Model structures with delay: ARX, AR, ARMA, ARMAX, FIR and MA.

    A(q^-1) y(k) = q^-d B(q^-1) u(k) + C(q^-1) e(k)
    A = 1 + a1 q^-1 + ... + a_na q^-na,   C = 1 + c1 q^-1 + ... + c_nc q^-nc,   B has nb coefficients

As in the lectures, the minus sign of a1 .. a_na is in the regressor, ``phi(k) = [-y(k-1), ..., u(k-d), ..., e(k-1),
...]``, with ``theta = [a1, ..., b.., c1, ...]``. The lab has it in theta; see `labsid.lab.arx`.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from labsid._arrays import FloatArray, as_signal, as_signals, freeze
from labsid.least_squares.solve import LeastSquares, solve_least_squares
from labsid.records.several_signals import names_of, signal_columns


@dataclass(frozen=True, slots=True)
class Structure:
    """Numbers of coefficients and delay of a model.

    Attributes
    ----------
    na : int
        Number of coefficients a1 .. a_na, for past outputs.
    nb : int
        Number of coefficients of B, for inputs u(k - delay) .. u(k - delay - nb + 1). In the Reading notes the delay
        is 1 in lecture 3 (b1 first) and d in eq. (3) (b0 first; nb there is one less). For SUSTech's ARX(p, q) see
        `arx_pq`.
    nc : int
        Number of coefficients c1 .. c_nc, for past noise.
    delay : int
        Delay d of the input in samples; 0 for a direct path.
    """

    na: int
    nb: int
    nc: int = 0
    delay: int = 1

    def __post_init__(self) -> None:
        if min(self.na, self.nb, self.nc, self.delay) < 0 or self.parameters == 0:
            raise ValueError(
                "na, nb, nc and delay must be zero or more and leave a parameter; got "
                f"{self.na}, {self.nb}, {self.nc} and {self.delay}."
            )

    @property
    def parameters(self) -> int:
        """Length of theta."""
        return self.na + self.nb + self.nc

    @property
    def longest_lag(self) -> int:
        """First sample k (zero-based) for which all lags were recorded; SUSTech's k0 minus one."""
        return max(self.na, self.nc, self.delay + self.nb - 1 if self.nb else 0)

    @property
    def kind(self) -> str:
        """The acronym, ARX, AR, ARMA, ARMAX, FIR or MA."""
        if self.nb:
            return "ARMAX" if self.nc else ("ARX" if self.na else "FIR")
        return ("AR" if self.na else "") + ("MA" if self.nc else "")


@dataclass(frozen=True, slots=True, eq=False)
class PolynomialModel:
    """A model of one of these structures, with its coefficients.

    Attributes
    ----------
    a : ndarray, shape (na + 1,)
        ``[1, a1, ...]``.
    b : ndarray, shape (nb,)
        Coefficients of B, the first for u(k - delay); empty without input.
    c : ndarray, shape (nc + 1,)
        ``[1, c1, ...]``.
    delay : int
    Ts : float
        Sampling time in seconds.
    """

    a: FloatArray
    b: FloatArray
    c: FloatArray
    delay: int = 1
    Ts: float = 1.0

    def __post_init__(self) -> None:
        a, b, c = as_signal("a", self.a), as_signal("b", self.b, at_least=0), as_signal("c", self.c)
        if a[0] != 1 or c[0] != 1:
            raise ValueError(f"a and c must start with 1; got {a[0]:g} and {c[0]:g}. Divide all by that coefficient.")
        if self.delay < 0:
            raise ValueError(f"delay must be zero or more; got {self.delay}.")
        if not (np.isfinite(self.Ts) and self.Ts > 0):
            raise ValueError(f"Ts must be a positive number of seconds; got {self.Ts}.")
        freeze(self, a=a, b=b, c=c)

    @property
    def structure(self) -> Structure:
        """The structure of the model."""
        return Structure(self.a.size - 1, self.b.size, self.c.size - 1, self.delay)

    @property
    def theta(self) -> FloatArray:
        """``[a1, ..., b.., c1, ...]``, in the order and with the signs of the lectures."""
        return np.concatenate([self.a[1:], self.b, self.c[1:]])

    @property
    def delayed_b(self) -> FloatArray:
        """Coefficients of ``q^-d B(q^-1)``; ``[0]`` without input."""
        return np.concatenate([np.zeros(self.delay), self.b]) if self.b.size else np.zeros(1)


@dataclass(frozen=True, slots=True, eq=False)
class Regression:
    """The linear regression ``Y = Phi theta`` of a structure.

    Attributes
    ----------
    Phi : ndarray, shape (n, p)
        SUSTech's H; row k - start is phi'(k).
    Y : ndarray, shape (n,)
        ``y(k)``, k = start .. stop - 1.
    structure : Structure
    start, stop : int
        The rows are the samples k = start .. stop - 1 (zero-based).
    """

    Phi: FloatArray
    Y: FloatArray
    structure: Structure
    start: int
    stop: int

    def __post_init__(self) -> None:
        freeze(self, Phi=self.Phi, Y=self.Y)

    @property
    def order(self) -> int:
        """Order na of the difference equation."""
        return self.structure.na


@dataclass(frozen=True, slots=True, eq=False)
class StructureFit:
    """An identified model with its regression and least-squares result.

    Attributes
    ----------
    model : PolynomialModel
    regression : Regression
    fit : LeastSquares
    """

    model: PolynomialModel
    regression: Regression
    fit: LeastSquares


def arx_pq(p: int, q: int) -> Structure:
    """Return the structure of SUSTech's ARX(p, q): alpha_1 .. alpha_p and beta_0 .. beta_q, no delay.

    Parameters
    ----------
    p : int
        Largest lag of the output.
    q : int
        Largest lag of the input.

    Returns
    -------
    Structure

    Notes
    -----
    SUSTech lecture, "Application to System Identification". There are q + 1 coefficients of the input.
    """
    return Structure(na=p, nb=q + 1, delay=0)


def model_from_theta(structure: Structure, theta: ArrayLike, Ts: float = 1.0) -> PolynomialModel:
    """Convert ``theta = [a1, ..., b.., c1, ...]`` to a model.

    Parameters
    ----------
    structure : Structure
    theta : array_like, shape (p,)
    Ts : float
        Sampling time in seconds.

    Returns
    -------
    PolynomialModel

    Raises
    ------
    ValueError
        If theta does not have one entry per coefficient.
    """
    theta = as_signal("theta", theta)
    if theta.size != structure.parameters:
        raise ValueError(
            f"theta must have one entry per coefficient of the {structure.kind} model ({structure.parameters}); "
            f"got {theta.size}."
        )
    a, b, c = np.split(theta, [structure.na, structure.na + structure.nb])
    return PolynomialModel(np.concatenate([[1.0], a]), b, np.concatenate([[1.0], c]), structure.delay, Ts)


def build_equations(
    structure: Structure,
    u: ArrayLike | None,
    y: ArrayLike,
    e: ArrayLike | None = None,
    start: int | None = None,
    stop: int | None = None,
) -> Regression:
    """Stack ``phi'(k) = [-y(k-1) .., u(k-d) .., e(k-1) ..]`` into Phi.

    Parameters
    ----------
    structure : Structure
    u : array_like, shape (N,), or None
        Input; None for AR and ARMA. With several, shape (N, nu), a block of lags for each.
    y : array_like, shape (N,)
        Output.
    e : array_like, shape (N,), optional
        Noise, for nc > 0: the true noise of a simulation, or the prediction errors in pseudo-linear regression.
    start, stop : int, optional
        Rows for the samples k = start .. stop - 1; default: from `Structure.longest_lag` to the last sample. Lags
        before sample 0 are zero.

    Returns
    -------
    Regression

    Raises
    ------
    ValueError
        If a signal that the structure uses is missing, the lengths differ, or there are fewer rows than unknowns.

    Notes
    -----
    Reading notes, lecture 3 and Example 2-3 (an FIR with ``delay=0, nb=3``, from sample 0); SUSTech lecture,
    "Regressor". Errata: the notes call ARMAX a linear regression; it is pseudo-linear, because e is not measured.
    """
    y = as_signal("y", y)
    columns = [-_lagged(y, lag) for lag in range(1, structure.na + 1)]
    for name, x, lags in (
        ("u", u, range(structure.delay, structure.delay + structure.nb)),
        ("e", e, range(1, structure.nc + 1)),
    ):
        if not lags:
            continue
        if x is None:
            raise ValueError(f"{name} must be given: the {structure.kind} structure has coefficients of it.")
        signals = signal_columns(x)
        for label, column in zip(names_of(name, (), len(signals)), signals, strict=True):
            checked = as_signals(1, **{label: column, "y": y})[0]
            columns += [_lagged(checked, lag) for lag in lags]
    start = structure.longest_lag if start is None else start
    stop = y.size if stop is None else stop
    if not 0 <= start < stop <= y.size:
        raise ValueError(
            f"start and stop must satisfy 0 <= start < stop <= {y.size} (the number of samples); got start {start} and "
            f"stop {stop}. Give a longer record or a smaller model."
        )
    if stop - start < len(columns):
        raise ValueError(
            f"the model has {len(columns)} unknowns and needs at least as many rows; got {stop - start} "
            f"(samples {start} to {stop - 1}). Give more samples or a smaller model."
        )
    return Regression(np.column_stack(columns)[start:stop], y[start:stop], structure, start, stop)


def fit_structure(
    structure: Structure, u: ArrayLike | None, y: ArrayLike, Ts: float = 1.0, start: int | None = None
) -> StructureFit:
    """Identify an ARX, AR or FIR model by linear least squares.

    Parameters
    ----------
    structure : Structure
        With nc = 0.
    u : array_like, shape (N,), or None
        Input; None for AR.
    y : array_like, shape (N,)
        Output.
    Ts : float
        Sampling time in seconds.
    start : int, optional
        First row; see `build_equations`.

    Returns
    -------
    StructureFit
        ``fit.status`` tells whether the parameters are unique.

    Raises
    ------
    ValueError
        If the structure has noise coefficients, or as `build_equations`.

    Notes
    -----
    Reading notes, Example 3-1; SUSTech lecture, "System ID problem for ARX model".
    """
    if structure.nc:
        raise ValueError(
            f"nc must be 0 for linear least squares; got {structure.nc}. The noise is not measured: use pseudo-linear "
            "regression or maximum likelihood."
        )
    regression = build_equations(structure, None if u is None else as_signal("u", u), y, start=start)
    fit = solve_least_squares(regression.Phi, regression.Y)
    return StructureFit(model_from_theta(structure, fit.theta, Ts), regression, fit)


def _lagged(x: FloatArray, lag: int) -> FloatArray:
    """``x(k - lag)`` for every k, zero before sample 0; the lag may exceed the record."""
    return np.concatenate([np.zeros(min(lag, x.size)), x[: max(x.size - lag, 0)]])
