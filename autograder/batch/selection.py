"""Which submissions are graded: the students of a folder, and the assignments that are wanted, or due and handed in."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from autograder.course.layout import Course, read_template
from autograder.intake.submission import NOT_READ_FILE, is_handed_in


@dataclass(frozen=True, slots=True)
class Batch:
    """Submissions to grade.

    Attributes
    ----------
    submitted : Path
    students : tuple of str
    assignments : tuple of str
    ignored : tuple of str
        Folders whose names are not valid Unicode: no gradebook and no table can hold them.
    remarks : tuple of str
        What is not graded, and what few students handed in.
    """

    submitted: Path
    students: tuple[str, ...]
    assignments: tuple[str, ...]
    ignored: tuple[str, ...] = ()
    remarks: tuple[str, ...] = ()


def find_batch(course: Course, submitted: Path, *wanted: str, due: Sequence[str] | None = None) -> Batch:
    """Find the submissions in a folder of nbgrader's layout.

    Parameters
    ----------
    course : Course
    submitted : Path
    *wanted : str
        The assignments to grade. Without them, these are the assignments that a student handed in, and that are due.
    due : sequence of str, optional
        The assignments that are due; without it, all are.

    Raises
    ------
    ValueError
        If the folder does not exist, or contains no submission of these assignments, or two students' folders differ
        only in case.
    """
    if not submitted.is_dir():
        raise ValueError(f"{submitted} is not a folder. Expected <student>/<assignment>/<assignment>.ipynb below it.")
    folders = sorted(path.name for path in submitted.iterdir() if path.is_dir() and not path.name.startswith("."))
    students = [name for name in folders if _is_unicode(name)]
    ignored = [ascii(name)[1:-1] for name in folders if not _is_unicode(name)]
    _refuse_equal_names(submitted, students)
    selected = course.select(wanted)
    if students and wanted:
        return Batch(submitted, tuple(students), tuple(selected), tuple(ignored))
    owners = handed_in_by(course, submitted)
    graded = [name for name, students in owners.items() if students and (due is None or name in due)]
    if not graded:
        if not any(owners.values()):
            expected = "expected <student>/<assignment>/<assignment>.ipynb below it"
            untouched = "; every notebook in it is as released" if owners else ""
            raise ValueError(f"{submitted} holds no submission: {expected}{untouched}.")
        submitted_names = ", ".join(name for name, students in owners.items() if students)
        raise ValueError(
            f"nothing that is due was handed in; {submitted} holds {submitted_names}. Name what to grade: "
            "--assignment NAME"
        )
    remarks = _selection_remarks(owners, graded, due)
    return Batch(submitted, tuple(students), tuple(graded), tuple(ignored), tuple(remarks))


def _refuse_equal_names(submitted: Path, students: Sequence[str]) -> None:
    first: dict[str, str] = {}
    for name in students:
        other = first.setdefault(name.casefold(), name)
        if other != name:
            raise ValueError(
                f"the folders {other} and {name} of {submitted} differ only in upper and lower case. Rename one of "
                "them to the ID of its student."
            )


def handed_in_by(course: Course, submitted: Path) -> dict[str, list[str]]:
    """Students who handed in each assignment, in course order; a notebook as it was released is not a hand-in.

    Parameters
    ----------
    course : Course
    submitted : Path
        ``<student>/<assignment>/<assignment>.ipynb``.

    Returns
    -------
    dict
        By the assignments of which there is a notebook; the list is empty if every notebook is as released.
    """
    folders = [path for path in sorted(submitted.glob("[!.]*")) if path.is_dir() and _is_unicode(path.name)]
    owners: dict[str, list[str]] = {}
    for name in course.assignments():
        places = [folder / name for folder in folders]
        handed_in = [place for place in places if any(place.glob("*.ipynb")) or (place / NOT_READ_FILE).is_file()]
        if handed_in:
            template = read_template(course, name)
            owners[name] = [place.parent.name for place in handed_in if is_handed_in(place, template)]
    return owners


def suggested_assignments(owners: Mapping[str, Sequence[str]]) -> list[str]:
    """The assignments to grade if others were handed in by fewer than half of the students; none if all were."""
    handed_in = {name: found for name, found in owners.items() if found}
    students = len({student for found in handed_in.values() for student in found})
    most = [name for name, found in handed_in.items() if 2 * len(found) >= students]
    return most if len(most) < len(handed_in) else []


def _selection_remarks(
    owners: Mapping[str, Sequence[str]], graded: Sequence[str], due: Sequence[str] | None
) -> Iterator[str]:
    """What is not graded and why; without due dates, also what fewer than half of the students handed in."""
    students = len({student for owners_of in owners.values() for student in owners_of})
    few = [name for name in graded if due is None and 2 * len(owners[name]) < students]
    most = " ".join(f"--assignment {name}" for name in graded if name not in few)
    for name, owners_of in owners.items():
        if not owners_of:
            yield f"{name}: not graded, because every notebook is as released."
        elif name not in graded:
            handed_in = _count(len(owners_of), "student")
            yield f"{name}: not graded, because its due date in course.toml has not passed; {handed_in} handed it in."
        elif name in few:
            only = f" If it is not due, grade only what is: {most}" if most else ""
            given = f"handed in by {len(owners_of)} of {_count(students, 'student')}"
            yield f"{name}: {given}; the others get 0 marks.{only}"
    for name in due or ():
        if name not in owners:
            yield f"{name}: not graded, because nobody handed it in."


def _count(number: int, noun: str) -> str:
    return f"{number} {noun}" if number == 1 else f"{number} {noun}s"


def _is_unicode(name: str) -> bool:
    """Whether a file name is valid UTF-8; Python reads any other bytes as lone surrogates."""
    return not any("\ud800" <= character <= "\udfff" for character in name)
