"""The work on one hand-in: read it, execute and judge it, compare it with others; all of it within limits."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path

from autograder.batch.grading_inputs import DataStore, GradingInputs
from autograder.batch.judge_process import JudgeError, JudgePool, JudgeProcess
from autograder.batch.judge_worker import CPU_SECONDS
from autograder.batch.tasks import Executor, Task, refused_result
from autograder.batch.wrong_record import flag_wrong_record
from autograder.intake.submission import Submission, read_submission
from autograder.judge.outcome import SubmissionResult, ungraded_result
from autograder.results.copied import Copied, find_copied
from autograder.results.similar import code_fingerprints
from autograder.sandbox.isolation import MachineError
from labsid.checks.cells import Template

ATTEMPTS = 2
"""How often a hand-in is tried in one run if the machine fails; the next run tries again."""

CPU_SECONDS_PER_RECORD = 1.0
"""Additional processor time for each record of the class that a hand-in is compared with; measured: 0.05 s."""


@dataclass(frozen=True, slots=True)
class HandIn:
    """One hand-in, and what it is graded with.

    Attributes
    ----------
    student : str
    template : Template
        The released assignment.
    folder : Path
        ``<submitted>/<student>/<assignment>``; may be missing.
    inputs : GradingInputs
        The student's.
    refused : Submission or None
        A quarantined submission, if there is a reason not to read it.
    """

    student: str
    template: Template
    folder: Path
    inputs: GradingInputs
    refused: Submission | None = None


@dataclass(frozen=True, slots=True)
class Judged:
    """A judged hand-in.

    Attributes
    ----------
    result : SubmissionResult
    work : mapping
        Fingerprint and size of the student's normalised code, by question.
    copied : Copied
        Code of labsid, and code that is carried as text.
    try_again : bool
        Whether the next run judges it again, because no machine could.
    """

    result: SubmissionResult
    work: Mapping[str, tuple[str, int]] = field(default_factory=dict)
    copied: Copied = field(default_factory=Copied)
    try_again: bool = False


def judge_hand_in(
    hand_in: HandIn, executor: Executor, judges: JudgePool, data_store: DataStore, students: tuple[str, ...]
) -> Judged:
    """Judge a hand-in; one that exceeds the limits is quarantined, and a failure of this machine is tried again.

    Parameters
    ----------
    hand_in : HandIn
    executor : Executor
    judges : JudgePool
    data_store : DataStore
    students : tuple of str
        IDs of the class, with whose records its answers are compared.
    """
    problem: JudgeError | MachineError
    for _ in range(ATTEMPTS):
        try:
            with judges.borrow() as judge:
                return _judge(hand_in, executor, judge, data_store, students)
        except JudgeError as error:
            return Judged(refused_result(hand_in.student, hand_in.template, executor.level, error))
        except MachineError as error:
            problem = error
    return Judged(refused_result(hand_in.student, hand_in.template, executor.level, problem), try_again=True)


def _judge(
    hand_in: HandIn, executor: Executor, judge: JudgeProcess, data_store: DataStore, students: tuple[str, ...]
) -> Judged:
    template, inputs = hand_in.template, hand_in.inputs
    submission = hand_in.refused or judge.call(read_submission, hand_in.folder, hand_in.student, template)
    if submission.status == "ready":
        files = {name: path.read_bytes() for name, path in inputs.files.items()}
        result = executor.run(Task(submission, inputs.assets, files), judge)
    else:
        result = ungraded_result(submission, template, executor.level)
    comparison = _Comparison(result, submission, inputs, data_store, hand_in.folder, students)
    seconds = CPU_SECONDS + CPU_SECONDS_PER_RECORD * len(students)
    try:
        flagged, work, copied = judge.call(compare_with_others, comparison, cpu_seconds=seconds)
    except JudgeError as error:  # it decides no mark
        flag = f"not compared with the others: {error}"
        flagged, work, copied = replace(result, flags=(*result.flags, flag)), {}, Copied()
    # the workers of a cluster return a result without cells if none of them could grade it
    return Judged(flagged, work, copied, try_again=submission.status == "ready" and not result.cells)


@dataclass(frozen=True, slots=True)
class _Comparison:
    """A judged submission, and what it is compared with."""

    result: SubmissionResult
    submission: Submission
    inputs: GradingInputs
    data_store: DataStore
    folder: Path
    students: tuple[str, ...]


def compare_with_others(it: _Comparison) -> tuple[SubmissionResult, dict[str, tuple[str, int]], Copied]:
    """The result, with flags if it was made on another student's record, and what to look at in its code."""
    released = {cell.id: cell.source for cell in it.inputs.assets.template.cells}
    work = code_fingerprints(it.submission.cells, released)
    copied = find_copied(it.submission.cells, released.values())
    return flag_wrong_record(it.result, it.inputs, it.data_store, it.folder, it.students), work, copied
