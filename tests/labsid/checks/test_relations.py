"""How a wrong result is related to the right one: a fact, or nothing."""

from typing import Any

import numpy as np
import pytest

from labsid.checks.relations import relation
from labsid.checks.verdict import judge

TRUE = np.array([0.31, -1.7, 2.9, 0.05, 4.1, -0.6, 1.3, 2.2, -3.4, 0.9, 1.05, -0.2])
TABLE = np.column_stack([TRUE, TRUE**2, np.cos(TRUE)])


def same(a: Any, b: Any) -> bool:
    return np.shape(a) == np.shape(b) and bool(np.allclose(a, b, rtol=1e-6, atol=0))


RELATIONS = [
    (-TRUE, TRUE, "right but for the sign"),
    (TRUE / 2, TRUE, "Every entry is half the right value"),
    (-2 * TRUE, TRUE, "twice the right value, with the other sign"),
    (1.2345 * TRUE, TRUE, "times one factor"),
    (TRUE + 0.4, TRUE, "with one constant added"),
    (TRUE**2, TRUE, "the square of the right result"),
    (np.abs(TRUE), TRUE, "the absolute value"),
    (np.round(TRUE * np.pi, 2), TRUE * np.pi, "rounded to 2 digits"),
    (TRUE[::-1], TRUE, "in reverse order"),
    (np.sort(TRUE), TRUE, "in another order"),
    (TRUE[:4] * [1, 1, -1, 1], TRUE[:4], "but for the sign of [2]"),
    (TABLE[:3].T, TABLE[:3], "the transpose"),
    (TABLE[:, [1, 0, 2]], TABLE, "its columns are right, in another order: now 1, 0, 2".capitalize()),
    (TABLE * [1, -1, 1], TABLE, "Column `[:, 1]` has the wrong sign"),
    (np.append(7.0, TRUE[:-1]), TRUE, "one sample late"),
    (np.append(TRUE[2:], [7.0, 8.0]), TRUE, "2 samples early"),
    (TABLE + np.array([0, 0, 7]), TABLE, "Column `[:, 2]` is wrong"),
    (np.append(TRUE[:-1], 9.0), TRUE, "Entry 11 is wrong"),
    (TABLE + np.array([0, 7, 7]), TABLE, "Columns `[:, 1]` and `[:, 2]` are wrong, the others are right"),
    (np.where(np.arange(12) < 2, 0, TRUE), TRUE, "Entries 0 to 1 (counted from 0) are zero, and should not be"),
    (np.where(np.arange(12)[:, None] == 3, 0, TABLE), TABLE, "Row 3 (counted from 0) is zero, and should not be"),
    (0 * TRUE, TRUE, "All of it is zero"),
    (6.0, 3.0, "It is twice the right value"),
    (9.0, 3.0, "three times"),
    (np.log(7.3), 7.3, "the natural logarithm of"),
]


@pytest.mark.parametrize(("got", "right", "said"), RELATIONS, ids=[one[2] for one in RELATIONS])
def test_a_simple_relation_is_told(got: Any, right: Any, said: str) -> None:
    assert said in relation(got, right, same)


@pytest.mark.parametrize(
    ("got", "right"),
    [
        (TRUE + 0.1 * np.cos(40 * TRUE), TRUE),
        (TRUE * 1.0001 + 0.01 * TRUE**2, TRUE),
        (TRUE[:-1], TRUE),
        ("text", TRUE),
        (TRUE * np.nan, TRUE),
        (7.1, 3.0),
        (TABLE + 0.1 * np.sin(30 * TABLE), TABLE),
    ],
)
def test_where_nothing_simple_relates_them_nothing_is_said(got: Any, right: Any) -> None:
    assert relation(got, right, same) == ""


def test_no_number_of_the_right_result_is_shown() -> None:
    for got, right, _ in RELATIONS:
        text = relation(got, right, same)
        assert not any(f"{abs(one):.2f}" in text for one in np.ravel(right))


def test_a_relation_is_added_to_what_no_slip_names() -> None:
    assert judge(TRUE / 2, TRUE, same, "right", "It is off.").reason.startswith("It is off. Every entry is half")
