"""The commands of students: ``labsid lab`` and ``labsid submit``."""

from collections.abc import Callable
from pathlib import Path
from typing import Annotated

import typer

Folder = Annotated[
    Path | None,
    typer.Option(help="Your work folder; by default this one if it has a start page, otherwise labsid-work."),
]


def lab_command(build: Callable[[], object]) -> Callable[..., None]:
    """The command ``lab``; `build` builds the notebooks in a checkout in which they have not been built."""

    def lab(
        folder: Folder = None,
        open_lab: Annotated[bool, typer.Option("--open/--no-open", help="Open JupyterLab in it.")] = True,
    ) -> None:
        """Copy the notebooks into a work folder without overwriting files, and open JupyterLab in it."""
        from labsid.checks.notebook_file import release_folder
        from labsid.hand_in.work_folder import copy_release, default_folder, open_jupyterlab

        release = release_folder()
        if release is None:
            print("Building the notebooks (once) ...")
            build()
            release = release_folder()
        if release is None:
            raise ValueError(
                "the notebooks are not here. Install labsid from the file in the release that you received."
            )
        target = folder or default_folder()
        for line in copy_release(release, target):
            print(line)
        if open_lab:
            open_jupyterlab(target)

    return lab


def submit_command(
    folder: Folder = None,
    out: Annotated[Path, typer.Option(help="The zip file to hand in.")] = Path("hand-in.zip"),
    assignment: Annotated[str | None, typer.Option(metavar="NAME", help="Only this assignment.")] = None,
    yes: Annotated[bool, typer.Option("--yes", help="Write the file even if some questions are not right.")] = False,
) -> None:
    """Run your notebooks from a clean start, show what is right, and zip them for hand-in."""
    from labsid.hand_in.submission_file import (
        find_work,
        open_questions,
        pack,
        run_notebook,
        run_text,
        tries_to_send,
    )
    from labsid.hand_in.work_folder import default_folder

    work = find_work(folder or default_folder(), assignment)
    runs = []
    for notebook in work.to_hand_in:
        print(f"Running {notebook.name} ...", flush=True)
        runs.append(run_notebook(notebook))
        print("\n".join(run_text(notebook, runs[-1])) + "\n")
    for remark in work.remarks:
        print(remark)
    if work.untouched:
        names = ", ".join(notebook.name for notebook in work.untouched)
        print(f"Left out, because they are as they were released: {names}.")
    for name, reason in work.unreadable.items():
        print(f"{name} cannot be handed in: {reason}")
    missing = open_questions(runs)
    if missing and not yes:
        _ask_to_go_on(missing, out)
    tries = tries_to_send(work.to_hand_in)
    for remark in pack(work.to_hand_in, out, tries if tries and _may_send(list(tries)) else None):
        print(remark)
    print(f"Hand in this file: {out} ({', '.join(notebook.name for notebook in work.to_hand_in)})")
    if work.unreadable:
        print(
            f"Not in it, because it cannot be read: {', '.join(work.unreadable)}. Mend it and run this command again."
        )


def _may_send(files: list[str]) -> bool:
    """Whether the student wants to send the tries; nobody is asked, and nothing sent, without a terminal."""
    import sys

    return sys.stdin.isatty() and typer.confirm(
        f"Your tries are kept in {', '.join(files)}. Send them, too? They help to improve the course; no mark and no "
        "decision depends on them, nor on your answer."
    )


def _ask_to_go_on(missing: int, out: Path) -> None:
    import sys

    said = f"{missing} questions are" if missing > 1 else "1 question is"
    if not sys.stdin.isatty():
        raise ValueError(f"{said} not right or not done. {out} was not written; to write it all the same, add --yes.")
    if not typer.confirm(f"{said} not right or not done. Write {out} all the same?"):
        raise ValueError(f"{out} was not written.")
