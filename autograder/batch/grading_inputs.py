"""What grading needs besides the submission: the checks, the student's record and the files of the work folder.

With a secret for individual data, each student's record and the hidden inputs of functions under test are derived from
HMAC(secret, ID).
"""

import hashlib
import hmac
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from threading import Lock

from autograder.course.individual_data import generator_hash, individual_file, is_individual
from autograder.course.layout import Course
from autograder.course.own_secret import read_own_secret, shared_file
from autograder.course.settings import read_settings
from autograder.course.solutions import hidden_tests, right_functions
from autograder.judge.judging import Assets
from labsid._files import write_file
from labsid.checks.cells import Template
from labsid.checks.notebook import find_assignment
from labsid.checks.question import Origin
from labsid.records.record import load_record
from labsid.rig.switchable.withheld_effects import STAND_IN_STUDENT

_GENERATING = Lock()  # several threads may need the same record


@dataclass(frozen=True, slots=True)
class GradingInputs:
    """What one student's submission of one assignment is graded with.

    Attributes
    ----------
    assets : Assets
        What the judge needs.
    files : mapping
        Files of the student's work folder: path by file name.
    """

    assets: Assets
    files: Mapping[str, Path]


@dataclass(frozen=True, slots=True)
class DataStore:
    """Source of the students' data files.

    Attributes
    ----------
    course : Course
    secret : bytes or None
        The secret of individual records; None if everybody works on the course's own records.
    folder : Path
        Cache of the generated records.
    without_second_record : frozenset of str
        Assignments whose hand-ins are not run on other records.
    """

    course: Course
    secret: bytes | None
    folder: Path
    without_second_record: frozenset[str] = frozenset()

    @property
    def seed(self) -> bytes:
        """Seed of the hidden inputs of functions under test."""
        return read_own_secret(self.course) if self.secret is None else self.secret

    @property
    def shared_origin(self) -> Origin:
        """Origin of the course's own records, used by everybody without an individual one."""
        return Origin(STAND_IN_STUDENT, read_own_secret(self.course))


def inputs_for(data_store: DataStore, template: Template, student: str) -> GradingInputs:
    """Collect what one student's submission of one assignment is graded with.

    Raises
    ------
    ValueError
        If no record can be generated for that student ID.
    """
    assignment = find_assignment(template.assignment)
    functions, tests = right_functions(data_store.course, template), hidden_tests(data_store.course, template)
    if assignment.record_file is None:
        return GradingInputs(Assets(template, assignment, None, data_store.seed, functions=functions, tests=tests), {})
    path = record_path(data_store, assignment.record_file, student)
    origin = data_store.shared_origin if data_store.secret is None else Origin(student, data_store.secret)
    second = template.assignment not in data_store.without_second_record
    assets = Assets(template, assignment, load_record(path), data_store.seed, origin, functions, tests, second)
    return GradingInputs(assets, {assignment.record_file: path})


def record_path(data_store: DataStore, name: str, student: str) -> Path:
    """Path of a student's record, which is generated if it is not in the store yet.

    Parameters
    ----------
    data_store : DataStore
    name : str
        Name of the file beside the notebook.
    student : str

    Raises
    ------
    ValueError
        If no record can be generated for that student ID.
    """
    if data_store.secret is None or not is_individual(name):
        return shared_file(data_store.course, name)
    rig = read_settings(data_store.course).rig
    key = f"{generator_hash(name, rig)}\0{name}\0{student}".encode(errors="surrogatepass")
    stem = hmac.new(data_store.secret, key, hashlib.sha256).hexdigest()[:32]
    path = data_store.folder / f"{stem}{Path(name).suffix}"
    with _GENERATING:
        if not path.is_file():
            path.parent.mkdir(parents=True, exist_ok=True)
            write_file(path, individual_file(name, student, data_store.secret, rig))
    return path


def data_hash(data_store: DataStore, inputs: GradingInputs) -> str:
    """Fingerprint of the data files and of the hidden inputs' seed; it does not reveal the secret."""
    digest = hashlib.sha256(hmac.new(data_store.seed, b"inputs", hashlib.sha256).digest())
    digest.update(b"" if inputs.assets.second_record else b"no second record")
    for name, path in sorted(inputs.files.items()):
        digest.update(name.encode() + b"\0" + hashlib.sha256(path.read_bytes()).digest())
    return digest.hexdigest()
