"""The course's own rig, ``[rig]`` in ``course.toml``: its description, and the records that students get of it.

The records are written in the layout of the lab's file, under its name, with the units of both signals. What is read of
them anywhere, in a notebook, a check or a figure, is as with the tanks.
"""

import hashlib
from dataclasses import dataclass, field
from functools import lru_cache
from pathlib import Path

import numpy as np

from autograder.course.layout import RECORD_FILE
from labsid._files import write_file
from labsid.checks.other_records.rig_model import RigModel, identify_rig, lab_input, make_rig_log, make_student_log
from labsid.records.reading import Reading
from labsid.records.record import read_record
from labsid.records.several_signals import one_signal_each
from labsid.rig.lab.instruments import AVERAGED, noise_reduced
from labsid.rig.lab.log import LabLog, lab_record_bytes, log_to_record

PICTURES = {".png": "image/png", ".jpg": "image/jpeg", ".jpeg": "image/jpeg", ".svg": "image/svg+xml"}
"""Types of a picture, by the end of its name."""

LARGEST_PICTURE = 1_000_000
"""Bytes of a picture, which each notebook of the lab holds."""

_SHARED_SEED = 2016


@dataclass(frozen=True, slots=True)
class Quantity:
    """The input or the output of a rig.

    Attributes
    ----------
    name : str
        A noun: "voltage".
    unit : str
    symbol : str
        In LaTeX; empty without one.
    """

    name: str
    unit: str
    symbol: str = ""

    @property
    def called(self) -> str:
        """Name and symbol in a sentence."""
        return f"{self.name} ${self.symbol}$" if self.symbol else self.name


@dataclass(frozen=True, slots=True)
class OwnRig:
    """The rig of a course.

    Attributes
    ----------
    record : Path
        A log that `labsid.load_record` reads.
    name : str
        In a sentence: "the DC motor".
    sentence : str
        What acts on what.
    input, output : Quantity
    picture : Path or None
        PNG, JPEG or SVG.
    reading : Reading
        How the log is read.
    simulated : bool
        Whether the record that all students share is made with a model that is identified from the log, with the lab's
        staircase for an input.
    """

    record: Path
    name: str
    sentence: str
    input: Quantity
    output: Quantity
    picture: Path | None = None
    reading: Reading = field(default_factory=Reading)
    simulated: bool = False

    @property
    def units(self) -> tuple[str, str]:
        """Units of input and output."""
        return self.input.unit, self.output.unit


def read_rig_log(path: Path, reading: Reading, units: tuple[str, str] = ("", ""), simulated: bool = False) -> LabLog:
    """Read a log of a rig as the record of the lab.

    Parameters
    ----------
    path : Path
    reading : Reading
    units : tuple of str
        Units of input and output; default those of the log.
    simulated : bool
        Whether the record is made with a model that is identified from the log.

    Returns
    -------
    LabLog
        A log with one output gets the lab's noise reduction, the mean of five samples.

    Raises
    ------
    ValueError
        If the log cannot be read, or has several signals, outputs that are missing, or no model.
    OSError
        If there is no such file.
    """
    record = one_signal_each(read_record(path, reading), "the lab")
    if record.missing.any():
        raise ValueError(
            f"{path.name}: {int(record.missing.sum())} samples have no output, which the lab does not deal with. Read "
            "it with --resample SECONDS, or from where there is no gap (--from, --to)."
        )
    own = (units[0] or record.units[0] or "V", units[1] or record.units[1] or "V")
    stem = Path(RECORD_FILE).stem
    if simulated:
        model = identify_rig(record)
        u = lab_input(model, record)
        return make_rig_log(model.settled_at(float(u[0])), u, np.random.SeedSequence(_SHARED_SEED), stem, own)
    measured = record.y if record.y_measured is None else record.y_measured
    reduced = record.y_noise_reduced
    if reduced is None:
        reduced = noise_reduced(measured, np.full(AVERAGED - 1, measured[0]))
    t = np.asarray(record.Ts * np.arange(len(record)), np.float64)
    return LabLog(t, record.u, measured, reduced, record.Ts, stem, own)


def rig_log(rig: OwnRig) -> LabLog:
    """The record that all students of a course share."""
    return read_rig_log(rig.record, rig.reading, rig.units, rig.simulated)


def rig_file(rig: OwnRig, folder: Path) -> Path:
    """Path of that record in the lab's layout, which is written into a folder if it is not there yet."""
    path = folder / rig_fingerprint(rig) / RECORD_FILE
    if not path.is_file():
        path.parent.mkdir(parents=True, exist_ok=True)
        write_file(path, lab_record_bytes(rig_log(rig)))
    return path


def rig_student_file(rig: OwnRig, student: str, secret: bytes) -> bytes:
    """One student's record: of a rig like the measured one, with noise of its kind."""
    log, model = _log_and_model(rig, rig_fingerprint(rig))
    return lab_record_bytes(make_student_log(model, log, student, secret))


def rig_fingerprint(rig: OwnRig) -> str:
    """What the records of a rig follow from: its log, how that is read, and the units."""
    known = repr((rig.reading, rig.units, rig.simulated)).encode()
    return hashlib.sha256(known + b"\0" + rig.record.read_bytes()).hexdigest()[:32]


@lru_cache(maxsize=4)
def _log_and_model(rig: OwnRig, fingerprint: str) -> tuple[LabLog, RigModel]:
    log = rig_log(rig)
    return log, identify_rig(log_to_record(log))
