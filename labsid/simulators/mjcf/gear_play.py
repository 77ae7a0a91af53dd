"""Play in a gear: the rotor and the link of a joint turn apart within it, as two joints of which one has stops.

The rotor keeps what the model says of the joint: its armature, damping, friction and actuator. Behind it the link turns
freely within the play, and its teeth meet at stops.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from labsid._arrays import FloatArray
from labsid.simulators.mjcf import loop_constants as at

LEAST_ROTOR = 1e-3  # of the inertia of the link: least one of a rotor; numerics
OFF_AXIS = 0.01  # of the radius of gyration: distance of the centre of a link's equivalent mass from its axis; numerics
PARENT, SLIDES, MASS, POSITION = 0, 1, 8, 18  # places in the array of links, see `several_joints.COLUMNS`
AXIS, ANCHOR, CENTRE, INERTIA = slice(2, 5), slice(5, 8), slice(9, 12), slice(12, 18)


@dataclass(frozen=True, slots=True)
class GearPlay:
    """The play in the gear of a joint.

    Attributes
    ----------
    width : float
        In rad or m; zero without a play.
    start : float
        Initial position of the link in it, from its middle.
    seen : bool
        Whether the sensor reads the link; otherwise it reads the rotor.
    armature : float
        Inertia of the rotor.
    contact : tuple of float
        Damping and stiffness of the reference acceleration where the teeth meet.
    solimp : tuple of float
        Impedance there.
    """

    width: float
    start: float = 0.0
    seen: bool = False
    armature: float = 0.0
    contact: tuple[float, float] = (0.0, 0.0)
    solimp: tuple[float, ...] = ()


NO_PLAY = GearPlay(0.0)
_Arrays = tuple[FloatArray, FloatArray, FloatArray, FloatArray, FloatArray, FloatArray, FloatArray]


def split_play(
    plays: Sequence[GearPlay],
    u: FloatArray,
    q: FloatArray,
    v: FloatArray,
    act: FloatArray,
    c: FloatArray,
    links: FloatArray,
    gravity: FloatArray,
) -> _Arrays:
    """The arguments of the compiled loop with a joint for each play, behind the joint of its rotor.

    Parameters
    ----------
    plays : sequence of GearPlay
        Of each joint.
    u, q, v, act, c, links, gravity
        As for `_joint_loop.play_compiled`.
    """
    if len(c) == 1:
        c, links, gravity = _with_link(plays[0], c, q)
    # Each joint, and behind it that of its play; where it has none, the mask leaves it out.
    kept = np.array([keep for one in plays for keep in (True, one.width > 0.0)])
    places = np.cumsum(kept) - 1
    rotors, outer = places[0::2], places[1::2]  # without a play, both are the joint itself
    doubled = [np.repeat(array, 2, axis=axis) for array, axis in ((u, 1), (q, 0), (v, 0), (act, 0), (c, 0), (links, 0))]
    for i, one in enumerate(plays):
        if not one.width:
            continue
        rotor, link = 2 * i, 2 * i + 1
        commands, positions, speeds, activations, constants, bodies = doubled
        commands[:, link] = speeds[link] = activations[link] = 0.0
        positions[link] = one.start
        positions[rotor] -= one.start if one.seen else 0.0
        constants[link] = _teeth(one, c[i])
        constants[rotor, at.INERTIA] = max(constants[rotor, at.INERTIA], LEAST_ROTOR * _about_axis(links[i]))
        bodies[rotor, MASS] = bodies[rotor, INERTIA] = 0.0
        bodies[link, POSITION] = 0.0
    for i, parent in enumerate(links[:, PARENT].astype(int)):
        doubled[5][2 * i, PARENT] = outer[parent] if parent >= 0 else -1
        doubled[5][2 * i + 1, PARENT] = rotors[i]
    whole = [np.ascontiguousarray(doubled[0][:, kept]), *(np.ascontiguousarray(array[kept]) for array in doubled[1:])]
    return whole[0], whole[1], whole[2], whole[3], whole[4], whole[5], gravity


def fold_play(plays: Sequence[GearPlay], motion: FloatArray) -> FloatArray:
    """Position, speed and force of the actuator of each joint, as its sensor reads them, shape (N, n, 3)."""
    found, place = np.empty((len(motion), len(plays), 3)), 0
    for i, one in enumerate(plays):
        found[:, i] = motion[:, place]
        if one.width and one.seen:
            found[:, i, :2] += motion[:, place + 1, :2]
        place += 2 if one.width else 1
    return found


def _teeth(play: GearPlay, own: FloatArray) -> FloatArray:
    """The constants of a joint that moves freely between two stops; `own` are those of the joint of the rotor."""
    c = np.zeros(at.COUNT)
    c[at.STRIBECK] = c[at.TIME_CONSTANT] = 1.0
    for low, high in (
        (at.CTRL_LOW, at.CTRL_HIGH),
        (at.FORCE_LOW, at.FORCE_HIGH),
        (at.ACT_LOW, at.ACT_HIGH),
        (at.JOINT_LOW, at.JOINT_HIGH),
    ):
        c[low], c[high] = -at.FREE, at.FREE
    c[at.LOW], c[at.HIGH] = -0.5 * play.width, 0.5 * play.width
    c[at.LIMIT_B], c[at.LIMIT_K] = play.contact
    c[at.D0], c[at.D1] = np.clip(play.solimp[:2], at.MIN_IMPEDANCE, at.MAX_IMPEDANCE)
    c[at.WIDTH], c[at.MID], c[at.POWER] = play.solimp[2:]
    c[at.IMPLICIT], c[at.CONSTANT] = own[at.IMPLICIT], own[at.CONSTANT]
    return c


def _about_axis(link: FloatArray) -> float:
    """Inertia of a link about the axis of its joint, or its mass on a slide."""
    if link[SLIDES]:
        return float(link[MASS])
    axis, arm = link[AXIS], link[CENTRE] - link[ANCHOR]
    (xx, yy, zz, xy, xz, yz), across = link[INERTIA], np.cross(axis, arm)
    own = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    return float(axis @ own @ axis + link[MASS] * across @ across)


def _with_link(play: GearPlay, c: FloatArray, q: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """The constants of a single joint, its link and gravity: what moves, but the rotor, becomes a body of mass 1.

    A single joint has the inertia and the weight of its link among its constants. Its axis is z, its weight acts on a
    point near the axis, and what of its weight does not depend on the position acts on link and rotor.
    """
    rotor = c.copy()
    whole = float(c[0, at.INERTIA])
    armature = max(play.armature, LEAST_ROTOR * whole)
    inertia = max(whole - armature, LEAST_ROTOR * whole)
    sine, cosine = float(c[0, at.SIN]), float(c[0, at.COS])
    rotor[0, at.INERTIA] = armature
    rotor[0, at.SIN] = rotor[0, at.COS] = 0.0
    radius, weight = OFF_AXIS * np.sqrt(inertia), float(np.hypot(sine, cosine))
    angle = float(np.arctan2(sine, -cosine))
    link = np.zeros((1, 19))
    link[0, PARENT], link[0, 4], link[0, MASS] = -1.0, 1.0, 1.0
    link[0, CENTRE] = radius * np.cos(angle), radius * np.sin(angle), 0.0
    link[0, INERTIA] = 0.0, 0.0, inertia - radius**2, 0.0, 0.0, 0.0
    return rotor, link, np.array([0.0, -weight / radius, 0.0])
