"""Slices that are empty where their end is counted from the end of an array and the count is zero."""

import ast
from collections.abc import Iterable

from labsid.checks.line_values import parsed_line
from labsid.checks.stops import Stop


def empty_slice(stop: Stop, lines: Iterable[str] = ()) -> str:
    """A slice to `-k` that takes nothing as k is 0, and the same slice with its end counted from 0; or empty.

    Parameters
    ----------
    stop : Stop
    lines : iterable of str
        Lines with slices of which one is known to be empty; without them it must have no entries in the line that
        stopped.
    """
    is_known = bool(tuple(lines))
    for line in lines or (stop.part or stop.line,):
        tree = parsed_line(line)
        for node in [] if tree is None else ast.walk(tree):
            if not isinstance(node, ast.Subscript):
                continue
            cut = node.slice.elts[0] if isinstance(node.slice, ast.Tuple) and node.slice.elts else node.slice
            count = _counted_from_the_end(cut.upper) if isinstance(cut, ast.Slice) and cut.step is None else ""
            shape = stop.shape(node)
            literal = (
                isinstance(cut, ast.Slice) and isinstance(cut.upper, ast.UnaryOp) and ast.unparse(cut.upper) == "-0"
            )
            if literal:
                return f"`{ast.unparse(node)}` is empty: `[:-0]` takes nothing."
            if count and isinstance(cut, ast.Slice) and (is_known or (shape is not None and 0 in shape[:1])):
                return _said(node, cut, count)
    return ""


def _counted_from_the_end(upper: ast.expr | None) -> str:
    """How many entries before its end a slice ends, as written: `k` of `-k`, `n - k` of `-n + k`; or empty."""
    if (
        isinstance(upper, ast.UnaryOp)
        and isinstance(upper.op, ast.USub)
        and not isinstance(upper.operand, ast.Constant)
    ):
        return ast.unparse(upper.operand)
    if isinstance(upper, ast.BinOp) and isinstance(upper.op, ast.Add):
        left = _counted_from_the_end(upper.left) if isinstance(upper.left, ast.UnaryOp) else ""
        return f"{left} - {ast.unparse(upper.right)}" if left else ""
    return ""


def _said(node: ast.Subscript, cut: ast.Slice, count: str) -> str:
    x, first = ast.unparse(node.value), "" if cut.lower is None else ast.unparse(cut.lower)
    end = f"len({x}) - ({count})" if " " in count else f"len({x}) - {count}"
    right = f"{x}[{first} : {end}]" if first else f"{x}[: {end}]"
    return (
        f"With {count} = 0, `{ast.unparse(node)}` takes nothing. `{right}` is the same slice for any other value, and "
        "is not empty for 0."
    )


def begins_below_zero(stop: Stop, text: str) -> str:
    """That a slice in an expression begins below zero, and so counts from the end; empty if none is known to."""
    tree = parsed_line(text)
    for node in [] if tree is None else ast.walk(tree):
        lower = node.slice.lower if isinstance(node, ast.Subscript) and isinstance(node.slice, ast.Slice) else None
        thing = None if lower is None else stop.things.get(ast.unparse(lower))
        if lower is not None and thing is not None and thing.value is not None and thing.value < 0:
            return (
                f"`{text}` is empty: `{ast.unparse(lower)}` is {thing.value}, and an index below zero counts from the "
                "end."
            )
    return ""
