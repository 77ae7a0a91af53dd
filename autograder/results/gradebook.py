"""The nbgrader gradebook: enter results, and read manual grades.

Formgrader, manual grading and nbgrader's own feedback work on this gradebook. Results are entered in bulk in one
transaction. The table ``labsid_entered`` beside nbgrader's tables records which results have been entered, so that the
run after an interrupted one enters the rest. Manual scores and comments are never changed.

nbgrader's setting ``CourseDirectory.db_url`` in ``OUT/nbgrader_config.py`` selects the database. The default is a file
in OUT; ``postgresql+psycopg://USER:PASSWORD@HOST/NAME`` lets several people grade by hand at the same time
(``pip install 'labsid[postgres]'``).
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from datetime import UTC, datetime
from decimal import Decimal
from pathlib import Path
from typing import Any

import nbformat

from autograder.course.layout import Course
from autograder.course.nbgrader_access import COURSE_ID, import_nbgrader_api, open_gradebook, without_disk_sync
from autograder.course.students import Student
from autograder.results.bulk_entry import BulkEntry
from autograder.results.result_files import StoredResult, entry_digest
from labsid._files import write_text

Key = tuple[str, str, str]
"""Student, assignment and question."""


@dataclass(frozen=True, slots=True)
class Mark:
    """A mark given with ``labsid course mark``.

    Attributes
    ----------
    score : Decimal
    marker : str
        Name of who gave it.
    when : datetime
        In UTC.
    ticked : tuple of int
        The lines of the rubric that the score adds up, from 0; empty if it was not given by a rubric.
    """

    score: Decimal
    marker: str
    when: datetime
    ticked: tuple[int, ...] = ()

    @property
    def text(self) -> str:
        """Who gave it and when, as on all pages."""
        return f"marked by {self.marker} on {self.when:%Y-%m-%d}"


@dataclass(frozen=True, slots=True)
class ManualGrades:
    """Manual scores and comments, by (student, assignment, question).

    Attributes
    ----------
    scores : dict
        Including extra credit.
    comments : dict
    needs_review : frozenset
        Questions with a manual score that are marked for review.
    marks : dict
        Who gave a score and when, where it was given with ``labsid course mark`` and has not been changed since.
    """

    scores: dict[Key, Decimal]
    comments: dict[Key, str]
    needs_review: frozenset[Key]
    marks: dict[Key, Mark] = field(default_factory=dict)


def database_url(out: Path) -> str:
    """URL of the gradebook of an OUT folder, as nbgrader takes it."""
    config = out / "nbgrader_config.py"
    if config.is_file():
        from traitlets.config.loader import PyFileConfigLoader

        try:
            url = PyFileConfigLoader(config.name, str(out.resolve())).load_config().CourseDirectory.get("db_url")
        except Exception as error:  # the configuration is a Python program: it can raise anything
            raise ValueError(f"{config} cannot be read: {type(error).__name__}: {error}") from None
        if isinstance(url, str):
            return url
    return f"sqlite:///{(out / 'gradebook.db').resolve()}"


def exists(out: Path) -> bool:
    """Whether OUT has a gradebook."""
    url = database_url(out)
    return Path(url.removeprefix("sqlite:///")).is_file() if url.startswith("sqlite:///") else out.is_dir()


def prepare(course: Course, out: Path, assignments: Sequence[str]) -> None:
    """Enter the assignments into the gradebook, and make OUT a course folder for nbgrader's own commands.

    Raises
    ------
    ValueError
        If an assignment has changed since submissions of it were graded here.
    """
    import_nbgrader_api()
    out.mkdir(parents=True, exist_ok=True)
    if not (out / "nbgrader_config.py").is_file():
        write_text(
            out / "nbgrader_config.py",
            _CONFIG.format(course_id=COURSE_ID, source=str(course.source), release=str(course.release)),
        )
    if exists(out):
        _enter_assignments(course, out, assignments)
    else:
        with without_disk_sync():
            _enter_assignments(course, out, assignments)


def _enter_assignments(course: Course, out: Path, assignments: Sequence[str]) -> None:
    from nbgrader.preprocessors import ComputeChecksums, SaveCells

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


def enter(out: Path, stored: Iterable[StoredResult]) -> int:
    """Enter new and changed results in one transaction; manual grades are kept.

    Parameters
    ----------
    out : Path
    stored : iterable of StoredResult

    Returns
    -------
    int
        Number of results entered.
    """
    from sqlalchemy import select

    with open_gradebook(database_url(out)) as gradebook:
        db, table = gradebook.db, _entered_table(gradebook)
        entered = {(student, name): digest for student, name, digest in db.execute(select(table)).all()}
        digests = {(result.student, result.assignment): (result, entry_digest(result)) for result in stored}
        new = {key: pair for key, pair in digests.items() if entered.get(key) != pair[1]}
        if not new:
            return 0
        entry = BulkEntry(gradebook)
        for key, (result, digest) in new.items():
            if not entry.has_assignment(result.assignment):
                continue  # an assignment that this run does not grade
            if not result.is_refused or entry.has_submission(key):  # formgrader cannot open a missing notebook
                entry.add(result)
            if key in entered:
                db.execute(table.delete().where(table.c.student == key[0], table.c.assignment == key[1]))
            db.execute(table.insert().values(student=key[0], assignment=key[1], digest=digest))
        entry.flush()
        db.commit()
    return len(new)


def _entered_table(gradebook: Any) -> Any:
    from sqlalchemy import Column, MetaData, String, Table

    metadata = MetaData()
    table = Table(
        "labsid_entered",
        metadata,
        Column("student", String(128), primary_key=True),
        Column("assignment", String(128), primary_key=True),
        Column("digest", String(64), nullable=False),
    )
    metadata.create_all(gradebook.engine)
    return table


def read_manual_grades(out: Path) -> ManualGrades:
    """Read all manual scores and comments."""
    if not exists(out):
        return ManualGrades({}, {}, frozenset())
    api = import_nbgrader_api()
    scores: dict[Key, Decimal] = {}
    needs_review: set[Key] = set()
    marks: dict[Key, Mark] = {}
    with open_gradebook(database_url(out)) as gradebook:
        db = gradebook.db
        given = _read_marks(gradebook)
        owner = (api.SubmittedAssignment.student_id, api.Assignment.name, api.BaseCell.name)
        rows = _cell_rows(db.query(*owner, *(getattr(api.Grade, name) for name in _GRADE)), api, api.Grade)
        for student, name, question, auto, manual, extra, waits in rows:
            key = student, name, question
            if manual is not None and waits:
                needs_review.add(key)
            score = _decimal(manual)
            if key in given and given[key].score == score:
                marks[key] = given[key]
            if extra:
                # nbgrader adds it to the manual or automatic score; without either, the question is not graded yet
                base = _decimal(auto) if score is None else score
                score = None if base is None else base + Decimal(str(extra))
            if score is not None:
                scores[key] = score
        rows = _cell_rows(db.query(*owner, api.Comment.manual_comment), api, api.Comment)
        comments = {(student, name, question): text for student, name, question, text in rows if text}
    return ManualGrades(scores, comments, frozenset(needs_review), marks)


def enter_mark(out: Path, key: Key, mark: Mark | None, comment: str) -> None:
    """Enter the mark and the comment of a question graded by hand, as formgrader does.

    Parameters
    ----------
    out : Path
        A folder that ``labsid course grade`` wrote.
    key : tuple of str
        Student, assignment and question.
    mark : Mark or None
        None takes a mark back: the question waits to be graded again.
    comment : str
        For the student; replaces an earlier one.

    Raises
    ------
    ValueError
        If the gradebook has no such question of that student.
    """
    student, assignment, question = key
    api = import_nbgrader_api()
    with open_gradebook(database_url(out)) as gradebook:
        try:
            grade = gradebook.find_grade(question, assignment, assignment, student)
            text = gradebook.find_comment(question, assignment, assignment, student)
        except api.MissingEntry:
            raise ValueError(f"the gradebook has no question {question} of {student} in {assignment}.") from None
        row = {"student": student, "assignment": assignment, "question": question}
        table, ticks = _marks_table(gradebook), _ticks_table(gradebook)
        for written in (table, ticks):
            gradebook.db.execute(written.delete().where(*(written.c[name] == value for name, value in row.items())))
        if mark is None:
            grade.manual_score, grade.needs_manual_grade = None, grade.auto_score is None
        else:
            grade.manual_score, grade.needs_manual_grade = float(mark.score), False
            values = {"score": str(mark.score), "marker": mark.marker, "marked": mark.when.astimezone(UTC).isoformat()}
            gradebook.db.execute(table.insert().values(row | values))
            if mark.ticked:
                gradebook.db.execute(ticks.insert().values(row | {"ticked": " ".join(map(str, mark.ticked))}))
        text.manual_comment = comment.strip() or None
        gradebook.db.commit()


def _read_marks(gradebook: Any) -> dict[Key, Mark]:
    from sqlalchemy import select

    rows = gradebook.db.execute(select(_marks_table(gradebook))).all()
    ticked = {
        (row.student, row.assignment, row.question): tuple(map(int, row.ticked.split()))
        for row in gradebook.db.execute(select(_ticks_table(gradebook))).all()
    }
    return {
        (key := (row.student, row.assignment, row.question)): Mark(
            Decimal(row.score), row.marker, datetime.fromisoformat(row.marked), ticked.get(key, ())
        )
        for row in rows
    }


def _marks_table(gradebook: Any) -> Any:
    return _own_table(gradebook, "labsid_marked", ("score", "marker", "marked"))


def _ticks_table(gradebook: Any) -> Any:
    return _own_table(gradebook, "labsid_ticked", ("ticked",))


def _own_table(gradebook: Any, name: str, columns: Sequence[str]) -> Any:
    """A table of ours beside those of nbgrader, with a row for a question of a student."""
    from sqlalchemy import Column, MetaData, String, Table

    metadata = MetaData()
    keys = (Column(key, String(128), primary_key=True) for key in ("student", "assignment", "question"))
    values = (Column(column, String(128), nullable=False) for column in columns)
    table = Table(name, metadata, *keys, *values)
    metadata.create_all(gradebook.engine)
    return table


def enter_students(out: Path, students: Iterable[Student]) -> None:
    """Enter names and e-mail addresses of students, for formgrader and all pages."""
    api = import_nbgrader_api()
    with open_gradebook(database_url(out)) as gradebook:
        known = {student.id: student for student in gradebook.db.query(api.Student).all()}
        for student in students:
            if student.id not in known:
                known[student.id] = api.Student(id=student.id)
                gradebook.db.add(known[student.id])
            entry = known[student.id]
            if student.name:
                entry.first_name, entry.last_name = student.first_and_last_name
            entry.email = student.email or entry.email
        gradebook.db.commit()


def read_names(out: Path) -> dict[str, str]:
    """Names of the students whose name is known, by ID."""
    if not exists(out):
        return {}
    api = import_nbgrader_api()
    with open_gradebook(database_url(out)) as gradebook:
        rows = gradebook.db.query(api.Student.id, api.Student.first_name, api.Student.last_name).all()
    names = {student: " ".join(filter(None, (first, last))) for student, first, last in rows}
    return {student: name for student, name in names.items() if name}


_GRADE = ("auto_score", "manual_score", "extra_credit", "needs_manual_grade")


def _cell_rows(query: Any, api: Any, model: Any) -> Any:
    return (
        query.select_from(model)
        .join(api.BaseCell, api.BaseCell.id == model.cell_id)
        .join(api.SubmittedNotebook, api.SubmittedNotebook.id == model.notebook_id)
        .join(api.SubmittedAssignment, api.SubmittedAssignment.id == api.SubmittedNotebook.assignment_id)
        .join(api.Assignment, api.Assignment.id == api.SubmittedAssignment.assignment_id)
        .all()
    )


def _decimal(score: float | None) -> Decimal | None:
    return None if score is None else Decimal(str(score))


_CONFIG = """# Written by "labsid course grade": lets nbgrader's own commands (formgrader) open this folder.
import os

c = get_config()  # noqa: F821
c.CourseDirectory.root = os.path.dirname(os.path.abspath(__file__))
c.CourseDirectory.course_id = {course_id!r}
c.CourseDirectory.source_directory = {source!r}
c.CourseDirectory.release_directory = {release!r}
c.CourseDirectory.db_url = "sqlite:///" + os.path.join(c.CourseDirectory.root, "gradebook.db")
c.HTMLExporter.sanitize_html = True  # student text must not run as script in formgrader
"""
