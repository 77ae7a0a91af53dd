"""Checks of the iterations by hand: Gauss-Newton, the damped step, Levenberg-Marquardt.

Both are tried on a linear regression seen through a compressing sensor, ``y = arsinh(Phi theta) + e``, through the
notebook's own `try_gauss_newton` and `try_levenberg_marquardt`: a check cannot hand functions over.
"""

from collections.abc import Callable, Iterator
from functools import partial

import numpy as np

from labsid._arrays import FloatArray
from labsid.checks.assignments.nonlinear_least_squares.estimates import as_estimate, within
from labsid.checks.compare import SAME, as_array, as_matrix, as_vector
from labsid.checks.descents import gradient_factor
from labsid.checks.question import Ask, returned, with_lists
from labsid.checks.values import Value
from labsid.checks.verdict import NoAnswer, Slip, Verdict, are_named, first_failure, judge, told_if_singular
from labsid.nonlinear.solve import NonlinearFit, levenberg_marquardt
from labsid.nonlinear.solve import gauss_newton as right_gauss_newton

Map = Callable[[FloatArray], FloatArray]
Step = Callable[[FloatArray, FloatArray], FloatArray]


def sensor(Phi: FloatArray) -> tuple[Map, Map]:
    """The g of the trials and its Jacobian."""

    def seen(theta: FloatArray) -> FloatArray:
        return np.asarray(np.arcsinh(Phi @ theta), float)

    def slope(theta: FloatArray) -> FloatArray:
        return np.asarray(Phi / np.sqrt(1 + (Phi @ theta) ** 2)[:, np.newaxis], float)

    return seen, slope


@first_failure
def check_gauss_newton(ask: Ask) -> Iterator[Verdict]:
    """`gauss_newton(g, jacobian, y, theta0, steps)`, which returns its path."""
    for n, p, steps in ((7, 2, 3), (int(ask.rng.integers(8, 12)), 3, int(ask.rng.integers(4, 6)))):
        Phi = ask.rng.uniform(-1, 1, (n, p)) + np.vstack([np.eye(p), np.zeros((n - p, p))])
        truth = ask.rng.uniform(0.4, 1.2, p)
        y = np.arcsinh(Phi @ truth) + 0.1 * ask.rng.standard_normal(n)
        start = truth + ask.rng.uniform(-0.4, 0.4, p)
        yield _judge_path(ask, Phi, y, start, steps)
    yield with_lists(ask, lambda given: _judge_path(given, Phi, y, start, steps), 2)


def _judge_path(ask: Ask, Phi: FloatArray, y: FloatArray, start: FloatArray, steps: int) -> Verdict:
    g, jacobian = sensor(Phi)
    p = start.size
    walked = right_gauss_newton(g, jacobian, y, start, steps).path
    path = np.vstack([walked, np.repeat(walked[-1:], steps + 1 - len(walked), axis=0)])
    value = _handed_back(ask.call("try_gauss_newton", Phi, y, start, steps), "gauss_newton")
    alone = as_array("what `gauss_newton` returns", value)
    if alone.shape in ((p,), (p, 1)) and not SAME(np.ravel(alone), path[-1]):
        return Verdict(
            False,
            "`gauss_newton` returns one theta, which is not the last of the path either: asked for is the path, one "
            "row for each theta, start first.",
            "one theta for the path",
        )
    if alone.shape in ((p,), (p, 1)):
        return Verdict(
            False,
            "`gauss_newton` returns the last theta only: asked for is the path, one row for each theta, start first.",
            "last theta only",
        )
    got = as_matrix("the path of gauss_newton", value, (None, p))
    if got.shape == (steps, p) and SAME(got, path[1:]):
        return Verdict(
            False, "the path of `gauss_newton` lacks its start: the first row is theta0.", "start left out of the path"
        )
    if got.shape[0] != steps + 1:
        return Verdict(
            False,
            f"the path of `gauss_newton` has {got.shape[0]} rows after {steps} steps; it should have steps + 1, the "
            "start and where each step leads.",
            "number of steps",
        )
    if not SAME(got[0], start):
        same_all_along = bool(np.all(np.abs(got - got[-1]) < 1e-12))
        return Verdict(
            False,
            "every row of the path is the last theta: `theta += step` changes the array that is already in the list. "
            "Use `theta = theta + step`."
            if same_all_along
            else "the first row of the path of `gauss_newton` is not theta0: begin where you are told to.",
            "the same array in every row" if same_all_along else "start not used",
        )

    def walk(step: Step, frozen: bool = False) -> FloatArray:
        theta, rows = start, [start]
        for _ in range(steps):
            J = jacobian(start if frozen else theta)
            theta = theta + step(J, y - g(theta))
            rows.append(theta)
        return np.array(rows)

    steps_taken = np.diff(got, axis=0)
    slopes = np.array([-jacobian(theta).T @ (y - g(theta)) for theta in got[:-1]]).reshape(steps_taken.shape)
    factor = gradient_factor(steps_taken, slopes) if are_named() else None
    if factor is not None and min(abs(factor - known) for known in (1.0, 2.0)) > 1e-6:  # these have their own words
        return Verdict(
            False,
            f"`gauss_newton` takes {factor:.3g} J'e for each step, along the gradient. The Gauss-Newton step is "
            "(J'J)^-1 J'e, the solution of a linear least-squares problem, and has no rate.",
            "step down the gradient",
        )
    return judge(
        got,
        path,
        SAME,
        "each step solves the linear least-squares problem at the place where it stands.",
        "the path of `gauss_newton` leaves the right one: work the example above by hand and print your J, e and step.",
        [
            Slip(
                "step in the wrong direction",
                "`gauss_newton` goes the wrong way: with e = y - g(theta) the step is added. (With e = g(theta) - y it "
                "would be taken off.)",
                lambda: walk(lambda J, e: -_newton(J, e)),
            ),
            Slip(
                "step down the gradient",
                "`gauss_newton` takes J'e for the step: (J'J)^-1 is missing before it.",
                lambda: walk(lambda J, e: J.T @ e),
            ),
            Slip(
                "step down the gradient",
                "`gauss_newton` takes 2J'e for the step: that is down the gradient; (J'J)^-1 is missing.",
                lambda: walk(lambda J, e: 2 * J.T @ e),
            ),
            Slip(
                "Jacobian of the start throughout",
                "`gauss_newton` keeps the Jacobian of the start: linearise anew at every theta.",
                lambda: walk(_newton, frozen=True),
            ),
            Slip(
                "step twice as long",
                "`gauss_newton` takes a step twice too long: the 2 of the gradient and that of J'J cancel.",
                lambda: walk(lambda J, e: 2 * _newton(J, e)),
            ),
            Slip(
                "step twice too short",
                "`gauss_newton` takes half of each step: the 2 of the gradient and that of J'J cancel.",
                lambda: walk(lambda J, e: 0.5 * _newton(J, e)),
            ),
            Slip(
                "y in place of the error",
                "`gauss_newton` fits the step to y: it should explain what is left, e = y - g(theta).",
                lambda: _walk_on_y(start, steps, y, jacobian),
            ),
            Slip(
                "step in place of theta",
                "`gauss_newton` takes the step for the new theta: it is added to the old one, theta + step.",
                lambda: _steps_alone(start, steps, y, g, jacobian),
            ),
            Slip("no step taken", "`gauss_newton` stays at theta0.", lambda: np.repeat(path[:1], steps + 1, axis=0)),
        ],
    )


def _handed_back(value: Value, name: str) -> Value:
    """`returned` would name the notebook's own function, in which the student's is called."""
    if value is None:
        raise NoAnswer(f"`{name}` returns nothing: end it with `return` and the result.", "no return")
    return value


def _newton(J: FloatArray, e: FloatArray) -> FloatArray:
    return np.asarray(np.linalg.lstsq(J, e, rcond=None)[0], float)


def _walk_on_y(start: FloatArray, steps: int, y: FloatArray, jacobian: Map) -> FloatArray:
    rows = [start]
    for _ in range(steps):
        rows.append(rows[-1] + _newton(jacobian(rows[-1]), y))
    return np.array(rows)


def _steps_alone(start: FloatArray, steps: int, y: FloatArray, g: Map, jacobian: Map) -> FloatArray:
    rows = [start]
    for _ in range(steps):
        rows.append(_newton(jacobian(rows[-1]), y - g(rows[-1])))
    return np.array(rows)


@first_failure
def check_damping(ask: Ask) -> Iterator[Verdict]:
    """`damped_step(J, e, mu)`, then `levenberg_marquardt(g, jacobian, y, theta0)`."""
    for n, p, mu in ((6, 2, 0.5), (8, 3, 4.0)):
        J = (ask.rng.uniform(-1, 1, (n, p)) + np.vstack([np.eye(p), np.zeros((n - p, p))])) * 2.0 ** np.arange(p)
        yield _judge_step(ask, J, ask.rng.uniform(-2, 2, n), mu)
    for n, p in ((8, 2), (10, 3)):
        Phi = np.vstack([np.eye(p), ask.rng.uniform(-1, 1, (n - p, p))])
        truth = ask.rng.uniform(0.3, 1, p)
        y = np.arcsinh(Phi @ truth) + 0.02 * ask.rng.standard_normal(n)
        for away in (0.2, 30.0):
            start = truth + away * ask.rng.choice([-1.0, 1.0], p)
            yield _judge_arrival(ask, Phi, y, start)
    yield with_lists(ask, lambda given: _judge_arrival(given, Phi, y, start), 2)
    yield Verdict(True, "near or far, it goes downhill until it arrives.")


def _judge_step(ask: Ask, J: FloatArray, e: FloatArray, mu: float) -> Verdict:
    JJ, Je, p = J.T @ J, J.T @ e, J.shape[1]
    D = np.diag(np.diag(JJ))

    def solve(left: FloatArray) -> FloatArray:
        return np.asarray(np.linalg.solve(left, Je), float)

    return judge(
        as_vector("damped_step(J, e, mu)", returned(ask, "damped_step", J, e, mu), p),
        solve(JJ + mu * D),
        SAME,
        "",
        "`damped_step` does not solve (J'J + mu D) s = J'e with D = diag(J'J).",
        [
            Slip(
                "identity in place of D",
                "`damped_step` adds mu to the diagonal, Levenberg's way. Asked for is Marquardt's: mu times the "
                "diagonal of J'J, so that the units of theta do not matter.",
                lambda: solve(JJ + mu * np.eye(p)),
            ),
            *(
                Slip(
                    "another diagonal",
                    f"D of `damped_step` is made of {what}: it is the diagonal of J'J, the sums of squares of the "
                    "columns.",
                    partial(solve, JJ + mu * np.diag(diagonal)),
                )
                for what, diagonal in (
                    ("the diagonal of J itself", np.diag(J)),
                    ("the lengths of the columns of J", np.sqrt(np.diag(JJ))),
                    ("the inverse of the diagonal of J'J", 1 / np.diag(JJ)),
                )
            ),
            Slip("mu not used", "`damped_step` does not use mu: it is the whole step.", lambda: solve(JJ)),
            Slip(
                "all of J'J enlarged",
                "`damped_step` multiplies all of J'J by 1 + mu, which only shortens the step.",
                lambda: solve((1 + mu) * JJ),
                mend="D is its diagonal alone: `np.diag(np.diag(...))`.",
            ),
            Slip(
                "number added to every entry",
                "`damped_step` adds to every entry of J'J: D is a *matrix* with zeros off its diagonal.",
                lambda: solve(JJ + mu * np.diag(JJ)),
                mend="`np.diag(M)` is a vector; `np.diag` of that is the matrix.",
            ),
            Slip(
                "number added to every entry",
                "`damped_step` adds mu to every entry of J'J, not to its diagonal alone.",
                lambda: solve(JJ + mu),
            ),
            Slip(
                "step in the wrong direction",
                "`damped_step` goes uphill: J'e stands on the right with a plus.",
                lambda: -solve(JJ + mu * D),
            ),
            Slip("mu squared", "`damped_step` uses the square of mu: it is mu D.", lambda: solve(JJ + mu**2 * D)),
            Slip("mu only", "`damped_step` leaves J'J itself out.", lambda: solve(mu * D)),
        ],
    )


_RUN_AWAY = (
    "`levenberg_marquardt` went so far that all slopes are zero, and the damped equations have no solution there. "
    "A step is taken only if the SSE gets smaller by it; if not, theta stays, and mu is multiplied by 10."
)


def _judge_arrival(ask: Ask, Phi: FloatArray, y: FloatArray, start: FloatArray) -> Verdict:
    g, jacobian = sensor(Phi)
    best = levenberg_marquardt(g, jacobian, y, start)
    if best.status != "converged":  # a start from which nobody arrives says nothing
        return Verdict(True, "")
    with told_if_singular(_RUN_AWAY, "every step accepted"):
        value = _handed_back(ask.call("try_levenberg_marquardt", Phi, y, start), "levenberg_marquardt")
    if isinstance(value, np.ndarray) and value.dtype.kind == "f" and not np.all(np.isfinite(value)):
        raise NoAnswer(
            "`levenberg_marquardt` runs out of the range of numbers: a step that makes the SSE larger must not be "
            "taken. Raise mu and try a shorter one.",
            "bad steps taken",
        )
    if isinstance(value, np.ndarray) and value.ndim == 2 and value.shape[1] == start.size != 1:
        return Verdict(
            False, "`levenberg_marquardt` returns a path: asked for is the theta at its end.", "path for theta"
        )
    theta = as_estimate("levenberg_marquardt(g, jacobian, y, theta0)", value, start.size)
    return _judge_end(theta, best, Phi, y, start)


def _judge_end(theta: FloatArray, best: NonlinearFit, Phi: FloatArray, y: FloatArray, start: FloatArray) -> Verdict:
    if within(best.stderr)(theta, best.theta):
        return Verdict(True, "")
    e, e_start = y - np.arcsinh(Phi @ theta), y - np.arcsinh(Phi @ start)
    if any(np.allclose(theta, _reversed(Phi, y, start, factor), rtol=1e-6) for factor in (10.0, 2.0, 3.0, 5.0)):
        return Verdict(
            False,
            "`levenberg_marquardt` ends where its first bad step came. After a bad step mu must rise (and fall after a "
            "good one), and the iteration go on.",
            "ends at the first bad step",
        )
    if SAME(theta, start):
        return Verdict(
            False,
            "`levenberg_marquardt` stays at theta0. When a trial step makes the SSE smaller, it must be taken: "
            "`theta = theta + step`. When not, mu must rise.",
            "no step taken",
        )
    if e @ e > e_start @ e_start:
        return Verdict(
            False,
            "`levenberg_marquardt` ends higher than it began: a step that makes the SSE larger must not be taken. "
            "Raise mu and try a shorter one.",
            "bad steps taken",
        )
    slope = float(np.max(np.abs(sensor(Phi)[1](theta).T @ e)))
    return Verdict(
        False,
        f"`levenberg_marquardt` goes downhill, from an SSE of {e_start @ e_start:.4g} to {e @ e:.4g}, and stops before "
        "the "
        f"minimum, {best.sse:.4g}: the largest entry of J'e is not yet zero, it is {slope:.2g}. Print mu and the SSE "
        "in each "
        "iteration, up to the last: mu falls after a good step and rises after a bad one.",
        "stops too early",
    )


@np.errstate(all="ignore")
def _reversed(Phi: FloatArray, y: FloatArray, start: FloatArray, factor: float) -> FloatArray:
    """Where the iteration ends if mu rises after a good step and falls after a bad one."""
    g, jacobian = sensor(Phi)
    theta, mu = start, 1e-3
    for _ in range(500):
        e, J = y - g(theta), jacobian(theta)
        JJ = J.T @ J
        step = np.linalg.lstsq(JJ + mu * np.diag(np.diag(JJ)), J.T @ e, rcond=None)[0]
        trial = y - g(theta + step)
        good = bool(trial @ trial < e @ e)
        theta, mu = (theta + step if good else theta), (mu * factor if good else mu / factor)
        if not np.isfinite(mu) or np.max(np.abs(step)) < 1e-12 * (1 + np.max(np.abs(theta))):
            break
    return np.asarray(theta, float)
