"""Runs of a notebook on records that nobody has seen: an answer that follows from the data is right on these, too.

A value that was typed in is right on the student's own record and wrong on another. An answer that is wrong on the
second record is tried on a third, so that honest code is not refused by bad luck. A hidden run never raises a mark, and
nothing of it is shown but the number of the line that stopped.
"""

import hashlib
import hmac
import time
from collections.abc import Callable, Mapping
from contextlib import nullcontext
from dataclasses import dataclass, replace
from decimal import Decimal
from pathlib import Path

from autograder.intake.submission import NotebookCell, Submission
from autograder.judge.answer import Answer
from autograder.judge.needed_cells import cells_needed, draws_known_values
from autograder.judge.notebook import Assets, JudgedNotebook
from autograder.judge.outcome import QuestionResult
from autograder.judge.waiting_record import WaitingRecord
from autograder.sandbox.isolation import ProcessLauncher
from labsid.checks.other_records import another_record, can_be_drawn
from labsid.checks.question import FollowsFrom
from labsid.plots.figure_values import FigureValue
from labsid.records.record import load_record

TYPED_IN = "This value fits your record only: compute it from the record."
STOPPED = "On another record your code for this step stops{line}: it must work on any record of this kind."
SECOND, THIRD = 2, 3

JudgeOn = Callable[[Submission, Assets, Path, ProcessLauncher], JudgedNotebook]
"""Judges a notebook on another record, with the files of a folder."""


@dataclass(frozen=True, slots=True)
class Confirmed:
    """The results of a submission after its hidden runs.

    Attributes
    ----------
    results : tuple of QuestionResult
    runs : int
        Hidden records on which it ran.
    flags : tuple of str
        Remarks for the instructor.
    """

    results: tuple[QuestionResult, ...]
    runs: int = 0
    flags: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class _Found:
    """What a hidden run found of one answer: right, or wrong for a reason."""

    is_right: bool
    reason: str


def second_record_of(assets: Assets) -> str:
    """Whether answers are tried on hidden records: "run", "off", or empty if none take the place of the student's."""
    name = assets.assignment.record_file
    if assets.record is None or name is None or not can_be_drawn(name):
        return ""
    return "run" if assets.second_record else "off"


def draw_second_record(submission: Submission, assets: Assets, launcher: ProcessLauncher) -> WaitingRecord:
    """Begin to draw the record of the second run, while the notebook runs on the student's own."""
    return _drawn(submission, assets, launcher, SECOND)


def confirm_on_hidden_records(
    submission: Submission,
    judged: JudgedNotebook,
    assets: Assets,
    judge_on: JudgeOn,
    second: WaitingRecord,
    launcher: ProcessLauncher,
) -> Confirmed:
    """Run a judged notebook on hidden records, and refuse the answers that are right on the student's own record alone.

    Parameters
    ----------
    submission : Submission
    judged : JudgedNotebook
        On the student's own record.
    assets : Assets
        With which it was judged. The secret seeds the records: the same for the same hand-in, others for every other.
    judge_on : callable
    second : WaitingRecord
        The record of the second run.
    launcher : ProcessLauncher

    Returns
    -------
    Confirmed
    """
    results = judged.results()
    at_stake = {answer.question.id for answer in judged.answers if _is_at_stake(answer)}
    refused: dict[str, _Found] = {}
    asked, runs = at_stake, 0
    flags: tuple[str, ...] = ()
    seconds = dict.fromkeys(at_stake, 0.0)
    for number in (SECOND, THIRD):
        if not asked:
            break
        began = time.monotonic()
        # the second run is shortened, as it finds most answers right; the third, which decides, is whole
        cells = (_shortened(judged, asked) if number == SECOND else None) or _whole(judged, asked)
        seed = record_seed(assets.secret, submission, number)
        with nullcontext(second) if number == SECOND else _drawn(submission, assets, launcher, number) as record:
            try:
                record.content()
            except ValueError as error:
                refused, flags = {}, (*flags, f"not run on another record: {error}")
                break
            runs += 1
            by_question = _run(record, seed, assets, judge_on, replace(submission, cells=cells))
        wrong = {
            question: result for question, result in by_question.items() if question in asked and not result.is_right
        }
        for question in asked:
            seconds[question] += (time.monotonic() - began) / len(asked)
        lucky = [result.question for result in results if result.question in refused and result.question not in wrong]
        if lucky:
            flags += (f"right on a third record, not on the second: {', '.join(lucky)}",)
        refused, asked = wrong, set(wrong)
    lost = [result.question for result in results if result.question in refused]
    if lost:
        flags += (f"right on the student's own record alone: {', '.join(lost)}",)
    return Confirmed(tuple(_with(result, refused, seconds) for result in results), runs, flags)


def record_seed(secret: bytes, submission: Submission, number: int) -> bytes:
    """The seed of a hidden record: HMAC(secret, student, assignment, hash of the hand-in, number)."""
    work = hashlib.sha256()
    for cell in submission.cells:
        if cell.code and cell.kind in ("answer", "extra"):
            source = cell.source.encode(errors="surrogatepass")
            work.update(f"{cell.id or ''}\0{len(source)}\0".encode(errors="surrogatepass") + source)
    identity = f"another record\0{submission.student}\0{submission.assignment}\0{work.hexdigest()}\0{number}"
    return hmac.digest(secret, identity.encode(errors="surrogatepass"), hashlib.sha256)


def _is_at_stake(answer: Answer) -> bool:
    """Whether an answer is right on the student's own record, and its check read a variable that follows from it."""
    return answer.is_right and answer.question.follows_from is FollowsFrom.DATA and bool(answer.asked.values)


def _drawn(submission: Submission, assets: Assets, launcher: ProcessLauncher, number: int) -> WaitingRecord:
    seed = record_seed(assets.secret, submission, number)
    return WaitingRecord(lambda: _hidden_file(assets, seed), assets.assignment.record_file or "", launcher)


def _hidden_file(assets: Assets, seed: bytes) -> bytes:
    """The data file of a hidden record; `ValueError` if none can be drawn in the place of the student's own."""
    if assets.record is None or assets.assignment.record_file is None:
        raise ValueError("this assignment has no record")
    return another_record(assets.assignment.record_file, assets.record, int.from_bytes(seed, "big"))


def _whole(judged: JudgedNotebook, asked: set[str]) -> tuple[NotebookCell, ...]:
    """The cells up to the last question that is asked for, without those that ended the student's process before."""
    cells: list[NotebookCell] = []
    length = 0
    for done in judged.executed:
        if done.failure is None and done.cell.kind not in ("manual", "tests"):
            cells.append(done.cell)
        if done.cell.kind == "question" and done.cell.id in asked:
            length = len(cells)
    return tuple(cells[:length])


def _shortened(judged: JudgedNotebook, asked: set[str]) -> tuple[NotebookCell, ...] | None:
    """The cells on which these questions depend; None if an answer is wrong, after which right values go on."""
    if not all(answer.is_right for answer in judged.answers):
        return None
    read = {answer.question.id: tuple(answer.asked.values) for answer in judged.answers}
    cells = _whole(judged, asked)
    figures = {answer.question.id for answer in judged.answers if _is_figure(answer)} & asked
    known = {name for question in asked - figures for name in read[question]}
    drawn = {question for question in figures if draws_known_values(cells, question, known)}
    needed = asked - drawn
    for answer in reversed(judged.answers):
        if answer.question.id in needed:
            needed |= set(answer.question.uses)
    return cells_needed(cells, needed, read)


def _is_figure(answer: Answer) -> bool:
    return any(isinstance(value, FigureValue) for value in answer.asked.values.values())


def _run(
    record: WaitingRecord, seed: bytes, assets: Assets, judge_on: JudgeOn, submission: Submission
) -> Mapping[str, _Found]:
    """Judge on one hidden record, in a work folder of its own; what the hidden run found, by question."""
    # other inputs of functions, too: the seed takes the place of the secret
    own = load_record(record.folder / (assets.assignment.record_file or ""))
    hidden = replace(assets, record=own, secret=seed, origin=None)
    answers = judge_on(submission, hidden, record.folder, record.launcher()).answers
    return {answer.question.id: _Found(answer.is_right, _reason(answer)) for answer in answers}


def _reason(answer: Answer) -> str:
    """Why an answer is refused: a fixed sentence, and the number of the line that stopped."""
    stopped = next((done for done in answer.asked.cells if done.failure or done.reply.error is not None), None)
    if stopped is None:
        return TYPED_IN
    line = (stopped.reply.error or {}).get("line")
    is_line = isinstance(line, int) and 1 <= line <= stopped.cell.source.count("\n") + 1
    return STOPPED.format(line=f" in line {line}" if is_line else "")


def _with(result: QuestionResult, refused: Mapping[str, _Found], seconds: Mapping[str, float]) -> QuestionResult:
    result = replace(result, seconds=result.seconds + seconds.get(result.question, 0.0))
    if result.question not in refused:
        return result
    return replace(result, score=Decimal(0), reason=refused[result.question].reason, slip=None)
