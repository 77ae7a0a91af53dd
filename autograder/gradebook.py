"""The gradebook is nbgrader's: formgrader, manual grading and nbgrader's own feedback go on working on it.

Only automatic scores are written here; a score or comment given by hand is never touched.
"""

from collections.abc import Iterable, Mapping, Sequence
from decimal import Decimal
from pathlib import Path
from typing import Any

import nbformat

from autograder.course import Course
from autograder.intake import Step
from autograder.judge import Ran, SubmissionResult
from autograder.nbgrader_door import COURSE_ID, nbgrader_api, open_gradebook
from autograder.results import write_text


def database_url(out: Path) -> str:
    """The gradebook of an OUT folder, in nbgrader's own notation."""
    return f"sqlite:///{(out / 'gradebook.db').resolve()}"


def is_there(out: Path) -> bool:
    """Whether OUT has a gradebook: without it, nothing that was graded earlier is entered anywhere."""
    return (out / "gradebook.db").is_file()


def prepare(course: Course, out: Path, assignments: Sequence[str]) -> None:
    """Enter the assignments into the gradebook, and make OUT a course folder that nbgrader's own commands can open.

    Raises
    ------
    ValueError
        If an assignment's cells have changed since submissions of it were graded here.
    """
    nbgrader_api()
    from nbgrader.preprocessors import ComputeChecksums, SaveCells

    out.mkdir(parents=True, exist_ok=True)
    write_text(
        out / "nbgrader_config.py",
        _CONFIG.format(course_id=COURSE_ID, source=str(course.source), release=str(course.release)),
    )
    url = database_url(out)
    with open_gradebook(url) as gradebook:
        for name in assignments:
            gradebook.update_or_create_assignment(name)
    for name in assignments:
        notebook = nbformat.read(course.release / name / f"{name}.ipynb", as_version=4)
        resources = {"nbgrader": {"notebook": name, "assignment": name, "db_url": url}}
        notebook, _ = ComputeChecksums().preprocess(notebook, resources)
        try:
            SaveCells().preprocess(notebook, resources)
        except RuntimeError as error:
            raise ValueError(
                f"{name} has changed since submissions were graded into {out} ({error}). Grade into a new folder."
            ) from None


def record(out: Path, results: Iterable[SubmissionResult]) -> None:
    """Enter automatic scores; what was graded by hand stays."""
    with open_gradebook(database_url(out)) as gradebook:
        for result in results:
            if not result.ran and not _is_entered(gradebook, result):
                continue  # missing or quarantined: nothing that formgrader could open
            gradebook.update_or_create_student(result.student)
            with gradebook.db.no_autoflush:
                submission = gradebook.update_or_create_submission(result.assignment, result.student)
            scores = {question.question: question for question in result.results}
            for notebook in submission.notebooks:
                for grade in notebook.grades:
                    question = scores[grade.name]
                    grade.auto_score = None if question.score is None else float(question.score)
                    grade.needs_manual_grade = question.score is None and grade.manual_score is None
            gradebook.db.commit()


def _is_entered(gradebook: Any, result: SubmissionResult) -> bool:
    """Whether an earlier hand-in of this submission was graded: its scores must not outlive it."""
    try:
        gradebook.find_submission(result.assignment, result.student)
    except nbgrader_api().MissingEntry:
        return False
    return True


def manual_scores(out: Path) -> dict[tuple[str, str, str], Decimal]:
    """Scores given by hand, by (student, assignment, question), as exact decimals."""
    return {key: score for key, score, _ in _by_hand(out) if score is not None}


def manual_comments(out: Path) -> dict[tuple[str, str, str], str]:
    """Comments given by hand, by (student, assignment, question)."""
    return {key: comment for key, _, comment in _by_hand(out) if comment}


def _decimal(score: float | None) -> Decimal | None:
    return None if score is None else Decimal(str(score))


def _by_hand(out: Path) -> Iterable[tuple[tuple[str, str, str], Decimal | None, str | None]]:
    if not is_there(out):
        return
    with open_gradebook(database_url(out)) as gradebook:
        for assignment in gradebook.db.query(nbgrader_api().Assignment).all():
            for submission in assignment.submissions:
                for notebook in submission.notebooks:
                    said = {comment.name: comment.manual_comment for comment in notebook.comments}
                    for grade in notebook.grades:
                        score = _decimal(grade.manual_score)
                        if grade.extra_credit:
                            # nbgrader adds it to whichever score counts; without one the question still waits
                            base = _decimal(grade.auto_score) if score is None else score
                            score = None if base is None else base + Decimal(str(grade.extra_credit))
                        yield (submission.student.id, assignment.name, grade.name), score, said.get(grade.name)


def write_autograded(course: Course, out: Path, result: SubmissionResult) -> None:
    """Write the notebook that formgrader shows: the student's cells with what they printed and drew."""
    if not result.ran:
        return
    name = result.assignment
    notebook = nbformat.read(course.release / name / f"{name}.ipynb", as_version=4)
    released = {cell.id: cell for cell in notebook.cells}
    # cells without a grade_id are the hand-in's own, the course's text among them
    notebook.cells = [_as_cell(ran, released, f"extra-{index}") for index, ran in enumerate(result.ran)]
    path = out / "autograded" / result.student / name / f"{name}.ipynb"
    write_text(path, nbformat.writes(notebook, version=4))


def _as_cell(ran: Ran, released: Mapping[str, Any], extra_id: str) -> Any:
    step: Step = ran.step
    if step.id is not None:
        cell = released[step.id]
        cell.source = step.source
    elif step.code:
        cell = nbformat.v4.new_code_cell(step.source, id=extra_id)
    else:
        cell = nbformat.v4.new_markdown_cell(step.source, id=extra_id)
    if step.code:
        cell.outputs = _outputs(ran)
    return cell


def _outputs(ran: Ran) -> list[Any]:
    made = []
    if ran.reply.stdout:
        made.append(nbformat.v4.new_output("stream", name="stdout", text=ran.reply.stdout))
    for picture in ran.reply.figures:
        made.append(nbformat.v4.new_output("display_data", data={"image/png": picture}))
    if ran.reply.error is not None:
        kind, text = str(ran.reply.error.get("kind")), str(ran.reply.error.get("text"))
        made.append(nbformat.v4.new_output("error", ename=kind, evalue=text, traceback=[f"{kind}: {text}"]))
    if ran.death is not None:
        made.append(nbformat.v4.new_output("stream", name="stderr", text=f"{ran.death}\n"))
    return made


_CONFIG = """# Written by "labsid course grade": lets nbgrader's own commands (formgrader) open this folder.
import os

c = get_config()  # noqa: F821
c.CourseDirectory.root = os.path.dirname(os.path.abspath(__file__))
c.CourseDirectory.course_id = {course_id!r}
c.CourseDirectory.source_directory = {source!r}
c.CourseDirectory.release_directory = {release!r}
c.CourseDirectory.db_url = "sqlite:///" + os.path.join(c.CourseDirectory.root, "gradebook.db")
"""
