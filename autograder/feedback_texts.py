"""What the commands put into feedback pages besides results: title, questions, and model answers when they are due."""

from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from autograder.course.layout import Course
    from autograder.course.settings import CourseSettings
    from autograder.results.extensions import Extensions
    from autograder.results.feedback import FeedbackTexts


def make_feedback_texts(
    here: "Course | None", settings: "CourseSettings", out: Path, solutions: bool | None = None
) -> "FeedbackTexts":
    """The texts of the course for the feedback pages; none outside of a course.

    Parameters
    ----------
    here : Course or None
    settings : CourseSettings
    out : Path
        A folder that ``labsid course grade`` wrote.
    solutions : bool, optional
        Whether the pages have model answers; by default those of assignments that nobody works on any more.
    """
    from autograder.batch.right_values import find_right_values
    from autograder.course.questions import read_questions
    from autograder.results.extensions import closed_assignments
    from autograder.results.feedback import FeedbackTexts
    from labsid.rig import read_secret

    if here is None:
        return FeedbackTexts()
    names = here.assignments()
    if solutions is None:
        closed = closed_assignments(settings.due_dates, all_extensions(here, settings, out), datetime.now(UTC))
    else:
        closed = frozenset(names if solutions else ())
    secret = settings.secret if settings.secret is not None and settings.secret.is_file() else None
    key = None if secret is None else read_secret(secret)
    return FeedbackTexts(
        settings.title,
        {name: read_questions(here, name) for name in names},
        closed,
        lambda student, assignment: find_right_values(here, out, key, student, assignment),
    )


def all_extensions(here: "Course", settings: "CourseSettings", out: Path | None = None) -> "Extensions":
    """The extensions in the file of ``course.toml``, and those with which OUT was graded."""
    from autograder.results.extensions import EXTENSIONS_FILE, read_extensions

    tables = [] if out is None else [out / EXTENSIONS_FILE]
    found = [read_extensions(table, here.assignments(), settings.timezone) for table in tables if table.is_file()]
    if settings.extensions is not None:
        found.append(read_extensions(settings.extensions, here.assignments(), settings.timezone))
    return {key: one for table in found for key, one in table.items()}
