"""`Record`, `load_record` and `sampling_time`: what comes in is good, and what is refused is told where."""

import copy
import pickle

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from labsid.records.formats import RawRecord
from labsid.records.record import (
    Record,
    between_outputs,
    bridge_gaps,
    find_faults,
    load_record,
    reading_notes,
    refusal,
    sampling_time,
)

N = 20
T = np.arange(N) * 0.75
U = np.repeat([2.0, 1.6], N // 2)
Y = np.linspace(2.3, 1.9, N) ** 2


def record(**changes):
    return Record(**({"t": T, "u": U, "y": Y, "Ts": 0.75} | changes))


def changed(values, index, value):
    values = np.array(values)
    values[index] = value
    return values


# Record ---------------------------------------------------------------------------------------------------


def test_a_record_holds_read_only_copies():
    u = U.copy()
    made = record(u=u, y_measured=Y + 1, reference=list(Y), name="run 7")
    u[0] = 99
    assert made.u[0] == 2.0
    for name in ("t", "u", "y", "y_measured", "reference"):
        with pytest.raises(ValueError, match="read-only"):
            getattr(made, name)[0] = 0
    with pytest.raises(AttributeError):
        made.Ts = 1.0
    assert len(made) == N
    assert made.y_noise_reduced is None


def test_a_record_takes_columns_rows_and_integers():
    made = record(u=U.reshape(-1, 1), y=np.arange(N).reshape(1, -1))
    assert made.u.shape == made.y.shape == (N,)
    assert made.y.dtype == np.float64


def test_repr_is_one_line_without_arrays():
    assert repr(record(name="run 7")) == "Record('run 7': 20 samples, Ts = 0.75 s, u 1.6..2, y 3.61..5.29)"


def test_records_can_be_copied_and_sent_to_another_process():
    for twin in (copy.deepcopy(record()), pickle.loads(pickle.dumps(record()))):
        np.testing.assert_array_equal(twin.y, Y)
        assert twin.Ts == 0.75


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"y": Y[:-1]}, r"t and u and y must have equal length; got 20 and 20 and 19\. Cut"),
        ({"y_measured": Y[:-1]}, r"must have equal length; got 20 and 20 and 20 and 19"),
        ({"t": T[:1], "u": U[:1], "y": Y[:1]}, r"t must have at least 2 samples; got 1"),
        ({"u": changed(U, 3, np.nan)}, r"u must be finite; got nan at sample 3 \(1 such samples\)"),
        ({"reference": changed(U, [3, 4], np.inf)}, r"reference must be finite; got inf at sample 3"),
        ({"y": changed(Y, 4, -1e200)}, r"y must be below 1e\+100 in size; got -1e\+200 at sample 4"),
        ({"reference": np.column_stack([Y, Y])}, r"reference must be one signal .*; got shape \(20, 2\)"),
        ({"y": np.zeros((N, 2, 2))}, r"y must be one signal .*; got shape \(20, 2, 2\)"),
        ({"u": ["a"] * N}, r"u must hold real numbers"),
        ({"t": changed(T, 5, 2.0)}, r"time goes backwards from sample 4 \(t = 3 s\) to sample 5 \(t = 2 s\)\."),
        ({"t": changed(T, 5, 3.0)}, r"time stands still from sample 4"),
        ({"t": T[::-1]}, r"time goes backwards from sample 0 .* \(19 such places\)"),
        ({"t": np.where(T > 6, T + 0.75, T)}, r"irregular: 0.75 s as a rule, but 1.5 s from sample 8 \(t = 6 s\)"),
        ({"Ts": 0.5}, r"Ts = 0.5 s disagrees with the times, which step by 0.75 s"),
        ({"Ts": -0.75}, r"Ts = -0.75 s disagrees"),
        ({"Ts": np.nan}, r"Ts = nan s disagrees"),
    ],
)
def test_a_bad_record_is_refused(changes, message):
    with pytest.raises(ValueError, match=message):
        record(**changes)


# Several signals ------------------------------------------------------------------------------------------

SEVERAL = {"u": np.column_stack([U, -U]), "y": np.column_stack([Y, 2 * Y, 3 * Y])}
NAMED = {"inputs": ("Q1", "Q2"), "outputs": ("T1", "T2", "T3"), "units": ("%", "%", "K", "K", "K")}


def test_a_record_of_several_signals():
    made = record(**SEVERAL, **NAMED, name="run 7", reference=Y)
    assert made.several
    assert (made.u.shape, made.y.shape, made.missing.shape) == ((N, 2), (N, 3), (N, 3))
    np.testing.assert_array_equal(made.input_columns, SEVERAL["u"])
    np.testing.assert_array_equal(made.output_columns, SEVERAL["y"])
    assert repr(made) == (
        "Record('run 7': 20 samples, Ts = 0.75 s, Q1 1.6..2, Q2 -2..-1.6, T1 3.61..5.29, T2 7.22..10.58, "
        "T3 10.83..15.87)"
    )
    for name in ("u", "y"):
        with pytest.raises(ValueError, match="read-only"):
            getattr(made, name)[0] = 0


def test_names_and_units_by_default():
    made = record(**SEVERAL)
    assert (made.inputs, made.outputs, made.units) == (("u1", "u2"), ("y1", "y2", "y3"), ("",) * 5)
    one = record()
    assert (one.inputs, one.outputs, one.units, one.several) == (("u",), ("y",), ("", ""), False)
    assert one.input_columns.shape == one.output_columns.shape == (N, 1)
    two_in = record(u=SEVERAL["u"])
    assert (two_in.several, two_in.outputs, two_in.y.shape, two_in.missing.shape) == (True, ("y",), (N,), (N,))


@pytest.mark.parametrize(("input", "output"), [("Q2", "T3"), (1, 2)])
def test_a_pair_is_a_record_of_one_signal_each(input, output):
    one = record(**SEVERAL, **NAMED, name="run 7", notes=("said",), jitter=0.1).pair(input, output)
    np.testing.assert_array_equal(one.u, -U)
    np.testing.assert_array_equal(one.y, 3 * Y)
    assert (one.name, one.units, one.notes, one.jitter) == ("run 7: Q2 -> T3", ("%", "K"), ("said",), 0.1)
    assert (one.several, one.inputs, one.outputs, one.labels) == (False, ("Q2",), ("T3",), ("Q2", "T3"))


def test_labels_are_the_names_unless_the_file_has_others():
    assert record().labels == ("u", "y")
    assert record(labels=("goal", "")).labels == ("goal", "y")
    with pytest.raises(ValueError, match="labels must hold one label for each of the 2 signals u, y; got 1: 'goal'"):
        record(labels=("goal",))


@given(st.integers(1, 3), st.integers(1, 3), st.data())
def test_pairs_hold_all_columns(nu, ny, data):
    values = st.floats(-1e6, 1e6)
    columns = [data.draw(st.lists(values, min_size=5, max_size=5)) for _ in range(nu + ny)]
    made = Record(np.arange(5.0), np.transpose(columns[:nu]), np.transpose(columns[nu:]), 1.0)
    for j in range(nu):
        for i in range(ny):
            one = made.pair(j, i)
            np.testing.assert_array_equal(one.u, columns[j])
            np.testing.assert_array_equal(one.y, columns[nu + i])
            assert one.pair(0, 0).inputs == one.inputs


def test_outputs_may_be_missing_at_different_samples():
    y = np.array(SEVERAL["y"])
    y[3:5, 1] = y[0, :] = y[-2:, :] = np.nan
    made = record(**{**SEVERAL, "y": y}, **NAMED)
    assert made.missing.sum(axis=0).tolist() == [3, 5, 3]
    assert repr(made).endswith("3 without T1, 5 without T2, 3 without T3)")
    cut = between_outputs(made)
    assert len(cut) == N - 3
    assert cut.notes == ("all outputs are missing in the first 1 and the last 2 samples; these are left out",)
    assert [note.split(" (")[0] for note in reading_notes(cut)[1:]] == ["T2 is missing in 2 of 17 samples"]
    filled = bridge_gaps(cut.y)
    assert filled.shape == cut.y.shape
    np.testing.assert_allclose(filled[2:4, 1], np.interp([2, 3], [1, 4], cut.y[[1, 4], 1]))


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"u": changed(SEVERAL["u"], (3, 1), np.nan)}, r"Q2 must be finite; got nan at sample 3"),
        ({"y": changed(SEVERAL["y"], (slice(None), 2), np.nan)}, r"T3 must be finite; got nan at sample 0"),
        ({"y": changed(SEVERAL["y"], (4, 0), -1e200)}, r"T1 must be below 1e\+100 in size; got -1e\+200 at sample 4"),
        (
            {"y": SEVERAL["y"][:-1]},
            r"t and Q1 and Q2 and T1 and T2 and T3 must have equal length; got 20 and 20",
        ),
        ({"u": SEVERAL["u"].T}, r"u must have a row for each sample .* shape \(20, 2\); got \(2, 20\)\. Transpose it"),
        ({"y_measured": Y}, r"y_measured belongs to a record of one input and one output; got several"),
        (
            {"units": ("V", "%")},
            r"units must hold one unit for each of the 5 signals Q1, .*; got 2: .*\. Give ''",
        ),
        ({"inputs": ("Q1",)}, r"inputs must hold one name for each of the 2 columns of u; got 1: Q1"),
        ({"inputs": ("Q1", "T1")}, r"'T1' is named as an input and as an output"),
    ],
)
def test_a_bad_record_of_several_signals_is_refused(changes, message):
    with pytest.raises(ValueError, match=message):
        record(**(SEVERAL | NAMED | changes))


# Sampling time --------------------------------------------------------------------------------------------


@pytest.mark.parametrize("Ts", [0.75, 0.1, 0.08, 0.02, 1e-3, 4.0, 1 / 3, np.pi, 2.5e-7])
@pytest.mark.parametrize("samples", [2, 3, 903, 100_000])
def test_sampling_time_is_exact(Ts, samples):
    assert sampling_time(np.arange(samples) * Ts) == Ts


def test_sampling_time_of_summed_and_shifted_times():
    assert sampling_time(np.cumsum(np.full(1000, 0.1))) == pytest.approx(0.1, rel=1e-12)
    assert sampling_time(1.7e9 + np.arange(1000) * 0.1) == 0.1
    assert sampling_time(np.round(np.arange(1000) / 3, 6)) == pytest.approx(1 / 3, rel=1e-8)


def test_sampling_time_forgives_jitter_below_a_hundredth():
    rng = np.random.default_rng(1)
    t = np.arange(500) * 0.75
    assert sampling_time(t + rng.uniform(-0.003, 0.003, t.size)) == pytest.approx(0.75, rel=1e-4)
    with pytest.raises(ValueError, match="sampling is irregular"):
        sampling_time(t + rng.uniform(-0.03, 0.03, t.size))


def test_rounded_times_are_irregular_and_the_remedy_is_named():
    with pytest.raises(ValueError, match=r"irregular: .* or read it without times \(columns u,y and Ts\)"):
        sampling_time(np.round(np.arange(100) * 0.025, 2))


# load_record ----------------------------------------------------------------------------------------------


def test_loading_a_log(write_log, staircase):
    s = staircase
    path = write_log(s["t"][:, None], np.column_stack([s["measured"], s["y"]]), s["u"][:, None])
    loaded = load_record(path)
    assert (loaded.Ts, loaded.name, len(loaded)) == (0.75, "record", 600)
    np.testing.assert_array_equal(loaded.y, s["y"])
    np.testing.assert_array_equal(load_record(path, output="measured").y, s["measured"])
    assert load_record(path, Ts=0.75).Ts == 0.75


def test_loading_text_without_time(write_text):
    loaded = load_record(write_text("1 2\n1 2.5\n3 2.25\n"), columns="u,y", Ts=0.08)
    np.testing.assert_array_equal(loaded.t, [0.0, 0.08, 0.16])
    assert loaded.Ts == 0.08


@pytest.mark.parametrize(
    ("text", "Ts", "message"),
    [
        ("t,u,y\n0,1,2\n", None, r"record.csv: t must have at least 2 samples; got 1\. \(2 more: see `labsid check`\)"),
        ("t,u,y\n0,1,2\n1,,2\n2,1,2\n", None, r"record.csv: u must be finite; got nan at sample 1"),
        ("t,u,y\n0,1,2\n1,1,2\n0.5,1,2\n", None, r"time goes backwards from sample 1"),
        ("t,u,y\n0,1,2\n1,1,2\n2,1,2\n7,1,2\n", None, r"irregular: 1 s as a rule, but 5 s from sample 2"),
        ("t,u,y\n0,1,2\n1,1,2\n2,1,2\n", 0.5, r"Ts = 0.5 s disagrees with the times, which step by 1 s"),
    ],
)
def test_loading_what_is_refused(write_text, text, Ts, message):
    with pytest.raises(ValueError, match=message):
        load_record(write_text(text), Ts=Ts)


def test_columns_without_time_need_a_sampling_time(write_text):
    with pytest.raises(ValueError, match=r"there is no time column\. Give the sampling time with Ts \(--Ts\)"):
        load_record(write_text("1 2\n1 2.5\n"), columns="1,2")


def test_lengths_that_differ_are_all_told(write_log, staircase):
    s = staircase
    path = write_log(s["t"][:, None], np.column_stack([s["measured"], s["y"]])[:-1], s["u"][:, None])
    with pytest.raises(ValueError, match=r"columns must have equal length; t has 600, u has 600, y has 599, y_meas"):
        load_record(path)


def test_a_ts_that_agrees_within_its_digits_is_taken():
    raw = RawRecord(np.arange(100) / 3, np.arange(100.0), np.arange(100.0), Ts=0.3333)
    assert find_faults(raw) == ()
    assert find_faults(RawRecord(raw.t, raw.u, raw.y, Ts=0.33))[0].topic == "sampling"


def test_swapped_signals_are_refused(staircase):
    s = staircase
    good, swapped = RawRecord(s["t"], s["u"], s["y"]), RawRecord(s["t"], s["y"], s["u"])
    assert find_faults(good) == ()
    (fault,) = find_faults(swapped)
    assert fault.topic == "signals"
    assert fault.text.startswith("u and y look swapped: y holds 3 exact levels")
    assert refusal("folder/run.csv", [fault]) == f"run.csv: {fault.text}"


def test_the_real_records_load(shared_data):
    tanks = shared_data / "unsw-water-tank"
    for name, size in (
        ("SysIdenData_StudentVersion", 903),
        ("SysIdenData_4", 2578),
        ("SysIdenData_8", 2216),
        ("SFControlData_0", 701),
    ):
        for output in ("noise-reduced", "measured"):
            loaded = load_record(tanks / f"{name}.mat", output=output)
            assert (len(loaded), loaded.Ts) == (size, 0.75)
    assert loaded.reference is not None
    assert loaded.y is not loaded.y_noise_reduced
    np.testing.assert_array_equal(loaded.y, loaded.y_measured)
    assert load_record(shared_data / "hair-dryer" / "dryer.dat", columns="1,2", Ts=0.08).Ts == 0.08


def test_the_real_records_swapped_are_refused(shared_data):
    for path, options in (
        ("unsw-water-tank/SysIdenData_StudentVersion.mat", {}),
        ("unsw-water-tank/SysIdenData_4.mat", {"output": "measured"}),
        ("unsw-water-tank/SysIdenData_8.mat", {}),
        ("hair-dryer/dryer.dat", {"columns": "1,2", "Ts": 0.08}),
    ):
        loaded = load_record(shared_data / path, **options)
        (fault,) = find_faults(RawRecord(loaded.t, loaded.y, loaded.u))
        assert fault.topic == "signals"


def stamped(t):
    """A record of even levels with these stamps, as text."""
    k = np.arange(t.size)
    return "t,u,y\n" + "".join(f"{a!r},{b},{c}\n" for a, b, c in zip(t.tolist(), k % 7 % 3, np.sin(k), strict=True))


def test_stamps_that_jitter_by_less_than_a_tenth_are_evened_and_it_is_said(write_text):
    t = 0.05 * (np.arange(400) + 0.03 * np.random.default_rng(1).uniform(-3, 3, 400))
    loaded = load_record(write_text(stamped(t)))
    assert loaded.Ts == 0.05
    assert loaded.jitter == pytest.approx(np.std(t / 0.05 - np.arange(400)), rel=0.01)
    np.testing.assert_allclose(np.diff(loaded.t), 0.05, rtol=1e-9)
    assert np.abs(loaded.t - t).max() < 0.1 * 0.05
    (note,) = reading_notes(loaded)
    assert note == "the stamps deviate by 0.051 of the sampling time (rms); samples taken as every 0.05 s"


def test_more_jitter_can_be_read_in_two_ways_and_the_options_are_named(write_text):
    t = 0.05 * (np.arange(400) + 0.1 * np.random.default_rng(1).uniform(-3, 3, 400))
    path = write_text(stamped(t))
    with pytest.raises(ValueError, match=r"irregular: .* with Ts \(--Ts 0.0\d+\), .* resample \(--resample 0.0\d+\)"):
        load_record(path)
    even, uneven = load_record(path, Ts=0.05), load_record(path, resample=0.05)
    assert even.Ts == uneven.Ts == 0.05
    assert even.jitter == pytest.approx(0.17, abs=0.02)
    assert any("resampled to 0.05 s" in note for note in uneven.notes)
    with pytest.raises(ValueError, match=r"Ts = 0.06 s disagrees with the times, which step by 0.05 s"):
        load_record(path, Ts=0.06)


@pytest.mark.parametrize(("rate", "digits"), [(30, 3), (40, 2), (60, 3)])
def test_rounded_stamps_are_even_times_and_no_jitter(write_text, rate, digits):
    loaded = load_record(write_text(stamped(np.round(np.arange(400) / rate, digits))))
    assert loaded.Ts == pytest.approx(1 / rate, rel=1e-9)
    assert loaded.jitter == 0.0
    assert loaded.notes[0].startswith(f"stamps are rounded to {10.0**-digits:g} s")


def test_good_stamps_stay_as_they_are(write_text):
    t = 3.0 + 0.05 * (np.arange(400) + 0.001 * np.random.default_rng(1).standard_normal(400))
    loaded = load_record(write_text(stamped(t)))
    np.testing.assert_array_equal(loaded.t, t)
    assert (loaded.jitter, loaded.notes) == (0.0, ())


def test_a_clock_that_wanders_in_small_steps_is_evened_and_it_is_said(write_text):
    k = np.arange(400)
    path = write_text(stamped(0.05 * (k + 0.2 * np.sin(2 * np.pi * k / 200))))
    loaded = load_record(path)
    assert loaded.jitter == pytest.approx(0.13, abs=0.02)
    assert "the stamps deviate by" in reading_notes(loaded)[0]


@pytest.mark.parametrize(
    ("stamps", "message"),
    [
        (lambda k: 0.05 * (k + 0.35 * (k == 150)), r"irregular: 0.05 s as a rule, but 0.0675 s from sample 149"),
        (lambda k: 0.05 * (k - 1.0 * (k == 150)), r"time stands still from sample 149 .*--repeated first, or last"),
        (lambda k: 0.05 * (k + 90.5 * (k > 150)), r"irregular: 0.05 s as a rule, but 4.575 s from sample 150"),
        (lambda k: 0.05 * np.where(k < 200, k, k - 200), r"time goes backwards from sample 199 .*--select 1"),
    ],
)
def test_what_is_worse_than_jitter_is_refused(write_text, stamps, message):
    with pytest.raises(ValueError, match=message):
        load_record(write_text(stamped(stamps(np.arange(400)))))


def test_a_broken_time_column_is_refused(write_text):
    for text, message in (
        ("t,u,y\n0,1,2\nnan,1,2\n2,1,2\n", "t must be finite; got nan at sample 1"),
        ("t,u,y\n0,1,2\n1e200,1,2\n2e200,1,2\n", "t must be below"),
        ("t,u,y\n0,1,2\n", "t must have at least 2 samples"),
    ):
        with pytest.raises(ValueError, match=message):
            load_record(write_text(text))
