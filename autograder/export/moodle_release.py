"""Individual packages for students, in the layout of Moodle's "Upload multiple feedback files in a zip"."""

from collections.abc import Mapping, Sequence
from pathlib import Path

from autograder.course.layout import Course
from autograder.course.release import IndividualRelease, individual_files, packages_beside, shared_files
from autograder.course.students import Student, merge_students, read_students, write_students
from autograder.intake.identity import identify
from autograder.intake.worksheet import Worksheet, participant_folder, participant_number
from labsid._files import write_file, zip_bytes

PACKAGE = "my-data.zip"
"""Name of each student's file; its folders are those of the notebooks."""


def write_moodle_release(
    course: Course,
    out: Path,
    secret: bytes,
    sheet: Worksheet,
    students: Sequence[Student] | None = None,
    assignments: Sequence[str] = (),
    due: Mapping[str, str] | None = None,
) -> IndividualRelease:
    """Write each participant's data files, and the release without data for everybody.

    Parameters
    ----------
    course : Course
        Built.
    out : Path
        The zip file for everybody, which has nothing of any student. The packages are written beside it, as
        ``<out>-packages.zip`` with a folder ``Full Name_123456_assignsubmission_file_`` for each participant.
    secret : bytes
    sheet : Worksheet
        Grading worksheet of the Moodle assignment with which the packages are distributed.
    students : sequence of str, optional
        The class; without it, every row of the worksheet is a student.
    assignments : sequence of str, optional
        The assignments to release; default all.
    due : mapping, optional
        When an assignment is due, as text, by its name.

    Returns
    -------
    IndividualRelease

    Raises
    ------
    ValueError
        If no row of the worksheet is a student, the assignments have no data files, the course has not been built, or
        an ID is unusable, or it is not clear who is who; nothing is written then.
    """
    shared = shared_files(course, assignments, due=due, data_come_apart=True)
    table = course.students_file
    known_students = read_students(table) if table.is_file() else []
    who = identify(sheet, merge_students(known_students, students or []))
    listed = None if students is None else {student.id for student in students}
    packages: dict[str, bytes] = {}
    in_worksheet: set[str] = set()
    for row in sheet.rows:
        number = participant_number(row)
        if number is None or (listed is not None and who.students[number].id not in listed):
            continue
        student = who.students[number].id
        in_worksheet.add(student)
        own = individual_files(course, secret, student, assignments)
        if not own:
            raise ValueError(
                "these assignments have no data files; give everybody the same release, without --worksheet."
            )
        packages[f"{participant_folder(row)}/{PACKAGE}"] = zip_bytes(own)
    if not packages:
        raise ValueError(f"{sheet.path} has no row of a student. Check the IDs in the students file.")
    beside = packages_beside(out).with_suffix(".zip")
    write_file(out, zip_bytes(shared))
    write_file(beside, zip_bytes(packages))
    write_students(table, merge_students(known_students, list(who.students.values())))
    remarks = tuple(
        f"{student.id}: not in the worksheet" for student in students or () if student.id not in in_worksheet
    )
    return IndividualRelease(out, beside, len(packages), remarks)
