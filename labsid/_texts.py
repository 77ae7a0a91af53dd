"""Words of sentences, and the width of lines."""

import shutil
import textwrap
from collections.abc import Sequence

LEAST_WIDTH = 60  # characters of a line, also on a narrower terminal
LIKELIER, POSSIBLE = 0.5, 0.1  # probabilities from which an effect is called the cause, and a possible one


def cause_word(p: float) -> str:
    """``cause``, ``possible cause`` or ``improbable cause``, by the probability of an effect."""
    return "cause" if p >= LIKELIER else "possible cause" if p >= POSSIBLE else "improbable cause"


def line_width(most: int) -> int:
    """Characters of a line: those of the terminal, from 60 to `most`, and `most` without one."""
    return max(min(shutil.get_terminal_size((most, 24)).columns, most), LEAST_WIDTH)


def wrapped(text: str, most: int = 90) -> str:
    """A text on lines of `line_width`, without breaks within words."""
    return textwrap.fill(text, line_width(most), break_on_hyphens=False)


def joined(words: Sequence[str], last: str = "and", comma: bool = False) -> str:
    """``a, b and c``; with `comma`, ``a, b, and c``."""
    if len(words) < 2:
        return "".join(words)
    return f"{', '.join(words[:-1])}{',' if comma else ''} {last} {words[-1]}"
