"""A metric of the grading beside its bars, and the table of all of them."""

from collections.abc import Sequence
from dataclasses import dataclass
from decimal import Decimal

from rich.console import Console
from rich.table import Table

HEADINGS = ("metric", "measured", "required", "target", "status")


@dataclass(frozen=True, slots=True)
class Metric:
    """One line of the table; `status` is ``target``, ``required`` or ``missed``, or says why there is no bar."""

    name: str
    measured: str
    required: str = ""
    target: str = ""
    status: str = ""

    def cells(self) -> tuple[str, ...]:
        return self.name, self.measured, self.required, self.target, self.status


def at_most(name: str, value: float, required: float, target: float, unit: str) -> Metric:
    """The less the better."""
    status = "target" if value <= target else "required" if value <= required else "missed"
    return Metric(name, f"{value:.3g} {unit}", f"{required:g} {unit}", f"{target:g} {unit}", status)


def at_least(name: str, value: float, required: float, target: float, unit: str) -> Metric:
    """The more the better."""
    status = "target" if value >= target else "required" if value >= required else "missed"
    return Metric(name, f"{value:.1f} {unit}", f"{required:g} {unit}", f"{target:g} {unit}", status)


def every(name: str, count: int, of: int) -> Metric:
    """All of them, and nothing less."""
    return Metric(name, f"{count} of {of}", "all", "all", "target" if 0 < of == count else "missed")


def none(name: str, *counts: int | Decimal) -> Metric:
    """None of any kind."""
    zeros = " / ".join("0" for _ in counts)
    return Metric(
        name, " / ".join(f"{float(count):g}" for count in counts), zeros, zeros, "missed" if any(counts) else "target"
    )


def markdown(metrics: Sequence[Metric]) -> str:
    """The table in Markdown."""
    lines = [HEADINGS, ("---",) * len(HEADINGS), *(metric.cells() for metric in metrics)]
    return "".join(f"| {' | '.join(line)} |\n" for line in lines)


def show(metrics: Sequence[Metric]) -> None:
    """Print the table."""
    table = Table(*HEADINGS, title="The bars of the grading")
    colours = {"target": "green", "required": "green", "missed": "red"}
    for metric in metrics:
        table.add_row(*metric.cells(), style=colours.get(metric.status))
    Console().print(table)
