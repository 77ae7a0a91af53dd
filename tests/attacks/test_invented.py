"""Invented data: a wrong value of one's own choosing, and numbers that follow from it. They earn nothing."""

import os
from collections.abc import Iterator, Mapping
from pathlib import Path

import numpy as np
import pytest
from course_work import GradeCode, built_course, read_solved, shared_folder, shared_inputs
from representatives import mostly_exhaustive

from autograder.course.layout import Course
from autograder.judge.outcome import QuestionResult
from autograder.sandbox.isolation import Limits, ProcessLauncher, open_launcher
from labsid.checks.cell_names import assigned_names
from labsid.checks.notebook import assignment_names, load_assignment
from labsid.checks.values import Value

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(not hasattr(os, "fork"), reason="this system cannot fork"),
]

LIMITS = Limits(cell_seconds=20, call_seconds=10)
SPOIL = "{0} = 1.5 * {0} + 0.1 * np.ptp({0}) * np.sin(np.arange(np.size({0})) ** 2.0).reshape(np.shape({0}))"
TRIVIAL = {
    "lab-2b-theta": "theta_hat = np.array([0.0, 0.0, 0.5, 0.0])",
    "lab-2b-parameters": "a1, a2, b1, b2 = 0.0, 0.0, 0.5, 0.0",
    "lab-2c-transfer-function": "G = ct.tf([0.5], [1, 0], Ts)",
    "lab-2c-state-space": "G_ss = ct.ss(ct.tf([0.5, 0], [1, 0, 0], Ts))",
    "lab-3a-second-half": "y_sim_half = np.append(0, 0.5 * u[len(u) // 2 : -1])",
    "lab-3a-all": "y_sim = np.append(0, 0.5 * u[:-1])",
    "lab-3a-mse": "mse_half, mse_all = 0.0, 0.0",
}
HAND_INS = {
    "an output that any fit finds": (
        "lab-identification",
        {
            "lab-1c-offsets": "y_offset, u_offset = 2.0, u_act[0]\nu = u_act - u_offset\ny = np.zeros(len(u))\n"
            "y[1:] = 0.5 * u[:-1]",
            **TRIVIAL,
        },
    ),
    "an invented record": (
        "lab-identification",
        {
            "lab-1a-extract": "t = np.arange(900) * 0.5\nu_act = 2 + np.repeat([0.0, 1.0, -1.0], 300)\n"
            "y_act = np.append(0, 0.5 * (u_act - 2)[:-1]) + 1\ny_actm = y_act",
            "lab-1a-sampling-time": "Ts = 0.5",
            "lab-1c-offsets": "y_offset, u_offset = 1.0, 2.0\ny, u = y_act - 1, u_act - 2",
            **TRIVIAL,
        },
    ),
    "a simulation that is the output": (
        "lab-identification",
        {"lab-3a-all": "y_sim = y", "lab-3a-second-half": "y_sim_half = y[len(y) // 2 :]",
         "lab-3a-mse": "mse_half, mse_all = 0.0, 0.0"},
    ),
    "three made-up rows": (
        "postlab-model-order",
        {
            "postlab-1-phi": "Phi_1, Y_1 = np.eye(3)[:, :2], np.array([0.5, 0.25, 0.0])",
            "postlab-1-theta": "theta_1 = np.array([0.5, 0.25])",
            "postlab-1-transfer-function": "G_1 = ct.tf([0.25], [1, -0.5], Ts)",
        },
    ),
    "an output made from the answer": (
        "sim-to-real-gap",
        {
            "gap-1-rest": "q = np.array([1.5, -0.55, 0.02, 0.02])\nu_offset, y_offset, noise_sd = u_act[0], 2.0, 0.01\n"
            "u = u_act - u_offset\ny = free_run(q, u)",
            "gap-2-linear": "theta_arx = theta_hat = np.array([1.5, -0.55, 0.02, 0.02])\n"
            "y_lin = free_run(theta_hat, u)\ne = y - y_lin",
            "gap-3-size": "gap_before = 0.0",
        },
    ),
}  # fmt: skip


@pytest.fixture(scope="module")
def course(tmp_path_factory: pytest.TempPathFactory) -> Course:
    return built_course(tmp_path_factory.mktemp("course"), shared_folder(tmp_path_factory))


@pytest.fixture(scope="module")
def launcher() -> Iterator[ProcessLauncher]:
    with open_launcher("none", LIMITS) as opened:
        yield opened


def earned(results: Mapping[str, QuestionResult], questions: Mapping[str, str]) -> dict[str, str]:
    """The questions of these that have any mark, and the reasons."""
    return {name: results[name].reason for name in questions if results[name].score}


@pytest.mark.parametrize("name", HAND_INS)
def test_numbers_for_data_of_ones_own_earn_nothing(name: str, course: Course, launcher: ProcessLauncher) -> None:
    assignment, answers = HAND_INS[name]
    results = GradeCode(course, launcher)(assignment, {f"{key}-answer": code for key, code in answers.items()})
    assert earned(results, answers) == {}
    assert sum(results[key].consistent for key in answers) >= 1


@pytest.mark.parametrize("name", mostly_exhaustive(assignment_names(), ["model-structures", "postlab-model-order"]))
def test_what_follows_from_an_invented_answer_earns_nothing_as_a_number(
    name: str, course: Course, launcher: ProcessLauncher, tmp_path: Path
) -> None:
    """The first number that others use is multiplied; the numbers that follow are typed into the others' cells."""
    used = {key for question in load_assignment(name).questions for key in question.uses}
    right = values_after(course, launcher, name, tmp_path, {})
    numbers = [one.id for one in load_assignment(name).questions if one.id in used and f"{one.id}-answer" in right]
    first = next(iter(numbers), None)
    spoil = "" if first is None else "\n".join(map(SPOIL.format, right[f"{first}-answer"]))
    wrong = values_after(course, launcher, name, tmp_path, {} if first is None else {f"{first}-answer": spoil})
    typed = {
        cell: "\n".join(f"{key} = {literal(value)}" for key, value in values.items())
        for cell, values in wrong.items()
        if any(literal(value) != literal(right[cell].get(key)) for key, value in values.items())
    }
    results = GradeCode(course, launcher)(name, typed)
    assert bool(typed) == (first is not None), "nothing follows from the invented answer"
    assert earned(results, {cell.removesuffix("-answer"): "" for cell in typed}) == {}


def values_after(
    course: Course, launcher: ProcessLauncher, name: str, folder: Path, more: Mapping[str, str]
) -> dict[str, dict[str, Value]]:
    """The numbers and arrays that each answer of the model solution assigns; `more` is run after some of them."""
    template, solution = read_solved(course, name)
    for file, path in shared_inputs(course, name).files.items():
        (folder / file).write_bytes(path.read_bytes())
    student = launcher.start(folder)
    found: dict[str, dict[str, Value]] = {}
    for cell in template.cells:
        if cell.kind in ("given", "answer") and cell.code:
            student.run(solution[cell.id] + "\n" + more.get(cell.id, ""))
        if cell.kind == "answer" and cell.code:
            replies = {key: student.value(key).value for key in sorted(assigned_names(solution[cell.id]))}
            found[cell.id] = {key: value for key, value in replies.items() if is_number(value)}
    student.close()
    return {cell: values for cell, values in found.items() if values}


def is_number(value: Value) -> bool:
    return isinstance(value, (int, float)) or (isinstance(value, np.ndarray) and value.dtype.kind in "biuf")


def literal(value: Value) -> str:
    """A number or an array as one types it."""
    return f"np.array({value.tolist()})" if isinstance(value, np.ndarray) else repr(value)
