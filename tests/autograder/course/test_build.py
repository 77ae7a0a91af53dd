"""The build: reproducible to the byte, no solution in a release, and every mistake of an author named."""

import ast
import re
import shutil
from collections.abc import Callable
from decimal import Decimal
from pathlib import Path
from typing import Any

import nbformat
import pytest

from autograder.batch.fingerprint import template_hash
from autograder.course import build
from autograder.course.build import build_course, build_source
from autograder.course.layout import Course, read_template
from autograder.course.lint import SOLUTION_DELIMITERS, lint_checks, lint_release
from autograder.course.questions import read_questions
from labsid.checks.cells import CODE_STUB, TEXT_STUB, Cell, Template, read_cell
from labsid.checks.notebook import assignment_names, load_assignment

ASSIGNMENTS = assignment_names()
BEGIN, END = SOLUTION_DELIMITERS
HEAD = """---
jupytext:
  text_representation:
    extension: .md
    format_name: myst
---

# Tiny
"""
ANSWER = """
```{code-cell}
:nbgrader: {grade_id: tiny-answer, solution: true}

# name it a
### BEGIN SOLUTION
a = 3 + 4 + 5 + 6
### END SOLUTION
```
"""
OPEN = """
+++ {"nbgrader": {"grade_id": "tiny-open", "points": 0.1, "manual": true}}

Because it starts from rest.

+++

The end.
"""


@pytest.fixture
def write(tmp_path: Path) -> Callable[..., Course]:
    """Write a course of one assignment, from the text after its title."""

    def make(text: str, name: str = "tiny") -> Course:
        folder = tmp_path / "notebooks" / name
        folder.mkdir(parents=True)
        (folder / f"{name}.md").write_text(HEAD + text, encoding="utf-8")
        (tmp_path / "autograder").mkdir()
        return Course(tmp_path)

    return make


def test_two_builds_are_equal_byte_for_byte(course: Course, tmp_path: Path) -> None:
    again = Course(tmp_path)
    names = course.assignments()[:2]
    for name in names:
        shutil.copytree(course.notebooks / name, again.notebooks / name)
    shutil.copytree(course.data, again.data)
    (tmp_path / "autograder").mkdir()
    assert list(build_course(again)) == names
    for name in names:
        for one, other in ((course.source, again.source), (course.release, again.release)):
            file = Path(name) / f"{name}.ipynb"
            assert (one / file).read_bytes() == (other / file).read_bytes()


def test_every_assignment_is_built(course: Course) -> None:
    assert course.assignments() == [name for name in _in_order() if name in ASSIGNMENTS]
    assert {"prelab-sinusoids", "lab-identification"} <= set(course.assignments())
    for name in course.assignments():
        for folder in (course.source, course.release):
            notebook = nbformat.read(folder / name / f"{name}.ipynb", as_version=4)
            nbformat.validate(notebook)
            known = [read_cell(cell) for cell in notebook.cells]
            assert all(cell.id == known.id for cell, known in zip(notebook.cells, known, strict=True) if known)
            assert not any(cell.get("outputs") for cell in notebook.cells)
        data = load_assignment(name).record_file
        beside = {path.name for path in (course.release / name).iterdir()} - {f"{name}.ipynb"}
        assert beside == ({data} if data else set())
        assert data is None or (course.release / name / data).read_bytes() == (course.data / data).read_bytes()


def _in_order() -> list[str]:
    return [
        "prelab-sinusoids", "lab-identification", "postlab-model-order", "step-response", "least-squares",
        "model-structures", "recursive-identification", "armax-and-instruments", "nonlinear-least-squares",
        "sim-to-real-gap", "several-signals",
    ]  # fmt: skip


@pytest.mark.parametrize("name", ASSIGNMENTS)
def test_no_solution_is_left_in_a_release(name: str, course: Course) -> None:
    source, release = (
        nbformat.read(folder / name / f"{name}.ipynb", as_version=4) for folder in (course.source, course.release)
    )
    assert [cell.id for cell in source.cells] == [cell.id for cell in release.cells]
    answers = 0
    for full, given in zip(source.cells, release.cells, strict=True):
        known = read_cell(full)
        assert "SOLUTION" not in given.source
        if known is None or known.kind not in ("answer", "manual"):
            assert given.source == full.source
            continue
        answers += 1
        if known.kind == "manual":
            assert given.source == TEXT_STUB
            continue
        outside = re.sub(f"{BEGIN}.*?{END}", CODE_STUB, full.source, flags=re.DOTALL)
        assert [line.strip() for line in given.source.split("\n")] == [line.strip() for line in outside.split("\n")]
    assert answers > 2
    assert list(lint_release(release, source)) == []


def test_an_untouched_answer_cell_displays_nothing() -> None:
    """Jupyter displays the value of a last line that is an expression, as it would "Ellipsis" for `...`."""
    assert not isinstance(ast.parse(CODE_STUB).body[-1], ast.Expr)


def test_a_solution_that_survives_stops_the_build(write: Callable, monkeypatch: pytest.MonkeyPatch) -> None:
    course = write(ANSWER + OPEN)

    def forgetful(course: Course, name: str, scratch: Path) -> Any:
        return nbformat.read(course.source / name / f"{name}.ipynb", as_version=4)

    monkeypatch.setattr(build, "_generate", forgetful)
    with pytest.raises(
        ValueError, match=r"contains the solution line 'a = 3 .*contains the solution line 'Because it starts"
    ):
        list(build_course(course))
    assert not course.release.exists()


def test_a_course_is_built(write: Callable) -> None:
    course = write(ANSWER + OPEN)
    assert list(build_course(course)) == ["tiny"]
    template = read_template(course, "tiny")
    assert template.title == "Tiny"
    assert template.cells == (
        Cell("tiny-answer", "answer", f"# name it a\n{CODE_STUB}", True, None, "Tiny", "Tiny"),
        Cell("tiny-open", "manual", TEXT_STUB, False, Decimal("0.1"), "Tiny", "Tiny"),
    )


def cell(metadata: str, source: str) -> str:
    return f"\n```{{code-cell}}\n:nbgrader: {metadata}\n\n{source}\n```\n"


def question(points: str, source: str = 'check("t")') -> str:
    return cell(f"{{grade_id: t, {points}}}", source)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        pytest.param(ANSWER.replace(BEGIN, "### BEGIN SOLUTON"), "tiny-answer: a misspelt .*BEGIN SOL", id="SOLUTON"),
        pytest.param(ANSWER.replace(BEGIN, "### begin solution"), "misspelt or unknown delimiter", id="lower case"),
        pytest.param(ANSWER.replace(BEGIN, "## BEGIN SOLUTION"), "misspelt or unknown delimiter", id="two hashes"),
        pytest.param(ANSWER.replace(BEGIN, "###BEGIN SOLUTION"), "misspelt or unknown delimiter", id="no space"),
        pytest.param(ANSWER.replace(BEGIN, "### BEGIN_SOLUTION"), "misspelt or unknown delimiter", id="underscore"),
        pytest.param(ANSWER.replace(BEGIN, "### BEGIN ANSWER"), "do not match", id="one of another name"),
        pytest.param(
            ANSWER.replace(BEGIN, "### BEGN").replace(END, "### ED"), "an answer cell without", id="both garbled"
        ),
        pytest.param(ANSWER.replace(END + "\n", ""), "1 BEGIN SOLUTION and 0 END SOLUTION", id="no end"),
        pytest.param(ANSWER.replace(BEGIN + "\n", ""), "0 BEGIN SOLUTION and 1 END SOLUTION", id="no beginning"),
        pytest.param(
            ANSWER.replace(BEGIN, "x").replace(END, BEGIN).replace("x\n", END + "\n"), "do not match", id="inverted"
        ),
        pytest.param(ANSWER.replace(BEGIN, BEGIN + "\n" + BEGIN), "2 BEGIN SOLUTION and 1 END", id="nested"),
        pytest.param(ANSWER + ANSWER, "tiny-answer: the grade_id is used twice", id="duplicate"),
        pytest.param(
            cell("{grade_id: t-answer, solution: true}", "a = 3"), "t-answer: an answer cell without a solution region",
            id="no region",
        ),
        pytest.param(
            cell("{grade_id: t-given, locked: true}", f"{BEGIN}\na = 3\n{END}"),
            "t-given: contains a solution but is not an answer", id="a solution in a given cell",
        ),
        pytest.param(
            f"\n```{{code-cell}}\n{BEGIN}\na = 3\n{END}\n```\n", "contains a solution but is not an answer",
            id="a solution in a plain cell",
        ),
        pytest.param(
            question("points: 1", 'check("t")\n### BEGIN HIDDEN TEST\nassert a == 3\n### END HIDDEN TEST'),
            "misspelt or unknown delimiter .*BEGIN HIDDEN", id="a hidden test",
        ),
        pytest.param(question("points: 1", 'check("u")'), r't: a question must contain check\("t"\) and nothing else',
                     id="a check of another question"),
        pytest.param(question("points: 1", 'check("t")\na = 3'), "and nothing else", id="more than a check"),
        pytest.param(question("points: 1"), "t: the notebook has this question, but there is no check for it. "
                     r"Write Question\(\"t\", judge\), with a function judge\(ask\) that returns a Verdict: write "
                     r"labsid/checks/assignments/tiny/__init__.py, with ASSIGNMENT = Assignment\('tiny', ",
                     id="a question without a check"),
        pytest.param(question("points: -1"), "t: points must not be negative", id="negative points"),
        pytest.param(question("points: .inf"), "t: points must not be negative", id="infinite points"),
        pytest.param(question("points: .nan"), "t: points must not be negative", id="points NaN"),
        pytest.param(question("points: many"), "points must not be negative, got many",
                     id="points of text"),
        pytest.param(question("point: 1"), "t: unknown metadata point", id="point"),
        pytest.param(question("points: 1, values: [a]"), "t: only a question with manual: true has a rubric and values",
                     id="values of a check"),
        pytest.param(question("points: 1, manual: true, values: [a b]"), r"t: values must be a list of names .*'a b'",
                     id="values that are no names"),
        pytest.param(question("points: 1, manual: true, rubric: [{text: a, points: 0.3}]"),
                     "t: the points of the rubric add up to 0.3, but the question has 1", id="a sum that is not right"),
        pytest.param(question("points: 1, manual: true, rubric: [{text: a}]"), "t: rubric must be a list of",
                     id="a line without points"),
        pytest.param(question("points: 1, manual: true, rubric: [{text: a, points: 2}, {text: b, points: -1}]"),
                     "t: rubric must be a list of", id="negative points of a line"),
        pytest.param(question("points: 1, manual: true, rubric: 3"), "t: rubric must be a list of", id="no list"),
        pytest.param(cell("{grade_id: t u, locked: true}", "a = 3"), "needs a grade_id of letters", id="id with space"),
        pytest.param(cell("{locked: true}", "a = 3"), "the cell 'a = 3': needs a grade_id", id="no id"),
        pytest.param(cell("3", "a = 3"), "needs a grade_id .*got nbgrader: 3", id="metadata that is a number"),
        pytest.param(cell("{grade_id: t", "a = 3"), "Invalid YAML", id="metadata that is not closed"),
        pytest.param(ANSWER.replace(":nbgrader:", ":nbgradr:"), "unknown metadata nbgradr", id="nbgradr"),
    ],
)  # fmt: skip
def test_what_must_not_be_released_is_named_and_nothing_is_written(write: Callable, text: str, said: str) -> None:
    course = write(text)
    with pytest.raises(ValueError, match=f"(?s)tiny.md cannot be released: .*{said}"):
        list(build_course(course))
    assert list((course.root / "autograder").iterdir()) == []


def test_every_mistake_of_a_notebook_is_said_at_once(write: Callable) -> None:
    course = write(ANSWER + ANSWER + cell("{grade_id: t, points: 1}", "pass"))
    with pytest.raises(ValueError, match=r"twice; .*nothing else, or .*; .*no check"):
        list(build_course(course))


def test_a_question_may_be_worth_nothing(write: Callable) -> None:
    """As practice, or to be marked with extra credit."""
    built = write(f"{ANSWER}\n{question('points: 0', 'assert a == 3')}")
    list(build_course(built))
    (worth,) = (one for one in read_template(built, "tiny").questions if one.id == "t")
    assert worth.points == 0


def test_an_answer_may_have_several_regions(write: Callable) -> None:
    course = write(ANSWER.replace("```\n", "", 1).replace(END, f"{END}\n# and b\n{BEGIN}\nb = 10 + 11 + 12\n{END}", 1))
    assert list(build_course(course)) == ["tiny"]
    (answer,) = read_template(course, "tiny").cells
    assert "a = 3" not in answer.source
    assert "b = 10" not in answer.source
    assert "# and b" in answer.source


@pytest.mark.parametrize("name", ASSIGNMENTS)
def test_notebook_and_checks_fit_together(name: str, course: Course) -> None:
    source = nbformat.read(course.source / name / f"{name}.ipynb", as_version=4)
    assert list(lint_checks(source, name)) == []
    asks = [cell for cell in source.cells if cell.source.startswith("check(")]
    assert len(asks) == len(load_assignment(name).questions) > 2

    renamed = source.copy()
    renamed.cells = [cell for cell in source.cells if cell is not asks[0]]
    file = f"labsid/checks/assignments/{name.replace('-', '_')}/__init__.py"
    unasked = (
        f"{asks[0].id}: {file} has a check for it, but the notebook has no such question. Write a code cell "
        f':nbgrader: {{grade_id: {asks[0].id}, points: 1}} with check("{asks[0].id}") in notebooks/{name}/{name}.md, '
        "or delete this Question"
    )
    assert list(lint_checks(renamed, name)) == [unasked]
    asks[0].metadata.nbgrader.grade_id = "else"
    assert list(lint_checks(source, name)) == [
        'else: the notebook has this question, but there is no check for it. Write Question("else", judge), with a '
        f"function judge(ask) that returns a Verdict: add it to the questions of ASSIGNMENT in {file}",
        unasked,
    ]
    asks[0].metadata.nbgrader.grade_id, asks[1].metadata.nbgrader.grade_id = asks[1].id, asks[0].id
    (problem,) = lint_checks(source, name)
    assert problem.startswith("the checks are in a different order than the questions. Put the questions of ")
    assert f"in {file} in the order of the notebook: {asks[1].id}, {asks[0].id}" in problem


@pytest.mark.parametrize("name", ASSIGNMENTS)
def test_checks_start_from_earlier_ones(name: str, course: Course) -> None:
    """Or the judge would have no right value to put in the place of a wrong one."""
    assignment = load_assignment(name)
    assert assignment.name == name
    assert assignment.record_file is None or (course.data / assignment.record_file).is_file()
    earlier: set[str] = set()
    for question in assignment.questions:
        assert set(question.uses) <= earlier, question.id
        earlier.add(question.id)
    assert len(earlier) == len(assignment.questions)
    assert name in course.assignments()


def test_the_lab_is_worth_exactly_two_marks(course: Course) -> None:
    questions = read_template(course, "lab-identification").questions
    assert sum(question.points for question in questions) == Decimal("2")
    for part, worth in (("lab-1", "0.6"), ("lab-2", "0.6"), ("lab-3", "0.8")):
        points = [question.points for question in questions if question.id.startswith(part)]
        assert sum(points) == Decimal(worth)
    assert all(question.id.startswith(("lab-1", "lab-2", "lab-3")) for question in questions)
    assert {question.kind for question in questions} == {"question", "manual"}


@pytest.mark.parametrize("name", ASSIGNMENTS)
def test_ids_say_where_they_belong(name: str, course: Course) -> None:
    """A question's answer stands in a cell of its name, so that feedback and samples can find it."""
    cells = read_template(course, name).cells
    ids = {cell.id for cell in cells}
    assert len(ids) == len(cells)
    for cell in cells:
        if cell.kind == "question":
            assert f"{cell.id}-answer" in ids
        assert cell.heading


def test_a_course_without_assignments_is_said(tmp_path: Path) -> None:
    (tmp_path / "notebooks" / "scratch").mkdir(parents=True)
    (tmp_path / "notebooks" / "scratch" / "notes.md").write_text("# Notes", encoding="utf-8")
    with pytest.raises(ValueError, match="no assignments in"):
        list(build_course(Course(tmp_path)))


def test_a_text_that_is_none_is_said(write: Callable) -> None:
    course = write("")
    path = course.notebooks / "tiny" / "tiny.md"
    path.write_bytes(b"\xff\xfe")
    with pytest.raises(ValueError, match="utf-8"):
        build_source(path)


def test_an_assignment_that_is_not_built_is_said(write: Callable) -> None:
    with pytest.raises(ValueError, match=r"tiny has not been built .*labsid course build"):
        read_template(write(ANSWER), "tiny")


def test_a_rubric_is_with_the_solutions_and_in_no_release(course: Course) -> None:
    for name in course.assignments():
        release = (course.release / name / f"{name}.ipynb").read_text(encoding="utf-8")
        assert "rubric" not in release
        for question, text in read_questions(course, name).items():
            assert not any(one.text in release for one in text.rubric), question
    (marked,) = (text for text in read_questions(course, "postlab-model-order").values() if text.rubric)
    assert marked.values == ("mse_1", "mse_2")
    assert [one.points for one in marked.rubric] == [Decimal(points) for points in ("0.04", "0.02", "0.03", "0.01")]
    notebook = nbformat.read(course.source / "postlab-model-order" / "postlab-model-order.ipynb", as_version=4)
    assert next(iter(lint_release(notebook, notebook))).endswith("the release still contains its rubric")


def test_any_change_of_a_release_changes_its_fingerprint() -> None:
    one = Cell("q", "question", "check", True, Decimal("0.10"))
    fingerprint = template_hash(Template("a", "A", (one,)))
    for other in (
        Cell("r", "question", "check", True, Decimal("0.10")),
        Cell("q", "manual", "check", True, Decimal("0.10")),
        Cell("q", "question", "check ", True, Decimal("0.10")),
        Cell("q", "question", "check", True, Decimal("0.20")),
        Cell("q", "question", "check", True, None),
    ):
        assert template_hash(Template("a", "A", (other,))) != fingerprint
    assert template_hash(Template("a", "A", ())) != fingerprint
    assert template_hash(Template("a", "Another title", (one,))) == fingerprint
