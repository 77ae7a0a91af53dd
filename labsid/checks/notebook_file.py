"""The file of the notebook in which a check runs: its cells in order, and the marks that the build wrote into them."""

import json
import os
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from labsid.checks.cells import Template, template_of

START_PAGE = "start.ipynb"
"""The page on which a release opens, beside the folders of the assignments."""


@dataclass(frozen=True, slots=True)
class NotebookFile:
    """A notebook as it was last saved.

    Attributes
    ----------
    template : Template
        Its cells with nbgrader metadata.
    sources : mapping
        The text of every cell by its id, in the order of the notebook.
    saved : float
        When it was saved, in seconds since the epoch.
    """

    template: Template
    sources: Mapping[str, str]
    saved: float

    def position(self, cell_id: str | None) -> int | None:
        """Position of a cell, from 0; None if the file does not contain it."""
        return next((i for i, known in enumerate(self.sources) if known == cell_id), None)


def plain_cells(notebook: Any) -> list[dict[str, Any]]:
    """The cells of a notebook of format 4 as read from JSON, with their source as text.

    Raises
    ------
    ValueError
        If it is not such a notebook.
    """
    cells = notebook.get("cells") if isinstance(notebook, dict) else None
    if not isinstance(cells, list) or not all(isinstance(cell, dict) for cell in cells):
        raise ValueError("it is not a notebook of format 4")
    try:
        return [
            {"cell_type": "raw", "metadata": {}, "id": f"cell-{i}", **cell, "source": "".join(cell["source"])}
            for i, cell in enumerate(cells)
        ]
    except (KeyError, TypeError):
        raise ValueError("one of its cells has no text") from None


def read_notebook(path: Path, assignment: str) -> NotebookFile:
    """Read a saved notebook.

    Raises
    ------
    OSError, ValueError
        If it cannot be read, or is not a notebook.
    """
    saved = path.stat().st_mtime
    cells = plain_cells(json.loads(path.read_text(encoding="utf-8")))
    template = template_of(assignment, cells)
    return NotebookFile(template, {str(cell["id"]): cell["source"] for cell in cells}, saved)


def open_notebook(assignment: str) -> NotebookFile | None:
    """The notebook of the running kernel, if it can be found: by the name that Jupyter gives, or in this folder."""
    paths = [Path(os.environ.get("JPY_SESSION_NAME", "")), Path(f"{assignment}.ipynb")]
    for path in paths:
        try:
            found = read_notebook(path, assignment) if path.is_file() else None
        except (OSError, ValueError, ArithmeticError, RecursionError):  # being saved just now, or damaged
            continue
        if found is not None and found.template.questions:
            return found
    return None


def released_template(assignment: str) -> Template | None:
    """The assignment as it was released, if the release is on this machine."""
    folder = release_folder()
    try:
        return (
            None if folder is None else read_notebook(folder / assignment / f"{assignment}.ipynb", assignment).template
        )
    except (OSError, ValueError):
        return None


def release_folder() -> Path | None:
    """The released notebooks: those in the package that students install, or those that the checkout has built."""
    package = Path(__file__).resolve().parents[1]
    folders = (package / "release", package.parent / "autograder" / "release")
    return next((folder for folder in folders if (folder / START_PAGE).is_file()), None)
