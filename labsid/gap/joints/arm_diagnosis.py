"""Diagnose a record with a model of several joints."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from labsid.gap.dynamics.record_start import RecordStart
from labsid.gap.joints.arm_simulation import MendedArm, mended_arm
from labsid.gap.joints.joint_check import check_joints
from labsid.gap.joints.joint_numbers import numbers_by_joint
from labsid.gap.joints.joint_report import JointPart, combine_joints
from labsid.gap.joints.joint_search import AtJoint, find_at_joints
from labsid.gap.joints.views import arm_record, joint_view, matching
from labsid.gap.record.clock import clock_findings
from labsid.gap.reports.report import build_report
from labsid.gap.search.beam_search import Progress
from labsid.gap.signals.preparation import Prepared, prepare, prepare_holdout
from labsid.gap.signals.result import SignalsDiagnosis
from labsid.gap.signals.signals_replay import SignalsReplay, scored_replay
from labsid.gap.verdict.answer import answer_from
from labsid.records.record import Record
from labsid.simulators.meter import SEARCH_SHARE
from labsid.simulators.simulator import Simulator


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class JointsDiagnosis(SignalsDiagnosis):
    """Result of `diagnose` with a model of several joints.

    Attributes
    ----------
    mended : MendedArm
        The model with the effects found.
    """

    mended: MendedArm = field(kw_only=True)


def diagnose_joints(
    record: Record,
    simulate: Simulator,
    *,
    free: Sequence[str] = (),
    holdout: Record | None = None,
    exclude: Sequence[tuple[float, float]] = (),
    seed: int = 0,
    evaluations: int | None = None,
    progress: Progress | None = None,
) -> JointsDiagnosis:
    """Find the effects at each joint of a model and its actuator.

    Parameters
    ----------
    record : Record
        With the commands of the actuators as inputs, and joints or sensors as outputs.
    simulate : Simulator
        Of a model of several joints.
    free, holdout, exclude, seed, evaluations, progress
        As for `labsid.gap.diagnosis.diagnose`.

    Raises
    ------
    ValueError
        If the record and the model do not match.
    """
    prepared = prepare(record, exclude)
    other = None if holdout is None else prepare_holdout(holdout, prepared)
    simulate = matching(simulate.with_free(free) if free else simulate, record, prepared.signals.outputs)
    findings = (*clock_findings(record, holdout), *check_joints(prepared.signals, simulate), *prepared.findings)
    prepared = replace(prepared, findings=findings)
    simulate.meter.begin(evaluations)
    with simulate.meter.searching(SEARCH_SHARE):
        arm = arm_record(prepared.signals, simulate)
        numbers = numbers_by_joint(arm)
        found = find_at_joints(arm, progress=progress)
    parts = [_part(one, seed, progress) for one in found.at]
    start = RecordStart(found.at[-1].explanation.path[0].slowest_rates)
    named = [part.at for part in parts if part.report["effects"]]
    mended = mended_arm(named, parts[-1].at, start)
    if other is not None:
        parts = _on_holdout(parts, mended, other, start)
    report = combine_joints(prepared, arm, found, parts, simulate.meter.counts())
    return JointsDiagnosis(report | {"identifiability": numbers}, {}, None, mended=mended)


def _part(one: AtJoint, seed: int, progress: Progress | None) -> JointPart:
    """The report of the joined outputs, as seen at a joint."""
    rng = np.random.default_rng(seed)
    record, base = one.view.record, one.view.base
    answer = answer_from(record, one.explanation, base, None, rng, progress)
    report = build_report(record, answer, base, rng)
    return JointPart(replace(one, explanation=answer.explanation), answer, report)


def _on_holdout(parts: Sequence[JointPart], mended: MendedArm, other: Prepared, start: RecordStart) -> list[JointPart]:
    """The parts with outputs on another record, by the model as it is and by the mended one."""
    last = parts[-1]
    as_it_is = replace(last.at, explanation=replace(last.at.explanation, path=(last.answer.before,)))
    outputs = [one.simulate(other.signals) for one in (mended_arm([], as_it_is, start), mended)]
    scored = np.arange(len(other.signals)) >= start.samples(len(other.signals))
    return [replace(part, holdout=(other.signals, outputs[0], outputs[1], scored)) for part in parts]


def replay_joints(simulate: Simulator, record: Record) -> SignalsReplay:
    """Run a model of several joints with the commands of a record; first samples determine its initial state.

    Parameters
    ----------
    simulate : Simulator
    record : Record

    Raises
    ------
    ValueError
        If it has other signals or diverges.
    """
    prepared = prepare(record)
    signals = prepared.signals
    ordered = matching(simulate, record, signals.outputs)
    arm = arm_record(signals, ordered)
    view = joint_view(arm, 0, {}, {})
    assert view.base.before is not None
    fit = view.base.before(view.data)
    start = RecordStart(fit.slowest_rates)
    noise = np.array([scale.unit for scale in arm.scales])
    mended = MendedArm(arm.simulator, {}, (), noise, np.zeros(noise.size), start)
    return scored_replay(record, mended.simulate(signals), start)
