"""Packages that run the checks of an assignment on Gradescope and in GitHub Classroom.

A package has what students have: the wheel of labsid of their release, and the data that all share. It has no model
solution, no secret and nothing of the autograder, so that it gives what `labsid submit` says on a student's machine.
"""

import json
from pathlib import Path

from autograder.course.layout import Course
from autograder.course.own_secret import shared_file
from autograder.course.release import shared_files
from labsid._files import write_file, zip_bytes
from labsid.checks.notebook import find_assignment

SYSTEMS = ("gradescope", "github")
SCRIPT = "grade.py"

_SETUP = """\
#!/usr/bin/env bash
set -euo pipefail
cd /autograder/source
if ! python3 -c 'import sys; sys.exit(not (3, 11) <= sys.version_info[:2] < (3, 14))'; then
    echo "labsid needs Python 3.11 to 3.13: choose a base image with it, such as Ubuntu 24.04." >&2
    exit 1
fi
apt-get update && apt-get install -y python3-venv
python3 -m venv /autograder/venv
/autograder/venv/bin/pip install --no-cache-dir "./{wheel}[notebooks]"
"""

_RUN = """\
#!/usr/bin/env bash
exec /autograder/venv/bin/python /autograder/source/grade.py \\
    --submission /autograder/submission --results /autograder/results/results.json
"""

_WORKFLOW = """\
name: Autograding Tests
on: [push, workflow_dispatch, repository_dispatch]
permissions:
  checks: write
  actions: read
  contents: read
jobs:
  run-autograding-tests:
    runs-on: ubuntu-latest
    if: github.actor != 'github-classroom[bot]'
    steps:
      - uses: actions/checkout@v4
      - uses: actions/setup-python@v5
        with:
          python-version: "3.12"
      - run: pip install "./.github/labsid/{wheel}[notebooks]"
      - id: labsid
        run: python .github/labsid/grade.py --submission . --results "$RUNNER_TEMP/results.json"
      - uses: classroom-resources/autograding-grading-reporter@v1
        env:
          LABSID_RESULTS: ${{{{ steps.labsid.outputs.result }}}}
        with:
          runners: labsid
"""


def write_package(course: Course, out: Path, system: str, assignment: str, is_individual: bool = False) -> list[str]:
    """Write the package of an assignment; the same course gives the same bytes.

    Parameters
    ----------
    course : Course
        Built.
    out : Path
        The zip file.
    system : {"gradescope", "github"}
    assignment : str
    is_individual : bool
        Whether students have their own data, which then are not in the package but in each hand-in.

    Returns
    -------
    list of str
        The names of its files.

    Raises
    ------
    ValueError
        If there is no such assignment or system, it has no checks, or the course has not been built.
    """
    if system not in SYSTEMS:
        raise ValueError(f"got {system!r}, expected {' or '.join(SYSTEMS)}.")
    (name,) = course.select([assignment])
    known = find_assignment(name)
    if not known.questions:
        raise ValueError(f"{name} has no checks, which the package would run; grade it with labsid course grade.")
    shared = shared_files(course, [name])
    wheel = next(path for path in shared if path.endswith(".whl"))
    record = known.record_file
    own = {wheel: shared[wheel], SCRIPT: Path(__file__).with_name("package_script.py").read_bytes()}
    own["settings.json"] = json.dumps({"assignment": name, "record": record, "system": system}).encode()
    if record is not None and not is_individual:
        own[f"data/{record}"] = shared_file(course, record).read_bytes()
    if system == "gradescope":
        files = {**own, "setup.sh": _SETUP.format(wheel=wheel).encode(), "run_autograder": _RUN.encode()}
    else:
        files = {f".github/labsid/{path}": content for path, content in own.items()}
        files[".github/workflows/classroom.yml"] = _WORKFLOW.format(wheel=wheel).encode()
    write_file(out, zip_bytes(files, ("setup.sh", "run_autograder")))
    return sorted(files)
