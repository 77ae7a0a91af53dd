"""Findings about a record of several signals: each as in the lab, and how they depend on each other."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import combinations

import numpy as np

from labsid._arrays import FloatArray
from labsid.lab.excitation import excited_in_other_units, persistent_excitation
from labsid.lab.findings import (
    Finding,
    about_command,
    about_feedback,
    about_input,
    about_output,
    about_rest,
)
from labsid.lab.offset import find_signal_offsets
from labsid.lab.regressor import build_phi
from labsid.records.formats import RawRecord
from labsid.records.several_signals import SeveralSignals

_PROPORTIONAL = 1e-9  # largest deviation from a straight line, as a share of the range: rounding of the log


def about_several_signals(raw: RawRecord, Ts: float | None) -> list[Finding]:
    """Describe inputs and outputs of a record of several signals.

    Parameters
    ----------
    raw : RawRecord
        Its signals must be finite and of equal length, at least 5 samples.
    Ts : float or None
        Sampling time in seconds, if known; for durations in the texts.

    Returns
    -------
    list of Finding
        Each text begins with the name of its signal.
    """
    faults = signal_faults(raw)
    findings = [Finding("refused", topic, text) for topic, text in faults]
    inputs, outputs = (dict(zip(*signals, strict=True)) for signals in _named(raw))
    moving = {name: u for name, u in inputs.items() if np.ptp(u)}
    findings += [_of(name, about_input(u)) for name, u in moving.items()]
    if raw.reference is not None:
        findings.append(about_feedback(raw))
    for name, y in outputs.items():
        pairs = [raw.pair(u, name) for u in moving] if np.ptp(y) else []
        if raw.reference is None:
            findings += [_of(f"{pair.inputs[0]}, {name}", finding) for pair in pairs for finding in _feedback(pair)]
        findings += [_of(f"{pair.inputs[0]}, {name}", finding) for pair in pairs for finding in about_command(pair, Ts)]
    if not faults:
        findings += _about_rest(raw, Ts)
    findings += [_of(name, finding) for name in outputs for finding in about_output(raw.pair(0, name), None)]
    return findings if faults else [*findings, *_about_excitation(raw)]


def signal_faults(raw: SeveralSignals) -> list[tuple[str, str]]:
    """Why no model of several signals can be fitted: constant ones, proportional ones, too few samples.

    Parameters
    ----------
    raw : SeveralSignals
        Without missing outputs.

    Returns
    -------
    list of (str, str)
        Topic, and a sentence that names the column and the remedy.
    """
    return [*_constant(raw), *_proportional(raw), *_too_few(raw)]


def _named(raw: SeveralSignals) -> tuple[tuple[Sequence[str], FloatArray], tuple[Sequence[str], FloatArray]]:
    return (raw.inputs, raw.input_columns.T), (raw.outputs, raw.output_columns.T)


def _constant(raw: SeveralSignals) -> Iterator[tuple[str, str]]:
    for kind, (names, columns) in zip(("input", "output"), _named(raw), strict=True):
        for name, x in zip(names, columns, strict=True):
            if not np.ptp(x):
                why = "It excites nothing" if kind == "input" else "There is nothing to model"
                yield (
                    kind,
                    f"the {kind} {name} is constant ({x[0]:g}). {why}: leave it out of the {kind}s (--{kind}s), or "
                    "record a run in which it moves.",
                )


def _proportional(raw: SeveralSignals) -> Iterator[tuple[str, str]]:
    (inputs, u), (outputs, y) = _named(raw)
    for (name, x), (second, z) in combinations(zip((*inputs, *outputs), (*u, *y), strict=True), 2):
        slope = _slope(x, z)
        if slope is None:
            continue
        if name in inputs and second in outputs:
            if slope == 1.0 and np.array_equal(x, z):
                yield "output", f"the output {second} is the input {name}. Leave it out of the outputs (--outputs)."
            continue
        kind = "input" if name in inputs else "output"
        why = "their effects cannot be told apart" if kind == "input" else "it holds nothing new"
        yield (
            kind,
            f"the {kind} {second} is {slope:.6g} times {name}, but for a constant, so that {why}. Leave one of "
            f"them out (--{kind}s).",
        )


def _slope(x: FloatArray, z: FloatArray) -> float | None:
    """The slope of z over x, if both move and z lies on a straight line over x."""
    if not (np.ptp(x) and np.ptp(z)):
        return None
    x_free, z_free = x - x.mean(), z - z.mean()
    slope = float(x_free @ z_free / (x_free @ x_free))
    deviation = float(np.abs(z_free - slope * x_free).max())
    return slope if deviation <= _PROPORTIONAL * float(np.ptp(z)) else None


def _too_few(raw: SeveralSignals) -> Iterator[tuple[str, str]]:
    half, unknowns = len(raw.u) // 2, 1 + len(raw.inputs)
    if half - 1 < unknowns:
        yield (
            "excitation",
            f"the first half has {half} samples, too few for the {unknowns} unknowns of each output, such as "
            f"{raw.outputs[0]}, with {_inputs(raw)} and order 1. Record more samples, or name fewer inputs.",
        )


def _feedback(pair: RawRecord) -> list[Finding]:
    """Only what is to be looked at: an input that does not depend on an output needs no line for each pair."""
    finding = about_feedback(pair)
    return [] if finding.level == "ok" else [finding]


def _about_rest(raw: RawRecord, Ts: float | None) -> list[Finding]:
    offsets = find_signal_offsets(raw.input_columns, raw.output_columns)
    if offsets.status == "means":
        text = (
            "the inputs move from the first samples on: there is no period at rest from which to take the offsets, so "
            "that the means are taken."
        )
        return [Finding("note", "rest", text)]
    u = raw.input_columns[:, offsets.first]
    columns = zip(raw.outputs, raw.output_columns.T, offsets.outputs, strict=True)
    return [_of(name, about_rest(u, y, one, Ts)) for name, y, one in columns]


def _about_excitation(raw: RawRecord) -> Iterator[Finding]:
    """Whether the first half determines first- and second-order models of each output with all inputs."""
    half = len(raw.u) // 2
    u = raw.input_columns - raw.input_columns[:half].mean(axis=0)
    for name, y in zip(raw.outputs, raw.output_columns.T, strict=True):
        conditions = []
        for n in (1, 2):
            unknowns = n * (1 + len(raw.inputs))
            if half - n < unknowns:
                text = f"the first half has {half} samples, too few for the {unknowns} unknowns of order {n}."
                yield Finding("refused" if n == 1 else "warning", "excitation", f"{name}: {text}")
                break
            Phi = build_phi(u, y - y[:half].mean(), n, stop=half).Phi
            excited = persistent_excitation(Phi)
            if not excited.positive_definite:
                text = (
                    f"the first half does not excite order {n} with {_inputs(raw)}. Phi has rank "
                    f"{excited.rank} of {unknowns}, so theta is not unique: move each input more, and not all at once."
                )
                if excited_in_other_units(Phi):
                    text = (
                        "the signals are of sizes too far apart for one matrix Phi, which is singular in numbers. "
                        "Convert some of them to other units."
                    )
                yield Finding("refused" if n == 1 else "warning", "excitation", f"{name}: {text}")
                break
            conditions.append(f"{excited.condition_number:.4g} for order {n}")
        if conditions:
            text = f"{name}: cond(Phi) of the first half {' and '.join(conditions)}, with {_inputs(raw)}."
            yield Finding("ok", "excitation", text)


def _inputs(raw: SeveralSignals) -> str:
    return "1 input" if len(raw.inputs) == 1 else f"{len(raw.inputs)} inputs"


def _of(name: str, finding: Finding) -> Finding:
    """A finding with the name of its signal, or of an input and an output, before it."""
    first, _, last = name.partition(", ")
    marks = finding.marks
    if marks is not None:
        marks = replace(marks, signal=first if marks.signal == "input" else last or first)
    return replace(finding, text=f"{name}: {finding.text}", marks=marks)
