"""Results entered into nbgrader's tables in bulk: the rows to write are collected, and written together."""

from datetime import datetime
from decimal import Decimal
from typing import Any

from autograder.course.nbgrader_access import import_nbgrader_api
from autograder.results.result_files import StoredResult


class BulkEntry:
    """Collects the rows to write; reads the gradebook's primary keys once."""

    def __init__(self, gradebook: Any) -> None:
        api = import_nbgrader_api()
        self._db = db = gradebook.db
        self._tables = [model.__table__ for model in (api.SubmittedAssignment, api.SubmittedNotebook)]
        self._tables += [api.Grade.__table__, api.Comment.__table__]
        self._gradebook = gradebook
        self._students = {row[0] for row in db.query(api.Student.id).all()}
        self._assignments = {name: key for key, name in db.query(api.Assignment.id, api.Assignment.name).all()}
        self._notebooks: dict[str, list[str]] = {}
        for key, assignment in db.query(api.Notebook.id, api.Notebook.assignment_id).all():
            self._notebooks.setdefault(assignment, []).append(key)
        self._cells = {
            "grade": _by_notebook(db.query(api.GradeCell.id, api.GradeCell.name, api.GradeCell.notebook_id)),
            "comment": _by_notebook(db.query(api.SolutionCell.id, api.SolutionCell.name, api.SolutionCell.notebook_id)),
        }
        submission, notebook, grade, _ = self._tables
        self._submissions = {
            (student, assignment): key
            for key, student, assignment in db.query(
                submission.c.id, submission.c.student_id, submission.c.assignment_id
            ).all()
        }
        self._submitted: dict[str, list[tuple[str, str]]] = {}
        for key, master, owner in db.query(notebook.c.id, notebook.c.notebook_id, notebook.c.assignment_id).all():
            self._submitted.setdefault(owner, []).append((key, master))
        self._grades = {
            (owner, cell): (key, manual, waits)
            for key, cell, owner, manual, waits in db.query(
                grade.c.id, grade.c.cell_id, grade.c.notebook_id, grade.c.manual_score, grade.c.needs_manual_grade
            ).all()
        }
        self._new: tuple[list[dict[str, Any]], ...] = ([], [], [], [])
        self._changed: tuple[list[dict[str, Any]], ...] = ([], [], [])

    def has_assignment(self, assignment: str) -> bool:
        """Whether the gradebook has the assignment."""
        return assignment in self._assignments

    def has_submission(self, key: tuple[str, str]) -> bool:
        """Whether an earlier version of this submission was entered, so that its scores must be replaced."""
        return (key[0], self._assignments.get(key[1])) in self._submissions

    def add(self, result: StoredResult) -> None:
        """Collect the rows of one result."""
        if result.student not in self._students:
            self._gradebook.db.add(import_nbgrader_api().Student(id=result.student))
            self._gradebook.db.flush()
            self._students.add(result.student)
        assignment = self._assignments[result.assignment]
        owner = self._submissions.get((result.student, assignment))
        when = None if result.submitted is None else datetime.fromisoformat(result.submitted).replace(tzinfo=None)
        if owner is None:
            owner = self._submissions[result.student, assignment] = _new_key()
            row = {"id": owner, "student_id": result.student, "assignment_id": assignment, "timestamp": when}
            self._new[0].append(row)
            self._submitted[owner] = []
            for master in self._notebooks[assignment]:
                key = _new_key()
                self._submitted[owner].append((key, master))
                penalty = float(result.penalty)
                row = {"id": key, "notebook_id": master, "assignment_id": owner, "late_submission_penalty": penalty}
                self._new[1].append(row | {"flagged": False})
                cells = self._cells["comment"].get(master, {}).values()
                self._new[3].extend({"id": _new_key(), "cell_id": cell, "notebook_id": key} for cell in cells)
        else:
            self._changed[0].append({"key": owner, "timestamp": when})
            for key, _ in self._submitted[owner]:
                self._changed[1].append({"key": key, "late_submission_penalty": float(result.penalty)})
        scores = {question.question: question.score for question in result.questions}
        for key, master in self._submitted[owner]:
            for name, cell in self._cells["grade"].get(master, {}).items():
                if name in scores:
                    self._grade(key, cell, scores[name], name in result.review)

    def _grade(self, notebook: str, cell: str, score: Decimal | None, needs_review: bool) -> None:
        known = self._grades.get((notebook, cell))
        auto = None if score is None else float(score)
        if known is None:
            row = {"id": _new_key(), "cell_id": cell, "notebook_id": notebook, "auto_score": auto}
            self._new[2].append(row | {"needs_manual_grade": score is None})
            return
        key, manual, waits = known
        needs = score is None if manual is None else bool(waits) or needs_review
        self._changed[2].append({"key": key, "auto_score": auto, "needs_manual_grade": needs})

    def flush(self) -> None:
        """Write the collected rows."""
        from sqlalchemy import bindparam

        for table, rows in zip(self._tables, self._new, strict=True):
            if rows:
                self._db.execute(table.insert(), rows)
        for table, rows in zip(self._tables, self._changed, strict=False):
            if rows:
                values: dict[str, Any] = {name: bindparam(name) for name in rows[0] if name != "key"}
                statement = table.update().where(table.c.id == bindparam("key")).values(values)
                self._db.connection().execute(statement, rows)


def _by_notebook(query: Any) -> dict[str, dict[str, str]]:
    found: dict[str, dict[str, str]] = {}
    for key, name, notebook in query.all():
        found.setdefault(notebook, {})[name] = key
    return found


def _new_key() -> str:
    from nbgrader.api import new_uuid

    return str(new_uuid())
