"""The commands that need Jupyter or nbgrader: ``course`` and ``demo``.

Each command parses its options, calls the package and prints; it imports what it needs when it runs.
"""

from collections import Counter
from datetime import UTC, datetime
from functools import cache
from pathlib import Path
from threading import Thread
from typing import TYPE_CHECKING, Annotated

import typer

from autograder.console import open_course, open_course_if_any, progress, warn
from autograder.export_command import course_export, course_package, course_return
from autograder.feedback_texts import make_feedback_texts
from autograder.rig_command import course_rig
from autograder.solutions_command import course_solutions
from autograder.writing_commands import new_command, preview_command

if TYPE_CHECKING:
    from autograder.course.settings import CourseSettings
    from autograder.course.students import Student
    from autograder.intake.canvas_gradebook import CanvasGradebook
    from autograder.intake.worksheet import Worksheet
    from autograder.results.extensions import Extensions
    from autograder.results.late import LateRules

course = typer.Typer(help="Build the course, grade a class, write feedback and exports.", no_args_is_help=True)
course.command("new")(new_command)

Out = Annotated[Path, typer.Option("--out", help="Folder of the graded class.")]
Solutions = Annotated[
    bool | None,
    typer.Option(
        "--solutions/--no-solutions",
        help="Model answers in the feedback pages; default once an assignment is due for everybody.",
    ),
]
SecretFile = Annotated[
    Path | None, typer.Option("--secret", metavar="FILE", help="File with the course's secret, for individual data.")
]
Assignments = Annotated[
    list[str] | None, typer.Option("--assignment", metavar="NAME", help="Only this assignment; may be repeated.")
]


@course.command("build")
def course_build() -> None:
    """Build notebooks/*.md into autograder/source and autograder/release."""
    from autograder.course.build import build_course
    from autograder.course.own_secret import make_own_secret

    here = open_course()
    if make_own_secret(here):
        print(f"Made {here.secret_file}, the seed of what is withheld from students: a build elsewhere needs a copy.")
    names = list(progress(build_course(here), len(here.assignments()), "building"))
    print(f"Built {len(names)} assignments: {', '.join(names)}.")
    print(f"Release: {here.release}")


course.command("preview")(preview_command)
course.command("rig")(course_rig)


@course.command("release")
def course_release(
    out: Annotated[Path, typer.Option(metavar="FILE.zip", help="The zip file to write.")],
    secret: SecretFile = None,
    students: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="CSV with id, name and e-mail, or an ID per line; with --secret."),
    ] = None,
    assignment: Assignments = None,
    worksheet: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="Moodle's grading worksheet: individual data as a zip of feedback files."),
    ] = None,
) -> None:
    """Write the student release: notebooks, data, labsid and its environment.

    With a secret, FILE.zip has no data; the individual data are written apart, beside it, as FILE-packages.
    """
    from autograder.course.release import write_individual_release, write_release
    from autograder.course.settings import read_settings
    from autograder.course.students import read_students
    from autograder.export.moodle_release import write_moodle_release
    from autograder.intake.worksheet import read_worksheet
    from labsid.rig import read_secret

    here = open_course()
    settings = read_settings(here)
    secret, students = secret or settings.secret, students or settings.students
    if secret is None and worksheet is not None:
        raise ValueError("--worksheet is for individual data: give --secret, too.")
    if secret is None and students is not None and students != settings.students:
        raise ValueError("--secret and --students go together, for individual data. Give both or neither.")
    if secret is not None and students is None and worksheet is None:
        raise ValueError(
            "--secret and --students go together, for individual data. Give both, or --worksheet in place of "
            "--students."
        )
    wanted, due = assignment or [], settings.due_texts()
    if secret is None:
        print(f"Wrote {out}: {len(write_release(here, out, wanted, due))} files.")
        return
    key = read_secret(secret)
    listed = None if students is None else read_students(students)
    if worksheet is None:
        done = write_individual_release(here, out, key, [student.id for student in listed or []], wanted, due)
    else:
        done = write_moodle_release(here, out, key, read_worksheet(worksheet), listed, wanted, due)
    for remark in done.remarks:
        print(remark)
    print(f"Wrote {done.shared}: for everybody, the notebooks, labsid and its environment.")
    if done.packages is None:
        print("These assignments have no data files, so that there are no packages.")
        return
    how = "a zip file for each" if worksheet is None else "for Moodle's 'Upload multiple feedback files in a zip'"
    print(f"Wrote {done.packages}: the data of {done.students} students, {how}. Give nobody the data of another.")


@course.command("collect")
def course_collect(
    hand_ins: Annotated[
        Path,
        typer.Argument(
            metavar="DOWNLOAD",
            help="All submissions: the zip file of Moodle, Canvas or Gradescope, or the folder of a hub.",
        ),
    ],
    out: Annotated[Path, typer.Option(metavar="DIR", help="Receives <student>/<assignment>/<assignment>.ipynb.")],
    worksheet: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="Moodle's grading worksheet or the gradebook of Canvas, for IDs and times."),
    ] = None,
    timezone: Annotated[
        str | None, typer.Option(metavar="ZONE", help="Time zone of the worksheet; default this machine's.")
    ] = None,
    assignment: Assignments = None,
    system: Annotated[
        str | None,
        typer.Option("--from", help="moodle, canvas or gradescope; default the one whose names most files have."),
    ] = None,
) -> None:
    """Extract submissions from the zip file of Moodle, Canvas or Gradescope, or copy them from the folder of a hub."""
    from autograder.batch.selection import handed_in_by, suggested_assignments
    from autograder.course.settings import read_settings, time_zone
    from autograder.intake.canvas_gradebook import is_gradebook, read_gradebook
    from autograder.intake.collect import collect_submissions
    from autograder.intake.other_downloads import SYSTEMS
    from autograder.intake.worksheet import read_worksheet

    if system not in (None, *SYSTEMS):
        raise typer.BadParameter(f"got {system!r}, expected {', '.join(SYSTEMS)}", param_hint="--from")
    here = open_course()
    settings = read_settings(here)
    zone_name = timezone or settings.timezone
    zone = None if zone_name is None else time_zone(zone_name)
    known = _who_is_who(settings, here.students_file)
    sheet: Worksheet | CanvasGradebook | None = None
    if worksheet is not None:
        sheet = read_gradebook(worksheet) if is_gradebook(worksheet) else read_worksheet(worksheet)
    if hand_ins.is_dir():
        if sheet is not None or system is not None:
            raise ValueError(f"{hand_ins} is a folder, of a hub: it goes without --worksheet and --from.")
        from autograder.intake.collect_hub import collect_hub_folder  # not on Windows

        lines = collect_hub_folder(here, hand_ins, out, assignment or (), known)
    else:
        lines = collect_submissions(here, hand_ins, out, sheet, zone, assignment or (), known, system)
    for line in lines:
        print(line)
    owners = handed_in_by(here, out)
    counts = ", ".join(f"{name} {len(students)}" for name, students in owners.items() if students)
    print(f"Handed in, by number of students: {counts or 'nothing'}. A notebook as it was released is not counted.")
    named = assignment or ([] if settings.due_by(datetime.now(UTC)) else suggested_assignments(owners))
    chosen = "".join(f" --assignment {name}" for name in named)
    print(f"Next: labsid course grade --submitted {out} --out OUT{chosen}")


@course.command("grade")
def course_grade(
    submitted: Annotated[Path, typer.Option(help="Submissions: <student>/<assignment>/<assignment>.ipynb.")],
    out: Out,
    assignment: Annotated[
        list[str] | None,
        typer.Option(
            metavar="NAME",
            help="Grade this assignment; may be repeated. Default: what was handed in and, with due dates in "
            "course.toml, is due.",
        ),
    ] = None,
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
    extensions: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="CSV with student, assignment, due: own due dates of single students."),
    ] = None,
    secret: SecretFile = None,
) -> None:
    """Grade a class; a second run grades only new and changed submissions.

    The gradebook is OUT/gradebook.db, or the database that OUT/nbgrader_config.py names in CourseDirectory.db_url.
    """
    from autograder.batch.executors import open_executor
    from autograder.batch.grade import grade_batch
    from autograder.batch.selection import find_batch
    from autograder.course.nbgrader_access import import_nbgrader_api
    from autograder.course.settings import read_settings
    from autograder.course.students import STUDENTS_FILE, write_students
    from autograder.results import gradebook
    from autograder.results.extensions import EXTENSIONS_FILE, extension_remarks, read_extensions, write_extensions
    from autograder.results.late import parse_rules
    from autograder.results.summary import class_table
    from autograder.sandbox.escapes import open_escapes
    from labsid.rig import read_secret

    if isolation not in ("strict", "best", "none"):
        raise typer.BadParameter(f"got {isolation!r}, expected strict, best or none", param_hint="--isolation")
    here = open_course()
    settings = read_settings(here)
    rules = _late_rules(settings) if late is None else parse_rules(late)
    own_dates: Extensions = {}
    if (table := extensions or settings.extensions) is not None:
        own_dates = read_extensions(table, here.assignments(), settings.timezone)
    secret = secret or settings.secret
    key = None if secret is None else read_secret(secret)
    students = _who_is_who(settings, out / STUDENTS_FILE, submitted / STUDENTS_FILE)
    batch = find_batch(here, submitted, *(assignment or ()), due=settings.due_by(datetime.now(UTC)))
    due, now = {**settings.due_dates, **{name: rule.due for name, rule in (rules or {}).items()}}, datetime.now(UTC)
    for line in (*batch.remarks, *extension_remarks(own_dates, batch.students, batch.assignments, due, now)):
        warn(line)
    for name in batch.ignored:
        warn(f"{name}: not graded, because the folder's name is not valid UTF-8. Rename it to the student's ID.")
    Thread(target=import_nbgrader_api, daemon=True).start()  # slow, as is opening the launcher: do both at a time
    total = len(batch.students) * len(batch.assignments)
    try:
        with open_executor(isolation, jobs, scheduler, warn) as executor:
            if open_to_students := open_escapes(executor.level):
                warn(f"NOT ISOLATED: student code runs with limits, but can {'; '.join(open_to_students)}.")
            graded = list(progress(grade_batch(here, batch, out, executor, key, rules, own_dates), total, "grading"))
    except KeyboardInterrupt:
        raise ValueError("interrupted. Finished results are kept; run the same command again to continue.") from None
    gradebook.enter_students(out, students)
    write_extensions(out / EXTENSIONS_FILE, own_dates)
    if students:
        write_students(out / STUDENTS_FILE, students)
    if settings.students is not None:
        listed = list(dict.fromkeys(student.id for student in students))
        absent = [student for student in listed if student not in batch.students]
        if absent:
            warn(f"nothing handed in by {len(absent)} of {len(listed)} students: {', '.join(absent)}")
    fresh = sum(result.fresh for result in graded)
    print(class_table(out))
    for reason, count in Counter(result.reason for result in graded if result.fresh and result.reason != "new").items():
        print(f"graded again, changed {reason}: {count}")
    print(
        f"{fresh} submissions graded, {len(graded) - fresh} unchanged since the last run. Grades: {out / 'grades.csv'}"
    )


@course.command("feedback")
def course_feedback(out: Out, solutions: Solutions = None) -> None:
    """Write OUT/feedback/<student>/<assignment>.html."""
    from autograder.results.feedback import write_feedback

    here, settings = open_course_if_any()
    pages = list(progress(write_feedback(out, make_feedback_texts(here, settings, out, solutions)), None, "feedback"))
    print(f"Wrote {len(pages)} pages below {out / 'feedback'}.")


course.command("return")(course_return)
course.command("export")(course_export)
course.command("package")(course_package)


@course.command("report")
def course_report(out: Out, solutions: Solutions = None) -> None:
    """Write OUT/report.html and the feedback pages to which it links.

    The report shows the distribution of marks, the most costly questions and mistakes, and submissions to review.
    """
    from autograder.results.report import write_report

    here, settings = open_course_if_any()
    print(f"Wrote {write_report(out, make_feedback_texts(here, settings, out, solutions))}.")


course.command("solutions")(course_solutions)


@course.command("mark")
def course_mark(
    out: Out,
    assignment: Annotated[str | None, typer.Option(metavar="NAME", help="Only this assignment.")] = None,
    question: Annotated[str | None, typer.Option(metavar="ID", help="Only this question.")] = None,
    marker: Annotated[
        str | None, typer.Option(metavar="NAME", help="Who marks; default the name of this machine's user.")
    ] = None,
    hide_names: Annotated[
        bool, typer.Option("--hide-names", help="Number the answers, in another order for each question.")
    ] = False,
    port: Annotated[int, typer.Option(min=0, max=65535, help="Port; default any free one.")] = 0,
    open_browser: Annotated[bool, typer.Option("--open/--no-open", help="Open the browser.")] = True,
) -> None:
    """Mark open questions in the browser, on this machine only; Ctrl+C ends it."""
    import getpass
    import webbrowser

    from autograder.course.settings import read_settings
    from autograder.marking.answers import open_questions, with_marks
    from autograder.marking.server import MarkingApp, make_server
    from autograder.results.grades import write_grades

    here = open_course()
    questions = open_questions(out, here, assignment, question)
    values = cache(make_feedback_texts(here, read_settings(here), out, solutions=True).values)
    user = marker or getpass.getuser()
    app = MarkingApp(out, questions, user, lambda: datetime.now(UTC), hide_names=hide_names, values=values)
    server = make_server(app, port)
    address = f"http://127.0.0.1:{server.server_address[1]}/{app.token}/"
    waiting = sum(question.waiting for question in questions)
    print(f"{waiting} answers to mark, in {len(questions)} questions. Open {address}")
    print("Press Ctrl+C to end; every mark is saved at once.", flush=True)
    if open_browser:
        webbrowser.open(address)
    try:
        server.serve_forever()
    except KeyboardInterrupt:
        pass
    finally:
        server.server_close()
        write_grades(out)
    still_waiting = sum(question.waiting for question in with_marks(out, questions))
    print(f"{still_waiting} answers left to mark. Next: labsid course feedback --out {out}")


@course.command("doctor")
def course_doctor(
    json_file: Annotated[Path | None, typer.Option("--json", metavar="FILE", help="Also write JSON.")] = None,
) -> None:
    """Attempt escapes from a student's process at each isolation level on this machine, and report the results."""
    from autograder.sandbox.doctor import attempt_escapes, reports_json, reports_text
    from autograder.sandbox.isolation import LEVELS
    from labsid._files import write_file

    found = list(progress(attempt_escapes(), len(LEVELS), "testing"))
    print(reports_text(found))
    if json_file is not None:
        write_file(json_file, reports_json(found).encode())


def demo(
    out: Annotated[Path, typer.Option(help="Output folder.")] = Path("labsid-demo"),
) -> None:
    """Build the course, grade sample submissions and identify the lab's record, end to end."""
    from autograder.demonstration import run_demo

    run_demo(out, progress)


def _late_rules(settings: "CourseSettings") -> "LateRules | None":
    """The late rules of ``course.toml``; None if it has none."""
    from autograder.results.late import parse_rules

    try:
        return parse_rules(settings.late_rules) if settings.late_rules else None
    except ValueError as error:
        raise ValueError(f"course.toml, late rules: {str(error).removeprefix('--late: ')}") from None


def _who_is_who(settings: "CourseSettings", *tables: Path) -> "list[Student]":
    """The students of the tables that exist and of the course's file; `ValueError` if it is not clear who is who."""
    from autograder.course.students import merge_students, read_students
    from autograder.intake.identity import identify

    lists = [read_students(table) for table in tables if table.is_file()]
    lists += [read_students(settings.students)] if settings.students is not None else []
    students = merge_students(*lists)
    identify(None, students)
    return students
