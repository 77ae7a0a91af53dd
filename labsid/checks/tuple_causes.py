"""Causes of Python's errors where a tuple stands for one of its parts, and a value or a list for an index."""

import ast
import re
from collections.abc import Iterator

from labsid.checks.line_values import parsed_line
from labsid.checks.stops import Stop
from labsid.checks.syntax_trees import last_name

_FINDS = ("where", "nonzero", "flatnonzero", "argwhere")
_SIZED = ("zeros", "ones", "empty", "eye", "range", "arange", "full", "reshape")
_COUNTS = "An index counts samples: `np.argmax` and `np.flatnonzero` return indices, and an entry of `t` is a time."
_EXTREMES = {"min": "argmin", "max": "argmax", "amin": "argmin", "amax": "argmax"}


def tuple_for_a_part(stop: Stop, _: re.Match[str] | None = None) -> str | None:
    """A tuple in a computation: what `np.where` finds, a whole shape, or all that a function returns."""
    for node in stop.expressions():
        if isinstance(node, ast.Name):
            thing = stop.things.get(node.id)
            if thing is not None and thing.kind == "tuple":
                return _all_of(stop, node.id, stop.made.get(node.id, ""))
        if isinstance(node, ast.Call) and last_name(node.func) in _FINDS[:2]:
            return _found(ast.unparse(node), node)
    return _whole_shape(stop.line)


def _all_of(stop: Stop, name: str, made: str) -> str | None:
    """Of what a tuple with that name is the whole; None if that is not known."""
    call = next((node for node in _calls(made) if last_name(node.func) in _FINDS[:2]), None)
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
    condition = call.args[0] if call.args else None
    said = (
        f"`np.{last_name(call.func)}` returns a tuple, with an array of all the indices in it. The first index is "
        f"`{name}[0][0]`"
    )
    if isinstance(condition, ast.Compare):
        return f"{said}, or `np.argmax({ast.unparse(condition)})`."
    return f"{said}, and the array of all of them `{name}[0]`."


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
        call = next((one for one in _calls(made) if last_name(one.func) in _FINDS), None)
        thing = stop.things.get(node.id) if isinstance(node, ast.Name) else None
        if call is not None and thing is not None and thing.kind == "array" and thing.shape:
            return (
                f"`{ast.unparse(node)}` has {thing.shape[0]} entries, "
                f"one for each index that `np.{last_name(call.func)}` "
                f"finds, by `{made}`. The first of them is `[0]`."
            )
    return None


def value_for_an_index(stop: Stop, _: re.Match[str]) -> str | None:
    """The smallest or the largest value where its index is asked for."""
    for node in stop.expressions():
        for part in node.args if isinstance(node, ast.Call) else ():
            if isinstance(part, ast.Call) and last_name(part.func) in _EXTREMES:
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


def no_whole_number(stop: Stop, _: re.Match[str]) -> str | None:
    """A fraction, or an array, where an index, a size or a count is asked for."""
    whole = "An index, a size or a count must be a whole number"
    nodes = list(stop.expressions())
    fractions = [node for node in nodes if isinstance(node, ast.Name) and _is_fraction(stop, node)]
    lines = (stop.part or stop.line, *(stop.made.get(ast.unparse(node), "") for node in fractions))
    if any(re.search(r"(?<!/)/(?!/)", line) for line in lines):
        return f"{whole}: `/` always gives a float, `//` a whole number."
    for node in (one for one in nodes if isinstance(one, ast.Call)):
        sized = node.args[0] if node.args and last_name(node.func) in ("eye", "identity") else None
        if isinstance(sized, ast.Name) and _is_fraction(stop, sized):
            called = ast.unparse(node.func)
            return (
                f"`{called}` takes a size, the number of rows, and `{sized.id}` is no whole number. A multiple of the "
                f"unit matrix has its factor before it: `{sized.id} * {called}(...)`."
            )
        for part in node.args:
            thing, name = stop.things.get(ast.unparse(part)), ast.unparse(part)
            if thing is not None and thing.kind == "array" and thing.shape and last_name(node.func) in _SIZED:
                return f"{whole}, and `{name}` is an array, of shape {thing.shape}: its length is `len({name})`."
            if isinstance(part, ast.Constant) and type(part.value) is float:
                return f"{whole}, and `{name}` is none."
    return f"{whole}: print what stands in its place."


def _is_fraction(stop: Stop, node: ast.expr) -> bool:
    thing = stop.things.get(ast.unparse(node))
    return thing is not None and thing.kind == "number" and not thing.is_whole


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
            open_parts += [one for one in (part.left, part.right) if not isinstance(one, ast.Constant)]
        elif part is not None:
            yield part


def _no_index(stop: Stop, part: ast.expr) -> str:
    """Why an expression is no index; empty if that cannot be told."""
    name, thing = ast.unparse(part), stop.things.get(ast.unparse(part))
    call = next((one for one in ast.walk(part) if isinstance(one, ast.Call) and last_name(one.func) in _FINDS), None)
    if call is not None:
        condition = call.args[0] if call.args else None
        first = (
            f" The first of them is `np.argmax({ast.unparse(condition)})`."
            if isinstance(condition, ast.Compare)
            else ""
        )
        return f"`{name}` holds all the indices that are found, and an index is one number.{first}"
    if isinstance(part, ast.Call) and last_name(part.func) in _EXTREMES:
        other = _EXTREMES[last_name(part.func)]
        return f"`{name}` is a value, and an index is asked for: where it is, `np.{other}(...)` tells."
    if isinstance(part, ast.Constant) and type(part.value) is float:
        return f"`{name}` is no whole number. {_COUNTS}"
    if thing is None:
        return ""
    if thing.kind == "function" and isinstance(part, ast.Name):
        return (
            f"`{name}` is a function, and an index is one number: what it returns is `{name}({', '.join(thing.keys)})`."
        )
    if thing.kind in ("list", "tuple") or (thing.kind == "array" and thing.shape):
        entry = f"{name}[0][0]" if thing.lengths else f"{name}[0]"
        if thing.kind == "array":
            made = f", by `{stop.made[name]}`" if name in stop.made else ""
            return f"`{name}` {thing.said}{made}, and an index is one whole number."
        return f"`{name}` {thing.said}, and an index is one number: take an entry, such as `{entry}`."
    if thing.kind == "number" and not thing.is_whole and not isinstance(part, ast.Constant):
        made = stop.made.get(name, "")
        if "/" in re.sub("//", "", made):
            return ""
        by = f", by `{made}`" if made else ""
        each = re.match(r"for (\w+) in ([\w.]+):", made)
        if each is not None and each[1] == name:
            return (
                f"`{name}` is no whole number: `{made}` goes through the entries of `{each[2]}` themselves, and "
                f"`for {name} in range(len({each[2]})):` through their indices."
            )
        return f"`{name}` is no whole number{by}. {_COUNTS}"
    return ""


def _calls(line: str) -> Iterator[ast.Call]:
    tree = parsed_line(line)
    yield from (node for node in ([] if tree is None else ast.walk(tree)) if isinstance(node, ast.Call))
