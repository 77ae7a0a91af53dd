"""Open a model of MuJoCo: what it may read, its actuators and outputs, and errors in one line."""

import os
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

from labsid.simulators.mjcf.sources import MjcfSource

INSTALL = 'pip install "labsid[mujoco]"'
FILE_ATTRIBUTES = ("file", "meshdir", "texturedir", "assetdir", "filename")
POSITION_SENSORS = {"jointpos": "position", "jointvel": "speed", "actuatorfrc": "force", "jointactuatorfrc": "force"}


@dataclass(frozen=True, slots=True)
class OpenedJoint:
    """A joint of a model, with its actuator.

    Attributes
    ----------
    joint, actuator : int
        Indices; -1 without an actuator.
    joint_name, actuator_name, link_name : str
    """

    joint: int
    actuator: int
    joint_name: str
    actuator_name: str
    link_name: str


@dataclass(frozen=True, slots=True)
class OpenedOutput:
    """An output of a model.

    Attributes
    ----------
    name : str
    joint : int
        Its place among the joints.
    what : str
        "position" or "speed" of the joint, or "force" of its actuator.
    """

    name: str
    joint: int
    what: str


@dataclass(frozen=True, slots=True, eq=False)
class OpenedModel:
    """A model with the signals of a record.

    Attributes
    ----------
    source : MjcfSource
        With the names of its signals.
    model : mujoco.MjModel
    joints : tuple of OpenedJoint
        All of them, in the order of the degrees of freedom.
    inputs : tuple of int
        For each input, the place of its joint among them.
    outputs : tuple of OpenedOutput
    """

    source: MjcfSource
    model: Any
    joints: tuple[OpenedJoint, ...]
    inputs: tuple[int, ...]
    outputs: tuple[OpenedOutput, ...]


def import_mujoco() -> Any:
    """The module mujoco.

    Raises
    ------
    ValueError
        If it is not installed.
    """
    try:
        import mujoco  # type: ignore[import-untyped, unused-ignore]
    except ImportError:
        raise ValueError(f"a model of MuJoCo needs the package mujoco. Type: {INSTALL}") from None
    return mujoco


def open_model(source: MjcfSource) -> OpenedModel:
    """Load a model and find the actuator and the output.

    Raises
    ------
    ValueError
        If mujoco is not installed, the model cannot be loaded or reads files outside its folder, or a name does not
        exist or is missing.
    """
    mujoco = import_mujoco()
    path = source.path
    if not path.is_file():
        raise ValueError(f"{path} does not exist. Give --sim as a MuJoCo model, FILE.xml.")
    if not source.trusted:
        _refuse_foreign_files(path)
    try:
        model = mujoco.MjModel.from_xml_path(str(path))
    except Exception as error:
        said = " ".join(str(error).split())
        raise ValueError(f"{path} cannot be loaded by MuJoCo {mujoco.__version__}: {said}") from None
    driven = _driven(mujoco, model, source)
    joints = _joints(mujoco, model, path, driven)
    actuators = list(driven)
    places = tuple(next(i for i, one in enumerate(joints) if one.actuator == at) for at in actuators)
    outputs = tuple(_output(mujoco, model, source, name, joints) for name in _outputs(source, joints, places))
    of_inputs, of_outputs = (
        ",".join(names) for names in ([joints[i].actuator_name for i in places], [one.name for one in outputs])
    )
    return OpenedModel(MjcfSource(path, of_inputs, of_outputs, source.trusted), model, joints, places, outputs)


def names_of(mujoco: Any, model: Any, kind: str) -> list[str]:
    """Names of all elements of a kind, "joint", "actuator" or "sensor"; numbers of those without a name."""
    count = {"joint": model.njnt, "actuator": model.nu, "sensor": model.nsensor}[kind]
    code = getattr(mujoco.mjtObj, f"mjOBJ_{kind.upper()}")
    return [mujoco.mj_id2name(model, code, index) or f"{kind} {index}" for index in range(count)]


def _driven(mujoco: Any, model: Any, source: MjcfSource) -> dict[int, int]:
    """The joint of each actuator that takes an input, by indices, in the order of the inputs."""
    names = names_of(mujoco, model, "actuator")
    if not names:
        raise ValueError(f"{source.path} has no actuator, so nothing takes the input. Add one, such as <motor>.")
    wanted = source.actuators or tuple(names)
    for name in wanted:
        if name not in names:
            raise ValueError(f"{source.path} has no actuator {name!r}; it has {', '.join(names)}.")
    if len(set(wanted)) < len(wanted):
        raise ValueError(f"--inputs names an actuator of {source.path} twice; got {source.actuator}.")
    missing = [name for name in names if name not in wanted]
    if missing:
        raise ValueError(
            f"{source.path} has {len(names)} actuators; --inputs names {', '.join(wanted)}. Name the columns of all of "
            f"them, or remove {', '.join(missing)}, as in the record."
        )
    of_joint = (int(mujoco.mjtTrn.mjTRN_JOINT), int(mujoco.mjtTrn.mjTRN_JOINTINPARENT))
    driven: dict[int, int] = {}
    for at in map(names.index, wanted):
        if int(model.actuator_trntype[at]) not in of_joint:
            raise ValueError(f"the actuator {names[at]} of {source.path} acts on no joint. Give one that does.")
        joint = int(model.actuator_trnid[at, 0])
        if joint in driven.values():
            of = names_of(mujoco, model, "joint")[joint]
            raise ValueError(
                f"the joint {of} of {source.path} has more than one actuator, which cannot be opened. Remove "
                "the others, or give the model as a function."
            )
        driven[at] = joint
    return driven


def _joints(mujoco: Any, model: Any, path: Path, driven: Mapping[int, int]) -> tuple[OpenedJoint, ...]:
    """All joints, each with the actuator that moves it."""
    names = names_of(mujoco, model, "joint")
    types = mujoco.mjtJoint
    for joint, name in enumerate(names):
        if int(model.jnt_type[joint]) not in (int(types.mjJNT_HINGE), int(types.mjJNT_SLIDE)):
            raise ValueError(f"the joint {name} of {path} is no hinge or slide. Give a model whose joints are.")
    actuator_of = {joint: at for at, joint in driven.items()}
    actuators = names_of(mujoco, model, "actuator")
    found = []
    for joint, name in enumerate(names):
        at, body = actuator_of.get(joint, -1), int(model.jnt_bodyid[joint])
        link = mujoco.mj_id2name(model, mujoco.mjtObj.mjOBJ_BODY, body) or f"body {body}"
        found.append(OpenedJoint(joint, at, name, actuators[at] if at >= 0 else "", link))
    return tuple(found)


def _outputs(source: MjcfSource, joints: Sequence[OpenedJoint], driven: Sequence[int]) -> tuple[str, ...]:
    """Names of the outputs; by default the joints with an actuator."""
    return source.outputs or tuple(joints[i].joint_name for i in driven)


def _output(mujoco: Any, model: Any, source: MjcfSource, wanted: str, joints: Sequence[OpenedJoint]) -> OpenedOutput:
    """What is measured of a joint, by the name of the joint or of a sensor."""
    names, sensors = [one.joint_name for one in joints], names_of(mujoco, model, "sensor")
    if wanted in names:
        return OpenedOutput(wanted, names.index(wanted), "position")
    if wanted not in sensors:
        known = [f"joints {', '.join(names)}", *([f"sensors {', '.join(sensors)}"] if sensors else [])]
        raise ValueError(f"{source.path} has no joint or sensor {wanted!r}; it has the {' and the '.join(known)}.")
    index = sensors.index(wanted)
    kind = mujoco.mjtSensor(int(model.sensor_type[index])).name.removeprefix("mjSENS_").lower()
    if kind not in POSITION_SENSORS:
        raise ValueError(
            f"the sensor {wanted} of {source.path} is of the kind {kind}; an output is a joint, or a sensor of the "
            f"kind {', '.join(POSITION_SENSORS)}."
        )
    at = int(model.sensor_objid[index])
    joint = int(model.actuator_trnid[at, 0]) if kind == "actuatorfrc" else at
    return OpenedOutput(wanted, joint, POSITION_SENSORS[kind])


def _refuse_foreign_files(path: Path) -> None:
    """Refuse a model that reads files outside its folder, or loads plugins.

    Raises
    ------
    ValueError
        If it does, or is no XML.
    """
    folder = path.resolve().parent
    for file, element in _elements(path, set()):
        if element.tag == "plugin":
            raise ValueError(f"{file} loads a plugin, which runs code of its own. Add --trust to allow it.")
        for attribute in FILE_ATTRIBUTES:
            named = element.get(attribute)
            if named is None:
                continue
            if named.startswith("package://"):
                named = named.removeprefix("package://")
            target = Path(os.path.normpath(folder / named))
            if not target.resolve().is_relative_to(folder):
                raise ValueError(
                    f"{file} names {named}, which is outside the folder of the model. Copy it there, or add --trust."
                )


def _elements(path: Path, seen: set[Path]) -> Iterator[tuple[Path, ElementTree.Element]]:
    """All elements of a model and of the files that it includes within its folder."""
    resolved = path.resolve()
    if resolved in seen:
        return
    seen.add(resolved)
    try:
        text = path.read_bytes()
    except OSError as error:
        raise ValueError(f"{path} cannot be read: {error}") from None
    if b"<!ENTITY" in text:
        raise ValueError(f"{path} defines entities, which a model needs not. Remove them.")
    try:
        root = ElementTree.fromstring(text)
    except ElementTree.ParseError as error:
        raise ValueError(f"{path} is no XML that can be read: {error}.") from None
    for element in root.iter():
        yield path, element
        named = element.get("file")
        if element.tag == "include" and named:
            target = path.resolve().parent / named
            if target.resolve().is_relative_to(path.resolve().parent) and target.is_file():
                yield from _elements(target, seen)
