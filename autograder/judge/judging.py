"""Judge one submission: run and judge its notebook, and make a result of every question.

An answer that follows from the record is then tried on records that nobody has seen. The student's processes run the
cells. Only this process holds the checks, the reference and the hidden inputs on which functions are tested.
"""

from pathlib import Path

from autograder.intake.submission import Submission
from autograder.judge.hidden_records import confirm_on_hidden_records, draw_second_record, second_record_of
from autograder.judge.notebook import Assets, JudgedNotebook, judge_notebook
from autograder.judge.outcome import SubmissionResult, ungraded_result
from autograder.sandbox.isolation import ProcessLauncher

__all__ = ["Assets", "judge_submission"]


def judge_submission(
    submission: Submission, assets: Assets, launcher: ProcessLauncher, folder: Path, pictures: bool = True
) -> SubmissionResult:
    """Judge a submission.

    Parameters
    ----------
    submission : Submission
    assets : Assets
    launcher : ProcessLauncher
        Starts the student's processes.
    folder : Path
        Work folder of these processes; it contains the record.
    pictures : bool
        Whether to draw the figures that are judged, for the feedback.

    Returns
    -------
    SubmissionResult
        One result for every question of the assignment, whatever the submission does.
    """
    if submission.status != "ready":
        return ungraded_result(submission, assets.template, launcher.level)
    state = second_record_of(assets)
    if state == "run":
        with draw_second_record(submission, assets, launcher) as second:
            judged = judge_notebook(submission, assets, launcher, folder, pictures)
            confirmed = confirm_on_hidden_records(submission, judged, assets, _judge_on, second, launcher)
    else:
        judged, confirmed = judge_notebook(submission, assets, launcher, folder, pictures), None
    return SubmissionResult(
        submission.student,
        submission.assignment,
        judged.results() if confirmed is None else confirmed.results,
        judged.executed,
        submission.notes,
        launcher.level,
        judged.wrong_values(),
        () if confirmed is None else confirmed.flags,
        state,
    )


def _judge_on(part: Submission, hidden: Assets, folder: Path, launcher: ProcessLauncher) -> JudgedNotebook:
    return judge_notebook(part, hidden, launcher, folder, pictures=False)
