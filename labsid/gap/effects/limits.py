"""Limits of a signal, of the actuator or of the sensor."""

from typing import ClassVar

import numpy as np

from labsid._arrays import FloatArray
from labsid.gap.dynamics.plant_form import Parameter
from labsid.gap.effects.base import Effect, Fitted, Planted, Value


class Limits(Effect):
    """Limits of the input or the output, `signal` "u" or "y"; `variant` low, high or both."""

    signal: ClassVar[str]
    leap: ClassVar[float]
    variants = ("high", "low", "both")

    @property
    def parameters(self) -> tuple[Parameter, ...]:
        """Limits in the scaled signal."""
        names = ("low", "high") if self.variant == "both" else (self.variant,)
        return tuple(Parameter(name, -8.0, 8.0, leap=self.leap) for name in names)

    def ends(self, own: FloatArray) -> tuple[float, float]:
        """The lower and the upper limit; infinite without one."""
        low = float(own[0]) if self.variant != "high" else -np.inf
        high = float(own[-1]) if self.variant != "low" else np.inf
        return low, high

    def between(self, lows: FloatArray, highs: FloatArray) -> list[FloatArray]:
        """Start values from some of either limit."""
        ends = {"low": lows, "high": highs}
        return [np.array(values) for values in zip(*(ends[one.name] for one in self.parameters), strict=True)]

    def values(self, fit: Fitted) -> dict[str, Value]:
        """`low` and `high` in the unit of the signal."""
        scale = fit.data.u_scale if self.signal == "u" else fit.data.y_scale
        ends = zip(self.parameters, fit.theta_of(self), strict=True)
        return {p.name: Value(float(scale.back(float(x))), self.signal) for p, x in ends}

    def planted(self, fit: Fitted, share: float) -> list[Planted]:
        """A limit within the range of the signal by a share of it."""
        signal = fit.data.u if self.signal == "u" else fit.output[fit.data.rows]
        low, high = float(signal.min()), float(signal.max())
        ends = {"low": low + share * (high - low), "high": high - share * (high - low)}
        return [Planted(self.variant, {self.variant: ends[self.variant]})]
