"""The steps from the columns of a log to evenly sampled signals; each says what it did."""

from dataclasses import replace

import numpy as np

from labsid._arrays import FloatArray
from labsid.records.choice import Chosen
from labsid.records.clocks import bring_together, resampled
from labsid.records.column import stamps_column
from labsid.records.even_times import (
    MAX_BY_WORD,
    MAX_DEVIATION,
    MAX_JITTER,
    EvenTimes,
    fit_coarse_stamps,
    fit_dropped_rows,
    fit_even_times,
    resolution,
)
from labsid.records.reading import Reading
from labsid.records.resampling import decimate, even_grid, hold, is_held, longest_hold
from labsid.records.several_signals import names_of
from labsid.records.signals import Signals, is_input, name_places, stretches
from labsid.records.stamp_order import select_run, sorted_rows, without_repeats
from labsid.records.stamps import in_seconds

REGULAR_WITHIN = 0.01  # largest deviation of an interval from the median one, as a share of it


def signal_keys(chosen: Chosen) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Keys of inputs and outputs in `Signals.values`: u and y, of several u1, u2, ... and y1, y2, ..."""
    return names_of("u", (), len(chosen.inputs)), names_of("y", (), len(chosen.outputs))


def signals_of(chosen: Chosen, how: Reading) -> Signals:
    """Times in seconds and the signals of the chosen columns, before anything is done to them."""
    inputs, outputs = signal_keys(chosen)
    columns = dict(zip((*inputs, *outputs), (*chosen.inputs, *chosen.outputs), strict=True))
    names = {key: column.name for key, column in columns.items()} if chosen.named else {}
    columns |= {column.name: column for column in chosen.others}
    values = {key: column.numbers for key, column in columns.items()}
    signals = Signals(None, values, chosen.notes, names=names)
    if chosen.t is not None:
        stamps = in_seconds(chosen.t, how.time_unit)
        return replace(signals, t=stamps.t).said(*stamps.notes)
    own = {key: column.stamps for key, column in columns.items() if column.stamps is not None}
    if len(own) < len(columns) or how.Ts is not None:
        return signals
    both = in_seconds(stamps_column(np.concatenate(list(own.values()))))
    parts = np.split(both.t, np.cumsum([x.size for x in own.values()])[:-1])
    times = dict(zip(own, parts, strict=True))
    signals = signals.said(*both.notes)
    if all(np.array_equal(t, parts[0]) for t in parts):
        return replace(signals, t=parts[0])
    return bring_together(signals, times, how)


def even_signals(signals: Signals, how: Reading) -> Signals:
    """Bring the signals of a log to even times, as far as that takes no guess; see `Reading`.

    Parameters
    ----------
    signals : Signals
    how : Reading

    Returns
    -------
    Signals
        With times that are not even where two readings are possible; `find_faults` names the options that decide.

    Raises
    ------
    ValueError
        If there is no such run or stretch, or the log cannot be resampled.
    """
    lengths = {x.size for x in signals.values.values()}
    if signals.t is not None and signals.t.size >= 2 and lengths == {signals.t.size}:
        if np.isfinite(signals.t).all() and np.abs(signals.t).max() < 1e100:
            signals = _at_even_times(_cut(select_run(signals, how.select), how), how)
    elif signals.t is None and len(lengths) == 1 and how.Ts is not None:
        t = np.arange(min(lengths), dtype=np.float64) * how.Ts
        signals = replace(_cut(replace(signals, t=t), how), t=None)
    if how.resample is not None and (signals.t is None or how.Ts is not None):
        raise ValueError("resample needs times; the log has none. Name its time column (--columns t,u,y).")
    signals = _inputs_held(signals)
    if how.decimate is not None:
        signals = _decimated(signals, how.decimate)
    return signals


def _cut(signals: Signals, how: Reading) -> Signals:
    if how.since is None and how.until is None:
        return signals
    assert signals.t is not None
    low, high = -np.inf if how.since is None else how.since, np.inf if how.until is None else how.until
    rows = (signals.t >= low) & (signals.t <= high)
    if rows.sum() < 2:
        raise ValueError(
            f"from {low:g} to {high:g} s (--from, --to) there are {rows.sum()} samples; the log runs from "
            f"{signals.t.min():g} to {signals.t.max():g} s."
        )
    said = f"cut to {rows.sum()} of {rows.size} samples, from {signals.t[rows].min():g} to {signals.t[rows].max():g} s"
    return signals.rows(rows).said(said)


def _at_even_times(signals: Signals, how: Reading) -> Signals:
    assert signals.t is not None
    coarse = None if how.resample is not None else fit_coarse_stamps(signals.t)
    if coarse is not None and np.all(np.diff(signals.t) >= 0.0):
        shared = round(signals.t.size / np.unique(signals.t).size, 1)
        note = f"stamps that {shared:g} samples share, as of a buffer or a coarse clock, spread to {coarse.Ts:g} s each"
        return replace(signals, t=coarse.t).said(note)
    signals = sorted_rows(without_repeats(signals, how.repeated))
    if how.resample is not None:
        return _resample(signals, how.resample)
    assert signals.t is not None
    steps = np.diff(signals.t)
    if steps.size < 2 or np.any(steps <= 0.0):
        return signals
    usual = float(np.median(steps))
    even = fit_even_times(signals.t, MAX_DEVIATION if how.Ts is None else MAX_BY_WORD)
    regular = bool(np.all(np.abs(steps - usual) <= REGULAR_WITHIN * usual))
    if regular and (even is None or even.jitter <= REGULAR_WITHIN):
        return signals
    even = even or fit_dropped_rows(signals.t)
    if even is None or not (regular or _is_even(even, signals.t, how)):
        return signals
    return _on_grid(signals, even, how)


def _is_even(even: EvenTimes, stamps: FloatArray, how: Reading) -> bool:
    """Whether these stamps are those of even samples: nearly even, rounded, or even by the caller's word."""
    return even.largest <= MAX_JITTER or how.Ts is not None or _is_rounding(even, stamps)


def _is_rounding(even: EvenTimes, stamps: FloatArray) -> bool:
    digit = resolution(stamps)
    return digit <= 0.5 * even.Ts and even.largest * even.Ts <= 0.75 * digit


def _on_grid(signals: Signals, even: EvenTimes, how: Reading) -> Signals:
    assert signals.t is not None
    notes = []
    jitter = even.jitter if even.jitter > 1e-9 else 0.0  # rounding errors of floats
    if _is_rounding(even, signals.t):
        jitter = 0.0
        if even.largest > REGULAR_WITHIN:
            notes.append(f"stamps are rounded to {resolution(signals.t):g} s; taken as every {even.Ts:.9g} s")
    dropped = even.t.size - signals.t.size
    if dropped:
        gaps = np.ones(even.t.size, bool)
        gaps[even.places] = False
        notes.append(
            f"{dropped} {'row' if dropped == 1 else 'rows'} of {even.t.size} missing by the stamps, at most "
            f"{longest_hold(gaps)} in a row, at samples {name_places(stretches(gaps))}"
        )
    values = {}
    for name, x in signals.values.items():
        values[name] = np.full(even.t.size, np.nan)
        values[name][even.places] = x
    return replace(signals, t=even.t, values=values, jitter=jitter).said(*notes)


def _resample(signals: Signals, Ts: float) -> Signals:
    assert signals.t is not None
    steps = np.diff(signals.t)
    if np.any(steps <= 0.0) or np.abs(steps - Ts).max() <= 1e-9 * Ts:
        return signals  # even at Ts already, or a fault that `find_faults` describes
    known = [signals.t[np.isfinite(x)] for x in signals.values.values()]
    if any(t.size < 4 for t in known):
        raise ValueError("resample needs at least 4 samples of each signal.")
    t = even_grid(max(x[0] for x in known), min(x[-1] for x in known), Ts)
    values, notes = resampled(t, {name: (signals.t, x) for name, x in signals.values.items()}, signals)
    return replace(signals, t=t, values=values).said(*notes)


def _inputs_held(signals: Signals) -> Signals:
    """Fill missing samples of an input that is held between its changes."""
    for key in filter(is_input, tuple(signals.values)):
        x, name = signals.values[key], signals.called(key)
        if not np.isnan(x).any() or not is_held(x):
            continue
        missing = np.isnan(x)
        filled = hold(x)
        after = np.append(x[1:], np.nan)
        changed = int(np.sum(missing & np.isfinite(after) & (after != filled)))
        note = f"{name} held at its last value in {int(missing.sum())} samples without one"
        if changed:
            note += f"; after {changed} of these gaps it differs, so that the change may have been earlier"
        signals = replace(signals, values={**signals.values, key: filled}).said(note)
    return signals


def _decimated(signals: Signals, every: int) -> Signals:
    if min(x.size for x in signals.values.values()) < 4 * every:
        raise ValueError(f"decimate {every} leaves under 4 samples of {min(x.size for x in signals.values.values())}.")
    values = {name: decimate(x, every) for name, x in signals.values.items()}
    t = None if signals.t is None else signals.t[::every]
    note = f"every {every}th sample kept after the same low-pass filter on all signals"
    return replace(signals, t=t, values=values).said(note)
