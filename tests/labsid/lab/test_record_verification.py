"""Fig. 4 on another record."""

from dataclasses import replace

import numpy as np
import pytest

from labsid.lab.arx import ArxModel
from labsid.lab.arx_system import simulate_system, system_from_thetas
from labsid.lab.identification import identify
from labsid.lab.record_verification import verify_on_record, verify_system_on_record
from labsid.lab.simulation import simulate
from labsid.records.record import Record, load_record

MODEL = ArxModel([1, -1.377, 0.392], [-0.0067, 0.0514], 0.75, u_offset=2.0, y_offset=2.33)


def other_record(model, level, first=60, N=500):
    """Another run of the same process: it rests `level` higher, and at another input."""
    rng = np.random.default_rng(3)
    u = np.append(np.full(first, 1.8), rng.choice([1.6, 2.2], (N - first) // 20).repeat(20))
    y = model.y_offset + model.static_gain * (1.8 - model.u_offset) + level + simulate(model, u - 1.8)
    return Record(t=model.Ts * np.arange(u.size), u=u, y=y, Ts=model.Ts)


def test_a_true_model_is_verified_on_another_record_and_the_moved_level_named():
    result = verify_on_record(MODEL, other_record(MODEL, level=0.4))
    assert result.start == 0
    assert result.mse < 1e-24
    assert result.level_shift == pytest.approx(0.4)
    np.testing.assert_allclose(result.error, result.y - result.y_sim, atol=0)


def test_a_model_of_the_wrong_gain_is_found_out_on_another_record():
    wrong = ArxModel(MODEL.a, 0.8 * MODEL.b, MODEL.Ts, MODEL.u_offset, MODEL.y_offset)
    record = other_record(MODEL, level=0.0)
    result = verify_on_record(wrong, record)
    assert result.mse == pytest.approx(0.04 * np.mean((record.y - record.y[0]) ** 2), rel=1e-6)


def test_an_integrator_has_no_level_to_shift_from_but_at_its_own_input():
    integrator = ArxModel([1, -1], [0.1], 0.75, u_offset=1.8, y_offset=1.0)
    record = other_record(MODEL, level=0.0)
    assert verify_on_record(integrator, record).level_shift == pytest.approx(record.y[0] - 1.0)
    elsewhere = ArxModel([1, -1], [0.1], 0.75, u_offset=2.0, y_offset=1.0)
    assert verify_on_record(elsewhere, record).level_shift == np.inf


@pytest.mark.parametrize(("name", "shift"), [("4", 0.09), ("8", 0.47)])
def test_the_model_of_the_lab_file_holds_on_the_other_runs_of_the_rig(shared_data, name, shift):
    folder = shared_data / "unsw-water-tank"
    model = identify(load_record(folder / "SysIdenData_StudentVersion.mat")).model
    record = load_record(folder / f"SysIdenData_{name}.mat")
    result = verify_on_record(model, record)
    assert result.start == result.offsets.settled[0] > 100
    assert result.mse < 5e-3
    assert result.mse < 0.02 * np.var(result.y)
    # At the same 2.0 V the rig now rests higher.
    assert result.level_shift == pytest.approx(shift, abs=0.01)


def test_record_and_model_must_have_one_sampling_time():
    record = Record(t=np.arange(5.0), u=np.arange(5.0), y=np.arange(5.0), Ts=1.0)
    with pytest.raises(ValueError, match="record and model must have one sampling time; got 1 s and"):
        verify_on_record(MODEL, record)


# Several signals ------------------------------------------------------------------------------------------

SYSTEM = system_from_thetas([[0.9, 0.3, 0.1], [0.7, 0.0, 0.5]], 1, 0.5, ("a", "b"), ("c", "d"))


def several(**changes):
    rng = np.random.default_rng(1)
    u = rng.standard_normal((200, 2))
    y = simulate_system(SYSTEM, u, [2.0, -1.0]) + np.array([5, 6])
    given = {"t": 0.5 * np.arange(200), "u": u + np.array([1, 2]), "y": y, "Ts": 0.5}
    return Record(**(given | {"inputs": ("a", "b"), "outputs": ("c", "d")} | changes))


def test_a_system_follows_another_record_from_a_state_of_its_own():
    model = replace(SYSTEM, u_offset=[1, 2], y_offset=[5, 6])
    y = several().y.copy()
    y[100:120, 0] = np.nan
    found = verify_system_on_record(model, several(y=y))
    assert found.mse.max() < 1e-20
    assert np.isnan(found.error).sum() == 20
    np.testing.assert_allclose(found.y_sim, several().y, atol=1e-9)


@pytest.mark.parametrize(
    ("changes", "start", "message"),
    [
        ({"t": np.arange(200.0), "Ts": 1.0}, 50, r"must have one sampling time; got 1 s and 0\.5 s"),
        ({"inputs": ("b", "a")}, 50, r"must have the same signals; got b, a, c, d and a, b, c, d\. Read the record"),
        ({}, 150, r"the record must have at least 300 samples, twice start; got 200"),
    ],
)
def test_a_record_that_does_not_fit_the_system(changes, start, message):
    with pytest.raises(ValueError, match=message):
        verify_system_on_record(SYSTEM, several(**changes), start)


def test_a_model_of_one_signal_each_takes_no_record_of_several():
    with pytest.raises(ValueError, match="comparison with another record takes one input and one output"):
        verify_on_record(ArxModel([1, -0.9], [0.1], 0.5), several())
