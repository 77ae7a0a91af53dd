"""A figure of the grading beside its bars, and the table of all of them."""

from collections.abc import Sequence
from dataclasses import dataclass
from decimal import Decimal

from rich.console import Console
from rich.table import Table

HEADINGS = ("figure", "measured", "must", "aim", "reached")


@dataclass(frozen=True, slots=True)
class Figure:
    """One line of the table; `reached` is ``aim``, ``must`` or ``missed``, or says why there is no bar."""

    name: str
    measured: str
    must: str = ""
    aim: str = ""
    reached: str = ""

    def cells(self) -> tuple[str, ...]:
        return self.name, self.measured, self.must, self.aim, self.reached


def at_most(name: str, value: float, must: float, aim: float, unit: str) -> Figure:
    """The less the better."""
    reached = "aim" if value <= aim else "must" if value <= must else "missed"
    return Figure(name, f"{value:.3g} {unit}", f"{must:g} {unit}", f"{aim:g} {unit}", reached)


def at_least(name: str, value: float, must: float, aim: float, unit: str) -> Figure:
    """The more the better."""
    reached = "aim" if value >= aim else "must" if value >= must else "missed"
    return Figure(name, f"{value:.1f} {unit}", f"{must:g} {unit}", f"{aim:g} {unit}", reached)


def every(name: str, count: int, of: int) -> Figure:
    """All of them, and nothing less."""
    return Figure(name, f"{count} of {of}", "all", "all", "aim" if 0 < of == count else "missed")


def none(name: str, *counts: int | Decimal) -> Figure:
    """None of any kind."""
    zeros = " / ".join("0" for _ in counts)
    return Figure(
        name, " / ".join(f"{float(count):g}" for count in counts), zeros, zeros, "missed" if any(counts) else "aim"
    )


def markdown(figures: Sequence[Figure]) -> str:
    """The table in Markdown."""
    lines = [HEADINGS, ("---",) * len(HEADINGS), *(figure.cells() for figure in figures)]
    return "".join(f"| {' | '.join(line)} |\n" for line in lines)


def show(figures: Sequence[Figure]) -> None:
    """Print the table."""
    table = Table(*HEADINGS, title="The bars of the grading")
    colours = {"aim": "green", "must": "green", "missed": "red"}
    for figure in figures:
        table.add_row(*figure.cells(), style=colours.get(figure.reached))
    Console().print(table)
