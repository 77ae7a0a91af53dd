"""The command ``labsid course solutions``: the model solutions for the class, when nobody works on them any more."""

from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from autograder.console import open_course, progress, warn
from autograder.feedback_texts import all_extensions

if TYPE_CHECKING:
    from autograder.course.students import Student
    from autograder.intake.worksheet import Worksheet


def course_solutions(
    out: Annotated[Path, typer.Option(metavar="FILE.zip", help="The zip file for everybody.")],
    assignment: Annotated[
        list[str] | None,
        typer.Option("--assignment", metavar="NAME", help="May be repeated; default those whose due date has passed."),
    ] = None,
    secret: Annotated[
        Path | None, typer.Option(metavar="FILE", help="File with the course's secret, for individual data.")
    ] = None,
    students: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="CSV with id, name and e-mail, or an ID per line; with --secret."),
    ] = None,
    worksheet: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE", help="Moodle's grading worksheet: individual solutions as a zip of feedback files."
        ),
    ] = None,
    jobs: Annotated[int, typer.Option(min=1, help="Notebooks that run at a time.")] = 2,
    early: Annotated[bool, typer.Option("--early", help="Also where the due date or an extension still runs.")] = False,
) -> None:
    """Write the model solutions for students: a notebook with its output, and a page.

    With a secret, those on individual data are written apart, on each student's own record, as FILE-packages.
    """
    from autograder.course.settings import read_settings
    from autograder.course.students import read_students
    from autograder.export.solutions import plan_solutions, require_closed, solved_files, write_solutions
    from autograder.intake.worksheet import read_worksheet
    from autograder.results.extensions import closed_assignments
    from labsid.rig import read_secret

    here = open_course()
    settings, now = read_settings(here), datetime.now(UTC)
    extensions = all_extensions(here, settings)
    closed = closed_assignments(settings.due_dates, extensions, now)
    names = here.select(assignment or sorted(closed)) if assignment or closed else []
    if not names:
        raise ValueError(
            "no due date in course.toml has passed for everybody. Name what to give out: --assignment NAME"
        )
    if not early:
        require_closed(names, settings.due_dates, extensions, now)
    secret, students = secret or settings.secret, students or settings.students
    key = None if secret is None else read_secret(secret)
    sheet = None if worksheet is None else read_worksheet(worksheet)
    listed = None if students is None else read_students(students)
    who = _participants(here.students_file, sheet, listed)
    ids = None if key is None else [student.id for student in listed] if listed is not None else list(who.values())
    plan = plan_solutions(names, ids)
    if plan.individual and not plan.students:
        raise ValueError(f"{plan.individual[0]} has individual data: give --students or --worksheet.")
    files: dict[str, dict[str, bytes]] = {}
    total = len(plan.shared) + len(plan.individual) * len(plan.students)
    for student, name, solved in progress(solved_files(here, plan, key, settings.title, jobs), total, "solving"):
        if isinstance(solved, str):
            warn(f"{name}{f' of {student}' if student else ''}: {solved}")
        else:
            files.setdefault(student, {}).update(solved)
    written = write_solutions(out, files, sheet, lambda number: who.get(number, ""))
    if not written:
        raise ValueError("nothing could be solved, and nothing was written.")
    for path in written:
        own = "" if path == out else " Give nobody the solutions of another: they have the other's data."
        print(f"Wrote {path}: {', '.join(plan.shared if path == out else plan.individual)}.{own}")


def _participants(table: Path, sheet: "Worksheet | None", listed: "list[Student] | None") -> dict[str, str]:
    """The ID of each participant of a worksheet, by participant number."""
    from autograder.course.students import merge_students, read_students
    from autograder.intake.identity import identify

    if sheet is None:
        return {}
    before = read_students(table) if table.is_file() else []
    return {number: one.id for number, one in identify(sheet, merge_students(before, listed or [])).students.items()}
