"""Hostile values, and mutated hand-ins, downloads, zip files, records and models: each is read, or refused in one line.

`make fuzz` runs many of them, a test a few. A case is repeated with its seed: ``--kind zips --seed 7 --cases 1``.
"""

import argparse
import io
import json
import shutil
import signal
import sys
import tempfile
import time
import zipfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent))
sys.path.insert(0, str(Path(__file__).resolve().parent.parent))  # the packages first: the tests mirror them

from log_samples import array_samples, library_samples, text_samples

from autograder.batch.wrong_record import _noisy_numbers
from autograder.course.build import build_course
from autograder.course.layout import Course, read_template
from autograder.intake.collect import collect_submissions
from autograder.intake.submission import read_submission
from autograder.judge.redaction import redact, redact_reason
from autograder.results.prose import prose_for_notebook
from autograder.results.similar import code_fingerprints
from autograder.sandbox.channel import ChannelError, decode
from labsid.checks.compare import as_array, as_matrix, as_number, as_vector, kind_of
from labsid.checks.compare_systems import as_system
from labsid.checks.verdict import NoAnswer
from labsid.gap.simulations.simulation_files import replay
from labsid.records.formats import describe_columns
from labsid.records.record import Record, load_record

ROOT = Path(__file__).resolve().parent.parent
NAME = "prelab-sinusoids"
SECONDS = 20
"""Time of one case; the slowest takes about 1 s."""

SHARES = {"values": 10, "logs": 0.1}
"""Cases of a kind against those of the others; each of `logs` starts a process."""

MAX_LINE = 100_000
Case = Callable[[np.random.Generator, "Ground"], None]


class Ground:
    """What is mutated, and a folder for the mutants."""

    def __init__(self, course: Course, folder: Path) -> None:
        self.course = course
        self.folder = folder
        self.template = read_template(course, NAME)
        self.notebook = (course.source / NAME / f"{NAME}.ipynb").read_bytes()
        self.records = {path.suffix: path.read_bytes() for path in sorted((ROOT / "data").glob("SysIdenData_S*.mat"))}
        self.records[".csv"] = (ROOT / "data" / "WithheldRig.csv").read_bytes()[:20_000]
        self.record: Record = load_record(ROOT / "data" / "WithheldRig.csv")
        self.texts, self.arrays, self.logs = text_samples(), array_samples(), library_samples()


def mutate(rng: np.random.Generator, content: bytes) -> bytes:
    """Bytes changed, removed, repeated or cut off at a few places."""
    data = bytearray(content)
    for _ in range(int(rng.integers(1, 6))):
        at = int(rng.integers(0, max(len(data), 1)))
        size = int(rng.integers(1, 40))
        match int(rng.integers(0, 5)):
            case 0:
                data[at : at + size] = rng.bytes(min(size, len(data) - at))
            case 1:
                del data[at : at + size]
            case 2:
                data[at:at] = data[at : at + size] * int(rng.integers(1, 50))
            case 3:
                del data[at:]
            case _:
                data[at:at] = bytes(rng.choice(np.frombuffer(b'[]{}",:0-e\\\xff\x00<&', "u1"), size))
    return bytes(data)


def hostile(rng: np.random.Generator, depth: int = 0) -> Any:
    """A message's value that no honest process sends."""
    sizes = [0, 1, 2, 3, 1 << 31, 1 << 62, -1, 10**30]
    match int(rng.integers(0, 11 if depth < 4 else 8)):
        case 0:
            shape = rng.choice(np.array(sizes, object), int(rng.integers(0, 9))).tolist()
            kinds = ["<f8", "<i1", "|b1", "|O8", "<c16", "<f2", ">f4", "<U9", "x"]
            return {
                "!": "array",
                "dtype": str(rng.choice(kinds)),
                "shape": shape,
                "data": "AAAAAAAAAAA="[: 4 * rng.integers(4)],
            }
        case 1:
            return float(rng.choice([np.nan, np.inf, -np.inf, 1e308, 5e-324, 0.0]))
        case 2:
            return rng.choice(np.array([0, -1, 2**62, 2**63, 10**400], object))
        case 3:
            return "".join(map(chr, rng.integers(0, 0xD7FF, int(rng.integers(0, 300))).tolist()))
        case 4:
            return rng.choice(np.array([None, True, "", "array", "TransferFunctionValue"], object))
        case 5:
            return {"!": "complex", "re": hostile(rng, 9), "im": hostile(rng, 9)}
        case 6:
            return {"!": "Unreadable", "kind": hostile(rng, 9)}
        case 7:
            return {"!": str(rng.choice(["", "Verdict", "dict", "FigureValue", "AxesValue", "StateSpaceValue"]))}
        case 8:
            return {"!": "dict", "items": {str(hostile(rng, 9)): hostile(rng, depth + 1) for _ in range(3)}}
        case 9:
            return [hostile(rng, depth + 1) for _ in range(int(rng.integers(0, 6)))]
        case _:
            fields = {
                name: hostile(rng, depth + 1) for name in ("num", "den", "A", "B", "C", "D", "dt", "axes", "curves")
            }
            return {"!": str(rng.choice(["TransferFunctionValue", "StateSpaceValue", "FigureValue"])), **fields}


def values(rng: np.random.Generator, ground: Ground) -> None:
    """What a student's process sends, and what checks make of it."""
    try:
        value = decode(hostile(rng))
    except ChannelError:
        return
    told = redact(value, "t = np.linspace(0, 100, 1001)")
    _noisy_numbers(told)
    readers: list[Callable[[Any], Any]] = [
        lambda it: as_number("t", it), lambda it: as_array("t", it), lambda it: as_vector("t", it),
        lambda it: as_matrix("t", it, (None, 2)), lambda it: as_system("t", it),
    ]  # fmt: skip
    for read in readers:
        try:
            read(told)
        except NoAnswer as nothing:
            one_line(redact_reason(str(nothing), ()))
    one_line(redact_reason(kind_of(told), ()))


def hand_ins(rng: np.random.Generator, ground: Ground) -> None:
    """A notebook, changed as text or as JSON."""
    content = mutate(rng, ground.notebook)
    if rng.integers(0, 2):
        notebook = json.loads(ground.notebook)
        for _ in range(int(rng.integers(1, 10))):
            cell = notebook["cells"][int(rng.integers(0, len(notebook["cells"])))]
            cell[str(rng.choice(["source", "metadata", "cell_type", "id"]))] = hostile(rng)
        content = json.dumps(notebook, default=str).encode(errors="replace")
    folder = ground.folder / "ann" / NAME
    folder.mkdir(parents=True, exist_ok=True)
    (folder / f"{NAME}.ipynb").write_bytes(content)
    submission = read_submission(folder, "ann", ground.template)
    assert submission.status in ("ready", "quarantined"), submission.status
    for note in submission.notes:
        one_line(note)
    code_fingerprints(submission.cells, {cell.id: cell.source for cell in ground.template.cells})
    for cell in submission.cells:
        prose_for_notebook(cell.source)


def zips(rng: np.random.Generator, ground: Ground) -> None:
    """Moodle's zip file, with odd names or changed bytes."""
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as archive:
        for _ in range(int(rng.integers(1, 5))):
            name = str(rng.choice(["Ada_1_assignsubmission_file_/", "../", "Eve_1_assignsubmission_file__2_", ""]))
            archive.writestr(name + str(hostile(rng, 9))[:50] + ".ipynb", mutate(rng, ground.notebook[:3000]))
        archive.writestr(f"Ben_2_assignsubmission_file_/{NAME}.ipynb", ground.notebook)
    content = packed.getvalue()
    path = ground.folder / "moodle.zip"
    path.write_bytes(mutate(rng, content) if rng.integers(0, 2) else content)
    with refused_in_one_line():
        for line in collect_submissions(ground.course, path, ground.folder / "submitted"):
            one_line(line)


def downloads(rng: np.random.Generator, ground: Ground) -> None:
    """A zip file in Moodle's zip file, with any method and changed headers: only its own student is affected."""
    methods = [zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED, zipfile.ZIP_BZIP2, zipfile.ZIP_LZMA]
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w") as archive:
        for number in range(int(rng.integers(1, 4))):
            content = mutate(rng, ground.notebook) if rng.integers(0, 2) else bytes(int(rng.integers(0, 10**7)))
            name = f"{str(hostile(rng, 9))[:20]}/{number}{rng.choice(['.ipynb', '.zip', '.csv', ''])}"
            archive.writestr(name, content, int(rng.choice(methods)))
    inner = bytearray(packed.getvalue())
    for _ in range(int(rng.integers(1, 5))):
        signature = [b"PK\x03\x04", b"PK\x01\x02", b"PK\x05\x06"][int(rng.integers(0, 3))]
        at = inner.find(signature) + int(rng.integers(4, 60))
        inner[at : at + 4] = [rng.bytes(4), b"\xff" * 4, bytes(4), b"\xfe\xff\xff\xff"][int(rng.integers(0, 4))]
    path = ground.folder / "moodle.zip"
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr(f"Ada_1_assignsubmission_file_/{NAME}.ipynb", ground.notebook)
        archive.writestr("Eve_2_assignsubmission_file_/hand-in.zip", bytes(inner))
        archive.writestr("Eve_2_assignsubmission_file_/two.zip", mutate(rng, bytes(inner)))
        archive.writestr(f"Zoe_3_assignsubmission_file_/{NAME}.ipynb", ground.notebook)
    shutil.rmtree(ground.folder / "submitted", ignore_errors=True)
    lines = list(collect_submissions(ground.course, path, ground.folder / "submitted"))
    for line in lines:
        one_line(line)
    assert (lines[0], lines[2]) == (f"1 (Ada): {NAME}", f"3 (Zoe): {NAME}"), lines
    assert lines[1].startswith("2 (Eve): "), lines


def records(rng: np.random.Generator, ground: Ground) -> None:
    """A record of MATLAB or as text, with changed bytes."""
    suffix = str(rng.choice(sorted(ground.records)))
    path = ground.folder / f"record{suffix}"
    path.write_bytes(mutate(rng, ground.records[suffix]))
    with refused_in_one_line():
        load_record(path)


def texts(rng: np.random.Generator, ground: Ground) -> None:
    """A log as text in one of several forms, with changed bytes, and read with some options."""
    form = str(rng.choice(sorted(ground.texts)))
    path = ground.folder / "log.csv"
    path.write_bytes(mutate(rng, ground.texts[form]))
    options: dict[str, Any] = {
        "columns": rng.choice(np.array([None, "1,2,3", "u,y", "2,3"], object)),
        "Ts": rng.choice(np.array([None, 0.1], object)),
        "time_unit": rng.choice(np.array([None, "ms", "days"], object)),
        "repeated": rng.choice(np.array([None, "first", "last"], object)),
        "select": rng.choice(np.array([None, 1, 2], object)),
        "since": rng.choice(np.array([None, 1.0], object)),
        "decimate": rng.choice(np.array([None, 2], object)),
    }
    if options["Ts"] is None:
        options["resample"] = rng.choice(np.array([None, 0.2], object))
    with refused_in_one_line():
        load_record(path, **options)
    with refused_in_one_line():
        describe_columns(path)


def arrays(rng: np.random.Generator, ground: Ground) -> None:
    """Arrays of numpy with changed bytes."""
    name = str(rng.choice(sorted(ground.arrays)))
    path = ground.folder / name
    path.write_bytes(mutate(rng, ground.arrays[name]))
    with refused_in_one_line():
        load_record(path)


def logs(rng: np.random.Generator, ground: Ground) -> None:
    """A file that a library reads, with changed bytes; the process that reads it may die, this one may not."""
    name = str(rng.choice(sorted(ground.logs)))
    path = ground.folder / name
    path.write_bytes(mutate(rng, ground.logs[name]))
    columns = {"a.mcap": "/rig.u,/rig.y", "a.bag": "/u.data,/y.data", "b.mcap": "/state.u,/state.y[1]"}.get(name)
    with refused_in_one_line():
        load_record(path, columns=columns)


def models(rng: np.random.Generator, ground: Ground) -> None:
    """A model for ``--sim``, with changed entries or bytes."""
    model: dict[str, Any] = {"num": [0.01], "den": [1.0, -1.4, 0.45], "dt": 0.75}
    if rng.integers(0, 2):
        model[str(rng.choice([*model, "schema", "extra"]))] = hostile(rng)
    content = json.dumps(model, default=str).encode(errors="replace")
    path = ground.folder / "model.json"
    path.write_bytes(mutate(rng, content) if rng.integers(0, 2) else content)
    with refused_in_one_line():
        replay(path, ground.record)


_CASES = (values, hand_ins, zips, downloads, records, texts, arrays, logs, models)
KINDS: dict[str, Case] = {one.__name__: one for one in _CASES}


def one_line(text: str) -> None:
    assert "\n" not in text, f"more than one line: {text[:200]!r}"
    assert len(text) < MAX_LINE, f"{len(text)} characters"


@contextmanager
def refused_in_one_line() -> Iterator[None]:
    try:
        yield
    except (ValueError, OSError) as error:
        one_line(" ".join(str(error).split()))


class CaseTimeout(BaseException):
    """A case takes too long; what is tested catches every `Exception` of a parser."""


@contextmanager
def time_limit(seconds: int) -> Iterator[None]:
    """Raise `CaseTimeout` after some seconds, where the system has alarms."""

    def stop(*_: object) -> None:
        raise CaseTimeout(f"longer than {seconds} s")

    if not hasattr(signal, "SIGALRM"):
        yield
        return
    before = signal.signal(signal.SIGALRM, stop)
    signal.alarm(seconds)
    try:
        yield
    finally:
        signal.alarm(0)
        signal.signal(signal.SIGALRM, before)


def run(kind: str, cases: int, seed: int, ground: Ground) -> list[str]:
    """Run cases with the seeds from `seed` on; returns a line for each that failed."""
    failed = []
    for number in range(seed, seed + cases):
        try:
            with time_limit(SECONDS), np.errstate(all="ignore"):
                KINDS[kind](np.random.default_rng([number, *kind.encode()]), ground)
        except (Exception, CaseTimeout) as error:
            failed.append(f"{kind}, seed {number}: {type(error).__name__}: {str(error)[:300]}")
    return failed


def main() -> int:
    options = argparse.ArgumentParser(description=__doc__)
    options.add_argument("--kind", choices=sorted(KINDS), action="append")
    options.add_argument("--cases", type=int, default=1000)
    options.add_argument("--seed", type=int, default=1)
    chosen = options.parse_args()
    failed: list[str] = []
    with tempfile.TemporaryDirectory() as folder:
        root = Path(folder) / "course"
        for part in (f"notebooks/{NAME}", "data"):
            shutil.copytree(ROOT / part, root / part)
        (root / "autograder").mkdir()
        list(build_course(Course(root)))
        ground = Ground(Course(root), Path(folder))
        for kind in chosen.kind or KINDS:
            cases = chosen.cases if chosen.kind else max(int(chosen.cases * SHARES.get(kind, 1)), 1)
            start = time.monotonic()
            found = run(kind, cases, chosen.seed, ground)
            print(f"{kind}: {cases} cases, {len(found)} failed, {time.monotonic() - start:.0f} s", flush=True)
            failed += found
    print("\n".join(failed))
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
