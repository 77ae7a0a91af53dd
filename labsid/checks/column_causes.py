"""Causes of Python's errors where arrays of different lengths are put side by side."""

import ast
import re

from labsid.checks.empty_slices import empty_slice
from labsid.checks.line_values import parsed_line
from labsid.checks.matrix_causes import unfit_blocks
from labsid.checks.stops import Stop

_FROM_DIFFERENCE = re.compile(r"\w+\[([^\[\]:]*-[^\[\]:]*):[^\[\]:]*\]")
_MOST_SLICES = 6


def unequal_columns(stop: Stop, _: re.Match[str]) -> str | None:
    """Columns of different lengths side by side."""
    below = re.search(r"along dimension 1, .*index (\d+) has size (\d+) and .*index (\d+) has size (\d+)", stop.text)
    if below is not None and "block(" not in stop.line:
        flat = "(A flat array counts as one row. Flat arrays are joined by `np.concatenate`.)" if _stacks(stop) else ""
        return (
            "One below the other, all need the same number of columns: part "
            f"{below[1]} (counted from 0) has {below[2]}, part {below[3]} has {below[4]}. {flat}"
        ).rstrip()
    said = "Side by side, all need the same number of rows."
    row = _row_for_a_column(stop)
    if row:
        return f"{said} {row}"
    alone = _number_in(stop)
    if alone:
        return f"{said} `{alone}` is one number, a column of one row."
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
    empty = empty_slice(stop, lines) if "has size 0" in stop.text or 0 in lengths else ""
    if empty:
        return f"{said} One is empty. {empty}"
    if 0 in lengths or "has size 0" in stop.text:
        begins = {one[1].strip(): one for line in lines for one in _FROM_DIFFERENCE.finditer(line)}
        begin = next(iter(begins.values())) if len(begins) == 1 else None
        cut, a = ("x[a:b]", "a") if begin is None else (begin[0], begin[1].strip())
        return (
            f"{said} One is empty, as a slice `{cut}` is where `{a}` is below zero: that counts from the end. Print "
            f"`{a}` for each column."
        )
    counts = [count for count in lengths if count]
    if ":" not in stop.line or (counts and 2 * min(counts) < max(counts)):
        return said + pairs
    return (
        f"{said}{pairs} `y[a:b]` has b - a of them. Each column is cut so that this difference is the "
        f"same. Row 0 holds the sample a: lags of 1 and 2 beside `y[2:]` are `[1:-1]` "
        "and `[:-2]`."
    )


def _row_for_a_column(stop: Stop) -> str:
    """A line that gives a name one row of a table, where other columns are as long as the columns of it; or empty.

    Only where no column is longer than a column of the table, and one is longer than half of it and than a row.
    """
    lengths = [length for thing in stop.things.values() for length in thing.lengths]
    for made in stop.made.values():
        tree = parsed_line(made)
        body = tree.body if isinstance(tree, ast.Module) else []
        node = body[0].value if len(body) == 1 and isinstance(body[0], ast.Assign) else None
        if not isinstance(node, ast.Subscript) or isinstance(node.slice, ast.Slice | ast.Tuple):
            continue
        table, name, k = stop.shape(node.value), ast.unparse(node.value), ast.unparse(node.slice)
        if table is None or len(table) != 2 or stop.shape(node) != table[1:] or not lengths:
            continue
        if table[0] >= max(lengths) > max(table[0] // 2, table[1]) and min(lengths) <= table[1]:
            return (
                f"In `{made}`, `{ast.unparse(node)}` is a row of `{name}`, with {table[1]} entries; a column, "
                f"`{name}[:, {k}]`, has {table[0]}."
            )
    return ""


def _number_in(stop: Stop) -> str:
    """A number in the list of the columns; empty without one."""
    for node in stop.expressions():
        is_stack = isinstance(node, ast.Call) and ast.unparse(node.func).endswith("column_stack") and node.args
        listed = node.args[0] if isinstance(node, ast.Call) and is_stack else None
        for part in listed.elts if isinstance(listed, ast.List | ast.Tuple) else []:
            thing = stop.things.get(ast.unparse(part))
            if isinstance(part, ast.Constant) or (thing is not None and thing.kind == "number"):
                return ast.unparse(part)
    return ""


def _stacks(stop: Stop) -> bool:
    """Whether flat arrays are handed over to `np.vstack`."""
    return "vstack(" in stop.line and any(
        len(stop.shape(part) or ()) == 1
        for node in stop.expressions()
        if isinstance(node, ast.List | ast.Tuple)
        for part in node.elts
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
