"""Tables of the command group ``labsid gap``."""

from collections.abc import Sequence

from rich.console import Console
from rich.table import Table

from labsid.gap.effects.families import DESCRIPTIONS
from labsid.gap.reports.quantities import number
from labsid.gap.reports.sentences import noun_without_article
from labsid.gap.rigs import RigResult

WIDTH = 130  # characters of a table that is written to a file


def print_effects() -> None:
    """Print a row for each effect: name, path, what it is, parameters, and the record that shows it."""
    table = Table("effect", "path", "what it is", "parameters", "record that shows it")
    for name, guide in DESCRIPTIONS.items():
        table.add_row(
            name,
            guide.path,
            noun_without_article(name),
            ", ".join(guide.parameters) or "–",
            guide.excited_by,
        )
    _print(table)


def print_rigs(results: Sequence[RigResult]) -> None:
    """Print a row for each rig: errors on the second record, verdict, named effects and what is left."""
    table = Table(title="Errors (rms, free run) on the second record, in units of y", caption_justify="left")
    for title in ("rig", "linear", "simple", "exported", "ratio", "verdict", "effects (probability)", "left", "s"):
        table.add_column(title, justify="right" if title in ("linear", "simple", "exported", "ratio", "s") else "left")
    for rig in results:
        if rig.message:
            table.add_row(rig.name, "–", "–", "–", "–", rig.verdict, rig.message, "–", f"{rig.seconds:.1f}")
            continue
        ratio = rig.after / rig.before if rig.before > 0.0 else 1.0
        table.add_row(
            rig.name,
            number(rig.before) + (" !" if rig.is_poor_baseline else ""),
            number(rig.simple),
            number(rig.after),
            f"{ratio:.2f}" + (" !" if rig.is_worse else ""),
            rig.verdict,
            ", ".join(f"{name} ({p:.2f})" for name, p in rig.effects) or "–",
            rig.remaining or "–",
            f"{rig.seconds:.1f}",
        )
    table.caption = (
        "linear: the model that the diagnosis starts from; simple: the better of least squares and first-order output "
        "error; exported: the simulation with the effects; left: path of the remaining error. ! misses its limit."
    )
    _print(table)


def _print(table: Table) -> None:
    console = Console()
    (console if console.is_terminal else Console(width=WIDTH)).print(table)
