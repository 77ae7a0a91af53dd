"""The effects that the search combines."""

from labsid.gap.effects import (
    command_faults,
    disturbance,
    drifts,
    dynamics,
    folded,
    force_limit,
    gravity,
    input,
    inside,
    motion,
    output,
    periodic,
    play,
    reactions,
    tanks,
)
from labsid.gap.effects.base import Effect

FAMILIES: tuple[type[Effect], ...] = (
    input.Delay,
    input.Saturation,
    input.DeadZone,
    input.Backlash,
    input.RateLimit,
    input.Nonlinearity,
    command_faults.Off,
    command_faults.Quantization,
    dynamics.ExtraLag,
    dynamics.Resonance,
    tanks.SqrtOutflow,
    tanks.Overflow,
    dynamics.CoulombFriction,
    reactions.Friction,
    dynamics.CubicStiffness,
    reactions.Spring,
    motion.EndStop,
    motion.QuadraticDrag,
    gravity.Gravity,
    force_limit.ForceLimit,
    dynamics.SlowMode,
    drifts.GainDrift,
    drifts.PoleDrift,
    drifts.InnerPoleDrift,
    output.Drift,
    output.Saturation,
    output.Nonlinearity,
    folded.Absolute,
    play.Play,
    disturbance.LoadStep,
    disturbance.Leak,
    disturbance.InnerLoad,
    periodic.Periodic,
    periodic.InnerPeriodic,
    *inside.FAMILIES,
)
"""In the order of the search."""
CANDIDATES: tuple[tuple[Effect, ...], ...] = tuple(
    tuple(effect for family in FAMILIES if family.name == name for effect in family.searched())
    for name in dict.fromkeys(family.name for family in FAMILIES if not inside.is_apart(family))
) + tuple((effect,) for family in FAMILIES if inside.is_apart(family) for effect in family.searched())
"""Forms that the search adds to a simulation, in a group for each name, or for each of several causes of one name."""
EFFECTS_BY_KEY: dict[str, Effect] = {
    effect.key: effect for effect in (*(e for family in FAMILIES for e in family.forms()), dynamics.DirectFeedthrough())
}
"""Every effect that an exported simulation may contain."""
