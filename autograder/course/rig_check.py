"""Whether a record of another rig carries the lab: each requirement, and what to record instead."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

from autograder.course.own_rig import read_rig_log
from autograder.course.rig_findings import SHORTEST_REST, about_rig
from labsid.checks.other_records.rig_model import identify_rig
from labsid.lab.findings import Finding
from labsid.lab.record_check import check_record
from labsid.records.formats import read_raw
from labsid.records.reading import Reading
from labsid.records.record import Record, read_record
from labsid.records.signal_quality import runs
from labsid.rig.lab.log import log_to_record

_JUDGED_HERE = "sampling", "rest", "excitation"
_AT_REST = "rest", "offsets", "first step"
_FROM_SAMPLES = 12
"""Largest number of later beginnings of a log that are tried."""


@dataclass(frozen=True, slots=True)
class RigCheck:
    """What is found of a record.

    Attributes
    ----------
    name : str
        Name of the log.
    findings : tuple of Finding
        One or more for each requirement; "refused" where the lab cannot be carried out.
    advice : tuple of str
        What to do or to record instead; empty if nothing is refused.
    """

    name: str
    findings: tuple[Finding, ...]
    advice: tuple[str, ...] = ()

    @property
    def carries(self) -> bool:
        """Whether the lab can be carried out on the record."""
        return not any(finding.level == "refused" for finding in self.findings)

    @property
    def verdict(self) -> str:
        """One line: yes or no, and why."""
        refused = [finding.topic for finding in self.findings if finding.level == "refused"]
        if refused:
            return f"carries the lab: no, because of {', '.join(dict.fromkeys(refused))}"
        warned = [finding.topic for finding in self.findings if finding.level == "warning"]
        return f"carries the lab: yes{', with a warning: ' + ', '.join(dict.fromkeys(warned)) if warned else ''}"


def check_rig(path: Path, reading: Reading, simulated: bool = False) -> RigCheck:
    """Check whether a log carries the lab.

    Parameters
    ----------
    path : Path
    reading : Reading
        How the log is read.
    simulated : bool
        Whether students get a record that is made with a model that is identified from the log.

    Raises
    ------
    ValueError
        If the log cannot be read as one input and one output, or, with `simulated`, has no model.
    OSError
        If there is no such file.
    """
    record = log_to_record(read_rig_log(path, reading, simulated=simulated))
    of_log = () if simulated else check_record(read_raw(path, reading)).findings
    faults = (one for one in of_log if one.level in ("warning", "refused") and one.topic not in _JUDGED_HERE)
    found = about_rig(record)
    said = {one.topic for one in found if one.level == "refused"}
    checked = RigCheck(path.name, (*(one for one in faults if one.topic not in said), *found))
    if checked.carries:
        return checked
    return replace(checked, advice=(*_ways_out(path, reading, simulated), *_to_record(record)))


def _ways_out(path: Path, reading: Reading, simulated: bool) -> Iterator[str]:
    """How the same log carries the lab after all: from a later time on, or by a model."""
    if simulated:
        return
    found = _later_start(path, reading)
    if found is not None:
        yield f"This log carries the lab from {found:.9g} s on: --from {found:.9g}."
    try:
        made = about_rig(log_to_record(read_rig_log(path, reading, simulated=True)))
    except ValueError:
        return
    if not any(finding.level == "refused" for finding in made):
        yield (
            "A model can be identified from this log, and a record made with it carries the lab: --simulated, and "
            "simulated = true in [rig]."
        )


def _later_start(path: Path, reading: Reading) -> float | None:
    """A time from which on the rig is at rest before a later change, and the rest of the log carries the lab."""
    record = read_record(path, reading)
    starts, lengths = runs(record.u)
    for start, length in list(zip(starts, lengths, strict=True))[1:_FROM_SAMPLES]:
        for share in (0.5, 0.7):
            since = round(float(record.t[start + int(share * length)]), 6)
            try:
                cut = log_to_record(read_rig_log(path, replace(reading, since=since)))
            except ValueError:
                return None
            if (1 - share) * length >= SHORTEST_REST and not _is_worse(about_rig(cut)):
                return since
    return None


def _is_worse(findings: list[Finding]) -> bool:
    """Whether something is refused, or the record does not begin at rest at a working point."""
    return any(one.level == "refused" or (one.level == "warning" and one.topic in _AT_REST) for one in findings)


def _to_record(record: Record) -> Iterator[str]:
    try:
        tau = identify_rig(record).time_constant
    except ValueError:
        tau = None
    low, high = float(record.u.min()), float(record.u.max())
    if low == high:
        yield (
            "To record instead: hold the input at a working point until the output has settled, and log at least "
            f"{max(SHORTEST_REST, 50)} samples of this rest; then change it five times, down and up, by steps to which "
            "the output responds clearly, and hold each level until the output has settled. Log the input, too."
        )
        return
    rest = low + 0.6 * (high - low)
    hold = "until the output has settled" if tau is None else f"for {5 * tau:.3g} s, until the output has settled"
    often = "20 to 60 times in a time constant" if tau is None else f"every {tau / 35:.2g} s"
    yield (
        f"To record instead: sample {often}; hold the input at a working point, such as {rest:.3g}, {hold}, and log at "
        f"least {max(SHORTEST_REST, 50)} samples of this rest; then change it five times, down to about "
        f"{low + 0.2 * (high - low):.3g} and up to about {high:.3g}, and hold each level {hold}. Neither the input nor "
        "the output may reach a limit."
    )
