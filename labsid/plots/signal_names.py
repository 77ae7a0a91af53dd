"""Names and units of signals as matplotlib shows them: any text, on lines of limited length."""

from textwrap import wrap
from typing import Any

LINES = 2  # of a name
UNIT = 10  # characters of a unit
LONGEST = 24  # characters of a label on one line


def units_of(report: dict[str, Any]) -> dict[str, str]:
    """Units of all signals of a report by name; empty where unknown."""
    return {one["name"]: one["unit"] or "" for kind in ("inputs", "outputs") for one in report["signals"][kind]}


def one_line(name: str, unit: str = "") -> str:
    """``name (unit)``, shortened."""
    return as_text_lines([" ".join([*fitted(name, LONGEST, 1), *_bracketed(unit)])])


def stacked(name: str, unit: str, width: int) -> str:
    """The name on at most two lines of `width` characters, and its unit below."""
    return as_text_lines([*fitted(name, width, LINES), *_bracketed(unit)])


def as_text_lines(lines: list[str]) -> str:
    """Lines that matplotlib shows as they are: without control characters and without mathematics."""
    return "\n".join("".join(c if c.isprintable() else " " for c in line) for line in lines).replace("$", r"\$")


def fitted(text: str, width: int, most: int) -> list[str]:
    """At most so many lines of a text. The last one holds its end, by which long names differ, after an ellipsis."""
    lines = wrap(text, width) or [""]
    if len(lines) <= most:
        return lines
    return [*lines[: most - 1], f"…{text[1 - width :].lstrip()}"]


def _bracketed(unit: str) -> list[str]:
    return [f"({fitted(unit, UNIT, 1)[0]})"] if unit else []
