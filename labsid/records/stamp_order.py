"""Rows of a log by their stamps: several runs in one file, repeated stamps, rows out of order."""

import numpy as np

from labsid.records.even_times import MAX_JITTER, fit_even_times
from labsid.records.signals import Signals

_MOVED = 0.1  # share of the rows that may be out of order
_NEAR = 10  # samples, by which a row that is out of order may be displaced


def select_run(signals: Signals, number: int | None) -> Signals:
    """Only the samples of one run, counted from 1; a run ends where time goes back.

    Raises
    ------
    ValueError
        If there is no such run.
    """
    if number is None:
        return signals
    assert signals.t is not None
    starts = [0, *(np.flatnonzero(np.diff(signals.t) < 0.0) + 1), signals.t.size]
    count = len(starts) - 1
    if number > count:
        raise ValueError(f"there {'is 1 run' if count == 1 else f'are {count} runs'} in it; got select {number}.")
    rows = np.arange(starts[number - 1], starts[number])
    return signals.rows(rows).said(f"run {number} of {count} ({rows.size} samples)")


def without_repeats(signals: Signals, keep: str | None) -> Signals:
    """One row for each stamp: equal rows are one; of different ones, the first or the last as the caller says."""
    assert signals.t is not None
    same = np.diff(signals.t) == 0.0
    if not same.any():
        return signals
    equal = same.copy()
    for x in signals.values.values():
        equal &= (x[1:] == x[:-1]) | (np.isnan(x[1:]) & np.isnan(x[:-1]))
    drop = np.zeros(signals.t.size, bool)
    drop[1:] |= equal
    notes = [f"{equal.sum()} repeated {'row' if equal.sum() == 1 else 'rows'} left out"] if equal.any() else []
    differ = same & ~equal
    if differ.any() and keep is not None:
        drop[1:] |= differ if keep == "first" else False
        drop[:-1] |= differ if keep == "last" else False
        notes.append(f"of rows with the same time the {keep} is kept ({differ.sum()} left out)")
    return signals.rows(~drop).said(*notes)


def sorted_rows(signals: Signals) -> Signals:
    """Rows in the order of their stamps, where a few are displaced and the sorted ones are evenly spaced."""
    assert signals.t is not None
    steps = np.diff(signals.t)
    if signals.t.size < 3 or not np.any(steps < 0.0):
        return signals
    order = np.argsort(signals.t, kind="stable")
    if np.abs(order - np.arange(order.size)).max() > _NEAR:
        return signals
    even = fit_even_times(signals.t[order])
    moved = int(np.sum(order != np.arange(order.size)))
    if even is None or even.largest > MAX_JITTER or moved > _MOVED * order.size:
        return signals
    return signals.rows(order).said(f"{moved} rows out of order, sorted by time")
