"""Effects of tanks: outflow by the root of the level, and overflow."""

from collections.abc import Mapping
from typing import ClassVar

import numpy as np

from labsid._arrays import FloatArray
from labsid.gap.dynamics import _kernels
from labsid.gap.dynamics.plant_form import LEVEL_OF, RATE_OF
from labsid.gap.dynamics.plants import Plant
from labsid.gap.dynamics.responses import real_rates
from labsid.gap.effects.base import RARE, Effect, Fitted, Planted, PlantEffect, Value
from labsid.gap.effects.context import Context, ParentFit, Structure
from labsid.gap.effects.description import Description, Reported
from labsid.gap.effects.sketch import Seen, Sketch, around_y, ends_of, same

START_BELOW = 0.1  # scaled level: distance of the initial level from the brim, to start with; numerics
MAX_START = 15.0  # scaled flow: largest initial deviation of a level, which a brim could hide; set by hand
MAX_TANK_RATE = 1.0  # per sample: a faster tank follows its inflow within a sample; set by hand
NO_CURVATURE = -190.0  # scaled: input at zero flow, without influence; numerics
NO_BRIM = 390.0  # scaled: level of a brim without influence; numerics
MOST_OF_FLOW = 0.97  # range of the input over its largest distance from zero flow; set by hand
SIDES = ("", "-flipped")


class _OfTanks(PlantEffect):
    """An effect of one of two tanks in series, or of both."""

    @property
    def tanks(self) -> tuple[str, ...]:
        """The tanks: "upper" and "lower"."""
        which = self.variant.removesuffix("-flipped")
        return {"both": ("upper", "lower"), "weir": ("lower",)}.get(which, (which,))

    @property
    def is_flipped(self) -> bool:
        """Whether a larger input means less flow."""
        return self.variant.endswith("-flipped")


def _height(x: FloatArray, p: Mapping[str, float], seen: Seen) -> FloatArray:
    """Height over the empty tank, of 1 at the mean level."""
    return np.asarray((x - p["empty"]) / (np.nanmean(seen.y) - p["empty"]))


class SqrtOutflow(_OfTanks):
    """Torricelli outflow, proportional to the root of the level; `variant` both, upper or lower, and "-flipped"."""

    name = "sqrt-outflow"
    description = Description(
        path="dynamics",
        noun="a square-root outflow",
        clauses=("The outflow is proportional to the square root of the level, not to the level",),
        meaning=(
            "Torricelli's law: per unit of level, the outflow of a full tank changes less than that of a nearly empty"
            " one, so gain and time constant increase with the level. The parameters are the command without inflow "
            "and the sensor reading of the empty tank. Both may lie far outside the record."
        ),
        excited_by="Levels over the whole height of the tank, nearly empty ones included.",
        parameters={
            "zero": Reported("command without inflow", "u", position=True),
            "empty": Reported("reading of the empty tank", "y", position=True),
        },
        confused_with=("input-nonlinearity", "output-nonlinearity", "overflow"),
        smooth_law=True,
        sketch=Sketch(
            "Level, as a reading",
            "y",
            "Outflow (1 at the mean level)",
            "",
            lambda x, p, seen: np.sqrt(np.maximum(_height(x, p, seen), 0.0)),
            lambda x, p, seen: 0.5 * (1.0 + _height(x, p, seen)),
            ("empty",),
            ("empty",),
            reach=lambda p, seen: ends_of(seen.y, 0.0, (p["empty"],)),
        ),
    )
    planted_variants = ("both", "lower")
    absent: ClassVar[Mapping[str, float]] = {"zero": NO_CURVATURE}
    variants = tuple(which + side for which in ("both", "upper", "lower") for side in SIDES)
    further: ClassVar[dict[str, tuple[str, ...]]] = {
        which + side: tuple(other + side for other in ("both", "upper", "lower") if other != which)
        for which in ("both", "upper", "lower")
        for side in SIDES
    }

    def extend(self, plant: Plant) -> Plant:
        """Tanks with square-root outflow as the variant states."""
        return plant.modified(kind="tanks", roots=self.tanks, flipped=self.is_flipped)

    def plant_starts(self, context: Context) -> list[dict[str, float]]:
        """Zero-flow inputs slightly, and one full range, below the record."""
        u = -context.data.u if self.is_flipped else context.data.u
        span = float(np.ptp(u))
        starts = []
        for below in (0.15, 1.0):
            zero = float(u.min()) - below * span
            middle = -zero  # the mean of the scaled input is zero
            faster = {RATE_OF[tank] + "+": float(np.log(2.0 * middle)) for tank in self.tanks}
            starts.append({"zero": zero} | faster | self._brim(context, zero))
        return starts

    def carry_over(self, fit: ParentFit, hypothesis: Structure, theta: FloatArray) -> None:
        """Preserve the linearized rates, and the brims, of tanks whose outflows change."""
        old, new = fit.hypothesis.plant, hypothesis.plant
        if not old.has_root:
            return
        own = theta[hypothesis.slices["plant"]]
        slope = new.root_slope(own)
        for tank, rate in RATE_OF.items():
            sign = (tank in new.roots) - (tank in old.roots)
            own[new.index(rate)] += sign * np.log(slope)
            if sign and tank in new.brims:
                at = new.index(new.brim_name(tank))
                own[at] = max(own[at], 0.0) ** (2.0 if sign > 0 else 0.5)
        if new.roots != old.roots:
            own[new.index("h1")] = own[new.index("h2")] = 0.0

    def _brim(self, context: Context, zero: float) -> dict[str, float]:
        """Brims of a parent with linear outflow, converted to the levels at the same flow."""
        plant = context.parent.hypothesis.plant
        if plant.has_root:
            return {}
        found = {}
        for tank in plant.brims:
            name = plant.brim_name(tank)
            flow = max(float(context.parent.plant_theta[plant.index(name)]) - zero, 0.0)
            found[name] = flow**2 if tank in self.tanks else flow
        return found

    def values(self, fit: Fitted) -> dict[str, Value]:
        """`zero`, the input at zero flow, and `empty`, the output of the empty tank."""
        zero = fit.value("zero")
        return {
            "zero": Value(fit.u(-zero if self.is_flipped else zero), "u"),
            "empty": Value(fit.y(float(fit.gains[1])), "y"),
        }

    def planted(self, fit: Fitted, share: float) -> list[Planted]:
        """The range of the input as a share of its distance at the high end from zero flow."""
        zero = float(fit.data.u.max()) - fit.input_range / min(share, MOST_OF_FLOW)
        own = fit.plant_theta[fit.hypothesis.plant.index("zero")]
        faster = float(np.log(zero / own))  # rates that are linearized at the mean flow, as before
        rates = {RATE_OF[tank]: float(fit.value(RATE_OF[tank])) + faster for tank in self.tanks}
        return [Planted("zero", {"zero": zero} | rates)] if NO_CURVATURE < zero < 0.0 else []


def _brimmed(x: FloatArray, p: Mapping[str, float], seen: Seen) -> FloatArray:
    """The level up to the brim; down to it, where a higher level reads less."""
    return (np.minimum if p["level"] > np.nanmedian(seen.y) else np.maximum)(x, p["level"])


class Overflow(_OfTanks):
    """Overflow of a tank at its brim; `variant` upper, lower, both or weir, and "-flipped".

    Over a weir the lower tank overflows the more, the higher its level is.
    """

    name = "overflow"
    description = Description(
        path="dynamics",
        noun="an overflow",
        clauses=(
            "A tank overflows at {level}",
            "A tank overflows",
        ),
        meaning=(
            "Inflow beyond the brim is lost or runs into the next tank. The brim is given as the reading at which the"
            " sensor would settle if the tank stayed just full. The next tank receives all of the overflow (100 %), "
            "none (0 %) or a part."
        ),
        excited_by="Inputs that fill the tank to the brim, long enough to see the level rest there.",
        parameters={
            "level": Reported("reading at the brim", "y", position=True),
            "upper": Reported("reading at the brim of the upper tank", "y", position=True),
            "caught": Reported("share received by the next tank", "1", share=True),
        },
        confused_with=("output-saturation", "input-saturation", "sqrt-outflow"),
        stops=True,
        sketch=Sketch(
            "Level without a brim, as a reading",
            "y",
            "Level",
            "y",
            _brimmed,
            same,
            ("level",),
            ("level", "upper"),
            reach=around_y,
        ),
    )
    planted_variants = ("lower", "upper")
    whole = "y"
    absent: ClassVar[Mapping[str, float]] = {"brim": NO_BRIM}
    variants = tuple(which + side for which in ("upper", "lower") for side in SIDES)
    further: ClassVar[dict[str, tuple[str, ...]]] = {
        which + side: ("both" + side,) for which in ("upper", "lower") for side in SIDES
    }
    richer: ClassVar[dict[str, tuple[str, ...]]] = {"lower" + side: ("weir" + side,) for side in SIDES}

    def alternatives(self, hypothesis: Structure) -> list[Effect]:
        """Overflow of both tanks, and of linear ones with their order reversed."""
        others = super().alternatives(hypothesis)
        if len(self.tanks) == 2 or hypothesis.plant.has_root:
            return others
        turned = ("lower", "weir") if self.tanks == ("upper",) else ("upper",)
        return [*others, *(Overflow(f"{other}-flipped" if self.is_flipped else other) for other in turned)]

    def carry_over(self, fit: ParentFit, hypothesis: Structure, theta: FloatArray) -> None:
        """Begin a second brim slightly below the highest level; swap rates and levels if the order is reversed."""
        old, new = fit.hypothesis.plant, hypothesis.plant
        own = theta[hypothesis.slices["plant"]]
        if {old.brims, new.brims} == {("upper",), ("lower",)}:
            own[:2] = own[1::-1].copy()
            own[new.index("h1")], own[new.index("h2")] = own[new.index("h2")], own[new.index("h1")]
        if len(new.brims) < 2 or len(old.brims) != 1:
            return
        level = (fit.output - fit.gains[1]) / (fit.gains[0] or 1.0)
        top = float(np.quantile(level, 1.0 - RARE))
        if old.brims == ("upper",):
            own[new.index("brim2")] = top
            return
        own[new.index("brim2")] = fit.plant_theta[old.index("brim")]
        flow = np.sqrt(max(top, 0.0)) if "lower" in old.roots else top
        own[new.index("brim")] = flow**2 if "upper" in old.roots else flow

    def extend(self, plant: Plant) -> Plant:
        """Tanks with a brim."""
        weir = self.variant.startswith("weir")
        return plant.modified(kind="tanks", brims=self.tanks, weir=weir, flipped=plant.flipped or self.is_flipped)

    def plant_starts(self, context: Context) -> list[dict[str, float]]:
        """Brims at 8, 25 and 50 % below the highest level, as shares of its range."""
        plant = context.parent.hypothesis.plant
        u = -context.actuator if self.is_flipped or plant.flipped else context.actuator
        slow, fast = real_rates(*context.rates)
        zero = 0.0
        if plant.has_root:
            own = context.parent.plant_theta
            zero = float(own[plant.index("zero")])
        level = _kernels.first_order(u - zero, float(np.exp(-fast)))
        level[: min(5, level.size)] = level[min(5, level.size - 1)]
        root = self.tanks[-1] in plant.roots
        if self.tanks == ("lower",):
            level = _kernels.first_order(level, float(np.exp(-slow)))
        low, high = float(level.min()), float(level.max())
        starts = []
        for part in (0.08, 0.25, 0.5):
            brim = high - part * (high - low)
            start = {"brim": brim**2 if root and brim > 0 else brim}
            start |= {"share": 0.3} if self.tanks == ("upper",) else {}
            starts.append(start | self._below(start["brim"], float(u[0] - zero), root))
        return starts

    def _below(self, brim: float, flow: float, root: bool) -> dict[str, float]:
        """The initial level of a tank below its brim, where the first command is more than that: at it, none counts."""
        above = (max(flow, 0.0) ** 2 if root else flow) - brim
        return {LEVEL_OF[self.tanks[-1]]: -above - START_BELOW} if above > 0.0 else {}

    def is_plausible(self, fit: Fitted) -> bool:
        """Reject a tank that fills within a sample (a limit of the actuator or the sensor) and an impossible start.

        The start of the other tank may be any, as far as it is over within a sample.
        """
        slopes = fit.hypothesis.plant.level_slopes(fit.plant_theta)
        rates = np.exp([fit.value("log_a"), fit.value("log_b")]) / slopes
        starts = np.abs([fit.value("h1"), fit.value("h2")]) / (slopes * np.maximum(rates, 1.0))
        if starts.max() > MAX_START or (fit.starts_at_rest and self._overflows_at_first(fit)):
            return False
        return all(rate < MAX_TANK_RATE for tank, rate in zip(RATE_OF, rates, strict=True) if tank in self.tanks)

    def _overflows_at_first(self, fit: Fitted) -> bool:
        """Whether the flow of the first command overflows in steady state."""
        plant = fit.hypothesis.plant
        w = float(fit.actuator[0])
        zero = fit.value("zero") if plant.has_root else 0.0
        brim = fit.value("brim")
        root = plant.brims[0] in plant.roots
        return (-w if plant.flipped else w) - zero > (np.sqrt(max(brim, 0.0)) if root else brim)

    def values(self, fit: Fitted) -> dict[str, Value]:
        """`level` of the brim as a reading; for the upper tank also `caught`, the share of overflow to the lower tank.

        With two brims, `level` is that of the lower, measured tank and `upper` that of the upper one.
        """
        plant = fit.hypothesis.plant
        if self.tanks == ("lower",):
            return {"level": self._reading(fit, fit.value("brim"))}
        brim = fit.value("brim")  # convert to the steady level of the lower tank
        flow = np.sqrt(max(brim, 0.0)) if "upper" in plant.roots else brim
        upper = self._reading(fit, flow**2 if "lower" in plant.roots else flow)
        caught = Value(fit.value("share"), "1")
        if self.tanks == ("upper",):
            return {"level": upper, "caught": caught}
        return {"level": self._reading(fit, fit.value("brim2")), "upper": upper, "caught": caught}

    def _reading(self, fit: Fitted, level: float) -> Value:
        return Value(fit.y(fit.hypothesis.reading(fit.theta, fit.gains, level)), "y")

    def planted(self, fit: Fitted, share: float) -> list[Planted]:
        """A brim below the highest level by a share of its range."""
        level = (fit.output - fit.gains[1]) / (fit.gains[0] or 1.0)
        flow = level if self.tanks == ("lower",) else fit.actuator * (-1.0 if fit.hypothesis.plant.flipped else 1.0)
        low, high = float(flow.min()), float(flow.max())
        return [Planted("level", {"brim": high - share * (high - low)})]
