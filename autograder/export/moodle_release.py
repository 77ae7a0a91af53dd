"""Individual packages for students, in the layout of Moodle's "Upload multiple feedback files in a zip"."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from autograder.course.layout import Course
from autograder.course.release import individual_files, shared_files
from autograder.intake.worksheet import Worksheet, participant_folder, participant_number, possible_ids
from labsid._files import write_file, zip_bytes

PACKAGE = "my-data.zip"
"""Name of each student's file; its folders are those of the notebooks."""


@dataclass(frozen=True, slots=True)
class MoodleRelease:
    """The files written, and remarks for the instructor.

    Attributes
    ----------
    packages : Path
        Zip file to upload as feedback files.
    shared : Path
        Zip file for everybody.
    students : int
        Number of packages.
    remarks : tuple of str
    """

    packages: Path
    shared: Path
    students: int
    remarks: tuple[str, ...]


def write_moodle_release(
    course: Course,
    out: Path,
    secret: bytes,
    sheet: Worksheet,
    students: Sequence[str] | None = None,
    assignments: Sequence[str] = (),
    due: Mapping[str, str] | None = None,
) -> MoodleRelease:
    """Write each participant's data files, and the release without data for everybody.

    Parameters
    ----------
    course : Course
        Built.
    out : Path
        The zip file with a folder ``Full Name_123456_assignsubmission_file_`` for each participant. What is the same
        for everybody is written beside it, as ``<out>-for-everybody.zip``.
    secret : bytes
    sheet : Worksheet
        Grading worksheet of the Moodle assignment with which the packages are distributed.
    students : sequence of str, optional
        IDs; without them, every row of the worksheet is a student, with the ID that ``labsid course collect`` gives.
    assignments : sequence of str, optional
        The assignments to release; default all.
    due : mapping, optional
        When an assignment is due, as text, by its name.

    Returns
    -------
    MoodleRelease

    Raises
    ------
    ValueError
        If no row of the worksheet is a student, the assignments have no data files, the course has not been built, or
        an ID is unusable.
    """
    shared = shared_files(course, assignments, due=due, data_come_apart=True)
    known = None if students is None else {student.casefold(): student for student in students}
    packages: dict[str, bytes] = {}
    found: set[str] = set()
    for row in sheet.rows:
        if participant_number(row) is None:
            continue
        ids = possible_ids(row)
        student = (
            next(ids, None)
            if known is None
            else next((known[i.casefold()] for i in ids if i.casefold() in known), None)
        )
        if student is None:
            continue
        found.add(student)
        own = individual_files(course, secret, student, assignments)
        if not own:
            raise ValueError(
                "these assignments have no data files; give everybody the same release, without --worksheet."
            )
        packages[f"{participant_folder(row)}/{PACKAGE}"] = zip_bytes(own)
    if not packages:
        raise ValueError(f"{sheet.path} has no row of a student. Check the IDs in the students file.")
    beside = out.with_name(f"{out.stem}-for-everybody.zip")
    write_file(beside, zip_bytes(shared))
    write_file(out, zip_bytes(packages))
    remarks = tuple(f"{student}: not in the worksheet" for student in students or () if student not in found)
    return MoodleRelease(out, beside, len(packages), remarks)
