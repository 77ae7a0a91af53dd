"""Unmeasured loads."""

from collections.abc import Callable
from dataclasses import replace
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from labsid._arrays import FloatArray
from labsid.gap.dynamics.plant_form import ONSET, Parameter
from labsid.gap.dynamics.plants import Plant
from labsid.gap.dynamics.responses import denominator, real_rates, step_signal
from labsid.gap.effects.base import (
    RICHER_FORM_BIC,
    AdditiveEffect,
    Effect,
    Fitted,
    Planted,
    PlantEffect,
    Value,
)
from labsid.gap.effects.context import Context, ParentFit, Structure
from labsid.gap.effects.description import Description, Reported
from labsid.gap.effects.sketch import Sketch, nothing, step

MIN_ONSET = 8  # samples from either end of the record; set by hand
MAX_EXTRAPOLATION = 3.0  # ranges of the output, beyond which the final change is not reported; set by hand
RESTART_POLE = 10.0  # per record: start value of a pole that was fitted as an integrator; numerics
FAST_POLE_RATIO = 10.0  # start value of the second pole over the first, if one was fitted as an integrator; numerics
ONSETS = 64  # tried, from which a load is fitted; numerics
ENERGY_RIDGE = 1e-9  # scaled, of inner products: keeps columns of nothing regular; numerics
LOAD_COLUMN = 3  # of the columns of the dynamics with a leak: response to a constant load; definition
PLANTED_ONSETS = 0.5, 0.05, 0.15, 0.25, 0.35, 0.65, 0.75, 0.85, 0.95
"""Of loads whose visibility is asked for; set by hand."""
MIN_LASTING = 0.1  # final change of the output over its largest change: below, a load step is a pulse; set by hand


class StepLoad(Effect):
    """A load that begins at an instant."""

    name = "load-step"
    description = Description(
        path="disturbance",
        noun="a load step",
        clauses=(
            "An unmeasured load acts from {onset} to {end} and changes the output by {size_y}",
            "An unmeasured load starts at {onset} and changes the output by {size_y}",
            "An unmeasured load starts at {onset} and changes the rate of return to rest by {size_1:%}, as a leak does",
            "An unmeasured load starts at {onset}",
            "An unmeasured load starts during the record",
        ),
        meaning="A further input acts on the process, such as an opened valve, a leak or an added weight.",
        excited_by="A record that goes on for several time constants after the load has started.",
        parameters={
            "onset": Reported("start", "s", position=True),
            "end": Reported("end", "s", position=True),
            "size": Reported(
                "settled change of the output", "y", share=True, labels={"1": "change of the rate of return to rest"}
            ),
        },
        confused_with=("output-drift", "parameter-drift"),
        of_one_record=True,
        varies_in_time=True,
        sketch=Sketch(
            "Time",
            "t",
            "Change by the load",
            "size",
            lambda x, p, seen: p["size"] * (step(x - p["onset"], p, seen) - step(x - p.get("end", np.inf), p, seen)),
            nothing,
            ("size",),
            ("onset", "end"),
        ),
    )

    @property
    def instants(self) -> tuple[str, ...]:
        """The onset."""
        return ("onset",)

    def _size(self, fit: Fitted) -> Value:
        raise NotImplementedError

    def is_plausible(self, fit: Fitted) -> bool:
        """Reject onsets near either end of the record: an offset, or a spike."""
        return is_within(fit, fit.value("onset")) and super().is_plausible(fit)

    def active_samples(self, fit: Fitted) -> np.ndarray:
        """The samples after the onset."""
        return np.asarray(np.arange(fit.data.samples) >= fit.value("onset") * fit.data.samples)

    def values(self, fit: Fitted) -> dict[str, Value]:
        """`onset` in seconds, and `size`."""
        return {"onset": fit.instant(fit.value("onset")), "size": self._size(fit)}


class LoadStep(StepLoad, AdditiveEffect):
    """An unmeasured load step."""

    planted_variants: ClassVar[tuple[str, ...]] = ("",)
    whole = "y"

    def alternatives(self, hypothesis: Structure) -> list[Effect]:
        """A load that depends on the state."""
        if hypothesis.plant.nonlinear:
            return [InnerLoad("inside")]
        return [Leak("leak")] if hypothesis.plant.kind == "linear" else []

    def grown_forms(self, hypothesis: Structure) -> list[Effect]:
        """All alternatives."""
        return self.alternatives(hypothesis)

    def inner_forms(self) -> tuple[Effect, ...]:
        """A load within the dynamics."""
        return (InnerLoad("inside"),)

    def inner_start(self, context: Context) -> dict[str, float]:
        """The onset, and the size as an equivalent change of the input."""
        fit, gain = context.parent, context.gain
        size = self.change(Fitted.of(fit, context.data))
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
        """Also reject loads that do not last: a pulse."""
        lasts = abs(self.change(fit)) > MIN_LASTING * float(np.abs(self.added(fit)).max())
        return lasts and super().is_plausible(fit)

    def _size(self, fit: Fitted) -> Value:
        """Final change of the output; that at the end of the record if the dynamics are too slow to show the former."""
        size = self.change(fit)
        if abs(size) > MAX_EXTRAPOLATION * fit.range:
            size = float(self.added(fit)[-1])
        return Value(size * fit.data.y_scale.unit, "y")

    def change(self, fit: Fitted) -> float:
        """Final change of the scaled output."""
        c, k = fit.hypothesis.plant.linear_rates(fit.plant_theta)
        a1, a2 = denominator(c, k)
        return float(fit.hypothesis.gains_of(fit.gains, self).sum()) / (1.0 + a1 + a2)

    def planted(self, fit: Fitted, share: float) -> list[Planted]:
        """A load in the middle of the record, and at other instants, that changes the output by this share."""
        a1, a2 = denominator(*fit.hypothesis.plant.linear_rates(fit.plant_theta))
        gains = (share * fit.range * (1.0 + a1 + a2), 0.0)
        return [Planted("size", {"onset": onset}, gains) for onset in PLANTED_ONSETS]


class PassingLoad(LoadStep):
    """A load that ends during the record."""

    variants = ("ends",)
    late = True
    planted_variants = ()
    bic_penalty = RICHER_FORM_BIC

    @property
    def instants(self) -> tuple[str, ...]:
        """The onset and the end."""
        return ("onset", "end")

    def alternatives(self, hypothesis: Structure) -> list[Effect]:
        """None: no other form ends."""
        return []

    @property
    def parameters(self) -> tuple[Parameter, ...]:
        """The onset and the end as shares of the record."""
        return (ONSET, replace(ONSET, name="end"))

    def starts(self, context: Context) -> list[FloatArray]:
        """Intervals in which a load reduces the residual most."""
        return [np.array(ends) for ends in _load_intervals(context, 3)]

    def columns(self, own: FloatArray, samples: int, span: int, plant: Plant, rates: FloatArray) -> FloatArray:
        """Response of the dynamics to a unit step that ends."""
        begun, ended = (step_signal(float(at), samples, span) for at in own)
        return plant.load_response(rates, begun - ended)

    def is_plausible(self, fit: Fitted) -> bool:
        """Reject loads that are shorter than an onset is from an end of the record, or end at this end."""
        edge = MIN_ONSET / fit.data.samples
        onset, end = fit.theta_of(self)
        return bool(onset + edge < end < 1.0 - edge) and StepLoad.is_plausible(self, fit)

    def active_samples(self, fit: Fitted) -> np.ndarray:
        """The samples from the onset to the end."""
        at = np.arange(fit.data.samples) / fit.data.samples
        onset, end = fit.theta_of(self)
        return np.asarray((at >= onset) & (at < end))

    def values(self, fit: Fitted) -> dict[str, Value]:
        """Also `end` in seconds."""
        onset, end = map(fit.instant, fit.theta_of(self))
        return {"onset": onset, "end": end, "size": self._size(fit)}

    def _size(self, fit: Fitted) -> Value:
        """Change of the output that the load would settle at; its largest one if the dynamics are too slow for that."""
        size = self.change(fit)
        if abs(size) > MAX_EXTRAPOLATION * fit.range:
            added = self.added(fit)
            size = float(added[np.abs(added).argmax()])
        return Value(size * fit.data.y_scale.unit, "y")


class Leak(StepLoad, PlantEffect):
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
        return plant.modified(kind="leak")

    def plant_starts(self, context: Context) -> list[dict[str, float]]:
        """Onsets at which a leak reduces the residual most; either sign, with and without a change of damping."""
        return [
            {"drift": size, "share_c": part, "turn": 0.5, "onset": at}
            for at in load_onsets(context, 3, context.parent.output - context.parent.output[0])
            for size in (0.15, -0.15)
            for part in (0.0, 1.0)
        ]

    def _size(self, fit: Fitted) -> Value:
        """Relative change of the restoring rate; final change of the output if a constant load changes it by more."""
        faster = float(np.expm1(fit.value("drift")))
        load = float(fit.gains[LOAD_COLUMN]) / (1.0 + faster)
        if abs(faster) * fit.range < abs(load) < MAX_EXTRAPOLATION * fit.range:
            return Value(load * fit.data.y_scale.unit, "y")
        return Value(faster, "1")


class InnerLoad(StepLoad, PlantEffect):
    """A load step on a nonlinear state.

    `variant` "inside" may include a leak; "ahead" acts on the first of two states in series.
    """

    only_inner = True
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
        return plant.modified(load=self.variant)

    def plant_starts(self, context: Context) -> list[dict[str, float]]:
        """Onsets at which a load step reduces the residual most, of either sign."""
        return load_starts(context)

    def is_plausible(self, fit: Fitted) -> bool:
        """Also reject impossible sizes."""
        change = fit.change_by("load", "leak")
        return fit.could_show(float(np.abs(change).max()), change) and super().is_plausible(fit)

    def _size(self, fit: Fitted) -> Value:
        """Change of the output at the end of the record."""
        return Value(float(fit.change_by("load", "leak")[-1]) * fit.data.y_scale.unit, "y")


def is_within(fit: Fitted, onset: float) -> bool:
    """Whether an onset, as a share of the record, is away from either end of it."""
    edge = max(MIN_ONSET / fit.data.samples, 0.005)
    return edge < onset < 1.0 - edge


def explained_energies(grams: FloatArray, crosses: FloatArray) -> FloatArray:
    """Sums of squares that sets of columns explain, from their inner products with each other and with the signal.

    Parameters
    ----------
    grams : ndarray, shape (n, m, m)
        The columns of a set may be in proportion.
    crosses : ndarray, shape (n, m)

    Returns
    -------
    ndarray, shape (n,)
    """
    size = grams.shape[-1]
    inverses = np.linalg.pinv(grams + ENERGY_RIDGE * np.eye(size), size * np.finfo(float).eps, hermitian=True)
    return np.asarray(np.einsum("ni,nij,nj->n", crosses, inverses, crosses))


def load_starts(context: Context) -> list[dict[str, float]]:
    """Start values of a load within the dynamics: onsets that reduce the residual most, of either sign."""
    return [{"load": size, "onset": at} for at in load_onsets(context, 3) for size in (0.2, -0.2)]


def load_onsets(context: Context, count: int, grows_with: FloatArray | None = None) -> list[float]:
    """Onsets, as shares of the record, at which a load through the dynamics reduces the residual most.

    The load is constant after the onset, or proportional to the signal `grows_with`.
    """
    load = np.ones(context.data.samples) if grows_with is None else grows_with
    plant, rates = Plant(), np.log(context.highpass_rates)
    return best_onsets(context, count, lambda after: plant.load_response(rates, np.where(after, load, 0.0)))


def best_onsets(context: Context, count: int, columns_of: Callable[[NDArray[np.bool_]], FloatArray]) -> list[float]:
    """Onsets, as shares of the record, at which the columns for the samples after an onset reduce the residual most."""
    e, residual_of = _beside_dynamics(context)
    samples = context.data.samples
    at = _tried_onsets(samples)
    tried = (residual_of(columns_of(np.arange(samples) >= k)) for k in at)
    grams, crosses = zip(*((columns.T @ columns, columns.T @ e) for columns in tried), strict=True)
    height = explained_energies(np.array(grams), np.array(crosses))
    found = []
    for _ in range(count):
        i = int(np.argmax(height))
        found.append(float(at[i]) / samples)
        height[max(i - 5, 0) : i + 6] = -np.inf
    return found


def _tried_onsets(samples: int) -> NDArray[np.intp]:
    return np.unique((np.linspace(0.02, 0.97, ONSETS) * samples).astype(np.intp))


def _beside_dynamics(context: Context) -> tuple[FloatArray, Callable[[FloatArray], FloatArray]]:
    """What the dynamics leave of the output, by least squares, and the function that leaves the same of columns."""
    y, rows = context.data.y, context.data.rows
    if context.parent.hypothesis.plant.nonlinear:
        base = context.parent.output[:, None]
    else:
        base = Plant().columns(np.log(context.highpass_rates), context.actuator, y.size)
    basis = np.linalg.qr(np.hstack([base, np.ones((y.size, 1))])[rows])[0]

    def residual_of(columns: FloatArray) -> FloatArray:
        kept = columns[rows]
        return np.asarray(kept - basis @ (basis.T @ kept))

    return residual_of(y[:, None])[:, 0], residual_of


def _load_intervals(context: Context, count: int) -> list[tuple[float, float]]:
    """Beginning and end, as shares of the record, of constant loads that reduce the residual most."""
    e, residual_of = _beside_dynamics(context)
    samples = context.data.samples
    plant, rates = Plant(), np.log(context.highpass_rates)
    at = _tried_onsets(samples)
    steps = np.array([residual_of(plant.load_response(rates, (np.arange(samples) >= k).astype(float))).T for k in at])
    products, crosses = np.einsum("iak,jbk->ijab", steps, steps, optimize=True), steps @ e
    begun, ended = np.triu_indices(at.size, 1)
    grams = products[begun, begun] + products[ended, ended] - products[begun, ended] - products[ended, begun]
    height = np.full((at.size, at.size), -np.inf)
    height[begun, ended] = explained_energies(grams, crosses[begun] - crosses[ended])
    intervals = []
    for _ in range(count):
        i, j = divmod(int(np.argmax(height)), at.size)
        intervals.append((float(at[i]) / samples, float(at[j]) / samples))
        height[max(i - 5, 0) : i + 6, max(j - 5, 0) : j + 6] = -np.inf
    return intervals
