"""A model of several joints as a compiled loop: rigid bodies, with changes of each joint and its actuator."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from math import ceil

import numpy as np

from labsid._arrays import FloatArray
from labsid.simulators.mjcf.one_joint import OUTPUTS, OneJoint, changes_in, run_loop, substeps

COLUMNS = 19
"""Of the array of links: parent, whether it slides, axis (3), anchor (3), mass, centre of mass (3), inertia about it
(xx, yy, zz, xy, xz, yz) and default position."""


@dataclass(frozen=True, slots=True, eq=False)
class Links:
    """The bodies that each joint moves and no further one, in the frame of the world at the default position.

    Attributes
    ----------
    parents : ndarray of int, shape (n,)
        The joint before each, or -1.
    slides : ndarray of bool, shape (n,)
    axes, anchors : ndarray, shape (n, 3)
        Of the joints.
    masses : ndarray, shape (n,)
    centres : ndarray, shape (n, 3)
    inertias : ndarray, shape (n, 3, 3)
        About the centres.
    positions : ndarray, shape (n,)
        Default positions of the joints.
    tips : ndarray, shape (n, 3)
        Where a load would be held.
    gravity : ndarray, shape (3,)
    """

    parents: np.ndarray
    slides: np.ndarray
    axes: FloatArray
    anchors: FloatArray
    masses: FloatArray
    centres: FloatArray
    inertias: FloatArray
    positions: FloatArray
    tips: FloatArray
    gravity: FloatArray

    def changed(self, scales: FloatArray, at_tips: FloatArray) -> FloatArray:
        """The array of the compiled loop, with scaled masses and with masses at the ends, shape (n, 19)."""
        found = np.zeros((self.masses.size, COLUMNS))
        found[:, 0], found[:, 1] = self.parents, self.slides
        found[:, 2:5], found[:, 5:8], found[:, 18] = self.axes, self.anchors, self.positions
        for i, (scale, added) in enumerate(zip(scales, at_tips, strict=True)):
            own = scale * self.masses[i]
            mass = own + added
            centre = (own * self.centres[i] + added * self.tips[i]) / mass if mass else self.centres[i]
            inertia = scale * self.inertias[i]
            for part, place in ((own, self.centres[i]), (added, self.tips[i])):
                arm = place - centre
                inertia = inertia + part * ((arm @ arm) * np.eye(3) - np.outer(arm, arm))
            found[i, 8], found[i, 9:12] = mass, centre
            found[i, 12:18] = inertia[[0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]]
        return found

    def lever(self, i: int) -> tuple[float, float]:
        """Of a unit mass at the end of link i: inertia about its joint, and the largest torque of its weight."""
        if self.slides[i]:
            return 1.0, abs(float(self.gravity @ self.axes[i]))
        arm = self.tips[i] - self.anchors[i]
        across = arm - (arm @ self.axes[i]) * self.axes[i]
        pull = self.gravity - (self.gravity @ self.axes[i]) * self.axes[i]
        return float(across @ across), float(np.linalg.norm(across) * np.linalg.norm(pull))


@dataclass(frozen=True, slots=True, eq=False)
class SeveralJoints:
    """A model of several joints, in SI units.

    Attributes
    ----------
    joints : tuple of OneJoint
        Each with its actuator, if it has one, without inertia and weight but those of the armature.
    inputs : tuple of int
        For each input, the place of the joint that its actuator moves.
    outputs : tuple of (int, str)
        For each output, the place of its joint and what of it is measured.
    names : tuple of str
        Of the outputs.
    links : Links
    """

    joints: tuple[OneJoint, ...]
    inputs: tuple[int, ...]
    outputs: tuple[tuple[int, str], ...]
    names: tuple[str, ...]
    links: Links

    @property
    def timestep(self) -> float:
        """In seconds."""
        return self.joints[0].timestep

    @property
    def place(self) -> str:
        """Where effects are put, in words."""
        return f"the joints {', '.join(one.joint for one in self.joints)}"

    @property
    def described(self) -> tuple[str, ...]:
        """What each actuator moves, and what each output is, in words."""
        moved = [self.joints[place] for place in self.inputs]
        says = [f"{one.actuator} ({one.kind}) moves the joint {one.joint}" for one in moved]
        pairs = zip(self.names, self.outputs, strict=True)
        return (*says, *(f"{name} is the {what} of {self.joints[place].place}" for name, (place, what) in pairs))

    def run(self, t: FloatArray, u: FloatArray, numbers: Mapping[str, float]) -> FloatArray:
        """Outputs for commands that are held between samples, shape (N, ny).

        Parameters
        ----------
        t : ndarray, shape (N,)
        u : ndarray, shape (N, nu)
        numbers : mapping
            Numbers of the model by name, and changes by name behind `prefix_of` their joint.
        """
        motion = self.motion(t, u, numbers)
        return np.column_stack([motion[:, place, OUTPUTS.index(what)] for place, what in self.outputs])

    def motion(self, t: FloatArray, u: FloatArray, numbers: Mapping[str, float]) -> FloatArray:
        """Position, speed and force of the actuator of each joint at each sample, shape (N, n, 3)."""
        steps = substeps(float(t[1] - t[0]) if t.size > 1 else self.timestep, self.timestep)
        changes = [changes_in(numbers, one.joint) for one in self.joints]
        commands = np.zeros((len(u), len(self.joints)))
        commands[:, self.inputs] = u
        late = [ceil(one.delay / self.timestep - 1e-9) for one in self.joints]
        if any(late):
            commands = np.repeat(commands, steps, axis=0)
            for i, count in enumerate(late):
                commands[count:, i] = commands[: len(commands) - count, i].copy()
                commands[:count, i] = commands[0, i]
        first = [one.activation(float(x), own) for one, x, own in zip(self.joints, commands[0], changes, strict=True)]
        motion = run_loop(
            commands,
            1 if any(late) else steps,
            self.timestep,
            np.array([one.position + own["start"] for one, own in zip(self.joints, changes, strict=True)]),
            np.array([own["start_speed"] for own in changes]),
            np.array(first),
            np.array([one.constants(numbers, own) for one, own in zip(self.joints, changes, strict=True)]),
            self.links.changed(
                np.array([numbers.get(f"{one.link}:mass", one.mass) / (one.mass or 1.0) for one in self.joints]),
                np.array([own["mass"] for own in changes]),
            ),
            self.links.gravity,
            [one.play(own) for one, own in zip(self.joints, changes, strict=True)],
        )
        return np.ascontiguousarray(motion[:: steps if any(late) else 1])

    def nominal(self) -> dict[str, float]:
        """Numbers of the model that may be fitted, by name."""
        return {name: value for one in self.joints for name, value in one.nominal().items()}

    def input_of(self, place: int) -> int:
        """The input of a joint's actuator; the first one for a joint without an actuator."""
        return self.inputs.index(place) if place in self.inputs else 0

    def joint(self, place: int) -> OneJoint:
        """A joint, whose end has the lever of its link."""
        inertia, weight = self.links.lever(place)
        return replace(self.joints[place], tip=(inertia, weight, 0.0, 0.0))
