"""Processor time of a hand-in with its second record against that of one run on the student's own record.

`python -P tests/second_record_time.py` prints a line for each assignment; `make bars` has the same figures.
"""

import os
import sys
import tempfile
import time
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
sys.path.insert(0, str(Path(__file__).resolve().parent.parent))

from course_work import GradeCode, copy_course
from record_draws import with_record

from autograder.course.build import build_course
from autograder.sandbox.isolation import ProcessLauncher, open_launcher


def processor_seconds(launcher: ProcessLauncher) -> float:
    """Of this process, which judges, and of the fork server with all the student's processes that have ended."""
    fork_server = getattr(launcher, "fork_server_pid", 0)
    fields = Path(f"/proc/{fork_server}/stat").read_text(encoding="ascii").rsplit(")", 1)[1].split()
    return sum(map(int, fields[11:15])) / os.sysconf("SC_CLK_TCK") + time.process_time()


def ratios(folder: Path, times: int = 5) -> Iterator[tuple[str, float, float]]:
    """Name, seconds of one run, and seconds with the second record, of each assignment with a record."""
    course = copy_course(folder / "course")
    list(build_course(course))
    with open_launcher("best") as launcher:
        both = GradeCode(course, launcher, pictures=True)
        for name in with_record():
            seconds = []
            for grade in (replace(both, second_record=False), both):
                grade(name, {})  # what is loaded and cached once
                began = processor_seconds(launcher)
                for _ in range(times):
                    grade(name, {})
                seconds.append((processor_seconds(launcher) - began) / times)
            yield name, seconds[0], seconds[1]


if __name__ == "__main__":
    with tempfile.TemporaryDirectory(prefix="labsid-") as scratch:
        for assignment, single, double in ratios(Path(scratch)):
            print(f"{assignment}: {single:.3f} s, with the second record {double:.3f} s, {double / single:.2f} times")
