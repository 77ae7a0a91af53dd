"""Clocks that jitter: what is said of them, and when their sampling time is that of another record or a simulation."""

from dataclasses import replace
from typing import Any

import numpy as np

from labsid.lab.findings import Finding
from labsid.records.record import REGULAR_WITHIN, Record

MAX_CLOCK_ERROR = 1.0  # samples: two sampling times of one rig may differ by this over a record whose clock jitters


def clock_findings(record: Record, holdout: Record | None = None) -> list[Finding]:
    """Say that a clock jitters.

    Parameters
    ----------
    record : Record
    holdout : Record, optional

    Returns
    -------
    list of Finding
        Empty where the stamps are off the even times by no more than a hundredth of the sampling time.
    """
    found = []
    for whose, what, one in (("", "record", record), (" of the holdout", "holdout", holdout)):
        if one is not None and one.jitter > REGULAR_WITHIN:
            text = (
                f"the clock{whose} jitters by {100.0 * one.jitter:.2g}% of the sampling time (root mean square); "
                f"the {what} is read as if it were sampled every {one.Ts:.4g} s."
            )
            found.append(Finding("note", "sampling", text))
    return found


def stated_sampling_time(simulation: dict[str, Any]) -> object:
    """The sampling time that a MODEL.json or an exported simulation states; it may be anything."""
    return simulation.get("dt", simulation.get("Ts"))


def at_sampling_time(record: Record, Ts: object) -> Record:
    """The record at the sampling time of another one or of a simulation, where its own is not known better.

    Parameters
    ----------
    record : Record
    Ts : object
        Sampling time in seconds as a file states it: it may be anything.

    Returns
    -------
    Record
        The same where its clock does not jitter, or where that is not its sampling time.
    """
    if not record.jitter or not isinstance(Ts, float | int) or Ts == record.Ts:
        return record
    if not abs(Ts - record.Ts) * (len(record) - 1) <= MAX_CLOCK_ERROR * record.Ts:
        return record
    return replace(record, t=record.t[0] + Ts * np.arange(len(record)), Ts=float(Ts))
