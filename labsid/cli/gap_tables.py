"""Tables of the command group ``labsid gap``."""

from collections.abc import Sequence
from textwrap import fill

from rich.console import Console
from rich.table import Table

from labsid.cli.console import WIDEST, is_too_wide, paragraphs
from labsid.gap.effects.families import DESCRIPTIONS
from labsid.gap.reports.quantities import number
from labsid.gap.reports.sentences import noun_without_article
from labsid.gap.rigs import RigResult

MESSAGE = 40  # characters of a line of a message
WIDTH = 130  # characters of a table that is written to a file


def print_effects() -> None:
    """Print a row for each effect: name, path, what it is, parameters, and the record that shows it."""
    titles = ("effect", "path", "what it is", "parameters", "record that shows it")
    rows = [
        (name, guide.path, noun_without_article(name), ", ".join(guide.parameters) or "–", guide.excited_by)
        for name, guide in DESCRIPTIONS.items()
    ]
    table = Table(*titles)
    for row in rows:
        table.add_row(*row)
    console = Console()
    if is_too_wide(table, console, broken=True):
        print(paragraphs(titles, rows, console.width))
        return
    (console if console.is_terminal else Console(width=WIDTH)).print(table)


def print_rigs(results: Sequence[RigResult]) -> None:
    """Print a row for each rig: errors on the second record, verdict, named effects and what is left.

    A terminal too narrow for the table gets a paragraph for each rig instead, so that no name is cut.
    """
    table = Table(title="Errors (rms, free run) on the second record, in units of y", caption_justify="left")
    titles = ("rig", "linear", "simple", "exported", "ratio", "verdict", "effects (probability)", "left", "s")
    for title in titles:
        numeric = title in ("linear", "simple", "exported", "ratio", "s")
        table.add_column(title, justify="right" if numeric else "left", no_wrap=True)
    rows = [_cells(rig) for rig in results]
    for row in rows:
        table.add_row(*row[:6], "\n".join(fill(line, MESSAGE) for line in row[6].split("\n")), *row[7:])
    caption = (
        "linear: the model that the diagnosis starts from; simple: the better of least squares and first-order output "
        "error; exported: the simulation with the effects; left: path of the remaining error. ! misses its limit."
    )
    console = Console()
    if is_too_wide(table, console):
        print(paragraphs(titles, rows, console.width))
        print(fill(caption, console.width))
        return
    needed = console.measure(table, options=console.options.update(width=WIDEST)).maximum
    table.caption = caption
    (console if console.is_terminal else Console(width=max(WIDTH, needed))).print(table)


def _cells(rig: RigResult) -> list[str]:
    """The row of a rig, each effect on a line of its own."""
    if rig.message:
        return [rig.name, "–", "–", "–", "–", rig.verdict, rig.message, "–", f"{rig.seconds:.1f}"]
    ratio = rig.after / rig.before if rig.before > 0.0 else 1.0
    return [
        rig.name,
        number(rig.before) + (" !" if rig.is_poor_baseline else ""),
        number(rig.simple),
        number(rig.after),
        f"{ratio:.2f}" + (" !" if rig.is_worse else ""),
        rig.verdict,
        "\n".join(f"{name} ({p:.2f})" for name, p in rig.effects) or "–",
        rig.remaining or "–",
        f"{rig.seconds:.1f}",
    ]
