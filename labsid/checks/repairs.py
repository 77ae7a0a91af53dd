"""Whether a repair that a message proposes fits the line in which it would stand, by the shapes of its parts."""

import ast
from copy import deepcopy

from labsid.checks.line_values import MOST_PARTS, parsed_line, shape_of
from labsid.checks.mended_functions import Mend
from labsid.checks.stops import OTHERWISE, RIGHT, SHAPED, Stop

Shape = tuple[int, ...]
_NEEDS_SHAPES = ("solve", "inv", "dot", "matmul")


def mends(stop: Stop, part: ast.expr, repair: str) -> bool:
    """Whether a line fits with `repair` in the place of `part`; nothing of it is run.

    The shape of the repair must follow from those of its parts, and no operation of the line may then have operands
    whose shapes do not fit. What follows on other lines, and operands of unknown shape, are not looked at.

    Parameters
    ----------
    stop : Stop
    part : ast.expr
        An expression of the line.
    repair : str
        Code in its place.
    """
    tree, written = parsed_line(stop.line), _expression(repair)
    if tree is None or written is None:
        return False
    known = _Known(stop, ast.unparse(part), written)
    tree = known.visit(tree)
    nodes = list(ast.walk(tree))[: 2 * MOST_PARTS]
    is_known = known.repaired is not None and shape_of(known.repaired, known.shapes) is not None
    return is_known and not any(_is_misfit(node, known.shapes) for node in nodes)


def proposal(stop: Stop, part: ast.expr, repair: str, said: str = "", line: str = "") -> str:
    """A question whether a repair is meant, if the answer is right with it; or a fact about shapes; or nothing.

    Parameters
    ----------
    stop : Stop
        Where no mend can be tried, nothing is proposed.
    part : ast.expr
        An expression of the line.
    repair : str
        Code in its place.
    said : str, optional
        The sentence that proposes it, in place of ``Is `repair` meant?``.
    line : str, optional
        The line, if it is one of those that made what stands in the line that stopped.
    """
    outcome = OTHERWISE if stop.outcome is None else stop.outcome(Mend(line or stop.line, ast.unparse(part), repair))
    if outcome == RIGHT:
        return said or f"Is `{repair}` meant?"
    if outcome == SHAPED:
        return f"With `{repair}` the function ends without an error, and what it returns has the shape that is asked."
    return ""


def shape_of_repair(stop: Stop, repair: str) -> Shape | None:
    """Shape of an expression made of what stands in the line; None if it does not follow or does not fit."""
    written = _expression(repair)
    if written is None:
        return None
    known = _Known(stop, "", written)
    return shape_of(known.visit(written), known.shapes)


def beside(stop: Stop, part: ast.expr) -> tuple[str, Shape] | None:
    """The other term of the sum or difference in which an expression stands, with its shape; None without one."""
    tree, text = parsed_line(stop.line), ast.unparse(part)
    for node in [] if tree is None else ast.walk(tree):
        if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Add | ast.Sub):
            for one, other in ((node.left, node.right), (node.right, node.left)):
                shape = stop.shape(other)
                if ast.unparse(one) == text and shape:
                    return ast.unparse(other), shape
    return None


class _Known(ast.NodeTransformer):
    """Puts a repair in the place of a part, and a name for each expression of known shape.

    `shapes` are those of the names; `repaired` is the repair in the tree.
    """

    def __init__(self, stop: Stop, part: str, repair: ast.expr) -> None:
        self.shapes: dict[str, Shape] = {}
        self.repaired: ast.expr | None = None
        self._stop, self._part, self._repair = stop, part, repair

    def visit(self, node: ast.AST) -> ast.AST:
        if not isinstance(node, ast.expr):
            return self.generic_visit(node)
        text = ast.unparse(node)
        if text == self._part:
            self._part = ""  # the repair may hold it again
            self.repaired = self.visit(deepcopy(self._repair))  # type: ignore[assignment]
            self._part = text
            return self.repaired  # type: ignore[return-value]
        thing = self._stop.things.get(text)
        is_read = isinstance(getattr(node, "ctx", ast.Load()), ast.Load) and not isinstance(node, ast.Constant)
        if is_read and thing is not None and thing.kind in ("array", "number") and not self._holds_part(node):
            name = f"known_{len(self.shapes)}"
            self.shapes[name] = thing.shape or ()
            return ast.Name(name, ast.Load())
        return self.generic_visit(node)

    def _holds_part(self, node: ast.AST) -> bool:
        """Whether the part that is repaired stands within an expression: its shape will be another one."""
        return any(isinstance(one, ast.expr) and ast.unparse(one) == self._part for one in ast.walk(node))


def _expression(code: str) -> ast.expr | None:
    tree = parsed_line(code)
    body = tree.body if isinstance(tree, ast.Module) else []
    return body[0].value if len(body) == 1 and isinstance(body[0], ast.Expr) else None


def _is_misfit(node: ast.AST, shapes: dict[str, Shape]) -> bool:
    """Whether an operation has operands of known shapes that do not fit."""
    if isinstance(node, ast.BinOp):
        parts = [node.left, node.right]
    elif isinstance(node, ast.Call) and ast.unparse(node.func).rpartition(".")[2] in _NEEDS_SHAPES:
        parts = node.args
    else:
        return False
    return all(shape_of(one, shapes) is not None for one in parts) and shape_of(node, shapes) is None
