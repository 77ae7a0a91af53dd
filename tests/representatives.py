"""Cases of a test of which some are tested everywhere, and all by `make test-all`."""

from collections.abc import Callable, Collection, Iterable
from typing import Any

import pytest
from _pytest.mark import ParameterSet


def mostly_exhaustive(
    cases: Iterable[Any], kept: Collection[str], name: Callable[[Any], str] = str
) -> list[ParameterSet]:
    """Parameters of a test, one for each case; those that are not `kept` are exhaustive.

    Parameters
    ----------
    cases : iterable
    kept : collection of str
        Names of the cases that are tested everywhere: one of each kind.
    name : callable
        Name of a case, which is the id of its test, too.

    Raises
    ------
    ValueError
        If a name is that of no case.
    """
    by_name = {name(case): case for case in cases}
    unknown = set(kept) - set(by_name)
    if unknown:
        raise ValueError(f"no case is named {', '.join(sorted(unknown))}; there are {', '.join(by_name)}.")
    return [
        pytest.param(case, id=one, marks=[] if one in kept else [pytest.mark.exhaustive])
        for one, case in by_name.items()
    ]
