"""Causes of Python's errors where the arguments of a library's function stand in another order than it has."""

import ast
import re
from collections.abc import Iterator

from labsid.checks.line_values import parsed_line
from labsid.checks.singular_matrices import called
from labsid.checks.stops import Stop


def turned_polynomial(stop: Stop, part: ast.expr, needed: tuple[int, ...]) -> str:
    """That `np.polyval` is handed the points first, where the other order has the shape that is needed; or empty."""
    for node in _calls_behind(stop, part):
        shapes = [stop.shape(one) for one in node.args]
        if called(node) == "polyval" and len(shapes) == 2 and shapes[0] == needed != shapes[1]:
            points, polynomial = map(ast.unparse, node.args)
            return (
                "`np.polyval(p, x)` takes the coefficients first, and has one value for each point of what comes "
                f"second: `np.polyval({polynomial}, {points})` has {needed[0]}."
            )
    return ""


def turned_histogram(stop: Stop, _: re.Match[str]) -> str | None:
    """The edges before the values, where there are as many weights as values."""
    for node in _calls(stop):
        weights = next((one.value for one in node.keywords if one.arg == "weights"), None)
        if called(node) != "histogram" or len(node.args) != 2 or weights is None:
            continue
        first, second = map(stop.shape, node.args)
        sizes = (stop.shape(weights),) if stop.shape(weights) else _sizes_in(stop, weights)
        if first != second and second is not None and second in sizes and first not in sizes:
            x, edges = map(ast.unparse, reversed(node.args))
            return (
                "`np.histogram(x, edges)` takes the values first, with a weight for each of them, and then the edges: "
                f"`np.histogram({x}, {edges}, weights=...)`."
            )
    return None


def _sizes_in(stop: Stop, weights: ast.expr) -> list[tuple[int, ...]]:
    """The shapes of the values of `rfft` in an expression."""
    found: list[tuple[int, ...]] = []
    for node in ast.walk(weights):
        if isinstance(node, ast.Call) and called(node) == "rfft" and node.args:
            shape = stop.shape(node.args[0])
            found += [(shape[0] // 2 + 1,)] if shape else []
    return found


def unsorted_edges(stop: Stop, _: re.Match[str]) -> str | None:
    """What comes second in `np.digitize` or `np.histogram`, and does not increase."""
    for node in _calls(stop):
        if called(node) in ("digitize", "histogram") and len(node.args) > 1:
            return (
                f"`np.{called(node)}(x, edges)` takes the values first and then the edges, which increase: here "
                f"`{ast.unparse(node.args[1])}` comes second."
            )
    return None


def points_of_interpolation(stop: Stop, _: re.Match[str]) -> str | None:
    """One number among the known points of `np.interp`."""
    for node in _calls(stop):
        if called(node) == "interp" and len(node.args) == 3:
            alone = next((one for one in node.args[1:] if _is_number(stop, one)), None)
            if alone is not None:
                return (
                    "`np.interp(x, xp, fp)` takes first where a value is asked for, and then the known points, two "
                    f"arrays: xp, which increases, and fp. Here `{ast.unparse(alone)}` is one number."
                )
    return None


def values_for_a_condition(stop: Stop, _: re.Match[str]) -> str | None:
    """Two arguments of `np.where`."""
    for node in _calls(stop):
        if called(node) == "where" and len(node.args) == 2:
            one, other = map(ast.unparse, node.args)
            return (
                "`np.where` takes one condition, such as `y >= 3`, and then nothing or what to take where it holds and "
                f"where not. Here `{one}` comes first, and `{other}` second."
            )
    return None


def system_first(stop: Stop, _: re.Match[str]) -> str | None:
    """What comes first in a function of python-control that simulates, and is no system."""
    for node in _calls(stop):
        thing = stop.things.get(ast.unparse(node.args[0])) if node.args else None
        if called(node).endswith("response") and thing is not None:
            return (
                f"`{ast.unparse(node.func)}` takes the system first, such as `G`: here `{ast.unparse(node.args[0])}` "
                f"comes first, and it {thing.said}."
            )
    return None


def _is_number(stop: Stop, part: ast.expr) -> bool:
    thing = stop.things.get(ast.unparse(part))
    is_written = isinstance(part, ast.Constant) and isinstance(part.value, int | float)
    return is_written or (thing is not None and (thing.kind == "number" or thing.shape == ()))


def _calls(stop: Stop) -> Iterator[ast.Call]:
    yield from (node for node in stop.expressions() if isinstance(node, ast.Call))


def _calls_behind(stop: Stop, part: ast.expr) -> Iterator[ast.Call]:
    """The calls in an expression, or in the line that made what has this name."""
    tree = parsed_line(stop.made.get(part.id, "")) if isinstance(part, ast.Name) else part
    yield from (node for node in ([] if tree is None else ast.walk(tree)) if isinstance(node, ast.Call))
