"""Write a corrected model of MuJoCo: attributes where MJCF has them, and a Python module for the rest."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from labsid._arrays import FloatArray
from labsid._files import write_file
from labsid.gap.dynamics.inside_parts import IN_TIME
from labsid.gap.model_file import ExportedModel
from labsid.gap.reports.effect_texts import noun, parameter_label, parameter_value
from labsid.gap.reports.inside_texts import inside_clause
from labsid.gap.reports.result import Diagnosis
from labsid.gap.simulations.python_export import write_python_module
from labsid.simulators.mjcf.one_joint import FREE, STANDING_SOLIMP, STANDING_SOLREF, OneJoint, changes_in
from labsid.simulators.mjcf.opening import OpenedModel, import_mujoco, open_model
from labsid.simulators.mjcf.playing import describe_joint, moves_with, tip_of
from labsid.simulators.mjcf.sources import parse_mjcf

IN_MJCF = ("input-delay", "input-saturation")
"""Effects ahead of the joint that attributes of an actuator describe."""
LAWS = ("transmitted", "peak")  # of friction, which depends on the motion
SMALL = 1e-12
HISTORY = 2  # commands that a delayed actuator keeps beyond its delay


def write_mended_model(path: Path, found: Diagnosis) -> list[str]:
    """Write the model with the effects found, and what has been written, in sentences.

    Parameters
    ----------
    path : Path
        ``better.xml``. What MJCF has not goes to ``better.py`` beside it.
    found : Diagnosis
        Of a model of MuJoCo.

    Raises
    ------
    ValueError
        If the simulation is none, or its files lie in another folder.
    """
    model = found.model
    plant = model.hypothesis.plant
    source = parse_mjcf(plant.simulation.source)
    if source is None or plant.simulation.port is None:
        raise ValueError("--export FILE.xml needs a model of MuJoCo as the simulation. Give --sim FILE.xml.")
    opened = open_model(source)
    one = describe_joint(opened)
    theta = model.theta[model.hypothesis.slices["plant"]]
    numbers = plant.simulation.nominal | plant.numbers(theta)
    spec = import_mujoco().MjSpec.from_file(str(source.path))
    names = {effect.name for effect in model.hypothesis.found} if found.summary["effects"] else set()
    left = _change_joint(spec, opened, one, numbers) if names or plant.free else []
    left += _change_actuator(spec, opened, one, model)
    _keep_files(spec, source.path, path)
    spec.compile()
    header = _comments(found, source.path.name)
    text = spec.to_xml().replace("<mujoco", f"{header}<mujoco", 1)
    write_file(path, text.encode())
    said = [f"{path}: the mended model; its comments say what was changed."]
    if not left:
        return said
    module = path.with_suffix(".py")
    if set(left) <= set(LAWS):
        write_file(module, _law_module(path, one, numbers).encode())
    else:
        write_python_module(module, model.to_json_dict())
    return [*said, f"{module}: steps it with what MJCF has not ({', '.join(left)})."]


def _change_joint(spec: Any, opened: OpenedModel, one: OneJoint, numbers: Mapping[str, float]) -> list[str]:
    """Set the attributes of the joint and its link; what has none."""
    mujoco, changes = import_mujoco(), changes_in(numbers)
    c = one.constants(numbers, changes)
    joint = spec.joints[opened.joint]
    joint.damping[:2], joint.stiffness[::2] = c[1:3], (c[3], c[5])
    turn = np.degrees(1.0) if spec.compiler.degree and not one.slides else 1.0
    joint.springref = turn * c[4]
    joint.frictionloss = c[9]
    held = [change for change in ("friction", *LAWS) if changes[change]]
    if held:
        joint.solref_friction[:], joint.solimp_friction[:] = STANDING_SOLREF, STANDING_SOLIMP
    joint.armature = max(numbers.get(f"{one.joint}:armature", one.armature) + changes["armature"], 0.0)
    if changes["low"] > -FREE or changes["high"] < FREE:
        joint.limited = 1
        joint.range[:] = turn * max(c[15], -1e6), turn * min(c[16], 1e6)
    scale = numbers.get(f"{one.link}:mass", one.mass) / one.mass
    if scale != 1.0 or changes["mass"]:
        _change_mass(spec, mujoco, opened, scale, changes["mass"])
    left = [law for law in LAWS if changes[law]]
    if changes["gravity_sin"] or changes["gravity_cos"]:
        left += _change_gravity(spec, mujoco, opened, (c[6], c[7]))
    actuator = spec.actuators[opened.actuator]
    actuator.gainprm[:3], actuator.biasprm[:3] = c[26:29], c[29:32]
    if any(c[29:32]):
        actuator.biastype = mujoco.mjtBias.mjBIAS_AFFINE
    if c[37] < FREE:
        actuator.forcelimited = 1
        actuator.forcerange[:] = c[36], c[37]
    if changes["lag"]:
        actuator.dyntype, actuator.dynprm[0] = mujoco.mjtDyn.mjDYN_FILTEREXACT, c[33]
    elif one.dynamics in ("filter", "filterexact"):
        actuator.dynprm[0] = c[33]
    return left


def _change_mass(spec: Any, mujoco: Any, opened: OpenedModel, scale: float, at_tip: float) -> None:
    """Scale the masses of what moves, and add a mass to the end of the link."""
    model = opened.model
    tip, place = tip_of(mujoco, model, opened.joint)
    for body in range(1, model.nbody):
        if not moves_with(model, body, int(model.jnt_bodyid[opened.joint])):
            continue
        mass, centre = scale * float(model.body_mass[body]), np.array(model.body_ipos[body])
        turn = np.zeros(9)
        mujoco.mju_quat2Mat(turn, model.body_iquat[body])
        axes = turn.reshape(3, 3)
        inertia = axes @ np.diag(scale * model.body_inertia[body]) @ axes.T
        if body == tip and at_tip:
            whole = mass + at_tip
            middle = (mass * centre + at_tip * place) / whole
            inertia = inertia + mass * _spread(centre - middle) + at_tip * _spread(place - middle)
            mass, centre = whole, middle
        own = spec.bodies[body]
        own.explicitinertial = True
        own.mass, own.ipos = mass, centre
        own.iquat = (1.0, 0.0, 0.0, 0.0)
        own.fullinertia = inertia[[0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]]


def _spread(arm: FloatArray) -> FloatArray:
    return np.asarray((arm @ arm) * np.eye(3) - np.outer(arm, arm))


def _change_gravity(spec: Any, mujoco: Any, opened: OpenedModel, wanted: tuple[float, float]) -> list[str]:
    """Set the vector of gravity that gives the joint this torque; "gravity" if its link is balanced."""
    model = opened.model
    before = np.array(model.opt.gravity)
    axes, torques = np.eye(3), []
    for axis in axes:
        model.opt.gravity[:] = axis
        torques.append(describe_joint(opened).gravity[:2])
    model.opt.gravity[:] = before
    matrix = np.array(torques).T
    if np.linalg.matrix_rank(matrix, SMALL) < 2:
        return ["gravity"]
    along = before - np.linalg.pinv(matrix) @ (matrix @ before)  # along the joint: it has no torque
    spec.option.gravity = np.linalg.pinv(matrix) @ np.array(wanted) + along
    return []


def _change_actuator(spec: Any, opened: OpenedModel, one: OneJoint, model: ExportedModel) -> list[str]:
    """Set the attributes that describe effects on the command; what has none."""
    hypothesis = model.hypothesis
    actuator = spec.actuators[opened.actuator]
    left = []
    for effect in hypothesis.found:
        if effect.name == "input-delay":
            delay = float(model.theta[hypothesis.slices[effect.key]][0]) * model.Ts + one.delay
            actuator.delay = max(delay, 0.0)
            actuator.nsample = int(np.ceil(delay / one.timestep)) + HISTORY
        elif effect.name == "input-saturation" and effect.variant in ("low", "high", "both", ""):
            low, high = np.asarray(model.u_scale.back(_limits(model, effect)))
            actuator.ctrllimited = 1
            actuator.ctrlrange[:] = max(low, one.ctrlrange[0], -1e6), min(high, one.ctrlrange[1], 1e6)
        elif not effect.key.partition("/")[2].startswith("joint"):
            left.append(effect.name)
    return left + [change for change in hypothesis.plant.inside if change in IN_TIME]


def _limits(model: ExportedModel, effect: Any) -> FloatArray:
    """Ends of the scaled command after a limit."""
    own = model.theta[model.hypothesis.slices[effect.key]]
    return np.asarray(effect.apply(np.array([-1e9, 1e9]), own, 2))


def _keep_files(spec: Any, before: Path, after: Path) -> None:
    """The folder of meshes, textures and hfields, which a model in another folder needs."""
    if before.resolve().parent == after.resolve().parent:
        return
    if len(spec.meshes) + len(spec.textures) + len(spec.hfields):
        raise ValueError(
            f"{before} uses files of its folder. Write the mended model there: --export {before.parent}/..."
        )


def _comments(found: Diagnosis, source: str) -> str:
    """What was changed, by how much, with standard errors."""
    report = found.summary
    lines = [f"Made by labsid gap diagnose from {source} and the record {report['record']['name'] or ''}."]
    for effect in report["effects"]:
        said = inside_clause(effect) if effect.get("joint") else noun(effect["name"])
        lines.append(f"{said}. Probability {effect['probability']:.2f}.")
        for name, entry in effect["parameters"].items():
            value, unit = parameter_value(effect["name"], name, entry)
            lines.append(f"  {parameter_label(effect['name'], name, entry)}: {value} {unit}".rstrip())
    gap = report["gap"]
    lines.append(f"Free-run rms error on held-out samples: {gap['before']:.4g} before, {gap['after']:.4g} after.")
    return "".join(f"<!-- {line.replace('--', '- -')} -->\n" for line in lines)


_LAW_MODULE = '''"""Steps {model} with what MJCF has not: friction that depends on torque and speed."""

from math import exp
from pathlib import Path

import mujoco
import numpy as np

MODEL = mujoco.MjModel.from_xml_path(str(Path(__file__).parent / "{model}"))
DOF, ACTUATOR = 0, 0
FRICTION = {friction!r}  # {unit}
TRANSMITTED = {transmitted!r}  # of the torque of the actuator
PEAK, STRIBECK = {peak!r}, {stribeck!r}  # {unit} more at rest, and the speed over which it decays


def step(model, data):
    """One step of MuJoCo, with the friction of this instant."""
    sliding = FRICTION + TRANSMITTED * abs(data.qfrc_actuator[DOF])
    model.dof_frictionloss[DOF] = sliding + PEAK * exp(-((data.qvel[DOF] / STRIBECK) ** 2))
    mujoco.mj_step(model, data)


def simulate(t, u, start={start!r}):
    """The output for a command that is held between samples, from the position `start` at rest."""
    data = mujoco.MjData(MODEL)
    data.qpos[0] = start
    if MODEL.na:
        data.act[0] = u[0]
    steps = round((t[1] - t[0]) / MODEL.opt.timestep)
    out = np.empty(len(u))
    for k, command in enumerate(u):
        data.ctrl[ACTUATOR] = command
        out[k] = data.{output}[0]
        for _ in range(steps):
            step(MODEL, data)
    return out
'''


def _law_module(path: Path, one: OneJoint, numbers: Mapping[str, float]) -> str:
    changes = changes_in(numbers)
    c = one.constants(numbers, changes)
    return _LAW_MODULE.format(
        model=path.name,
        unit="N" if one.slides else "N m",
        friction=float(c[9]),
        transmitted=float(c[10]),
        peak=float(c[11]),
        stribeck=float(c[12]),
        start=one.position + changes["start"],
        output={"position": "qpos", "speed": "qvel", "force": "actuator_force"}[one.output],
    )
