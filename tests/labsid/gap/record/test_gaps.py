"""Records with missing outputs: simulated through, neither fitted nor scored; their units in the report."""

from dataclasses import replace

import numpy as np
import pytest

from labsid.cli.commands import main
from labsid.gap.diagnosis import diagnose
from labsid.records.record import Record


@pytest.fixture(scope="module")
def clipped(rig_record):
    return rig_record("input-saturation", 400)


@pytest.fixture
def holey(clipped):
    """The record with every 40th output missing, and a stretch of ten."""
    y = clipped.y.copy()
    y[7::40] = np.nan
    y[200:210] = np.nan
    return replace(clipped, y=y)


def test_missing_outputs_change_neither_effects_nor_parameters(clipped, holey):
    whole, report = diagnose(clipped).report, diagnose(holey).report
    (effect,), (expected,) = report["effects"], whole["effects"]
    assert effect["name"] == expected["name"] == "input-saturation"
    high, reference = effect["parameters"]["high"], expected["parameters"]["high"]
    assert high["value"] == pytest.approx(reference["value"], abs=3.0 * reference["stderr"])
    assert "y is missing in" in report["record_findings"][0]["text"]


def test_records_with_gaps_beside_others_are_refused(clipped, holey):
    with pytest.raises(ValueError, match=r"record 2 has \d+ samples without an output. Diagnose it alone"):
        diagnose([replace(clipped, name=""), replace(holey, name="")])
    with pytest.raises(ValueError, match=r"the holdout has \d+ samples without an output. Cut it"):
        diagnose(clipped, holdout=holey)


def test_units_of_the_log_stand_in_the_report_and_a_replay_leaves_gaps_out(tmp_path, capsys, clipped, holey):
    rows = zip(holey.t.tolist(), holey.u.tolist(), holey.y.tolist(), strict=True)
    text = "t [s],u [V],y [rad]\n" + "".join(f"{t!r},{u!r},{'' if y != y else repr(y)}\n" for t, u, y in rows)
    (tmp_path / "log.csv").write_text(text)
    better = tmp_path / "better.json"
    assert main(["gap", "diagnose", str(tmp_path / "log.csv"), "--export", str(better)]) == 0
    said = capsys.readouterr().out
    assert "rad" in said
    assert "units of y" not in said
    assert main(["gap", "simulate", str(better), str(tmp_path / "log.csv")]) == 0
    error = float(capsys.readouterr().out.split("rmse ")[1].split()[0])
    assert 0.0 < error < 0.2 * float(np.std(clipped.y))


def test_a_record_with_gaps_can_be_used_like_any_other(holey):
    assert isinstance(holey, Record)
    assert holey.missing.sum() == np.isnan(holey.y).sum() > 10
    assert "without y" in repr(holey)
    with pytest.raises(ValueError, match="u must be finite"):
        replace(holey, u=np.where(holey.missing, np.nan, holey.u))
