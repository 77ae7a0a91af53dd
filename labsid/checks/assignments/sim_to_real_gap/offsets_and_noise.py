"""Step 1 of the gap: the offsets at rest, and the noise."""

from collections.abc import Iterator

import numpy as np

from labsid._arrays import FloatArray
from labsid.checks.assignments.lab_identification.lab_data import changed_in_place, taken_off_twice
from labsid.checks.compare import SAME, as_number, as_vector, close
from labsid.checks.question import Ask
from labsid.checks.values import Value
from labsid.checks.verdict import Slip, Verdict, first_failure, judge
from labsid.lab.offset import first_period_length, mid_range
from labsid.records.record import Record


def right_rest(ask: Ask) -> dict[str, Value]:
    """Step 1."""
    record = ask.record
    at_rest = record.y[: first_period_length(record.u)]
    y_offset = float(np.mean(at_rest))
    return {
        "u_offset": float(record.u[0]),
        "y_offset": y_offset,
        "noise_sd": float(np.std(at_rest)),
        "u": record.u - record.u[0],
        "y": record.y - y_offset,
    }


def check_rest(ask: Ask) -> Verdict:
    """Step 1: offsets, noise, and the signals without their offsets."""
    record = ask.record
    verdict = _offsets(ask, record)
    if verdict.passed:
        verdict = _noise(ask, record)
    for name, raw in (("u", record.u), ("y", record.y)):
        if verdict.passed:
            verdict = _offset_free(ask, name, raw)
    return verdict if verdict.passed else changed_in_place(ask, {"y_act": record.y, "u_act": record.u}) or verdict


@first_failure
def _offsets(ask: Ask, record: Record) -> Iterator[Verdict]:
    right = right_rest(ask)
    u_offset, y_offset = (as_number(name, ask.value(name)) for name in ("u_offset", "y_offset"))
    yield judge(
        u_offset,
        record.u[0],
        close(0, 1e-9),
        "",
        "`u_offset` is not the level of rest: take the first value of the input.",
        [
            Slip(
                "middle of the range",
                "`u_offset` is the middle of the range of the input. Take its first value, the level of rest.",
                lambda: mid_range(record.u),
            ),
            Slip(
                "mean over the whole record",
                "`u_offset` is the mean over the record. Take the first value of the input, the level of rest.",
                lambda: np.mean(record.u),
            ),
        ],
    )
    single = "`y_offset` is the value of one sample, with the noise on it. Take the mean over the rest."
    n = first_period_length(record.u)
    if np.any(np.abs(record.y[: n + 1] - y_offset) < 1e-9):
        yield Verdict(False, single, "a single sample")
    means = np.cumsum(record.y) / np.arange(1, record.y.size + 1)
    first = int(np.argmin(np.abs(means - y_offset))) + 1
    is_mean = abs(means[first - 1] - y_offset) < 1e-9 and n + 1 < first < record.y.size // 2
    if is_mean and abs(y_offset - means[n - 1]) > 0.25 * as_number("noise_sd", right["noise_sd"]):
        yield Verdict(
            False,
            f"`y_offset` is the mean of the first {first} samples, and the input first changes at sample {n}.",
            "mean over more than the rest",
        )
    part = next((m for m in range(2, n - 1) if abs(means[m - 1] - y_offset) < 1e-12 * max(abs(y_offset), 1.0)), None)
    if part is not None and abs(y_offset - means[n - 1]) > 1e-9:
        yield Verdict(
            False,
            f"`y_offset` is the mean of the first {part} samples, and the rest goes on: the input first changes at "
            f"sample {n}. Find that sample from `u_act`, and take the mean over all {n} before it.",
            "mean over a part of the rest",
        )
    yield judge(
        y_offset,
        float(np.mean(record.y[:n])),
        close(0, 0.25 * as_number("noise_sd", right["noise_sd"])),
        "",
        "`y_offset` is not the mean of the output over the rest, the samples before the input first changes.",
        [
            Slip(
                "mean over the whole record",
                "`y_offset` is the mean over the whole record. Average the rest only, before the input first changes.",
                lambda: float(np.mean(record.y)),
            ),
            Slip(
                "mean over the first half",
                "`y_offset` is the mean over the first half. Average the rest only, before the input first changes.",
                lambda: float(np.mean(record.y[: record.y.size // 2])),
            ),
            Slip(
                "middle of the range",
                "`y_offset` is the middle of the range of the output: average the rest, before the input changes.",
                lambda: mid_range(record.y),
            ),
        ],
        exactly=close(0, 1e-9),
    )


def _noise(ask: Ask, record: Record) -> Verdict:
    at_rest = record.y[: first_period_length(record.u)]
    sd = float(np.std(at_rest))
    moving = (
        "`noise_sd` is the standard deviation of the whole record, or of half of it. While the input moves, so does "
        "the output: at rest the spread is noise alone."
    )
    return judge(
        as_number("noise_sd", ask.value("noise_sd")),
        sd,
        close(0.05),
        "at rest the output varies by noise alone: no simulation can be nearer than this.",
        "`noise_sd` is not the standard deviation of the output over the rest.",
        [
            Slip("variance for standard deviation", "`noise_sd` is the variance: take its root.", lambda: sd**2),
            Slip("spread of the whole record", moving, lambda: float(np.std(record.y))),
            Slip("spread of the whole record", moving, lambda: float(np.std(record.y[: record.y.size // 2]))),
            Slip(
                "mean left in",
                "`noise_sd` is the root mean square of the output: its mean must be taken off first, as `np.std` does.",
                lambda: float(np.sqrt(np.mean(at_rest**2))),
            ),
            Slip("peak to peak", "`noise_sd` runs from peak to peak.", lambda: float(np.ptp(at_rest))),
            Slip(
                "spread of the differences",
                "`noise_sd` is made of differences of samples, which hold the noise twice.",
                lambda: float(np.std(np.diff(at_rest))),
            ),
        ],
    )


def _offset_free(ask: Ask, name: str, raw: FloatArray) -> Verdict:
    offset = as_number(f"{name}_offset", ask.value(f"{name}_offset"))
    return judge(
        as_vector(name, ask.value(name), raw.size),
        raw - offset,
        SAME,
        "rest and noise are known; what follows is deviations from rest.",
        f"`{name}` is not `{name}_act` without `{name}_offset`.",
        [
            Slip("offset left in", f"The offset is still in `{name}`.", lambda: raw),
            Slip("offset added", f"The offset is added to `{name}`; take it off.", lambda: raw + offset),
            taken_off_twice(name, raw, offset),
        ],
    )
