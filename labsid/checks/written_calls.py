"""What numbers a cell hands over to a function of its own, read without running any of it."""

import ast
import linecache
import operator
from collections.abc import Mapping
from types import FunctionType
from typing import Any

import numpy as np

from labsid.checks.line_values import parsed_line

_OPERATIONS = {
    ast.Add: operator.add, ast.Sub: operator.sub, ast.Mult: operator.mul, ast.Div: operator.truediv,
    ast.Pow: operator.pow,
}  # fmt: skip


def numbers_handed(function: object, name: str, variables: Mapping[str, Any]) -> tuple[float | None, ...]:
    """The arguments of the call that makes a variable, in the cell that defines the function.

    Parameters
    ----------
    function : object
        The function that is called.
    name : str
        Of the variable.
    variables : mapping
        The notebook's variables.

    Returns
    -------
    tuple of float or None
        None for an argument that is no number, or more than an expression of numbers; empty if the call is not found.
    """
    if not isinstance(function, FunctionType):
        return ()
    found: tuple[float | None, ...] = ()
    for line in linecache.getlines(function.__code__.co_filename):
        tree = parsed_line(line.strip()) if line.startswith(f"{name} ") or line.startswith(f"{name}=") else None
        for node in [] if tree is None else ast.walk(tree):
            is_call = isinstance(node, ast.Call) and isinstance(node.func, ast.Name)
            if isinstance(node, ast.Call) and is_call and node.func.id == function.__name__ and not node.keywords:  # type: ignore[attr-defined]
                found = tuple(_number(one, variables) for one in node.args)
    return found


def _number(node: ast.expr, variables: Mapping[str, Any]) -> float | None:
    """The value of a number, of a variable that is one, or of two of these in an operation; None of anything else."""
    if isinstance(node, ast.BinOp):
        left, right = _single(node.left, variables), _single(node.right, variables)
        operation = _OPERATIONS.get(type(node.op))
        if left is None or right is None or operation is None:
            return None
        try:
            value = operation(left, right)
        except ArithmeticError:
            return None
        return value if isinstance(value, float) else None
    return _single(node, variables)


def _single(node: ast.expr, variables: Mapping[str, Any]) -> float | None:
    value = node.value if isinstance(node, ast.Constant) else None
    value = variables.get(node.id) if isinstance(node, ast.Name) else value
    is_number = isinstance(value, int | float | np.number) and not isinstance(value, bool)
    return float(value) if is_number else None  # type: ignore[arg-type]
