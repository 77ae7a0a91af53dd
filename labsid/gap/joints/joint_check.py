"""Whether a record and a model of several joints speak of the same thing."""

from dataclasses import replace

import numpy as np

from labsid.gap.joints.joint_numbers import numbers_by_joint, sentences_by_joint
from labsid.gap.joints.views import arm_record, initial_states, matching
from labsid.gap.signals.preparation import prepare
from labsid.gap.signals.roles import Signals
from labsid.gap.simulations.model_check import check_output, contact_findings, limit_findings
from labsid.lab.findings import Finding
from labsid.records.record import Record
from labsid.simulators.mjcf.one_joint import substeps
from labsid.simulators.mjcf.several_joints import SeveralJoints
from labsid.simulators.mjcf.simulation import CONTACTS
from labsid.simulators.simulator import Simulator


def check_joints(signals: Signals, simulate: Simulator) -> list[Finding]:
    """What of a record and a model does not fit together, by output, each with the option that mends it.

    Parameters
    ----------
    signals : Signals
    simulate : Simulator
        Of a model of several joints, with its signals in the order of the record.

    Raises
    ------
    ValueError
        If the timestep of the model does not divide the sampling time, or the model is in contact for most of it.
    """
    joints = simulate.joint
    assert isinstance(joints, SeveralJoints)
    substeps(signals.Ts, joints.timestep)
    t = np.asarray(signals.Ts * np.arange(len(signals)), np.float64)
    start = initial_states(joints, signals)
    found: list[Finding] = []
    for i, place in enumerate(joints.inputs):
        found += limit_findings(Record(signals.t, signals.u[:, i], signals.y[:, 0], signals.Ts), joints.joints[place])
    pairs = np.asarray(simulate.run(t, signals.u, simulate.nominal | start | {CONTACTS: 1.0}))[:, 0]
    found += contact_findings(pairs, joints.joints[0])
    y = joints.run(t, signals.u, start)
    for j, (place, what) in enumerate(joints.outputs):
        if what == "force" or not np.isfinite(y[:, j]).all() or not np.ptp(y[:, j]):
            continue
        main = joints.inputs.index(place) if place in joints.inputs else 0
        record = Record(signals.t, signals.u[:, main], signals.y[:, j], signals.Ts)
        one = replace(joints.joints[place], output=what)
        found += [
            replace(finding, text=f"{signals.outputs[j]}: {finding.text}")
            for finding in check_output(record, y[:, j], one, driven=place in joints.inputs)
        ]
    return found


def check_record_of_joints(record: Record, simulate: Simulator) -> list[Finding]:
    """The same of a record, whose signals are those of the model by name, or in their order."""
    signals = prepare(record).signals
    return check_joints(signals, matching(simulate, record, signals.outputs))


def determined_of_joints(record: Record, simulate: Simulator) -> list[str]:
    """Which numbers of each joint a record determines, in sentences."""
    signals = prepare(record).signals
    arm = arm_record(signals, matching(simulate, record, signals.outputs))
    return sentences_by_joint(numbers_by_joint(arm))
