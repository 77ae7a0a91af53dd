"""Reading of JSON from untrusted sources, with a limit on its size in memory."""

import json
from typing import Any

MAX_PARTS = 1_000_000
MAX_VALUES = 5_000_000


def read_json(text: bytes, parts: bytes = b"[{") -> Any:
    """Read JSON from an untrusted source.

    An empty list takes three bytes as text but about 60 in memory, and parsing millions of them blocks all threads.

    Parameters
    ----------
    text : bytes
    parts : bytes
        Characters to count; text with more than `MAX_PARTS` of them, or with more than `MAX_VALUES` commas, is
        rejected.

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
    if text.count(b",") > MAX_VALUES:
        raise ValueError(f"it has more than {MAX_VALUES} values")
    return json.loads(text)


def reading_work(text: bytes) -> int:
    """The work of `read_json`: the number of bytes that are unpacked with deflate in the same time, measured."""
    return 2 * len(text) + 450 * (text.count(b"[") + text.count(b"{")) + 40 * text.count(b",")
