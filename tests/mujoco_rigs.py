"""Rigs in MuJoCo with an effect, and the model without it that the README of labsid.gap shows."""

import re
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
README = Path(__file__).resolve().parent.parent / "labsid" / "gap" / "README.md"
TS, SAMPLES, NOISE = 0.02, 600, 0.01  # s; samples; noise over the standard deviation of the output


@dataclass(frozen=True)
class Effect:
    """What a rig has and the model lacks; its name in the report, in SI units."""

    name: str
    joint: str = ""  # attributes of the joint and of the actuator
    actuator: str = ""
    delay: float = 0.0
    cubic: float = 0.0
    load: tuple[float, float] = (0.0, 0.0)  # instant and size
    wave: tuple[float, float] = (0.0, 0.0)  # frequency and amplitude


EFFECTS = {
    "friction": Effect("coulomb-friction", joint='frictionloss=".08"'),
    "force limit": Effect("input-saturation", actuator='forcelimited="true" forcerange="-.6 .6"'),
    "delay": Effect("input-delay", delay=0.07),
    "extra lag": Effect("extra-lag", actuator='dyntype="filterexact" dynprm=".08"'),
    "spring across": Effect("cubic-stiffness", cubic=6.0),
    "load": Effect("load-step", load=(6.4, 0.25)),
    "wave": Effect("periodic-disturbance", wave=(0.9, 0.08)),
}


def example() -> str:
    """The source of the README's model."""
    found = re.search(r'```python\n("""A joint with a motor.*?)```', README.read_text(encoding="utf-8"), re.DOTALL)
    assert found is not None
    return found[1]


def load_example() -> ModuleType:
    """The README's model as a module."""
    module = ModuleType("arm")
    exec(compile(example(), "arm.py", "exec"), vars(module))
    return module


def torques(seed: int) -> Array:
    """Levels of 0.2 to 0.8 s."""
    rng = np.random.default_rng(seed)
    return np.concatenate([np.full(rng.integers(10, 40), rng.uniform(-1.0, 1.0)) for _ in range(60)])[:SAMPLES]


def angles(model: ModuleType, u: Array, effect: Effect) -> Array:
    """Angle of the joint with an effect, step by step."""
    import mujoco

    xml = model.XML.replace("<joint ", f"<joint {effect.joint} ").replace("<general ", f"<general {effect.actuator} ")
    rig = mujoco.MjModel.from_xml_string(xml)
    data = mujoco.MjData(rig)
    steps, late = round(TS / rig.opt.timestep), round(effect.delay / rig.opt.timestep)
    driven = np.concatenate([np.zeros(late), np.repeat(u, steps)])
    y = np.empty(u.size)
    (onset, size), (frequency, amplitude) = effect.load, effect.wave
    for k in range(u.size):
        y[k] = data.qpos[0]
        for torque in driven[k * steps : (k + 1) * steps]:
            data.ctrl[0] = torque
            load = size * (data.time >= onset) + amplitude * np.sin(2.0 * np.pi * frequency * data.time)
            data.qfrc_applied[0] = load - effect.cubic * data.qpos[0] ** 3
            mujoco.mj_step(rig, data)
    return y


def measured(y: Array, seed: int) -> Array:
    """The angle with noise."""
    return np.asarray(y + NOISE * np.std(y) * np.random.default_rng(seed).standard_normal(y.size))
