"""Description of a record and its faults, for records that `load_record` refuses, too."""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from labsid._arrays import FloatArray
from labsid.lab.findings import Finding, Marks, about_signals
from labsid.lab.several_findings import about_several_signals
from labsid.records.formats import RawRecord, cut_signals
from labsid.records.record import LARGEST, OUTPUTS, Fault, bridge_gaps, find_faults, is_sound
from labsid.records.signals import jitter_note, missing_note, name_places, span_of_outputs, stretches
from labsid.records.steps import REGULAR_WITHIN


@dataclass(frozen=True, slots=True)
class RecordCheck:
    """Findings about a record.

    Attributes
    ----------
    name : str
        Name of the record.
    samples : int
        Samples of the input.
    Ts : float or None
        Median sampling interval in seconds, if known.
    faults : tuple of Fault
        Reasons for which `load_record` refuses it.
    findings : tuple of Finding
    """

    name: str
    samples: int
    Ts: float | None
    faults: tuple[Fault, ...]
    findings: tuple[Finding, ...]

    @property
    def usable(self) -> bool:
        """Whether the lab's procedure can be carried out on the record."""
        return not any(finding.level == "refused" for finding in self.findings)

    @property
    def verdict(self) -> str:
        """One line: usable or not, and why."""
        reasons = [finding for finding in self.findings if finding.level == "refused"]
        if reasons:
            return f"usable for the lab: no, because {_first_sentence(reasons[0].text)}"
        warnings = [finding for finding in self.findings if finding.level == "warning"]
        if warnings:
            count = "1 warning" if len(warnings) == 1 else f"{len(warnings)} warnings"
            return f"usable for the lab: yes, with {count}: {_first_sentence(warnings[0].text)}"
        rests = any(finding.topic == "rest" and finding.level == "ok" for finding in self.findings)
        what = "starts at rest, is sampled" if rests else "is sampled"
        return f"usable for the lab: yes, because it {what} regularly and excites a second-order model"


def check_record(raw: RawRecord) -> RecordCheck:
    """Describe a record and its faults.

    Parameters
    ----------
    raw : RawRecord
        From `labsid.records.formats.read_raw`.

    Returns
    -------
    RecordCheck
    """
    faults = find_faults(raw)
    Ts = _usual_interval(raw)
    findings = [*_about_sampling(raw, Ts), *_about_missing(raw)]
    outputs = list(zip(raw.outputs, raw.output_columns.T, strict=True))
    for name, y in outputs:
        marks = _as_marks("missing", name if raw.several else "output", np.isnan(y))
        findings += [Finding("note", "values", f"{note}.", marks) for note in missing_note(y, raw.t, name)]
    # These findings list several places, a fault only the first.
    covered = {finding.topic for finding in findings if finding.level == "refused"}
    findings += [Finding("refused", fault.topic, fault.text) for fault in faults if fault.topic not in covered]
    measured = [y[~np.isnan(y)] for _, y in outputs]
    is_described = len(raw.u) == len(raw.y) and min(y.size for y in measured) >= 5
    if is_described and is_sound(raw.u) and all(map(is_sound, measured)):
        whole = cut_signals(raw, span_of_outputs(raw.y))
        bridged = replace(whole, y=bridge_gaps(whole.y))
        span, readings = span_of_outputs(raw.y), _readings(whole)
        about = about_several_signals(bridged, Ts) if raw.several else about_signals(bridged, Ts, readings)
        findings += [
            replace(one, marks=one.marks and one.marks.later(span.start))
            if readings is None
            else replace(one, marks=None)
            for one in about
            if not _is_of_bridge(one, whole.y)
        ]
    notes = [Finding("note", "file", f"{note}.") for note in (*raw.notes, *jitter_note(raw.jitter, Ts))]
    return RecordCheck(raw.name, len(raw.u), Ts, faults, (*notes, *findings))


def _is_of_bridge(finding: Finding, y: FloatArray) -> bool:
    """Whether a finding is about samples of an output of which most are missing, with a line in their place."""
    if finding.marks is None or not finding.marks.stretches:
        return False
    missing = np.isnan(y).reshape(len(y), -1)
    return all(missing[start:stop].mean(axis=0).max() > 0.5 for start, stop in finding.marks.stretches)


def _readings(raw: RawRecord) -> RawRecord | None:
    """The samples at which the output was read, if that is the smaller part of them."""
    read = np.flatnonzero(~np.isnan(raw.y))
    return cut_signals(raw, read) if 2 * read.size < len(raw.y) else None


def to_json_dict(check: RecordCheck) -> dict[str, Any]:
    """Convert a check to the JSON object of ``labsid check --json``.

    Parameters
    ----------
    check : RecordCheck

    Returns
    -------
    dict
        ``record, usable, refused`` (by `load_record`), ``verdict, samples, Ts, findings``.
    """
    return {
        "record": check.name,
        "usable": check.usable,
        "refused": bool(check.faults),
        "verdict": check.verdict,
        "samples": check.samples,
        "Ts": check.Ts,
        "findings": [{"level": f.level, "topic": f.topic, "text": f.text} for f in check.findings],
    }


def _usual_interval(raw: RawRecord) -> float | None:
    if raw.t is not None and raw.t.size > 1:
        steps = np.diff(raw.t[np.abs(raw.t) <= LARGEST])
        steps = steps[steps > 0]
        if steps.size:
            return float(f"{np.median(steps):.9g}")
    return raw.Ts


def _about_sampling(raw: RawRecord, Ts: float | None) -> list[Finding]:
    size = f"{len(raw.u)} samples"
    if Ts is None:
        return []
    if raw.t is None or raw.t.size < 2 or not is_sound(raw.t):
        text = f"{size}, one every {Ts:g} s as given; there are no times to verify this."
        return [Finding("note", "sampling", text)]
    steps = np.diff(raw.t)
    back = np.flatnonzero(steps <= 0)
    odd = np.flatnonzero((steps > 0) & (np.abs(steps - Ts) > REGULAR_WITHIN * Ts))
    if not back.size and not odd.size:
        gaps = "no gaps" if not np.isnan(raw.y).any() else "with gaps in y"
        text = f"{size}, one every {Ts:.6g} s, {raw.t[-1] - raw.t[0]:g} s in all; {gaps}."
        return [Finding("ok", "sampling", text)]
    findings = []
    if back.size:
        text = f"time goes backwards or stands still {_times(back.size)}: {_jumps(raw.t, back)}."
        findings.append(Finding("refused", "sampling", text, _steps_as_marks("time goes back", back)))
    if odd.size:
        longest = float(steps[odd].max())
        text = f"sampling is irregular {_times(odd.size)}: {Ts:g} s as a rule, but {_jumps(raw.t, odd)}."
        if longest > 1.5 * Ts:
            missing = round(longest / Ts) - 1
            text += f" The longest gap is {longest:g} s, about {missing} {'sample' if missing == 1 else 'samples'}."
        findings.append(Finding("refused", "sampling", text, _steps_as_marks("gaps of the log", odd)))
    return findings


def _steps_as_marks(text: str, places: np.ndarray) -> Marks:
    """Marks from a sample to the one after it."""
    return Marks(text, "", tuple((int(k), int(k) + 2) for k in places))


def _as_marks(text: str, signal: str, mask: np.ndarray) -> Marks:
    return Marks(text, signal, tuple((start, stop) for start, stop in stretches(mask)))


def _about_missing(raw: RawRecord) -> list[Finding]:
    """Stretches in which values are NaN or infinite; an output may be missing, which the notes of the record say."""
    findings = []
    for name, column in raw.columns.items():
        is_output = name in (*raw.outputs, *OUTPUTS[1:])
        bad = np.isinf(column) if is_output and not np.isnan(column).all() else ~np.isfinite(column)
        if not bad.any():
            continue
        places = stretches(bad)
        text = f"{name} is missing or not finite at samples {name_places(places)} ({bad.sum()} in all)."
        findings.append(Finding("refused", "values", text, _as_marks("not finite", name, bad)))
    return findings


def _jumps(t: FloatArray, places: np.ndarray) -> str:
    named = [f"from {t[k]:g} to {t[k + 1]:g} s at sample {k + 1}" for k in places[:4]]
    return ", ".join(named) + (", and so on" if places.size > 4 else "")


def _times(count: int) -> str:
    return "once" if count == 1 else f"{count} times"


def _first_sentence(text: str) -> str:
    return text.split(". ")[0].rstrip(".")
