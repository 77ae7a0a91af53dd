"""Ways to turn what a student's machine knows into an answer: none earns what follows from the data.

Each hand-in is the model solution of the post-lab with one answer replaced. Nothing of a hidden record is ever shown.
"""

import base64
import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import pytest
from course_work import GradeCode, copy_course, read_solved
from one_answer import solve

from autograder.course.build import build_course
from autograder.course.layout import Course
from autograder.course.own_secret import read_own_secret
from autograder.intake.submission import NotebookCell, Submission
from autograder.judge.hidden_records import TYPED_IN, record_seed
from autograder.judge.outcome import QuestionResult
from autograder.sandbox.isolation import Limits, open_launcher
from labsid.checks.other_records import another_record
from labsid.records.record import Record, load_record

NAME = "postlab-model-order"
FILE = "SysIdenData_StudentVersion.mat"
THETA = "postlab-1-theta"


@dataclass(frozen=True)
class Known:
    """What a student's machine knows: the right answer on the student's own record, and the record."""

    theta: str
    content: str
    total: float


LIMITS = Limits(cell_seconds=5, call_seconds=5, memory_bytes=1 << 30)


@pytest.fixture(scope="module")
def course(tmp_path_factory: pytest.TempPathFactory) -> Course:
    """A course of one assignment."""
    built = copy_course(tmp_path_factory.mktemp("course"), NAME)
    assert list(build_course(built)) == [NAME]
    return built


@pytest.fixture(scope="module")
def grade_code(course: Course) -> Iterator[GradeCode]:
    """Without isolation, where files of a first run can be found by a second one."""
    with open_launcher("none", LIMITS) as opened:
        yield GradeCode(course, opened)


@pytest.fixture(scope="module")
def known(course: Course) -> Iterator[Known]:
    content = (course.data / FILE).read_bytes()
    solved = solve(NAME, "s", content)
    theta = solved.run_before("postlab-1-theta")["theta_1"].tolist()
    assert solved.record is not None
    total = float(solved.record.y.sum())
    yield Known(f"np.array({theta})", base64.b64encode(content).decode(), total)
    for folder in ("/tmp", "/dev/shm"):
        Path(folder, "labsid-kept-theta").unlink(missing_ok=True)


ATTACKS = {
    "typed in": "theta_1 = {theta}",
    "typed in as text": "theta_1 = np.array([float(x) for x in '{theta}'[10:-2].split(',')])",
    "hidden in an expression": "theta_1 = {theta} + 0 * Phi_1[0]",
    "hidden behind the computed value": "theta_1 = np.linalg.lstsq(Phi_1, Y_1)[0]\ntheta_1 += {theta} - theta_1",
    "a table by the hash of the record": (
        "import hashlib\nkey = hashlib.sha256(y_act.tobytes()).hexdigest()\ntable = {{key: {theta}}}\n"
        "theta_1 = table.get(hashlib.sha256(y_act.tobytes()).hexdigest())"
    ),
    "a table by the length of the record": "theta_1 = {{903: {theta}}}.get(len(y_act))",
    "only where the record is not known": "theta_1 = {theta} if abs(y_act.sum() - {total}) < 1e-6 else {theta} * 1.5",
    "one's own record in the notebook": (
        "import base64\nopen('own.mat', 'wb').write(base64.b64decode('{content}'))\nown = load_record('own.mat')\n"
        "n = np.flatnonzero(own.u != own.u[0])[0]\nuu, yy = own.u - own.u[0], own.y - own.y[:n].mean()\n"
        "theta_1 = np.linalg.lstsq(np.column_stack([yy[:450], uu[:450]]), yy[1:451])[0]"
    ),
    "one's own record in the place of the other": (
        "import base64\nopen('SysIdenData_StudentVersion.mat', 'wb').write(base64.b64decode('{content}'))\n"
        "own = load_record('SysIdenData_StudentVersion.mat')\nn = np.flatnonzero(own.u != own.u[0])[0]\n"
        "uu, yy = own.u - own.u[0], own.y - own.y[:n].mean()\n"
        "theta_1 = np.linalg.lstsq(np.column_stack([yy[:450], uu[:450]]), yy[1:451])[0]"
    ),
    "kept from the first run": (
        "import os, pathlib\n"
        "places = [pathlib.Path(p) / 'labsid-kept-theta' for p in ('/tmp', '/dev/shm', '.', '..')]\n"
        "theta_1 = np.linalg.lstsq(Phi_1, Y_1)[0]\n"
        "for place in places:\n    try:\n        theta_1 = np.fromstring(place.read_text(), sep=' ')\n"
        "    except OSError:\n        pass\n"
        "theta_1 = {theta}\n"
        "for place in places:\n    try:\n        place.write_text(' '.join(map(repr, theta_1.tolist())))\n"
        "    except OSError:\n        pass"
    ),
    "what the check compares with": (
        "try:\n    theta_1 = check._known()['theta_1']\nexcept Exception:\n    theta_1 = {theta}"
    ),
    "skipped": "check.skip('postlab-1-theta')\ntheta_1 = globals().get('theta_1', {theta})",
    "practised": (
        "theta_1 = {theta}\nfor name in ('practice', 'hint', 'skip'):\n    try:\n"
        "        found = getattr(check, name)('postlab-1-theta')\n"
        "        theta_1 = theta_1 if found is None else found\n"
        "    except Exception:\n        pass"
    ),
    "identified by labsid": (
        "theta_1 = {theta}\ntry:\n    from labsid import identify\n"
        "    theta_1 = np.array(identify(record, order=1).fit.theta)\n"
        "except Exception:\n    pass"
    ),
}


@pytest.mark.parametrize("attack", ATTACKS)
def test_what_a_machine_knows_earns_nothing(attack: str, known: Known, grade_code: GradeCode) -> None:
    code = ATTACKS[attack].format(theta=known.theta, content=known.content, total=known.total)
    results = grade_code(NAME, {f"{THETA}-answer": code})
    assert (results[THETA].score, results[THETA].reason) == (0, TYPED_IN), attack
    assert lost(results) == [THETA]


STOPPING = {
    "raises": "raise ValueError(repr(y_act.tolist()))",
    "ends the process": "import os\n    os._exit(1)",
    "does not end": "while True:\n        pass",
    "fills the memory": "theta_1 = bytearray(1 << 40)",
}


@pytest.mark.parametrize("how", STOPPING)
def test_what_stops_on_a_hidden_record_costs_its_question_and_tells_a_line_alone(
    how: str, known: Known, grade_code: GradeCode
) -> None:
    code = (
        f"print(y_act.tolist())\nif abs(y_act.sum() - {known.total}) > 1e-6:\n    {STOPPING[how]}\n"
        "theta_1 = np.linalg.lstsq(Phi_1, Y_1)[0]"
    )
    results = grade_code(NAME, {f"{THETA}-answer": code})
    line = r"( in line \d+)?"
    assert re.fullmatch(
        rf"On another record your code for this step stops{line}: it must work on any record of this kind\.",
        results[THETA].reason,
    )
    assert results[THETA].score == 0
    assert lost(results) == [THETA]


def test_nothing_of_a_hidden_record_is_shown(course: Course, known: Known, grade_code: GradeCode) -> None:
    """It prints, draws and raises what it reads; only what it read of the student's own record is stored."""
    code = (
        "theta_1 = np.linalg.lstsq(Phi_1, Y_1)[0]\nprint('first', y_act[:3].tolist(), theta_1.tolist())\n"
        f"if abs(y_act.sum() - {known.total}) > 1e-6:\n    theta_1 = y_act\n"
        "    exec('\\n' * int(1e3 * y_act[0]) + '1/0')"
    )
    results = grade_code(NAME, {f"{THETA}-answer": code})
    own = load_record(course.data / FILE)
    for number in (2, 3):
        hidden = hidden_record(course, code, number, own)
        digits = {f"{value:.4f}".rstrip("0") for value in hidden.y[:3]} - {f"{x:.4f}".rstrip("0") for x in own.y}
        told = " ".join(f"{one.reason} {one.output} {one.answer}" for one in results.values())
        assert not [text for text in digits if text in told]
        assert str(int(1e3 * hidden.y[0])) not in results[THETA].reason
    assert "first" in results[THETA].output


def hidden_record(course: Course, code: str, number: int, own: Record) -> Record:
    """The record on which the judge runs this hand-in."""
    seed = record_seed(read_own_secret(course), handed_in(course, code), number)
    path = Path(course.root) / "hidden" / FILE
    path.parent.mkdir(exist_ok=True)
    path.write_bytes(another_record(FILE, own, int.from_bytes(seed, "big")))
    return load_record(path)


def handed_in(course: Course, code: str, student: str = "s") -> Submission:
    template, solution = read_solved(course, NAME)
    texts = {**solution, f"{THETA}-answer": code}
    cells = tuple(
        NotebookCell(one.id, one.kind, texts[one.id] if one.kind in ("answer", "manual") else one.source, one.code)
        for one in template.cells
    )
    return Submission(student, NAME, "ready", cells, ())


def test_the_seed_is_the_same_on_appeal_and_another_for_any_other_hand_in(course: Course) -> None:
    secret = b"a secret of the tests"
    seed = record_seed(secret, handed_in(course, "theta_1 = 1"), 2)
    assert record_seed(secret, handed_in(course, "theta_1 = 1"), 2) == seed
    others = [
        record_seed(secret, handed_in(course, "theta_1 = 1"), 3),
        record_seed(secret, handed_in(course, "theta_1 = 2"), 2),
        record_seed(secret, handed_in(course, "theta_1 = 1", "t"), 2),
        record_seed(b"another secret", handed_in(course, "theta_1 = 1"), 2),
    ]
    assert len({seed, *others}) == 5


def test_honest_code_with_bad_luck_on_the_second_record_is_right_by_the_third(
    course: Course, grade_code: GradeCode
) -> None:
    """It is wrong where the input rests below a level: on the second record of this hand-in, and not on the third."""
    own = load_record(course.data / FILE)
    for turn in range(40):
        code = f"theta_1 = np.linalg.lstsq(Phi_1, Y_1)[0]  # {turn}\nif u_act[0] < own_rest - 0.001:\n    theta_1 *= 2"
        code = code.replace("own_rest", repr(float(own.u[0])))
        second, third = (hidden_record(course, code, number, own).u[0] for number in (2, 3))
        if second < own.u[0] < third:
            break
    assert second < own.u[0] < third
    assert lost(grade_code(NAME, {f"{THETA}-answer": code})) == []


def lost(results: dict[str, QuestionResult]) -> list[str]:
    return [one for one, r in results.items() if r.status != "manual" and r.score != r.max_score]
