"""Reading of JSON from untrusted sources, with a limit on its size in memory."""

import json
from typing import Any

MAX_PARTS = 1_000_000


def read_json(text: bytes, parts: bytes = b"[{") -> Any:
    """Read JSON from an untrusted source.

    An empty list takes three bytes as text but about 60 in memory, and parsing millions of them blocks all threads.

    Parameters
    ----------
    text : bytes
    parts : bytes
        Characters to count; text with more than `MAX_PARTS` of them is rejected.

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
