"""Effects of the actuator, between the command and the dynamics."""

from collections.abc import Mapping
from dataclasses import replace
from typing import ClassVar

import numpy as np

from labsid._arrays import FloatArray
from labsid.gap.dynamics import _kernels
from labsid.gap.dynamics.plant_form import Parameter
from labsid.gap.dynamics.plants import Plant
from labsid.gap.effects import curves
from labsid.gap.effects.base import REST_SAMPLES, Fitted, InputEffect, Planted, Value
from labsid.gap.effects.context import Context, ParentFit, Structure
from labsid.gap.effects.description import Description, Reported
from labsid.gap.effects.limits import Limits
from labsid.gap.effects.sketch import Seen, Sketch, after_a_step, bent, clipped, same, step
from labsid.gap.record.data import Data

LONGEST_DELAY = 250.0  # samples; set by hand
LONGEST_SHARE = 0.25  # of the record; set by hand
LEAST_BAND = 0.005  # of the range of the command: change by a dead zone with two gains, beside a kink; set by hand
END = 0.02  # of the range of the command, from its ends: a dead zone with an edge there has one edge; set by hand
NEAR_ZERO = 0.04  # of the range of the command, whose end reaches zero if it is as near; set by hand
INITIAL_OFFSET = Parameter("before", -30.0, 30.0)  # of the actuator before the record, relative to the first command


class Delay(InputEffect):
    """Transport delay of the actuator path, in addition to the one sample of a strictly proper model.

    A numerator zero can mimic a fractional delay: with the `variant` "no-zero" the dynamics have none. With "switched"
    the input steps at sample 0; otherwise the rig was at steady state.
    """

    name = "input-delay"
    description = Description(
        path="input",
        noun="a transport delay",
        clauses=(
            "The rig responds to each command {delay} late",
            "The rig responds to each command late",
        ),
        meaning=(
            "The command reaches the process after this delay, in addition to the one sample of every sampled system."
            " Look for pipes, belts, buses and buffers."
        ),
        excited_by="Steps or fast changes of the input, sampled faster than the delay.",
        parameters={"delay": Reported("delay", "s")},
        confused_with=("extra-lag",),
        sketch=Sketch(
            "Time after a step of the command (s)",
            "s",
            "Step that acts, as a share",
            "",
            lambda x, p, seen: step(x - p["delay"], p, seen),
            step,
            ("delay",),
            reach=after_a_step("delay", 0.5, 2.5),
        ),
    )
    variants = ("", "no-zero")
    planted_variants = ("",)
    whole = "time"
    further: ClassVar[dict[str, tuple[str, ...]]] = {
        "": ("switched", "no-zero switched"),
        "no-zero": ("no-zero switched",),
    }
    position = 9

    def extend(self, plant: Plant) -> Plant:
        """Remove the numerator zero for the "no-zero" variants."""
        return plant.modified(zero=False) if self.variant.startswith("no-zero") else plant

    @property
    def parameters(self) -> tuple[Parameter, ...]:
        """Delay in samples, and for "switched" the command before the record."""
        own = (Parameter("delay", 0.0, LONGEST_DELAY, 0.02, leap=0.5),)
        return (*own, INITIAL_OFFSET) if self.variant.endswith("switched") else own

    def starts(self, context: Context) -> list[FloatArray]:
        """Delays in roughly geometric steps."""
        longest = min(LONGEST_DELAY, context.data.samples / 8)
        return [np.array([d]) for d in (1.0, 2.2, 4.0, 7.0, 12.0, 20.0, 35.0, 60.0, 100.0, 170.0) if d <= longest]

    def apply(self, w: FloatArray, own: FloatArray, span: int) -> FloatArray:
        """Return `w`: the hypothesis delays the signal after all other input effects."""
        return w

    def is_plausible(self, fit: Fitted) -> bool:
        """Reject delays over a quarter of the record: most of it would show no response."""
        return float(fit.theta_of(self)[0]) < LONGEST_SHARE * fit.data.samples

    def values(self, fit: Fitted) -> dict[str, Value]:
        """`delay` in seconds."""
        return {"delay": Value(float(fit.theta_of(self)[0]) * fit.data.Ts, "s")}

    def planted(self, fit: Fitted, share: float) -> list[Planted]:
        """A delay beyond the one of the simulation, up to the slowest time constant."""
        delay = min(share * fit.slowest_time, LONGEST_DELAY)
        return [Planted("delay", {"delay": float(fit.theta[0]) + delay}, size=Value(delay * fit.data.Ts, "s"))]


class Saturation(Limits, InputEffect):
    """The actuator saturates inside the commanded range; `variant` low, high or both."""

    name = "input-saturation"
    description = Description(
        path="input",
        noun="a limit of the actuator",
        clauses=(
            "The actuator saturates at {low} and at {high}",
            "The actuator goes no lower than {low}",
            "The actuator goes no higher than {high}",
            "The actuator saturates within the range of the command",
        ),
        meaning=(
            "Commands beyond the limit have the same effect as the limit. Check end stops, supply voltage and limits "
            "in the amplifier or its software."
        ),
        excited_by="An input that goes beyond the limit and back, with several levels inside it.",
        parameters={
            "low": Reported("lower limit", "u", position=True),
            "high": Reported("upper limit", "u", position=True),
        },
        confused_with=("input-nonlinearity", "output-saturation", "input-rate-limit"),
        shape_of_input=True,
        sketch=Sketch(
            "Command",
            "u",
            "Command that acts",
            "u",
            clipped,
            same,
            ("low", "high"),
            ("low", "high"),
        ),
    )
    signal, leap = "u", 0.05
    position = 1
    planted_variants = ("high", "low")

    def applies(self, context: Context) -> bool:
        """Require more levels than the gain and offset can absorb."""
        return context.levels.size > (3 if self.variant == "both" else 2)

    def starts(self, context: Context) -> list[FloatArray]:
        """Limits at 8, 22 and 40 % of the range from its ends."""
        low, high = float(context.data.u.min()), float(context.data.u.max())
        within = np.array([0.08, 0.22, 0.4]) * (high - low)
        return self.between(low + within, high - within)

    def apply(self, w: FloatArray, own: FloatArray, span: int) -> FloatArray:
        """Clip at the limits."""
        low, high = self.ends(own)
        return np.clip(w, np.minimum(low, high), np.maximum(low, high))

    def is_plausible(self, fit: Fitted) -> bool:
        """Reject a limit that the command exceeds while the rig is off: this is a dead zone."""
        u = fit.data.u
        return not fit.starts_at_rest or bool(self.apply(u[:1], fit.theta_of(self), u.size)[0] == u[0])

    def active_samples(self, fit: Fitted) -> np.ndarray:
        """The samples at which the command exceeds a limit."""
        return np.asarray(self.apply(fit.data.u, fit.theta_of(self), fit.data.samples) != fit.data.u)


def _side_about_zero(low: float, high: float, data: Data) -> str:
    """The seen edge, "low" or "high", of a band about the command zero that the command leaves there alone; else empty.

    The command reaches zero, and nothing beyond the mirrored edge is seen of such a band.
    """
    zero = data.zero_command
    least, most = float(data.u.min()), float(data.u.max())
    edge = END * (most - least)
    if low <= least + edge and high < most - edge:
        side, half, end = "high", high - zero, zero - least
    elif high >= most - edge and low > least + edge:
        side, half, end = "low", zero - low, most - zero
    else:
        return ""
    return side if half > 0.0 and -NEAR_ZERO * (most - least) <= end <= half + edge else ""


def _jump(name: str) -> Parameter:
    return Parameter(name, 0.0, 8.0, leap=0.1)


def _beyond_band(x: FloatArray, p: Mapping[str, float], seen: Seen) -> FloatArray:
    """The command beyond either end of the band that is known, with the steps there."""
    acting = np.zeros(x.size)
    if "high" in p:
        acting += np.where(x > p["high"], x - p["high"] + p.get("jump_high", 0.0), 0.0)
    if "low" in p:
        acting += np.where(x < p["low"], p.get("ratio", 1.0) * (x - p["low"]) - p.get("jump_low", 0.0), 0.0)
    return acting


class DeadZone(InputEffect):
    """A dead zone: no effect until the command leaves a band.

    With `variant` "jump" the command acts with a step of its own at either end of the band, as a drive that loses
    another voltage each way. "gain" scales the command below the band, as the other half of a bridge.
    """

    name = "input-dead-zone"
    description = Description(
        path="input",
        noun="a dead zone",
        clauses=(
            "The actuator does not move between {low} and {high}",
            "The actuator does not move until the command exceeds {high}",
            "The actuator does not move until the command falls below {low}",
            "The actuator does not move until the command leaves a band",
        ),
        meaning=(
            "Commands inside the band have no effect. Look for valve overlap, friction in the drive, or a threshold "
            "in the amplifier."
        ),
        excited_by="Small inputs on both sides of rest beside large ones.",
        parameters={
            "low": Reported("lower edge of the band", "u", position=True),
            "high": Reported("upper edge of the band", "u", position=True),
            "jump_low": Reported("step at the lower edge", "u"),
            "jump_high": Reported("step at the upper edge", "u"),
            "ratio": Reported("gain below the band over the gain above it", "1"),
        },
        confused_with=("coulomb-friction", "input-backlash", "input-nonlinearity"),
        shape_of_input=True,
        sketch=Sketch(
            "Command",
            "u",
            "Command that acts",
            "u",
            _beyond_band,
            lambda x, p, seen: x - np.mean([p[side] for side in ("low", "high") if side in p]),
            ("low", "high"),
            ("low", "high"),
        ),
    )
    least_levels = 3
    position = 4
    planted_variants = ("",)
    richer: ClassVar[dict[str, tuple[str, ...]]] = {"": ("jump", "gain")}

    @property
    def parameters(self) -> tuple[Parameter, ...]:
        """Ends of the band in the scaled input; the steps at its ends, or the logarithm of the ratio of the gains."""
        ends = (Parameter("low", -8.0, 8.0, leap=0.1), Parameter("high", -8.0, 8.0, leap=0.1))
        richer = {"jump": (_jump("jump_low"), _jump("jump_high")), "gain": (Parameter("log_ratio", -3.0, 3.0),)}
        return (*ends, *richer.get(self.variant, ()))

    def starts(self, context: Context) -> list[FloatArray]:
        """Narrow and wide bands around the first input, the mid-range and the median; about zero at an end."""
        u = context.data.u
        low, high = float(u.min()), float(u.max())
        middles = dict.fromkeys((round(float(u[0]), 6), 0.5 * (low + high), float(np.median(u))))
        starts = []
        for middle in middles:
            for half in (0.08, 0.2):
                pair = np.clip([middle - half * (high - low), middle + half * (high - low)], low, high)
                starts.append(pair)
        zero = context.data.zero_command
        edges = [end + sign * share * (high - low) for end, sign in ((low, 1.0), (high, -1.0)) for share in (0.1, 0.25)]
        mirrored = [(min(edge, 2.0 * zero - edge), max(edge, 2.0 * zero - edge)) for edge in edges]
        one_edged = [pair for pair in mirrored if _side_about_zero(*pair, context.data)]
        return [*starts, *map(np.array, one_edged)]

    def apply(self, w: FloatArray, own: FloatArray, span: int) -> FloatArray:
        """Zero within the band, distance from the band outside."""
        low, high = min(own[:2]), max(own[:2])
        above, below = np.maximum(w - high, 0.0), np.minimum(w - low, 0.0)
        if self.variant == "jump":
            return above + below + own[3] * (w > high) - own[2] * (w < low)
        return above + below * float(np.exp(own[2:].sum()))

    def active_samples(self, fit: Fitted) -> np.ndarray:
        """The samples at which the command is within the band."""
        return np.asarray(self.apply(fit.data.u, fit.theta_of(self), fit.data.samples) == 0.0)

    def is_plausible(self, fit: Fitted) -> bool:
        """Reject a band that reaches the end of the input's range (a limit), unless rest lies there.

        The rig is at rest at that end, or the command zero is the middle of the band. With another gain below it, a
        band within which no command tells it from a kink is no dead zone.
        """
        low, high = sorted(fit.theta_of(self)[:2])
        if self.variant == "gain" and not self._is_no_kink(fit):
            return False
        u = fit.data.u
        edge = END * float(np.ptp(u))
        inside = low > u.min() + edge and high < u.max() - edge
        at_end = u[0] < u.min() + edge if low <= u.min() + edge else u[0] > u.max() - edge
        at_rest = bool(np.all(u[:REST_SAMPLES] == u[0])) and low <= u[0] <= high and at_end
        return bool(high > low and (inside or at_rest or _side_about_zero(low, high, fit.data)))

    def _is_no_kink(self, fit: Fitted) -> bool:
        """Whether some command is where the band differs from its two straight lines, drawn to their crossing."""
        own, u = fit.theta_of(self), fit.data.u
        (low, high), ratio = sorted(own[:2]), float(np.exp(own[2]))
        above, below = u - high, ratio * (u - low)
        crossing = (high - ratio * low) / (1.0 - ratio) if ratio != 1.0 else np.inf
        kinked = np.where(u > crossing, above, below)
        change = np.abs(kinked - self.apply(u, own, fit.data.samples))
        return not np.isfinite(crossing) or bool(change.max() > LEAST_BAND * np.ptp(u))

    def completed(self, own: FloatArray, data: Data) -> tuple[FloatArray, int]:
        """Own parameters; an end of the band that the command never reaches mirrors the other one about rest.

        Rest is the first command, if the rig is at rest at an end of the range, else the command zero.
        """
        low, high = sorted(own[:2])
        u = data.u
        at_end = u[0] == u.min() or u[0] == u.max()
        if at_end and np.all(u[:REST_SAMPLES] == u[0]) and low <= u[0] <= high:
            rest, seen = float(u[0]), "high" if u[0] == u.min() else "low"
        else:
            rest, seen = data.zero_command, _side_about_zero(low, high, data)
            if not seen:
                return own, 0
        ends = (2.0 * rest - high, high) if seen == "high" else (low, 2.0 * rest - low)
        steps = np.full(2, own[3] if seen == "high" else own[2]) if self.variant == "jump" else np.zeros(own.size - 2)
        return np.concatenate([np.clip(ends, -8.0, 8.0), steps]), 1 + len(steps) // 2 + (self.variant == "gain")

    def values(self, fit: Fitted) -> dict[str, Value]:
        """`low` and `high` as inputs, and what differs by side, without a side that the record does not reach."""
        low, high = sorted(fit.theta_of(self)[:2])
        u = fit.data.u
        sides = [side for side, reached in (("low", low >= u.min()), ("high", high <= u.max())) if reached]
        ends = {"low": low, "high": high}
        values = {side: Value(fit.u(ends[side]), "u") for side in sides}
        for parameter, value in zip(self.parameters[2:], fit.theta_of(self)[2:], strict=True):
            if parameter.name == "log_ratio" and len(sides) == 2:
                values["ratio"] = Value(float(np.exp(value)), "1")
            elif parameter.name in {f"jump_{side}" for side in sides}:
                values[parameter.name] = Value(float(value) * fit.data.u_scale.unit, "u")
        return values

    def planted(self, fit: Fitted, share: float) -> list[Planted]:
        """A band about the first input, and about the middle of its range; its size is the width.

        About zero in a given simulation, which has no free offset at its input.
        """
        u, half = fit.data.u, 0.5 * share * fit.input_range
        width = Value(2.0 * half * fit.data.u_scale.unit, "u")
        given = fit.hypothesis.plant.kind == "given"
        middles = [0.0] if given else dict.fromkeys((float(u[0]), 0.5 * float(u.min() + u.max())))
        return [Planted("width", {"low": at - half, "high": at + half}, size=width) for at in middles]


class Backlash(InputEffect):
    """Backlash of a given width."""

    name = "input-backlash"
    description = Description(
        path="input",
        noun="backlash",
        clauses=(
            "The actuator crosses a play of {width} at each change of direction",
            "The actuator crosses a play at each change of direction",
        ),
        meaning=(
            "After each change of direction the command must cross the play before the actuator follows. Check gears,"
            " couplings and valve stems."
        ),
        excited_by="Changes of direction after small and after large changes of the input.",
        parameters={"width": Reported("play", "u")},
        confused_with=("input-dead-zone", "coulomb-friction", "input-delay"),
        sketch=Sketch(
            "Command",
            "u",
            "Command that acts",
            "u",
            lambda x, p, seen: _kernels.backlash(x, p["width"], 0.5),
            same,
            ("width",),
            loop=True,
        ),
    )
    least_levels = 3
    position = 5
    planted_variants = ("",)

    @property
    def parameters(self) -> tuple[Parameter, ...]:
        """Width of the backlash, and initial position within it."""
        return (Parameter("width", 0.0, 8.0, leap=0.05), Parameter("position", 0.0, 1.0, 0.02))

    def starts(self, context: Context) -> list[FloatArray]:
        """Narrow to wide, with an initial position in the middle."""
        span = float(np.ptp(context.data.u))
        return [np.array([part * span, 0.5]) for part in (0.06, 0.15, 0.35)]

    def apply(self, w: FloatArray, own: FloatArray, span: int) -> FloatArray:
        """Follow the command once the backlash is taken up."""
        return _kernels.backlash(w, float(own[0]), float(own[1]))

    def values(self, fit: Fitted) -> dict[str, Value]:
        """`width` in the unit of the input."""
        return {"width": Value(float(fit.theta_of(self)[0]) * fit.data.u_scale.unit, "u")}

    def planted(self, fit: Fitted, share: float) -> list[Planted]:
        """Backlash up to the range of the input."""
        return [Planted("width", {"width": share * fit.input_range, "position": 0.5})]


class RateLimit(InputEffect):
    """A limit of the slew rate; with `variant` "behind" it follows the dead zone and the backlash.

    With "switched" the actuator's initial position differs from the first command. "timed" preserves the first moment
    of the signal within each sample in addition to its mean, by moving half of the moment to each of the neighbouring
    samples. That is inaccurate for dynamics that follow their input within a sample. "uneven" has another rate towards
    smaller values, as valves with a spring and motors that coast.
    """

    name = "input-rate-limit"
    description = Description(
        path="input",
        noun="a rate limit of the actuator",
        clauses=(
            "The actuator moves up no faster than {rate}, and down no faster than {rate_down}",
            "The actuator moves no faster than {rate}",
            "The actuator moves more slowly than the command",
        ),
        meaning=(
            "The actuator follows fast changes of the command at a limited rate. Check motor-driven valves and ramps "
            "in the drive's software."
        ),
        excited_by="Steps of different sizes: the larger ones are slower.",
        parameters={"rate": Reported("largest rate", "u/s"), "rate_down": Reported("largest rate downwards", "u/s")},
        confused_with=("extra-lag", "input-saturation"),
        sketch=Sketch(
            "Time after a step over the range of the command (s)",
            "s",
            "Change of the command that acts",
            "u",
            lambda x, p, seen: np.clip(p["rate"] * x, 0.0, np.ptp(seen.u)),
            lambda x, p, seen: np.ptp(seen.u) * step(x, p, seen),
            ("rate",),
            reach=lambda p, seen: (-0.3 * float(np.ptp(seen.u)) / p["rate"], 1.5 * float(np.ptp(seen.u)) / p["rate"]),
        ),
    )
    position = 2
    variant_positions: ClassVar[dict[str, int]] = {"behind": 6}
    further: ClassVar[dict[str, tuple[str, ...]]] = {"": ("switched", "timed")}
    richer: ClassVar[dict[str, tuple[str, ...]]] = {"": ("uneven", "uneven-timed")}
    places = ("", "behind")
    planted_variants = ("",)
    whole = "time"

    @property
    def parameters(self) -> tuple[Parameter, ...]:
        """Logarithm of the rate in scaled input per sample, or of both; for "switched" the initial offset."""
        own = Parameter("log_rate", -9.0, 3.0, leap=0.1)
        if self.uneven:
            return (own, replace(own, name="log_rate_down"))
        return (own, INITIAL_OFFSET) if self.variant == "switched" else (own,)

    @property
    def uneven(self) -> bool:
        """Whether the rate downwards is another one."""
        return self.variant in ("uneven", "uneven-timed")

    def carry_over(self, fit: ParentFit, hypothesis: Structure, theta: FloatArray) -> None:
        """Begin with equal rates."""
        known = any(parameter.name == "log_rate_down" for parameter in fit.hypothesis.parameters)
        if self.uneven and not known:
            first = hypothesis.slices[self.key].start
            theta[first + 1] = theta[first]

    def starts(self, context: Context) -> list[FloatArray]:
        """Rates as shares of the largest input step."""
        largest = float(np.abs(np.diff(context.data.u)).max())
        return [np.array([np.log(part * largest)]) for part in (0.6, 0.25, 0.08, 0.03)]

    def apply(self, w: FloatArray, own: FloatArray, span: int) -> FloatArray:
        """Limit the slew rate."""
        up, down = self._rates(own)
        start = float(w[0] + own[1]) if self.variant == "switched" else float(w[0])
        mean, moment = _kernels.rate_limit(w, up, down, start)
        if self.variant in ("timed", "uneven-timed"):
            mean[1:] += 0.5 * moment[:-1]
            mean[:-1] -= 0.5 * moment[1:]
        return np.asarray(mean)

    def values(self, fit: Fitted) -> dict[str, Value]:
        """`rate` in units of the input per second, upwards if `rate_down` is another one."""
        unit = fit.data.u_scale.unit / fit.data.Ts
        up, down = self._rates(fit.theta_of(self))
        return {"rate": Value(up * unit, "u/s")} | ({"rate_down": Value(down * unit, "u/s")} if self.uneven else {})

    def _rates(self, own: FloatArray) -> tuple[float, float]:
        """Largest rates upwards and downwards, in scaled input per sample."""
        return float(np.exp(own[0])), float(np.exp(own[1 if self.uneven else 0]))

    def planted(self, fit: Fitted, share: float) -> list[Planted]:
        """A rate at which the largest step of the input takes up to the slowest time constant."""
        rate = float(np.abs(np.diff(fit.data.u)).max()) / (share * fit.slowest_time)
        return [Planted("rate", {"log_rate": float(np.log(rate))})]


class Nonlinearity(curves.Curve, InputEffect):
    """A smooth static actuator curve: w = u + c2 u^2 + c3 u^3 about the mean input of the record.

    It is the last element of the actuator, as of a valve or pump; with `variant` "first" it is the first one. "rich" is
    a spline.
    """

    name = "input-nonlinearity"
    description = Description(
        path="input",
        noun="a curved characteristic of the actuator",
        clauses=("The gain of the actuator changes with the size of the command",),
        meaning=(
            "The same step of the command has more effect in one part of its range than in another. Check the "
            "characteristic of the pump, the valve or the amplifier. With d the command minus the centre of the "
            "curve, the actuator gives d + (quadratic coefficient) d² + (cubic coefficient) d³."
        ),
        excited_by="Many levels of the input over its range.",
        parameters={
            "c2": Reported("quadratic coefficient", "1/u"),
            "c3": Reported("cubic coefficient", "1/u^2"),
            "centre": Reported("centre of the curve", "u", position=True),
        },
        confused_with=("output-nonlinearity", "sqrt-outflow", "input-saturation"),
        smooth_law=True,
        shape_of_input=True,
        sketch=Sketch(
            "Command",
            "u",
            "Command that acts",
            "u",
            bent,
            same,
            ("c2",),
        ),
    )
    least_levels = 3
    position = 7
    variant_positions: ClassVar[dict[str, int]] = {"first": 0}
    signal = "u"
    places = ("", "first")

    def starts(self, context: Context) -> list[FloatArray]:
        """Small positive and negative values of either coefficient."""
        return [np.array(pair) for pair in ((0.1, 0.0), (-0.1, 0.0), (0.0, 0.1), (0.0, -0.1))]

    def apply(self, w: FloatArray, own: FloatArray, span: int) -> FloatArray:
        """Value of the curve."""
        return curves.evaluate(w, own)
