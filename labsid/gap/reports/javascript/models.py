"""Exported simulations as data of a page, and the JavaScript that plays them."""

from collections.abc import Iterable
from dataclasses import fields
from typing import Any

from labsid.gap.dynamics.plants import Plant
from labsid.gap.effects.base import Effect
from labsid.gap.fits.hypothesis import Hypothesis
from labsid.gap.reports.javascript.library import TEMPLATES, Library


def script(hypotheses: Iterable[Hypothesis]) -> str:
    """JavaScript with a function ``simulate(model, theta, gains, u)`` for these hypotheses, and the table ``RUN``.

    ``RUN`` holds the functions of the effects by the names that `structure` gives them.
    """
    known = list(hypotheses)
    library = Library({one.plant.kind for one in known})
    library.name(Plant, "columns")
    names = {}
    for effect, member in (pair for one in known for pair in _simulated(one)):
        names[_run_name(effect)] = library.name(type(effect), member)
    table = ", ".join(f'"{key}": {name}' for key, name in sorted(names.items()))
    written = [(TEMPLATES / name).read_text(encoding="utf-8") for name in ("arrays.js", "simulate.js")]
    return "\n".join([written[0], str(library), f"const RUN = {{{table}}};", written[1]])


def structure(hypothesis: Hypothesis, span: int, reference: float) -> dict[str, Any]:
    """What ``simulate`` needs to know of a hypothesis: JSON-ready.

    Parameters
    ----------
    hypothesis : Hypothesis
    span : int
        Length of the fitted record.
    reference : float
        Operating point of linear dynamics.
    """
    delays = [effect for effect in hypothesis.inputs if effect.name == "input-delay"]
    return {
        "span": span,
        "reference": reference,
        "delay": _ends(hypothesis.slices[delays[0].key]) if delays else [0, 1],
        "inputs": [_effect(hypothesis, effect) for effect in hypothesis.inputs if effect not in delays],
        "plant": {"self": _plant(hypothesis.plant), "at": _ends(hypothesis.slices["plant"])},
        "outputs": [_effect(hypothesis, one) | {"limits": one.is_limit} for one in hypothesis.outputs],
        "additive": [_effect(hypothesis, one) | {"at_load": one.at_load} for one in hypothesis.additive],
    }


def _simulated(hypothesis: Hypothesis) -> list[tuple[Effect, str]]:
    """The effects that act on signals, with the method that does it."""
    acting = [*hypothesis.inputs, *hypothesis.outputs]
    return [(effect, "apply") for effect in acting] + [(effect, "columns") for effect in hypothesis.additive]


def _run_name(effect: Effect) -> str:
    return f"{type(effect).__module__.rpartition('.')[2]}.{type(effect).__name__}"


def _effect(hypothesis: Hypothesis, effect: Effect) -> dict[str, Any]:
    own = {one.name: getattr(effect, one.name) for one in fields(effect)}
    return {"run": _run_name(effect), "self": own, "at": _ends(hypothesis.slices[effect.key])}


def _plant(plant: Plant) -> dict[str, Any]:
    """The fields of a plant, its parameters by name."""
    own = {one.name: getattr(plant, one.name) for one in fields(plant) if one.name not in ("simulation", "parameters")}
    return own | {"parameters": [{"name": one.name} for one in plant.parameters]}


def _ends(part: slice) -> list[int]:
    return [part.start, part.stop]
