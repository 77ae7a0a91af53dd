"""The commands for who writes an assignment: ``labsid course new`` and ``labsid course preview``."""

import tempfile
from pathlib import Path
from typing import Annotated

import typer

from autograder.console import open_course, warn


def new_command(
    name: Annotated[str, typer.Argument(metavar="NAME", help="Its name, such as pid-control.")],
) -> None:
    """Write a new assignment with two worked questions: a notebook and its checks, to be replaced by your own."""
    from autograder.course.new_assignment import write_new_assignment

    here = open_course()
    notebook, questions, judges = (path.relative_to(here.root).as_posix() for path in write_new_assignment(here, name))
    print(f"Wrote {notebook}: text, cells and model solutions.")
    print(f"Wrote {questions}: the list of the questions.")
    print(f"Wrote {judges}: the functions that judge them.")
    print("It can be built as it is. Replace the example by your own; notebooks/README.md explains each part.")
    print(f"Next: labsid course build, then labsid course preview --assignment {name}")


def preview_command(
    assignment: Annotated[
        list[str] | None, typer.Option("--assignment", metavar="NAME", help="Only this assignment; may be repeated.")
    ] = None,
    folder: Annotated[Path | None, typer.Option(help="New folder to write to; default a temporary one.")] = None,
    open_lab: Annotated[
        bool, typer.Option("--open/--no-open", help="Open JupyterLab in it; with --no-open it is only written.")
    ] = True,
) -> None:
    """Open the release as a student sees it: its start page in JupyterLab, with the data that all students share."""
    from autograder.course.preview import changed_since_build, write_preview
    from autograder.course.settings import read_settings
    from labsid.hand_in.work_folder import open_jupyterlab

    here = open_course()
    due, wanted = read_settings(here).due_texts(), assignment or []
    target = folder or Path(tempfile.mkdtemp(prefix="labsid-preview-"))
    files = write_preview(here, target, wanted, due)
    for name in changed_since_build(here, wanted):
        warn(f"{name}: its text was changed after the last build. Run: labsid course build")
    print(f"Wrote {len(files)} files to {target}, as a student gets them.", flush=True)
    if open_lab:
        open_jupyterlab(target)
