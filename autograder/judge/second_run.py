"""The second run of a notebook, in which right values and functions replace wrong ones.

It judges only what the first run left wrong. What its cells print is not kept, because they run on right values.

Each question is judged before anything of it, or of a later one, is set or served in any process of this hand-in. So
nothing that student code does with right values or functions can raise the mark of the question they belong to.
"""

import builtins
import contextlib
import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

import numpy as np

from autograder.judge.answer import Answer
from autograder.judge.ask import AskOpener
from autograder.judge.attempt import Attempt
from autograder.judge.carrying import (
    Shape,
    differ_in_shape,
    has_shape_of,
    in_shape,
    is_row,
    is_signal,
    wrong_names,
)
from autograder.judge.examiner import Examination, Examiner
from autograder.judge.execution import ExecutedCell, Execution, with_replacements
from autograder.judge.places import Places
from autograder.judge.replaced import replaced_for
from autograder.judge.served_functions import RightFunctions
from autograder.sandbox.isolation import ProcessLauncher, Reply, StudentProcessError
from autograder.sandbox.replacing import Replacement
from labsid.checks.values import Value


@dataclass(frozen=True, slots=True, eq=False)
class _Carried:
    """What replaces one wrong answer.

    `right` holds the values as the check gives them, `replacement` in the student's shape, which may be `in_doubt`.
    """

    question: str
    right: Mapping[str, Value]
    in_doubt: bool
    replacement: Replacement

    def in_shape(self, shape: Shape) -> "_Carried":
        """The same with right values in another shape, which is not in doubt."""
        right = {name: in_shape(value, None, shape) for name, value in self.right.items()}
        return replace(self, in_doubt=False, replacement=replace(self.replacement, right=right))


class SecondRun:
    """Judges the answers that are wrong in the first run, and may be right after right answers.

    Parameters
    ----------
    first_run : sequence of ExecutedCell
        All cells of the submission, as they ran.
    answers : sequence of Answer
        One for each question cell, judged in the first run; attempts are added to them.
    functions : RightFunctions
    asks : AskOpener
    launcher : ProcessLauncher
    folder : Path
        The files of the student's work folder.
    """

    def __init__(
        self,
        first_run: Sequence[ExecutedCell],
        answers: Sequence[Answer],
        functions: RightFunctions,
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
        self._was_right = [answer.is_right for answer in answers]
        self._deadline = 0.0
        self._known: dict[str, Value] = {}
        self._carried: list[_Carried] = []

    def judge(self, deadline: float) -> None:
        """Judge until the deadline, question by question."""
        waiting = [key for key in range(len(self._answers)) if self._may_become_right(key)]
        if not waiting:
            return
        self._deadline = deadline
        with contextlib.suppress(StudentProcessError):  # no process: what was found so far stands
            execution = Execution(self._launcher, self._folder, deadline, self._functions)
            with contextlib.closing(self._functions), contextlib.closing(execution):
                self._run(execution, waiting)

    def _run(self, execution: Execution, waiting: Sequence[int]) -> None:
        """Run the cells up to the last answer that waits; judge each of these, and only then replace it."""
        examiner = Examiner(execution, self._asks, self._launcher.limits)
        cells: list[ExecutedCell] = []
        answers = iter(enumerate(self._answers))
        for first in self._first_run[: self._places.checks[waiting[-1]] + 1]:
            cell = first.cell
            if first.failure is None:
                done = _without_output(execution.run(cell))
                if cell.kind in ("answer", "extra") and cell.code:
                    cells.append(done)
            if cell.kind == "tests":
                cells = []
            if cell.kind != "question":
                continue
            if time.monotonic() > self._deadline:
                return
            key, answer = next(answers)
            asked = Examination(key, answer.question, cells)
            cells = []
            if answer.is_sound:
                self._keep(asked, execution, examiner)
            else:
                passed = self._judge(asked, execution, examiner) if key in waiting else None
                self._carry(execution, examiner, passed or asked, passed is not None)
            self._functions.start_question()

    def _keep(self, asked: Examination, execution: Execution, examiner: Examiner) -> None:
        """Go on from the values of a right answer: those that were judged, or that follow from right ones by now."""
        answer = self._answers[asked.key]
        # an object may answer differently each time: it is read as often as in the first run
        examiner.own_values(asked, answer.asked.values)
        execution.read_variables(*answer.asked.values)
        carried = dict(answer.carried)
        if answer.right and any(True for _ in self._wrong_before(asked.key)):
            attempt = examiner.judge_here(asked, self._known, self._as_columns(asked.key))
            if attempt.passed:
                carried |= {name: value for name, value in asked.values.items() if name in carried}
        self._known.update(carried)

    def _judge(self, asked: Examination, execution: Execution, examiner: Examiner) -> Examination | None:
        """Judge an answer on right values of the earlier ones; the examination in which it is right, if any."""
        answer, start = self._answers[asked.key], time.monotonic()
        attempt = examiner.judge_here(asked, self._known, self._as_columns(asked.key))
        if not attempt.passed:
            attempt, asked = self._in_other_shapes(attempt, asked, execution, examiner)
        if attempt.verdict is not None:  # where the process ended, what the first run found stands
            replaced = replaced_for(answer, list(self._wrong_before(asked.key)), self._functions_of)
            answer.attempts.append(attempt.noted(replaced.beside_right(), replaced.before_wrong()))
            if attempt.passed:
                answer.causes = replaced.causes
        answer.seconds += time.monotonic() - start
        return asked if attempt.passed else None

    def _in_other_shapes(
        self, attempt: Attempt, asked: Examination, execution: Execution, examiner: Examiner
    ) -> tuple[Attempt, Examination]:
        """Judge a wrong answer again with right values in other shapes, where the student's own do not tell it.

        The run goes on with the shape in which the answer is right, and otherwise as it was.
        """
        answer, carried, known, actions = self._answers[asked.key], self._carried, self._known, execution.actions
        used = [step for step in carried if step.question in answer.question.uses or any(map(answer.reads, step.right))]
        if not any(step.in_doubt for step in used):
            return attempt, asked
        tried = [self._shapes()]
        for shape in (Shape.FLAT, Shape.COLUMN):
            self._carried = [step.in_shape(shape) if step.in_doubt else step for step in carried]
            if self._shapes() in tried:
                continue
            tried.append(self._shapes())
            self._known = known | {
                name: value for step in self._carried for name, value in step.replacement.right.items()
            }
            new = {
                id(old.replacement): new_step.replacement for old, new_step in zip(carried, self._carried, strict=True)
            }
            execution.do_again([with_replacements(action, new) for action in actions])
            again = Examination(asked.key, asked.question, asked.cells)
            verdict = examiner.judge_here(again, self._known, self._as_columns(asked.key))
            if verdict.passed:
                return verdict, again
        self._carried, self._known = carried, known
        if len(tried) > 1:
            execution.do_again(actions)
        return attempt, asked

    def _carry(self, execution: Execution, examiner: Examiner, asked: Examination, passed: bool) -> None:
        """Set what later steps start from: the student's own values and functions if they are right, or right ones."""
        answer = self._answers[asked.key]
        right = dict(answer.accepted) if self._was_right[asked.key] else examiner.right_values(asked, self._known)
        own = examiner.own_values(asked, right)
        if passed:
            execution.read_variables(*right)
            self._known.update(right | own)
            return
        signal = next(filter(is_signal, self._known.values()), None)
        style = {name: own.get(name, answer.own.get(name, signal)) for name in right}
        shaped = {name: in_shape(value, style[name], Shape.OWN) for name, value in right.items()}
        called = self._places.read_after(asked.key)
        functions = () if answer.is_right else tuple(name for name in self._functions_of(answer) if name in called)
        kept = (self._all_names | self._places.given) - right.keys() - set(functions)
        replacement = Replacement(shaped, own, functions, kept)
        in_doubt = any(is_signal(value) and not has_shape_of(own.get(name), value) for name, value in right.items())
        self._carried.append(_Carried(asked.question.id, right, in_doubt, replacement))
        self._known.update({name: right[name] if is_row(value) else value for name, value in shaped.items()})
        if not replacement.names:
            return
        if self._places.goes_on_from(asked.key):
            execution.replace_where_made(replacement)
        else:
            execution.replace(replacement)

    def _as_columns(self, key: int) -> bool:
        return any(differ_in_shape(other.own, other.right) for other in self._wrong_before(key))

    def _may_become_right(self, key: int) -> bool:
        """Whether an answer is wrong, and its code starts from what an earlier wrong answer makes."""
        answer = self._answers[key]
        return not answer.is_right and not answer.crashed and any(True for _ in self._wrong_before(key))

    def _wrong_before(self, key: int) -> Iterator[Answer]:
        """The earlier answers that are not sound, and from which this one starts."""
        for other in self._answers[:key]:
            if not other.is_sound and self._places.starts_from(key, other.asked.key):
                yield other

    @cached_property
    def _places(self) -> Places:
        return Places(self._first_run, self._answers, self._names)

    @cached_property
    def _names(self) -> list[frozenset[str]]:
        """The names that are replaced for later steps, by answer."""
        return [
            frozenset((*wrong_names(answer.own, answer.right), *self._functions_of(answer))) for answer in self._answers
        ]

    @cached_property
    def _all_names(self) -> frozenset[str]:
        """The names that any question asks for or gives."""
        return (
            frozenset()
            .union(*self._names, *(other.right for other in self._answers))
            .union(*(other.asked.values for other in self._answers))
        )

    def _functions_of(self, answer: Answer) -> tuple[str, ...]:
        return self._functions.names(answer.question.id)

    def _shapes(self) -> list[tuple[int, ...]]:
        values = (value for one in self._carried for value in one.replacement.right.values())
        return [value.shape for value in values if isinstance(value, np.ndarray)]


def _without_output(executed: ExecutedCell) -> ExecutedCell:
    """A cell without anything that could reveal the right values on which it ran."""
    cell, error = executed.cell, executed.reply.error
    if error is not None:
        kind, line = str(error.get("kind")), error.get("line")
        shown = {"kind": kind if hasattr(builtins, kind) else "an error", "text": ""}
        error = {**shown, "line": line} if line in range(1, cell.source.count("\n") + 2) else shown
    return replace(executed, reply=Reply(executed.reply.ok, None, error))
