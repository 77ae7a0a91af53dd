"""Code that Python runs, however deeply it is nested, is judged as other code is: no walk through it is recursive."""

import ast
import types
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

import autograder
import labsid
from autograder.intake.submission import NotebookCell
from autograder.judge.needed_cells import cells_needed, draws_known_values
from autograder.results.copied import find_copied
from autograder.results.similar import code_fingerprints, normal_form
from autograder.sandbox.replacing import Replacement, run_replacing
from labsid.checks.cell_names import assigned_names, bound_names, made_by_calls, read_names, used_names
from labsid.checks.given_lines import put_back
from labsid.checks.permitted import refused_lines
from labsid.checks.python_errors import explain
from labsid.checks.stops import stop_of
from labsid.checks.written_values import typed_names

MOST = 2_800
"""Levels that Python 3.11 compiles below a few frames of its own; of calls of methods about half as many."""

DEEP: dict[str, Callable[[int], str]] = {
    "calls": lambda n: "s = 'a'" + ".strip()" * (n // 2),
    "a sum": lambda n: "s = " + " + ".join(["x"] * n),
    "texts": lambda n: "s = " + "\\\n + ".join(f"'{k}'" for k in range(n)),
    "typed numbers": lambda n: "s = " + "+".join(["1"] * n),
    "signs": lambda n: "s = " + "-" * n + "1",
    "not": lambda n: "s = " + "not " * n + "x",
    "elif": lambda n: "if x > n: s = -1\n" + "".join(f"elif x == {k}: s = {k}\n" for k in range(n)),
    "nested conditions": lambda n: "s = " + "1 if x else " * n + "2",
    "powers": lambda n: "s = " + "**".join(["1"] * n),
    "indices": lambda n: "s = c" + "[0]" * n,
    "stored indices": lambda n: "s = 1\nc" + "[0]" * n + " = 2",
    "attributes": lambda n: "s = 1\nc" + ".real" * n + " = 2",
    "lambdas": lambda n: "s = " + "lambda: " * (n // 2) + "x",
    "brackets": lambda n: "s = " + "[" * min(n, 90) + "x" + "]" * min(n, 90),
    "targets": lambda n: "(" * min(n, 90) + "s" + ",)" * min(n, 90) + " = c",
    "functions": lambda n: "".join(f"{' ' * k}def s{k}():\n" for k in range(min(n, 90))) + " " * 91 + "return 1\ns = 1",
    "loops": lambda n: "".join(f"{' ' * k}for s in c:\n" for k in range(min(n, 20))) + " " * 20 + "s = s",
    "a long condition": lambda n: "s = " + " and ".join(["x"] * n),
    "comparisons": lambda n: "s = " + " < ".join(["x"] * n),
    "a large integer": lambda n: "s = 0x" + "f" * 2 * n,
}


def walks(source: str) -> None:
    """Everything that is found out about the code of a hand-in."""
    cells = [
        NotebookCell("first", "answer", "x = 3\nc = []", True),
        NotebookCell("deep", "answer", source, True),
        NotebookCell("question", "question", "check('question')", True),
    ]
    put_back("a = np.ones(3)\n# Your code here", source)
    assert "s" in assigned_names(source)
    assert "s" in bound_names(source)
    for find in (made_by_calls, used_names, read_names):
        find(source)
    typed_names([source], ["s"])
    list(refused_lines(source, {}))
    assert cells_needed(cells, ["question"], {"question": ["s"]})[-2].id == "deep"
    draws_known_values(cells, "question", ["x"])
    normal_form(source)
    code_fingerprints(cells, {})
    find_copied(cells, ["x = 3"])
    variables: dict[str, Any] = {"x": 3}
    try:
        exec(compile(source, "<cell>", "exec"), variables)
    except Exception as error:
        explain(stop_of(error, variables, source))


@pytest.mark.parametrize("kind", DEEP)
def test_walks_take_any_code_that_python_compiles(kind: str) -> None:
    source = DEEP[kind](MOST)
    compile(source, "<cell>", "exec")
    walks(source)


@pytest.mark.parametrize("kind", DEEP)
def test_deep_code_runs_where_values_are_replaced(kind: str) -> None:
    ran: list[object] = []
    shell = types.SimpleNamespace(user_ns={}, transform_ast=lambda tree: tree)

    def run_cell(source: str, store_history: bool) -> Any:
        tree = shell.transform_ast(ast.parse(source))
        ran.append(compile(tree, "<cell>", "exec"))
        return types.SimpleNamespace(error_before_exec=None, error_in_exec=None)

    shell.run_cell = run_cell
    body = "\n".join(f" {line}" for line in DEEP[kind](900).splitlines())
    whole = f"def main():\n{body}\n return s\ny = main()"
    run_replacing(shell, whole, (Replacement({"s": 2.0}, {"s": 1.5}),), lambda name: lambda: None)
    assert ran


RECURSIVE = ("NodeVisitor", "NodeTransformer", "ast.dump(", "ast.unparse(", "fix_missing_locations(", "literal_eval(")
BOUNDED = {
    "labsid/checks/causes.py": "parts of a line that `parsed_line` has found short and flat",
    "labsid/checks/argument_orders.py": "the same",
    "labsid/checks/column_causes.py": "the same",
    "labsid/checks/empty_slices.py": "the same",
    "labsid/checks/mended_functions.py": "trees that `is_deep` has found flat",
    "labsid/checks/one_place.py": "the same",
    "labsid/checks/other_expressions.py": "the same",
    "labsid/checks/repairs.py": "the same",
    "labsid/checks/asked_texts.py": "the same",
    "labsid/checks/call_causes.py": "the same",
    "labsid/checks/stops.py": "the same",
    "labsid/checks/line_values.py": "the same",
    "labsid/checks/loops.py": "the same",
    "labsid/checks/matrix_causes.py": "the same",
    "labsid/checks/handed_over.py": "the same",
    "labsid/checks/key_causes.py": "the same",
    "labsid/checks/library_errors.py": "the same",
    "labsid/checks/operands.py": "the same",
    "labsid/checks/points.py": "the same",
    "labsid/checks/singular_matrices.py": "the same",
    "labsid/checks/tables.py": "the same",
    "labsid/checks/tuple_causes.py": "the same",
    "labsid/checks/given_lines.py": "of the release",
    "labsid/checks/syntax_trees.py": "named in its text",
    "autograder/course/definitions.py": "of the course",
}


def test_no_walk_through_student_code_needs_recursion() -> None:
    rooms = ("checks", "hand_in"), ("judge", "batch", "results", "sandbox", "intake", "course", "marking")
    for package, names in zip((labsid, autograder), rooms, strict=True):
        folder = Path(package.__path__[0])
        for path in (path for name in names for path in (folder / name).rglob("*.py")):
            inside = path.relative_to(folder.parent).as_posix()
            found = [word for word in RECURSIVE if word in path.read_text(encoding="utf-8")]
            assert not found or inside in BOUNDED, (inside, found)
