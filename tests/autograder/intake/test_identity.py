"""Who is who: one identifier, one student, in whatever column it is; decided once."""

import re
from collections.abc import Mapping
from pathlib import Path

import pytest

from autograder.course.students import Student
from autograder.intake.identity import identify
from autograder.intake.worksheet import Worksheet

ADA = {"Identifier": "Participant 11", "Full name": "Ada", "ID number": "z1", "Username": "ada", "Email address": "a@x"}
BEN = {"Identifier": "Participant 12", "Full name": "Ben", "ID number": "z2", "Username": "ben", "Email address": "b@x"}


def sheet(*rows: Mapping[str, str]) -> Worksheet:
    return Worksheet(tuple(ADA), tuple(map(dict, rows)), "", Path("w.csv"))


def ids(found: object) -> list[str]:
    return [one.id for one in found.students.values()]  # type: ignore[attr-defined]


@pytest.mark.parametrize(
    ("changed", "said"),
    [
        ({"Identifier": "Participant 11"}, "the worksheet has participant 11 twice: Ada and Ben"),
        ({"ID number": "z1"}, "Ada (z1), participant 11 and Ben (z1), participant 12 have the same ID"),
        ({"ID number": "Z1"}, "Ada (z1), participant 11 and Ben (Z1), participant 12 have IDs that differ in case"),
        ({"Username": "Z1"}, "Z1 is the ID of Ada (z1), participant 11 and the username of Ben (z2), participant 12"),
        ({"Username": "ada"}, "ada is the username of Ada (z1), participant 11 and the username of Ben"),
        ({"Email address": "z1"}, "z1 is the ID of Ada (z1), participant 11 and the e-mail address of Ben"),
        ({"ID number": "11"}, "11 is the participant number of Ada (z1), participant 11 and the ID of Ben (11)"),
        ({"ID number": "Ada"}, "Ada is the username of Ada (z1), participant 11 and the ID of Ben (Ada)"),
        ({"ID number": "", "Username": "z1"}, "Ada (z1), participant 11 and Ben (z1), participant 12 have the same ID"),
        ({"ID number": "", "Username": "", "Email address": "11"}, "11 is the participant number of Ada"),
    ],
)
@pytest.mark.parametrize("order", [1, -1])
def test_an_identifier_of_two_students_is_refused_with_both_names(
    changed: Mapping[str, str], said: str, order: int
) -> None:
    rows = (ADA, {**BEN, **changed})
    with pytest.raises(ValueError, match=r"Ada.*Ben|Ben.*Ada"):
        identify(sheet(*rows[::order]))
    if order == 1:
        with pytest.raises(ValueError, match=re.escape(said)):
            identify(sheet(*rows))


def test_the_first_usable_column_is_the_id() -> None:
    cat = {**ADA, "Identifier": "Participant 13", "ID number": "../x", "Username": "", "Email address": "c@x"}
    dan = dict.fromkeys(ADA, "") | {"Identifier": "Participant 014"}
    assert ids(identify(sheet(ADA, BEN, cat, dan))) == ["z1", "z2", "c@x", "14"]


def test_the_students_file_says_which_column_is_the_id() -> None:
    """A username that is another's ID does not make the one the other."""
    by_name = identify(sheet(ADA, BEN), [Student("ADA"), Student("ben")])
    assert ids(by_name) == ["ADA", "ben"]
    assert not by_name.unlisted
    gone = {**BEN, "Username": "z3"}
    with pytest.raises(ValueError, match=r"z3 is the ID of Cat \(z3\) and the username of Ben"):
        identify(sheet(ADA, gone), [Student("z1"), Student("z3", "Cat")])
    assert identify(sheet(ADA, BEN), [Student("z1")]).unlisted == {"12"}


def test_what_was_decided_before_stays() -> None:
    known = [Student("old", "Ada", username="ada", participant="5"), Student("b", "Ben", "b@x")]
    assert ids(identify(sheet(ADA, BEN), known)) == ["old", "b"]
    number = [Student("z9", "Ada", participant="11")]
    assert ids(identify(sheet({**ADA, "Username": "", "Email address": ""}), number)) == ["z9"]
    with pytest.raises(ValueError, match=r"Eve \(z9\), participant 11 and Ada \(z9\), participant 11 have the same ID"):
        identify(sheet(ADA), [Student("old", "Ada", username="ada"), Student("z9", "Eve", participant="11")])


def test_a_number_alone_makes_nobody_somebody_else() -> None:
    """A participant number that is another's ID, and one that is used again on another site."""
    listed = [Student("11", "Ada Able", "a@x"), Student("15", "Ben Brown", "b@x")]
    with pytest.raises(ValueError, match=r"Ada Able \(11\) and Ben Brown \(11\), participant 11 have the same ID"):
        identify(None, listed, {"11": "Ben Brown", "12": "Ada Able"})
    assert ids(identify(None, [Student("11"), Student("12", "Brown, Ben")], {"11": "Ada", "12": "Ben Brown"})) == [
        "11",
        "12",
    ]
    before = [Student("z1", "Ada", "a@x", "ada", "12")]
    with pytest.raises(ValueError, match=r"Ada \(z1\), participant 12 and Ben \(z1\), participant 12 have the same ID"):
        identify(sheet(BEN), before)
    assert ids(identify(sheet({**ADA, "Full name": "Ada Byron"}), [Student("z1", "Ada", "a@x", "ada", "11")])) == ["z1"]


def test_who_is_not_in_the_worksheet_has_the_number_if_it_is_free() -> None:
    assert ids(identify(None, (), {"11": "Ada", "12": "Ben"})) == ["11", "12"]
    assert ids(identify(sheet(ADA), (), {"11": "A", "12": "Ben"})) == ["z1", "12"]
    with pytest.raises(ValueError, match=r"Ada \(12\), participant 11 and Ben \(12\), participant 12 have the same ID"):
        identify(sheet({**ADA, "ID number": "12"}), (), {"12": "Ben"})
    with pytest.raises(ValueError, match=r"Ada \(12\), participant 11 and Ben \(12\), participant 12 have the same ID"):
        identify(None, [Student("12", "Ada", participant="11")], {"12": "Ben"})
