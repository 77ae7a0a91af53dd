"""Searches for a few effects only, for tests of what does not depend on the others: these take most of the time."""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest

from labsid.gap.batches import batch
from labsid.gap.effects.families import CANDIDATES, LATE
from labsid.gap.limits import planting, smallest_sizes

_TESTS = Path(__file__).resolve().parent
FEW_IN_ONE_PROCESS = f"""
import sys
sys.path[:0] = {[str(_TESTS.parent), str(_TESTS)]!r}
from gap_search import run_here, searched
from labsid.cli.commands import main
from labsid.gap.batches import batch
batch.run_tasks = run_here
with searched("load-step"):
    sys.exit(main(sys.argv[1:]))
"""
"""The command `labsid`, as a program for a process of its own: it starts no others, and searches for one effect."""


@contextmanager
def searched(*names: str) -> Iterator[None]:
    """Limit the search, and the limits of the record, in this process to these effects; also a decorator of a test."""
    few = tuple(group for group in CANDIDATES if group[0].name in names)
    unknown = set(names) - {group[0].name for group in few}
    assert not unknown, f"the search has no {sorted(unknown)}"
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("labsid.gap.search.beam_search.CANDIDATES", few)
        patch.setattr("labsid.gap.search.instants.LATE", tuple(effect for effect in LATE if effect.name in names))
        with limits_of(*names):
            yield


@contextmanager
def limits_of(*names: str) -> Iterator[None]:
    """State the limits of the record in this process for these effects alone; nested, for those that each one names."""
    few = tuple(family for family in planting.FAMILIES if family.name in names)
    with pytest.MonkeyPatch.context() as patch:
        for module in (planting, smallest_sizes):
            patch.setattr(module, "FAMILIES", few)
        yield


def run_here(module: str, tasks: Sequence[dict[str, Any]], jobs: int) -> Iterator[tuple[int, dict[str, Any]]]:
    """In place of `run_tasks` of a batch: diagnose in this process instead of starting others."""
    for number, task in enumerate(tasks):
        yield number, batch._diagnose(task)
