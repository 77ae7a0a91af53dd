"""Translate Python expressions over numbers and numpy arrays to JavaScript."""

import ast
import builtins
import inspect
import math
from collections.abc import Callable, Iterable
from types import ModuleType
from typing import Any

from labsid.gap.reports.javascript.names import UnsupportedSourceError, literal, placed, safe_name

_ARITHMETIC = {ast.Add: "add", ast.Sub: "sub", ast.Mult: "mul", ast.Div: "div", ast.Pow: "pow", ast.MatMult: "matmul"}
_SIGNS = {ast.Add: "+", ast.Sub: "-", ast.Mult: "*", ast.Div: "/", ast.Pow: "**"}
_ORDER = {ast.Lt: "<", ast.LtE: "<=", ast.Gt: ">", ast.GtE: ">=", ast.Eq: "===", ast.NotEq: "!=="}
_ORDER_OF_ARRAYS = {"<": "lt", "<=": "le", ">": "gt", ">=": "ge", "===": "eq", "!==": "ne"}
_METHODS = {"get", "copy", "sum", "mean", "max", "min", "partition"}
_OF_LISTS = {"append": "push", "index": "indexOf"}
_BUILTINS = {"float", "int", "len", "range", "zip", "enumerate", "sum", "bool", "list", "tuple"}
_OF_NUMBERS = {"float": "+", "int": "Math.trunc", "min": "Math.min", "max": "Math.max", "abs": "Math.abs"}
_NUMPY_CONSTANTS = {"float64": "null", "inf": "Infinity", "nan": "NaN", "pi": "Math.PI"}
_FIELDS = {"name", "rates"}  # of objects whose class is unknown


class Expressions:
    """Expressions of one function.

    ``refer(function, member)`` gives the name in JavaScript of a function, of a member of a class, or of a constant
    that is no plain number. With `of_numbers` operators act on numbers, as in a compiled loop; otherwise each may act
    on arrays, and the functions of ``templates/arrays.js`` decide.
    """

    def __init__(
        self,
        node: ast.FunctionDef,
        namespace: dict[str, Any],
        refer: Callable[[Any, str], str],
        owner: type | None,
        of_numbers: bool,
    ) -> None:
        self.node, self.namespace, self.refer, self.of_numbers = node, namespace, refer, of_numbers
        self.classes: dict[str, type] = {} if owner is None else {"self": owner}
        for argument in node.args.args:
            stated = namespace.get(argument.annotation.id) if isinstance(argument.annotation, ast.Name) else None
            if isinstance(stated, type) and stated.__module__.startswith("labsid."):
                self.classes[argument.arg] = stated
        self.local = {one.arg for one in node.args.args} | set(stored_names([node]))
        self.arrays = {one.arg for one in node.args.args if "FloatArray" in ast.unparse(one.annotation or one)}
        for one in ast.walk(node):
            if isinstance(one, ast.Assign) and _makes_arrays(one.value):
                self.arrays |= set(stored_names(one.targets))

    def unsupported(self, node: ast.AST, what: str) -> UnsupportedSourceError:
        """The error for a part without translation."""
        text = (
            f"line {getattr(node, 'lineno', '?')} of {self.node.name}: {what} has no translation: {ast.unparse(node)}"
        )
        return UnsupportedSourceError(text)

    def expression(self, node: ast.expr) -> str:
        """One expression."""
        match node:
            case ast.Constant(value=value):
                return literal(value)
            case ast.Name():
                return self._name(node)
            case ast.BinOp(left=left, op=op, right=right):
                return self.arithmetic(op, left, right, node)
            case ast.UnaryOp(op=ast.USub(), operand=operand):
                inner = self.expression(operand)
                return f"(-{inner})" if self._is_number(operand) else f"np.neg({inner})"
            case ast.UnaryOp(op=ast.Not(), operand=operand):
                return f"!({self.expression(operand)})"
            case ast.BoolOp(op=op, values=values):
                sign = " && " if isinstance(op, ast.And) else " || "
                return f"({sign.join(self.expression(one) for one in values)})"
            case ast.Compare():
                return self._comparison(node)
            case ast.IfExp(test=test, body=body, orelse=orelse):
                return f"({self.expression(test)} ? {self.expression(body)} : {self.expression(orelse)})"
            case ast.Tuple(elts=elements) | ast.List(elts=elements):
                return f"[{', '.join(self.expression(one) for one in elements)}]"
            case ast.Starred(value=value):
                return f"...{self.expression(value)}"
            case ast.JoinedStr(values=values):
                return "`" + "".join(self._part(one) for one in values) + "`"
            case ast.GeneratorExp() | ast.ListComp():
                return self._mapped(node.generators, self.expression(node.elt))
            case ast.DictComp():
                pair = f"[{self.expression(node.key)}, {self.expression(node.value)}]"
                return f"Object.fromEntries({self._mapped(node.generators, pair)})"
            case ast.Subscript(value=value, slice=index):
                return self.element(value, index) or f"np.take({self.expression(value)}, {self.indices(index)})"
            case ast.Attribute():
                return self._attribute(node)
            case ast.Call():
                return self._call(node)
        raise self.unsupported(node, type(node).__name__)

    def arithmetic(self, op: ast.operator, left: ast.expr, right: ast.expr, node: ast.AST) -> str:
        """The result of an operator, of numbers or of arrays."""
        a, b = self.expression(left), self.expression(right)
        if self._is_number(left) and self._is_number(right) and type(op) in _SIGNS:
            return f"({a} {_SIGNS[type(op)]} {b})"
        if type(op) not in _ARITHMETIC:
            raise self.unsupported(node, f"the operator {type(op).__name__}")
        return f"np.{_ARITHMETIC[type(op)]}({a}, {b})"

    def element(self, value: ast.expr, index: ast.expr) -> str | None:
        """One element of an array of a compiled loop, or the value of a key; None for anything else."""
        if isinstance(index, ast.JoinedStr) or (isinstance(index, ast.Constant) and isinstance(index.value, str)):
            return f"{self.expression(value)}[{self.expression(index)}]"
        if not self.of_numbers or any(isinstance(one, ast.Slice) for one in ast.walk(index)):
            return None
        base = self.expression(value)
        if isinstance(index, ast.Tuple):
            if len(index.elts) != 2:
                raise self.unsupported(index, "an array of more than two dimensions")
            row, column = (self.expression(one) for one in index.elts)
            return f"{base}[{row} * {base}.cols + {column}]"
        if isinstance(index, ast.UnaryOp):
            return f"{base}[{base}.length - {self.expression(index.operand)}]"
        return f"{base}[{self.expression(index)}]"

    def indices(self, index: ast.expr) -> str:
        """The indices of a part of an array, by dimension."""
        parts = index.elts if isinstance(index, ast.Tuple) else [index]
        return "[" + ", ".join(self._index(one) for one in parts) + "]"

    def _index(self, node: ast.expr) -> str:
        if not isinstance(node, ast.Slice):
            return self.expression(node)
        if node.step is not None:
            raise self.unsupported(node, "a slice with a step")
        ends = ("undefined" if end is None else self.expression(end) for end in (node.lower, node.upper))
        return f"np.slice({', '.join(ends)})"

    def _is_number(self, node: ast.expr) -> bool:
        """Whether an operand is known to be a number."""
        if isinstance(node, ast.Constant):
            return isinstance(node.value, int | float)
        if not self.of_numbers:
            return False
        if isinstance(node, ast.Name):
            return node.id not in self.arrays
        if isinstance(node, ast.Attribute):
            return node.attr != "T"
        operands = [one for one in ast.iter_child_nodes(node) if isinstance(one, ast.expr)]
        return isinstance(node, ast.Subscript | ast.Call) or all(self._is_number(one) for one in operands)

    def _name(self, node: ast.Name) -> str:
        if node.id in self.local:
            return safe_name(node.id)
        return self._value(self._global(node), node)

    def _global(self, node: ast.Name) -> Any:
        """The value of a name of the module."""
        if node.id in self.namespace:
            return self.namespace[node.id]
        if hasattr(builtins, node.id):
            return getattr(builtins, node.id)
        raise self.unsupported(node, "this name")

    def _value(self, value: Any, node: ast.AST) -> str:
        """A constant or function of a module."""
        if value is None or isinstance(value, bool | int | float | str):
            return literal(value)
        if isinstance(value, type | ModuleType):
            raise self.unsupported(node, "a class or module as a value")
        return self.refer(value, "")

    def _part(self, node: ast.expr) -> str:
        match node:
            case ast.Constant(value=str() as text):
                return text
            case ast.FormattedValue(value=value, format_spec=None):
                return "${" + self.expression(value) + "}"
        raise self.unsupported(node, "this format")

    def _comparison(self, node: ast.Compare) -> str:
        values = [node.left, *node.comparators]
        parts = []
        for left, op, right in zip(values, node.ops, values[1:], strict=False):
            a, b = self.expression(left), self.expression(right)
            if isinstance(op, ast.Is | ast.IsNot):
                parts.append(f"{a} {'===' if isinstance(op, ast.Is) else '!=='} {b}")
            elif isinstance(op, ast.In):
                parts.append(f"np.has({b}, {a})")
            elif type(op) not in _ORDER:
                raise self.unsupported(node, f"the comparison {type(op).__name__}")
            elif self.of_numbers:
                parts.append(f"{a} {_ORDER[type(op)]} {b}")
            else:
                parts.append(f"np.{_ORDER_OF_ARRAYS[_ORDER[type(op)]]}({a}, {b})")
        return f"({' && '.join(parts)})"

    def _mapped(self, generators: list[ast.comprehension], each: str) -> str:
        (generator,) = generators
        target = self.expression(generator.target)
        kept = "".join(f".filter(({target}) => {self.expression(test)})" for test in generator.ifs)
        return f"[...{self.expression(generator.iter)}]{kept}.map(({target}) => {each})"

    def _attribute(self, node: ast.Attribute) -> str:
        resolved = self._resolved(node)
        if resolved is not None:
            return self._value(resolved, node)
        if node.attr in _NUMPY_CONSTANTS and isinstance(node.value, ast.Name) and node.value.id in ("np", "math"):
            return _NUMPY_CONSTANTS[node.attr]
        owner = self._class_of(node.value)
        base = self.expression(node.value)
        if owner is not None:
            member = inspect.getattr_static(owner, node.attr, None)
            if isinstance(member, property):
                return f"{self.refer(owner, node.attr)}({base})"
            if isinstance(member, bool | int | float | str) and node.attr not in _data_fields(owner):
                return literal(member)
            return f"{base}.{node.attr}"
        match node.attr:
            case "size":
                return f"{base}.length"
            case "shape":
                return f"np.shape({base})"
            case "T":
                return f"np.transpose({base})"
        if node.attr in _FIELDS:
            return f"{base}.{node.attr}"
        raise self.unsupported(node, "this attribute")

    def _class_of(self, node: ast.expr) -> type | None:
        return self.classes.get(node.id) if isinstance(node, ast.Name) else None

    def _resolved(self, node: ast.Attribute) -> Any:
        """The value of a name of another module of this project; None for anything else."""
        if not isinstance(node.value, ast.Name) or node.value.id in self.local:
            return None
        module = self._global(node.value)
        return getattr(module, node.attr) if isinstance(module, ModuleType) and _is_own(module) else None

    def _call(self, node: ast.Call) -> str:
        arguments = [self.expression(one) for one in node.args]
        keywords = {one.arg: self.expression(one.value) for one in node.keywords if one.arg and one.arg != "strict"}
        named = [f"{{{', '.join(f'{key}: {value}' for key, value in keywords.items())}}}"] if keywords else []
        function = node.func
        if isinstance(function, ast.Attribute):
            owner, resolved = self._class_of(function.value), self._resolved(function)
            if resolved is not None:
                return f"{self.refer(resolved, '')}({', '.join(placed(resolved, arguments, keywords))})"
            if owner is not None and callable(getattr(owner, function.attr, None)):
                base = self.expression(function.value)
                return f"{self.refer(owner, function.attr)}({', '.join([base, *arguments])})"
            if isinstance(function.value, ast.Name) and function.value.id in ("np", "math"):
                plain = function.value.id == "math" and hasattr(math, function.attr) and function.attr != "copysign"
                return f"{'Math' if plain else 'np'}.{function.attr}({', '.join([*arguments, *named])})"
            if function.attr in _OF_LISTS:
                return f"{self.expression(function.value)}.{_OF_LISTS[function.attr]}({', '.join(arguments)})"
            if function.attr in _METHODS:
                return f"np.{function.attr}({', '.join([self.expression(function.value), *arguments, *named])})"
        elif isinstance(function, ast.Name) and function.id not in self.local:
            called = self._global(function)
            if called in (float, int, min, max, abs) and self.of_numbers:
                return f"{_OF_NUMBERS[function.id]}({', '.join(arguments)})"
            if function.id in _BUILTINS or called in (min, max, abs):
                return f"np.{function.id}({', '.join([*arguments, *named])})"
            if str(getattr(called, "__module__", "")).startswith("numpy"):
                return f"np.{function.id}({', '.join([*arguments, *named])})"
            return f"{self.refer(called, '')}({', '.join(placed(called, arguments, keywords))})"
        elif isinstance(function, ast.Subscript):  # of a table of functions
            return f"{self.expression(function.value)}[{self.expression(function.slice)}]({', '.join(arguments)})"
        raise self.unsupported(node, "this call")


def _is_own(module: ModuleType) -> bool:
    return module.__name__.startswith("labsid.")


def _data_fields(owner: type) -> set[str]:
    return set(getattr(owner, "__dataclass_fields__", {}))


def _makes_arrays(node: ast.expr) -> bool:
    """Whether an expression is a new array, or several."""
    elements = node.elts if isinstance(node, ast.Tuple) else [node]
    return all(
        isinstance(one, ast.Call)
        and isinstance(one.func, ast.Attribute)
        and one.func.attr in ("zeros", "empty", "ones", "full")
        for one in elements
    )


def stored_names(nodes: Iterable[ast.AST]) -> list[str]:
    """Names that parts of the source assign, each time that they do."""
    named = [one for node in nodes for one in ast.walk(node) if isinstance(one, ast.Name)]
    return [one.id for one in named if isinstance(one.ctx, ast.Store)]
