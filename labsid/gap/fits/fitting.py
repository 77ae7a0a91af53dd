"""Fit a hypothesis to a record by output error: Levenberg-Marquardt over theta, with the gains projected out."""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from labsid._arrays import FloatArray
from labsid.gap.dynamics._kernels import whiten
from labsid.gap.dynamics.responses import MAX_OBSERVED_RATE
from labsid.gap.fits.fast_least_squares import RIDGE, scaled_gram, solve_least_squares, solve_positive_definite
from labsid.gap.fits.hypothesis import Design, Hypothesis
from labsid.gap.fits.known_scales import implied_count, known_bounds, known_gains, known_values
from labsid.gap.fits.noise_model import Noise, noise_of
from labsid.gap.record.data import Data

UNFILTERED = np.zeros(0)
DIVERGED = 1e100  # of a scaled signal: its square is finite; numerics
SAME_RATE = 1e-3  # relative difference of two poles that are one; numerics
SAME_COST = 1e-6  # relative difference of the errors at two points that are one simulation; numerics
WEAK = 0.01
"""Of the error: a parameter whose unit moves the output less is damped as one that moves it so far; numerics."""


@dataclass(frozen=True, slots=True, eq=False)
class Fit:
    """A hypothesis fitted to a record.

    Attributes
    ----------
    hypothesis : Hypothesis
    theta : ndarray
        Nonlinear parameters.
    gains : ndarray
        Linear parameters.
    output : ndarray, shape (N,)
        Free-run output over the whole record, including samples that do not count.
    cost : float
        Mean square of the (whitened) error over the rows that count; infinity where the simulation diverges.
    noise : Noise
        Model of the residual.
    bic : float
        Of the whitened residual; lower is better.
    free_run : float
        Mean square of the free-run error over the rows that count.
    """

    hypothesis: Hypothesis
    theta: FloatArray
    gains: FloatArray
    output: FloatArray
    cost: float
    noise: Noise
    bic: float
    free_run: float = np.nan

    @property
    def plant_theta(self) -> FloatArray:
        """The plant's part of theta."""
        return self.theta[self.hypothesis.slices["plant"]]

    @property
    def rates(self) -> tuple[float, float]:
        """Coefficients c and k of the linear dynamics s^2 + c s + k, in samples."""
        return self.hypothesis.plant.linear_rates(self.plant_theta)

    @property
    def slowest_rates(self) -> tuple[float, float]:
        """c and k of the two slowest poles of the linearized dynamics, in samples."""
        return self.hypothesis.plant.slowest_rates(self.plant_theta, self.output.size)

    @property
    def onset(self) -> float | None:
        """Onset of a load as a share of the record; None without a load."""
        names = [parameter.name for parameter in self.hypothesis.parameters]
        return float(self.theta[names.index("onset")]) if "onset" in names else None

    @property
    def whitened_bic(self) -> float:
        """BIC of the whitened residual alone, also of fits by `Data.by_free_run`."""
        return self.noise.score + self.n_free * float(np.log(self.noise.rows))

    @property
    def n_free(self) -> int:
        """Number of fitted parameters."""
        return self.theta.size + int(np.count_nonzero(self.gains))


@dataclass(frozen=True, slots=True, eq=False)
class Point:
    """One point of the minimization.

    Attributes
    ----------
    theta, gains : ndarray
        Nonlinear and linear parameters.
    design : Design
    output : ndarray, shape (N,)
        Free-run output.
    error : ndarray
        The (whitened) error on the rows that count.
    cost : float
        Mean square of the error.
    """

    theta: FloatArray
    gains: FloatArray
    design: Design
    output: FloatArray
    error: FloatArray
    cost: float


class Problem:
    """Least-squares problem of one hypothesis on one record with one whitening filter."""

    def __init__(self, data: Data, hypothesis: Hypothesis, ar: FloatArray = UNFILTERED) -> None:
        self.data, self.hypothesis, self.ar = data, hypothesis, ar
        counted = data.rows
        if ar.size:  # the filter sees zeros before the record: its first rows determine the initial state
            counted = data.complete.copy()
            begun = data.lags * data.stride
            counted[:begun] = data.rows[:begun] if data.rows[: begun : data.stride].all() else False
        self.rows = slice(None) if counted.all() else np.flatnonzero(counted)
        self.count = int(counted.sum())
        self.has_sensor = bool(hypothesis.outputs)
        self.known = known_gains(data, hypothesis)  # the first ones
        self.fixed = self.known.size
        self.bounds = known_bounds(data, hypothesis)
        self.y = self.seen(data.y[:, None])[:, 0]

    def seen(self, columns: FloatArray) -> FloatArray:
        """Columns as the cost counts them: whitened, on the rows that count."""
        return (whiten(columns, self.ar) if self.ar.size else columns)[self.rows]

    def _gains(self, columns: FloatArray, y: FloatArray) -> FloatArray:
        """Gains by linear least squares."""
        seen = self.seen(columns)
        if not self.fixed:
            return solve_least_squares(seen, y)
        found = solve_least_squares(seen[:, self.fixed :], y - seen[:, : self.fixed] @ self.known)
        return np.concatenate([self.known, found])

    def start(self, theta: FloatArray, gains: FloatArray | None = None, near: Design | None = None) -> Point | None:
        """The point at theta, within its bounds; None if the simulation diverges."""
        at = self.point(np.clip(theta, *self.bounds), gains, near)
        return at if at is not None and np.isfinite(at.cost) else None

    def point(self, theta: FloatArray, gains: FloatArray | None = None, near: Design | None = None) -> Point | None:
        """The best gains at theta and their error; None if the simulation diverges."""
        design = self.hypothesis.design(theta, self.data.u, near=near)
        columns = design.columns
        if not (np.abs(columns[-1]) < DIVERGED).all():  # a diverged simulation stays so, or is NaN, up to the end
            return None
        if not self.has_sensor:
            gains = self._gains(columns, self.y)
            return self._at(theta, gains, design)
        if gains is None or gains.size != columns.shape[1]:
            reading = self.hypothesis.undone(theta, self.data.y, design, self.data.rows)
            gains = self._gains(columns, self.seen(reading[:, None])[:, 0])
        best = self._at(theta, gains, design)
        for _ in range(3):
            step = solve_least_squares(self.seen(self._by_gains(best)), best.error)
            better = None
            for share in (1.0, 0.3):
                gains = best.gains + share * step
                better = self._at(theta, gains, design)
                if better.cost < best.cost:
                    break
            if better is None or better.cost >= best.cost * (1.0 - 1e-6):
                break
            best = better
        return best

    def _by_gains(self, at: Point) -> FloatArray:
        """Derivatives of the output by the gains."""
        columns = at.design.columns
        if self.has_sensor:
            columns = self.hypothesis.sensed_columns(at.theta, at.gains, at.design)
        elif self.fixed:
            columns = columns.copy(order="F")
        columns[:, : self.fixed] = 0.0
        return columns

    def _at(self, theta: FloatArray, gains: FloatArray, design: Design) -> Point:
        output = self.hypothesis.sensor(theta, gains, design)
        error = self.y - self.seen(output[:, None])[:, 0]
        with np.errstate(over="ignore"):  # it may have diverged in one of several records only
            return Point(theta, gains, design, output, error, float(error @ error) / self.count)

    def jacobian(self, at: Point) -> FloatArray | None:
        """Derivatives of the (whitened) output by theta and the gains, in this order; None where they diverge."""
        J = self.seen(self.derivatives(at))
        is_bounded = (np.abs(J[-1]) < DIVERGED).all() and np.isfinite(J).all()  # in each of several records
        return J if is_bounded else None

    def derivatives(self, at: Point) -> FloatArray:
        """Derivatives of the output by theta and the gains, in this order, shape (N, p)."""
        upper = self.bounds[1]
        searched = at.theta.size
        J = np.empty((self.data.samples, searched + at.gains.size), order="F")
        for i, parameter in enumerate(self.hypothesis.parameters):
            step = parameter.step if at.theta[i] + parameter.step <= upper[i] else -parameter.step
            perturbed = at.theta.copy()
            perturbed[i] += step
            J[:, i] = self.hypothesis.output_near(perturbed, at.gains, self.data.u, at.design)
            J[:, i] -= at.output
            J[:, i] /= step
        J[:, searched:] = self._by_gains(at)
        return J


def evaluate(problem: Problem, thetas: Iterable[FloatArray]) -> list[Point]:
    """The points at each theta, without those where the simulation diverges."""
    points: list[Point] = []
    for theta in thetas:
        at = problem.start(theta, near=points[-1].design if points else None)
        if at is not None:
            points.append(at)
    return points


def minimize(
    data: Data,
    hypothesis: Hypothesis,
    theta: FloatArray,
    gains: FloatArray | None = None,
    iterations: int = 15,
    ar: FloatArray = UNFILTERED,
    tolerance: float = 1e-5,
) -> Point | None:
    """Minimize the output error by Levenberg-Marquardt from `theta`; None if the start cannot be simulated."""
    problem = Problem(data, hypothesis, ar)
    at = problem.start(theta, gains)
    return None if at is None else descend(problem, at, iterations, tolerance)


def descend(problem: Problem, at: Point, iterations: int, tolerance: float = 1e-5) -> Point:
    """Minimize the output error by Levenberg-Marquardt from a point of the same problem."""
    lower, upper = problem.bounds
    searched = at.theta.size
    plant, own = problem.hypothesis.plant, problem.hypothesis.slices["plant"]
    has_root = plant.has_root
    damping = 1e-3
    for _ in range(iterations):
        J = problem.jacobian(at)
        if J is None:
            break
        if has_root:  # the linearized dynamics and their gains stay as the curvature of the outflow changes
            zero = own.start + plant.index("zero")
            J[:, zero] = J[:, own] @ plant.flatter(at.theta[own])
            beside_zero = solve_least_squares(J[:, searched:], J[:, zero])
            J[:, zero] -= J[:, searched:] @ beside_zero
        gram, scale = scaled_gram(J)
        slope = (J.T @ at.error) / scale
        better = None
        # Hold a parameter that is at its bound and whose gradient points outside.
        held = np.zeros(gram.shape[0], bool)
        push = slope[:searched]
        held[:searched] = ((at.theta <= lower) & (push < 0)) | ((at.theta >= upper) & (push > 0))
        gram[held, :] = gram[:, held] = slope[held] = 0.0
        ridge = np.where(held, 1.0, RIDGE)
        weak = WEAK**2 * float(at.error @ at.error) / scale[:searched] ** 2
        for _ in range(6):
            lhs = gram.copy()
            diagonal = lhs.flat[:: gram.shape[0] + 1]
            diagonal += ridge
            diagonal[:searched] += damping * np.maximum(weak, 1.0)
            lhs.flat[:: gram.shape[0] + 1] = diagonal
            step = solve_positive_definite(lhs, slope) / scale
            new = at.theta + step[:searched]
            if has_root:
                new[own] = plant.stepped(at.theta[own], step[own])
                step[searched:] -= beside_zero * step[zero]
            new = np.clip(new, lower, upper)
            better = problem.point(new, at.gains + step[searched:] if problem.has_sensor else None)
            if better is not None and better.cost < at.cost:
                break
            damping = min(damping * 8.0, 1e6)
            better = None
        if better is None:
            break
        gain = 1.0 - better.cost / at.cost
        at = better
        damping = max(damping / 6.0, 1e-9)
        if gain < tolerance:
            break
    return at


def finish(data: Data, hypothesis: Hypothesis, point: Point) -> Fit:
    """Fit the noise model of the residual and compute the BIC.

    A slow residual leaves only sensor noise in its innovations, so that the whitened error cannot rank simulations.
    `Data.by_free_run` then adds the power of the free-run error, weighted by its number of independent samples.
    """
    point = _with_fastest_lag(data, hypothesis, point)
    e = data.y - point.output
    noise = noise_of(data, e)
    theta, undetermined = hypothesis.completed(point.theta, data)
    fixed = hypothesis.plant.follows or hypothesis.plant.stabilised
    known = known_gains(data, hypothesis).size * fixed + len(known_values(data, hypothesis))
    known += implied_count(hypothesis)
    free = point.theta.size - undetermined - known + int(np.count_nonzero(point.gains))
    bic = noise.score + free * np.log(noise.rows)
    free_run = float(np.mean(e[data.rows] ** 2))
    if data.by_free_run:
        mean_square = max(free_run, noise.sigma2)
        bic += noise.rows * np.sqrt(noise.sigma2 / mean_square) * np.log(mean_square) + free * np.log(noise.rows)
    return Fit(hypothesis, theta, point.gains, point.output, point.cost, noise, float(bic), free_run)


def _with_fastest_lag(data: Data, hypothesis: Hypothesis, point: Point) -> Point:
    """The point at which the lag of linear dynamics is the fastest of their real poles: they may be exchanged."""
    plant = hypothesis.plant
    if plant.kind != "linear" or not plant.lag:
        return point
    begin = hypothesis.slices["plant"].start
    lag = begin + plant.index("log_lag")
    c, k = np.exp(point.theta[begin : begin + 2])
    if c * c <= 4.0 * k:
        return point
    fast = float(0.5 * c + np.sqrt(0.25 * c * c - k))
    rates = float(k) / fast, fast
    at = 1 if rates[1] < MAX_OBSERVED_RATE and not plant.single else 0
    own, other = float(np.exp(-point.theta[lag])), rates[at]
    if other <= own * (1.0 + SAME_RATE):
        return point
    theta = point.theta.copy()
    kept = own, float(c) - own if plant.single else rates[1 - at]
    theta[begin : begin + 2] = np.log(sum(kept)), np.log(kept[0] * kept[1])
    theta[lag] = -np.log(other)
    exchanged = Problem(data, hypothesis).start(theta, point.gains if hypothesis.outputs else None)
    if exchanged is None or exchanged.cost >= point.cost * (1.0 + SAME_COST):
        return point
    return exchanged


def fit_from(
    data: Data, hypothesis: Hypothesis, theta: FloatArray, iterations: int = 15, tolerance: float = 1e-5
) -> Fit | None:
    """Fit by output error from `theta`; None if it cannot be simulated."""
    point = minimize(data, hypothesis, theta, iterations=iterations, tolerance=tolerance)
    return None if point is None else finish(data, hypothesis, point)


def refit(data: Data, fit: Fit, tolerance: float = 1e-6) -> Fit:
    """Refit the hypothesis to the rows of `data`."""
    point = minimize(data, fit.hypothesis, fit.theta, fit.gains, iterations=20, tolerance=tolerance)
    return fit if point is None else finish(data, fit.hypothesis, point)


def covariance(data: Data, fit: Fit) -> FloatArray:
    """Least-squares covariance of theta and the gains, in this order, from the whitened error.

    What the record does not determine of theta has a standard error of the distance between its bounds, and no more.
    """
    problem = Problem(data, fit.hypothesis, fit.noise.ar)
    at = problem.point(fit.theta, fit.gains)
    J = None if at is None else problem.jacobian(at)
    size = fit.theta.size + fit.gains.size
    if J is None:
        return np.full((size, size), np.nan)
    known = list(known_values(data, fit.hypothesis))
    J[:, known] = 0.0
    gram, scale = scaled_gram(J)
    lower, upper = problem.bounds
    width = np.where(upper > lower, upper - lower, np.inf)  # nothing is known of the others by their bounds
    spread = (width * scale[: lower.size]) ** 2
    gram.flat[: lower.size * (size + 1) : size + 1] += fit.noise.sigma2 / spread
    inverse = np.asarray(np.linalg.pinv(gram, rcond=1e-10, hermitian=True), np.float64) * fit.noise.sigma2
    return np.asarray(inverse / np.outer(scale, scale))


def mean_square(data: Data, fit: Fit) -> float:
    """Mean square of the free-run error over the rows that count."""
    return float(np.mean((data.y - fit.output)[data.rows] ** 2))


def rms(data: Data, fit: Fit) -> float:
    """Root mean square of the free-run error over the rows that count."""
    return float(np.sqrt(mean_square(data, fit)))
