"""Model order: loss against order, information criteria, F test, and pole-zero cancellation."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.special import fdtrc

from labsid._arrays import FloatArray, as_signal, freeze
from labsid.least_squares.solve import LeastSquares
from labsid.model_structures.structures import Structure, fit_structure


@dataclass(frozen=True, slots=True, eq=False)
class OrderScan:
    """Structures fitted to the same equations.

    Attributes
    ----------
    structures : tuple of Structure
    rows : int
        Number of equations N.
    parameters : ndarray, shape (m,)
        Number of parameters p.
    loss : ndarray, shape (m,)
        ``V = 1/N sum epsilon^2``, in the square of the unit of y (Fig. 15).
    aic, bic : ndarray, shape (m,)
        ``N ln V + 2 p`` and ``N ln V + p ln N``; minus infinity for a perfect fit.
    fpe : ndarray, shape (m,)
        ``V (1 + p/N) / (1 - p/N)``, the final prediction error: the expected loss on new data.
    condition_number : ndarray, shape (m,)
        Of Phi; a large increase is a sign of over-parameterisation.
    """

    structures: tuple[Structure, ...]
    rows: int
    parameters: FloatArray
    loss: FloatArray
    aic: FloatArray
    bic: FloatArray
    fpe: FloatArray
    condition_number: FloatArray

    def __post_init__(self) -> None:
        freeze(self, parameters=self.parameters, loss=self.loss, aic=self.aic, bic=self.bic, fpe=self.fpe)
        freeze(self, condition_number=self.condition_number)


@dataclass(frozen=True, slots=True)
class FTest:
    """F test of a model against a smaller one nested in it.

    Attributes
    ----------
    statistic : float
        Reduction of the loss per added parameter, over the remaining loss per degree of freedom.
    added : int
        Number of added parameters.
    degrees_of_freedom : int
        Equations minus parameters of the larger model.
    p_value : float
        Probability of an equal or larger statistic if the added parameters are zero.
    """

    statistic: float
    added: int
    degrees_of_freedom: int
    p_value: float


@dataclass(frozen=True, slots=True, eq=False)
class RootPairs:
    """Pairs of zeros and poles.

    Attributes
    ----------
    zeros, poles : ndarray of complex, shape (m,)
        Roots in z; the i-th zero is paired with the i-th pole, closest pair first.
    distance : ndarray, shape (m,)
        ``|zero - pole|``; zero if the two cancel.
    """

    zeros: NDArray[np.complex128]
    poles: NDArray[np.complex128]
    distance: FloatArray

    def __post_init__(self) -> None:
        freeze(self, distance=self.distance)


def loss_against_order(structures: Sequence[Structure], u: ArrayLike | None, y: ArrayLike) -> OrderScan:
    """Fit several structures to the same rows and compute loss and information criteria.

    Parameters
    ----------
    structures : sequence of Structure
        With nc = 0.
    u : array_like, shape (N,), or None
        Input; None for AR.
    y : array_like, shape (N,)
        Output.

    Returns
    -------
    OrderScan

    Raises
    ------
    ValueError
        If there is no structure, or as `fit_structure`.

    Notes
    -----
    Reading notes, lecture 7, "Determining the model structure" and Fig. 15. The larger of two nested models has at
    most the same loss, if both are fitted to *the same rows*; hence the common start. AIC, BIC and FPE penalize
    parameters: BIC is consistent, AIC and FPE tend to overestimate the order slightly. A rank-deficient fit counts
    all its parameters.
    """
    if not structures:
        raise ValueError("structures must hold at least one structure; got none.")
    start = max(structure.longest_lag for structure in structures)
    fits = [fit_structure(structure, u, y, start=start).fit for structure in structures]
    N = fits[0].residual.size
    p = np.array([float(structure.parameters) for structure in structures])
    V = np.array([2 * fit.loss / N for fit in fits])
    with np.errstate(divide="ignore"):  # a perfect fit has loss zero
        log_loss = N * np.log(V)
        fpe = np.where(p < N, V * (1 + p / N) / (1 - p / N), np.inf)
    return OrderScan(
        structures=tuple(structures),
        rows=N,
        parameters=p,
        loss=V,
        aic=log_loss + 2 * p,
        bic=log_loss + p * np.log(N),
        fpe=fpe,
        condition_number=np.array([fit.condition_number for fit in fits]),
    )


def compare_models(smaller: LeastSquares, larger: LeastSquares) -> FTest:
    """Test whether the larger of two nested fits is a significant improvement.

    Parameters
    ----------
    smaller, larger : LeastSquares
        Fits to the same Y; the regressors of the smaller are among those of the larger.

    Returns
    -------
    FTest

    Raises
    ------
    ValueError
        If the numbers of equations differ, the larger does not have more parameters, or there is no degree of
        freedom.

    Notes
    -----
    Reading notes, lecture 7: "whether or not the improvement in the fit is significant". The F test of linear
    regression, asymptotic for lagged outputs.
    """
    rows, p1, p2 = larger.residual.size, smaller.theta.size, larger.theta.size
    if smaller.residual.size != rows:
        raise ValueError(
            f"both fits must solve the same equations; got {smaller.residual.size} and {rows} of them. "
            "Fit both from the same start."
        )
    if not p1 < p2 < rows:
        raise ValueError(
            f"larger must have more parameters than smaller and fewer than equations ({rows}); got {p2} and {p1}."
        )
    per_parameter = max(smaller.loss - larger.loss, 0.0) / (p2 - p1)
    per_freedom = larger.loss / (rows - p2)
    statistic = per_parameter / per_freedom if per_freedom > 0 else (np.inf if per_parameter > 0 else 0.0)
    return FTest(statistic, p2 - p1, rows - p2, float(fdtrc(p2 - p1, rows - p2, statistic)))


def pair_roots(numerator: ArrayLike, denominator: ArrayLike) -> RootPairs:
    """Pair the zeros of a model with its poles, to find those that cancel.

    Parameters
    ----------
    numerator, denominator : array_like
        Polynomials in q^-1, lowest delay first: B or C, and A. Leading zeros of B are a delay, not roots.

    Returns
    -------
    RootPairs
        Their number is the lower of the two degrees.

    Raises
    ------
    ValueError
        If a polynomial is zero.

    Notes
    -----
    Reading notes, Example 7-2: ``(1 + c q^-1)(1 + d q^-1)`` over ``(1 + a q^-1)(1 + d q^-1)``, C over A, describes the
    same process for every d. The closest pair is matched first, then the closest of the remaining roots. Whether a pair
    cancels depends on the standard errors of the parameters.
    """
    zeros, poles = (_roots(name, p) for name, p in (("numerator", numerator), ("denominator", denominator)))
    distances = np.abs(zeros[:, np.newaxis] - poles)
    pairs: list[tuple[int, int]] = []
    for flat in np.argsort(distances, axis=None, kind="stable"):
        i, j = divmod(int(flat), poles.size)
        if all(i != taken_i and j != taken_j for taken_i, taken_j in pairs):
            pairs.append((i, j))
    rows, columns = [i for i, _ in pairs], [j for _, j in pairs]
    return RootPairs(zeros[rows], poles[columns], distances[rows, columns])


def _roots(name: str, polynomial: ArrayLike) -> NDArray[np.complex128]:
    coefficients = as_signal(name, polynomial)
    if not np.any(coefficients):
        raise ValueError(f"{name} must not be zero everywhere.")
    return np.roots(coefficients).astype(np.complex128)
