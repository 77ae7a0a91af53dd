"""Diagnose a record with a model of several joints."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from labsid._arrays import FloatArray
from labsid.gap.dynamics.record_start import RecordStart
from labsid.gap.fits.fitting import Fit
from labsid.gap.joints.joint_check import check_joints
from labsid.gap.joints.joint_report import JointPart, combine_joints
from labsid.gap.joints.joint_search import AtJoint, find_at_joints, numbers_of
from labsid.gap.joints.joint_view import arm_record, joint_view
from labsid.gap.joints.mended_arm import MendedArm, mended_arm
from labsid.gap.record.clock import clock_findings
from labsid.gap.reports.report import build_report
from labsid.gap.search.beam_search import Progress
from labsid.gap.signals.preparation import Prepared, prepare, prepare_holdout
from labsid.gap.signals.result import SignalsDiagnosis
from labsid.gap.system_pairs import in_order
from labsid.gap.verdict.answer import answer_from
from labsid.records.record import Record
from labsid.simulators.meter import SEARCH_SHARE
from labsid.simulators.mjcf.several_joints import SeveralJoints
from labsid.simulators.simulator import Simulator


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class JointsDiagnosis(SignalsDiagnosis):
    """Result of `diagnose` with a model of several joints.

    Attributes
    ----------
    arm : MendedArm or None
        The model with the effects found.
    """

    arm: MendedArm | None = None


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
        found = find_at_joints(arm, progress=progress)
    parts = [_part(one, seed, progress) for one in found.at]
    start = RecordStart(found.at[-1].explanation.path[0].slowest_rates)
    named = [one for one, part in zip(found.at, parts, strict=True) if part.report["effects"]]
    mended = mended_arm(found.at, numbers_of(named), start)
    if other is not None:
        parts = _on_holdout(parts, found.at, mended, other, start)
    report = combine_joints(prepared, arm, found, parts, simulate.meter.counts())
    return JointsDiagnosis(report, {}, None, mended)


def matching(simulate: Simulator, record: Record, kept: Sequence[str]) -> Simulator:
    """The simulator with its signals in the order of those of a record."""
    ordered = in_order(simulate, record.inputs, record.outputs, kept)
    joints = simulate.joint
    assert isinstance(joints, SeveralJoints)
    inputs = [simulate.inputs.index(name) for name in record.inputs] if set(simulate.inputs) == set(record.inputs) else None
    of = dict(zip(record.outputs, _places(simulate.outputs, record.outputs), strict=True))
    changed = replace(
        joints,
        inputs=joints.inputs if inputs is None else tuple(joints.inputs[i] for i in inputs),
        outputs=tuple(joints.outputs[of[name]] for name in kept),
        names=tuple(kept),
    )
    return replace(ordered, joint=changed)


def _places(names: Sequence[str], wanted: Sequence[str]) -> list[int]:
    return [names.index(name) for name in wanted] if set(names) == set(wanted) else list(range(len(wanted)))


def _part(one: AtJoint, seed: int, progress: Progress | None) -> JointPart:
    """The report of the joined outputs, as seen at a joint."""
    rng = np.random.default_rng(seed)
    record, base = one.view.record, one.view.base
    answer = answer_from(record, one.explanation, base, None, rng, progress)
    report = build_report(record, answer, base, rng)
    return JointPart(one, answer, report)


def _on_holdout(
    parts: Sequence[JointPart], found: Sequence[AtJoint], mended: MendedArm, other: Prepared, start: RecordStart
) -> list[JointPart]:
    """The parts with outputs on another record, by the model as it is and by the mended one."""
    plain = replace(mended, numbers={}, commands=(), zeros=_zeros(found[-1]))
    outputs = [one.simulate(other.signals) for one in (plain, mended)]
    scored = np.arange(len(other.signals)) >= start.samples(len(other.signals))
    return [replace(part, holdout=(other.signals, outputs[0], outputs[1], scored)) for part in parts]


def _zeros(one: AtJoint) -> FloatArray:
    """Zeros of the sensors for the model as it is."""
    base: Fit = one.view.base.before(one.view.data)  # type: ignore[misc]
    alone = replace(one, explanation=replace(one.explanation, path=(base,)))
    return mended_arm([alone], {}, RecordStart(base.slowest_rates)).zeros


def play_joints(simulate: Simulator, record: Record) -> tuple[FloatArray, RecordStart]:
    """Outputs of a model of several joints on a record, and which samples its start is estimated from."""
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
    return mended.simulate(signals), start
