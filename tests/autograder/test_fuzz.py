"""A small part of `make fuzz`, with other seeds than its first ones."""

import warnings
from pathlib import Path

import fuzz
import pytest

from autograder.course.layout import Course


@pytest.mark.parametrize("kind", list(fuzz.KINDS))
def test_what_is_hostile_is_read_or_refused_in_one_line(kind: str, course: Course, tmp_path: Path) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        assert fuzz.run(kind, int(40 * min(fuzz.SHARES.get(kind, 1), 1)), 10**6, fuzz.Ground(course, tmp_path)) == []


def test_a_case_that_fails_is_named_with_its_seed(
    course: Course, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def broken(*_: object) -> None:
        raise KeyError("x")

    monkeypatch.setitem(fuzz.KINDS, "values", broken)
    assert fuzz.run("values", 1, 7, fuzz.Ground(course, tmp_path)) == ["values, seed 7: KeyError: 'x'"]
