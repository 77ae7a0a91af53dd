"""Simulation files: read by --sim, simulated and written by `simulate`."""

import json

import numpy as np
import pytest
from gap_search import searched

from labsid.gap.diagnosis import diagnose
from labsid.gap.simulations.simulation_files import load_simulation, replay, write_replay
from labsid.records.record import Record, load_record

DEN = np.poly([0.95, 0.8]).tolist()


@pytest.fixture(scope="module")
def record(rig_record):
    return rig_record("none", 200)


@pytest.fixture
def model(tmp_path, record):
    path = tmp_path / "model.json"
    start = float(record.u[0])
    path.write_text(json.dumps({"num": [0.01, 0.0], "den": DEN, "dt": 0.5, "u0": start, "y0": start}))
    return path


def test_a_series_is_read_at_the_records_times(tmp_path, record):
    path = tmp_path / "sim.CSV"
    rows = "\n".join(f"{x},{2 * x},{t}" for t, x in zip(record.t, record.y, strict=True))
    path.write_text("\ufeffy,z,t\n" + rows)
    np.testing.assert_array_equal(load_simulation(path, record).y, record.y)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "holds no rows"),
        ("t,y\n0,1\n0.5,2\n", "at all times of the record, 0 to 99.5 s; got 0 to 0.5 s"),
        ("t,y\n", "holds no rows"),
        ("time,y\n0,1\n", "with the header t,y"),
        ("t,y\n0,one\n", "with the header t,y and numbers below"),
        ("t,y\n0\n", "with the header t,y and numbers below"),
        ("t,y\n" + "".join(f"{0.5 * k},nan\n" for k in range(200)), "must hold finite numbers; got y = nan in row 1"),
        ("t,y\n" + "".join(f"{0.5 * k + 0.6},1\n" for k in range(200)), "0 to 99.5 s; got 0.6 to 100.1 s"),
        ("t,y\n" + "".join(f"{0.5 * min(k, 199)},1\n" for k in range(201)), "must increase; got t = 99.5 s in row 201"),
        (
            "t,y\n" + "".join(f"{'nan' if k == 7 else 0.5 * k},1\n" for k in range(200)),
            "must hold finite numbers; got t = nan in row 8",
        ),
    ],
)
def test_series_that_are_none(tmp_path, record, text, words):
    path = tmp_path / "sim.csv"
    path.write_text(text)
    with pytest.raises(ValueError, match=words):
        load_simulation(path, record)


def test_bytes_are_no_series(tmp_path, record):
    path = tmp_path / "sim.csv"
    path.write_bytes(b"t,y\n\xff\xfe\x00")
    with pytest.raises(ValueError, match="with the header t,y and numbers below"):
        load_simulation(path, record)


def test_a_model_is_simulated_from_the_state_estimated_from_the_record(model, record):
    later = Record(record.t[60:], record.u[60:], record.y[60:], record.Ts)
    played = replay(model, later)
    assert played.start == 50
    assert played.rmse == pytest.approx(np.sqrt(np.mean((later.y - played.y)[50:] ** 2)))
    assert played.rmse < 0.02 * np.std(record.y)


def test_a_short_record_counts_as_a_whole(model, record):
    short = Record(record.t[:20], record.u[:20], record.y[:20], record.Ts)
    assert replay(model, short).start == 0


@searched("input-saturation", "extra-lag", "output-saturation", "load-step")
def test_an_exported_model_can_be_simulated_and_diagnosed_again(tmp_path, record):
    found = diagnose(record)
    path = tmp_path / "better.json"
    path.write_text(json.dumps(found.model.to_json_dict()))
    played = replay(path, record)
    np.testing.assert_array_equal(played.y, found.model.simulate(record.u, record.y))
    assert played.rmse == pytest.approx(found.report["gap"]["after"], rel=0.3)
    again = diagnose(record, load_simulation(path, record)).report
    assert (again["verdict"], again["simulation"]["given"]) == ("none", True)


@searched("extra-lag", "load-step")
def test_an_output_that_no_model_reproduces_cannot_be_exported(record):
    found = diagnose(record, np.minimum(record.y, np.median(record.y)))
    with pytest.raises(ValueError, match="cannot be exported"):
        found.model.to_json_dict()


@pytest.mark.parametrize(
    ("changed", "words"),
    [({"dt": 1.0}, "sampling time 0.5 s; got 1 s"), ({"den": [1.0, -3.0, 1.0]}, "unstable on this record")],
)
def test_models_that_cannot_be_played(model, record, changed, words):
    model.write_text(json.dumps(json.loads(model.read_text()) | changed))
    with pytest.raises(ValueError, match=words):
        replay(model, record)


def test_written_files_can_be_read_again(tmp_path, record):
    path = tmp_path / "played.csv"
    write_replay(path, record, record.y + 1.0)
    again = load_record(path)
    np.testing.assert_array_equal(again.y, record.y)
    again = load_record(path, columns="t,u,y_sim")
    np.testing.assert_array_equal(again.y, record.y + 1.0)
