"""Play between the process and the sensor."""

import numpy as np

from labsid._arrays import FloatArray
from labsid.gap.dynamics import _kernels
from labsid.gap.dynamics.plant_form import Parameter
from labsid.gap.effects.base import Fitted, OutputEffect, Planted, Value
from labsid.gap.effects.context import Context
from labsid.gap.effects.description import Description, Reported
from labsid.gap.effects.sketch import Sketch, same

MIN_MOVED = 0.02  # share of the record in which the sensor moves each way; set by hand
MAX_SHARE = 0.7  # width over the range of the output; set by hand


class Play(OutputEffect):
    """The sensor follows the process once the play is taken up."""

    name = "output-backlash"
    description = Description(
        path="output",
        noun="a play of the sensor",
        clauses=(
            "The sensor crosses a play of {width} at each change of direction",
            "The sensor crosses a play at each change of direction",
        ),
        meaning=(
            "After each change of direction the process moves through the play before the reading follows. Check the "
            "coupling of the sensor: gears, levers, cords and floats."
        ),
        excited_by="Slow motion with changes of direction at several levels.",
        parameters={"width": Reported("play", "y")},
        confused_with=("input-backlash", "coulomb-friction", "output-nonlinearity"),
        sketch=Sketch(
            "Output of the process",
            "y",
            "Reading",
            "y",
            lambda x, p, seen: _kernels.backlash(x, p["width"], 0.5),
            same,
            ("width",),
            loop=True,
        ),
    )
    position = 2
    planted_variants = ("",)
    whole = "y"

    @property
    def parameters(self) -> tuple[Parameter, ...]:
        """Width of the play, and initial position within it."""
        return (Parameter("width", 0.0, 4.0, leap=0.05), Parameter("position", 0.0, 1.0, 0.02))

    def starts(self, context: Context) -> list[FloatArray]:
        """Narrow to wide, with an initial position at either side and in the middle."""
        span = float(np.ptp(context.data.y[context.data.rows]))
        return [np.array([part * span, at]) for part in (0.05, 0.15, 0.3) for at in (0.5, 0.0, 1.0)]

    def apply(self, z: FloatArray, own: FloatArray) -> FloatArray:
        """Follow the process once the play is taken up."""
        return _kernels.backlash(z, float(own[0]), float(own[1]))

    def passed(self, columns: FloatArray, z: FloatArray, own: FloatArray) -> FloatArray:
        """Hold each column while the process crosses the play."""
        reading = self.apply(z, own)
        moved = np.diff(reading, prepend=reading[0]) != 0.0
        return columns[np.maximum.accumulate(np.where(moved, np.arange(z.size), 0))]

    def is_plausible(self, fit: Fitted) -> bool:
        """Require that the play is crossed both ways, and narrower than most of the range."""
        width = fit.theta_of(self)[0]
        moves = np.diff(fit.output)
        both = min(np.mean(moves > 0.0), np.mean(moves < 0.0)) > MIN_MOVED
        return bool(both and width < MAX_SHARE * fit.range)

    def values(self, fit: Fitted) -> dict[str, Value]:
        """`width` in the unit of the output."""
        return {"width": Value(float(fit.theta_of(self)[0]) * fit.data.y_scale.unit, "y")}

    def planted(self, fit: Fitted, share: float) -> list[Planted]:
        """A play up to the range of the output."""
        return [Planted("width", {"width": share * fit.range, "position": 0.5})]
