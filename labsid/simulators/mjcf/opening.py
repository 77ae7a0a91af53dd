"""Open a model of MuJoCo: what it may read, its actuators and outputs, and errors in one line."""

import os
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

from labsid.simulators.mjcf.sources import MjcfSource

INSTALL = 'pip install "labsid[mujoco]"'
FILE_ATTRIBUTES = ("file", "meshdir", "texturedir", "assetdir", "filename")
POSITION_SENSORS = {"jointpos": "position", "jointvel": "speed", "actuatorfrc": "force", "jointactuatorfrc": "force"}


@dataclass(frozen=True, slots=True, eq=False)
class OpenedModel:
    """A model with the signals of a record.

    Attributes
    ----------
    source : MjcfSource
        With the names of its signals.
    model : mujoco.MjModel
    actuator, joint : int
        Indices.
    output : str
        "position" or "speed" of the joint, or "force" of the actuator.
    joint_name, actuator_name, link_name : str
    """

    source: MjcfSource
    model: Any
    actuator: int
    joint: int
    output: str
    joint_name: str
    actuator_name: str
    link_name: str


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
    actuator = _actuator(mujoco, model, source)
    joint, output, name = _output(mujoco, model, source, actuator)
    names = [
        mujoco.mj_id2name(model, kind, index) or f"{text} {index}"
        for kind, index, text in (
            (mujoco.mjtObj.mjOBJ_JOINT, joint, "joint"),
            (mujoco.mjtObj.mjOBJ_ACTUATOR, actuator, "actuator"),
            (mujoco.mjtObj.mjOBJ_BODY, int(model.jnt_bodyid[joint]), "body"),
        )
    ]
    known = MjcfSource(path, names[1], name, source.trusted)
    return OpenedModel(known, model, actuator, joint, output, *names)


def names_of(mujoco: Any, model: Any, kind: str) -> list[str]:
    """Names of all elements of a kind, "joint", "actuator" or "sensor"; numbers of those without a name."""
    count = {"joint": model.njnt, "actuator": model.nu, "sensor": model.nsensor}[kind]
    code = getattr(mujoco.mjtObj, f"mjOBJ_{kind.upper()}")
    return [mujoco.mj_id2name(model, code, index) or f"{kind} {index}" for index in range(count)]


def _actuator(mujoco: Any, model: Any, source: MjcfSource) -> int:
    names = names_of(mujoco, model, "actuator")
    if not names:
        raise ValueError(f"{source.path} has no actuator, so nothing takes the input. Add one, such as <motor>.")
    if not source.actuator and len(names) > 1:
        raise ValueError(f"{source.path} has {len(names)} actuators. Say which takes u: --inputs {' or '.join(names)}.")
    if source.actuator and source.actuator not in names:
        raise ValueError(f"{source.path} has no actuator {source.actuator!r}; it has {', '.join(names)}.")
    return names.index(source.actuator) if source.actuator else 0


def _output(mujoco: Any, model: Any, source: MjcfSource, actuator: int) -> tuple[int, str, str]:
    """The joint of the output, what of it is measured, and the output's name."""
    transmission = int(model.actuator_trntype[actuator])
    driven = int(model.actuator_trnid[actuator, 0])
    of_joint = (int(mujoco.mjtTrn.mjTRN_JOINT), int(mujoco.mjtTrn.mjTRN_JOINTINPARENT))
    actuator_name = names_of(mujoco, model, "actuator")[actuator]
    joints, sensors = names_of(mujoco, model, "joint"), names_of(mujoco, model, "sensor")
    if transmission not in of_joint:
        raise ValueError(f"the actuator {actuator_name} of {source.path} acts on no joint. Give one that does.")
    wanted = source.output
    if not wanted:
        wanted = joints[driven]
    if wanted in joints:
        joint, what = joints.index(wanted), "position"
    elif wanted in sensors:
        index = sensors.index(wanted)
        kind = mujoco.mjtSensor(int(model.sensor_type[index])).name.removeprefix("mjSENS_").lower()
        if kind not in POSITION_SENSORS:
            raise ValueError(
                f"the sensor {wanted} of {source.path} is of the kind {kind}; an output is a joint, or a sensor of the "
                f"kind {', '.join(POSITION_SENSORS)}."
            )
        at = int(model.sensor_objid[index])
        joint = int(model.actuator_trnid[at, 0]) if kind == "actuatorfrc" else at
        what = POSITION_SENSORS[kind]
    else:
        known = [f"joints {', '.join(joints)}", *([f"sensors {', '.join(sensors)}"] if sensors else [])]
        raise ValueError(f"{source.path} has no joint or sensor {wanted!r}; it has the {' and the '.join(known)}.")
    types = mujoco.mjtJoint
    if int(model.jnt_type[joint]) not in (int(types.mjJNT_HINGE), int(types.mjJNT_SLIDE)):
        raise ValueError(f"the joint {joints[joint]} of {source.path} is no hinge or slide. Give one that is.")
    return joint, what, wanted


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
