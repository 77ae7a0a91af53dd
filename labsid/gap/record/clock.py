"""Records with clock jitter: findings, and agreement on one sampling time."""

from dataclasses import replace

import numpy as np

from labsid.lab.findings import Finding
from labsid.records.record import REGULAR_WITHIN, Record, missing_notes

MAX_CLOCK_ERROR = 1.0  # samples over the record, by which two sampling times of one rig may differ; set by hand


def clock_findings(record: Record, holdout: Record | None = None) -> list[Finding]:
    """Report what was done in reading the records, and clock jitter.

    Parameters
    ----------
    record : Record
    holdout : Record, optional

    Returns
    -------
    list of Finding
        Of jitter only if the time stamps deviate from even times by more than 1 % of the sampling time.
    """
    findings = [Finding("note", "file", f"{note}.") for note in (*record.notes, *missing_notes(record))]
    if holdout is not None:
        findings += [Finding("note", "file", f"holdout: {note}.") for note in (*holdout.notes, *missing_notes(holdout))]
    for whose, what, stamped in (("", "record", record), (" of the holdout", "holdout", holdout)):
        if stamped is not None and stamped.jitter > REGULAR_WITHIN:
            text = (
                f"the clock{whose} jitters by {100.0 * stamped.jitter:.2g}% of the sampling time (root mean square); "
                f"the {what} is read as if it were sampled every {stamped.Ts:.4g} s."
            )
            findings.append(Finding("note", "sampling", text))
    return findings


def stated_sampling_time(simulation: object) -> object:
    """The sampling time of a simulation or in the content of a model file, not validated; None without one."""
    if isinstance(simulation, dict):
        return simulation.get("dt", simulation.get("Ts"))
    return getattr(simulation, "Ts", None)


def at_sampling_time(record: Record, Ts: object) -> Record:
    """Replace the sampling time of a record with clock jitter by that of another record or simulation.

    Parameters
    ----------
    record : Record
    Ts : object
        Sampling time in seconds as read from a file, not validated.

    Returns
    -------
    Record
        Unchanged if its clock does not jitter, or if its own sampling time differs from `Ts`.
    """
    if not record.jitter or not isinstance(Ts, float | int) or Ts == record.Ts:
        return record
    if not abs(Ts - record.Ts) * (len(record) - 1) <= MAX_CLOCK_ERROR * record.Ts:
        return record
    return replace(record, t=record.t[0] + Ts * np.arange(len(record)), Ts=float(Ts))
