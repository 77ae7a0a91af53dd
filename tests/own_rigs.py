"""Courses whose lab is about another rig: a simulated motor, and measured rigs where their records are."""

from pathlib import Path

import numpy as np
from course_work import copy_course

from autograder.course.build import build_course
from autograder.course.layout import Course
from labsid.checks.other_records.rig_model import RigModel, make_rig_log
from labsid.rig.lab.log import LabLog

MOTOR = RigModel(
    gain=30.0,
    period=0.05,
    damping=2.0,
    delay=1,
    u_rest=4.0,
    y_rest=75.0,
    y_start=75.0,
    noise=0.6,
    correlation=0.5,
    lattice=0.5,
    Ts=0.01,
)
LEVELS, HOLD = (4.0, 2.0, 6.0, 4.0, 2.5, 6.5), 120

OF_THE_MOTOR = """
name = "the motor"
sentence = "A bridge drives a motor, and an encoder measures its speed."
input = { name = "voltage", unit = "V", symbol = "v" }
output = { name = "speed", unit = "rpm", symbol = "n" }
"""
OF_THE_HEATER = """
name = "the heater"
sentence = "A transistor heats a plate."
input = { name = "power", unit = "%" }
output = { name = "temperature", unit = "°C" }
reading = { inputs = "Q1", outputs = "T1", repeated = "first", resample = 4 }
simulated = true
"""
OF_THE_TANKS = """
name = "the tanks of our lab"
sentence = "A pump fills two tanks."
input = { name = "pump voltage", unit = "V" }
output = { name = "sensor voltage", unit = "V" }
"""


def motor_log(seed: int = 0, model: RigModel = MOTOR) -> LabLog:
    """A run of the simulated motor."""
    u = np.repeat(LEVELS, HOLD)
    return make_rig_log(model, u, np.random.SeedSequence(seed), "motor", ("V", "rpm"))


def write_csv(path: Path, log: LabLog) -> Path:
    """Write a log with one output as a text file."""
    columns = np.column_stack([log.t, log.u, log.y_measured])
    np.savetxt(path, columns, fmt="%.6g", delimiter=",", header="t,u,y", comments="")
    return path


def rig_course(root: Path, record: Path, description: str, *names: str) -> Course:
    """A built course with these notebooks, whose lab is about the rig of a record."""
    course = copy_course(root, *names)
    text = f'[rig]\nrecord = "{record.resolve().as_posix()}"\n{description}'
    (root / "course.toml").write_text(text, encoding="utf-8")
    assert list(build_course(course)) == course.select(names)
    return course
