"""Play a model of MuJoCo with changes of its joints and actuators."""

from collections.abc import Iterator, Mapping
from copy import copy
from typing import Any

import numpy as np

from labsid._arrays import FloatArray
from labsid.simulators.mjcf.describing import describe_model, joint_of, joints_in, spread, tip_of
from labsid.simulators.mjcf.loop_constants import FREE
from labsid.simulators.mjcf.one_joint import (
    STANDING_SOLIMP,
    STANDING_SOLREF,
    OneJoint,
    changes_in,
    substeps,
)
from labsid.simulators.mjcf.opening import OpenedJoint, OpenedModel, import_mujoco
from labsid.simulators.simulator import SimulatorError

IN_ORDER = ("position", "speed", "force")


class Player:
    """A model that MuJoCo plays, with numbers and changes of its joints."""

    def __init__(self, opened: OpenedModel) -> None:
        self.mujoco, self.opened = import_mujoco(), opened
        self.one = describe_model(opened)
        self.joints = joints_in(self.one)

    def run(self, t: FloatArray, u: FloatArray, numbers: Mapping[str, float]) -> FloatArray:
        """Outputs for commands that are held between samples, shape (N,) for u of shape (N,), else (N, ny).

        Raises
        ------
        SimulatorError
            If the simulation diverges.
        """
        motion = self.play(t, u, numbers)[0]
        if not np.isfinite(motion).all():
            raise SimulatorError(f"{self.opened.source.path} is unstable with this input: its state diverges.")
        y = np.column_stack([motion[:, one.joint, IN_ORDER.index(one.what)] for one in self.opened.outputs])
        return np.ascontiguousarray(y[:, 0] if isinstance(self.one, OneJoint) else y)

    def play(self, t: FloatArray, u: FloatArray, numbers: Mapping[str, float]) -> tuple[FloatArray, np.ndarray]:
        """Position, speed and force at each sample, shape (N, n, 3); and the pair of geoms in contact there, or -1."""
        mujoco, joints = self.mujoco, self.joints
        u = u.reshape(len(u), -1)
        alone = len(joints) == 1
        changes = [changes_in(numbers, "" if alone else one.joint) for one in joints]
        c = np.array([one.constants(numbers, own) for one, own in zip(joints, changes, strict=True)])
        model = copy(self.opened.model)
        for place, opened in enumerate(self.opened.joints):
            _change(mujoco, model, joints[place], opened, c[place], changes[place])
            armature = numbers.get(f"{opened.joint_name}:armature", joints[place].armature)
            model.dof_armature[opened.joint] = armature + changes[place]["armature"]
            scale = numbers.get(f"{opened.link_name}:mass", joints[place].mass) / (joints[place].mass or 1.0)
            _change_link(mujoco, model, self.opened.model, opened.joint, scale, changes[place]["mass"])
        data = mujoco.MjData(model)
        mujoco.mj_setConst(model, data)
        mujoco.mj_resetData(model, data)
        driven = [(i, self.opened.joints[place].actuator, place) for i, place in enumerate(self.opened.inputs)]
        lags: dict[int, _Lag] = {}
        for place, (one, own) in enumerate(zip(joints, changes, strict=True)):
            data.qpos[place] = one.position + own["start"]
            data.qvel[place] = own["start_speed"]
        for i, at, place in driven:
            one, own = joints[place], changes[place]
            if one.delay:
                _fill_history(mujoco, model, data, at, float(u[0, i]))
            first = one.activation(float(u[0, i]), own)
            if one.dynamics != "none":
                data.act[model.actuator_actadr[at]] = first
            elif c[place, 32]:
                lags[i] = _Lag(one, c[place], first)
        timestep = joints[0].timestep
        steps = substeps(float(t[1] - t[0]) if t.size > 1 else timestep, timestep)
        applied = [
            place
            for place, own in enumerate(changes)
            if any(own[name] for name in ("gravity_sin", "gravity_cos")) or any(c[place, [42, 44, 45]])
        ]
        varied = [place for place, own in enumerate(changes) if own["transmitted"] or own["peak"]]
        motion, contacts = np.empty((len(u), len(joints), 3)), np.full(len(u), -1)
        for k in range(len(u)):
            for i, at, _ in driven:
                data.ctrl[at] = u[k, i]
            motion[k, :, 0], motion[k, :, 1], motion[k, :, 2] = data.qpos, data.qvel, 0.0
            for s in range(steps):
                for i, lag in lags.items():
                    place = driven[i][2]
                    data.ctrl[driven[i][1]] = lag.next(min(max(float(u[k, i]), c[place, 34]), c[place, 35]))
                for place in applied:
                    q, time = float(data.qpos[place]), (k * steps + s) * timestep
                    data.qfrc_applied[place] = _applied(q, time, timestep, c[place], changes[place])
                for place in varied:
                    model.dof_frictionloss[place] = _friction(data, c[place], place)
                mujoco.mj_step(model, data)
                if s == 0:
                    for _, at, place in driven:
                        motion[k, place, 2] = data.actuator_force[at]
                    if data.ncon:
                        contacts[k] = data.contact.geom1[0] * model.ngeom + data.contact.geom2[0]
            if not (np.abs(data.qpos) < 1e8).all() or data.warning[int(mujoco.mjtWarning.mjWARN_BADQACC)].number:
                motion[k + 1 :] = np.nan
                break
        return motion, contacts


def _fill_history(mujoco: Any, model: Any, data: Any, actuator: int, command: float) -> None:
    """A delayed actuator has had the first command for long."""
    samples = int(model.actuator_history[actuator, 0])
    times = (np.arange(samples) - samples) * float(model.opt.timestep)
    mujoco.mj_initCtrlHistory(model, data, actuator, times, np.full(samples, command))


class _Lag:
    """A lag ahead of an actuator without dynamics."""

    def __init__(self, one: OneJoint, c: FloatArray, first: float) -> None:
        self.state, self.share = first, 1.0 - float(np.exp(-one.timestep / c[33]))

    def next(self, command: float) -> float:
        """The state before this step."""
        before = self.state
        self.state += self.share * (command - before)
        return before


def _applied(q: float, time: float, timestep: float, c: FloatArray, changes: Mapping[str, float]) -> float:
    """Torque of loads, waves and changed weight on the joint."""
    torque = changes["gravity_sin"] * np.sin(q) + changes["gravity_cos"] * np.cos(q)
    if time > c[43] - timestep:
        torque += c[42] * min((time - c[43]) / timestep + 1.0, 1.0)
    return float(torque + c[44] * np.cos(c[46] * time) + c[45] * np.sin(c[46] * time))


def _friction(data: Any, c: FloatArray, place: int) -> float:
    """Largest friction of a joint that depends on the torque of its actuator in the last step, and on its speed."""
    held = c[9] + c[10] * abs(float(data.qfrc_actuator[place]))
    return float(held + c[11] * np.exp(-((float(data.qvel[place]) / c[12]) ** 2)))


def changed_bodies(
    mujoco: Any, nominal: Any, joint: int, scale: float, at_tip: float
) -> Iterator[tuple[int, float, FloatArray, FloatArray]]:
    """The bodies of a link with scaled masses and a mass at its end: index, mass, centre, inertia of shape (3, 3)."""
    tip, place = tip_of(mujoco, nominal, joint)
    for body in range(1, nominal.nbody):
        if joint_of(nominal, body) != joint:
            continue
        mass, centre = scale * float(nominal.body_mass[body]), np.array(nominal.body_ipos[body])
        turn = np.zeros(9)
        mujoco.mju_quat2Mat(turn, nominal.body_iquat[body])
        axes = turn.reshape(3, 3)
        inertia = axes @ np.diag(scale * nominal.body_inertia[body]) @ axes.T
        if body == tip and at_tip:
            whole = mass + at_tip
            middle = (mass * centre + at_tip * place) / whole
            inertia = inertia + mass * spread(centre - middle) + at_tip * spread(place - middle)
            mass, centre = whole, middle
        yield body, mass, centre, inertia


def _change_link(mujoco: Any, model: Any, nominal: Any, joint: int, scale: float, at_tip: float) -> None:
    """Scale the masses of a link, and add a mass to its end."""
    if scale == 1.0 and not at_tip:
        return
    for body, mass, centre, inertia in changed_bodies(mujoco, nominal, joint, scale, at_tip):
        moments, vectors, quat = np.zeros(3), np.zeros(9), np.zeros(4)
        mujoco.mju_eig3(moments, vectors, quat, inertia.ravel())
        model.body_mass[body], model.body_ipos[body], model.body_inertia[body] = mass, centre, moments
        model.body_iquat[body], model.body_sameframe[body] = quat, 0


def _change(
    mujoco: Any, model: Any, joint: OneJoint, opened: OpenedJoint, c: FloatArray, changes: Mapping[str, float]
) -> None:
    """Set the constants of a joint and its actuator."""
    dof, at = opened.joint, opened.actuator
    model.dof_damping[dof], model.jnt_stiffness[dof], model.qpos_spring[dof] = c[1], c[3], c[4]
    if hasattr(model, "dof_dampingpoly"):
        model.dof_dampingpoly[dof, 0], model.jnt_stiffnesspoly[dof, 1] = c[2], c[5]
    model.dof_frictionloss[dof] = c[9]
    if changes["friction"] or changes["transmitted"] or changes["peak"]:
        model.dof_solref[dof], model.dof_solimp[dof] = STANDING_SOLREF, STANDING_SOLIMP
    if c[15] > -FREE or c[16] < FREE:
        model.jnt_limited[dof] = 1
        model.jnt_range[dof] = max(c[15], -1e9), min(c[16], 1e9)
    if at < 0:
        return
    model.actuator_gainprm[at, :3], model.actuator_biasprm[at, :3] = c[26:29], c[29:32]
    if joint.gain != tuple(c[26:29]) or joint.bias != tuple(c[29:32]):
        if any(c[27:29]):
            model.actuator_gaintype[at] = int(mujoco.mjtGain.mjGAIN_AFFINE)
        if any(c[29:32]):
            model.actuator_biastype[at] = int(mujoco.mjtBias.mjBIAS_AFFINE)
    if c[36] > -FREE or c[37] < FREE:
        model.actuator_forcelimited[at] = 1
        model.actuator_forcerange[at] = max(c[36], -1e9), min(c[37], 1e9)
    if joint.dynamics != "none":
        model.actuator_dynprm[at, 0] = c[33]
