"""Rig parameters and input levels of a lab record: the stand-in's, or individual ones from HMAC-SHA256(secret, ID)."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TypeVar

import numpy as np

from labsid._arrays import FloatArray
from labsid.rig.lab.tanks import TankParameters
from labsid.rig.seeds import student_entropy, uniform_samples

_PLAN_STREAM = 0
_T = TypeVar("_T")


@dataclass(frozen=True, slots=True)
class LabPlan:
    """Parameters of one rig and the input of its lab record.

    Parameters
    ----------
    parameters : TankParameters
        The tanks.
    levels : tuple of float
        Input levels of the lab's record in order; the first is the rest level (V).
    starts : tuple of int
        Sample at which each level begins; the first is 0.
    entropy : int
        Seed of the rig's random numbers.
    """

    parameters: TankParameters
    levels: tuple[float, ...]
    starts: tuple[int, ...]
    entropy: int

    def seed(self, stream: int) -> np.random.SeedSequence:
        """Seed of one of the rig's independent random streams."""
        return np.random.SeedSequence(entropy=self.entropy, spawn_key=(stream,))


STAND_IN = LabPlan(
    parameters=TankParameters(),
    levels=(2.0, 1.6, 2.2, 2.0, 1.6, 2.2),
    starts=(0, 51, 251, 451, 651, 851),
    entropy=2016,
)
"""The rig of the stand-in record in `data/`."""

# Largest relative deviation of a student's parameter from the stand-in's. The plateaus are proportional to
# (pump_gain / lower_orifice)^2, so these two vary least.
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


def student_plan(student: str, secret: bytes) -> LabPlan:
    """Plan one student's record.

    Parameters
    ----------
    student : str
        The student's ID, as for `labsid.rig.seeds.student_entropy`.
    secret : bytes
        The course's secret, at least 16 bytes.

    Returns
    -------
    LabPlan

    Raises
    ------
    ValueError
        If the ID or the secret is invalid.
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


def staircase(levels: tuple[float, ...], starts: tuple[int, ...], samples: int) -> FloatArray:
    """Input that holds ``levels[i]`` (V) from sample ``starts[i]`` on; shape (samples,)."""
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
