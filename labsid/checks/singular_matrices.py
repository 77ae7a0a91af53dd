"""Causes of Python's errors at an inverse: products that never have one, by their shapes, and tall matrices."""

import ast
import re
from collections.abc import Iterator

from labsid.checks.line_values import parsed_line
from labsid.checks.stops import Stop

_INVERTED = ("inv", "solve")
"""What takes the inverse of its first argument."""


def products_in(tree: ast.AST) -> Iterator[tuple[ast.expr, ast.expr]]:
    """The factors of the products of matrices, by `@`, `np.dot` or `np.matmul`, outermost first."""
    for node in ast.walk(tree):
        if isinstance(node, ast.BinOp) and isinstance(node.op, ast.MatMult):
            yield node.left, node.right
        elif isinstance(node, ast.Call) and len(node.args) == 2 and called(node) in ("dot", "matmul"):
            yield node.args[0], node.args[1]


def called(node: ast.Call) -> str:
    """The name of the function that is called, without what stands before its dot."""
    return ast.unparse(node.func).rpartition(".")[2]


def never_inverted(stop: Stop) -> str:
    """A product whose inverse is taken and that has none, by its shapes; empty if there is none.

    Looked for in the line that stopped and in those that made what stands in it.
    """
    for line in dict.fromkeys((stop.line, *stop.made.values())):
        tree = parsed_line(line)
        for node in [] if tree is None else ast.walk(tree):
            if isinstance(node, ast.Call) and node.args and called(node) in _INVERTED:
                said = _without_inverse(stop, node.args[0])
                if said:
                    return said
    return ""


def _without_inverse(stop: Stop, matrix: ast.expr) -> str:
    """That a matrix is a product of too low a rank, or has the name of one; empty if it is none."""
    made = stop.made.get(matrix.id, "") if isinstance(matrix, ast.Name) else ""
    tree = parsed_line(made) if made else None
    value = next((one.value for one in ast.walk(tree) if isinstance(one, ast.Assign)), matrix) if tree else matrix
    first, second = next(products_in(value), (None, None))
    if first is None or second is None or not isinstance(value, ast.BinOp | ast.Call):
        return ""
    if isinstance(value, ast.BinOp) and (value.left, value.right) != (first, second):
        return ""
    one, other = stop.shape(first), stop.shape(second)
    if not one or not other or len(one) != 2 or len(other) != 2 or not one[0] == other[1] > one[1]:
        return ""
    left, right = ast.unparse(first), ast.unparse(second)
    is_turned = isinstance(first, ast.Name) and right.endswith(".T")
    small = f"{left}.T @ {right[:-2]}" if is_turned else f"{right} @ {left}"
    name = f"`{ast.unparse(matrix)}`, made by `{made}`, is" if made else f"The product of `{left}` and `{right}` is"
    return (
        f"{name} {one[0]} by {one[0]}, but of rank {one[1]} at most: it never has an inverse. "
        f"`{small}` is {one[1]} by {one[1]}."
    )


def _calls(stop: Stop) -> Iterator[ast.Call]:
    yield from (node for node in stop.expressions() if isinstance(node, ast.Call))


def product_without_inverse(stop: Stop, _: re.Match[str]) -> str | None:
    """A product that is singular by its shapes, a single zero, or dependent columns."""
    for node in stop.expressions():
        if isinstance(node, ast.Call) and node.args and called(node) in _INVERTED:
            shapes = {stop.shape(part) for part in ast.walk(node.args[0]) if isinstance(part, ast.expr)} - {None}
            if (1, 1) in shapes and shapes <= {(1, 1), (1,)}:
                said = f"`{ast.unparse(node.args[0])}` is a single number, and it is zero"
                return f"{said}: {_zero_squares(stop, node.args[0]) or 'print what it is made of.'}"
    said = never_inverted(stop)
    if said:
        return said
    if ".jac" in stop.line:
        return (
            "Where the search ended, the output does not depend on each of the parameters. That is so when the model "
            "does not use one of them, when it lacks one, so that no value of the others fits, and when the "
            "search begins far from the data: print where it ended."
        )
    return (
        "The matrix has no inverse: its columns are dependent, as they are when a column of Phi is zero or a multiple "
        "of others, or when Phi has fewer rows than columns. Print `np.linalg.matrix_rank(...)` of each factor."
    )


def _zero_squares(stop: Stop, matrix: ast.expr) -> str:
    """That a product of a matrix with its transpose, of which a zero is made, has no slopes in it; or nothing."""
    names = [node.id for node in ast.walk(matrix) if isinstance(node, ast.Name)]
    trees = [matrix, *(tree for name in names if (tree := parsed_line(stop.made.get(name, ""))) is not None)]
    for first, second in (pair for tree in trees for pair in products_in(tree)):
        factor = ast.unparse(second)
        if ast.unparse(first) == f"{factor}.T":
            return (
                f"`{factor}.T @ {factor}` is a sum of squares, so every entry of `{factor}` is zero, or too small to "
                f"be squared. If `{factor}` holds slopes: has an earlier step led so far that the output no longer "
                "changes, though it made the error larger?"
            )
    return ""


def not_square(stop: Stop, _: re.Match[str]) -> str | None:
    """The inverse, or the determinant, of a tall matrix."""
    for node in stop.expressions():
        if isinstance(node, ast.Call) and node.args and called(node) in (*_INVERTED, "det"):
            shape, name = stop.shape(node.args[0]), ast.unparse(node.args[0])
            if shape and len(shape) == 2 and shape[0] != shape[1]:
                said = f"`{name}` is {shape[0]} by {shape[1]}; only a square matrix has "
                if called(node) == "det":
                    return (
                        f"{said}a determinant. How many columns of any matrix are independent, its rank says: "
                        f"`np.linalg.matrix_rank({name})`."
                    )
                tall = (
                    f" (Least squares inverts `{name}.T @ {name}`, or takes `np.linalg.lstsq({name}, ...)[0]`.)"
                    if shape[0] > shape[1]
                    else ""
                )
                return f"{said}an inverse.{tall}"
    inverted = next((node.args[0] for node in _calls(stop) if node.args and called(node) in _INVERTED), None)
    if inverted is None or isinstance(inverted, ast.Name):
        return "Only a square matrix has an inverse: in least squares Phi'Phi is square, and Phi is not."
    return f"Only a square matrix has an inverse: print the shape of `{ast.unparse(inverted)}`."
