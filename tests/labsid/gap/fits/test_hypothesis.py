"""A hypothesis: where its numbers lie, in which order its effects act, and that it runs on any input."""

import numpy as np
import pytest

from labsid._arrays import FloatArray
from labsid.gap.dynamics._kernels import delayed
from labsid.gap.dynamics.plants import Plant
from labsid.gap.effects import disturbance, drifts, dynamics, input, output, periodic, tanks
from labsid.gap.fits.hypothesis import Design, Hypothesis

FULL = Hypothesis(
    (
        output.Nonlinearity(),
        periodic.Periodic(),
        input.DeadZone(),
        disturbance.LoadStep(),
        dynamics.ExtraLag(),
        output.Drift("2"),
        output.Saturation("high"),
        input.Saturation("low"),
    )
)


def names_at(hypothesis: Hypothesis, key: str) -> list[str]:
    """Names of the parameters in one slice."""
    return [parameter.name for parameter in hypothesis.parameters[hypothesis.slices[key]]]


def test_theta_holds_delay_inputs_plant_outputs_and_additive_effects_in_this_order() -> None:
    names = [parameter.name for parameter in FULL.parameters]
    assert names == ["delay", "low", "low", "high", "log_c", "log_k", "log_lag", "c2", "c3", "high", "cycles", "onset"]
    assert FULL.parameters[0].upper == 0.5
    assert names_at(FULL, "input-saturation/low") == ["low"]
    assert names_at(FULL, "input-dead-zone") == ["low", "high"]
    assert names_at(FULL, "plant") == ["log_c", "log_k", "log_lag"]
    assert names_at(FULL, "output-nonlinearity") == ["c2", "c3"]
    assert names_at(FULL, "output-saturation/high") == ["high"]
    assert names_at(FULL, "periodic-disturbance") == ["cycles"]
    assert names_at(FULL, "load-step") == ["onset"]
    assert names_at(FULL, "output-drift/2") == []


def test_slices_and_the_delay_cover_theta_once() -> None:
    for hypothesis in (FULL, FULL.plus(input.Delay()), Hypothesis()):
        covered = [i for place in hypothesis.slices.values() for i in range(place.start, place.stop)]
        first = [] if hypothesis.delay_is_an_effect else [0]
        assert sorted(first + covered) == list(range(len(hypothesis.parameters)))


def test_a_delay_that_is_an_effect_takes_the_place_of_the_nuisance_one() -> None:
    hypothesis = Hypothesis((input.DeadZone(), input.Delay()))
    assert [parameter.name for parameter in hypothesis.parameters] == ["low", "high", "delay", "log_c", "log_k"]
    assert hypothesis.delay_is_an_effect
    assert not FULL.delay_is_an_effect


def test_the_input_of_a_spring_may_be_sampled_and_not_held() -> None:
    """Straight lines between the samples are half a sample ahead of what is held; friction hides where that is."""
    least = {
        plant: Hypothesis((effect,)).parameters[0].lower
        for plant, effect in (
            ("spring", dynamics.CubicStiffness("sampled")),
            ("held", dynamics.CubicStiffness()),
            ("friction", dynamics.CoulombFriction("position")),
            ("tanks", tanks.SqrtOutflow("both")),
        )
    }
    assert least == {"spring": -0.5, "held": 0.0, "friction": 0.0, "tanks": 0.0}


def test_bounds_are_those_of_the_parameters() -> None:
    lower, upper = FULL.bounds
    assert lower.tolist() == [parameter.lower for parameter in FULL.parameters]
    assert upper.tolist() == [parameter.upper for parameter in FULL.parameters]


def test_effects_that_the_simulation_already_had_are_no_finding() -> None:
    given = Hypothesis((dynamics.ExtraLag(),), n_given=1)
    assert given.names == given.keys == ()
    more = given.plus(input.Saturation("low"))
    assert more.names == ("input-saturation",)
    assert more.keys == ("input-saturation/low",)
    assert more.plant == Plant(lag="behind")
    twice = Hypothesis((disturbance.LoadStep(), disturbance.Leak("leak")))
    assert twice.names == ("load-step",)
    assert twice.keys == ("load-step", "load-step/leak")


def test_effects_are_added_to_a_given_plant() -> None:
    hypothesis = Hypothesis((dynamics.Resonance(),), given=Plant(lag="behind"))
    assert hypothesis.plant == Plant(lag="behind", mode="behind")
    assert hypothesis.plus(output.Saturation("low")).plant == hypothesis.plant


def test_input_effects_act_in_the_order_of_the_actuator_and_the_delay_last(levels: FloatArray) -> None:
    """Limited first, then dead: whatever the order in which they were found."""
    limit, band, delay = input.Saturation("high"), input.DeadZone(), input.Delay()
    own = {limit.key: [0.8], band.key: [-0.3, 0.2], delay.key: [2.5]}
    found = []
    for effects in ((limit, band, delay), (delay, band, limit)):
        hypothesis = Hypothesis(effects)
        theta = np.zeros(len(hypothesis.parameters))
        for key, numbers in own.items():
            theta[hypothesis.slices[key]] = numbers
        found.append(hypothesis.actuator(theta, levels))
    limited = np.minimum(levels, 0.8)
    expected = delayed(np.maximum(limited - 0.2, 0.0) + np.minimum(limited + 0.3, 0.0), 2, 0.5)
    np.testing.assert_allclose(found, [expected, expected], atol=1e-12)


def sensed(theta: FloatArray, z: FloatArray, *added: FloatArray) -> Design:
    """A design of ready columns, of which the first one and the constant pass through the whole sensor."""
    parts = tuple(column[:, None] for column in (z, *added))
    return Design(np.column_stack([z, np.ones(z.size), *added]), 2, theta, (z, 0.0), parts)


def test_the_sensor_bends_then_adds_then_clips_and_its_columns_are_the_derivatives() -> None:
    hypothesis = Hypothesis((output.Saturation("both"), output.Nonlinearity(), output.Drift("1")))
    theta = np.zeros(len(hypothesis.parameters))
    theta[hypothesis.slices["output-nonlinearity"]] = 0.2, 0.05
    theta[hypothesis.slices["output-saturation/both"]] = -0.713, 1.013
    z, added = np.linspace(-2.0, 2.0, 81), 0.6 * np.cos(np.arange(81.0))
    gains = np.array([1.0, 0.0, 1.0])

    def read(z: FloatArray, added: FloatArray) -> FloatArray:
        return hypothesis.sensor(theta, gains, sensed(theta, z, added))

    bent = z + 0.2 * z**2 + 0.05 * z**3
    expected = np.clip(bent + added, -0.713, 1.013)
    assert (np.clip(bent, -0.713, 1.013) + added != expected).sum() > 30  # in another order it is another reading
    np.testing.assert_allclose(read(z, added), expected)
    h = 1e-6
    design = sensed(theta, z, added)
    by_gains = hypothesis.sensed_columns(theta, gains, design)
    for i, step in enumerate(h * np.eye(3)):
        ends = [hypothesis.sensor(theta, gains + sign * step, design) for sign in (1.0, -1.0)]
        np.testing.assert_allclose(by_gains[:, i], (ends[0] - ends[1]) / (2.0 * h), atol=1e-5)


def test_without_additive_effects_the_sensor_nonlinearity_and_limits_apply() -> None:
    hypothesis = Hypothesis((output.Saturation("high"), output.Nonlinearity()))
    theta = np.zeros(len(hypothesis.parameters))
    theta[hypothesis.slices["output-nonlinearity"]] = 0.2, 0.05
    theta[hypothesis.slices["output-saturation/high"]] = 1.01
    z = np.linspace(-2.0, 2.0, 41)
    read = hypothesis.sensor(theta, np.array([1.0, 0.0]), sensed(theta, z))
    np.testing.assert_allclose(read, np.minimum(z + 0.2 * z**2 + 0.05 * z**3, 1.01))


def full_theta() -> FloatArray:
    """Numbers at which every effect of FULL is at work."""
    theta = np.zeros(len(FULL.parameters))
    theta[0] = 0.3
    theta[FULL.slices["input-saturation/low"]] = -1.0
    theta[FULL.slices["input-dead-zone"]] = -0.2, 0.3
    theta[FULL.slices["plant"]] = np.log([0.5, 0.05, 3.0])
    theta[FULL.slices["output-nonlinearity"]] = 0.1, 0.02
    theta[FULL.slices["output-saturation/high"]] = 0.9
    theta[FULL.slices["periodic-disturbance"]] = 7.0
    theta[FULL.slices["load-step"]] = 0.4
    return theta


GAINS = np.array([0.03, 0.04, 0.1, -0.1, 0.0, 0.2, 0.05, 0.15, 0.02, 0.01, 0.3, -0.2, 0.1, 0.05])


def test_a_load_passes_the_whole_sensor_and_a_drift_only_its_limits(levels: FloatArray) -> None:
    design = FULL.design(full_theta(), levels)
    assert design.sensed.shape == (levels.size, 7 + 1 + 2)  # the plant's, the constant, the load's
    assert design.added.shape == (levels.size, 2 + 2)  # the sinusoid's, the drift's
    np.testing.assert_array_equal(design.sensed[:, 7], 1.0)
    bent = (z := design.sensed @ GAINS[:10]) * (1.0 + z * (0.1 + 0.02 * z))
    expected = np.minimum(bent + design.added @ GAINS[10:], 0.9)
    assert 20 < (expected == 0.9).sum() < 580
    np.testing.assert_allclose(FULL.output(full_theta(), GAINS, levels), expected, atol=1e-12)


@pytest.mark.parametrize("hypothesis", [FULL, FULL.plus(input.Delay()), FULL.plus(tanks.SqrtOutflow("both"))])
def test_a_reused_design_equals_a_new_one(hypothesis: Hypothesis, levels: FloatArray) -> None:
    theta = np.full(len(hypothesis.parameters), 0.3)
    own = dict(zip([p.name for p in Plant(lag="behind").parameters], full_theta()[FULL.slices["plant"]], strict=True))
    own |= {"log_a": np.log(0.3), "log_b": np.log(0.2), "zero": -3.0}
    for key, place in FULL.slices.items():
        numbers = full_theta()[place] if key != "plant" else [own.get(p.name, 0.1) for p in hypothesis.plant.parameters]
        theta[hypothesis.slices[key]] = numbers
    near = hypothesis.design(theta, levels)
    for i, parameter in enumerate(hypothesis.parameters):
        moved = theta.copy()
        moved[i] += parameter.step if theta[i] + parameter.step <= parameter.upper else -parameter.step
        again = hypothesis.design(moved, levels, near=near)
        np.testing.assert_array_equal(again.columns, hypothesis.design(moved, levels).columns)
        in_sensor = any(i in range(*hypothesis.slices[e.key].indices(theta.size)) for e in hypothesis.outputs)
        assert np.array_equal(again.columns, near.columns) == in_sensor


def test_gains_of_finds_the_gains_of_each_additive_effect() -> None:
    found = {effect.key: FULL.gains_of(GAINS, effect).tolist() for effect in FULL.additive}
    assert found == {"load-step": [0.02, 0.01], "periodic-disturbance": [0.3, -0.2], "output-drift/2": [0.1, 0.05]}


@pytest.mark.parametrize("hypothesis", [FULL, Hypothesis((drifts.GainDrift("1"), dynamics.Resonance()))])
def test_the_beginning_of_an_input_gives_the_beginning_of_the_output(
    hypothesis: Hypothesis, levels: FloatArray
) -> None:
    """Slow changes are counted by the span of the fit's record, not by the input that is played."""
    if hypothesis is FULL:
        theta, gains = full_theta(), GAINS
    else:
        theta = np.array([0.2, 0.3, 0.1, np.log(0.5), np.log(0.05), np.log(0.4), np.log(0.1)])
        gains = GAINS[: hypothesis.design(theta, levels).sensed.shape[1]]
    whole = hypothesis.output(theta, gains, levels)
    part = hypothesis.output(theta, gains, levels[:250], span=levels.size)
    np.testing.assert_allclose(part, whole[:250], atol=1e-12)
    assert np.abs(hypothesis.output(theta, gains, levels[:250]) - whole[:250]).max() > 1e-3


def test_reference_is_the_input_from_which_linear_dynamics_count(levels: FloatArray) -> None:
    """A record that goes on from rest at the fit's first input runs the same with that rest before it."""
    hypothesis, theta = Hypothesis(), np.array([0.0, np.log(0.5), np.log(0.05)])
    gains = np.array([0.03, 0.02, 0.0, 0.0, 0.0, 0.4])
    later = levels[100:] + 0.3
    rest = np.full(300, levels[0])
    played = hypothesis.output(theta, gains, np.concatenate([rest, later]), levels.size, float(levels[0]))[300:]
    own = hypothesis.output(theta, gains, later, levels.size, float(levels[0]))
    np.testing.assert_allclose(played, own, atol=1e-9)
    about_itself = hypothesis.output(theta, gains, later, levels.size)
    assert np.abs(about_itself - own).max() > 0.1
