"""Periodic disturbances."""

from typing import Any

import numpy as np

from labsid._arrays import FloatArray
from labsid.gap.dynamics.plant_form import CYCLES, Parameter
from labsid.gap.dynamics.plants import Plant
from labsid.gap.effects.base import AdditiveEffect, Effect, Fitted, Planted, PlantEffect, Value
from labsid.gap.effects.context import Context, Structure
from labsid.gap.effects.description import Description, Reported
from labsid.gap.effects.dynamics import peaks
from labsid.gap.effects.sketch import Sketch, nothing
from labsid.gap.record.data import Data

SINUSOID_STEP = 0.1  # amplitude for the numerical derivative by a sinusoid within the dynamics; numerics
PLANTED_CORNERS = 1.0, 0.3, 0.1, 3.0, 10.0
"""Frequencies whose visibility is asked for, over that of the slowest pole; set by hand."""
SLOWEST_PLANTED = 3.0  # cycles in the record of such a sinusoid; set by hand
LEAST_LINE = 0.1  # share of the power of the change of the output at the frequency of the sinusoid; set by hand
MAX_SINUSOID = 3.0  # largest start value of its amplitude; numerics


class _Sinusoid(Effect):
    """A sinusoid anywhere behind the actuator."""

    name = "periodic-disturbance"
    description = Description(
        path="disturbance",
        noun="a periodic disturbance",
        clauses=(
            "The output oscillates at {frequency} with amplitude {amplitude}, independent of the command",
            "The output oscillates, independent of the command",
        ),
        meaning=(
            "A steady oscillation that the command does not cause. Check pumps, fans, mains hum and nearby machines, "
            "also for frequencies above half the sampling rate: read every T seconds, f looks like 1/T - f."
        ),
        excited_by="Several periods, with stretches of constant input.",
        parameters={
            "frequency": Reported("frequency", "Hz"),
            "amplitude": Reported("amplitude", "y"),
        },
        confused_with=("resonance", "coloured-noise"),
        of_one_record=True,
        sketch=Sketch(
            "Time (s)",
            "s",
            "Oscillation, of any phase",
            "amplitude",
            lambda x, p, seen: p["amplitude"] * np.sin(2.0 * np.pi * p["frequency"] * x),
            nothing,
            ("amplitude",),
            reach=lambda p, seen: (0.0, 3.0 / p["frequency"]),
        ),
    )

    def alternatives(self, hypothesis: Structure) -> list[Effect]:
        """The other positions, where they differ."""
        forms: list[Effect] = [Periodic()]
        forms += [Periodic("load")] if any(not effect.is_limit for effect in hypothesis.outputs) else []
        forms += [InnerPeriodic("inside")] if hypothesis.plant.nonlinear else []
        forms += [InnerPeriodic("ahead")] if hypothesis.plant.in_series else []
        return [form for form in forms if form != self]

    def _amplitude(self, fit: Fitted) -> float:
        """In the scaled output."""
        raise NotImplementedError

    def values(self, fit: Fitted) -> dict[str, Value]:
        """`frequency`, and `amplitude` in the output."""
        frequency = fit.value("cycles") / (fit.data.samples * fit.data.Ts)
        return {
            "frequency": Value(frequency, "Hz"),
            "amplitude": Value(self._amplitude(fit) * fit.data.y_scale.unit, "y"),
        }


def residual_cycles(context: Context) -> list[float]:
    """Cycles in the record of the highest narrow peaks in the spectrum of the residual."""
    samples = context.data.samples
    slowest = 2.0 * np.pi * CYCLES.lower / samples
    return [w * samples / (2.0 * np.pi) for w in peaks(context, slowest)]


def _line(change: FloatArray, cycles: float) -> float:
    """Amplitude of the component of a signal with so many cycles."""
    wave = np.exp(-2j * np.pi * cycles / change.size * np.arange(change.size))
    return float(2.0 * abs(np.mean(change * wave)))


class InnerPeriodic(_Sinusoid, PlantEffect):
    """A sinusoidal load on a nonlinear state; `variant` "inside", or "ahead" for the first of two states in series."""

    only_inner = True
    variants = ("inside",)
    places = ("inside", "ahead")

    def outer_form(self) -> Effect:
        """A sinusoid at the sensor."""
        return Periodic()

    def with_linear_gains(self, data: Data, hypothesis: Any, theta: FloatArray) -> FloatArray:
        """Set amplitude and phase by linear least squares."""
        at = [hypothesis.slices["plant"].start + hypothesis.plant.index(name) for name in ("shake_cos", "shake_sin")]
        base_columns = hypothesis.design(theta, data.u).columns
        derivatives = []
        for i in at:
            moved = theta.copy()
            moved[i] = SINUSOID_STEP
            derivatives.append((hypothesis.design(moved, data.u).columns[:, 0] - base_columns[:, 0]) / SINUSOID_STEP)
        columns = np.column_stack([base_columns, *derivatives])[data.rows]
        if not np.isfinite(columns).all():
            return theta
        gains = np.linalg.lstsq(columns, data.y[data.rows])[0]
        out = theta.copy()
        out[at] = np.clip(gains[-2:] / (gains[0] or np.inf), -MAX_SINUSOID, MAX_SINUSOID)
        return out

    def extend(self, plant: Plant) -> Plant:
        """The dynamics with a sinusoidal load."""
        return plant.modified(sinusoid=self.variant)

    def plant_starts(self, context: Context) -> list[dict[str, float]]:
        """The highest narrow peaks in the spectrum of the residual."""
        return [{"cycles": at} for at in residual_cycles(context)]

    def is_plausible(self, fit: Fitted) -> bool:
        """Require that the output oscillates: a fast and strong shaking may act as another law of the dynamics."""
        change = fit.change_by("shake_cos", "shake_sin")
        return bool(0.5 * _line(change, fit.value("cycles")) ** 2 >= LEAST_LINE * np.var(change))

    def _amplitude(self, fit: Fitted) -> float:
        """Of its component in the change of the output."""
        return _line(fit.change_by("shake_cos", "shake_sin"), fit.value("cycles"))


class Periodic(_Sinusoid, AdditiveEffect):
    """A sinusoid added after the sensor's curve; with `variant` "load", before it."""

    places = ("", "load")
    planted_variants = ("",)
    whole = "y"

    def inner_forms(self) -> tuple[Effect, ...]:
        """At the sensor, or within the dynamics."""
        return (self, InnerPeriodic("inside"))

    def inner_start(self, context: Context) -> dict[str, float]:
        """The cycles."""
        fit = context.parent
        return {"cycles": float(fit.theta[fit.hypothesis.slices[self.key]][0])}

    @property
    def at_load(self) -> bool:
        """Whether the sinusoid is added before the sensor's curve."""
        return self.variant == "load"

    @property
    def parameters(self) -> tuple[Parameter, ...]:
        """Number of cycles in the record."""
        return (CYCLES,)

    def starts(self, context: Context) -> list[FloatArray]:
        """The highest narrow peaks in the spectrum of the residual."""
        return [np.array([at]) for at in residual_cycles(context)]

    def columns(self, own: FloatArray, samples: int, span: int, plant: Plant, rates: FloatArray) -> FloatArray:
        """Cosine and sine."""
        phase = 2.0 * np.pi * own[0] / span * np.arange(samples)
        return np.column_stack([np.cos(phase), np.sin(phase)])

    def _amplitude(self, fit: Fitted) -> float:
        return float(np.hypot(*fit.hypothesis.gains_of(fit.gains, self)))

    def planted(self, fit: Fitted, share: float) -> list[Planted]:
        """A sinusoid at the corner of the slowest time constant, of either phase, and slower and faster ones."""
        corner = fit.data.samples / (2.0 * np.pi * fit.slowest_time)
        cycles = [max(factor * corner, SLOWEST_PLANTED) for factor in PLANTED_CORNERS]
        phases = (share * fit.range, 0.0), (0.0, share * fit.range)
        return [Planted("amplitude", {"cycles": at}, gains) for at in dict.fromkeys(cycles) for gains in phases]
