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
_SEVERAL = re.compile(r"\b(\w+)\s*=\s*([A-Za-z_]\w*(?:\s*,\s*[A-Za-z_]\w*)+)(?=\s*,\s*\w+\s*=|\s*\))")
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


def column_without_quotes(name: str, stop: Stop) -> str:
    """That a name that is not defined stands where `load_record` takes texts, in a sentence; empty if it does not."""
    tree = parsed_line(stop.line)
    for node in [] if tree is None else ast.walk(tree):
        if isinstance(node, ast.Call) and ast.unparse(node.func).endswith("load_record"):
            for handed in (*node.args, *(one.value for one in node.keywords)):
                if any(isinstance(part, ast.Name) and part.id == name for part in ast.walk(handed)):
                    names = re.sub(r"[^\w,.]", "", ast.unparse(handed))
                    return f'`load_record` takes the names of files and columns as texts, in quotes: `"{names}"`.'
    return ""


def columns_without_quotes(stop: Stop) -> str:
    """Several names after a keyword of a call that Python cannot read, in a sentence; empty if there are none."""
    several = _SEVERAL.search(stop.line)
    if several is None or "positional argument follows keyword" not in stop.text:
        return ""
    keyword, names = several.groups()
    joined = re.sub(r"\s", "", names)
    if "load_record" in stop.line:
        return f'`{keyword}` takes the names of its columns as one text, in quotes: `{keyword}="{joined}"`.'
    return (
        f"`{several[0]}`: the comma ends the argument `{keyword}`, and after an argument with a name each needs one. "
        f"Several values of one argument stand in a list: `{keyword}=[{names}]`."
    )


def _texts(name: str | None) -> tuple[str, ...]:
    return _RETURNED if name is None else OF_VARIABLES.get(name, ())


def _alike(written: str, texts: tuple[str, ...]) -> str:
    return next((text for text in texts if _words(text) == _words(written)), "")


def _words(text: str) -> list[str]:
    return re.split(r"[\s_-]+", text.strip().lower())
