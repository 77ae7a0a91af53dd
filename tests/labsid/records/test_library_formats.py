"""Formats that libraries read, written here by the formats' own writers, and damaged files of each."""

import base64
import importlib.util
import json
import subprocess
import sys
import warnings
import zlib
from pathlib import Path

import log_samples
import numpy as np
import pytest

from labsid.records import apart
from labsid.records.contents import suggested_options
from labsid.records.formats import describe_columns
from labsid.records.library_formats import FORMATS, MAT4, library_format, open_library_log
from labsid.records.record import load_record

N = 80
T = np.arange(N) * 0.1
U = np.repeat([0.0, 1.0, 2.5, 1.0], N // 4)
Y = np.sin(np.arange(N) / 9)
NS = 1_764_000_000_000_000_000 + np.round(T * 1e9).astype(np.int64)
SIGNALS = list(zip(T.tolist(), U.tolist(), Y.tolist(), strict=True))
JOINT = "/cmd.data[0],/joint_states.position[elbow]"


def needs(package):
    return pytest.mark.skipif(
        importlib.util.find_spec(package) is None, reason=f"{package} is not installed (labsid[logs])"
    )


def assert_read(record, rows=slice(None), t=True):
    np.testing.assert_allclose(record.u, U[rows], atol=1e-6)
    np.testing.assert_allclose(record.y, Y[rows], atol=1e-6)
    assert record.Ts == pytest.approx(0.1, rel=1e-9)
    assert not record.missing.any()


# Tables -------------------------------------------------------------------------------------------------------


@needs("python_calamine")
def test_excel(tmp_path):
    import openpyxl

    book = openpyxl.Workbook()
    book.active.title = "notes"
    book.active.append(["measured in March"])
    sheet = book.create_sheet("log")
    for row in (["rig 7"], ["t", "u", "y", "by"], ["s", "V", "cm", None]):
        sheet.append(row)
    for t, u, y in zip(T.tolist(), U.tolist(), Y.tolist(), strict=True):
        sheet.append([t, u, None if t == 0.5 else y, "Ann"])
    book.save(tmp_path / "a.xlsx")
    record = load_record(tmp_path / "a.xlsx")
    np.testing.assert_array_equal(record.u, U)
    assert np.flatnonzero(record.missing).tolist() == [5]
    assert record.units == ("V", "cm")
    assert record.notes == ("sheet log read", "the row under the header read as units: s, V, cm")


@needs("python_calamine")
def test_words_beside_numbers_above_the_table_of_a_workbook(tmp_path):
    import openpyxl

    book = openpyxl.Workbook()
    for row in (["rig", 7], ["Kp", 2.0, "Ki", 0.1], [], ["t", "u", "y"], [0.0, 0.5], [0.1, 0.5]):
        book.active.append(row)
    for t, u, y in zip((T + 0.2).tolist(), U.tolist(), Y.tolist(), strict=True):
        book.active.append([t, u, y])
    book.save(tmp_path / "a.xlsx")
    record = load_record(tmp_path / "a.xlsx")
    assert record.u.tolist() == [0.5, 0.5, *U]
    assert np.flatnonzero(record.missing).tolist() == [0, 1]


@needs("python_calamine")
def test_times_of_a_workbook_that_pass_midnight(tmp_path):
    import openpyxl

    book = openpyxl.Workbook()
    book.active.append(["t", "u", "y"])
    for t, u, y in zip(T.tolist(), U.tolist(), Y.tolist(), strict=True):
        book.active.append([(86398 + t) / 86400, u, y])
    for row in book.active.iter_rows(min_row=2, max_col=1):
        row[0].number_format = "hh:mm:ss.000"
    book.save(tmp_path / "a.xlsx")
    np.testing.assert_allclose(load_record(tmp_path / "a.xlsx").t, 86398 + T, atol=1e-6)


@needs("python_calamine")
def test_an_older_workbook_and_a_log_that_has_only_its_suffix(tmp_path):
    path = tmp_path / "a.xls"
    path.write_bytes(zlib.decompress(base64.b85decode(log_samples.XLS)))
    record = load_record(path)
    assert (record.Ts, record.y.tolist()) == (0.1, [0.0, 0.111, 0.22, 0.327])
    for encoding in ("utf-8", "utf-16"):  # as LabVIEW and others write them
        path.write_text("t\tu\ty\n" + "".join(f"{t}\t{u}\t{y}\n" for t, u, y in SIGNALS), encoding=encoding)
        assert_read(load_record(path))


@needs("python_calamine")
def test_a_workbook_of_libreoffice_with_times_of_day(tmp_path):
    log_samples.write_ods(tmp_path / "a.ods")
    log = open_library_log(tmp_path / "a.ods", library_format(tmp_path / "a.ods").module)
    time, u, y = log.read([0, 1, 2])
    assert (time.unit, time.values[:2].tolist()) == ("h:m:s", [43200.0, 43201.0])
    np.testing.assert_array_equal(u.values, log_samples.U)
    np.testing.assert_array_equal(y.values, log_samples.Y)


@needs("pyarrow")
def test_parquet_with_dates(tmp_path):
    import pyarrow as pa
    import pyarrow.parquet as pq

    table = pa.table({"time": NS.astype("datetime64[ns]"), "u": U, "y": Y.astype(np.float32), "who": ["Ann"] * N})
    pq.write_table(table, tmp_path / "a.parquet")
    record = load_record(tmp_path / "a.parquet")
    assert_read(record)
    assert record.notes == ("times count from 2025-11-24 16:00:00, the first stamp",)


@needs("pyarrow")
def test_parquet_with_durations_and_words(tmp_path):
    import pyarrow as pa
    import pyarrow.parquet as pq

    switches = ["ON" if u else "OFF" for u in U]
    columns = {
        "t": pa.array(np.round(T * 1e9).astype("timedelta64[ns]")),
        "u": pa.array(switches).dictionary_encode(),
        "y": pa.array([f"{y} V" for y in Y]),
        "by": ["Ann"] * N,
    }
    pq.write_table(pa.table(columns), tmp_path / "a.parquet")
    log = open_library_log(tmp_path / "a.parquet", "parquet_file")
    t, u, y = log.read([0, 1, 2])
    np.testing.assert_allclose(t.values, T)
    np.testing.assert_array_equal(u.values, U > 0)
    np.testing.assert_array_equal(y.values, Y)
    assert (t.unit, y.unit) == ("s", "V")
    with pytest.raises(ValueError, match="column by holds words"):
        log.read([3])


@needs("python_calamine")
def test_a_workbook_whose_numbers_are_text(tmp_path):
    import openpyxl

    book = openpyxl.Workbook()
    for row in (["time", "u", "y"], *([f"{t:.1f}".replace(".", ","), f"{u} V", y] for t, u, y in SIGNALS)):
        book.active.append(row)
    book["Sheet"]["C7"] = "#N/A"
    book.save(tmp_path / "a.xlsx")
    t, u, y = open_library_log(tmp_path / "a.xlsx", "sheet_file").read([0, 1, 2])
    np.testing.assert_allclose(t.values, T)
    np.testing.assert_array_equal(u.values, U)
    assert u.unit == "V"
    assert np.flatnonzero(np.isnan(y.values)).tolist() == [5]


@needs("h5py")
def test_hdf5_by_paths_with_units(tmp_path):
    import h5py

    with h5py.File(tmp_path / "a.h5", "w") as file:
        file["run/t"], file["run/u"] = T, U
        file["run/both"] = np.column_stack([Y, 2 * Y])
        file["run/u"].attrs["units"] = "V"
        file["who"] = "Ann"
    record = load_record(tmp_path / "a.h5", columns="run/t,run/u,run/both.1")
    assert_read(record)
    assert record.units[0] == "V"


@needs("h5py")
def test_matlab_7_3_with_a_structure_and_a_cell(tmp_path):
    import h5py

    with h5py.File(tmp_path / "a.mat", "w", userblock_size=512) as file:
        log = file.create_group("log")
        log.attrs["MATLAB_class"] = np.bytes_("struct")
        for name, values in (("time", T), ("input", U), ("output", Y)):
            log[name] = values[None]
            log[name].attrs["MATLAB_class"] = np.bytes_("double")
        file["#refs#/a"] = U[None]
        cell = file.create_dataset("cell", (1, 1), dtype=h5py.ref_dtype)
        cell[0, 0] = file["#refs#/a"].ref
        cell.attrs["MATLAB_class"] = np.bytes_("cell")
    with (tmp_path / "a.mat").open("r+b") as file:
        file.write(b"MATLAB 7.3 MAT-file".ljust(124) + b"\x00\x02IM")
    assert_read(load_record(tmp_path / "a.mat"))
    assert_read(load_record(tmp_path / "a.mat", columns="log.time,cell,log.output"))
    with h5py.File(tmp_path / "b.mat", "w") as file:
        file["time"] = (100 * np.arange(N, dtype=np.uint32))[None]
    (time,) = open_library_log(tmp_path / "b.mat", "hdf5_file").read([0])
    assert time.values.dtype == np.int64  # counters, which do not say their unit


# Measurements -------------------------------------------------------------------------------------------------


@needs("asammdf")
def test_mdf_with_one_clock_and_with_two(tmp_path):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        from asammdf import MDF, Signal

        for name, every in (("a", 1), ("b", 4)):
            log = MDF()
            log.append([Signal(U, T, name="u", unit="V")])
            log.append([Signal(Y[::every], T[::every], name="y", unit="cm")])
            log.save(tmp_path / f"{name}.mf4")
            log.close()
    record = load_record(tmp_path / "a.mf4")
    assert_read(record)
    assert record.units == ("V", "cm")
    slower = load_record(tmp_path / "b.mf4")
    np.testing.assert_array_equal(slower.missing, np.arange(N) % 4 > 0)
    assert slower.notes == ("y has times of its own, 0.4 s apart; missing between them",)
    resampled = load_record(tmp_path / "b.mf4", resample=0.4)
    np.testing.assert_allclose(resampled.y, Y[::4])
    assert "y taken at its own samples" in resampled.notes


@needs("nptdms")
def test_tdms_with_a_column_of_times_and_with_waveforms(tmp_path):
    from nptdms import ChannelObject, TdmsWriter

    with TdmsWriter(str(tmp_path / "a.tdms")) as file:
        file.write_segment([ChannelObject("rig", name, x) for name, x in (("t", T), ("u", U), ("y", Y))])
    wave = {"wf_increment": 0.1, "unit_string": "V"}
    with TdmsWriter(str(tmp_path / "b.tdms")) as file:
        file.write_segment(
            [ChannelObject("a", "in", U, properties=wave), ChannelObject("b", "out", Y, properties=wave)]
        )
    assert_read(load_record(tmp_path / "a.tdms"))
    (tmp_path / "cut.tdms").write_bytes((tmp_path / "a.tdms").read_bytes()[:-40])
    with pytest.raises(ValueError, match=r"cut\.tdms: it is cut off: its last segment is not complete"):
        load_record(tmp_path / "cut.tdms")
    record = load_record(tmp_path / "b.tdms", columns="in,out")
    assert_read(record)
    assert record.units == ("V", "V")


@needs("nptdms")
def test_tdms_whose_channels_begin_at_different_times(tmp_path):
    from nptdms import ChannelObject, TdmsWriter

    start = np.datetime64("2026-03-01T09:00:00.000000")
    with TdmsWriter(str(tmp_path / "a.tdms")) as file:
        for name, x, late in (("u", U, 0), ("y", Y, 1000)):
            wave = {"wf_increment": 0.1, "wf_start_time": start + np.timedelta64(late, "ms")}
            file.write_segment([ChannelObject("rig", name, x, properties=wave)])
    record = load_record(tmp_path / "a.tdms")
    assert (len(record), record.Ts) == (N - 10, pytest.approx(0.1))  # u ends 1 s before y
    assert "10 samples of y before the first of u or after its last left out" in record.notes
    np.testing.assert_array_equal(record.u, U[10:])
    np.testing.assert_array_equal(record.y, Y[:-10])


# Robots -------------------------------------------------------------------------------------------------------


@needs("mcap")
def test_mcap_with_json(tmp_path):
    from mcap.writer import Writer

    with (tmp_path / "a.mcap").open("wb") as file:
        writer = Writer(file)
        writer.start()
        schema = writer.register_schema("any", "jsonschema", b"{}")
        cmd, state = (writer.register_channel(topic, "json", schema) for topic in ("/cmd", "/joint_states"))
        for k in range(N):
            joints = {"name": ["wrist", "elbow"], "position": [0.0, Y[k]]}
            for channel, message in ((cmd, {"data": [U[k]]}), (state, joints)):
                writer.add_message(channel, int(NS[k]), json.dumps(message).encode(), int(NS[k]))
        writer.finish()
    record = load_record(tmp_path / "a.mcap", columns=JOINT)
    assert_read(record)
    assert record.notes == ("times count from 2025-11-24 16:00:00, the first stamp",)
    with pytest.raises(ValueError, match=r"there is no field '/cmd.speed' in it; it holds /cmd.data\[0\], /joint_st"):
        load_record(tmp_path / "a.mcap", columns="/cmd.speed,/joint_states.position[elbow]")


@needs("mcap")
def test_mcap_with_json_whose_fields_are_not_in_each_message(tmp_path):
    from mcap.writer import Writer

    with (tmp_path / "a.mcap").open("wb") as file:
        writer = Writer(file)
        writer.start()
        channel = writer.register_channel("/rig", "json", 0)
        for k in range(N):
            stamp = {"sec": int(NS[k] // 10**9), "nsec": int(NS[k] % 10**9)}
            part = {"u": U[k]} if k % 2 else {"u": U[k], "y": Y[k] if k else None, "more": {"a": 1}}
            writer.add_message(channel, 7 + k, json.dumps({"timestamp": stamp, **part}).encode(), 7 + k)
        writer.finish()
    log = open_library_log(tmp_path / "a.mcap", "mcap_file")
    assert log.names == ("/rig.u", "/rig.y", "/rig.more.a")
    (y,) = log.read([1])
    np.testing.assert_array_equal(np.isnan(y.values), (np.arange(N) % 2 > 0) | (np.arange(N) == 0))
    np.testing.assert_array_equal(y.stamps, NS)


@needs("mcap_protobuf")
def test_mcap_with_protobuf(tmp_path):
    log_samples.write_protobuf(tmp_path / "a.mcap")
    log = open_library_log(tmp_path / "a.mcap", "mcap_file")
    assert log.names == ("/state.u", "/state.y[0]", "/state.y[1]", "/state.at", "/state.at.x")
    u, y, x = log.read([0, 2, 4])
    np.testing.assert_array_equal(u.values, log_samples.U)
    np.testing.assert_array_equal(y.values, log_samples.Y)
    assert np.flatnonzero(np.isnan(x.values)).tolist() == [0]
    assert np.unique(np.diff(u.stamps)).tolist() == [10**8]  # the stamps of the messages: they are logged unevenly


def messages(store, is_first):
    """A command and the state of the joints at each sample, as messages of ROS."""
    types = store.types
    for k in range(N):
        layout = types["std_msgs/msg/MultiArrayLayout"](dim=[], data_offset=0)
        command = types["std_msgs/msg/Float64MultiArray"](layout=layout, data=np.array([U[k]]))
        stamp = types["builtin_interfaces/msg/Time"](sec=int(NS[k] // 10**9), nanosec=int(NS[k] % 10**9))
        more = {"seq": k} if is_first else {}
        header = types["std_msgs/msg/Header"](stamp=stamp, frame_id="", **more)
        empty, names = np.array([]), ["wrist", "elbow"] if k % 2 else ["elbow", "wrist"]  # the order may change
        position = np.array([0.0, Y[k]] if k % 2 else [Y[k], 0.0])
        state = types["sensor_msgs/msg/JointState"](
            header=header, name=names, position=position, velocity=empty, effort=empty
        )
        yield int(NS[k]) + 7_000_000, command, state  # logged 7 ms later


@needs("rosbags")
@pytest.mark.parametrize("kind", ["ros1", "sqlite3", "mcap"])
def test_bags(tmp_path, kind):
    from rosbags import rosbag1, rosbag2
    from rosbags.typesys import Stores, get_typestore

    store = get_typestore(Stores.ROS1_NOETIC if kind == "ros1" else Stores.ROS2_HUMBLE)
    path = tmp_path / ("a.bag" if kind == "ros1" else "bag")
    if kind == "ros1":
        writer, pack = rosbag1.Writer(path), store.serialize_ros1
    else:
        writer = rosbag2.Writer(path, version=9, storage_plugin=rosbag2.StoragePlugin[kind.upper()])
        pack = store.serialize_cdr
    with writer:
        cmd = writer.add_connection("/cmd", "std_msgs/msg/Float64MultiArray", typestore=store)
        joints = writer.add_connection("/joint_states", "sensor_msgs/msg/JointState", typestore=store)
        for stamp, command, state in messages(store, kind == "ros1"):
            writer.write(cmd, stamp, pack(command, cmd.msgtype))
            writer.write(joints, stamp, pack(state, joints.msgtype))
    record = load_record(path, columns=JOINT)
    # The state has the stamp of its header, 7 ms before the command was logged: the command is held.
    np.testing.assert_allclose(record.y, Y[1:])
    np.testing.assert_allclose(record.u, U[:-1])
    assert "u has times of its own" in " ".join(record.notes)
    part = next(path.glob("*.mcap"), None) if path.is_dir() else None
    if part is not None:
        np.testing.assert_array_equal(load_record(part, columns=JOINT).y, record.y)


@needs("pyarrow")
@pytest.mark.parametrize("version", [2, 3])
def test_lerobot_data_sets(tmp_path, version):
    import pyarrow as pa
    import pyarrow.parquet as pq

    names = ["elbow.pos", "wrist.pos"]
    feature = {"dtype": "float32", "shape": [2], "names": names if version == 3 else {"motors": names}}
    (tmp_path / "meta").mkdir()
    (tmp_path / "data" / "chunk-000").mkdir(parents=True)
    info = {"codebase_version": f"v{version}", "features": {"action": feature, "observation.state": feature}}
    (tmp_path / "meta" / "info.json").write_text(json.dumps(info))
    half = N // 2
    for episode in (0, 1):
        rows = slice(episode * half, (episode + 1) * half)
        table = pa.table(
            {
                "action": pa.array(np.column_stack([U, 0 * U])[rows].tolist(), pa.list_(pa.float32(), 2)),
                "observation.state": pa.array(np.column_stack([Y, 0 * Y])[rows].tolist(), pa.list_(pa.float32())),
                "timestamp": T[:half].astype(np.float32),
                "episode_index": np.full(half, episode),
            }
        )
        pq.write_table(table, tmp_path / "data" / "chunk-000" / f"episode_{episode:06d}.parquet")
    columns = "action[elbow.pos],observation.state[elbow.pos]"
    with pytest.raises(ValueError, match=r"time goes backwards from sample 39 .*--select 1"):
        load_record(tmp_path, columns=columns)
    assert_read(load_record(tmp_path, columns=columns, select=1), slice(half))
    assert_read(load_record(tmp_path, columns=columns, select=2), slice(half, N))


# MATLAB 4, and objects of MATLAB -------------------------------------------------------------------------------


def test_matlab_4(tmp_path):
    from scipy.io import savemat

    names = {"time": T, "input": U, "output": Y, "by": "Ann", "gain": 2.0}
    savemat(tmp_path / "a.mat", names, format="4")
    assert library_format(tmp_path / "a.mat") is MAT4
    columns = open_library_log(tmp_path / "a.mat", MAT4.module).read([0, 1, 2])
    for column, x in zip(columns, (T, U, Y), strict=True):
        np.testing.assert_array_equal(column.values, x)


@needs("matio")
@pytest.mark.parametrize(
    ("times", "version"),
    [
        ("stored", "v7"),
        ("uniform", "v7.3"),
        pytest.param("stored", "v7.3", marks=pytest.mark.exhaustive),
        pytest.param("uniform", "v7", marks=pytest.mark.exhaustive),
    ],
)
def test_timeseries_tables_and_data_sets_of_simulink(tmp_path, version, times):
    pd = pytest.importorskip("pandas")  # comes with mat-io

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of pandas, for an option that mat-io sets
        from matio import save_to_mat
        from matio.utils.matclass import MatlabOpaque

    def series(name, values):
        numbers = {"Start_": 0.0, "Increment_": 0.1, "Length_": float(N)}
        info = MatlabOpaque({key: np.array([[x]]) for key, x in numbers.items()}, "tsdata.timemetadata")
        stored = T[:, None] if times == "stored" else np.empty((0, 0))
        properties = {"Name": np.array([name]), "Data_": values[:, None], "Time_": stored, "TimeInfo": info}
        return MatlabOpaque(properties, "timeseries")

    elements = np.empty((2, 1), object)
    for k, (name, values) in enumerate((("speed", Y), ("voltage", U))):
        signal = {"Name": np.array([name]), "Values": series("", values)}
        elements[k, 0] = MatlabOpaque(signal, "Simulink.SimulationData.Signal")
    logs = MatlabOpaque({"Elements_": elements}, "Simulink.SimulationData.Dataset")
    content = {
        "u": series("u", U),
        "y": series("y", Y),
        "logsout": logs,
        "tab": pd.DataFrame({"time": T, "cmd": U, "level": Y}),
    }
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        save_to_mat(tmp_path / "a.mat", content, version=version)
    path = tmp_path / "a.mat"
    assert_read(load_record(path, columns="u,y"))
    assert_read(load_record(path, columns="logsout.voltage,logsout.speed"))
    assert_read(load_record(path, columns="tab.time,tab.cmd,tab.level"))


# What all share -----------------------------------------------------------------------------------------------


MAGIC = {one.module: one.magic[0] if one.magic else b"PK\x03\x04" for one in FORMATS if one.suffixes}


@pytest.mark.parametrize("one", [one for one in FORMATS if one.suffixes], ids=lambda one: one.module)
def test_a_damaged_file_is_refused_in_one_line(tmp_path, one):
    path = tmp_path / f"bad{one.suffixes[0]}"
    path.write_bytes(MAGIC[one.module] + bytes(range(256)) * 4)
    assert library_format(path) is one
    says = r"bad\.\w+: .*(damaged|needs the package|Give the bag's folder|no channels)"
    with pytest.raises(ValueError, match=says) as caught:
        load_record(path)
    assert "\n" not in str(caught.value)


def test_a_missing_package_is_named_with_how_to_install_it(tmp_path, monkeypatch):
    blocked = tmp_path / "site"
    blocked.mkdir()
    (blocked / "python_calamine.py").write_text("raise ModuleNotFoundError('no', name='python_calamine')\n")
    monkeypatch.setenv("PYTHONPATH", str(blocked))
    path = tmp_path / "a.xlsx"
    path.write_bytes(b"PK\x03\x04")
    with pytest.raises(
        ValueError, match=r'reading it needs the package python_calamine. Install it: pip install "labsid\[logs'
    ):
        load_record(path)


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no limits of memory")
@needs("h5py")
def test_a_bomb_is_refused_and_takes_no_memory(tmp_path):
    import h5py

    with h5py.File(tmp_path / "a.h5", "w") as file:
        for name in "tuy":
            file.create_dataset(name, (2**33,), dtype="f8", chunks=(2**20,), compression="gzip")
    assert (tmp_path / "a.h5").stat().st_size < 2**20
    with pytest.raises(ValueError, match="data set /t is over 512 MB"):
        load_record(tmp_path / "a.h5")


@needs("pyarrow")
@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no limits of memory")
def test_a_process_that_needs_too_much_memory_is_refused(tmp_path, monkeypatch):
    import pyarrow as pa
    import pyarrow.parquet as pq

    constant = pa.array(np.zeros(30_000_000))
    pq.write_table(pa.table(dict.fromkeys("tuy", constant)), tmp_path / "a.parquet")
    assert (tmp_path / "a.parquet").stat().st_size < 2**20
    with pytest.raises(ValueError, match=r"over 512 MB|more than 1024 MB|ended the reader|cannot be read as Parquet"):
        load_record(tmp_path / "a.parquet")


def test_a_process_that_dies_or_takes_too_long_is_told(tmp_path, monkeypatch):
    path = tmp_path / "a.parquet"
    path.write_bytes(b"PAR1" * 10)
    monkeypatch.setattr(apart, "SECONDS", 0.01)
    with pytest.raises(ValueError, match=r"reading this Parquet table took over 0.01 s"):
        load_record(path)
    monkeypatch.undo()
    monkeypatch.setattr(apart.sys, "executable", "/bin/false")
    with pytest.raises(ValueError, match=r"it is damaged, or too large: reading it as Parquet table ended the reader"):
        load_record(path)


def test_the_columns_of_a_log_are_described(write_text):
    text = "time_ms,pwm,speed,idle,who\n" + "".join(f"{20 * k},{k // 9 % 2 * 50},{k % 7},1,Ann\n" for k in range(50))
    found = describe_columns(write_text(text))
    assert [(one.name, one.role) for one in found] == [
        ("time_ms", "time"),
        ("pwm", "input"),
        ("speed", "output"),
        ("idle", "constant"),
        ("who", "text"),
    ]
    assert (found[0].interval, found[1].low, found[1].high) == (pytest.approx(0.02), 0.0, 50.0)


@pytest.mark.parametrize(
    ("header", "typed"),
    [
        ("time,pwm,speed", ["--columns", "time,pwm,speed"]),
        ("time,a,speed", ["--columns", "time,INPUT,OUTPUT"]),
        ("time,pwm,u", ["--columns", "time,INPUT,OUTPUT"]),
        ("pwm,speed", ["--columns", "pwm,speed", "--Ts", "SECONDS"]),
    ],
)
def test_the_line_to_type_names_what_is_certain(write_text, header, typed):
    columns = header.split(",")
    rows = (",".join(str(k if name == "time" else k * k % 41 / 7) for name in columns) for k in range(60))
    assert suggested_options(describe_columns(write_text("\n".join([header, *rows])))) == typed


def test_text_needs_no_library():
    root = Path(__file__).resolve().parents[3]
    program = (
        "import sys\nfrom labsid.records.record import load_record\n"
        "load_record('data/WithheldRig.csv')\nload_record('data/SysIdenData_StudentVersion.mat')\n"
        "print(*sys.modules)"
    )
    done = subprocess.run([sys.executable, "-c", program], cwd=root, capture_output=True, text=True, check=True)
    heavy = {
        "h5py",
        "pyarrow",
        "asammdf",
        "nptdms",
        "mcap",
        "rosbags",
        "python_calamine",
        "google",
        "matio",
        "pandas",
        "scipy",
    }
    assert heavy & set(done.stdout.split()) == set()


# Several signals ----------------------------------------------------------------------------------------------

SEVERAL = {"t": T, "fan": U, "valve": np.roll(U, 7), "level": Y, "flow": np.cos(T), "goal": 2 * U}


def write_excel(path):
    import openpyxl

    book = openpyxl.Workbook()
    for row in [list(SEVERAL), *np.column_stack(list(SEVERAL.values())).tolist()]:
        book.active.append(row)
    book.save(path)


def write_parquet(path):
    import pyarrow as pa
    import pyarrow.parquet as pq

    pq.write_table(pa.table(SEVERAL), path)


def write_hdf5(path):
    import h5py

    with h5py.File(path, "w") as file:
        for name, x in SEVERAL.items():
            file[name] = x


def write_tdms(path):
    import nptdms

    with nptdms.TdmsWriter(path) as writer:
        writer.write_segment([nptdms.ChannelObject("run", name, x) for name, x in SEVERAL.items()])


def write_mdf(path):
    import asammdf

    signals = [asammdf.Signal(x, T, name=name) for name, x in SEVERAL.items() if name != "t"]
    with asammdf.MDF() as mdf:
        mdf.append(signals)
        mdf.save(path)


def write_mat(path):
    import scipy.io

    scipy.io.savemat(path, SEVERAL)


def write_json(path):
    path.write_text(json.dumps({name: x.tolist() for name, x in SEVERAL.items()}))


@pytest.mark.parametrize(
    ("name", "write", "package"),
    [
        ("a.json", write_json, "json"),
        ("a.mat", write_mat, "scipy"),
        ("a.npz", lambda path: np.savez(path, **SEVERAL), "numpy"),
        ("a.xlsx", write_excel, "python_calamine"),
        ("a.parquet", write_parquet, "pyarrow"),
        ("a.h5", write_hdf5, "h5py"),
        ("a.tdms", write_tdms, "nptdms"),
        ("a.mf4", write_mdf, "asammdf"),
    ],
)
def test_several_signals_in_every_format(tmp_path, name, write, package):
    pytest.importorskip(package)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        write(tmp_path / name)
    record = load_record(tmp_path / name, inputs="valve,fan", outputs="level,flow", reference="goal")
    assert (record.inputs, record.outputs) == (("valve", "fan"), ("level", "flow"))
    np.testing.assert_allclose(record.u, np.column_stack([SEVERAL["valve"], U]))
    np.testing.assert_allclose(record.y, np.column_stack([Y, SEVERAL["flow"]]))
    np.testing.assert_allclose(record.reference, 2 * U)
    assert record.Ts == pytest.approx(0.1)
    with pytest.raises(ValueError, match=r"'level' is named as an input and as an output"):
        load_record(tmp_path / name, inputs="fan,level", outputs="level")
