"""Judges questions in one run of a notebook: values at their question, functions after the last cell."""

import contextlib
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from autograder.judge.ask import AskOpener, CallDeferred, ProcessAsk
from autograder.judge.attempt import Attempt, judged
from autograder.judge.execution import ExecutedCell, Execution
from autograder.sandbox.isolation import Limits, MachineError, StudentProcess, StudentProcessError
from labsid.checks.question import Question
from labsid.checks.values import Value, in_double_precision
from labsid.checks.verdict import NoAnswer, Verdict


@dataclass(slots=True)
class Examination:
    """A question in one run of the notebook.

    Attributes
    ----------
    key : int
        The key under which the variables at the question are saved.
    question : Question
    cells : sequence of ExecutedCell
        The cells of its answer, as they ran.
    values : dict
        The variables read so far.
    """

    key: int
    question: Question
    cells: Sequence[ExecutedCell]
    values: dict[str, Value] = field(default_factory=dict)


class Examiner:
    """Judges questions in the processes of one execution.

    Functions receive hidden inputs, which no later output may reveal: they are called after the last cell, when the
    variables are again those of the question.
    """

    def __init__(self, execution: Execution, asks: AskOpener, limits: Limits) -> None:
        self._execution = execution
        self._asks = asks
        self._limits = limits

    def judge_now(self, one: Examination, known: Mapping[str, Value], as_columns: bool = False) -> Attempt | None:
        """Judge in the present state; None if the check calls a function.

        The variables are saved for `judge_later`, unless the answer is right whatever the earlier ones are.
        """
        try:
            attempt = self._attempt(one, self._open(one, self._present, known, True, as_columns))
        except CallDeferred:
            attempt = None
        if attempt is None or not attempt.passed or one.question.uses:
            self._execution.save_variables(one.key)
        return attempt

    def judge_here(self, one: Examination, known: Mapping[str, Value], as_columns: bool = False) -> Attempt:
        """Judge in the present state, and call functions in it: nothing that later cells print is kept."""
        self._execution.extend_deadline(self._limits.call_seconds)
        return self._attempt(one, self._open(one, self._present, known, False, as_columns))

    def judge_later(self, one: Examination, known: Mapping[str, Value], as_columns: bool = False) -> Attempt:
        """Judge after the last cell, with the variables as they were at the question."""
        if self._execution.process.lost:  # the cells have used up the time of the submission
            self._execution.extend_deadline(self._limits.cell_seconds)
            self._execution.restart()
        self._execution.extend_deadline(self._limits.call_seconds)
        try:
            changed = self._execution.restore_variables(one.key)
        except StudentProcessError as failure:
            if self._execution.process.lost:
                self._execution.restart()
            return Attempt(None, failure)
        attempt = self._attempt(one, self._open(one, self._present, known, False, as_columns))
        if changed and attempt.verdict is not None and not attempt.passed:
            attempt = self._judge_replayed(one, known, as_columns) or attempt
        return attempt.noted("", self._execution.said_of_left_out())

    def right_values(self, one: Examination, known: Mapping[str, Value]) -> dict[str, Value]:
        """The right values of the variables that later steps use; empty if they cannot be computed."""
        if one.question.gives is None:
            return {}
        try:
            with np.errstate(all="ignore"):
                return one.question.gives(self._open(one, self._present, known, True, False))
        except Exception:  # the questions that need these values will report that they could not be judged
            return {}

    def own_values(self, one: Examination, names: Iterable[str]) -> dict[str, Value]:
        """The student's values of these variables in the present state, as far as there are any."""
        ask = self._open(one, self._present, {}, True, False)
        found: dict[str, Value] = {}
        for name in names:
            try:
                found[name] = in_double_precision(ask.value(name))
            except NoAnswer:
                continue
            except StudentProcessError:
                self._execution.restart()
        return found

    def _present(self) -> StudentProcess:
        return self._execution.process

    def _open(
        self,
        one: Examination,
        process: Callable[[], StudentProcess],
        known: Mapping[str, Value],
        defer_calls: bool,
        as_columns: bool,
    ) -> ProcessAsk:
        return self._asks.open(one.question.id, process, known, one.values, defer_calls, as_columns)

    def _judge_replayed(self, one: Examination, known: Mapping[str, Value], as_columns: bool) -> Attempt | None:
        """Judge in a process without the later cells, which have modified variables in place; None if that fails."""
        try:
            with contextlib.closing(self._execution.replayed(one.key)) as process:
                ask = self._open(one, lambda: process, known, False, as_columns)
                return self._judged(one, ask)
        except MachineError:
            raise
        except Exception:  # the process ended, or the check is broken: the first verdict stands
            return None

    def _attempt(self, one: Examination, ask: ProcessAsk) -> Attempt:
        try:
            return self._judged(one, ask)
        except StudentProcessError as failure:
            if self._execution.process.lost:
                self._execution.restart()
            return Attempt(None, failure)
        except Exception as error:  # a broken check must not affect the other questions
            text = f"This answer could not be judged ({type(error).__name__}). Tell your instructor."
            return judged(Verdict(False, text), one.cells, broken=True)

    def _judged(self, one: Examination, ask: ProcessAsk) -> Attempt:
        with np.errstate(all="ignore"):  # what follows from wrong values may divide by zero
            return judged(one.question.verdict(ask), one.cells, ask.got_nothing)
