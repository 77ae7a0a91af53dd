"""Checks that students run in the cells of a notebook."""

import time
from collections.abc import Iterable, Mapping, MutableMapping
from dataclasses import replace
from decimal import Decimal
from html import escape
from importlib import import_module
from pathlib import Path
from textwrap import wrap
from typing import Any

from labsid.checks.cell_runs import runs_in, shell_of
from labsid.checks.cells import Cell, answer_id, functions_asked_for, is_stub, steps_that_call
from labsid.checks.function_reads import made_without_return
from labsid.checks.hints import Hints
from labsid.checks.notebook_ask import NotebookAsk
from labsid.checks.notebook_file import open_notebook, released_template
from labsid.checks.notebook_tries import NotebookTries
from labsid.checks.origin_of_values import QuestionCells
from labsid.checks.question import Assignment, Question, given_values
from labsid.checks.summary import (
    FAILED,
    NOT_DONE,
    NOTED,
    PASSED,
    SIGNS,
    SKIPPED,
    decimal_text,
    sign_html,
    states_of,
    summary_html,
    summary_text,
)
from labsid.checks.values import Value, as_student_object
from labsid.checks.verdict import PYTHON_ERROR, NoAnswer, Verdict
from labsid.checks.written_values import typed_names
from labsid.records.record import load_record

_LINE = 95  # characters; JupyterLab breaks longer lines in the middle of a word
_FIRST_MESSAGE = "The first hint is the message of the check: run the check first."
OUTCOME = "labsid"
"""Key of the outcome of a check in the metadata of its output: the question and its state."""


class CheckFailed(Exception):
    """A check that did not pass. Jupyter shows only its text, without a traceback.

    Parameters
    ----------
    text : str
        The question and the reason.
    advice : str
        How to go on, on lines of its own; may be empty.
    """

    def __init__(self, text: str, advice: str = "") -> None:
        super().__init__(text)
        self.advice = advice

    def _render_traceback_(self) -> list[str]:
        sign = SIGNS[FAILED]
        first, *others = wrap(f"{sign} {self}", _LINE, subsequent_indent="  ")
        advice = wrap(self.advice, _LINE, initial_indent="  ", subsequent_indent="  ")
        return [first.replace(sign, f"\x1b[1;31m{sign}\x1b[0m", 1), *others, *advice]


class notebook_checks:  # noqa: N801  (called like a function, once, at the top of a notebook)
    """Open the checks of one assignment on the variables of a notebook.

    Parameters
    ----------
    assignment : str
        Name of the assignment, such as ``"lab-identification"``.
    variables : mapping
        The notebook's own variables: pass ``globals()``.
    record : str, Path or None
        Data file; None for the file that the assignment names.

    Raises
    ------
    ValueError
        If there is no such assignment, or its record cannot be read.

    Examples
    --------
    ``check = notebook_checks("lab-identification", globals())`` once, then ``check("lab-1c-offset")`` after a step,
    ``check.hint()`` for more than its message, ``check.practice("lab-1c-offset")`` for the same with new numbers,
    ``check.skip("lab-1c-offset")`` to go on without it, ``check.tries.keep()`` to keep a list of one's tries, and
    ``check.summary()`` at the end.
    """

    def __init__(self, assignment: str, variables: MutableMapping[str, Any], record: str | Path | None = None) -> None:
        self._assignment = load_assignment(assignment)
        path = record or self._assignment.record_file
        if path is not None and not Path(path).exists():
            raise ValueError(f"{path} is not in {Path.cwd()}. Copy your data file into the folder of this notebook.")
        self._record = None if path is None else load_record(path)
        self._variables = variables
        self._passed: dict[str, Mapping[str, Value]] = {}
        self._skipped: dict[str, Mapping[str, Value]] = {}
        self._set_by_skip: dict[str, Mapping[str, Any]] = {}
        self._states: dict[str, str] = {}
        self._hints = Hints(self._assignment)
        self._practised = 0
        self._shell = shell_of(variables)
        self._runs = None if self._shell is None else runs_in(self._shell)
        self.tries = NotebookTries(assignment, lambda text, html: self._display(text, html, {}))

    def __call__(self, question_id: str) -> None:
        """Check one question and print the result; raise `CheckFailed` with the reason if it is wrong."""
        question = self._assignment.question(question_id)
        cells = self._cells(question_id)
        run = None if cells is None else cells.answer
        source = "" if run is None else run.source
        ask = NotebookAsk(self._variables, self._record, self._known(), question_id, source)
        not_run = cells.not_run(question.outcome_of_mends(ask)) if cells is not None else None
        if not_run is None and self._still_skipped(question_id):
            self._show(SKIPPED, question_id, "you went on from the reference's value. It earns no marks.")
            return
        if not_run is not None:
            if cells is not None and cells.has_stopped:
                self._note_try(question_id, cells, PYTHON_ERROR)
            self._fail(question, not_run, cells)
        waiting = [used for used in question.uses if used not in self._passed and used not in self._skipped]
        if waiting:
            self._fail(question, f"it starts from {self._step(waiting[0])}, which is not right yet.", cells, waiting[0])
        verdict, remark = _judged(question, ask, cells)
        verdict = (
            self._unless_typed_in(question, ask, verdict) if verdict.passed else self._typed(question, ask, verdict)
        )
        self._note_try(question_id, cells, verdict.slip, verdict.passed, ask.names)
        if not verdict.passed:
            # several calls before a verdict: the last need not be the one that is wrong
            asks_for_values = question.gives is not None or question.reference is not None
            tried = "" if verdict.slip is not None or asks_for_values else ask.tried
            beside = ask.beside if verdict.slip in (None, PYTHON_ERROR) else ""
            reason = " ".join(filter(None, (verdict.reason, self._without_return(ask, verdict), beside, tried)))
            self._fail(question, reason, cells, mend=verdict.mend, names=ask.names)
        self._passed[question_id] = given_values(question, ask, passed=True)
        self._skipped.pop(question_id, None)
        self._set_by_skip.pop(question_id, None)
        self._hints.forget(question_id)
        state = NOTED if verdict.noted else PASSED
        self._show(state, question_id, " ".join(filter(None, (verdict.reason, remark))))

    def hint(self, question_id: str | None = None) -> None:
        """Show the next hint on a question: first where to look, then what to do.

        The next one comes when the answer has changed, or after two minutes. Hints cost no marks.

        Parameters
        ----------
        question_id : str, optional
            The question of the last check that failed, if it is not given.
        """
        asked = self._hints.last if question_id is None else self._assignment.question(question_id).id
        if asked is None:
            self._display(f"No check has failed yet. {_FIRST_MESSAGE}", "", {})
            return
        if asked in self._passed:
            self._show(PASSED, asked, "it is right; there is nothing to hint at.")
            return
        text = self._hints.next(asked, self._code_of(asked), time.monotonic(), self._has_practice(asked))
        said = f"{self._step(asked)}: {text or _FIRST_MESSAGE}"
        self._display(said, f"<b>{escape(self._step(asked))}</b>: {escape(text or _FIRST_MESSAGE)}", {})

    def practice(self, question_id: str | None = None) -> Any:
        """Make a small new instance of a question, and return it; without an id, list the questions that have one.

        Nothing of the notebook's is used or changed, and no marks depend on it.

        Parameters
        ----------
        question_id : str, optional

        Returns
        -------
        Exercise or None
            It shows what is given and asked, and ``check(...)`` judges an answer to it.
        """
        # not while the notebook's first cell runs: it imports the rigs
        from labsid.checks.practice import exercise_of, questions_with_practice

        if question_id is None:
            ids = "\n".join(
                f'  check.practice("{question.id}")' for question in questions_with_practice(self._assignment)
            )
            self._display(f"Practise with new numbers:\n{ids}", "", {})
            return None
        question = self._assignment.question(question_id)
        self._practised += 1
        exercise = exercise_of(self._assignment, question, self._practised)
        if exercise is None:
            raise CheckFailed(f"{question_id} has no numbers to practise with. check.practice() lists those that have.")
        self._display(str(exercise), "", {})
        return exercise

    def predict(self, prediction_id: str) -> None:
        """Ask what will happen, and show it with a slider on the notebook's own data once a prediction is chosen.

        No marks depend on it, and nothing of the notebook's is changed. Where widgets do not run, a still picture is
        shown.

        Parameters
        ----------
        prediction_id : str
        """
        from labsid.predictions.display import RUN_AGAIN, has_widget, prediction_data, text_of
        from labsid.predictions.prediction import Sources

        if self._shell is None:
            print(text_of(prediction_id))
            return
        data = prediction_data(prediction_id, Sources(self._record, self._variables))
        if has_widget(data):
            self._display(RUN_AGAIN, f"<small>{escape(RUN_AGAIN)}</small>", {})
        self._shell.display_pub.publish(data, metadata={})

    def _without_return(self, ask: "NotebookAsk", verdict: Verdict) -> str:
        """Which function without `return` made a value that the verdict says is nothing; empty if none did."""
        sources, _ = self._sources_and_typed(n for n in ask.names if f"`{n}`" in verdict.reason)
        told = (made_without_return(name, texts, self._variables) for name, texts in sources.items())
        return next(filter(None, told), "") if "nothing (None)" in verdict.reason else ""

    def _has_practice(self, question_id: str) -> bool:
        from labsid.checks.practice import exercise_of

        return exercise_of(self._assignment, self._assignment.question(question_id), 0) is not None

    def _unless_typed_in(self, question: Question, ask: "NotebookAsk", verdict: Verdict) -> Verdict:
        """The verdict; a right value that was typed in, and is wrong on another record, is not right."""
        if self._runs is None:
            return verdict
        from labsid.checks.typed_values import told, wrong_elsewhere  # simulates rigs
        from labsid.checks.written_numbers import numbers_in_texts, numbers_that_count, told_of_numbers

        sources, typed = self._sources_and_typed(ask.names)
        if wrong_elsewhere(question, self._assignment, self._record, typed, self._variables, ask.call):
            return told(typed)
        written = {name: numbers_in_texts(texts) for name, texts in sources.items()}
        counted = numbers_that_count(question, self._assignment, ask, written)
        return told_of_numbers(counted) if counted else verdict

    def _typed(self, question: Question, ask: "NotebookAsk", verdict: Verdict) -> Verdict:
        """The verdict on a wrong answer; if it names a value that was typed in, and no cause, with that cause."""
        if verdict.slip is not None or question.follows_from.may_be_typed or self._runs is None:
            return verdict
        from labsid.checks.typed_values import told_of_wrong

        _, typed = self._sources_and_typed(name for name in ask.names if f"`{name}`" in verdict.reason)
        return told_of_wrong(typed, verdict.reason) if typed else verdict

    def _sources_and_typed(self, names: Iterable[str]) -> tuple[dict[str, list[str]], list[str]]:
        """The cells that made each of these values, and the names of those that were typed in."""
        if self._runs is None:
            return {}, []
        sources = {name: self._runs.sources_of(name) for name in dict.fromkeys(names)}
        return sources, [name for name, texts in sources.items() if typed_names(texts, [name])]

    def skip(self, question_id: str) -> None:
        """Go on without a question: the reference's values, on this notebook's record, become the notebook's variables.

        The question earns no marks, here and at grading. Questions from which it starts, and which are not right
        either, are skipped with it.

        Parameters
        ----------
        question_id : str

        Raises
        ------
        CheckFailed
            If the reference's values cannot be had in the notebook.
        """
        question = self._assignment.question(question_id)
        if question_id in self._passed:
            self._show(PASSED, question_id, "it is right; nothing is skipped.")
            return
        for used in question.uses:
            if used not in self._passed and used not in self._skipped:
                self.skip(used)
        values: Mapping[str, Value] = {}
        if question.gives is not None:
            try:
                values = question.gives(NotebookAsk(self._variables, self._record, self._known(), question_id))
            except (NoAnswer, ValueError, ArithmeticError, LookupError) as error:
                raise CheckFailed(f"{self._name(question_id)} cannot be skipped: {error}") from None
        objects = {name: as_student_object(value) for name, value in values.items()}
        self._skipped[question_id] = values
        self._set_by_skip[question_id] = objects
        self._variables.update(objects)
        names = ", ".join(f"`{name}`" for name in objects)
        where = "" if self._record is None else " on your record"
        now = f"The notebook now has the reference's {names}{where}" if names else "It sets no variable for later steps"
        beside = self._on_functions(question_id, objects)
        self._show(SKIPPED, question_id, " ".join(filter(None, (f"skipped. It earns no marks. {now}.", beside))))

    def _on_functions(self, question_id: str, given: Iterable[str]) -> str:
        """What a skipped step asks for and does not get: functions, which would be the solution. Empty without any."""
        file = open_notebook(self._assignment.name)
        template = released_template(self._assignment.name) or (None if file is None else file.template)
        asked = () if template is None else functions_asked_for(template, question_id)
        missing = [name for name in asked if name not in given]
        if template is None or not missing:
            return ""
        steps = dict.fromkeys(step for name in missing for step in steps_that_call(template, name))
        where = f" (here: {'; '.join(steps)})" if steps else ""
        names = " and ".join(f"`{name}`" for name in missing)
        return f"A function is not given: code that calls {names}{where} needs one of your own."

    def summary(self) -> None:
        """Show every question of the assignment: right, not right, skipped or not done, with its marks."""
        file = open_notebook(self._assignment.name)
        questions = self._questions()
        by_hand = {cell.id for cell in questions if cell.kind == "manual"}  # of the others, the cells as run are known
        saved = {} if file is None else {name: text for name, text in file.sources.items() if name in by_hand}
        states = states_of(questions, self._states | self._states_of_tests(questions), saved)
        title = f"{self._assignment.name}: what the checks found in this run of the notebook"
        self._display(summary_text(title, states), summary_html(title, states), {})

    def _states_of_tests(self, questions: Iterable[Cell]) -> dict[str, str]:
        """How the test cells of nbgrader ended that have been run."""
        checked = {question.id for question in self._assignment.questions}
        tests = [cell.id for cell in questions if cell.kind == "tests" and cell.id not in checked]
        runs = [run for run in map(self._runs.last, tests) if run is not None] if self._runs is not None else []
        return {str(run.cell_id): FAILED if run.error else PASSED for run in runs}

    def _known(self) -> dict[str, Value]:
        values = {**self._skipped, **self._passed}
        in_order = (values[question.id] for question in self._assignment.questions if question.id in values)
        return {name: value for gives in in_order for name, value in gives.items()}

    def _still_skipped(self, question_id: str) -> bool:
        """Whether the variables are still those that `skip` set."""
        objects = self._set_by_skip.get(question_id) or {}
        return bool(objects) and all(self._variables.get(name) is value for name, value in objects.items())

    def _fail(
        self,
        question: Question,
        reason: str,
        cells: QuestionCells | None,
        skip: str = "",
        mend: str = "",
        names: Iterable[str] = (),
    ) -> None:
        self._passed.pop(question.id, None)
        run = None if cells is None else cells.answer
        self._states[question.id] = NOT_DONE if run is not None and is_stub(run.source) else FAILED
        if skip:
            advice = f'To go on without it, run check.skip("{skip}") in a new cell below: it earns no marks.'
        else:
            self._hints.failed(question.id, mend, tuple(names), self._code_of(question.id, names), time.monotonic())
            advice = "For a hint, run check.hint() in a new cell below."
        deleted = None if cells is None else cells.deleted_lines(released_template(self._assignment.name))
        told = " ".join(filter(None, (reason, deleted)))
        raise CheckFailed(f"{self._name(question.id)}: {told}", advice)

    def _note_try(
        self,
        question_id: str,
        cells: QuestionCells | None,
        slip: str | None,
        right: bool = False,
        names: Iterable[str] = (),
    ) -> None:
        """Keep a try, if the student chose so; an answer cell as it was released is none."""
        run = None if cells is None else cells.answer
        if run is None or not is_stub(run.source):
            self.tries.note(question_id, right, slip, self._code_of(question_id, tuple(names)))

    def _show(self, state: str, question_id: str, text: str) -> None:
        self._states[question_id] = state
        name = self._name(question_id)
        html = f"{sign_html(state)} <b>{escape(name)}</b>: {escape(text)}"
        self._display(f"{SIGNS[state]} {name}: {text}", html, {"question": question_id, "state": state})

    def _display(self, text: str, html: str, outcome: dict[str, str]) -> None:
        if self._shell is None:
            print(text)
            return
        data = {"text/plain": text, "text/html": html} if html else {"text/plain": text}
        self._shell.display_pub.publish(data, metadata={OUTCOME: outcome})

    def _code_of(self, question_id: str, names: Iterable[str] = ()) -> tuple[str, ...] | None:
        """The code of an answer: the last runs of its cell and of those that assign its names.

        None without IPython, where nothing tells two answers apart.
        """
        if self._runs is None:
            return None
        own = self._runs.last(answer_id(question_id))
        named = (self._runs.assigning(name) for name in (names or self._hints.names(question_id)))
        made = [run.source for runs in named for run in runs[-1:]]
        return ("" if own is None else own.source, *made)

    def _cells(self, question_id: str) -> QuestionCells | None:
        if self._runs is None:
            return None
        file = open_notebook(self._assignment.name)
        template = released_template(self._assignment.name) if file is None else file.template
        return QuestionCells(question_id, self._runs, file, template, self._variables)

    def _questions(self) -> tuple[Cell, ...]:
        """The questions with their marks, from the notebook's file or the release; without either, with no marks."""
        file = open_notebook(self._assignment.name)
        template = released_template(self._assignment.name) if file is None else file.template
        known = {} if template is None else {cell.id: cell for cell in template.questions}
        if {question.id for question in self._assignment.questions} <= set(known):
            return tuple(known.values())
        return tuple(
            Cell(question.id, "question", "", True, Decimal(0)) for question in self._assignment.questions
        )  # fmt: skip

    def _name(self, question_id: str) -> str:
        """A question as its messages begin: its id, its step and its marks."""
        cell = self._cell(question_id)
        return question_id if cell is None else f"{question_id} ({cell.heading}; {marks_text(cell.points)})"

    def _step(self, question_id: str) -> str:
        """A question as other messages call it: its id and its step."""
        cell = self._cell(question_id)
        return question_id if cell is None else f"{question_id} ({cell.heading})"

    def _cell(self, question_id: str) -> Cell | None:
        return next((cell for cell in self._questions() if cell.id == question_id and cell.heading), None)


def marks_text(points: Decimal | None) -> str:
    """Marks in words."""
    return "1 mark" if points == 1 else f"{decimal_text(points or Decimal(0))} marks"


def _judged(question: Question, ask: "NotebookAsk", cells: QuestionCells | None) -> tuple[Verdict, str]:
    """The verdict, and a remark for a right answer; what grading would not see or would refuse is not right."""
    verdict = question.verdict(ask)
    if cells is None:
        return verdict, ""
    wrong = next(filter(None, (cells.wrong_origin(name, verdict.passed) for name in ask.names)), None)
    if wrong is None:
        if verdict.passed:
            wrong = cells.refused() or cells.made_below()
        else:
            wrong = cells.stopped_before(ask.names, verdict.slip, question.outcome_of_mends(ask))
    if wrong is not None:
        return replace(verdict, passed=False, reason=wrong, slip=None), ""
    return verdict, cells.remark(ask.names)


def load_assignment(name: str) -> Assignment:
    """The automatic questions of an assignment; `ValueError` lists the valid names."""
    names = assignment_names()
    if name not in names:
        raise ValueError(f"there is no assignment {name!r}; there are {', '.join(names)}.")
    module = import_module(f"labsid.checks.assignments.{name.replace('-', '_')}")
    assignment: Assignment = module.ASSIGNMENT
    return assignment


def find_assignment(name: str) -> Assignment:
    """The automatic questions of an assignment; none if it has no checks, but tests of nbgrader alone."""
    return load_assignment(name) if name in assignment_names() else Assignment(name, ())


def assignment_names() -> list[str]:
    """Names of the assignments that have checks."""
    folders = (Path(__file__).parent / "assignments").glob("[a-z]*/__init__.py")
    return sorted(path.parent.name.replace("_", "-") for path in folders)
