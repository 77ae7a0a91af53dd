"""Another record in the place of a student's own, on which an answer that follows from the data is right, too.

Grading runs a notebook on records that nobody has seen, with seeds from the course's secret; in the notebook, a check
tries a public one where a value was typed in. A record is drawn decisively and fairly. Values of the student's own
record are wrong on it by three tolerances. It is no harder: of the same length and sampling time, with the same kind of
start, no more noise, and as many steps of the input, none of them smaller.
"""

from collections.abc import Callable, Mapping
from importlib import import_module

from labsid.records.record import Record
from labsid.rig.switchable.withheld_effects import RECORD_FILE as WITHHELD_FILE

LAB_FILE = "SysIdenData_StudentVersion.mat"

_MAKERS: Mapping[str, str] = {LAB_FILE: "other_tanks", WITHHELD_FILE: "other_withheld_rig"}
"""Module with the function ``make_other(own, entropy)``, by the name of the data file."""


def can_be_drawn(name: str) -> bool:
    """Whether there are other records in the place of the data file of that name."""
    return name in _MAKERS


def another_record(name: str, own: Record, entropy: int) -> bytes:
    """Draw another record, as a file that takes the place of a student's own.

    Parameters
    ----------
    name : str
        Name of the data file beside the notebook.
    own : Record
        The student's own record.
    entropy : int
        Seed; equal seeds give equal records.

    Returns
    -------
    bytes

    Raises
    ------
    ValueError
        If there are no other records of that name, or none can be drawn for this own record.
    """
    if name not in _MAKERS:
        raise ValueError(f"there are no other records in the place of {name}, only of {', '.join(_MAKERS)}.")
    maker = "other_rig" if name == LAB_FILE and any(own.units) else _MAKERS[name]
    make: Callable[[Record, int], bytes] = import_module(f"{__name__}.{maker}").make_other
    return make(own, entropy)
