"""The second run of a notebook, in which right values and functions replace wrong ones.

It judges only what the first run left wrong. What its cells print is not kept, because they run on right values.
"""

import builtins
import contextlib
import re
import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

import numpy as np

from autograder.course.definitions import defined_functions
from autograder.intake.submission import NotebookCell
from autograder.judge.answer import Answer
from autograder.judge.ask import AskOpener
from autograder.judge.attempt import Attempt
from autograder.judge.carrying import Shape, differ_in_shape, in_shape, wrong_names
from autograder.judge.examiner import Examination, Examiner
from autograder.judge.execution import ExecutedCell, Execution
from autograder.judge.replaced import replaced_for
from autograder.sandbox.isolation import ProcessLauncher, Reply, StudentProcessError
from labsid.checks.values import Value


@dataclass(frozen=True, slots=True)
class _Retrial:
    """An answer in the second run: judged already, or after the last cell on the values known at its question."""

    answer: Answer
    asked: Examination
    attempt: Attempt | None
    known: Mapping[str, Value]


class SecondRun:
    """Judges the answers that are wrong in the first run, and may be right after right answers.

    Parameters
    ----------
    first_run : sequence of ExecutedCell
        All cells of the submission, as they ran.
    answers : sequence of Answer
        One for each question cell, judged in the first run; attempts are added to them.
    functions : mapping
        Source of the right functions, by question.
    asks : AskOpener
    launcher : ProcessLauncher
    folder : Path
        The files of the student's work folder.
    """

    def __init__(
        self,
        first_run: Sequence[ExecutedCell],
        answers: Sequence[Answer],
        functions: Mapping[str, str],
        asks: AskOpener,
        launcher: ProcessLauncher,
        folder: Path,
    ) -> None:
        self._first_run = first_run
        self._answers = answers
        self._functions = functions
        self._asks = asks
        self._launcher = launcher
        self._folder = folder
        self._shapes: dict[Shape, list[tuple[int, ...]]] = {shape: [] for shape in Shape}  # of the replaced values
        self._positions = [k for k, done in enumerate(first_run) if done.cell.kind == "question"]

    def judge(self, deadline: float) -> None:
        """Judge until the deadline: with vectors in the shape of the student's own, then flat, then as columns."""
        tried: list[Shape] = []
        for shape in Shape:
            if any(self._shapes[shape] == self._shapes[other] for other in tried):
                continue
            tried.append(shape)
            before: list[int] = []
            # once more if it made answers right: their functions are the student's own then
            while (waiting := self._waiting()) and waiting != before and time.monotonic() < deadline:
                with contextlib.suppress(StudentProcessError):  # no process: what was found so far stands
                    execution = Execution(self._launcher, self._folder, deadline)
                    with contextlib.closing(execution):
                        self._run(execution, waiting, shape)
                before = waiting

    def _waiting(self) -> list[int]:
        return [key for key in range(len(self._answers)) if self._may_become_right(key)]

    def _run(self, execution: Execution, waiting: Sequence[int], shape: Shape) -> None:
        """Run the cells up to the last answer that waits, replace wrong values on the way, and judge."""
        self._shapes = {shape: [] for shape in Shape}
        examiner = Examiner(execution, self._asks, self._launcher.limits)
        known: dict[str, Value] = {}
        retrials: list[_Retrial] = []
        cells: list[ExecutedCell] = []
        answers = iter(enumerate(self._answers))
        for first in self._first_run[: self._positions[waiting[-1]] + 1]:
            cell = first.cell
            if first.failure is None:
                done = _without_output(execution.run(cell))
                if cell.kind in ("answer", "extra") and cell.code:
                    cells.append(done)
            if cell.kind == "tests":
                cells = []
            if cell.kind != "question":
                continue
            key, answer = next(answers)
            asked = Examination(key, answer.question, cells)
            cells = []
            if answer.is_sound:
                # an object may answer differently each time: it is read as often as in the first run
                examiner.own_values(asked, answer.asked.values)
                known.update(answer.carried)
                continue
            attempt = None
            if not answer.crashed:
                attempt = examiner.judge_now(asked, known, self._as_columns(key))
                if key in waiting:
                    retrials.append(_Retrial(answer, asked, attempt, dict(known)))
            known.update(self._carry(execution, examiner, asked, attempt, known, shape))
        for retrial in retrials:
            self._finish(retrial, examiner)

    def _carry(
        self,
        execution: Execution,
        examiner: Examiner,
        asked: Examination,
        attempt: Attempt | None,
        known: Mapping[str, Value],
        shape: Shape,
    ) -> dict[str, Value]:
        """The values with which later steps start; right values and functions replace those of a wrong answer."""
        answer = self._answers[asked.key]
        right = examiner.right_values(asked, known)
        if attempt is not None and attempt.passed:
            return right | examiner.own_values(asked, right)
        shaped = {name: in_shape(value, answer.own.get(name), shape) for name, value in right.items()}
        for any_shape, used in self._shapes.items():
            used += [_shape_of(in_shape(value, answer.own.get(name), any_shape)) for name, value in right.items()]
        if shaped:
            execution.set(shaped)
        if not answer.is_right and asked.question.id in self._functions:
            execution.run(NotebookCell(None, "given", self._functions[asked.question.id], True))
        return shaped

    def _finish(self, retrial: _Retrial, examiner: Examiner) -> None:
        answer, key = retrial.answer, retrial.asked.key
        start = time.monotonic()
        attempt = retrial.attempt
        if attempt is None:
            attempt = examiner.judge_later(retrial.asked, retrial.known, self._as_columns(key))
        if attempt.verdict is not None:  # where the process ended, what the first run found stands
            wrong = list(self._wrong_before(key))
            replaced = replaced_for(answer, wrong, self._functions_of)
            answer.attempts.append(attempt.noted(replaced.beside_right(), replaced.before_wrong()))
            answer.causes = replaced.causes
        answer.seconds += time.monotonic() - start

    def _as_columns(self, key: int) -> bool:
        return any(differ_in_shape(other.own, other.right) for other in self._wrong_before(key))

    def _may_become_right(self, key: int) -> bool:
        """Whether an answer is wrong, and a name that an earlier wrong answer defines occurs on the way to it."""
        answer = self._answers[key]
        return not answer.is_right and not answer.crashed and any(True for _ in self._wrong_before(key))

    def _wrong_before(self, key: int) -> Iterator[Answer]:
        """The earlier answers that are not sound, if a name that is replaced for them occurs on the way to this one."""
        for other, names in zip(self._answers[:key], self._names, strict=False):
            between = self._mentioned[self._positions[other.asked.key] + 1 : self._positions[key]]
            if not other.is_sound and not all(map(names.isdisjoint, between)):
                yield other

    @cached_property
    def _mentioned(self) -> list[set[str]]:
        """Which of the names that may be replaced occur in each code cell."""
        names = frozenset().union(*self._names)
        sources = (done.cell.source if done.cell.code else "" for done in self._first_run)
        return [{word[0] for word in re.finditer(r"\b[^\W\d]\w*", source) if word[0] in names} for source in sources]

    @cached_property
    def _names(self) -> list[frozenset[str]]:
        """The names that are replaced for later steps, by answer."""
        return [
            frozenset((*wrong_names(answer.own, answer.right), *self._functions_of(answer))) for answer in self._answers
        ]

    def _functions_of(self, answer: Answer) -> tuple[str, ...]:
        return defined_functions(self._functions.get(answer.question.id, ""))


def _shape_of(value: Value) -> tuple[int, ...]:
    return value.shape if isinstance(value, np.ndarray) else ()


def _without_output(executed: ExecutedCell) -> ExecutedCell:
    """A cell without anything that could reveal the right values on which it ran."""
    cell, error = executed.cell, executed.reply.error
    if error is not None:
        kind, line = str(error.get("kind")), error.get("line")
        shown = {"kind": kind if hasattr(builtins, kind) else "an error", "text": ""}
        error = {**shown, "line": line} if line in range(1, cell.source.count("\n") + 2) else shown
    return replace(executed, reply=Reply(executed.reply.ok, None, error))
