"""Effects planted in arms in MuJoCo, their models without them: what is named and where, and the second record.

python tests/bars_inside.py [ACTUATOR[:EFFECT] ...]        (position, velocity, torque; all by default)
python tests/bars_inside.py 2|3[:ACTUATOR[:EFFECT]] ...     (arms of two and three joints, position and torque)
"""

import sys
import tempfile
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from time import process_time

import numpy as np
from mjcf_arms import (
    AMPLITUDES,
    ANGLES,
    MOTOR,
    NAMES,
    NOISE,
    SERVO,
    SPEED,
    TORQUES,
    arm,
    as_logged,
    behind_play,
    beyond_band,
    chain,
    geared,
    late,
    limited,
    measured,
    measured_chain,
    written,
)

from labsid.gap.diagnosis import diagnose
from labsid.gap.signals.preparation import prepare
from labsid.simulators.process import open_in_process

ACTUATORS = {"position": SERVO, "velocity": SPEED, "torque": MOTOR}
SAMPLES = 1500
START = 50  # samples that determine the initial state
PLANTED: dict[str, tuple[str | None, dict[str, float]]] = {
    "nothing": (None, {}),
    "friction": ("coulomb-friction", {"friction": 0.12}),
    "friction with the load": ("coulomb-friction", {"friction": 0.03, "transmitted": 0.2}),
    "break-away": ("coulomb-friction", {"friction": 0.08, "peak": 0.06, "stribeck": 0.15}),
    "drag": ("quadratic-drag", {"drag": 0.03}),
    "damping": ("parameter-mismatch", {"damping": 0.06}),
    "armature": ("parameter-mismatch", {"armature": 0.015}),
    "gravity": ("gravity", {"gravity_sin": 0.8}),
    "payload": ("parameter-mismatch", {"mass": 0.3}),
    "cubic spring": ("cubic-stiffness", {"cubic": 1.0}),
    "spring": ("parameter-mismatch", {"stiffness": 0.8}),
    "stop": ("end-stop", {"high": 0.5}),
    "force limit": ("force-limit", {"limit": 0.6}),
    "lag": ("extra-lag", {"lag": 0.05}),
    "load": ("load-step", {"load": 0.2, "onset": 6.4}),
    "wave": ("periodic-disturbance", {"wave_cos": 0.1, "frequency": 0.9}),
    "gain": ("parameter-mismatch", {"gain": 0.2}),
}


@dataclass(frozen=True, slots=True)
class AtJoints:
    """Effects in an arm of several joints.

    Attributes
    ----------
    truth : set of (str, str)
        Names, and the joint or the actuator of each.
    changes : dict
        By names such as ``elbow:friction``.
    command : callable
        What acts at the elbow, as a function of its command over the amplitude of that.
    gear : float
        Width of a play in the gear of the elbow, in rad.
    seen : bool
        Whether the sensor of the elbow reads its link, behind that play.
    only : str
        Kind of actuator that shows it.
    """

    truth: frozenset[tuple[str, str]] = frozenset()
    changes: dict[str, float] = field(default_factory=dict)
    command: Callable[[np.ndarray], np.ndarray] = as_logged
    gear: float = 0.0
    seen: bool = False
    only: str = ""


def _one(name: str, joint: str, only: str = "", **changes: float) -> AtJoints:
    return AtJoints(frozenset({(name, joint)}), {f"{joint}:{key}": x for key, x in changes.items()}, only=only)


def _two(first: tuple[str, str], second: tuple[str, str], **changes: float) -> AtJoints:
    """Two effects, with a change for each."""
    joints = (first[1], second[1])
    named = {f"{joint}:{key}": x for joint, (key, x) in zip(joints, changes.items(), strict=True)}
    return AtJoints(frozenset({first, second}), named)


AT_JOINTS: dict[str, AtJoints] = {
    "nothing": AtJoints(),
    "friction": _one("coulomb-friction", "elbow", friction=0.08),
    "friction before": _one("coulomb-friction", "shoulder", friction=0.15),
    "damping": _one("parameter-mismatch", "elbow", damping=0.05),
    "armature": _one("parameter-mismatch", "elbow", armature=0.02),
    "gravity": _one("gravity", "shoulder", gravity_sin=0.8),
    "payload": _one("parameter-mismatch", "elbow", mass=0.2),
    "stop": _one("end-stop", "elbow", high=0.4),
    "force limit": _one("force-limit", "elbow", only="position", limit=0.8),
    "drag": _one("quadratic-drag", "elbow", drag=0.03),
    "cubic spring": _one("cubic-stiffness", "shoulder", cubic=1.5),
    "gain": _one("parameter-mismatch", "elbow", gain=0.2),
    "lag": _one("extra-lag", "elbow", lag=0.05),
    "load": _one("load-step", "elbow", load=0.2, onset=6.4),
    "wave": _one("periodic-disturbance", "shoulder", wave_cos=0.25, frequency=0.9),
    "delay": AtJoints(frozenset({("input-delay", "elbow")}), command=partial(late, samples=3)),
    "limit of the command": AtJoints(frozenset({("input-saturation", "elbow")}), command=partial(limited, limit=0.6)),
    "dead zone": AtJoints(frozenset({("input-dead-zone", "elbow")}), command=partial(beyond_band, half=0.2)),
    "play of the command": AtJoints(
        frozenset({("input-backlash", "elbow")}), command=partial(behind_play, width=0.2), only="position"
    ),
    "play in the gear": AtJoints(frozenset({("input-backlash", "elbow")}), gear=0.1),
    "play that the sensor sees": AtJoints(frozenset({("input-backlash", "elbow")}), gear=0.1, seen=True),
    "friction and damping": _two(
        ("coulomb-friction", "elbow"), ("parameter-mismatch", "shoulder"), friction=0.08, damping=0.15
    ),
    "friction and payload": _two(
        ("coulomb-friction", "shoulder"), ("parameter-mismatch", "elbow"), friction=0.2, mass=0.2
    ),
    "friction and stop": _two(("coulomb-friction", "elbow"), ("end-stop", "elbow"), friction=0.08, high=0.4),
    "friction and delay": replace(
        _one("coulomb-friction", "elbow", friction=0.08),
        truth=frozenset({("coulomb-friction", "elbow"), ("input-delay", "elbow")}),
        command=partial(late, samples=3),
    ),
    "friction before a delay": replace(
        _one("coulomb-friction", "shoulder", friction=0.2),
        truth=frozenset({("coulomb-friction", "shoulder"), ("input-delay", "elbow")}),
        command=partial(late, samples=3),
    ),
}


def main() -> None:
    wanted = sys.argv[1:]
    several = [one for one in wanted if one[0] in "23"] if wanted else ["2", "3"]
    with tempfile.TemporaryDirectory() as folder:
        alone = [one for one in wanted if one not in several] if wanted else list(ACTUATORS)
        for title, rows in (
            ("one joint", one_joint(Path(folder), alone)),
            ("several joints", several_joints(Path(folder), several)),
        ):
            found = list(rows)
            if found:
                errors = [error for _, error in found]
                right = sum(named for named, _ in found)
                share = f"{right} of {len(found)} ({right / len(found):.0%}, must 92 %)"
                print(f"{title}: {share} named; largest error on a second record {max(errors):.3f} (must 1.2)")


def one_joint(folder: Path, wanted: list[str]) -> Iterator[tuple[bool, float]]:
    """Whether the effect is named, and the error of the mended model on a second record over the noise."""
    for kind, actuator in ACTUATORS.items():
        model = written(folder / f"{kind}.xml", arm(actuator))
        for what, (name, changes) in PLANTED.items():
            if not {kind, f"{kind}:{what}"} & set(wanted) or (what == "force limit" and kind == "torque"):
                continue
            first, second = (measured(model, n, SAMPLES, AMPLITUDES[actuator], **changes) for n in (1, 2))
            begun = process_time()
            found = diagnose(first, open_in_process(str(model)))
            seconds = process_time() - begun
            y = found.model.simulate(second.u, second.y, of_record=True)  # load and wave act at the same times
            error = np.sqrt(np.mean((y - second.y)[START:] ** 2)) / (NOISE * np.std(second.y))
            named = [(e["name"], e.get("joint"), round(e["probability"], 2)) for e in found.report["effects"]]
            print(f"{kind:9s}{what:23s}{named}  second record {error:.3f}  {seconds:.1f} s", flush=True)
            yield [one[0] for one in named] == ([] if name is None else [name]), float(error)


def several_joints(folder: Path, wanted: list[str]) -> Iterator[tuple[bool, float]]:
    """The same for arms of two and three joints: effects with their joints, and the largest error of an output."""
    for count in (2, 3):
        for kind, amplitudes in (("torque", TORQUES), ("position", ANGLES)):
            model = written(folder / f"{count}{kind}.xml", chain(count, {"torque": "motor"}.get(kind, kind)))
            for what, planted in AT_JOINTS.items():
                names = {f"{count}", f"{count}:{kind}", f"{count}:{kind}:{what}"}
                if not names & set(wanted) or planted.only not in ("", kind):
                    continue
                text = model.read_text(encoding="utf-8")
                rig = written(folder / "rig.xml", geared(text, "elbow", planted.gear) if planted.gear else text)
                changes = {f"inside {name}": x for name, x in planted.changes.items()}
                first, second = (
                    measured_chain(rig, n, SAMPLES, amplitudes, planted.command, planted.seen, **changes)
                    for n in (1, 2)
                )
                begun = process_time()
                found = diagnose(first, open_in_process(str(model)))
                seconds = process_time() - begun
                y = found.mended.simulate(prepare(second).signals, of_record=True)
                error = np.sqrt(np.mean((y - second.y)[START:] ** 2, axis=0)) / (NOISE * np.std(second.y, axis=0))
                joints = {one: next(name for name in NAMES if one.startswith(name)) for one in first.inputs}
                named = {
                    (e["name"], e.get("joint") or joints[e["signal"]]): round(e["probability"], 2)
                    for e in found.report["effects"]
                }
                print(
                    f"{count} {kind:9s}{what:23s}{named}  second record {error.max():.3f}  {seconds:.0f} s "
                    f"{found.report['simulation']['evaluations']['runs']} runs",
                    flush=True,
                )
                yield set(named) == planted.truth, float(error.max())


if __name__ == "__main__":
    main()
