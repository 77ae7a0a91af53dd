"""Who is who: the ID of each participant, decided once and stored, so that every command gives the same.

An identifier, which is an ID, a username, an e-mail address or a participant number, belongs to one student. If it
belongs to two, in any case of letters, everything is refused: marks, records and feedback would reach the wrong one.
"""

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass

from autograder.course.plain_text import one_line
from autograder.course.students import Student, described
from autograder.intake.worksheet import (
    EMAIL,
    FULL_NAME,
    ID_COLUMNS,
    USERNAME,
    Worksheet,
    folder_name,
    participant_number,
)

_REMEDY = "Correct one of them, in the worksheet or the students file, and use that file for all commands."


@dataclass(frozen=True, slots=True)
class WhoIsWho:
    """The participants of a worksheet or of a download.

    Attributes
    ----------
    students : mapping
        Student by participant number.
    unlisted : frozenset of str
        Participant numbers of those who are not among the known students.
    """

    students: Mapping[str, Student]
    unlisted: frozenset[str]


def identify(
    sheet: Worksheet | None, known: Sequence[Student] = (), others: Mapping[str, str] | None = None
) -> WhoIsWho:
    """Decide the ID of each participant.

    The ID is the one decided before for the participant number, the username or the e-mail address; otherwise the first
    usable of the columns ``ID number``, ``Username`` and ``Email address``, beginning with the one in which most known
    IDs are; otherwise the participant number.

    Parameters
    ----------
    sheet : Worksheet, optional
    known : sequence of Student
        Students of the course's file, and those about whom it was decided before.
    others : mapping, optional
        Names of participants who may not be in the worksheet, by participant number.

    Returns
    -------
    WhoIsWho

    Raises
    ------
    ValueError
        If an identifier belongs to two students.
    """
    rows = _rows_by_number(sheet)
    people = {number: _person(number, row) for number, row in rows.items()}
    people |= {
        number: Student("", one_line(name), participant=number)
        for number, name in (others or {}).items()
        if number not in people
    }
    spelled = {student.id.casefold(): student.id for student in known}
    columns = sorted(ID_COLUMNS, key=lambda column: -sum(_fold(row, column) in spelled for row in rows.values()))
    decided: dict[str, Student] = {}
    unlisted: set[str] = set()
    for number, person in people.items():
        student_id = _decided_before(person, known) or _first_usable(rows.get(number, {}), columns) or number
        student_id = spelled.get(student_id.casefold(), student_id)
        decided[number] = Student(student_id, person.name, person.email, person.username, number)
        if student_id.casefold() not in spelled:
            unlisted.add(number)
    _refuse_shared(known, decided.values(), rows)
    return WhoIsWho(decided, frozenset(unlisted))


def _rows_by_number(sheet: Worksheet | None) -> dict[str, Mapping[str, str]]:
    """The rows of a worksheet by participant number; `ValueError` if two rows have the same number."""
    rows: dict[str, Mapping[str, str]] = {}
    for row in sheet.rows if sheet is not None else ():
        number = participant_number(row)
        if number is None:
            continue
        if number in rows:
            names = " and ".join(one_line(one.get(FULL_NAME, "")) for one in (rows[number], row))
            raise ValueError(f"the worksheet has participant {number} twice: {names}. Download it again.")
        rows[number] = row
    return rows


def _person(number: str, row: Mapping[str, str]) -> Student:
    name, email, username = (one_line(row.get(column, "")) for column in (FULL_NAME, EMAIL, USERNAME))
    return Student("", name, email, username, number)


def _decided_before(person: Student, known: Iterable[Student]) -> str:
    """The ID of a participant about whom it was decided before; empty if it was not."""
    by_number = by_username = by_email = ""
    for student in known:
        if student.participant and student.participant == person.participant:
            by_number = student.id
        if student.username and student.username.casefold() == person.username.casefold():
            by_username = student.id
        if student.email and student.email.casefold() == person.email.casefold():
            by_email = student.id
    return by_number or by_username or by_email


def _first_usable(row: Mapping[str, str], columns: Iterable[str]) -> str:
    return next((name for column in columns if (name := folder_name(row.get(column, ""))) is not None), "")


def _fold(row: Mapping[str, str], column: str) -> str:
    return (folder_name(row.get(column, "")) or "").casefold()


def _refuse_shared(known: Iterable[Student], decided: Iterable[Student], rows: Mapping[str, Mapping[str, str]]) -> None:
    """Refuse an identifier that belongs to two students, or one ID for two participants of a worksheet."""
    owners: dict[str, tuple[Student, str]] = {}
    participants: dict[str, Student] = {}
    for student in decided:
        holder = participants.setdefault(student.id.casefold(), student)
        if holder is not student:
            same = (
                "the same ID" if holder.id == student.id else f"IDs that differ in case, {holder.id} and {student.id}"
            )
            raise ValueError(f"{_who(holder)} and {_who(student)} have {same}. {_REMEDY}")
    known = tuple(known)
    numbers = {(student.id.casefold(), student.participant) for student in known}
    for student in known:
        namesake = participants.get(student.id.casefold())
        if namesake is None:
            continue
        by_number = namesake.id == namesake.participant  # nothing but the number says who it is
        decided_before = (student.id.casefold(), namesake.participant) in numbers
        unexpected = bool(student.participant) and by_number and not decided_before
        if unexpected or ((student.participant or by_number) and _are_different(student, namesake)):
            raise ValueError(f"{_who(student)} and {_who(namesake)} have the same ID. {_REMEDY}")
    for student in (*known, *participants.values()):
        for value, kind in _identifiers(student, rows.get(student.participant, {})):
            owner, as_what = owners.setdefault(value.casefold(), (student, kind))
            if owner.id.casefold() != student.id.casefold():
                raise ValueError(
                    f"{value} is the {as_what} of {_who(owner)} and the {kind} of {_who(student)}. {_REMEDY}"
                )


def _are_different(one: Student, other: Student) -> bool:
    """Whether what is known of two participants of different assignments says that they are two students."""
    for pair in ((one.username, other.username), (one.email, other.email)):
        if all(pair):
            return pair[0].casefold() != pair[1].casefold()
    words = [set(re.findall(r"\w+", student.name.casefold())) for student in (one, other)]
    return all(words) and words[0].isdisjoint(words[1])


def _identifiers(student: Student, row: Mapping[str, str]) -> Iterator[tuple[str, str]]:
    yield student.id, "ID"
    if student.participant:
        yield student.participant, "participant number"
    if student.username:
        yield student.username, "username"
    if student.email:
        yield student.email, "e-mail address"
    number = folder_name(row.get(ID_COLUMNS[0], ""))
    if number is not None:
        yield number, ID_COLUMNS[0]


def _who(student: Student) -> str:
    number = f", participant {student.participant}" if student.participant else ""
    return f"{described(student)}{number}"
