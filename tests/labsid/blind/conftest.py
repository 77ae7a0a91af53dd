"""Cases of the `dev` suite, each of which takes up to a second to draw."""

from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import cache

import pytest

from labsid.blind import suite
from labsid.blind.experiment import Case
from labsid.records.formats import cut_signals

_made = cache(suite._made)


@pytest.fixture(scope="session")
def dev_cases() -> Callable[[str, int], list[Case]]:
    """The first cases of a row, each drawn once."""

    def cases(row: str, count: int) -> list[Case]:
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(suite, "_made", _made)
            return list(suite.make_cases("dev", count, [row]))

    return cases


@pytest.fixture
def drawn_once() -> Iterator[None]:
    """Cases that another test has drawn are not drawn again."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(suite, "_made", _made)
        yield


@pytest.fixture
def short_cases(dev_cases: Callable[[str, int], list[Case]]) -> list[Case]:
    """Two cases without an effect, cut to what is diagnosed in a second."""
    return [replace(case, record=cut_signals(case.record, slice(300))) for case in dev_cases("none", 2)]
