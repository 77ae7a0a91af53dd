"""The commands of students: ``labsid lab``, ``labsid submit`` and ``labsid feedback``."""

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

if TYPE_CHECKING:
    from labsid.hand_in.hub import Hub
    from labsid.hand_in.saved_work import SavedNotebook

Folder = Annotated[
    Path | None,
    typer.Option(help="Your work folder; by default this one if it has a start page, otherwise labsid-work."),
]

_OUT = Path("hand-in.zip")


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
    out: Annotated[
        Path | None,
        typer.Option(help="The zip file to hand in; default hand-in.zip or, on a hub, the folder of the course."),
    ] = None,
    assignment: Annotated[str | None, typer.Option(metavar="NAME", help="Only this assignment.")] = None,
    yes: Annotated[bool, typer.Option("--yes", help="Write the file even if some questions are not right.")] = False,
) -> None:
    """Run your notebooks from a clean start, show what is right, and hand them in: a zip file, or at once on a hub."""
    from labsid.hand_in.hub import read_hub
    from labsid.hand_in.submission_file import (
        find_work,
        open_questions,
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
    hub = read_hub() if out is None else None
    if missing and not yes:
        _ask_to_go_on(missing, None if hub is not None else out or _OUT)
    tries = tries_to_send(work.to_hand_in)
    chosen = tries if tries and _may_send(list(tries)) else None
    if hub is not None:
        _hand_in_on_hub(hub, folder or default_folder(), work.to_hand_in, chosen)
    else:
        _write_zip(work.to_hand_in, out or _OUT, chosen)
    if work.unreadable:
        print(
            f"Not in it, because it cannot be read: {', '.join(work.unreadable)}. Mend it and run this command again."
        )


def _write_zip(notebooks: "Sequence[SavedNotebook]", out: Path, tries: Mapping[str, bytes] | None) -> None:
    from labsid.hand_in.submission_file import pack

    for remark in pack(notebooks, out, tries):
        print(remark)
    print(f"Hand in this file: {out} ({', '.join(notebook.name for notebook in notebooks)})")


def _hand_in_on_hub(
    hub: "Hub", work: Path, notebooks: "Sequence[SavedNotebook]", tries: Mapping[str, bytes] | None
) -> None:
    """Hand in notebooks where the course collects them, and say so."""
    from datetime import UTC, datetime

    from labsid.hand_in.hub import hand_in_with_nbgrader, put_into_folder
    from labsid.hand_in.submission_file import zipped

    names = [notebook.name for notebook in notebooks]
    if hub.hand_in is None:
        print(f"Handed in with nbgrader: {', '.join(hand_in_with_nbgrader(hub, work, names))}. You may do so again.")
        return
    content, remarks = zipped(notebooks, tries)
    for remark in remarks:
        print(remark)
    written = put_into_folder(hub.hand_in, content, datetime.now(UTC))
    print(f"Handed in: {', '.join(names)}, as {written}. You may do so again; of each assignment the last one counts.")


def feedback_command(folder: Folder = None) -> None:
    """Copy your feedback from the hub beside your notebooks."""
    from labsid.hand_in.hub import fetch_from_folder, fetch_with_nbgrader, read_hub
    from labsid.hand_in.saved_work import notebook_paths
    from labsid.hand_in.work_folder import default_folder

    hub, work = read_hub(), folder or default_folder()
    if hub is None:
        raise ValueError("this release says of no hub from which feedback comes. Ask your instructor where it is.")
    names = list(dict.fromkeys(path.parent.name for path in notebook_paths(work) if path.stem == path.parent.name))
    pages = fetch_with_nbgrader(hub, work, names) if hub.hand_in is None else fetch_from_folder(hub.hand_in, work)
    for page in pages:
        print(f"Feedback: {page}")
    if not pages:
        print("There is no new feedback.")


def _may_send(files: list[str]) -> bool:
    """Whether the student wants to send the tries; nobody is asked, and nothing sent, without a terminal."""
    import sys

    return sys.stdin.isatty() and typer.confirm(
        f"Your tries are kept in {', '.join(files)}. Send them, too? They help to improve the course; no mark and no "
        "decision depends on them, nor on your answer."
    )


def _ask_to_go_on(missing: int, out: Path | None) -> None:
    """Ask whether to write a file, or to hand in on a hub, although some questions are not right."""
    import sys

    said = f"{missing} questions are" if missing > 1 else "1 question is"
    nothing = "Nothing was handed in" if out is None else f"{out} was not written"
    act, question = ("hand in", "Hand in") if out is None else ("write it", f"Write {out}")
    if not sys.stdin.isatty():
        raise ValueError(f"{said} not right or not done. {nothing}; to {act} all the same, add --yes.")
    if not typer.confirm(f"{said} not right or not done. {question} all the same?"):
        raise ValueError(f"{nothing}.")
