"""A student's notebooks as they are saved in the work folder."""

import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from labsid.checks.cells import Template, grade_id_of, has_work, is_stub, template_of
from labsid.checks.notebook_file import plain_cells, released_template
from labsid.checks.summary import FAILED, QuestionState, states_of
from labsid.checks.timetable import in_course_order


@dataclass(frozen=True, slots=True)
class SavedNotebook:
    """One notebook of the work folder.

    Attributes
    ----------
    path : Path
    data : bytes
        Its content.
    cells : tuple of mapping
        Its cells, as `plain_cells` reads them.
    template : Template
        The assignment as it was released; as the notebook itself has it, if there is no release on this machine.
    is_released_here : bool
        Whether there is one.
    """

    path: Path
    data: bytes
    cells: tuple[Mapping[str, Any], ...]
    template: Template
    is_released_here: bool

    @property
    def name(self) -> str:
        """Name of the assignment."""
        return self.path.stem

    @property
    def is_untouched(self) -> bool:
        """Whether it is as it was released: no answer changed, and no cell of the student's own."""
        if self.is_released_here:
            return not has_work(((grade_id_of(cell), cell["source"]) for cell in self.cells), self.template)
        own = [cell for cell in self.template.cells if cell.kind in ("answer", "manual")]
        return all(is_stub(cell.source) for cell in own)

    def states(self) -> tuple[QuestionState, ...]:
        """What the checks found when the notebook was last saved."""
        found = {state["question"]: state["state"] for cell in self.cells for state in _outcomes(cell)}
        return states_of(self.template.questions, found, {grade_id_of(cell): cell["source"] for cell in self.cells})


def notebook_paths(folder: Path) -> list[Path]:
    """The notebooks one folder deep, in the order of the course."""
    found = [path for path in folder.glob("[!.]*/[!.]*.ipynb") if path.is_file()]
    return sorted(found, key=lambda path: (in_course_order(path.parent.name), path.name))


def read_saved(path: Path) -> SavedNotebook:
    """Read a notebook of the work folder.

    Raises
    ------
    ValueError
        If it is not a readable notebook, or not one of the course.
    """
    try:
        data = path.read_bytes()
    except OSError as error:
        raise ValueError(
            f"{path} cannot be read ({error.strerror or error}). Check the file and its permissions."
        ) from None
    try:
        cells = plain_cells(json.loads(data))
        own = template_of(path.stem, cells)
    except (ValueError, KeyError, TypeError, AttributeError, ArithmeticError, RecursionError) as error:
        raise ValueError(
            f"{path} is not a readable notebook ({type(error).__name__}). Open it in JupyterLab and save it again; "
            "if that fails, use your last good copy."
        ) from None
    if not any(cell.kind in ("answer", "manual") for cell in own.cells):
        raise ValueError(f"{path} contains no cell of the assignment. Hand in the notebook from the release.")
    released = released_template(path.stem)
    return SavedNotebook(path, data, tuple(cells), released or own, released is not None)


def _outcomes(cell: Mapping[str, Any]) -> Iterator[Mapping[str, str]]:
    """What the checks in a cell found, in its saved outputs."""
    for output in cell.get("outputs") or ():
        found = output.get("metadata", {}).get("labsid")
        if found:
            yield found
        elif output.get("ename") == "CheckFailed":
            yield {"question": grade_id_of(cell), "state": FAILED}
