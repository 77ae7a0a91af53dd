"""Checks of step 1c of the lab: the offsets, and the signals without them."""

from collections.abc import Callable
from functools import partial

import numpy as np

from labsid._arrays import FloatArray
from labsid.checks.assignments.lab_identification.lab_data import changed_in_place, known_vector, taken_off_twice
from labsid.checks.compare import as_number, as_vector, close
from labsid.checks.question import Ask
from labsid.checks.values import Value
from labsid.checks.verdict import NoAnswer, Slip, Verdict, judge
from labsid.lab.offset import find_offsets, first_period_length, mid_range

_SAME_MEAN, _MOST_SAMPLES = 1e-11, 5_000

OFFSET_TOLERANCE = 0.01
"""Largest difference between valid choices of the settled part, as a share of the range of y."""


def right_offsets(ask: Ask) -> dict[str, Value]:
    """Step 1c."""
    u_act, y_act = known_vector(ask, "u_act"), known_vector(ask, "y_act")
    found = find_offsets(u_act, y_act)
    return {
        "y_offset": found.y_offset,
        "u_offset": found.u_offset,
        "y": y_act - found.y_offset,
        "u": u_act - found.u_offset,
    }


def check_offsets(ask: Ask) -> Verdict:
    """Step 1c: both offsets, and both signals without them."""
    u_act, y_act, y_actm = (known_vector(ask, name) for name in ("u_act", "y_act", "y_actm"))
    verdict = _judge_offsets(ask, u_act, y_act, y_actm)
    return verdict if verdict.passed else changed_in_place(ask, {"y_act": y_act, "u_act": u_act}) or verdict


def _judge_offsets(ask: Ask, u_act: FloatArray, y_act: FloatArray, y_actm: FloatArray) -> Verdict:
    u_offset, y_offset = (as_number(name, ask.value(name)) for name in ("u_offset", "y_offset"))
    verdict = _output_offset(y_offset, u_act, y_act, y_actm)
    if verdict.passed:
        verdict = _input_offset(u_offset, u_act, y_offset)
    for name, raw, offset, other in (("y", y_act, y_offset, y_actm), ("u", u_act, u_offset, y_act)):
        if verdict.passed:
            verdict = _offset_free(name, as_vector(name, ask.value(name)), raw, offset, other)
    return verdict


def _output_offset(got: float, u_act: FloatArray, y_act: FloatArray, y_actm: FloatArray) -> Verdict:
    offsets = find_offsets(u_act, y_act)
    n = offsets.first_period
    # possibly within the tolerance, so these are compared exactly; a right mean may equal one of them by chance
    is_mean = _is_mean_up_to(n, y_act, got)
    if not (_is_mean_up_to(n, y_act, got, n // 4) or _is_rounded(offsets.y_offset, got)):
        if not is_mean and _is_mean_up_to(n, y_actm, got):
            return Verdict(
                False,
                "`y_offset` is the mean of the measured output `y_actm`. It should be that of the noise-reduced "
                "`y_act`, from which `y` is made, too.",
                "measured output used",
            )
        if not is_mean and _is_mean_up_to(n + 1, y_act, got):
            return Verdict(
                False,
                "`y_offset` is averaged over one sample too many: `y_act[n_first]` is the sample at which the input "
                "changes. The slice `y_act[:n_first]` ends before it.",
                "off by one",
            )
        # possibly within the tolerance, but a single sample contains the noise that averaging removes
        is_near = abs(got - offsets.y_offset) <= OFFSET_TOLERANCE * float(np.ptp(y_act))
        if np.any(np.abs(got - (y_act[:n] if is_near and not is_mean else y_act[[0, n - 1]])) < 1e-9):
            return Verdict(
                False,
                "`y_offset` is the value of one sample, including its noise. Take the mean over the first period.",
                "a single sample",
            )
    second_change = n + first_period_length(u_act[n:]) if np.ptp(u_act[n:]) else u_act.size
    slips: list[Slip[float]] = [
        Slip(
            "mean over the whole record",
            "`y_offset` is the mean over the whole record. Average the first period only, before the input changes.",
            lambda: float(np.mean(y_act)),
        ),
        Slip(
            "start-up averaged in",
            "`y_offset` is the mean of the whole first period, but your record is not settled at its start: average "
            "only the constant part at the end of that period, see Fig. 5(a).",
            lambda: float(np.mean(y_act[:n])),
        ),
        Slip(
            "mean over more than the first period",
            "`y_offset` is averaged over more than the first period. Use `y_act[:n_first]`.",
            lambda: float(np.mean(y_act[:second_change])),
        ),
        Slip(
            "mean after the first period",
            "`y_offset` is averaged over the samples after the first period. Use `y_act[:n_first]`.",
            lambda: float(np.mean(y_act[n:])),
        ),
        Slip(
            "input in place of the output",
            "`y_offset` is the first value of the input. Use `y_act`.",
            lambda: float(u_act[0]),
        ),
        Slip(
            "middle of the range",
            "`y_offset` is the middle of the range of the output. Use `y_act[:n_first]`.",
            lambda: mid_range(y_act),
        ),
        Slip("no offset", "`y_offset` is zero, so that no offset is removed.", lambda: 0.0),
        *(
            Slip(
                "an extreme in place of a mean",
                f"`y_offset` is the {word} of {of}. Take a mean: `np.mean(y_act[:n_first])`, if the output "
                f"is settled there.",
                partial(_picked, pick, part),
            )
            for word, pick in (("smallest value", np.min), ("largest value", np.max), ("median", np.median))
            for of, part in (("the whole output", y_act), ("the first period", y_act[:n]))
        ),
        Slip(
            "level at the end of the record",
            "`y_offset` is the last value of the output. Average the samples before the input first changes.",
            lambda: float(y_act[-1]),
        ),
        Slip(
            "mean over the first half",
            "`y_offset` is the mean over the first half of the record. Average the first period only, "
            "`y_act[:n_first]`.",
            lambda: float(np.mean(y_act[: y_act.size // 2])),
        ),
    ]
    settled = y_act[offsets.settled[0] : offsets.settled[1]]
    low, high = float(np.min(settled)), float(np.max(settled))
    side = "above" if got > high else "below" if got < low else "within"
    otherwise = (
        "`y_offset` should be the mean of the settled output before the first change of the input. Yours, "
        f"{got:.4g}, lies {side} all that the output does there, {low:.4g} to {high:.4g}."
        if side != "within"
        else "`y_offset` should be the mean of the settled output before the first change of the input. Yours, "
        f"{got:.4g}, is among the values that the output takes there, {low:.4g} to {high:.4g}, and not their mean."
    )
    if abs(got - offsets.y_offset) <= OFFSET_TOLERANCE * float(np.ptp(y_act)):
        return Verdict(True, "")
    otherwise += _samples_of_mean(got, y_act)
    # a closer tolerance for mistakes than for right answers: two mistakes may give similar values
    return judge(got, offsets.y_offset, close(1e-5), "", otherwise, slips)


def _picked(pick: Callable[[FloatArray], np.floating], part: FloatArray) -> float:
    return float(pick(part))


def _is_rounded(mean: float, got: float) -> bool:
    """Whether `got` is this mean with fewer decimals, but more than one."""
    return any(np.round(mean, decimals) == got for decimals in range(2, 8))


def _is_mean_up_to(stop: int, y: FloatArray, got: float, fewest: int = 2) -> bool:
    """Whether `got` is the mean of several samples that end before `stop`, from any first one."""
    tail = y[:stop][::-1]
    means = (np.cumsum(tail) / np.arange(1, tail.size + 1))[max(fewest, 2) - 1 :]
    return bool(np.any(np.abs(means - got) <= 1e-12 * np.max(np.abs(y))))


def _input_offset(got: float, u_act: FloatArray, y_offset: float) -> Verdict:
    n = first_period_length(u_act)
    slips = [
        Slip(
            "middle of the input range",
            "`u_offset` is the middle of the input range. The output was averaged while the input had its *first* "
            "value: use that value.",
            lambda: mid_range(u_act),
        ),
        Slip(
            "mean over the whole record",
            "`u_offset` is the mean over the whole record. Take the first value.",
            lambda: float(np.mean(u_act)),
        ),
        Slip("output in place of the input", "`u_offset` is the offset of the output. Use `u_act`.", lambda: y_offset),
        Slip(
            "level after the first change",
            "`u_offset` is the level after the first change. Take the first value.",
            lambda: float(u_act[n]),
        ),
        Slip("no offset", "`u_offset` is zero, so that no offset is removed.", lambda: 0.0),
    ]
    otherwise = "`u_offset` is not the input of the first period. Take its first value."
    return judge(got, float(u_act[0]), close(0, 1e-6), "", otherwise, slips)


def _offset_free(name: str, got: FloatArray, raw: FloatArray, offset: float, other: FloatArray) -> Verdict:
    if got.size != raw.size:
        raise NoAnswer(
            f"`{name}` has {got.size} samples and `{name}_act` {raw.size}: subtract the offset from the entire signal.",
            "signal cut",
        )
    slips = [
        Slip("offset not removed", f"`{name}` is still `{name}_act`: subtract `{name}_offset`.", lambda: raw),
        Slip("offset added", f"`{name}_offset` was added; subtract it.", lambda: raw + offset),
        taken_off_twice(name, raw, offset),
        Slip(
            "sign of the signal",
            f"`{name}` has the wrong sign: it is the signal minus the offset.",
            lambda: offset - raw,
        ),
        Slip("divided by the offset", f"`{name}` was divided by the offset: subtract it.", lambda: raw / offset),
        Slip("another signal taken", f"`{name}` is not computed from `{name}_act`.", lambda: other - offset),
    ]
    otherwise = f"`{name}` is not `{name}_act` minus `{name}_offset`."
    return judge(
        got,
        raw - offset,
        close(1e-9, 1e-9),
        "The offsets are right, and removed from `y` and `u`.",
        otherwise,
        slips,
    )


def _samples_of_mean(got: float, y_act: FloatArray) -> str:
    """From which samples in a row a mean is made; empty if from none, or if several runs of samples give it."""
    if y_act.size > _MOST_SAMPLES:
        return ""
    sums = np.concatenate([[0.0], np.cumsum(y_act)])
    spans = []
    for count in range(2, y_act.size + 1):
        means = (sums[count:] - sums[:-count]) / count
        starts = np.flatnonzero(np.abs(means - got) <= _SAME_MEAN * max(1.0, abs(got)))
        spans += [(int(start), int(start) + count) for start in starts]
        if len(spans) > 1:
            return ""
    return f" It is the mean of `y_act[{spans[0][0]}:{spans[0][1]}]`." if spans else ""
