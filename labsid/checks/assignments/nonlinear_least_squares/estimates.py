"""Reading what the functions of the nonlinear lecture return, and tolerances measured in standard errors."""

from collections.abc import Callable, Iterable, Iterator

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import least_squares

from labsid._arrays import FloatArray
from labsid.checks.compare import as_vector
from labsid.checks.values import Value
from labsid.checks.verdict import NoAnswer
from labsid.nonlinear.solve import levenberg_marquardt


def within(stderr: FloatArray, share: float = 0.05) -> Callable[[ArrayLike, ArrayLike], bool]:
    """Make a comparison of estimates: nearer than this share of their standard errors.

    Iterations stop at different tolerances. What lies so far below the noise is the same answer.
    """
    tolerance = share * np.asarray(stderr, float)

    def same(a: ArrayLike, b: ArrayLike) -> bool:
        x, y = np.asarray(a, float), np.asarray(b, float)
        return x.shape == y.shape and bool(np.all(np.abs(x - y) <= tolerance + 1e-7 * np.abs(y)))

    return same


SQUARED = (
    "hands `least_squares` the *squared* errors. It squares and adds up what it is handed: hand it the "
    "errors themselves."
)

SUMMED = (
    "hands `least_squares` the *sum* of the squared errors. It squares and adds up what it is handed: hand it the "
    "errors themselves, one for each point."
)


def fits_of_sum(
    g: Callable[[FloatArray], FloatArray], y: FloatArray, starts: Iterable[ArrayLike]
) -> Iterator[Callable[[], FloatArray]]:
    """The estimates, one for each start, from the sum of squared errors in the place of the errors.

    With one number to fit and several parameters, the search stops in the valley of the sum, before its lowest point.
    """
    for start in starts:
        yield lambda start=start: np.asarray(least_squares(lambda theta: np.sum((g(theta) - y) ** 2), start).x)  # type: ignore[misc]


def fit_of_squares(
    g: Callable[[FloatArray], FloatArray], jacobian: Callable[[FloatArray], FloatArray], y: FloatArray, start: ArrayLike
) -> FloatArray:
    """The estimate from squared errors that are squared once more."""
    return levenberg_marquardt(
        lambda theta: (y - g(theta)) ** 2,
        lambda theta: -2 * (y - g(theta))[:, np.newaxis] * jacobian(theta),
        np.zeros(y.size),
        start,
    ).theta


def as_estimate(call: str, value: Value, size: int) -> FloatArray:
    """An estimate; what `scipy.optimize.least_squares` or `curve_fit` returns as a whole is named as such."""
    if isinstance(value, dict) and "x" in value:
        raise NoAnswer(
            f"`{call}` returns all that `least_squares` returns: take the solution out of it, `.x`.",
            "all of the result",
        )
    if isinstance(value, tuple) and len(value) in (2, 4) and isinstance(value[0], np.ndarray):
        raise NoAnswer(
            f"`{call}` returns more than the estimate: return its first part only, `[0]`.", "all of the result"
        )
    return as_vector(call, value, size)
