"""Code that may not be the student's own: that of labsid with other names, and code that is carried as text.

Both are things to look at, without marks. Code equal to that of labsid may have been derived: the same formula is
often written in the same way. So only longer stretches count, which neither the release nor its text gives.
"""

import ast
import hashlib
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import Any

from autograder.course.sources import source_path
from autograder.intake.submission import NotebookCell
from labsid.checks.cell_names import parse_python
from labsid.checks.permitted import without_magic
from labsid.checks.syntax_trees import constant_text

MIN_NODES = 60
"""Stretches of code with fewer syntax tree nodes are not compared."""

MIN_CHARACTERS, MIN_ELEMENTS = 200, 200
"""Less text in a cell, and lists with fewer elements, carry no code."""

MAX_CHARACTERS = 100_000
"""Longer cells are not parsed."""

REFERENCE_ROOMS = ("lab", "least_squares", "model_structures", "estimation", "nonlinear", "gap.effects", "gap.dynamics")
"""The packages of labsid that do the steps of the assignments."""

_UNPACKING = frozenset((
    "exec", "eval", "compile", "__import__", "import_module", "ModuleType", "b64decode", "b85decode", "a85decode",
    "b32decode", "b16decode", "decompress", "unhexlify", "fromhex", "frombuffer", "fromstring", "loads", "bytes",
    "bytearray", "decode", "unpack", "literal_eval", "maketrans", "translate", "exec_module", "run_cell", "chr",
    "to_bytes", "write", "write_text", "writelines",
))  # fmt: skip


_NAME_FIELDS: Mapping[type[ast.AST], str] = {ast.Name: "id", ast.arg: "arg", ast.FunctionDef: "name"}
_WITHOUT = ("annotation", "returns", "ctx", "type_comment", "kind", "type_ignores", "decorator_list")
_END = object()


@dataclass(frozen=True, slots=True)
class Copied:
    """What to look at in the code of one submission.

    Attributes
    ----------
    same_as : mapping
        The function of labsid whose code stands in the answer, by question.
    code_as_text : tuple of str
        The questions before whose check a long literal is decoded, unpacked, executed or imported.
    """

    same_as: Mapping[str, str] = field(default_factory=dict)
    code_as_text: tuple[str, ...] = ()


def find_copied(cells: Sequence[NotebookCell], released: Iterable[str]) -> Copied:
    """Look for code of labsid, and for code that is carried as text, in a student's cells.

    Parameters
    ----------
    cells : sequence of NotebookCell
    released : iterable of str
        Source of the cells of the release, whose code everybody has.
    """
    given = {window for source in released for window in _windows(source)}
    same_as: dict[str, str] = {}
    as_text: list[str] = []
    code: list[str] = []
    for cell in cells:
        if cell.kind in ("answer", "extra") and cell.code:
            code.append(cell.source)
        elif cell.kind in ("question", "tests"):
            name = cell.id or ""
            windows = (window for source in code for window in _windows(source) if window not in given)
            known = next((_reference()[window] for window in windows if window in _reference()), None)
            if known is not None:
                same_as[name] = known
            if any(map(carries_code, code)):
                as_text.append(name)
            code = []
    return Copied(same_as, tuple(as_text))


def carries_code(source: str) -> bool:
    """Whether a cell has a long literal, or many short ones, and calls what decodes, unpacks, executes or writes it."""
    tree = _parse(source)
    if tree is None:
        return False
    names = {node.id for node in ast.walk(tree) if isinstance(node, ast.Name)}
    reads_docstrings = any(isinstance(node, ast.Attribute) and node.attr == "__doc__" for node in ast.walk(tree))
    nodes = list(ast.walk(tree) if reads_docstrings else _without_docstrings(tree))
    characters = sum(_characters(node.value) for node in nodes if isinstance(node, ast.Constant))
    is_list = any(isinstance(node, ast.List | ast.Tuple | ast.Set) and _is_list_of_codes(node) for node in nodes)
    unpacks = "__builtins__" in names or not _UNPACKING.isdisjoint(_called(tree))
    return (characters >= MIN_CHARACTERS or is_list) and unpacks


def _characters(value: object) -> int:
    """Length of a text, or of the bytes that a large integer stands for."""
    if isinstance(value, str | bytes):
        return len(value)
    return value.bit_length() // 8 if isinstance(value, int) else 0


def _is_list_of_codes(node: ast.List | ast.Tuple | ast.Set) -> bool:
    return len(node.elts) >= MIN_ELEMENTS and all(
        isinstance(one, ast.Constant) and isinstance(one.value, int | str | bytes) for one in node.elts
    )


def _called(tree: ast.Module) -> Iterator[str]:
    for node in ast.walk(tree):
        if isinstance(node, ast.Call):
            yield node.func.attr if isinstance(node.func, ast.Attribute) else getattr(node.func, "id", "")


def _without_docstrings(tree: ast.Module) -> Iterator[ast.AST]:
    """All nodes but texts that stand alone as a statement."""
    alone = {id(node.value) for node in ast.walk(tree) if isinstance(node, ast.Expr)}
    return (node for node in ast.walk(tree) if id(node) not in alone)


@cache
def _reference() -> Mapping[str, str]:
    """The function of labsid by the fingerprint of each stretch of its code."""
    found: dict[str, str] = {}
    for room in REFERENCE_ROOMS:
        package = source_path(f"labsid.{room}")
        folder = package.parent if package is not None else Path()
        for path in sorted(folder.glob("*.py")) if package is not None else ():
            tree = parse_python(path.read_bytes())
            for function in (node for node in ast.walk(tree) if isinstance(node, ast.FunctionDef)):
                for window in _windows_of(function.body):
                    found.setdefault(window, f"labsid.{room}.{path.stem}.{function.name}")
    return found


def _windows(source: str) -> list[str]:
    tree = _parse(source)
    return [] if tree is None else [*_windows_of_blocks(tree)]


def _windows_of_blocks(tree: ast.AST) -> Iterator[str]:
    """The stretches in a cell and in each of its functions, however deep."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Module | ast.FunctionDef):
            yield from _windows_of(node.body)


def _windows_of(body: Sequence[ast.stmt]) -> Iterator[str]:
    """Fingerprints of the shortest stretches of statements, from each statement on, that are long enough."""
    statements = [one for one in body if not (isinstance(one, ast.Expr) and isinstance(one.value, ast.Constant))]
    sizes = [sum(1 for node in ast.walk(one) if not isinstance(node, ast.expr_context)) for one in statements]
    for first in range(len(statements)):
        total = 0
        for last in range(first, len(statements)):
            total += sizes[last]
            if total >= MIN_NODES:
                yield _fingerprint(statements[first : last + 1])
                break


def _fingerprint(statements: Sequence[ast.stmt]) -> str:
    """Of the syntax trees, with all names numbered in order of appearance, and without annotations and docstrings."""
    numbers: dict[str, int] = {}
    parts: list[str] = []
    waiting: list[Any] = [list(statements)]
    while waiting:  # without recursion: the code is the student's, and may be nested deeply
        node = waiting.pop()
        if isinstance(node, list):
            waiting += [_END, *reversed(node)]
        elif isinstance(node, ast.AnnAssign) and node.value is not None:
            waiting.append(ast.Assign(targets=[node.target], value=node.value))
        elif isinstance(node, ast.AST):
            parts.append(type(node).__name__)
            if isinstance(node, ast.Name | ast.arg | ast.FunctionDef):
                name = getattr(node, _NAME_FIELDS[type(node)])
                parts.append(str(numbers.setdefault(name, len(numbers))))
            waiting += reversed(list(_fields(node)))
        else:
            parts.append(";" if node is _END else constant_text(node))
    return hashlib.sha256(" ".join(parts).encode(errors="surrogatepass")).hexdigest()[:24]


def _fields(node: ast.AST) -> Iterator[object]:
    """What a fingerprint is made of, but for the node's name."""
    for name, value in ast.iter_fields(node):
        if name in _WITHOUT or name == _NAME_FIELDS.get(type(node)):
            continue
        is_function = isinstance(node, ast.FunctionDef) and name == "body"
        yield [one for one in value if not _is_text(one)] if is_function else value


def _is_text(statement: ast.stmt) -> bool:
    return isinstance(statement, ast.Expr) and isinstance(statement.value, ast.Constant)


def _parse(source: str) -> ast.Module | None:
    try:
        return None if len(source) > MAX_CHARACTERS else parse_python(without_magic(source))
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        return None
