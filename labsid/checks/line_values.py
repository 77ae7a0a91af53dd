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
from labsid.checks.syntax_trees import is_deep, last_name

MOST_PARTS = 60
_MOST_ITEMS, _MOST_KEYS = 8, 12
_RESULTS = ("EigResult", "EighResult", "SVDResult", "QRResult", "SlogdetResult")
"""The tuples that `np.linalg` returns."""
_RESULT = "OptimizeResult"
"""The dictionary of results that scipy's searches return."""
_LONGEST_LINE, _MOST_LEVELS = 2_000, 40  # characters, and levels of the tree, of a line that is explained
_READ, _LOAD = (ast.Name, ast.Attribute, ast.Subscript, ast.BinOp, ast.Call, ast.UnaryOp, ast.List), ast.Load()
_REDUCED = ("mean", "sum", "std", "var", "max", "min")
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
    is_whole : bool
        Whether it is a whole number.
    """

    kind: str
    shape: tuple[int, ...] | None = None
    value: int | None = None
    keys: tuple[str, ...] = ()
    lengths: tuple[int, ...] = ()
    is_whole: bool = False

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


def things_in(line: str, names: Mapping[str, Any], is_inner: bool = False) -> dict[str, Thing]:
    """What the expressions in a line of code are, by their texts.

    Parameters
    ----------
    line : str
    names : mapping
    is_inner : bool
        Whether the names are those within a lambda or a comprehension; otherwise the names that these bind stand for
        nothing yet.
    """
    tree = parsed_line(line)
    if tree is not None and not is_inner:
        bound = _bound_within(tree)
        names = {name: value for name, value in names.items() if name not in bound}
    found: dict[str, Thing] = {}
    for node in [] if tree is None else list(ast.walk(tree))[:MOST_PARTS]:
        if isinstance(node, _READ) and isinstance(getattr(node, "ctx", _LOAD), ast.Load):
            thing = _as_thing(_read(node, names))
            if thing is not None:
                found[ast.unparse(node)] = thing
    return found


def _bound_within(tree: ast.AST) -> set[str]:
    """The names that the lambdas and the comprehensions of a line bind."""
    nodes = list(ast.walk(tree))
    arguments = {one.arg for node in nodes if isinstance(node, ast.Lambda) for one in node.args.args}
    targets = [node.target for node in nodes if isinstance(node, ast.comprehension)]
    return arguments | {one.id for target in targets for one in ast.walk(target) if isinstance(one, ast.Name)}


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
    if type(value) in (list, tuple) or (isinstance(value, tuple) and type(value).__name__ in _RESULTS):
        items = tuple(list.__iter__(value) if isinstance(value, list) else tuple.__iter__(value))
        arrays = items[:_MOST_ITEMS] if items and all(type(one) is np.ndarray and one.ndim for one in items) else ()
        kind = "list" if isinstance(value, list) else "tuple"
        return Thing(kind, (len(items),), lengths=tuple(len(one) for one in arrays))
    if type(value) is dict or (isinstance(value, dict) and type(value).__name__ == _RESULT):
        return Thing("dictionary", keys=tuple(key for key in dict.keys(value) if type(key) is str)[:_MOST_KEYS])
    if isinstance(value, FunctionType):
        return Thing("function", keys=value.__code__.co_varnames[: value.__code__.co_argcount])
    if value is None:
        return Thing("nothing")
    if isinstance(value, bool | np.bool_):
        return Thing("number")
    if isinstance(value, int | np.integer):
        return Thing("number", value=int(value), is_whole=True)
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
        if node.attr == "newaxis":
            return None
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
        if isinstance(owner, _Shaped):
            return _Shaped(np.shape(np.broadcast_to(0.0, owner.shape)[_index(node.slice, names)]))
        raise _Unknown
    if isinstance(node, ast.List):
        return [_as_array(_value(one, names)) for one in node.elts]
    if isinstance(node, ast.Tuple):
        return tuple(_value(one, names) for one in node.elts)
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
    one, other = _shape(left), _shape(right)
    if isinstance(node.op, ast.MatMult):
        return _Shaped(_product(one, other))
    if isinstance(node.op, _ARITHMETIC):
        return _Shaped(np.broadcast_shapes(one, other))
    raise _Unknown


def _product(one: tuple[int, ...], other: tuple[int, ...]) -> tuple[int, ...]:
    if not 1 <= len(one) <= 2 or not 1 <= len(other) <= 2 or one[-1] != other[0]:
        raise _Unknown
    return (*one[:-1], *other[1:])


def _called(node: ast.Call, names: Mapping[str, Any]) -> Any:
    """The results of the few functions whose shapes follow from their arguments."""
    called = last_name(node.func)
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
        sizes = {_shape(one) for one in listed[:_MOST_ITEMS]} if type(listed) is list else set()
        return _Shaped((len(listed), *sizes.pop()) if len(sizes) == 1 else _shape(listed))
    if called in ("zeros", "ones", "eye") and len(node.args) == 1:
        given = _value(node.args[0], names)
        made = (given, given)[: 1 + (called == "eye")] if type(given) is int else given
        if type(made) is tuple and all(type(size) is int for size in made):
            return _Shaped(made)
    if called in ("transpose", "pinv") and node.args:
        return _Shaped(_shape(_value(node.args[0], names))[::-1])
    if called in ("dot", "matmul", "outer") and len(node.args) == 2:
        one, other = (_shape(_value(part, names)) for part in node.args)
        return _Shaped((*one, *other) if called == "outer" else _product(one, other))
    if called == "diag" and len(node.args) == 1:
        shape = _shape(_value(node.args[0], names))
        return _Shaped((shape[0], shape[0]) if len(shape) == 1 else (min(shape),))
    if called in _REDUCED:
        return _Shaped(_reduced(node, names))
    if called == "lfilter" and len(node.args) == 3:
        return _Shaped(_shape(_value(node.args[2], names)))
    if called in ("inv", "solve") and node.args:
        matrix = _shape(_value(node.args[0], names))
        if len(matrix) != 2 or matrix[0] != matrix[1]:
            raise _Unknown
        right = matrix if called == "inv" else _shape(_value(node.args[1], names))
        _product(matrix, right)
        return _Shaped(right)
    if called in ("abs", "sqrt", "exp", "log", "sin", "cos") and len(node.args) == 1:
        return _Shaped(_shape(_value(node.args[0], names)))
    raise _Unknown


def _reduced(node: ast.Call, names: Mapping[str, Any]) -> tuple[int, ...]:
    """The shape of a mean, a sum or the like along one axis of a table."""
    is_method = not node.args
    owner = node.func.value if is_method and isinstance(node.func, ast.Attribute) else node.args[0]
    axes = (one.value.value for one in node.keywords if one.arg == "axis" and isinstance(one.value, ast.Constant))
    axis = next((0 if one == 0 else 1 for one in axes if one in (0, 1)), None)
    shape = _shape(_value(owner, names))
    if len(shape) != 2 or axis is None or len(node.keywords) > 1 or len(node.args) > 1:
        raise _Unknown
    return (shape[1 - axis],)


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
