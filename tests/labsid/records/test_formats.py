"""`read_raw`: columns as found, whatever the layout; and an error that helps where there are none."""

import warnings

import numpy as np
import pytest
from scipy.io import savemat

from labsid.records.formats import RawRecord, read_raw
from labsid.records.reading import Reading

ROWS = "0,1,2\n0.5,1,2.5\n1,3,2.25\n"
T, U, Y = np.array([0.0, 0.5, 1.0]), np.array([1.0, 1.0, 3.0]), np.array([2.0, 2.5, 2.25])


def assert_columns(raw, t=T, u=U, y=Y):
    if t is None:
        assert raw.t is None
    else:
        np.testing.assert_array_equal(raw.t, t)
    np.testing.assert_array_equal(raw.u, u)
    np.testing.assert_array_equal(raw.y, y)


# Text -----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "text",
    [
        "t,u,y\n" + ROWS,
        "T, U, Y\n" + ROWS,
        "time,u,y\n" + ROWS,
        '"t","u","y"\n' + ROWS,
        "t,u,y,\n" + ROWS.replace("\n", ",\n"),
        "# made by a logger\n% at noon\n\nt,u,y\n" + ROWS + "\n\n",
        "# t,u,y\n" + ROWS,
        ROWS,
        ROWS.rstrip("\n"),
        "t,u,y\r\n" + ROWS.replace("\n", "\r\n"),
        "t,u,y\r" + ROWS.replace("\n", "\r"),
        ("t,u,y\n" + ROWS).replace(",", ";"),
        ("t,u,y\n" + ROWS).replace(",", "\t"),
        ("t,u,y\n" + ROWS).replace(",", " \t "),
        ("t,u,y\n" + ROWS).replace(",", "   "),
        "t;u;y\n0;1;2\n0,5;1;2,5\n1;3;2,25\n",
        "y,t,x,u\n2,0,9,1\n2.5,0.5,9,1\n2.25,1,9,3\n",
        't,u,y\n"0","1","2"\n"0.5","1","2.5"\n"1","3","2.25"\n',
        "t,u,y\n0e0,1E0,2.0\n+5e-1,1,2.5\n1.,3,225e-2\n",
    ],
)
def test_text_layouts(write_text, text):
    assert_columns(read_raw(write_text(text)))


def test_decimal_commas_with_a_leading_comma_value(write_text):
    raw = read_raw(write_text("t;u;y\n0,0;1,0;2,0\n0,5;1,0;2,5\n1,0;3,0;2,25\n"))
    assert_columns(raw)
    assert raw.notes == ("decimal commas read as decimal points",)


@pytest.mark.parametrize("encoding", ["utf-8-sig", "utf-16", "latin-1"])
def test_encodings(write_text, encoding):
    raw = read_raw(write_text("# Füllstand\nt,u,y\n" + ROWS, encoding=encoding))
    assert_columns(raw)


def test_two_columns_need_a_sampling_time(write_text):
    path = write_text("u,y\n1,2\n1,2.5\n3,2.25\n")
    assert_columns(read_raw(path, Reading(Ts=0.5)), t=None)
    assert read_raw(path, Reading(Ts=0.5)).Ts == 0.5
    with pytest.raises(ValueError, match=r"record.csv: no columns t,u,y; the columns are u, y\. Choose columns"):
        read_raw(path)


def test_without_header_by_number_and_by_order(write_text):
    path = write_text("1 2\n1 2.5\n3 2.25\n", "dryer.dat")
    for columns in ("u,y", "1,2", None):
        assert_columns(read_raw(path, Reading(columns=columns, Ts=0.5)), t=None)
    assert_columns(read_raw(path, Reading(columns="2,1", Ts=0.5)), t=None, u=Y, y=U)
    assert read_raw(path, Reading(Ts=0.5)).notes == ("no header: columns taken as u,y",)
    with pytest.raises(ValueError, match=r"there is no column 'y'; the columns are 1 to 2 .*Give numbers"):
        read_raw(path, Reading(columns="y,u", Ts=0.5))
    with pytest.raises(ValueError, match=r"no columns t,u,y; the columns are 1 to 2 \(there is no header\)"):
        read_raw(path)


def test_columns_by_name_and_number(write_text):
    path = write_text("clock,pump,level,Ts\n0,1,2,4\n0.5,1,2.5,\n1,3,2.25,\n")
    assert_columns(read_raw(path, Reading(columns="clock,pump,level")))
    assert_columns(read_raw(path, Reading(columns="1,pump,3")))
    assert_columns(read_raw(path, Reading(columns="pump, level", Ts=4)), t=None)
    for wrong in ("a,b", "pump,5", "pump,0", "pump,-1"):
        with pytest.raises(ValueError, match="the columns are clock, pump, level, Ts"):
            read_raw(path, Reading(columns=wrong, Ts=4))


@pytest.mark.parametrize("columns", ["u", "t,u,y,z", "u,,y", "", ","])
def test_columns_must_be_two_or_three(write_text, columns):
    with pytest.raises(ValueError, match="columns must name three columns, t,u,y, or two, u,y"):
        read_raw(write_text("t,u,y\n" + ROWS), Reading(columns=columns))


def test_columns_must_differ(write_text):
    with pytest.raises(ValueError, match="columns must name different columns"):
        read_raw(write_text("t,u,y\n" + ROWS), Reading(columns="u,u"))


def test_empty_fields_are_nan_where_they_matter(write_text):
    raw = read_raw(write_text("t,u,y,note\n0,1,2,\n0.5,,2.5,\n1,3,nan,4\n"))
    assert_columns(raw, u=[1, np.nan, 3], y=[2, 2.5, np.nan])


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("t,u,y\n", r"there is a header \(t, u, y\) and no data under it"),
        ("# nothing\n% at all\n", "there are no data in it, only comments"),
        ("t,u,y\n0,1,2\n0.5,bad,2\n", r"line 3, column 2: 'bad' is not a number"),
        ("# c\n\nt,u,y\n0,1,2\n# c\n0.5,1\n", r"line 6 has 2 fields, but column 3 is needed: '0.5,1'"),
        ("s,u,y\n" + ROWS, r"no columns t,u,y; the columns are s, u, y"),
        ("1,2,3,4\n1,2,3,4\n", r"no columns t,u,y; the columns are 1 to 4"),
        ("t;u;y\n0;1,5;2\n0.5;1;2\n", r"line 2, column 2: '1,5' is not a number"),
    ],
)
def test_text_without_columns(write_text, text, message):
    with pytest.raises(ValueError, match=message) as caught:
        read_raw(write_text(text))
    assert str(caught.value).startswith("record.csv: ")


def test_a_binary_file_is_not_text(tmp_path):
    path = tmp_path / "picture.png"
    path.write_bytes(b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR")
    with pytest.raises(ValueError, match=r"picture.png: it is neither a MAT-file nor text"):
        read_raw(path)


def test_long_text_takes_the_fast_path_and_the_same_values(write_text):
    """The path for clean files and the one for files with empty fields must agree to the last bit."""
    rng = np.random.default_rng(0)
    table = np.column_stack([np.arange(2000) * 0.1, rng.standard_normal((2000, 2))])
    text = "".join(f"{a!r},{b!r},{c!r}\n" for a, b, c in table.tolist())
    fast = read_raw(write_text("t,u,y\n" + text))
    slow = read_raw(write_text("t,u,y\n" + text + ",,\n", "slow.csv"))
    assert_columns(fast, *table.T)
    np.testing.assert_array_equal(slow.y[:-1], table[:, 2])
    assert np.isnan(slow.y[-1])


def test_text_has_one_output(write_text):
    with pytest.raises(ValueError, match="a text file has one y"):
        read_raw(write_text("t,u,y\n" + ROWS), Reading(output="measured"))


# MATLAB ---------------------------------------------------------------------------------------------------

MEASURED, REDUCED = np.array([2.5, 2.0, 2.5]), Y
OUTPUTS = np.column_stack([MEASURED, REDUCED])


@pytest.mark.parametrize(
    ("time", "outputs", "u"),
    [
        (T[:, None], OUTPUTS, U[:, None]),
        (T, OUTPUTS, U),
        (T[None], OUTPUTS.T, U[None]),
        (T[:, None], OUTPUTS.astype(np.float32), U.astype(np.int16)[:, None]),
        (T[:, None], OUTPUTS[None].transpose(2, 0, 1), U.reshape(1, 1, 3)),
    ],
    ids=["as logged", "vectors", "rows", "other types", "three dimensions"],
)
@pytest.mark.parametrize("compress", [False, True])
def test_log_layouts(write_log, time, outputs, u, compress):
    if outputs.ndim == 3:  # a scope's 1x1xN and 2x1xN
        time = T[:, None]
    raw = read_raw(write_log(time, outputs, u, do_compression=compress))
    assert_columns(raw)
    np.testing.assert_array_equal(raw.y_measured, MEASURED)
    np.testing.assert_array_equal(raw.y_noise_reduced, REDUCED)
    assert raw.reference is None
    assert raw.name == "record"


def test_output_measured(write_log):
    assert_columns(read_raw(write_log(T, OUTPUTS, U), Reading(output="measured")), y=MEASURED)


def test_signals_in_a_cell(tmp_path):
    cell = np.empty((1, 2), dtype=object)
    cell[0, 0], cell[0, 1] = {"values": OUTPUTS}, {"values": U[:, None]}
    savemat(tmp_path / "cell.mat", {"LogData": {"time": T[:, None], "signals": cell}})
    assert_columns(read_raw(tmp_path / "cell.mat"))


def test_closed_loop_log_has_its_reference_first(write_log):
    reference = np.array([7.0, 8.0, 9.0])
    raw = read_raw(write_log(T, np.column_stack([reference, OUTPUTS]), U, name="SFLogData"))
    assert_columns(raw)
    np.testing.assert_array_equal(raw.reference, reference)
    np.testing.assert_array_equal(raw.y_measured, MEASURED)


def test_a_mat_file_is_known_by_its_first_bytes_too(write_log):
    path = write_log(T, OUTPUTS, U)
    assert_columns(read_raw(path.rename(path.with_suffix(".log"))))


def test_one_output_column_is_the_measured_one(write_log):
    path = write_log(T[:, None], MEASURED[:, None], U[:, None])
    assert_columns(read_raw(path, Reading(output="measured")), y=MEASURED)
    with pytest.raises(ValueError, match=r"has one column, the measured output.*--LogData measured"):
        read_raw(path)


def test_a_single_sample_keeps_its_columns(write_log):
    raw = read_raw(write_log(np.zeros((1, 1)), np.array([[2.0, 3.0]]), np.ones((1, 1))))
    assert_columns(raw, t=[0], u=[1], y=[3])


def test_lengths_are_not_judged(write_log):
    raw = read_raw(write_log(T[:, None], OUTPUTS[:2], U[:, None]))
    assert (raw.t.size, raw.u.size, raw.y.size) == (3, 3, 2)


def test_empty_time(write_log):
    raw = read_raw(write_log(np.empty((0, 0)), OUTPUTS, U[:, None]), Reading(Ts=0.5))
    assert_columns(raw, t=None)
    assert raw.notes == ("LogData.time is empty",)


def test_variables_by_name(tmp_path):
    savemat(tmp_path / "v.mat", {"time": T, "pump": U[:, None], "level": Y, "both": OUTPUTS})
    assert_columns(read_raw(tmp_path / "v.mat", Reading(columns="time,pump,level")))
    assert_columns(read_raw(tmp_path / "v.mat", Reading(columns="pump,level", Ts=1)), t=None)
    with pytest.raises(ValueError, match=r"there is no variable 'u' in it; it holds time, pump, level, both.1, both.2"):
        read_raw(tmp_path / "v.mat", Reading(columns="u,level"))
    with pytest.raises(ValueError, match=r"variable both has 2 columns. Name one of them: both.1, both.2"):
        read_raw(tmp_path / "v.mat", Reading(columns="pump,both"))


def test_no_log_names_what_there_is(tmp_path):
    savemat(tmp_path / "other.mat", {"ans": 1.0, "x": T})
    with pytest.raises(ValueError, match=r"other.mat: no columns t,u,y; it holds x\."):
        read_raw(tmp_path / "other.mat")


def test_swapped_signals_are_seen_by_their_columns(write_log):
    path = write_log(T[:, None], U[:, None], OUTPUTS)
    for output in ("noise-reduced", "measured"):
        with pytest.raises(ValueError, match="input and output are swapped"):
            read_raw(path, Reading(output=output))


@pytest.mark.parametrize(
    ("log", "message"),
    [
        ({"time": T}, r"no LogData.signals\).*Structure With Time"),
        ({"signals": T}, r"no LogData.time\)"),
        (T, r"LogData is not a structure"),
        ({"time": T, "signals": {"values": OUTPUTS}}, r"LogData.signals must have two elements.*; got 1"),
        ({"time": "noon", "signals": {"values": OUTPUTS}}, r"LogData.time must hold real numbers"),
        ({"time": T + 1j, "signals": {"values": OUTPUTS}}, r"LogData.time must hold real numbers; got complex"),
    ],
)
def test_other_structures(tmp_path, log, message):
    savemat(tmp_path / "log.mat", {"LogData": log})
    with pytest.raises(ValueError, match=message):
        read_raw(tmp_path / "log.mat")


@pytest.mark.parametrize(
    ("outputs", "u", "message"),
    [
        (np.ones((3, 4)), U[:, None], r"must have 2 columns .*; got 4 and 1"),
        (OUTPUTS, OUTPUTS, r"must have 2 columns .*; got 2 and 2"),
        (np.ones((3, 2, 2)), U[:, None], r"signals\(1\).values must be a matrix .*; got shape \(3, 2, 2\)"),
    ],
)
def test_other_shapes(write_log, outputs, u, message):
    with pytest.raises(ValueError, match=message):
        read_raw(write_log(T[:, None], outputs, u))


@pytest.mark.parametrize("header", [b"MATLAB 7.3 MAT-file, Platform: PCWIN64".ljust(512), b""])
def test_a_damaged_hdf5_file_is_refused_in_one_line(tmp_path, header):
    path = tmp_path / "new.mat"
    path.write_bytes(header + b"\x89HDF\r\n\x1a\n" + bytes(64))
    with pytest.raises(ValueError, match=r"it cannot be read as MATLAB 7.3 or HDF5 .*: it is cut off or damaged"):
        read_raw(path)


@pytest.mark.parametrize("compress", [False, True])
def test_a_file_cut_off_anywhere_is_refused_or_whole(write_log, tmp_path, compress):
    """Only the filling after the last value, eight bytes at most, can be missed."""
    content = write_log(T[:, None], OUTPUTS, U[:, None], do_compression=compress).read_bytes()
    cut = tmp_path / "cut.mat"
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        for size in range(1, len(content)):
            cut.write_bytes(content[:size])
            try:
                raw = read_raw(cut)
            except ValueError as error:
                assert str(error).startswith("cut.mat")  # noqa: PT017
            else:
                assert size > len(content) - 8
                assert_columns(raw)


def test_text_called_mat(tmp_path):
    (tmp_path / "text.mat").write_text("t,u,y\n" + ROWS)
    with pytest.raises(ValueError, match="it is no MAT-file of version 5 or 7, or it is cut off or damaged"):
        read_raw(tmp_path / "text.mat")


# Any file -------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["empty.csv", "empty.mat", "blank.csv"])
def test_empty_files(tmp_path, name):
    (tmp_path / name).write_text("\n \n" if name.startswith("blank") else "")
    with pytest.raises(ValueError, match=f"{name}: it is empty: a record needs at least two samples"):
        read_raw(tmp_path / name)


def test_no_such_file_and_a_folder(tmp_path):
    with pytest.raises(FileNotFoundError):
        read_raw(tmp_path / "nowhere.csv")
    with pytest.raises(OSError, match=r"folder|directory|denied"):
        read_raw(tmp_path)


def test_options_are_checked(write_text):
    path = write_text("t,u,y\n" + ROWS)
    with pytest.raises(ValueError, match="output must be noise-reduced or measured; got 'noisy'"):
        read_raw(path, Reading(output="noisy"))
    for Ts in (0.0, -1.0, np.nan, np.inf):
        with pytest.raises(ValueError, match="Ts must be a positive number of seconds"):
            read_raw(path, Reading(Ts=Ts))


def test_raw_record_names_each_column_once():
    raw = RawRecord(None, U, Y, y_measured=MEASURED, y_noise_reduced=Y)
    assert list(raw.columns) == ["u", "y", "y_measured"]
    with pytest.raises(ValueError, match="read-only"):
        raw.u[0] = 1


def test_the_real_records_are_read(shared_data):
    tanks = shared_data / "unsw-water-tank"
    for name, size in (("SysIdenData_StudentVersion", 903), ("SysIdenData_4", 2578), ("SysIdenData_8", 2216)):
        raw = read_raw(tanks / f"{name}.mat")
        assert raw.t.size == raw.u.size == raw.y.size == size
        np.testing.assert_array_equal(raw.y, raw.y_noise_reduced)
    assert read_raw(tanks / "SFControlData_0.mat").reference.size == 701
    dryer = read_raw(shared_data / "hair-dryer" / "dryer.dat", Reading(columns="u,y", Ts=0.08))
    assert (dryer.u.size, dryer.u[0], dryer.y[0]) == (1000, 6.41, 4.7660989)
    tanks = read_raw(shared_data / "cascaded-tanks" / "dataBenchmark.csv", Reading(columns="uEst,yEst", Ts=4))
    assert (tanks.u.size, tanks.u[0], tanks.y[0]) == (1024, 3.2567, 5.205)
