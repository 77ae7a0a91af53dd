"""Folders of the course, order of its assignments, and the cells of its released notebooks."""

import json
from collections.abc import Collection, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import nbformat

from labsid.checks.cells import Template, template_of
from labsid.checks.timetable import in_course_order

RECORD_FILE = "SysIdenData_StudentVersion.mat"

SETTINGS_FILE = "course.toml"
"""The settings of a course, in its root."""


@dataclass(frozen=True, slots=True)
class Course:
    """The folders of a course, all below one root.

    Attributes
    ----------
    root : Path
        The checkout, with ``notebooks``, ``autograder`` and ``data``.
    remark : str
        What to say about this choice of course; empty if it is the working folder, with the labsid that runs.
    """

    root: Path
    remark: str = field(default="", compare=False)

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
    def students_file(self) -> Path:
        """Who is who, as decided by ``labsid course release`` when it gave out individual data."""
        return self.root / "autograder" / "students.csv"

    @property
    def record(self) -> Path:
        """The lab's record for students without an individual one."""
        return self.data / RECORD_FILE

    def checks_folder(self, assignment: str) -> Path:
        """The package with the checks of an assignment."""
        return self.root / "labsid" / "checks" / "assignments" / assignment.replace("-", "_")

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


def find_course() -> Course:
    """Find the course: the one in or above the working folder, otherwise the checkout of this package.

    Returns
    -------
    Course
        Its `remark` says which folder it is, if it is not the working folder.

    Raises
    ------
    ValueError
        If there is no course.
    """
    here, own = Path.cwd(), Path(__file__).resolve().parents[2]
    for root in (here, *here.parents, own):
        if (root / "notebooks").is_dir() and (root / "autograder").is_dir():
            return Course(root, " ".join(_remarks(root, here, own)))
    raise ValueError(
        f"no course found: neither {own} nor {here} has the folders 'notebooks' and 'autograder'. "
        "Get a checkout of the course, which the wheel of labsid does not contain, and run this command in it."
    )


def _remarks(root: Path, here: Path, own: Path) -> Iterator[str]:
    """What an instructor may not expect of the course in `root`, seen from the working folder."""
    if root != here:
        yield f"Using the course in {root}: this folder has no folders 'notebooks' and 'autograder'."
        if (here / SETTINGS_FILE).is_file():
            yield f"{SETTINGS_FILE} of this folder is not read."
    if root.resolve() != own and (root / "labsid" / "checks").is_dir():
        yield (
            f"The checks are those of the labsid in {own}, which runs this command, not those of {root / 'labsid'}. "
            f"To use these, run: pip install --editable {root}"
        )


def read_template(course: Course, assignment: str) -> Template:
    """Read the released notebook of an assignment; `ValueError` if the course has not been built."""
    path = course.release / assignment / f"{assignment}.ipynb"
    if not path.is_file():
        raise ValueError(f"{assignment} has not been built ({path} does not exist). Run: labsid course build")
    return template_of(assignment, nbformat.reads(path.read_text(encoding="utf-8"), as_version=4).cells)


def to_json(value: Any) -> str:
    """Format JSON reproducibly: indented, with sorted keys and a final newline."""
    return json.dumps(value, indent=1, sort_keys=True, ensure_ascii=False) + "\n"
