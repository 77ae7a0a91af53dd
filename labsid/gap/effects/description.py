"""What the diagnosis says of an effect, and the properties by which its rules treat it."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from string import Formatter

from labsid.gap.effects.sketch import Sketch

PATHS = ("input", "dynamics", "output", "disturbance", "parameters")
"""Where an effect acts."""


@dataclass(frozen=True, slots=True, eq=False)
class Reported:
    """A parameter as the report states it.

    Attributes
    ----------
    label : str
    unit : str
        In terms of u, y and seconds: ``"1/u^2"``; ``"1"`` without one.
    position : bool
        Whether it is a place on an axis, which may be near zero; the others are magnitudes.
    share : bool
        Whether it is written in per cent where its unit is ``"1"``.
    labels : dict
        By unit, of a parameter that has another meaning in another unit.
    """

    label: str
    unit: str
    position: bool = False
    share: bool = False
    labels: Mapping[str, str] = field(default_factory=dict)


@dataclass(frozen=True, slots=True, eq=False)
class Description:
    """All that is said of an effect, and its properties; what has no default here is required by `missing`.

    Attributes
    ----------
    path : str
        Where it acts, one of `PATHS`.
    noun : str
        Name with its article.
    clauses : tuple of str
        What the rig does, with parameters in braces. The first clause whose parameters are all known is used; the last
        one has none. ``{size_y}`` is `size` in the unit y; ``{cubic+}`` and ``{cubic-}`` are the magnitude of a
        positive or negative `cubic`.
    meaning : str
        Explanation for a reader who does not know the effect, and parts of the rig to check.
    excited_by : str
        What a record must contain to show it.
    parameters : dict
        The reported parameters by name.
    confused_with : tuple of str
        Names of effects that look alike on a poor record.
    given_only : bool
        Whether it is only found beside a simulation that was given.
    of_one_record : bool
        Whether its time course belongs to one record, and is not carried to another.
    stops : bool
        Whether the output rests at its extreme.
    wanders : bool
        Whether it moves the output slowly, as coloured noise does.
    varies_in_time : bool
        Whether the rig differs before and after, so that no linear model fits the whole record.
    adds_poles : bool
        Whether it only adds poles to the linear dynamics.
    shape_of_input : bool
        Whether it is a static shape of the actuator, which one that only switches does not show.
    spring : bool
        Whether it is a force that depends on the position.
    bends_reading : bool
        Whether it bends or cuts the sensor's reading, as a spring of an unstable rig seems to.
    smooth_law : bool
        Whether its law is a smooth curve, which approximates any other smooth law; limits, steps and delays do not.
    sketch : Sketch, optional
        A curve of what it does, made from its parameters.
    """

    path: str = ""
    noun: str = ""
    clauses: tuple[str, ...] = ()
    meaning: str = ""
    excited_by: str = ""
    parameters: Mapping[str, Reported] = field(default_factory=dict)
    confused_with: tuple[str, ...] = ()
    given_only: bool = False
    of_one_record: bool = False
    stops: bool = False
    wanders: bool = False
    varies_in_time: bool = False
    adds_poles: bool = False
    shape_of_input: bool = False
    spring: bool = False
    bends_reading: bool = False
    smooth_law: bool = False
    sketch: Sketch | None = None

    def missing(self, names: frozenset[str]) -> list[str]:
        """What is missing or wrong, in words.

        Parameters
        ----------
        names : frozenset of str
            Of all effects.
        """
        lacking = [f"`{part}`" for part in ("noun", "clauses", "meaning", "excited_by") if not getattr(self, part)]
        if self.path not in PATHS:
            lacking.append(f"`path` (one of {', '.join(PATHS)}; got {self.path!r})")
        fields = [[name for _, name, _, _ in Formatter().parse(clause) if name is not None] for clause in self.clauses]
        if fields and fields[-1]:
            lacking.append("a last clause without parameters")
        stated = {name.rstrip("+-").partition("_1")[0].partition("_y")[0] for clause in fields for name in clause}
        lacking += [f"`parameters[{name!r}]`, which a clause uses" for name in sorted(stated - set(self.parameters))]
        for name, parameter in self.parameters.items():
            lacking += [
                f"`{part}` of the parameter {name!r}" for part in ("label", "unit") if not getattr(parameter, part)
            ]
        lacking += [f"the effect {name!r} of `confused_with`" for name in self.confused_with if name not in names]
        return lacking
