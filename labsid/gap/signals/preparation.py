"""The signals of a record of several inputs or outputs, as the search uses them."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np

from labsid._arrays import FloatArray
from labsid.gap.record.exclusion import MIN_SAMPLES, included_samples
from labsid.gap.signals.roles import Signals
from labsid.lab.findings import Finding
from labsid.records.record import Record, bridge_gaps

MAX_SAMPLES = 8000  # samples, as every output is searched through every input; set by hand
SAMPLES_PER_PARAMETER = 5  # of the linear responses of one output; set by hand
OWN_PARAMETERS = 6  # of one response; definition: those of `input_responses`
SAME_OUTPUT = 1e-8  # of 1, the correlation of two outputs that differ in their digits only; numerics
PROPORTIONAL = 1e-6  # of 1, the correlation of two signals from which they are in proportion; numerics


@dataclass(frozen=True, slots=True, eq=False)
class Prepared:
    """A record ready for the search.

    Attributes
    ----------
    signals : Signals
    units : tuple of str
        Of the inputs, then of the outputs.
    findings : tuple of Finding
    notes : tuple of str
        What was left out.
    """

    signals: Signals
    units: tuple[str, ...]
    findings: tuple[Finding, ...]
    notes: tuple[str, ...]


def prepare(record: Record, exclude: Sequence[tuple[float, float]] = (), what: str = "the record") -> Prepared:
    """Check the signals and choose the samples that are used.

    Parameters
    ----------
    record : Record
    exclude : sequence of (float, float)
        Time ranges, in seconds, that are neither fitted nor scored.
    what : str
        How messages call the record.

    Raises
    ------
    ValueError
        If a signal cannot be used; the message names it.
    """
    part, notes = _shortened(record)
    u, y = part.input_columns, part.output_columns
    needed = max(MIN_SAMPLES, SAMPLES_PER_PARAMETER * OWN_PARAMETERS * u.shape[1])
    if len(part) < needed:
        raise ValueError(
            f"{what} has {len(part)} samples; with {u.shape[1]} inputs a diagnosis needs at least {needed}. Use a "
            "longer record, or fewer inputs."
        )
    _check_inputs(u, part.inputs, what)
    rows = ~np.isnan(y) & included_samples(part.t, exclude)[:, None]
    kept = [j for j, name in enumerate(part.outputs) if _is_used(y[rows[:, j], j])]
    if not kept:
        raise ValueError(f"no output of {what} moves ({', '.join(part.outputs)}). Nothing can be identified from it.")
    _check_outputs(u, y, rows, part)
    left_out = [name for j, name in enumerate(part.outputs) if j not in kept]
    findings = tuple(
        Finding("warning", "signals", f"{name} has fewer than {MIN_SAMPLES} samples or never moves; it is left out.")
        for name in left_out
    )
    y = np.column_stack([bridge_gaps(y[:, j]) for j in kept])
    names = tuple(part.outputs[j] for j in kept)
    nu = len(part.inputs)
    units = (*part.units[:nu], *(part.units[nu + j] for j in kept))
    signals = Signals(part.t, u, y, rows[:, kept], part.Ts, part.inputs, names, part.name)
    return Prepared(signals, units, findings, notes)


def prepare_holdout(holdout: Record, of: Prepared) -> Prepared:
    """The same signals of another record of the rig.

    Raises
    ------
    ValueError
        If it has other signals or another sampling time.
    """
    signals = of.signals
    missing = [name for name in (*signals.inputs, *signals.outputs) if name not in (*holdout.inputs, *holdout.outputs)]
    if missing:
        raise ValueError(
            f"the holdout has no signal {missing[0]}; it has {', '.join((*holdout.inputs, *holdout.outputs))}. Name "
            "its columns as those of the record."
        )
    if abs(holdout.Ts - signals.Ts) > 1e-6 * signals.Ts:
        raise ValueError(f"the holdout runs at {holdout.Ts:g} s, the record at {signals.Ts:g} s. Resample one of them.")
    part, notes = _shortened(holdout)
    u = np.column_stack([part.input_columns[:, part.inputs.index(name)] for name in signals.inputs])
    y = np.column_stack([part.output_columns[:, part.outputs.index(name)] for name in signals.outputs])
    rows = ~np.isnan(y)
    scarce = [name for name, own in zip(signals.outputs, rows.T, strict=True) if own.sum() < MIN_SAMPLES]
    if scarce:
        raise ValueError(f"{scarce[0]} of the holdout has fewer than {MIN_SAMPLES} samples. Use a longer one.")
    y = np.column_stack([bridge_gaps(column) for column in y.T])
    return replace(
        of, signals=replace(signals, t=part.t, u=u, y=y, rows=rows, name=part.name), notes=notes, findings=()
    )


def _shortened(record: Record) -> tuple[Record, tuple[str, ...]]:
    """The part of a long record in which the inputs move most."""
    if len(record) <= MAX_SAMPLES:
        return record, ()
    u = record.input_columns
    power = (np.abs(np.diff(u, axis=0)) / np.maximum(np.ptp(u, axis=0), np.finfo(float).tiny)).sum(axis=1)
    moved = np.concatenate([[0.0], np.cumsum(power)])
    start = int(np.argmax(moved[MAX_SAMPLES:] - moved[: moved.size - MAX_SAMPLES]))
    rows = slice(start, start + MAX_SAMPLES)
    part = replace(record, t=record.t[rows], u=record.u[rows], y=record.y[rows], reference=None)
    note = (
        f"The diagnosis uses {MAX_SAMPLES} of the {len(record)} samples of the record, from t = {part.t[0]:g} s to "
        f"{part.t[-1]:g} s."
    )
    return part, (note,)


def _is_used(y: FloatArray) -> bool:
    return y.size >= MIN_SAMPLES and bool(np.ptp(y) > 0.0)


def _check_inputs(u: FloatArray, names: Sequence[str], what: str) -> None:
    for name, values in zip(names, u.T, strict=True):
        if np.ptp(values) == 0.0:
            raise ValueError(
                f"{name} of {what} never moves ({values[0]:g} throughout). Leave it out of the inputs, or begin the "
                "record before its step."
            )
    for (first, a), (second, b) in combinations(zip(names, u.T, strict=True), 2):
        if abs(np.corrcoef(a, b)[0, 1]) > 1.0 - PROPORTIONAL:
            raise ValueError(
                f"{first} and {second} of {what} move in proportion: what each of them does cannot be told apart. "
                "Leave one of them out of the inputs, or record them moving apart."
            )


def _check_outputs(u: FloatArray, y: FloatArray, rows: np.ndarray, record: Record) -> None:
    for j, name in enumerate(record.outputs):
        at = rows[:, j]
        for i, input_name in enumerate(record.inputs):
            if at.any() and np.array_equal(y[at, j], u[at, i]):
                raise ValueError(f"the output {name} holds the values of the input {input_name}. Check the columns.")
        for k in range(j):
            both = at & rows[:, k]
            if _is_used(y[both, j]) and abs(np.corrcoef(y[both, k], y[both, j])[0, 1]) > 1.0 - SAME_OUTPUT:
                raise ValueError(
                    f"the outputs {record.outputs[k]} and {name} move in proportion: one holds nothing new. "
                    "Leave one of them out."
                )
