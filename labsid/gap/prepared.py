"""Make a record and a simulation ready for the search: one sampling time, readings, gaps, a baseline."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import chain

import numpy as np

from labsid._arrays import stretches_of
from labsid.gap.dynamics.record_start import LEAST_START, MOST_SHARE
from labsid.gap.fits.noisy_command import with_levels
from labsid.gap.fits.unknown_input import about_unknown_input, after_unknown_input
from labsid.gap.model_file import ExportedModel
from labsid.gap.record.clock import at_sampling_time, clock_findings, stated_sampling_time
from labsid.gap.record.data import Data, scaled
from labsid.gap.record.exclusion import MIN_SAMPLES, included_samples
from labsid.gap.record.readings import at_readings, brought_to_samples
from labsid.gap.record.record_findings import filtered_input
from labsid.gap.simulations.baseline import (
    Baseline,
    Simulation,
    make_baseline,
    read_exported,
)
from labsid.gap.simulations.long_record import (
    MAX_OF_SEVERAL,
    MAX_SAMPLES,
    cut_alike,
    shorten_holdout,
    shorten_record,
    shorten_records,
)
from labsid.gap.simulations.model_check import TOPIC, check_model
from labsid.gap.simulations.simulated_output import SimulatedOutput
from labsid.gap.simulations.stepper_port import untried_inside
from labsid.gap.verdict.several_records import (
    JoinedRecords,
    at_one_sampling_time,
    join_records,
    label,
)
from labsid.lab.findings import Finding
from labsid.records.record import Record, between_outputs, bridge_gaps
from labsid.simulators.simulator import Simulator
from labsid.simulators.stepper import Stepper

_Times = Sequence[tuple[float, float]]
MIN_SCORED = 10  # samples
MIN_HOLDOUT = LEAST_START + MIN_SCORED  # samples, of which the first determine the initial state
SIZES = 1e-50, 1e50  # of the range of a signal and of the sampling time: powers of their ratios stay finite


@dataclass(frozen=True, slots=True, eq=False)
class Prepared:
    """A record ready for the search.

    Attributes
    ----------
    whole, record : Record
        As given, and as diagnosed: at one sampling time and shortened.
    measured : ndarray of bool
        Mask of the samples of `record` that have an output.
    holdout : Record or None
        With the input filtered like that of `data`.
    holdout_measured : ndarray of bool or None
        As `measured`, of the holdout.
    data : Data
    base : Baseline
    findings : list of Finding
    notes : tuple of str
        Sentences on what was left out.
    joined : JoinedRecords or None
        With several records, how `record` was made of them.
    """

    whole: Record
    record: Record
    measured: np.ndarray
    holdout: Record | None
    holdout_measured: np.ndarray | None
    data: Data
    base: Baseline
    findings: list[Finding]
    notes: tuple[str, ...]
    joined: JoinedRecords | None = None


def prepare(
    record: Record,
    simulation: Simulation | None,
    holdout: Record | None,
    order: int,
    exclude: Sequence[tuple[float, float]],
) -> Prepared:
    """Make one record ready for the search.

    Parameters
    ----------
    record : Record
    simulation : dict, ExportedModel, SimulatedOutput, Simulator or None
    holdout : Record or None
        Another record of the same rig.
    order : int
        Order of the linear model, if there is no simulation.
    exclude : sequence of (float, float)
        Time ranges, in seconds, that are neither fitted nor scored.

    Raises
    ------
    ValueError
        If a record is too short, has a constant signal, or does not match the simulation.
    """
    as_given = record
    record, holdout = between_outputs(record), None if holdout is None else between_outputs(holdout)
    simulation = cut_alike(simulation, as_given, record)
    record, holdout = _common_sampling_time(record, holdout, simulation)
    findings = clock_findings(record, holdout)
    both = [record] if holdout is None else [record, holdout]
    compared = at_readings(both, simulation is not None, MAX_SAMPLES, ~included_samples(record.t, exclude))
    simulation = cut_alike(simulation, record, compared.records[0])
    (record, *rest), is_slow = compared.records, compared.is_slow
    holdout = rest[0] if rest else None
    gaps, record = _without_gaps(record)
    holdout_gaps: _Times = ()
    if holdout is not None:
        holdout_gaps, holdout = _without_gaps(holdout)
    _check_records(record, holdout)
    if holdout is not None:
        findings += _repeated([("the record", record), ("the holdout", holdout)])
    findings += _compared(record, simulation)
    whole, shortened = record, shorten_record(record, simulation, is_slow=is_slow)
    record, simulation, notes = shortened.record, shortened.simulation, compared.notes + shortened.notes
    if holdout is not None:
        holdout, more = shorten_holdout(holdout, shortened.every)
        notes += more
    _check_records(record, holdout)
    if holdout is not None:
        holdout = Record(holdout.t, filtered_input(holdout), holdout.y, holdout.Ts, name=holdout.name)
    simulation = read_exported(simulation, record.Ts)
    scales = (simulation.u_scale, simulation.y_scale) if isinstance(simulation, ExportedModel) else None
    measured = _measured(record, gaps)
    rows = _included(record, exclude, measured)
    if not isinstance(simulation, SimulatedOutput):  # which was made from the input as it is logged
        record, more = with_levels(record, rows)
        notes += more
        holdout = None if holdout is None else with_levels(holdout)[0]
    data = scaled(filtered_input(record), record.y, rows, record.Ts, float(record.t[0]), scales)
    if isinstance(simulation, Simulator) and simulation.joint is not None:
        data = data.about_zero_command()
    if is_slow:
        data = replace(data, at=np.flatnonzero(measured), stride=compared.stride)
    else:
        unknown = after_unknown_input(data, record.u, measured)
        notes += about_unknown_input(unknown, record.Ts)
        data = replace(data, rows=data.rows & ~unknown) if unknown.any() else data
    base = make_baseline(data, record.t, simulation, order)
    if base.before is not None and compared.before is not None and len(record) == len(compared.records[0]):
        simulated = data.y_scale.back(base.before(data).output)
        record = brought_to_samples(record, np.flatnonzero(measured), compared.before, np.asarray(simulated))
        data = replace(data, y=data.y_scale.of(record.y))
        base = make_baseline(data, record.t, simulation, order)
    if base.output_only and holdout is not None:
        raise ValueError(
            "a simulated output is known on its own record only. Give a model or a function, or omit the holdout."
        )
    holdout_measured = None if holdout is None else _measured_holdout(holdout, holdout_gaps)
    return Prepared(whole, record, measured, holdout, holdout_measured, data, base, findings, notes)


def prepare_several(
    records: Sequence[Record],
    simulation: Simulation | None,
    holdout: Record | None,
    order: int,
    exclude: Sequence[tuple[float, float]],
) -> Prepared:
    """Make several runs of one rig ready for the search, as one record with a piece for each.

    Parameters
    ----------
    records : sequence of Record
    simulation : dict, ExportedModel, SimulatedOutput, Simulator or None
    holdout : Record or None
        Refused: each record in turn is held out.
    order : int
        Order of the linear model, if there is no simulation.
    exclude : sequence of (float, float)
        Refused: the times would be those of one record.

    Raises
    ------
    ValueError
        As `prepare`.
    """
    if not records:
        raise ValueError("there is no record. Give at least one.")
    if holdout is not None:
        raise ValueError("of several records each in turn is held out. Omit the holdout, or give it as one of them.")
    if len(exclude):
        raise ValueError("--exclude refers to the times of one record. Cut the records instead.")
    records = at_one_sampling_time(list(map(between_outputs, records)), stated_sampling_time(simulation))
    findings = [
        replace(finding, text=f"{label(record, number)}: {finding.text}")
        for number, record in enumerate(records, 1)
        for finding in clock_findings(record)
    ]
    compared = at_readings(records, simulation is not None, MAX_OF_SEVERAL)
    records = compared.records
    gaps, records = zip(*map(_without_gaps, records), strict=True)
    for number, record in enumerate(records, 1):
        _check_record(record, label(record, number))
    parts, notes = shorten_records(records)
    notes = compared.notes + notes
    for number, record in enumerate(parts, 1):
        _check_record(record, label(record, number))
    if not isinstance(simulation, SimulatedOutput):
        followed = list(map(with_levels, parts))
        parts = [part for part, _ in followed]
        notes += tuple(dict.fromkeys(chain.from_iterable(said for _, said in followed)))
    joined = join_records(parts, [_measured(part, times) for part, times in zip(parts, gaps, strict=True)])
    findings += _repeated([(f"the record {name}", part) for name, part in zip(joined.names, parts, strict=True)])
    simulation = read_exported(simulation, joined.record.Ts)
    scales = (simulation.u_scale, simulation.y_scale) if isinstance(simulation, ExportedModel) else None
    data = joined.data(scales)
    if isinstance(simulation, Simulator) and simulation.joint is not None:
        data = data.about_zero_command()
    if compared.is_slow:
        data = replace(data, at=np.flatnonzero(data.rows), stride=compared.stride)
    base = make_baseline(data, joined.record.t, simulation, order)
    return Prepared(joined.record, joined.record, joined.measured, None, None, data, base, findings, notes, joined)


def _compared(record: Record, simulation: Simulation | None) -> list[Finding]:
    """What of a record and a simulation that opens does not fit together."""
    if not isinstance(simulation, Simulator) or simulation.joint is None:
        return []
    findings = check_model(record, simulation)
    if isinstance(simulation.joint, Stepper):
        findings.append(Finding("note", TOPIC, untried_inside(simulation.joint, record.Ts)))
    return findings


def _without_gaps(record: Record) -> tuple[_Times, Record]:
    """Times without an output, and the record with straight lines there, which are neither fitted nor scored."""
    half = 0.5 * record.Ts
    times = [(record.t[k] - half, record.t[stop - 1] + half) for k, stop in stretches_of(record.missing)]
    return times, replace(record, y=bridge_gaps(record.y)) if times else record


def _measured(record: Record, gaps: _Times) -> np.ndarray:
    """Mask of the samples outside the gaps of the output."""
    rows = np.ones(len(record), bool)
    for start, stop in gaps:
        rows[np.searchsorted(record.t, start) : np.searchsorted(record.t, stop)] = False
    return rows


def _measured_holdout(holdout: Record, gaps: _Times) -> np.ndarray:
    """Mask of the samples of a holdout that have an output."""
    rows = _measured(holdout, gaps)
    scored = int(rows[max(LEAST_START, int(np.ceil(MOST_SHARE * rows.size))) :].sum())
    if scored < MIN_SCORED:
        raise ValueError(
            f"the holdout has an output at {scored} of its scored samples; at least {MIN_SCORED} are needed. Use "
            "another one."
        )
    return rows


def _included(record: Record, exclude: _Times, measured: np.ndarray) -> np.ndarray:
    """Mask of the samples with an output outside the excluded time ranges, which may be in no part that is used."""
    within = [(start, stop) for start, stop in exclude if np.any((record.t >= start) & (record.t < stop))]
    rows = measured & included_samples(record.t, within)
    if measured.sum() < MIN_SAMPLES:
        raise ValueError(
            f"the output of the record has {measured.sum()} readings; a diagnosis needs at least {MIN_SAMPLES}. Use a "
            "longer record."
        )
    if rows.sum() < MIN_SAMPLES:
        raise ValueError(f"--exclude leaves {rows.sum()} samples; at least {MIN_SAMPLES} are needed.")
    return rows


def _common_sampling_time(
    record: Record, holdout: Record | None, simulation: Simulation | None
) -> tuple[Record, Record | None]:
    """Bring records with clock jitter to one sampling time.

    It is that of the simulation if it has one, else that of a holdout without jitter, else that of the record.
    """
    record = at_sampling_time(record, stated_sampling_time(simulation))
    if holdout is None:
        return record, None
    if not holdout.jitter:
        record = at_sampling_time(record, holdout.Ts)
    return record, at_sampling_time(holdout, record.Ts)


def _check_records(record: Record, holdout: Record | None) -> None:
    """Reject a record that is too short or has a constant signal, and a holdout of another sampling time.

    A holdout is only scored, after the samples that determine its initial state: neither of its signals has to move.
    """
    _check_record(record, "the record")
    if holdout is not None and len(holdout) < MIN_HOLDOUT:
        raise ValueError(
            f"the holdout has {len(holdout)} samples; it needs at least {MIN_HOLDOUT}: its first {LEAST_START} "
            "determine the initial state and are not scored. Use a longer one."
        )
    if holdout is not None and abs(holdout.Ts - record.Ts) > 1e-6 * record.Ts:
        raise ValueError(f"the holdout runs at {holdout.Ts:g} s, the record at {record.Ts:g} s. Resample one of them.")


def _repeated(records: Sequence[tuple[str, Record]]) -> list[Finding]:
    """Which of the named records hold the samples of an earlier one."""
    findings = []
    first_with: dict[tuple[bytes, bytes], str] = {}  # by samples: the record that had them first
    for name, record in records:
        first = first_with.setdefault((record.u.tobytes(), record.y.tobytes()), name)
        if first != name:
            text = f"{name} holds the samples of {first}: the error on it is not that on another run."
            findings.append(Finding("warning", "samples", text))
    return findings


def _check_record(record: Record, name: str) -> None:
    """Reject a record that is too short or has a constant signal."""
    if len(record) < MIN_SAMPLES:
        raise ValueError(
            f"{name} has {len(record)} samples; a diagnosis needs at least {MIN_SAMPLES}. Use a longer record."
        )
    for signal, values in (("u", record.u), ("y", record.y)):
        if np.ptp(values) == 0.0:
            raise ValueError(f"{signal} of {name} is constant ({values[0]:g}); nothing can be identified from it.")
        _check_size(f"the range of {signal} of {name}", float(np.ptp(values)))
    _check_size(f"the sampling time of {name}", record.Ts)


def _check_size(what: str, value: float) -> None:
    """Reject a size whose powers could overflow or vanish."""
    low, high = SIZES
    if not low <= value <= high:
        raise ValueError(f"{what} must be between {low:g} and {high:g}; got {value:g}. Give it in another unit.")
