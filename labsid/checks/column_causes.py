"""Causes of Python's errors where arrays of different lengths are put side by side."""

import ast
import re

from labsid.checks.matrix_causes import unfit_blocks
from labsid.checks.stops import Stop

_TO_MINUS = re.compile(r"(\w*)\[([^\[\]:]*):\s*-\s*([A-Za-z_]\w*)\]")
"""A slice to the k-th entry from the end, which takes nothing for k = 0."""
_FROM_DIFFERENCE = re.compile(r"\w+\[([^\[\]:]*-[^\[\]:]*):[^\[\]:]*\]")
_MOST_SLICES = 6
FILLED_WITH_ZEROS = ", or begins with as many zeros as its slice drops samples"
"""A way to equal lengths; no remedy where zeros would change what is asked for."""


def unequal_columns(stop: Stop, _: re.Match[str]) -> str | None:
    """Columns of different lengths side by side."""
    said = "Side by side, all need the same number of rows."
    if "block(" in stop.line:
        return unfit_blocks(stop) or (
            f"{said} In `np.block` a number is a block of 1 by 1, which fits only beside blocks of one row: an empty "
            "corner is `np.zeros((rows, columns))`."
        )
    listed = {ast.unparse(node) for node in stop.expressions() if isinstance(node, ast.List | ast.Name | ast.Tuple)}
    lengths = [length for name in listed & set(stop.things) for length in stop.things[name].lengths]
    pairs = _rows_of_slices(stop)
    if len(set(lengths)) > 1 and (0 in lengths or not pairs):
        said += f" Here these are {', '.join(map(str, lengths))}."
    lines = [stop.line, *(stop.made[name] for name in listed & set(stop.made))]
    to_minus = next((one for line in lines for one in _TO_MINUS.finditer(line)), None)
    if to_minus is not None and ("has size 0" in stop.text or 0 in lengths):
        k, first, x = to_minus[3], to_minus[2].strip(), to_minus[1] or "x"
        right = f"{x}[{first} : len({x}) - {k}]" if first else f"{x}[: len({x}) - {k}]"
        return f"{said} One is empty: with {k} = 0, `{to_minus[0]}` takes nothing. `{right}` is right there, too."
    if 0 in lengths:
        begin = next((one for line in lines for one in _FROM_DIFFERENCE.finditer(line)), None)
        cut, a = ("x[a:b]", "a") if begin is None else (begin[0], begin[1].strip())
        return (
            f"{said} One is empty, as a slice `{cut}` is where `{a}` is below zero: that counts from the end. Print "
            f"`{a}` for each column."
        )
    if ":" not in stop.line:
        return said
    return (
        f"{said}{pairs} `y[a:b]` has b - a of them. Each column is cut so that this difference is the "
        f"same{FILLED_WITH_ZEROS}. Row 0 holds the sample a: lags of 1 and 2 beside `y[2:]` are `[1:-1]` "
        "and `[:-2]`."
    )


def _rows_of_slices(stop: Stop) -> str:
    """How many rows each slice in a list has, where these differ; empty if that is not known."""
    for node in stop.expressions():
        if not isinstance(node, ast.List | ast.Tuple) or not 1 < len(node.elts) <= _MOST_SLICES:
            continue
        rows = {ast.unparse(part): stop.shape(part) for part in node.elts}
        known = {text: shape[0] for text, shape in rows.items() if shape}
        if len(known) == len(rows) and len(set(known.values())) > 1:
            return f" Here {', '.join(f'`{text}` has {count}' for text, count in known.items())}."
    return ""
