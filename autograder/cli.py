"""The groups of the command that need Jupyter or nbgrader: ``course``, ``lab``, ``submit`` and ``demo``.

Thin: parse, call, print. Everything heavy is imported by the command that needs it.
"""

import sys
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Annotated, TypeVar

import typer

Item = TypeVar("Item")

course = typer.Typer(help="Build the course, grade a class, write feedback and exports.", no_args_is_help=True)

Out = Annotated[Path, typer.Option("--out", help="Folder of the graded class.")]


@course.command()
def build() -> None:
    """Build notebooks/*.md into autograder/source and autograder/release."""
    from autograder.build import build_course
    from autograder.course import find_course

    here = find_course()
    names = list(_progress(build_course(here), len(here.assignments()), "building"))
    print(f"Built {len(names)} assignments: {', '.join(names)}.")
    print(f"Release: {here.release}")


@course.command()
def grade(
    submitted: Annotated[Path, typer.Option(help="Submissions: <student>/<assignment>/<assignment>.ipynb.")],
    out: Out,
    assignment: Annotated[str | None, typer.Option(help="Grade only this assignment.")] = None,
    jobs: Annotated[int, typer.Option(min=1, help="Submissions at a time.")] = 2,
    isolation: Annotated[str, typer.Option(help="strict, best or none.")] = "best",
) -> None:
    """Grade a class. Run again to grade only what is missing or has changed."""
    from autograder.course import find_course
    from autograder.grade import find_batch, grade_batch
    from autograder.isolation import open_workshop
    from autograder.summary import class_table

    if isolation not in ("strict", "best", "none"):
        raise typer.BadParameter(f"got {isolation!r}, expected strict, best or none", param_hint="--isolation")
    here = find_course()
    batch = find_batch(here, submitted, assignment)
    total = len(batch.students) * len(batch.assignments)
    try:
        with open_workshop(isolation) as workshop:
            if workshop.rung == "none":
                print(
                    "NOT ISOLATED: student code runs in its own process with limits, "
                    "but can read this machine's files.",
                    file=sys.stderr,
                )
            graded = list(_progress(grade_batch(here, batch, out, workshop, jobs), total, "grading"))
    except KeyboardInterrupt:
        raise ValueError("interrupted. What is graded is kept; run the same command again for the rest.") from None
    fresh = sum(one.fresh for one in graded)
    print(class_table(out))
    print(
        f"{fresh} submissions graded, {len(graded) - fresh} unchanged since the last run. Grades: {out / 'grades.csv'}"
    )


@course.command()
def feedback(out: Out) -> None:
    """Write OUT/feedback/<student>/<assignment>.html."""
    from autograder.feedback import write_feedback

    pages = list(_progress(write_feedback(out), None, "feedback"))
    print(f"Wrote {len(pages)} pages below {out / 'feedback'}.")


@course.command()
def export(
    out: Out,
    format: Annotated[str, typer.Option("--format", help="csv.")] = "csv",
) -> None:
    """Export the grades, with what was graded by hand since."""
    from autograder.export import export_csv

    if format != "csv":
        raise typer.BadParameter(f"got {format!r}, expected csv", param_hint="--format")
    print(f"Wrote {export_csv(out)} and {out / 'grades.csv'}.")


def lab(
    folder: Annotated[Path, typer.Option(help="Your work folder.")] = Path("labsid-work"),
    open_lab: Annotated[bool, typer.Option("--open/--no-open", help="Open JupyterLab in it.")] = True,
) -> None:
    """Copy the student release into a work folder, never overwriting work, and open JupyterLab."""
    from autograder.course import find_course
    from autograder.student import copy_release, open_jupyterlab

    for line in copy_release(find_course(), folder):
        print(line)
    if open_lab:
        open_jupyterlab(folder)


def submit(
    folder: Annotated[Path, typer.Option(help="Your work folder.")] = Path("labsid-work"),
    out: Annotated[Path, typer.Option(help="The file to hand in.")] = Path("hand-in.zip"),
) -> None:
    """Check your notebooks and zip them for hand-in."""
    from autograder.student import pack

    for line in pack(folder, out):
        print(line)


def demo(
    out: Annotated[Path, typer.Option(help="Folder for what it makes.")] = Path("labsid-demo"),
) -> None:
    """The main job, end to end, on embedded data."""
    from autograder.demo import run_demo

    run_demo(out, _progress)


def _progress(items: Iterable[Item], total: int | None, what: str) -> Iterator[Item]:
    """Pass items on while showing how far it is; silent where nobody watches."""
    from rich.console import Console
    from rich.progress import track

    console = Console(stderr=True)
    if not console.is_terminal:
        yield from items
        return
    yield from track(items, description=what, total=total, console=console, transient=True)
