"""A text notebook run cell by cell in a plain namespace, as a student runs it, with the checks of the notebook."""

import re
import shutil
from collections.abc import Callable, Iterator, Mapping
from functools import lru_cache
from pathlib import Path

import jupytext
import matplotlib as mpl
import matplotlib.pyplot as plt
import numpy as np
import pytest
from one_answer import work_folder

from labsid.checks import CheckFailed, NoAnswer
from labsid.checks.notebook import load_assignment
from labsid.checks.values import Value, plain
from labsid.records.record import Record

NOTEBOOKS = Path(__file__).resolve().parents[3] / "notebooks"
REGION = re.compile(r"( *)### BEGIN SOLUTION.*?### END SOLUTION", re.DOTALL)

Said = dict[str, str]
RunNotebook = Callable[..., Said]
Cells = Callable[[str], Iterator[tuple[dict[str, object], str]]]


def code_cells(assignment: str) -> Iterator[tuple[dict[str, object], str]]:
    """nbgrader's few words, the tags and the source of every code cell."""
    notebook = jupytext.read(NOTEBOOKS / assignment / f"{assignment}.md", fmt="md:myst")
    for cell in notebook.cells:
        if cell.cell_type == "code":
            yield {**cell.metadata["nbgrader"], "tags": cell.metadata.get("tags", [])}, cell.source


@pytest.fixture(scope="session")
def notebook_cells() -> Cells:
    """The code cells of an assignment's source."""
    return code_cells


@pytest.fixture(autouse=True)
def no_release(monkeypatch: pytest.MonkeyPatch) -> None:
    """The checks know no headings and marks, whether or not this checkout has been built."""
    monkeypatch.setattr("labsid.checks.notebook.released_template", lambda assignment: None)


@pytest.fixture(autouse=True)
def own_style() -> Iterator[None]:
    """A notebook sets the style of its figures."""
    with mpl.rc_context():
        yield


class Answers:
    """Asks the functions of a notebook, with inputs from a seed of its own."""

    def __init__(self, variables: dict[str, object], seed: int) -> None:
        self._variables = variables
        self.rng = np.random.default_rng(seed)
        self.called: set[str] = set()

    @property
    def record(self) -> Record:
        raise AssertionError("this assignment has no record")

    def value(self, name: str) -> Value:
        if name not in self._variables:
            raise NoAnswer(f"no {name}")
        return plain(self._variables[name])

    def call(self, name: str, *arguments: Value) -> Value:
        self.called.add(name)
        function = self._variables.get(name)
        if not callable(function):
            raise NoAnswer(f"no function {name}")
        try:
            return plain(function(*arguments))
        except Exception as error:
            raise NoAnswer(str(error)) from error

    def changes(self, name: str, *arguments: Value) -> bool:
        return False

    def known(self, name: str) -> Value:
        return self.value(name)


@pytest.fixture
def answers() -> type[Answers]:
    """Makes what a check asks, from a notebook's variables and a seed."""
    return Answers


@lru_cache(maxsize=1)
def variables_of(assignment: str) -> dict[str, object]:
    variables: dict[str, object] = {}
    with work_folder():  # cells may write files
        for words, source in code_cells(assignment):
            if "points" not in words and "demonstration" not in words["tags"]:
                exec(compile(source, str(words["grade_id"]), "exec"), variables)
    plt.close("all")
    return variables


@pytest.fixture
def solved() -> Callable[[str], dict[str, object]]:
    """The variables of an assignment's model solution, without the cells that only show something."""
    return variables_of


@pytest.fixture
def run_notebook(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> RunNotebook:
    """Run an assignment beside a copy of `record`: what every check said, "" where it passed.

    An error in a cell that is not a check ends the run, except in a release, whose answer cells are empty.
    """
    folder = tmp_path / "work"
    folder.mkdir()
    monkeypatch.chdir(folder)

    def run(assignment: str, record: Path, replaced: Mapping[str, str] | None = None, release: bool = False) -> Said:
        shutil.copyfile(record, folder / (load_assignment(assignment).record_file or record.name))
        variables: dict[str, object] = {}
        said: Said = {}
        for words, written in code_cells(assignment):
            grade_id = str(words["grade_id"])
            source = written
            if release:
                source = REGION.sub(lambda found: f"{found[1]}# Your code here\n{found[1]}pass", source)
            source = (replaced or {}).get(grade_id, source)
            try:
                exec(compile(source, grade_id, "exec"), variables)
            except CheckFailed as failed:
                said[grade_id] = str(failed)
            except Exception:
                if not release or "points" in words:
                    raise
            else:
                if "points" in words:
                    said[grade_id] = ""
            finally:
                plt.close("all")
        return said

    return run
