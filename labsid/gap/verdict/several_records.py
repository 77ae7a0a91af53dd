"""Several records of one rig: join them end to end for one search, and report on each of them."""

from collections import Counter, defaultdict
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from labsid._arrays import FloatArray
from labsid.gap.dynamics.record_start import RecordStart
from labsid.gap.dynamics.responses import real_rates
from labsid.gap.model_file import LEAST
from labsid.gap.record.clock import at_sampling_time
from labsid.gap.record.data import Data, Scale, scaled
from labsid.gap.record.readings import readings_alone
from labsid.gap.record.record_findings import PlateauGap, filtered_input, findings_from_record, plateau_gap
from labsid.gap.verdict.baseline_choice import fit_first_order
from labsid.gap.verdict.scores import NO_GAP_MEAN_SQUARE, GapScore, closed_share
from labsid.lab.findings import Finding
from labsid.records.record import Record

BRIDGE_TIME_CONSTANTS = 5.0  # time constants after which the state has settled to 1 %; set by hand
MIN_BRIDGE = 20  # samples: more than the noise model looks back; set by hand
MAX_BRIDGE = 1 / 3  # of the shortest record; set by hand


@dataclass(frozen=True, slots=True, eq=False)
class JoinedRecords:
    """Records joined end to end.

    Between two records the input holds the first value of the next one, for the dynamics to settle. These bridges are
    neither fitted nor scored.

    Attributes
    ----------
    record : Record
        All records, with times that run on.
    u : ndarray, shape (N,)
        The input, filtered like the output of each record.
    pieces : tuple of (int, int)
        First sample of each record and the one after its last.
    names : tuple of str
        Distinct names of the records.
    records : tuple of Record
        The records.
    measured : ndarray of bool, shape (N,)
        Samples with an output; those between two records count as such.
    """

    record: Record
    u: FloatArray
    pieces: tuple[tuple[int, int], ...]
    names: tuple[str, ...]
    records: tuple[Record, ...]
    measured: np.ndarray

    @property
    def inside(self) -> np.ndarray:
        """Mask of the samples that belong to a record, shape (N,)."""
        found = np.zeros(len(self.record), bool)
        for start, stop in self.pieces:
            found[start:stop] = True
        return found

    def data(self, scales: tuple[Scale, Scale] | None = None) -> Data:
        """The scaled signals, in the scales of a simulation if it has some."""
        data = scaled(self.u, self.record.y, self.inside & self.measured, self.record.Ts, 0.0, scales)
        return replace(data, pieces=self.pieces)


def at_one_sampling_time(records: Sequence[Record], stated: object = None) -> list[Record]:
    """Bring records with clock jitter to the sampling time of the others.

    Parameters
    ----------
    records : sequence of Record
    stated : object, optional
        Sampling time of a simulation, not validated.

    Raises
    ------
    ValueError
        If two records have different sampling times.
    """
    Ts = stated if isinstance(stated, float | int) else next((r.Ts for r in records if not r.jitter), records[0].Ts)
    records = [at_sampling_time(record, Ts) for record in records]
    first = records[0]
    for number, record in enumerate(records[1:], 2):
        if abs(record.Ts - first.Ts) > 1e-6 * first.Ts:
            raise ValueError(
                f"{label(record, number)} runs at {record.Ts:g} s, {label(first, 1)} at {first.Ts:g} s. Several "
                "records must have one sampling time; resample one of them."
            )
    return records


def label(record: Record, number: int) -> str:
    """Name of a record in messages."""
    return record.name or f"record {number}"


def join_records(records: Sequence[Record], measured: Sequence[np.ndarray] | None = None) -> JoinedRecords:
    """Join records of one sampling time end to end.

    Parameters
    ----------
    records : sequence of Record
    measured : sequence of ndarray of bool, optional
        Of each record the samples with an output, by default all; in the place of others the record has any value.
    """
    if measured is None:
        measured = [np.ones(len(record), bool) for record in records]
    bridge = _bridge_length(records)
    u, filtered, y, pieces, rows = [], [], [], [], []
    samples = 0
    for number, record in enumerate(records):
        own = filtered_input(record)
        if number:
            u.append(np.full(bridge, record.u[0]))
            filtered.append(np.full(bridge, own[0]))
            y.append(record.y[bridge:0:-1])  # mirrored: neither held values nor another converter step
            rows.append(np.ones(bridge, bool))
            samples += bridge
        u.append(record.u)
        filtered.append(own)
        y.append(record.y)
        rows.append(measured[number])
        pieces.append((samples, samples + len(record)))
        samples += len(record)
    names = [label(record, number) for number, record in enumerate(records, 1)]
    count = Counter(names)
    names = [f"{name} ({number})" if count[name] > 1 else name for number, name in enumerate(names, 1)]
    Ts = records[0].Ts
    t = np.asarray(Ts * np.arange(samples), np.float64)
    joined = Record(t, np.concatenate(u), np.concatenate(y), Ts, name=", ".join(names))
    return JoinedRecords(
        joined, np.concatenate(filtered), tuple(pieces), tuple(names), tuple(records), np.concatenate(rows)
    )


def _bridge_length(records: Sequence[Record]) -> int:
    """Samples until the dynamics have settled, from a first-order fit of the first record."""
    first = records[0]
    every = np.ones(len(first), bool)
    slowest = real_rates(*fit_first_order(scaled(filtered_input(first), first.y, every, first.Ts)).rates)[0]
    longest = int(MAX_BRIDGE * min(map(len, records)))
    return int(np.clip(BRIDGE_TIME_CONSTANTS / slowest, MIN_BRIDGE, longest))


def score_by_record(
    joined: JoinedRecords, data: Data, score: GapScore, begun: RecordStart = LEAST
) -> list[dict[str, Any]]:
    """The gap on each record, simulated by fits to the others, as in the report.

    Parameters
    ----------
    joined : JoinedRecords
    data : Data
        With the rows that were fitted.
    score : GapScore
        On all records, each left out in turn.
    begun : RecordStart
        Which samples of each determine its initial state.
    """
    unit = data.y_scale.unit
    fitted = np.where(data.rows, data.y - score.after_fit.output, 0.0) ** 2
    correct = score.floor**2 * data.rows.sum() / max(float(fitted.sum()), 1e-300)
    found = []
    for name, (start, stop) in zip(joined.names, joined.pieces, strict=True):
        at = np.flatnonzero(score.scored[start:stop]) + start
        before, after = (float(np.mean((data.y - output)[at] ** 2)) for output in score.outputs)
        floor = correct * float(fitted[start:stop].sum()) / max(int(data.rows[start:stop].sum()), 1)
        gap = score.closed is not None and before > NO_GAP_MEAN_SQUARE * floor
        found.append(
            {
                "name": name,
                "before": float(np.sqrt(before)) * unit,
                "after": float(np.sqrt(after)) * unit,
                "noise_floor": float(np.sqrt(floor)) * unit,
                "closed": closed_share(before, after, floor) if gap else None,
                "start": float(start * data.Ts),
                "samples": stop - start,
                "unscored": begun.samples(stop - start),
            }
        )
    return found


def findings_by_record(
    joined: JoinedRecords, outputs: tuple[FloatArray, FloatArray], data: Data
) -> tuple[list[Finding], PlateauGap | None]:
    """Findings from each record, those that all have in common once, and the plateaus that matter most.

    Parameters
    ----------
    joined : JoinedRecords
    outputs : tuple of ndarray, shape (N,)
        Of the simulation and of the explanation on the joined records.
    data : Data
        With the samples to use.
    """
    named: defaultdict[Finding, list[str]] = defaultdict(list)
    plateaus: dict[str, PlateauGap] = {}
    for name, record, (start, stop) in zip(joined.names, joined.records, joined.pieces, strict=True):
        before, after = (output[start:stop] for output in outputs)
        plateau = plateau_gap(record.u, record.y, before, after, data.rows[start:stop])
        if plateau is not None and plateau.matters:
            plateaus[name] = plateau
        at = np.flatnonzero(joined.measured[start:stop])
        for finding in findings_from_record(record if data.at is None else readings_alone(record, at), plateau):
            named[finding].append(name)
    worst = max(plateaus, key=lambda name: plateaus[name].missed, default=None)
    found = []
    for finding, names in named.items():
        if finding.topic == "plateaus" and worst not in names:
            continue
        every = len(names) == len(joined.records)
        found.append(finding if every else replace(finding, text=f"{', '.join(names)}: {finding.text}"))
    return found, None if worst is None else plateaus[worst]
