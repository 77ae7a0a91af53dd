"""A new assignment: a text notebook and its checks with two worked questions, to be replaced by one's own."""

import keyword
import re
from pathlib import Path

import jinja2

from autograder.course.layout import Course
from labsid._files import write_text

MAX_NAME_CHARACTERS = 40
"""A grade_id, which begins with the name, has at most 64 characters."""

_NAME = re.compile(r"[a-z][a-z0-9]*(-[a-z0-9]+)*")
_TEMPLATES = Path(__file__).parent / "templates"


def write_new_assignment(course: Course, name: str) -> list[Path]:
    """Write the text notebook and the checks of a new assignment.

    It needs nothing else: an assignment that `labsid.checks.timetable` does not list comes after those that it lists.

    Parameters
    ----------
    course : Course
    name : str

    Returns
    -------
    list of Path
        The files: the notebook, the list of its questions, and the functions that judge them.

    Raises
    ------
    ValueError
        If the name is invalid, there is such an assignment, or the course is not a checkout with labsid.
    """
    require_assignment_name(name)
    folder, checks = course.notebooks / name, course.checks_folder(name)
    if not checks.parent.is_dir():
        raise ValueError(
            f"{checks.parent} does not exist: checks are written into labsid. Run this command in a checkout."
        )
    for path in (folder, checks):
        if path.exists():
            raise ValueError(f"there is an assignment {name!r} already ({path} exists). Choose another name.")
    loader = jinja2.FileSystemLoader(_TEMPLATES)
    environment = jinja2.Environment(loader=loader, undefined=jinja2.StrictUndefined, keep_trailing_newline=True)
    values = {"name": name, "package": checks.name, "title": name.replace("-", " ").capitalize()}
    files = {
        folder / f"{name}.md": "notebook.md.j2",
        checks / "__init__.py": "questions.py.j2",
        checks / "first_order.py": "first_order.py.j2",
    }
    for path, template in files.items():
        write_text(path, environment.get_template(template).render(values))
    return list(files)


def require_assignment_name(name: str) -> None:
    """Refuse a name that cannot be that of a folder of notebooks and, with underscores, of a Python package.

    Raises
    ------
    ValueError
        With the rule.
    """
    if not _NAME.fullmatch(name) or keyword.iskeyword(name) or len(name) > MAX_NAME_CHARACTERS:
        raise ValueError(
            f"{name!r} cannot be the name of an assignment. Give lower-case letters, digits and single hyphens, such "
            f"as pid-control: first a letter, at most {MAX_NAME_CHARACTERS} characters, and no keyword of Python."
        )
