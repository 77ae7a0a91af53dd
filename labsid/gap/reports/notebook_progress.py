"""The progress of a diagnosis below the cell of a Jupyter notebook."""

import html
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

from labsid._stages import over_stages

DELAY = 1.0  # s: a shorter diagnosis shows no progress
INTERVAL = 0.2  # s between two displays


def runs_in_notebook() -> bool:
    """Whether this process is the kernel of a notebook."""
    ipython = sys.modules.get("IPython")  # loaded in every kernel; labsid itself does not need it
    return ipython is not None and "IPython.display" in sys.modules and hasattr(ipython.get_ipython(), "kernel")


@contextmanager
def show_in_notebook() -> Iterator[Callable[[str, float], None]]:
    """Show a progress bar while the context is open, and remove it at its end.

    Yields
    ------
    callable
        ``show(step, share)`` with a description of the current step and the completed share of its stage, 0 to 1; the
        bar is one over all stages.
    """
    ipython: Any = sys.modules["IPython.display"]
    handle: Any = None
    shown = time.monotonic() + DELAY - INTERVAL

    def show(step: str, share: float) -> None:
        nonlocal handle, shown
        if time.monotonic() < shown + INTERVAL:
            return
        shown = time.monotonic()
        bar = ipython.HTML(f'<label>{html.escape(step)} <progress max="1" value="{share:.3f}"></progress></label>')
        if handle is None:
            handle = ipython.display(bar, display_id=True)
        else:
            handle.update(bar)

    try:
        yield over_stages(show)
    finally:
        if handle is not None:
            handle.update(ipython.HTML(""))
