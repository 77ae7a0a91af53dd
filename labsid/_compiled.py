"""Compile hot loops with numba. Import it where it is used: numba takes most of a second to load."""

from collections.abc import Callable
from typing import Any

from numba import njit


def compiled(*relaxed: str) -> Callable[[Callable[..., Any]], Callable[..., Any]]:
    """Compile on first use, and keep the result on disk wherever numba finds a folder that it may write to.

    `relaxed` are the rules of floating point that the compiler may relax; "contract" lets it fuse ``a * b + c``.
    """
    rules = set(relaxed)

    def decorate(function: Callable[..., Any]) -> Callable[..., Any]:
        try:
            return njit(cache=True, error_model="numpy", fastmath=rules)(function)
        except RuntimeError:  # no such folder: an installation and a home that are both read-only
            return njit(error_model="numpy", fastmath=rules)(function)

    return decorate
