"""How a log is to be read: what the caller decides where a file can be read in two ways."""

from dataclasses import dataclass

import numpy as np

from labsid.records.units import SECONDS

OUTPUTS = ("noise-reduced", "measured")
REPEATS = ("first", "last")


@dataclass(frozen=True, slots=True)
class Reading:
    """How a log is to be read; see `labsid.records.record.load_record`.

    Attributes
    ----------
    columns : str or None
    Ts : float or None
    output : {"noise-reduced", "measured"}
    time_unit : str or None
        A key of `labsid.records.units.SECONDS`.
    repeated : {"first", "last"} or None
    select : int or None
    since, until : float or None
        Times in seconds.
    resample : float or None
    decimate : int or None
    inputs, outputs : str or None
        Columns of several signals, with commas between them.
    reference : str or None

    Raises
    ------
    ValueError
        If a value is out of range.
    """

    columns: str | None = None
    Ts: float | None = None
    output: str = "noise-reduced"
    time_unit: str | None = None
    repeated: str | None = None
    select: int | None = None
    since: float | None = None
    until: float | None = None
    resample: float | None = None
    decimate: int | None = None
    inputs: str | None = None
    outputs: str | None = None
    reference: str | None = None

    def __post_init__(self) -> None:
        for name, allowed in (("output", OUTPUTS), ("repeated", REPEATS), ("time_unit", tuple(SECONDS))):
            value = getattr(self, name)
            if value is not None and value not in allowed:
                raise ValueError(f"{name} must be {' or '.join(allowed)}; got {value!r}.")
        if (self.inputs or self.outputs) and "," in (self.columns or ""):
            raise ValueError(
                f"columns must name the times alone where inputs or outputs are named; got {self.columns!r}. Leave it "
                "out, or give one input and one output as columns t,u,y."
            )
        for name in ("Ts", "resample"):
            value = getattr(self, name)
            if value is not None and not 0 < value < np.inf:
                raise ValueError(f"{name} must be a positive number of seconds; got {value:g}.")
        for name, least in (("select", 1), ("decimate", 2)):
            value = getattr(self, name)
            if value is not None and value < least:
                raise ValueError(f"{name} must be a whole number of at least {least}; got {value}.")
        if self.since is not None and self.until is not None and not self.since < self.until:
            raise ValueError(f"since (--from) must be before until (--to); got {self.since:g} and {self.until:g} s.")
        if self.Ts is not None and self.resample is not None:
            raise ValueError(
                "Ts says that the samples are even, resample that they are not. Give the one that is true of the log."
            )
