"""Write a corrected model of MuJoCo: attributes where MJCF has them, and a Python module for the rest."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from labsid._arrays import FloatArray
from labsid._files import write_file
from labsid.gap.dynamics.inside_parts import IN_TIME
from labsid.gap.effects.base import InputEffect
from labsid.gap.effects.inside import Inside
from labsid.gap.fits.hypothesis import Hypothesis
from labsid.gap.joints.arm_diagnosis import JointsDiagnosis
from labsid.gap.record.data import Scale
from labsid.gap.reports.effect_texts import noun, parameter_label, parameter_value
from labsid.gap.reports.inside_texts import inside_clause
from labsid.gap.reports.result import Diagnosis
from labsid.gap.simulations.python_export import write_python_module
from labsid.simulators.mjcf.describing import describe_model, joints_in
from labsid.simulators.mjcf.loop_constants import FREE
from labsid.simulators.mjcf.one_joint import STANDING_SOLIMP, STANDING_SOLREF, OneJoint, changes_in
from labsid.simulators.mjcf.opening import OpenedModel, import_mujoco, open_model
from labsid.simulators.mjcf.playing import changed_bodies
from labsid.simulators.mjcf.sources import parse_mjcf

IN_MJCF = ("input-delay", "input-saturation")
"""Effects ahead of the joint that attributes of an actuator describe."""
LAWS = ("transmitted", "peak")  # of friction, which depends on the motion
WEIGHT = ["gravity"]  # on one of several joints
SEEN_PLAY = "a play between an actuator and its sensor"
SMALL = 1e-12
HISTORY = 2  # commands that a delayed actuator keeps beyond its delay


def write_mended_model(path: Path, found: Diagnosis | JointsDiagnosis) -> list[str]:
    """Write the model with the effects found, and what has been written, in sentences.

    Parameters
    ----------
    path : Path
        ``better.xml``. What MJCF has not goes to ``better.py`` beside it.
    found : Diagnosis or JointsDiagnosis
        Of a model of MuJoCo.

    Raises
    ------
    ValueError
        If the simulation is none, or its files lie in another folder.
    """
    several = isinstance(found, JointsDiagnosis)
    if isinstance(found, JointsDiagnosis):
        source = parse_mjcf(found.mended.simulator.source)
    else:
        simulation = found.model.hypothesis.plant.simulation
        source = None if simulation.port is None else parse_mjcf(simulation.source)
    if source is None:
        raise ValueError("--export FILE.xml needs a model of MuJoCo as the simulation. Give --sim FILE.xml.")
    opened = open_model(source)
    joints = joints_in(describe_model(opened))
    spec = import_mujoco().MjSpec.from_file(str(source.path))
    if isinstance(found, JointsDiagnosis):
        numbers, commands, in_time = _changes_of_several(found, opened)
    else:
        numbers, commands, in_time = _changes_of_one(found)
    left: dict[str, None] = {}
    for place, one in enumerate(joints if numbers else ()):
        left |= dict.fromkeys(_change_joint(spec, opened, place, one, numbers))
    _add_plays(spec, opened, joints, numbers)
    Ts = found.summary["record"]["Ts"]
    for place, (hypothesis, theta, scale) in commands.items():
        left |= dict.fromkeys(_change_actuator(spec, opened, place, joints[place], hypothesis, theta, scale, Ts))
    left |= dict.fromkeys(in_time)
    _keep_files(spec, source.path, path)
    spec.compile()
    header = _comments(found.summary, source.path.name)
    content = spec.to_xml().replace("<mujoco", f"{header}<mujoco", 1)
    write_file(path, content.encode())
    said = [f"{path}: the mended model; its comments say what was changed."]
    if not left:
        return said
    module = path.with_suffix(".py")
    if set(left) <= {*LAWS, *(WEIGHT if several else ())}:
        write_file(module, _law_module(path, opened, joints, numbers).encode())
    elif isinstance(found, JointsDiagnosis):
        return [*said, f"It is without {', '.join(left)}, which MJCF has not, or which belongs to this record only."]
    else:
        write_python_module(module, found.model.to_json_dict())
    return [*said, f"{module}: steps it with what MJCF has not ({', '.join(left)})."]


_Commands = dict[int, tuple[Hypothesis, FloatArray, Scale]]


def _changes_of_one(found: Diagnosis) -> tuple[dict[str, float], _Commands, list[str]]:
    """Numbers that have changed, effects on the command, and changes that belong to the record, of one joint."""
    model = found.model
    hypothesis, plant = model.hypothesis, model.hypothesis.plant
    numbers = plant.simulation.nominal | plant.numbers(model.theta[hypothesis.slices["plant"]])
    changed = bool(hypothesis.found and found.summary["effects"]) or bool(plant.free)
    in_time = [change for change in plant.inside if change in IN_TIME]
    return numbers if changed else {}, {0: (hypothesis, model.theta, model.u_scale)}, in_time


def _changes_of_several(found: JointsDiagnosis, opened: OpenedModel) -> tuple[dict[str, float], _Commands, list[str]]:
    """The same of a model of several joints."""
    arm = found.mended
    commands = {opened.inputs[one.input]: (one.hypothesis, one.theta, one.scale) for one in arm.commands}
    in_time = [name for name in arm.numbers if name.rpartition(":")[2] in ("load", "frequency")]
    return (
        dict(arm.numbers),
        commands,
        [{"load": "load", "frequency": "wave"}[name.rpartition(":")[2]] for name in in_time],
    )


def _change_joint(spec: Any, opened: OpenedModel, place: int, one: OneJoint, numbers: Mapping[str, float]) -> list[str]:
    """Set the attributes of a joint and its link; what has none."""
    alone = len(opened.joints) == 1
    mujoco, changes = import_mujoco(), changes_in(numbers, "" if alone else one.joint)
    c = one.constants(numbers, changes)
    joint = spec.joints[opened.joints[place].joint]
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
    scale = numbers.get(f"{one.link}:mass", one.mass) / (one.mass or 1.0)
    if one.mass and (scale != 1.0 or changes["mass"]):
        _change_mass(spec, mujoco, opened, opened.joints[place].joint, scale, changes["mass"])
    left = [law for law in LAWS if changes[law]] + ([SEEN_PLAY] if changes["seen_play"] else [])
    if changes["gravity_sin"] or changes["gravity_cos"]:
        left += _change_gravity(spec, mujoco, opened, (c[6], c[7])) if alone else WEIGHT
    if not one.actuator:
        return left
    actuator = spec.actuators[opened.joints[place].actuator]
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


def _add_plays(spec: Any, opened: OpenedModel, joints: Sequence[OneJoint], numbers: Mapping[str, float]) -> None:
    """Add a joint between stops behind each joint whose gear has a play."""
    rotors = list(spec.joints)
    for place, one in enumerate(joints):
        changes = changes_in(numbers, "" if len(joints) == 1 else one.joint)
        if not changes["play"]:
            continue
        rotor = rotors[opened.joints[place].joint]
        turn = np.degrees(1.0) if spec.compiler.degree and not one.slides else 1.0
        play = rotor.parent.add_joint(
            name=f"{one.joint}-play", type=rotor.type, axis=rotor.axis, pos=rotor.pos, limited=1
        )
        play.range[:] = -0.5 * turn * changes["play"], 0.5 * turn * changes["play"]
        play.solref_limit[:] = changes["contact_time"], 1.0


def _change_mass(spec: Any, mujoco: Any, opened: OpenedModel, joint: int, scale: float, at_tip: float) -> None:
    """Scale the masses of a link, and add a mass to its end."""
    for body, mass, centre, inertia in changed_bodies(mujoco, opened.model, joint, scale, at_tip):
        own = spec.bodies[body]
        own.explicitinertial = True
        own.mass, own.ipos = mass, centre
        own.iquat = (1.0, 0.0, 0.0, 0.0)
        own.fullinertia = inertia[[0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]]


def _change_gravity(spec: Any, mujoco: Any, opened: OpenedModel, wanted: tuple[float, float]) -> list[str]:
    """Set the vector of gravity that gives the joint this torque; "gravity" if its link is balanced."""
    model = opened.model
    before = np.array(model.opt.gravity)
    axes, torques = np.eye(3), []
    for axis in axes:
        model.opt.gravity[:] = axis
        torques.append(joints_in(describe_model(opened))[0].gravity[:2])
    model.opt.gravity[:] = before
    matrix = np.array(torques).T
    if np.linalg.matrix_rank(matrix, SMALL) < 2:
        return ["gravity"]
    along = before - np.linalg.pinv(matrix) @ (matrix @ before)  # along the joint: it has no torque
    spec.option.gravity = np.linalg.pinv(matrix) @ np.array(wanted) + along
    return []


def _change_actuator(
    spec: Any,
    opened: OpenedModel,
    place: int,
    one: OneJoint,
    hypothesis: Hypothesis,
    theta: FloatArray,
    scale: Scale,
    Ts: float,
) -> list[str]:
    """Set the attributes that describe effects on the command of an actuator; what has none."""
    actuator = spec.actuators[opened.joints[place].actuator]
    left = []
    for effect in hypothesis.found:
        own = theta[hypothesis.slices[effect.key]] if effect.key in hypothesis.slices else theta[:0]
        if effect.name == "input-delay":
            delay = float(own[0]) * Ts + one.delay
            actuator.delay = max(delay, 0.0)
            actuator.nsample = int(np.ceil(delay / one.timestep)) + HISTORY
        elif effect.name == "input-saturation" and effect.variant in ("low", "high", "both", ""):
            assert isinstance(effect, InputEffect)
            ends = np.asarray(effect.apply(np.array([-1e9, 1e9]), own, 2))
            low, high = np.asarray(scale.back(ends))
            actuator.ctrllimited = 1
            actuator.ctrlrange[:] = max(low, one.ctrlrange[0], -1e6), min(high, one.ctrlrange[1], 1e6)
        elif not isinstance(effect, Inside):
            left.append(effect.name)
    return left


def _keep_files(spec: Any, before: Path, after: Path) -> None:
    """The folder of meshes, textures and hfields, which a model in another folder needs."""
    if before.resolve().parent == after.resolve().parent:
        return
    if len(spec.meshes) + len(spec.textures) + len(spec.hfields):
        raise ValueError(
            f"{before} uses files of its folder. Write the mended model there: --export {before.parent}/..."
        )


def _comments(report: dict[str, Any], source: str) -> str:
    """What was changed, by how much, with standard errors."""
    lines = [f"Made by labsid gap diagnose from {source} and the record {report['record']['name'] or ''}."]
    for effect in report["effects"]:
        said = inside_clause(effect) if effect.get("joint") else noun(effect["name"])
        lines.append(f"{said}. Probability {effect['probability']:.2f}.")
        for name, entry in effect["parameters"].items():
            value, unit = parameter_value(effect["name"], name, entry, {})
            lines.append(f"  {parameter_label(effect['name'], name, entry)}: {value} {unit}".rstrip())
    gap = report["gap"]
    lines.append(f"Free-run rms error on held-out samples: {gap['before']:.4g} before, {gap['after']:.4g} after.")
    return "".join(f"<!-- {line.replace('--', '- -')} -->\n" for line in lines)


_LAW_MODULE = '''"""Steps {model} with what MJCF has not: friction that depends on torque and speed, or weights."""

from math import cos, exp, sin
from pathlib import Path

import mujoco
import numpy as np

MODEL = mujoco.MjModel.from_xml_path(str(Path(__file__).parent / "{model}"))
ACTUATORS = {actuators!r}  # of the inputs
START = {start!r}  # positions of the joints
# By degree of freedom: friction, share of the actuator's torque, excess at rest, and the speed over which it decays.
FRICTION = {friction!r}  # {unit}
WEIGHT = {weight!r}  # {unit}, times sine and cosine of the position


def step(model, data):
    """One step of MuJoCo, with the friction and the weights of this instant."""
    for dof, (sliding, transmitted, peak, stribeck) in FRICTION.items():
        held = sliding + transmitted * abs(data.qfrc_actuator[dof])
        model.dof_frictionloss[dof] = held + peak * exp(-((data.qvel[dof] / stribeck) ** 2))
    for dof, (over_sine, over_cosine) in WEIGHT.items():
        data.qfrc_applied[dof] = over_sine * sin(data.qpos[dof]) + over_cosine * cos(data.qpos[dof])
    mujoco.mj_step(model, data)


def simulate(t, u):
    """The outputs for commands that are held between samples, from the positions `START` at rest."""
    data = mujoco.MjData(MODEL)
    data.qpos[:] = START
    commands = np.asarray(u, float).reshape(len(t), -1)
    for column, actuator in enumerate(ACTUATORS):
        if MODEL.actuator_actadr[actuator] >= 0:
            data.act[MODEL.actuator_actadr[actuator]] = commands[0, column]
    steps = round((t[1] - t[0]) / MODEL.opt.timestep)
    out = np.empty((len(t), {count}))
    for k, command in enumerate(commands):
        data.ctrl[ACTUATORS] = command
        out[k] = {outputs}
        for _ in range(steps):
            step(MODEL, data)
    return out.reshape(np.shape(u)) if {count} == 1 else out
'''


def _law_module(path: Path, opened: OpenedModel, joints: Sequence[OneJoint], numbers: Mapping[str, float]) -> str:
    friction, weight, start = {}, {}, []
    for place, one in enumerate(joints):
        changes = changes_in(numbers, "" if len(joints) == 1 else one.joint)
        c = one.constants(numbers, changes)
        start.append(float(one.position + changes["start"]))
        if any(changes[law] for law in LAWS):
            friction[place] = tuple(map(float, c[9:13]))
        if len(joints) > 1 and (changes["gravity_sin"] or changes["gravity_cos"]):
            weight[place] = (float(changes["gravity_sin"]), float(changes["gravity_cos"]))
    attributes = {"position": "qpos", "speed": "qvel", "force": "qfrc_actuator"}
    return _LAW_MODULE.format(
        model=path.name,
        unit="N" if joints[0].slides else "N m",
        actuators=[opened.joints[place].actuator for place in opened.inputs],
        start=start,
        friction=friction,
        weight=weight,
        count=len(opened.outputs),
        outputs=", ".join(f"data.{attributes[one.what]}[{one.joint}]" for one in opened.outputs),
    )
