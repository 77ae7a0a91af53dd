"""Values carried forward: which wrong ones count, and the shape of those that replace them."""

from typing import Any

import numpy as np
import pytest

from autograder.judge.carrying import Shape, differ_in_shape, in_shape, wrong_names

SIGNAL = np.linspace(-1, 1, 5)


def test_the_names_of_wrong_values() -> None:
    right = {"a": 1.0, "b": SIGNAL, "c": SIGNAL, "d": "text", "e": 2.0}
    own = {"a": 1.0 + 1e-12, "b": SIGNAL.copy(), "c": SIGNAL.reshape(-1, 1), "d": "text"}
    assert wrong_names(own, right) == ("c", "d", "e")


@pytest.mark.parametrize(
    ("own", "expected"),
    [(SIGNAL, False), (SIGNAL.reshape(1, -1), True), (SIGNAL[:-1].reshape(-1, 1), False), (3.0, False), (None, False)],
)
def test_a_vector_of_another_shape_is_noticed(own: Any, expected: bool) -> None:
    assert differ_in_shape({"a": own}, {"a": SIGNAL}) is expected


@pytest.mark.parametrize(
    ("right", "own", "shape", "expected"),
    [
        (SIGNAL, SIGNAL.reshape(-1, 1), Shape.OWN, (5, 1)),
        (SIGNAL, SIGNAL.reshape(1, -1), Shape.OWN, (1, 5)),
        (SIGNAL, np.zeros((9, 1)), Shape.OWN, (5, 1)),
        (SIGNAL, np.zeros(9), Shape.OWN, (5,)),
        (SIGNAL, None, Shape.OWN, (5,)),
        (SIGNAL, SIGNAL.reshape(-1, 1), Shape.FLAT, (5,)),
        (SIGNAL, None, Shape.COLUMN, (5, 1)),
        (3.0, np.array([[1.0]]), Shape.OWN, (1, 1)),
        (3.0, np.zeros((9, 1)), Shape.OWN, ()),
        (3.0, None, Shape.COLUMN, ()),
        (np.eye(3), np.zeros(9), Shape.OWN, (3, 3)),
        (np.eye(3), None, Shape.COLUMN, (3, 3)),
    ],
)
def test_right_values_take_a_shape(right: Any, own: Any, shape: Shape, expected: tuple[int, ...]) -> None:
    got = in_shape(right, own, shape)
    assert np.shape(got) == expected
    np.testing.assert_array_equal(np.ravel(got), np.ravel(right))
