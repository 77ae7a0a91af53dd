"""Gravity on a joint: a torque with the sine of the angle."""

from itertools import product
from typing import ClassVar

import numpy as np

from labsid.gap.dynamics.plant_form import NO_SPRING
from labsid.gap.dynamics.plants import Plant
from labsid.gap.dynamics.responses import force_unit
from labsid.gap.effects.base import Fitted, PlantEffect, Value
from labsid.gap.effects.context import Context
from labsid.gap.effects.description import Description, Reported
from labsid.gap.effects.sketch import Sketch, nothing
from labsid.gap.record.data import Data

DEGREES = 180.0 / np.pi  # in a radian; definition
LEAST_SWING = 0.25  # radians: less shows a constant and a spring; set by hand
LARGEST_SWING = 13.0  # radians: more is no swing of an arm; set by hand
UNIT_ERROR = 1.15  # largest factor between a fitted unit of the angle and the radian or the degree; set by hand
MIN_TORQUE_SHARE = 0.01  # change of the torque over the record, over the range of the command; set by hand


class Gravity(PlantEffect):
    """A torque with the sine of the angle about an angle of rest.

    In a position loop the output is the angle that the input commands, in radians or degrees. `variant` "unsprung" is a
    joint without a spring or a loop, whose unit of the angle is fitted.
    """

    name = "gravity"
    description = Description(
        path="dynamics",
        noun="gravity",
        clauses=(
            "A weight turns the joint towards {angle} with a torque of up to {torque}",
            "A weight turns the joint towards its angle of rest",
        ),
        meaning=(
            "The torque is proportional to the sine of the angle between the joint and its rest. It is given as the "
            "command that holds it. Look for an arm or a load off the axis that the simulation lacks, or a wrong mass"
            " or centre of mass."
        ),
        excited_by="Slow motion over a large range of angles, in both directions.",
        parameters={
            "torque": Reported("largest torque, in units of the command", "u"),
            "angle": Reported("angle of rest", "y", position=True),
            "per_radian": Reported("output per radian", "y"),
        },
        confused_with=("cubic-stiffness", "output-nonlinearity", "load-step"),
        spring=True,
        smooth_law=True,
        sketch=Sketch(
            "Angle",
            "y",
            "Torque, in units of the command",
            "torque",
            lambda x, p, seen: p["torque"] * np.sin((x - p["angle"]) / p.get("per_radian", 1.0)),
            nothing,
            ("torque",),
            ("angle",),
        ),
    )
    sizes = ("torque",)
    variants: ClassVar[tuple[str, ...]] = ("", "unsprung")

    def applies(self, context: Context) -> bool:
        """Require an output that swings as an angle does, beside no other effects than those of a mass.

        In a position loop it follows the command.
        """
        if not angle_unit(context.data):
            return False
        before = context.parent.hypothesis
        beside = before.plant.kind == "mechanics" or not before.found
        return beside and (context.follows or self.variant == "unsprung")

    def extend(self, plant: Plant) -> Plant:
        """A mass in the field of gravity."""
        unsprung = plant.unsprung or self.variant == "unsprung"
        return plant.modified(kind="mechanics", gravity=True, follows=not self.variant, unsprung=unsprung)

    def plant_starts(self, context: Context) -> list[dict[str, float]]:
        """Weak to strong torques with their rest at the zero of the output, beside and opposite to it.

        Without a spring the torque is about the one that the linear model takes for a spring.
        """
        scale, unit = context.data.y_scale, angle_unit(context.data)
        c, k = context.rates
        slack = NO_SPRING - float(np.log(k)) if self.variant else 0.0
        force = force_unit(c, k * np.exp(slack))
        gain = _output_per_force(context) / force
        if not gain or not unit:
            return []
        turn = (abs(gain) * scale.unit if self.variant else context.data.u_scale.unit) / unit
        first = float(scale.back(context.data.y[:3].mean()))
        zero = -np.sign(gain) * first / unit  # angle at which the output is zero, from the first position
        sizes = k / force * np.array([0.3, 1.0, 3.0]) if self.variant else (0.1, 0.5, 1.5)
        starts = []
        for torque, quarter in product(sizes, range(4)):
            angle = float(zero + quarter * np.pi / 2.0)
            start = {"torque": float(torque / turn), "log_turn": float(np.log(turn)), "angle": angle}
            starts.append(start | ({"log_k+": slack} if slack else {}))
            if quarter == 0 and not slack:  # a linear fit counts the torque about a stable rest as a spring
                starts.append(start | {"log_k+": -float(np.log1p(torque))})
        return starts

    def is_plausible(self, fit: Fitted) -> bool:
        """Require a torque that changes with the motion, and a fitted unit of the angle near one that exists."""
        per_radian = self.values(fit)["per_radian"].value
        near = any(1.0 / UNIT_ERROR < per_radian / unit < UNIT_ERROR for unit in (1.0, DEGREES))
        position = fit.hypothesis.plant.motion(fit.plant_theta, fit.actuator)[:, 0]
        phase = np.exp(fit.value("log_turn")) * position - fit.value("angle")
        change = fit.value("torque") * float(np.ptp(np.sin(phase)))
        return bool(near and np.ptp(phase) > LEAST_SWING and change > MIN_TORQUE_SHARE * fit.input_range)

    def values(self, fit: Fitted) -> dict[str, Value]:
        """`torque` in units of the input, the `angle` of rest, and the output `per_radian`."""
        gain, offset = (float(x) for x in fit.gains[:2])
        turn = float(np.exp(fit.value("log_turn")))
        per_radian = abs(gain) * fit.data.y_scale.unit / turn
        at = fit.y(gain * fit.value("angle") / turn + offset)
        whole = 2.0 * np.pi * per_radian
        return {
            "torque": Value(fit.value("torque") * fit.command_unit, "u"),
            "angle": Value(at - whole * round(at / whole) if whole else at, "y"),
            "per_radian": Value(per_radian, "y"),
        }


def angle_unit(data: Data) -> float:
    """Output per radian if the output swings as an angle in radians or degrees does; else zero."""
    low, high = np.quantile(data.y, (0.005, 0.995))
    swing = float(high - low) * data.y_scale.unit
    return next((unit for unit in (1.0, DEGREES) if LEAST_SWING < swing / unit < LARGEST_SWING), 0.0)


def _output_per_force(context: Context) -> float:
    """Scaled acceleration of the output per unit of the input, with the dynamics of the parent; zero if not finite.

    From its step response, which for c y' + k y need not have settled.
    """
    (c, k), step = context.rates, context.step
    gain = k * (step[-1] - step[0]) + c * (step[-1] - step[-2])
    return float(gain) if np.isfinite(gain) else 0.0
