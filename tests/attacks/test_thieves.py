"""Functions and values that are looked for in the student's process instead of computed: no marks, on every level."""

import os
from collections.abc import Iterator
from pathlib import Path

import pytest
from course_work import GradeCode, built_course, read_solved, shared_folder
from representatives import mostly_exhaustive

from attacks.thieves import KIT, WAYS, raising_cells, thief_cells
from autograder.course.layout import Course
from autograder.judge.execution import Execution
from autograder.sandbox.isolation import Limits, ProcessLauncher, open_launcher
from autograder.sandbox.replacing import Replacement
from labsid.checks.notebook import assignment_names
from labsid.checks.permitted import is_reference

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(not hasattr(os, "fork"), reason="this system cannot fork"),
]

LIMITS = Limits(cell_seconds=20, call_seconds=10)
STRICT = "recursive-identification"
"""Its functions call each other, and its answers take little time."""
SHORT = "prelab-sinusoids"
"""Values, figures and a function. The walls are those of the process, and the same for every assignment."""


@pytest.fixture(scope="module")
def course(tmp_path_factory: pytest.TempPathFactory) -> Course:
    return built_course(tmp_path_factory.mktemp("course"), shared_folder(tmp_path_factory))


@pytest.fixture(scope="module")
def open_to_all() -> Iterator[ProcessLauncher]:
    with open_launcher("none", LIMITS) as opened:
        yield opened


def answers_of(course: Course, name: str) -> dict[str, str]:
    template, solution = read_solved(course, name)
    return {cell.id: solution[cell.id] for cell in template.cells if cell.kind == "answer" and cell.code}


def marked(course: Course, launcher: ProcessLauncher, name: str, cells: dict[str, str]) -> dict[str, str]:
    """The automatic questions with any mark, and the reasons."""
    results = GradeCode(course, launcher)(name, cells).values()
    return {one.question: one.reason for one in results if one.status != "manual" and one.score}


@pytest.mark.parametrize("name", mostly_exhaustive(assignment_names(), [SHORT, STRICT]))
def test_what_is_looked_for_is_not_there(
    name: str, course: Course, open_to_all: ProcessLauncher, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    answers, replaced = answers_of(course, name), set[str]()
    serve = Execution._serve

    def noting(self: Execution, *replacements: Replacement) -> None:
        replaced.update(name for one in replacements for name in one.names)
        serve(self, *replacements)

    monkeypatch.setattr(Execution, "_serve", noting)
    assert marked(course, open_to_all, name, thief_cells(answers, str(tmp_path))) == {}
    assert replaced, "there was nothing to find"
    if name == STRICT:  # a control: what is counted as no mark is none
        assert marked(course, open_to_all, name, raising_cells(answers)) == {}


def test_nor_in_a_sandbox(course: Course, tmp_path: Path) -> None:
    with open_launcher("best", LIMITS) as launcher:
        assert marked(course, launcher, SHORT, thief_cells(answers_of(course, SHORT), str(tmp_path))) == {}


@pytest.mark.parametrize("way", sorted(set(WAYS) - {"asked", "handlers"}))
def test_a_thief_finds_what_is_there(way: str, open_to_all: ProcessLauncher, tmp_path: Path) -> None:
    """A function that is defined in the process after the thief's, as the grader once did, and seen by later cells."""
    student = open_to_all.start(tmp_path)
    right = "def double(x):\n    return 2 * x\nholder = [double]\ndef outer():\n    return double\n"
    inside = "def make():\n    def double(x):\n        return 2 * x\n    return lambda x: double(x)\nmaker = make()"
    for source in (
        "NAMES = ['double']\n" + KIT.format(ways=(way,), stash=str(tmp_path)),
        "theft = double = thief('double')\nshop.first = theft\ndel theft",
        "del double\nshop.first = thief('double')" if way == "weak" else "pass",
        inside if way == "closures" else right,
        "import shop\nkeep()\nimport time\ntime.sleep(0.05)\nholder = [globals().get('double')]",
        "import wave" if way == "imports" else "pass",
        "found = shop.first(4)",
    ):
        reply = student.run(source)
        assert reply.ok, (source, reply.error)
    assert student.value("found").value == 8
    student.close()


def test_no_module_of_the_reference_is_in_the_process(open_to_all: ProcessLauncher, tmp_path: Path) -> None:
    """Nor a function or the code of one: what the grader needs there, and what notebooks may import."""
    student = open_to_all.start(tmp_path)
    reply = student.run(
        "import gc, types\ngc.unfreeze()\nfound = set()\nfor one in gc.get_objects():\n"
        "    for it in (one, *gc.get_referents(one)):\n"
        "        name = it.__name__ if isinstance(it, types.ModuleType) else getattr(it, '__module__', None)\n"
        "        if isinstance(name, str) and name.split('.')[0] in ('labsid', 'autograder'):\n"
        "            found.add(name)\nfound = sorted(found)"
    )
    assert reply.ok, reply.error
    names = set(student.value("found").value)  # type: ignore[arg-type]
    student.close()
    of_reference = {name for name in names if is_reference(name)}
    assert "labsid.checks.values" in names
    assert {name for name in of_reference if not name.startswith(("autograder.sandbox", "autograder.intake."))} == set()
