"""Run the checks on one hand-in, and write what the system that hosts it reads.

This file is copied into the packages of ``labsid course package``. It needs Python alone; the checks are those of the
labsid that the package brings, and run in a process of their own, of another user where that is possible.
"""

import argparse
import base64
import contextlib
import json
import os
import pwd
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

HERE = Path(__file__).resolve().parent
SECONDS = 1500
HONESTY = (
    "These marks are what the checks in the notebook find, run from a clean start and on a public second record. The "
    "checks run in the process of the notebook, with public inputs: they are no proof of who wrote the answer, and "
    "code can be written to deceive them. What they can only note, and what is marked by hand, has no marks here. The "
    "marks that count are those that your instructor gives."
)
_UNJUDGED = {
    "noted": "Noted: the answer is complete, and only grading can tell whether it is right. No marks here.",
    "marked by hand": "Marked by hand. No marks here.",
}


class ProblemError(Exception):
    """Why a hand-in has no result, in one line."""


def find_notebook(submission: Path, assignment: str) -> Path:
    """The notebook of the assignment: the one with its name that is least deep, or the only one there is."""
    paths = sorted(
        (path for path in submission.rglob("*.ipynb") if path.is_file() and not path.is_symlink()),
        key=lambda path: (len(path.parts), str(path)),
    )
    inside = [path for path in paths if not any(part.startswith(".") for part in path.relative_to(submission).parts)]
    named = [path for path in inside if path.stem == assignment]
    if named:
        return named[0]
    if len(inside) == 1:
        return inside[0]
    raise ProblemError(f"{assignment}.ipynb was not handed in.")


def run_checks(submission: Path, settings: Mapping[str, Any]) -> dict[str, Any]:
    """What the checks find, in a process that can write nothing here if this one runs as root."""
    assignment, record = settings["assignment"], settings["record"]
    notebook = find_notebook(submission, assignment)
    with tempfile.TemporaryDirectory(prefix="labsid-hand-in-") as folder:
        work = Path(folder)
        shutil.copyfile(notebook, work / "hand-in.ipynb")
        given = HERE / "data" / str(record)
        own = given if record is not None and given.is_file() else notebook.parent / str(record)
        if record is not None and own.is_file() and not own.is_symlink():
            shutil.copyfile(own, work / record)
        environment = {name: os.environ[name] for name in ("PATH", "LANG", "PYTHONPATH") if name in os.environ}
        environment |= {"HOME": folder, "TMPDIR": folder, "MPLBACKEND": "agg"}
        command = [sys.executable, "-m", "labsid.hand_in.checked_result", str(work / "hand-in.ipynb"), assignment]
        user_options: dict[str, Any] = {}
        if os.geteuid() == 0:
            nobody = pwd.getpwnam("nobody")
            for path in (work, *work.iterdir()):
                os.chown(path, nobody.pw_uid, nobody.pw_gid)
            user_options = {"user": nobody.pw_uid, "group": nobody.pw_gid, "extra_groups": []}
        try:
            done = subprocess.run(
                command, capture_output=True, timeout=SECONDS, cwd=folder, env=environment, check=False, **user_options
            )
        except subprocess.TimeoutExpired:
            raise ProblemError(f"the notebook takes longer than {SECONDS} s.") from None
        except OSError as error:  # such as a Python that only its owner may run
            raise ProblemError(f"the checks could not be started as the user nobody: {error}") from None
    try:
        judged: dict[str, Any] = json.loads(done.stdout)
    except ValueError:
        last = (done.stderr.decode(errors="replace").strip().splitlines() or ["no output"])[-1]
        raise ProblemError(f"the checks could not be run: {last[:300]}") from None
    if "error" in judged:
        raise ProblemError(str(judged["error"]))
    return judged


def for_gradescope(judged: Mapping[str, Any]) -> dict[str, Any]:
    """The results that Gradescope reads: a test for each question, with marks where the checks can give them."""
    tests = []
    for question in judged["questions"]:
        test: dict[str, Any] = {"name": f"{question['id']}: {question['heading']}", "visibility": "visible"}
        if question["state"] in _UNJUDGED:
            test["output"] = _UNJUDGED[question["state"]]
        else:
            test |= {"score": float(question["earned"]), "max_score": float(question["marks"])}
            test |= {"status": "passed" if question["state"] == "right" else "failed", "output": _said(question)}
        tests.append(test)
    output = "\n\n".join([HONESTY, *judged["remarks"]])
    return {"output": output, "visibility": "visible", "stdout_visibility": "hidden", "tests": tests}


def for_github(judged: Mapping[str, Any]) -> dict[str, Any]:
    """The results that the reporter of GitHub Classroom reads."""
    tests = []
    most = 0.0
    for question in judged["questions"]:
        if question["state"] in _UNJUDGED:
            continue
        most += float(question["marks"])
        is_right = question["state"] == "right"
        tests.append(
            {
                "name": f"{question['id']}: {question['heading']}",
                "status": "pass" if is_right else "fail",
                "score": float(question["earned"]),
                "message": None if is_right else _said(question),
                "test_code": f'check("{question["id"]}")',
                "filename": "",
                "line_no": 0,
                "execution_time": "0s",
            }
        )
    status = "pass" if all(test["status"] == "pass" for test in tests) else "fail"
    return {"version": 1, "status": status, "max_score": round(most, 6), "tests": tests}


def _said(one: Mapping[str, Any]) -> str:
    return str(one["said"] or f"{one['state'].capitalize()}.")


def refused(why: str, system: str) -> dict[str, Any]:
    """The results of a hand-in that could not be run."""
    if system == "gradescope":
        return {"score": 0, "output": why, "visibility": "visible"}
    return {"version": 1, "status": "error", "max_score": 0, "tests": [
        {"name": "hand-in", "status": "error", "score": 0, "message": why, "test_code": "", "filename": "",
         "line_no": 0, "execution_time": "0s"}
    ]}  # fmt: skip


def main() -> int:
    """Write the results; the exit status is 0 also where the hand-in is wrong, for the system shows what is written."""
    parser = argparse.ArgumentParser(description="Run the checks of labsid on one hand-in.")
    parser.add_argument("--submission", type=Path, required=True, metavar="DIR")
    parser.add_argument("--results", type=Path, required=True, metavar="FILE")
    options = parser.parse_args()
    settings = json.loads((HERE / "settings.json").read_text(encoding="utf-8"))
    system = settings["system"]
    try:
        judged = run_checks(options.submission, settings)
        result = for_gradescope(judged) if system == "gradescope" else for_github(judged)
    except ProblemError as error:
        result = refused(str(error), system)
    options.results.parent.mkdir(parents=True, exist_ok=True)
    with contextlib.suppress(FileNotFoundError):
        options.results.unlink()
    options.results.write_text(json.dumps(result, indent=1), encoding="utf-8")
    if system == "github":
        packed = base64.b64encode(json.dumps(result).encode()).decode()
        if target := os.environ.get("GITHUB_OUTPUT"):
            with open(target, "a", encoding="utf-8") as file:
                file.write(f"result={packed}\n")
        for test in result["tests"]:
            print(": ".join(filter(None, (test["status"], test["name"], test["message"]))))
        print(HONESTY)
    return 0


if __name__ == "__main__":
    sys.exit(main())
