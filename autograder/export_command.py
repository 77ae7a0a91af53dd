"""The commands ``labsid course export``, ``return`` and ``package``: marks and pages for other systems, and checks."""

from pathlib import Path
from typing import Annotated

import typer

from autograder.console import open_course_if_any, warn
from autograder.feedback_texts import make_feedback_texts

FORMATS = ("csv", "moodle", "canvas", "gradescope")


def course_export(
    out: Annotated[Path, typer.Option("--out", help="Folder of the graded class.")],
    format: Annotated[
        str | None,
        typer.Option(
            "--format",
            help="csv, moodle, canvas or gradescope; default csv, with lms in course.toml and --worksheet that one.",
        ),
    ] = None,
    worksheet: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="Moodle's grading worksheet or the gradebook of Canvas, as downloaded."),
    ] = None,
    assignment: Annotated[
        list[str] | None,
        typer.Option(
            metavar="NAME",
            help="Assignment of the worksheet; may be repeated. Default: all graded assignments, added up; in Canvas, "
            "each in its own column.",
        ),
    ] = None,
    column: Annotated[
        str | None,
        typer.Option(metavar="NAME", help="Canvas: the column for the sum of the assignments; default one for each."),
    ] = None,
    scale: Annotated[bool, typer.Option("--scale", help="Convert the marks to the worksheet's maximum.")] = False,
    zero: Annotated[
        bool, typer.Option("--zero", help="Give 0 marks in the rows of the worksheet without a hand-in.")
    ] = False,
    solutions: Annotated[
        bool | None,
        typer.Option(
            "--solutions/--no-solutions",
            help="Model answers in the feedback pages; default once an assignment is due for everybody.",
        ),
    ] = None,
) -> None:
    """Export the grades, including manual grades, as CSV or to Moodle, Canvas or Gradescope."""
    from autograder.export.canvas import export_canvas
    from autograder.export.grades_csv import export_csv
    from autograder.export.gradescope import export_gradescope
    from autograder.export.moodle import export_moodle
    from autograder.intake.canvas_gradebook import read_gradebook
    from autograder.intake.worksheet import read_worksheet

    here, settings = open_course_if_any()
    if format is None:
        format = settings.lms or "csv" if worksheet is not None else "csv"
    if format not in FORMATS:
        raise typer.BadParameter(f"got {format!r}, expected {', '.join(FORMATS)}", param_hint="--format")
    names = assignment or ()
    if column is not None and format != "canvas":
        raise ValueError("--column is for --format canvas.")
    if format == "csv":
        if worksheet is not None or assignment or scale or zero:
            raise ValueError("--worksheet, --assignment, --scale and --zero are for --format moodle and canvas.")
        print(f"Wrote {export_csv(out)} and {out / 'grades.csv'}.")
    elif format == "gradescope":
        if worksheet is not None or scale or zero:
            raise ValueError("--worksheet, --scale and --zero are for --format moodle and canvas.")
        path, remarks = export_gradescope(out, *names)
        _print_all(remarks)
        print(f"Wrote {path}, in the columns of Gradescope's Download Grades.")
    elif format == "canvas":
        if worksheet is None and scale:
            raise ValueError("--scale needs --worksheet: the gradebook of Canvas, as exported, has the points.")
        book = None if worksheet is None else read_gradebook(worksheet)
        filled = export_canvas(out, book, *names, column=column, weights=settings.weights, scale=scale, zero=zero)
        _print_all(filled.remarks)
        print(f"Marks of {filled.filled} students in {', '.join(map(repr, filled.columns))}. Import {filled.path}.")
    else:
        if worksheet is None:
            raise ValueError("--format moodle needs --worksheet: Moodle's offline grading worksheet, as downloaded.")
        sheet, texts = read_worksheet(worksheet), make_feedback_texts(here, settings, out, solutions)
        done = export_moodle(out, sheet, *names, weights=settings.weights, scale=scale, zero=zero, texts=texts)
        _print_all(done.remarks)
        print(f"Filled in {done.filled} rows. Upload {done.worksheet} and {done.feedback}.")


def _print_all(remarks: tuple[str, ...]) -> None:
    for remark in remarks:
        print(remark)


def course_return(out: Annotated[Path, typer.Option("--out", help="Folder of the graded class.")]) -> None:
    """Return the feedback pages on the hub of [hub] in course.toml: each to its student alone."""
    from autograder.export.hub_feedback import return_feedback

    _, settings = open_course_if_any()
    if settings.hub is None:
        raise ValueError("course.toml has no table [hub], which says where students of a hub hand in.")
    pages, students = 0, 0
    for remark, done in return_feedback(out, settings.hub):
        pages, students = pages + done, students + (done > 0)
        if remark:
            warn(remark)
    print(f"Returned {pages} pages to {students} students, who fetch them with: labsid feedback")


def course_package(
    out: Annotated[Path, typer.Option(metavar="FILE.zip", help="The zip file to write.")],
    system: Annotated[str, typer.Option("--for", help="gradescope or github.")],
    assignment: Annotated[str, typer.Option("--assignment", metavar="NAME", help="The assignment.")],
) -> None:
    """Write an autograder package for Gradescope or GitHub Classroom: the checks of the notebook, without any secret.

    It can judge what the checks in the notebook can, and says so in each result.
    """
    from autograder.console import open_course
    from autograder.course.settings import read_settings
    from autograder.export.autograder_package import write_package

    here = open_course()
    is_individual = read_settings(here).secret is not None
    files = write_package(here, out, system, assignment, is_individual)
    print(f"Wrote {out}: {len(files)} files, with nothing that students do not have.")
    if is_individual:
        print("The data are individual: each hand-in needs the student's data file beside the notebook.")
    if system == "gradescope":
        print("In Gradescope, upload it under Configure Autograder, with a base image that has Python 3.11 to 3.13.")
    else:
        print("Unpack it in the template repository of the assignment, beside the notebook, and commit it.")
