"""Exported simulations: simulation by hand, round trip through a file, and invalid files."""

import json

import numpy as np
import pytest
from scipy.signal import lfilter

from labsid.gap.data import Scale
from labsid.gap.effects.dynamics import Overflow, SqrtOutflow
from labsid.gap.effects.input import Delay, RateLimit
from labsid.gap.hypothesis import Hypothesis
from labsid.gap.model_file import EFFECTS_BY_KEY, ExportedModel, from_json_dict, load_model

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


def by_hand(scaled_u, from_rest):
    """The same in scipy's words, in the record's unit."""
    w = np.minimum(scaled_u, LIMIT) - 0.1
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
    model = ExportedModel(hypothesis, theta, gains, 0.5, 600, 0.1, Scale(2.0, 3.0), Scale(-1.0, 5.0))
    again = from_json_dict(json.loads(json.dumps(model.to_json_dict())))
    assert again.hypothesis == hypothesis
    played = model.simulate(2.0 + 3.0 * levels[:100])
    assert np.isfinite(played).all()
    np.testing.assert_array_equal(again.simulate(2.0 + 3.0 * levels[:100]), played)


@pytest.mark.parametrize("away", [(-3.0, 1.5), (2.5, -2.0), (4.0, 6.0), (-5.0, -4.0)])
@pytest.mark.parametrize("brim", ["upper", "lower", "both"])
def test_the_initial_state_of_overflowing_tanks_is_estimated_from_the_measured_output(levels, brim, away):
    """Above the overflow level the cost does not depend on the initial state: its gradient is zero there."""
    hypothesis = Hypothesis((SqrtOutflow("both"), Overflow(brim)))
    numbers = {"log_a": np.log(0.5), "log_b": np.log(0.4), "zero": -3.0, "brim": 10.0, "brim2": 9.8, "share": 0.4}
    numbers |= {"h1": 5.0, "h2": 5.0}  # of the record that was fitted
    theta = np.array([numbers.get(p.name, 0.0) for p in hypothesis.parameters])
    model = ExportedModel(hypothesis, theta, np.array([0.5, -1.0]), 0.5, 600, 0.1, Scale(2.0, 3.0), Scale(-1.0, 5.0))
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
    model = ExportedModel(hypothesis, theta, gains, 0.5, 600, 0.1, Scale(2.0, 3.0), Scale(-1.0, 5.0))
    began = theta.copy()
    began[place] = own, before
    measured = -1.0 + 5.0 * hypothesis.output(began, gains, levels, 600, 0.1)
    np.testing.assert_allclose(model.simulate(2.0 + 3.0 * levels, measured), measured, atol=1e-3 * measured.std())
    at_rest = model.simulate(2.0 + 3.0 * levels)
    began[place] = own, 0.0
    rest = np.concatenate([np.full(5000, levels[0]), levels])
    np.testing.assert_allclose(at_rest, -1.0 + 5.0 * hypothesis.output(began, gains, rest, 600, 0.1)[5000:], atol=1e-9)
