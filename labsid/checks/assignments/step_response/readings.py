"""Judge gain, time constant and delay by the response of their model, not by how they were read."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import permutations

import numpy as np

from labsid._arrays import FloatArray
from labsid.checks.answer_code import AnswerCode
from labsid.checks.compare import as_vector
from labsid.checks.figures import UNITS_OF_TIME
from labsid.checks.question import Ask
from labsid.checks.values import Value
from labsid.checks.verdict import NoAnswer, Verdict
from labsid.lab.step_response import FirstOrderDelay, StepResponseFit, first_order_response, fit_step_response

GAIN_WITHIN = 0.04
"""Relative; a careful reading of the final level is within 1 %."""
COARSE = 0.5
"""Sampling time in seconds above which a delay in samples cannot be distinguished from one in seconds."""
_SAME_WHERE_SHOWN = 0.08
"""Relative distance from the value of a known mistake whose number stands in the code: levels are read in many ways."""
_HALF = (0.5, 50.0)
SAME_READING = 0.01
"""Relative distance of tau and td that are read as a known mistake reads them, in the same samples."""
_SAME_NUMBER = 0.02
"""Relative distance of a number in the code: 0.63 is written for 0.632."""
ANOTHER_UNIT = "another unit of time"
_AT_THE_END, _NOISE = 20, 1e-4  # samples in which a settled output changes by less than this share of its range
SAME_VALUE = 0.04
"""Relative distance from the value of a known mistake, up to which it is recognised (times: plus 1.5 samples)."""


@dataclass(frozen=True, slots=True, eq=False)
class Step:
    """A recorded response to a step at t = 0.

    Attributes
    ----------
    t, y : ndarray, shape (N,)
        Time in seconds, and the output; samples at t <= 0 give the level before the step.
    amplitude : float
        Size of the step, negative for a step down.
    allowance : float
        Largest root mean square distance from the record, beyond that of the best model, as a share of the change.
    """

    t: FloatArray
    y: FloatArray
    amplitude: float
    allowance: float


@dataclass(frozen=True, slots=True)
class _Suspect:
    """The value that a known mistake gives to one parameter."""

    slip: str
    parameter: str
    value: float
    within: float
    hint: str
    shows: tuple[float, ...] = ()
    """Numbers of which the code holds one, where it computes the parameter."""


def judge_reading(got: FloatArray, step: Step, where: str, praise: str, code: AnswerCode | None = None) -> Verdict:
    """Judge ``[K, tau, td]`` as read from a step; `where` is a prefix of each reason, such as "``read_step``: ".

    Of mistakes that give nearly the same number, the `code` that computes them tells one from the other.
    """
    if code is not None and not code.calls:
        code = None  # read by eye
    fit = fit_step_response(step.t, step.y, step.amplitude)
    K, tau, td = map(float, got)
    if _is_right(got, step, fit):
        return Verdict(True, praise)
    for seconds, unit in UNITS_OF_TIME:
        if _is_right(got * [1.0, seconds, seconds], step, fit):
            return Verdict(
                False,
                f"{where}K is right, and tau and td are in {unit}: they are asked for in seconds, as the times are.",
                ANOTHER_UNIT,
            )
    right_gain = _is_right_gain(K, fit)
    if right_gain and tau == td == 0 and fit.y_final > 10 * abs(fit.y_initial):
        return Verdict(False, f"{where}tau is zero: {_one_instant(code)}", "one instant for both")
    opposite = abs(td + fit.reading.td) <= SAME_VALUE * fit.reading.td + float(step.t[1] - step.t[0])
    if right_gain and td != 0 and not opposite and _is_right(np.array([K, tau, td + 2 / 3 * tau]), step, fit):
        return Verdict(
            False,
            f"{where}K and tau are right, td is not: it is t_63 - tau, and yours is t_28 - tau.",
            "t_28 for t_63",
        )
    right = np.array([fit.reading.K, fit.reading.tau, fit.reading.td])
    within = SAME_VALUE * np.abs([fit.reading.K, fit.reading.tau, fit.reading.tau])
    within[1:] += 0.5 * float(step.t[1] - step.t[0])
    for order in [] if _is_shown(got, step, fit, code) else list(permutations(range(3)))[1:]:
        if np.all(np.abs(got[list(order)] - right) <= within):
            return Verdict(False, f"{where}K, tau and td are right, but in another order.", "order of K, tau and td")
    for slip, levels, of_what in _other_levels(step, fit) if right_gain else ():
        ways = [(level - fit.y_initial) / (fit.y_final - fit.y_initial) for level in levels]
        is_reached = all(0 < way < 1 for way in ways)
        if is_reached and _close_to(got[1:], _read_at(step, *levels)):
            return Verdict(
                False, f"{where}K is right. tau and td come of the times at which the output {of_what}", slip
            )
    if right_gain and _close_to(got[1:], _interpolated_at_levels(step, fit)):
        return Verdict(
            False,
            f"{where}tau and td are made of outputs, read at times. `np.interp(level, y, t)`, with the known levels "
            "second, is the time at which y reaches a level.",
            "outputs for times",
        )
    values = {"K": K, "tau": tau, "td": td}
    matches = list(_matches(values, step, fit, code))
    if matches:
        # of two mistakes in one parameter, the nearer one; of two parameters, the one that is looked at first
        first = matches[0][1].parameter
        nearest = min((match for match in matches if match[1].parameter == first), key=lambda match: match[0])[1]
        both = nearest.slip in ("no delay", "28.3 % taken for the delay") and any(
            suspect.slip == "tau measured from the step" for _, suspect in matches
        )
        in_tau = " Here tau is the whole time to 63.2 %, so the delay is in it: tau begins at t_d." if both else ""
        return Verdict(False, where + nearest.hint + in_tau, nearest.slip)
    if right_gain and _close_to(got[1:], _from_values(step, fit)):
        return Verdict(
            False,
            f"{where}tau and td are made of the *outputs* at 28.3 % and 63.2 %: take the times there, `t[...]`.",
            "outputs for times",
        )
    is_td = tau > 0 and _is_right(np.array([K, tau, fit.t_632 - tau]), step, fit)
    alone = " Of the three, td alone is wrong: it is t_63 - tau." if is_td else ""
    return Verdict(False, where + _deviation(values, fit, right_gain) + alone)


def _matches(
    values: Mapping[str, float], step: Step, fit: StepResponseFit, code: AnswerCode | None
) -> Iterator[tuple[float, _Suspect]]:
    """The known mistakes whose value is near, with how near it is; of those with a number, where the code holds it."""
    right_gain = _is_right_gain(values["K"], fit)
    for suspect in _suspects(step, fit):
        if (suspect.parameter == "K") == right_gain:
            continue
        if code is not None and suspect.shows and not code.has(*suspect.shows, within=_SAME_NUMBER):
            continue
        distance = abs(values[suspect.parameter] - suspect.value)
        same = _SAME_WHERE_SHOWN if code is not None and suspect.shows else SAME_VALUE
        if distance <= same * abs(suspect.value) + suspect.within:
            yield distance, suspect


def _is_shown(got: FloatArray, step: Step, fit: StepResponseFit, code: AnswerCode | None) -> bool:
    """Whether the code holds the number of a known mistake that gives this value."""
    values = dict(zip(("K", "tau", "td"), map(float, got), strict=True))
    return code is not None and any(suspect.shows for _, suspect in _matches(values, step, fit, code))


def _one_instant(code: AnswerCode | None) -> str:
    """Why the times of both levels are the first sample."""
    same = "t_28 and t_63 are the same instant, the first sample."
    least = (
        "`np.argmin(y - level)` gives the sample that is farthest *below* the level; the first one at or above it is "
        "`np.argmax(y >= level)`."
    )
    if code is not None and "argmin" in code.calls:
        return f"{same} {least}"
    never = (
        "`np.argmax(y >= level)` is 0 where *no* sample is at or above the level, as where the first one is: print "
        "both levels beside `max(y)`."
    )
    if code is not None and code.has(63.2, 63, 28.3, 28, within=_SAME_NUMBER) and not code.has(100, 0.01):
        return f"{same} No sample is at 63.2 times the final value: 63.2 % of it is 0.632 times it. ({never})"
    return f"{same} {never}" if code is not None else f"{same} {never} {least}"


def _other_levels(step: Step, fit: StepResponseFit) -> Iterator[tuple[str, tuple[float, float], str]]:
    """Levels of the output that are taken for those at 28.3 % and 63.2 % of its change, with what reaches them."""
    start, change, low, high = fit.y_initial, fit.y_final - fit.y_initial, 1 - np.exp(-1 / 3), 1 - np.exp(-1)
    whole = f"take shares of the change of the *output*, {change:.3g} here."
    for size, what in (
        (step.amplitude, f"reaches 28.3 % and 63.2 % of {step.amplitude:.3g}, the step of the *input*: {whole}"),
        (1.0, f"reaches 0.283 and 0.632 themselves: {whole}"),
    ):
        if abs(size - change) > 0.05 * abs(change):
            for level in {0.0, start}:
                yield "shares of another size", (level + low * size, level + high * size), what
    for shares, what in (
        (
            (1 - low, 1 - high),
            "reaches e^(-1/3) and e^(-1) of its change: it *rises* to 1 less these, 28.3 % and 63.2 %.",
        ),
        ((low, 1 - high), "reaches 28.3 % and 36.8 % of its change: at t_d + tau it is at 1 - e^(-1), 63.2 %."),
        ((0.1, 0.9), "reaches 10 % and 90 % of its change: the formula is for those at 28.3 % and 63.2 %."),
    ):
        yield "other percentages", (start + shares[0] * change, start + shares[1] * change), what


def _read_at(step: Step, low: float, high: float) -> list[FloatArray]:
    """tau and td from the times at which the output reaches these levels, in the samples or between them."""
    sign = np.sign(high - step.y[0]) or 1.0
    rising = np.maximum.accumulate(sign * step.y)
    pairs = []
    for t_low, t_high in (
        tuple(float(step.t[np.argmax(sign * step.y >= sign * level)]) for level in (low, high)),
        tuple(float(np.interp(sign * level, rising, step.t)) for level in (low, high)),
    ):
        tau = 1.5 * (t_high - t_low)
        pairs += [np.array([tau, t_high - tau]), np.array([tau, max(t_high - tau, 0.0)])]
    return pairs


def _from_values(step: Step, fit: StepResponseFit) -> list[FloatArray]:
    """tau and td from the outputs in place of the times, as they are or as shares of the change."""
    change = fit.y_final - fit.y_initial
    way = (step.y - fit.y_initial) / change
    pairs = []
    for values in (step.y, way):
        low, high = (float(values[np.argmax(way >= share)]) for share in (1 - np.exp(-1 / 3), 1 - np.exp(-1)))
        tau = 1.5 * (high - low)
        pairs += [np.array([tau, high - tau]), np.array([tau, max(high - tau, 0.0)])]
    return pairs


def _interpolated_at_levels(step: Step, fit: StepResponseFit) -> list[FloatArray]:
    """tau and td from the outputs at the times that have the numbers of the levels at 28.3 % and 63.2 %."""
    change = fit.y_final - fit.y_initial
    levels = (fit.y_initial + (1 - np.exp(-share)) * change for share in (1 / 3, 1))
    low, high = (float(np.interp(level, step.t, step.y)) for level in levels)
    tau = 1.5 * (high - low)
    return [np.array([tau, high - tau])] if tau else []


def _close_to(got: FloatArray, others: list[FloatArray]) -> bool:
    return any(np.allclose(got, other, rtol=0.0, atol=SAME_READING * float(np.abs(other).max())) for other in others)


def _is_right_gain(K: float, fit: StepResponseFit) -> bool:
    return any(abs(K - right) <= GAIN_WITHIN * abs(right) for right in (fit.reading.K, fit.model.K))


def _is_right(got: FloatArray, step: Step, fit: StepResponseFit) -> bool:
    K, tau, td = map(float, got)
    return _is_right_gain(K, fit) and tau > 0 and _excess(FirstOrderDelay(K, tau, td), step, fit) <= step.allowance


def _excess(model: FirstOrderDelay, step: Step, fit: StepResponseFit) -> float:
    """Root mean square distance from the record after the step, beyond the best model's, as a share of the change."""
    after = step.t >= 0
    change = fit.model.K * step.amplitude

    def mean_square(candidate: FirstOrderDelay) -> float:
        error = step.y - fit.y_initial - first_order_response(candidate, step.t, step.amplitude)
        return float(np.mean(error[after] ** 2))

    return float(np.sqrt(max(0.0, mean_square(model) - mean_square(fit.model)))) / abs(change)


def _suspects(step: Step, fit: StepResponseFit) -> Iterator[_Suspect]:
    right, a, change = fit.reading, step.amplitude, fit.y_final - fit.y_initial
    turned = "tau is negative: t_63 comes after t_28, so subtract t_28 from t_63."
    yield _Suspect("t_28 minus t_63", "tau", -right.tau, 1.5 * float(step.t[1] - step.t[0]), turned)
    Ts = float(step.t[1] - step.t[0])
    grid = 1.5 * Ts
    both = "K has the wrong sign: keep the signs of the change of the output and of the amplitude."
    if right.K > 0:
        yield _Suspect("sign of the gain", "K", -right.K, 0, both)
    if change < 0:
        downwards = (
            "in a step down, or wherever the output falls, `y >= level` is true from the start, and `np.interp` needs "
            "values that rise: compare the share of the change, which rises from 0 to 1 both ways."
        )
        for value, within in ((0.0, 0.01 * Ts), (-right.td, grid)):  # at one instant both levels are passed
            yield _Suspect("only steps up", "tau", value, within, f"tau: {downwards}")
    if abs(fit.y_initial) > 0.1 * abs(change):
        crossed = _first_time(step, 0.632 * fit.y_final)
        left_in = "the level before the step is included: use the change y - y_start."
        for value in (fit.y_final / a, fit.y_final):
            yield _Suspect("initial level left in", "K", value, 0, f"K: {left_in}")
        for value in (crossed, crossed - right.td):
            yield _Suspect("initial level left in", "tau", value, grid, f"tau: {left_in}")
    if change < 0:
        largest = "K: the largest y is not the end of a response that falls: take the mean of the last samples."
        for value in (0.0, (np.max(step.y) - fit.y_initial) / a):
            yield _Suspect("largest value for the end", "K", float(value), 0.05 * abs(right.K), largest)
    divide = "K is the whole change of the output: divide it by the amplitude."
    yield _Suspect("amplitude not divided out", "K", change, 0, divide)
    yield _Suspect(
        "gain inverted",
        "K",
        a / change,
        0,
        "K is inverted: yours is input over output, and it should be output over input.",
    )
    for amplitude in (2.0, 1.0):
        if abs(a) > 0 and abs(abs(a) - amplitude) > 0.1:
            fixed = f"K is the change over {amplitude:g}, and this step has the amplitude {a:.3g}."
            yield _Suspect("amplitude of another step", "K", change / amplitude, 0, fixed)
    absolute = "K is the absolute value: with its sign it tells whether the output falls when the input rises."
    if right.K < 0:
        yield _Suspect("absolute value of the gain", "K", abs(right.K), 0, absolute)
    early = "K was read at 63.2 % of the change; read it at the end."
    yield _Suspect("63.2 % taken for the end", "K", 0.632 * right.K, 0, early)
    if abs(right.K - change) > 0.1 * abs(change):
        of_change = (
            f"the times are those to 63.2 % and 28.3 % of K, and the response goes on to {fit.y_final:.3g}: take "
            "shares of its whole change."
        )
        t_63, t_28 = (_first_time(step, fit.y_initial + share * right.K) for share in (0.632, 0.283))
        yield _Suspect("shares of K", "tau", 1.5 * (t_63 - t_28), grid, of_change)
    upside_down = "tau is 2/3 of t_63 - t_28; by the text t_63 - t_28 is 2/3 of tau."
    yield _Suspect("the factor 3/2 inverted", "tau", 2 / 3 * (fit.t_632 - fit.t_283), Ts, upside_down, (2 / 3,))
    two_thirds = "tau is t_63 - t_28, which is only two thirds of the time constant."
    yield _Suspect("the factor 3/2 forgotten", "tau", fit.t_632 - fit.t_283, grid, two_thirds)
    way = (step.y - fit.y_initial) / change
    t_33 = float(step.t[np.argmax(way >= 1 / 3)])
    third_of_it = (
        "tau is 3/2 of the time from 33.3 % to 63.2 %; at t_d + tau/3 the response is at 28.3 %, 1 - e^(-1/3)."
    )
    yield _Suspect("a third taken for 28.3 %", "tau", 1.5 * (fit.t_632 - t_33), 0.0, third_of_it, (1 / 3,))
    t_50 = float(step.t[np.argmax(way >= 0.5)])
    from_half = third_of_it.replace("33.3 %", "50 %")
    yield _Suspect("50 % taken for 28.3 %", "tau", 1.5 * (fit.t_632 - t_50), 0.0, from_half, _HALF)
    half = "tau is measured to 50 % of the change; the time constant is the time to 63.2 %."
    yield _Suspect("50 % taken for 63.2 %", "tau", t_50 - right.td, grid, half, _HALF)
    if abs(t_50 - right.tau) > 2 * SAME_VALUE * right.tau + grid:
        yield _Suspect("50 % taken for 63.2 %", "tau", t_50, grid, half, _HALF)
    if abs(fit.t_283 - right.td) > grid + 2 * SAME_VALUE * right.td:
        third = "td is the time to 28.3 %, which is t_d + tau/3: take tau off the time to 63.2 %."
        yield _Suspect("28.3 % taken for the delay", "td", fit.t_283, grid, third)
    between = fit.t_632 - fit.t_283
    if abs(between - right.td) > grid + 2 * SAME_VALUE * right.td:
        taken = "td is t_63 - t_28, a time within tau: td is t_63 - tau."
        yield _Suspect("difference taken for the delay", "td", between, grid, taken)
    late = "td is the time to 63.2 %, which is t_d + tau: subtract tau."
    yield _Suspect("63.2 % taken for the delay", "td", fit.t_632, grid, late)
    if Ts <= COARSE:
        loosely = 0.4 * right.td / Ts
        yield _Suspect("time in samples", "td", right.td / Ts, loosely, "td counts samples; it should be in seconds.")
    if right.td > 0.1 * right.tau:
        noise = " (The first change of y is not its start: noise changes y at once.)" if _is_noisy(step) else ""
        at_once = f"td is zero, but this response has a delay: it is t_63 - tau.{noise}"
        yield _Suspect("no delay", "td", 0.0, grid, at_once)
        negative = "td is negative: the response starts after the step."
        yield _Suspect("delay with the wrong sign", "td", -right.td, grid, negative)
        from_step = "tau was measured from the step and includes the delay: measure it from t_d."
        yield _Suspect("tau measured from the step", "tau", fit.t_632, grid, from_step)
    settling = "tau is the time to 95 %; the time constant is the time to 63.2 %."
    yield _Suspect("settling time in place of the time constant", "tau", 3 * right.tau, grid, settling)
    yield _Suspect("time in samples", "tau", right.tau / Ts, 1.5, "tau counts samples; it should be in seconds.")
    yield _Suspect("time constant inverted", "tau", 1 / right.tau, 0, "tau is inverted: yours is 1/tau.")


def _deviation(values: dict[str, float], fit: StepResponseFit, right_gain: bool) -> str:
    if not right_gain:
        return (
            "K is not the change of the output divided by the amplitude of the step: it is "
            f"{values['K'] / fit.reading.K:.2g} times that. Print both levels and the amplitude."
        )
    if not values["tau"] > 0:
        return "tau is not positive; it is the time from t_d to 63.2 % of the change."
    t_28, t_63 = values["td"] + values["tau"] / 3, values["td"] + values["tau"]
    sides = [
        "too late" if got > right + grid else "too early" if got < right - grid else "at the right time"
        for got, right, grid in ((t_28, fit.t_283, 0.02 * fit.t_632), (t_63, fit.t_632, 0.02 * fit.t_632))
    ]
    return (
        f"K is right, but with this tau and td the model reaches 28.3 % at {t_28:.3g} s, {sides[0]}, and 63.2 % at "
        f"{t_63:.3g} s, {sides[1]}. When does the response reach them?"
    )


def _is_noisy(step: Step) -> bool:
    """Whether the output still changes at the end of the record, from one sample to the next."""
    end = step.y[-_AT_THE_END:]
    return bool(np.std(np.diff(end)) > _NOISE * np.ptp(step.y))


def _first_time(step: Step, level: float) -> float:
    return float(step.t[np.argmax(step.y >= level)])


def own_answer(ask: Ask, name: str, *arguments: Value) -> FloatArray | None:
    """Result of the student's function of an earlier step, whose errors count only there; None if it fails."""
    try:
        return as_vector(name, ask.call(name, *arguments))
    except NoAnswer:
        return None
