"""What an answer may use of labsid and of the machine while it is graded, and the lines of a cell that are refused."""

import ast
import re
from collections.abc import Iterator, Mapping
from importlib import import_module
from types import ModuleType
from typing import Any

from labsid.checks.syntax_trees import last_name

ALLOWED_PACKAGES = ("records", "rig.lab")
"""The packages of labsid that graded code may import with all their modules."""

ALLOWED_MODULES = (
    "_arrays", "_files", "checks", "checks.answer_code", "checks.argument_orders", "checks.array_errors",
    "checks.asked_texts", "checks.call_causes", "checks.causes", "checks.cell_names", "checks.cell_runs",
    "checks.cells",
    "checks.column_causes", "checks.compare", "checks.empty_slices", "checks.error_table", "checks.function_reads",
    "checks.given_lines", "checks.grading_rules", "checks.handed_over", "checks.hints", "checks.kept_tries",
    "checks.key_causes", "checks.library_errors", "checks.line_values", "checks.loops", "checks.matlab_syntax",
    "checks.matrix_causes", "checks.mended_functions", "checks.module_names", "checks.notebook",
    "checks.notebook_ask", "checks.notebook_file",
    "checks.notebook_tries", "checks.one_place", "checks.operands", "checks.origin_of_values",
    "checks.other_expressions", "checks.permitted",
    "checks.points",
    "checks.python_errors", "checks.question", "checks.relations", "checks.repairs", "checks.singular_matrices",
    "checks.stops", "checks.summary", "checks.syntax_trees", "checks.tables", "checks.time_limit",
    "checks.tuple_causes", "checks.values", "checks.verdict", "checks.written_calls", "checks.written_values",
    "plots", "plots.block_diagrams", "plots.captions", "plots.describe", "plots.diagrams", "plots.figure",
    "plots.figure_values", "plots.lecture_diagrams", "plots.rig_sketch", "plots.style", "plots.visible",
    "rig", "rig.seeds",
)  # fmt: skip
"""The single modules of labsid that graded code may import: what notebooks use, and the encoding of values. The figures
of a student's own results and the rigs with withheld effects are not among them."""

ALLOWED_FILES = ("plots/notebook.mplstyle",)
"""Files of labsid beside its modules that graded code may read: the style of the notebooks' figures."""

RULE = (
    "Answers may use Python, numpy, scipy, python-control and matplotlib. Of labsid they may use `load_record`, the "
    "rig of the lab (`labsid.rig`) and the diagrams (`labsid.plots`: `sketch_rig`, `figure_2` to `figure_4`). The rest "
    "of labsid, the functions that do a step of the lab or of a lecture and the figures of its results, is the "
    "reference: grading refuses it, and so do the checks in the notebook. While a notebook is graded nothing can be "
    "installed, no program can be started and there is no network: lines such as `!ls` and `%pip install` are skipped. "
    "A cell may take up to {seconds:g} seconds, and a notebook 2 GB of memory."
)
"""The rule as students read it on the start page."""

WRITE_YOURSELF = "write the step yourself (the start page says what may be used of labsid)"

SKIPPED_MAGICS = (
    "pip", "conda", "mamba", "micromamba", "uv", "sx", "system", "bash", "sh", "script", "cmd", "perl", "ruby",
    "autosave", "connect_info", "edit", "load", "notebook", "qtconsole", "store", "subshell",
)  # fmt: skip
"""Magic commands that install or start something, or that only a front end has."""

_PROGRAM = re.compile(rf"!|\w+\s*=\s*!|%+({'|'.join(SKIPPED_MAGICS)})\b")
"""A line that starts a program: a shell escape, or such a magic command."""


def is_reference(module: str) -> bool:
    """Whether a dotted module name belongs to the reference or the grader."""
    top, _, inner = module.partition(".")
    if top == "labsid":
        allowed = inner in ("", *ALLOWED_MODULES) or any(f"{inner}.".startswith(f"{one}.") for one in ALLOWED_PACKAGES)
        return not allowed
    return top == "autograder"


def refused_lines(source: str, variables: Mapping[str, Any]) -> Iterator[str]:
    """What grading refuses in a cell, one sentence each.

    Parameters
    ----------
    source : str
        Text of a code cell.
    variables : mapping
        The notebook's variables, to which its names refer.

    Yields
    ------
    str
        What the line does, why it fails at grading, and what to do.
    """
    for name in _taught_names(source, variables):
        yield f"it uses `{name}`, which is the taught function itself. Grading refuses it: {WRITE_YOURSELF}."


def skipped_lines(source: str) -> Iterator[str]:
    """The lines of a cell that start a program; they do nothing while a notebook is graded and in ``labsid submit``."""
    yield from filter(_PROGRAM.match, map(str.strip, source.splitlines()))


def is_taught(value: object) -> bool:
    """Whether an object is a module, function or class of the reference, or an instance of such a class."""
    module = value.__name__ if isinstance(value, ModuleType) else getattr(value, "__module__", None)
    return isinstance(module, str) and is_reference(module)


def _taught_names(source: str, variables: Mapping[str, Any]) -> Iterator[str]:
    try:
        tree = ast.parse(without_magic(source))
    except (SyntaxError, ValueError, MemoryError, RecursionError):  # the cell has failed, which is said elsewhere
        return
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names if is_reference(alias.name))
        elif isinstance(node, ast.ImportFrom) and node.module and not node.level:
            yield from (
                f"{node.module}.{alias.name}" for alias in node.names if is_taught_import(node.module, alias.name)
            )
        elif isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name):
            owner = variables.get(node.value.id)
            if isinstance(owner, ModuleType) and is_taught_import(owner.__name__, node.attr):
                yield f"{node.value.id}.{node.attr}"
        elif isinstance(node, ast.Call) and node.args and isinstance(node.args[0], ast.Constant):
            named = node.args[0].value
            called = last_name(node.func)
            if called in ("import_module", "__import__") and isinstance(named, str) and is_reference(named):
                yield named


def is_taught_import(module: str, name: str) -> bool:
    """Whether ``from module import name`` needs a module of the reference."""
    if module.partition(".")[0] not in ("labsid", "autograder"):
        return False
    if is_reference(module):
        return True
    try:
        return is_taught(getattr(import_module(module), name, None))
    except ImportError:  # the cell has failed, which is said elsewhere
        return False


def without_magic(source: str) -> str:
    """The source of a cell without the lines that start with a magic command or a shell escape."""
    return "\n".join("" if line.lstrip().startswith(("%", "!")) else line for line in source.splitlines())
