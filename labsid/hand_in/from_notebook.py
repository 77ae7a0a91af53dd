"""Hand-in and feedback from a cell of the start page, for a hub: the same as ``labsid submit`` in a terminal."""

import subprocess
import sys

_LABSID = "import sys; from labsid.cli.commands import main; sys.exit(main(sys.argv[1:]))"


def submit(assignment: str | None = None) -> None:
    """Hand in the notebooks of this folder as ``labsid submit --yes`` does, and print what it says.

    What is not right yet is handed in, too: it can be handed in again.

    Parameters
    ----------
    assignment : str, optional
        Only this assignment; default all that were changed.
    """
    _run("submit", "--yes", *([] if assignment is None else ["--assignment", assignment]))


def fetch_feedback() -> None:
    """Copy the feedback from the hub beside the notebooks of this folder, as ``labsid feedback`` does."""
    _run("feedback")


def _run(*arguments: str) -> None:
    """Run a command of labsid in a process of its own, as it starts kernels, and print its lines as they come."""
    with subprocess.Popen(
        [sys.executable, "-P", "-c", _LABSID, *arguments, "--folder", "."],
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        encoding="utf-8",
        errors="replace",
    ) as process:
        assert process.stdout is not None
        for line in process.stdout:
            print(line, end="", flush=True)
