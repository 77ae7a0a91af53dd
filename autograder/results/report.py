"""The class report: one self-contained HTML file, made from the stored results and the manual grades."""

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from decimal import Decimal
from pathlib import Path
from typing import Any
from urllib.parse import quote

from autograder.course.plain_text import plain_decimal
from autograder.course.students import STUDENTS_FILE, read_students
from autograder.results import gradebook, grades, result_files
from autograder.results.class_statistics import question_figures, statistics_csv
from autograder.results.feedback import FeedbackTexts, load_template, printable, unique_headings, write_feedback
from autograder.results.gradebook import ManualGrades
from autograder.results.hard_questions import HardAssignment, hard_csv, what_was_hard
from autograder.results.late import TIME_UNKNOWN
from autograder.results.nearly_equal import NearlyEqual, find_nearly_equal
from autograder.results.result_files import StoredResult
from autograder.results.sent_tries import StudentTries, load_sent
from autograder.results.similar import find_equal, find_similar
from labsid._files import write_text
from labsid.checks.timetable import in_course_order

BINS = 10
MAX_MISTAKES = 12
HARD_TABLE = "what-was-hard.csv"
STATISTICS_TABLE = "questions.csv"
_CELL_MARKS = {
    result_files.NOT_HANDED_IN: "–",
    result_files.AS_RELEASED: "○",
    result_files.COULD_NOT_BE_GRADED: "✗",
    "waiting": "…",
}  # of what the colour of a cell does not say
_FAILURES = ("quarantined", "crashed", "timeout", "limit")


def write_report(out: Path, texts: FeedbackTexts | None = None) -> Path:
    """Write ``OUT/report.html``, the feedback pages to which it links, and two tables without names.

    ``OUT/questions.csv`` has the figures of the questions and, if enough students sent their tries,
    ``OUT/what-was-hard.csv`` the statistics of these.

    Parameters
    ----------
    out : Path
    texts : FeedbackTexts, optional
        For the feedback pages, and the title of the course.

    Raises
    ------
    ValueError
        If OUT holds no results.
    """
    path = out / "report.html"
    texts = texts or FeedbackTexts()
    list(write_feedback(out, texts))
    stored = result_files.load_all(out)
    sent = {name: load_sent(out, name) for name in {result.assignment for result in stored}}
    students = out / STUDENTS_FILE
    listed = {student.id: student.name for student in (read_students(students) if students.is_file() else ())}
    names = {student: name for student, name in listed.items() if name} | gradebook.read_names(out)
    page = report_page(stored, gradebook.read_manual_grades(out), names, texts.title, sent, tuple(listed))
    write_text(path, load_template("report.html.j2").render(page=page))
    write_text(
        out / STATISTICS_TABLE,
        statistics_csv({assignment["name"]: assignment["figures"] for assignment in page["assignments"]}),
    )
    table = out / HARD_TABLE
    if page["hard"]:
        write_text(table, hard_csv(page["hard"]))
    else:
        table.unlink(missing_ok=True)
    return path


def report_page(
    stored: Sequence[StoredResult],
    manual: ManualGrades,
    student_names: Mapping[str, str] | None = None,
    course: str = "",
    sent: Mapping[str, Sequence[StudentTries]] | None = None,
    listed: Sequence[str] = (),
) -> dict[str, Any]:
    """The content of the report, as plain text and numbers.

    Parameters
    ----------
    stored : sequence of StoredResult
    manual : ManualGrades
    student_names : mapping, optional
        Names of students, by ID.
    course : str
        Title of the course.
    sent : mapping, optional
        The tries that students sent, by assignment.
    listed : sequence of str
        IDs of the students of the course, if they are known.

    Returns
    -------
    dict
    """
    names = sorted({result.assignment for result in stored}, key=in_course_order)
    graded = {result.student for result in stored}
    by_name = {name: [result for result in stored if result.assignment == name] for name in names}
    levels = Counter(result.isolation for result in stored)
    equal = find_equal(stored)
    nearly = find_nearly_equal(stored)
    same = [(group.assignment, set(group.students)) for group in equal if group.question is None]
    same += [(group.assignment, set(group.students)) for group in nearly]
    pairs = [
        pair
        for pair in find_similar(stored)
        if not any(pair.assignment == name and {pair.first, pair.second} <= group for name, group in same)
    ]
    rows = _class_list(stored, names, manual)
    found = {cell["status"] for row in rows for cell in row["cells"] if cell}
    return {
        "course": course,
        "names": {printable(student): printable(name) for student, name in (student_names or {}).items()},
        "class": rows,
        "marks": _CELL_MARKS,
        "statuses": [status for status in _CELL_MARKS if status in found],
        "students": len(graded),
        "submissions": len(stored),
        "isolation": [{"level": printable(level), "count": count} for level, count in levels.most_common()],
        "unisolated": levels.get("none", 0),
        "assignments": [_assignment(by_name[name], manual) for name in names],
        "missing": _missing(stored),
        "absent": [printable(student) for student in listed if student not in graded],
        "reviews": sorted(
            (review for result in stored if (review := _review(result, manual)) is not None),
            key=lambda review: (-review["weight"], review["student"]),
        ),
        "equal": [
            {
                "assignment": group.assignment,
                "question": group.question,
                "students": [_person(student, group.assignment) for student in group.students],
            }
            for group in equal
        ],
        "nearly": [_nearly_equal(group) for group in nearly],
        "similar": [
            {
                "assignment": pair.assignment,
                "first": _person(pair.first, pair.assignment),
                "second": _person(pair.second, pair.assignment),
                "share": round(100 * pair.share),
                "questions": pair.questions,
            }
            for pair in pairs
        ],
        "copied": [copy for result in stored for copy in _copied(result)],
        "hard": [hard for name in names if (hard := _hard(by_name[name], (sent or {}).get(name, ()))) is not None],
        "hard_table": HARD_TABLE,
    }


def _hard(stored: Sequence[StoredResult], sent: Sequence[StudentTries]) -> HardAssignment | None:
    """What was hard in an assignment, by the tries that students sent; None if too few did."""
    handed_in = [result for result in stored if not result.is_refused]
    known = {question.question: result.headings for result in stored for question in result.questions}
    headings = {question: printable(found.get(question, "")) for question, found in known.items()}
    return what_was_hard(stored[0].assignment, sent, len(handed_in), headings)


def _person(student: str, assignment: str) -> dict[str, str]:
    """A student as the report shows one: ID, and the address of the feedback page."""
    return {"id": printable(student), "page": f"feedback/{quote(student, errors='replace')}/{assignment}.html"}


def _nearly_equal(group: NearlyEqual) -> dict[str, Any]:
    """A group of hand-ins with nearly all answers equal, as the report shows it."""
    counts = f"{group.fewest}" if group.fewest == group.most else f"{group.fewest} to {group.most}"
    return {
        "assignment": group.assignment,
        "students": [_person(student, group.assignment) for student in group.students],
        "equal": f"{counts} of {group.compared}",
        "different": group.different,
        "to_the_letter": group.to_the_letter,
        "same_mistakes": group.same_mistakes,
    }


def _copied(result: StoredResult) -> Iterator[dict[str, Any]]:
    """Answers whose code is that of labsid, and answers that carry code as text: to be looked at, without marks."""
    who = _person(result.student, result.assignment)
    for question, function in result.copied.same_as.items():
        what = f"the same as {function}; it may have been derived"
        yield {"who": who, "assignment": result.assignment, "question": question, "what": what}
    for question in result.copied.code_as_text:
        what = "code as text: a long literal is decoded, unpacked, executed or imported"
        yield {"who": who, "assignment": result.assignment, "question": question, "what": what}


def _second_record(stored: Sequence[StoredResult]) -> str:
    """A sentence on the second record; empty if nothing in the assignment follows from a record."""
    found = Counter(result.second_record for result in stored)
    if found["off"]:
        return "The second record is switched off in course.toml: values that were typed in count like computed ones."
    return "What follows from the record was also tried on records that nobody has seen." if found["run"] else ""


def _class_list(
    stored: Sequence[StoredResult], assignments: Sequence[str], manual: ManualGrades
) -> list[dict[str, Any]]:
    """A row for each student with the marks in each assignment and the feedback pages; the lowest marks first."""
    results = {(result.student, result.assignment): result for result in stored}
    rows = []
    for student in dict.fromkeys(result.student for result in stored):
        cells: list[dict[str, Any] | None] = []
        lost: list[Decimal] = []
        for name in assignments:
            result = results.get((student, name))
            if result is None:
                cells.append(None)
                continue
            marks = grades.totals(result, manual.scores)
            status = result.refusal or ("waiting" if marks.waiting else "")
            lost.append(_lost(marks))
            cells.append(
                {
                    **_person(student, name),
                    "score": plain_decimal(marks.score),
                    "status": status,
                    "lost": None if result.is_refused else round(100 * lost[-1]),
                }
            )
        rows.append({"id": printable(student), "cells": cells, "lost": sum(lost, Decimal(0)) / len(lost)})
    return sorted(rows, key=lambda row: -row["lost"])


def _lost(marks: grades.Totals) -> Decimal:
    """The share of the marks that is lost; those not yet given are not."""
    lost = marks.max_score - marks.waiting - marks.score
    return max(lost, Decimal(0)) / marks.max_score if marks.max_score else Decimal(0)


def _assignment(stored: Sequence[StoredResult], manual: ManualGrades) -> dict[str, Any]:
    handed_in = [result for result in stored if not result.is_refused]
    totals = [grades.totals(result, manual.scores) for result in handed_in]
    max_score = max((total.max_score for total in (grades.totals(result, {}) for result in stored)), default=Decimal(0))
    scores = sorted(total.score for total in totals)
    waiting = sum((total.waiting for total in totals), Decimal(0))
    questions = _questions(handed_in, manual)
    return {
        "name": stored[0].assignment,
        "title": printable(stored[0].title),
        "handed_in": len(handed_in),
        "refused": [
            f"{count} {words}" for words, count in Counter(result.refusal for result in stored).most_common() if words
        ],
        "second_record": _second_record(handed_in),
        "late": sum(total.penalty > 0 for total in totals),
        "untimed": sum(result.late == TIME_UNKNOWN for result in stored),
        "extensions": [
            {"who": _person(result.student, result.assignment), "due": result.extension}
            for result in stored
            if result.extension
        ],
        "max_score": plain_decimal(max_score),
        "mean": plain_decimal((sum(scores, Decimal(0)) / len(scores)).quantize(Decimal("0.01"))) if scores else "–",
        "median": plain_decimal(_median(scores)) if scores else "–",
        "waiting": plain_decimal(waiting),
        "bars": _bars(scores, max_score),
        "lost": round(100 * sum(map(_lost, totals), Decimal(0)) / len(totals)) if totals else None,
        "questions": [row for row in questions if row["lost"] != "0"],
        "without_loss": sum(row["lost"] == "0" for row in questions),
        "slips": _slips(handed_in),
        "figures": question_figures(handed_in, manual.scores, _headings(handed_in)),
        "figures_table": STATISTICS_TABLE,
    }


def _headings(stored: Sequence[StoredResult]) -> dict[str, str]:
    return {question: printable(heading) for one in stored for question, heading in unique_headings(one).items()}


def _median(scores: Sequence[Decimal]) -> Decimal:
    middle = len(scores) // 2
    return scores[middle] if len(scores) % 2 else (scores[middle - 1] + scores[middle]) / 2


def _bars(scores: Sequence[Decimal], max_score: Decimal) -> list[dict[str, Any]]:
    """Histogram of the scores; full marks count in the last bar."""
    counts = [0] * BINS
    for score in scores:
        counts[min(int(score * BINS / max_score), BINS - 1) if max_score else 0] += 1
    highest = max(counts, default=0) or 1
    edges = [plain_decimal(max_score * edge / BINS) for edge in range(BINS + 1)]
    return [
        {"count": count, "height": round(100 * count / highest), "low": edges[i], "high": edges[i + 1]}
        for i, count in enumerate(counts)
    ]


def _questions(stored: Sequence[StoredResult], manual: ManualGrades) -> list[dict[str, Any]]:
    """Marks lost on each question, most costly first."""
    rows: dict[str, dict[str, Any]] = {}
    for result in stored:
        headings = unique_headings(result)
        for question in result.questions:
            row = rows.setdefault(
                question.question,
                {"id": question.question, "heading": printable(headings[question.question]), "full": 0,
                 "none": 0, "graded": 0, "lost": Decimal(0), "max_score": plain_decimal(question.max_score),
                 "worth": question.max_score, "slips": Counter()},
            )  # fmt: skip
            score = manual.scores.get((result.student, result.assignment, question.question), question.score)
            if score is None:
                continue
            row["graded"] += 1
            row["full"] += score >= question.max_score
            row["none"] += score == 0
            row["lost"] += max(question.max_score - score, Decimal(0))
            if question.slip:
                row["slips"][question.slip] += 1
    table = []
    for row in sorted(rows.values(), key=lambda row: -row["lost"]):
        total = row["worth"] * row["graded"]
        slip = row["slips"].most_common(1)
        table.append(
            {key: row[key] for key in ("id", "heading", "full", "none", "graded", "max_score")}
            | {
                "lost": plain_decimal(row["lost"]),
                "share": round(100 * row["lost"] / total) if total else 0,
                "slip": f"{printable(slip[0][0])} ({slip[0][1]})" if slip else "",
            }
        )
    return table


def _slips(stored: Sequence[StoredResult]) -> list[dict[str, Any]]:
    """Marks lost by each known mistake, most costly first."""
    cost: dict[str, Decimal] = {}
    count: Counter[str] = Counter()
    for result in stored:
        for question in result.questions:
            if question.slip and question.score is not None and question.score < question.max_score:
                cost[question.slip] = cost.get(question.slip, Decimal(0)) + question.max_score - question.score
                count[question.slip] += 1
    most_costly = sorted(cost, key=lambda slip: (-cost[slip], slip))[:MAX_MISTAKES]
    return [{"slip": printable(slip), "count": count[slip], "lost": plain_decimal(cost[slip])} for slip in most_costly]


def _review(result: StoredResult, manual: ManualGrades) -> dict[str, Any] | None:
    """Reasons for the instructor to review a submission, and their weight; None without a reason."""
    reasons: list[str] = []
    status = Counter(question.status for question in result.questions)
    weight = 0
    if result.flags:
        reasons += [printable(flag) for flag in result.flags]
        weight += 100
    if any((result.student, result.assignment) == key[:2] for key in manual.needs_review):
        reasons.append("changed after it was graded by hand")
        weight += 50
    for kind in _FAILURES:
        if status[kind]:
            reasons.append(f"{result.refusal} ({kind})" if result.is_refused else f"{kind}: {_named(result, kind)}")
            weight += 20
    automatic = [question for question in result.questions if question.status != "manual"]
    if not result.is_refused and automatic and all(question.score == 0 for question in automatic):
        reasons.append("no automatic question is right")
        weight += 10
    if not result.is_refused and result.notes:
        reasons.append(f"repaired: {'; '.join(printable(note) for note in result.notes[:3])}")
        weight += 5
    if result.late and result.late != TIME_UNKNOWN:  # which a sentence on the whole class says
        reasons.append(printable(result.late))
        weight += 2
    consistent = [question for question in result.questions if question.consistent]
    if consistent:
        marks = plain_decimal(sum((question.max_score for question in consistent), Decimal(0)))
        named = ", ".join(f"{question.question} ({plain_decimal(question.max_score)})" for question in consistent)
        reasons.append(f"consistent with the student's own wrong values, {marks} marks that you may give: {named}")
        weight += 3
    if not reasons:
        return None
    detail = printable("; ".join(result.notes)) if result.is_refused else ""
    return {
        "student": printable(result.student),
        "page": _person(result.student, result.assignment)["page"],
        "assignment": result.assignment,
        "reasons": reasons,
        "detail": detail,
        "weight": weight,
    }


def _missing(stored: Sequence[StoredResult]) -> list[dict[str, Any]]:
    """Students without an answer to grade, by assignment and whether they handed in something."""
    found: dict[tuple[str, str], list[str]] = {}
    for result in stored:
        if result.refusal in (result_files.NOT_HANDED_IN, result_files.AS_RELEASED):
            found.setdefault((result.assignment, result.refusal), []).append(printable(result.student))
    return [{"assignment": name, "words": words, "students": students} for (name, words), students in found.items()]


def _named(result: StoredResult, status: str) -> str:
    return ", ".join(question.question for question in result.questions if question.status == status)
