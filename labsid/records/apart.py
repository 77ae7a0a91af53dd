"""Reading with a library in a process of its own: a damaged file can crash or fill a process, but not this one."""

import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from labsid.records.choice import Chosen, UnknownColumns, choose
from labsid.records.column import Column
from labsid.records.contents import ColumnSummary, summarize
from labsid.records.library_formats import LibraryFormat, open_library_log
from labsid.records.reading import Reading

MEMORY = 2**30  # bytes of data of the process, where the system has limits
SECONDS = 300.0
_KEPT_SIZE = 2**29  # bytes of the columns that come back
_INSTALL = 'pip install "labsid[logs]"'


def choose_apart(path: Path, kind: LibraryFormat, how: Reading) -> Chosen:
    """Open a log in a process of its own and read the columns of a record; see `labsid.records.choice.choose`.

    Raises
    ------
    OSError
        If the file cannot be opened.
    ValueError
        If it is damaged, lacks the columns, or takes too much memory or time.
    """
    with tempfile.TemporaryDirectory(prefix="labsid-") as folder:
        told = _run(path, kind, {"how": asdict(how)}, Path(folder))
        with np.load(Path(folder) / "columns.npz", allow_pickle=False) as arrays:
            read = [
                Column(column["name"], arrays[f"v{k}"], column["unit"], arrays[f"s{k}"] if column["stamped"] else None)
                for k, column in enumerate(told["columns"])
            ]
    t = read.pop(0) if told["timed"] else None
    nu, ny = told["inputs"], told["outputs"]
    inputs, outputs, others = read[:nu], read[nu : nu + ny], read[nu + ny :]
    return Chosen(t, tuple(inputs), tuple(outputs), tuple(others), told["named"], tuple(told["notes"]))


def describe_apart(path: Path, kind: LibraryFormat) -> list[ColumnSummary]:
    """Describe the columns of a log, which a process of its own opens."""
    with tempfile.TemporaryDirectory(prefix="labsid-") as folder:
        return [ColumnSummary(**one) for one in _run(path, kind, {"describe": True}, Path(folder))["summaries"]]


def _run(path: Path, kind: LibraryFormat, task: dict[str, Any], folder: Path) -> dict[str, Any]:
    command = [sys.executable, "-P", "-m", "labsid.records.apart", str(path.absolute()), str(folder)]
    threads = dict.fromkeys(("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"), "1")
    environment = {**os.environ, **threads, "ARROW_DEFAULT_MEMORY_POOL": "system"}
    again = "Copy or download it again"
    again += ", or save it again with save('file.mat', ..., '-v7')." if path.suffix.lower() == ".mat" else "."
    try:
        done = subprocess.run(
            command,
            input=json.dumps(task | {"module": kind.module}).encode(),
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            timeout=SECONDS,
            env=environment,
            check=False,
        )
    except subprocess.TimeoutExpired:
        raise ValueError(f"reading this {kind.title} took over {SECONDS:g} s. Cut it to what is needed.") from None
    try:
        told: dict[str, Any] = json.loads((folder / "told.json").read_text(encoding="utf-8"))
    except (OSError, ValueError):
        raise ValueError(
            f"it is damaged, or too large: reading it as {kind.title} ended the reader (status {done.returncode}). "
            f"{again}"
        ) from None
    if "missing" in told:
        raise ValueError(f"{kind.title}: reading it needs the package {told['missing']}. Install it: {_INSTALL}")
    if "unknown" in told:
        raise UnknownColumns(told["unknown"])
    if "error" in told:
        raise ValueError(told["error"])
    if "damage" in told:
        raise ValueError(f"it cannot be read as {kind.title} ({told['damage']}): it is cut off or damaged. {again}")
    return told


def _answer(path: Path, task: dict[str, Any], folder: Path) -> dict[str, Any]:
    log = open_library_log(path, task["module"])
    if "describe" in task:
        return {"summaries": [asdict(summary) for summary in summarize(log)]}
    chosen = choose(log, Reading(**task["how"]))
    signals = (*chosen.inputs, *chosen.outputs, *chosen.others)
    columns = signals if chosen.t is None else (chosen.t, *signals)
    arrays = {f"v{k}": column.values for k, column in enumerate(columns)}
    arrays |= {f"s{k}": column.stamps for k, column in enumerate(columns) if column.stamps is not None}
    if sum(array.nbytes for array in arrays.values()) > _KEPT_SIZE:
        raise ValueError(f"its columns are over {_KEPT_SIZE // 2**20} MB. Cut the log to what is needed.")
    np.savez(folder / "columns.npz", **arrays)  # type: ignore[arg-type]
    return {
        "columns": [
            {"name": column.name, "unit": column.unit, "stamped": column.stamps is not None} for column in columns
        ],
        "timed": chosen.t is not None,
        "inputs": len(chosen.inputs),
        "outputs": len(chosen.outputs),
        "named": chosen.named,
        "notes": chosen.notes,
    }


def main(arguments: Sequence[str]) -> None:
    """Read one log and write what it holds into a folder; errors become one line of ``told.json``."""
    path, folder = Path(arguments[0]), Path(arguments[1])
    task = json.load(sys.stdin)
    told: dict[str, Any]
    try:
        _limit_memory()
        told = _answer(path, task, folder)
    except ModuleNotFoundError as error:
        told = {"missing": str(error.name)}
    except UnknownColumns as error:
        told = {"unknown": str(error)}
    except ValueError as error:
        told = {"error" if _is_own(error) else "damage": _line(error)}
    except MemoryError:
        told = {"error": f"it needs more than {MEMORY // 2**20} MB to read. Cut it to what is needed."}
    except Exception as error:
        told = {"damage": _line(error)}
    (folder / "told.json").write_text(json.dumps(told), encoding="utf-8")


def _is_own(error: BaseException) -> bool:
    """Whether an error was raised by a module of this package, and not within a library."""
    trace = error.__traceback__
    assert trace is not None
    while trace.tb_next is not None:
        trace = trace.tb_next
    return str(trace.tb_frame.f_globals.get("__name__", "")).startswith(("labsid.", "__main__"))


def _line(error: BaseException) -> str:
    return " ".join(f"{error}".split())[:300] or type(error).__name__


def _limit_memory() -> None:
    try:
        import resource
    except ImportError:  # Windows
        return
    for kind in (resource.RLIMIT_DATA, resource.RLIMIT_CORE):
        limit = MEMORY if kind == resource.RLIMIT_DATA else 0
        _, hard = resource.getrlimit(kind)
        if hard == resource.RLIM_INFINITY or limit <= hard:
            resource.setrlimit(kind, (limit, hard))


if __name__ == "__main__":
    main(sys.argv[1:])
