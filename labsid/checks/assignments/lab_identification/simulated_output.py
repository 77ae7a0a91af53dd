"""Checks of simulated outputs: free runs of the model, and known mistakes."""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from functools import partial
from itertools import chain, product

import numpy as np
from numpy.typing import ArrayLike
from scipy.signal import filtfilt, lfilter

from labsid._arrays import FloatArray
from labsid.checks.assignments.lab_identification.lab_data import LabData
from labsid.checks.compare import as_vector, close, kind_of
from labsid.checks.double_mistakes import Edit, pairs_of, with_pairs
from labsid.checks.question import Ask
from labsid.checks.recursions import Factor, with_recursion
from labsid.checks.regressions import WRAPS, wrapped_filter
from labsid.checks.values import Unreadable, Value
from labsid.checks.verdict import NoAnswer, Slip, Verdict, judge
from labsid.lab.arx import ArxModel
from labsid.lab.simulation import estimate_initial_state, predict_one_step, simulate
from labsid.lab.verification import mse

SAME = close(1e-6, 1e-9)
_FEW = 5

_RESPONSES = ("TimeResponseData", "TimeResponseList")

_BEGUN_LATE = "(Your loop begins at k = 2: y(1) = b1 u(0) is left out, as if the input had begun one sample later.)"

_MOST_PARAMETERS = 8  # of a model whose number of parameters is taken off that of the samples

_SAME_MEAN = 1e-9
"""Relative: a mean is that of a part of the samples to rounding, or by no means."""


def read_output(name: str, value: Value) -> FloatArray:
    """Read a simulated output; the other results of simulating functions have their own messages."""
    if isinstance(value, Unreadable) and value.kind in _RESPONSES:
        raise NoAnswer(
            f"`{name}` is the whole result of `forced_response`: take its `.outputs`.", "response instead of its output"
        )
    if isinstance(value, (tuple, Mapping)):
        raise NoAnswer(
            f"`{name}` contains several values: take only the simulated output.", "response instead of its output"
        )
    if isinstance(value, np.ndarray) and value.ndim == 2 and 1 in value.shape:
        value = value.reshape(-1)
    if isinstance(value, np.ndarray) and value.ndim == 2 and value.shape[0] == 2:
        what = "contains time and output" if np.all(np.diff(value[0]) > 0) else "has two rows, as `.states` has"
        raise NoAnswer(f"`{name}` {what}: take only the output, `.outputs`.", "response instead of its output")
    if value is None:
        raise NoAnswer(f"`{name}` is {kind_of(value)}.")
    return as_vector(name, value)


def judge_entire_run(
    ask: Ask, name: str, data: LabData, model: ArxModel, more: Iterable[Slip[FloatArray]] = ()
) -> Verdict:
    """Judge the free run over the entire input, from rest or from the first measured samples; see `judge_mse`."""
    value = ask.value(name)
    got = read_output(name, value)
    right = simulate(model, data.u)
    n = model.order
    for accepted in (
        _zero_at_first(model, data.u),
        simulate(model, data.u, estimate_initial_state(model, data.u, data.y, n)),
    ):
        if got.size == right.size and SAME(got, accepted):
            right = accepted

    def joined(half: int) -> FloatArray:
        return np.concatenate([simulate(model, data.u[:half]), simulate(model, data.u[half:])])

    slips = chain(
        (
            Slip(
                "wrong half",
                f"`{name}` covers the first half only; simulate the entire input.",
                lambda: right[: data.half],
            ),
            Slip(
                "wrong half",
                f"`{name}` covers the second half only; simulate the entire input.",
                lambda: simulate(model, data.u[data.half :]),
            ),
            Slip(
                "measured output joined",
                f"`{name}` is the measured output in its first half: simulate the entire input, from its first "
                "sample on.",
                lambda: np.concatenate([data.y[: data.half], simulate(model, data.u[data.half :])]),
            ),
            *(
                Slip(
                    "two runs joined",
                    f"`{name}` is two runs put together: the second starts from rest in the middle of the record. "
                    "Simulate the entire input in one call.",
                    partial(joined, half),
                )
                for half in (data.half, data.half + 1)
            ),
        ),
        _predictions_elsewhere(name, data, model, "whole record, from `u` alone"),
        _slips(name, data, model, 0, _is_column(value)),
        _step_response(name, got, model, "`u`"),
        more,
    )
    verdict = judge(
        got, right, SAME, "A free run over the entire input.", _otherwise(name, got, right, model, data.u), slips
    )
    verdict = _with_terms(verdict, name, got, data.u, data.y, model)
    return with_pairs(verdict, got, SAME, _pairs(name, data, model, 0))


def judge_second_half(ask: Ask, name: str, data: LabData, model: ArxModel) -> Verdict:
    """Judge the free run over the second half of the input, from rest. The half may be rounded up or down."""
    value = ask.value(name)
    got = read_output(name, value)
    rounded = data.y.size - data.half
    for half in (data.half, rounded):
        if SAME(got, simulate(model, data.u[half:])):
            return Verdict(True, "A free run over the second half of the input, from rest.")
        if SAME(got, _zero_at_first(model, data.u[half:])):
            return Verdict(True, f"A free run over the second half of the input, from rest. {_BEGUN_LATE}")
    half = data.half if got.size != data.y.size - data.half - 1 else data.half + 1
    u, y = data.u[half:], data.y[half:]
    entire = simulate(model, data.u)
    carried = (
        "state carried over",
        f"`{name}` is cut from the simulation of the entire input. Here the second half is "
        f"simulated by itself: hand over "
        "`u[half:]` alone.",
    )
    measured = (
        "started from measured samples",
        f"`{name}` starts from measured samples. Start from rest, as `lsim` and `filter` do.",
    )
    off_by_one = f"`{name}` is not simulated with exactly the second half of the input: begin with sample `half`."
    slips = [
        *(
            Slip("off by one", off_by_one, partial(simulate, model, data.u[first:]))
            for first in (data.half - 2, data.half - 1, rounded + 1, rounded + 2)
        ),
        Slip(
            "wrong half",
            f"`{name}` is the simulation of the first half; simulate with `u[half:]`.",
            lambda: simulate(model, data.u[:half]),
        ),
        Slip(
            "wrong half",
            f"`{name}` is the simulation of the first half; simulate with `u[half:]`.",
            lambda: simulate(model, data.u[: data.u.size - half]),
        ),
        Slip("entire input", f"`{name}` covers the entire input; simulate with `u[half:]`.", lambda: entire),
        Slip(*carried, lambda: entire[half:]),
        Slip(*measured, lambda: simulate(model, u, estimate_initial_state(model, u, y, model.order))),
        Slip(*measured, lambda: simulate(model, u, estimate_initial_state(model, u, y))),
        *_predictions_elsewhere(name, data, model, "second half, from `u[half:]` alone"),
        *_slips(name, data, model, half, _is_column(value)),
        *_step_response(name, got, model, "`u[half:]`"),
    ]
    right = simulate(model, u)
    verdict = judge(got, right, SAME, "", _otherwise(name, got, right, model, u), slips)
    verdict = _with_terms(verdict, name, got, u, y, model)
    return with_pairs(verdict, got, SAME, _pairs(name, data, model, half))


def _with_terms(verdict: Verdict, name: str, got: FloatArray, u: FloatArray, y: FloatArray, model: ArxModel) -> Verdict:
    asked = {(name, i): Factor(f"-a{i}", -model.a[i]) for i in range(1, model.order + 1)}
    asked |= {("u", i + 1): Factor(f"b{i + 1}", b) for i, b in enumerate(model.b)}
    return with_recursion(verdict, (name, got), {"u": u, "y": y}, asked, "y")


def _step_response(name: str, got: FloatArray, model: ArxModel, asked: str) -> Iterator[Slip[FloatArray]]:
    hint = f"`{name}` is the response to a unit step. Simulate with the input of the record: hand over {asked}."
    yield Slip("step response", hint, lambda: simulate(model, np.ones(got.size)))


def _predictions_elsewhere(name: str, data: LabData, model: ArxModel, asked: str) -> Iterator[Slip[FloatArray]]:
    """One-step predictions of other samples, such as ``Phi @ theta_hat`` of the fit's own rows."""
    whole = predict_one_step(model, data.u, data.y)
    hint = (
        f"`{name}` is `Phi @ theta_hat`: one-step predictions of the *first* half, from its measured outputs. Simulate "
        f"the {asked}."
    )
    for stop in (data.half, data.half + 1):
        for first in range(model.order + 2):
            yield Slip("one-step prediction", hint, partial(np.copy, whole[first:stop]))
            for begun in (np.zeros(first), data.y[:first]):
                text = hint.replace("theta_hat`:", f"theta_hat` behind {first} other samples:")
                yield Slip("one-step prediction", text, partial(np.concatenate, [begun, whole[first:stop]]))


def judge_mse(
    name: str,
    got: float,
    y: FloatArray,
    y_sim: FloatArray,
    more: Sequence[Slip[float]] = (),
    others: Sequence[Edit] = (),
) -> Verdict:
    """Judge the mean squared error of `y_sim`.

    `more` are further known mistakes, and `others` the differences of other signals, as edits of the part "e".
    """
    e = y - y_sim
    squared = e**2

    def slip(short: str, hint: str, wrong: ArrayLike) -> Slip[float]:
        return Slip(short, f"`{name}` {hint}", lambda: float(np.asarray(wrong)))

    slips = [
        slip(
            "root of the mean squared error",
            "is the root of the mean squared error: leave the root out.",
            np.sqrt(np.mean(squared)),
        ),
        slip("sum in place of the mean", "is the sum of the squared errors: divide by their number.", np.sum(squared)),
        slip(
            "loss V in place of the mean",
            "is the loss V of the appendix, half the sum: take the mean.",
            np.sum(squared) / 2,
        ),
        slip("half the mean", "is half of the mean squared error: leave out the factor 1/2.", np.mean(squared) / 2),
        slip("mean of the errors", "is the mean of the errors: square them first, or they cancel.", np.mean(e)),
        slip("mean of the errors", "is the mean of the errors: square them first, or they cancel.", -np.mean(e)),
        slip(
            "square of the mean error", "is the square of the mean error: square first, then average.", np.mean(e) ** 2
        ),
        slip(
            "second half only",
            "is averaged over the second half only; use the entire record.",
            np.mean(squared[e.size // 2 :]),
        ),
        slip(
            "first half only",
            "is averaged over the first half only: the average goes over all samples.",
            np.mean(squared[: e.size // 2]),
        ),
        *(
            slip(
                "divided by the size of the output",
                f"is divided by {what}, which makes a share of it. Asked for is the mean itself.",
                np.mean(squared) / size,
            )
            for what, size in (("the variance of y", np.var(y)), ("the mean of y^2", np.mean(y**2)))
        ),
        slip(
            "fit for the error",
            "is a measure of fit, 1 less a share of the output. Asked for is the mean of the squared errors.",
            1 - np.mean(squared) / np.var(y),
        ),
        slip("mean absolute error", "is the mean of the absolute errors: square them.", np.mean(np.abs(e))),
        slip(
            "variance of the error",
            "is the variance of the error, from which its mean is subtracted. Use the mean of the squares.",
            np.var(e),
        ),
        slip(
            "difference of squares",
            "is the mean of y^2 less that of y_sim^2: take the difference first, then square.",
            np.mean(y**2) - np.mean(y_sim**2),
        ),
        slip("norm of the error", "is the norm of the error: take the mean of the squares.", np.sqrt(np.sum(squared))),
        slip(
            "norm of the error",
            "is the norm of the error over N: the norm is a root. Square it before you divide.",
            np.sqrt(np.sum(squared)) / e.size,
        ),
        slip(
            "column minus flat",
            "is averaged over an N-by-N matrix, the difference of a column (N, 1) and a flat array (N,). Flatten "
            "the column.",
            np.mean(y**2) - 2 * np.mean(y) * np.mean(y_sim) + np.mean(y_sim**2),
        ),
    ]
    otherwise = f"`{name}` is not the mean of the squared differences between measured and simulated output."

    def made(e: FloatArray = e, of: Callable[[FloatArray], float] = _mean_square) -> float:
        return float(of(e))

    return judge(
        got,
        mse(y, y_sim),
        close(1e-6),
        "Both mean squared errors are right.",
        otherwise,
        [*slips, *more, *wrong_means(name, got, squared), *pairs_of(f"`{name}`", [*others, *_OF_ERRORS], made)],
    )


def _mean_square(e: FloatArray) -> float:
    return float(np.mean(e**2))


def _root_of_mean(e: FloatArray) -> float:
    return float(np.sqrt(np.mean(e**2)))


def _sum_of_squares(e: FloatArray) -> float:
    return float(np.sum(e**2))


def _loss(e: FloatArray) -> float:
    return float(np.sum(e**2)) / 2


def _half_of_mean(e: FloatArray) -> float:
    return float(np.mean(e**2)) / 2


def _mean(e: FloatArray) -> float:
    return float(np.mean(e))


def _mean_size(e: FloatArray) -> float:
    return float(np.mean(np.abs(e)))


_OF_ERRORS = (
    Edit("of", _root_of_mean, "the root is taken of the mean"),
    Edit("of", _sum_of_squares, "the squares are summed, and not divided by their number"),
    Edit("of", _loss, "half the sum of the squares is taken for their mean"),
    Edit("of", _half_of_mean, "half the mean is taken"),
    Edit("of", _mean, "the errors are not squared"),
    Edit("of", _mean_size, "absolute errors are taken, and not squared"),
    Edit("of", np.var, "the mean of the errors is subtracted before they are squared"),
)
"""What may have been made of errors in the place of the mean of their squares."""


def wrong_means(name: str, got: float, squared: FloatArray) -> list[Slip[float]]:
    """Means of squared errors over a part of them, or with another divisor than their number."""
    N = squared.size
    of_parameters = [
        Slip(
            "parameters taken off the number",
            f"`{name}` is divided by N - {p}, as an estimate of the variance with {p} parameters is. The mean is over "
            f"all {N} samples: divide by N.",
            partial(_divided, squared, N - p),
        )
        for p in range(2, _MOST_PARAMETERS + 1)
    ]
    return [*_wrong_divisors(name, squared), *_means_of_a_part(name, got, squared), *of_parameters]


def _divided(squared: FloatArray, by: int) -> float:
    return float(np.sum(squared)) / by


def _wrong_divisors(name: str, squared: FloatArray) -> list[Slip[float]]:
    """Means of squared errors that are made with N - 1, in brackets or not."""
    N = squared.size
    outside = f"`{name}` is the mean less 1: the 1 in `/ N - 1` is taken off after the division. The mean is over N."
    return [
        Slip("1 taken off the mean", outside, lambda: float(np.mean(squared)) - 1),
        Slip("N - 1 for N", f"`{name}` is divided by N - 1: divide by N.", lambda: float(np.sum(squared)) / (N - 1)),
    ]


def _means_of_a_part(name: str, got: float, squared: FloatArray) -> list[Slip[float]]:
    """The mean over the samples from one on, or up to one, if that is what was got."""
    N = squared.size
    sums, counts = np.cumsum(squared)[:-1], np.arange(1, N)
    for means, what in (
        (sums / counts, "the first {first} samples"),
        ((sums[-1] + squared[-1] - sums) / (N - counts), "the last {last} samples"),
    ):
        matching = np.flatnonzero(np.isclose(means, got, rtol=_SAME_MEAN, atol=0))
        if matching.size == 1:
            first = int(counts[matching[0]])
            text = f"`{name}` is averaged over {what.format(first=first, last=N - first)} of {N}: all of them count."
            return [Slip("mean of a part", text, partial(float, got))]
    return []


def _zero_at_first(model: ArxModel, u: FloatArray) -> FloatArray:
    """Output of a loop that begins at k = n and leaves the earlier samples at zero."""
    n = model.order
    return simulate(model, u, estimate_initial_state(model, u[:n], np.zeros(n)))


def _is_column(value: Value) -> bool:
    return isinstance(value, np.ndarray) and value.ndim == 2 and value.shape[1] == 1


def _slips(name: str, data: LabData, model: ArxModel, first: int, is_column: bool) -> Iterator[Slip[FloatArray]]:
    u, y = data.u[first:], data.y[first:]
    n = model.order

    def slip(short: str, hint: str, wrong: FloatArray) -> Slip[FloatArray]:
        return Slip(short, f"`{name}` {hint}", lambda: wrong)

    prediction = (
        "one-step prediction",
        "predicts one step ahead from the *measured* outputs. A simulation uses its own past outputs: its only "
        "input is `u`.",
    )
    numerator = np.concatenate([[0.0], model.b])
    whole = predict_one_step(model, data.u, data.y)
    own = predict_one_step(model, u, y)
    yield slip(*prediction, whole[first:])
    yield slip(*prediction, own)
    yield slip(*prediction, np.concatenate([np.zeros(n), own[n:]]))
    yield slip(*prediction, np.concatenate([y[:n], own[n:]]))
    yield slip(*prediction, own[n:])
    yield slip("measured output", "is the measured output itself; simulate with `u` alone.", y)
    # not `simulate`, which rejects overflow: the first of these diverges on a long record
    denominator = np.concatenate([[1.0], -model.a[1:]])
    of_a, of_b = (", ".join(f"{letter}{i}" for i in range(1, n + 1)) for letter in "ab")
    wrong_sign = f"comes from a model with the wrong sign of a: the denominator is 1, {of_a}."
    yield slip("sign of a", wrong_sign, lfilter(numerator, denominator, u))
    yield slip(
        "sign of b", "is right but for its sign, as with -b1 and -b2, or with -u.", lfilter(-numerator, model.a, u)
    )
    for turned in _some_of(n):
        a, b = model.a * np.r_[1, turned[:n]], model.b * turned[n:]
        which = " and ".join(f"{'ab'[i // n]}{i % n + 1}" for i in np.flatnonzero(turned < 0))
        text = (
            f"is the run with {which} alone of the wrong sign: theta holds -a1, -a2, b1, b2, and G is "
            "(b1 z + b2) / (z^2 + a1 z + a2)."
        )
        with np.errstate(all="ignore"):
            yield slip("sign of some coefficients", text, lfilter(np.r_[0.0, b], a, u))
    if n > 1:
        no_leading_one = f"has a denominator without its leading 1: it is 1, {of_a}."
        yield slip("theta in place of the denominator", no_leading_one, lfilter(numerator, model.a[1:], u))
    early = f"is one sample too early: the numerator in powers of z^-1 begins with a zero, `[0, {of_b}]`."
    yield slip("numerator one step early", early, lfilter(model.b, model.a, u))
    late = "is one sample too late: y(k) depends on u(k-1)."
    yield slip("numerator one step late", late, lfilter(np.concatenate([[0.0], numerator]), model.a, u))
    wraps = (
        f"takes `u[-1]`{' and `u[-2]`' * (n > 1)}, the *last* samples, for those before the first: an index below zero "
        f"goes round. Begin the loop with k = {n}."
    )
    yield slip(WRAPS, wraps, lfilter([1.0], model.a, wrapped_filter(numerator, u)))
    if n > 1:
        exchanged = "has a2 in the place of a1 and a1 in that of a2: a1 belongs to y(k-1), a2 to y(k-2)."
        yield slip("order of a", exchanged, lfilter(numerator, np.r_[1, model.a[:0:-1]], u))
        last = f"has a denominator whose 1 stands last: it is 1, {of_a}, the highest power first."
        for a in (model.a[1:], model.a[:0:-1]):
            with np.errstate(all="ignore"):
                yield slip("order of the denominator", last, lfilter(numerator, np.r_[a, 1], u))
        reverse = "has b1 and b2 swapped: b1 belongs to u(k-1), b2 to u(k-2)."
        yield slip("order of b", reverse, lfilter(np.concatenate([[0.0], model.b[::-1]]), model.a, u))
    along = (
        "does not depend on earlier samples: `lfilter` filters along the rows of a column, which have one element "
        "each. Give it `axis=0`, or a flat `u`."
    )
    zero = (
        "is zero at every sample, whatever the input is: print the input and the coefficients that your line hands "
        "over, "
        "and their shapes."
    )  # zeros may come from anything else, but a column of them hardly does
    yield slip(*(("filtered along the wrong axis", along) if is_column else ("zero output", zero)), np.zeros(u.size))
    yield slip("filtered along the wrong axis", along, model.b[0] * u)
    right = simulate(model, u)
    yield slip(
        "offset added back", "includes the output offset; compare offset-free signals here.", right + data.y_offset
    )
    yield Slip(
        "input offset left in",
        f"`{name}` was simulated with `u_act`. Use the offset-free `u`.",
        lambda: simulate(model, data.u_act[first:]),
    )
    both_ways = (
        "is filtered twice, forwards and then backwards, as `filtfilt` does: it depends on inputs that come later. "
        "`lfilter`, or `forced_response` of the model, goes forwards once."
    )
    yield Slip("filtered both ways", f"`{name}` {both_ways}", lambda: filtfilt(numerator, model.a, u))
    yield Slip(
        "output used as input",
        f"`{name}` was simulated with `y` as the input; the input is `u`.",
        lambda: simulate(model, y),
    )


def _pairs(name: str, data: LabData, model: ArxModel, first: int) -> Iterator[Slip[FloatArray]]:
    """Runs of a model with two of its parts changed: denominator, numerator and input."""
    n, b = model.order, model.b
    of_a, of_b = (", ".join(f"{letter}{i}" for i in range(1, n + 1)) for letter in "ab")

    def made(
        denominator: FloatArray = model.a, numerator: FloatArray = np.r_[0.0, b], u: FloatArray = data.u[first:]
    ) -> FloatArray:
        return np.asarray(lfilter(numerator, denominator, u), float)

    edits = [
        Edit("denominator", np.r_[1.0, -model.a[1:]], "its denominator has the other sign of a"),
        Edit("numerator", b, f"its numerator lacks the zero before {of_b}, and is one sample early"),
        Edit("numerator", np.r_[0.0, 0.0, b], "its numerator has two zeros at its beginning, and is one sample late"),
        Edit("numerator", np.r_[0.0, -b], "its numerator has the other sign of b"),
        Edit("u", data.u_act[first:], "its input is `u_act`, with the offset"),
        Edit("u", data.y[first:], "its input is `y`"),
    ]
    if n > 1:
        edits += [
            Edit("denominator", model.a[1:], f"its denominator has no leading 1 (it is 1, {of_a})"),
            Edit("denominator", np.r_[model.a[1:], 1.0], f"the 1 of its denominator stands last (it is 1, {of_a})"),
            Edit("denominator", np.r_[1.0, model.a[:0:-1]], f"{of_a} stand in reverse order"),
            Edit("numerator", np.r_[0.0, b[::-1]], f"{of_b} stand in reverse order"),
        ]
    yield from pairs_of(f"`{name}`", edits, made)


def _some_of(n: int) -> Iterator[FloatArray]:
    """Signs of a1 .. an and b1 .. bn of which some are turned; none for n = 1, where all of a or of b are."""
    for turned in product((1.0, -1.0), repeat=2 * n if n == 2 else 0):
        signs = np.array(turned)
        if 0 < np.sum(signs < 0) < signs.size and len(set(signs[:n])) + len(set(signs[n:])) > 2:
            yield signs


def _otherwise(name: str, got: FloatArray, right: FloatArray, model: ArxModel, u: FloatArray) -> str:
    if got.size != right.size:
        return (
            f"`{name}` has {got.size} samples; this part of the input has {right.size}. A simulation "
            "gives one output for each sample of its input."
        )
    n = int(np.argmax(np.abs(got - right) > 1e-6 * np.max(np.abs(right))))
    begun = f" It is right up to sample {n - 1}." if n > _FEW else " It differs from its first samples on."
    return f"`{name}` is not the free run of your model from rest.{begun} {_first_wrong_step(got, model, u)}"


def _first_wrong_step(got: FloatArray, model: ArxModel, u: FloatArray) -> str:
    """The first sample that does not follow from those before it and from the input, in the student's numbers."""
    n = model.order
    numerator = np.concatenate([[0.0], model.b])
    follows = lfilter(numerator, [1.0], u[: got.size]) - lfilter(np.r_[0.0, model.a[1:]], [1.0], got)
    k = int(np.argmax(np.abs(got - follows) > 1e-6 * np.max(np.abs(got), initial=1e-300)))
    if k == 0:
        return f"Its first sample is {got[0]:.4g}; from rest it is zero, as u(k-1) and y(k-1) are before it."
    lags = range(1, min(n, k) + 1)
    terms = [f"-{_indexed('a', i, n)} y({k - i})" for i in lags] + [f"{_indexed('b', i, n)} u({k - i})" for i in lags]
    return (
        f"At k = {k} it is {got[k]:.4g}, and {' + '.join(terms).replace('+ -', '- ')}, with its own samples before k, "
        f"is {follows[k]:.4g}."
    )


def _indexed(letter: str, i: int, n: int) -> str:
    """A coefficient as the notebook writes it: without a number where there is only one."""
    return letter if n == 1 else f"{letter}{i}"
