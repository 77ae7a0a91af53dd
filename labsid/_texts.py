"""Words of sentences."""

from collections.abc import Sequence


def joined(words: Sequence[str], last: str = "and", comma: bool = False) -> str:
    """``a, b and c``; with `comma`, ``a, b, and c``."""
    if len(words) < 2:
        return "".join(words)
    return f"{', '.join(words[:-1])}{',' if comma else ''} {last} {words[-1]}"
