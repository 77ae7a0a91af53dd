"""Test cells of nbgrader: graded as they are, hidden tests in no release and no feedback, and what they say."""

import json
import re
from collections.abc import Iterator
from decimal import Decimal
from pathlib import Path

import pytest
from course_work import GradeCode

from autograder.course.build import build_course
from autograder.course.layout import Course, read_template
from autograder.course.lint import lint_release
from autograder.course.own_secret import make_own_secret
from autograder.intake.submission import NotebookCell, Submission
from autograder.judge.judging import Assets, judge_submission
from autograder.judge.outcome import QuestionResult
from autograder.sandbox.isolation import Limits, open_launcher
from labsid.checks.cells import Cell, Template
from labsid.checks.compare import SAME, as_number, as_vector
from labsid.checks.question import Ask, Assignment, Question
from labsid.checks.summary import FAILED, PASSED
from labsid.checks.verdict import Verdict, judge
from labsid.cli.commands import main
from labsid.hand_in.clean_run import run_from_clean_start
from labsid.hand_in.kernel import NotebookKernel
from labsid.hand_in.saved_work import read_saved

NAME, PRELAB = "old-course", "prelab-sinusoids"
WHERE = "(Checked in the student's process.)"
HEAD = "---\njupytext:\n  text_representation:\n    extension: .md\n    format_name: myst\n---\n\n# Old course\n"
HIDDEN = """
### BEGIN HIDDEN TESTS
assert square(-31) == 961, "it is wrong at -31"
### END HIDDEN TESTS"""
TESTS = {
    "test-square": 'from numpy.testing import assert_allclose\nassert square(2) == 4, "square(2) should be 4"' + HIDDEN,
    "test-list": "assert_allclose(squares, [1, 4, 9])",
    "test-sum": "assert total == 14\nassert total > 0, 'positive'",
    "test-all": "### BEGIN HIDDEN TESTS\nassert squares[2] == 9\n### END HIDDEN TESTS",
}
ANSWERS = {
    "cell-square": "def square(x):\n    ### BEGIN SOLUTION\n    return x**2\n    ### END SOLUTION",
    "cell-list": "### BEGIN SOLUTION\nsquares = [square(x) for x in (1, 2, 3)]\n### END SOLUTION",
    "cell-sum": "### BEGIN SOLUTION\ntotal = sum(squares)\n### END SOLUTION",
}


def full_metadata(grade_id: str, points: float | None = None) -> str:
    """As nbgrader writes them into a notebook."""
    grade = points is not None
    meta = {
        "checksum": "0" * 32, "grade": grade, "grade_id": grade_id, "locked": grade, "schema_version": 3,
        "solution": not grade, "task": False, "cell_type": "code", **({"points": points} if grade else {}),
    }  # fmt: skip
    return json.dumps(meta)


def cell(metadata: str, source: str) -> str:
    return f"\n```{{code-cell}}\n:deletable: false\n:nbgrader: {metadata}\n\n{source}\n```\n"


def write_course(root: Path, tests: dict[str, str] = TESTS) -> Course:
    """A course with one notebook of nbgrader and no checks; the last question has no answer cell of its own."""
    course = Course(root)
    (course.notebooks / NAME).mkdir(parents=True)
    (root / "autograder").mkdir()
    parts = [HEAD]
    for question, answer in zip(tests, [*ANSWERS, None], strict=False):
        parts += [cell(full_metadata(answer), ANSWERS[answer])] if answer is not None else []
        parts.append(cell(full_metadata(question, 2.0 if question == "test-square" else 0.5), tests[question]))
    (course.notebooks / NAME / f"{NAME}.md").write_text("".join(parts), encoding="utf-8")
    return course


@pytest.fixture(scope="module")
def old(tmp_path_factory: pytest.TempPathFactory) -> Course:
    """The course, built."""
    course = write_course(tmp_path_factory.mktemp("old"))
    make_own_secret(course)
    assert list(build_course(course)) == [NAME]
    return course


@pytest.fixture(scope="module")
def grade_old(old: Course) -> Iterator[GradeCode]:
    """Grade the model solution of it with some cells replaced."""
    with open_launcher(limits=Limits(cell_seconds=2, call_seconds=2)) as launcher:
        yield GradeCode(old, launcher)


def shown(results: dict[str, QuestionResult]) -> str:
    """What a student reads of the results."""
    return "\n".join(f"{one.reason} {one.output} {one.answer}" for one in results.values())


def test_the_release_has_the_tests_without_the_hidden_ones(old: Course) -> None:
    cells = {cell.id: cell for cell in read_template(old, NAME).cells}
    assert [(cells[name].kind, cells[name].points) for name in TESTS] == [
        ("tests", Decimal("2")), *[("tests", Decimal("0.5"))] * 3,
    ]  # fmt: skip
    assert cells["test-square"].source == TESTS["test-square"].replace(HIDDEN, "") + "\n# 2 marks"
    assert cells["test-all"].source.strip() == "# 0.5 marks"
    released = (old.release / NAME / f"{NAME}.ipynb").read_text(encoding="utf-8")
    assert not re.search(r"HIDDEN|-31|== 961|wrong at", released)


def test_the_solution_has_full_marks(grade_old: GradeCode) -> None:
    results = grade_old(NAME, {})
    assert {name: one.score for name, one in results.items()} == {
        "test-square": Decimal("2"), "test-list": Decimal("0.5"), "test-sum": Decimal("0.5"),
        "test-all": Decimal("0.5"),
    }  # fmt: skip
    assert {one.reason for one in results.values()} == {f"All tests passed. {WHERE}"}
    assert {one.status for one in results.values()} == {"graded"}


@pytest.mark.parametrize(
    ("replaced", "wrong", "said"),
    [
        ({"cell-square": "def square(x):\n    return x**2 + 1"}, "test-square", f"square(2) should be 4. {WHERE}"),
        ({"cell-square": "square = lambda x: x + x"}, "test-square", f"A test that is not shown failed. {WHERE}"),
        ({"cell-list": "squares = [1, 4, 8]"}, "test-list", "Not equal to tolerance"),
        ({"cell-sum": "total = 15"}, "test-sum", f"This test failed: assert total == 14 {WHERE}"),
        ({"cell-sum": "total = 1 / 0"}, "test-sum", "Your cell stopped in line 1 with ZeroDivisionError: division by"),
        ({"cell-sum": "pass"}, "test-sum", f"The tests stopped with NameError: name 'total' is not defined. {WHERE}"),
    ],
)  # fmt: skip
def test_a_failed_test_tells_its_message(grade_old: GradeCode, replaced: dict[str, str], wrong: str, said: str) -> None:
    results = grade_old(NAME, replaced)
    assert results[wrong].score == 0
    assert said in results[wrong].reason
    assert not re.search(r"31|961", shown(results))


def test_hidden_tests_run_on_the_variables_of_their_question(grade_old: GradeCode) -> None:
    """Whatever later cells do with them, in place too."""
    later = "total = sum(squares)\nsquares_before = squares\n"
    assert grade_old(NAME, {"cell-sum": later + "square = None"})["test-square"].score == 2
    results = grade_old(NAME, {"cell-list": ANSWERS["cell-list"] + "\nkept = [2]\ndef square(x):\n    return kept"})
    assert results["test-square"].score == 2
    spoilt = {
        "cell-square": "power = [2]\ndef square(x):\n    return x ** power[0]",
        "cell-sum": "total = sum(squares)\npower[0] = 5",
    }
    assert grade_old(NAME, spoilt)["test-square"].score == 2


def test_no_cell_can_print_what_is_hidden(grade_old: GradeCode) -> None:
    """The hidden tests run after the last cell."""
    spying = {
        "cell-square": "seen = []\ndef square(x):\n    seen.append(x)\n    print('called with', x)\n    return x**2",
        "cell-sum": "total = sum(squares)\nprint(seen)",
    }
    results = grade_old(NAME, spying)
    assert results["test-square"].score == 2
    assert results["test-sum"].output == "[2, 1, 2, 3]\n"
    assert not re.search(r"31|961", shown(results))


def test_a_crash_or_an_endless_loop_costs_its_question_only(grade_old: GradeCode) -> None:
    crash = grade_old(NAME, {"cell-list": "import os\nos._exit(1)", "cell-sum": "squares = [1, 4, 9]\ntotal = 14"})
    assert (crash["test-list"].status, crash["test-list"].score) == ("crashed", 0)
    assert (crash["test-square"].score, crash["test-sum"].score, crash["test-all"].score) == (
        2,
        Decimal("0.5"),
        Decimal("0.5"),
    )
    endless = "def square(x):\n    while x < 0:\n        pass\n    return x**2"
    results = grade_old(NAME, {"cell-square": endless})
    assert (results["test-square"].status, results["test-square"].score) == ("timeout", 0)
    assert results["test-all"].score == Decimal("0.5")


def test_tests_and_checks_in_one_notebook(tmp_path: Path) -> None:
    """A wrong answer to a check costs its question alone; the tests see the student's own values."""

    def gain(ask: Ask) -> Verdict:
        return judge(as_number("a", ask.value("a")), 3.0, SAME, "Right.", "Not the gain.")

    def line(ask: Ask) -> Verdict:
        x = ask.rng.normal(size=4)
        right = 2 * x + as_number("a", ask.known("a"))
        return judge(as_vector("f(x)", ask.call("f", x), 4), right, SAME, "Right.", "Not the line.")

    sources = {
        "q-gain-answer": ("answer", "a = 4"),
        "q-gain": ("question", 'check("q-gain")'),
        "cell-b": ("answer", "b = 2 * a"),
        "q-tests": ("tests", "assert b == 2 * a, 'b is twice a'"),
        "q-line-answer": ("answer", "c = 3\ndef f(x):\n    return 2 * x + c"),
        "q-line": ("question", 'check("q-line")'),
    }
    points = {name: Decimal("0.5") for name in ("q-gain", "q-tests", "q-line")}
    template = Template(
        "tiny", "Tiny", tuple(Cell(name, kind, "", True, points.get(name)) for name, (kind, _) in sources.items())
    )
    cells = tuple(NotebookCell(name, kind, text, True) for name, (kind, text) in sources.items())
    gains = Question("q-gain", gain, lambda ask: {"a": 3.0})
    assets = Assets(template, Assignment("tiny", (gains, Question("q-line", line, uses=("q-gain",)))), None, b"s")
    with open_launcher(limits=Limits(cell_seconds=5, call_seconds=5)) as launcher:
        results = judge_submission(Submission("s", "tiny", "ready", cells, ()), assets, launcher, tmp_path).results
    assert [(one.question, one.score) for one in results] == [
        ("q-gain", 0), ("q-tests", Decimal("0.5")), ("q-line", Decimal("0.5")),
    ]  # fmt: skip
    assert results[1].answer == "b = 2 * a"
    assert results[2].answer == sources["q-line-answer"][1]


@pytest.mark.slow
def test_the_summary_in_the_notebook_has_the_tests(course: Course, tmp_path: Path) -> None:
    notebook = json.loads((course.release / PRELAB / f"{PRELAB}.ipynb").read_text(encoding="utf-8"))
    tests = {"own-right": "assert 1 < 2", "own-wrong": "assert 1 > 2", "own-later": "assert True"}
    for name, source in tests.items():
        meta = {"nbgrader": {"grade": True, "grade_id": name, "points": 0.5, "solution": False}}
        notebook["cells"].append({"cell_type": "code", "id": name, "metadata": meta, "source": source, "outputs": []})
    (tmp_path / f"{PRELAB}.ipynb").write_text(json.dumps(notebook), encoding="utf-8")
    setup = next(one for one in notebook["cells"] if one["id"] == "prelab-setup")
    with NotebookKernel(tmp_path) as kernel:
        kernel.run("".join(setup["source"]), "prelab-setup", 60)
        for name in ("own-right", "own-wrong"):
            kernel.run(tests[name], name, 60)
        said = kernel.run("check.summary()", None, 60).printed
    states = {line.split()[1]: line.split()[0] for line in said.splitlines() if "own-" in line}
    assert states == {"own-right": "✓", "own-wrong": "✗", "own-later": "·"}


@pytest.mark.parametrize(
    ("tests", "said"),
    [
        ("total == 14", r'must contain check\("test-square"\) and nothing else, or assertions'),
        ("assert 1\n### BEGIN HIDDEN TEST\nassert 2\n### END HIDDEN TEST", "misspelt or unknown delimiter"),
        ("assert 1\n### BEGIN HIDDEN TESTS\nassert 2", "misspelt or unknown delimiter"),
    ],
)
def test_a_test_cell_that_cannot_be_released_is_named(tmp_path: Path, tests: str, said: str) -> None:
    course = write_course(tmp_path, {"test-square": tests})
    with pytest.raises(ValueError, match=f"(?s)cannot be released: test-square: .*{said}"):
        list(build_course(course))
    assert not course.release.exists()


def test_a_hidden_test_that_survives_is_named(old: Course) -> None:
    import nbformat

    source = nbformat.read(old.source / NAME / f"{NAME}.ipynb", as_version=4)
    problems = list(lint_release(source, source))
    assert any(line.startswith("test-square: the release still contains the hidden test line") for line in problems)


@pytest.mark.slow
def test_feedback_grades_and_hand_in_say_the_same(
    old: Course, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("autograder.course.layout.find_course", lambda: old)
    folder = tmp_path / "submitted" / "ada" / NAME
    folder.mkdir(parents=True)
    notebook = json.loads((old.release / NAME / f"{NAME}.ipynb").read_text(encoding="utf-8"))
    answers = {
        "cell-square": "def square(x):\n    return x + x", "cell-list": "squares = [1, 4, 9]", "cell-sum": "total = 15",
    }  # fmt: skip
    for one in notebook["cells"]:
        one["source"] = answers.get(one["id"], one["source"])
    path = folder / f"{NAME}.ipynb"
    path.write_text(json.dumps(notebook), encoding="utf-8")
    out = tmp_path / "out"
    assert main(["course", "grade", "--submitted", str(tmp_path / "submitted"), "--out", str(out)]) == 0
    grades = (out / "grades.csv").read_text(encoding="utf-8")
    assert f"ada,{NAME},test-square,0,2,graded,A test that is not shown failed. {WHERE}" in grades
    assert f"ada,{NAME},test-list,0.5,0.5,graded,All tests passed. {WHERE}" in grades
    assert main(["course", "feedback", "--out", str(out)]) == 0
    written = [
        file for file in out.rglob("*") if file.suffix in (".html", ".csv", ".json", ".ipynb") and file.is_file()
    ]
    assert len(written) > 2
    assert [file for file in written if re.search(r"-31|== 961|wrong at", file.read_text(encoding="utf-8"))] == []

    saved = read_saved(path)
    run = run_from_clean_start(saved.cells, saved.template, path)
    assert {one.question.id: one.state for one in run.states} == {
        "test-square": PASSED, "test-list": PASSED, "test-sum": FAILED, "test-all": PASSED,
    }  # fmt: skip
    assert "AssertionError" in run.reasons["test-sum"]
