"""What a record must show for the lab to be carried out on it: one finding or more for each requirement."""

from collections.abc import Iterator

import numpy as np

from autograder.course.rig_numbers import START_MATTERS
from labsid.checks.other_records import LAB_FILE, another_record
from labsid.checks.other_records.rig_model import RigModel, identify_rig
from labsid.lab.findings import Finding, Level
from labsid.lab.identification import Identification, identify
from labsid.lab.offset import Offsets, find_offsets
from labsid.lab.step_response import cut_held_step, fit_step_response
from labsid.records.record import Record
from labsid.records.signal_quality import digits_of, runs

SHORTEST_REST = 25
"""Samples before the first change; those of the lab's own record are 51."""

SHORTEST_HOLD = 20
"""Samples of a level, of which the input of the lab has six."""

LARGEST_ERROR, WORTH_A_WARNING = 0.1, 0.05
"""Root-mean-square error of the second-order model over the whole record, as a share of the range of the output."""

WORST_CONDITION = 1e5
"""Condition number of Phi above which the normal equations lose the digits that the checks ask for."""

SLOWEST, FASTEST = 80.0, 5.0
"""Samples in the longest time constant; in the lab's own record 39."""

SMALLEST_STEP = 0.05
"""Change of the output after the first step, as a share of its range."""

SMALLEST_OFFSET = 0.03
"""Level at rest, as a share of the range; below, what forgets the offset is right, too."""

_MOST_CHANGES = 0.2  # as a share of the samples
_SEEDS = 1, 2


def about_rig(record: Record) -> list[Finding]:
    """The findings of each requirement on the record that students get."""
    if np.all(record.u == record.u[0]) or np.all(record.y == record.y[0]):
        which = "input" if np.all(record.u == record.u[0]) else "output"
        return [Finding("refused", which, f"The {which} is constant: there is nothing to identify.")]
    offsets = find_offsets(record.u, record.y)
    orders = [_identified(record, order) for order in (1, 2)]
    findings = [_rest(record, offsets), *_offset(record, offsets), _steps(record), _halves(record)]
    findings += [_first_step(record, offsets), *_order(record, orders), *_second_half(orders[1])]
    if all(finding.topic != "order 2" or finding.level != "refused" for finding in findings):
        findings += _sampling(record, orders[1])
    if all(finding.level != "refused" for finding in findings):
        findings += [_another(record), *_will_see(record, orders)]
    return findings


def _identified(record: Record, order: int) -> Identification | str:
    try:
        return identify(record, order)
    except ValueError as error:
        return str(error)


def _rest(record: Record, offsets: Offsets) -> Finding:
    n, Ts = offsets.first_period, record.Ts
    length = f"{n} {'sample' if n == 1 else 'samples'} ({n * Ts:.4g} s) before the first change of the input"
    if n < SHORTEST_REST:
        return Finding("refused", "rest", f"{length}; step 1c averages the output over at least {SHORTEST_REST}.")
    if offsets.status == "not settled":
        return Finding("refused", "rest", f"The output does not settle in the {length}.")
    first = offsets.settled[0]
    if first:
        text = f"{length}, settled from sample {first} on; students must leave the start-up out of the mean."
        return Finding("warning", "rest", text)
    return Finding("ok", "rest", f"{length}, settled from the start.")


def _offset(record: Record, offsets: Offsets) -> Iterator[Finding]:
    pairs = (("input", offsets.u_offset, record.u), ("output", offsets.y_offset, record.y))
    none = [name for name, offset, x in pairs if abs(offset) < SMALLEST_OFFSET * np.ptp(x)]
    if none:
        yield Finding(
            "warning",
            "offsets",
            f"At rest the {' and the '.join(none)} {'are' if len(none) > 1 else 'is'} near zero, so that step 1c "
            "subtracts nothing, and an answer that forgets it is right. Rest at a working point instead.",
        )
    else:
        u0, y0 = digits_of(offsets.u_offset, np.ptp(record.u)), digits_of(offsets.y_offset, np.ptp(record.y))
        yield Finding("ok", "offsets", f"u = {u0} and y = {y0} at rest.")


def _steps(record: Record) -> Finding:
    _, lengths = runs(record.u)
    if lengths.size < 4:
        text = f"The input changes {_times(lengths.size - 1)}; the lab needs at least 3 changes."
        return Finding("refused", "steps", text)
    if lengths.size > _MOST_CHANGES * len(record):
        text = "The input is not held from sample to sample: log the command, and not a measurement of it."
        return Finding("refused", "steps", text)
    longest = np.sort(lengths)[::-1][:3]
    if longest[-1] < SHORTEST_HOLD:
        text = f"No three levels of the input are held for {SHORTEST_HOLD} samples, so no figure shows where they lead."
        return Finding("warning", "steps", text)
    return Finding(
        "ok", "steps", f"{lengths.size - 1} changes of the input, levels held for {min(lengths)} samples or more."
    )


def _halves(record: Record) -> Finding:
    half = len(record) // 2
    changes = np.flatnonzero(np.diff(record.u)) + 1
    first, second = int(np.sum(changes < half)), int(np.sum(changes >= half))
    text = f"The input changes {_times(first)} in the first half, which is fitted, and {_times(second)} in the second,"
    if first < 2 or second < 1:
        return Finding("refused", "two halves", f"{text} which verifies it. Needed are 2 and 1.")
    return Finding("ok", "two halves", f"{text} which verifies it.")


def _first_step(record: Record, offsets: Offsets) -> Finding:
    try:
        t, y, amplitude = cut_held_step(record.u, record.y, record.Ts, 0, before=min(offsets.first_period, 20))
        fit = fit_step_response(t, y, amplitude)
    except ValueError as error:
        return Finding("refused", "first step", f"No response can be read from the first step: {error}")
    share = abs(fit.y_final - fit.y_initial) / float(np.ptp(record.y))
    if share < SMALLEST_STEP:
        text = (
            f"The output hardly answers the first step: by {share:.1%} of its range. A dead zone, or too small a step?"
        )
        return Finding("refused", "first step", text)
    text = f"The output changes by {share:.0%} of its range, with a time constant of {fit.model.tau:.3g} s"
    if fit.status == "not settled":
        return Finding("warning", "first step", f"{text}, and has not settled when the input changes again.")
    return Finding("ok", "first step", f"{text}, and settles.")


def _order(record: Record, orders: list[Identification | str]) -> Iterator[Finding]:
    shares = []
    for order, found in enumerate(orders, 1):
        if isinstance(found, str):
            yield Finding("refused", f"order {order}", found)
            continue
        share = error_share(found)
        shares.append(share)
        text = f"The model of the first half misses the whole record by {share:.1%} of the range of y (rms)"
        level: Level = "ok"
        if order == 2 and (not found.model.is_stable or share > LARGEST_ERROR):
            why = "" if found.model.is_stable else ", and is unstable"
            text, level = f"{text}{why}; more than {LARGEST_ERROR:.0%} is no model to work with", "refused"
        elif order == 2 and share > WORTH_A_WARNING:
            level = "warning"
        yield Finding(level, f"order {order}", f"{text}.")
    second = orders[1]
    if not isinstance(second, str) and second.fit.condition_number > WORST_CONDITION:
        text = f"The condition number of Phi is {second.fit.condition_number:.2g}, which costs digits of theta."
        unit = "Give the output in a unit in which it is about as large as the input."
        yield Finding("warning", "units", f"{text} {unit}")
    if len(shares) == 2 and shares[1] >= shares[0]:
        text = "The second-order model is no better than the first-order one: the post-lab's comparison shows that."
        yield Finding("warning", "order 2", text)


def _second_half(second: Identification | str) -> Iterator[Finding]:
    """Whether the second half begins away from the rest, which question 3b asks about."""
    if isinstance(second, str):
        return
    errors = second.verification
    if errors.mse_second_half < START_MATTERS * errors.mse_second_half_carried:
        text = (
            "It begins near the level of the rest, so that Fig. 7(a) does not show what question 3b asks: why the "
            "simulation starts elsewhere. Hold another level in the middle of the record."
        )
        yield Finding("warning", "second half", text)


def error_share(found: Identification) -> float:
    """Root-mean-square error of the simulation over the whole record, as a share of the range of y."""
    return float(np.sqrt(found.verification.mse_all) / np.ptp(found.record.y))


def _sampling(record: Record, second: Identification | str) -> Iterator[Finding]:
    tau = None if isinstance(second, str) else time_constant(second)
    if tau is None:
        return
    samples = tau / record.Ts
    text = f"One sample every {record.Ts:.4g} s, {samples:.3g} in the longest time constant, {tau:.3g} s"
    if samples > SLOWEST:
        factor = int(np.ceil(samples / 35))
        yield Finding("warning", "sampling", f"{text}. Keep fewer: --resample {record.Ts * factor:.4g}.")
    elif samples < FASTEST:
        yield Finding("warning", "sampling", f"{text}. Sample faster: the mean of five samples hides the response.")
    else:
        yield Finding("ok", "sampling", f"{text}.")


def time_constant(found: Identification) -> float | None:
    """The longest time constant of a stable model in seconds; None if it has none."""
    slowest = max(abs(pole) for pole in found.model.poles)
    return -found.model.Ts / float(np.log(slowest)) if 0 < slowest < 1 else None


def _another(record: Record) -> Finding:
    """Whether grading can draw other records, and students can get individual ones."""
    try:
        model = identify_rig(record)
        for seed in _SEEDS:
            another_record(LAB_FILE, record, seed)
    except ValueError as error:
        text = f"Hand-ins are graded on the students' own record alone, and there are no individual ones: {error}"
        return Finding("warning", "other records", text)
    return Finding("ok", "other records", f"Individual and hidden records can be made: {_described(model)}.")


def _described(model: RigModel) -> str:
    noise = f"noise of sd {model.noise:.2g}" + (f" on a lattice of {model.lattice:.4g}" if model.lattice else "")
    delay = f", a delay of {model.delay * model.Ts:.3g} s" if model.delay else ""
    return f"gain {model.gain:.4g}, longest time constant {model.time_constant:.3g} s{delay}, {noise}"


def _will_see(record: Record, orders: list[Identification | str]) -> Iterator[Finding]:
    first, second = (one for one in orders if isinstance(one, Identification))
    errors = second.verification
    yield Finding(
        "note",
        "students see",
        f"offsets {second.model.u_offset:.4g} and {second.model.y_offset:.4g}; a condition number of Phi of "
        f"{second.fit.condition_number:.3g}; MSE {errors.mse_all:.3g} over the whole record, "
        f"{errors.mse_second_half:.3g} over the second half from rest, {errors.mse_second_half_carried:.3g} from the "
        f"right state; with order 1 {first.verification.mse_all:.3g}.",
    )


def _times(count: int) -> str:
    return ("never", "once")[count] if count < 2 else f"{count} times"
