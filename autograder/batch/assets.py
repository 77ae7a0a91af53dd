"""What grading one student's assignment takes: the checks, the record that this student works on, the work folder.

`inputs_for` is the one place that knows what is a student's own: with the course's secret the record comes from
HMAC(secret, ID), and the inputs on which functions are tried come from the secret too.
"""

import hashlib
import hmac
from collections.abc import Mapping
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from threading import Lock

from autograder.course.layout import RECORD_FILE, Course, Template
from autograder.course.sources import sources_hash
from autograder.judge.judging import Assets
from labsid._files import write_file
from labsid.checks.notebook import load_assignment
from labsid.checks.question import Origin
from labsid.records.record import load_record
from labsid.rig.switchable.withheld_effects import STAND_IN_STUDENT

_MAKING = Lock()  # submissions that are looked at side by side may need one record

PUBLIC_SECRET = b"labsid: inputs of functions under test"
"""Seeds the inputs on which functions are tried in a course that has no secret of its own."""


COURSE_ORIGIN = Origin(STAND_IN_STUDENT, PUBLIC_SECRET)
"""Of the records that everybody works on who has no individual ones."""


@dataclass(frozen=True, slots=True)
class GradingInputs:
    """One student's place for one assignment.

    Attributes
    ----------
    assets : Assets
        What the judge holds.
    files : mapping
        What lies in the student's work folder: path of each file, by its name there.
    """

    assets: Assets
    files: Mapping[str, Path]


@dataclass(frozen=True, slots=True)
class DataStore:
    """Where students' data come from.

    Attributes
    ----------
    course : Course
    secret : bytes or None
        The course's secret; None where everybody works on the course's one record.
    folder : Path
        Keeps the records that were made, so that each is made once.
    """

    course: Course
    secret: bytes | None
    folder: Path

    @property
    def seed(self) -> bytes:
        """Seeds the inputs on which functions are tried."""
        return PUBLIC_SECRET if self.secret is None else self.secret


def inputs_for(data_store: DataStore, template: Template, student: str) -> GradingInputs:
    """Lay out what one student's submission of one assignment is judged with.

    Raises
    ------
    ValueError
        If no record can be made for a student of that ID.
    """
    assignment = load_assignment(template.assignment)
    if assignment.record_file is None:
        return GradingInputs(Assets(template, assignment, None, data_store.seed), {})
    path = record_path(data_store, assignment.record_file, student)
    origin = COURSE_ORIGIN if data_store.secret is None else Origin(student, data_store.secret)
    return GradingInputs(
        Assets(template, assignment, load_record(path), data_store.seed, origin), {assignment.record_file: path}
    )


def record_path(data_store: DataStore, name: str, student: str) -> Path:
    """The file of the record that a student works on, made where it is not there yet.

    Parameters
    ----------
    data_store : DataStore
    name : str
        Name of the file beside the notebook.
    student : str

    Raises
    ------
    ValueError
        If no record can be made for a student of that ID.
    """
    if data_store.secret is None or name not in _MAKERS:
        return data_store.course.data / name
    module, _ = _MAKERS[name]
    key = f"{sources_hash(module, __name__)}\0{name}\0{student}".encode(errors="surrogatepass")
    made = hmac.new(data_store.secret, key, hashlib.sha256).hexdigest()[:32]
    path = data_store.folder / f"{made}{Path(name).suffix}"
    with _MAKING:
        if not path.is_file():
            path.parent.mkdir(parents=True, exist_ok=True)
            write_file(path, individual_file(name, student, data_store.secret))
    return path


def is_individual(name: str) -> bool:
    """Whether the data file of that name can be made for each student."""
    return name in _MAKERS


def individual_file(name: str, student: str, secret: bytes) -> bytes:
    """One student's own data file, as it goes beside the notebook under that name.

    Raises
    ------
    ValueError
        If `student` is no usable ID, or there is no individual file of that name.
    """
    if name not in _MAKERS:
        raise ValueError(f"{name} is the same for everybody; individual are {', '.join(_MAKERS)}.")
    module, function = _MAKERS[name]
    made: bytes = getattr(import_module(module), function)(student, secret)
    return made


def lab_file(student: str, secret: bytes) -> bytes:
    """One student's record of the lab, as ``labsid data make --student ID --secret FILE`` writes it."""
    from labsid.rig import lab_record_bytes, make_lab_record

    return lab_record_bytes(make_lab_record(student, secret))


_MAKERS = {
    RECORD_FILE: (__name__, "lab_file"),
    "WithheldRig.csv": ("labsid.rig.switchable.withheld", "withheld_record_bytes"),
}
"""What makes each individual data file: a function of (student, secret), by the file's name."""


def data_hash(data_store: DataStore, inputs: GradingInputs) -> str:
    """Fingerprint of the data and of the hidden inputs' seed; the secret cannot be had back from it."""
    digest = hashlib.sha256(hmac.new(data_store.seed, b"inputs", hashlib.sha256).digest())
    for name, path in sorted(inputs.files.items()):
        digest.update(name.encode() + b"\0" + hashlib.sha256(path.read_bytes()).digest())
    return digest.hexdigest()
