"""Describe the joints of a model of MuJoCo for the compiled loop."""

from typing import Any

import numpy as np

from labsid._arrays import FloatArray
from labsid.simulators.mjcf.loop_constants import FREE
from labsid.simulators.mjcf.one_joint import OneJoint
from labsid.simulators.mjcf.opening import OpenedJoint, OpenedModel, import_mujoco
from labsid.simulators.mjcf.several_joints import Links, SeveralJoints


def describe_model(opened: OpenedModel) -> OneJoint | SeveralJoints:
    """The model as numbers.

    Raises
    ------
    ValueError
        If it has elements that the loop has not.
    """
    mujoco, model = import_mujoco(), opened.model
    if len(opened.joints) == 1 and len(opened.outputs) == 1:
        return _describe_joint(mujoco, opened, opened.joints[0], opened.outputs[0].what)
    output = {one.joint: one.what for one in opened.outputs}
    joints = tuple(
        _describe_joint(mujoco, opened, one, output.get(i, "position")) for i, one in enumerate(opened.joints)
    )
    tips = tuple(tip_of(mujoco, model, one.joint) for one in opened.joints)
    return SeveralJoints(
        joints,
        opened.inputs,
        tuple((one.joint, one.what) for one in opened.outputs),
        tuple(one.name for one in opened.outputs),
        _links(mujoco, model, tips),
    )


def joints_in(described: OneJoint | SeveralJoints) -> tuple[OneJoint, ...]:
    """The joints of a model."""
    return (described,) if isinstance(described, OneJoint) else described.joints


def _describe_joint(mujoco: Any, opened: OpenedModel, own: OpenedJoint, output: str) -> OneJoint:
    """A joint with its actuator; one of several without inertia and weight, which depend on the others."""
    model, at, joint = opened.model, own.actuator, own.joint
    alone = len(opened.joints) == 1
    link = int(model.jnt_bodyid[joint])
    armature = float(model.dof_armature[joint])
    poly = getattr(model, "dof_dampingpoly", np.zeros((model.nv, 2)))
    stiff = getattr(model, "jnt_stiffnesspoly", np.zeros((model.njnt, 2)))
    limited = bool(model.jnt_limited[joint])
    integrators = mujoco.mjtIntegrator
    return OneJoint(
        joint=own.joint_name,
        actuator=own.actuator_name,
        link=own.link_name,
        output=output,
        timestep=float(model.opt.timestep),
        slides=int(model.jnt_type[joint]) == int(mujoco.mjtJoint.mjJNT_SLIDE),
        inertia=_inertia(mujoco, model) if alone else armature,
        armature=armature,
        gravity=_gravity_torque(mujoco, model, joint) if alone else (0.0, 0.0, 0.0),
        mass=float(model.body_subtreemass[link]) if alone else _link_mass(model, joint),
        tip=_tip(mujoco, model, joint) if alone else (0.0, 0.0, 0.0, 0.0),
        position=float(model.qpos0[joint]),
        passive={
            "damping": float(model.dof_damping[joint]),
            "drag": float(poly[joint, 0]),
            "stiffness": float(model.jnt_stiffness[joint]),
            "springref": float(model.qpos_spring[joint]),
            "cubic": float(stiff[joint, 1]),
            "frictionloss": float(model.dof_frictionloss[joint]),
        },
        solref_friction=tuple(map(float, model.dof_solref[joint])),
        solimp_friction=tuple(map(float, model.dof_solimp[joint])),
        solref_limit=tuple(map(float, model.jnt_solref[joint])),
        solimp_limit=tuple(map(float, model.jnt_solimp[joint])),
        range=(*(map(float, model.jnt_range[joint]) if limited else (-FREE, FREE)), float(model.jnt_margin[joint])),
        jointrange=_bounds(model.jnt_actfrcrange[joint], model.jnt_actfrclimited[joint]),
        implicit=int(model.opt.integrator) != int(integrators.mjINT_EULER),
        geoms=tuple(mujoco.mj_id2name(model, mujoco.mjtObj.mjOBJ_GEOM, i) or f"geom {i}" for i in range(model.ngeom)),
        euler_damping=not int(model.opt.disableflags) & int(mujoco.mjtDisableBit.mjDSBL_EULERDAMP),
        **_actuator(mujoco, model, at, own.actuator_name),
    )


def _actuator(mujoco: Any, model: Any, at: int, name: str) -> dict[str, Any]:
    """The part of a description about the actuator; `at` is -1 without one."""
    if at < 0:
        nothing, free = (0.0, 0.0, 0.0), (-FREE, FREE)
        ranges = {"ctrlrange": free, "forcerange": free, "actrange": free}
        return {"gear": 0.0, "gain": nothing, "bias": nothing, "dynamics": "none", "time_constant": 0.0} | ranges
    names = ("none", "integrator", "filter", "filterexact")
    dynamics = {int(getattr(mujoco.mjtDyn, f"mjDYN_{kind.upper()}")): kind for kind in names}
    kind = int(model.actuator_dyntype[at])
    if kind not in dynamics:
        raise ValueError(f"the actuator {name} has dynamics that cannot be opened. Give it as a function.")
    gain = np.array(model.actuator_gainprm[at, :3], float)
    if int(model.actuator_gaintype[at]) == int(mujoco.mjtGain.mjGAIN_FIXED):
        gain[1:] = 0.0
    bias = np.array(model.actuator_biasprm[at, :3], float)
    if int(model.actuator_biastype[at]) == int(mujoco.mjtBias.mjBIAS_NONE):
        bias[:] = 0.0
    return {
        "gear": float(model.actuator_gear[at, 0]),
        "gain": tuple(gain),
        "bias": tuple(bias),
        "dynamics": dynamics[kind],
        "time_constant": float(model.actuator_dynprm[at, 0]),
        "ctrlrange": _bounds(model.actuator_ctrlrange[at], model.actuator_ctrllimited[at]),
        "forcerange": _bounds(model.actuator_forcerange[at], model.actuator_forcelimited[at]),
        "actrange": _bounds(model.actuator_actrange[at], model.actuator_actlimited[at]),
        "delay": float(model.actuator_delay[at]) if hasattr(model, "actuator_delay") else 0.0,
    }


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


def joint_of(model: Any, body: int) -> int:
    """The last joint that moves a body; -1 for one that stands."""
    while body and not int(model.body_jntnum[body]):
        body = int(model.body_parentid[body])
    return int(model.body_jntadr[body] + model.body_jntnum[body] - 1) if body else -1


def _link_mass(model: Any, joint: int) -> float:
    """Mass of the bodies that a joint moves and no further one."""
    return float(sum(model.body_mass[body] for body in range(1, model.nbody) if joint_of(model, body) == joint))


def _links(mujoco: Any, model: Any, tips: tuple[tuple[int, FloatArray], ...]) -> Links:
    """The bodies by joint, in the frame of the world at the default position."""
    data = mujoco.MjData(model)
    data.qpos[:] = model.qpos0
    mujoco.mj_kinematics(model, data)
    mujoco.mj_comPos(model, data)
    count = model.njnt
    masses, centres, inertias = np.zeros(count), np.zeros((count, 3)), np.zeros((count, 3, 3))
    bodies = [(body, joint_of(model, body)) for body in range(1, model.nbody)]
    for body, joint in bodies:
        if joint >= 0:
            masses[joint] += model.body_mass[body]
            centres[joint] += model.body_mass[body] * data.xipos[body]
    centres /= np.where(masses > 0.0, masses, 1.0)[:, None]
    for body, joint in bodies:
        if joint >= 0:
            turn, arm = data.ximat[body].reshape(3, 3), data.xipos[body] - centres[joint]
            inertias[joint] += turn @ np.diag(model.body_inertia[body]) @ turn.T + model.body_mass[body] * spread(arm)
    return Links(
        np.array([int(model.dof_parentid[joint]) for joint in range(count)]),
        np.array([int(kind) == int(mujoco.mjtJoint.mjJNT_SLIDE) for kind in model.jnt_type]),
        np.array(data.xaxis),
        np.array(data.xanchor),
        masses,
        centres,
        inertias,
        np.array(model.qpos0),
        np.array([data.xpos[body] + data.xmat[body].reshape(3, 3) @ place for body, place in tips]),
        np.array(model.opt.gravity),
    )


def spread(arm: FloatArray) -> FloatArray:
    """Inertia of a unit mass at the end of an arm, shape (3, 3)."""
    return np.asarray((arm @ arm) * np.eye(3) - np.outer(arm, arm))


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
    """The body and the place in it, where a load would be held: the end of the link, far from its joint.

    Without geoms it is the centre of mass.
    """
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    anchor, axis = data.xanchor[joint], data.xaxis[joint]
    slides = int(model.jnt_type[joint]) == int(mujoco.mjtJoint.mjJNT_SLIDE)
    best, place, farthest = int(model.jnt_bodyid[joint]), None, -1.0
    for geom in range(model.ngeom):
        body = int(model.geom_bodyid[geom])
        if joint_of(model, body) != joint:
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
