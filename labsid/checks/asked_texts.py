"""Texts that questions ask for, and those that stand in a line without their quotes."""

import ast
import re
from collections.abc import Mapping

from labsid.checks.line_values import parsed_line
from labsid.checks.stops import Stop

KINDS = ("positive definite", "positive semidefinite", "negative definite", "negative semidefinite", "indefinite")
"""Of a matrix, in *Least squares*."""
LAYOUTS = ("unique", "mirror", "undetermined")
"""Of beacons, in *Nonlinear least squares*."""

_EFFECTS = (
    "input-delay", "input-saturation", "input-dead-zone", "input-nonlinearity", "sqrt-outflow", "overflow",
    "output-saturation", "output-nonlinearity",
)  # fmt: skip
OF_VARIABLES: Mapping[str, tuple[str, ...]] = {"effect": _EFFECTS, "path": ("input", "dynamics", "output")}
"""The texts that a variable of this name is to hold. (Graded code may not import the table of the effects.)"""
_RETURNED = (*KINDS, "mirror", "undetermined")
"""The texts that functions are to return, but for "unique": other questions' functions may mean a variable by it."""

_ASSIGNED = re.compile(r"(?:^(?P<name>\w+)\s*=|\breturn\b)\s*(?P<text>[A-Za-z_][\w -]*?)\s*;?$")
_BEGINNING = re.compile(r"(?:(?P<name>\w+)\s*=(?!=)|return\b)")


def text_without_quotes(line: str, unknown: str = "") -> str:
    """The text that a question asks for and that stands in a line as names; empty if none does.

    Parameters
    ----------
    line : str
    unknown : str
        A name in it that is not defined; empty where Python cannot read the line.
    """
    whole = _ASSIGNED.search(line)
    if whole is not None:
        alike = _alike(whole["text"], _texts(whole["name"]))
        if alike:
            return alike
    begun = _BEGINNING.match(line)
    return "" if begun is None or not unknown else _alike(unknown, _texts(begun["name"]))


def key_without_quotes(name: str, stop: Stop) -> str:
    """Where a name that is not defined stands as a key of a dictionary, in a sentence; empty if it does not."""
    tree = parsed_line(stop.line)
    for node in [] if tree is None else ast.walk(tree):
        if isinstance(node, ast.Dict) and any(isinstance(key, ast.Name) and key.id == name for key in node.keys):
            return f'It is a key of the dictionary: a key that is a text stands in quotes, `{{"{name}": ...}}`.'
        if isinstance(node, ast.Subscript) and isinstance(node.slice, ast.Name) and node.slice.id == name:
            owner = ast.unparse(node.value)
            thing = stop.things.get(owner)
            if thing is not None and name in thing.keys:
                return f'`{owner}` has it as a key: a key that is a text stands in quotes, `{owner}["{name}"]`.'
    return ""


def _texts(name: str | None) -> tuple[str, ...]:
    return _RETURNED if name is None else OF_VARIABLES.get(name, ())


def _alike(written: str, texts: tuple[str, ...]) -> str:
    return next((text for text in texts if _words(text) == _words(written)), "")


def _words(text: str) -> list[str]:
    return re.split(r"[\s_-]+", text.strip().lower())
