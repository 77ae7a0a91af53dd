"""One record in 27 forms, as loggers write them: each is read right, with the shortest options."""

import os
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
from scipy.io import savemat

from labsid.lab.identification import identify
from labsid.records.record import Record, between_outputs, load_record, reading_notes

EVEN = {"columns": "u,y", "Ts": 0.1}
FORMS = {
    "batches.csv": ({}, "stamps that 5 samples share"),
    "epoch.csv": ({}, "times count from 2025-11-24 16:00:00 UTC"),
    "fortran.txt": ({}, "no header: columns taken as t,u,y"),
    "gaps.csv": ({}, "y is missing in 9 of 800 samples"),
    "german.csv": ({"columns": "Zeit,Spannung,Füllstand"}, "decimal commas"),
    "ide_prefix.txt": ({}, "no header"),
    "iso.csv": ({}, "times count from 2026-03-01 09:00:00"),
    "jitter.csv": ({"Ts": 0.1}, "the stamps deviate by 0.096 of the sampling time"),
    "log_start.csv": ({}, "2 lines before the table skipped"),
    "micros_wrap.csv": ({}, "the 32-bit counter us wraps once; unwrapped"),
    "missing_rows.csv": ({}, "16 rows of 800 missing by the stamps"),
    "ms.csv": ({"columns": "time_ms,pwm,speed"}, "time_ms read as milliseconds (by its name)"),
    "nested.mat": ({"columns": "log.run.data.1,log.run.data.2,log.run.data.3"}, ""),
    "plain.csv": ({}, ""),
    "reset.csv": (EVEN, ""),
    "scope.mat": ({"columns": "1,2,3"}, ""),
    "simple.mat": ({}, ""),
    "struct.mat": ({}, ""),
    "table.parquet": ({}, ""),
    "table.xlsx": ({}, ""),
    "thousands.csv": ({}, "'.' read as a mark of thousands"),
    "units_row.csv": ({}, "the row under the header read as units: s, V, cm"),
    "v73.mat": ({}, ""),
    "arrays.npz": ({}, ""),
    "columns.npy": ({}, "no header: columns taken as t,u,y"),
}
SCALES = {"ms.csv": 51.0, "thousands.csv": 1000.0}  # of u, against that of plain.csv
LEFT_OUT = {"gaps.csv": 9, "missing_rows.csv": 16}


@pytest.fixture(scope="module")
def logs(shared_data):
    folder = shared_data / "logs"
    if not folder.is_dir():
        pytest.skip(f"the logs are not on this machine (looked in {folder})")
    return folder


@pytest.fixture(scope="module")
def plain(logs):
    return load_record(logs / "plain.csv")


def test_no_form_is_forgotten(logs):
    known = {*FORMS, "boolean.csv", "two_rates.csv"}
    assert {path.name for path in logs.iterdir()} == known
    assert len(known) == 27


@pytest.mark.parametrize("name", FORMS)
def test_a_form_gives_the_samples_and_the_theta_of_the_plain_record(logs, plain, name):
    options, says = FORMS[name]
    record = load_record(logs / name, **options)
    scale = SCALES.get(name, 1.0)
    rounding = 1.0 if name == "ms.csv" else 6e-6 * scale  # of the numbers in the file
    assert (len(record), record.Ts) == (800, 0.1)
    assert record.missing.sum() == LEFT_OUT.get(name, 0)
    there = ~record.missing
    assert np.abs(record.u - scale * plain.u)[there].max() <= rounding
    assert np.abs(record.y - plain.y)[there].max() <= 6e-6
    notes = "; ".join(reading_notes(record))
    assert says in notes
    assert ("the stamps deviate" in notes) == (name == "jitter.csv")  # rounding errors of floats are no jitter
    found, expected = identify(record, order=1), identify(plain, order=1)
    # theta of a record with gaps comes from fewer rows: it differs within its standard error, and by no more.
    slack = expected.fit.stderr * 0.3 if name in LEFT_OUT else [2e-4 if name == "ms.csv" else 1e-6] * 2
    assert np.all(np.abs(found.fit.theta * [1.0, scale] - expected.fit.theta) <= slack)
    assert found.incomplete_rows == {"gaps.csv": 8, "missing_rows.csv": 16}.get(name, 0)


def test_an_input_that_is_on_or_off_is_another_input(logs, plain):
    record = load_record(logs / "boolean.csv", columns="t,heater,T")
    np.testing.assert_array_equal(record.u, plain.u > 2.5)
    assert record.notes == ("heater: on read as 1, off as 0",)


def test_two_rates_are_read_at_the_slower_one(logs, plain):
    sparse = load_record(logs / "two_rates.csv")
    assert sparse.missing.sum() == 600
    assert "y has a reading at one sample in 4 only" in reading_notes(sparse)[0]
    assert "--resample 0.4" in reading_notes(sparse)[0]
    with pytest.raises(ValueError, match=r"only 0 have all their outputs.*\(--resample\)"):
        identify(sparse, order=1)
    record = load_record(logs / "two_rates.csv", resample=0.4)
    np.testing.assert_allclose(record.y, plain.y[::4])
    np.testing.assert_allclose(record.u, plain.u[::4])
    # The pole at 0.4 s is the fourth power of that at 0.1 s, within what the changes between samples do to the fit.
    assert identify(record, order=1).model.poles[0].real == pytest.approx(0.91811**4, abs=0.02)


def test_time_that_starts_again_is_two_runs_or_one_clock(logs, plain):
    with pytest.raises(ValueError, match=r"time goes backwards from sample 399 .*--select 1.*without times"):
        load_record(logs / "reset.csv")
    for number, rows in ((1, slice(400)), (2, slice(400, 800))):
        run = load_record(logs / "reset.csv", select=number)
        np.testing.assert_array_equal(run.y, plain.y[rows])
    with pytest.raises(ValueError, match="there are 2 runs in it; got select 3"):
        load_record(logs / "reset.csv", select=3)


@pytest.mark.parametrize(
    ("file", "how", "labels"),
    [
        ("ms.csv", {"columns": "1,2,3"}, ("pwm", "speed")),
        ("log_start.csv", {}, ("Input", "Output")),
        ("plain.csv", {}, ("u", "y")),
        ("fortran.txt", {}, ("u", "y")),  # without a header
    ],
)
def test_labels_are_the_names_of_the_columns(logs, file, how, labels):
    found = load_record(logs / file, **how)
    assert (found.labels, found.inputs, found.outputs) == (labels, ("u",), ("y",))


def test_jitter_beyond_a_tenth_names_what_decides(logs):
    with pytest.raises(ValueError, match=r"sampling is irregular: .*\(--Ts 0.1\).*\(--resample 0.1\)"):
        load_record(logs / "jitter.csv")


def test_logs_of_a_temperature_lab_are_read_with_their_times(shared_data):
    folder = shared_data / "several-signals"
    with pytest.raises(ValueError, match=r"time stands still .*--repeated first, or last"):
        load_record(folder / "tclab-step.csv", columns="Time,Q1,T1")
    step = load_record(folder / "tclab-step.csv", columns="Time,Q1,T1", repeated="first")
    assert (len(step), step.Ts, step.u[0], step.u[1]) == (800, 1.0, 0.0, 50.0)
    for heater, sensor in (("Q1", "T1"), ("Q2", "T2")):
        two = load_record(folder / "tclab-two-heaters.csv", columns=f"Time,{heater},{sensor}")
        assert (len(two), two.Ts, two.missing.sum()) == (801, 1.0, 1)


def test_a_pipe_is_read_from_its_beginning(tmp_path):
    pipe = tmp_path / "pipe.csv"
    os.mkfifo(pipe)
    text = "t,u,y\n" + "".join(f"{k / 10},{k % 7},{k}\n" for k in range(5000))
    with ThreadPoolExecutor() as pool:
        written = pool.submit(pipe.write_text, text)
        record = load_record(pipe)
        assert written.result() == len(text)
    assert (record.name, len(record), record.y[0]) == ("pipe", 5000, 0.0)


def test_days_are_not_taken_for_seconds_by_the_name_t(tmp_path):
    path = tmp_path / "days.csv"
    path.write_text("t,u,y\n" + "".join(f"{739946 + k / 864000!r},{k % 7},{k}\n" for k in range(50)))
    with pytest.raises(ValueError, match=r"t may hold seconds or days \(MATLAB's datenum\)"):
        load_record(path)
    assert load_record(path, time_unit="days").Ts == pytest.approx(0.1)


def test_offsets_come_from_outputs_that_are_there(tmp_path):
    """The first output lies 8 s after the first input: what was before is left out, and said."""
    rng = np.random.default_rng(2)
    u = np.repeat(rng.uniform(1.0, 2.0, 12), 50)
    y = np.concatenate([[2.0], 2.0 + np.cumsum(0.1 * rng.standard_normal(599))])
    y[:80] = y[-20:] = np.nan
    path = tmp_path / "late.csv"
    rows = zip((0.1 * np.arange(600)).tolist(), u.tolist(), y.tolist(), strict=True)
    path.write_text("t,u,y\n" + "".join(f"{a!r},{b!r},{'' if c != c else c!r}\n" for a, b, c in rows))
    found = identify(load_record(path), order=1)
    assert len(found.record) == 500
    assert found.offsets.u_offset == u[80]
    assert found.record.notes[-1] == "y is missing in the first 80 and the last 20 samples; these are left out"


@pytest.mark.parametrize(
    ("first", "last", "said"),
    [
        (3, 0, "the first 3 samples; these are left out"),
        (0, 2, "the last 2 samples; these are left out"),
        (1, 4, "the first 1 and the last 4 samples; these are left out"),
        (1, 0, "the first sample; it is left out"),
        (0, 1, "the last sample; it is left out"),
    ],
)
def test_only_the_ends_without_an_output_are_said(first, last, said):
    y = np.arange(40.0)
    y[:first] = y[40 - last :] = np.nan
    record = Record(0.1 * np.arange(40), np.arange(40.0), y, 0.1)
    assert between_outputs(record).notes == (f"y is missing in {said}",)


@pytest.mark.parametrize("kind", ["npz", "mat"])
def test_an_unsigned_counter_does_not_say_its_unit_either(tmp_path, kind):
    k = np.arange(60)
    log = {"time": (100 * k).astype(np.uint32), "u": k % 7, "y": 0.5 * k}
    path = tmp_path / f"log.{'npz' if kind == 'npz' else 'mat'}"
    if kind == "npz":
        np.savez(path, **log)
    else:
        savemat(path, log)
    with pytest.raises(ValueError, match="time counts in whole numbers, 100 apart, and does not say its unit"):
        load_record(path)
    assert load_record(path, time_unit="ms").Ts == 0.1
