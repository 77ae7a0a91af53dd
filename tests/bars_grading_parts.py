"""What is measured for each bar of the grading, of batches on a cluster, and of simulations in MuJoCo.

Every part says how far it is, and yields its metrics.
"""

import os
import statistics
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from dataclasses import dataclass
from datetime import datetime
from decimal import Decimal
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import bars_fleet
import bars_mujoco
import bars_simulators
import nbformat
import record_draws
import second_record_time
import wrong_draws
from attacks.arena import ATTACKS
from attacks.figures import Figures, fight_as
from bars_grading_figures import Metric, at_least, at_most, every, none
from bench_grading import OURS, compare, disturb
from course_work import GradeCode, copy_course, execute_solution
from variants import Right, Wrong, questions_lost, variants_of

from autograder.course.build import build_course
from autograder.judge.outcome import QuestionResult
from autograder.sandbox.isolation import LEVELS, Limits, open_launcher
from labsid.checks.notebook import assignment_names, load_assignment


@dataclass(frozen=True, slots=True)
class Size:
    """How much is measured: hand-ins beside nbgrader, kills, draws of the trials, what runs at a time, and records."""

    submissions: int
    kills: int
    draws: int
    jobs: int
    records: int


Say = Callable[[str], None]
PLAIN = (65534, 65534)
"""User and group of the attacks as a plain user, where this is run as root: nobody, who owns no files."""

Part = Callable[[Path, Size, Say], Iterator[Metric]]
"""Measures in an empty folder."""


def answers(folder: Path, size: Size, say: Say) -> Iterator[Metric]:
    """Right answers that differ from the model solution, and wrong ones, to every question of every assignment."""
    course = copy_course(folder / "course")
    list(build_course(course))
    right = wrong = full = rewarded = spoiled = named = 0
    limits = Limits(cell_seconds=60, call_seconds=30)
    with open_launcher(limits=limits) as launcher, ThreadPoolExecutor(size.jobs) as pool:
        grade_code = GradeCode(course, launcher)

        def graded(name: str, variant: Right | Wrong) -> tuple[Right | Wrong, dict[str, QuestionResult]]:
            return variant, grade_code(name, variant.code)

        for number, name in enumerate(course.assignments(), start=1):
            variants = variants_of(name)
            say(f"{name}, {number} of {len(course.assignments())}: {len(variants)} answers")
            for variant, results in pool.map(graded, [name] * len(variants), variants):
                lost = questions_lost(results)
                own = results[variant.question]
                if isinstance(variant, Right):
                    right, full = right + 1, full + (not lost)
                else:
                    wrong, named = wrong + 1, named + (own.slip is not None)
                    rewarded += own.score == own.max_score
                    spoiled += bool(set(lost) - {variant.question})
                if bool(lost) == isinstance(variant, Right) or set(lost) - {variant.question}:
                    say(f"  {variant.question}: {variant.name}: {lost or 'full marks'}")
    yield every("correct but different answers with full marks", full, right)
    name = f"{wrong} wrong answers: with full marks / affecting another question"
    yield none(name, rewarded, spoiled)
    yield at_least("wrong answers whose mistake the feedback names", 100 * named / wrong, 80, 95, "%")


def draws(folder: Path, size: Size, say: Say) -> Iterator[Metric]:
    """The trials of the checks drawn anew for each planted wrong answer."""
    names = assignment_names()
    questions = [[question.id for question in load_assignment(name).questions] for name in names]
    passed: list[str] = []
    tried = 0
    with ProcessPoolExecutor(size.jobs, mp_context=get_context("spawn")) as pool:
        results = pool.map(wrong_draws.draw, names, questions, [size.draws] * len(names))
        for name, (lucky, count) in zip(names, results, strict=True):
            say(f"{name}: {count} verdicts, {len(lucky)} answers passed")
            for line in lucky:
                say(f"  {line}")
            passed += lucky
            tried += count
    yield none(
        f"{tried} verdicts on wrong answers, each with {size.draws} draws of its trials: answers that passed",
        len(passed),
    )


def records(folder: Path, size: Size, say: Say) -> Iterator[Metric]:
    """Other records drawn for typed-in values and right styles, and the time that a second record takes."""
    names = record_draws.with_record()
    share = -(-size.draws // size.jobs)
    parts = [(name, first) for name in names for first in range(0, size.draws, share)]
    refused = passed = tried = 0
    with ProcessPoolExecutor(size.jobs, mp_context=get_context("spawn")) as pool:
        found = pool.map(record_draws.counted, *zip(*parts, strict=True), [share] * len(parts))
        for (name, first), (lines, count) in zip(parts, found, strict=True):
            say(f"{name}, draws from {first}: {count} answers, {len(lines)} kinds not as they should be")
            for line in lines:
                say(f"  {line}")
            passed += sum(line.startswith(record_draws.PASSES) for line in lines)
            refused += sum(not line.startswith(record_draws.PASSES) for line in lines)
            tried += count
    what = f"{tried} answers on {size.draws} draws of another record: right styles refused / typed-in values that pass"
    yield none(what, refused, passed)
    for name, single, double in second_record_time.ratios(folder):
        yield at_most(f"{name}: processor time with the second record", double / single, 1.5, 1.2, "times")


def attacks(folder: Path, size: Size, say: Say) -> Iterator[Metric]:
    """The attack suite on every level of the ladder, with a secret and without, as each user that there is."""
    is_root = hasattr(os, "geteuid") and os.geteuid() == 0
    users: dict[str, tuple[int, int] | None] = {"as root": None, "as a plain user": PLAIN} if is_root else {"": None}
    folder.chmod(0o755)
    for user, ids in users.items():
        for level in LEVELS:
            for with_secret in (True, False):
                setting = " ".join(filter(None, (level, user, "with a secret" if with_secret else "without a secret")))
                say(f"{len(ATTACKS)} attacks, {setting}")
                own = folder / setting.replace(" ", "-")
                own.mkdir()
                if ids is not None:
                    os.chown(own, *ids)
                found = fight_as(ids, own, level, with_secret)
                yield from of_attacks(found, setting, say)


def of_attacks(found: Figures, setting: str, say: Say) -> Iterator[Metric]:
    """The metrics of a batch of attacks."""
    what = "undeserved points / batch aborted / others' grades or files touched"
    if found.problem:
        say(f"  {found.problem}")
        status = "missed" if found.aborted else "not tried"
        yield Metric(f"attacks, {setting}: {what}", f"- / {int(found.aborted)} / -", "0 / 0 / 0", "", status)
        return
    for place in found.touched:
        say(f"  touched: {place}")
    yield none(f"{found.tried} attacks, {setting}: {what}", Decimal(str(found.undeserved)), 0, len(found.touched))
    if found.open:
        name = f"{found.open} attacks, {setting}, which only a sandbox stops: undeserved points"
        yield Metric(name, f"{found.open_undeserved:g}", status="warned when grading")


def speed(folder: Path, size: Size, say: Say) -> Iterator[Metric]:
    """The same honest hand-ins, graded by labsid and by nbgrader."""
    say(f"{size.submissions} hand-ins; nbgrader takes some seconds for each")
    found = compare(folder, size.submissions, size.jobs)
    assert found.stock is not None
    what = f"{found.submissions} hand-ins, speed relative to nbgrader autograde"
    yield at_least(f"{what}: time", found.stock.seconds / found.ours.seconds, 10, 25, "times")
    yield at_least(f"{what}: processor time", found.stock.cpu / found.ours.cpu, 10, 25, "times")


def kills(folder: Path, size: Size, say: Say) -> Iterator[Metric]:
    """Grading killed at random moments and restarted."""
    say(f"{size.submissions} hand-ins, undisturbed")
    found = compare(folder, size.submissions, size.jobs, ours_only=True)
    say(f"the same, killed {size.kills} times")
    came = disturb(folder, found, size.kills, lambda text: say(f"  {text}"))
    say(f"  {came.while_grading} while grading, {came.while_entering} while filling the gradebook")
    name = f"killed {size.kills} times while grading {size.submissions} hand-ins: grades lost / doubled"
    yield none(name, came.lost, came.doubled)


def course(folder: Path, size: Size, say: Say) -> Iterator[Metric]:
    """The whole course built by its command, every solution executed in a kernel, each check twice, and timed."""
    made = copy_course(folder / "course")
    say("building the course")
    began = time.perf_counter()
    subprocess.run([sys.executable, "-c", OURS, str(made.root), "course", "build"], check=True, stdout=subprocess.PIPE)

    def execute(name: str) -> Any:
        ask_twice(made.source / name / f"{name}.ipynb")
        say(f"executing {name}")
        return execute_solution(made, name, folder / name)

    with ThreadPoolExecutor(size.jobs) as pool:
        notebooks = list(pool.map(execute, made.assignments()))
    seconds = time.perf_counter() - began
    cells = [cell for notebook in notebooks for cell in notebook.cells if is_check(cell)]
    first, again = ({cell.source: taken(cell) for cell in some} for some in (cells[::2], cells[1::2]))
    for times in (first, again):
        slowest = sorted(times, key=lambda question: times[question])[-3:]
        said = ", ".join(f"{question} {times[question]:.3f} s" for question in slowest)
        say(f"  slowest checks: {said}; median {statistics.median(times.values()):.3f} s")
    what = "slowest of"
    yield at_most(f"{what} {len(again)} checks in the notebook, after imports", max(again.values()), 0.5, 0.2, "s")
    yield at_most(
        f"{what} {len(first)} first checks in the notebook, with their imports", max(first.values()), 0.5, 0.2, "s"
    )
    opened = max(map(first_answer, notebooks))
    yield Metric("a fresh kernel up to its first check, with all imports", f"{opened:.3g} s", status="no bar")
    yield at_most("whole course rebuilt and every solution notebook executed", seconds, 180, 60, "s")


def ask_twice(path: Path) -> None:
    """Put a second check behind every check of a notebook."""
    notebook = nbformat.read(path, as_version=4)
    twice = [[cell, nbformat.v4.new_code_cell(cell.source)] if is_check(cell) else [cell] for cell in notebook.cells]
    notebook.cells = [cell for cells in twice for cell in cells]
    nbformat.write(notebook, path)


def is_check(cell: Any) -> bool:
    return cell.cell_type == "code" and cell.source.startswith('check("')


def taken(cell: Any) -> float:
    """Seconds from the kernel's start on a cell to its answer."""
    begun, ended = (cell.metadata.execution[key] for key in ("iopub.status.busy", "shell.execute_reply"))
    return (datetime.fromisoformat(ended) - datetime.fromisoformat(begun)).total_seconds()


def first_answer(notebook: Any) -> float:
    """Seconds that a student waits for a first answer: the cell that imports everything, and the first check."""
    opened = next(cell for cell in notebook.cells if "notebook_checks(" in cell.source)
    return taken(opened) + taken(next(filter(is_check, notebook.cells)))


def fleet(folder: Path, size: Size, say: Say) -> Iterator[Metric]:
    """Records diagnosed on two Dask workers, one of which is killed midway."""
    say(f"{size.records} records, about half a second to two for each")
    yield from bars_fleet.measure(folder, size.records, say)


def mujoco(folder: Path, size: Size, say: Say) -> Iterator[Metric]:
    """Rigs in MuJoCo diagnosed with a model of theirs that lacks the effect."""
    yield from bars_mujoco.measure(say)


def simulators(folder: Path, size: Size, say: Say) -> Iterator[Metric]:
    """One simulation given in three ways: what the diagnosis names with each."""
    say("half an hour, nearly all of it the runs of python-control and of the FMU")
    yield from bars_simulators.measure(folder, say)


PARTS: dict[str, Part] = {
    "answers": answers,
    "draws": draws,
    "records": records,
    "attacks": attacks,
    "speed": speed,
    "kills": kills,
    "course": course,
    "fleet": fleet,
    "mujoco": mujoco,
    "simulators": simulators,
}
