"""Describe a model of one joint for the compiled loop, and play it with its changes in MuJoCo."""

from collections.abc import Mapping
from copy import copy
from typing import Any

import numpy as np

from labsid._arrays import FloatArray
from labsid.simulators.mjcf.one_joint import (
    FREE,
    OUTPUTS,
    STANDING_SOLIMP,
    STANDING_SOLREF,
    OneJoint,
    changes_in,
    substeps,
)
from labsid.simulators.mjcf.opening import OpenedModel, import_mujoco
from labsid.simulators.simulator import SimulatorError

UNIT_GRAVITY = 1e-9  # torque over that at rest: less is none
DEFAULT_GRAVITY = (0.0, 0.0, -9.81)


def describe_joint(opened: OpenedModel) -> OneJoint:
    """The model of one joint as numbers.

    Raises
    ------
    ValueError
        If it has more than one joint that moves, or elements that the loop has not.
    """
    mujoco, model = import_mujoco(), opened.model
    if model.nv != 1 or model.nu != 1:
        raise ValueError(
            f"{opened.source.path} has {model.nv} degrees of freedom and {model.nu} actuators; a model of one joint "
            "with one actuator can be diagnosed. Remove or fix the others, as they were in the record."
        )
    at, joint = opened.actuator, opened.joint
    moment = _gravity_torque(mujoco, model, joint)
    tip = _tip(mujoco, model, joint)
    link = int(model.jnt_bodyid[joint])
    integrators = mujoco.mjtIntegrator
    names = ("none", "integrator", "filter", "filterexact")
    dynamics = {int(getattr(mujoco.mjtDyn, f"mjDYN_{name.upper()}")): name for name in names}
    kind = int(model.actuator_dyntype[at])
    if kind not in dynamics:
        raise ValueError(
            f"the actuator {opened.actuator_name} has dynamics that cannot be opened. Give it as a function."
        )
    poly = getattr(model, "dof_dampingpoly", np.zeros((1, 2)))
    stiff = getattr(model, "jnt_stiffnesspoly", np.zeros((1, 2)))
    limited = bool(model.jnt_limited[joint])
    gain = np.array(model.actuator_gainprm[at, :3], float)
    if int(model.actuator_gaintype[at]) == int(mujoco.mjtGain.mjGAIN_FIXED):
        gain[1:] = 0.0
    bias = np.array(model.actuator_biasprm[at, :3], float)
    if int(model.actuator_biastype[at]) == int(mujoco.mjtBias.mjBIAS_NONE):
        bias[:] = 0.0
    armature = float(model.dof_armature[0])
    return OneJoint(
        joint=opened.joint_name,
        actuator=opened.actuator_name,
        link=opened.link_name,
        output=opened.output,
        timestep=float(model.opt.timestep),
        slides=int(model.jnt_type[joint]) == int(mujoco.mjtJoint.mjJNT_SLIDE),
        inertia=_inertia(mujoco, model),
        armature=armature,
        gravity=moment,
        mass=float(model.body_subtreemass[link]),
        tip=tip,
        position=float(model.qpos0[0]),
        passive={
            "damping": float(model.dof_damping[0]),
            "drag": float(poly[0, 0]),
            "stiffness": float(model.jnt_stiffness[joint]),
            "springref": float(model.qpos_spring[0]),
            "cubic": float(stiff[joint, 1]),
            "frictionloss": float(model.dof_frictionloss[0]),
        },
        solref_friction=tuple(map(float, model.dof_solref[0])),
        solimp_friction=tuple(map(float, model.dof_solimp[0])),
        solref_limit=tuple(map(float, model.jnt_solref[joint])),
        solimp_limit=tuple(map(float, model.jnt_solimp[joint])),
        range=(*(map(float, model.jnt_range[joint]) if limited else (-FREE, FREE)), float(model.jnt_margin[joint])),
        gear=float(model.actuator_gear[at, 0]),
        gain=tuple(gain),
        bias=tuple(bias),
        dynamics=dynamics[kind],
        time_constant=float(model.actuator_dynprm[at, 0]),
        ctrlrange=_bounds(model.actuator_ctrlrange[at], model.actuator_ctrllimited[at]),
        forcerange=_bounds(model.actuator_forcerange[at], model.actuator_forcelimited[at]),
        actrange=_bounds(model.actuator_actrange[at], model.actuator_actlimited[at]),
        jointrange=_bounds(model.jnt_actfrcrange[joint], model.jnt_actfrclimited[joint]),
        implicit=int(model.opt.integrator) != int(integrators.mjINT_EULER),
        delay=float(model.actuator_delay[at]) if hasattr(model, "actuator_delay") else 0.0,
        geoms=tuple(mujoco.mj_id2name(model, mujoco.mjtObj.mjOBJ_GEOM, i) or f"geom {i}" for i in range(model.ngeom)),
        euler_damping=not int(model.opt.disableflags) & int(mujoco.mjtDisableBit.mjDSBL_EULERDAMP),
    )


def _bounds(limits: FloatArray, limited: Any) -> tuple[float, float]:
    return (float(limits[0]), float(limits[1])) if limited else (-FREE, FREE)


def _inertia(mujoco: Any, model: Any) -> float:
    """Inertia of everything that moves, the armature included."""
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    full = np.zeros((1, 1))
    arguments = (full, data.qM) if _takes_array(mujoco) else (data, full)
    mujoco.mj_fullM(model, *arguments)
    return float(full[0, 0])


def _takes_array(mujoco: Any) -> bool:
    """Whether mj_fullM takes the sparse inertia, as in MuJoCo up to 3.8."""
    return "qM" in (mujoco.mj_fullM.__doc__ or "") or "M: " in (mujoco.mj_fullM.__doc__ or "")


def _gravity_torque(mujoco: Any, model: Any, joint: int) -> tuple[float, float, float]:
    """Torque of gravity over sin q, cos q, and constant, with the compensation of the model."""
    data = mujoco.MjData(model)

    def torque(q: float) -> float:
        data.qpos[0], data.qvel[0] = q, 0.0
        mujoco.mj_forward(model, data)
        held = float(data.qfrc_gravcomp[0]) if hasattr(data, "qfrc_gravcomp") else 0.0
        return held - float(data.qfrc_bias[0])

    if int(model.jnt_type[joint]) == int(mujoco.mjtJoint.mjJNT_SLIDE):
        return 0.0, 0.0, torque(float(model.qpos0[0]))
    return _sinusoid([torque(q) for q in (0.0, 0.5 * np.pi, np.pi)])


def _sinusoid(values: list[float]) -> tuple[float, float, float]:
    """Coefficients of sin q, cos q and 1 from values at 0, 90 and 180 degrees."""
    constant = 0.5 * (values[0] + values[2])
    return values[1] - constant, values[0] - constant, constant


def _tip(mujoco: Any, model: Any, joint: int) -> tuple[float, float, float, float]:
    """Inertia of a unit mass at the end of the link, and the torque of its weight over sin q, cos q, and constant."""
    data = mujoco.MjData(model)
    body, place = tip_of(mujoco, model, joint)

    def torque_and_inertia(q: float) -> tuple[float, float]:
        data.qpos[0] = q
        mujoco.mj_forward(model, data)
        jacobian = np.zeros((3, 1))
        at = data.xpos[body] + data.xmat[body].reshape(3, 3) @ place
        mujoco.mj_jac(model, data, jacobian, None, at, body)
        return float(jacobian[:, 0] @ model.opt.gravity), float(jacobian[:, 0] @ jacobian[:, 0])

    if int(model.jnt_type[joint]) == int(mujoco.mjtJoint.mjJNT_SLIDE):
        torque, inertia = torque_and_inertia(float(model.qpos0[0]))
        return inertia, 0.0, 0.0, torque
    forces = [torque_and_inertia(q) for q in (0.0, 0.5 * np.pi, np.pi)]
    return (forces[0][1], *_sinusoid([force[0] for force in forces]))


def tip_of(mujoco: Any, model: Any, joint: int) -> tuple[int, FloatArray]:
    """The body and the place in it, where a load would be held: the end of what moves, far from the joint.

    Without geoms it is the centre of mass.
    """
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    anchor, axis = data.xanchor[joint], data.xaxis[joint]
    slides = int(model.jnt_type[joint]) == int(mujoco.mjtJoint.mjJNT_SLIDE)
    best, place, farthest = int(model.jnt_bodyid[joint]), None, -1.0
    for geom in range(model.ngeom):
        body = int(model.geom_bodyid[geom])
        if not moves_with(model, body, int(model.jnt_bodyid[joint])):
            continue
        centre, long = data.geom_xpos[geom], data.geom_xmat[geom].reshape(3, 3)[:, 2]
        half = float(model.geom_size[geom, 1]) if int(model.geom_type[geom]) in (3, 5) else 0.0  # capsule, cylinder
        for end in (centre - half * long, centre + half * long):
            arm = end - anchor
            distance = 0.0 if slides else float(np.linalg.norm(arm - (arm @ axis) * axis))
            if distance > farthest + 1e-9:
                best, place, farthest = body, end, distance
    if place is None:
        place = data.xipos[best]
    return best, np.asarray(data.xmat[best].reshape(3, 3).T @ (place - data.xpos[best]))


def moves_with(model: Any, body: int, moving: int) -> bool:
    """Whether a body is the moving one or hangs on it."""
    while body:
        if body == moving:
            return True
        body = int(model.body_parentid[body])
    return False


class Player:
    """A model that MuJoCo plays, with numbers and changes of its joint."""

    def __init__(self, opened: OpenedModel) -> None:
        self.mujoco, self.opened = import_mujoco(), opened
        self.one = describe_joint(opened)

    def run(self, t: FloatArray, u: FloatArray, numbers: Mapping[str, float]) -> FloatArray:
        """Output for a command that is held between samples, shape (N,).

        Raises
        ------
        SimulatorError
            If the simulation diverges.
        """
        motion = self.play(t, u, numbers)[0]
        if not np.isfinite(motion).all():
            raise SimulatorError(f"{self.opened.source.path} is unstable with this input: its state diverges.")
        return np.ascontiguousarray(motion[:, OUTPUTS.index(self.one.output)])

    def play(self, t: FloatArray, u: FloatArray, numbers: Mapping[str, float]) -> tuple[FloatArray, np.ndarray]:
        """Position, speed and force at each sample, shape (N, 3); and the pair of geoms in contact there, or -1."""
        mujoco, joint = self.mujoco, self.one
        model, data, changes = copy(self.opened.model), None, changes_in(numbers)
        c = joint.constants(numbers, changes)
        _change(model, joint, c, changes)
        data = mujoco.MjData(model)
        data.qpos[0], data.qvel[0] = joint.position + changes["start"], changes["start_speed"]
        if joint.delay:
            _fill_history(mujoco, model, data, float(u[0]))
        lagging = _Lag(joint, c, joint.activation(float(u[0]), changes)) if not model.na and c[32] else None
        if model.na:
            data.act[0] = joint.activation(float(u[0]), changes)
        steps = substeps(float(t[1] - t[0]) if t.size > 1 else joint.timestep, joint.timestep)
        extra = [c[6] - joint.gravity[0], c[7] - joint.gravity[1], c[8] - joint.gravity[2]]
        applied = any(abs(x) > UNIT_GRAVITY for x in extra) or any(c[[42, 44, 45]])
        varied = changes["transmitted"] or changes["peak"]
        motion, contacts = np.empty((u.size, 3)), np.full(u.size, -1)
        for k in range(u.size):
            data.ctrl[0] = u[k]
            command = min(max(float(u[k]), c[34]), c[35])
            motion[k, 0], motion[k, 1] = data.qpos[0], data.qvel[0]
            for s in range(steps):
                if lagging is not None:
                    data.ctrl[0] = lagging.next(command)
                if applied:
                    data.qfrc_applied[0] = _applied(
                        float(data.qpos[0]), (k * steps + s) * joint.timestep, joint, c, extra
                    )
                if varied:
                    model.dof_frictionloss[0] = _friction(data, c)
                mujoco.mj_step(model, data)
                if s == 0:
                    motion[k, 2] = data.actuator_force[0]
                    if data.ncon:
                        contacts[k] = data.contact.geom1[0] * model.ngeom + data.contact.geom2[0]
            if not abs(data.qpos[0]) < 1e8 or data.warning[int(mujoco.mjtWarning.mjWARN_BADQACC)].number:
                motion[k + 1 :] = np.nan
                break
        return motion, contacts


def _fill_history(mujoco: Any, model: Any, data: Any, command: float) -> None:
    """A delayed actuator has had the first command for long."""
    samples = int(model.actuator_history[0, 0])
    times = (np.arange(samples) - samples) * float(model.opt.timestep)
    mujoco.mj_initCtrlHistory(model, data, 0, times, np.full(samples, command))


class _Lag:
    """A lag ahead of an actuator without dynamics."""

    def __init__(self, one: OneJoint, c: FloatArray, first: float) -> None:
        self.state, self.share = first, 1.0 - float(np.exp(-one.timestep / c[33]))

    def next(self, command: float) -> float:
        """The state before this step."""
        before = self.state
        self.state += self.share * (command - before)
        return before


def _applied(q: float, time: float, one: OneJoint, c: FloatArray, extra: list[float]) -> float:
    """Torque of loads, waves and changed weight on the joint."""
    torque = extra[0] * np.sin(q) + extra[1] * np.cos(q) + extra[2]
    if time > c[43] - one.timestep:
        torque += c[42] * min((time - c[43]) / one.timestep + 1.0, 1.0)
    return float(torque + c[44] * np.cos(c[46] * time) + c[45] * np.sin(c[46] * time))


def _friction(data: Any, c: FloatArray) -> float:
    """Largest friction of a joint that depends on the torque of its actuator in the last step, and on its speed."""
    held = c[9] + c[10] * abs(float(data.qfrc_actuator[0]))
    return float(held + c[11] * np.exp(-((float(data.qvel[0]) / c[12]) ** 2)))


def _change(model: Any, joint: OneJoint, c: FloatArray, changes: Mapping[str, float]) -> None:
    """Set the constants of a model of one joint."""
    model.dof_damping[0], model.jnt_stiffness[0], model.qpos_spring[0] = c[1], c[3], c[4]
    if hasattr(model, "dof_dampingpoly"):
        model.dof_dampingpoly[0, 0], model.jnt_stiffnesspoly[0, 1] = c[2], c[5]
    model.dof_armature[0] += c[0] - joint.inertia  # whatever has changed the inertia
    model.dof_frictionloss[0] = c[9]
    if changes["friction"] or changes["transmitted"] or changes["peak"]:
        model.dof_solref[0], model.dof_solimp[0] = STANDING_SOLREF, STANDING_SOLIMP
    if c[15] > -FREE or c[16] < FREE:
        model.jnt_limited[0] = 1
        model.jnt_range[0] = max(c[15], -1e9), min(c[16], 1e9)
    model.actuator_gainprm[0, :3], model.actuator_biasprm[0, :3] = c[26:29], c[29:32]
    if joint.gain != tuple(c[26:29]) or joint.bias != tuple(c[29:32]):
        if any(c[27:29]):
            model.actuator_gaintype[0] = 1
        if any(c[29:32]):
            model.actuator_biastype[0] = 1
    if c[36] > -FREE or c[37] < FREE:
        model.actuator_forcelimited[0] = 1
        model.actuator_forcerange[0] = max(c[36], -1e9), min(c[37], 1e9)
    if model.na:
        model.actuator_dynprm[0, 0] = c[33]
    model.dof_invweight0[0] = 1.0 / c[0]
