"""Rows and columns of a table that were taken for each other, and flat arrays in the place of a table."""

import ast
import re
from collections.abc import Iterator

from labsid.checks.empty_slices import empty_slice
from labsid.checks.line_values import parsed_line
from labsid.checks.stops import Stop

_NAME = re.compile(r"(?<![\w.\"'])[A-Za-z_]\w*")
_EYE = re.compile(r"\beye\([^(),]+, *(-?\w+)\)")
"""What looks like a diagonal, and is the number of columns."""
_FLAT_ZEROS = re.compile(r"\b(zeros|ones|empty)\(\s*(?!\()[^(),]*(?:\([^()]*\))?[^(),]*\)\s*(?:#.*)?$")
"""An array of zeros of one size, at the end of a line."""


def row_or_column(stop: Stop, _: re.Match[str] | None = None) -> str | None:
    """A row where a column fits, or the reverse: in the line that stopped, or in one that made what stands in it."""
    sizes = {int(number) for number in re.findall(r"\b\d+\b", stop.text)}
    sizes |= {length for thing in stop.things.values() for length in thing.lengths}
    failed = stop.line if "input array" in stop.text else stop.part or stop.line
    lines = dict.fromkeys((failed, *_lines_behind(stop, failed)))
    counted = (_counted,) if "core dimension" in stop.text else ()
    for taken in (*counted, _starred, _gone_through, _cut):
        for line in lines:
            said = next(filter(None, (taken(stop, line, node, sizes) for node in _expressions(line))), "")
            if said:
                return said if line == failed else f"In `{line}`, {said}"
    return None


def _lines_behind(stop: Stop, failed: str) -> Iterator[str]:
    """The lines that made what stands in the part that failed, and those that made what stands in these."""
    asked, told = [failed], set[str]()
    while asked:
        for name in _NAME.findall(asked.pop(0)):
            thing = stop.things.get(name)
            is_count = thing is not None and thing.kind == "number"
            if name in stop.made and name not in told and (not is_count or "len(" in stop.made[name]):
                told.add(name)
                asked.append(stop.made[name])
                yield stop.made[name]


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
        return _turned_target(stop, table, parts, name)
    is_behind = line not in (
        stop.part,
        stop.line,
    )  # a row is what a step of a recursion takes: another side may be wrong
    if is_behind and "core dimension" in stop.text:
        return ""
    if at == [True] or (at == [True, False] and _is_whole(parts[1])):
        k = ast.unparse(parts[0])
        return f"`{cut}` is a row of `{name}`, with {table[1]} entries; a column, `{name}[:, {k}]`, has {table[0]}."
    return ""


def _turned_target(stop: Stop, table: tuple[int, ...], parts: list[ast.expr], name: str) -> str:
    """A row that is set to as many numbers as a column has; empty if it is not."""
    got = re.search(r"from shape \((\d+),\) into shape \((\d+),\)", stop.text)
    if got is None or (int(got[1]), int(got[2])) != table or isinstance(parts[0], ast.Slice):
        return ""
    if _EYE.search(stop.made.get(name, "")):
        return ""
    k = ast.unparse(parts[0])
    return f"`{name}[{k}]` is a row of `{name}`, with {table[1]} entries; a column, `{name}[:, {k}]`, has {table[0]}."


def _is_whole(part: ast.expr) -> bool:
    return isinstance(part, ast.Slice) and part.lower is part.upper is part.step is None


def unfit_target(stop: Stop, found: re.Match[str]) -> str | None:
    """Entries that are set to an array of another shape."""
    target, value = _assignment(stop)
    if target is None or value is None:
        return None
    empty = empty_slice(stop, [ast.unparse(value)]) if re.match(r"\(0,", found[1]) else ""
    if empty:
        return empty
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
    eye = _EYE.search(stop.made.get(ast.unparse(target.value), ""))
    if eye is not None:
        return (
            f"`{left}` takes {wanted}: `{eye[0]}` made it, where {eye[1]}, what comes second, is the number of "
            f"columns. A diagonal above or below is chosen by its name, `k={eye[1]}`."
        )
    if re.fullmatch(r"\(\d+,\)", got) and re.fullmatch(r"\(\d+,\)", wanted):
        made = f" (made by `{stop.made[right]}`)" if right in stop.made else ""
        return (
            f"`{left}` takes {wanted[1:-2]} numbers, and `{right}`{made} has {got[1:-2]}: on both sides of `=` there "
            f"must be as many.{_counted_size(stop, target, int(wanted[1:-2]) - int(got[1:-2]))}"
        )
    made = f", by `{stop.made[right]}`" if right in stop.made else ""
    return f"`{left}` takes {wanted}, and `{right}` has the shape {got}{made}."


def _counted_size(stop: Stop, target: ast.Subscript, excess: int) -> str:
    """By which count the array that is set got its size; empty if that is not known."""
    made = stop.made.get(ast.unparse(target.value), "")
    for name in _NAME.findall(made.partition("=")[2]):
        count = stop.made.get(name, "")
        counted = re.search(r"=\s*len\((\w+)\)( - \d+)?$", count)
        if counted is None or stop.things.get(name) is None or stop.things[name].kind != "number":
            continue
        order = f" (A polynomial of len({counted[1]}) coefficients has the order len({counted[1]}) - 1.)"
        return f" `{made}` made it, with `{count}`.{order if excess == 1 and counted[2] is None else ''}"
    return ""


def entry_of_a_flat_array(stop: Stop, _: re.Match[str]) -> str | None:
    """One entry of a flat array that is set to a whole array, or a row of a table that is set to a list of arrays."""
    for target, value in _pairs(stop):
        shape, put = stop.shape(target.value), stop.shape(value)
        parts = value.elts if isinstance(value, ast.List | ast.Tuple) else []
        whole = [part for part in parts if stop.shape(part)]
        if shape is not None and len(shape) == 2 and whole and not isinstance(target.slice, ast.Tuple):
            left, right = ast.unparse(target), ast.unparse(value)
            return (
                f"`{left}` is one row of {shape[1]} numbers, and `{right}` a list with arrays in it: "
                f"`{ast.unparse(whole[0])}` has shape {stop.shape(whole[0])}. Joined to one flat array they are "
                "`np.concatenate([...])`."
            )
        if shape is None or len(shape) != 1 or put == ():
            continue
        name, right = ast.unparse(target.value), ast.unparse(value)
        holds = f"`{right}` has shape {put}" if put else f"`{right}` is an array of several"
        made = f", by `{stop.made[name]}`" if name in stop.made else ""
        zeros = zeros_of_one_size(stop, name)
        return (
            f"`{name}` has shape {shape}{made}: each entry is one number, and {holds}. Is a row to be kept for each? "
            f"Then `{name}` must be a table: {zeros or '`np.zeros((rows, columns))`.'} Is it to be one number? Then "
            "something on the right is taken whole in place of one entry."
        )
    return None


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
    return next(_pairs(stop), (None, None))


def _pairs(stop: Stop) -> Iterator[tuple[ast.Subscript, ast.expr]]:
    """The entries that a line sets, each with what it sets it to."""
    tree = parsed_line(stop.line)
    for node in [] if tree is None else ast.walk(tree):
        if not isinstance(node, ast.Assign) or len(node.targets) != 1:
            continue
        target, value = node.targets[0], node.value
        if isinstance(target, ast.Subscript):
            yield target, value
        elif isinstance(target, ast.Tuple) and isinstance(value, ast.Tuple) and len(target.elts) == len(value.elts):
            pairs = zip(target.elts, value.elts, strict=True)
            yield from ((one, part) for one, part in pairs if isinstance(one, ast.Subscript))
