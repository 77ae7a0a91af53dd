"""Checks of step 6 of the appendix: a step cut from the record of the lab, and the model read from it."""

from collections.abc import Callable
from dataclasses import replace
from functools import partial

import numpy as np

from labsid._arrays import FloatArray
from labsid.checks.assignments.step_response.readings import (
    ANOTHER_UNIT,
    Step,
    judge_reading,
    own_answer,
)
from labsid.checks.compare import as_number, as_vector, close
from labsid.checks.figures import UNITS_OF_TIME
from labsid.checks.question import Ask
from labsid.checks.values import Value
from labsid.checks.verdict import NoAnswer, Slip, Verdict, judge
from labsid.lab.offset import find_offsets, mean_of_first_period
from labsid.lab.step_response import cut_held_step, fit_step_response

TANK_PARAMETERS = ("K_tank", "tau_tank", "td_tank")
_same_times = close(0, absolute=1e-6)
LEVEL_WITHIN = 0.02
"""Largest difference between valid means of the level before the step, as a share of the change."""


def check_held_step(ask: Ask) -> Verdict:
    """Step 6: the first step of the record, cut out."""
    t_act, u, y = ask.record.t, ask.record.u, ask.record.y
    first, second, third = [*(np.flatnonzero(np.diff(u)) + 1), u.size][:3]
    right = give_held_step(ask)
    y_held, a_held = np.asarray(right["y_held"]), float(u[first] - u[first - 1])
    change = abs(np.mean(y_held[-10:]))
    got_y = as_vector("y_held", ask.value("y_held"))
    got_t = as_vector("t_held", ask.value("t_held"), got_y.size)
    # the sample at the second change was taken before that change acts, so both ends are right
    stop = second if got_y.size != second - first + 1 else second + 1
    single = next((k for k in (first, first - 1, 0) if _is_level(got_y, y[first:stop], y[k])), None)
    if single is not None and not any(_is_level(got_y, y[first:stop], y[k:first].mean()) for k in range(first - 2)):
        return Verdict(
            False,
            f"`y_held`: what is subtracted is one sample, number {single}, with the noise on it. Subtract the mean of "
            "settled samples before the change, for example of the last 20.",
            "a single sample",
        )
    verdict = judge(
        got_y,
        y[first:stop] - find_offsets(u, y).y_offset,
        _same_up_to_level(LEVEL_WITHIN * change),
        "",
        "`y_held` should be the output from the first change of the input up to the second, minus the level before "
        "the first.",
        [
            Slip(
                "initial level left in",
                "`y_held` still includes the level before the step: subtract it.",
                lambda: y[first:stop],
            ),
            Slip(
                "mean over the whole record",
                "`y_held`: subtract the mean before the first change, not the mean over the whole record.",
                lambda: y[first:stop] - y.mean(),
            ),
            Slip(
                "mean over the step itself",
                "`y_held`: subtract the mean before the first change, not the mean over the step.",
                lambda: y[first:stop] - y[first:stop].mean(),
            ),
            Slip(
                "level of the end",
                "`y_held`: subtract the level before the step, not the level at its end.",
                lambda: y[first:stop] - y[stop - 10 : stop].mean(),
            ),
            Slip(
                "mean before the rig has settled",
                "`y_held`: the output of this record is not settled at first; average the settled end of the first "
                "period.",
                lambda: y[first:stop] - mean_of_first_period(u, y),
            ),
            Slip(
                "the period before the step",
                "`y_held` is the output before the first change; the step comes after it.",
                lambda: y[:first] - y[:first].mean(),
            ),
            Slip(
                "cut from the start of the record",
                "`y_held` starts at the start of the record; it should start at the first change.",
                lambda: y[:second] - y[:first].mean(),
            ),
            Slip(
                "not cut at the second change",
                "`y_held` extends to the end of the record: stop at the second change.",
                lambda: y[first:] - y[:first].mean(),
            ),
            *(
                Slip(
                    "the second step",
                    "`y_held` is the output after the second change of the input; the first step is asked for.",
                    partial(np.subtract, y[second:third], level),
                )
                for level in (y[:first].mean(), y[second - 20 : second].mean(), y[first:second].mean())
            ),
            Slip(
                "off by one",
                "`y_held` starts one sample too early: np.diff(u)[k] is the change from sample k to sample k + 1.",
                lambda: y[first - 1 : stop - 1] - y[:first].mean(),
            ),
        ],
    )
    cut = {
        "the period before the step": slice(0, first),
        "cut from the start of the record": slice(0, second),
        "not cut at the second change": slice(first, None),
        "the second step": slice(second, third),
    }.get(verdict.slip or "")
    if cut is not None and any(_same_times(got_t, t_act[cut] - start) for start in (0.0, t_act[cut][0])):
        return replace(verdict, reason=f"{verdict.reason} `t_held` has the same wrong cut.")
    if verdict.passed:
        verdict = judge(
            got_t,
            t_act[first:stop] - t_act[first],
            _same_times,
            "",
            "`t_held` is not the time since the first change of the input.",
            [
                Slip("time not set back to zero", "`t_held` should start from zero.", lambda: t_act[first:stop]),
                Slip(
                    "time in samples",
                    "`t_held` counts samples; it should be in seconds.",
                    lambda: np.arange(stop - first, dtype=float),
                ),
            ],
        )
    if verdict.passed:
        verdict = judge(
            as_number("a_held", ask.value("a_held")),
            a_held,
            close(1e-6),
            "the first step of the record, starting from time zero and level zero.",
            "`a_held` is not the change of the input.",
            [
                Slip(
                    "sign of the step",
                    "`a_held` has the wrong sign: it is the new input minus the old one.",
                    lambda: -a_held,
                ),
                Slip(
                    "level in place of the change",
                    "`a_held` is the new level; it should be the change.",
                    lambda: float(u[first]),
                ),
                Slip(
                    "the second step",
                    "`a_held` is the second change; it should be the first.",
                    lambda: float(u[second] - u[first]),
                ),
            ],
        )
    return verdict


def check_tank_model(ask: Ask) -> Verdict:
    """Step 6: the model of the recorded step."""
    got = np.array([as_number(name, ask.value(name)) for name in TANK_PARAMETERS])
    settled = find_offsets(ask.record.u, ask.record.y)
    n_before = settled.settled[1] - settled.settled[0]
    t, y, a = cut_held_step(ask.record.u, ask.record.y, ask.record.Ts, 0, n_before)
    praise = "a first-order model with delay of this step."
    verdict = judge_reading(got, Step(t, y, a, 0.03), "", praise)
    if verdict.passed:
        return verdict
    t_held, y_held = (np.asarray(ask.known(name), np.float64).reshape(-1) for name in ("t_held", "y_held"))
    carried = own_answer(ask, "read_step", t_held, y_held, a)
    doubled = own_answer(ask, "read_step", 2 * t_held, 3 * y_held, a)
    depends = carried is not None and doubled is not None and not np.array_equal(carried, doubled)
    if depends and carried is not None and close(1e-6)(got, carried):
        return Verdict(True, "this is the result of your `read_step`, which is judged in step 5.")
    for seconds, unit in UNITS_OF_TIME:
        if depends and carried is not None and close(1e-6)(got * [1.0, seconds, seconds], carried):
            text = f"tau_tank and td_tank are in {unit}: they are asked for in seconds, as `t_held` is."
            return Verdict(False, text, ANOTHER_UNIT)
    for slip, hint, other_value in (
        (
            "the whole record",
            "are what `read_step` makes of the whole record: hand over the one step, `t_held` and `y_held`.",
            _whole(ask, a),
        ),
        ("model of part A", "are the values of part A: read them from the step of the record.", _of_part_a(ask)),
    ):
        if other_value is not None and close(1e-6)(got, other_value):
            return Verdict(False, f"{', '.join(TANK_PARAMETERS[:-1])} and {TANK_PARAMETERS[-1]} {hint}", slip)
    return verdict


def _whole(ask: Ask, a: float) -> FloatArray | None:
    """What the student's `read_step` makes of the whole record."""
    t, y = (np.asarray(one, np.float64) for one in (ask.record.t, ask.record.y))
    return own_answer(ask, "read_step", t, y, a)


def _of_part_a(ask: Ask) -> FloatArray | None:
    """The student's values of step 1."""
    try:
        return np.array([as_number(name, ask.value(name)) for name in ("K", "tau", "td")])
    except NoAnswer:
        return None


def _is_level(got: FloatArray, cut: FloatArray, level: float) -> bool:
    """Whether this level was subtracted, to the last digits."""
    return got.shape == cut.shape and bool(np.max(np.abs(cut - level - got)) <= 1e-12 * max(abs(level), 1e-300))


def _same_up_to_level(within: float) -> Callable[[FloatArray, FloatArray], bool]:
    def same(a: FloatArray, b: FloatArray) -> bool:
        if a.shape != b.shape:
            return False
        difference = a - b
        return bool(np.ptp(difference) < 1e-9 and abs(np.mean(difference)) <= within)

    return same


def give_held_step(ask: Ask) -> dict[str, Value]:
    """The right cut."""
    u, y = ask.record.u, ask.record.y
    t, y_held, amplitude = cut_held_step(u, y - find_offsets(u, y).y_offset, ask.record.Ts, 0, before=0)
    return {"t_held": t, "y_held": y_held, "a_held": amplitude}


def give_tank_model(ask: Ask) -> dict[str, Value]:
    """The right model."""
    u, y = ask.record.u, ask.record.y
    model = fit_step_response(*cut_held_step(u, y, ask.record.Ts, 0)).model
    return dict(zip(TANK_PARAMETERS, (model.K, model.tau, model.td), strict=True))
