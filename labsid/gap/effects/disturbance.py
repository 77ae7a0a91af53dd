"""Disturbances: effects that are independent of the input."""

from typing import Any

import numpy as np

from labsid._arrays import FloatArray
from labsid.gap.data import Data
from labsid.gap.effects.base import MAX_RANGES, RICHER_FORM_BIC, AdditiveEffect, Effect, Fitted, PlantEffect, Value
from labsid.gap.effects.context import Context, ParentFit, Structure
from labsid.gap.effects.dynamics import peaks
from labsid.gap.plant_form import CYCLES, ONSET, Parameter
from labsid.gap.plants import Plant
from labsid.gap.responses import denominator, real_rates, step_signal

MIN_ONSET = 8  # samples from either end of the record
MAX_EXTRAPOLATION = 3.0  # ranges of the output, beyond which the final change is not reported
RESTART_POLE = 10.0  # per record: start value of a pole that was fitted as an integrator
FAST_POLE_RATIO = 10.0  # start value of the second pole over the first, if one was fitted as an integrator
SINUSOID_STEP = 0.1  # amplitude for the numerical derivative by a sinusoid within the dynamics
MAX_SINUSOID = 3.0  # largest start value of its amplitude
MIN_LASTING = 0.1  # final change of the output over its largest change: below, a load step is a pulse


class LoadStep(AdditiveEffect):
    """An unmeasured load step."""

    name = "load-step"

    def grown(self, plant: Plant) -> Effect | None:
        """A load that depends on the state."""
        if plant.nonlinear:
            return InnerLoad("inside")
        return Leak("leak") if plant.kind == "linear" else None

    def alternatives(self, hypothesis: Structure) -> list[Effect]:
        """The grown one."""
        grown = self.grown(hypothesis.plant)
        return [] if grown is None else [grown]

    def inner_forms(self) -> tuple[Effect, ...]:
        """A load within the dynamics."""
        return (InnerLoad("inside"),)

    def inner_start(self, context: Context) -> dict[str, float]:
        """The onset, and the size as an equivalent change of the input."""
        fit, gain = context.parent, context.gain
        size = self.change(Fitted(fit.hypothesis, fit.theta, fit.gains, context.data))
        onset = float(fit.theta[fit.hypothesis.slices[self.key]][0])
        return {"onset": onset, "load": float(np.clip(-size / gain, -20.0, 20.0)) if gain else 0.0}

    @property
    def at_load(self) -> bool:
        """True: the load passes through the dynamics."""
        return True

    @property
    def parameters(self) -> tuple[Parameter, ...]:
        """The onset as a share of the record."""
        return (ONSET,)

    def starts(self, context: Context) -> list[FloatArray]:
        """Onsets at which a load step reduces the residual most."""
        return [np.array([at]) for at in load_onsets(context, 4)]

    def columns(self, own: FloatArray, samples: int, span: int, plant: Plant, rates: FloatArray) -> FloatArray:
        """Response of the dynamics to a unit step."""
        return plant.load_response(rates, step_signal(float(own[0]), samples, span))

    def is_plausible(self, fit: Fitted) -> bool:
        """Reject onsets near either end (an offset, a spike), loads that do not last (a pulse) and impossible sizes."""
        most = float(np.abs(self._response(fit)).max())
        lasts = abs(self.change(fit)) > MIN_LASTING * most
        possible = most < MAX_RANGES * fit.range
        return bool(lasts and possible and _inside(float(fit.theta_of(self)[0]), fit.data.samples))

    def _response(self, fit: Fitted) -> FloatArray:
        """Change of the scaled output by the load, shape (N,)."""
        plant, samples = fit.hypothesis.plant, fit.data.samples
        rates = fit.theta[fit.hypothesis.slices["plant"]]
        columns = self.columns(fit.theta_of(self), samples, samples, plant, rates)
        return np.asarray(columns @ fit.hypothesis.gains_of(fit.gains, self))

    def active_samples(self, fit: Fitted) -> np.ndarray:
        """The samples after the onset."""
        return np.asarray(np.arange(fit.data.samples) >= float(fit.theta_of(self)[0]) * fit.data.samples)

    def values(self, fit: Fitted) -> dict[str, Value]:
        """`onset` in seconds, and `size`: the final change of the output, or that at the end of the record.

        The latter if the dynamics are so slow that the record does not show the former.
        """
        size = self.change(fit)
        if abs(size) > MAX_EXTRAPOLATION * fit.range:
            size = float(self._response(fit)[-1])
        return {
            "onset": _instant(fit, float(fit.theta_of(self)[0])),
            "size": Value(size * fit.data.y_scale.unit, "y"),
        }

    def change(self, fit: Fitted) -> float:
        """Final change of the scaled output."""
        c, k = fit.hypothesis.plant.linear_rates(fit.theta[fit.hypothesis.slices["plant"]])
        a1, a2 = denominator(c, k)
        return float(fit.hypothesis.gains_of(fit.gains, self).sum()) / (1.0 + a1 + a2)


class _PlantLoad(PlantEffect):
    """A load step within the dynamics."""

    name = "load-step"
    path = "disturbance"

    def is_plausible(self, fit: Fitted) -> bool:
        """Reject onsets near either end of the record."""
        return _inside(fit.plant_value("onset"), fit.data.samples)

    def active_samples(self, fit: Fitted) -> np.ndarray:
        """The samples after the onset."""
        return np.asarray(np.arange(fit.data.samples) >= fit.plant_value("onset") * fit.data.samples)

    def values(self, fit: Fitted) -> dict[str, Value]:
        """`onset` in seconds, and `size`."""
        return {"onset": _instant(fit, fit.plant_value("onset")), "size": self._size(fit)}

    def _size(self, fit: Fitted) -> Value:
        raise NotImplementedError


class Leak(_PlantLoad):
    """A leak: a load proportional to the state that starts at an instant."""

    variants = ("leak",)
    bic_penalty = RICHER_FORM_BIC

    def alternatives(self, hypothesis: Structure) -> list[Effect]:
        """A constant load."""
        return [LoadStep()]

    def grown_starts(self, fit: ParentFit, hypothesis: Structure, theta: FloatArray) -> list[FloatArray]:
        """From a load step: with its poles, and with others if one of these integrates the load."""
        own, samples = hypothesis.slices["plant"], fit.output.size
        theta[own][hypothesis.plant.index("turn")] = 0.5
        starts = [theta]
        slow, fast = real_rates(*fit.rates)
        if slow * samples < 1.0:
            for slow, quick in ((RESTART_POLE / samples, fast), (fast, FAST_POLE_RATIO * fast)):
                starts.append(theta.copy())
                starts[-1][own][:2] = np.log((slow + quick, slow * quick))
        return starts

    def extend(self, plant: Plant) -> Plant:
        """Dynamics whose restoring rate steps at the onset."""
        return plant.modified(kind="varying", course="step")

    def plant_starts(self, context: Context) -> list[dict[str, float]]:
        """Onsets at which a leak reduces the residual most; either sign, with and without a change of damping."""
        return [
            {"drift": size, "share_c": part, "turn": 0.5, "onset": at}
            for at in load_onsets(context, 3, context.parent.output - context.parent.output[0])
            for size in (0.15, -0.15)
            for part in (0.0, 1.0)
        ]

    def _size(self, fit: Fitted) -> Value:
        """Relative change of the restoring rate."""
        return Value(float(np.expm1(fit.plant_value("drift"))), "1")


class InnerPeriodic(PlantEffect):
    """A sinusoidal load on a nonlinear state; `variant` "inside", or "ahead" for the first of two states in series."""

    name = "periodic-disturbance"
    path = "disturbance"
    variants = ("inside",)
    places = ("inside", "ahead")

    def alternatives(self, hypothesis: Structure) -> list[Effect]:
        """The other positions."""
        return [other for other in _periodic_forms(hypothesis) if other != self]

    def outer_form(self) -> Effect:
        """A sinusoid at the sensor."""
        return Periodic()

    def with_linear_gains(self, data: Data, hypothesis: Any, theta: FloatArray) -> FloatArray:
        """Set amplitude and phase by linear least squares."""
        at = [hypothesis.slices["plant"].start + hypothesis.plant.index(name) for name in ("shake_cos", "shake_sin")]
        base_columns = hypothesis.design(theta, data.u).columns
        derivatives = []
        for i in at:
            one = theta.copy()
            one[i] = SINUSOID_STEP
            derivatives.append((hypothesis.design(one, data.u).columns[:, 0] - base_columns[:, 0]) / SINUSOID_STEP)
        columns = np.column_stack([base_columns, *derivatives])[data.rows]
        if not np.isfinite(columns).all():
            return theta
        gains = np.linalg.lstsq(columns, data.y[data.rows])[0]
        out = theta.copy()
        out[at] = np.clip(gains[-2:] / (gains[0] or np.inf), -MAX_SINUSOID, MAX_SINUSOID)
        return out

    def extend(self, plant: Plant) -> Plant:
        """The dynamics with a sinusoidal load."""
        return plant.modified(has_sinusoid=True, sinusoid_upstream=self.variant == "ahead")

    def applies(self, context: Context) -> bool:
        """Only with a nonlinear state; `Periodic` covers linear dynamics."""
        return context.parent.hypothesis.plant.nonlinear

    def plant_starts(self, context: Context) -> list[dict[str, float]]:
        """The highest narrow peaks in the spectrum of the residual."""
        return [{"cycles": at} for at in residual_cycles(context)]

    def values(self, fit: Fitted) -> dict[str, Value]:
        """`frequency`, and `amplitude` of its component in the change of the output."""
        cycles = fit.plant_value("cycles")
        change = _change(fit, "shake_cos", "shake_sin")
        amplitude = 2.0 * abs(np.mean(change * np.exp(-2j * np.pi * cycles / change.size * np.arange(change.size))))
        frequency = cycles / (fit.data.samples * fit.data.Ts)
        return {
            "frequency": Value(frequency, "Hz"),
            "amplitude": Value(float(amplitude) * fit.data.y_scale.unit, "y"),
        }


class InnerLoad(_PlantLoad):
    """A load step on a nonlinear state.

    `variant` "inside" may include a leak; "ahead" acts on the first of two states in series.
    """

    variants = ("inside",)
    places = ("inside", "ahead")

    def place_matters(self, hypothesis: Structure) -> bool:
        """Whether there are two states in series."""
        return hypothesis.plant.in_series

    def outer_form(self) -> Effect:
        """A load on linear dynamics."""
        return LoadStep()

    def extend(self, plant: Plant) -> Plant:
        """The dynamics with a load."""
        return plant.modified(has_load=True, load_upstream=self.variant == "ahead")

    def applies(self, context: Context) -> bool:
        """Only with a nonlinear state; `LoadStep` and `Leak` cover linear dynamics."""
        return context.parent.hypothesis.plant.nonlinear

    def plant_starts(self, context: Context) -> list[dict[str, float]]:
        """Onsets at which a load step reduces the residual most, of either sign."""
        return [{"load": size, "onset": at} for at in load_onsets(context, 3) for size in (0.2, -0.2)]

    def is_plausible(self, fit: Fitted) -> bool:
        """Reject onsets near either end of the record, and impossible sizes."""
        possible = float(np.abs(_change(fit, "load", "leak")).max()) < MAX_RANGES * fit.range
        return possible and _inside(fit.plant_value("onset"), fit.data.samples)

    def _size(self, fit: Fitted) -> Value:
        """Change of the output at the end of the record."""
        return Value(float(_change(fit, "load", "leak")[-1]) * fit.data.y_scale.unit, "y")


def _change(fit: Fitted, *names: str) -> FloatArray:
    """Change of the output by the named plant parameters, shape (N,)."""
    place = fit.hypothesis.slices["plant"].start
    without = fit.theta.copy()
    for i, parameter in enumerate(fit.hypothesis.plant.parameters):
        if parameter.name in names:
            without[place + i] = 0.0
    return np.subtract(*(fit.hypothesis.output(theta, fit.gains, fit.data.u) for theta in (fit.theta, without)))


def _periodic_forms(hypothesis: Structure) -> list[Effect]:
    """Periodic disturbances at all positions that differ for this hypothesis."""
    forms: list[Effect] = [Periodic()]
    forms += [Periodic("load")] if any(not effect.is_limit for effect in hypothesis.outputs) else []
    forms += [InnerPeriodic("inside")] if hypothesis.plant.nonlinear else []
    forms += [InnerPeriodic("ahead")] if hypothesis.plant.in_series else []
    return forms


def residual_cycles(context: Context) -> list[float]:
    """Cycles in the record of the highest narrow peaks in the spectrum of the residual."""
    samples = context.data.samples
    slowest = 2.0 * np.pi * CYCLES.lower / samples
    return [w * samples / (2.0 * np.pi) for w in peaks(context, 3, slowest)]


def _instant(fit: Fitted, share: float) -> Value:
    """Time at a share of the record."""
    return Value(share * fit.data.samples * fit.data.Ts + fit.data.start, "s")


def _inside(onset: float, samples: int) -> bool:
    edge = max(MIN_ONSET / samples, 0.005)
    return edge < onset < 1.0 - edge


def explained_energy(columns: FloatArray, e: FloatArray) -> float:
    """Sum of squares of `e` that two columns explain; they may be in proportion."""
    gram = columns.T @ columns + 1e-9 * np.eye(2)
    cross = columns.T @ e
    return float(cross @ np.linalg.lstsq(gram, cross, rcond=None)[0])


def load_onsets(context: Context, count: int, grows_with: FloatArray | None = None) -> list[float]:
    """Onsets, as shares of the record, at which a load through the dynamics reduces the residual most.

    The load is constant after the onset, or proportional to the signal `grows_with`.
    """
    y, rows = context.data.y, context.data.rows
    samples = y.size
    plant, rates = Plant(), np.log(context.highpass_rates)
    base_columns = plant.columns(rates, context.actuator, samples)
    if context.parent.hypothesis.plant.nonlinear:
        base_columns = context.parent.output[:, None]
    basis = np.hstack([base_columns, np.ones((samples, 1))])[rows]
    basis = np.linalg.qr(basis)[0]
    e = y[rows] - basis @ (basis.T @ y[rows])
    load = np.ones(samples) if grows_with is None else grows_with
    at = np.unique(np.linspace(0.02, 0.97, 64) * samples).astype(int)
    gains = []
    for k in at:
        load_signal = np.where(np.arange(samples) >= k, load, 0.0)
        step = plant.load_response(rates, load_signal)[rows]
        step -= basis @ (basis.T @ step)
        gains.append(explained_energy(step, e))
    height = np.array(gains)
    found = []
    for _ in range(count):
        i = int(np.argmax(height))
        found.append(float(at[i]) / samples)
        height[max(i - 5, 0) : i + 6] = -np.inf
    return found


class Periodic(AdditiveEffect):
    """A sinusoid added after the sensor's curve; with `variant` "load", before it."""

    name = "periodic-disturbance"
    places = ("", "load")

    def alternatives(self, hypothesis: Structure) -> list[Effect]:
        """The other positions."""
        return [other for other in _periodic_forms(hypothesis) if other != self]

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

    def is_plausible(self, fit: Fitted) -> bool:
        """Reject amplitudes larger than the record could show."""
        return self._amplitude(fit) < MAX_RANGES * fit.range

    def _amplitude(self, fit: Fitted) -> float:
        return float(np.hypot(*fit.hypothesis.gains_of(fit.gains, self)))

    def values(self, fit: Fitted) -> dict[str, Value]:
        """`frequency` and `amplitude` at the output."""
        cycles = float(fit.theta_of(self)[0])
        frequency = cycles / (fit.data.samples * fit.data.Ts)
        amplitude = self._amplitude(fit) * fit.data.y_scale.unit
        return {"frequency": Value(frequency, "Hz"), "amplitude": Value(amplitude, "y")}
