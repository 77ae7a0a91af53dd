"""Logs through the commands: the table of their columns, what is said of them, and `labsid record`."""

import numpy as np
import pytest
from gap_search import searched

from labsid.records.record import load_record, reading_notes

N = 300
K = np.arange(N)
U = np.array([2.0, 1.0, 3.0, 2.0])[np.minimum(np.maximum(K - 40, 0) // 60 + (K >= 40), 3)]
NOISE = 0.01 * np.random.default_rng(1).standard_normal(N)
Y = np.round(np.convolve(U, 0.1 * 0.9**K)[:N] + 0.9 ** (K + 1) + NOISE, 4)


@pytest.fixture
def log(write_text):
    """A log in milliseconds, with names of its own, a dropped row and a missing output."""
    rows = [f"{5000 + 100 * k},{50 * U[k]:.0f},{'' if k == 33 else Y[k]}\n" for k in K if k != 100]
    return write_text("time_ms,pwm,speed [rad/s]\n" + "".join(rows), "rig.log")


def test_check_lists_the_columns_and_the_line_to_type(labsid, log):
    status, out, err = labsid("check", log)
    assert status == 2
    rows = [line.split() for line in out.splitlines() if line.strip()]
    assert rows[1][:4] == ["time_ms", "299", "0.1", "s"]
    assert [row[0] for row in rows[1:4]] == ["time_ms", "pwm", "speed"]
    assert f"Type: labsid check {log} --columns time_ms,pwm,speed" in out
    assert err.startswith("labsid: error: rig.log: no columns t,u,y; the columns are time_ms, pwm, speed.")
    assert labsid("check", log, "--columns", "time_ms,pwm,speed")[0] == 0


@searched("load-step")
def test_what_was_done_is_said_by_every_command(labsid, log):
    columns = ("--columns", "time_ms,pwm,speed")
    said = (
        "time_ms read as milliseconds (by its name)",
        "1 row of 300 missing by the stamps",
        "u held at its last value in 1 samples",
        "is missing in 2 of 300 samples (33, 100)",
    )
    for command in (["check"], ["identify", "--order", "1"], ["gap", "diagnose"]):
        status, out, err = labsid(*command, log, *columns)
        assert (status, err) == (0, "")
        text = " ".join(out.split())
        for note in said:
            assert note in text or note[0].upper() + note[1:] in text, (command, note)


def test_identify_leaves_incomplete_rows_out(labsid, log):
    out = labsid("identify", log, "--columns", "time_ms,pwm,speed", "--order", "1")[1]
    assert "     4 of these rows left out: an output in them is missing from the record" in out


def test_record_writes_what_was_read_and_any_command_reads_it(labsid, log, tmp_path):
    out = tmp_path / "record.csv"
    status, said, _ = labsid("record", log, "--columns", "time_ms,pwm,speed", "--out", out)
    assert status == 0
    assert said.startswith(f"wrote {out}: 300 samples, one every 0.1 s\nnote: time_ms read as milliseconds")
    text = out.read_text()
    assert text.startswith("# record of rig.log, 300 samples every 0.1 s, labsid ")
    assert "# time_ms read as milliseconds (by its name)\n" in text
    assert "\nt [s],u,y [rad/s]\n" in text
    first, again = load_record(log, columns="time_ms,pwm,speed"), load_record(out)
    for name in ("t", "u", "y"):
        np.testing.assert_array_equal(getattr(again, name), getattr(first, name))
    assert (again.Ts, again.units) == (first.Ts, first.units)
    assert len(reading_notes(again)) == 1  # nothing more was done but to leave the gaps


def test_record_writes_several_logs_into_a_folder(labsid, log, tmp_path):
    other = tmp_path / "second.log"
    other.write_bytes(log.read_bytes())
    out = tmp_path / "records"
    assert labsid("record", log, other, "--columns", "1,2,3", "--out", out)[0] == 0
    assert sorted(path.name for path in out.iterdir()) == ["rig.csv", "second.csv"]


def test_record_never_replaces_the_log(labsid, log):
    status, _, err = labsid("record", log, "--columns", "1,2,3", "--out", log)
    assert status == 2
    assert "is the log itself" in err
    assert log.read_text().startswith("time_ms")


def test_large_offsets_keep_their_digits(labsid, write_text):
    rows = "".join(f"{k / 10},{100000000 + U[k]:.0f},{101325 + Y[k]:.4f}\n" for k in K)
    path = write_text("t,u,y\n" + rows)
    out = labsid("check", path)[1]
    assert "100000001, 100000002, 100000003" in " ".join(out.split())
    assert f"between {101325 + Y.min():.4f}"[:15] in out
    assert "u_offset = 100000002" in labsid("identify", path, "--order", "1")[1]


def test_the_rounding_of_a_log_excites_nothing(labsid, write_text):
    sine = np.round(np.sin((K + 1) / 9), 4)  # with its offset, the first value, of order 3
    path = write_text("t,u,y\n" + "".join(f"{k / 10},{sine[k]},{Y[k]}\n" for k in K))
    assert "persistently exciting of order 3;" in " ".join(labsid("check", path)[1].split())
