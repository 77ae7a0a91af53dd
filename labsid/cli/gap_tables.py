"""Tables of the command group ``labsid gap``."""

from collections.abc import Sequence
from typing import Literal

from rich.table import Table

from labsid._tables import print_table
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
    print_table(table, WIDTH, broken=True)


def print_rigs(results: Sequence[RigResult]) -> None:
    """Print a row for each rig: errors on the second record, verdict, named effects and what is left.

    A terminal too narrow for the table gets a paragraph for each rig instead, so that no name is cut.
    """
    caption = (
        "linear: the model that the diagnosis starts from; simple: the better of least squares and first-order output "
        "error; exported: the simulation with the effects; left: path of the remaining error. ! misses its limit."
    )
    title = "Errors (rms, free run) on the second record, in units of y"
    table = Table(title=title, caption=caption, caption_justify="left")
    for name in ("rig", "linear", "simple", "exported", "ratio", "verdict", "effects (probability)", "left", "s"):
        numeric, long = name in ("linear", "simple", "exported", "ratio", "s"), name.startswith("effects")
        justify: Literal["left", "right"] = "right" if numeric else "left"
        table.add_column(name, justify=justify, no_wrap=not long, max_width=MESSAGE if long else None)
    for rig in results:
        table.add_row(*_cells(rig))
    print_table(table)


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
