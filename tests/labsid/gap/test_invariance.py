"""What must not matter: units, where zero lies, the sign of a signal, a second run; and a simulation that is right."""

import json

import numpy as np
import pytest
from gap_search import searched
from representatives import mostly_exhaustive

from labsid.gap.diagnosis import diagnose
from labsid.records.record import Record

KINDS = ("input-saturation", "input-delay", "load-step", "output-saturation")
FEW = (*KINDS, "input-dead-zone", "input-nonlinearity", "extra-lag", "output-nonlinearity", "output-drift")


@pytest.fixture(scope="module")
def answers(rig_record):
    """The diagnosis of a record by a search for few effects, made once: by its effect."""
    made = {}

    def of(effect):
        if effect not in made:
            with searched(*FEW):
                made[effect] = diagnose(rig_record(effect))
        return made[effect]

    return of


def changed(record, u=(1.0, 0.0), y=(1.0, 0.0), seconds=1.0):
    """The same record in other units: each signal times a factor, plus a shift; time in units of so many seconds."""
    t = record.t / seconds
    return Record(t, u[0] * record.u + u[1], y[0] * record.y + y[1], record.Ts / seconds)


def values(report):
    return {
        f"{effect['name']} {name}": number["value"]
        for effect in report["effects"]
        for name, number in effect["parameters"].items()
    }


@pytest.mark.parametrize("effect", mostly_exhaustive(KINDS, ["input-delay", "load-step", "output-saturation"]))
def test_effects_are_named_with_their_parameters(answers, effect):
    report = answers(effect).report
    assert [found["name"] for found in report["effects"]] == [effect]
    truth = {
        "input-saturation": {"high": (3.1, 0.01)},
        "input-delay": {"delay": (2.0, 0.75)},  # a free numerator can hold a sample and a half of it
        "load-step": {"onset": (180.0, 1.5), "size": (-0.6, 0.02)},
        "output-saturation": {"high": (3.0, 0.01)},
    }[effect]
    found = values(report)
    for name, (value, off) in truth.items():
        assert found[f"{effect} {name}"] == pytest.approx(value, abs=off)


@searched(*FEW)
@pytest.mark.parametrize(
    ("effect", "change", "expected"),
    [
        pytest.param(
            "input-saturation",
            {"u": (1e3, -7e3), "y": (0.02, 4.0), "seconds": 60.0},
            {"high": lambda x: 1e3 * x - 7e3},
            marks=pytest.mark.exhaustive,
        ),
        ("input-delay", {"u": (1e-3, 0.5), "y": (-40.0, 0.0), "seconds": 60.0}, {"delay": lambda x: x / 60.0}),
        ("load-step", {"u": (-1.0, 0.0), "y": (-1.0, 0.0)}, {"onset": lambda x: x, "size": lambda x: -x}),
        ("output-saturation", {"u": (5.0, 1.0), "y": (-2.0, 30.0)}, {"low": lambda x: 30.0 - 2.0 * x}),
    ],
)
def test_other_units_and_signs_change_only_the_numbers(answers, rig_record, effect, change, expected):
    before, after = answers(effect).report, diagnose(changed(rig_record(effect), **change)).report
    assert [found["name"] for found in after["effects"]] == [effect]
    assert after["ambiguous"] == before["ambiguous"]
    numbers, name_before = values(after), list(values(before))
    assert len(numbers) == len(expected)
    for (name, conversion), old in zip(expected.items(), name_before, strict=True):
        assert numbers[f"{effect} {name}"] == pytest.approx(conversion(values(before)[old]), rel=1e-3)
    assert after["gap"]["closed"] == pytest.approx(before["gap"]["closed"], abs=1e-3)
    factor = abs(change.get("y", (1.0,))[0])
    assert after["gap"]["before"] == pytest.approx(factor * before["gap"]["before"], rel=1e-3)
    assert [name["name"] for name in after["ranking"][:3]] == [name["name"] for name in before["ranking"][:3]]


@searched(*FEW)
def test_a_second_run_gives_the_same_bytes(answers, rig_record):
    first, again = answers("output-saturation"), diagnose(rig_record("output-saturation"))
    assert json.dumps(again.report) == json.dumps(first.report)
    assert json.dumps(again.model.to_json_dict()) == json.dumps(first.model.to_json_dict())


@searched(*FEW)
def test_another_seed_changes_only_the_interval(rig_record):
    one, two = (diagnose(rig_record("none", samples=300), seed=seed).report for seed in (0, 1))
    for report in (one, two):
        report["gap"].pop("ci95")
    assert one == two


@searched(*FEW)
@pytest.mark.parametrize("effect", mostly_exhaustive(KINDS, ["load-step", "output-saturation"]))
def test_a_simulation_that_has_the_effect_already_leaves_no_gap(answers, rig_record, effect):
    exported = json.loads(json.dumps(answers(effect).model.to_json_dict()))
    report = diagnose(rig_record(effect), exported).report
    assert (report["verdict"], report["effects"]) == ("none", [])
    assert report["simulation"] == {
        "given": True,
        "output_only": False,
        "closed": False,
        "evaluations": None,
        "model": None,
        "output": None,
    }


@searched(*FEW)
def test_the_exported_simulation_is_valid_on_another_record_of_the_same_rig(answers, rig_record):
    """The input of the other record has another mean and spread; the exported numbers keep their meaning."""
    other = rig_record("input-saturation", samples=400, seed=8)
    model = answers("input-saturation").model
    report = diagnose(other, model.to_json_dict()).report
    assert report["verdict"] == "none"
    assert report["gap"]["before"] < 1.2 * report["gap"]["noise_floor"]
    error = (other.y - model.simulate(other.u, other.y))[50:]
    noise = 0.01 * np.std(other.y)
    assert np.sqrt(np.mean(error**2)) < 1.2 * noise


@searched(*FEW)
def test_the_effect_missing_in_a_given_simulation_is_found(rig_record):
    record = rig_record("input-saturation")
    den = np.poly([0.95, 0.8]).tolist()
    model = {"num": [0.01, 0.0], "den": den, "dt": 0.5, "u0": float(record.u[0]), "y0": float(record.u[0])}
    report = diagnose(record, model).report
    assert [effect["name"] for effect in report["effects"]] == ["input-saturation"]
    assert report["gap"]["closed"] > 0.9
