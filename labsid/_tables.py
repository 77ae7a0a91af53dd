"""Tables on a terminal of any width, and in a file."""

import textwrap
from collections.abc import Sequence

from rich.console import Console
from rich.table import Table

WIDEST = 1300  # characters of a table before it is compared with the terminal


def print_table(table: Table, width: int | None = None, broken: bool = False) -> None:
    """Print a table as wide as it needs, or a paragraph for each row where a terminal is too narrow for it.

    Parameters
    ----------
    table : rich.table.Table
        Of texts without markup.
    width : int, optional
        Characters of a table that no terminal shows; by default as many as it needs.
    broken : bool
        Whether cells may be broken into lines between words.
    """
    console = Console(highlight=False, markup=False)
    needed = console.measure(table, options=console.options.update(width=WIDEST))
    if console.is_terminal and (needed.minimum if broken else needed.maximum) > console.width:
        cells = [[str(cell) for cell in column.cells] for column in table.columns]
        _print_text(table.title, console.width)
        print(paragraphs([str(one.header) for one in table.columns], list(zip(*cells, strict=True)), console.width))
        _print_text(table.caption, console.width)
        return
    shown = console if console.is_terminal else Console(highlight=False, markup=False, width=width or needed.maximum)
    with shown.capture() as capture:
        shown.print(table)
    print("\n".join(line.rstrip() for line in capture.get().splitlines()))


def _print_text(text: object, width: int) -> None:
    if text:
        print(textwrap.fill(str(text), width, break_on_hyphens=False))


def paragraphs(titles: Sequence[str], rows: Sequence[Sequence[str]], width: int) -> str:
    """A paragraph of at most `width` characters a line for each row, with the titles of its cells but the first."""
    texts = []
    for name, *cells in rows:
        said = [f"{title} {cell}" for title, cell in zip(titles[1:], cells, strict=True) if cell not in ("", "–")]
        texts.append(
            textwrap.fill(
                "; ".join(said).replace("\n", ", "),
                width,
                initial_indent=f"{name}: ",
                subsequent_indent="  ",
                break_on_hyphens=False,
            )
        )
    return "\n".join(texts)
