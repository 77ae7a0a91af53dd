"""Checks of starting values and of position from ranges: several minima, and layouts that cannot tell."""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial

import numpy as np

from labsid._arrays import FloatArray
from labsid.checks.answer_code import code_of
from labsid.checks.asked_texts import LAYOUTS
from labsid.checks.assignments.nonlinear_least_squares.estimates import (
    SQUARED,
    as_estimate,
    fit_of_squares,
    within,
)
from labsid.checks.compare import as_number, kind_of
from labsid.checks.question import Ask, returned
from labsid.checks.verdict import NoAnswer, Slip, Verdict, first_failure, judge
from labsid.least_squares.solve import solve_least_squares
from labsid.nonlinear.ranges import locate as right_locate
from labsid.nonlinear.ranges import ranges_from, ranges_jacobian
from labsid.nonlinear.solve import NonlinearFit, levenberg_marquardt


@first_failure
def check_frequency(ask: Ask) -> Iterator[Verdict]:
    """`fit_frequency(t, y, low, high)`."""
    for trial in range(len(_SIGNS)):
        verdict, far_off = _one_frequency(ask, trial)
        if verdict.slip == _HERTZ:  # one wrong frequency may happen to be the best in hertz, two hardly
            again, _ = _one_frequency(ask, trial)
            verdict = verdict if again.slip in _IN_HERTZ else far_off if again.passed else again
        yield verdict
    yield Verdict(True, "the lowest of many valleys, wherever it lies.")


_HERTZ = "searched in hertz"
_IN_HERTZ = (_HERTZ, "Hz for rad/s")
_SIGNS = ((1, 1), (-1, -1), (1, -1), (-1, 1))


def _one_frequency(ask: Ask, trial: int) -> tuple[Verdict, Verdict]:
    """The verdict on one record, and the one that names no cause."""
    sign_A, sign_B = _SIGNS[trial]
    t: FloatArray = ask.rng.uniform(0.32, 0.35) * np.arange(ask.rng.integers(85, 95), dtype=np.float64)
    if trial == 1:
        t = t - t.mean()  # then no frequency near the right one makes up for a wrong sign of A and B
    low = float(ask.rng.uniform(3.2, 3.6) if trial == 2 else ask.rng.uniform(0.4, 1.5))
    high = low + float(ask.rng.uniform(4.5, 5))
    # in the middle between two frequencies of a scan that is far too coarse; far up in the third trial
    interval = int(ask.rng.integers(6, 8) if trial == 2 else ask.rng.integers(1, 8))
    w = low + (high - low) * (interval + 0.5 + float(ask.rng.uniform(-0.05, 0.05))) / 9
    truth = np.array([w, sign_A * ask.rng.uniform(1, 2), sign_B * ask.rng.uniform(1, 2)])
    y = _wave(t, truth) + 0.4 * ask.rng.standard_normal(t.size)
    if trial >= 2:  # a larger oscillation outside the range, for those who scan a range of their own
        outside = np.array([low - 2 if trial == 2 else high + 2, *ask.rng.uniform(2, 2.5, 2)])
        y += _wave(t, outside)
    fit = levenberg_marquardt(partial(_wave, t), partial(_wave_jacobian, t), y, truth)
    got = as_number(*_frequency_of(ask, t, y, low, high))
    return _judge_frequency(got, fit, t, y, low, high), _far_off(got, t, y)


def _frequency_of(ask: Ask, t: FloatArray, y: FloatArray, low: float, high: float) -> tuple[str, FloatArray]:
    call = "fit_frequency(t, y, low, high)"
    value = returned(ask, "fit_frequency", t, y, low, high)
    if isinstance(value, np.ndarray) and value.size == 3:
        raise NoAnswer(f"`{call}` returns three numbers: asked for is the frequency alone.", "all three parameters")
    return call, value  # type: ignore[return-value]


def _wave(t: FloatArray, theta: FloatArray) -> FloatArray:
    w, A, B = theta
    return np.asarray(A * np.sin(w * t) + B * np.cos(w * t), float)


def _wave_jacobian(t: FloatArray, theta: FloatArray) -> FloatArray:
    w, A, B = theta
    return np.column_stack([t * (A * np.cos(w * t) - B * np.sin(w * t)), np.sin(w * t), np.cos(w * t)])


def _profile(t: FloatArray, y: FloatArray, w: float) -> float:
    """The smallest SSE at this frequency, twice the loss."""
    return 2 * solve_least_squares(np.column_stack([np.sin(w * t), np.cos(w * t)]), y).loss


def _judge_frequency(w: float, fit: NonlinearFit, t: FloatArray, y: FloatArray, low: float, high: float) -> Verdict:
    right, valley = float(fit.theta[0]), np.pi / (t[-1] - t[0])
    same = within(fit.stderr[:1], 0.2)
    if same([abs(w)], [right]):
        return Verdict(True, "")
    if abs(2 * np.pi * w - right) < 0.01 * right:
        return Verdict(
            False, "`fit_frequency` returns Hz: asked for is the angular frequency in rad/s.", "Hz for rad/s"
        )
    if _is_in_hertz(w, fit, t, y, low, high):
        return Verdict(
            False,
            "`fit_frequency` returns the best f for waves sin and cos of 2 pi f t, in hertz. `low` and `high`, and the "
            "frequency that is asked for, are angular, in rad/s: sin(w t).",
            _HERTZ,
        )
    if not low <= abs(w) <= high and w == int(w):
        return Verdict(
            False,
            f"`fit_frequency` returns {w:g}, a whole number outside low and high. `np.argmin` gives the "
            "*index* of the smallest value; the frequency is that entry.",
            "index for frequency",
        )
    if not low <= abs(w) <= high:
        hertz = low <= 2 * np.pi * abs(w) <= high
        unit = " Times 2 pi it lies between them: is it in Hz? `low` and `high` are in rad/s." if hertz else ""
        return Verdict(
            False,
            f"`fit_frequency` returns {w:.4g}, outside low = {low:.4g} and high = {high:.4g}.{unit} Compare the SSE of "
            "frequencies between these two only.",
            "outside the range",
        )
    if any(same([w], [_alone(t, y, column, right, valley)]) for column in (np.sin, np.cos)):
        return Verdict(
            False,
            "`fit_frequency` fits a sine without a cosine, or the other way round: then the phase is fixed. With both, "
            "it is free.",
            "phase fixed",
        )
    if abs(w - right) < 0.5 * valley:
        return Verdict(
            False,
            "`fit_frequency` finds the right valley and stops on its slope: let a finer search, or an iteration, start "
            "from the best of your frequencies.",
            "not refined",
        )
    d = 0.02 * valley
    if min(_profile(t, y, w - d), _profile(t, y, w + d)) >= _profile(t, y, w):
        return Verdict(
            False,
            "`fit_frequency` ends in a local minimum: no frequency beside it is better, but one far away is. Compare "
            "the SSE of many frequencies between low and high first.",
            "local minimum",
        )
    return _far_off(w, t, y)


def _far_off(w: float, t: FloatArray, y: FloatArray) -> Verdict:
    return Verdict(
        False,
        f"`fit_frequency` returns {w:.4g} rad/s, where the SSE is far larger than it could be: with the best A and B "
        "it "
        f"is {_profile(t, y, w):.4g} of {y @ y:.4g}. Compute it by your own lines at w = {w:.4g}, and at frequencies "
        "far "
        "from it.",
    )


_AMONG_THE_BEST = 0.2
"""Of the range of the SSE over a scan: below it is only the valley around a lowest point."""


def _is_in_hertz(w: float, fit: NonlinearFit, t: FloatArray, y: FloatArray, low: float, high: float) -> bool:
    """Whether it is one of the best f between low and high for waves of 2 pi f t, and not for those of f t.

    Of samples in equal steps, waves of several frequencies are the same, so that several are the best.
    """
    step = 0.5 * np.pi / (t[-1] - t[0]) / (2 * np.pi)
    if not low - step <= w <= high + step or _profile(t, y, w) < 1.5 * _profile(t, y, 2 * np.pi * w):
        return False
    grid = np.arange(low, high, step / 4)
    sse = np.array([_profile(t, y, 2 * np.pi * f) for f in grid])
    best = grid[sse <= np.min(sse) + _AMONG_THE_BEST * np.ptp(sse)]
    return bool(np.min(np.abs(w - best)) < step)


def _alone(t: FloatArray, y: FloatArray, column: np.ufunc, right: float, valley: float) -> float:
    """The frequency that fits best without the other of sine and cosine."""
    grid = np.linspace(right - valley, right + valley, 801)
    waves = column(np.outer(grid, t))
    power = np.maximum(np.einsum("ij,ij->i", waves, waves), np.finfo(float).tiny)
    return float(grid[np.argmax((waves @ y) ** 2 / power)])  # the part of y that the wave explains


@first_failure
def check_locate(ask: Ask) -> Iterator[Verdict]:
    """`locate(beacons, ranges)`, in rooms and along a road, where the wrong side of it is a local minimum."""
    across = np.array([-0.7, 0.6, -0.3, 0.5, -0.6]) * ask.rng.uniform(0.8, 1.2)
    four = ask.rng.uniform(0, 2, (4, 2)) + np.array([[0, 0], [9, 1], [7, 8], [1, 6]])
    road = np.column_stack([np.array([0.0, 2.3, 5.1, 7.4, 10.0]) + ask.rng.uniform(-0.4, 0.4, 5), across])
    room = ask.rng.uniform(0, 2, (5, 2)) + np.array([[0, 0], [8, 0], [8, 6], [0, 6], [4, 8]])
    side = ask.rng.uniform(2.5, 4)
    for beacons, place in (
        (room, ask.rng.uniform(3, 6, 2)),
        (four, ask.rng.uniform(2, 6, 2)),
        (road, np.array([ask.rng.uniform(3, 7), side])),
        (road, np.array([ask.rng.uniform(3, 7), -side])),
    ):
        ranges = ranges_from(beacons, place) + 0.03 * ask.rng.standard_normal(len(beacons))
        yield _judge_place(ask, beacons, ranges)
    yield Verdict(True, "on both sides of a row of beacons, too.")


def _judge_place(ask: Ask, beacons: FloatArray, ranges: FloatArray) -> Verdict:
    fix = right_locate(beacons, ranges)
    assert fix.fit is not None
    centre = beacons.mean(axis=0)
    across = np.linalg.svd(beacons - centre)[2][1]
    mirrored = fix.position - 2 * ((fix.position - centre) @ across) * across
    local_minimum = levenberg_marquardt(
        lambda theta: ranges_from(beacons, theta), lambda theta: ranges_jacobian(beacons, theta), ranges, mirrored
    ).theta
    got = as_estimate("locate(beacons, ranges)", returned(ask, "locate", beacons, ranges), 2)
    # |theta|^2 - 2 b'theta + |b|^2 = y^2 is linear in theta and in |theta|^2
    squares = solve_least_squares(
        np.column_stack([-2 * beacons, np.ones(ranges.size)]), ranges**2 - np.sum(beacons**2, axis=1)
    ).theta[:2]
    differences = _less_their_mean(beacons - centre, ranges) + centre
    no_step = (
        "`locate` returns the centre of the beacons: its search has made no step from there, or its errors are "
        "smallest there. So they are with one distance for all beacons, which `np.linalg.norm` of a table is: with "
        "`axis=1` it is one for each row. Print what is handed over: one distance, and one error, for each beacon."
    )
    linear = (
        "`locate` solves the linear equations of the *squared* ranges: another criterion, which trusts far beacons "
        "too much. It is a good start for `scipy.optimize.least_squares` with the errors of the ranges themselves."
    )
    verdict = judge(
        got,
        fix.position,
        within(fix.fit.stderr),
        "",
        "`locate` does not return the position with the smallest sum of (range - distance)^2: at yours it is "
        f"{np.sum((ranges - ranges_from(beacons, got)) ** 2):.4g}, and {fix.fit.sse:.4g} is possible.",
        [
            Slip("coordinates swapped", "`locate` returns the second coordinate first.", lambda: fix.position[::-1]),
            Slip("squared ranges", linear, lambda: squares),
            Slip("squared ranges", linear, lambda: differences),
            *(Slip("squared ranges", linear, partial(_less_one, beacons, ranges, i)) for i in (0, len(beacons) - 1)),
            Slip(
                "squared ranges",
                "`locate` hands over errors of the *squared* ranges, distance^2 - range^2: another criterion, which "
                "trusts far beacons too much. The error of a beacon is its distance less its range.",
                lambda: _fourth_power(beacons, ranges, fix.position),
            ),
            Slip(
                "squares handed over",
                f"`locate` {SQUARED}",
                lambda: fit_of_squares(
                    lambda theta: ranges_from(beacons, theta),
                    lambda theta: ranges_jacobian(beacons, theta),
                    ranges,
                    fix.position,
                ),
            ),
            Slip("no step taken", no_step, lambda: centre),
        ],
    )
    apart = np.linalg.norm(local_minimum - fix.position) > 0.5
    if not verdict.passed and not verdict.slip and apart and np.linalg.norm(got - local_minimum) < 0.05:
        return Verdict(
            False,
            "`locate` ends on the wrong side of the line along which the beacons lie: a local minimum, near the mirror "
            "image of the best place. Start on both sides of that line, whatever its direction, and keep the one with "
            "the smaller SSE.",
            "local minimum",
        )
    return verdict


def _less_their_mean(centred: FloatArray, ranges: FloatArray) -> FloatArray:
    """The linear equations that remain of the squared ranges when their mean is subtracted."""
    squares = ranges**2 - np.sum(centred**2, axis=1)
    return solve_least_squares(-2 * centred, squares - squares.mean()).theta


def _less_one(beacons: FloatArray, ranges: FloatArray, one: int) -> FloatArray:
    """The linear equations that remain of the squared ranges when the one of beacon `one` is subtracted."""
    squares = ranges**2 - np.sum(beacons**2, axis=1)
    rows = np.arange(len(beacons)) != one
    return solve_least_squares(-2 * (beacons - beacons[one])[rows], (squares - squares[one])[rows]).theta


def _fourth_power(beacons: FloatArray, ranges: FloatArray, start: FloatArray) -> FloatArray:
    return levenberg_marquardt(
        lambda theta: ranges_from(beacons, theta) ** 2, lambda theta: 2 * (theta - beacons), ranges**2, start
    ).theta


def check_layout(ask: Ask) -> Verdict:
    """`layout(beacons)`: what the beacons can tell at all."""
    made = trial_layouts(ask.rng)
    order = ask.rng.permutation([*range(len(made)), *ask.rng.integers(0, len(made), 3)])
    trials = [made[i] for i in order]
    answers = [_layout(ask, one.beacons) for one in trials]
    truth = [one.kind for one in trials]
    if answers == truth:
        return Verdict(True, "it says beforehand what the measurements will be able to tell.")
    rules = (
        (
            "beacons counted",
            "counts the beacons. Ten on one line tell no more than two: what matters is how they lie.",
            [_of_rank(min(len(one.beacons) - 1, 2)) for one in trials],
        ),
        (
            "not centred",
            "takes the rank of the beacons' coordinates as they are. A line need not pass through the origin: subtract "
            "one beacon, or their mean, first.",
            [_of_rank(int(np.linalg.matrix_rank(one.beacons, tol=1e-9))) for one in trials],
        ),
        (
            "mirror and unique swapped",
            "has two of its answers swapped.",
            [{"unique": "mirror", "mirror": "unique"}.get(kind, kind) for kind in truth],
        ),
        (
            "one place forgotten",
            "does not see that all beacons are in one place: then only the distance from it is known.",
            ["mirror" if kind == "undetermined" else kind for kind in truth],
        ),
        (
            "along the axes only",
            _ALONG_AXES,
            [_of_rank(int(np.count_nonzero(np.ptp(one.beacons, axis=0) > 1e-9))) for one in trials],
        ),
    )
    for slip, hint, wrong in rules:
        if answers == wrong:
            return Verdict(False, f"`layout` {hint}", slip)
    told = {int(i): answer for i, answer in zip(order, answers, strict=True) if answer != made[i].kind}
    if set(told) <= set(SLANTING) and EXACT_SLANTING in told and _has_tolerance(ask):
        return Verdict(False, f"`layout` {_ALONG_AXES}", "along the axes only")
    if set(told) <= set(SLANTING) - {REPEATED_SLANTING}:
        return Verdict(
            False,
            "`layout` misses beacons on a slanting line: through rounding, what should be zero is about 1e-16. Compare "
            "with a small tolerance, not with 0.",
            "zero compared exactly",
        )
    missed = [made[i] for i in sorted(told)]
    if all(one.is_narrow for one in missed) and set(told.values()) == {"mirror"}:
        return Verdict(
            False,
            f"`layout` says 'mirror' for {_told_narrow(missed[0])}. No line passes through all of them: they span the "
            "plane. The tolerance is for rounding alone, such as 1e-9, and not for a distance in the room.",
            "tolerance too wide",
        )
    first, code = missed[0], code_of(ask, "layout")
    because = first.because if code is not None and code.divides else ""
    return Verdict(
        False,
        f"`layout` is wrong for {len(first.beacons)} beacons that {_SAID[first.kind]}{first.says}: it says "
        f"{told[min(told)]!r}.{because}",
        first.slip or None,
    )


_ALONG_AXES = (
    "only sees lines along an axis: a line may run in any direction. (Or zero is compared exactly: through rounding, "
    "what should be zero is about 1e-16 on a slanting line. Compare with a small tolerance.)"
)
_SAID = {"unique": "span the plane", "mirror": "lie on one line", "undetermined": "are in one place"}
SLANTING = (2, 4, 6, 7, 13)
"""Those of the trial layouts that lie on a line along neither axis; the third and fourth have rounded coordinates."""
REPEATED_SLANTING = 13
"""The one of them with two beacons in one place, and exact coordinates."""
EXACT_SLANTING = 4
"""One of them with several beacons, whose coordinates and differences are exact."""


def _told_narrow(layout: "Layout") -> str:
    width = float(np.linalg.svd(layout.beacons - layout.beacons.mean(axis=0))[1][1])
    where = ", ".join(f"({x:.3g}, {y:.3g})" for x, y in layout.beacons)
    return f"beacons at {where}, where the second singular value of the differences is {width:.2g}"


def _has_tolerance(ask: Ask) -> bool:
    """Whether the code of `layout` compares with a small number."""
    code = code_of(ask, "layout")
    return code is not None and (bool(code.calls & {"isclose", "allclose"}) or any(0 < n < 1e-3 for n in code.numbers))


def right_layout(beacons: FloatArray) -> str:
    """What beacons can tell, from the rank of their coordinates about their mean."""
    return _of_rank(int(np.linalg.matrix_rank(beacons - beacons.mean(axis=0), tol=1e-6)))


def _of_rank(rank: int) -> str:
    return LAYOUTS[2 - min(rank, 2)]


@dataclass(frozen=True, slots=True, eq=False)
class Layout:
    """Beacons on which `layout` is tried.

    Attributes
    ----------
    beacons : ndarray, shape (m, 2)
    kind : str
        What they can tell, known from how they are made.
    says : str
        What is special about them, behind "beacons that lie on one line".
    because : str
        What divides by zero there, in a sentence.
    slip : str
        Name of the mistake of missing them.
    is_narrow : bool
        Whether they span the plane, and one singular value of their differences is below 1 m.
    """

    beacons: FloatArray
    kind: str
    says: str = ""
    because: str = ""
    slip: str = ""
    is_narrow: bool = False


NEARLY_ON_A_LINE = ((0.0, 2.0), (2.5, 2.4), (5.0, 1.8), (7.5, 2.3), (10.0, 1.9))
"""Beacons of the notebook's figure, in m."""


def trial_layouts(rng: np.random.Generator) -> list[Layout]:
    """Layouts with what they can tell."""

    def on_line(n: int, direction: FloatArray, through: FloatArray) -> FloatArray:
        along = np.arange(n) + 0.25 * rng.integers(0, 4, n)
        return np.asarray(through + along[:, np.newaxis] * direction, float)

    def moved(*places: tuple[float, float]) -> FloatArray:
        return np.asarray(corner + np.array(places), float)

    corner = rng.integers(2, 9, 2).astype(float)
    angles = rng.uniform(0.3, 1.2, 2)
    slanting = np.array([[3.0, 1.0], [1.0, 2.0]])[int(rng.integers(2))]
    vertical = (
        ", along the second axis",
        " (A slope, the quotient of two differences, is inf or -inf there.)",
        "vertical line",
    )
    repeated = (
        ", two of them in one place",
        " (Between these two a slope, the quotient of two differences, is 0/0.)",
        "repeated beacon",
    )
    return [
        Layout(corner + rng.uniform(-1, 1, (3, 2)) + np.array([[0, 0], [6, 0], [0, 6]]), "unique"),
        Layout(corner + rng.uniform(-1, 1, (5, 2)) + np.array([[0, 0], [6, 0], [0, 6], [6, 6], [3, 3]]), "unique"),
        Layout(corner + rng.uniform(0, 3, (2, 2)) + np.array([[0, 0], [6, 4]]), "mirror"),
        Layout(on_line(5, np.array([1.0, 0.0]), corner), "mirror"),
        Layout(on_line(4, slanting, corner + np.array([0, 1])), "mirror"),
        Layout(on_line(4, np.array([2.0, 1.0]), np.zeros(2)) + np.array([[0, 0], [0, 1], [0, 0], [0, 2]]), "unique"),
        *(Layout(on_line(5, np.array([np.cos(angle), np.sin(angle)]), corner), "mirror") for angle in angles),
        Layout(np.repeat(corner[np.newaxis], 3, axis=0), "undetermined"),
        Layout(np.repeat(rng.integers(1, 9, (1, 2)).astype(float), 4, axis=0), "undetermined"),
        Layout(corner + rng.uniform(0, 1, (1, 2)), "undetermined"),
        Layout(moved((0, 0), (0, 2), (0, -3), (0, 5)), "mirror", *vertical),
        Layout(moved((0, 0), (0, 1), (0, 4)), "mirror", *vertical),
        Layout(moved((0, 0), (0, 0), (1, 2), (2, 4)), "mirror", *repeated),
        Layout(moved((0, 0), (0, 0), (6, 0), (0, 6)), "unique", *repeated),
        Layout(moved((0, 0), (6, 0), (6, 0), (0, 6)), "unique", *repeated),
        Layout(np.array(NEARLY_ON_A_LINE), "unique", is_narrow=True),
        Layout(moved((0, 0), (0.5, 0), (0, 0.5)), "unique", is_narrow=True),
        Layout(moved((0, 0), (0.25, 0), (0.75, 0)), "mirror", " of less than a metre"),
        Layout(moved((0, 0), (800, 0), (0, 600)), "unique", " far apart"),
        Layout(moved((0, 0), (400, 0), (1000, 0)), "mirror", " far apart"),
    ]


def _layout(ask: Ask, beacons: FloatArray) -> str:
    value = returned(ask, "layout", beacons)
    if not isinstance(value, str) or value.strip().lower() not in LAYOUTS:
        what = repr(value[:40]) if isinstance(value, str) else kind_of(value)
        raise NoAnswer(
            f"`layout` should return one of the texts {', '.join(LAYOUTS)}; it returns {what}.", "another text"
        )
    return value.strip().lower()
