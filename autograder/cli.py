"""The commands that need Jupyter or nbgrader: ``course`` and ``demo``.

Each command parses its options, calls the package and prints; it imports what it needs when it runs.
"""

import sys
from collections import Counter
from collections.abc import Iterable, Iterator
from pathlib import Path
from threading import Thread
from typing import Annotated, TypeVar

import typer

Item = TypeVar("Item")

course = typer.Typer(help="Build the course, grade a class, write feedback and exports.", no_args_is_help=True)

Out = Annotated[Path, typer.Option("--out", help="Folder of the graded class.")]
SecretFile = Annotated[
    Path | None, typer.Option("--secret", metavar="FILE", help="File with the course's secret, for individual data.")
]


@course.command("build")
def course_build() -> None:
    """Build notebooks/*.md into autograder/source and autograder/release."""
    from autograder.course.build import build_course
    from autograder.course.layout import find_course
    from autograder.course.own_secret import make_own_secret

    here = find_course()
    if make_own_secret(here):
        print(f"Made {here.secret_file}, the seed of what is withheld from students: a build elsewhere needs a copy.")
    names = list(_progress(build_course(here), len(here.assignments()), "building"))
    print(f"Built {len(names)} assignments: {', '.join(names)}.")
    print(f"Release: {here.release}")


@course.command("release")
def course_release(
    out: Annotated[Path, typer.Option(metavar="FILE.zip", help="The zip file to write.")],
    secret: SecretFile = None,
    students: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Student IDs, one per line; with --secret.")
    ] = None,
) -> None:
    """Write the student release: notebooks, data, labsid and its environment; with a secret, individual data."""
    from autograder.course.layout import find_course
    from autograder.course.release import read_students, write_individual_releases, write_release
    from labsid.rig import read_secret

    if (secret is None) != (students is None):
        raise ValueError("--secret and --students go together, for individual data. Give both or neither.")
    here = find_course()
    if secret is None or students is None:
        files = write_release(here, out)
    else:
        files = write_individual_releases(here, out, read_secret(secret), read_students(students))
    print(f"Wrote {out}: {len(files)} files.")


@course.command("collect")
def course_collect(
    hand_ins: Annotated[Path, typer.Argument(metavar="MOODLE.zip", help="Zip file of 'Download all submissions'.")],
    out: Annotated[Path, typer.Option(metavar="DIR", help="Receives <student>/<assignment>/<assignment>.ipynb.")],
    worksheet: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="Moodle's grading worksheet, for IDs and times."),
    ] = None,
    timezone: Annotated[
        str | None, typer.Option(metavar="ZONE", help="Time zone of the worksheet; default this machine's.")
    ] = None,
) -> None:
    """Extract submissions from Moodle's zip file."""
    from autograder.course.layout import find_course
    from autograder.intake.collect import collect_submissions
    from autograder.intake.worksheet import read_worksheet
    from autograder.results.late import time_zone

    zone = None if timezone is None else time_zone(timezone)
    sheet = None if worksheet is None else read_worksheet(worksheet)
    for line in collect_submissions(find_course(), hand_ins, out, sheet, zone):
        print(line)
    print(f"Next: labsid course grade --submitted {out} --out OUT")


@course.command("grade")
def course_grade(
    submitted: Annotated[Path, typer.Option(help="Submissions: <student>/<assignment>/<assignment>.ipynb.")],
    out: Out,
    assignment: Annotated[str | None, typer.Option(help="Grade only this assignment.")] = None,
    jobs: Annotated[int, typer.Option(min=1, help="Submissions graded at a time on this machine.")] = 2,
    scheduler: Annotated[
        str | None,
        typer.Option(metavar="ADDRESS", help="Grade on the workers of a Dask scheduler, such as tcp://HOST:8786."),
    ] = None,
    isolation: Annotated[str, typer.Option(help="strict, best or none.")] = "best",
    late: Annotated[
        str | None,
        typer.Option(
            metavar="RULES",
            help="Late rules, such as 'due=2026-11-30T23:59,tz=Australia/Sydney,grace=2h,per-day=10%,most=50%'; "
            "several are separated by ';', each for one assignment as 'lab-identification: due=...'. Lateness counts "
            "from due in started days; percentages are of all marks.",
        ),
    ] = None,
    secret: SecretFile = None,
) -> None:
    """Grade a class; a second run grades only new and changed submissions.

    The gradebook is OUT/gradebook.db, or the database that OUT/nbgrader_config.py names in CourseDirectory.db_url.
    """
    from autograder.batch.executors import open_executor
    from autograder.batch.grade import find_batch, grade_batch
    from autograder.course.layout import find_course
    from autograder.course.nbgrader_access import import_nbgrader_api
    from autograder.results.late import parse_rules
    from autograder.results.summary import class_table
    from autograder.sandbox.escapes import open_escapes
    from labsid.rig import read_secret

    if isolation not in ("strict", "best", "none"):
        raise typer.BadParameter(f"got {isolation!r}, expected strict, best or none", param_hint="--isolation")
    rules = None if late is None else parse_rules(late)
    key = None if secret is None else read_secret(secret)
    here = find_course()
    batch = find_batch(here, submitted, assignment)
    for name in batch.ignored:
        _warn(f"{name}: not graded, because the folder's name is not valid UTF-8. Rename it to the student's ID.")
    Thread(target=import_nbgrader_api, daemon=True).start()  # slow, as is opening the launcher: do both at a time
    total = len(batch.students) * len(batch.assignments)
    try:
        with open_executor(isolation, jobs, scheduler, _warn) as executor:
            if open_to_students := open_escapes(executor.level):
                _warn(f"NOT ISOLATED: student code runs with limits, but can {'; '.join(open_to_students)}.")
            graded = list(_progress(grade_batch(here, batch, out, executor, key, rules), total, "grading"))
    except KeyboardInterrupt:
        raise ValueError("interrupted. Finished results are kept; run the same command again to continue.") from None
    fresh = sum(one.fresh for one in graded)
    print(class_table(out))
    for reason, count in Counter(one.reason for one in graded if one.fresh and one.reason != "new").items():
        print(f"graded again, changed {reason}: {count}")
    print(
        f"{fresh} submissions graded, {len(graded) - fresh} unchanged since the last run. Grades: {out / 'grades.csv'}"
    )


@course.command("feedback")
def course_feedback(out: Out) -> None:
    """Write OUT/feedback/<student>/<assignment>.html."""
    from autograder.results.feedback import write_feedback

    pages = list(_progress(write_feedback(out), None, "feedback"))
    print(f"Wrote {len(pages)} pages below {out / 'feedback'}.")


@course.command("export")
def course_export(
    out: Out,
    format: Annotated[str, typer.Option("--format", help="csv or moodle.")] = "csv",
    worksheet: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Moodle's grading worksheet, as downloaded.")
    ] = None,
    assignment: Annotated[
        str | None, typer.Option(help="Assignment of the worksheet; default all graded assignments, added up.")
    ] = None,
) -> None:
    """Export the grades, including manual grades, as CSV or to Moodle."""
    from autograder.export.grades_csv import export_csv
    from autograder.export.moodle import export_moodle
    from autograder.intake.worksheet import read_worksheet

    if format not in ("csv", "moodle"):
        raise typer.BadParameter(f"got {format!r}, expected csv or moodle", param_hint="--format")
    if format == "csv":
        if worksheet is not None or assignment is not None:
            raise ValueError("--worksheet and --assignment are for --format moodle.")
        print(f"Wrote {export_csv(out)} and {out / 'grades.csv'}.")
        return
    if worksheet is None:
        raise ValueError("--format moodle needs --worksheet: Moodle's offline grading worksheet, as downloaded.")
    done = export_moodle(out, read_worksheet(worksheet), assignment)
    for remark in done.remarks:
        print(remark)
    print(f"Filled in {done.filled} rows. Upload {done.worksheet} and {done.feedback}.")


@course.command("report")
def course_report(out: Out) -> None:
    """Write OUT/report.html: distribution of marks, most costly questions and mistakes, submissions to review."""
    from autograder.results.report import write_report

    print(f"Wrote {write_report(out)}.")


@course.command("doctor")
def course_doctor(
    json_file: Annotated[Path | None, typer.Option("--json", metavar="FILE", help="Also write JSON.")] = None,
) -> None:
    """Attempt escapes from a student's process at each isolation level on this machine, and report the results."""
    from autograder.sandbox.doctor import attempt_escapes, reports_json, reports_text
    from autograder.sandbox.isolation import LEVELS
    from labsid._files import write_file

    found = list(_progress(attempt_escapes(), len(LEVELS), "testing"))
    print(reports_text(found))
    if json_file is not None:
        write_file(json_file, reports_json(found).encode())


def demo(
    out: Annotated[Path, typer.Option(help="Output folder.")] = Path("labsid-demo"),
) -> None:
    """Build the course, grade sample submissions and identify the lab's record, end to end."""
    from autograder.demonstration import run_demo

    run_demo(out, _progress)


def _warn(line: str) -> None:
    print(line, file=sys.stderr)


def _progress(items: Iterable[Item], total: int | None, what: str) -> Iterator[Item]:
    """Yield the items with a progress bar on stderr; without one if stderr is not a terminal."""
    from rich.console import Console
    from rich.progress import track

    console = Console(stderr=True)
    if not console.is_terminal:
        yield from items
        return
    yield from track(items, description=what, total=total, console=console, transient=True)
