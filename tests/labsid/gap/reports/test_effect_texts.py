"""Every effect has its texts, and every parameter its label."""

import re

import pytest
from gap_reports import PARAMETERS, effect

from labsid.gap.effects.families import CANDIDATES, DESCRIPTIONS
from labsid.gap.reports.effect_texts import clause, noun, parameter_label, parameter_rows, parameter_value

CLAUSES = {
    "input-delay": "The rig responds to each command 0.4339 s late",
    "input-saturation": "The actuator saturates at -0.5115 and at 0.0897",
    "input-dead-zone": "The actuator does not move between 0.458 and 0.875",
    "input-backlash": "The actuator crosses a play of 0.32 at each change of direction",
    "input-rate-limit": "The actuator moves no faster than 1.71 units a second",
    "input-nonlinearity": "The gain of the actuator changes with the size of the command",
    "input-off": "From 72.00 s to 90.00 s, 0.010 acts instead of the command in the log",
    "input-quantization": "The command acts in steps of 0.250, which its log does not have",
    "extra-lag": "There is an additional lag of 2.51 s between command and record",
    "resonance": "The rig oscillates at 8.579 Hz with a damping ratio of 0.0591",
    "sqrt-outflow": "The outflow is proportional to the square root of the level, not to the level",
    "overflow": "A tank overflows at 10.10",
    "coulomb-friction": "Motion starts only when the command overcomes dry friction of 1.702",
    "cubic-stiffness": "The stiffness decreases by 0.938 times the square of the displacement",
    "end-stop": "The motion runs against stops at -0.4998 and at 0.4502",
    "quadratic-drag": "A resistance of 0.166 times the square of the speed opposes the motion",
    "gravity": "A weight turns the joint towards -0.014 with a torque of up to 0.371",
    "force-limit": "The drive gives no more force once the error of its loop exceeds 0.414",
    "slow-mode": "A share of 29 % of the response comes with a time constant of 8.2 s",
    "parameter-drift": "The gain of the rig changes by -60 % over the record",
    "output-drift": "The zero of the sensor drifts by ±0.0760",
    "output-saturation": "The sensor clips above 243.71",
    "output-nonlinearity": "The gain of the sensor changes over its range",
    "output-backlash": "The sensor crosses a play of 0.299 at each change of direction",
    "output-quantization": "The output is quantised in steps of 0.0129",
    "output-outliers": "Of the readings, 0.72 % are isolated spikes",
    "output-dropout": "The logger repeats its last value over 12 % of the record",
    "load-step": "An unmeasured load starts at 374.2 s and changes the output by -0.210",
    "periodic-disturbance": "The output oscillates at 0.0861 Hz with amplitude 0.00467, independent of the command",
    "coloured-noise": "The output contains noise of 0.045 rms that is correlated over many samples",
    "coupling": "The input moves the output, and in the simulation it does not; the steady gain is 0.699",
    "parameter-mismatch": "The structure of the simulation is right, but its parameters are wrong",
}


def test_the_words_are_those_of_the_table_and_of_every_candidate():
    assert set(DESCRIPTIONS) == set(CLAUSES) == set(PARAMETERS)
    assert {variant.name for group in CANDIDATES for variant in group} <= set(DESCRIPTIONS)


@pytest.mark.parametrize("name", CLAUSES)
def test_what_the_rig_does_with_its_numbers(name):
    assert clause(effect(name)) == CLAUSES[name]


@pytest.mark.parametrize("name", CLAUSES)
def test_what_the_rig_does_without_numbers(name):
    """Without parameters no placeholder remains and no number is invented."""
    said = clause(effect(name) | {"parameters": {}})
    assert "{" not in said
    assert not any(c.isdigit() for c in said)
    assert said[0].isupper()


@pytest.mark.parametrize("name", CLAUSES)
def test_every_parameter_has_a_label_and_a_unit_in_words(name):
    for parameter, entry in PARAMETERS[name].items():
        assert parameter_label(name, parameter, entry) != parameter or parameter in (
            "delay",
            "frequency",
            "amplitude",
        )
        value, unit = parameter_value(name, parameter, entry, {})
        assert value
        assert unit in {"s", "Hz", "%", ""} or re.fullmatch(r"(units of|per unit of|per \(unit of) .*", unit)


def test_one_limit_alone_is_said_alone():
    alone = effect("input-saturation")
    del alone["parameters"]["high"]
    assert clause(alone) == "The actuator goes no lower than -0.5115"


def test_a_load_that_grows_with_the_output_is_a_leak():
    leak = effect("load-step")
    leak["parameters"]["size"] = {"value": 0.21, "stderr": 0.01, "unit": "1"}
    assert clause(leak) == (
        "An unmeasured load starts at 374.2 s and changes the rate of return to rest by 21 %, as a leak does"
    )
    assert parameter_label("load-step", "size", {"unit": "1"}) == "change of the rate of return to rest"
    assert parameter_value("load-step", "size", leak["parameters"]["size"], {}) == ("21.0 ± 1.0", "%")


def test_a_stiffening_spring_is_not_a_softening_one():
    hard = effect("cubic-stiffness")
    hard["parameters"]["cubic"]["value"] = 0.05
    assert clause(hard).startswith("The stiffness increases by 0.050 times")


def test_a_size_that_its_error_swallows_is_not_said():
    loose = effect("output-drift")
    loose["parameters"]["amplitude"]["stderr"] = 7.5
    assert clause(loose) == "The zero of the sensor drifts"
    near_zero = effect("output-saturation")
    near_zero["parameters"] = {"low": {"value": 0.001, "stderr": 0.01, "unit": "y"}}
    assert clause(near_zero) == "The sensor clips below 0.0010"


def test_a_name_outside_the_table_is_said_as_it_is():
    assert noun("gremlins") == "gremlins"
    assert clause(effect("gremlins")) == "The record shows gremlins"
    assert parameter_value("gremlins", "x", {"value": 2.0, "stderr": 0.0, "unit": "furlong"}, {}) == (
        "2.000",
        "furlong",
    )


def test_a_parameter_at_the_limit_of_its_search_says_so():
    entry = {"value": 305.2, "stderr": 39.3, "unit": "Hz"}
    effect = {"name": "resonance", "parameters": {"frequency": entry, "damping": entry | {"unit": "1"}}}
    assert [row[2] for row in parameter_rows(effect, {})] == ["Hz", ""]
    units = [row[2] for row in parameter_rows(effect | {"at_limit": ["frequency"]}, {})]
    assert units == ["Hz, at the limit of its search", ""]
