"""One short record as a file of each format, by the formats' own writers; for `make fuzz`."""

import base64
import io
import json
import tempfile
import warnings
import zipfile
import zlib
from collections.abc import Callable
from pathlib import Path

import numpy as np

N = 60
T = np.arange(N) * 0.1
U = np.repeat([0.0, 1.0, 2.5], N // 3)
Y = np.round(np.sin(np.arange(N) / 9), 4)
SIGNALS = {"t": T, "u": U, "y": Y}
# Four rows in a workbook of Excel 97, by xlwt; packed.
XLS = (
    "c-rk)O=uHA6#iy+)BM<`Nle97C^2BGZ7-q+FYT(JJz1(A6cuV}gFg+4gnFolTCF(>iYLWOp%*W;UaDdRy?GGo9|($&=utcf3KrU|Z{F_4H0_}Q"
    "E&j|G=FOY;GjFo<=Izh(*>HaRZc_mj=z@--<ws4KOi=T?gAhn>S(0^oA2mziuY%u48(HJQ!@6f)xrcJU3(zoSJRu5vpmq#r(UVChW2=bWyoQ93"
    "Yv?2@aEl~CH1et<OiwUf%k&Og&M@7{k}FI*$u=*JVAkwu+u>yKVJ*(OAmqIF*yk-vwxR(~Wfot!Dr{R1c4bc|Qh%nR*{H<?Xy3Y%>0~yM$|Fh}"
    "IDv0g4EXAv)W<O;UtPHX$-gg_dzX=4*9>43)^Seo9M)i3ml_?Z%*lCj(s{s@cZk|KYQq6ph56Km7M<EU&gNR81E^;{%sCyRx;%gT%gcTJy=EUv"
    "M!8bk^?Z|D0xVpV9^@QkjR$Zdx3Nb%(@Q+-2IiZXM#+-;mfi-3**nHIms#6FakepDnXP5~X5w?7_TO*LeKfZaKiOS4ADw(-jw4R@mjUvZzcF-("
    "4sr8_!~@gqg>&}bGi_W_2Ygz{S-a)jwCb^d0JCAH_DEhGQ5tE^wUXYV!ut`{v&^<AryAR9OY9?#O?$~wK-Xlok#Szc-_4DjnK7lWzDz8gy$+Ve"
    "I$DZlRM^W|4Yt|tT-y;XKoWQFZM}@TaVmT2+UM71mlnaaR8f`ui2xK76ciK`6ciNx4+ws?w4e12=gD8bO?aK}It$c_>NCkdiv!5eZ-`z@_aIGu"
    "7Q<EL&pLR7JC|6YkNdq);t)m8Vi5hjj=`$)m)^BR`Ttq5W9Zi%p=#q7t6Ar7j{gIL)6W("
)


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
        "labels": "".join(f"t:{t:.1f},u:{u},y:{y}\n" for t, u, y in rows).encode(),
        "units": ("t;u;y\n" + "".join(f"{t:.1f} s;{u} V;{y} cm\n" for t, u, y in rows)).encode(),
        "clock": "".join(f"03/01/2026 9:00:{t:06.3f} AM\t{1000 * u:,.1f}\t{y}\n" for t, u, y in rows).encode(),
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
        "a.bag": _bag, "b.mcap": write_protobuf, "a.ods": write_ods, "a.mat": _mat4, "a.json": _json,
        "b.json": _json_lines,
        "a.xls": lambda path: path.write_bytes(zlib.decompress(base64.b85decode(XLS))),
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


def _mat4(path: Path) -> None:
    from scipy.io import savemat

    savemat(path, SIGNALS, format="4")


def _json(path: Path) -> None:
    path.write_text(json.dumps({name: x.tolist() for name, x in SIGNALS.items()}))


def _json_lines(path: Path) -> None:
    path.write_text("".join(json.dumps({"t": t, "rig": {"u": 1.0, "y": [t]}}) + "\n" for t in T.tolist()))


def write_ods(path: Path) -> None:
    """A workbook of LibreOffice without a header, whose first column holds times of day, 1 s apart."""

    def cell(kind: str, name: str, value: object) -> str:
        return f'<table:table-cell office:value-type="{kind}" office:{name}="{value}"/>'

    rows = "".join(
        f"<table:table-row>{cell('time', 'time-value', f'PT12H00M{k:02d}S')}"
        f"{cell('float', 'value', u)}{cell('float', 'value', y)}</table:table-row>"
        for k, (u, y) in enumerate(zip(U.tolist(), Y.tolist(), strict=True))
    )
    space = "urn:oasis:names:tc:opendocument:xmlns"
    content = (
        f'<office:document-content xmlns:office="{space}:office:1.0" xmlns:table="{space}:table:1.0"><office:body>'
        f'<office:spreadsheet><table:table table:name="log">{rows}</table:table></office:spreadsheet></office:body>'
        "</office:document-content>"
    )
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("mimetype", "application/vnd.oasis.opendocument.spreadsheet")
        archive.writestr("content.xml", content)
        archive.writestr("META-INF/manifest.xml", f'<manifest:manifest xmlns:manifest="{space}:manifest:1.0"/>')


def write_protobuf(path: Path) -> None:
    """Messages in protobuf: a stamp, u, two y of which the second counts, and a part that the first message lacks."""
    from google.protobuf import descriptor_pb2, descriptor_pool, message_factory, timestamp_pb2
    from mcap_protobuf.writer import Writer

    kinds = descriptor_pb2.FieldDescriptorProto
    one, many = kinds.LABEL_OPTIONAL, kinds.LABEL_REPEATED
    file = descriptor_pb2.FileDescriptorProto(name="rig.proto", package="rig", syntax="proto3")
    file.dependency.append("google/protobuf/timestamp.proto")
    state = file.message_type.add(name="State")
    state.nested_type.add(name="Point").field.add(name="x", number=1, type=kinds.TYPE_DOUBLE, label=one)
    for number, (name, kind, label, of) in enumerate(
        [
            ("timestamp", kinds.TYPE_MESSAGE, one, ".google.protobuf.Timestamp"),
            ("u", kinds.TYPE_FLOAT, one, None),
            ("y", kinds.TYPE_DOUBLE, many, None),
            ("at", kinds.TYPE_MESSAGE, one, ".rig.State.Point"),
        ]
    ):
        state.field.add(name=name, number=number + 1, type=kind, label=label, type_name=of)
    pool = descriptor_pool.DescriptorPool()
    pool.AddSerializedFile(timestamp_pb2.DESCRIPTOR.serialized_pb)
    pool.Add(file)
    message = message_factory.GetMessageClass(pool.FindMessageTypeByName("rig.State"))
    with path.open("wb") as stream, Writer(stream) as writer:
        for k, (t, u, y) in enumerate(zip(T.tolist(), U.tolist(), Y.tolist(), strict=True)):
            sent = message(u=u, y=[0.0, y])
            sent.timestamp.FromNanoseconds(10**18 + round(1e9 * t))
            if k:
                sent.at.x = y
            writer.write_message("/state", sent, 10**18 + round(1e9 * t) + k * k)
