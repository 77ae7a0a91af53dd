"""Effects that react to the motion of a given simulation, at its input: dry friction and a cubic spring."""

import numpy as np

from labsid._arrays import FloatArray
from labsid.gap.dynamics.plants import Plant
from labsid.gap.dynamics.reaction_forces import is_collocated
from labsid.gap.effects.base import Fitted, Planted, PlantEffect, Value
from labsid.gap.effects.context import Context
from labsid.gap.effects.dynamics import moves_both_ways

SETTLED_SHARE = 0.02
"""Of the largest value, to which the pulse response of a simulation with a spring decays; set by hand."""


class _AroundGiven(PlantEffect):
    """A reaction to the output of a given simulation."""

    only_given = True
    before_given = True

    def applies(self, context: Context) -> bool:
        """Whether the force at the input moves the output at once, in the sense of a mechanism."""
        plant = context.parent.hypothesis.plant
        if (
            plant.simulation.port is not None
            or not plant.simulation.takes_input
            or self.name in {effect.name for effect in context.parent.hypothesis.effects}
        ):
            return False
        return is_collocated(_pulse(plant, context.parent.plant_theta, context.data.samples))


def _pulse(plant: Plant, theta: FloatArray, samples: int) -> FloatArray:
    """Response of a given simulation to a unit pulse of its input."""
    return plant.simulation.pulse(plant.numbers(theta), samples)


class Friction(_AroundGiven):
    """Dry friction against the motion; `variant` "given" of a position, "given-speed" of a speed."""

    name = "coulomb-friction"
    sizes = ("friction",)
    variants = planted_variants = ("given", "given-speed")

    def extend(self, plant: Plant) -> Plant:
        """The simulation with friction."""
        return plant.modified(reactions=(*plant.reactions, "speed" if self.variant == "given-speed" else "friction"))

    def plant_starts(self, context: Context) -> list[dict[str, float]]:
        """Weak to strong friction."""
        return [{"friction": size} for size in (0.05, 0.25, 0.8)]

    def is_plausible(self, fit: Fitted) -> bool:
        """Require motion in both directions: in one direction friction is a constant."""
        output = fit.output
        scale = fit.data.y_scale
        moving = output + scale.centre / scale.unit if self.variant == "given-speed" else np.diff(output)
        return moves_both_ways(moving)

    def values(self, fit: Fitted) -> dict[str, Value]:
        """`friction` in units of the input."""
        return {"friction": Value(fit.value("friction") * fit.command_unit, "u")}

    def planted(self, fit: Fitted, share: float) -> list[Planted]:
        """Friction up to the range of the input."""
        return [Planted("friction", {"friction": share * fit.input_range})]


class Spring(_AroundGiven):
    """Hardening or softening restoring force beside a spring of the simulation; `variant` "given"."""

    name = "cubic-stiffness"
    sizes = ("spring",)
    variants = ("given",)

    def applies(self, context: Context) -> bool:
        """The simulation must have a spring, so that it returns from a pulse."""
        if not super().applies(context):
            return False
        pulse = np.abs(_pulse(context.parent.hypothesis.plant, context.parent.plant_theta, context.data.samples))
        return bool(pulse[-pulse.size // 10 :].max() < SETTLED_SHARE * pulse.max())

    def extend(self, plant: Plant) -> Plant:
        """The simulation with a cubic spring."""
        return plant.modified(reactions=(*plant.reactions, "cubic"))

    def plant_starts(self, context: Context) -> list[dict[str, float]]:
        """Hardening and softening springs."""
        return [{"cubic": size} for size in (0.01, 0.05, 0.4, -0.02)]

    def values(self, fit: Fitted) -> dict[str, Value]:
        """`cubic`: relative increase of the restoring force, per square of the output."""
        pulse = _pulse(fit.hypothesis.plant, fit.plant_theta, fit.data.samples)
        gain = float(np.sum(pulse))  # of the simulation: its spring has 1 / gain
        return {"cubic": Value(fit.value("spring") * gain * fit.state_per_output**2, "1/y^2")}
