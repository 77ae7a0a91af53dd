"""The page on which a release opens: the assignments in order, how a notebook works, how far one is, how to hand in."""

import json
from collections.abc import Mapping, Sequence
from decimal import Decimal

from labsid.checks.cells import Template
from labsid.checks.permitted import RULE
from labsid.checks.summary import decimal_text
from labsid.checks.time_limit import CELL_SECONDS
from labsid.checks.timetable import HOURS

DATA_BESIDE = "The data files are beside the notebooks that use them."

_INTRODUCTION = """\
# {title}: start here

{table}

Work from top to bottom: each assignment uses what the ones before it teach. Open a notebook by its link, or in the file
browser on the left. The hours are an estimate for a student who reads all of the text.

{data}"""

_WORK = """\
## How a notebook works

- Write your answer into the cell that asks for it, run it (Shift+Enter), and run the *check* below it. A check answers
  at once: ✓ if the step is right, ✗ and the reason if it is not. You may run it as often as you like.
- **Stuck?** `check.hint()` in a new cell below helps with the check that failed last, once you have changed your answer
  or after two minutes: first where to look, the next time how it is done. `check.practice("name-of-the-check")` gives a
  small exercise of the same kind. None of it costs marks. `check.skip("name-of-the-check")` goes on from the
  reference's values on your own data; the step that you skip earns nothing, the steps after it do.
- **Compute it.** Grading runs your hand-in a second time, on another record under the same file name, with other
  numbers in it. A number that you type instead of computing it is right on your record only, and earns nothing. It
  counts only where the pen ✎ stands beside the check.
- `check.summary()`, the last cell of each notebook, lists every question with its marks.
- *Run > Restart Kernel and Run All Cells* runs a notebook as grading does: from an empty start, every cell once, from
  top to bottom. It reaches the end even if some steps are not done or wrong. Only a cell that you have added yourself
  stops it, if that cell fails: correct or delete it. `labsid submit` names such cells, and goes on after them.

## What your answers may use

{rule}"""

_TRIES = """\
## Your tries, if you like

`check.tries.keep()` in a notebook begins to keep a list of your tries, in a file beside that notebook: for each changed
answer the question, the minutes of work since then, right or not right, and the name of the mistake. It has no code, no
values and no times of day. It is off until you turn it on, and nothing depends on it: no mark, no deadline and no
suspicion.

- `check.tries()` shows the list, `check.tries.delete()` deletes it and ends the keeping.
- The list stays on your machine. `labsid submit` asks whether to send it with your hand-in; without a yes it does not.
- What is sent shows your instructors where the class found the course hard, as figures of at least five students and
  without names. Their notice says who can open the hand-ins, when they are deleted, and which rights you have."""

_PROGRESS = """\
## How far you are

Run the cell below (Shift+Enter). It reads the notebooks as they were last saved."""

_HAND_IN = """\
## Hand in

Save your notebooks, then run this in a terminal (*File > New > Terminal*), in this folder:

    labsid submit

It runs each notebook that you have changed from a clean start, as grading does, shows what is right and what is not,
and writes `hand-in.zip`, the file to hand in. `labsid submit --assignment NAME` does so for one assignment. Notebooks
that you have not touched are left out."""

_HAND_IN_ON_HUB = """\
## Hand in

Save your notebooks, then run the cell below (Shift+Enter). It runs each notebook that you have changed from a
clean start, as grading does, shows what is right and what is not, and hands it in. You may hand in again: of each
assignment the last time counts. `submit("NAME")` does so for one assignment. In a terminal (*File > New > Terminal*),
in this folder, `labsid submit` does the same, and asks first where something is not right. Notebooks that you have not
touched are left out."""

_FEEDBACK = """\
## Feedback

Once your instructor has returned it, the cell below copies it into the folder of each assignment, as does
`labsid feedback` in a terminal. Open the page with a double click in the file browser."""


def start_text(templates: Sequence[Template], due: Mapping[str, str], data: str, title: str = "") -> str:
    """The start page as Markdown, without the part that only works in Jupyter.

    Parameters
    ----------
    templates : sequence of Template
        The released assignments, in order.
    due : mapping
        When an assignment is due, as text, by its name; may be empty.
    data : str
        A sentence on the data files.
    title : str
        Of the course.

    Returns
    -------
    str
    """
    return "\n\n".join([_introduction(templates, due, data, title), _work(), _TRIES, _HAND_IN]) + "\n"


def start_notebook(
    templates: Sequence[Template], due: Mapping[str, str], data: str, on_hub: bool = False, title: str = ""
) -> bytes:
    """The start page as a notebook, see `start_text`; with cells that hand in and fetch feedback if it is on a hub."""
    texts = {
        "introduction": _introduction(templates, due, data, title),
        "work": _work(),
        "tries": _TRIES,
        "progress": _PROGRESS,
    }
    cells: list[dict[str, object]] = [_markdown(name, text) for name, text in texts.items()]
    cells.append(_code("how-far", "from labsid.hand_in import show_progress\n\nshow_progress()"))
    if on_hub:
        cells.append(_markdown("hand-in", _HAND_IN_ON_HUB))
        cells.append(_code("submit", "from labsid.hand_in import submit\n\nsubmit()"))
        cells.append(_markdown("feedback", _FEEDBACK))
        cells.append(_code("fetch", "from labsid.hand_in import fetch_feedback\n\nfetch_feedback()"))
    else:
        cells.append(_markdown("hand-in", _HAND_IN))
    notebook = {
        "cells": cells,
        "metadata": {
            "kernelspec": {"display_name": "Python 3", "language": "python", "name": "python3"},
            "language_info": {"name": "python"},
        },
        "nbformat": 4,
        "nbformat_minor": 5,
    }
    return (json.dumps(notebook, indent=1, ensure_ascii=False) + "\n").encode()


def _markdown(name: str, text: str) -> dict[str, object]:
    return {"cell_type": "markdown", "id": name, "metadata": {}, "source": text.splitlines(keepends=True)}


def _code(name: str, source: str) -> dict[str, object]:
    lines = source.splitlines(keepends=True)
    return {"cell_type": "code", "execution_count": None, "id": name, "metadata": {}, "outputs": [], "source": lines}


def _work() -> str:
    return _WORK.format(rule=RULE.format(seconds=CELL_SECONDS))


def _introduction(templates: Sequence[Template], due: Mapping[str, str], data: str, title: str) -> str:
    return _INTRODUCTION.format(title=title or "System identification", table=_table(templates, due), data=data)


def _table(templates: Sequence[Template], due: Mapping[str, str]) -> str:
    has_due = any(template.assignment in due for template in templates)
    head = ["", "assignment", "hours", "marks", *(["due"] if has_due else [])]
    rows = [head, [":--", ":--", "--:", "--:", *([":--"] if has_due else [])]]
    for number, template in enumerate(templates, 1):
        name = template.assignment
        marks = sum((cell.points or Decimal(0) for cell in template.questions), Decimal(0))
        link = f"[{template.title}]({name}/{name}.ipynb)"
        hours = f"{HOURS[name]:g}" if name in HOURS else ""
        rows.append([str(number), link, hours, decimal_text(marks), *([due.get(name, "")] if has_due else [])])
    return "\n".join(f"| {' | '.join(row)} |" for row in rows)
