"""Progress of the commands that take more than two seconds."""

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from labsid._stages import over_stages


@contextmanager
def shown_progress(lines: bool = False, stages: bool = False) -> Iterator[Callable[[str, float], None] | None]:
    """A progress bar on a terminal; otherwise lines on stderr or nothing.

    Parameters
    ----------
    lines : bool
        Whether a line is printed for each 5 % of progress where stderr is no terminal.
    stages : bool
        Whether the share is that of one of several stages; the bar is then one over all of them. The time beside it is
        that which has passed.

    Yields
    ------
    callable or None
        To be called with what is done now and the share of all that is done; None if nothing is shown.
    """
    if not sys.stderr.isatty():
        yield _line_printer() if lines else None
        return
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

    columns = TextColumn("{task.description}"), BarColumn(), TimeElapsedColumn()
    with Progress(*columns, console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task("baseline", total=1.0)

        def show(what: str, share: float) -> None:
            bar.update(task, description=what, completed=share)

        yield over_stages(show) if stages else show


def _line_printer() -> Callable[[str, float], None]:
    """Print a line on stderr for each 5 % of progress of each step."""
    printed = -1

    def show(what: str, share: float) -> None:
        nonlocal printed
        if int(20 * share) != printed:
            printed = int(20 * share)
            print(what, file=sys.stderr, flush=True)

    return show
