"""JavaScript of functions of this package, with everything that they call."""

import ast
import inspect
import textwrap
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from labsid._arrays import beside
from labsid.gap.dynamics import responses
from labsid.gap.reports.javascript.names import UnsupportedSourceError, literal
from labsid.gap.reports.javascript.statements import Statements

TEMPLATES = Path(__file__).parent / "templates"
_WRITTEN = {beside: "np.column_stack", responses._equilibrium: "np.equilibrium"}  # in templates/arrays.js


class Library:
    """Translated functions and constants, each once; `responses.response` calls only the `kinds` of dynamics given."""

    def __init__(self, kinds: Iterable[str]) -> None:
        self.kinds = set(kinds)
        self._functions: dict[str, str] = {}
        self._constants: dict[str, str] = {}

    def __str__(self) -> str:
        constants = (f"const {name} = {text};" for text, name in self._constants.items())
        return "\n".join([*constants, *self._functions.values()])

    def name(self, value: Any, member: str = "") -> str:
        """Name in JavaScript of a function, of the `member` of a class, or of a constant; translated if it is new."""
        if not member and callable(value) and value in _WRITTEN:
            return _WRITTEN[value]
        owner = value if member else None
        function = inspect.getattr_static(value, member) if member else value
        function = getattr(function, "fget", None) or getattr(function, "py_func", function)
        if not callable(function):
            return self._constant(value)
        place = value if member else function
        name = "_".join(
            [*place.__module__.split(".")[-1:], place.__qualname__.replace(".", "_"), *filter(None, [member])]
        )
        if name not in self._functions:
            self._functions[name] = ""  # now known, for functions that call themselves
            self._functions[name] = self._translated(name, function, owner, hasattr(value, "py_func"))
        return name

    def _translated(self, name: str, function: Any, owner: type | None, compiled: bool) -> str:
        (node,) = ast.parse(textwrap.dedent(inspect.getsource(function))).body
        if not isinstance(node, ast.FunctionDef):
            raise UnsupportedSourceError(f"{name} is no function")
        namespace = dict(function.__globals__)
        if "_KINDS" in namespace:
            namespace["_KINDS"] = {kind: own for kind, own in namespace["_KINDS"].items() if kind in self.kinds}
        return Statements(node, namespace, self.name, owner, compiled).function(name)

    def _constant(self, value: Any) -> str:
        """A table of functions, or a constant that is no plain number."""
        if isinstance(value, dict):
            return "({" + ", ".join(f"{key}: {self.name(function)}" for key, function in value.items()) + "})"
        return self._constants.setdefault(literal(_plain(value)), f"CONSTANT_{len(self._constants)}")


def _plain(value: Any) -> Any:
    """A constant without its objects, of which only the number is used."""
    if isinstance(value, tuple | list):
        return [_plain(one) for one in value]
    return None if hasattr(value, "__dataclass_fields__") else value
