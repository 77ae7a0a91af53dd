"""Another record of a course's own rig: the rig with another gain, speed and rest, and another input."""

from dataclasses import replace
from functools import lru_cache

import numpy as np

from labsid.checks.other_records.other_tanks import ShownRig, draw_apart, draw_changes
from labsid.checks.other_records.rig_model import RigModel, identify_rig, make_rig_log, rests_alike
from labsid.records.record import Record
from labsid.rig.lab.log import LabLog

_RANGE_OF_THE_TANKS = 0.6
"""Range of the input of the tanks, for which the changes of the input are made (V)."""


def make_other(own: Record, entropy: int) -> bytes:
    """Draw a record of another rig in the place of `own`; see `labsid.checks.other_records.another_record`."""
    return draw_apart(own, entropy, _draw)


def _draw(own: Record, rig: ShownRig, seed: np.random.SeedSequence) -> LabLog:
    model = _model_of(_Key(own))
    changes = draw_changes(own, rig, seed, float(np.ptp(own.u)) / _RANGE_OF_THE_TANKS)
    other = replace(
        model,
        gain=model.gain * changes.gain,
        period=model.period * changes.slower,
        u_rest=float(changes.u[0]),
        y_rest=model.y_rest + changes.y0,
        y_start=model.y_start + changes.y0,
        noise=model.noise * changes.quieter,
    )
    u_unit, y_unit = own.units
    made = make_rig_log(other, changes.u, changes.noise_seed, own.name, (u_unit, y_unit))
    if not rests_alike(made, own):
        raise ValueError("no draw began at rest as it does")
    return made


class _Key:
    """A record, equal to another with the same samples."""

    def __init__(self, record: Record) -> None:
        self.record = record
        self._samples = record.u.tobytes() + record.y.tobytes()

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _Key) and self._samples == other._samples

    def __hash__(self) -> int:
        return hash(self._samples)


@lru_cache(maxsize=8)  # each draw, and each run of a notebook, starts from the same record
def _model_of(key: _Key) -> RigModel:
    return identify_rig(key.record)
