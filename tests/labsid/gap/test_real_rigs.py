"""Recordings of real rigs: the effects to be named and the closure to be reached."""

from pathlib import Path

import numpy as np
import pytest

from labsid.gap.diagnosis import diagnose
from labsid.gap.rigs import check_rigs, find_rigs
from labsid.records.formats import read_raw
from labsid.records.reading import Reading
from labsid.records.record import Record, load_record

pytestmark = pytest.mark.usefixtures("without_limits")


@pytest.mark.exhaustive  # `labsid gap rigs`, which CI runs, plays this record on its second one, too
def test_the_overflow_of_the_cascaded_tanks_is_named_and_the_held_back_record_followed(shared_data: Path) -> None:
    path = shared_data / "cascaded-tanks" / "dataBenchmark.csv"
    est, val = (load_record(path, columns=columns, Ts=4.0) for columns in ("uEst,yEst", "uVal,yVal"))
    report = diagnose(est, holdout=val).report
    assert report["verdict"] == "partial"
    likely = [effect for effect in report["effects"] if effect["probability"] > 0.5]
    assert likely[0]["name"] == "overflow"
    assert likely[0]["probability"] > 0.9
    assert {effect["name"] for effect in likely[1:]} <= {"sqrt-outflow"}  # both tanks have a free outlet
    assert 9.9 < likely[0]["parameters"]["level"]["value"] < 10.2  # the record stands at 10 V
    assert report["gap"]["after"] < 0.19  # volts


@pytest.mark.parametrize("start", [0, pytest.param(500, marks=pytest.mark.exhaustive)])
def test_the_delay_of_the_hair_dryer_is_named_on_either_half(start: int, shared_data: Path) -> None:
    raw = read_raw(shared_data / "hair-dryer" / "dryer.dat", Reading(Ts=0.08))
    half = slice(start, start + 500)
    report = diagnose(Record(np.arange(500) * 0.08, raw.u[half], raw.y[half], 0.08)).report
    delays = [one["parameters"]["delay"]["value"] for one in report["effects"] if one["name"] == "input-delay"]
    assert len(delays) == 1
    assert 1.5 < delays[0] / 0.08 < 3.0  # samples beyond the first


@pytest.mark.exhaustive  # `labsid gap rigs`, which CI runs, does the same
def test_the_absolute_value_of_the_coupled_drives_is_found(shared_data: Path) -> None:
    (pair,) = [pair for pair in find_rigs(shared_data / "real-rigs") if pair[0].stem == "coupled-drives"]
    (result,) = check_rigs([pair])
    assert not result.is_worse
    assert not result.is_poor_baseline
    assert result.after < 0.4
    assert "output-nonlinearity" in dict(result.effects)


def test_a_folder_without_second_records_is_said(tmp_path: Path) -> None:
    (tmp_path / "one.csv").write_text("t,u,y\n")
    with pytest.raises(ValueError, match=r"no NAME.csv with a NAME.holdout.csv beside it"):
        find_rigs(tmp_path)
