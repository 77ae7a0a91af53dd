"""Exported simulations: simulation by hand, round trip through a file, and invalid files."""

import json

import numpy as np
import pytest
from scipy.signal import lfilter

from labsid.gap.effects.families import EFFECTS_BY_KEY
from labsid.gap.effects.input import Delay, RateLimit
from labsid.gap.effects.tanks import Overflow, SqrtOutflow
from labsid.gap.fits.hypothesis import Hypothesis
from labsid.gap.model_file import ExportedModel, from_json_dict, load_model
from labsid.gap.record.data import Scale

C, K = 0.5, 0.05
POLES = np.exp(np.roots([1.0, C, K]))
DEN = np.poly(POLES)
GAINS = [0.02, 0.03, 0.0, 0.0, 0.0, 0.4]
LIMIT = 0.8  # scaled


def content(**changed):
    """Two poles with an actuator that stops at LIMIT; the record's units are 2 + 3 u and -1 + 5 y."""
    return {
        "schema": "labsid.model/1",
        "effects": ["input-saturation/high"],
        "parameters": ["delay", "high", "log_c", "log_k"],
        "theta": [0.0, LIMIT, np.log(C), np.log(K)],
        "gains": GAINS,
        "Ts": 0.5,
        "span": 600,
        "reference": 0.1,
        "u_scale": {"centre": 2.0, "unit": 3.0},
        "y_scale": {"centre": -1.0, "unit": 5.0},
    } | changed


def exported(hypothesis, theta, gains, input_means=()):
    """A simulation in the units of `content`, by default of an unknown record."""
    scales = Scale(2.0, 3.0), Scale(-1.0, 5.0)
    return ExportedModel(hypothesis, theta, gains, 0.5, 600, 0.1, *scales, np.array(input_means))


def by_hand(scaled_u, from_rest, limit=LIMIT):
    """The same in scipy's words, in the record's unit."""
    w = np.minimum(scaled_u, limit) - 0.1
    before = np.full(4000 if from_rest else 0, w[0])
    y = lfilter([0.0, *GAINS[:2]], DEN, np.concatenate([before, w]))[before.size :] + GAINS[-1]
    return -1.0 + 5.0 * y


def test_simulation_from_rest_by_hand(levels):
    model = from_json_dict(content())
    np.testing.assert_allclose(model.simulate(2.0 + 3.0 * levels), by_hand(levels, from_rest=True), atol=1e-9)


def test_the_initial_state_is_estimated_from_the_measured_output(levels):
    model = from_json_dict(content())
    decay = 4.0 * POLES[0].real ** np.arange(levels.size)
    measured = by_hand(levels, from_rest=False) + decay
    np.testing.assert_allclose(model.simulate(2.0 + 3.0 * levels, measured), measured, atol=1e-6)


def test_round_trip_through_a_file(levels, tmp_path):
    path = tmp_path / "model.json"
    model = from_json_dict(content())
    path.write_text(json.dumps(model.to_json_dict()))
    again = from_json_dict(load_model(path))
    assert again.to_json_dict() == model.to_json_dict()
    np.testing.assert_array_equal(again.simulate(levels), model.simulate(levels))


@pytest.mark.parametrize(
    ("changed", "words"),
    [
        ({"effects": ["input-delay", "magic"]}, "contains unknown effects: 'magic'"),
        ({"effects": None}, "a value has the wrong type"),
        ({"parameters": ["delay", "low", "log_c", "log_k"]}, "its parameters must be delay, high, log_c, log_k"),
        ({"parameters": None}, "its parameters must be delay"),
        ({"theta": [0.0, LIMIT, np.log(C)]}, "theta must hold 4 numbers within their bounds"),
        ({"theta": [0.0, LIMIT, np.log(C), np.nan]}, "theta must hold 4 numbers within their bounds"),
        ({"theta": [0.0, LIMIT, 1e6, np.log(K)]}, "theta must hold 4 numbers within their bounds"),
        ({"theta": "x"}, "a value has the wrong type"),
        ({"gains": GAINS[:-1]}, "gains must hold 6 numbers; got 5"),
        ({"gains": [*GAINS[:-1], np.inf]}, "its numbers must be finite"),
        ({"reference": np.nan}, "its numbers must be finite"),
        ({"Ts": 0.0}, "Ts, span and the units must be positive"),
        ({"span": -1}, "Ts, span and the units must be positive"),
        ({"y_scale": {"centre": 0.0, "unit": 0.0}}, "Ts, span and the units must be positive"),
        ({"y_scale": {"centre": 0.0}}, "'unit' is missing"),
        ({"u_scale": [1.0, 2.0]}, "a value has the wrong type"),
        ({"input_means": [0.0] * 15}, "input_means must hold 16 numbers"),
        ({"input_means": [np.nan] * 16}, "its numbers must be finite"),
        ({"input_means": None}, "a value has the wrong type|must hold|must be finite"),
    ],
)
def test_invalid_exported_simulations(changed, words):
    with pytest.raises(ValueError, match=words) as caught:
        from_json_dict(content(**changed))
    assert "\n" not in str(caught.value)


def test_every_key_is_required():
    for key in content():
        if key != "schema":
            rest = {name: value for name, value in content().items() if name != key}
            with pytest.raises(ValueError, match=f"'{key}' is missing"):
                from_json_dict(rest)


@pytest.mark.parametrize("text", ["", "{", "[" * 100_000, "\x00", '"a"', "3"])
def test_files_without_a_json_object(tmp_path, text):
    path = tmp_path / "model.json"
    path.write_text(text)
    with pytest.raises(ValueError, match=r"model\.json: (not JSON|must hold a JSON object)"):
        load_model(path)


def test_forms_of_every_effect_have_a_key():
    """Alternative forms can be exported, too."""
    forms = {"extra-lag/ahead", "resonance/beside", "load-step/inside", "load-step/leak"}
    orders = {"input-rate-limit/behind", "input-nonlinearity/first"}
    general = {"overflow/both", "overflow/both-flipped", "input-nonlinearity/rich", "output-nonlinearity/rich"}
    switched = {"input-delay/switched", "input-delay/no-zero switched", "input-rate-limit/switched"}
    assert forms | orders | general | switched <= set(EFFECTS_BY_KEY)
    assert all(effect.key == key for key, effect in EFFECTS_BY_KEY.items())


@pytest.mark.parametrize("key", EFFECTS_BY_KEY)
@pytest.mark.parametrize("beside", [(), (SqrtOutflow("both"),)], ids=["alone", "in tanks"])
def test_an_export_with_any_effect_is_read_again(key, beside, levels):
    tested = EFFECTS_BY_KEY[key]
    hypothesis = Hypothesis((*(effect for effect in beside if effect.name != tested.name), tested))
    numbers = {"log_c": np.log(C), "log_k": np.log(K), "log_a": -1.0, "log_b": -1.5, "zero": -3.0, "brim": 9.0}
    numbers |= {"onset": 0.4, "load": 0.2, "leak": 0.1, "cycles": 7.0, "log_share": -1.0, "high": 0.8, "friction": 0.1}
    theta = np.clip([numbers.get(p.name, 0.1) for p in hypothesis.parameters], *hypothesis.bounds)
    width = hypothesis.design(theta, levels).columns.shape[1]
    gains = np.linspace(0.05, 0.1, width)
    model = exported(hypothesis, theta, gains)
    again = from_json_dict(json.loads(json.dumps(model.to_json_dict())))
    assert again.hypothesis == hypothesis
    played = model.simulate(2.0 + 3.0 * levels[:100])
    assert np.isfinite(played).all()
    np.testing.assert_array_equal(again.simulate(2.0 + 3.0 * levels[:100]), played)


TIME_COURSES = [
    "load-step",
    "periodic-disturbance",
    "output-drift",
    "parameter-drift",
]


def with_time_course(key, levels):
    """A linear rig with an effect that belongs to one record, fitted to the record with the input `levels`."""
    effect = EFFECTS_BY_KEY.get(key) or next(e for e in EFFECTS_BY_KEY.values() if e.name == key)
    hypothesis = Hypothesis((effect,))
    numbers = {"log_c": np.log(C), "log_k": np.log(K), "onset": 0.4, "load": 0.5, "leak": 0.5, "cycles": 7.0}
    numbers |= {"delay": 0.0}
    theta = np.clip([numbers.get(p.name, 0.3) for p in hypothesis.parameters], *hypothesis.bounds)
    width = hypothesis.design(theta, levels).columns.shape[1]
    gains = np.zeros(width)
    gains[:2], gains[5] = (0.02, 0.03), 0.4
    gains[6:] = 0.5
    means = [part.mean() for part in np.array_split(levels, 16)]
    return exported(hypothesis, theta, gains, means), exported(hypothesis, theta, gains)


@pytest.mark.parametrize("key", TIME_COURSES)
def test_a_time_course_is_left_out_on_other_records(key, levels):
    """It is part of the record that was fitted, and of no other one, not even of the same length."""
    model, unknown_record = with_time_course(key, levels)
    own, other = 2.0 + 3.0 * levels, 2.0 + 3.0 * levels[::-1]
    assert np.abs(model.simulate(own) - by_hand(levels, True, np.inf)).max() > 0.02
    np.testing.assert_array_equal(model.simulate(own), unknown_record.simulate(own))
    assert np.abs(model.simulate(other) - unknown_record.simulate(other)).max() > 0.02
    np.testing.assert_allclose(model.simulate(other), by_hand(levels[::-1], True, np.inf), atol=1e-6)
    assert model.simulate(own[:300]).shape == (300,)
    np.testing.assert_allclose(model.simulate(own[:300]), by_hand(levels[:300], True, np.inf), atol=1e-6)


@pytest.mark.parametrize("key", TIME_COURSES)
def test_a_time_course_begins_with_the_record_and_not_with_the_rest_before_it(key, levels):
    """A run from rest is the run from the initial state that its own first samples show."""
    model, _ = with_time_course(key, levels)
    own = 2.0 + 3.0 * levels
    y = model.simulate(own)
    np.testing.assert_allclose(model.simulate(own, y), y, atol=1e-3 * np.std(y))


def test_files_of_earlier_versions_play_their_time_courses_on_every_record(levels):
    model, unknown_record = with_time_course("load-step", levels)
    written = model.to_json_dict()
    assert len(written["input_means"]) == 16
    del written["input_means"]
    again = from_json_dict(written)
    other = 2.0 + 3.0 * levels[::-1]
    np.testing.assert_array_equal(again.simulate(other), unknown_record.simulate(other))


def test_the_fitted_record_is_recognised_from_a_text_file(levels):
    """Numbers in text files have ten digits."""
    model, unknown_record = with_time_course("load-step", levels)
    u = np.array([float(f"{x:.10g}") for x in 2.0 + 3.0 * levels])
    np.testing.assert_array_equal(model.simulate(u), unknown_record.simulate(u))


@pytest.mark.parametrize("away", [(-3.0, 1.5), (2.5, -2.0), (4.0, 6.0), (-5.0, -4.0)])
@pytest.mark.parametrize("brim", ["upper", "lower", "both"])
def test_the_initial_state_of_overflowing_tanks_is_estimated_from_the_measured_output(levels, brim, away):
    """Above the overflow level the cost does not depend on the initial state: its gradient is zero there."""
    hypothesis = Hypothesis((SqrtOutflow("both"), Overflow(brim)))
    numbers = {"log_a": np.log(0.5), "log_b": np.log(0.4), "zero": -3.0, "brim": 10.0, "brim2": 9.8, "share": 0.4}
    numbers |= {"h1": 5.0, "h2": 5.0}  # of the record that was fitted
    theta = np.array([numbers.get(p.name, 0.0) for p in hypothesis.parameters])
    model = exported(hypothesis, theta, np.array([0.5, -1.0]))
    u = levels[200:500]
    began = theta.copy()
    for name, value in zip(("h1", "h2"), away, strict=True):
        began[[p.name for p in hypothesis.parameters].index(name)] = value
    measured = -1.0 + 5.0 * hypothesis.output(began, model.gains, u, 600, 0.1)
    found = model.simulate(2.0 + 3.0 * u, measured)
    np.testing.assert_allclose(found, measured, atol=0.02 * measured.std())


@pytest.mark.parametrize("before", [-2.4, 0.7, 3.0])
@pytest.mark.parametrize(("effect", "own"), [(Delay("switched"), 6.3), (RateLimit("switched"), np.log(0.2))])
def test_the_input_before_sample_0_is_a_state_of_the_record(levels, effect, own, before):
    hypothesis = Hypothesis((effect,))
    place = hypothesis.slices[effect.key]
    numbers = {"log_c": np.log(C), "log_k": np.log(K)}
    theta = np.array([numbers.get(p.name, 0.0) for p in hypothesis.parameters])
    theta[place] = own, 1.1
    gains = np.array([0.02, 0.03, 0.0, 0.0, 0.0, 0.4])
    model = exported(hypothesis, theta, gains)
    began = theta.copy()
    began[place] = own, before
    measured = -1.0 + 5.0 * hypothesis.output(began, gains, levels, 600, 0.1)
    np.testing.assert_allclose(model.simulate(2.0 + 3.0 * levels, measured), measured, atol=1e-3 * measured.std())
    at_rest = model.simulate(2.0 + 3.0 * levels)
    began[place] = own, 0.0
    rest = np.concatenate([np.full(5000, levels[0]), levels])
    np.testing.assert_allclose(at_rest, -1.0 + 5.0 * hypothesis.output(began, gains, rest, 600, 0.1)[5000:], atol=1e-9)
