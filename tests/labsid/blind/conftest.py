"""Cases of the `dev` suite, each of which takes up to a second to draw: drawn once, by the first worker that asks."""

import os
import pickle
from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import cache
from pathlib import Path

import pytest
from course_work import shared_folder

from labsid.blind import suite
from labsid.blind.experiment import Case
from labsid.records.formats import cut_signals

Made = Callable[[tuple[int, str, int]], Case]


@pytest.fixture(scope="session")
def made(tmp_path_factory: pytest.TempPathFactory) -> Made:
    """Draws a case, or reads what another worker has drawn."""
    folder = shared_folder(tmp_path_factory) / "drawn-cases"
    folder.mkdir(exist_ok=True)
    draw = suite._made

    @cache
    def case(which: tuple[int, str, int]) -> Case:
        path = folder / "-".join(map(str, which))
        if not path.is_file():
            mine = Path(f"{path}.{os.getpid()}")
            mine.write_bytes(pickle.dumps(draw(which)))
            mine.replace(path)
        return pickle.loads(path.read_bytes())

    return case


@pytest.fixture(scope="session")
def dev_cases(made: Made) -> Callable[[str, int], list[Case]]:
    """The first cases of a row, each drawn once."""

    def cases(row: str, count: int) -> list[Case]:
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(suite, "_made", made)
            return list(suite.make_cases("dev", count, [row]))

    return cases


@pytest.fixture
def drawn_once(made: Made) -> Iterator[None]:
    """Cases that another test has drawn are not drawn again."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(suite, "_made", made)
        yield


@pytest.fixture
def short_cases(dev_cases: Callable[[str, int], list[Case]]) -> list[Case]:
    """Two cases without an effect, cut to what is diagnosed in a second."""
    return [replace(case, record=cut_signals(case.record, slice(300))) for case in dev_cases("none", 2)]
