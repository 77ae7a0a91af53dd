"""What the checks find in a notebook that was handed in, as plain data, for systems that run a program on each hand-in.

It is what `labsid submit` says: the notebook runs from a clean start, on its own record and on a public second one. The
checks run in the process of the notebook, on public inputs; nothing here knows a secret or a model solution.
"""

import json
import re
import sys
import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from labsid.checks.notebook import find_assignment
from labsid.checks.summary import FAILED, PASSED, decimal_text
from labsid.checks.time_limit import NOTEBOOK_BYTES
from labsid.hand_in.saved_work import read_saved
from labsid.hand_in.submission_file import run_notebook

_MOST_CHARACTERS = 2_000
_ERROR_TEXT = re.compile(r"(stopped with \w+): .*?(?= \(line \d+\)|$)", re.S)
"""The text of a Python error, which the student's code writes."""


def result_of_checks(notebook: Path, assignment: str, record: Path | None = None) -> dict[str, Any]:
    """Run a notebook and say what the checks found.

    Parameters
    ----------
    notebook : Path
        The notebook that was handed in, under any name.
    assignment : str
    record : Path, optional
        The data file; default the one beside the notebook.

    Returns
    -------
    dict
        With the keys ``title``, ``questions`` and ``remarks``. A question has its ``id``, ``heading``, ``marks``,
        ``earned``, ``state`` and ``said``, the reason where it is not right; marks are text.

    Raises
    ------
    ValueError
        If it is not a notebook of the assignment, or no kernel can be started.
    """
    if notebook.stat().st_size > NOTEBOOK_BYTES:
        raise ValueError(f"{notebook.name} is larger than {NOTEBOOK_BYTES // 2**20} MiB.")
    file = find_assignment(assignment).record_file
    with tempfile.TemporaryDirectory(prefix="labsid-") as scratch:
        own = Path(scratch, f"{assignment}.ipynb")
        own.write_bytes(notebook.read_bytes())
        source = None if file is None else record or notebook.parent / file
        if source is not None and file is not None:
            if not source.is_file():
                raise ValueError(f"{file} is not beside {notebook.name}: hand in your data file, too.")
            own.with_name(file).write_bytes(source.read_bytes())
        saved = read_saved(own)
        if saved.template.assignment != assignment or not saved.template.questions:
            raise ValueError(f"{notebook.name} is not a notebook of {assignment}.")
        run = run_notebook(saved)
    if run is None:
        raise ValueError(f"{assignment} has no checks.")
    questions = []
    has_right_values = False  # whether the reference's values stand in the notebook's variables
    for state in run.states:
        said = run.reasons.get(state.question.id, "") if state.state == FAILED else ""
        if has_right_values:
            said = _ERROR_TEXT.sub(r"\1", said)
        has_right_values |= state.state != PASSED
        questions.append(
            {
                "id": state.question.id,
                "heading": state.question.heading,
                "marks": decimal_text(state.marks),
                "earned": decimal_text(state.earned),
                "state": state.state,
                "said": said[:_MOST_CHARACTERS],
            }
        )
    remarks = [_ERROR_TEXT.sub(r"\1", remark)[:_MOST_CHARACTERS] for remark in run.remarks]
    return {"title": saved.template.title, "questions": questions, "remarks": remarks}


def main(arguments: Sequence[str]) -> int:
    """Print the result as JSON: that of the notebook, or the key ``error`` with one line."""
    notebook, assignment, *record = arguments
    found: Mapping[str, Any]
    try:
        found = result_of_checks(Path(notebook), assignment, Path(record[0]) if record else None)
    except (ValueError, OSError) as error:
        found = {"error": " ".join(str(error).split())}
    print(json.dumps(found))
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
