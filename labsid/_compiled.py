"""Compilation of loops with numba. Import it inside functions: numba takes most of a second to load."""

from collections.abc import Callable
from typing import Any

from numba import njit


def compiled(*relaxed: str, inline: bool = False) -> Callable[[Callable[..., Any]], Callable[..., Any]]:
    """Compile on first use, and cache the result on disk if numba finds a writable folder.

    `relaxed` are LLVM's fast-math flags; "contract" lets the compiler fuse ``a * b + c``. `inline`
    compiles the function into each of its compiled callers, whose rules then hold.
    """
    options: dict[str, Any] = {
        "error_model": "numpy",
        "fastmath": set(relaxed),
        "inline": "always" if inline else "never",
    }

    def decorate(function: Callable[..., Any]) -> Callable[..., Any]:
        try:
            return njit(cache=True, **options)(function)
        except RuntimeError:  # no writable folder: installation and home are both read-only
            return njit(**options)(function)

    return decorate
