"""Archives that are broken or hostile: their student is named, everybody else is collected, and the time is bounded."""

import io
import json
import struct
import zipfile
from collections.abc import Callable
from pathlib import Path

import pytest

from autograder.course.layout import Course
from autograder.intake import collect, download
from autograder.intake.collect import collect_submissions
from labsid.checks.time_limit import limit_time

LAB = "lab-identification"
METHODS = {"stored": 0, "deflate": 8, "bzip2": 12, "lzma": 14}


def packed(files: dict[str, bytes], method: int = zipfile.ZIP_DEFLATED) -> bytes:
    content = io.BytesIO()
    with zipfile.ZipFile(content, "w", method) as archive:
        for name, data in files.items():
            archive.writestr(name, data)
    return content.getvalue()


def with_field(content: bytes, signature: bytes, offset: int, value: bytes) -> bytes:
    """The archive with other bytes in the header that begins with a signature."""
    at = content.index(signature) + offset
    return content[:at] + value + content[at + len(value) :]


def bad_lzma_header(notebook: bytes) -> bytes:
    content = packed({"a.ipynb": notebook}, zipfile.ZIP_LZMA)
    start = 30 + len("a.ipynb")
    return content[: start + 4] + b"\xff" * 5 + content[start + 9 :]


def far_offset(notebook: bytes) -> bytes:
    """A zip64 field with an offset near 2^64."""
    info = zipfile.ZipInfo("a.ipynb")
    content = io.BytesIO()
    with zipfile.ZipFile(content, "w") as archive:
        archive.writestr(info, notebook)
        archive.filelist[0].header_offset = 2**64 - 2
    return content.getvalue()


def without_a_name(notebook: bytes) -> bytes:
    content = packed({"a": notebook})
    for signature, offset, fixed in ((b"PK\x03\x04", 26, 30), (b"PK\x01\x02", 28, 46)):
        at = content.index(signature)
        content = content[: at + offset] + b"\0\0" + content[at + offset + 2 : at + fixed] + content[at + fixed + 1 :]
    end = content.index(b"PK\x05\x06")
    size, start = struct.unpack("<LL", content[end + 12 : end + 20])
    return content[: end + 12] + struct.pack("<LL", size - 1, start - 1) + content[end + 20 :]


def many_bombs() -> bytes:
    """Three hundred entries that unpack to more than is allowed for one."""
    bomb = packed({"0000.ipynb": bytes(51 * 2**20)})
    local, directory = bomb.index(b"PK\x03\x04"), bomb.index(b"PK\x01\x02")
    end = bomb.index(b"PK\x05\x06")
    entry, listed = bomb[local:directory], bomb[directory:end]
    files, table = b"", b""
    for n in range(300):
        name = f"{n:04}.ipynb".encode()
        table += (listed[:42] + struct.pack("<L", len(files)) + listed[46:]).replace(b"0000.ipynb", name)
        files += entry.replace(b"0000.ipynb", name)
    tail = struct.pack("<4s4H2LH", b"PK\5\6", 0, 0, 300, 300, len(table), len(files), 0)
    return files + table + tail


HOSTILE: dict[str, Callable[[bytes], bytes]] = {
    "a bad LZMA header": bad_lzma_header,
    "an offset near 2^64": far_offset,
    "an entry without a name": without_a_name,
    "300 refused entries": lambda _: many_bombs(),
    "19,000 empty entries": lambda _: packed({f"{n}.ipynb": b"" for n in range(19_000)}),
    "21,000 entries": lambda _: packed({f"{n}": b"" for n in range(21_000)}),
    "a bzip2 bomb": lambda _: packed({"a.ipynb": bytes(100_000_000)}, zipfile.ZIP_BZIP2),
    "an LZMA bomb": lambda _: packed({"a.ipynb": bytes(100_000_000)}, zipfile.ZIP_LZMA),
    "an unknown method": lambda it: with_field(packed({"a.ipynb": it}), b"PK\x01\x02", 10, b"\x63\0"),
    "no zip file": lambda _: b"PK\x03\x04",
    "half of a zip file": lambda it: packed({"a.ipynb": it})[:2000],
    "a million parts": lambda _: packed({f"{LAB}.ipynb": b"[" + b'{"a":{}},' * 450_000 + b"1]"}),
    "many values": lambda _: packed({f"{LAB}.ipynb": b"[" + b"1," * 10**7 + b"1]"}),
    "deep": lambda _: packed({f"{LAB}.ipynb": b"[" * 400_000 + b"]" * 400_000}),
}


@pytest.fixture(scope="module")
def notebook(course: Course) -> bytes:
    changed = json.loads((course.release / LAB / f"{LAB}.ipynb").read_bytes())
    changed["cells"].append({"cell_type": "markdown", "metadata": {}, "source": "Done.", "id": "mark"})
    return json.dumps(changed).encode()


@pytest.mark.parametrize("kind", HOSTILE)
def test_the_others_are_collected_and_the_student_is_named(
    course: Course, notebook: bytes, tmp_path: Path, kind: str
) -> None:
    content = HOSTILE[kind](notebook)
    files = {
        "Ada_1_assignsubmission_file_/x.ipynb": notebook,
        "Eve_2_assignsubmission_file_/hand-in.zip": content,
        f"Zoe_3_assignsubmission_file_/{LAB}.ipynb": notebook,
    }
    (tmp_path / "m.zip").write_bytes(packed(files))
    with limit_time(120.0):  # it takes two seconds at most
        ada, eve, zoe = collect_submissions(course, tmp_path / "m.zip", tmp_path / "out")
    assert (ada, zoe) == (f"1 (Ada): {LAB}", f"3 (Zoe): {LAB}")
    assert eve.startswith("2 (Eve): ")
    assert any(word in eve for word in ("skipped: ", "not everything was read", f"2 (Eve): {LAB}"))
    assert len(eve) < 2_000
    assert (tmp_path / "out" / "2").is_dir()


@pytest.mark.parametrize("method", METHODS)
def test_every_method_of_packing_is_read(course: Course, notebook: bytes, tmp_path: Path, method: str) -> None:
    inner = packed({f"{LAB}/{LAB}.ipynb": notebook}, METHODS[method])
    (tmp_path / "m.zip").write_bytes(packed({"Ada_1_assignsubmission_file_/hand-in.zip": inner}))
    assert list(collect_submissions(course, tmp_path / "m.zip", tmp_path / "out")) == [f"1 (Ada): {LAB}"]
    assert (tmp_path / "out" / "1" / LAB / f"{LAB}.ipynb").read_bytes() == notebook
    if method != "stored":
        damaged = bytearray(inner)
        damaged[len(inner) // 2] ^= 255
        (tmp_path / "m.zip").write_bytes(packed({"Ada_1_assignsubmission_file_/hand-in.zip": bytes(damaged)}))
        (line,) = collect_submissions(course, tmp_path / "m.zip", tmp_path / "again")
        assert f"{LAB}.ipynb: it cannot be unpacked (" in line


@pytest.mark.parametrize("error", [KeyError, MemoryError, RecursionError, OverflowError, struct.error, AssertionError])
@pytest.mark.parametrize("where", ["read_packed", "read_entries", "_recognise", "reading_work"])
def test_whatever_a_parser_raises_is_a_remark(
    course: Course,
    notebook: bytes,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    where: str,
    error: type[Exception],
) -> None:
    def broken(*_: object) -> None:
        raise error("bad")

    files = {"Ada_1_assignsubmission_file_/hand-in.zip": packed({"a.ipynb": notebook})}
    (tmp_path / "m.zip").write_bytes(packed(files))
    monkeypatch.setattr(download, where, broken)
    (line,) = collect_submissions(course, tmp_path / "m.zip", tmp_path / "out")
    assert line.startswith("1 (Ada): no notebook of this course; ")


def test_one_student_can_use_up_the_pool_but_nobodys_share(
    course: Course, notebook: bytes, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(collect, "POOL", 1_000_000)
    monkeypatch.setattr(collect, "SHARE", 5_000_000)
    files = {f"E{n}_{n}_assignsubmission_file_/hand-in.zip": many_bombs() for n in range(1, 4)}
    files["Zoe_9_assignsubmission_file_/x.zip"] = packed({"a.ipynb": notebook})
    (tmp_path / "m.zip").write_bytes(packed(files))
    *eves, zoe = collect_submissions(course, tmp_path / "m.zip", tmp_path / "out")
    assert all("not everything was read: its files take too much work to read" in eve for eve in eves)
    assert zoe == f"9 (Zoe): {LAB}"
