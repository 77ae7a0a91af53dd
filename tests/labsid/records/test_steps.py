"""From the columns of a log to even samples: dropped rows, repeated and displaced ones, cutting, resampling."""

import numpy as np
import pytest
from scipy.signal import lfilter

from labsid.records.choice import Chosen
from labsid.records.column import Column
from labsid.records.even_times import fit_coarse_stamps, fit_dropped_rows
from labsid.records.reading import Reading
from labsid.records.record import load_record, reading_notes
from labsid.records.resampling import band_limited_at, decimate, held_at, is_held
from labsid.records.steps import signals_of

N = 400
K = np.arange(N)
T = 0.1 * K
U = np.array([0.0, 2.0, 1.0, 3.0])[K // 37 % 4]
Y = lfilter([0.0, 0.1], [1.0, -0.9], U)


@pytest.fixture
def write(write_text):
    def rows(t, u=U, y=Y):
        lines = (f"{a!r},{b!r},{c!r}\n" for a, b, c in zip(t.tolist(), u.tolist(), y.tolist(), strict=True))
        return write_text("t,u,y\n" + "".join(lines))

    return rows


def test_dropped_rows_are_missing_samples_and_the_held_input_goes_on(write):
    there = np.setdiff1d(K, [5, 100, 101, 102, 250])
    record = load_record(write(T[there], U[there], Y[there]))
    assert (len(record), record.Ts) == (N, 0.1)
    assert np.flatnonzero(record.missing).tolist() == [5, 100, 101, 102, 250]
    np.testing.assert_array_equal(record.u, U)
    np.testing.assert_array_equal(record.y[there], Y[there])
    assert record.notes[0] == ("5 rows of 400 missing by the stamps, at most 3 in a row, at samples 5, 100 to 102, 250")


def test_dropped_rows_of_a_moving_input_are_refused(write):
    there = np.setdiff1d(K, [5])
    with pytest.raises(ValueError, match="u must be finite; got nan at sample 5"):
        load_record(write(T[there], np.sin(K / 5)[there], Y[there]))


@pytest.mark.parametrize("jitter", [0.0, 0.02])
def test_many_dropped_rows_are_found_and_too_many_are_not_even_sampling(jitter):
    rng = np.random.default_rng(3)
    there = np.sort(rng.choice(N, int(0.9 * N), replace=False))
    found = fit_dropped_rows(T[there] + 0.1 * jitter * rng.uniform(-1, 1, there.size))
    assert found is not None
    np.testing.assert_array_equal(found.places, there - there[0])
    assert fit_dropped_rows(T[np.sort(rng.choice(N, N // 2, replace=False))]) is None


@pytest.mark.parametrize("batch", [2, 5, 10])
def test_stamps_of_a_buffer_are_spread(write, batch):
    record = load_record(write(np.round(T[K // batch * batch], 10)))
    assert record.Ts == pytest.approx(0.1, rel=1e-9)
    np.testing.assert_array_equal(record.y, Y)
    assert record.notes[0].startswith(f"stamps that {batch} samples share")


def test_stamps_of_a_clock_that_counts_seconds_are_spread_and_uneven_batches_are_not():
    assert fit_coarse_stamps(np.floor(np.arange(1000) / 7.3)).Ts == pytest.approx(1 / 7.3, rel=1e-3)
    uneven = np.repeat(np.arange(20.0), np.random.default_rng(0).integers(1, 12, 20))
    assert fit_coarse_stamps(uneven) is None
    assert fit_coarse_stamps(T) is None


def test_equal_rows_are_one_and_of_different_ones_the_caller_chooses(write):
    rows = np.insert(K, 50, 50)
    record = load_record(write(T[rows], U[rows], Y[rows]))
    np.testing.assert_array_equal(record.y, Y)
    assert record.notes == ("1 repeated row left out",)
    y = Y[rows].copy()
    y[51] += 1.0
    path = write(T[rows], U[rows], y)
    with pytest.raises(ValueError, match=r"time stands still from sample 50 .*\(--repeated first, or last\)"):
        load_record(path)
    assert load_record(path, repeated="first").y[50] == Y[50]
    last = load_record(path, repeated="last")
    assert last.y[50] == Y[50] + 1.0
    assert last.notes == ("of rows with the same time the last is kept (1 left out)",)


def test_a_few_displaced_rows_are_sorted_and_it_is_said(write):
    order = K.copy()
    order[[10, 11]], order[[200, 202]] = order[[11, 10]], order[[202, 200]]
    record = load_record(write(T[order], U[order], Y[order]))
    np.testing.assert_array_equal(record.y, Y)
    assert record.notes == ("4 rows out of order, sorted by time",)
    with pytest.raises(ValueError, match="time goes backwards"):
        load_record(write(T[::-1].copy()))


def test_a_stretch_is_cut_out(write):
    record = load_record(write(T), since=10.0, until=19.95)
    np.testing.assert_array_equal(record.y, Y[100:200])
    assert record.notes == ("cut to 100 of 400 samples, from 10 to 19.9 s",)
    without_times = load_record(write(T), columns="u,y", Ts=0.1, since=10.0)
    np.testing.assert_array_equal(without_times.y, Y[100:])
    with pytest.raises(ValueError, match=r"from 50 to inf s \(--from, --to\) there are 0 samples; the log runs from 0"):
        load_record(write(T), since=50.0)


def test_uneven_samples_are_resampled_band_limited_and_the_held_input_is_held(write):
    rng = np.random.default_rng(1)
    t = np.cumsum(rng.uniform(0.02, 0.09, 3000))
    u, y = np.floor(t / 4.3) % 3, np.sin(2 * np.pi * 0.3 * t)
    path = write(t, u, y)
    with pytest.raises(ValueError, match=r"sampling is irregular: .*\(--resample 0.0"):
        load_record(path)
    record = load_record(path, resample=0.1)
    np.testing.assert_allclose(np.diff(record.t), 0.1)
    inside = slice(20, -20)
    np.testing.assert_allclose(record.y[inside], np.sin(2 * np.pi * 0.3 * record.t)[inside], atol=2e-3)
    assert set(record.u) <= {0.0, 1.0, 2.0}
    assert "resampled to 0.1 s" in record.notes[0]
    assert any("a change acts up to one sample late" in note for note in record.notes)


def test_resampling_removes_what_is_too_fast_instead_of_folding_it():
    stamps = 0.01 * np.arange(5000)
    t = 0.1 * np.arange(50, 450)
    slow = np.sin(2 * np.pi * 1.0 * stamps)
    fast = np.sin(2 * np.pi * 9.3 * stamps)  # would appear at 0.7 Hz
    resampled = band_limited_at(t, stamps, slow + fast)
    np.testing.assert_allclose(resampled, np.sin(2 * np.pi * t), atol=0.01)


def test_what_was_missing_stays_missing_when_it_is_resampled():
    stamps = np.delete(0.1 * np.arange(300), slice(100, 110))
    y = band_limited_at(0.1 * np.arange(300), stamps, np.sin(stamps))
    assert np.flatnonzero(np.isnan(y)).tolist() == list(range(100, 110))
    assert held_at(np.array([0.5, 2.5]), np.array([1.0, 2.0]), np.array([5.0, 6.0])).tolist()[1] == 6.0


def test_every_nth_sample_is_kept_after_a_low_pass_filter(write):
    record = load_record(write(T), decimate=4)
    assert (len(record), record.Ts) == (100, pytest.approx(0.4))
    assert "every 4th sample kept" in record.notes[0]
    k = np.arange(4000)
    kept = decimate(np.sin(2 * np.pi * k / 100) + np.sin(2 * np.pi * 0.26 * k), 4)
    np.testing.assert_allclose(kept[20:-20], np.sin(2 * np.pi * k / 100)[::4][20:-20], atol=0.01)
    holey = np.sin(k / 50.0)
    holey[1001] = np.nan
    assert np.flatnonzero(np.isnan(decimate(holey, 4))).tolist() == [250]


def test_what_is_held():
    assert is_held(U)
    assert not is_held(np.sin(K / 5))


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"Ts": 0.1, "resample": 0.1}, "Ts says that the samples are even, resample that they are not"),
        ({"since": 5.0, "until": 5.0}, r"since \(--from\) must be before until \(--to\)"),
        ({"select": 0}, "select must be a whole number of at least 1; got 0"),
        ({"decimate": 1}, "decimate must be a whole number of at least 2; got 1"),
        ({"resample": -1.0}, "resample must be a positive number of seconds"),
        ({"time_unit": "weeks"}, "time_unit must be s or ms or us or ns or min or h or days; got 'weeks'"),
        ({"repeated": "all"}, "repeated must be first or last; got 'all'"),
    ],
)
def test_options_are_checked(options, message):
    with pytest.raises(ValueError, match=message):
        Reading(**options)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"resample": 1e-12}, r"resample 1e-12 s makes 3.99e\+13 samples"),
        ({"resample": 100.0}, r"resample 100 s makes 1.4 samples"),
        ({"decimate": 200}, "decimate 200 leaves under 4 samples of 400"),
        ({"columns": "u,y", "resample": 0.1}, "resample needs times; the log has none"),
    ],
)
def test_what_cannot_be_done_is_refused(write, options, message):
    with pytest.raises(ValueError, match=message):
        load_record(write(T), **options)


def test_a_log_that_needs_nothing_says_nothing(write):
    assert reading_notes(load_record(write(T))) == ()


# Several signals ------------------------------------------------------------------------------------------


@pytest.fixture
def write_several(write_text):
    def rows(t, u, y):
        lines = (",".join(map(repr, row)).replace("nan", "") for row in np.column_stack([t, u, y]).tolist())
        return write_text("t,fan,valve,level,flow\n" + "\n".join(lines) + "\n")

    return lambda t=T, u=(U, V), y=(Y, -2 * Y): rows(t, np.transpose(u), np.transpose(y))


V = np.roll(U, 9)
NAMES = {"inputs": "fan,valve", "outputs": "level,flow"}


def test_each_of_several_signals_is_treated_as_one(write_several):
    """Dropped rows, cutting and a low-pass filter: as for the record of any pair alone."""
    there = np.setdiff1d(K, [5, 100, 101, 250])
    path = write_several(T[there], (U[there], V[there]), (Y[there], -2 * Y[there]))
    for options in (
        {},
        {"since": 2.0, "until": 30.0},
        {"resample": 0.2},
        {"since": 11.0, "until": 24.0, "decimate": 3},
    ):
        several = load_record(path, **NAMES, **options)
        assert several.y.shape == (len(several), 2)
        for u, y in (("fan", "level"), ("valve", "flow")):
            one = load_record(path, columns=f"t,{u},{y}", **options)
            np.testing.assert_array_equal(several.pair(u, y).u, one.u)
            np.testing.assert_array_equal(several.pair(u, y).y, one.y)
            assert several.Ts == one.Ts


def test_notes_name_the_signal(write_several):
    y = np.array([Y, -2 * Y])
    y[1, 7:9] = np.nan
    u = np.array([U, V])
    u[1, 60] = np.nan
    record = load_record(write_several(u=u, y=y), **NAMES)
    assert reading_notes(record) == (
        "valve held at its last value in 1 samples without one",
        "flow is missing in 2 of 400 samples (7 to 8); these are neither fitted nor scored",
    )
    u[1] += np.sin(K)
    with pytest.raises(ValueError, match=r"valve must be finite; got nan at sample 60"):
        load_record(write_several(u=u, y=y), **NAMES)


def signals_with_clocks(times, how=None):
    """Signals with stamps of their own: two inputs and two outputs, sinusoids or levels of their times."""
    columns = [
        Column(name, np.floor(t) if name in ("fan", "valve") else np.sin(t), stamps=t)
        for name, t in zip(("fan", "valve", "level", "flow"), times, strict=True)
    ]
    return signals_of(Chosen(None, tuple(columns[:2]), tuple(columns[2:]), named=True), how or Reading())


def test_inputs_with_clocks_of_their_own_are_held_at_the_outputs():
    t_y = 0.1 * np.arange(100)
    found = signals_with_clocks((0.25 * np.arange(40), 0.4 * np.arange(26), t_y, t_y))
    np.testing.assert_allclose(found.values["y2"], np.sin(found.t))
    assert [note.split(" has")[0] for note in found.notes] == ["fan", "valve"]
    assert found.t.size == 100
    (note,) = signals_with_clocks((t_y, 0.4 * np.arange(26), t_y, t_y)).notes
    assert note == "valve has times of its own, 0.4 s apart; held at those of level"


def test_slower_outputs_are_missing_between_their_samples():
    t_u, t_y = 0.1 * np.arange(100), 0.5 * np.arange(20)
    found = signals_with_clocks((t_u, t_u, t_y, t_y))
    assert np.isnan(found.values["y1"]).sum() == np.isnan(found.values["y2"]).sum() == 80
    np.testing.assert_allclose(found.values["y2"][::5], np.sin(t_y))


def test_outputs_with_different_clocks_are_resampled_or_refused():
    t_u = 0.1 * np.arange(100)
    times = (t_u, t_u, t_u, 0.25 * np.arange(40))
    with pytest.raises(ValueError, match=r"flow and level have different times\. .* \(--resample 0\.1\)"):
        signals_with_clocks(times)
    found = signals_with_clocks(times, Reading(resample=0.5))
    np.testing.assert_allclose(found.values["y2"][3:-3], np.sin(found.t)[3:-3], atol=0.03)


@pytest.mark.parametrize("code", [-999.0, 9999.0, 32767.0])
def test_a_number_for_missing_samples_is_read_as_missing(write, code):
    gone = K % 7 == 3
    record = load_record(write(T, y=np.where(gone, code, Y)))
    np.testing.assert_array_equal(record.missing, gone)
    np.testing.assert_array_equal(record.y[~gone], Y[~gone])
    assert f"y holds {code:.0f} in {gone.sum()} samples, far from all others: read as missing" in record.notes


def test_a_value_within_reach_of_the_others_is_one_of_them(write):
    spread = 400.0 * Y  # up to 1,200
    spread[7] = 999.0
    assert not load_record(write(T, y=spread)).missing.any()
    near = np.where(K == 9, -99.0, 30.0 * Y)
    assert not load_record(write(T, y=near)).missing.any()


def test_an_input_may_have_any_value(write):
    u = np.where(U > 2.5, 9999.0, U)
    np.testing.assert_array_equal(load_record(write(T, u=u)).u, u)


def test_a_logger_that_paused_a_few_times_lost_up_to_a_third_of_its_rows():
    t = np.arange(1100.0)
    pause = np.r_[t[:600], t[800:]]
    often = t[(np.arange(1100) % 50) >= 11]
    found = fit_dropped_rows(pause)
    assert found is not None
    assert found.t.size == 1100
    assert fit_dropped_rows(often) is None  # 22 % in 22 places
    assert fit_dropped_rows(np.r_[t[:600], t[1000:]]) is None
