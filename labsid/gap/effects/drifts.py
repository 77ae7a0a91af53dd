"""Parameters of the rig that drift slowly during the record."""

from collections.abc import Callable, Mapping
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from labsid._arrays import FloatArray
from labsid.gap.dynamics._rates import changed_rates
from labsid.gap.dynamics.plant_form import ONSET, Parameter
from labsid.gap.dynamics.plants import Plant
from labsid.gap.dynamics.responses import (
    chebyshev_course,
    comes_to_rest,
    decay_rates,
    real_rates,
    section,
    single_pole,
    step_signal,
)
from labsid.gap.effects.base import (
    RICHER_FORM_BIC,
    Effect,
    Fitted,
    InputEffect,
    OutputEffect,
    Planted,
    PlantEffect,
    Value,
)
from labsid.gap.effects.context import Context, ParentFit, Structure
from labsid.gap.effects.description import Description, Reported
from labsid.gap.effects.disturbance import best_onsets, is_within
from labsid.gap.effects.sketch import Seen, Sketch, nothing, step

MIN_COSINE = 0.05  # smallest cosine of the neutral-input angle, which is then within 20 scaled units; set by hand
MIN_MOTION = 0.15  # standard deviation of the input on either side of a change of a gain, over that of all; set by hand
STEP_COSINE = 0.15  # the same of a change at an instant: 6.6 scaled units, a range beyond the record; set by hand
SETTLED = 5.0  # slowest time constants after which the response to a pulse is over; set by hand
MOST_AT_ONCE = 0.9  # energy of what a lasting change does up to then, over all of it: a pulse has 0.99; set by hand


def _course_of_change(x: FloatArray, p: Mapping[str, float], seen: Seen) -> FloatArray:
    if "onset" in p:
        return p["drift"] * step(x - p["onset"], p, seen)
    return np.asarray(p.get("drift", p.get("pole", 0.0)) * (x - x[0]) / (x[-1] - x[0]))


class _Once(Effect):
    """What changes once, at an instant."""

    variants: ClassVar[tuple[str, ...]] = ("step",)
    planted_variants: ClassVar[tuple[str, ...]] = ()
    late = True
    bic_penalty = RICHER_FORM_BIC

    @property
    def instants(self) -> tuple[str, ...]:
        """The onset."""
        return ("onset",)

    def rates(self, context: Context) -> list[tuple[float, float]]:
        """Those of the high-pass fit, into which the change brings no slow pole; also its fast pole alone.

        The fast pole alone if the other one is slower than the record shows.
        """
        slow, fast = real_rates(*context.highpass_rates)
        alone = [single_pole(fast)] if slow * context.data.samples < 1.0 else []
        return [context.highpass_rates, *alone]


class _GainOnce(_Once):
    """A gain that changes once, about a neutral value of the signal, at which the change has no influence."""

    @property
    def parameters(self) -> tuple[Parameter, ...]:
        """The instant as a share of the record, the relative change, and the angle of the neutral value."""
        return (ONSET, Parameter("step", -3.0, 3.0), Parameter("angle", -2.0 * np.pi, 2.0 * np.pi, 1e-3))

    def is_plausible(self, fit: Fitted) -> bool:
        """Reject instants near an end of the record, and what a shift does as well.

        That is a change about a neutral value far outside the record, or of an input that rests before or after it.
        """
        onset, _, angle = fit.theta_of(self)
        u = fit.data.u
        at = int(np.clip(onset * u.size, 1, u.size - 1))
        moves = min(np.std(u[:at]), np.std(u[at:])) > MIN_MOTION * np.std(u)
        return is_within(fit, float(onset)) and bool(moves and abs(np.cos(angle)) > STEP_COSINE)

    def values(self, fit: Fitted) -> dict[str, Value]:
        """`drift`: relative change of the gain; `onset`: its instant."""
        onset, size, angle = fit.theta_of(self)
        return {"drift": Value(float(size * np.cos(angle)), "1"), "onset": fit.instant(onset)}

    def changed(self, x: FloatArray, own: FloatArray, span: int) -> FloatArray:
        """A signal whose distance from the neutral value is scaled after the instant."""
        onset, size, angle = own
        return np.asarray(x + size * (np.cos(angle) * x + np.sin(angle)) * step_signal(float(onset), x.size, span))


class PoleDrift(PlantEffect):
    """A slow drift of a pole, possibly with the gain."""

    name = "parameter-drift"
    description = Description(
        path="dynamics",
        noun="a drift of the parameters",
        clauses=(
            "The gain of the rig changes by {drift:%} and its speed of response by {pole:%} at {onset}",
            "The gain of the rig changes by {drift:%} at {onset}",
            "The speed of response changes by {pole:%} at {onset}",
            "The gain of the rig changes by {drift:%} and its speed of response by {pole:%} over the record",
            "The gain of the rig changes by {drift:%} over the record",
            "The speed of response changes by {pole:%} over the record",
            "The parameters of the rig change slowly over the record",
        ),
        meaning=(
            "The same command has a different effect at the end of the record than at the beginning. Check "
            "temperature, supply, wear and filling."
        ),
        excited_by="The same inputs at the beginning and at the end of a long record.",
        parameters={
            "drift": Reported("change of the gain", "1", share=True),
            "onset": Reported("instant of the change", "s", position=True),
            "pole": Reported("change of the speed of response", "1", share=True),
        },
        confused_with=("output-drift", "load-step"),
        of_one_record=True,
        wanders=True,
        varies_in_time=True,
        sketch=Sketch(
            "Time",
            "t",
            "Change, as a share",
            "",
            _course_of_change,
            nothing,
            ("drift", "pole"),
            ("onset",),
        ),
    )
    key_form = "pole-{}"
    variants: ClassVar[tuple[str, ...]] = ("1", "4")
    planted_variants: ClassVar[tuple[str, ...]] = ("1",)
    whole = "gain"

    def inner_forms(self) -> tuple[Effect, ...]:
        """A drift of the last nonlinear state."""
        return (InnerPoleDrift(self.variant),)

    def extend(self, plant: Plant) -> Plant:
        """Dynamics with slowly varying rates."""
        return plant.modified(kind="varying", drift_degree=int(self.variant))

    def plant_starts(self, context: Context) -> list[dict[str, float]]:
        """A rising, falling or curved restoring rate, with and without a change of damping."""
        return [start | {"share_c": part} for start in self._ways() for part in (0.0, 1.0)]

    def _ways(self) -> list[dict[str, float]]:
        ways = ("drift", "bend1") if self.variant != "1" else ("drift",)
        return [{way: size} for way in ways for size in (0.1, -0.1)]

    def values(self, fit: Fitted) -> dict[str, Value]:
        """`pole` and `drift`: relative changes of the speed and of the gain; beside a nonlinearity, of a spring.

        The speed is one over the mean delay of the response, on which a pole that a zero cancels has no influence; of
        an oscillation the slowest rate. The gain is that at rest; of a rig that comes to no rest, of its rate to the
        input.
        """
        ends = self._ends(fit)
        if fit.hypothesis.plant.kind != "varying":
            return {"pole": Value(float(np.exp(ends[1] - ends[0])) - 1.0, "1")}
        c, k = (float(np.exp(fit.value(name))) for name in ("log_c", "log_k"))
        rates = np.array([changed_rates(c, k, fit.value("share_c"), float(np.expm1(at))) for at in ends])
        rests = all(comes_to_rest(float(c), float(k), fit.data.samples) for c, k in rates)
        position, speed = (fit.gains[n] + fit.gains[n + 2] * ends for n in (0, 1))
        gains = position / rates[:, int(rests)]
        turns = gains[0] * gains[1] <= 0.0
        values = {} if turns else {"drift": Value(float(gains[1] / gains[0]) - 1.0, "1")}
        if rests or turns:
            oscillates = turns or fit.hypothesis.plant.feedthrough or (rates[:, 0] ** 2 < rates[:, 1]).any()
            slowest = np.array([decay_rates(float(c), float(k))[0] for c, k in rates])
            delay = 1.0 / slowest if oscillates else rates[:, 0] / rates[:, 1] - speed / position
            delay = delay if delay.min() > 0.0 else 1.0 / slowest
            values["pole"] = Value(float(delay[0] / delay[1]) - 1.0, "1")
        return values

    def _ends(self, fit: Fitted) -> FloatArray:
        """Logarithm of the factor of the rate at the beginning and at the end."""
        shape = np.array([fit.value("drift"), *(fit.value(f"bend{n}") for n in range(1, int(self.variant)))])
        return chebyshev_course(shape, 101, 101)[[0, -1]]

    def planted(self, fit: Fitted, share: float) -> list[Planted]:
        """A restoring rate that rises or falls by this factor."""
        half = 0.5 * float(np.log1p(share))
        return [
            Planted("pole", {"drift": way, "share_c": 1.0}, size=Value(float(np.expm1(2.0 * way)), "1"))
            for way in (half, -half)
        ]


class PoleStep(_Once, PoleDrift):
    """A pole that changes once, possibly with the gain."""

    def inner_forms(self) -> tuple[Effect, ...]:
        """A drift of the last nonlinear state."""
        return (InnerPoleDrift("1"),)

    def extend(self, plant: Plant) -> Plant:
        """Dynamics whose rates step at the onset."""
        return plant.modified(kind="varying", drift_degree=1, steps=True)

    def plant_starts(self, context: Context) -> list[dict[str, float]]:
        """Instants at which a change of the restoring force and of the gain reduces the residual most."""
        plant, rates, y = Plant(), np.log(context.highpass_rates), context.parent.output

        def columns_of(after: NDArray[np.bool_]) -> FloatArray:
            signals = (context.actuator, y - y[0], np.ones(y.size))
            return np.hstack([plant.load_response(rates, np.where(after, x, 0.0)) for x in signals])

        return [
            start | {"share_c": part, "turn": 0.5, "onset": at}
            for at in best_onsets(context, 2, columns_of)
            for start in ({"drift": 0.5}, {"drift": -0.5})
            for part in (0.0, 1.0)
        ]

    def is_plausible(self, fit: Fitted) -> bool:
        """Reject instants near an end of the record, and a gain that changes its sign: a slow pole then has hidden.

        Also a change that does not last: the step of a zero's coefficient passes a pulse at its instant.
        """
        return is_within(fit, fit.value("onset")) and "drift" in super().values(fit) and self._lasts(fit)

    def _lasts(self, fit: Fitted) -> bool:
        unchanged = fit.theta.copy()
        unchanged[[parameter.name for parameter in fit.hypothesis.parameters].index("drift")] = 0.0
        change = (fit.output - fit.hypothesis.output(unchanged, fit.gains, fit.data.u)) ** 2
        until = int(fit.value("onset") * fit.data.samples + SETTLED * fit.slowest_time) + 1
        return float(change[:until].sum()) < MOST_AT_ONCE * float(change.sum())

    def values(self, fit: Fitted) -> dict[str, Value]:
        """As of a drift, and `onset`, the instant."""
        return {**super().values(fit), "onset": fit.instant(fit.value("onset"))}

    def _ends(self, fit: Fitted) -> FloatArray:
        return np.array([0.0, fit.value("drift")])


class InnerPoleDrift(PoleDrift):
    """A slow drift of the rate of the last nonlinear state, or of the spring."""

    planted_variants: ClassVar[tuple[str, ...]] = ()
    key_form = "pole-{}-inside"
    only_inner = True

    def alternatives(self, hypothesis: Structure) -> list[Effect]:
        """A drift of the gain."""
        return [GainDrift(self.variant)]

    def outer_form(self) -> Effect:
        """A drift of a pole."""
        return PoleDrift(self.variant)

    def extend(self, plant: Plant) -> Plant:
        """The dynamics with a drifting rate."""
        return plant.modified(drift_degree=int(self.variant))

    def plant_starts(self, context: Context) -> list[dict[str, float]]:
        """A rising, falling or curved rate."""
        return self._ways()


class GainDrift(InputEffect):
    """A slow drift of the gain about a neutral input, at which the drift has no influence.

    The neutral input is -tan(angle), so that the minimization can pass through infinity.
    """

    name = "parameter-drift"
    key_form = "gain-{}"
    variants: ClassVar[tuple[str, ...]] = ("1", "4")
    planted_variants: ClassVar[tuple[str, ...]] = ("1",)
    whole = "gain"
    position: ClassVar[int] = 8

    def alternatives(self, hypothesis: Structure) -> list[Effect]:
        """Beside a nonlinear state, a drift of its rate."""
        return [InnerPoleDrift(self.variant)] if hypothesis.plant.nonlinear else []

    @property
    def parameters(self) -> tuple[Parameter, ...]:
        """Coefficients of the drift, and the angle of the neutral input."""
        shape = [Parameter(f"shape{n}", -3.0, 3.0) for n in range(1, int(self.variant) + 1)]
        return (*shape, Parameter("angle", -2.0 * np.pi, 2.0 * np.pi, 1e-3))

    def starts(self, context: Context) -> list[FloatArray]:
        """A rising and a falling gain, and the drift that explains most of the residual to first order."""
        starts = np.zeros((2, int(self.variant) + 1))
        starts[:, 0] = 0.1, -0.1
        return [*starts, *self._course(context)]

    def _course(self, context: Context) -> list[FloatArray]:
        """Regress the residual on the linearized effects of the drift and of the neutral input."""
        count = int(self.variant)
        shapes = [chebyshev_course(shape, context.data.samples, context.data.samples) for shape in np.eye(count)]
        fit = context.parent
        constant = np.ones(context.data.samples)
        w = context.actuator
        columns = [_linear_response(fit, signal) for signal in (*(w * shape for shape in shapes), *shapes)]
        rows = context.data.rows
        J = np.column_stack([*columns, constant])
        if not np.isfinite(J).all():
            return []
        gains = np.linalg.lstsq(J[rows], context.residual[rows], rcond=1e-6)[0]
        static = np.column_stack([_linear_response(fit, w), constant])[rows]
        unit = float(np.linalg.lstsq(static, fit.output[rows], rcond=None)[0][0])
        if unit == 0.0:
            return []
        shape, offset = gains[:count] / unit, gains[count : 2 * count] / unit
        angle = float(np.arctan2(offset @ shape, shape @ shape))
        return [np.array([*np.clip(shape / max(np.cos(angle), MIN_COSINE), -2.0, 2.0), angle])]

    def is_plausible(self, fit: Fitted) -> bool:
        """Reject a neutral input far outside the record: the drift is then an offset."""
        return bool(abs(np.cos(fit.theta_of(self)[-1])) > MIN_COSINE)

    def apply(self, w: FloatArray, own: FloatArray, span: int) -> FloatArray:
        """Scale the distance from the neutral input."""
        distance = np.cos(own[-1]) * w + np.sin(own[-1])
        return np.asarray(w + distance * chebyshev_course(own[:-1], w.size, span))

    def values(self, fit: Fitted) -> dict[str, Value]:
        """`drift`: relative change of the gain over the record."""
        own = fit.theta_of(self)
        course = 1.0 + np.cos(own[-1]) * chebyshev_course(own[:-1], 101, 101)
        return {"drift": Value(float(course[-1] / course[0]) - 1.0, "1")}

    def planted(self, fit: Fitted, share: float) -> list[Planted]:
        """A gain that rises or falls by this share, about the mean input."""
        return [Planted("drift", {"shape1": 0.5 * sign * share, "angle": 0.0}) for sign in (1.0, -1.0)]


class GainStep(_GainOnce, GainDrift):
    """A gain of the actuator that changes once."""

    def alternatives(self, hypothesis: Structure) -> list[Effect]:
        """A change of the reading in place of that of the actuator."""
        return [ReadingStep("step")]

    def starts(self, context: Context) -> list[FloatArray]:
        """Instants at which such a change reduces the residual most."""
        plant, rates, w = Plant(), np.log(context.highpass_rates), context.actuator

        def columns_of(after: NDArray[np.bool_]) -> FloatArray:
            return np.hstack([plant.load_response(rates, np.where(after, x, 0.0)) for x in (w, np.ones(w.size))])

        def response(x: FloatArray) -> FloatArray:
            return section(*context.highpass_rates, x - x[0])[:, 0]

        return _step_starts(context, response(w), columns_of, response, w)

    def apply(self, w: FloatArray, own: FloatArray, span: int) -> FloatArray:
        """The command, changed."""
        return self.changed(w, own, span)


class ReadingStep(_GainOnce, OutputEffect):
    """A gain of the reading that changes once: another range, a new calibration."""

    name = "parameter-drift"
    key_form = "reading-{}"
    position: ClassVar[int] = 3

    def alternatives(self, hypothesis: Structure) -> list[Effect]:
        """A change of the gain of the actuator."""
        return [GainStep("step")]

    def starts(self, context: Context) -> list[FloatArray]:
        """Instants at which such a change reduces the residual most."""
        x = context.parent.output

        def columns_of(after: NDArray[np.bool_]) -> FloatArray:
            return np.column_stack([np.where(after, x, 0.0), after.astype(np.float64)])

        return _step_starts(context, x, columns_of, lambda one: one, x)

    def apply(self, z: FloatArray, own: FloatArray) -> FloatArray:
        """The reading, changed."""
        return self.changed(z, own, z.size)

    def slope(self, z: FloatArray, own: FloatArray) -> FloatArray:
        """The gain of the reading."""
        onset, size, angle = own
        return np.asarray(1.0 + size * np.cos(angle) * step_signal(float(onset), z.size, z.size))


def _step_starts(
    context: Context,
    response: FloatArray,
    columns_of: Callable[[NDArray[np.bool_]], FloatArray],
    passed: Callable[[FloatArray], FloatArray],
    signal: FloatArray,
) -> list[FloatArray]:
    """Instants, relative changes and angles at which a signal changes its gain, by least squares on the output."""
    samples, rows = context.data.samples, context.data.rows
    starts = []
    for at in best_onsets(context, 3, columns_of):
        after = np.arange(samples) >= at * samples
        changed = [passed(np.where(after, x, 0.0)) for x in (signal, np.ones(samples))]
        columns = np.column_stack([response, *changed, np.ones(samples)])[rows]
        if not np.isfinite(columns).all():
            continue
        gain, change, offset, _ = np.linalg.lstsq(columns, context.data.y[rows], rcond=1e-6)[0]
        if gain:
            angle = float(np.arctan(offset / change)) if change else 0.0
            size = change / gain / max(float(np.cos(angle)), MIN_COSINE)
            starts.append(np.array([at, np.clip(size, -2.0, 2.0), angle]))
    return starts


def _linear_response(fit: ParentFit, w: FloatArray) -> FloatArray:
    """Response of the linear dynamics of a fit to a signal, up to a gain."""
    return section(*fit.rates, w - w[0])[:, 0]
