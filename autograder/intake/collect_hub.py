"""Collect hand-ins from a shared folder of a hub, or from the inbound folder of nbgrader's exchange."""

import tempfile
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from pathlib import Path

from autograder.course.archive import MAX_FILE_BYTES, Budget, Pool
from autograder.course.layout import Course, read_template
from autograder.course.plain_text import one_line
from autograder.course.students import STUDENTS_FILE, Student, merge_students, read_students, write_students
from autograder.intake.collect import MOST, POOL, SHARE, write_hand_in
from autograder.intake.hub_folder import list_hub_folder, open_folder, read_hub_hand_ins
from autograder.intake.identity import identify
from autograder.intake.worksheet import IDENTIFIER, USERNAME, Worksheet, utc_timestamp

_FIRST_NUMBER = 10**17  # a hub has no numbers of participants; these are none that another system gives


def collect_hub_folder(
    course: Course, path: Path, out: Path, assignments: Sequence[str] = (), known: Sequence[Student] = ()
) -> Iterator[str]:
    """Copy the last hand-in of each student and assignment.

    Parameters
    ----------
    course : Course
        Built.
    path : Path
        The shared folder, or ``inbound`` of the course in nbgrader's exchange.
    out : Path
        As for `autograder.intake.collect.collect_submissions`; ``timestamp.txt`` is that of the file system.
    assignments : sequence of str, optional
        The assignments to collect; default all.
    known : sequence of Student
        Students whose IDs are known; those in `out` are added. A user of the hub is the student with this username, or
        with this ID.

    Yields
    ------
    str
        A line for each student, and one for what belongs to nobody.

    Raises
    ------
    ValueError
        If there is no such assignment, or it is not clear who is who; nothing is written then.
    """
    wanted = course.select(assignments)
    if out.exists() and not out.is_dir():
        raise ValueError(f"{out} is a file; give --out another name.")
    templates = {name: read_template(course, name) for name in course.assignments()}
    found = list_hub_folder(path)
    users = {str(_FIRST_NUMBER + place): user for place, user in enumerate(sorted(found.hand_ins))}
    rows = tuple({IDENTIFIER: f"Participant {number}", USERNAME: user} for number, user in users.items())
    table = out / STUDENTS_FILE
    written_before = read_students(table) if table.is_file() else []
    who = identify(Worksheet((IDENTIFIER, USERNAME), rows, "", path), _without_numbers(written_before, known))
    students = _without_numbers(who.students.values())
    write_students(table, merge_students(written_before, students))
    pool = Pool(POOL)
    with open_folder(path) as top, tempfile.TemporaryFile() as scratch:
        for number, user in users.items():
            budget = Budget(SHARE, MOST, pool)
            read = read_hub_hand_ins(top, found.hand_ins[user], templates, budget, MAX_FILE_BYTES, scratch)
            student = who.students[number].id
            times = {name: utc_timestamp(when) for name, when in read.times.items()}
            remarks = write_hand_in(out / student, read.hand_in, wanted, times)
            if known and number in who.unlisted:
                remarks.append("not in the students file")
            yield one_line(f"{student}{'' if user == student else f' ({user})'}: {'; '.join(remarks)}")
    if found.strays:
        more = " ..." if len(found.strays) > 10 else ""
        yield one_line(f"belongs to nobody, or cannot be read: {', '.join(found.strays[:10])}{more}")


def _without_numbers(*lists: Iterable[Student]) -> list[Student]:
    """The students of all lists without the numbers that another system gave them."""
    return merge_students([replace(student, participant="") for students in lists for student in students])
