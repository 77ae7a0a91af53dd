"""Checks of part 1 of the lab: reading the record, its figures, the first period."""

from collections.abc import Iterator, Mapping, Sequence
from functools import partial

import numpy as np

from labsid._arrays import FloatArray
from labsid.checks.answer_code import code_of, nothing_returned
from labsid.checks.assignments.lab_identification.lab_data import (
    known_vector,
    measured_output,
    noise_reduced_output,
    units_of,
)
from labsid.checks.assignments.lab_identification.signal_panels import Panel, require_panels
from labsid.checks.compare import as_number, as_vector, close
from labsid.checks.question import Ask
from labsid.checks.values import Value
from labsid.checks.verdict import NoAnswer, Slip, Verdict, first_failure, judge
from labsid.lab.offset import first_period_length

EXACT = close(1e-9, 1e-9)
_FEWEST_SAMPLES = 5
_COLUMNS = "Python counts from 0: MATLAB's column 2 has the index 1."
_WHERE = (
    "MATLAB's `signals(1)`, the outputs, are `signals[0]`, and `signals(2)`, the input, is `signals[1]`. The time is "
    '`LogData["time"]`.'
)


def right_signals(ask: Ask) -> dict[str, Value]:
    """Step 1a."""
    record = ask.record
    return {
        "t": record.t,
        "y_act": noise_reduced_output(record),
        "y_actm": measured_output(record),
        "u_act": record.u,
    }


def log_data(ask: Ask) -> dict[str, Value]:
    """The structure of the lab's data file, to extract the signals from."""
    right = right_signals(ask)
    outputs = np.column_stack([np.asarray(right[name]) for name in ("y_actm", "y_act")])
    return {"LogData": {"time": right["t"], "signals": ({"values": outputs}, {"values": right["u_act"]})}}


@first_failure
def check_extract(ask: Ask) -> Iterator[Verdict]:
    """Step 1a: the four signals."""
    right = {name: np.asarray(value, float) for name, value in right_signals(ask).items()}
    for name, values in right.items():
        got = _extracted(name, ask.value(name), right)
        taken = [
            Slip(
                "y_act and y_actm swapped" if {name, taken} == {"y_act", "y_actm"} else "another signal taken",
                f"`{name}` contains `{taken}`. " + (_COLUMNS if {name, taken} == {"y_act", "y_actm"} else _WHERE),
                partial(right.__getitem__, taken),
            )
            for taken in right
            if taken != name
        ]
        counted = Slip(
            "sample number in place of time",
            f"`{name}` counts the samples; use the time in seconds from the record.",
            lambda: np.arange(values.size, dtype=float),  # noqa: B023
        )
        yield judge(
            got,
            values,
            EXACT,
            "",
            f"`{name}` is not this signal of the record. Compare your lines with those of the lab.",
            [*taken, counted],
        )
    yield Verdict(True, f"Four signals of {right['t'].size} samples each.")


def _extracted(name: str, value: Value, right: Mapping[str, FloatArray]) -> FloatArray:
    if isinstance(value, Mapping):
        raise NoAnswer(
            f"`{name}` is still a structure (a dictionary): take the field that contains the numbers.",
            "structure instead of its field",
        )
    if isinstance(value, np.ndarray) and value.ndim == 2 and value.shape[1] == 2:
        is_output = name in ("y_act", "y_actm")
        if not is_output and EXACT(value, np.column_stack([right["y_actm"], right["y_act"]])):
            other = '`LogData["time"]`' if name == "t" else 'the second signal, `LogData["signals"][1]`'
            raise NoAnswer(
                f"`{name}` contains the two outputs, which are the first signal, `signals[0]`: this one is in {other}.",
                "outputs in the place of another signal",
            )
        raise NoAnswer(f"`{name}` contains both columns: take one, `[:, 0]` or `[:, 1]`.", "both columns taken")
    got = as_vector(name, value)
    if got.size < _FEWEST_SAMPLES:
        table = np.column_stack([right["y_actm"], right["y_act"]])
        is_row = got.size == 2 and np.all(table == got, axis=1).any()
        if not is_row and not (got.size == 1 and got[0] in [*right[name], *table.flat]):
            raise NoAnswer(
                f"`{name}` is {got.tolist()}, which is no sample of this record; a signal has {right['t'].size}. Print "
                "it, and look at the line that makes it.",
                "not a signal",
            )
        raise NoAnswer(
            f"`{name}` has {got.size} entries: that is one row of the table, a single sample. A column has all rows, "
            "`[:, 0]` or `[:, 1]`.",
            "a row taken",
        )
    return got


def right_sampling_time(ask: Ask) -> dict[str, Value]:
    """Step 1a."""
    return {"Ts": ask.record.Ts}


def check_sampling_time(ask: Ask) -> Verdict:
    """Step 1a: Ts."""
    t = known_vector(ask, "t")
    value = ask.value("Ts")
    if isinstance(value, np.ndarray) and value.size == t.size - 1 and value.size > 1:
        raise NoAnswer("`Ts` contains all intervals, which are equal: give one number.", "all intervals")
    slips = [
        Slip(
            "frequency in place of time",
            "`Ts` is the sampling frequency, in samples per second. The time between two samples is the difference of "
            "two successive entries of `t`.",
            lambda: 1 / ask.record.Ts,
        ),
        Slip(
            "frequency in place of time",
            "`Ts` is the number of samples over their duration, in samples per second. The time between two samples is "
            "the difference of two successive entries of `t`.",
            lambda: float(t.size / (t[-1] - t[0])),
        ),
        Slip("length of the record", "`Ts` is the duration of the record.", lambda: float(t[-1] - t[0])),
        Slip("number of samples", "`Ts` is the number of samples.", lambda: float(t.size)),
        Slip(
            "divided by the number of samples",
            "`Ts` is divided by the number of samples; there is one interval fewer.",
            lambda: float((t[-1] - t[0]) / t.size),
        ),
        Slip(
            "milliseconds in place of seconds",
            "`Ts` is in milliseconds; it should be in seconds.",
            lambda: 1000 * ask.record.Ts,
        ),
        Slip("two samples apart", "`Ts` is twice the sampling time.", lambda: 2 * ask.record.Ts),
        Slip("minutes in place of seconds", "`Ts` is in minutes; it should be in seconds.", lambda: ask.record.Ts / 60),
        Slip(
            "the first time",
            f"`Ts` is {t[0]:g}: the time of the first sample, or a difference without its digits. Take a difference, "
            "and do not round it.",
            lambda: float(t[0]),
        ),
        Slip("mean of the times", "`Ts` is the mean of the times; take a difference.", lambda: float(np.mean(t))),
        Slip("sign of the difference", "`Ts` has the wrong sign: later minus earlier.", lambda: -ask.record.Ts),
    ]
    otherwise = (
        "`Ts` should be the time from one sample to the next: print `t[:3]`, and compare yours "
        "with the distance of two "
        "neighbours."
    )
    return judge(
        as_number("Ts", value), ask.record.Ts, close(1e-6), "This is the time between two samples.", otherwise, slips
    )


def check_figure_5(ask: Ask) -> Verdict:
    """Step 1b: Fig. 5."""
    t, y_act, y_actm, u_act = (known_vector(ask, name) for name in ("t", "y_act", "y_actm", "u_act"))
    calls = ("measured|original|y_actm", "noise|reduced|filter|smooth")
    u_unit, y_unit = units_of(ask.record)
    upper = Panel("the upper panel of Fig. 5", {"y_actm": y_actm, "y_act": y_act}, (t,), calls, y_unit)
    lower = Panel("the lower panel of Fig. 5", {"u_act": u_act}, (t,), unit=u_unit)
    require_panels("fig_5", ask.value("fig_5"), (upper, lower))
    return Verdict(True, "Fig. 5 shows both outputs and the input. Compare it with the description below.")


def check_first_period(ask: Ask) -> Verdict:
    """Step 1c: the loop, tried on unseen inputs."""
    trials = [ask.record.u, *_staircases(ask.rng)]
    is_column = np.ndim(ask.known("u_act")) == 2  # type: ignore[arg-type]
    got = np.array([_counted(ask, u.reshape(-1, 1) if is_column else u) for u in trials])
    right = np.array([first_period_length(u) for u in trials], float)

    def slip(name: str, hint: str, wrong: Sequence[float]) -> Slip[FloatArray]:
        return Slip(name, hint, lambda: np.array(wrong, float))

    code = code_of(ask, "first_period")
    loop = "" if code is None else code.ends_in_first_pass
    if loop and not np.array_equal(got, right):
        return Verdict(
            False,
            f"The `return` stands inside the loop `{loop}`, and ends the function in the first pass: put it after the "
            "loop, indented as the loop's first line is.",
            "return inside the loop",
        )
    is_counted = code is not None and code.has_loop and code.reads("u")
    changes = [np.flatnonzero(np.diff(u)) for u in trials]
    fall = [float(np.argmax(u < u[0])) for u in trials]
    rise = [float(np.argmax(u > u[0])) for u in trials]
    at_first = "" if code is None else code.index_of_the_one_before
    slips = [
        slip(
            "index wraps around",
            "It returns 0 where the last sample of the input differs from the first: at the first sample, "
            f"`{at_first}` is `u[-1]`, the *last* one. Begin with the second sample, or compare with `u[0]`.",
            [n if u[-1] == u[0] else 0.0 for u, n in zip(trials, right, strict=True)] if at_first else [],
        ),
        slip(
            "the same number for every input",
            f"It returns the same number for every input, {got[0]:g}: "
            + ("print what it returns in each pass of its loop." if is_counted else "count in the argument `u`."),
            [float(got[0])] * len(trials),
        ),
        slip(
            "off by one",
            "One too few: this is the index of the last sample of the period. Samples 0 to n - 1 are n samples.",
            list(right - 1),
        ),
        slip(
            "off by one",
            "One too many: the sample at which the input changes is not in the first period.",
            list(right + 1),
        ),
        slip(
            "all samples at the first level",
            "It counts all samples at the first level, including later ones. Stop at the first change.",
            [float(np.count_nonzero(u == u[0])) for u in trials],
        ),
        slip(
            "last change instead of the first",
            "It stops at the last change of the input; stop at the first.",
            [c[-1] + 1 for c in changes],
        ),
        slip(
            "number of changes",
            "It counts the changes of the input, not the samples before the first.",
            [c.size for c in changes],
        ),
        slip(
            "if in place of while",
            "It looks at one sample only: "
            + ("does its loop end after one pass?" if is_counted else "`if` asks once, `while` again and again."),
            [1.0 + (u[1] == u[0]) for u in trials],
        ),
        slip(
            "condition reversed",
            "The loop goes on while a sample *differs* from the first. It should go on while they are equal.",
            [float(np.argmax(u[1:] == u[0])) + 1 for u in trials],
        ),
        slip("changes in one direction only", "It does not detect a change upwards: compare with `!=` or `==`.", fall),
        slip(
            "changes in one direction only", "It does not detect a change downwards: compare with `!=` or `==`.", rise
        ),
        *(
            slip(
                "small changes not seen",
                "It does not see a small change: the input is held exactly, so compare with `==` or `!=`, without a "
                "tolerance.",
                [float(np.argmax(np.abs(u - u[0]) > least)) for u in trials],
            )
            for least in (0.01, 0.1, 0.25, 0.35)
        ),
        slip(
            "length of the input",
            "It returns the length of the input: the loop never stops at the change.",
            [u.size for u in trials],
        ),
        slip(
            "a value in place of its index",
            "It returns the new value of the input: return the index of the first sample that has it.",
            [float(u[n]) for u, n in zip(map(np.ravel, trials), right.astype(int), strict=True)],
        ),
        slip(
            "an instant of another kind",
            "It returns the sample of the largest rise. The first change may be a fall, and need not be the largest.",
            [int(np.argmax(np.diff(np.ravel(u)))) for u in trials],
        ),
        slip(
            "time instead of a number of samples",
            "It returns a time; return the number of samples.",
            list(right * ask.record.Ts),
        ),
    ]
    at_own_level = [u - u[0] + ask.record.u[0] for u in trials[1:]] if got[0] == right[0] else []
    shifted = [_counted(ask, u.reshape(-1, 1) if is_column else u) for u in at_own_level]
    if shifted and np.array_equal(shifted, right[1:]) and not np.array_equal(got, right):
        otherwise = (
            f"It is right for inputs that begin with {ask.record.u[0]:g}, as your record does, and wrong for others: "
            "compare with `u[0]`, and not with that value."
        )
    elif got[0] == right[0] and not np.all(got == got[0]):
        otherwise = "It is right for this record, but wrong for another input. Try it on short inputs of your own."
    else:
        otherwise = (
            "It does not return the number of samples before the first change. Try it on a short input: [2, 2, 2, 1]."
        )
    return judge(got, right, close(0, 1e-9), "Right, also for unseen inputs.", otherwise, slips)


def right_first_period(ask: Ask) -> dict[str, Value]:
    """Step 1c."""
    return {"n_first": first_period_length(ask.record.u)}


def _counted(ask: Ask, u: FloatArray) -> float:
    value = ask.call("first_period", u)
    if value is None:
        raise nothing_returned(ask, "first_period", "the number", "nothing returned")
    if np.ndim(value):  # type: ignore[arg-type]
        changed = np.flatnonzero(np.ravel(u) != np.ravel(u)[0])
        if np.size(value) == changed.size and np.array_equal(np.ravel(np.asarray(value, float)), changed):  # type: ignore[arg-type]
            text = (
                f"`first_period(u)` returns all {changed.size} samples at which u is not what it was first. The "
                "first of these indices is the answer: take it, `[0]` of the array. (`np.where` returns a tuple with "
                "the array in it, so there it is `[0][0]`.)"
            )
            raise NoAnswer(text, "all indices in place of the first")
        if np.size(value) == np.size(u) and set(np.ravel(np.asarray(value, float))) <= {0.0, 1.0}:  # type: ignore[arg-type]
            text = (
                "`first_period(u)` returns a truth value for each sample, and one number is asked for: how many "
                "samples come before the first that differs."
            )
            raise NoAnswer(text, "a list in place of its length")
        raise NoAnswer(
            f"`first_period(u)` returns a list of {np.size(value)}, and one number is asked for"  # type: ignore[arg-type]
            + (": return how many there are, `len(...)`." if np.size(value) > 1 else ": leave the brackets out."),  # type: ignore[arg-type]
            "a list in place of its length",
        )
    return as_number("first_period(u)", value)


def _staircases(rng: np.random.Generator) -> list[FloatArray]:
    """Inputs that first rise, first fall, change after one sample, and return to their first level."""
    steps = ((0.3, -0.3, 0.0), (-0.4, 0.2, 0.0), (0.05, -0.3, 0.05), (-0.2, 0.4, 0.0))
    made = []
    for trial, (second, third, fourth) in enumerate(steps):
        level = np.round(rng.uniform(1.5, 2.5), 2)
        holds = rng.integers(5, 60, size=4)
        if trial == len(steps) - 1:
            holds[0] = 1
        made.append(np.repeat(level + np.array([0.0, second, third, fourth]), holds))
    return made


def check_figure_6(ask: Ask) -> Verdict:
    """Step 1c: Fig. 6."""
    t, y, u = (known_vector(ask, name) for name in ("t", "y", "u"))
    u_unit, y_unit = units_of(ask.record)
    upper = Panel("the upper panel of Fig. 6", {"y": y}, (t,), unit=y_unit)
    lower = Panel("the lower panel of Fig. 6", {"u": u}, (t,), unit=u_unit)
    require_panels("fig_6", ask.value("fig_6"), (upper, lower))
    return Verdict(True, "Fig. 6 shows both signals without their offsets; both start at zero.")
