"""Causes of Python's errors between two operands, entry by entry: the shapes are those in Python's own message."""

import ast
import re
from dataclasses import dataclass

from labsid.checks.argument_orders import turned_polynomial
from labsid.checks.empty_slices import empty_slice
from labsid.checks.line_values import parsed_line
from labsid.checks.matrix_causes import products_of_matrices
from labsid.checks.repairs import mends, proposal, shape_of_repair
from labsid.checks.singular_matrices import never_inverted
from labsid.checks.stops import Stop

_OPERATIONS = (ast.Add, ast.Sub, ast.Mult, ast.Div, ast.Pow, ast.FloorDiv, ast.Mod)
_PLACE = {0: "column", 1: "row"}
"""By the axis along which numbers are put together: what each number is made of."""
_SHORTEST_SIGNAL = 20
"""Entries; vectors of parameters and coefficients have fewer."""
Shape = tuple[int, ...]


@dataclass(frozen=True, slots=True)
class Operands:
    """The two sides of an operation that failed."""

    operation: ast.operator
    left: ast.expr
    right: ast.expr
    shapes: tuple[Shape, Shape]
    is_in_place: bool = False


def shapes_in(text: str) -> list[Shape]:
    """The shapes in a message of numpy's, in its order."""
    found = re.findall(r"\((\d+(?:,\s*\d+)*),?\)|\(\)", text)
    return [tuple(map(int, one.split(","))) if one else () for one in found]


def operands_of(stop: Stop) -> Operands | None:
    """The operation of the line that failed; None if that is not known."""
    shapes = shapes_in(stop.text)
    if len(shapes) < 2:
        return None
    pair = shapes[0], shapes[1]
    tree = parsed_line(stop.part or stop.line)
    body = tree.body[0] if isinstance(tree, ast.Module) and len(tree.body) == 1 else None
    if isinstance(body, ast.AugAssign):
        return Operands(body.op, body.target, body.value, pair, True)
    whole = body.value if isinstance(body, ast.Expr) and stop.part else None
    if isinstance(whole, ast.BinOp) and isinstance(whole.op, _OPERATIONS):
        return Operands(whole.op, whole.left, whole.right, pair)
    for node in stop.operations(*_OPERATIONS):
        if (stop.shape(node.left), stop.shape(node.right)) == pair:
            return Operands(node.op, node.left, node.right, pair)
    return None


def entry_by_entry(stop: Stop, _: re.Match[str]) -> str | None:
    """`*` where the shapes fit a matrix product."""
    found = operands_of(stop)
    if found is None or not isinstance(found.operation, ast.Mult):
        return None
    (one, other), left, right = found.shapes, ast.unparse(found.left), ast.unparse(found.right)
    if len(one) != 2 or len(other) != 2 or one[-1] != other[0]:
        return None
    if right == f"{left}.T" and one[0] > one[-1]:
        return (
            f"`*` multiplies entry by entry; the product of matrices is `@`. `{left} @ {right}` would be "
            f"{one[0]} by {one[0]}, and never has an inverse; `{right} @ {left}` is {one[-1]} by {one[-1]}."
        )
    said, product = "`*` multiplies entry by entry. The product of the matrices is", f"{left} @ {right}"
    count = products_of_matrices(stop)
    if count:
        return f"{said} `{product}`, which fits. So are the others: each of the {count} `*` in this line is an `@`."
    if mends(stop, ast.BinOp(found.left, ast.Mult(), found.right), product):
        return f"{said} `{product}`, which fits."
    return f"{said} `{product}`, of shape {(one[0], other[1])}."


def vector_by_columns(stop: Stop, _: re.Match[str]) -> str | None:
    """`*` between a matrix and a vector with an entry for each column, where the product fits the line."""
    found = operands_of(stop)
    for side in () if found is None else (found.left, found.right):
        made = stop.made.get(side.id, "") if isinstance(side, ast.Name) else ""
        tree = parsed_line(made) if made else side
        for node in [] if tree is None else ast.walk(tree):
            if not isinstance(node, ast.BinOp) or not isinstance(node.op, ast.Mult):
                continue
            written, left, right = map(ast.unparse, (node, node.left, node.right))
            table, vector = stop.shape(node.left), stop.shape(node.right)
            if table is not None and vector is not None and len(table) == 1:
                left, right, table, vector = right, left, vector, table
            shape = stop.shape(node)
            product = f"{left} @ {right}"
            if table is None or len(table) != 2 or vector != table[1:] or shape != table:
                continue
            if not shape_of_repair(stop, product) or not _mended_by(stop, side, node, product):
                continue
            where = f"In `{made}`, `{written}`" if made else f"`{written}`"
            return (
                f"{where} multiplies each column of `{left}` by its entry of `{right}`, and has shape {shape}. The "
                f"product of the matrix and the vector is `{product}`, of shape {table[:1]}."
            )
    return None


def _mended_by(stop: Stop, side: ast.expr, node: ast.BinOp, product: str) -> bool:
    """Whether a line fits with a product in the place of `*`, which stands in it or is what made its `side`."""
    made = parsed_line(stop.made.get(side.id, "")) if isinstance(side, ast.Name) else None
    value = next((one.value for one in ast.walk(made) if isinstance(one, ast.Assign)), None) if made else None
    if value is None:
        return mends(stop, node, product)
    return mends(stop, side, ast.unparse(value).replace(ast.unparse(node), product))


def rows_by_a_vector(stop: Stop, _: re.Match[str]) -> str | None:
    """A number for each row, in a flat array."""
    found = operands_of(stop)
    if found is None:
        return None
    if found.is_in_place:
        return None
    (one, other), left, right = found.shapes, found.left, found.right
    if (len(one), len(other)) == (1, 2):
        one, other, left, right = other, one, right, left
    if len(one) == 2 and len(other) == 1 and one[0] == other[0]:
        along_rows = _reduced(stop, right, one)
        name = ast.unparse(right)
        name = name if re.fullmatch(r"[\w.]+(\[.*\]|\(.*\))*", name) else f"({name})"
        if along_rows:
            kept = f"(To keep one for each row beside the table: `{name}[:, np.newaxis]`.)"
            return f"{along_rows} {_with_side(stop, found, right, f'{name}[:, np.newaxis]', kept)}".rstrip()
        said = f"numpy matches shapes from the last axis: a flat array stands for one *row* of {one[1]}."
        to_each = f"For one number to each of the {one[0]} rows make it a column: `{name}[:, np.newaxis]`."
        proposed = _with_side(stop, found, right, f"{name}[:, np.newaxis]", to_each)
        return (
            f"{said} {proposed}"
            if proposed
            else f"{said} `{ast.unparse(left)}` has shape {one} and `{ast.unparse(right)}` {other}."
        )
    for side, shape in ((found.left, found.shapes[0]), (found.right, found.shapes[1])):
        turned = re.fullmatch(r"(\w+)\[(np\.newaxis|None),\s*:\]", ast.unparse(side))
        if turned is not None and len(shape) == 2 and shape[1] in (one[0], other[0]):
            column = f"{turned[1]}[:, {turned[2]}]"
            to_each = f"For one number to each row make a column of it: `{column}`."
            return (
                f"`{turned[0]}` is one row, of shape {shape}. {_with_side(stop, found, side, column, to_each)}".rstrip()
            )
    return None


def _with_side(stop: Stop, found: Operands, side: ast.expr, repair: str, said: str) -> str:
    """The proposal of another operand, in this operation alone: its name may stand elsewhere in the line, too."""
    sides = (found.left, found.right)
    left, right = (ast.parse(repair, mode="eval").body if one is side else one for one in sides)
    part = ast.BinOp(found.left, found.operation, found.right)
    return proposal(stop, part, ast.unparse(ast.BinOp(left, found.operation, right)), said)


def unequal_shapes(stop: Stop, _: re.Match[str]) -> str | None:
    """Two operands of different shapes: what each is, and what made it so."""
    found = operands_of(stop)
    if found is None:
        shapes = " and ".join(map(str, dict.fromkeys(shapes_in(stop.text))))
        return f"Entry by entry, both need the same shape (an axis of length 1 fits any). Here these are {shapes}."
    one, other = found.shapes
    left, right = ast.unparse(found.left), ast.unparse(found.right)
    for side, shape, beside in ((found.left, one, other), (found.right, other, one)):
        said = (
            _reduced(stop, side, beside)
            or _convolved(stop, side, shape, beside)
            or turned_polynomial(stop, side, beside)
        )
        if said:
            return said
    fault = empty_slice(stop, [left, right] if 0 in (*one, *other) else ()) or never_inverted(stop)
    if fault:
        return f"`{left}` has shape {one} and `{right}` {other}. {fault}"
    if len(one) == len(other) == 1:
        return f"`{left}` has {one[0]} entries and `{right}` has {other[0]}. {_paired(stop, found, left, right)}"
    return (
        f"`{left}` has shape {one} and `{right}` {other}. Entry by entry, both need the same shape (an axis of "
        "length 1 fits any)."
    )


def _paired(stop: Stop, found: Operands, left: str, right: str) -> str:
    """How two flat arrays of different lengths can stand beside each other."""
    one, other = found.shapes[0][0], found.shapes[1][0]
    filling = re.compile(r"(?:np\.)?(zeros|ones)\(.*\)|\[0(?:\.0)?\] \* .+")
    if isinstance(found.operation, ast.Add) and (filling.fullmatch(left) or filling.fullmatch(right)):
        joined = f"np.concatenate([{left}, {right}])"
        asked = f"Is one to stand behind the other? Then join them: `{joined}`."
        proposed = proposal(stop, ast.BinOp(found.left, found.operation, found.right), joined, asked)
        return f"`+` adds entry by entry, and joins nothing. {proposed}".rstrip()
    if 2 * min(one, other) < max(one, other):
        return "Entry by entry they do not pair up."
    are_signals = min(one, other) >= _SHORTEST_SIGNAL
    cut = are_signals or any(_is_cut(stop, side) for side in (found.left, found.right))
    samples = " Signals beside each other must cover the same samples." if cut else ""
    return f"Entry by entry they must be of equal length.{samples}"


def _is_cut(stop: Stop, side: ast.expr) -> bool:
    """Whether a slice with bounds stands in an expression, or in the line that made what has this name."""
    tree = parsed_line(stop.made.get(side.id, "")) if isinstance(side, ast.Name) else side
    slices = (node for node in ([] if tree is None else ast.walk(tree)) if isinstance(node, ast.Slice))
    return any(one.lower is not None or one.upper is not None for one in slices)


def _reduced(stop: Stop, side: ast.expr, beside: Shape) -> str:
    """A mean or the like along one axis, where that along the other fits; empty if there is none."""
    made = parsed_line(stop.made.get(side.id, "")) if isinstance(side, ast.Name) else side
    for node in [] if made is None else ast.walk(made):
        if not isinstance(node, ast.Call) or [one.arg for one in node.keywords] != ["axis"]:
            continue
        axis = node.keywords[0].value
        table = node.args[0] if node.args else getattr(node.func, "value", None)
        shape = None if table is None else stop.shape(table)
        if not isinstance(axis, ast.Constant) or axis.value not in (0, 1) or shape is None or len(shape) != 2:
            continue
        k, call = 0 if axis.value == 0 else 1, ast.unparse(node)
        said = f"`{call}` has {shape[1 - k]} entries: `axis={k}` makes one number of each *{_PLACE[k]}*."
        fits = bool(beside) and beside[-1] == shape[k] != shape[1 - k]
        return f"{said} `axis={1 - k}` makes one of each {_PLACE[1 - k]}, {shape[k]} in all." if fits else said
    return ""


def _convolved(stop: Stop, side: ast.expr, shape: Shape, beside: Shape) -> str:
    """A convolution, which is longer than the signal; empty if there is none."""
    line = stop.made.get(side.id, "") if isinstance(side, ast.Name) else ast.unparse(side)
    joined = re.search(r"np\.convolve\((\w+), (\w+)\)", line)
    if joined is None:
        return ""
    things = [stop.things.get(name) for name in joined.groups()]
    sizes = [thing.shape[0] if thing is not None and thing.shape else 0 for thing in things]
    if not all(sizes) or shape != (sum(sizes) - 1,):
        return ""
    longer = joined[1 + (sizes[1] >= sizes[0])]
    said = f"`{joined[0]}` has len({joined[1]}) + len({joined[2]}) - 1 = {shape[0]} entries"
    if beside[-1:] != (max(sizes),):
        return f"{said}."
    return f"{said}: those of the samples of `{longer}` are the first, `{joined[0]}[: len({longer})]`."
