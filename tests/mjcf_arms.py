"""Small arms in MJCF, and records of them with changes that the models do not have."""

import re
from collections.abc import Callable
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


NAMES = ("shoulder", "elbow", "wrist")
LENGTHS, MASSES = (0.3, 0.25, 0.15), (0.9, 0.6, 0.3)
DAMPINGS, ARMATURES = (0.12, 0.06, 0.03), (0.02, 0.01, 0.005)
TORQUES = (1.5, 0.6, 0.15)  # N m: amplitudes of the commands of a motor
ANGLES = (0.8, 0.8, 0.6)  # rad: of a servo
GAINS = (14.0, 7.0, 2.5)  # N m/rad: of a servo


def chain(count: int, kind: str = "motor", option: str = "") -> str:
    """An arm of two or three links that hangs down, its last joint across the plane of the others."""
    body = ""
    for i in reversed(range(count)):
        at = f"0 0 {-LENGTHS[i - 1]}" if i else "0 0 0"
        axis = "1 0 0" if i == 2 else "0 1 0"
        body = f"""<body name="link{i + 1}" pos="{at}">
      <joint name="{NAMES[i]}" axis="{axis}" damping="{DAMPINGS[i]}" armature="{ARMATURES[i]}"/>
      <geom type="capsule" fromto="0 0 0 0.02 0 {-LENGTHS[i]}" size="0.02" mass="{MASSES[i]}"
            contype="0" conaffinity="0"/>
      {body}
    </body>"""
    actuators = {
        "motor": '<motor name="{0}-motor" joint="{0}"/>',
        "position": '<position name="{0}-servo" joint="{0}" kp="{1}" kv="{2}"/>',
    }[kind]
    driven = "".join(actuators.format(NAMES[i], GAINS[i], 0.04 * GAINS[i]) for i in range(count))
    return f"""<mujoco>
  <option timestep="0.002" integrator="implicitfast" {option}/>
  <worldbody>{body}</worldbody>
  <actuator>{driven}</actuator>
</mujoco>
"""


def geared(text: str, joint: str, width: float, contact: float = 0.006) -> str:
    """A model with a play of this width in the gear of a joint: a second joint behind it, between stops."""
    own = re.search(f'<joint name="{joint}" ([^>]*?)(damping|armature)=[^>]*/>', text)
    assert own is not None
    half = 0.5 * (width if 'type="slide"' in own[1] else np.degrees(width))
    stops = f'range="{-half} {half}" limited="true" solreflimit="{contact} 1"'
    return text.replace(own[0], f'{own[0]}<joint name="{joint}-play" {own[1]}{stops}/>')


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


def as_logged(u: np.ndarray) -> np.ndarray:
    """The command itself."""
    return u


def late(u: np.ndarray, samples: int) -> np.ndarray:
    """The command, that acts some samples later."""
    return np.concatenate([np.full(samples, u[0]), u])[: u.size]


def limited(u: np.ndarray, limit: float) -> np.ndarray:
    """The command, that goes no higher."""
    return np.minimum(u, limit)


def beyond_band(u: np.ndarray, half: float) -> np.ndarray:
    """The command beyond a dead zone about zero."""
    return np.asarray(np.sign(u) * np.maximum(np.abs(u) - half, 0.0))


def behind_play(u: np.ndarray, width: float) -> np.ndarray:
    """What follows a signal behind a play, from its middle on."""
    out = np.empty(u.size)
    at = u[0]
    for k, x in enumerate(u):
        at = min(max(at, x - 0.5 * width), x + 0.5 * width)
        out[k] = at
    return out


def measured_chain(
    path: Path,
    seed: int,
    samples: int = 500,
    amplitudes: tuple[float, ...] = TORQUES,
    command: Callable[[np.ndarray], np.ndarray] = as_logged,
    seen: bool = False,
    **changes: float,
) -> Record:
    """A record of the same for several joints; changes by names such as ``inside elbow:friction``.

    What acts at the second joint is its `command`, a function of the logged one over its amplitude. The outputs are the
    joints with actuators; if `seen`, with a play in the gear of one.
    """
    rig = player(path)
    driven = rig.opened.inputs
    count = len(driven)
    u = np.column_stack([commands(100 * seed + i, samples, amplitudes[i]) for i in range(count)])
    t = TS * np.arange(samples)
    acting = u.copy()
    acting[:, 1] = amplitudes[1] * command(u[:, 1] / amplitudes[1])
    position = rig.play(t, acting, changes)[0][:, :, 0]
    y = position[:, driven]
    for place in set(range(len(rig.joints))) - set(driven) if seen else ():
        y[:, driven.index(place - 1)] += position[:, place]
    rng = np.random.default_rng(1000 + seed)
    noisy = y + NOISE * np.std(y, axis=0) * rng.standard_normal(y.shape)
    inputs = tuple(rig.opened.joints[place].actuator_name for place in driven)
    return Record(t, u, noisy, TS, name="run", inputs=inputs, outputs=NAMES[:count])
