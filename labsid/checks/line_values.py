"""What the names and the expressions in a line of code are, read without running any of it.

Names are looked up, and shapes of products and slices are computed from the shapes of their parts.
"""

import ast
from collections.abc import Mapping
from dataclasses import dataclass
from types import FunctionType, ModuleType
from typing import Any

import numpy as np

from labsid.checks.cell_names import parse_python
from labsid.checks.syntax_trees import is_deep

MOST_PARTS = 60
_MOST_ITEMS, _MOST_KEYS = 8, 12
_RESULT = "OptimizeResult"
"""The dictionary of results that scipy's searches return."""
_LONGEST_LINE, _MOST_LEVELS = 2_000, 40  # characters, and levels of the tree, of a line that is explained
_READ, _LOAD = (ast.Name, ast.Attribute, ast.Subscript, ast.BinOp, ast.Call, ast.UnaryOp, ast.List), ast.Load()
_ARITHMETIC = (ast.Add, ast.Sub, ast.Mult, ast.Div, ast.FloorDiv, ast.Mod, ast.Pow)


@dataclass(frozen=True, slots=True)
class Thing:
    """What a name or an expression is.

    Attributes
    ----------
    kind : str
        "array", "list", "tuple", "number", "text", "dictionary", "function", "module", "nothing" or "object".
    shape : tuple of int, optional
        Of an array; of a list or a tuple its length.
    value : int, optional
        Of a whole number.
    keys : tuple of str
        Of a dictionary or a result of scipy; of a function the names of its arguments.
    lengths : tuple of int
        Of a list of arrays: how many rows each has.
    """

    kind: str
    shape: tuple[int, ...] | None = None
    value: int | None = None
    keys: tuple[str, ...] = ()
    lengths: tuple[int, ...] = ()

    @property
    def said(self) -> str:
        """In words, after the name."""
        if self.kind == "array":
            return f"has shape {self.shape}" if self.shape else "is one number"
        if self.lengths:
            return f"is a {self.kind} of arrays with {', '.join(map(str, self.lengths))} rows"
        if self.kind in ("list", "tuple"):
            return f"is a {self.kind} of {self.shape[0] if self.shape else 0}"
        if self.kind == "number" and self.value is not None:
            return f"is {self.value}"
        return f"is {self.kind}" if self.kind == "nothing" else f"is a {self.kind}"


def things_in(line: str, names: Mapping[str, Any]) -> dict[str, Thing]:
    """What the expressions in a line of code are, by their texts."""
    tree = parsed_line(line)
    found: dict[str, Thing] = {}
    for node in [] if tree is None else list(ast.walk(tree))[:MOST_PARTS]:
        if isinstance(node, _READ) and isinstance(getattr(node, "ctx", _LOAD), ast.Load):
            thing = _as_thing(_read(node, names))
            if thing is not None:
                found[ast.unparse(node)] = thing
    return found


def shape_of(node: ast.AST, shapes: Mapping[str, tuple[int, ...]]) -> tuple[int, ...] | None:
    """Shape of an expression whose names are arrays of these shapes; None if it does not follow from them."""
    value = _read(node, {name: _Shaped(shape) for name, shape in shapes.items()})
    return value.shape if isinstance(value, _Shaped) else None


class _Shaped:
    """An array of which only the shape is known."""

    def __init__(self, shape: tuple[int, ...]) -> None:
        self.shape = shape


class _Unknown(Exception):
    """What an expression is cannot be told without running it."""


def _as_thing(value: Any) -> Thing | None:
    if value is _Unknown:
        return None
    if isinstance(value, _Shaped | np.ndarray):
        return Thing("array", _shape(value))
    if type(value) in (list, tuple):
        arrays = (
            value[:_MOST_ITEMS] if value and all(type(array) is np.ndarray and array.ndim for array in value) else ()
        )
        return Thing(type(value).__name__, (len(value),), lengths=tuple(len(array) for array in arrays))
    if type(value) is dict or (isinstance(value, dict) and type(value).__name__ == _RESULT):
        return Thing("dictionary", keys=tuple(key for key in dict.keys(value) if type(key) is str)[:_MOST_KEYS])
    if isinstance(value, FunctionType):
        return Thing("function", keys=value.__code__.co_varnames[: value.__code__.co_argcount])
    if value is None:
        return Thing("nothing")
    if isinstance(value, bool | np.bool_):
        return Thing("number")
    if isinstance(value, int | np.integer):
        return Thing("number", value=int(value))
    if isinstance(value, float | complex | np.number):
        return Thing("number")
    if isinstance(value, str):
        return Thing("text")
    if isinstance(value, ModuleType):
        return Thing("module")
    return Thing("function" if callable(value) else "object")


def _read(node: ast.AST, names: Mapping[str, Any]) -> Any:
    try:
        return _value(node, names)
    except (_Unknown, KeyError, IndexError, TypeError, ValueError, AttributeError, ArithmeticError, RecursionError):
        return _Unknown


def _value(node: ast.AST | None, names: Mapping[str, Any]) -> Any:
    if isinstance(node, ast.Constant):
        return node.value
    if isinstance(node, ast.Name):
        return names[node.id]
    if isinstance(node, ast.Attribute):
        if node.attr == "T":
            return _Shaped(_shape(_value(node.value, names))[::-1])
        if node.attr == "shape":
            return _shape(_value(node.value, names))
        owner = _value(node.value, names)
        if isinstance(owner, ModuleType) and owner.__name__.partition(".")[0] in ("numpy", "scipy"):
            return vars(owner)[node.attr]
        raise _Unknown
    if isinstance(node, ast.UnaryOp):
        inside = _value(node.operand, names)
        return -inside if isinstance(node.op, ast.USub) and type(inside) in (int, float) else _Shaped(_shape(inside))
    if isinstance(node, ast.Subscript):
        owner = _value(node.value, names)
        if type(owner) in (dict, list, tuple, np.ndarray):
            return owner[_index(node.slice, names)]
        raise _Unknown
    if isinstance(node, ast.List):
        return [_as_array(_value(element, names)) for element in node.elts]
    if isinstance(node, ast.Tuple):
        return tuple(_value(element, names) for element in node.elts)
    if isinstance(node, ast.BinOp):
        return _operation(node, _value(node.left, names), _value(node.right, names))
    if isinstance(node, ast.Call):
        return _called(node, names)
    raise _Unknown


def _index(node: ast.expr, names: Mapping[str, Any]) -> Any:
    if isinstance(node, ast.Slice):
        bounds = (None if part is None else _value(part, names) for part in (node.lower, node.upper, node.step))
        return slice(*bounds)
    if isinstance(node, ast.Tuple):
        return tuple(_index(part, names) for part in node.elts)
    index = _value(node, names)
    if index is None or type(index) in (int, str) or isinstance(index, np.integer):
        return index
    raise _Unknown


def _operation(node: ast.BinOp, left: Any, right: Any) -> Any:
    if type(left) is int and type(right) is int and isinstance(node.op, ast.Add | ast.Sub | ast.Mult | ast.FloorDiv):
        if isinstance(node.op, ast.Add):
            return left + right
        if isinstance(node.op, ast.Sub):
            return left - right
        return left * right if isinstance(node.op, ast.Mult) else left // right
    left_shape, right_shape = _shape(left), _shape(right)
    if isinstance(node.op, ast.MatMult):
        return _Shaped(_product(left_shape, right_shape))
    if isinstance(node.op, _ARITHMETIC):
        return _Shaped(np.broadcast_shapes(left_shape, right_shape))
    raise _Unknown


def _product(one: tuple[int, ...], other: tuple[int, ...]) -> tuple[int, ...]:
    if not 1 <= len(one) <= 2 or not 1 <= len(other) <= 2 or one[-1] != other[0]:
        raise _Unknown
    return (*one[:-1], *other[1:])


def _called(node: ast.Call, names: Mapping[str, Any]) -> Any:
    """The results of the few functions whose shapes follow from their arguments."""
    called = node.func.attr if isinstance(node.func, ast.Attribute) else getattr(node.func, "id", "")
    if called == "len" and len(node.args) == 1:
        return int(_shape(_value(node.args[0], names))[0])
    if called in ("ravel", "flatten"):
        owner = node.args[0] if node.args else node.func.value if isinstance(node.func, ast.Attribute) else None
        return _Shaped((int(np.prod(_shape(_value(owner, names)))),))
    if called in ("concatenate", "hstack") and node.args and isinstance(node.args[0], ast.List | ast.Tuple):
        shapes = [_shape(_value(part, names)) for part in node.args[0].elts]
        if all(len(shape) == 1 for shape in shapes):
            return _Shaped((sum(shape[0] for shape in shapes),))
    if called in ("array", "asarray") and len(node.args) == 1:
        listed = _value(node.args[0], names)
        sizes = {_shape(item) for item in listed[:_MOST_ITEMS]} if type(listed) is list else set()
        return _Shaped((len(listed), *sizes.pop()) if len(sizes) == 1 else _shape(listed))
    if called in ("zeros", "ones", "eye") and len(node.args) == 1:
        given = _value(node.args[0], names)
        made = (given, given)[: 1 + (called == "eye")] if type(given) is int else given
        if type(made) is tuple and all(type(size) is int for size in made):
            return _Shaped(made)
    if called in ("transpose", "pinv") and node.args:
        return _Shaped(_shape(_value(node.args[0], names))[::-1])
    if called in ("inv", "abs", "sqrt", "exp") and len(node.args) == 1:
        return _Shaped(_shape(_value(node.args[0], names)))
    raise _Unknown


def _as_array(value: Any) -> Any:
    """What stands in a list of arrays; of a computed one only the shape counts, so an empty one of it will do."""
    return np.broadcast_to(0.0, value.shape).view(np.ndarray) if isinstance(value, _Shaped) else value


def _shape(value: Any) -> tuple[int, ...]:
    if isinstance(value, _Shaped):
        return value.shape
    if isinstance(value, np.ndarray):
        return tuple(
            map(int, np.ndarray.shape.__get__(value))
        )  # a subclass, such as python-control's, may have its own
    if type(value) in (int, float, complex) or isinstance(value, np.number):
        return ()
    if type(value) is list and all(type(item) in (int, float) for item in value):
        return (len(value),)
    raise _Unknown


def parsed_line(text: str) -> ast.AST | None:
    """The tree of a line; of the head of a compound statement, that of its expression.

    None for one that cannot be parsed, and for one that is too long or too deeply nested to be explained.
    """
    if len(text) > _LONGEST_LINE:
        return None
    for written in (text, f"{text} pass", text.partition(" ")[2].rstrip(":")):
        if written.strip():
            try:
                tree = parse_python(written)
            except (SyntaxError, ValueError, RecursionError, MemoryError):
                continue
            return None if is_deep(tree, _MOST_LEVELS) else tree
    return None
