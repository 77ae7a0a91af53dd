"""Folders of the course, order of its assignments, and the cells of its released notebooks."""

import json
import re
from collections.abc import Collection
from dataclasses import dataclass
from decimal import Decimal
from pathlib import Path
from typing import Any

import nbformat

RECORD_FILE = "SysIdenData_StudentVersion.mat"


@dataclass(frozen=True, slots=True)
class Course:
    """The folders of a course, all below one root.

    Attributes
    ----------
    root : Path
        The checkout, with ``notebooks``, ``autograder`` and ``data``.
    """

    root: Path

    @property
    def notebooks(self) -> Path:
        """The text notebooks, the only source."""
        return self.root / "notebooks"

    @property
    def source(self) -> Path:
        """Built notebooks with solutions."""
        return self.root / "autograder" / "source"

    @property
    def release(self) -> Path:
        """Built notebooks for students."""
        return self.root / "autograder" / "release"

    @property
    def data(self) -> Path:
        """Data files for students without individual ones."""
        return self.root / "data"

    @property
    def secret_file(self) -> Path:
        """The course's own secret, made by the first ``labsid course build``."""
        return self.root / "autograder" / "course-secret"

    @property
    def own_data(self) -> Path:
        """Data files generated from the course's own secret."""
        return self.root / "autograder" / "data"

    @property
    def record(self) -> Path:
        """The lab's record for students without an individual one."""
        return self.data / RECORD_FILE

    def assignments(self) -> list[str]:
        """Names of the assignments, in the order of the course."""
        names = {path.parent.name for path in self.notebooks.glob("*/*.md") if path.stem == path.parent.name}
        return sorted(names, key=in_course_order)

    def select(self, wanted: Collection[str]) -> list[str]:
        """The wanted assignments, all if none is named, in the order of the course; `ValueError` if one is unknown."""
        names = self.assignments()
        unknown = [name for name in wanted if name not in names]
        if unknown:
            raise ValueError(f"there is no assignment {unknown[0]!r}; there are {', '.join(names)}.")
        return [name for name in names if name in wanted] if wanted else names


def in_course_order(assignment: str) -> tuple[int, str]:
    """Sort key for the order in which assignments are taught."""
    return (_ORDER.index(assignment) if assignment in _ORDER else len(_ORDER), assignment)


_ORDER = (
    "prelab-sinusoids",
    "lab-identification",
    "postlab-model-order",
    "step-response",
    "least-squares",
    "model-structures",
    "recursive-identification",
    "armax-and-instruments",
    "nonlinear-least-squares",
    "sim-to-real-gap",
)


def find_course() -> Course:
    """Find the course: the checkout of this package, or the one in or above the working folder.

    Raises
    ------
    ValueError
        If there is no course.
    """
    own = Path(__file__).resolve().parents[2]
    for root in (own, Path.cwd(), *Path.cwd().parents):
        if (root / "notebooks").is_dir() and (root / "autograder").is_dir():
            return Course(root)
    raise ValueError(
        f"no course found: neither {own} nor {Path.cwd()} has the folders 'notebooks' and 'autograder'. "
        "Get a checkout of the course, which the wheel of labsid does not contain, and run this command in it."
    )


@dataclass(frozen=True, slots=True)
class Cell:
    """One cell of a built notebook with nbgrader metadata.

    Attributes
    ----------
    id : str
        Its grade_id.
    kind : {"given", "demonstration", "answer", "question", "manual"}
        Locked code; locked code of which grading runs the definitions alone; a student's answer; a question graded
        automatically; a question graded by hand.
    source : str
        Its text.
    code : bool
        Whether it is a code cell.
    points : Decimal or None
        Points of the question.
    heading : str
        The notebook heading above it.
    """

    id: str
    kind: str
    source: str
    code: bool
    points: Decimal | None
    heading: str = ""


def read_cell(cell: Any, heading: str = "") -> Cell | None:
    """Read the nbgrader metadata of a notebook cell; None if it has none."""
    meta = cell.get("metadata", {}).get("nbgrader")
    if not isinstance(meta, dict) or "grade_id" not in meta:
        return None
    grade, solution = bool(meta.get("grade")), bool(meta.get("solution"))
    if grade:
        kind = "manual" if solution else "question"
    elif solution:
        kind = "answer"
    else:
        kind = "demonstration" if "demonstration" in cell["metadata"].get("tags", ()) else "given"
    points = Decimal(str(meta["points"])) if grade else None
    return Cell(str(meta["grade_id"]), kind, str(cell["source"]), cell["cell_type"] == "code", points, heading)


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
    """

    assignment: str
    title: str
    cells: tuple[Cell, ...]
    texts: frozenset[str] = frozenset()

    @property
    def questions(self) -> tuple[Cell, ...]:
        """Cells that carry points, in order."""
        return tuple(cell for cell in self.cells if cell.points is not None)


def read_template(course: Course, assignment: str) -> Template:
    """Read the released notebook of an assignment; `ValueError` if the course has not been built."""
    path = course.release / assignment / f"{assignment}.ipynb"
    if not path.is_file():
        raise ValueError(f"{assignment} has not been built ({path} does not exist). Run: labsid course build")
    notebook = nbformat.reads(path.read_text(encoding="utf-8"), as_version=4)
    cells: list[Cell] = []
    texts: set[str] = set()
    title = heading = ""
    for raw in notebook.cells:
        for level, text in re.findall(r"^(#{1,4})\s+(.+)$", raw.source if raw.cell_type == "markdown" else "", re.M):
            heading = _without_mathematics(text.strip())
            title = title or (heading if level == "#" else "")
        cell = read_cell(raw, heading)
        if cell is not None:
            cells.append(cell)
        else:
            texts.add(raw.source.strip())
    return Template(assignment, title or assignment, tuple(cells), frozenset(texts))


def _without_mathematics(heading: str) -> str:
    """A heading as plain text: ``Build $\\Phi$`` is ``Build Φ``."""
    for mark, letter in (
        (r"\hat\theta", "θ̂"),
        (r"\hat{\theta}", "θ̂"),
        (r"\theta", "θ"),
        (r"\Phi", "Φ"),
        (r"\tau", "τ"),
    ):
        heading = heading.replace(mark, letter)
    return heading.replace("$", "").replace("`", "").replace("{", "").replace("}", "")


def to_json(value: Any) -> str:
    """Format JSON reproducibly: indented, with sorted keys and a final newline."""
    return json.dumps(value, indent=1, sort_keys=True, ensure_ascii=False) + "\n"
