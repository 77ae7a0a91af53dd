"""Effects of a moving mass: mechanical stops, and resistance with the square of the speed."""

from collections.abc import Mapping
from typing import ClassVar

import numpy as np

from labsid._arrays import FloatArray
from labsid.gap.dynamics.plants import Plant
from labsid.gap.dynamics.responses import force_unit, real_rates
from labsid.gap.effects.base import RARE, Effect, Fitted, Planted, PlantEffect, Value
from labsid.gap.effects.context import Context, ParentFit, Structure
from labsid.gap.effects.description import Description, Reported
from labsid.gap.effects.dynamics import MAX_UNSPRUNG_RATE, SLACK_LOG_STIFFNESS, weak_starts
from labsid.gap.effects.sketch import Seen, Sketch, around_y, clipped, nothing, same

MIN_STOPPED = 4  # samples at a stop; set by hand
AT_STOP = 1e-9  # scaled distance; numerics


class EndStop(PlantEffect):
    """A mechanical stop; `variant` low, high or both, "-rebound" if the mass keeps a share of its speed there.

    "-unsprung" is for a mass without a spring.
    """

    name = "end-stop"
    description = Description(
        path="dynamics",
        noun="an end stop",
        clauses=(
            "The motion runs against stops at {low} and at {high}",
            "The motion runs against a stop at {low}",
            "The motion runs against a stop at {high}",
            "The motion runs against a stop",
        ),
        meaning=(
            "A moving part hits a mechanical stop, loses all or most of its speed there, and moves back as soon as the "
            "force turns. "
            "Look for the ends of slides, cylinders and valve stems, and for cables that are too short."
        ),
        excited_by="Motion against the stop, with time for the force to turn and lead away from it.",
        parameters={
            "low": Reported("lower stop", "y", position=True),
            "high": Reported("upper stop", "y", position=True),
            "rebound": Reported("speed after a hit over that before", "1"),
        },
        confused_with=("output-saturation", "overflow", "cubic-stiffness"),
        stops=True,
        sketch=Sketch(
            "Position without the stop",
            "y",
            "Position",
            "y",
            clipped,
            same,
            ("low", "high"),
            ("low", "high"),
            reach=around_y,
        ),
    )
    planted_variants = ("high", "low")
    whole = "y"
    absent: ClassVar[Mapping[str, float]] = {"stop_low": -50.0, "stop_high": 50.0}
    variants = tuple(side + spring for side in ("high", "low", "both") for spring in ("", "-unsprung"))
    richer: ClassVar[dict[str, tuple[str, ...]]] = {
        side + spring: (*(() if side == "both" else ("both" + spring,)), side + "-rebound" + spring)
        for side in ("low", "high", "both")
        for spring in ("", "-unsprung")
    }

    @property
    def sides(self) -> tuple[str, ...]:
        """The sides with a stop."""
        side = self.variant.partition("-")[0]
        return ("low", "high") if side == "both" else (side,)

    @property
    def _outwards(self) -> tuple[tuple[str, float], ...]:
        """The sides, each with the sign of a speed towards its stop."""
        return tuple((side, 1.0 if side == "high" else -1.0) for side in self.sides)

    @property
    def rebound(self) -> bool:
        """Whether the mass keeps a share of its speed."""
        return "-rebound" in self.variant

    @property
    def unsprung(self) -> bool:
        """Whether the mass has almost no spring."""
        return self.variant.endswith("-unsprung")

    def applies(self, context: Context) -> bool:
        """Allow "-unsprung" only if the record hardly shows a spring."""
        return not self.unsprung or real_rates(*context.rates)[0] * context.data.samples < MAX_UNSPRUNG_RATE

    def extend(self, plant: Plant) -> Plant:
        """A mass with stops."""
        return plant.modified(
            kind="mechanics", stops=self.sides, rebound=self.rebound, unsprung=plant.unsprung or self.unsprung
        )

    def grown_forms(self, hypothesis: Structure) -> list[Effect]:
        """A second stop; a rebound, which could take its place, is tried with the best fits only."""
        return [form for form in self.alternatives(hypothesis) if isinstance(form, EndStop) and not form.rebound]

    def plant_starts(self, context: Context) -> list[dict[str, float]]:
        """Stops at the ends of the output, and 8 and 25 % of its range within them."""
        c, k = context.rates
        y = context.data.y[context.data.rows]
        gain = context.gain * k / force_unit(c, k)  # of the position as the simulation scales it
        if not gain:
            return []
        low, high = np.quantile(y, (0.01, 0.99))
        starts = []
        for part in (0.0, 0.08, 0.25):
            ends = np.array([low + part * (high - low), high - part * (high - low)])
            ends = np.sort(np.clip((ends - y[:3].mean()) / gain, -50.0, 50.0))
            start = {f"stop_{side}": float(ends[int(side == "high")]) for side in self.sides}
            starts.append(start | ({"log_k+": SLACK_LOG_STIFFNESS} if self.unsprung else {}))
        return starts

    def carry_over(self, fit: ParentFit, hypothesis: Structure, theta: FloatArray) -> None:
        """Begin a second stop where the mass seldom is."""
        before, now = fit.hypothesis.plant.stops, hypothesis.plant.stops
        if len(before) == 1 and len(now) == 2:
            (missing,) = set(now) - set(before)
            position = (fit.output - fit.gains[1]) / (fit.gains[0] or 1.0)
            at = hypothesis.slices["plant"].start + hypothesis.plant.index(f"stop_{missing}")
            theta[at] = np.quantile(position, 1.0 - RARE if missing == "high" else RARE)

    def active_samples(self, fit: Fitted) -> np.ndarray:
        """The samples at which the mass is at a stop, or with a rebound reaches it within the sample."""
        position, speed = fit.hypothesis.plant.motion(fit.plant_theta, fit.actuator).T
        ways = [outwards * (fit.value(f"stop_{side}") - position) for side, outwards in self._outwards]
        if not self.rebound:
            return np.any([np.abs(way) < AT_STOP for way in ways], axis=0)
        steps = [outwards * speed + AT_STOP for _, outwards in self._outwards]
        return np.any([way < step for way, step in zip(ways, steps, strict=True)], axis=0)

    def is_plausible(self, fit: Fitted) -> bool:
        """Require that the mass reaches a stop."""
        return bool(self.active_samples(fit).sum() >= MIN_STOPPED)

    def values(self, fit: Fitted) -> dict[str, Value]:
        """`low` and `high` as outputs, and `rebound` where a share of the speed is kept."""
        gain, offset = (float(x) for x in fit.gains[:2])
        ends = [fit.y(gain * fit.value(f"stop_{side}") + offset) for side in self.sides]
        turned = gain < 0.0
        names = [{"low": "high", "high": "low"}[side] if turned else side for side in self.sides]
        found = {name: Value(end, "y") for name, end in sorted(zip(names, ends, strict=True), reverse=True)}
        return found | ({"rebound": Value(fit.value("rebound"), "1")} if self.rebound else {})

    def planted(self, fit: Fitted, share: float) -> list[Planted]:
        """A stop within the range of the motion by a share of it."""
        position = fit.hypothesis.plant.motion(fit.plant_theta, fit.actuator)[:, 0]
        low, high = float(position.min()), float(position.max())
        ends = {"low": low + share * (high - low), "high": high - share * (high - low)}
        (side,) = self.sides
        (name,) = self.values(fit)
        return [Planted(name, {f"stop_{side}": ends[side]})]


def _speeds(p: Mapping[str, float], seen: Seen) -> tuple[float, float]:
    """Speeds of the record, in both directions: those of y, or y where it is the speed itself."""
    speed = np.diff(seen.y) / np.diff(seen.t) if "s^2" in seen.units["drag"] else seen.y
    top = float(np.nanmax(np.abs(speed)))
    return -top, top


class QuadraticDrag(PlantEffect):
    """Resistance that grows with the square of the speed; `variant` position, speed, or speed-lag."""

    name = "quadratic-drag"
    description = Description(
        path="dynamics",
        noun="a quadratic drag",
        clauses=(
            "A resistance of {drag} times the square of the speed opposes the motion",
            "A resistance that grows with the square of the speed opposes the motion",
        ),
        meaning=(
            "The faster the motion, the more the rig is damped: twice the speed meets four times the resistance. Look"
            " for fans, propellers, fluid pushed through a narrow passage, and parts that move in air or water."
        ),
        excited_by="Slow and fast motion: small and large steps, without reaching a limit.",
        parameters={"drag": Reported("drag: command that holds it, over the square of the speed", "u s^2/y^2")},
        confused_with=("sqrt-outflow", "input-nonlinearity", "coulomb-friction"),
        smooth_law=True,
        sketch=Sketch(
            "Speed",
            "",
            "Drag, in units of the command",
            "u",
            lambda x, p, seen: p["drag"] * x * np.abs(x),
            nothing,
            ("drag",),
            reach=_speeds,
        ),
    )
    sizes = ("drag",)
    variants = ("position", "speed", "speed-lag")
    places = ("speed", "speed-lag")
    planted_variants = ("position", "speed")

    def extend(self, plant: Plant) -> Plant:
        """A mass or a motor with drag."""
        if self.variant == "position":
            return plant.modified(kind="mechanics", drag=True)
        return plant.modified(kind="speed", drag=True, lag_first=self.variant == "speed")

    def plant_starts(self, context: Context) -> list[dict[str, float]]:
        """Weak to strong drag, and inputs at which a motor rests."""
        if self.variant == "position":
            return [
                *weak_starts(context, "drag"),
                {"drag": 0.1},
                {"drag": 0.6, "log_c+": -0.5},
                {"drag": 3.0, "log_c+": -1.5},
            ]
        u = context.data.u
        zero = -context.data.u_scale.centre / context.data.u_scale.unit
        middles = (float(np.median(u)), float(u[0]), float(u.min()), zero if abs(zero) < 20.0 else float(u[0]))
        return [
            {"drag": size, "centre": middle} for size in (0.1, 0.6) for middle in dict.fromkeys(np.round(middles, 3))
        ]

    def values(self, fit: Fitted) -> dict[str, Value]:
        """`drag`: input per square of the speed; of a motor, the output is the speed."""
        if self.variant != "position":
            return {"drag": Value(fit.value("drag") * fit.command_unit * fit.state_per_output**2, "u/y^2")}
        unit = force_unit(np.exp(fit.value("log_c")), np.exp(fit.value("log_k")))
        size = fit.value("drag") * fit.command_unit / unit * (fit.data.Ts * fit.state_per_output) ** 2
        return {"drag": Value(float(size), "u s^2/y^2")}

    def planted(self, fit: Fitted, share: float) -> list[Planted]:
        """A resistance at the largest speed of up to the range of the input."""
        speed = float(np.abs(fit.hypothesis.plant.motion(fit.plant_theta, fit.actuator)[:, 1]).max())
        return [Planted("drag", {"drag": share * fit.input_range / max(speed, 1e-9) ** 2})]
