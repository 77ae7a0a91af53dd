"""Causes of Python's errors where a tuple stands for one of its parts, and a value or a list for an index."""

import ast
import re
from collections.abc import Iterator

from labsid.checks.line_values import parsed_line
from labsid.checks.stops import Stop

_FINDS = ("where", "nonzero", "flatnonzero", "argwhere")
_EXTREMES = {"min": "argmin", "max": "argmax", "amin": "argmin", "amax": "argmax"}


def tuple_for_a_part(stop: Stop, _: re.Match[str] | None = None) -> str | None:
    """A tuple in a computation: what `np.where` finds, a whole shape, or all that a function returns."""
    for node in stop.expressions():
        if isinstance(node, ast.Name):
            thing = stop.things.get(node.id)
            if thing is not None and thing.kind == "tuple":
                return _all_of(stop, node.id, stop.made.get(node.id, ""))
        if isinstance(node, ast.Call) and _function(node) in _FINDS[:2]:
            return _found(ast.unparse(node), node)
    return _whole_shape(stop.line)


def _all_of(stop: Stop, name: str, made: str) -> str | None:
    """Of what a tuple with that name is the whole; None if that is not known."""
    call = next((node for node in _calls(made) if _function(node) in _FINDS[:2]), None)
    if call is not None:
        return _found(name, call)
    if re.search(r"\.shape\b(?!\s*\[)", made):
        return (
            f"`{name}` is a whole shape, a tuple, by `{made}`: the number of rows is its `[0]`, of columns its `[1]`."
        )
    call = next(iter(_calls(made)), None)
    if call is None:
        return None
    count = (stop.things[name].shape or (0,))[0]
    return (
        f"`{name}` is all that `{ast.unparse(call.func)}` returns, a tuple of {count}, by `{made}`: take the part that "
        f"is meant, `[0]` for the first, or give each a name of its own on the left of `=`."
    )


def _found(name: str, call: ast.Call) -> str:
    condition = ast.unparse(call.args[0]) if call.args else "condition"
    return (
        f"`np.{_function(call)}` returns a tuple, with an array of all the indices in it. The first index is "
        f"`{name}[0][0]`, or `np.argmax({condition})`."
    )


def _whole_shape(line: str) -> str | None:
    """A shape without an index in a line."""
    found = re.search(r"([\w.]+)\.shape\b(?!\s*[\[=])", line)
    if found is None:
        return None
    name = found[1]
    return f"`{name}.shape` is a tuple: the number of rows is `{name}.shape[0]`, of columns `{name}.shape[1]`."


def all_that_is_found(stop: Stop, _: re.Match[str]) -> str | None:
    """All entries that meet a condition, in a computation with one of them."""
    for node in stop.expressions():
        made = stop.made.get(node.id, "") if isinstance(node, ast.Name) else ""
        call = next((one for one in _calls(made) if _function(one) in _FINDS), None)
        thing = stop.things.get(node.id) if isinstance(node, ast.Name) else None
        if call is not None and thing is not None and thing.kind == "array" and thing.shape:
            return (
                f"`{ast.unparse(node)}` has {thing.shape[0]} entries, one for each index that `np.{_function(call)}` "
                f"finds, by `{made}`. The first of them is `[0]`, and its index `np.argmax(condition)`."
            )
    return None


def value_for_an_index(stop: Stop, _: re.Match[str]) -> str | None:
    """The smallest or the largest value where its index is asked for."""
    for node in stop.expressions():
        for part in node.args if isinstance(node, ast.Call) else ():
            if isinstance(part, ast.Call) and _function(part) in _EXTREMES:
                return _no_index(stop, part)
    return None


def unknown_part(stop: Stop, _: re.Match[str]) -> str | None:
    """An index beyond the end of a tuple."""
    for node in stop.expressions():
        if not isinstance(node, ast.Subscript):
            continue
        owner = ast.unparse(node.value)
        thing = stop.things.get(owner)
        if owner.endswith(".shape"):
            return f"`{owner}` is counted from 0: `[0]` is the number of rows, `[1]` of columns."
        if thing is not None and thing.kind == "tuple":
            said = _all_of(stop, owner, stop.made.get(owner, ""))
            return said or f"`{owner}` has {(thing.shape or (0,))[0]} parts, counted from 0."
    return "Python counts from 0: of three parts the last is `[2]`."


def several_indices(stop: Stop, _: re.Match[str]) -> str | None:
    """A list, a tuple, an array or a value where an index is one whole number."""
    for node in stop.expressions():
        for part in _indices(node) if isinstance(node, ast.Subscript) else ():
            said = _no_index(stop, part)
            if said:
                return said
    return None


def _indices(node: ast.Subscript) -> Iterator[ast.expr]:
    """The single indices in square brackets, and the terms of the sums that they are."""
    open_parts: list[ast.expr | None] = [node.slice]
    while open_parts:
        part = open_parts.pop(0)
        if isinstance(part, ast.Tuple):
            open_parts += part.elts
        elif isinstance(part, ast.Slice):
            open_parts += [part.lower, part.upper, part.step]
        elif isinstance(part, ast.BinOp):
            open_parts += [part.left, part.right]
        elif part is not None:
            yield part


def _no_index(stop: Stop, part: ast.expr) -> str:
    """Why an expression is no index; empty if that cannot be told."""
    name, thing = ast.unparse(part), stop.things.get(ast.unparse(part))
    call = next((node for node in ast.walk(part) if isinstance(node, ast.Call) and _function(node) in _FINDS), None)
    if call is not None:
        condition = ast.unparse(call.args[0]) if call.args else "condition"
        return f"`{name}` holds all the indices that are found. The first of them is `np.argmax({condition})`."
    if isinstance(part, ast.Call) and _function(part) in _EXTREMES:
        index_function = _EXTREMES[_function(part)]
        return f"`{name}` is a value, and an index is asked for: where it is, `np.{index_function}(...)` tells."
    if thing is None:
        return ""
    if thing.kind in ("list", "tuple") or (thing.kind == "array" and thing.shape):
        entry = f"{name}[0][0]" if thing.lengths else f"{name}[0]"
        return f"`{name}` {thing.said}, and an index is one number: take an entry, such as `{entry}`."
    if thing.kind == "number" and thing.value is None and not isinstance(part, ast.Constant):
        made = stop.made.get(name, "")
        if "/" in re.sub("//", "", made) or not made:
            return ""
        return (
            f"`{name}` is no whole number, by `{made}`. An index counts samples: `np.argmax` and `np.flatnonzero` "
            "return indices, and an entry of `t` is a time."
        )
    return ""


def _calls(line: str) -> Iterator[ast.Call]:
    tree = parsed_line(line)
    yield from (node for node in ([] if tree is None else ast.walk(tree)) if isinstance(node, ast.Call))


def _function(call: ast.Call) -> str:
    """The name of the function that is called, without what stands before its dot."""
    return call.func.attr if isinstance(call.func, ast.Attribute) else getattr(call.func, "id", "")
