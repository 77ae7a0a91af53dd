"""Effects of the sensor, between the true output and the record."""

from collections.abc import Mapping
from typing import ClassVar

import numpy as np
from numpy.polynomial.chebyshev import chebvander

from labsid._arrays import FloatArray
from labsid.gap.dynamics.plant_form import Parameter
from labsid.gap.dynamics.plants import Plant
from labsid.gap.dynamics.responses import normalized_time
from labsid.gap.effects import curves
from labsid.gap.effects.base import (
    RARE,
    REST_SAMPLES,
    AdditiveEffect,
    Fitted,
    OutputEffect,
    Planted,
    Value,
)
from labsid.gap.effects.context import Context, ParentFit, Structure
from labsid.gap.effects.description import Description, Reported
from labsid.gap.effects.limits import Limits
from labsid.gap.effects.sketch import Seen, Sketch, around_y, bent, clipped, ends_of, same

NEARLY_ZERO = 1e-3  # of the spread of y: what is less may be the floor of `fits.floor`; set by hand
HIDDEN = 20.0  # scaled: largest excursion beyond a limit, where an initial state could hide for any time; set by hand
CURVE_RANGE = (-20.0, 20.0)  # scaled output; outside it the curve continues with slope one; set by hand


class Saturation(Limits, OutputEffect):
    """The sensor saturates; `variant` low, high or both."""

    name = "output-saturation"
    description = Description(
        path="output",
        noun="a clipping sensor",
        clauses=(
            "The sensor clips below {low} and above {high}",
            "The sensor clips below {low}",
            "The sensor clips above {high}",
            "The sensor clips at the end of its range",
        ),
        meaning=(
            "The process continues beyond the limit of the reading. Check the ranges of the sensor and of the "
            "converter."
        ),
        excited_by="Outputs beyond the range of the sensor, and back.",
        parameters={
            "low": Reported("lower limit", "y", position=True),
            "high": Reported("upper limit", "y", position=True),
        },
        confused_with=("input-saturation", "overflow", "output-nonlinearity"),
        stops=True,
        bends_reading=True,
        sketch=Sketch(
            "Output without the limit",
            "y",
            "Reading",
            "y",
            clipped,
            same,
            ("low", "high"),
            ("low", "high"),
            reach=around_y,
        ),
    )
    signal, leap = "y", 0.03
    further: ClassVar[dict[str, tuple[str, ...]]] = {"low": ("both",), "high": ("both",)}
    position = 2
    is_limit = True
    planted_variants = ("high", "low")
    whole = "y"

    def starts(self, context: Context) -> list[FloatArray]:
        """Quantiles of the output."""
        y = context.data.y[context.data.rows]
        return self.between(np.quantile(y, (0.02, 0.1, 0.25)), np.quantile(y, (0.98, 0.9, 0.75)))

    def carry_over(self, fit: ParentFit, hypothesis: Structure, theta: FloatArray) -> None:
        """Begin a second limit where the output seldom is."""
        if self.variant == "both" and self not in fit.hypothesis.effects:
            missing = 0 if Saturation("high") in fit.hypothesis.effects else 1
            theta[hypothesis.slices[self.key]][missing] = np.quantile(fit.output, (RARE, 1.0 - RARE)[missing])

    def apply(self, z: FloatArray, own: FloatArray) -> FloatArray:
        """Clip at the limits; far beyond them, where nothing can be hidden, the reading continues with slope one."""
        low, high = self.ends(own)
        return np.clip(z, low, high) + (z - np.clip(z, low - HIDDEN, high + HIDDEN))

    def slope(self, z: FloatArray, own: FloatArray) -> FloatArray:
        """One between the limits and far beyond them, zero outside."""
        low, high = self.ends(own)
        return ((z > low) & (z < high) | (z < low - HIDDEN) | (z > high + HIDDEN)).astype(float)

    def is_plausible(self, fit: Fitted) -> bool:
        """Reject a limit that the sensor exceeds while the rig is off and reads zero: zero is the true value then."""
        reading = np.asarray(fit.data.y_scale.back(fit.data.y[:REST_SAMPLES]))
        if not fit.starts_at_rest or np.any(np.abs(reading) > NEARLY_ZERO * fit.data.y_scale.unit):
            return True
        return not self.active_samples(fit)[:REST_SAMPLES].any()

    def active_samples(self, fit: Fitted) -> np.ndarray:
        """The samples at which the simulated reading is at a limit."""
        low, high = self.ends(fit.theta_of(self))
        output = fit.output
        return np.asarray((output <= low) | (output >= high))


def _folded(p: Mapping[str, float], seen: Seen) -> tuple[float, float]:
    """The range of y, and its reflection at the fold."""
    low, high = ends_of(seen.y)
    return (2.0 * p["fold"] - high, high) if "fold" in p else (low, high)


class Nonlinearity(curves.Curve, OutputEffect):
    """A smooth static sensor curve: y = z + c2 z^2 + c3 z^3 about the mean output of the record.

    The `variant` "rich" is a spline.
    """

    name = "output-nonlinearity"
    description = Description(
        path="output",
        noun="a curved characteristic of the sensor",
        clauses=(
            "The sensor reads how far the output is from {fold}, but not on which side",
            "The gain of the sensor changes over its range",
        ),
        meaning=(
            "The same change of the process gives a larger reading in one part of the range than in another. Check "
            "the calibration. A pulse counter, for example, reads the absolute value of a speed. With d the true "
            "output minus the centre of the curve, the sensor reads d + (quadratic coefficient) d² + (cubic "
            "coefficient) d³."
        ),
        excited_by="Outputs over the whole range, reached slowly and fast.",
        parameters={
            "c2": Reported("quadratic coefficient", "1/y"),
            "c3": Reported("cubic coefficient", "1/y^2"),
            "centre": Reported("centre of the curve", "y", position=True),
            "fold": Reported("lowest reading, at which the sign is lost", "y", position=True),
        },
        confused_with=("input-nonlinearity", "sqrt-outflow", "cubic-stiffness"),
        smooth_law=True,
        bends_reading=True,
        sketch=Sketch(
            "Output of the process",
            "y",
            "Reading",
            "y",
            lambda x, p, seen: p["fold"] + np.abs(x - p["fold"]) if "fold" in p else bent(x, p, seen),
            same,
            ("c2", "fold"),
            ("fold",),
            reach=_folded,
        ),
    )
    position = 1
    signal = whole = "y"

    def starts(self, context: Context) -> list[FloatArray]:
        """Small positive and negative values of either coefficient."""
        return [np.array(pair) for pair in ((0.05, 0.0), (-0.05, 0.0), (0.0, 0.03), (0.0, -0.03))]

    def apply(self, z: FloatArray, own: FloatArray) -> FloatArray:
        """Value of the curve; far outside the record it continues with slope one."""
        near = np.clip(z, *CURVE_RANGE)
        return z - near + curves.evaluate(near, own)

    def slope(self, z: FloatArray, own: FloatArray) -> FloatArray:
        """Derivative of the curve."""
        return curves.slope(np.clip(z, *CURVE_RANGE), own)


class Drift(AdditiveEffect):
    """A slow drift of the sensor zero: a polynomial of the degree in `variant`, or an exponential decay, "settle"."""

    name = "output-drift"
    description = Description(
        path="output",
        noun="a drift of the sensor",
        clauses=(
            "The zero of the sensor drifts by ±{amplitude}",
            "The zero of the sensor drifts",
        ),
        meaning=(
            "The reading changes slowly, independent of the command. Check warm-up, temperature and the sensor's "
            "supply."
        ),
        excited_by="A long record with stretches at the same input.",
        parameters={"amplitude": Reported("amplitude", "y")},
        confused_with=("parameter-drift", "load-step"),
        of_one_record=True,
        wanders=True,
    )
    variants = ("1", "3", "6", "10", "16", "settle")
    planted_variants = ("3",)
    whole = "y"

    @property
    def width(self) -> int:
        """One column for "settle", else one for each degree."""
        return 1 if self.variant == "settle" else int(self.variant)

    @property
    def parameters(self) -> tuple[Parameter, ...]:
        """For "settle", the logarithm of the time constant as a share of the record."""
        return (Parameter("log_share", -4.0, 0.0),) if self.variant == "settle" else ()

    def starts(self, context: Context) -> list[FloatArray]:
        """Short to long time constants for "settle"."""
        if self.variant == "settle":
            return [np.array([np.log(share)]) for share in (0.05, 0.2, 0.6)]
        return [np.zeros(0)]

    def columns(self, own: FloatArray, samples: int, span: int, plant: Plant, rates: FloatArray) -> FloatArray:
        """Chebyshev polynomials of degree 1, 2, ... along the record, or an exponential decay."""
        if self.variant == "settle":
            return np.exp(-np.arange(samples) / (span * np.exp(own[0])))[:, None]
        return np.asarray(chebvander(normalized_time(samples, span), int(self.variant))[:, 1:], np.float64)

    def values(self, fit: Fitted) -> dict[str, Value]:
        """`amplitude`, half of the range of the drift."""
        return {"amplitude": Value(0.5 * float(np.ptp(self.added(fit))) * fit.data.y_scale.unit, "y")}

    def planted(self, fit: Fitted, share: float) -> list[Planted]:
        """A ramp, a bow and a wave along the record."""
        return [Planted("amplitude", {}, tuple(share * fit.range * row)) for row in np.eye(int(self.variant))]
