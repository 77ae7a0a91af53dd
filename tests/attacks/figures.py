"""All attacks on one level of the ladder, in a process of its own that may belong to a plain user; prints what came.

``python -m attacks.figures LEVEL SECRET``, with SECRET one of ``secret`` and ``none``, works in the current folder.
"""

import json
import subprocess
import sys
from dataclasses import asdict, dataclass
from decimal import Decimal
from pathlib import Path

from course_work import copy_course

from attacks import Attack
from attacks.arena import ATTACKS, NAME, SECRET, Outcome, due_to, fight, scores_of, student_of
from autograder.course.build import build_course
from autograder.course.layout import Course
from autograder.sandbox.isolation import probe_levels

TESTS = Path(__file__).resolve().parent.parent
MINUTES = 20


@dataclass(frozen=True, slots=True)
class Figures:
    """What came of a batch of attacks.

    Attributes
    ----------
    level : str
    tried : int
        Attacks that must not succeed.
    undeserved : float
        Points that they got and should not have.
    touched : list of str
        Places that are not as they were, honest students who got something else, and what is left behind.
    open : int
        Attacks that only a sandbox stops, of which the grading run warns.
    open_undeserved : float
    problem : str
        Why the batch was aborted, or could not be tried; "" if it was graded.
    aborted : bool
    """

    level: str
    tried: int = 0
    undeserved: float = 0.0
    touched: tuple[str, ...] = ()
    open: int = 0
    open_undeserved: float = 0.0
    problem: str = ""
    aborted: bool = False


def gain(outcome: Outcome, course: Course, attack: Attack) -> Decimal:
    """Points that an attack got and should not have."""
    got, due = scores_of(outcome.results[student_of(attack)]), due_to(attack, course)
    return sum((max((got[key] or Decimal(0)) - (due[key] or Decimal(0)), Decimal(0)) for key in got), Decimal(0))


def fight_here(level: str, secret: bytes | None) -> Figures:
    """Grade all attacks in the current folder."""
    problem = next(one.problem for one in probe_levels() if one.name == level)
    if problem:
        return Figures(level, problem=problem)
    course = copy_course(Path("course").resolve(), NAME)
    list(build_course(course))
    folder = Path("batch").resolve()
    folder.mkdir()
    try:
        outcome = fight(course, folder, level, ATTACKS, secret)
    except Exception as error:  # whatever an attack can bring about
        return Figures(level, problem=f"{type(error).__name__}: {error}", aborted=True)
    known = [attack for attack in ATTACKS if outcome.level == "none" and attack.open_on_none]
    closed = [attack for attack in ATTACKS if attack not in known]
    touched = (*outcome.touched(), *outcome.harmed(), *outcome.left_running, *outcome.left_behind)
    return Figures(
        outcome.level,
        len(closed),
        float(sum(gain(outcome, course, attack) for attack in closed)),
        touched,
        len(known),
        float(sum(gain(outcome, course, attack) for attack in known)),
    )


def fight_as(user: tuple[int, int] | None, folder: Path, level: str, with_secret: bool) -> Figures:
    """Grade all attacks in a process of a user (uid, gid), or of the present one, in an empty folder."""
    command = [sys.executable, "-P", "-m", "attacks.figures", level, "secret" if with_secret else "none"]
    environment = {"PATH": "/usr/bin:/bin", "HOME": str(folder), "TMPDIR": str(folder), "PYTHONDONTWRITEBYTECODE": "1"}
    environment["PYTHONPATH"] = f"{TESTS.parent}:{TESTS}"
    other = {} if user is None else {"user": user[0], "group": user[1], "extra_groups": ()}
    try:
        done = subprocess.run(
            command, cwd=folder, env=environment, capture_output=True, text=True, timeout=60 * MINUTES, **other
        )
    except PermissionError as error:
        return Figures(level, problem=f"that user may not run {error.filename}")
    except subprocess.TimeoutExpired:
        return Figures(level, problem=f"longer than {MINUTES} minutes", aborted=True)
    if done.returncode:
        return Figures(level, problem=" ".join(done.stderr.split())[-300:], aborted=True)
    found = json.loads(done.stdout.splitlines()[-1])
    return Figures(**{**found, "touched": tuple(found["touched"])})


if __name__ == "__main__":
    print(json.dumps(asdict(fight_here(sys.argv[1], SECRET if sys.argv[2] == "secret" else None))))
