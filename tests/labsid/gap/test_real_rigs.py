"""Recordings of real rigs: the effects to be named and the closure to be reached."""

from pathlib import Path

import numpy as np

from labsid.gap.diagnosis import diagnose
from labsid.records.formats import read_raw
from labsid.records.record import Record, load_record


def test_the_overflow_of_the_cascaded_tanks_is_named_and_the_held_back_record_followed(shared_data: Path) -> None:
    path = shared_data / "cascaded-tanks" / "dataBenchmark.csv"
    est, val = (load_record(path, columns=columns, Ts=4.0) for columns in ("uEst,yEst", "uVal,yVal"))
    report = diagnose(est, holdout=val).report
    (effect,) = report["effects"]
    assert effect["name"] == "overflow"
    assert 9.9 < effect["parameters"]["level"]["value"] < 10.2  # the record stands at 10 V
    assert {"sqrt-outflow", "output-nonlinearity"} == set(report["beside"])
    assert report["gap"]["after"] < 0.23  # volts
    assert report["gap"]["black_box"] < report["gap"]["closed"]


def test_the_delay_of_the_hair_dryer_is_named_on_either_half(shared_data: Path) -> None:
    raw = read_raw(shared_data / "hair-dryer" / "dryer.dat", Ts=0.08)
    for half in (slice(0, 500), slice(500, 1000)):
        record = Record(np.arange(500) * 0.08, raw.u[half], raw.y[half], 0.08)
        delays = [
            e["parameters"]["delay"]["value"] for e in diagnose(record).report["effects"] if e["name"] == "input-delay"
        ]
        assert len(delays) == 1
        assert 1.5 < delays[0] / 0.08 < 3.0  # samples beyond the first
