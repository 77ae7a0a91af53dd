"""What the commands share: the course they work on, its settings, remarks on stderr, and progress bars."""

import sys
from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING, TypeVar

if TYPE_CHECKING:
    from autograder.course.layout import Course
    from autograder.course.settings import CourseSettings

Item = TypeVar("Item")


def open_course() -> "Course":
    """The course that the commands work on; says on stderr which it is, if it is not the working folder."""
    from autograder.course.layout import find_course

    found = find_course()
    if found.remark:
        warn(found.remark)
    return found


def open_course_if_any() -> "tuple[Course | None, CourseSettings]":
    """The course and its settings; None and the defaults outside of a course, for commands that do not need one."""
    from autograder.course.settings import CourseSettings, read_settings

    try:
        here = open_course()
    except ValueError:
        return None, CourseSettings()
    return here, read_settings(here)


def warn(line: str) -> None:
    """Print a line on stderr."""
    print(line, file=sys.stderr)


def progress(items: Iterable[Item], total: int | None, what: str) -> Iterator[Item]:
    """Yield the items with a progress bar on stderr; without one if stderr is not a terminal."""
    from rich.console import Console
    from rich.progress import track

    console = Console(stderr=True)
    if not console.is_terminal:
        yield from items
        return
    yield from track(items, description=what, total=total, console=console, transient=True)
