"""Recursive identification online: estimators that take one sample a call, in one or two microseconds.

The numbers are those of the functions in `labsid.estimation.recursive` over the same samples, bit for bit. Constructing
an estimator loads its compiled update (seconds when it is compiled for the first time), so that no call of `update`
waits for it. An estimator belongs to one thread.
"""

from math import inf, isfinite
from textwrap import shorten

import numpy as np
from numpy.typing import ArrayLike

from labsid._arrays import FloatArray
from labsid.estimation import _loops
from labsid.estimation.recursion import (
    RecursiveState,
    check_delay,
    check_forgetting,
    check_instrumental,
    diffuse_start,
    nothing_pending,
    resume,
    settle,
    symmetric,
)
from labsid.model_structures.structures import Structure


class RecursiveLeastSquares:
    """Least squares with forgetting, sample by sample; `recursive_least_squares` does the same for a record.

    Parameters
    ----------
    p : int
        Number of parameters.
    forgetting : float
        The factor lambda, above 0 and at most 1: a sample weighs ``lambda^age``. 1 forgets nothing.
    start : RecursiveState, optional
        Where to start or to go on: theta(0), P(0) and the bound on its trace. `diffuse_start` unless given.

    Raises
    ------
    ValueError
        If `forgetting` is outside (0, 1], or `start` has another number of parameters.

    Notes
    -----
    Reading lectures, L4, L5 and "RLS algorithm with a forgetting factor", as in `recursive_least_squares`.

    Examples
    --------
    The true parameters are 2 and -1:

    >>> from labsid import RecursiveLeastSquares
    >>> estimator = RecursiveLeastSquares(2)
    >>> for phi, y in [([1, 0], 2.0), ([1, 1], 1.0), ([0, 2], -2.0)]:
    ...     print(f"{estimator.update(phi, y):.4f}")
    2.0000
    -1.0000
    -0.0000
    >>> estimator.theta.round(4)
    array([ 2., -1.])
    """

    def __init__(self, p: int, forgetting: float = 1.0, start: RecursiveState | None = None) -> None:
        check_forgetting(forgetting)
        start = diffuse_start(p) if start is None else start
        self._theta, self._P, _ = resume(start, p, 0)
        self._trace_bound = float(start.trace_bound)
        self._phi, self._pending = np.zeros(p), nothing_pending(p)
        self._rest = self._theta, self._P, self._pending, np.zeros(p), float(forgetting), self._trace_bound, (0,) * p
        _loops.prepare(inf)
        _loops.rls_update(self._phi, np.nan, *self._rest)  # loads the compiled code, and changes nothing

    def update(self, phi: ArrayLike, y: float) -> float:
        """Use one sample.

        Parameters
        ----------
        phi : array_like, shape (p,)
            Regressor of the sample; an array of float64 is the fastest.
        y : float
            Output.

        Returns
        -------
        float
            Prediction error ``epsilon(n) = y(n) - phi'(n) theta(n-1)``; not finite once the estimate has diverged.

        Raises
        ------
        ValueError
            If phi does not hold p real numbers, y is not a real number, or one of them is not finite. The estimate is
            as before the call.
        """
        try:
            if len(phi) != self._phi.size:  # type: ignore[arg-type]
                raise ValueError
            np.copyto(self._phi, phi)
            error: float = _loops.rls_update(self._phi, float(y), *self._rest)
            refused = not isfinite(error) and not (isfinite(y) and np.isfinite(self._phi).all())
        except (TypeError, ValueError, OverflowError):
            refused = True
        if refused:
            raise ValueError(
                f"phi must hold {self._phi.size} finite real numbers, and y be one; got phi = {_shown(phi)} and "
                f"y = {_shown(y)}. Leave out a sample that was not measured."
            )
        return error

    @property
    def theta(self) -> FloatArray:
        """The current estimate, a copy, shape (p,)."""
        return self._theta.copy()

    @property
    def state(self) -> RecursiveState:
        """Copies of theta and P, from which `recursive_least_squares` or another estimator can go on."""
        return RecursiveState(self._theta, settle(self._P, self._pending), self._trace_bound, np.empty(0))


class RecursiveArmax:
    """Extended least squares of an ARMAX model, sample by sample; `recursive_armax` does the same for a record.

    Parameters
    ----------
    structure : Structure
        With a delay of 1; with nc = 0 it is least squares of an ARX model.
    forgetting : float
        The factor lambda, above 0 and at most 1.
    start : RecursiveState, optional
        Where to start or to go on; `diffuse_start` and the plant at rest unless given.

    Raises
    ------
    ValueError
        If the delay is not 1, `forgetting` is outside (0, 1], or `start` is the state of another structure.

    Notes
    -----
    Reading lectures, L7, as in `recursive_armax`. The parameters are ``theta = [a1, ..., b1, ..., c1, ...]``.

    Examples
    --------
    The true system is ``y(k) = 0.5 y(k-1) + u(k-1)``:

    >>> from labsid import RecursiveArmax, Structure
    >>> estimator = RecursiveArmax(Structure(1, 1))
    >>> for u, y in [(1.0, 0.0), (0.0, 1.0), (2.0, 0.5), (1.0, 2.25)]:
    ...     error = estimator.update(u, y)
    >>> estimator.theta.round(4)
    array([-0.5,  1. ])
    """

    def __init__(self, structure: Structure, forgetting: float = 1.0, start: RecursiveState | None = None) -> None:
        check_delay(structure)
        check_forgetting(forgetting)
        p = structure.parameters
        start = diffuse_start(p) if start is None else start
        self._theta, self._P, self._memory = resume(start, p, p)
        self._trace_bound = float(start.trace_bound)
        orders, scratch = (structure.na, structure.nb), np.zeros(p)
        self._rest = (
            *orders,
            self._theta,
            self._P,
            self._memory,
            scratch,
            float(forgetting),
            self._trace_bound,
            (0,) * p,
        )
        _loops.prepare(inf)
        _loops.extended_update(np.nan, np.nan, *self._rest)  # loads the compiled code, and changes nothing

    def update(self, u: float, y: float) -> float:
        """Use one sample.

        Parameters
        ----------
        u, y : float
            Input and output at the sample; 0 for the input of AR and ARMA.

        Returns
        -------
        float
            Prediction error ``epsilon(k)``; not finite once the estimate has diverged.

        Raises
        ------
        ValueError
            If u or y is not a finite real number. The estimate is as before the call.
        """
        try:
            error: float = _loops.extended_update(float(u), float(y), *self._rest)
            refused = not isfinite(error) and not (isfinite(u) and isfinite(y))
        except (TypeError, ValueError, OverflowError):
            refused = True
        if refused:
            raise _not_a_sample(u, y)
        return error

    @property
    def theta(self) -> FloatArray:
        """The current estimate, a copy, shape (p,)."""
        return self._theta.copy()

    @property
    def state(self) -> RecursiveState:
        """Copies of theta, P and the memory, from which `recursive_armax` or another estimator goes on."""
        return RecursiveState(self._theta, symmetric(self._P), self._trace_bound, self._memory)


class RecursiveInstrumental:
    """Instrumental variables of an ARX model, sample by sample; `recursive_instrumental` does the same for a record.

    Parameters
    ----------
    structure : Structure
        With past outputs and inputs, a delay of 1, and nc = 0.
    warm_up : int
        For so many samples, from the first, the regressor is its own instrument. Without effect where `start` is given.
    start : RecursiveState, optional
        Where to go on; `diffuse_start` and the plant at rest unless given.

    Raises
    ------
    ValueError
        If the structure does not suit, `warm_up` is negative, or `start` is the state of another structure.

    Notes
    -----
    Reading lectures, L8, as in `recursive_instrumental`. The parameters are ``theta = [a1, ..., b1, ...]``.

    Examples
    --------
    The true system is ``y(k) = 0.5 y(k-1) + u(k-1)``:

    >>> from labsid import RecursiveInstrumental, Structure
    >>> estimator = RecursiveInstrumental(Structure(1, 1), warm_up=3)
    >>> for u, y in [(1.0, 0.0), (0.0, 1.0), (2.0, 0.5), (1.0, 2.25)]:
    ...     error = estimator.update(u, y)
    >>> estimator.theta.round(4)
    array([-0.5,  1. ])
    """

    def __init__(self, structure: Structure, warm_up: int = 100, start: RecursiveState | None = None) -> None:
        check_instrumental(structure, warm_up)
        p = structure.parameters
        self._own_instruments = warm_up if start is None else 0
        start = diffuse_start(p) if start is None else start
        self._theta, self._P, memory = resume(start, p, 3 * p)
        self._memory, self._trace_bound, self._kept_back = memory.reshape(3, p).copy(), start.trace_bound, 0
        self._first = structure.na, self._theta, self._P, self._memory
        self._scratch = np.zeros((1, p)), np.zeros(4)
        _loops.prepare(inf)
        _loops.iv_update(np.nan, np.nan, *self._first, 0, *self._scratch)  # loads the compiled code, changes nothing

    def update(self, u: float, y: float) -> float:
        """Use one sample.

        Parameters
        ----------
        u, y : float
            Input and output at the sample.

        Returns
        -------
        float
            Prediction error ``epsilon(k)``; not finite once the estimate has diverged.

        Raises
        ------
        ValueError
            If u or y is not a finite real number. The estimate is as before the call.
        """
        try:
            error: float
            error, kept_back = _loops.iv_update(float(u), float(y), *self._first, self._own_instruments, *self._scratch)
            refused = not isfinite(error) and not (isfinite(u) and isfinite(y))
        except (TypeError, ValueError, OverflowError):
            refused = True
        if refused:
            raise _not_a_sample(u, y)
        self._kept_back += kept_back
        if self._own_instruments:
            self._own_instruments -= 1
        return error

    @property
    def theta(self) -> FloatArray:
        """The current estimate, a copy, shape (p,)."""
        return self._theta.copy()

    @property
    def kept_back(self) -> int:
        """For how many samples the estimate was unstable and the instruments kept to the last stable model."""
        return self._kept_back

    @property
    def state(self) -> RecursiveState:
        """Copies of theta, P and the memory, from which `recursive_instrumental` goes on, its warm-up over."""
        return RecursiveState(self._theta, self._P, self._trace_bound, self._memory.reshape(-1))


def _not_a_sample(u: object, y: object) -> ValueError:
    return ValueError(
        f"u and y must be finite real numbers; got u = {_shown(u)} and y = {_shown(y)}. Both are needed at every "
        "sample: estimate a missing one."
    )


def _shown(value: object) -> str:
    return shorten(repr(value), 80)
