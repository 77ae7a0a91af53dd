"""Rows and columns of a table that were taken for each other, and flat arrays in the place of a table."""

import ast
import re
from collections.abc import Iterator

from labsid.checks.line_values import parsed_line
from labsid.checks.stops import Stop

_FLAT_ZEROS = re.compile(r"\b(zeros|ones|empty)\(\s*(?!\()[^(),]*(?:\([^()]*\))?[^(),]*\)\s*(?:#.*)?$")
"""An array of zeros of one size, at the end of a line."""


def row_or_column(stop: Stop, _: re.Match[str] | None = None) -> str | None:
    """A row where a column fits, or the reverse: in the line that stopped, or in one that made what stands in it."""
    sizes = {int(number) for number in re.findall(r"\b\d+\b", stop.text)}
    sizes |= {length for thing in stop.things.values() for length in thing.lengths}
    lines = dict.fromkeys((stop.line, *stop.made.values()))
    counted = (_counted,) if "core dimension" in stop.text else ()
    for taken in (*counted, _starred, _gone_through, _cut):
        for line in lines:
            said = next(filter(None, (taken(stop, line, node, sizes) for node in _expressions(line))), "")
            if said:
                return said if line == stop.line else f"In `{line}`, {said}"
    return None


def _expressions(line: str) -> Iterator[ast.expr]:
    tree = parsed_line(line)
    yield from (node for node in ([] if tree is None else ast.walk(tree)) if isinstance(node, ast.expr))


def _counted(stop: Stop, line: str, node: ast.expr, sizes: set[int]) -> str:
    """The number of rows, where an array is made with an entry for each column."""
    is_length = isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == "len"
    if not is_length or not isinstance(node, ast.Call) or not node.args:
        return ""
    table, name = stop.shape(node.args[0]), ast.unparse(node.args[0])
    counted = "|".join(map(re.escape, [f"len({name})", *(one for one, made in stop.made.items() if made == line)]))
    zeros = re.compile(rf"\bzeros\(({counted})\)")
    is_size = any(zeros.search(made) and re.search(rf"\b{one}\b", stop.line) for one, made in stop.made.items())
    if table is None or len(table) != 2 or table[0] == table[1] or not set(table) <= sizes or not is_size:
        return ""
    return f"`len({name})` is {table[0]}, the number of rows; the number of columns is `{name}.shape[1]`, {table[1]}."


def _starred(stop: Stop, _: str, node: ast.expr, sizes: set[int]) -> str:
    """The rows of a table, or the whole of it, in a list of columns."""
    if not isinstance(node, ast.List) or "block(" in stop.line:
        return ""
    for part in node.elts:
        inner = part.value if isinstance(part, ast.Starred) else part
        table, name = stop.shape(inner), ast.unparse(inner)
        if table is None or len(table) != 2 or "must match exactly" not in stop.text:
            continue
        if isinstance(part, ast.Starred) and table[1] in sizes and table[1] < table[0]:
            return f"`*{name}` is one row of `{name}` after the other; its columns are `*{name}.T`."
        if not isinstance(part, ast.Starred) and name.endswith(".T"):
            return f"`{name}` is a whole table: `*{name}` puts its rows into the list, one after the other."
    return ""


def _gone_through(stop: Stop, line: str, node: ast.expr, sizes: set[int]) -> str:
    """A loop through the columns of a table."""
    if not line.startswith("for ") or not isinstance(node, ast.Attribute) or node.attr != "T":
        return ""
    table, name = stop.shape(node.value), ast.unparse(node.value)
    if table is None or len(table) != 2 or not set(table) <= sizes:
        return ""
    return f"`{name}.T` is gone through column by column of `{name}`; `{name}` itself goes row by row."


def _cut(stop: Stop, line: str, node: ast.expr, sizes: set[int]) -> str:
    """A row or a column that is taken of a table."""
    if not isinstance(node, ast.Subscript):
        return ""
    table, name = stop.shape(node.value), ast.unparse(node.value)
    if table is None or len(table) != 2 or table[0] == table[1] or not set(table) <= sizes:
        return ""
    parts = node.slice.elts if isinstance(node.slice, ast.Tuple) else [node.slice]
    at = [not isinstance(part, ast.Slice) for part in parts]
    cut = ast.unparse(node)
    if at == [False, True] and _is_whole(parts[0]):
        k = ast.unparse(parts[1])
        return f"`{cut}` is a column of `{name}`, with {table[0]} entries; a row, `{name}[{k}]`, has {table[1]}."
    if isinstance(node.ctx, ast.Store):
        return ""
    if at == [True] or (at == [True, False] and _is_whole(parts[1])):
        k = ast.unparse(parts[0])
        return f"`{cut}` is a row of `{name}`, with {table[1]} entries; a column, `{name}[:, {k}]`, has {table[0]}."
    return ""


def _is_whole(part: ast.expr) -> bool:
    return isinstance(part, ast.Slice) and part.lower is part.upper is part.step is None


def unfit_target(stop: Stop, found: re.Match[str]) -> str | None:
    """Entries that are set to an array of another shape."""
    target, value = _assignment(stop)
    if target is None or value is None:
        return None
    left, right, got = ast.unparse(target), ast.unparse(value), found[1].replace(" ", "")
    wanted = found[2].replace(" ", "")
    if got.endswith(",1)") and wanted == got.replace(",1)", ",)"):
        return f"`{right}` is a column, {got}, and `{left}` is flat, {wanted}: `{right}[:, 0]` is flat, too."
    if re.fullmatch(r"\((\d+),\1\)", got):
        made = f", made by `{stop.made[right]}`" if right in stop.made else ""
        return (
            f"`{right}` is a table of {got[1:-1].replace(',', ' by ')}{made}, and `{left}` takes one row of it. Print "
            "the shapes of what it is made of. Often here: `*` between a matrix and a vector where `@` is meant, or a "
            "column (N, 1) beside a flat array (N,)?"
        )
    if isinstance(value, ast.Name):
        made = f", by `{stop.made[right]}`" if right in stop.made else ""
        return f"`{left}` takes {wanted}, and `{right}` has the shape {got}{made}."
    return None


def entry_of_a_flat_array(stop: Stop, _: re.Match[str]) -> str | None:
    """One entry of a flat array that is set to a whole array."""
    target, _value = _assignment(stop)
    shape = None if target is None else stop.shape(target.value)
    if target is None or shape is None or len(shape) != 1:
        return None
    name = ast.unparse(target.value)
    return (
        f"`{name}` has shape {shape}: each entry is one number, and here it is set to a whole array. "
        f"{zeros_of_one_size(stop, name) or 'A table takes a row at once: `np.zeros((rows, columns))`.'}"
    )


def zeros_of_one_size(stop: Stop, name: str) -> str:
    """That a flat array was made in the way in which MATLAB makes a square one; empty if it was not."""
    made = _FLAT_ZEROS.search(stop.made.get(name, ""))
    return (
        ""
        if made is None
        else (
            f"`np.{made[1]}(n)` is flat, while MATLAB's `{made[1]}(n)` is n by n: a table is "
            f"`np.{made[1]}((rows, columns))`."
        )
    )


def _assignment(stop: Stop) -> tuple[ast.Subscript | None, ast.expr | None]:
    """The entries that a line sets, and what it sets them to."""
    tree = parsed_line(stop.line)
    for node in _statements(tree):
        if len(node.targets) == 1 and isinstance(node.targets[0], ast.Subscript):
            return node.targets[0], node.value
    return None, None


def _statements(tree: ast.AST | None) -> Iterator[ast.Assign]:
    yield from (node for node in ([] if tree is None else ast.walk(tree)) if isinstance(node, ast.Assign))
