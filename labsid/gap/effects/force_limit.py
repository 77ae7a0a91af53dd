"""The loop of a drive runs into its limit."""

from collections.abc import Mapping
from typing import ClassVar

import numpy as np

from labsid.gap.dynamics.plants import Plant
from labsid.gap.dynamics.responses import real_rates
from labsid.gap.effects.base import RARE, Fitted, Planted, PlantEffect, Value
from labsid.gap.effects.context import Context
from labsid.gap.effects.description import Description, Reported
from labsid.gap.effects.dynamics import MAX_UNSPRUNG_RATE, SLACK_LOG_STIFFNESS
from labsid.gap.effects.sketch import Sketch, same

MIN_LIMITED = 4  # samples; set by hand
FAST = 1.0  # per sample: rate of a pole that the record does not show; set by hand
FASTEST = 0.98  # quantile of the changes of the output, at which the loop is at its limit; numerics
ERROR_QUANTILES = (0.97, 0.85, 0.6)  # of the size of the error, from which limits start; numerics


class ForceLimit(PlantEffect):
    """The error of a loop is bounded before it becomes a force.

    `variant` "position" of a position loop, "damped" of one whose damping is of the same loop, "loaded" of one whose
    load rises with the output, as friction does with the speed that a loop of first order controls, "speed" of a speed
    loop whose output is the position.
    """

    name = "force-limit"
    description = Description(
        path="dynamics",
        noun="a limit in the loop of the drive",
        clauses=(
            "The drive gives no more force once the error of its loop exceeds {limit}",
            "The force of the drive is limited",
        ),
        meaning=(
            "The loop inside the drive runs into the largest current or voltage: the command is reached later, not "
            "cut off. Check the limits of current, voltage and duty cycle in the drive, and the supply."
        ),
        excited_by="Large steps of the command beside small ones.",
        parameters={"limit": Reported("error of the loop at the limit, in units of the command", "u")},
        confused_with=("input-rate-limit", "input-saturation", "quadratic-drag"),
        sketch=Sketch(
            "Force without the limit",
            "limit",
            "Force",
            "limit",
            lambda x, p, seen: np.clip(x, -p["limit"], p["limit"]),
            same,
            ("limit",),
            reach=lambda p, seen: (-2.0 * p["limit"], 2.0 * p["limit"]),
        ),
    )
    variants: ClassVar[tuple[str, ...]] = ("position", "damped", "loaded", "speed")
    absent: ClassVar[Mapping[str, float]] = {"limit": 50.0}
    planted_variants = ("position",)

    def applies(self, context: Context) -> bool:
        """Require a position loop, whose output follows the command, or a speed loop, whose output integrates it."""
        if self.variant != "speed":
            return context.follows
        return real_rates(*context.rates)[0] * context.data.samples < MAX_UNSPRUNG_RATE

    def extend(self, plant: Plant) -> Plant:
        """A mass in a loop with a limit."""
        return plant.modified(kind="mechanics", limit=self.variant, unsprung=plant.unsprung or self.variant == "speed")

    def plant_starts(self, context: Context) -> list[dict[str, float]]:
        """Limits that the error of the parent's loop exceeds seldom and often, with faster dynamics for the latter."""
        if self.variant == "loaded":
            return _first_order_starts(context)
        slack = {"log_k+": SLACK_LOG_STIFFNESS} if self.variant == "speed" else {}
        error = np.abs(_loop_error(context, self.variant))
        starts = []
        for share, faster in zip(ERROR_QUANTILES, (0.0, 0.5, 1.0), strict=True):
            limit = float(np.clip(np.quantile(error, share), 0.01, 20.0))
            starts.append({"limit": limit, "log_c+": faster} | slack)
            if faster and self.variant != "speed":
                starts.append({"limit": limit, "log_c+": faster, "log_k+": 2.0 * faster})
        return starts if self.variant == "speed" else [*starts, *_first_order_starts(context)]

    def active_samples(self, fit: Fitted) -> np.ndarray:
        """The samples at which the loop is at its limit."""
        return np.abs(self._error(fit)) > fit.value("limit")

    def is_plausible(self, fit: Fitted) -> bool:
        """Require that the loop is at its limit for some samples, and not nearly always, as a relay would be.

        A load that rises with the output is one of a loop of first order, whose other pole is too fast to be seen.
        """
        if self.variant == "loaded" and real_rates(*fit.hypothesis.plant.linear_rates(fit.plant_theta))[1] < FAST:
            return False
        share = float(np.mean(self.active_samples(fit)))
        return MIN_LIMITED / fit.data.samples <= share < 1.0 - RARE

    def values(self, fit: Fitted) -> dict[str, Value]:
        """`limit` in units of the input."""
        return {"limit": Value(fit.value("limit") * fit.command_unit, "u")}

    def planted(self, fit: Fitted, share: float) -> list[Planted]:
        """A limit below the largest error by a share of it."""
        largest = float(np.abs(self._error(fit)).max())
        return [Planted("limit", {"limit": (1.0 - 0.99 * share) * largest})]

    def _error(self, fit: Fitted) -> np.ndarray:
        """Error of the loop, in scaled units of the input."""
        return fit.hypothesis.plant.loop_error(fit.plant_theta, fit.actuator)


def _first_order_starts(context: Context) -> list[dict[str, float]]:
    """Limits of a loop of first order, as of a speed, by the fastest change of the output.

    A linear model of a loop that is mostly at its limit has other poles, or none that the record shows.
    """
    data, (c, k) = context.data, context.rates
    y = data.y * data.y_scale.unit / data.u_scale.unit
    error = np.abs(data.u - np.mean(data.u) - (y - np.mean(y)))
    ahead = max(data.samples // 500, 4)
    fastest = float(np.quantile(np.abs(y[ahead:] - y[:-ahead]), FASTEST)) / ahead
    starts = []
    for share in ERROR_QUANTILES:
        limit = float(np.clip(np.quantile(error, share), 0.01, 20.0))
        starts.append({"limit": limit, "log_c+": -np.log(c), "log_k+": float(np.log(fastest / limit / k))})
    return starts if fastest > 0.0 else []


def _loop_error(context: Context, variant: str) -> np.ndarray:
    """Error of the loop of the parent's linear dynamics, in scaled units of the input."""
    c, k = context.rates
    plant = Plant(kind="mechanics", limit=variant)
    (theta, *_) = plant.starts(c, k)
    theta[plant.index("limit")] = 50.0
    return plant.loop_error(theta, context.actuator)
