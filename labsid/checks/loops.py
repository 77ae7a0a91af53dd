"""Loops that do not end, or that leave the array: what their condition compares."""

import ast
import re

from labsid.checks.line_values import parsed_line
from labsid.checks.stops import Stop


def beyond_by_a_loop(stop: Stop, found: re.Match[str]) -> str | None:
    """A `while` whose condition is still true at the last entry."""
    index, size = int(found[1]), int(found[3])
    if not stop.line.startswith("while ") or not size or index != size:
        return None
    itself = compared_with_itself(stop)
    if itself:
        return itself
    counters = [name for name, thing in stop.things.items() if thing.value == size and name in stop.made]
    if not any(re.search(r"=\s*\d+$", stop.made[name]) for name in counters):
        return None
    return f"The loop has gone on to the last of {size} entries: its condition held for all of them."


def endless(stop: Stop, _: re.Match[str]) -> str | None:
    """A line in which a loop was interrupted."""
    itself = compared_with_itself(stop)
    if itself:
        return itself
    tree = parsed_line(stop.line)
    only = tree.body[0] if isinstance(tree, ast.Module) and len(tree.body) == 1 else None
    if isinstance(only, ast.Expr) and isinstance(only.value, ast.BinOp):
        name = next((one.id for one in ast.walk(only) if isinstance(one, ast.Name)), "n")
        written = ast.unparse(only)
        return f"`{written}` computes a number and keeps it nowhere: `{name} = {written}` keeps it."
    head = re.match(r"while\s+(.+?)\s*:", stop.line)
    if head is None or head[1] in ("True", "1"):
        return "Look for a loop whose condition never becomes false, or whose `break` is never reached."
    return (
        f"The condition of the loop, `{head[1]}`, does not become false: does a line in the loop change what it "
        "compares, as `n = n + 1` does?"
    )


def compared_with_itself(stop: Stop) -> str:
    """A comparison in the line whose two sides are the same; empty if there is none."""
    tree = parsed_line(stop.line)
    for node in [] if tree is None else ast.walk(tree):
        if isinstance(node, ast.Compare) and len(node.ops) == 1:
            left, right = ast.unparse(node.left), ast.unparse(node.comparators[0])
            if left == right and isinstance(node.ops[0], ast.Eq | ast.GtE | ast.LtE) and _holds_a_name(node.left):
                return f"`{ast.unparse(node)}` compares `{left}` with itself, and is always true."
    return ""


def _holds_a_name(node: ast.expr) -> bool:
    return any(isinstance(one, ast.Name) for one in ast.walk(node))
