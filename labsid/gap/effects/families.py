"""The effects that the search combines."""

from collections.abc import Iterable, Iterator
from itertools import chain

from labsid.gap.effects import (
    command_faults,
    detected,
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
from labsid.gap.effects.base import AdditiveEffect, Effect, InputEffect, OutputEffect, PlantEffect
from labsid.gap.effects.description import PATHS, Description

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
    drifts.PoleStep,
    drifts.GainStep,
    drifts.ReadingStep,
    output.Drift,
    output.Saturation,
    output.Nonlinearity,
    folded.Absolute,
    play.Play,
    disturbance.LoadStep,
    disturbance.PassingLoad,
    disturbance.Leak,
    disturbance.InnerLoad,
    periodic.Periodic,
    periodic.InnerPeriodic,
    *inside.FAMILIES,
)
"""In the order of the search."""
CANDIDATES: tuple[tuple[Effect, ...], ...] = tuple(
    tuple(effect for family in FAMILIES if family.name == name and not family.late for effect in family.searched())
    for name in dict.fromkeys(family.name for family in FAMILIES if not inside.is_apart(family))
) + tuple((effect,) for family in FAMILIES if inside.is_apart(family) for effect in family.searched())
"""Forms that the search adds to a simulation, in a group for each name, or for each of several causes of one name."""
LATE: tuple[Effect, ...] = tuple(effect for family in FAMILIES if family.late for effect in family.searched())
"""Forms that are tried after a search with the others."""
EFFECTS_BY_KEY: dict[str, Effect] = {
    effect.key: effect for effect in (*(e for family in FAMILIES for e in family.forms()), dynamics.DirectFeedthrough())
}
"""Every effect that an exported simulation may contain."""


REQUIRED_METHODS: dict[type[Effect], tuple[tuple[str, ...], ...]] = {
    InputEffect: (("apply",),),
    PlantEffect: (("extend",),),
    OutputEffect: (("apply",), ("slope", "passed")),
    AdditiveEffect: (("columns",),),
}
"""What an effect must define, by its base class; of several names, one."""


def descriptions_of(classes: Iterable[type[Effect]]) -> dict[str, Description]:
    """The description of each name, by the path on which it acts; those beside a given simulation only come last.

    Parameters
    ----------
    classes : iterable of type
        Every class of these names. One of each name has the description.

    Raises
    ------
    TypeError
        If a description is missing, double or incomplete, or a class lacks a method; names the class, and what is
        missing.
    """
    classes = tuple(classes)
    names = frozenset(family.name for family in classes)
    descriptions: dict[str, Description] = {}
    for name in dict.fromkeys(family.name for family in classes):
        of_name = [family for family in classes if family.name == name]
        listed = ", ".join(f"{family.__module__}.{family.__name__}" for family in of_name)
        own = {id(description): description for description in chain.from_iterable(map(_own_descriptions, of_name))}
        if len(own) != 1:
            raise TypeError(f"the effect {name!r} ({listed}) needs one class with a `description`; got {len(own)}.")
        (descriptions[name],) = own.values()
        if missing := descriptions[name].missing(names):
            raise TypeError(f"the `description` of the effect {name!r} ({listed}) lacks: {'; '.join(missing)}.")
        for family in of_name:
            if methods := _missing_methods(family):
                place = f"{family.__module__}.{family.__name__}"
                raise TypeError(f"the effect {name!r} ({place}) lacks the method {', and the method '.join(methods)}.")
    return dict(sorted(descriptions.items(), key=lambda item: (item[1].given_only, PATHS.index(item[1].path))))


def _missing_methods(family: type[Effect]) -> list[str]:
    """Methods that a class takes from a base that does not define them, in words."""
    return [
        " or ".join(f"`{name}`" for name in names)
        for base, needed in REQUIRED_METHODS.items()
        if issubclass(family, base)
        for names in needed
        if all(getattr(family, name) is getattr(base, name) for name in names)
    ]


def _own_descriptions(family: type[Effect]) -> Iterator[Description]:
    """Descriptions on a class and on those of its bases that are not of another effect."""
    for base in family.__mro__:
        description = vars(base).get("description")
        if description is not None and vars(base).get("name", family.name) == family.name:
            yield description


DESCRIPTIONS: dict[str, Description] = descriptions_of((*FAMILIES, *detected.DETECTED))
"""Of every effect that a report can name."""


def names_where(holds: str) -> frozenset[str]:
    """Names of the effects with a property of `Description`, such as ``"stops"``."""
    return frozenset(name for name, description in DESCRIPTIONS.items() if getattr(description, holds))


def magnitudes_of(name: str) -> frozenset[str]:
    """The parameters of an effect of which one is its size; empty where places on an axis give it, as of a dead zone.

    Parameters
    ----------
    name : str
        Of the effect.
    """
    parameters, places = DESCRIPTIONS[name].parameters, places_of(name)
    return frozenset(parameters.keys() - places) if places <= {"onset", "end"} else frozenset()


def places_of(name: str) -> frozenset[str]:
    """The parameters of an effect that are places on an axis.

    Parameters
    ----------
    name : str
        Of the effect.
    """
    return frozenset(key for key, parameter in DESCRIPTIONS[name].parameters.items() if parameter.position)
