"""Code of labsid under other names, and code that is carried as text: pointed out, and honest code is not."""

import ast
import builtins
from pathlib import Path

import pytest
from course_work import read_solved
from variants import Right, variants_of

import labsid
from autograder.course.layout import Course
from autograder.intake.submission import NotebookCell
from autograder.results.copied import MIN_NODES, REFERENCE_ROOMS, Copied, carries_code, find_copied
from labsid.checks.notebook import assignment_names

ROOT = Path(labsid.__file__).parent


def hand_in(*sources: str) -> list[NotebookCell]:
    cells = [NotebookCell(f"q-answer-{k}", "answer", source, True) for k, source in enumerate(sources)]
    return [*cells, NotebookCell("q", "question", 'check("q")', True)]


class _Renamed(ast.NodeTransformer):
    """All names but those of Python changed, docstrings and annotations removed."""

    def __init__(self) -> None:
        self.names: dict[str, str] = {}

    def _new(self, name: str) -> str:
        return name if hasattr(builtins, name) else self.names.setdefault(name, f"own_{len(self.names)}")

    def visit_Name(self, node: ast.Name) -> ast.AST:
        return ast.Name(self._new(node.id), node.ctx)

    def visit_arg(self, node: ast.arg) -> ast.AST:
        return ast.arg(self._new(node.arg))

    def visit_FunctionDef(self, node: ast.FunctionDef) -> ast.AST:
        node.name, node.returns = self._new(node.name), None
        if ast.get_docstring(node) is not None:
            node.body = node.body[1:]
        return self.generic_visit(node)


def taught_functions() -> list[tuple[str, str]]:
    """Name and changed source of each longer function of the rooms of labsid that assignments teach."""
    found = []
    for room in REFERENCE_ROOMS:
        for path in sorted(ROOT.joinpath(*room.split(".")).glob("*.py")):
            for node in ast.parse(path.read_text(encoding="utf-8")).body:
                if isinstance(node, ast.FunctionDef):
                    size = sum(1 for statement in node.body[1:] for _ in ast.walk(statement))
                    if size >= 2 * MIN_NODES:
                        found.append((f"{path.stem}.{node.name}", ast.unparse(_Renamed().visit(node))))
    return found


def test_98_per_cent_of_the_functions_of_labsid_are_recognised_under_other_names() -> None:
    functions = taught_functions()
    assert len(functions) > 80
    missed = [name for name, source in functions if not find_copied(hand_in(source), ()).same_as]
    assert len(missed) <= 0.02 * len(functions), missed


def test_a_body_without_its_first_lines_and_outside_of_a_function_is_recognised() -> None:
    _, source = next(one for one in taught_functions() if one[0] == "arx.fit_arx" or "step_response" in one[0])
    body = ast.parse(source).body[0].body
    flat = "\n".join(ast.unparse(one) for one in body if not isinstance(one, ast.Return | ast.If))
    assert find_copied(hand_in(flat), ()).same_as or len(flat) < 400


def test_code_of_the_release_is_left_out() -> None:
    _, source = taught_functions()[0]
    assert find_copied(hand_in(source), [source]) == Copied()


@pytest.mark.parametrize("name", assignment_names())
def test_honest_answers_are_not_pointed_out(name: str, course: Course) -> None:
    template, solution = read_solved(course, name)
    released = [cell.source for cell in template.cells]
    model = [source for cell, source in solution.items() if cell.endswith("-answer")]
    others = [code for one in variants_of(name) if isinstance(one, Right) for code in one.code.values()]
    for sources in (model, others):
        assert find_copied(hand_in(*sources), released) == Copied()


PACKED = "x" * 300


@pytest.mark.parametrize(
    "source",
    [
        f"import base64\nexec(base64.b64decode('{PACKED}'))",
        f"import zlib, base64\ncode = zlib.decompress(base64.b85decode(b'{PACKED}'))\nexec(code)",
        f"import numpy as np\ny_sim = np.frombuffer(bytes.fromhex('{PACKED}'))",
        f"import json\ntable = json.loads('{PACKED}')",
        f"eval(compile('{PACKED}', 'x', 'exec'))",
        f"exec(bytes({list(range(250))}).decode())",
        f"exec(''.join(map(chr, {list(range(250))})))\nchr(1)",
        f"n = 0x{'61' * 300}\nexec(n.to_bytes(300, 'big'))",
        "q = ''\n" + "".join(f"q += 'abcdefghij{n}'\n" for n in range(30)) + "exec(q)",
        f"def f():\n    '{PACKED}'\nexec(f.__doc__)",
        f"with open('hm.py', 'w') as file:\n    file.write('{PACKED}')\nimport hm",
        f"s = '{PACKED}'\ngetattr(__builtins__, 'exe' + 'c')(s)",
        f"import types\nm = types.ModuleType('m')\nexec('''{PACKED}''', m.__dict__)",
    ],
)
def test_code_as_text_is_pointed_out(source: str) -> None:
    assert carries_code(source)
    assert find_copied(hand_in("a = 1", source), ()).code_as_text == ("q",)


@pytest.mark.parametrize(
    "source",
    [
        f"'''{PACKED}'''\nx = int('3')\nexec('a = 1')",
        f"text = '{PACKED}'\nprint(text)",
        f"def f(x):\n    '''{PACKED}'''\n    return eval('x')",
        f"x = {[0.5] * 300}\ny = bytes(3)",
        "this is no Python(",
    ],
)
def test_long_texts_and_short_programs_are_not(source: str) -> None:
    assert not carries_code(source)
