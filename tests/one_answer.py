"""Grade one answer in this process: quick enough for thousands of answers, without a sandbox and for our own code only.

The model solution is run once; before each cell for answers, its variables are kept. An answer is then run on the
variables that stood before it, and its question judged with inputs of any seed.
"""

import contextlib
import os
import pickle
import re
import tempfile
import warnings
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import cache, lru_cache
from pathlib import Path
from typing import Any

import jupytext
import matplotlib
import numpy as np

from autograder.course.individual_data import individual_file
from labsid.checks.notebook import NotebookAsk, load_assignment
from labsid.checks.question import Assignment, Origin, given_values
from labsid.checks.time_limit import OutOfTime, limit_time
from labsid.checks.values import Value
from labsid.checks.verdict import Verdict
from labsid.records.record import Record, load_record

matplotlib.use("Agg")
import matplotlib.pyplot as plt
from matplotlib.axes import Axes
from matplotlib.figure import Figure

NOTEBOOKS = Path(__file__).resolve().parent.parent / "notebooks"
SECRET = b"a secret of the tests"
SECONDS = 15.0
"""Time of an answer and its check."""
END = "end"
"""Key of the variables after the last cell."""


@dataclass(frozen=True, slots=True)
class Kept:
    """The variables at one place of a notebook.

    `data` and `drawn` are those that an answer may change, as `pickle` writes them: arrays, generators and what
    contains them; and figures with their axes, which take much longer to read.
    """

    data: bytes
    drawn: bytes
    names_drawn: tuple[str, ...]
    others: dict[str, Any]

    @classmethod
    def of(cls, variables: Mapping[str, Any], before: "Kept | None" = None, source: str = "") -> "Kept":
        """Keep the variables after a cell; those `before` it tell which figures it cannot have changed."""
        kinds = {name: _kind(name, value) for name, value in variables.items()}
        drawn = {name: variables[name] for name, kind in kinds.items() if kind == "drawn"}
        data = {name: variables[name] for name, kind in kinds.items() if kind == "data"}
        others = {name: value for name, value in variables.items() if kinds[name] == "other"}
        as_before = before is not None and before.names_drawn == tuple(drawn) and not before.draws([source])
        return cls(
            pickle.dumps(data), before.drawn if as_before and before else pickle.dumps(drawn), tuple(drawn), others
        )

    def variables(self, sources: Iterable[str]) -> dict[str, Any]:
        """The variables for these cells to be run on: figures of their own where a cell names one, or pyplot's."""
        drawn = pickle.loads(self.drawn) if self.draws(sources) else _figures(self.drawn)
        return {**self.others, **pickle.loads(self.data), **drawn}

    def draws(self, sources: Iterable[str]) -> bool:
        """Whether a cell names a figure, or pyplot."""
        named = {word for source in sources for word in re.findall(r"\w+", source)}
        return not named.isdisjoint({*self.names_drawn, "plt", "matplotlib"})


@lru_cache(maxsize=64)
def _figures(drawn: bytes) -> dict[str, Any]:
    """Figures that nobody changes."""
    return dict(pickle.loads(drawn))


def _kind(name: str, value: Any) -> str:
    """Whether a variable is of the "data" or "drawn" that an answer may change, or one of the "other" ones."""
    if type(value) in (bool, int, float, str) or (type(value) is np.ndarray and not value.dtype.hasobject):
        return "other" if name.startswith("__") else "data"
    if isinstance(value, Figure | Axes):
        return "drawn"
    if isinstance(value, np.ndarray) and type(value) is not np.ndarray:
        return "other"  # python-control's own signals cannot be pickled
    if name.startswith("__") or callable(value) or type(value).__module__.partition(".")[0] == "labsid":
        return "other"
    try:
        return "drawn" if b"matplotlib" in pickle.dumps(value) else "data"
    except Exception:
        return "other"


@dataclass(frozen=True)
class Solved:
    """The model solution of an assignment, run on a record.

    Attributes
    ----------
    assignment : Assignment
    record : Record or None
    origin : Origin or None
    cells : mapping
        Source of each cell that is run or judged, in their order, by grade_id.
    kept : mapping
        Variables before each of them.
    known : mapping
        Right values of earlier steps, by question.
    files : mapping
        Content of the files in the folder of the notebook, by name.
    """

    assignment: Assignment
    record: Record | None
    origin: Origin | None
    cells: Mapping[str, str]
    kept: dict[str, Kept] = field(default_factory=dict)
    known: dict[str, dict[str, Value]] = field(default_factory=dict)
    files: dict[str, bytes] = field(default_factory=dict)

    @contextlib.contextmanager
    def in_folder(self) -> Iterator[None]:
        """Work in a folder with the files of the notebook."""
        with work_folder() as folder:
            for name, content in self.files.items():
                (folder / name).write_bytes(content)
            yield

    def answer_cells(self, question: str) -> tuple[str, ...]:
        """The cells for answers that belong to a question: those between the question before and its own."""
        ids = list(self.cells)
        questions = {one.id for one in self.assignment.questions}
        at = ids.index(question)
        first = next((i + 1 for i in range(at - 1, -1, -1) if ids[i] in questions), 0)
        return tuple(one for one in ids[first:at] if one.endswith("-answer"))

    def run_before(self, cell: str) -> dict[str, Any]:
        """The variables before a cell; after the last one if there is no such cell."""
        kept = self.kept[cell if cell in self.kept else END]
        return kept.variables(["plt"])

    def names_read(self, question: str) -> set[str]:
        """The variables that a question's check reads of the model solution; none if there is no such question."""
        if question not in {one.id for one in self.assignment.questions}:
            return set()
        ask = self._ask(question, self.kept[question].variables(["plt"]))
        with quietly():
            self.assignment.question(question).verdict(ask)
        return set(ask.names)

    def run(self, question: str, replaced: Mapping[str, str]) -> dict[str, Any]:
        """The variables when a question is judged, with some cells replaced; raises what a cell raises."""
        ids = list(self.cells)
        first = min(map(ids.index, replaced), default=ids.index(question))
        questions = {one.id for one in self.assignment.questions}
        to_run = [one for one in ids[first : ids.index(question)] if one not in questions]
        sources = {one: replaced.get(one, self.cells[one]) for one in to_run}
        variables = self.kept[ids[first]].variables(sources.values())
        with self.in_folder():
            for one, source in sources.items():
                exec(compile(source, one, "exec"), variables)
        return variables

    def verdict(self, question: str, variables: Mapping[str, Any], seed: int) -> Verdict:
        """The verdict on a question, with the trials of a seed."""
        return self.verdict_and_draws(question, variables, seed)[0]

    def verdict_and_draws(self, question: str, variables: Mapping[str, Any], seed: int) -> tuple[Verdict, bool]:
        """The verdict on a question, and whether its check drew any trials."""
        ask = self._ask(question, variables)
        ask.rng = np.random.default_rng([seed, *question.encode()])
        before = ask.rng.bit_generator.state
        return self.assignment.question(question).verdict(ask), ask.rng.bit_generator.state != before

    def judge(self, question: str, replaced: Mapping[str, str], seed: int = 0) -> Verdict:
        """The verdict on a question with some cells replaced; an answer that stops, or does not end, is wrong."""
        try:
            with quietly(), limit_time(SECONDS):
                return self.verdict(question, self.run(question, replaced), seed)
        except OutOfTime:
            return Verdict(False, f"longer than {SECONDS:g} s")
        except Exception as error:
            return Verdict(False, f"stopped with {type(error).__name__}: {error}")

    def _ask(self, question: str, variables: Mapping[str, Any]) -> NotebookAsk:
        ask = NotebookAsk(variables, self.record, self.known[question], question)
        ask.origin = self.origin  # type: ignore[assignment]
        return ask


@lru_cache(maxsize=2)
def solve(name: str, student: str = "z5000001", content: bytes | None = None) -> Solved:
    """Run the model solution of an assignment on a student's record; demonstrations are left out.

    With the `content` of a data file it runs on that record, of which no origin is known.
    """
    assignment = load_assignment(name)
    cells = cells_of(name)
    with work_folder() as folder, quietly():
        record = None
        if assignment.record_file is not None:
            path = folder / assignment.record_file
            path.write_bytes(individual_file(path.name, student, SECRET) if content is None else content)
            record = load_record(path)
        solved = Solved(assignment, record, Origin(student, SECRET) if content is None else None, cells)
        variables: dict[str, Any] = {}
        known: dict[str, Value] = {}
        questions = {question.id: question for question in assignment.questions}
        before, last = None, ""
        for one, source in cells.items():
            before = solved.kept[one] = Kept.of(variables, before, last)
            last = source
            if one in questions:
                solved.known[one] = dict(known)
                known.update(given_values(questions[one], solved._ask(one, variables), passed=True))
            else:
                exec(compile(source, one, "exec"), variables)
        solved.kept[END] = Kept.of(variables, before, last)
        solved.files.update({path.name: path.read_bytes() for path in folder.iterdir() if path.is_file()})
    return solved


def own_record(name: str, student: str) -> Record | None:
    """A student's record, without running the model solution on it."""
    record_file = load_assignment(name).record_file
    if record_file is None:
        return None
    with work_folder() as folder:
        path = folder / record_file
        path.write_bytes(individual_file(record_file, student, SECRET))
        return load_record(path)


@cache
def cells_of(name: str) -> dict[str, str]:
    """Source of each cell that is run or judged, by grade_id; demonstrations are left out."""
    notebook = jupytext.read(NOTEBOOKS / name / f"{name}.md", fmt="md:myst")
    return {
        str(cell.metadata["nbgrader"]["grade_id"]): cell.source
        for cell in notebook.cells
        if cell.cell_type == "code" and "demonstration" not in cell.metadata.get("tags", [])
    }


@contextlib.contextmanager
def work_folder() -> Iterator[Path]:
    """Work in a new folder."""
    before = Path.cwd()
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        try:
            yield Path(folder)
        finally:
            os.chdir(before)


@contextlib.contextmanager
def quietly() -> Iterator[None]:
    """Print nothing, warn of nothing, and leave no figure open."""
    with (
        warnings.catch_warnings(),
        np.errstate(all="ignore"),
        open(os.devnull, "w") as nowhere,
        contextlib.redirect_stdout(nowhere),
    ):
        warnings.simplefilter("ignore")
        try:
            yield
        finally:
            plt.close("all")
