"""How far a change of the output is from what refits and rivals can absorb."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from operator import itemgetter

import numpy as np

from labsid._arrays import FloatArray
from labsid.gap.dynamics.responses import real_rates
from labsid.gap.fits.fitting import Fit, Point, Problem, descend
from labsid.gap.record.data import Data

FEW = 3  # iterations of a check; numerics
STEPS = 12  # iterations of a refit from each start; numerics
TOLERANCE = 2e-3  # relative change of the cost at which a refit ends; numerics
WORTH = 0.8  # cost of a linearized refit over that of an exact one, below which it is worth another; numerics
MISFIT = 0.1  # relative difference of the power left, from which a linearized refit is wrong; set by hand
SLOWER = 4.0  # slow pole over the slowest start value of the other pole; numerics
FASTEST = 1.0  # per sample: fastest start value of the other pole; numerics
STARTS = 10  # start values of the other pole; numerics
NEARLY_PARALLEL = 1e-5  # one minus the squared cosine of two vectors, below which they do not span a plane; numerics
LEAST_VALUE = 1e-10  # of the largest singular value of scaled columns: below, a direction is rounding; numerics


@dataclass(frozen=True, slots=True, eq=False)
class _Start:
    """Parameters from which a refit starts, and the simulation linearized about them.

    Attributes
    ----------
    theta : ndarray
    basis : ndarray, shape (n, p)
        Orthonormal basis of the whitened derivatives of the output.
    rest : ndarray, shape (n,)
        What it leaves of the fitted output.
    """

    theta: FloatArray
    basis: FloatArray
    rest: FloatArray

    def left(self, change: FloatArray) -> float:
        """Squared error that remains of the fitted output with a whitened change, shape (n,)."""
        error = self.rest + _less(change, self.basis)
        return float(error @ error)


@dataclass(frozen=True, slots=True, eq=False)
class Refit:
    """What a refit of all that a simulation leaves free absorbs, linearized about the fit.

    Attributes
    ----------
    data : Data
    fit : Fit
    whitened, plain : Problem
        With and without the noise model of the fit.
    absorbed : tuple of ndarray
        Orthonormal bases of the derivatives of the output, as either problem sees it.
    sigma : float
        Standard deviation of the innovations.
    noise : float
        Rms error of the fit.
    residual : ndarray
        The residual in units of `sigma`, less what a refit absorbs.
    starts : tuple of _Start
        At the fit, and with other rates of the faster pole: it has no gradient where a zero cancels it.
    """

    data: Data
    fit: Fit
    whitened: Problem
    plain: Problem
    absorbed: tuple[FloatArray, FloatArray]
    sigma: float
    noise: float
    residual: FloatArray
    starts: tuple[_Start, ...]

    @classmethod
    def about(cls, data: Data, fit: Fit, noise: float) -> "Refit | None":
        """About a fit with an rms error of `noise`; None if its derivatives diverge."""
        whitened, plain = Problem(data, fit.hypothesis, fit.noise.ar), Problem(data, fit.hypothesis)
        at = whitened.point(fit.theta, fit.gains)
        if at is None or not np.isfinite(J := whitened.derivatives(at)).all():
            return None
        absorbed = _basis(whitened.seen(J)), _basis(plain.seen(J))
        sigma = float(np.sqrt(fit.noise.sigma2))
        residual = _less(at.error / sigma, absorbed[0])
        here = _Start(fit.theta, absorbed[0], np.zeros(residual.size))
        starts = (here, *_other_starts(data, fit))
        return cls(data, fit, whitened, plain, absorbed, sigma, noise, residual, starts)

    def left(self, change: FloatArray) -> tuple[FloatArray, float]:
        """What a refit leaves of a change of the output.

        Parameters
        ----------
        change : ndarray, shape (N,)

        Returns
        -------
        ndarray
            Whitened, in units of its noise.
        float
            Its rms value, not whitened, over that of the noise.
        """
        white = _less(self.whitened.seen(change[:, None])[:, 0] / self.sigma, self.absorbed[0])
        plain = _less(self.plain.seen(change[:, None])[:, 0], self.absorbed[1])
        return white, float(np.sqrt(np.mean(plain**2))) / self.noise

    def left_exactly(self, change: FloatArray, near: Point | None = None) -> tuple[FloatArray, float, Point | None]:
        """As `left`, but by a refit: a delay and a lag can be absorbed by a pole that moves far.

        Parameters
        ----------
        change : ndarray, shape (N,)
        near : Point, optional
            Refit of a similar change.

        Returns
        -------
        ndarray
        float
        Point or None
            The refit; None if none can be simulated.
        """
        problem = self._on(change)
        seen = self.whitened.seen(change[:, None])[:, 0]
        promised = min(((s.left(seen) / problem.count, s.theta) for s in self.starts), key=itemgetter(0))
        first = self.starts[-1].theta if near is None else near.theta  # a fast pole finds its way to a slower one
        nearest: Point | None = None
        for least, theta in ((0.0, first), promised):
            if nearest is None or least < WORTH * nearest.cost:
                at = problem.start(theta, self.fit.gains)
                at = None if at is None else descend(problem, at, STEPS, TOLERANCE)
                nearest = nearest if at is None or (nearest is not None and nearest.cost <= at.cost) else at
        if nearest is None:
            return *self.left(change), None
        rest = self.plain.seen((self.fit.output + change - nearest.output)[:, None])
        return nearest.error / self.sigma, float(np.sqrt(np.mean(rest**2))) / self.noise, nearest

    def is_linear_at(self, change: FloatArray, vector: FloatArray) -> bool:
        """Whether a linearized refit, which leaves `vector` of a change of the output, is as good as an exact one."""
        power = float(vector @ vector)
        if self.fit.hypothesis.plant.kind == "given" or power < 1.0:  # it is slow, and has few numbers that are free
            return True
        seen = self.whitened.seen(change[:, None])[:, 0]
        if any(start.left(seen) < (1.0 - MISFIT) * power * self.sigma**2 for start in self.starts[1:]):
            return False
        problem = self._on(change)
        at = problem.start(self.fit.theta, self.fit.gains)
        exact = np.inf if at is None else descend(problem, at, FEW, TOLERANCE).cost * problem.count / self.sigma**2
        return bool(abs(exact / power - 1.0) < MISFIT)

    def _on(self, change: FloatArray) -> Problem:
        """The problem of a refit to the fitted output with a change."""
        return Problem(replace(self.data, y=self.fit.output + change), self.fit.hypothesis, self.fit.noise.ar)


def _other_starts(data: Data, fit: Fit) -> Iterator[_Start]:
    c, k = fit.rates
    if fit.hypothesis.plant.kind != "linear" or c * c < 4.0 * k:
        return
    problem = Problem(replace(data, y=fit.output), fit.hypothesis, fit.noise.ar)
    slow = real_rates(c, k)[0]
    for rate in np.geomspace(slow / SLOWER, FASTEST, STARTS):
        theta = fit.theta.copy()
        theta[fit.hypothesis.slices["plant"]][:2] = np.log((slow + rate, slow * rate))
        at = problem.start(theta)
        J = None if at is None else problem.jacobian(at)
        if at is not None and J is not None:
            basis = _basis(J)
            yield _Start(at.theta, basis, _less(at.error, basis))


def _basis(J: FloatArray) -> FloatArray:
    """Orthonormal basis of the columns, without the directions that rounding alone gives to columns in proportion."""
    size = np.sqrt((J**2).sum(axis=0))
    U, values, _ = np.linalg.svd(J[:, size > 0.0] / size[size > 0.0], full_matrices=False)
    return np.asarray(U[:, values > LEAST_VALUE * values.max(initial=0.0)])


def _less(x: FloatArray, basis: FloatArray) -> FloatArray:
    return np.asarray(x - basis @ (basis.T @ x))


@dataclass(frozen=True, slots=True, eq=False)
class Trace:
    """One form of an effect at one place, over its size.

    Attributes
    ----------
    name : str
        Of the effect.
    shares : ndarray, shape (k,)
        Sizes, ascending.
    vectors : ndarray, shape (k, n)
        What a refit leaves of each change, whitened.
    changes : ndarray, shape (k,)
        Its rms value over that of the noise.
    added : int
        Number of parameters that the effect adds.
    is_linear : bool
        Whether the change is proportional to the size, with either sign.
    """

    name: str
    shares: FloatArray
    vectors: FloatArray
    changes: FloatArray
    added: int
    is_linear: bool


class Rivals:
    """All traces of a record, between which the distances are measured."""

    def __init__(self, traces: list[Trace]) -> None:
        vectors = np.concatenate([trace.vectors for trace in traces]).astype(np.float32)
        self.gram = np.asarray(vectors @ vectors.T, np.float64)
        self.starts = np.cumsum([0, *(trace.shares.size for trace in traces)])
        own = np.repeat(np.arange(len(traces)), [trace.shares.size for trace in traces])
        self.names = np.array([trace.name for trace in traces])[own]
        self.added = np.array([trace.added for trace in traces])[own]
        self._signed = np.array([trace.is_linear for trace in traces])[own]
        joined = (own[:-1] == own[1:]) | (self._signed[:-1] & (self.names[:-1] == self.names[1:]))
        self._joined = np.append(joined, False)

    def distances(self, at: int) -> FloatArray:
        """Squared distance of one vector from each one, scaled, and from the plane of it and the next of its effect.

        The size of a rival is refitted, and so are others of its parameters: a plane stands for both.
        """
        a, x = np.maximum(self.gram.diagonal(), 1e-12), self.gram[at]
        b, y, ab = np.roll(a, -1), np.roll(x, -1), np.append(self.gram.diagonal(1), 0.0)
        alone = np.where(self._signed, x, np.maximum(x, 0.0)) ** 2 / a
        determinant = a * b - ab**2
        sound = self._joined & (determinant > NEARLY_PARALLEL * a * b)
        determinant = np.where(sound, determinant, 1.0)
        first, second = (b * x - ab * y) / determinant, (a * y - ab * x) / determinant
        inside = sound & (self._signed | ((first >= 0.0) & (second >= 0.0)))
        together = np.where(inside, first * x + second * y, 0.0)
        return np.asarray(np.maximum(a[at] - np.maximum(alone, together), 0.0))
