"""The model solutions for a class: one zip file for everybody, and each student's own where records are individual."""

from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path

from autograder.course.individual_data import individual_file, is_individual
from autograder.course.layout import Course, read_template
from autograder.course.own_secret import shared_file
from autograder.course.release import packages_beside
from autograder.course.settings import read_settings
from autograder.export.solution_notebooks import notebook_bytes, solution_page, solve
from autograder.intake.worksheet import Worksheet, participant_folder, participant_number
from autograder.results.extensions import Extensions
from labsid._files import write_file, zip_bytes
from labsid.checks.notebook import find_assignment

PACKAGE = "my-solutions.zip"
"""Name of each student's file in Moodle."""


@dataclass(frozen=True, slots=True)
class SolutionsPlan:
    """Which solutions are made for whom.

    Attributes
    ----------
    shared : tuple of str
        Assignments that have the same solution for everybody.
    individual : tuple of str
        Assignments that are solved on each student's own record.
    students : tuple of str
        IDs.
    """

    shared: tuple[str, ...]
    individual: tuple[str, ...]
    students: tuple[str, ...] = ()


def plan_solutions(names: Sequence[str], students: Collection[str] | None) -> SolutionsPlan:
    """Sort assignments by whether their record is the student's own.

    Parameters
    ----------
    names : sequence of str
    students : collection of str or None
        IDs, if the course has individual records.
    """
    own = [name for name in names if students is not None and is_individual(find_assignment(name).record_file or "")]
    return SolutionsPlan(
        tuple(name for name in names if name not in own), tuple(own), tuple(students or ()) if own else ()
    )


def require_closed(names: Sequence[str], due: Mapping[str, datetime], extensions: Extensions, now: datetime) -> None:
    """Refuse solutions of assignments on which somebody still works; `ValueError` names them."""
    for name in names:
        if name in due and due[name] > now:
            raise ValueError(f"{name} is not due yet. Give out its solution after that, or add --early.")
        running = [
            f"{student} ({one.text})" for (student, about), one in extensions.items() if about == name and one.due > now
        ]
        if running:
            raise ValueError(
                f"{name}: extensions still run: {', '.join(running)}. Give out its solution after that, or add --early."
            )


def solved_files(
    course: Course,
    plan: SolutionsPlan,
    secret: bytes | None,
    title: str = "",
    jobs: int = 2,
) -> Iterator[tuple[str, str, dict[str, bytes] | str]]:
    """Solve the assignments of a plan; yields student (empty for everybody), assignment, and files or what failed.

    Parameters
    ----------
    course : Course
        Built.
    plan : SolutionsPlan
    secret : bytes or None
        The secret of individual records.
    title : str
        Title of the course.
    jobs : int
        Notebooks that run at a time.
    """
    todo = [("", name) for name in plan.shared]
    todo += [(student, name) for student in plan.students for name in plan.individual]

    rig = read_settings(course).rig

    def one(item: tuple[str, str]) -> tuple[str, str, dict[str, bytes] | str]:
        student, name = item
        file = find_assignment(name).record_file
        try:
            if file is None:
                record = None
            elif student:
                assert secret is not None
                record = individual_file(file, student, secret, rig)
            else:
                record = shared_file(course, file).read_bytes()
            solved = solve(course, name, record)
        except ValueError as error:
            return student, name, str(error)
        page = solution_page(solved, read_template(course, name).title, title)
        stem = f"{name}/{name}-solution"
        return student, name, {f"{stem}.ipynb": notebook_bytes(solved), f"{stem}.html": page.encode()}

    with ThreadPoolExecutor(jobs) as pool:
        yield from pool.map(one, todo)


def write_solutions(
    out: Path, files: Mapping[str, Mapping[str, bytes]], sheet: Worksheet | None, student_of: Callable[[str], str]
) -> list[Path]:
    """Write the solutions; what is made on a student's record goes into this student's package alone.

    Parameters
    ----------
    out : Path
        The zip file for everybody; not written if there is nothing for everybody.
    files : mapping
        Content by path, by student; those for everybody have an empty name.
    sheet : Worksheet or None
        Moodle's grading worksheet; with it, the packages are one zip file in Moodle's layout.
    student_of : callable
        The ID of a participant of the worksheet, by participant number.

    Returns
    -------
    list of Path
        The files and folders that were written.
    """
    written = []
    if files.get(""):
        write_file(out, zip_bytes(files[""]))
        written.append(out)
    own = {student: zip_bytes(content) for student, content in files.items() if student and content}
    beside = packages_beside(out)
    if own and sheet is None:
        beside.mkdir(parents=True, exist_ok=True)
        for student, package in own.items():
            write_file(beside / f"{student}.zip", package)
        written.append(beside)
    elif own and sheet is not None:
        numbers = [(row, number) for row in sheet.rows if (number := participant_number(row)) is not None]
        packages = {
            f"{participant_folder(row)}/{PACKAGE}": own[student_of(number)]
            for row, number in numbers
            if student_of(number) in own
        }
        write_file(beside.with_suffix(".zip"), zip_bytes(packages))
        written.append(beside.with_suffix(".zip"))
    return written
