"""The cells of a course's notebooks: which are given, which are answers, and how many marks a question carries.

The course's build writes these into the metadata of the cells. Everything that needs the marks reads them from there.
"""

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from decimal import Decimal
from typing import Any

CODE_STUB = "# Your code here\npass"
TEXT_STUB = "*Your answer here*"
HIDDEN_DELIMITERS = ("### BEGIN HIDDEN TESTS", "### END HIDDEN TESTS")
"""nbgrader's, around the tests of a test cell that students do not get."""

# with the indentation of the release, if the answer is the body of a function; `...` stood in earlier releases
_STUB = re.compile(rf"# Your code here\n\s*(pass|\.\.\.)|{re.escape(TEXT_STUB)}")
_FUNCTION = re.compile(r"^def (\w+)\(", re.M)
_CHECK = re.compile(r"\bcheck\(")
_HEADING = re.compile(r"^(#{1,4})\s+(.+)$", re.M)
_LETTERS = {r"\hat\theta": "θ̂", r"\hat{\theta}": "θ̂", r"\theta": "θ", r"\Phi": "Φ", r"\tau": "τ"}


@dataclass(frozen=True, slots=True)
class Cell:
    """One cell of a built notebook with nbgrader metadata.

    Attributes
    ----------
    id : str
        Its grade_id.
    kind : {"given", "demonstration", "answer", "question", "tests", "manual"}
        Locked code; locked code of which grading runs the definitions alone; a student's answer; a question graded
        automatically, by ``check(...)``; one graded by tests of nbgrader in the cell itself; a question graded by hand.
    source : str
        Its text.
    code : bool
        Whether it is a code cell.
    points : Decimal or None
        Points of the question.
    heading : str
        The notebook heading above it.
    part : str
        The heading of the first level above it; the notebook's title if there is no other.
    """

    id: str
    kind: str
    source: str
    code: bool
    points: Decimal | None
    heading: str = ""
    part: str = ""


@dataclass(frozen=True, slots=True)
class Place:
    """One cell of a released notebook, in its place.

    Attributes
    ----------
    cell_id : str
        Its grade_id; empty for a text without one.
    code : bool
    text : str
    """

    cell_id: str
    code: bool
    text: str


@dataclass(frozen=True, slots=True)
class Template:
    """A released assignment, with which submissions are compared.

    Attributes
    ----------
    assignment, title : str
        Its name, and the title of its notebook.
    cells : tuple of Cell
        The cells with nbgrader metadata, in order.
    texts : frozenset of str
        The texts of all other cells, without surrounding blanks.
    places : tuple of Place
        All cells, in order.
    """

    assignment: str
    title: str
    cells: tuple[Cell, ...]
    texts: frozenset[str] = frozenset()
    places: tuple[Place, ...] = ()

    @property
    def questions(self) -> tuple[Cell, ...]:
        """Cells that carry points, in order."""
        return tuple(cell for cell in self.cells if cell.points is not None)


def answer_id(question_id: str) -> str:
    """The grade_id of the answer cell of a question that is graded automatically."""
    return f"{question_id}-answer"


def is_stub(source: str) -> bool:
    """Whether an answer cell is empty, or still contains the text of the release that asks for an answer."""
    return not source.strip() or _STUB.search(source) is not None


def template_of(assignment: str, cells: Iterable[Mapping[str, Any]]) -> Template:
    """The template of an assignment from the cells of its notebook; their source is text, not a list of lines."""
    read_cells: list[Cell] = []
    texts: set[str] = set()
    places: list[Place] = []
    title = heading = part = ""
    for raw in cells:
        for level, text in _HEADING.findall(raw["source"] if raw["cell_type"] == "markdown" else ""):
            heading = _without_mathematics(text.strip())
            if level == "#":
                title, part = title or heading, heading
        cell = read_cell(raw, heading, part)
        if cell is not None:
            read_cells.append(cell)
        else:
            texts.add(raw["source"].strip())
        places.append(Place("" if cell is None else cell.id, raw["cell_type"] == "code", raw["source"]))
    return Template(assignment, title or assignment, tuple(read_cells), frozenset(texts), tuple(places))


def functions_asked_for(template: Template, question_id: str) -> tuple[str, ...]:
    """Names of the functions that the released answer cell of a question begins, for the student to complete."""
    asked = (cell.source for cell in template.cells if cell.id == answer_id(question_id) and is_stub(cell.source))
    return tuple(name for source in asked for name in _FUNCTION.findall(source))


def steps_that_call(template: Template, function: str) -> tuple[str, ...]:
    """Headings of the steps whose given code calls a function of the student's, in order."""
    call = re.compile(rf"(?<!def )\b{re.escape(function)}\(")
    return tuple(dict.fromkeys(cell.heading for cell in template.cells if cell.code and call.search(cell.source)))


def has_work(cells: Iterable[tuple[str, str]], template: Template) -> bool:
    """Whether a notebook has an answer that differs from the released one, or a cell that is not in the release.

    Parameters
    ----------
    cells : iterable of (str, str)
        The grade_id of each cell, empty for one without, and its text.
    template : Template
        The assignment as it was released.

    Returns
    -------
    bool
    """
    released = {cell.id: cell.source.strip() for cell in template.cells}
    own = {cell.id for cell in template.cells if cell.kind in ("answer", "manual")}
    for grade_id, source in cells:
        text = source.strip()
        is_new = grade_id in own if grade_id in released else text not in template.texts
        if text and is_new and text != released.get(grade_id):
            return True
    return False


def read_cell(cell: Mapping[str, Any], heading: str = "", part: str = "") -> Cell | None:
    """Read the nbgrader metadata of a notebook cell; None if it has none."""
    meta = cell.get("metadata", {}).get("nbgrader")
    if not isinstance(meta, dict) or "grade_id" not in meta:
        return None
    grade, solution = bool(meta.get("grade")), bool(meta.get("solution"))
    if grade:
        kind = "manual" if solution else "question" if _CHECK.search(cell["source"]) else "tests"
    elif solution:
        kind = "answer"
    else:
        kind = "demonstration" if "demonstration" in cell["metadata"].get("tags", ()) else "given"
    points = Decimal(str(meta["points"])) if grade else None
    return Cell(str(meta["grade_id"]), kind, str(cell["source"]), cell["cell_type"] == "code", points, heading, part)


def grade_id_of(cell: Mapping[str, Any]) -> str:
    """The grade_id of a cell of a notebook; empty for a cell of the student's own."""
    meta = cell["metadata"].get("nbgrader") if isinstance(cell.get("metadata"), dict) else None
    return str(meta.get("grade_id", "")) if isinstance(meta, dict) else ""


def _without_mathematics(heading: str) -> str:
    """A heading as plain text: ``Build $\\Phi$`` is ``Build Φ``."""
    for mark, letter in _LETTERS.items():
        heading = heading.replace(mark, letter)
    return heading.replace("$", "").replace("`", "").replace("{", "").replace("}", "")
