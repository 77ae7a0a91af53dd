"""Python names, constants and arguments in JavaScript."""

import inspect
import math
from typing import Any

import numpy as np

_RESERVED = {
    "case",
    "const",
    "default",
    "delete",
    "function",
    "in",
    "let",
    "new",
    "np",
    "switch",
    "this",
    "var",
    "void",
}


class UnsupportedSourceError(ValueError):
    """A part of the source that has no translation."""


def safe_name(name: str) -> str:
    """A Python name as a JavaScript one."""
    return f"{name}$" if name in _RESERVED else name


def literal(value: Any) -> str:
    """A constant in JavaScript."""
    match value:
        case None:
            return "null"
        case bool():
            return str(value).lower()
        case str():
            return '"' + value.encode("unicode_escape").decode("ascii").replace('"', '\\"') + '"'
        case float() if math.isinf(value):
            return "Infinity" if value > 0.0 else "(-Infinity)"
        case int() | float():
            return repr(float(value)).removesuffix(".0") if isinstance(value, float) else repr(value)
        case np.ndarray():
            flat = ",".join(literal(float(one)) for one in value.ravel())
            return f"np.array([{flat}], {list(value.shape)})"
        case tuple() | list():
            return f"[{', '.join(literal(one) for one in value)}]"
    raise UnsupportedSourceError(f"a constant {value!r} has no translation")


def placed(function: Any, arguments: list[str], keywords: dict[str, str]) -> list[str]:
    """All arguments of a call by position."""
    if not keywords:
        return arguments
    parameters = list(inspect.signature(getattr(function, "py_func", function)).parameters)[len(arguments) :]
    last = max(parameters.index(name) for name in keywords)
    return [*arguments, *(keywords.get(name, "undefined") for name in parameters[: last + 1])]
