"""What is printed is a function of the result alone; what is written is there whole or not at all."""

import json
import os

import numpy as np
import pytest

from labsid._files import write_file, write_json
from labsid.cli.console import identification_text, print_check, theta_texts
from labsid.lab.identification import identify
from labsid.lab.record_check import check_record
from labsid.records.formats import RawRecord
from labsid.records.record import Record


@pytest.fixture
def tank(staircase):
    s = staircase
    return Record(s["t"], s["u"], s["y"], 0.75, name="tank run")


def test_identification_text_says_what_was_found(tank):
    result = identify(tank)
    text = identification_text(result)
    assert text == identification_text(identify(tank))
    lines = text.splitlines()
    assert lines[0] == "tank run: 600 samples, Ts = 0.75 s"
    assert f"y_offset = {result.offsets.y_offset:.8f}, the mean of samples 0 to 99" in lines
    assert any(line.startswith("Phi: rows k = 2 to 299 of the first half") for line in lines)
    printed = [line.split() for line in lines]
    for symbol, value, error in zip(["-a1", "-a2", "b1", "b2"], result.fit.theta, result.fit.stderr, strict=True):
        row = next(words for words in printed if words[:1] == [symbol])
        assert float(row[1]) == pytest.approx(value, abs=0.05 * error)
        assert row[2] == "±"
        assert float(row[3]) == pytest.approx(error, rel=0.05)
        assert ("zero" in row) == (abs(value) < 2 * error)
    for number in (result.verification.mse_all, result.verification.mse_second_half_carried):
        assert f"{number:.5e}" in text
    assert "<TransferFunction>: G" in text
    assert "<StateSpace>: G" in text
    assert "follows the second half closely" in text
    assert "It is stable, with static gain" in text
    assert "Warning:" not in text


def test_identification_text_in_words(tank):
    late = Record(tank.t[:500], tank.u[97:597], tank.y[97:597], 0.75)
    result = identify(late)
    (warning,) = result.warnings
    assert f"Warning: {warning}." in " ".join(identification_text(result).split())
    noise = Record(tank.t, tank.u, np.r_[tank.y[:300], 5 * np.sin(np.arange(300.0))], 0.75)
    text = " ".join(identification_text(identify(noise)).split())
    assert "follows the second half" in text
    assert "closely" not in text
    flat = Record(tank.t, tank.u, np.r_[tank.y[:300], np.full(300, 2.3)], 0.75)
    assert "follows the second half" not in identification_text(identify(flat))


def test_print_check_gives_the_verdict_first(tank, capsys):
    check = check_record(RawRecord(tank.t, tank.u, tank.y))
    print_check(check)
    lines = capsys.readouterr().out.splitlines()
    assert " ".join(lines[: lines.index("")]) == check.verdict
    assert max(map(len, lines)) <= 80
    assert all(line == line.rstrip() for line in lines)
    words = " ".join(" ".join(lines).split())
    assert "ok rest settled from the start: 100 samples" in words


def test_write_file_replaces_whole(tmp_path):
    path = tmp_path / "out.json"
    path.write_text("old")
    write_json(path, {"a": [1.5, 2]})
    assert json.loads(path.read_text()) == {"a": [1.5, 2]}
    assert [entry.name for entry in tmp_path.iterdir()] == ["out.json"]


def test_write_file_leaves_the_old_one_when_it_fails(tmp_path, monkeypatch):
    path = tmp_path / "out.json"
    path.write_text("old")

    def fail(source, target):
        raise OSError(28, "No space left on device", str(target))

    monkeypatch.setattr(os, "replace", fail)
    with pytest.raises(OSError, match="No space left"):
        write_file(path, b"new")
    assert path.read_text() == "old"
    assert [entry.name for entry in tmp_path.iterdir()] == ["out.json"]


def test_write_file_needs_a_folder_and_a_file_name(tmp_path):
    with pytest.raises(FileNotFoundError, match="there is no such folder to write to"):
        write_file(tmp_path / "nowhere" / "out.json", b"")
    with pytest.raises(IsADirectoryError, match="it is a folder; name a file to write to"):
        write_file(tmp_path, b"")


@pytest.mark.skipif(not hasattr(os, "symlink") or os.name == "nt", reason="symbolic links need rights on Windows")
def test_write_file_keeps_a_link_a_link(tmp_path):
    (tmp_path / "link.json").symlink_to(tmp_path / "real.json")
    write_file(tmp_path / "link.json", b"new")
    assert (tmp_path / "link.json").is_symlink()
    assert (tmp_path / "real.json").read_bytes() == b"new"


def test_nan_is_no_json(tmp_path):
    with pytest.raises(ValueError, match="not JSON compliant"):
        write_json(tmp_path / "out.json", {"a": float("nan")})
    assert list(tmp_path.iterdir()) == []


def test_signs_stand_in_one_column():
    values, errors = np.array([1.36612, -0.40211, 0.00012, -12.0]), np.array([0.0381, 0.0362, 0.0011, 0.0])
    assert theta_texts(values, errors) == [
        " 1.366  ± 0.038",
        "-0.402  ± 0.036",
        " 0.0001 ± 0.0011  not told from zero",
        "-12.00",
    ]
