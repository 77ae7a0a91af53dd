"""How far a student is: a line for each assignment, from the notebooks as they are saved."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from html import escape
from pathlib import Path

from labsid.checks.summary import BY_HAND, FAILED, NOT_DONE, NOTED, PASSED, SKIPPED, QuestionState, total_text
from labsid.hand_in.saved_work import notebook_paths, read_saved


@dataclass(frozen=True, slots=True)
class AssignmentProgress:
    """How far one assignment is.

    Attributes
    ----------
    name, title : str
    said : str
        In words.
    """

    name: str
    title: str
    said: str


@dataclass(frozen=True, slots=True, repr=False)
class ProgressTable:
    """The progress of all assignments; Jupyter shows it as a table.

    Attributes
    ----------
    rows : tuple of AssignmentProgress
        In the order of the course.
    """

    rows: tuple[AssignmentProgress, ...]

    def __repr__(self) -> str:
        return "\n".join(f"{row.name}: {row.said}" for row in self.rows)

    def _repr_html_(self) -> str:
        rows = "".join(
            f'<tr><td style="text-align:left">{escape(row.title)}</td>'
            f'<td style="text-align:left">{escape(row.said)}</td></tr>'
            for row in self.rows
        )
        return f"<table><tbody>{rows}</tbody></table>"


def show_progress(folder: str | Path = ".") -> ProgressTable:
    """How far each assignment of a work folder is, by the checks in its saved notebook.

    Parameters
    ----------
    folder : str or Path
        The work folder.

    Returns
    -------
    ProgressTable
    """
    rows = []
    for path in notebook_paths(Path(folder)):
        if path.stem != path.parent.name:
            continue
        try:
            saved = read_saved(path)
        except ValueError as error:
            rows.append(AssignmentProgress(path.stem, path.stem, str(error)))
            continue
        rows.append(AssignmentProgress(path.stem, saved.template.title, _words(saved.is_untouched, saved.states())))
    return ProgressTable(tuple(rows))


def _words(is_untouched: bool, states: Sequence[QuestionState]) -> str:
    if is_untouched:
        return "not begun"
    counted = Counter(one.state for one in states)
    order = (PASSED, NOTED, FAILED, SKIPPED, NOT_DONE, BY_HAND)
    parts = [f"{counted[state]} {state}" for state in order if counted[state]]
    return f"{total_text(states)} ({', '.join(parts)})"
