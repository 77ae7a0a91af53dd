"""Steps along the gradient in the place of a solution or of a Gauss-Newton step."""

from collections.abc import Iterator

import numpy as np

from labsid._arrays import FloatArray
from labsid.checks.answer_code import AnswerCode
from labsid.checks.compare import close

_same = close(1e-6)
_MOST_STEPS = 10**7
_PARALLEL = 1e-9


def descent_of(code: AnswerCode | None, got: FloatArray, M: FloatArray, v: FloatArray) -> tuple[int, float] | None:
    """The steps from zero against the gradient of the loss whose end is an answer, if their numbers are in its code.

    Parameters
    ----------
    code : AnswerCode or None
    got : ndarray, shape (p,)
    M, v : ndarray
        Of the equations ``M x = v``; the gradient at x is ``M x - v``, or twice that.

    Returns
    -------
    tuple of int and float, or None
        How many steps, and the factor of the gradient in each.
    """
    if code is None or not code.has_loop:
        return None
    lam, V = np.linalg.eigh(M)
    if not np.all(lam > 0):
        return None
    end = V.T @ v / lam
    for steps, factor in _pairs(code):
        for times in (1.0, 2.0):
            with np.errstate(all="ignore"):
                reached = V @ (end * (1 - (1 - times * factor * lam) ** steps))
            if np.all(np.isfinite(reached)) and _same(got, reached):
                return steps, factor
    return None


def _pairs(code: AnswerCode) -> Iterator[tuple[int, float]]:
    """Each whole number in the code as a number of steps, with each other number as their factor."""
    for steps in sorted(code.numbers):
        if steps == round(steps) and 1 < steps <= _MOST_STEPS:
            yield from ((round(steps), factor) for factor in sorted(code.numbers) if factor not in (0.0, steps))


def gradient_factor(steps: FloatArray, gradients: FloatArray) -> float | None:
    """The one factor c of steps that are all -c times the gradient at their start; None if there is none.

    Parameters
    ----------
    steps, gradients : ndarray, shape (n, p)
        Of at least two unknowns, as in one unknown every step lies along the gradient.
    """
    if steps.shape != gradients.shape or steps.shape[1] < 2 or not np.isfinite(gradients).all():
        return None
    size = float(np.sum(gradients**2))
    c = -float(np.sum(steps * gradients)) / size if size else 0.0
    is_one = bool(np.max(np.abs(steps + c * gradients)) <= _PARALLEL * np.max(np.abs(steps), initial=0.0))
    return c if c and is_one else None
