"""Records to practise with: the lab's tanks with other dimensions and levels, and a rig with an effect."""

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from labsid._arrays import FloatArray
from labsid.checks.question import Origin
from labsid.checks.values import Value
from labsid.lab.offset import find_offsets
from labsid.records.record import Record
from labsid.rig.lab.instruments import noise_reduced
from labsid.rig.lab.integration import simulate_rig
from labsid.rig.lab.plan import staircase
from labsid.rig.lab.tanks import TankParameters, steady_levels, tank_rig
from labsid.rig.switchable.withheld import WithheldRig, withheld_record, withheld_rig, withheld_validation_data

_TS = 0.75
_BEFORE = 4
_NOISE = 0.003
_SHARED = b"for practice only: known to everybody"
"""From which the rigs with an effect are made; never a course's secret."""


def tank_record(rng: np.random.Generator) -> Record:
    """A short record of the lab's tanks, settled at its start, with two steps that settle and two that need not."""
    plain = TankParameters()
    vary = {name: getattr(plain, name) * float(rng.uniform(0.9, 1.1)) for name in ("upper_area", "lower_area")}
    rig = tank_rig(replace(plain, **vary))
    rest = float(rng.choice([1.9, 2.0, 2.1]))
    first = int(rng.integers(30, 40))
    starts = (0, first, first + 180, first + 330, first + 370)
    u = staircase((rest, rest - 0.3, rest + 0.2, rest - 0.1, rest), starts, first + 400)
    running = np.concatenate([np.full(_BEFORE, u[0]), u])
    parameters = replace(plain, **vary)
    clean = simulate_rig(rig, running, _TS, steady_levels(parameters, rest)).y
    measured = clean + _NOISE * rng.standard_normal(clean.size)
    averaged = noise_reduced(measured[_BEFORE:], measured[:_BEFORE])
    t: FloatArray = _TS * np.arange(u.size, dtype=np.float64)
    return Record(
        t=t, u=u, y=averaged, Ts=_TS, y_measured=measured[_BEFORE:], y_noise_reduced=averaged, name="practice"
    )


def gap_origin(rng: np.random.Generator) -> Origin:
    """Origin of a rig with one effect."""
    return Origin(f"practice-{rng.integers(10**6)}", _SHARED)


def gap_record(rng: np.random.Generator) -> Record:
    """A record of that rig."""
    return withheld_record(_rig_of(gap_origin(rng)))


def gap_facts(origin: Origin) -> dict[str, Value]:
    """The effect of that rig, its path and its parameters."""
    return _facts(_rig_of(origin))


def _facts(rig: WithheldRig) -> dict[str, Any]:
    return {"effect": rig.effect, "path": rig.path, "parameters": dict(rig.parameters)}


def _rig_of(origin: Origin) -> WithheldRig:
    return withheld_rig(origin.student, origin.secret)


def signals_of(record: Record) -> dict[str, Value]:
    """The signals of a record, as the notebooks name them."""
    return {"t": record.t, "Ts": record.Ts, "u_act": record.u, "y_act": record.y}


def offset_free_signals_of(record: Record) -> dict[str, Value]:
    """The signals without their offsets, and the half of their length."""
    offsets = find_offsets(record.u, record.y)
    u, y = record.u - offsets.u_offset, record.y - offsets.y_offset
    return {"t": record.t, "Ts": record.Ts, "u": u, "y": y, "half": y.size // 2}


@dataclass(frozen=True, slots=True, eq=False)
class UnaidedRig:
    """A rig to analyse without steps: its `record`, the error of a simulation on another run, and its effect."""

    record: Record
    _rig: WithheldRig = field(repr=False)

    def error(self, simulate: Callable[[FloatArray], Any]) -> float:
        """Root-mean-square error (V) of `simulate(u_act)` on a run without noise that is not in the record."""
        u, y = withheld_validation_data(self._rig)
        return float(np.sqrt(np.mean((np.ravel(simulate(np.array(u))) - y) ** 2)))

    def solution(self) -> dict[str, Any]:
        """The effect, its path and its parameters."""
        return _facts(self._rig)


def unaided_rig(number: int) -> UnaidedRig:
    """The rig of a number: each has one effect of the assignment's list."""
    rig = withheld_rig(f"unaided-{number}", _SHARED)
    return UnaidedRig(withheld_record(rig), rig)
