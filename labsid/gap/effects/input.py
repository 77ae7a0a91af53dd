"""Effects on the way from the command to the dynamics."""

from typing import ClassVar

import numpy as np

from labsid._arrays import FloatArray
from labsid.gap import _kernels
from labsid.gap.effects import curves
from labsid.gap.effects.base import RICHER_FORM_BIC, Fitted, InputEffect, Value
from labsid.gap.effects.context import Context
from labsid.gap.plant_form import Parameter
from labsid.gap.plants import Plant

LONGEST_DELAY = 250.0  # samples
INITIAL_OFFSET = Parameter("before", -30.0, 30.0)  # how far from the first command the actuator stood before the record
REST_SAMPLES = 5  # samples of one value at the beginning of a record


class Delay(InputEffect):
    """Transport delay of the actuator path, beyond the one sample that a strictly proper model has.

    A zero of the dynamics does for a part of a sample, and hides it: with the `variant` "no-zero" they have none. With
    "switched" the first command of the record is news to the rig; otherwise it has stood there for long.
    """

    name = "input-delay"
    position = 9

    def extend(self, plant: Plant) -> Plant:
        """Dynamics without a zero, where the variant says so."""
        return plant.modified(zero=False) if self.variant.startswith("no-zero") else plant

    @property
    def parameters(self) -> tuple[Parameter, ...]:
        """The delay in samples, and where the command stood before the record."""
        own = (Parameter("delay", 0.0, LONGEST_DELAY, 0.02, leap=0.5),)
        return (*own, INITIAL_OFFSET) if self.variant.endswith("switched") else own

    def starts(self, context: Context) -> list[FloatArray]:
        """Short ones closer together than long ones."""
        longest = min(LONGEST_DELAY, context.data.samples / 8)
        return [np.array([d]) for d in (1.0, 2.2, 4.0, 7.0, 12.0, 20.0, 35.0, 60.0, 100.0, 170.0) if d <= longest]

    def apply(self, w: FloatArray, own: FloatArray, span: int) -> FloatArray:
        """The signal itself: the hypothesis delays it behind all other effects, in place of the nuisance delay."""
        return w

    def values(self, fit: Fitted) -> dict[str, Value]:
        """`delay` in seconds."""
        return {"delay": Value(float(fit.theta_of(self)[0]) * fit.data.Ts, "s")}


class Saturation(InputEffect):
    """The actuator stops at a low and/or a high limit inside the commanded range; `variant` low, high or both."""

    name = "input-saturation"
    position = 1

    @property
    def parameters(self) -> tuple[Parameter, ...]:
        """The limits in the scaled input."""
        names = {"low": ("low",), "high": ("high",), "both": ("low", "high")}[self.variant]
        return tuple(Parameter(name, -8.0, 8.0, leap=0.05) for name in names)

    def applies(self, context: Context) -> bool:
        """Two levels cut down are two levels: the gain would take it up."""
        return context.levels.size > (3 if self.variant == "both" else 2)

    def starts(self, context: Context) -> list[FloatArray]:
        """A little, a fifth and two fifths inside the range."""
        u = context.data.u
        lows, highs = _inner_limits(u, -1), _inner_limits(u, 1)
        if self.variant == "low":
            return [np.array([low]) for low in lows]
        if self.variant == "high":
            return [np.array([high]) for high in highs]
        return [np.array([low, high]) for low, high in zip(lows, highs, strict=True)]

    def apply(self, w: FloatArray, own: FloatArray, span: int) -> FloatArray:
        """Stop at the limits."""
        if self.variant == "low":
            return np.maximum(w, own[0])
        if self.variant == "high":
            return np.minimum(w, own[0])
        return np.clip(w, min(own), max(own))

    def active_samples(self, fit: Fitted) -> np.ndarray:
        """Where the command is beyond a limit."""
        return np.asarray(self.apply(fit.data.u, fit.theta_of(self), fit.data.samples) != fit.data.u)

    def values(self, fit: Fitted) -> dict[str, Value]:
        """`low` and `high` as inputs."""
        return {p.name: Value(fit.u(float(x)), "u") for p, x in zip(self.parameters, fit.theta_of(self), strict=True)}


def _inner_limits(u: FloatArray, side: int) -> list[float]:
    """Where a limit may lie: a little, a third and two thirds inside the range."""
    low, high = float(u.min()), float(u.max())
    return [(high - part * (high - low)) if side > 0 else (low + part * (high - low)) for part in (0.08, 0.22, 0.4)]


class DeadZone(InputEffect):
    """No effect until the command leaves a band."""

    name = "input-dead-zone"
    position = 4

    @property
    def parameters(self) -> tuple[Parameter, ...]:
        """Both ends of the band in the scaled input."""
        return (Parameter("low", -8.0, 8.0, leap=0.1), Parameter("high", -8.0, 8.0, leap=0.1))

    def applies(self, context: Context) -> bool:
        """Two levels are two levels behind any static curve."""
        return context.levels.size > 2

    def starts(self, context: Context) -> list[FloatArray]:
        """Narrow and wide bands about the first, the middle and the median input."""
        u = context.data.u
        low, high = float(u.min()), float(u.max())
        middles = dict.fromkeys((round(float(u[0]), 6), 0.5 * (low + high), float(np.median(u))))
        starts = []
        for middle in middles:
            for half in (0.08, 0.2):
                pair = np.clip([middle - half * (high - low), middle + half * (high - low)], low, high)
                starts.append(pair)
        return starts

    def apply(self, w: FloatArray, own: FloatArray, span: int) -> FloatArray:
        """Zero within the band, the distance from it outside."""
        low, high = min(own), max(own)
        return np.maximum(w - high, 0.0) + np.minimum(w - low, 0.0)

    def active_samples(self, fit: Fitted) -> np.ndarray:
        """Where the command is within the band."""
        return np.asarray(self.apply(fit.data.u, fit.theta_of(self), fit.data.samples) == 0.0)

    def is_plausible(self, fit: Fitted) -> bool:
        """A band that reaches to the end of the input's range is a limit, unless the rig rests at that end."""
        low, high = sorted(fit.theta_of(self))
        u = fit.data.u
        edge = 0.02 * float(np.ptp(u))
        inside = low > u.min() + edge and high < u.max() - edge
        at_end = u[0] < u.min() + edge if low <= u.min() + edge else u[0] > u.max() - edge
        at_rest = bool(np.all(u[:REST_SAMPLES] == u[0])) and low <= u[0] <= high and at_end
        return bool(high - low > edge and (inside or at_rest))

    def values(self, fit: Fitted) -> dict[str, Value]:
        """`low` and `high` as inputs."""
        low, high = sorted(fit.theta_of(self))
        return {"low": Value(fit.u(low), "u"), "high": Value(fit.u(high), "u")}


class Backlash(InputEffect):
    """Play of a given width."""

    name = "input-backlash"
    position = 5

    @property
    def parameters(self) -> tuple[Parameter, ...]:
        """Width of the play, and where in it the record begins."""
        return (Parameter("width", 0.0, 8.0, leap=0.05), Parameter("position", 0.0, 1.0, 0.02))

    def applies(self, context: Context) -> bool:
        """Two levels behind a play are two levels, or none."""
        return context.levels.size > 2

    def starts(self, context: Context) -> list[FloatArray]:
        """Narrow to wide, the record beginning in the middle of the play."""
        span = float(np.ptp(context.data.u))
        return [np.array([part * span, 0.5]) for part in (0.06, 0.15, 0.35)]

    def apply(self, w: FloatArray, own: FloatArray, span: int) -> FloatArray:
        """Follow the command only once the play is taken up."""
        return _kernels.backlash(w, float(own[0]), float(own[1]))

    def values(self, fit: Fitted) -> dict[str, Value]:
        """`width` in the unit of the input."""
        return {"width": Value(float(fit.theta_of(self)[0]) * fit.data.u_scale.unit, "u")}


class RateLimit(InputEffect):
    """The actuator slews at a bounded rate; `variant` "behind" puts it behind a dead zone and a play.

    With "switched" the actuator stands elsewhere when the record begins. "timed" has the first moment of each sample
    right, not its mean alone: what comes late in a sample is moved on by half, from the sample before to the one
    behind. Dynamics that follow their input within a sample would see that too early.
    """

    name = "input-rate-limit"
    position = 2
    variant_positions: ClassVar[dict[str, int]] = {"behind": 6}

    @property
    def parameters(self) -> tuple[Parameter, ...]:
        """Logarithm of the rate in the scaled input per sample, and where the actuator stands at first."""
        own = (Parameter("log_rate", -9.0, 3.0, leap=0.1),)
        return (*own, INITIAL_OFFSET) if self.variant == "switched" else own

    def starts(self, context: Context) -> list[FloatArray]:
        """Shares of the largest step of the input."""
        largest = float(np.abs(np.diff(context.data.u)).max())
        return [np.array([np.log(part * largest)]) for part in (0.6, 0.25, 0.08, 0.03)]

    def apply(self, w: FloatArray, own: FloatArray, span: int) -> FloatArray:
        """Slew to the command."""
        mean, moment = _kernels.rate_limit(w, float(np.exp(own[0])), float(w[0] + own[1:].sum()))
        if self.variant == "timed":
            mean[1:] += 0.5 * moment[:-1]
            mean[:-1] -= 0.5 * moment[1:]
        return np.asarray(mean)

    def values(self, fit: Fitted) -> dict[str, Value]:
        """`rate` in units of the input per second."""
        rate = float(np.exp(fit.theta_of(self)[0])) * fit.data.u_scale.unit / fit.data.Ts
        return {"rate": Value(rate, "u/s")}


class Nonlinearity(InputEffect):
    """A smooth static curve: w = u + c2 u^2 + c3 u^3 about the middle of the record's input.

    It stands at the end of the actuator, where a valve or a pump is; the `variant` "first" stands at its beginning.
    "rich" is a spline.
    """

    name = "input-nonlinearity"
    position = 7
    bic_penalty: ClassVar[dict[str, float]] = {curves.SPLINE_VARIANT: RICHER_FORM_BIC}
    variant_positions: ClassVar[dict[str, int]] = {"first": 0}

    @property
    def parameters(self) -> tuple[Parameter, ...]:
        """The coefficients in the scaled input."""
        return curves.parameters(self.variant)

    def applies(self, context: Context) -> bool:
        """Two levels are two levels behind any static curve."""
        return context.levels.size > 2

    def starts(self, context: Context) -> list[FloatArray]:
        """Either coefficient a little up or down."""
        return [np.array(pair) for pair in ((0.1, 0.0), (-0.1, 0.0), (0.0, 0.1), (0.0, -0.1))]

    def apply(self, w: FloatArray, own: FloatArray, span: int) -> FloatArray:
        """The curve, of slope one in the middle."""
        return curves.evaluate(w, own)

    def values(self, fit: Fitted) -> dict[str, Value]:
        """`c2` and `c3` about `centre`, the middle of the record."""
        return curves.coefficients(fit.theta_of(self), fit.data.u_scale.unit, "u") | {"centre": Value(fit.u(0.0), "u")}
