"""Single changes of the model solutions: which of them do the checks not notice?

A mutant is a model solution with one number, operator, comparison or name changed. `make mutants` grades all of them in
this process and lists those that pass and are not in ``mutants_equivalent.txt``, which gives a reason for each of them.
"""

import argparse
import ast
import copy
import sys
import time
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import islice
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
sys.path.insert(0, str(Path(__file__).resolve().parent.parent))

from one_answer import Solved, solve

from labsid.checks.notebook import assignment_names

EQUIVALENT = Path(__file__).with_name("mutants_equivalent.txt")
LOOKS = {"linewidth", "figsize", "markersize", "alpha", "fontsize", "zorder", "dpi", "s", "pad"}
"""Arguments of figures that no check reads."""

NOT_CHANGED = {"gap-7-simulation-answer"}
"""Cells of alternatives: the model solution fits eight models and takes the best, so that seven may be wrong."""

OPERATORS: dict[type[ast.operator], type[ast.operator]] = {
    ast.Add: ast.Sub,
    ast.Sub: ast.Add,
    ast.Mult: ast.Div,
    ast.Div: ast.Mult,
    ast.Pow: ast.Mult,
    ast.MatMult: ast.Mult,
    ast.FloorDiv: ast.Div,
}
COMPARISONS: dict[type[ast.cmpop], type[ast.cmpop]] = {
    ast.Lt: ast.LtE,
    ast.LtE: ast.Lt,
    ast.Gt: ast.GtE,
    ast.GtE: ast.Gt,
    ast.Eq: ast.NotEq,
    ast.NotEq: ast.Eq,
    ast.Is: ast.IsNot,
    ast.IsNot: ast.Is,
}


@dataclass(frozen=True, slots=True)
class Mutant:
    """A changed answer: the question, the cell, the line as it was and as it is, and the cell's whole source."""

    question: str
    cell: str
    line: str
    source: str

    @property
    def name(self) -> str:
        return f"{self.question}: {self.line}"


def changes(node: ast.AST, names: tuple[str, ...]) -> Iterator[tuple[str, object]]:
    """Each field of a node that a mutant changes, with its new value; `names` are those of the function's arguments."""
    if isinstance(node, ast.Constant) and type(node.value) in (int, float):
        yield from (("value", node.value + 1), ("value", -node.value)) if node.value else (("value", 1),)
        if isinstance(node.value, int) and node.value > 1:
            yield "value", node.value - 1
    elif (isinstance(node, ast.BinOp) and type(node.op) in OPERATORS) or (
        isinstance(node, ast.AugAssign) and type(node.op) in OPERATORS
    ):
        yield "op", OPERATORS[type(node.op)]()
    elif isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub):
        yield "op", ast.UAdd()
    elif isinstance(node, ast.BoolOp):
        yield "op", ast.And() if isinstance(node.op, ast.Or) else ast.Or()
    elif isinstance(node, ast.Compare) and len(node.ops) == 1 and type(node.ops[0]) in COMPARISONS:
        yield "ops", [COMPARISONS[type(node.ops[0])]()]
    elif isinstance(node, ast.Name) and isinstance(node.ctx, ast.Load) and node.id in names:
        yield from (("id", other) for other in names if other != node.id)


def mutants_of(solved: Solved) -> Iterator[Mutant]:
    """Every mutant of an assignment's answers, in the order of the notebook."""
    for question in solved.assignment.questions:
        for cell in (one for one in solved.answer_cells(question.id) if one not in NOT_CHANGED):
            for before, source in mutated(solved.cells[cell]):
                yield Mutant(question.id, cell, before, source)


def mutated(source: str) -> Iterator[tuple[str, str]]:
    """Every single change of a cell within its solution: the changed line, and the source."""
    tree = ast.parse(source)
    before = ast.unparse(tree)
    solution = lines_of_solution(source)
    for number, (node, names) in enumerate(walk(tree, ())):
        if getattr(node, "lineno", 0) not in solution:
            continue
        for field, value in changes(node, names):
            changed = copy.deepcopy(tree)
            twin, _ = next(islice(walk(changed, ()), number, None))
            setattr(twin, field, value)
            after = ast.unparse(changed)
            if after != before:
                yield difference(before, after), after


def lines_of_solution(source: str) -> set[int]:
    """Numbers of the lines that students write."""
    found, inside = set(), False
    for number, line in enumerate(source.splitlines(), start=1):
        inside = (inside or "### BEGIN SOLUTION" in line) and "### END SOLUTION" not in line
        if inside:
            found.add(number)
    return found


def walk(node: ast.AST, names: tuple[str, ...]) -> Iterator[tuple[ast.AST, tuple[str, ...]]]:
    """All nodes below one, each with the names of the arguments of the function that it is in."""
    for child in ast.iter_child_nodes(node):
        inner = names
        if isinstance(child, ast.FunctionDef | ast.Lambda):
            inner = (*names, *(one.arg for one in child.args.args))
        if isinstance(child, ast.keyword) and child.arg in LOOKS:
            continue
        yield child, inner
        yield from walk(child, inner)


def difference(before: str, after: str) -> str:
    """The line that differs, as it was and as it is."""
    pairs = zip(before.splitlines(), after.splitlines(), strict=True)
    was, now = next((a.strip(), b.strip()) for a, b in pairs if a != b)
    return f"{was}  ->  {now}"


def survives(solved: Solved, mutant: Mutant, seed: int = 0) -> bool:
    return solved.judge(mutant.question, {mutant.cell: mutant.source}, seed).passed


def equivalent() -> dict[str, str]:
    """The mutants that are right answers, and why."""
    found = {}
    reason = ""
    for line in EQUIVALENT.read_text(encoding="utf-8").splitlines():
        if line.startswith("# "):
            reason = line[2:]
        elif line.strip():
            found[line.strip()] = reason
    return found


def main() -> int:
    options = argparse.ArgumentParser(description=__doc__)
    options.add_argument("--only", choices=assignment_names(), action="append", help="this assignment; may be repeated")
    options.add_argument("--question", default="", help="only questions with this in their id")
    options.add_argument("--seed", type=int, default=1)
    chosen = options.parse_args()
    known, left, seen = equivalent(), 0, set[str]()
    for name in chosen.only or assignment_names():
        began, solved = time.monotonic(), solve(name)
        mutants = [one for one in mutants_of(solved) if chosen.question in one.question]
        alive = [one for one in mutants if survives(solved, one, chosen.seed)]
        new = [one for one in alive if one.name not in known]
        seen.update(one.name for one in alive)
        left += len(new)
        print(
            f"{name}: {len(mutants)} mutants, {len(mutants) - len(alive)} fail, {len(alive) - len(new)} equivalent, "
            f"{len(new)} pass, {time.monotonic() - began:.0f} s",
            flush=True,
        )
        print("".join(f"  {one.name}\n" for one in new), end="", flush=True)
    stale = [] if chosen.only or chosen.question else sorted(set(known) - seen)
    print("".join(f"{EQUIVALENT.name} lists what does not pass, or is no mutant: {name}\n" for name in stale), end="")
    return 1 if left or stale else 0


if __name__ == "__main__":
    sys.exit(main())
