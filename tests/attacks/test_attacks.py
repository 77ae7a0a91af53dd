"""Attacks, graded in one batch beside two honest students: all of them on the best level, some on the other levels.

Loopback only. What attacks leave running is ended by the grader, which is what is tested.
"""

import base64
import hashlib
import hmac
import html
import os
import re
import zipfile
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from course_work import copy_course

from attacks import FUNCTION, NOISE, QUESTIONS, Attack, hand_ins, reach
from attacks.arena import (
    ATTACKS,
    HONEST,
    LIMITS,
    NAME,
    ON_ITS_PROCESS,
    SECRET,
    Outcome,
    due_to,
    fight,
    scores_of,
    student_of,
)
from autograder.course.build import build_course
from autograder.course.layout import Course
from autograder.intake.collect import collect_submissions
from autograder.sandbox.isolation import IsolationLevel, open_launcher, probe_levels
from labsid.checks.assignments.prelab_sinusoids.waveforms import check_function
from labsid.lab.sinusoid import make_sinusoids

pytestmark = pytest.mark.skipif(not hasattr(os, "fork"), reason="this system cannot fork")

ON = {"best": ATTACKS, "landlock": reach.ATTACKS, "none": ON_ITS_PROCESS}
"""What is tried on each level; `make bars` tries everything on every level. What reaches for files, the network and
other processes meets other walls on each; the limits of a process are the same."""
MARKS = {"none": [pytest.mark.exhaustive]}
"""Without isolation no wall is tested, only that the attacks are real: so do the trials of the doctor, everywhere."""


@pytest.fixture(scope="module")
def course(tmp_path_factory: pytest.TempPathFactory) -> Course:
    """A course of one assignment."""
    built = copy_course(tmp_path_factory.mktemp("course"), NAME)
    assert list(build_course(built)) == [NAME]
    return built


@pytest.fixture(scope="module")
def machine() -> list[IsolationLevel]:
    """The levels of the ladder on this machine."""
    return probe_levels()


@pytest.fixture(scope="module")
def outcomes() -> dict[str, Outcome]:
    """Each level's batch, graded when it is first asked for."""
    return {}


@pytest.fixture(params=[pytest.param(level, marks=MARKS.get(level, [])) for level in ON])
def outcome(
    request: pytest.FixtureRequest,
    course: Course,
    machine: list[IsolationLevel],
    outcomes: dict[str, Outcome],
    tmp_path_factory: Any,
) -> Outcome:
    """The batch as it was graded on a level."""
    wanted = request.param
    best = next(level.name for level in machine if not level.problem)
    if wanted != "best":
        problem = next(level.problem for level in machine if level.name == wanted)
        if problem or best == wanted:
            pytest.skip(problem or "it is the best level of this machine")
    if wanted not in outcomes:
        outcomes[wanted] = fight(course, tmp_path_factory.mktemp(wanted), wanted, ON[wanted])
    return outcomes[wanted]


ON_EACH = [
    pytest.param(level, one, id=f"{level}-{one.name}", marks=MARKS.get(level, []))
    for level, attacks in ON.items()
    for one in attacks
]
EVERYTHING = [level for level, attacks in ON.items() if attacks is ATTACKS]


@pytest.mark.parametrize(("outcome", "attack"), ON_EACH, indirect=["outcome"])
def test_an_attack_earns_what_it_should(
    attack: Attack, outcome: Outcome, course: Course, request: pytest.FixtureRequest
) -> None:
    if outcome.level == "none" and attack.open_on_none:
        request.applymarker(pytest.mark.xfail(strict=True, reason=attack.open_on_none))
    result = outcome.results[student_of(attack)]
    scores, expected = scores_of(result), due_to(attack, course)
    reasons = {one.question: one.reason for one in result.questions}
    assert scores == expected, reasons
    if attack.said:
        assert re.search(attack.said, reasons[attack.loses[0]]), reasons[attack.loses[0]]
    if attack.spares:
        assert outcome.untouched[attack.spares]


def test_attacks_have_names_of_their_own() -> None:
    assert len({student_of(attack) for attack in ATTACKS}) == len(ATTACKS)
    assert all(set(attack.loses) <= set(QUESTIONS) and attack.why for attack in ATTACKS)


def test_honest_students_get_what_they_get_without_attackers(outcome: Outcome) -> None:
    assert outcome.harmed() == []
    ada, ben = (outcome.results[student].questions for student in HONEST)
    assert all(one.score == one.max_score for one in ada if one.question in QUESTIONS)
    assert [one.question for one in ben if one.score == 0] == ["prelab-3-cut"]


def test_nothing_else_is_touched(outcome: Outcome) -> None:
    assert outcome.touched() == []


def test_nothing_is_left(outcome: Outcome) -> None:
    assert outcome.left_running == []
    assert outcome.left_behind == []


@pytest.mark.parametrize("outcome", EVERYTHING, indirect=True)
def test_pages_run_nothing(outcome: Outcome) -> None:
    for student, page in outcome.pages.items():
        shown = [base64.b64decode(picture).decode() for picture in re.findall(r"base64,([\w+/=]+)", page)]
        for text in (page, *shown):
            assert not re.search(r"<script|<img(?! alt=\"Your figure)|<iframe|\x1b|javascript:", text), student
            assert not re.search(r"<[^>]*\son\w+\s*=", text), student
    planted = outcome.pages["HTML-and-colours-in-output-and-error"]
    assert html.escape(hand_ins.SCRIPT, quote=False).replace("'", "&#39;") in planted


def test_pages_hold_no_hidden_input(outcome: Outcome) -> None:
    for student, page in outcome.pages.items():
        numbers = {repr(abs(value))[:8] for array in hidden_inputs(student) for value in array.ravel().tolist()}
        telling = [number for number in numbers if len(number) == 8 and len(set(number[-4:])) > 1]
        assert len(telling) > 100
        assert [number for number in telling if number in page] == [], student


def rng_of(student: str, question: str) -> np.random.Generator:
    """As the judge seeds it."""
    seed = hmac.new(SECRET, f"{student}\0{NAME}\0{question}".encode(), hashlib.sha256).digest()
    return np.random.default_rng(list(seed))


def hidden_inputs(student: str) -> list[np.ndarray]:
    """What the judge tries this student's function on."""
    tried: list[np.ndarray] = []

    class Asked:
        rng = rng_of(student, FUNCTION)

        def call(self, name: str, data: np.ndarray, n: int) -> np.ndarray:
            tried.append(data)
            right = data[n:].copy()
            right[:, 0] -= right[0, 0]
            return right

        def changes(self, name: str, *arguments: object) -> bool:
            return False

    assert check_function(Asked()).passed  # type: ignore[arg-type]
    return tried


@pytest.mark.parametrize("outcome", EVERYTHING, indirect=True)
def test_pages_hold_no_right_value_of_a_failed_step(outcome: Outcome) -> None:
    student = "right-values-of-a-failed-step-printed"
    printed = html.unescape(outcome.pages[student])
    assert [value for value in _right_noise(student) if repr(value) in printed] == []


def _right_noise(student: str) -> list[float]:
    found: list[float] = make_sinusoids(rng_of(student, NOISE)).y1.ravel().tolist()
    return found[:50]


@pytest.mark.skipif(not hasattr(os, "geteuid") or os.geteuid() != 0, reason="only root gives files away")
@pytest.mark.parametrize(
    "code", ["os.rmdir(here)\nos.symlink(other, here)", "os.link(f'{other}/gradebook.db', 'mine')"]
)
def test_a_work_folder_that_leads_elsewhere_gives_nothing_away(tmp_path: Path, code: str) -> None:
    """A process makes a link to what is not its own; cleaning up after it, as root, touches the link alone."""
    other, given = tmp_path / "other", tmp_path / "given"
    other.mkdir()
    given.mkdir()
    book = other / "gradebook.db"
    book.write_text("0.5", encoding="utf-8")
    tmp_path.chmod(0o755)
    before = [(path.stat().st_uid, path.stat().st_mode) for path in (other, book)]
    with open_launcher("none", LIMITS) as launcher:
        student = launcher.start(given)
        student.run(f"import os\nhere, other = os.getcwd(), {str(other)!r}\n{code}")
        student.close()
        again = launcher.start(given)
        assert again.run("open('mine', 'w').write('5')").ok
        again.close()
    assert [(path.stat().st_uid, path.stat().st_mode) for path in (other, book)] == before
    assert book.read_text(encoding="utf-8") == "0.5"
    assert [path.name for path in other.iterdir()] == [book.name]


def test_a_zip_bomb_costs_nobody_else_their_hand_in(course: Course, tmp_path: Path) -> None:
    notebook = (course.source / NAME / f"{NAME}.ipynb").read_bytes()
    bomb = tmp_path / "bomb.zip"
    with zipfile.ZipFile(bomb, "w", zipfile.ZIP_DEFLATED) as archive:
        for index in range(3):
            archive.writestr(f"{index}.ipynb", bytes(60 << 20), compresslevel=1)
    with zipfile.ZipFile(tmp_path / "moodle.zip", "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr(f"Ada_1_assignsubmission_file_/{NAME}.ipynb", notebook)
        archive.write(bomb, "Mallory_2_assignsubmission_file_/bomb.zip")
        archive.write(bomb, "Mallory_2_assignsubmission_file_/bomb2.zip")
        archive.writestr("Mallory_2_assignsubmission_file_/../../../out.ipynb", notebook)
        archive.writestr(f"Eve_3_assignsubmission_file_/{NAME}.ipynb", notebook)
    list(collect_submissions(course, tmp_path / "moodle.zip", tmp_path / "submitted"))
    taken = {path.relative_to(tmp_path / "submitted") for path in (tmp_path / "submitted").rglob("*.ipynb")}
    assert {Path("1", NAME, f"{NAME}.ipynb"), Path("3", NAME, f"{NAME}.ipynb")} <= taken
    assert all(path.parts[0] in ("1", "2", "3") for path in taken)
    assert sum(path.stat().st_size for path in (tmp_path / "submitted").rglob("*") if path.is_file()) < 60 << 20
