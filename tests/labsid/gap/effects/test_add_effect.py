"""The guide's example of a new effect works as it stands, and an incomplete one is refused when it is loaded."""

import re
import sys
from dataclasses import replace
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
from scipy.signal import lfilter

from labsid.gap.diagnosis import Diagnosis, diagnose
from labsid.gap.effects import families
from labsid.gap.effects.base import AdditiveEffect, Effect, InputEffect, OutputEffect, PlantEffect
from labsid.gap.effects.description import Description
from labsid.gap.effects.detected import DETECTED
from labsid.gap.effects.families import FAMILIES, descriptions_of
from labsid.gap.effects.input import Nonlinearity, Saturation
from labsid.gap.reports.effect_guide import effect_page
from labsid.gap.reports.text_report import format_report
from labsid.records.record import Record

GUIDE = Path(families.__file__).resolve().parents[1] / "README.md"
FADE, CENTRE = 0.8, 0.0


@pytest.fixture
def fade(monkeypatch: pytest.MonkeyPatch) -> type[InputEffect]:
    """The class of the guide's example, in the tables that `families` makes of `FAMILIES`."""
    (source,) = re.findall(r'```python\n("""Loss of gain.*?)```', GUIDE.read_text(encoding="utf-8"), re.S)
    module = ModuleType("labsid.gap.effects.fade")
    monkeypatch.setitem(sys.modules, module.__name__, module)
    exec(compile(source, "fade.py", "exec"), module.__dict__)
    for name, one in descriptions_of((*FAMILIES, *DETECTED, module.Fade)).items():
        monkeypatch.setitem(families.DESCRIPTIONS, name, one)
    monkeypatch.setitem(families.EFFECTS_BY_KEY, module.Fade.name, module.Fade())
    rivals = ((module.Fade(),), Nonlinearity.searched(), Saturation.searched())
    monkeypatch.setattr("labsid.gap.search.beam_search.CANDIDATES", rivals)
    return module.Fade


def fading_record() -> Record:
    """A motor with u/(1 + 0.8 |u|) ahead of it, moved in both directions."""
    rng = np.random.default_rng(0)
    u = np.repeat(rng.uniform(-3.0, 3.0, 60), 12)
    y = lfilter([0.0, 0.2, 0.1], [1.0, -1.1, 0.3], u / (1.0 + FADE * np.abs(u - CENTRE)))
    return Record(0.05 * np.arange(u.size), u, y + 0.01 * rng.standard_normal(u.size), 0.05)


def test_the_example_of_the_guide_is_named_on_a_simulated_record(fade: type[InputEffect]) -> None:
    """An effect is one file: as soon as it is listed, it is found, reported in words, exported and explained."""
    found = diagnose(fading_record())
    assert isinstance(found, Diagnosis)
    assert (found.verdict, list(found.effects)) == ("effect", [fade.name])
    parameters = found.report["effects"][0]["parameters"]
    assert parameters["fade"]["value"] == pytest.approx(FADE, abs=0.05)
    assert parameters["centre"]["value"] == pytest.approx(CENTRE, abs=0.05)
    assert "loss of gain" in format_report(found.report)
    assert ("confused with", "a curved characteristic of the actuator (input-nonlinearity), a limit of the actuator "
            "(input-saturation)") in effect_page(fade.name)  # fmt: skip


def described_as(description: Description | None, name: str = "input-fade") -> type[Effect]:
    return type("Fade", (InputEffect,), {"name": name, "description": description, "__module__": "fade"})


COMPLETE = Description(
    "input", "a fading actuator", ("It fades by {width}", "It fades"), "Meaning.", "Any.", {}, ("input-delay",)
)


@pytest.mark.parametrize(
    ("description", "lacks"),
    [
        (replace(COMPLETE, noun="", excited_by="", clauses=("It fades",)), "`noun`; `excited_by`"),
        (COMPLETE, r"`parameters\['width'\]`, which a clause uses"),
        (replace(COMPLETE, clauses=("It fades by {width}",)), "a last clause without parameters"),
        (replace(COMPLETE, path="actuator", clauses=("It fades",)), "`path` .one of input, .*; got 'actuator'"),
        (replace(COMPLETE, confused_with=("fades",), clauses=("It fades",)), "the effect 'fades' of `confused_with`"),
    ],
)
def test_an_incomplete_description_is_refused_when_it_is_loaded(description: Description, lacks: str) -> None:
    """The error names the effect, its class and what is missing; it does not wait until the effect is first named."""
    with pytest.raises(TypeError, match=rf"of the effect 'input-fade' \(fade.Fade\) lacks: .*{lacks}"):
        descriptions_of((*FAMILIES, *DETECTED, described_as(description)))


@pytest.mark.parametrize(
    ("base", "methods", "lacks"),
    [
        (InputEffect, (), "`apply`"),
        (PlantEffect, (), "`extend`"),
        (OutputEffect, (), "`apply`, and the method `slope` or `passed`"),
        (OutputEffect, ("apply",), "`slope` or `passed`"),
        (AdditiveEffect, (), "`columns`"),
    ],
)
def test_an_effect_without_a_method_is_refused_when_it_is_loaded(
    base: type[Effect], methods: tuple[str, ...], lacks: str
) -> None:
    """It is not first noticed within a search, which would say neither the effect nor the method."""
    given = {name: lambda *arguments: None for name in methods}
    own = {"name": "input-fade", "description": replace(COMPLETE, clauses=("It fades",)), "__module__": "fade", **given}
    with pytest.raises(TypeError, match=rf"the effect 'input-fade' \(fade.Fade\) lacks the method {lacks}\."):
        descriptions_of((*FAMILIES, *DETECTED, type("Fade", (base,), own)))


def test_an_effect_has_one_description() -> None:
    """None, or two of one name, are refused; that of a base with another name is not taken."""
    with pytest.raises(TypeError, match=r"'input-fade' \(fade.Fade\) needs one class with a `description`; got 0"):
        descriptions_of((*FAMILIES, *DETECTED, described_as(None)))
    with pytest.raises(TypeError, match=r"'input-delay' .*needs one class with a `description`; got 2"):
        descriptions_of((*FAMILIES, *DETECTED, described_as(COMPLETE, "input-delay")))
    borrowed = type("Borrowed", (Nonlinearity,), {"name": "input-fade", "__module__": "fade"})
    with pytest.raises(TypeError, match=r"'input-fade' \(fade.Borrowed\) needs one class"):
        descriptions_of((*FAMILIES, *DETECTED, borrowed))
