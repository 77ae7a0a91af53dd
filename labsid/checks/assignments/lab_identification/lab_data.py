"""The signals and the model from which the checks of the lab and of the post-lab start."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from labsid._arrays import FloatArray, freeze
from labsid.checks.compare import as_number, as_vector
from labsid.checks.question import Ask
from labsid.checks.verdict import NoAnswer, Slip, Verdict
from labsid.lab.arx import ArxModel, arx_from_theta
from labsid.records.record import Record


@dataclass(frozen=True, slots=True, eq=False)
class LabData:
    """A record, its offsets, and its signals without them.

    Attributes
    ----------
    u_act, y_act, y_actm : ndarray, shape (N,)
        Input, noise-reduced and measured output.
    u_offset, y_offset : float
    Ts : float
        Sampling time (s).
    """

    u_act: FloatArray
    y_act: FloatArray
    y_actm: FloatArray
    u_offset: float
    y_offset: float
    Ts: float

    def __post_init__(self) -> None:
        freeze(self, u_act=self.u_act, y_act=self.y_act, y_actm=self.y_actm)

    @property
    def u(self) -> FloatArray:
        """Offset-free input."""
        return self.u_act - self.u_offset

    @property
    def y(self) -> FloatArray:
        """Offset-free output."""
        return self.y_act - self.y_offset

    @property
    def half(self) -> int:
        """First sample of the second half."""
        return int(self.y_act.size // 2)

    def wrong_signals(self) -> Iterator[tuple[str, str, FloatArray, FloatArray]]:
        """Signals that a later step may use by mistake: name of the mistake, hint, u, y."""
        u, y = self.u, self.y
        hint = "Use the offset-free `u` and `y`."
        yield "offset left in", f"The offsets are not removed. {hint}", self.u_act, self.y_act
        yield "output offset left in", f"The output offset is not removed. {hint}", u, self.y_act
        yield "input offset left in", f"The input offset is not removed. {hint}", self.u_act, y
        measured = self.y_actm - self.y_offset
        yield (
            "measured output used",
            "This is made from the measured output `y_actm`; `y` is made from `y_act`.",
            u,
            measured,
        )


def units_of(record: Record) -> tuple[str, str]:
    """Units of input and output: those that the record names, as of a course's own rig, else volts."""
    u_unit, y_unit = record.units[0], record.units[-1]
    return u_unit or "V", y_unit or "V"


def measured_output(record: Record) -> FloatArray:
    """Column 1 of a lab record."""
    return record.y if record.y_measured is None else record.y_measured


def noise_reduced_output(record: Record) -> FloatArray:
    """Column 2 of a lab record."""
    return record.y if record.y_noise_reduced is None else record.y_noise_reduced


def known_vector(ask: Ask, name: str) -> FloatArray:
    """A signal of an earlier step, shape (N,)."""
    return as_vector(name, ask.known(name))


def changed_in_place(ask: Ask, recorded: Mapping[str, FloatArray]) -> Verdict | None:
    """Whether a recorded signal is another one now: then each run of a cell gives another result."""
    for name, was in recorded.items():
        try:
            by = as_vector(name, ask.value(name), was.size) - was
        except NoAnswer:
            continue
        if np.any(by) and np.ptp(by) <= 1e-9 * np.ptp(was):
            own = name.removesuffix("_act")
            unit = units_of(ask.record)[own == "y"]
            moved = f"{abs(by[0]):.4g} {unit} {'lower' if by[0] < 0 else 'higher'}"
            return Verdict(
                False,
                f"`{name}` itself has changed since it was read: it is {moved}. `{name} -= {own}_offset` changes it, "
                f"and so does `{own} -= {own}_offset` after `{own} = {name}`; a second run of the cell starts from "
                f"there. Write `{own} = {name} - {own}_offset`, and run the cells from where the data are read again.",
                "a record changed",
            )
    return None


def taken_off_twice(name: str, raw: FloatArray, offset: float) -> Slip[FloatArray]:
    """A cell that starts from its own result, run twice."""
    return Slip(
        "offset taken off twice",
        f"`{name}_offset` is taken off `{name}` twice, as a cell with `{name} = {name} - {name}_offset` does when it "
        "is "
        f"run twice. `{name} = {name}_act - {name}_offset` gives the same, however often it is run.",
        lambda: raw - 2 * offset,
    )


def known_data(ask: Ask) -> LabData:
    """The signals after step 1c of the lab."""
    return LabData(
        u_act=known_vector(ask, "u_act"),
        y_act=known_vector(ask, "y_act"),
        y_actm=known_vector(ask, "y_actm"),
        u_offset=as_number("u_offset", ask.known("u_offset")),
        y_offset=as_number("y_offset", ask.known("y_offset")),
        Ts=as_number("Ts", ask.known("Ts")),
    )


def known_model(ask: Ask) -> ArxModel:
    """The second-order model after step 2b of the lab."""
    a1, a2, b1, b2 = (as_number(name, ask.known(name)) for name in ("a1", "a2", "b1", "b2"))
    return arx_from_theta(np.array([-a1, -a2, b1, b2]), as_number("Ts", ask.known("Ts")))
