"""Checksums of variables: changes in place are seen, whatever is in them is read in little time, and nothing runs."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from autograder.sandbox.checksums import checksums_of
from labsid.checks.time_limit import limit_time


def change(value: Any, key: Any, new: Any) -> None:
    value[key] = new


@pytest.mark.parametrize(
    ("value", "modify"),
    [
        pytest.param(np.zeros(200_000), lambda v: change(v, 77_777, 1e-9), id="an array"),
        pytest.param(np.arange(10).astype("M8[s]"), lambda v: change(v, 3, 0), id="times"),
        pytest.param(np.ones((3, 4))[:, ::2], lambda v: change(v, (1, 1), 2), id="a view"),
        pytest.param([1.0] * 500_000, lambda v: change(v, 123_456, 2.0), id="a list of floats"),
        pytest.param(list(np.ones(500_000)), lambda v: change(v, 123_456, np.float64(2)), id="numpy's floats"),
        pytest.param([1, -1], lambda v: change(v, 1, -2), id="whole numbers with the same hash"),
        pytest.param([0.0, None, "a"], lambda v: v.append(1), id="a list that grows"),
        pytest.param([np.zeros(4) for _ in range(900)], lambda v: change(v[456], 2, 1), id="a list of arrays"),
        pytest.param([[1, 2], [3, [4]]], lambda v: change(v[1][1], 0, 5), id="lists in lists"),
        pytest.param({"a": {"b": (np.zeros(2), 1)}}, lambda v: change(v["a"]["b"][0], 0, 1), id="a record"),
        pytest.param({"a": 1}, lambda v: change(v, "b", v.pop("a")), id="a key"),
        pytest.param({1, 2}, lambda v: v.add("three"), id="a set"),
        pytest.param(np.array([[1], "a"], object), lambda v: v[0].append(2), id="objects in an array"),
        pytest.param([bytearray(b"ab")], lambda v: change(v[0], 0, 99), id="bytes"),
    ],
)
def test_a_change_in_place_is_seen(value: Any, modify: Callable[[Any], object]) -> None:
    before = checksums_of({"v": value})
    assert checksums_of({"v": value}) == before
    modify(value)
    assert checksums_of({"v": value}) != before


class Slow:
    """An object that answers nothing in time."""

    def __repr__(self) -> str:
        raise AssertionError

    def __getattribute__(self, name: str) -> Any:
        raise AssertionError

    __hash__ = __eq__ = __len__ = __iter__ = __float__ = __array__ = __repr__  # type: ignore[assignment]


class OwnList(list[Any]):
    """A list whose methods are not to be called."""

    __iter__ = __len__ = __getitem__ = Slow.__repr__  # type: ignore[assignment]


class OwnArray(np.ndarray[Any, Any]):
    """An array whose methods are not to be called."""

    tobytes = view = dtype = property(Slow.__repr__)  # type: ignore[assignment]


def cyclic() -> list[Any]:
    value: list[Any] = [1, {}]
    value[1]["self"] = value
    return value


def bomb() -> list[Any]:
    value: list[Any] = ["a"]
    for _ in range(40):
        value = [value] * 10 + ["a"]
    return value


LARGE: dict[str, Callable[[], Any]] = {
    "arrays in a list": lambda: [np.zeros(4) for _ in range(100_000)],
    "arrays in a dict": lambda: {k: np.zeros(4) for k in range(300_000)},
    "floats": lambda: [0.5] * 500_000,
    "lists": lambda: [[1, 2] for _ in range(200_000)],
    "texts": lambda: [str(k) for k in range(300_000)],
    "large integers": lambda: [1 << 10**6 + k for k in range(100)],
    "objects": lambda: [Slow() for _ in range(2_000)],
    "objects in an array": lambda: np.frompyfunc(lambda _: Slow(), 1, 1)(np.arange(300)),
    "a list of one's own": lambda: OwnList([1, 2, "a"]),
    "an array of one's own": lambda: np.ndarray.__new__(OwnArray, 5),
    "a long axis without memory": lambda: np.broadcast_to(0.0, (10**12,)),
    "within itself": cyclic,
    "ten to the forty": bomb,
}


@pytest.mark.parametrize("kind", LARGE)
def test_any_value_is_read_in_little_time(kind: str) -> None:
    value = LARGE[kind]()
    with limit_time(60.0):  # it takes a fraction of a second
        found = checksums_of({f"v{k}": value for k in range(5)})
    assert len(found) == 5
