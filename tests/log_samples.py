"""One short record as a file of each format, by the formats' own writers; for `make fuzz`."""

import io
import json
import tempfile
import warnings
from collections.abc import Callable
from pathlib import Path

import numpy as np

N = 60
T = np.arange(N) * 0.1
U = np.repeat([0.0, 1.0, 2.5], N // 3)
Y = np.round(np.sin(np.arange(N) / 9), 4)
SIGNALS = {"t": T, "u": U, "y": Y}


def text_samples() -> dict[str, bytes]:
    """The same record as text in several forms."""
    rows = list(zip(T.tolist(), U.tolist(), Y.tolist(), strict=True))
    plain = "t,u,y\n" + "".join(f"{t:.1f},{u},{y}\n" for t, u, y in rows)
    german = "Zeit [s];Spannung [V];Weg [cm]\n" + "".join(f"{t:.1f};{1000 * u:,.2f};{y}\n" for t, u, y in rows)
    stamped = "timestamp,u,y\n" + "".join(f"2026-03-01T09:00:{t:06.3f}+01:00,{u},{y}\n" for t, u, y in rows)
    return {
        "plain": plain.encode(),
        "utf-16": plain.encode("utf-16"),
        "german": german.replace(".", "§").replace(",", ".").replace("§", ",").encode("cp1252"),
        "dates": stamped.encode(),
        "switches": plain.replace(",1.0,", ",ON,").replace(",0.0,", ",OFF,").encode(),
        "fortran": "".join(f"{t:.1f}D+00  {u}D+00  {y}\n" for t, u, y in rows).encode(),
        "monitor": "".join(f"21:00:0{t:.3f} -> {u},{y}\n" for t, u, y in rows).encode(),
        "lines before": ("Device: 1\nDate: 2026-01-01\n\n" + plain.replace("t,u,y", "t,u,y\ns,V,cm")).encode(),
        "milliseconds": plain.replace("t,u,y", "time_ms,u,y").replace(".1,", "1,").encode(),
    }


def array_samples() -> dict[str, bytes]:
    """The same record as arrays of numpy."""
    archive, packed, matrix = io.BytesIO(), io.BytesIO(), io.BytesIO()
    np.savez(archive, **SIGNALS)
    np.savez_compressed(packed, **SIGNALS)
    np.save(matrix, np.column_stack([T, U, Y]))
    return {"a.npz": archive.getvalue(), "b.npz": packed.getvalue(), "a.npy": matrix.getvalue()}


def library_samples() -> dict[str, bytes]:
    """The same record in the formats that libraries read; a format without its library is left out."""
    writers: dict[str, Callable[[Path], object]] = {
        "a.xlsx": _excel, "a.parquet": _parquet, "a.h5": _hdf5, "a.mf4": _mdf, "a.tdms": _tdms, "a.mcap": _mcap,
        "a.bag": _bag,
    }  # fmt: skip
    samples = {}
    with tempfile.TemporaryDirectory() as folder, warnings.catch_warnings():
        warnings.simplefilter("ignore")
        for name, write in writers.items():
            try:
                write(Path(folder) / name)
            except ModuleNotFoundError:
                continue
            samples[name] = (Path(folder) / name).read_bytes()
    return samples


def _excel(path: Path) -> None:
    import openpyxl

    book = openpyxl.Workbook()
    for row in (list(SIGNALS), *np.column_stack([T, U, Y]).tolist()):
        book.active.append(row)
    book.save(path)


def _parquet(path: Path) -> None:
    import pyarrow as pa
    import pyarrow.parquet as pq

    pq.write_table(pa.table(SIGNALS), path)


def _hdf5(path: Path) -> None:
    import h5py

    with h5py.File(path, "w") as file:
        for name, values in SIGNALS.items():
            file.create_dataset(name, data=values, compression="gzip" if name == "y" else None)


def _mdf(path: Path) -> None:
    from asammdf import MDF, Signal

    log = MDF()
    log.append([Signal(U, T, name="u"), Signal(Y, T, name="y")])
    log.save(path)
    log.close()


def _tdms(path: Path) -> None:
    from nptdms import ChannelObject, TdmsWriter

    with TdmsWriter(str(path)) as file:
        file.write_segment([ChannelObject("rig", name, values) for name, values in SIGNALS.items()])


def _mcap(path: Path) -> None:
    from mcap.writer import Writer

    with path.open("wb") as file:
        writer = Writer(file)
        writer.start()
        channel = writer.register_channel("/rig", "json", writer.register_schema("any", "jsonschema", b"{}"))
        for t, u, y in zip(T.tolist(), U.tolist(), Y.tolist(), strict=True):
            stamp = round(t * 1e9)
            writer.add_message(channel, stamp, json.dumps({"u": u, "y": y}).encode(), stamp)
        writer.finish()


def _bag(path: Path) -> None:
    from rosbags.rosbag1 import Writer
    from rosbags.typesys import Stores, get_typestore

    store = get_typestore(Stores.ROS1_NOETIC)
    with Writer(path) as writer:
        for topic, values in (("/u", U), ("/y", Y)):
            one = writer.add_connection(topic, "std_msgs/msg/Float64", typestore=store)
            for t, value in zip(T.tolist(), values.tolist(), strict=True):
                message = store.types["std_msgs/msg/Float64"](data=value)
                writer.write(one, round(1e9 * t) + 10**18, store.serialize_ros1(message, one.msgtype))
