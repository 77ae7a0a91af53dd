"""Parameters of the rig that drift slowly during the record."""

from typing import ClassVar

import numpy as np

from labsid._arrays import FloatArray
from labsid.gap.dynamics._rates import changed_rates
from labsid.gap.dynamics.plant_form import Parameter
from labsid.gap.dynamics.plants import Plant
from labsid.gap.dynamics.responses import chebyshev_course, comes_to_rest, decay_rates, section
from labsid.gap.effects.base import Effect, Fitted, InputEffect, Planted, PlantEffect, Value
from labsid.gap.effects.context import Context, ParentFit, Structure
from labsid.gap.effects.description import Description, Reported
from labsid.gap.effects.sketch import Sketch, nothing

MIN_COSINE = 0.05  # smallest cosine of the neutral-input angle: the neutral input lies within 20 scaled units


class PoleDrift(PlantEffect):
    """A slow drift of a pole, possibly with the gain."""

    name = "parameter-drift"
    description = Description(
        path="dynamics",
        noun="a drift of the parameters",
        clauses=(
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
            "drift": Reported("change of the gain over the record", "1", share=True),
            "pole": Reported("change of the speed of response over the record", "1", share=True),
        },
        confused_with=("output-drift", "load-step"),
        of_one_record=True,
        wanders=True,
        varies_in_time=True,
        sketch=Sketch(
            "Time",
            "t",
            "Change by the end, drawn straight, as a share",
            "",
            lambda x, p, seen: p.get("drift", p.get("pole", 0.0)) * (x - x[0]) / (x[-1] - x[0]),
            nothing,
            ("drift", "pole"),
        ),
    )
    key_form = "pole-{}"
    variants = ("1", "4")
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
        shape = np.array([fit.value("drift"), *(fit.value(f"bend{n}") for n in range(1, int(self.variant)))])
        ends = chebyshev_course(shape, 101, 101)[[0, -1]]
        if fit.hypothesis.plant.kind != "varying":
            return {"pole": Value(float(np.exp(ends[1] - ends[0])) - 1.0, "1")}
        c, k = (float(np.exp(fit.value(name))) for name in ("log_c", "log_k"))
        rates = np.array([changed_rates(c, k, fit.value("share_c"), float(np.expm1(at))) for at in ends])
        rests = all(comes_to_rest(float(c), float(k), fit.data.samples) for c, k in rates)
        position, speed = (fit.gains[n] + fit.gains[n + 2] * ends for n in (0, 1))
        gains = position / rates[:, int(rests)]
        turns = gains[0] * gains[1] <= 0.0
        found = {} if turns else {"drift": Value(float(gains[1] / gains[0]) - 1.0, "1")}
        if rests or turns:
            oscillates = turns or fit.hypothesis.plant.feedthrough or (rates[:, 0] ** 2 < 4.0 * rates[:, 1]).any()
            slowest = np.array([decay_rates(float(c), float(k))[0] for c, k in rates])
            delay = 1.0 / slowest if oscillates else rates[:, 0] / rates[:, 1] - speed / position
            delay = delay if delay.min() > 0.0 else 1.0 / slowest
            found["pole"] = Value(float(delay[0] / delay[1]) - 1.0, "1")
        return found

    def planted(self, fit: Fitted, share: float) -> list[Planted]:
        """A restoring rate that rises or falls by this factor."""
        half = 0.5 * float(np.log1p(share))
        return [
            Planted("pole", {"drift": way, "share_c": 1.0}, size=Value(float(np.expm1(2.0 * way)), "1"))
            for way in (half, -half)
        ]


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
    variants = ("1", "4")
    planted_variants = ("1",)
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


def _linear_response(fit: ParentFit, w: FloatArray) -> FloatArray:
    """Response of the linear dynamics of a fit to a signal, up to a gain."""
    return section(*fit.rates, w - w[0])[:, 0]
