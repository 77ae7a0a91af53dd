"""Sample submissions for the demonstration, from a correct one to one that crashes."""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import nbformat

from autograder.course.layout import Course

LAB = "lab-identification"

_MISTAKES = {
    "lab-1c-offsets-answer": """
y_offset = np.mean(y_act)
u_offset = u_act[0]
y = y_act - y_offset
u = u_act - u_offset
""",
    "lab-2b-parameters-answer": """
a1, a2, b1, b2 = theta_hat
""",
    "lab-3a-second-half-answer": """
y_sim_half = scipy.signal.lfilter([0, b1, b2], [1, a1, a2], u)[len(u) // 2 :]
""",
    "lab-3b-start": "The simulation is wrong at first.",
}

_OTHER_METHODS = {
    "lab-1c-loop-answer": """
def first_period(u):
    changed = np.flatnonzero(np.asarray(u).ravel() != np.asarray(u).ravel()[0])
    return int(changed[0])

n_first = first_period(u_act)
""",
    "lab-2a-phi-answer": """
half = len(y) // 2
rows, targets = [], []
for k in range(10, half):
    rows.append([y[k - 1], y[k - 2], u[k - 1], u[k - 2]])
    targets.append([y[k]])
Phi = np.array(rows)
Y = np.array(targets)
""",
    "lab-2b-theta-answer": """
theta_hat, *_ = np.linalg.lstsq(Phi, Y, rcond=None)
theta_hat = np.asarray(theta_hat).reshape(-1)
""",
    "lab-2c-transfer-function-answer": """
G = scipy.signal.dlti([b1, b2], [1, a1, a2], dt=Ts)
""",
    "lab-3a-second-half-answer": """
y_sim_half = scipy.signal.lfilter([0, b1, b2], [1, a1, a2], u[len(u) // 2 :])
""",
    "lab-3a-all-answer": """
y_sim = np.zeros(len(u))
for k in range(len(u)):
    for lag, a, b in ((1, a1, b1), (2, a2, b2)):
        if k >= lag:
            y_sim[k] += -a * y_sim[k - lag] + b * u[k - lag]
""",
}

_CRASHING = {
    "lab-2a-phi-answer": """
import os
os._exit(1)
""",
    "lab-3a-all-answer": """
y_sim = simulate_the_model(u)
""",
}

_INVENTED = {
    "lab-1c-offsets-answer": """
y_offset = np.mean(y_act[:n_first])
u_offset = u_act[0]
u = u_act - u_offset
y = np.zeros(len(u))
y[1:] = 0.5 * u[:-1]
""",
    "lab-2b-theta-answer": """
theta_hat = np.array([0.0, 0.0, 0.5, 0.0])
""",
    "lab-2b-parameters-answer": """
a1, a2, b1, b2 = 0.0, 0.0, 0.5, 0.0
""",
    "lab-3a-second-half-answer": """
y_sim_half = y[len(y) // 2 :]
""",
    "lab-3a-all-answer": """
y_sim = y
""",
    "lab-3a-mse-answer": """
mse_half, mse_all = 0.0, 0.0
""",
}


def _typed_in(course: Course) -> dict[str, str]:
    """Answers with the numbers that ``labsid identify`` prints of the record."""
    from labsid.lab.identification import identify
    from labsid.records.record import load_record

    identified = identify(load_record(course.record), order=2, start=2)
    theta, model, mse = identified.fit.theta.tolist(), identified.model, identified.verification
    return {
        "lab-1c-offsets-answer": f"""
y_offset, u_offset = {model.y_offset!r}, {model.u_offset!r}
y, u = y_act - y_offset, u_act - u_offset
""",
        "lab-2b-theta-answer": f"theta_hat = np.array({theta!r})",
        "lab-2b-parameters-answer": f"a1, a2, b1, b2 = {-theta[0]!r}, {-theta[1]!r}, {theta[2]!r}, {theta[3]!r}",
        "lab-2c-transfer-function-answer": f"G = ct.tf({theta[2:]!r}, [1, {-theta[0]!r}, {-theta[1]!r}], 0.75)",
        "lab-3a-mse-answer": f"mse_half, mse_all = {mse.mse_second_half!r}, {mse.mse_all!r}",
    }


def write_samples(course: Course, folder: Path) -> dict[str, str]:
    """Write eight students' submissions of the lab, and all assignments of the first student.

    Parameters
    ----------
    course : Course
        Built.
    folder : Path
        Receives ``<student>/<assignment>/<assignment>.ipynb``.

    Returns
    -------
    dict
        Description of each student's submission, by name.
    """
    for name in course.assignments():
        _write(folder / "ada" / name / f"{name}.ipynb", _notebook(course, name, {}))
    _write(folder / "ben" / LAB / f"{LAB}.ipynb", _notebook(course, LAB, _MISTAKES))
    _write(folder / "cleo" / LAB / f"{LAB}.ipynb", _notebook(course, LAB, _OTHER_METHODS))
    unanswered = (course.release / LAB / f"{LAB}.ipynb").read_text(encoding="utf-8")
    _write(folder / "dan" / LAB / f"{LAB}.ipynb", unanswered)
    _write(folder / "eve" / LAB / f"{LAB}.ipynb", _notebook(course, LAB, _CRASHING))
    _write(folder / "finn" / LAB / f"{LAB}.ipynb", unanswered[: len(unanswered) // 2])
    _write(folder / "gina" / LAB / f"{LAB}.ipynb", _notebook(course, LAB, _typed_in(course)))
    _write(folder / "hugo" / LAB / f"{LAB}.ipynb", _notebook(course, LAB, _INVENTED))
    return {
        "ada": "all answers right",
        "ben": "three common mistakes",
        "cleo": "right, by other methods",
        "dan": "the release, not answered",
        "eve": "code that ends its process, and an undefined name",
        "finn": "a truncated file",
        "gina": "the numbers that labsid identify prints, typed in",
        "hugo": "an invented output, and the answers to it typed in",
    }


def _notebook(course: Course, name: str, replaced: Mapping[str, str]) -> str:
    """The source notebook with its solutions, some of them replaced."""
    source: Any = nbformat.read(course.source / name / f"{name}.ipynb", as_version=4)
    for cell in source.cells:
        if cell.id in replaced:
            cell.source = replaced[cell.id].strip()
    return json.dumps(source, indent=1) + "\n"


def _write(path: Path, text: str) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text, encoding="utf-8")
