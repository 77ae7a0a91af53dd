"""Every student's own rig: parameters, levels and hold times from HMAC-SHA256(secret, ID)."""

import hashlib
import hmac
import unicodedata
from collections.abc import Sequence
from dataclasses import dataclass, replace
from os import PathLike
from pathlib import Path
from typing import TypeVar

import numpy as np

from labsid._arrays import FloatArray
from labsid.rig.instruments import uniform_samples
from labsid.rig.lab.tanks import TankParameters

SHORTEST_SECRET = 16
"""Bytes below which a secret can be guessed."""

_PLAN_STREAM = 0
_T = TypeVar("_T")


@dataclass(frozen=True, slots=True)
class LabPlan:
    """One rig and what is done to it.

    Parameters
    ----------
    parameters : TankParameters
        The rig.
    levels : tuple of float
        The levels of the input in the lab's record, in order; the first is the level of rest (V).
    starts : tuple of int
        The sample at which each level begins, the first at 0.
    entropy : int
        Seeds everything random about this rig.
    """

    parameters: TankParameters
    levels: tuple[float, ...]
    starts: tuple[int, ...]
    entropy: int

    def seed(self, stream: int) -> np.random.SeedSequence:
        """Seed of one of the independent random streams of this rig."""
        return np.random.SeedSequence(entropy=self.entropy, spawn_key=(stream,))


STAND_IN = LabPlan(
    parameters=TankParameters(),
    levels=(2.0, 1.6, 2.2, 2.0, 1.6, 2.2),
    starts=(0, 51, 251, 451, 651, 851),
    entropy=2016,
)
"""The rig of the record that ships."""

# How far a parameter of a student's rig may lie from the stand-in's, as a share of it. The plateaus go with
# (pump_gain / lower_orifice)^2, so the shares of these two are small.
_SPREAD = {
    "upper_area": 0.30,
    "lower_area": 0.15,
    "upper_orifice": 0.10,
    "lower_orifice": 0.06,
    "pump_gain": 0.06,
    "sensor_gain": 0.06,
    "sensor_zero": 0.12,
}
_REST = (1.95, 2.00, 2.05)
_DOWN = (0.35, 0.40, 0.45)
_UP = (0.15, 0.20, 0.25)
_FIRST_HOLD = range(47, 56)
_OTHER_HOLDS = range(195, 206)


def read_secret(path: str | PathLike[str]) -> bytes:
    """Read a course's secret from a file.

    Parameters
    ----------
    path : path
        Its white space at both ends does not count, so an editor's last line break changes no record.

    Returns
    -------
    bytes

    Raises
    ------
    OSError
        If it cannot be read.
    ValueError
        If it is empty or shorter than 16 bytes.
    """
    return _checked_secret(Path(path).read_bytes().strip(), f"the secret in {Path(path).name}")


def student_plan(student: str, secret: bytes) -> LabPlan:
    """Plan one student's record.

    Parameters
    ----------
    student : str
        The student's ID as the course writes it: ``z5000001`` and ``Z5000001`` are two. Accented letters are
        the same however the system composes them (Unicode NFC).
    secret : bytes
        The course's secret, at least 16 bytes. Whoever has it can make every student's record again.

    Returns
    -------
    LabPlan

    Raises
    ------
    ValueError
        If the ID is empty, has white space at an end or holds control characters, or the secret is too short.
    """
    plan = replace(STAND_IN, entropy=student_entropy(student, secret))
    draws = uniform_samples(plan.seed(_PLAN_STREAM), len(_SPREAD) + 8)
    spread = dict(zip(_SPREAD, draws, strict=False))
    factors = {name: 1 + share * (2 * float(spread[name]) - 1) for name, share in _SPREAD.items()}
    parameters = replace(
        STAND_IN.parameters,
        **{name: getattr(STAND_IN.parameters, name) * factor for name, factor in factors.items()},
    )
    rest, down, up, *holds = draws[len(_SPREAD) :].tolist()
    return replace(plan, parameters=parameters, levels=_levels(rest, down, up), starts=_starts(holds))


def student_entropy(student: str, secret: bytes, purpose: str = "") -> int:
    """Seed everything random about one student's rig.

    Parameters
    ----------
    student : str
        As for `student_plan`.
    secret : bytes
        As for `student_plan`.
    purpose : str
        What the rig is for: those of two purposes have nothing in common. Unless given, the lab.

    Returns
    -------
    int
        HMAC-SHA256 of the ID, as a number of 256 bits: no secret, no number.

    Raises
    ------
    ValueError
        As for `student_plan`.
    """
    # an ID holds no control character, so no ID is another purpose's
    message = f"{purpose}\0{_checked_id(student)}" if purpose else _checked_id(student)
    return int.from_bytes(hmac.digest(_checked_secret(secret, "secret"), message.encode(), hashlib.sha256), "big")


def staircase(levels: tuple[float, ...], starts: tuple[int, ...], samples: int) -> FloatArray:
    """Input that holds each of `levels` (V) from its sample in `starts` on; shape (samples,)."""
    return np.repeat(levels, np.diff([*starts, samples]))


def _levels(rest: float, down: float, up: float) -> tuple[float, ...]:
    u0 = _pick(_REST, rest)
    low, high = round(u0 - _pick(_DOWN, down), 2), round(u0 + _pick(_UP, up), 2)
    return u0, low, high, u0, low, high


def _starts(draws: list[float]) -> tuple[int, ...]:
    holds = [_pick(_FIRST_HOLD, draws[0]), *(_pick(_OTHER_HOLDS, draw) for draw in draws[1:])]
    return 0, *np.cumsum(holds).tolist()


def _pick(choices: Sequence[_T], draw: float) -> _T:
    return choices[int(draw * len(choices))]


def _checked_secret(secret: bytes, name: str) -> bytes:
    if len(secret) < SHORTEST_SECRET:
        raise ValueError(
            f"{name} must have at least {SHORTEST_SECRET} bytes; got {len(secret)}. "
            'Make one with `python -c "import secrets; print(secrets.token_hex(32))"`.'
        )
    return secret


def _checked_id(student: str) -> str:
    if not student.strip():
        raise ValueError("student must be an ID; got an empty one. Give the ID as the course writes it.")
    if student != student.strip():
        raise ValueError(f"student must have no white space at its ends; got {student!r}. Take it away.")
    for character in student:
        if unicodedata.category(character) in ("Cc", "Cf", "Cs", "Zl", "Zp"):
            raise ValueError(
                f"student must hold no control characters; got {character!r} in {student!r}. Type the ID again."
            )
    return unicodedata.normalize("NFC", student)
