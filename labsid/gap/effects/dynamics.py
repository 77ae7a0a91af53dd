"""Effects inside the dynamics."""

from collections.abc import Mapping
from typing import ClassVar

import numpy as np

from labsid._arrays import FloatArray, stretches_of
from labsid.gap.dynamics.plants import Plant
from labsid.gap.dynamics.responses import damping_ratio, denominator, lag_mean, mode_mean, real_rates, single_pole
from labsid.gap.effects.base import Fitted, Planted, PlantEffect, Value
from labsid.gap.effects.context import Context, rise
from labsid.gap.effects.description import Description, Reported
from labsid.gap.effects.sketch import Seen, Sketch, after_a_step, nothing, same, step

LEAST_DAMPING = 2e-3  # of a mode; set by hand
MOST_DAMPING = 0.3
"""Of a mode that is lightly damped; the slower pair of a fourth-order Butterworth has 0.38; set by hand."""
MAX_MODE_DAMPING = 0.2  # of parent dynamics that may be a mode; set by hand
SINGLE_POLE_RATIO = 3.0  # frequency of such a mode over the pole that is tried for the rig; numerics
PLANTED_DAMPING = 0.05  # of a mode whose visibility is asked for; set by hand
PLANTED_SLOW_RATIO = 4.0  # time constant of such a slow mode over the slowest one; set by hand
PEAKS = 3  # of a spectrum, from which a mode or a sinusoid starts; numerics
MIN_CYCLES = 4.0  # of a mode, in the record; set by hand
MAX_UNSPRUNG_RATE = 40.0  # slow pole times record length, below which the spring is not observable; set by hand
SLACK_LOG_STIFFNESS = -6.0  # change of the logarithm of the stiffness for a start without a spring; numerics
REST = 1e-4  # of the largest speed, below which a mass is at rest; set by hand
SHORTEST_REST = 3  # samples of a rest; set by hand
MIN_STOPS = 2  # rests of a mass between motions, in one direction or both; set by hand
MIN_EITHER_DIRECTION = 0.03  # share of the record with motion in each direction; set by hand
FULL_FRICTION = 1.5  # times the speed over which friction is smooth: there it has nine tenths of its size; definition
CREEP = 0.01  # of the largest speed: a slower motion is none; set by hand
MIN_PARALLEL_SHARE = 0.03  # of the static gain, of a slow mode; set by hand
MAX_PARALLEL_SHARE = 0.85  # of poles in series, the slowest has a share of one or more; set by hand
MIN_SLOW_TIMES = 1.5  # time constants of a slow mode in the record; set by hand
MAX_SLOW_RATIO = 0.8  # rate of a slow mode over the slower one of the other poles; set by hand
WHITE = 3.0  # standard errors of the autocorrelation of a white residual; statistics: .3 % of white ones are beyond
MIN_DRIVEN_WHITE = 0.1  # the same as below, where white noise is all that is left; set by hand
MIN_DRIVEN = 0.25  # spread of a slow mode's response to the input over that of its free response; set by hand
CYCLES_SHOWN = 5.0  # of a mode, in its sketch; set by hand
PEAK_SHOWN = 0.1  # of the range of the speed, over which the friction of a sketch falls from its peak; set by hand
STATIC_SAMPLES = 20000  # of a step, for the static gain; numerics


class Placed(PlantEffect):
    """Additional linear dynamics whose position `variant` states."""

    planted_variants = ("",)
    whole = "time"
    before_given = True

    def passed(self, w: FloatArray, own: Mapping[str, float]) -> FloatArray:
        """Mean over each sample of the signal `w` behind these dynamics, from rest."""
        raise NotImplementedError

    def applies(self, context: Context) -> bool:
        """Variants differ only with a nonlinear state; a given simulation has one ahead of it, or a mode beside it."""
        plant = context.parent.hypothesis.plant
        return not self.variant or plant.nonlinear or (plant.kind == "given" and self.variant == "beside")


class ExtraLag(Placed):
    """An additional real pole; with `variant` "ahead" it precedes a nonlinear state."""

    name = "extra-lag"
    description = Description(
        path="dynamics",
        noun="an extra lag",
        clauses=(
            "There is an additional lag of {tau} between command and record",
            "There is an additional lag between command and record",
        ),
        meaning=(
            "Actuator, process, sensor or a filter smooths the signal with this time constant; the record does not "
            "show which."
        ),
        excited_by="An input with energy near the inverse of the time constant.",
        parameters={"tau": Reported("time constant", "s")},
        confused_with=("input-delay", "resonance"),
        adds_poles=True,
        sketch=Sketch(
            "Time after a step (s)",
            "s",
            "Step behind the lag, as a share",
            "",
            lambda x, p, seen: -np.expm1(-np.maximum(x, 0.0) / p["tau"]),
            step,
            ("tau",),
            reach=after_a_step("tau", 0.5, 5.0),
        ),
    )
    variants = places = ("", "ahead")

    def extend(self, plant: Plant) -> Plant:
        """The plant with an additional real pole."""
        return plant.modified(lag=self.variant or "behind")

    def plant_starts(self, context: Context) -> list[dict[str, float]]:
        """Time constants shorter and longer than those of the parent."""
        c, k = context.rates
        slow, fast = real_rates(c, k)
        times = dict.fromkeys(np.clip(np.log([0.6 / fast, 2.0 / fast, 0.5 / slow]), -1.0, 7.0))
        beside = [{"log_lag": float(time)} for time in times]
        # Two poles fitted to a third-order plant lie between its slowest pole and the others.
        slower = {"log_lag": float(np.clip(-np.log(slow), -1.0, 7.0)), "log_c+": 0.5, "log_k+": 1.0}
        return [*beside, slower] if context.parent.hypothesis.plant.kind == "linear" else beside

    def is_plausible(self, fit: Fitted) -> bool:
        """Reject a lag whose free response exceeds its response to the input: it imitates a drift."""
        plant = fit.hypothesis.plant
        if plant.lag_ahead:
            return True
        if plant.kind == "linear" and is_parallel(fit):
            return False  # a slow mode
        columns = plant.columns(fit.plant_theta, fit.actuator, fit.data.samples)
        parts = columns * fit.gains[: columns.shape[1]]
        at = 0 if plant.kind != "linear" else 5 if plant.zero else 4
        passed, free = at, at + 1
        return bool(np.std(parts[:, passed]) > np.std(parts[:, free]))

    def values(self, fit: Fitted) -> dict[str, Value]:
        """`tau` in seconds."""
        return {"tau": Value(float(np.exp(fit.value("log_lag"))) * fit.data.Ts, "s")}

    def passed(self, w: FloatArray, own: Mapping[str, float]) -> FloatArray:
        """Behind the lag."""
        return lag_mean(w, float(np.exp(own["log_lag"])))

    def planted(self, fit: Fitted, share: float) -> list[Planted]:
        """A lag up to the slowest time constant."""
        return [Planted("tau", {"log_lag": float(np.log(share * fit.slowest_time))})]


class SlowMode(PlantEffect):
    """A slow real pole in parallel to the other dynamics, such as creep or warming up."""

    name = "slow-mode"
    description = Description(
        path="dynamics",
        noun="a slow mode",
        clauses=(
            "A share of {share:%} of the response comes with a time constant of {tau}",
            "A part of the response comes much later than the rest",
        ),
        meaning=(
            "After each step the output goes on creeping when the fast response has ended, or back, if the share is "
            "negative. Look for parts that warm up, creep of polymers, and a second volume beside the first."
        ),
        excited_by=(
            "Steps after which the input rests for several of the long time constants, and fast changes as well."
        ),
        parameters={
            "tau": Reported("time constant", "s"),
            "share": Reported("share of the static gain", "1", share=True),
        },
        confused_with=("extra-lag", "output-drift", "load-step"),
        adds_poles=True,
        sketch=Sketch(
            "Time after a step (s)",
            "s",
            "Response, as a share of the final one",
            "",
            lambda x, p, seen: step(x, p, seen) - p["share"] * np.exp(-np.maximum(x, 0.0) / p["tau"]) * (x >= 0.0),
            step,
            ("tau",),
            reach=after_a_step("tau", 0.3, 4.0),
        ),
    )
    planted_variants = ("",)
    whole = "gain"
    before_given = True

    def extend(self, plant: Plant) -> Plant:
        """The plant with a slow pole in parallel."""
        return plant.modified(slow=True)

    def plant_starts(self, context: Context) -> list[dict[str, float]]:
        """Time constants longer than those of the parent."""
        slow = real_rates(*context.rates)[0]
        longest = np.log(context.data.samples / 2.0)
        times = dict.fromkeys(float(np.clip(np.log(n / slow), 0.0, longest)) for n in (2.0, 6.0, 20.0))
        # Two poles fitted to dynamics with a slow mode are slower than those of the dynamics alone.
        faster = {"log_slow": float(np.clip(-np.log(slow), 0.0, longest)), "log_c+": 0.7, "log_k+": 1.4}
        beside = [{"log_slow": time} for time in times]
        return [*beside, faster] if context.parent.hypothesis.plant.kind == "linear" else beside

    def is_plausible(self, fit: Fitted) -> bool:
        """Require a pole that is slower than the others and visible in the record, with a small share of the gain."""
        rate = float(np.exp(-fit.value("log_slow")))
        if rate * fit.data.samples < MIN_SLOW_TIMES or rate > MAX_SLOW_RATIO * real_rates(*_main_rates(fit))[0]:
            return False
        share = self._share(fit)
        return bool(abs(share) > MIN_PARALLEL_SHARE and share < MAX_PARALLEL_SHARE and self._is_driven(fit))

    def _is_driven(self, fit: Fitted) -> bool:
        """Whether the input excites the mode, and not its initial state alone, which imitates a drift."""
        plant, at = fit.hypothesis.plant, fit.hypothesis.plant.slow_column
        columns = plant.columns(fit.plant_theta, fit.actuator, fit.data.samples)[:, at : at + 2]
        driven, free = np.std(columns * fit.gains[at : at + 2], axis=0)
        e = (fit.data.y - fit.output)[fit.data.rows]
        white = abs(e[1:] @ e[:-1]) < WHITE * (e @ e) / np.sqrt(e.size)
        return bool(driven > (MIN_DRIVEN_WHITE if white else MIN_DRIVEN) * free)

    def _share(self, fit: Fitted) -> float:
        """Share of the static gain of the dynamics: a step of the command may be lost in backlash or a dead zone."""
        plant, step = fit.hypothesis.plant, np.repeat((0.0, 1.0), STATIC_SAMPLES)
        stepped, resting = (plant.columns(fit.plant_theta, w, step.size) for w in (step, np.zeros(step.size)))
        whole = rise((stepped - resting)[STATIC_SAMPLES - 1 :] @ fit.gains[: stepped.shape[1]])
        return float(fit.gains[plant.slow_column]) / whole if whole else np.inf

    def values(self, fit: Fitted) -> dict[str, Value]:
        """`tau` in seconds, and `share` of the static gain."""
        tau = float(np.exp(fit.value("log_slow"))) * fit.data.Ts
        return {"tau": Value(tau, "s"), "share": Value(self._share(fit), "1")}

    def planted(self, fit: Fitted, share: float) -> list[Planted]:
        """A share of the gain that settles a few times more slowly."""
        time = min(PLANTED_SLOW_RATIO * fit.slowest_time, fit.data.samples / (2.0 * MIN_SLOW_TIMES))
        gain = share * fit.range / fit.input_range
        return [Planted("share", {"log_slow": float(np.log(time))}, (gain, 0.0), Value(share, "1"))]


def _main_rates(fit: Fitted) -> tuple[float, float]:
    return fit.hypothesis.plant.linear_rates(fit.plant_theta)


def is_parallel(fit: Fitted) -> bool:
    """Whether linear dynamics with a lag are dynamics with a slow mode: by the share of the slowest of three poles.

    For 1 / ((T1 s + 1) (T2 s + 1) (T3 s + 1)) and the largest T1 that share is T1^2 / ((T1 - T2) (T1 - T3)), which is
    one or more. The mode adds a zero near the pole, and the share is less.
    """
    plant, (c, k) = fit.hypothesis.plant, _main_rates(fit)
    rate = float(np.exp(-fit.value("log_lag")))
    lag = float(fit.gains[5 if plant.zero else 4])
    a1, a2 = denominator(c, k)
    whole = lag + (float(fit.gains[:2].sum()) / (1.0 + a1 + a2) if plant.zero else float(fit.gains[0]))
    share = lag / (whole or np.inf)
    oscillates = c * c <= 4.0 * k
    if (0.5 * c if oscillates else real_rates(c, k)[0]) < rate:  # one of the main poles is the slowest, or both
        if oscillates or not plant.zero:
            return False
        slow, fast = np.exp(-np.array(real_rates(c, k)))
        share = float((fit.gains[0] * slow + fit.gains[1]) / ((slow - fast) * (1.0 - slow) * (whole or np.inf)))
    return abs(share) > MIN_PARALLEL_SHARE and share < MAX_PARALLEL_SHARE


class DirectFeedthrough(PlantEffect):
    """Response of the output within the sample in which the input changes, as of an acceleration to a force.

    It belongs to the structure of a linear model, and is not an effect that is found.
    """

    name = "direct-feedthrough"

    def extend(self, plant: Plant) -> Plant:
        """The plant with a gain from its input to its output."""
        return plant.modified(feedthrough=True)


def _swing(x: FloatArray, p: Mapping[str, float], seen: Seen) -> FloatArray:
    """A unit step behind a mode of second order."""
    damping, t = min(p["damping"], 0.999), 2.0 * np.pi * p["frequency"] * np.maximum(x, 0.0)
    damped = np.sqrt(1.0 - damping**2)
    return np.asarray(1.0 - np.exp(-damping * t) * (np.cos(damped * t) + damping / damped * np.sin(damped * t)))


class Resonance(Placed):
    """An unmodelled, lightly damped mode; `variant` "ahead" or "beside" states its position to a nonlinear state."""

    name = "resonance"
    description = Description(
        path="dynamics",
        noun="a lightly damped mode",
        clauses=(
            "The rig oscillates at {frequency} with a damping ratio of {damping}",
            "The rig oscillates after each change",
        ),
        meaning=(
            "Each change of the input or load excites a decaying oscillation. Look for flexible shafts, belts, "
            "supports, or sloshing."
        ),
        excited_by="Steps, or an input with energy near the frequency of the mode.",
        parameters={
            "frequency": Reported("frequency", "Hz"),
            "damping": Reported("damping ratio", "1"),
        },
        confused_with=("extra-lag", "periodic-disturbance"),
        adds_poles=True,
        sketch=Sketch(
            "Time after a step (s)",
            "s",
            "Step behind the mode, as a share",
            "",
            _swing,
            step,
            ("frequency",),
            reach=lambda p, seen: (-0.5 / p["frequency"], CYCLES_SHOWN / p["frequency"]),
        ),
    )
    variants = places = ("", "ahead", "beside")

    def extend(self, plant: Plant) -> Plant:
        """The plant with an additional pair of poles."""
        return plant.modified(mode=self.variant or "behind")

    def plant_starts(self, context: Context) -> list[dict[str, float]]:
        """Peaks in the spectrum of the residual, two fixed frequencies, and the poles of a lightly damped parent."""
        beside = [_mode(w, 0.08) for w in peaks(context, 0.02)] + [_mode(w, 0.15) for w in (0.15, 0.5)]
        w, damped = float(np.sqrt(context.rates[1])), damping_ratio(*context.rates)
        if (
            context.parent.hypothesis.plant.kind != "linear"
            or not LEAST_DAMPING < damped < MAX_MODE_DAMPING
            or w > np.pi
        ):
            return beside
        log_c, log_k = np.log(single_pole(w / SINGLE_POLE_RATIO)).tolist()
        return [*beside, {"log_c": log_c, "log_k": log_k} | _mode(w, damped)]

    def is_plausible(self, fit: Fitted) -> bool:
        """Reject a few cycles per record (a drift) and no damping (a periodic disturbance)."""
        swings = float(np.exp(fit.value("log_frequency"))) * fit.data.samples / (2.0 * np.pi)
        return swings > MIN_CYCLES and float(np.exp(fit.value("log_damping"))) > LEAST_DAMPING

    def values(self, fit: Fitted) -> dict[str, Value]:
        """`frequency` in hertz, and `damping`."""
        frequency = float(np.exp(fit.value("log_frequency"))) / (2.0 * np.pi * fit.data.Ts)
        return {
            "frequency": Value(frequency, "Hz"),
            "damping": Value(float(np.exp(fit.value("log_damping"))), "1"),
        }

    def passed(self, w: FloatArray, own: Mapping[str, float]) -> FloatArray:
        """Behind the mode."""
        return mode_mean(w, float(np.exp(own["log_frequency"])), float(np.exp(own["log_damping"])))

    def planted(self, fit: Fitted, share: float) -> list[Planted]:
        """A mode whose radian takes up to the slowest time constant, if it is slower than the sampling."""
        frequency = 1.0 / (share * fit.slowest_time)
        return [Planted("frequency", _mode(frequency, PLANTED_DAMPING))] if frequency < np.pi else []


def _mode(frequency: float, damped: float) -> dict[str, float]:
    """Start values of a mode."""
    return {"log_frequency": float(np.log(frequency)), "log_damping": float(np.log(damped))}


def peaks(context: Context, slowest: float) -> list[float]:
    """Frequencies (rad per sample) of the highest narrow peaks in the spectrum of the residual, up to half the rate of
    the readings: a peak above is the image of one below.
    """
    e = context.residual
    padded = 1 << int(np.ceil(np.log2(4 * e.size)))
    power = np.abs(np.fft.rfft((e - e[context.data.rows].mean()) * np.hanning(e.size), padded)) ** 2
    w = 2.0 * np.pi * np.arange(power.size) / padded
    # Relative to the neighbourhood: slow drifts dominate the absolute spectrum.
    width = max(9, 24 * padded // e.size // 2 * 2 + 1)
    log_power = np.log(power + 1e-300)
    smooth = np.convolve(log_power, np.ones(width) / width, mode="same")
    height = np.where((w > slowest) & (w <= np.pi / context.data.stride), log_power - smooth, -np.inf)
    frequencies: list[float] = []
    for _ in range(PEAKS):
        i = int(np.argmax(height))
        if not np.isfinite(height[i]):
            break
        frequencies.append(float(w[i]))
        height[max(i - width // 2, 0) : i + width // 2] = -np.inf
    return frequencies


LAWS = "smooth", "peak", "load", "give", "load-give", "drive"  # of friction, richer than a constant
FAINT = 0.01  # scaled: friction or drag from which one starts beside other effects of a mass; numerics
OF_A_MASS = "position", "unsprung"  # places of friction at which a spring or gravity may act beside the drive


def _friction(x: FloatArray, p: Mapping[str, float], seen: Seen) -> FloatArray:
    """Friction over the speed, with what is added to it at rest."""
    peak = p.get("break_away", p["friction"]) - p["friction"]
    return np.asarray(np.sign(x) * (p["friction"] + peak * np.exp(-np.abs(x) / PEAK_SHOWN)))


class CoulombFriction(PlantEffect):
    """Dry friction.

    `variant` position (of a mass), unsprung (a mass without a spring), speed, or speed-lag (a lag after the speed);
    "-smooth" is proportional to tanh(speed) about rest, "-peak" has a larger friction at rest (Stribeck), "-load" grows
    with the force that the gear transmits, "-drive" with that of the drive alone, and with "-give" the bodies give way
    before they slide (Dahl's law), with "-peak-give" more of it at rest.
    """

    name = "coulomb-friction"
    description = Description(
        path="dynamics",
        noun="dry friction",
        clauses=(
            "Motion starts only when the command overcomes dry friction of {friction}",
            "Dry friction opposes the motion",
        ),
        meaning=(
            "A force of constant magnitude opposes every motion: small commands have no effect, and the motion stops "
            "early. Check bearings, seals and guides."
        ),
        excited_by="Slow motion, stops and changes of direction.",
        parameters={
            "friction": Reported("friction, in units of the command", "u"),
            "break_away": Reported("friction at rest, in units of the command", "u"),
            "load": Reported("share of the transmitted force that is added to the friction", "1", share=True),
            "give": Reported("way before the bodies slide", "y"),
        },
        confused_with=("input-dead-zone", "input-backlash"),
        sketch=Sketch(
            "Speed, as a share",
            "",
            "Friction",
            "friction",
            _friction,
            nothing,
            ("friction",),
            reach=lambda p, seen: (-1.0, 1.0),
        ),
    )
    sizes = ("friction", "load_share")
    variants = ("position", "unsprung", "speed", "speed-lag")
    richer: ClassVar[dict[str, tuple[str, ...]]] = {
        place: tuple(f"{place}-{law}" for law in LAWS if law != "drive" or place in OF_A_MASS) for place in variants
    } | {f"{place}-give": (f"{place}-peak-give",) for place in variants}
    places = ("speed", "speed-lag")
    planted_variants = ("position", "speed")

    @property
    def place(self) -> str:
        """Position of the friction, one of `variants`."""
        return next(place for place in self.variants[::-1] if self.variant.startswith(place))

    @property
    def law(self) -> str:
        """Of the friction: sharp, one of `LAWS`, or "peak-give"."""
        return self.variant[len(self.place) + 1 :] or "sharp"

    def applies(self, context: Context) -> bool:
        """Allow "unsprung" only if the record hardly shows a spring."""
        return self.place != "unsprung" or real_rates(*context.rates)[0] * context.data.samples < MAX_UNSPRUNG_RATE

    def extend(self, plant: Plant) -> Plant:
        """A mass or a motor with friction."""
        if self.place in OF_A_MASS:
            unsprung = plant.unsprung or self.place == "unsprung"
            return plant.modified(kind="mechanics", friction=self.law, unsprung=unsprung)
        return plant.modified(kind="speed", friction=self.law, lag_first=self.place == "speed")

    def plant_starts(self, context: Context) -> list[dict[str, float]]:
        """Weak to strong friction, and initial positions or neutral inputs."""
        faint = weak_starts(context, "friction")
        if self.place == "position":
            offset = initial_offset(context)
            starts = [{"friction": size, "z0": z0} for size in (0.05, 0.25, 0.8) for z0 in dict.fromkeys((0.0, offset))]
            return [*faint, *starts]
        if self.place == "unsprung":
            return [*faint, *({"friction": size, "log_k+": SLACK_LOG_STIFFNESS} for size in (0.05, 0.25, 0.8))]
        u = context.data.u
        inside = u.min() + np.array([0.3, 0.7]) * np.ptp(u)  # inputs at which the motor may reverse
        middles = dict.fromkeys(round(float(x), 3) for x in (np.median(u), u[0], *inside))
        return [{"friction": size, "centre": middle} for size in (0.1, 0.4) for middle in middles]

    def is_plausible(self, fit: Fitted) -> bool:
        """Require motion in both directions, or of a mass stops on its way: without, friction is a constant.

        A level at its brim stops and does not turn: friction on a speed that hardly turns fits it as well.
        """
        plant = fit.hypothesis.plant
        speed = plant.motion(fit.plant_theta, fit.actuator)[:, 1]
        if plant.kind == "mechanics" and count_stops(speed) >= MIN_STOPS:
            return True
        slow = 0.0
        if plant.kind == "speed" and self.law == "smooth":  # at small speeds alone it is any curve
            slow = FULL_FRICTION * float(np.exp(fit.value("log_smooth")))
        return moves_both_ways(speed, CREEP * (plant.kind == "speed"), slow)

    def values(self, fit: Fitted) -> dict[str, Value]:
        """`friction` in units of the input; with a peak, `break_away`; with the load, its share `load`."""
        unit, friction = fit.command_unit, fit.value("friction")
        found = {"friction": Value(friction * unit, "u")}
        if "peak" in self.law:
            found["break_away"] = Value(friction * (1.0 + fit.value("peak")) * unit, "u")
        if self.law in ("load", "drive", "load-give"):
            found["load"] = Value(fit.value("load_share"), "1")
        if "give" in self.law:
            found["give"] = Value(abs(float(np.exp(fit.value("log_give"))) / fit.state_per_output), "y")
        return found

    def planted(self, fit: Fitted, share: float) -> list[Planted]:
        """Friction up to the range of the input."""
        return [Planted("friction", {"friction": share * fit.input_range})]


def weak_starts(context: Context, name: str) -> list[dict[str, float]]:
    """A start beside other effects of a mass at which a parameter is so small that the motion remains the parent's."""
    return [{name: FAINT}] if context.parent.hypothesis.plant.kind == "mechanics" else []


def count_stops(speed: FloatArray) -> int:
    """Number of rests between motions."""
    rests = stretches_of(np.abs(speed) < REST * float(np.abs(speed).max()))
    return sum(stop - start >= SHORTEST_REST and start > 0 and stop < speed.size for start, stop in rests)


def moves_both_ways(speed: FloatArray, least: float = 0.0, slow: float = 0.0) -> bool:
    """Whether a motion has either direction for long enough, and up to the share `least` of its largest speed.

    Motion at speeds up to `slow` does not count.
    """
    forth, back = float(speed.max()), float(-speed.min())
    if min(forth, back) < least * max(forth, back):
        return False
    return bool(min(np.mean(speed > slow), np.mean(speed < -slow)) > MIN_EITHER_DIRECTION)


def initial_offset(context: Context) -> float:
    """Initial deviation from the steady state of the linear model, in units of the input."""
    fit, u = context.parent, context.data.u
    output = fit.hypothesis.output(fit.theta, fit.gains, np.array([u[0], u[0] + 1.0]).repeat(2000))
    gain = float(output[-1] - output[1999])
    if not np.isfinite(gain) or abs(gain) < 1e-3:
        return 0.0
    return float(np.clip((context.data.y[:3].mean() - output[1999]) / gain, -5.0, 5.0))


class CubicStiffness(PlantEffect):
    """Hardening or softening restoring force; `variant` "sampled" for an input that is not held between samples."""

    name = "cubic-stiffness"
    description = Description(
        path="dynamics",
        noun="a nonlinear spring",
        clauses=(
            "The stiffness increases by {cubic+} times the square of the displacement",
            "The stiffness decreases by {cubic-} times the square of the displacement",
            "The restoring force is not proportional to the displacement",
        ),
        meaning=(
            "Far from rest the rig is stiffer, or softer, than near rest. Check springs near the end of their travel "
            "and flexible parts."
        ),
        excited_by="Small and large displacements to both sides.",
        parameters={"cubic": Reported("cubic coefficient", "1/y^2")},
        confused_with=("output-nonlinearity", "input-nonlinearity"),
        spring=True,
        smooth_law=True,
        sketch=Sketch(
            "Displacement from rest",
            "y",
            "Force over the linear stiffness",
            "y",
            lambda x, p, seen: x * (1.0 + p["cubic"] * x**2),
            same,
            ("cubic",),
            reach=lambda p, seen: (-0.5 * float(np.ptp(seen.y)), 0.5 * float(np.ptp(seen.y))),
        ),
    )
    sizes = ("cubic",)
    variants = ("", "sampled")
    planted_variants = ("",)
    whole = "gain"

    def applies(self, context: Context) -> bool:
        """Allow "sampled" only with underdamped dynamics: others do not distinguish it from a held input."""
        return self.variant != "sampled" or damping_ratio(*context.rates) < 1.0

    def extend(self, plant: Plant) -> Plant:
        """A mass on a spring."""
        return plant.modified(kind="mechanics", cubic=True, sampled=self.variant == "sampled")

    def plant_starts(self, context: Context) -> list[dict[str, float]]:
        """Hardening and softening springs, centred at the median and at the first input."""
        middles = dict.fromkeys(round(float(x), 3) for x in (np.median(context.data.u), context.data.u[0]))
        return [{"cubic": size, "centre": middle} for size in (0.01, 0.05, 0.4, -0.02) for middle in middles]

    def values(self, fit: Fitted) -> dict[str, Value]:
        """`cubic`: relative increase of the restoring force, per square of the output."""
        return {"cubic": Value(fit.value("cubic") / fit.own_spring * fit.state_per_output**2, "1/y^2")}

    def planted(self, fit: Fitted, share: float) -> list[Planted]:
        """A spring that is stiffer by this share at the ends of the motion."""
        position = fit.hypothesis.plant.motion(fit.plant_theta, fit.actuator)[:, 0]
        return [Planted("cubic", {"cubic": share / max(float(np.abs(position).max()), 1e-9) ** 2})]
