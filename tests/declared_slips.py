"""The names of the known mistakes that the checks can give, as they stand in their source."""

import ast
from collections.abc import Iterator
from pathlib import Path

import labsid.checks

CHECKS = Path(labsid.checks.__file__).parent
SHARED = "shared"
_PLACE = {"Slip": 0, "Verdict": 2, "NoAnswer": 1, "told_if_singular": 1}
"""Where a call holds the name."""
_OF_PYTHON = ("error_table.py", "matlab_syntax.py")
"""Their tables hold patterns; their slip is `PYTHON_ERROR`."""


def declared_slips() -> dict[str, dict[str, str]]:
    """Where each name stands, for each assignment's folder and for the modules that all share."""
    found: dict[str, dict[str, str]] = {}
    for path in sorted(CHECKS.rglob("*.py")):
        file = path.relative_to(CHECKS)
        if file.name in _OF_PYTHON:
            continue
        folder = file.parts[1] if file.parts[0] == "assignments" else SHARED
        for node in ast.walk(ast.parse(path.read_text())):
            for name in _names(node):
                found.setdefault(folder, {})[name] = f"{file}:{node.lineno}"  # type: ignore[attr-defined]
    return found


def _names(node: ast.AST) -> Iterator[str]:
    """The names that a call gives, and those of tables and helpers: a short text beside a sentence."""
    if isinstance(node, ast.Call) and isinstance(node.func, ast.Name):
        if node.func.id in _PLACE:
            place = _PLACE[node.func.id]
            named = [word.value for word in node.keywords if word.arg in ("slip", "name")]
            yield from _texts([*node.args[place : place + 1], *named])
        elif len(node.args) > 1 and _is_sentence(node.args[1]):
            yield from _texts(node.args[:1])
    elif isinstance(node, ast.Tuple) and any(map(_is_sentence, node.elts)):
        yield from [text for text in _texts(node.elts) if text and text[-1] != "."][:1]


def _texts(nodes: list[ast.expr]) -> Iterator[str]:
    for node in nodes:
        for one in (node.body, node.orelse) if isinstance(node, ast.IfExp) else (node,):
            if isinstance(one, ast.Constant) and isinstance(one.value, str):
                yield one.value


def _is_sentence(node: ast.expr) -> bool:
    parts = node.values if isinstance(node, ast.JoinedStr) else [node]
    last = parts[-1]
    return isinstance(last, ast.Constant) and isinstance(last.value, str) and last.value.endswith(".")
