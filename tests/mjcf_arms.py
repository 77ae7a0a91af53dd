"""Small arms in MJCF, and records of them with changes that the models do not have."""

from pathlib import Path

import numpy as np

from labsid.records.record import Record
from labsid.simulators.mjcf.one_joint import PREFIX
from labsid.simulators.mjcf.opening import open_model
from labsid.simulators.mjcf.playing import Player
from labsid.simulators.mjcf.sources import MjcfSource

TS, NOISE = 0.01, 0.01
MOTOR = '<motor name="motor" joint="elbow"/>'
SERVO = '<position name="servo" joint="elbow" kp="6" kv="0.25"/>'
SPEED = '<velocity name="drive" joint="elbow" kv="0.5"/>'
AMPLITUDES = {MOTOR: 0.9, SERVO: 1.0, SPEED: 2.0}


def arm(actuator: str = SERVO, joint: str = 'damping="0.05" armature="0.01"', option: str = "", more: str = "") -> str:
    """A link on a hinge that hangs down."""
    return f"""<mujoco>
  <option timestep="0.002" integrator="implicitfast" {option}/>
  <worldbody>
    <body name="link">
      <joint name="elbow" axis="0 1 0" {joint}/>
      <geom name="rod" type="capsule" fromto="0 0 0 0.02 0 -0.3" size="0.02" mass="0.8"/>
    </body>
  </worldbody>
  <actuator>{actuator}</actuator>{more}
</mujoco>
"""


def written(path: Path, text: str) -> Path:
    """The file, with this text in it."""
    path.write_text(text, encoding="utf-8")
    return path


def player(path: Path) -> Player:
    """The model, played by MuJoCo in this process."""
    return Player(open_model(MjcfSource(path)))


def commands(seed: int, samples: int, amplitude: float = 1.0) -> np.ndarray:
    """Random levels that are held for 0.3 s."""
    rng = np.random.default_rng(seed)
    return np.repeat(rng.uniform(-amplitude, amplitude, samples // 30 + 1), 30)[:samples]


def measured(path: Path, seed: int, samples: int = 500, amplitude: float = 1.0, **changes: float) -> Record:
    """A record of the rig: the model with changes of its joint, and noise of 1 % of the output."""
    u, t = commands(seed, samples, amplitude), TS * np.arange(samples)
    y = player(path).run(t, u, {PREFIX + name: value for name, value in changes.items()})
    rng = np.random.default_rng(1000 + seed)
    return Record(t, u, y + NOISE * np.std(y) * rng.standard_normal(samples), TS, name="run")
