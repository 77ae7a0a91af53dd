"""JSON from others: held against what it would unpack to, before it is read."""

import json
from typing import Any

MAX_PARTS = 1_000_000


def read_json(text: bytes, parts: bytes = b"[{") -> Any:
    """Read JSON that somebody else wrote.

    An empty list takes three characters as text and twenty times that in memory, and while millions of them are made
    no other thread of the grader runs.

    Parameters
    ----------
    text : bytes
    parts : bytes
        The characters that are counted: where there are more than `MAX_PARTS`, it is not read.

    Returns
    -------
    object

    Raises
    ------
    ValueError
        If it is not JSON, or has too many parts.
    """
    if sum(text.count(part) for part in parts) > MAX_PARTS:
        raise ValueError(f"it has more than {MAX_PARTS} parts")
    return json.loads(text)
