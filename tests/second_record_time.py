"""Processor time of grading a class with the second record against that of one run of each hand-in.

`python -P tests/second_record_time.py` prints a line for each assignment; `make bars` has the same figures.
"""

import os
import shutil
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
sys.path.insert(0, str(Path(__file__).resolve().parent.parent))

from course_work import copy_course
from record_draws import with_record

from autograder.batch.executors import LocalExecutor
from autograder.batch.grade import grade_batch
from autograder.batch.selection import find_batch
from autograder.course.build import build_course
from autograder.course.layout import Course
from autograder.sandbox.isolation import open_launcher

HAND_INS = 16


def ratios(folder: Path) -> Iterator[tuple[str, float, float]]:
    """Name, processor seconds of one run, and of the runs with the second record, for a class in each assignment."""
    course = copy_course(folder / "course")
    list(build_course(course))
    for name in with_record():
        for number in range(HAND_INS):
            to = folder / name / f"s{number}" / name
            to.mkdir(parents=True)
            shutil.copy(course.source / name / f"{name}.ipynb", to)
        single, double = (processor_seconds(course, name, folder, is_on) for is_on in (False, True))
        yield name, single, double


def processor_seconds(course: Course, name: str, folder: Path, is_on: bool) -> float:
    """Of everything that grading the class takes, in this process and in all that it starts."""
    switch = f"[assignments.{name}]\nsecond-record = {str(is_on).lower()}\n"
    (course.root / "course.toml").write_text(switch, encoding="utf-8")
    began = sum(os.times()[:4])
    with open_launcher("best") as launcher:
        batch = find_batch(course, folder / name, name)
        list(grade_batch(course, batch, folder / f"{name}-{is_on}", LocalExecutor(launcher, 2)))
    return sum(os.times()[:4]) - began


if __name__ == "__main__":
    with tempfile.TemporaryDirectory(prefix="labsid-") as scratch:
        for assignment, one, both in ratios(Path(scratch)):
            print(f"{assignment}: {one:.1f} s, with the second record {both:.1f} s, {both / one:.2f} times", flush=True)
