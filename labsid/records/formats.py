"""The formats of logs: one module each, and the one function that reads any of them."""

import shutil
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, replace
from os import PathLike
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, TypeVar

import numpy as np

from labsid._arrays import FloatArray, freeze
from labsid.records.apart import choose_apart, describe_apart
from labsid.records.choice import Chosen, UnknownColumns, choose
from labsid.records.column import Log
from labsid.records.contents import ColumnSummary, summarize
from labsid.records.library_formats import OBJECTS, LibraryFormat, library_format
from labsid.records.mat_file import is_mat5, open_mat
from labsid.records.numpy_file import NUMPY_MAGIC, open_numpy
from labsid.records.reading import Reading
from labsid.records.several_signals import SeveralSignals, joined, labels_of, units_of
from labsid.records.signals import Signals, without_placeholders
from labsid.records.steps import even_signals, signal_keys, signals_of
from labsid.records.text_file import open_text

AnyRecord = TypeVar("AnyRecord", bound=Any)
_SIGNALS = ("t", "u", "y", "y_measured", "y_noise_reduced", "reference")


@dataclass(frozen=True, slots=True, eq=False)
class RawRecord(SeveralSignals):
    """The signals of a file, not validated: lengths may differ, values may be NaN, times may be out of order.

    Attributes
    ----------
    t : ndarray, shape (Nt,), or None
        Times in seconds; None if the file has none.
    u, y : ndarray, shapes (Nu,) and (Ny,), of several signals (Nu, nu) and (Ny, ny)
        Input and the requested output.
    Ts : float or None
        Sampling time in seconds, as given by the caller.
    y_measured, y_noise_reduced, reference : ndarray or None
        The other columns of a lab record.
    name : str
        File name without folder and suffix.
    notes : tuple of str
        What was assumed and done in reading the file.
    jitter : float
        Root-mean-square deviation of the file's time stamps from `t`, in sampling times.
    units : tuple of str
        Units of inputs and outputs, as the file names them; empty where it does not.
    inputs, outputs : tuple of str
        Names of inputs and outputs.
    labels : tuple of str
        Names of the columns of inputs and outputs; by default `inputs` and `outputs`.
    """

    t: FloatArray | None
    u: FloatArray
    y: FloatArray
    Ts: float | None = None
    y_measured: FloatArray | None = None
    y_noise_reduced: FloatArray | None = None
    reference: FloatArray | None = None
    name: str = ""
    notes: tuple[str, ...] = ()
    jitter: float = 0.0
    units: tuple[str, ...] = ("", "")
    inputs: tuple[str, ...] = ("u",)
    outputs: tuple[str, ...] = ("y",)
    labels: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        freeze(self, **self._present())
        object.__setattr__(self, "units", units_of(self.units, self.signal_names))
        object.__setattr__(self, "labels", labels_of(self.labels, self.signal_names))

    @property
    def columns(self) -> dict[str, FloatArray]:
        """The available columns by name, without the output that equals `y`."""
        present = self._present()
        for name in ("y_measured", "y_noise_reduced"):
            if name in present and np.array_equal(present[name], self.y, equal_nan=True):
                del present[name]
                break
        signals = zip(self.signal_names, (*self.input_columns.T, *self.output_columns.T), strict=True)
        t = {"t": self.t} if self.t is not None else {}
        return t | dict(signals) | {name: x for name, x in present.items() if name not in ("t", "u", "y")}

    def _present(self) -> dict[str, FloatArray]:
        return {name: getattr(self, name) for name in _SIGNALS if getattr(self, name) is not None}


def read_raw(path: str | PathLike[str], how: Reading | None = None) -> RawRecord:
    """Read the signals of a file and bring them to even times where that takes no guess, without validating them.

    Parameters
    ----------
    path : path
        Any of the formats in the table of ``labsid/records/README.md``.
    how : Reading, optional

    Returns
    -------
    RawRecord

    Raises
    ------
    OSError
        If the file cannot be opened.
    ValueError
        If the file does not contain these columns, or is damaged.
    """
    how = how or Reading()
    path = Path(path)
    try:
        with _file_of(path) as file:
            chosen = _chosen(file, how)
            signals = even_signals(without_placeholders(signals_of(chosen, how)), how)
        input_keys, output_keys = signal_keys(chosen)
        inputs, outputs = ({key: signals.values[key] for key in keys} for keys in (input_keys, output_keys))
        values = {key: x for key, x in signals.values.items() if key not in (*input_keys, *output_keys)}
        u, y = _of_equal_length(inputs, signals), _of_equal_length(outputs, signals)
    except UnknownColumns as error:
        raise UnknownColumns(f"{path.name}: {error}") from None
    except ValueError as error:
        raise ValueError(f"{path.name}: {error}") from None
    every = how.decimate or 1
    return RawRecord(
        t=signals.t,
        u=u,
        y=y,
        **values,
        Ts=None if how.Ts is None else how.Ts * every,
        name=path.stem,
        notes=signals.notes,
        jitter=signals.jitter,
        units=tuple(column.unit for column in (*chosen.inputs, *chosen.outputs)),
        inputs=tuple(map(signals.called, inputs)),
        outputs=tuple(map(signals.called, outputs)),
        labels=tuple("" if column.name.isdecimal() else column.name for column in (*chosen.inputs, *chosen.outputs)),
    )


def _of_equal_length(columns: Mapping[str, FloatArray], signals: Signals) -> FloatArray:
    """The columns of u or y side by side."""
    if len({x.size for x in columns.values()}) > 1:
        got = ", ".join(f"{signals.called(key)} has {x.size}" for key, x in columns.items())
        raise ValueError(f"columns must have equal length; {got}. Cut them to the same samples.")
    return np.asarray(joined(list(columns.values())))


def cut_signals(record: AnyRecord, rows: slice | np.ndarray) -> AnyRecord:
    """A record with only these samples of all its signals."""
    present = {name: x for name in _SIGNALS if (x := getattr(record, name)) is not None}
    return replace(record, **{name: x[rows] for name, x in present.items()})


def describe_columns(path: str | PathLike[str]) -> list[ColumnSummary]:
    """Describe each column of a file: name, unit, rate, range, share missing, and what it looks like.

    Raises
    ------
    OSError, ValueError
        As `read_raw`.
    """
    path = Path(path)
    try:
        with _file_of(path) as file:
            log = _open(file, Reading())
            return describe_apart(file, log) if isinstance(log, LibraryFormat) else summarize(log)
    except ValueError as error:
        raise ValueError(f"{path.name}: {error}") from None


@contextmanager
def _file_of(path: Path) -> Iterator[Path]:
    """The file itself, or a copy of what comes out of a pipe: a format is recognised and read by opening it twice."""
    if not path.exists() or path.is_file() or path.is_dir():
        yield path
        return
    with TemporaryDirectory(prefix="labsid-") as folder:
        copy = Path(folder) / path.name
        with path.open("rb") as pipe, copy.open("wb") as file:
            shutil.copyfileobj(pipe, file)
        yield copy


def _chosen(path: Path, how: Reading) -> Chosen:
    log = _open(path, how)
    if isinstance(log, LibraryFormat):
        _refuse_output(how)
        return choose_apart(path, log, how)
    return choose(log, how)


def _open(path: Path, how: Reading) -> Log | LibraryFormat:
    """The log, or its format if a library reads it."""
    kind = library_format(path)
    if kind is not None:
        return kind
    content = path.read_bytes()
    if not content.strip():
        raise ValueError("it is empty: a record needs at least two samples of u and y.")
    if content.startswith((b"# Created by Octave", b"# name:")):
        raise ValueError("it is in the text format of Octave. Save it again with save -v7 FILE.mat t u y.")
    if path.suffix.lower() == ".mat" or is_mat5(content):
        log = open_mat(content, how.output, how.columns is None and how.inputs is None and how.outputs is None)
        return OBJECTS if log is None else log
    _refuse_output(how)
    if content.startswith(NUMPY_MAGIC) or path.suffix.lower() in (".npz", ".npy"):
        return open_numpy(content)
    return open_text(content)


def _refuse_output(how: Reading) -> None:
    if how.output == "measured":
        raise ValueError(
            "output measured chooses between the two outputs of LogData; a text file has one y. "
            "Choose its column with columns (--columns)."
        )
