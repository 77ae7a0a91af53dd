"""A class that is stepped sample by sample as a simulation, with forces at the port of its motion.

``reset(position, speed)`` or ``reset(y0)`` begins a run, and ``step(u, force) -> y`` takes it one sample further.
Forces that depend on the motion are found within each step, from the speed at its end: `force` changes it by the
mobility.
"""

import inspect
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from math import cos, exp, isfinite, pi, sin
from typing import Any

import numpy as np

from labsid._arrays import FloatArray
from labsid.simulators.mjcf.loop_constants import FREE
from labsid.simulators.mjcf.one_joint import PREFIX, changes_in
from labsid.simulators.simulator import Simulator, SimulatorError, function_simulator

COLUMN = PREFIX + "column"
"""Among the numbers of a run: which of `COLUMNS` it returns in place of the output."""
COLUMNS = ("output", "position", "speed", "mobility")
LONGEST_UNSOLVED = 2e-3  # s: friction from the last speed is wrong by .4 % there, by 3.5 % at 10 ms
TRIAL_FORCE = 1e-3  # from which the mobility is found
DIFFERENCE_STEPS = 3  # until a difference of positions shows a force
MOST_TRIALS = 3  # of a step
SAME_SPEED = 1e-9  # of what friction can change in a step
PUSHED_OUT = 0.2  # of what is beyond a stop, in a sample
DIVERGED = 1e9
CHECKED = 50  # samples on which save and restore are checked
SAME_OUTPUT = 1e-9  # of the largest output
SPEEDS = ("speed", "velocity", "v", "v0", "dq", "qd", "qdot", "omega")  # names of a second argument of reset


@dataclass(frozen=True, slots=True)
class Stepper:
    """What a class that is stepped can do.

    Attributes
    ----------
    label : str
        What messages call it, such as ``rig.py:Rig``.
    has_motion : bool
        Whether ``motion() -> (position, speed)`` says where it is; otherwise the output is its position.
    takes_speed : bool
        Whether ``reset`` takes the speed as well.
    solver : str
        How friction is solved in a step: "restore" after a trial, with the "mobility" that the class states, or "".
    output : str
        "position", "speed" or "other".
    position : float
        Where it begins by default.
    """

    label: str
    has_motion: bool = False
    takes_speed: bool = True
    solver: str = ""
    output: str = "position"
    position: float = 0.0

    @property
    def place(self) -> str:
        """Where effects are put, in words."""
        return f"the port of {self.label}"

    def holds(self, Ts: float) -> bool:
        """Whether dry friction and stops can be put in, at a sampling time."""
        return self.has_motion and (bool(self.solver) or Ts <= LONGEST_UNSOLVED)


def callable_simulator(thing: Callable[..., Any], label: str | None = None) -> Simulator:
    """A simulation from a class, which is stepped, or from a function; errors as of either.

    Parameters
    ----------
    thing : callable
    label : str, optional
        What messages call it; by default its name.
    """
    return (stepper_simulator if inspect.isclass(thing) else function_simulator)(thing, label)


def stepper_simulator(kind: Callable[..., Any], label: str | None = None) -> Simulator:
    """A simulation from a class.

    Parameters
    ----------
    kind : class
        The keyword arguments of its constructor that have a number as default are its nominal numbers.
    label : str, optional
        What messages call it; by default its name.

    Raises
    ------
    ValueError
        If the class cannot be stepped.
    """
    label = label or kind.__name__
    nominal = _numbers(kind, label)
    stepper = Stepper(
        label,
        has_motion=callable(getattr(kind, "motion", None)),
        takes_speed=_takes_speed(kind, label),
        solver=_solver(kind, label),
    )
    _check_step(kind, label)
    checked = stepper.solver != "restore"

    def run(t: FloatArray, u: FloatArray, numbers: Mapping[str, float]) -> Any:
        nonlocal checked
        if u.ndim > 1:
            raise SimulatorError(
                f"{label} is stepped with one input; the record has {u.shape[1]}. Name it by --inputs."
            )
        h = float(t[1] - t[0]) if t.size > 1 else 1.0
        rig = kind(**{name: numbers[name] for name in nominal})
        _check_time(rig, h, label)
        playing = _Playing(stepper, rig, u.tolist(), h, changes_in(numbers))
        if not checked:
            playing.check_restore()
            checked = True
        return playing.run(COLUMNS[int(numbers.get(COLUMN, 0.0))])

    return Simulator(run, label, nominal, joint=stepper)


def _numbers(kind: Callable[..., Any], label: str) -> dict[str, float]:
    """The numbers of a class: what its constructor takes with a number as default."""
    missing = [name for name in ("reset", "step") if not callable(getattr(kind, name, None))]
    if missing:
        raise ValueError(
            f"{label} is a class without {' and '.join(missing)}. Give it reset(position, speed) and "
            "step(u, force) -> y, or name a function."
        )
    try:
        signature = inspect.signature(kind)
        signature.bind()
    except TypeError as error:
        raise ValueError(f"{label} cannot be made as {label.split(':')[-1]}(): {error}. Give defaults.") from None
    except ValueError:  # a class without a signature
        return {}
    defaults = {name: parameter.default for name, parameter in signature.parameters.items()}
    numeric = int | float | np.number
    return {name: float(x) for name, x in defaults.items() if isinstance(x, numeric) and not isinstance(x, bool)}


def _parameters(kind: Callable[..., Any], name: str) -> list[inspect.Parameter] | None:
    """Parameters of a method that are given by position, without `self`; None if unknown."""
    try:
        found = list(inspect.signature(getattr(kind, name)).parameters.values())
    except ValueError:
        return None
    if not isinstance(inspect.getattr_static(kind, name), staticmethod | classmethod):
        found = found[1:]
    if any(one.kind is one.VAR_POSITIONAL for one in found):
        return None
    return [one for one in found if one.kind in (one.POSITIONAL_ONLY, one.POSITIONAL_OR_KEYWORD)]


def _takes_speed(kind: Callable[..., Any], label: str) -> bool:
    own = _parameters(kind, "reset")
    if own is None:
        return True
    needed = [one.name for one in own if one.default is one.empty]
    if not own or len(needed) > 2:
        names = ", ".join(one.name for one in own)
        raise ValueError(f"{label} has reset({names}); it must take (position, speed), or (y0).")
    second = own[1] if len(own) > 1 else None
    return second is not None and (len(needed) == 2 or isinstance(second.default, float) or second.name in SPEEDS)


def _check_step(kind: Callable[..., Any], label: str) -> None:
    own = _parameters(kind, "step")
    if own is not None and (len(own) < 2 or sum(one.default is one.empty for one in own) > 2):
        names = ", ".join(one.name for one in own)
        raise ValueError(f"{label} has step({names}); it must take (u, force), the force at the port of its motion.")


def _solver(kind: Callable[..., Any], label: str) -> str:
    has = {name: callable(getattr(kind, name, None)) for name in ("save", "restore", "mobility")}
    if has["save"] != has["restore"]:
        there, missing = ("save", "restore") if has["save"] else ("restore", "save")
        raise ValueError(f"{label} has {there} and no {missing}. Give it both, save() and restore(state), or neither.")
    return "restore" if has["save"] else "mobility" if has["mobility"] else ""


def _check_time(rig: Any, h: float, label: str) -> None:
    """Reject a class that says that it steps another time than the record's."""
    own = getattr(rig, "Ts", None)
    if isinstance(own, int | float | np.number) and abs(own - h) > 1e-3 * h:
        raise SimulatorError(
            f"{label} steps {own:g} s (its Ts), the record {h:g} s. Set Ts, or resample the record with "
            f"--resample {own:g}."
        )


def _is_number(value: object) -> bool:
    try:
        float(value)  # type: ignore[arg-type]
    except (TypeError, ValueError):
        return False
    return not isinstance(value, str)


class _Playing:
    """One run of a class."""

    def __init__(self, stepper: Stepper, rig: Any, u: list[float], h: float, changes: Mapping[str, float]) -> None:
        self.stepper, self.rig, self.h, self.changes = stepper, rig, h, changes
        self.u = _lagged(u, h, changes) if changes["lag"] > 0.0 else u

    def run(self, column: str) -> FloatArray:
        """A column for each sample, shape (N,)."""
        changes = self.changes
        tried = any(changes[name] for name in ("friction", "peak")) or self._stops
        forced = tried or any(changes[name] for name in _FORCES)
        if column == "mobility":
            return np.full(len(self.u), self._mobility())
        if column == "output" and not forced:
            return _as_array(self._plain(), self.stepper.label)
        return _as_array(self._forced(COLUMNS.index(column), tried), self.stepper.label)

    @property
    def _stops(self) -> bool:
        return self.changes["low"] > -FREE or self.changes["high"] < FREE

    def _reset(self) -> float:
        """Begin; the first output."""
        start, label = self.changes["start"], self.stepper.label
        first = (
            self.rig.reset(start, self.changes["start_speed"]) if self.stepper.takes_speed else self.rig.reset(start)
        )
        if first is None:
            first = self._motion()[0] if self.stepper.has_motion else start
        if not _is_number(first):
            raise SimulatorError(
                f"{label}: reset returns a {type(first).__name__}; it must return y, a number, or None."
            )
        return float(first)

    def _motion(self) -> tuple[float, float]:
        found = self.rig.motion()
        if not isinstance(found, tuple | list | np.ndarray) or len(found) != 2 or not all(map(_is_number, found)):
            raise SimulatorError(f"{self.stepper.label}: motion() must return (position, speed); got {found!r:.60}.")
        return float(found[0]), float(found[1])

    def _plain(self) -> list[Any]:
        out: list[Any] = [self._reset()]
        append, step = out.append, self.rig.step
        for command in self.u[:-1]:
            append(step(command, 0.0))
        _check_output(out[-1], self.stepper.label)
        return out

    def _mobility(self) -> float:
        """Speed at the end of the first step per unit of force."""
        steps = 1 if self.stepper.has_motion else DIFFERENCE_STEPS
        speeds = []
        for force in (0.0, TRIAL_FORCE):
            q = self._reset()
            q_before = q
            for command in (self.u * DIFFERENCE_STEPS)[:steps]:
                q_before, q = q, self.rig.step(command, force)
                _check_output(q, self.stepper.label)
            speeds.append(self._motion()[1] if self.stepper.has_motion else (float(q) - float(q_before)) / self.h)
        mobility = (speeds[1] - speeds[0]) / (TRIAL_FORCE * steps)
        if not mobility > 0.0 or not isfinite(mobility):
            raise SimulatorError(
                f"{self.stepper.label}: a force at its port does not raise the speed at the end of a step. Let step "
                "add force to the forces on what moves."
            )
        return mobility

    def check_restore(self) -> None:
        """Check that a state that is restored goes on as it did.

        Raises
        ------
        SimulatorError
            If it does not.
        """
        rig, label = self.rig, self.stepper.label
        mobility = self._mobility()
        self._reset()
        for command in self.u[:CHECKED]:
            ends = []
            for force in (0.0, self.h / mobility, 0.0):
                state = rig.save()
                y = rig.step(command, force)
                _check_output(y, label)
                ends.append((float(y), *(self._motion() if self.stepper.has_motion else ())))
                rig.restore(state)
            size = max(map(abs, ends[0])) + max(map(abs, ends[1]))
            if max(abs(a - b) for a, b in zip(ends[0], ends[2], strict=True)) > SAME_OUTPUT * size:
                raise SimulatorError(
                    f"{label}: after save, step and restore, a step differs from the first one. Let save() return a "
                    "copy of all that step changes, and restore(state) set it."
                )
            rig.step(command, 0.0)

    def _forced(self, column: int, tried: bool) -> list[Any]:
        """Outputs with forces that are found within each step; or positions or speeds.

        Smooth forces are those in the middle of the step, for which the other forces are taken to be those of the last
        one. Friction and stops are corrected by what the step has shown, if it can be taken back.
        """
        rig, h, changes = self.rig, self.h, self.changes
        damping, drag, stiffness, cubic = (changes[name] for name in ("damping", "drag", "stiffness", "cubic"))
        sine, cosine, load, onset = (changes[name] for name in ("gravity_sin", "gravity_cos", "load", "onset"))
        wave_cos, wave_sin, omega = changes["wave_cos"], changes["wave_sin"], 2.0 * pi * changes["frequency"]
        friction, peak, stribeck = changes["friction"], changes["peak"], max(abs(changes["stribeck"]), 1e-9)
        low, high = changes["low"], changes["high"]
        heavy, waves, bounded = sine != 0.0 or cosine != 0.0, wave_cos != 0.0 or wave_sin != 0.0, self._stops
        reads, restores = self.stepper.has_motion, tried and self.stepper.solver == "restore"
        states = tried and self.stepper.solver == "mobility"
        m = self._mobility() if tried or damping or drag else 0.0
        first = self._reset()
        q, v = self._motion() if reads else (first, changes["start_speed"])
        out: list[Any] = [(first, q, v)[column]]
        append, step = out.append, rig.step
        motion = rig.motion if reads else None
        save, restore = (rig.save, rig.restore) if restores else (None, None)
        state: Any = None
        drift, held, below, above = 0.0, 0.0, -FREE, FREE  # drift: change of the speed by all other forces
        for k in range(len(self.u) - 1):
            command = self.u[k]
            if states:
                m = rig.mobility()
            at = q + 0.5 * h * v
            force = -at * (stiffness + cubic * at * at)
            if heavy:
                force += sine * sin(at) + cosine * cos(at)
            if load:
                force += load * min(max(k + 1.0 - onset / h, 0.0), 1.0)
            if waves:
                angle = omega * h * (k + 0.5)
                force += wave_cos * cos(angle) + wave_sin * sin(angle)
            loss = damping + drag * abs(v)
            if loss:
                force = (force - loss * (v + 0.5 * drift)) / max(1.0 + 0.5 * loss * m, 0.1)
            held = 0.0
            if tried:
                most = m * (friction + peak * exp(-((v / stribeck) ** 2)) if peak else friction)
                if bounded:
                    distance = high - q
                    above = max(2.0 * distance / h - v, 0.0) if distance > 0.0 else PUSHED_OUT * distance / h
                    distance = low - q
                    below = min(2.0 * distance / h - v, 0.0) if distance < 0.0 else PUSHED_OUT * distance / h
                free = v + drift + m * force
                held = (min(max(_slowed(v, free - v, most), below), above) - free) / m
                if save is not None:
                    state = save()
            y = step(command, force + held)
            if motion is not None:
                after, fast = motion()
            else:
                after, fast = y, (y - q) / h
            if restore is not None:
                for _ in range(MOST_TRIALS):
                    free = fast - m * held
                    end = min(max(_slowed(v, free - v, most), below), above)
                    if abs(end - fast) <= SAME_SPEED * (most + abs(end - free)):
                        break
                    corrected, fast_before = (end - free) / m, fast
                    restore(state)
                    y = step(command, force + corrected)
                    after, fast = motion()  # type: ignore[misc]
                    mobility = (fast - fast_before) / (corrected - held) if corrected != held else m
                    held = corrected
                    if 0.1 * m < mobility < 10.0 * m:
                        most *= mobility / m
                        m = mobility
            drift = fast - v - m * (force + held)
            q, v = after, fast
            if not -DIVERGED < q < DIVERGED:
                out += [np.nan] * (len(self.u) - len(out))
                return out
            append(y if not column else q if column == 1 else v)
        return out


_FORCES = (
    "damping",
    "drag",
    "stiffness",
    "cubic",
    "gravity_sin",
    "gravity_cos",
    "load",
    "wave_cos",
    "wave_sin",
)
"""Changes that are forces at the port, friction and stops excepted."""


def _slowed(v: float, change: float, most: float) -> float:
    """Speed at the end of a step with dry friction, which turns with the motion within it.

    `change` is that of the speed by all other forces, and `most` the largest one by friction.
    """
    if v < 0.0:
        return -_slowed(-v, -change, most)
    if v == 0.0:
        return change - most if change > most else change + most if change < -most else 0.0
    end = v + change - most
    if end >= 0.0 or not most:
        return end
    return 0.0 if change >= -most else (change + most) * (1.0 - v / (most - change))


def _lagged(u: list[float], h: float, changes: Mapping[str, float]) -> list[float]:
    """The command behind a lag, as its mean over each sample."""
    tau = changes["lag"]
    left = exp(-h / tau)
    level, mean, found = u[0] + changes["start_lag"], tau / h * (1.0 - left), []
    for command in u:
        found.append(command + (level - command) * mean)
        level = command + (level - command) * left
    return found


def _check_output(y: object, label: str) -> None:
    if y is None or not _is_number(y):
        what = "nothing" if y is None else f"a {type(y).__name__}"
        raise SimulatorError(f"{label}: step returns {what}; it must return the output, one number.")


def _as_array(values: list[Any], label: str) -> FloatArray:
    try:
        return np.array(values, float)
    except (TypeError, ValueError):
        bad = next((y for y in values if not _is_number(y)), values)
        raise SimulatorError(f"{label}: step returns a {type(bad).__name__}; it must return one number.") from None
