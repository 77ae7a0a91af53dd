"""Findings about the signals of a record: rest, levels, noise, converter, clipping, feedback, excitation."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np

from labsid._arrays import FloatArray, stretches_of
from labsid.lab.command_faults import log_step, unanswered_command
from labsid.lab.excitation import excitation_order, excited_in_other_units, persistent_excitation
from labsid.lab.offset import Offsets, find_offsets, mean_of_first_period, remove_offsets
from labsid.lab.plateaus import Plateaus, repeated_plateaus
from labsid.lab.regressor import build_phi
from labsid.records.direction import feedback_statistic, gain_from_past
from labsid.records.formats import RawRecord
from labsid.records.record import is_sound
from labsid.records.signal_quality import (
    digits_of,
    find_held,
    isolated_samples,
    lattice_step,
    moving_mean_length,
    runs,
    scatter,
    shortest_hold,
    stuck_at_extreme,
)
from labsid.records.signals import name_places
from labsid.records.slow_sensor import find_readings

Level = Literal["ok", "note", "warning", "refused"]

_MAX_LEVELS = 20  # of a staircase input
_TESTED_ORDER = 10


@dataclass(frozen=True, slots=True)
class Marks:
    """Where a record shows a finding.

    Attributes
    ----------
    text : str
        One to five words.
    signal : str
        "input" or "output", of several signals the name of one; empty of all.
    stretches : tuple of (int, int)
        First sample of each, and the one after its last.
    """

    text: str
    signal: str
    stretches: tuple[tuple[int, int], ...]

    def later(self, samples: int) -> "Marks":
        """The same marks in a record with so many samples before."""
        return replace(self, stretches=tuple((start + samples, stop + samples) for start, stop in self.stretches))


@dataclass(frozen=True, slots=True)
class Finding:
    """A property or fault of a record.

    Attributes
    ----------
    level : {"ok", "note", "warning", "refused"}
        "note": for information. "warning": a step of the lab goes wrong unless it is taken into account. "refused":
        the lab's procedure cannot be carried out.
    topic : str
        One or two words.
    text : str
        One or more sentences; the first can be quoted alone.
    marks : Marks or None
        Where the record shows it, for a figure.
    """

    level: Level
    topic: str
    text: str
    marks: Marks | None = field(default=None, compare=False)


UNJUDGED = Finding("note", "feedback", "not judged: the output is missing while the input changes.")


def about_signals(raw: RawRecord, Ts: float | None, readings: RawRecord | None = None) -> list[Finding]:
    """Describe input and output of a record.

    Parameters
    ----------
    raw : RawRecord
        Its u and y must be finite and of equal length, at least 5 samples.
    Ts : float or None
        Sampling time in seconds, if known; for durations in the texts.
    readings : RawRecord, optional
        The samples at which the output was read, of one that is missing at most of them: its noise is judged by these.

    Returns
    -------
    list of Finding
    """
    u, y = raw.u, raw.y
    if np.all(u == u[0]):
        text = f"the input is constant ({u[0]:g}). It excites nothing, so no model can be identified."
        return [Finding("refused", "input", text), *about_output(raw, None)]
    if np.all(y == y[0]):
        text = f"the output is constant ({y[0]:g}). There is nothing to model."
        return [about_input(u), Finding("refused", "output", text)]
    offsets, plateaus = find_offsets(u, y), repeated_plateaus(u, y)
    return [
        about_input(u),
        *about_command(raw, Ts),
        about_feedback(raw) if readings is None else UNJUDGED,
        about_rest(u, y, offsets, Ts),
        *([] if plateaus is None else [about_plateaus(plateaus)]),
        *(about_output(raw, offsets) if readings is None else about_output(readings, None)),
        *about_filter(raw, Ts),
        _about_excitation(u, y, offsets),
    ]


def about_input(u: FloatArray) -> Finding:
    """Levels of a staircase and how long they are held, or range and limits of an input that moves more."""
    starts, lengths = runs(u)
    levels = np.unique(u)
    span = float(np.ptp(u))

    def shown(level: float) -> str:
        return digits_of(float(level), span, 6)

    changes = starts.size - 1
    if levels.size <= _MAX_LEVELS:
        text = f"{levels.size} levels ({', '.join(shown(level) for level in levels)}), {changes} changes"
        if changes > 10:
            return Finding("ok", "input", f"{text}, held {lengths.min()} to {lengths.max()} samples.")
        held = ", ".join(f"{shown(u[k])} for {n}" for k, n in zip(starts, lengths, strict=True))
        return Finding("ok", "input", f"{text}; held (samples): {held}.")
    text = f"between {shown(levels[0])} and {shown(levels[-1])}, moving at {changes / (u.size - 1):.0%} of the samples."
    stops = [(extreme, *stuck_at_extreme(u, extreme)) for extreme in (levels[0], levels[-1])]
    named = [
        f"{shown(extreme)} ({samples} samples, {longest} in a row)" for extreme, samples, longest in stops if samples
    ]
    if named:
        at_limit = stretches_of(np.isin(u, [extreme for extreme, samples, _ in stops if samples]))
        marks = Marks("input at a limit", "input", _pairs(at_limit))
        return Finding("note", "input", f"{text} It rests on a limit: {' and '.join(named)}.", marks)
    return Finding("ok", "input", text)


def about_command(raw: RawRecord, Ts: float | None) -> list[Finding]:
    """Whether the log of the input is coarse, and whether the rig gets what is logged; `raw` as for `about_signals`."""
    findings = []
    step = log_step(raw.u)
    if step is not None and np.unique(raw.u).size > _MAX_LEVELS:
        text = (
            f"it is logged in steps of {step:.4g}, {step / float(np.ptp(raw.u)):.1%} of its range. What acts on the "
            "rig may be finer: log it with more digits."
        )
        findings.append(Finding("note", "input", text))
    stretch = unanswered_command(raw.u, raw.y)
    if stretch is not None:
        start, stop = stretch
        where = f"samples {start} to {stop - 1}" if Ts is None else f"{start * Ts:.4g} to {(stop - 1) * Ts:.4g} s"
        text = (
            f"the output stands still from {where} while the input goes on. The command may not have reached the rig: "
            "look for a drive that has tripped, or an emergency stop."
        )
        findings.append(Finding("warning", "input", text, Marks("flat while u moves", "output", (stretch,))))
    return findings


def about_feedback(raw: RawRecord) -> Finding:
    """Whether the input depends on the output; `raw` as for `about_signals`."""
    if raw.reference is not None:
        text = (
            "it is a closed-loop record (it has a reference). The input depends on the output, so noise "
            "reaches both and a least-squares fit is biased; use it to verify a loop or a model."
        )
        return Finding("refused", "feedback", text)
    has_levels = np.unique(raw.u).size <= _MAX_LEVELS
    # y is advanced by one sample, because a controller computes u from the y of the same sample.
    gain = gain_from_past(raw.y[1:], raw.u[:-1]) if has_levels else feedback_statistic(raw.u, raw.y)
    if gain <= 10:
        return Finding("ok", "feedback", "none seen: the output does not help to predict the input.")
    text = f"the output up to the same sample helps to predict the input (F = {gain:.3g})."
    if has_levels:
        return Finding("note", "feedback", f"{text} A periodic input has this effect, as has a relay in closed loop.")
    text += (
        " The record was probably taken in closed loop, and a least-squares fit is then biased. A rig that is far from "
        "linear looks like this, too, if its input is smooth."
    )
    return Finding("warning", "feedback", text)


def about_rest(u: FloatArray, y: FloatArray, offsets: Offsets, Ts: float | None) -> Finding:
    """Whether the record begins at rest, and at which sample the output has settled."""
    k0, n = offsets.settled
    length = f"{n} samples" + (f" ({n * Ts:g} s)" if Ts else "")
    if n == 1:
        text = "the input changes at sample 1: no samples before it show the rest from which to take the offsets."
        return Finding("refused", "rest", text)
    if offsets.status == "too short":
        text = f"only {length} come before the first change of the input, too few to see whether the output is settled."
        return Finding("warning", "rest", text)
    if offsets.status == "not settled":
        text = (
            f"the output does not settle in the {length} before the input first changes. The mean of their last "
            f"quarter, {offsets.y_offset:.5g}, is the best available offset, but biased."
        )
        return Finding("warning", "rest", text, Marks("not at rest", "output", ((0, n),)))
    rest = Marks("at rest", "output", ((k0, n),))
    noise = float(np.std(y[k0:n]))
    if k0 == 0:
        u_rest, y_rest = digits_of(offsets.u_offset, np.ptp(u), 6), digits_of(offsets.y_offset, np.ptp(y), 5)
        text = f"settled from the start: {length} before the first change, u = {u_rest}, y = {y_rest}, sd {noise:.2g}."
        return Finding("ok", "rest", text, rest)
    first = digits_of(y[0], np.ptp(y), 3)
    text = (
        f"not settled at the start: y comes from {first} and is at rest only in samples {k0} to {n - 1} of the "
        f"{length} before the input first changes. Average these: y offset {offsets.y_offset:.5g}, sd {noise:.2g}. "
        f"The mean of all of them would be {mean_of_first_period(u, y):.5g}."
    )
    return Finding("warning", "rest", text, rest)


def about_plateaus(plateaus: Plateaus) -> Finding:
    """Levels of y at the end of each input period, and whether they repeat at the same input."""
    at_levels = [
        f"{', '.join(f'{y_end:.3f}' for y_end in values)} at u = {level:g}" for level, values in plateaus.ends.items()
    ]
    listed, share = "; ".join(at_levels), f"{plateaus.largest / plateaus.span:.1%} of"
    if plateaus.repeat:
        return Finding("ok", "plateaus", f"y comes back to the same levels within {share} its range: {listed}.")
    text = (
        f"y does not come back to the same level at the same input: {listed}. The largest difference is "
        f"{share} the range of y. A linear model driven by u settles at one level for each input."
    )
    return Finding("note", "plateaus", text)


def about_output(raw: RawRecord, offsets: Offsets | None) -> list[Finding]:
    """Range, noise, converter step and held values; of the measured output, if it was logged."""
    y, sensor = raw.y, raw.y_measured
    if sensor is None or sensor.size != y.size or not is_sound(sensor):
        sensor = y
    findings = [
        Finding("ok", "output", f"between {digits_of(y.min(), np.ptp(y))} and {digits_of(y.max(), np.ptp(y))}.")
    ]
    which = "measured output" if raw.y_measured is not None else "output"
    if offsets is not None and offsets.status == "settled":
        noise, where = float(np.std(sensor[slice(*offsets.settled)])), f"{which}, settled"
    else:
        noise, where = scatter(sensor), f"{which}, from sample to sample: an upper bound while y moves"
    y_range = float(np.ptp(y))
    share = f", {noise / y_range:.1%} of the range of y" if y_range > 0 else ""
    findings.append(Finding("ok", "noise", f"sd {noise:.2g} ({where}){share}."))
    step = lattice_step(sensor)
    if step is not None and step > noise / 10:
        against = f"{step / noise:.2g} times the noise" if noise > 0 else "and there is no noise"
        text = f"values lie on a lattice of {step:.5g}{_converter(step)}, {against}."
        findings.append(Finding("note" if step > 2 * noise else "ok", "converter", text))
    findings += about_clipping(y)
    if (readings := find_readings(raw.u, sensor)) is not None:
        text = (
            f"y has a new value at one sample in {readings.every:.3g} only: its sensor or its bus is slower than the "
            "logger. The values between are repeated ones, and no measurements."
        )
        return [*findings, Finding("warning", "held values", text)]
    stuck = [extreme for extreme in (y.min(), y.max()) if stuck_at_extreme(y, extreme)[0]]
    stretches = find_held(sensor, step, shortest_hold(sensor)) if noise > 0 else ()
    held = [(k - 1, stop) for k, stop in stretches if sensor[k] not in stuck]
    if held:
        total = sum(stop - k for k, stop in held)
        text = (
            f"y repeats one value for longer than its noise allows at samples {name_places(held)} ({total} in "
            "all). The logger may have kept its last value."
        )
        findings.append(Finding("warning", "held values", text, Marks("held values", "output", _pairs(held))))
    return [*findings, *about_spikes(raw.u, sensor)]


def about_clipping(y: FloatArray) -> list[Finding]:
    """Extremes at which y is clipped."""
    findings = []
    for extreme, word in ((float(y.min()), "lowest"), (float(y.max()), "highest")):
        samples, longest = stuck_at_extreme(y, extreme)
        if samples:
            where = digits_of(extreme, np.ptp(y), 6)
            text = (
                f"y is stuck at its {word} value {where} for {samples} samples ({longest} in a row), so it looks "
                "clipped. A linear model cannot reproduce this."
            )
            marks = Marks(f"clipped at its {word}", "output", _pairs(stretches_of(y == extreme)))
            findings.append(Finding("warning", "clipping", text, marks))
    return findings


def about_spikes(u: FloatArray, y: FloatArray) -> list[Finding]:
    """Single samples of y far from those beside them, which the input does not explain."""
    at = isolated_samples(u, y)
    if not at.size:
        return []
    places = [(int(k), int(k) + 1) for k in at]
    text = (
        f"y leaves its course for a single sample at sample {name_places(places)} ({at.size} in all), and comes back: "
        "a spike of the sensor or of its line. Exclude these samples from a fit."
    )
    return [Finding("note", "spikes", text, Marks("spikes", "output", _pairs(places)))]


def _pairs(stretches: Iterable[Sequence[int]]) -> tuple[tuple[int, int], ...]:
    return tuple((int(start), int(stop)) for start, stop in stretches)


def _converter(step: float) -> str:
    """The common converters with this step."""
    named = [
        f"{bits} bits over {span:g}"
        for span in (5.0, 10.0, 20.0, 3.3)
        for bits in (8, 10, 12, 14, 16)
        if abs(step * 2**bits - span) < 1e-6 * span
    ]
    return f" (a converter of {' or '.join(named)})" if named else ""


def about_filter(raw: RawRecord, Ts: float | None) -> list[Finding]:
    """The filter between the measured output and the noise-reduced one; empty unless both were logged."""
    before, after = raw.y_measured, raw.y_noise_reduced
    if before is None or after is None or before.size != after.size:
        return []
    if not (is_sound(before) and is_sound(after)):
        return []
    m = moving_mean_length(before, after)
    if m is None:
        text = "the noise-reduced output is not a moving mean of the measured one."
    elif m == 1:
        text = "the noise-reduced output is the measured one, unchanged."
    else:
        delay = f"{(m - 1) / 2:g} samples" + (f" ({(m - 1) / 2 * Ts:g} s)" if Ts else "")
        text = (
            f"the noise-reduced output is exactly the mean of the last {m} samples of the measured one. That "
            f"filter, a delay of {delay}, is in the data, so the identified model contains it."
        )
    return [Finding("note", "noise reduction", text)]


def _about_excitation(u: FloatArray, y: FloatArray, offsets: Offsets) -> Finding:
    u_free, y_free = remove_offsets(u, y, offsets)
    half = u.size // 2
    conditions = []
    for n in (1, 2):
        try:
            Phi = build_phi(u_free, y_free, n, stop=half).Phi
        except ValueError:
            text = f"the first half has {half} samples, too few rows for the {2 * n} unknowns of order {n}."
            return Finding("refused", "excitation", text)
        result = persistent_excitation(Phi)
        if not result.positive_definite:
            text = (
                f"the first half does not excite order {n}. Phi has rank {result.rank} of {2 * n}, so theta is not "
                "unique: the input must change more than once before the middle of the record."
            )
            if excited_in_other_units(Phi):
                text = (
                    f"y is at most {np.abs(y_free).max():.3g} and u {np.abs(u_free).max():.3g}, offsets removed: too "
                    "far apart for one matrix Phi, which is singular in numbers. Convert one of them to other units."
                )
            return Finding("refused", "excitation", text)
        conditions.append(f"{result.condition_number:.4g} for order {n}")
    order = excitation_order(u_free, largest=_TESTED_ORDER, rounding=_rounding_of(u))
    at_least = "at least " if order == _TESTED_ORDER else ""
    text = (
        f"input persistently exciting of order {at_least}{order}; cond(Phi) of the first half "
        f"{' and '.join(conditions)}."
    )
    if order < 2:
        return Finding("warning", "excitation", f"{text} A second-order model needs order 2.")
    return Finding("ok", "excitation", text)


def _rounding_of(u: FloatArray) -> float:
    """Step to which the log rounds an input that takes many values; 0 for a few levels, which are exact."""
    if np.unique(u).size <= _MAX_LEVELS:
        return 0.0
    return lattice_step(u) or 0.0
