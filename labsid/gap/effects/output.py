"""Effects on the way from the true output to the record."""

from typing import ClassVar

import numpy as np
from numpy.polynomial.chebyshev import chebvander

from labsid._arrays import FloatArray
from labsid.gap.effects import curves
from labsid.gap.effects.base import RICHER_FORM_BIC, AdditiveEffect, Fitted, OutputEffect, Value
from labsid.gap.effects.context import Context
from labsid.gap.plant_form import Parameter
from labsid.gap.plants import Plant
from labsid.gap.responses import normalized_time

CURVE_RANGE = (-20.0, 20.0)  # scaled output where a curve is bent


class Saturation(OutputEffect):
    """The sensor clips; `variant` low, high or both."""

    name = "output-saturation"
    position = 2
    is_limit = True

    @property
    def parameters(self) -> tuple[Parameter, ...]:
        """The limits in the scaled output."""
        names = {"low": ("low",), "high": ("high",), "both": ("low", "high")}[self.variant]
        return tuple(Parameter(name, -8.0, 8.0, leap=0.03) for name in names)

    def starts(self, context: Context) -> list[FloatArray]:
        """Quantiles of the output."""
        y = context.data.y[context.data.rows]
        lows = np.quantile(y, (0.02, 0.1, 0.25))
        highs = np.quantile(y, (0.98, 0.9, 0.75))
        if self.variant == "both":
            return [np.array([low, high]) for low, high in zip(lows, highs, strict=True)]
        return [np.array([limit]) for limit in (lows if self.variant == "low" else highs)]

    def _limits(self, own: FloatArray) -> tuple[float, float]:
        low = float(own[0]) if self.variant != "high" else -np.inf
        high = float(own[-1]) if self.variant != "low" else np.inf
        return low, high

    def apply(self, z: FloatArray, own: FloatArray) -> FloatArray:
        """Stop at the limits."""
        return np.clip(z, *self._limits(own))

    def slope(self, z: FloatArray, own: FloatArray) -> FloatArray:
        """One between the limits, zero beyond."""
        low, high = self._limits(own)
        return ((z > low) & (z < high)).astype(float)

    def active_samples(self, fit: Fitted) -> np.ndarray:
        """Where the simulated reading is at a limit."""
        low, high = self._limits(fit.theta_of(self))
        output = fit.hypothesis.output(fit.theta, fit.gains, fit.data.u)
        return np.asarray((output <= low) | (output >= high))

    def values(self, fit: Fitted) -> dict[str, Value]:
        """`low` and `high` as outputs."""
        return {p.name: Value(fit.y(float(x)), "y") for p, x in zip(self.parameters, fit.theta_of(self), strict=True)}


class Nonlinearity(OutputEffect):
    """A smooth static sensor curve: y = z + c2 z^2 + c3 z^3 about the middle of the record's output.

    The `variant` "rich" is a spline.
    """

    name = "output-nonlinearity"
    position = 1
    bic_penalty: ClassVar[dict[str, float]] = {curves.SPLINE_VARIANT: RICHER_FORM_BIC}

    @property
    def parameters(self) -> tuple[Parameter, ...]:
        """The coefficients in the scaled output."""
        return curves.parameters(self.variant)

    def starts(self, context: Context) -> list[FloatArray]:
        """Either coefficient a little up or down."""
        return [np.array(pair) for pair in ((0.05, 0.0), (-0.05, 0.0), (0.0, 0.03), (0.0, -0.03))]

    def apply(self, z: FloatArray, own: FloatArray) -> FloatArray:
        """The curve; far outside the record it goes on with slope one."""
        near = np.clip(z, *CURVE_RANGE)
        return z - near + curves.evaluate(near, own)

    def slope(self, z: FloatArray, own: FloatArray) -> FloatArray:
        """Derivative of the curve."""
        return curves.slope(np.clip(z, *CURVE_RANGE), own)

    def values(self, fit: Fitted) -> dict[str, Value]:
        """`c2` and `c3` about `centre`, the middle of the record."""
        return curves.coefficients(fit.theta_of(self), fit.data.y_scale.unit, "y") | {"centre": Value(fit.y(0.0), "y")}


class Drift(AdditiveEffect):
    """A slow additive wander of the sensor zero: Chebyshev polynomials up to the degree in `variant`, or "settle"."""

    name = "output-drift"
    path = "output"

    @property
    def width(self) -> int:
        """One column for a zero that settles, else one for each degree."""
        return 1 if self.variant == "settle" else int(self.variant)

    @property
    def parameters(self) -> tuple[Parameter, ...]:
        """Of a zero that settles, the logarithm of its time constant as a share of the record."""
        return (Parameter("log_share", -4.0, 0.0),) if self.variant == "settle" else ()

    def starts(self, context: Context) -> list[FloatArray]:
        """Fast to slow."""
        if self.variant == "settle":
            return [np.array([np.log(share)]) for share in (0.05, 0.2, 0.6)]
        return [np.zeros(0)]

    def columns(self, own: FloatArray, samples: int, span: int, plant: Plant, rates: FloatArray) -> FloatArray:
        """Polynomials of degree 1, 2, ... along the record, or one decay."""
        if self.variant == "settle":
            return np.exp(-np.arange(samples) / (span * np.exp(own[0])))[:, None]
        return np.asarray(chebvander(normalized_time(samples, span), int(self.variant))[:, 1:], np.float64)

    def values(self, fit: Fitted) -> dict[str, Value]:
        """`amplitude`, half of the range of the wander."""
        samples = fit.data.samples
        wander = self.columns(fit.theta_of(self), samples, samples, fit.hypothesis.plant, fit.theta)
        wander = wander @ fit.hypothesis.gains_of(fit.gains, self)
        return {"amplitude": Value(0.5 * float(np.ptp(wander)) * fit.data.y_scale.unit, "y")}
