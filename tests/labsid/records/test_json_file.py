"""JSON as devices and tables write it."""

import json

import numpy as np
import pytest

from labsid.records.json_file import open_log
from labsid.records.library_formats import JSON, library_format
from labsid.records.record import load_record

N = 40
T = [k / 10 for k in range(N)]
U = [k % 7 for k in range(N)]
Y = [None if k == 3 else k / 3 for k in range(N)]
ROWS = [{"t": t, "u": u, "y": y} for t, u, y in zip(T, U, Y, strict=True)]
COLUMNS = {"t": T, "u": U, "y": Y}


@pytest.fixture
def opened(tmp_path):
    def open_content(content):
        path = tmp_path / "a.json"
        path.write_text(content if isinstance(content, str) else json.dumps(content))
        assert library_format(path) is JSON
        return open_log(path)

    return open_content


@pytest.mark.parametrize(
    ("content", "prefix"),
    [
        (ROWS, ""),
        (COLUMNS, ""),
        ("\n".join(map(json.dumps, ROWS)) + '\n{"t": 4.0, "u', ""),
        ({"rig": 7, "samples": ROWS}, "samples."),
        ({"run": {"log": COLUMNS}}, "run.log."),
        ({name: dict(enumerate(x)) for name, x in COLUMNS.items()}, ""),
    ],
)
def test_objects_of_each_sample_and_lists_of_each_signal(opened, content, prefix):
    log = opened(content)
    assert log.names == tuple(prefix + name for name in "tuy")
    t, u, y = log.read([0, 1, 2])
    assert u.values.dtype == np.int64
    np.testing.assert_array_equal(t.values, T)
    np.testing.assert_array_equal(u.values, U)
    np.testing.assert_array_equal(y.values, np.array(Y, float))
    assert log.notes == (("the last line is cut off; left out",) if isinstance(content, str) else ())


def test_dates_switches_units_and_nested_members(opened):
    log = opened([{"at": f"2026-03-01T10:00:{k:02d}Z", "on": k > 3, "q": [k / 7], "v": f"{k} V"} for k in range(9)])
    assert log.names == ("at", "on", "q[0]", "v")
    at, on, _, v = log.read([0, 1, 2, 3])
    assert (at.values.dtype.kind, v.unit) == ("M", "V")
    np.testing.assert_array_equal(on.values, np.arange(9) > 3)


def test_rows_without_names_have_numbers(opened):
    log = opened([[t, float(u)] for t, u in zip(T, U, strict=True)])
    assert (log.names, log.has_names) == (("1", "2"), False)


@pytest.mark.parametrize(
    ("content", "says"),
    [
        ("[" * 100_000, "nested too deeply"),
        ('{"t": 1,\n', "line 1 is no JSON .*Repair or delete that line"),
        ('{"t": 1}\n{"t" 2}\n', "line 2 is no JSON"),
        ({"who": "Ann"}, "there are no lists of numbers in it"),
        ([{"t": "1"}, {"t": "2"}, {"t": "x"}], "column t, row 3 of the data: 'x' is not a number"),
    ],
)
def test_what_is_refused(opened, content, says):
    with pytest.raises(ValueError, match=says):
        opened(content)


def test_a_record(tmp_path):
    (tmp_path / "a.jsonl").write_text("\n".join(map(json.dumps, ROWS)))
    record = load_record(tmp_path / "a.jsonl")
    assert (record.Ts, np.flatnonzero(record.missing).tolist()) == (0.1, [3])
