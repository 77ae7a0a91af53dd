"""Faults of the command: it is switched off, or acts in steps that its log does not have."""

import numpy as np
import pytest
from gap_search import searched
from scipy.signal import lfilter

from labsid.gap.diagnosis import diagnose
from labsid.gap.dynamics._kernels import in_steps, switched_off
from labsid.gap.effects.command_faults import Off
from labsid.records.record import Record, load_record

pytestmark = pytest.mark.usefixtures("without_limits")

TS = 0.1
FEW = (
    "input-delay",
    "input-saturation",
    "input-dead-zone",
    "input-nonlinearity",
    "input-off",
    "input-quantization",
    "load-step",
    "output-drift",
    "parameter-drift",
)
LEVELS = np.repeat(np.random.default_rng(8).uniform(-1.0, 1.0, 60), 20)
WAVE = sum(np.sin(2.0 * np.pi * f * np.arange(1200) / 1200 + f**2) for f in (3, 5, 8, 13, 21)) / 2.5


def recorded(logged, acting, noise=0.01):
    y = lfilter([0.0, 0.05, 0.04], [1.0, -1.5, 0.56], acting - acting[0])
    y = y + noise * np.std(y) * np.random.default_rng(3).standard_normal(y.size)
    return Record(TS * np.arange(logged.size), logged, y, TS)


def only(report):
    (effect,) = report["effects"]
    assert report["verdict"] == "effect", report["verdict"]
    return effect["name"], {name: one["value"] for name, one in effect["parameters"].items()}


# The two maps ---------------------------------------------------------------------------------------------


def test_a_command_is_replaced_and_samples_at_the_ends_are_mixed():
    np.testing.assert_allclose(switched_off(np.ones(6), 1.25, 4.0, 3.0), [1.0, 2.5, 3.0, 3.0, 1.0, 1.0])
    np.testing.assert_array_equal(switched_off(LEVELS, 5.0, 5.0, 3.0), LEVELS)


def test_a_command_is_rounded_to_a_lattice():
    np.testing.assert_allclose(in_steps(np.array([-0.3, 0.1, 0.26, 1.0]), 0.5, 0.0), [-0.5, 0.0, 0.5, 1.0])
    np.testing.assert_allclose(in_steps(np.array([0.1, 0.4, 0.6]), 0.5, 0.5), [0.25, 0.25, 0.75])


@pytest.mark.parametrize("variant", Off.variants)
def test_with_times_of_zero_it_is_never_off(variant):
    """So it is left out on another record, as a load is."""
    effect = Off(variant)
    assert all(one.name.startswith("off_") for one in effect.parameters)
    np.testing.assert_array_equal(effect.apply(LEVELS, np.zeros(len(effect.parameters)), LEVELS.size), LEVELS)


# Recovery -------------------------------------------------------------------------------------------------


@searched(*FEW)
@pytest.mark.parametrize(
    ("offset", "start", "stop"),
    [
        (0.0, 733, 1200),
        pytest.param(5.0, 415, 702, marks=pytest.mark.exhaustive),  # that of `command-off-for-a-while`, below
        (0.0, 0, 190),
        pytest.param(5.0, 733, 1200, marks=pytest.mark.exhaustive),
        pytest.param(0.0, 415, 702, marks=pytest.mark.exhaustive),
        pytest.param(5.0, 0, 190, marks=pytest.mark.exhaustive),
    ],
)
def test_a_command_that_is_off_is_found_with_its_times_and_level(offset, start, stop):
    at = np.arange(LEVELS.size)
    off = (at >= start) & (at < stop)
    level = offset + 0.2  # a set point that is frozen
    found = diagnose(recorded(LEVELS + offset, np.where(off, level, LEVELS + offset)))
    name, values = only(found.report)
    assert name == "input-off"
    assert values["onset"] == pytest.approx(TS * start, abs=0.3)
    assert values["level"] == pytest.approx(level, abs=0.05)
    assert ("end" in values) == (stop < LEVELS.size)
    assert values.get("end", TS * stop) == pytest.approx(TS * stop, abs=0.3)


@searched(*FEW)
def test_a_drive_that_trips_is_found_where_zero_is_outside_of_the_commands():
    logged = LEVELS + 5.0
    name, values = only(diagnose(recorded(logged, np.where(np.arange(logged.size) > 900, 0.0, logged))).report)
    assert (name, values["level"]) == ("input-off", pytest.approx(0.0, abs=0.1))


@searched(*FEW)
@pytest.mark.parametrize(
    ("step", "floor"),
    [
        (0.13, False),
        (0.4, True),
        pytest.param(0.13, True, marks=pytest.mark.exhaustive),
        pytest.param(0.4, False, marks=pytest.mark.exhaustive),
    ],
)
def test_steps_that_the_log_does_not_have_are_found(step, floor):
    logged = 0.2 + WAVE
    acting = step * (np.floor(logged / step) if floor else np.round(logged / step))
    name, values = only(diagnose(recorded(logged, acting, 0.005)).report)
    assert (name, values["step"]) == ("input-quantization", pytest.approx(step, rel=0.02))


@searched(*FEW)
def test_fine_steps_are_found_ahead_of_a_delay_of_half_a_sample():
    """Rounding after the delay would smear each step over two samples; 32 of them need a fine grid."""
    step = float(np.ptp(WAVE)) / 32.0
    acting = step * np.round(WAVE / step)
    late = 0.5 * (acting + np.concatenate([acting[:1], acting[:-1]]))
    name, values = only(diagnose(recorded(WAVE, late, 0.002)).report)
    assert (name, values["step"]) == ("input-quantization", pytest.approx(step, rel=0.01))


@searched(*FEW)
@pytest.mark.parametrize("logged", [np.round(LEVELS, 1), np.round(WAVE, 1)], ids=["levels", "wave"])
def test_steps_that_the_log_has_are_no_effect(logged):
    assert diagnose(recorded(logged, logged)).report["verdict"] == "none"


@searched(*FEW)
def test_a_load_is_no_command_that_is_off():
    record = recorded(LEVELS, LEVELS + 0.6 * (np.arange(LEVELS.size) > 700))
    assert only(diagnose(record).report)[0] == "load-step"


@searched(*FEW)
def test_on_another_record_the_command_is_applied():
    at = np.arange(LEVELS.size)
    model = diagnose(recorded(LEVELS, np.where(at > 733, 0.0, LEVELS))).model
    other = recorded(LEVELS[::-1].copy(), LEVELS[::-1])
    error = (other.y - model.simulate(other.u, other.y))[60:]
    assert np.std(error) < 0.03 * np.std(other.y)


# The records of `shared/data/found` -----------------------------------------------------------------------


@pytest.mark.parametrize(
    ("name", "times"),
    [
        pytest.param("command-off", {"onset": 72.0}, marks=pytest.mark.exhaustive),
        ("command-off-for-a-while", {"onset": 48.0, "end": 72.0}),
    ],
)
def test_the_commands_that_were_off_are_named(shared_data, name, times):
    found, values = only(diagnose(load_record(shared_data / "found" / f"{name}.csv")).report)
    assert found == "input-off"
    assert values.pop("level") == pytest.approx(0.0, abs=0.01)
    assert values == pytest.approx(times, abs=0.2)
