"""How many points `np.arange` and `np.linspace` make, where another number of them is needed."""

import ast
import math
import re

from labsid.checks.line_values import parsed_line
from labsid.checks.stops import Stop


def points_made(stop: Stop, part: ast.expr | None, count: int | None = None, asked: int | None = None) -> str:
    """Why an expression has the number of points that it has; empty if no `arange` or `linspace` made it.

    Parameters
    ----------
    stop : Stop
    part : ast.expr or None
        An array of the line, or what an array is made of there.
    count : int, optional
        The number of points that it has, where its shape does not tell.
    asked : int, optional
        The number of points that is needed.
    """
    call = _made_by_counting(stop, part)
    if call is None:
        return ""
    written, name = ast.unparse(call), ast.unparse(call.func).rpartition(".")[2]
    shape = stop.shape(part) if part is not None else None
    count = shape[0] if shape else count
    has = f"`{written}` has {count} entries" if count is not None else f"`{written}`"
    if name == "linspace":
        return f"{has}: without a third number it makes 50. `np.linspace(first, last, number)` takes their number."
    if len(call.args) == 2:
        return f"{has}: its two numbers are start and stop, and the step is 1. `np.arange(start, stop, step)`."
    if len(call.args) == 3 and asked is not None and asked - 1 == count:
        return f"{has}: the stop, `{ast.unparse(call.args[1])}`, is left out. {asked} are asked for."
    return ""


def _made_by_counting(stop: Stop, part: ast.expr | None) -> ast.Call | None:
    """The call of `np.arange` or of `np.linspace` without a number that an expression is, or that made it."""
    if isinstance(part, ast.Name):
        tree = parsed_line(stop.made.get(part.id, ""))
        part = next((one.value for one in ast.walk(tree) if isinstance(one, ast.Assign)), None) if tree else None
    if not isinstance(part, ast.Call) or part.keywords:
        return None
    name, count = ast.unparse(part.func).rpartition(".")[2], len(part.args)
    return part if (name == "arange" and count in (2, 3)) or (name == "linspace" and count == 2) else None


def reshaped(stop: Stop, found: re.Match[str]) -> str | None:
    """A shape that the entries do not fill, or a number in place of an argument."""
    fixed = [number for number in re.findall(r"\b\d+\b", found[2]) if re.search(rf"\b{number}\b", stop.line)]
    unused = [name for name in stop.arguments if not re.search(rf"\b{name}\b", stop.line)]
    if fixed and unused:
        names = " or ".join(f"`{name}`" for name in unused)
        return (
            f"The line has the number {fixed[0]} in it, whatever is handed over, and does not use the argument {names}."
        )
    sides = [int(number) for number in re.findall(r"\d+", found[2])]
    asked = math.prod(sides) if "newaxis" not in found[2] else None
    for node in stop.expressions():
        if not isinstance(node, ast.Call) or not ast.unparse(node.func).endswith("reshape"):
            continue
        is_method = isinstance(node.func, ast.Attribute) and ast.unparse(node.func.value) != "np"
        owner = node.func.value if is_method and isinstance(node.func, ast.Attribute) else next(iter(node.args), None)
        said = points_made(stop, owner, int(found[1]), asked)
        if said:
            needed = "" if asked is None or "are asked for" in said else f" {asked} are asked for."
            return f"{said}{needed}"
    return f"{found[1]} entries do not fill that shape: the product of its sides must be {found[1]}."
