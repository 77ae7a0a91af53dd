"""Expressions that may be meant in the place of one in a student's function."""

import ast
from collections.abc import Iterator
from copy import deepcopy
from typing import NamedTuple

from labsid.checks.cell_names import parse_python
from labsid.checks.syntax_trees import last_name

_SMALL = 3  # integers up to it are indices, lags and bounds, which are often off by one
_REDUCE = ("sum", "mean", "norm")
"""Functions that make one number of many where each is asked for."""
_KEPT_CALLS = ("range", "len", "enumerate", "zip", "list", "int", "float", "array", "asarray", "copy", "zeros", "ones")
"""Functions without which an expression is another kind of thing, or the same."""
_CUT_OFF = "`//` cuts off all digits behind the point; `/` keeps them."
_WHOLE_NUMBERS = "An array of whole numbers cuts off all digits behind the point."
_ENTRY_BY_ENTRY = "`*` multiplies two flat arrays entry by entry; the table of all products is `np.outer`."
_IN_PLACE = (
    "`{0}` changes the array itself, also where it stands in a list already or under another name: `{1}` makes a new "
    "one."
)
_KEYWORD = "The argument `{0}` is not asked for."
_OPERATORS: dict[type[ast.operator], str] = {ast.Add: "+=", ast.Sub: "-=", ast.Mult: "*=", ast.Div: "/="}


class Other(NamedTuple):
    """An expression, or a statement, that may be meant in the place of one.

    `rank` is lower for mistakes that are more frequent, and `is_whole` says whether the message shows what is replaced
    alone, without what stands around it. `why` is what the one does that the other does not, in a sentence.
    """

    rank: int
    new: ast.AST
    is_whole: bool
    why: str = ""


def statements_for(node: ast.AugAssign) -> Iterator[Other]:
    """An assignment of a new array in the place of one that changes the array."""
    if isinstance(node.target, ast.Name) and type(node.op) in _OPERATORS:
        name, sign = node.target.id, _OPERATORS[type(node.op)]
        value = ast.BinOp(ast.Name(name, ast.Load()), node.op, node.value)
        new = ast.copy_location(ast.Assign([ast.Name(name, ast.Store())], value), node)
        yield Other(1, new, True, _IN_PLACE.format(f"{name} {sign}", f"{name} = {name} {sign[0]} ..."))


def expressions_for(node: ast.expr, parent: ast.AST, names: list[str]) -> Iterator[Other]:
    """Expressions that may be meant in the place of one.

    Parameters
    ----------
    node, parent : ast.AST
        The expression, and what it stands in.
    names : list of str
        The variables of the function.
    """
    match node:
        case ast.Constant(value=int(number)) if not isinstance(number, bool) and abs(number) <= _SMALL:
            for other in (number + 1, number - 1):
                if other >= 0:
                    yield Other(0, ast.Constant(other), False)
        case ast.Attribute(attr="shape") if isinstance(parent, ast.Assign):
            yield Other(0, _parsed(f"({ast.unparse(node)})[::-1]"), True)
        case ast.Attribute(attr="T"):
            yield Other(1, node.value, True)
        case ast.Name():
            rank = 3 if isinstance(parent, ast.Subscript) else 4
            if node.id in names:
                yield from (Other(rank, ast.Name(other, ast.Load()), False) for other in names if other != node.id)
            if isinstance(parent, ast.BinOp) and isinstance(parent.op, ast.MatMult):
                yield Other(3, ast.Attribute(deepcopy(node), "T", ast.Load()), False)
        case ast.UnaryOp(op=ast.USub()):
            yield Other(1, node.operand, True)
        case ast.BinOp():
            yield from _other_operations(node)
        case ast.Call():
            yield from _other_calls(node)
    in_list = isinstance(parent, ast.List | ast.Tuple) and not isinstance(node, ast.Constant | ast.UnaryOp)
    if in_list and isinstance(node, ast.Subscript | ast.Name):
        yield Other(3, ast.UnaryOp(ast.USub(), deepcopy(node)), True)
    if isinstance(parent, ast.Subscript) and node is parent.slice and isinstance(node, ast.Name):
        for operation in (ast.Sub(), ast.Add()):
            yield Other(2, ast.BinOp(deepcopy(node), operation, ast.Constant(1)), False)


def _other_operations(node: ast.BinOp) -> Iterator[Other]:
    others: dict[type[ast.operator], ast.operator] = {
        ast.Add: ast.Sub(), ast.Sub: ast.Add(), ast.Mult: ast.Div(), ast.Div: ast.Mult(),
    }  # fmt: skip
    operation = type(node.op)
    if operation in others:
        yield Other(1, ast.BinOp(node.left, others[operation], node.right), True)
    if operation is ast.FloorDiv:
        yield Other(0, ast.BinOp(node.left, ast.Div(), node.right), True, _CUT_OFF)
    if operation is ast.Mult:
        outer = ast.Attribute(ast.Name("np", ast.Load()), "outer", ast.Load())
        are_products = all(isinstance(x, ast.BinOp) and isinstance(x.op, ast.MatMult) for x in (node.left, node.right))
        yield Other(0 if are_products else 3, ast.Call(outer, [node.left, node.right], []), True, _ENTRY_BY_ENTRY)
    inner = node.left
    if operation is ast.Pow and isinstance(inner, ast.BinOp) and isinstance(inner.op, ast.Add | ast.Sub):
        square = ast.BinOp(inner.right, ast.Pow(), node.right)  # a + b**2 for (a + b)**2
        yield Other(1, ast.BinOp(inner.left, inner.op, square), True)
        yield Other(2, ast.BinOp(ast.BinOp(inner.left, ast.Pow(), node.right), inner.op, square), True)
    if operation is ast.Pow:
        yield Other(1, node.left, True)
    if operation is ast.Sub:
        yield Other(2, ast.BinOp(node.right, ast.Sub(), node.left), True)
    if operation in (ast.Mult, ast.Div, ast.Add, ast.Sub):
        yield Other(2, node.left, True)  # a factor or a term too many
        if operation in (ast.Mult, ast.Add):
            yield Other(2, node.right, True)
    if operation is ast.MatMult:
        yield Other(2, ast.BinOp(node.right, ast.MatMult(), node.left), True)
        middle = node.left
        if isinstance(middle, ast.BinOp) and isinstance(middle.op, ast.MatMult):  # x A y for y A x
            inner = ast.BinOp(node.right, ast.MatMult(), middle.right)
            yield Other(2, ast.BinOp(inner, ast.MatMult(), middle.left), True)


def _other_calls(node: ast.Call) -> Iterator[Other]:
    name = node.func.attr if isinstance(node.func, ast.Attribute) else getattr(node.func, "id", "")
    arguments = node.args
    if name == "range":
        last = 0 if len(arguments) == 1 else 1
        if len(arguments) <= 2 and not isinstance(arguments[last], ast.Constant):
            for operation in (ast.Add(), ast.Sub()):
                bounds = [*arguments[:last], ast.BinOp(arguments[last], operation, ast.Constant(1))]
                yield Other(0, ast.Call(node.func, bounds, []), True)
        if len(arguments) == 1:
            yield Other(0, ast.Call(node.func, [ast.Constant(1), arguments[0]], []), True)
        counted = [one for argument in arguments for one in ast.walk(argument) if _is_length(one)]
        if counted:
            yield Other(1, deepcopy(counted[0].args[0]), True)  # type: ignore[attr-defined]
        return
    for keyword in node.keywords:
        if keyword.arg is not None:
            rest = [one for one in node.keywords if one is not keyword]
            is_whole_number = keyword.arg == "dtype" and "int" in last_name(keyword.value)
            why = _WHOLE_NUMBERS if is_whole_number else _KEYWORD.format(keyword.arg)
            yield Other(1, ast.Call(node.func, arguments, rest), True, why)
    if len(arguments) == 1 and not node.keywords and name not in _KEPT_CALLS:
        yield Other(-1 if name in _REDUCE else 1, arguments[0], True)
        inner = arguments[0]
        if isinstance(inner, ast.Call) and len(inner.args) == 1 and not inner.keywords:
            yield Other(2, inner.args[0], True)
    if len(arguments) >= 2 and not any(isinstance(one, ast.Starred) for one in arguments):
        yield Other(1, ast.Call(node.func, [arguments[1], arguments[0], *arguments[2:]], node.keywords), True)


def _is_length(node: ast.AST) -> bool:
    return isinstance(node, ast.Call) and getattr(node.func, "id", "") == "len" and len(node.args) == 1


def _parsed(text: str) -> ast.expr:
    only = parse_python(text).body[0]
    assert isinstance(only, ast.Expr)
    return only.value
