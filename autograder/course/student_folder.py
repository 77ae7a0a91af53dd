"""The student's work folder: copy the release into it, and pack its notebooks for hand-in."""

import json
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

from autograder.course.archive import zip_bytes
from autograder.course.build import CODE_STUB, TEXT_STUB, build_course
from autograder.course.layout import Course, read_cell
from labsid._files import write_file
from labsid.checks.notebook import assignment_names, load_assignment

_MAX_RECORD_BYTES = 16 * 1024 * 1024
# with the indentation of the release, if the answer is the body of a function
_STUB = re.compile("|".join(r"\n\s*".join(map(re.escape, stub.splitlines())) for stub in (CODE_STUB, TEXT_STUB)))


def copy_release(course: Course, folder: Path) -> Iterator[str]:
    """Copy the release into a work folder; existing files are kept.

    Parameters
    ----------
    course : Course
        Built first if necessary.
    folder : Path
        The work folder; created if necessary.

    Yields
    ------
    str
        A line for each assignment.
    """
    if folder.exists() and not folder.is_dir():
        raise ValueError(f"{folder} is a file; give --folder another name.")
    names = course.assignments()
    if not all((course.release / name / f"{name}.ipynb").is_file() for name in names):
        yield "Building the notebooks (once) ..."
        list(build_course(course))
    for name in names:
        kept, copied = [], []
        for file in sorted((course.release / name).glob("[!.]*.*")):
            target = folder / name / file.name
            if target.exists():
                kept.append(file.name)
                continue
            target.parent.mkdir(parents=True, exist_ok=True)
            write_file(target, file.read_bytes())
            copied.append(file.name)
        parts = [f"new: {', '.join(copied)}"] if copied else []
        parts += [f"kept: {', '.join(kept)}"] if kept else []
        yield f"{name}: {'; '.join(parts)}"


def open_jupyterlab(folder: Path) -> None:
    """Open JupyterLab in the work folder and wait until it is closed; `ValueError` if it is not installed."""
    from importlib.util import find_spec

    if find_spec("jupyterlab") is None:
        raise ValueError('JupyterLab is not installed. Run: pip install "labsid[notebooks]"')
    try:
        subprocess.run([sys.executable, "-m", "jupyterlab", str(folder)], check=False)
    except KeyboardInterrupt:
        print(f"JupyterLab closed. Your work is in {folder.resolve()}.")


def pack_submission(folder: Path, out: Path) -> Iterator[str]:
    """Check a student's notebooks and zip them for hand-in.

    Parameters
    ----------
    folder : Path
        The work folder.
    out : Path
        The zip file, written atomically.

    Yields
    ------
    str
        A line for each notebook, with its unanswered questions.

    Raises
    ------
    ValueError
        If a notebook cannot be read, or there is none; the zip file is not written then.
    """
    found = sorted(path for path in folder.glob("[!.]*/[!.]*.ipynb") if path.is_file())
    notebooks = [path for path in found if path.stem == path.parent.name]
    if not notebooks:
        raise ValueError(f"{folder} contains no notebooks. Expected <assignment>/<assignment>.ipynb below it.")
    files: dict[str, bytes] = {}
    for path in notebooks:
        files[f"{path.stem}/{path.name}"] = data = path.read_bytes()
        yield f"{path.stem}: {_describe(path, data)}"
        record = _record_beside(path)
        if record is not None:
            files[f"{path.stem}/{record.name}"] = record.read_bytes()
    for path in found:
        if path not in notebooks:
            expected = f"{path.parent.name}.ipynb"
            yield f"{path.parent.name}/{path.name} is not included: the notebook of this folder is {expected}"
    write_file(out, zip_bytes(files))
    yield f"Hand in this file: {out}"


def _record_beside(notebook: Path) -> Path | None:
    """The data file beside a notebook; it is handed in to show on which record the notebook was made."""
    name = load_assignment(notebook.stem).record_file if notebook.stem in assignment_names() else None
    path = notebook.parent / (name or "")
    return path if name is not None and path.is_file() and path.stat().st_size <= _MAX_RECORD_BYTES else None


def _describe(path: Path, data: bytes) -> str:
    """Describe which answers a notebook contains; `ValueError` if it is not a notebook."""
    try:
        cells = json.loads(data)["cells"]
        known = [read_cell({**cell, "source": "".join(cell["source"])}) for cell in cells]
    except (ValueError, KeyError, TypeError, AttributeError, ArithmeticError, RecursionError) as error:
        raise ValueError(
            f"{path} is not a readable notebook ({type(error).__name__}). Open it in JupyterLab and save it again; "
            "if that fails, use your last good copy."
        ) from None
    answers = [cell for cell in known if cell is not None and cell.kind in ("answer", "manual")]
    if not answers:
        raise ValueError(f"{path} contains no cell of the assignment. Hand in the notebook from the release.")
    missing = [cell.id for cell in answers if _STUB.search(cell.source) or not cell.source.strip()]
    if not missing:
        return f"all {len(answers)} questions answered"
    return f"{len(answers) - len(missing)} of {len(answers)} questions answered; not answered: {', '.join(missing)}"
