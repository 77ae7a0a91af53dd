"""Every line of "Seed coverage" has a function, a step in a notebook and a test, and all of them are there."""

import ast
import importlib
import re
from functools import cache
from pathlib import Path

import pytest
from seed_coverage import ROWS, Row

ROOT = Path(__file__).resolve().parent.parent


@cache
def cells_of(assignment: str) -> frozenset[str]:
    text = (ROOT / "notebooks" / assignment / f"{assignment}.md").read_text(encoding="utf-8")
    return frozenset(re.findall(r"grade_id\"?: \"?([\w-]+)", text))


@cache
def functions_in(file: str) -> frozenset[str]:
    tree = ast.parse((ROOT / file).read_text(encoding="utf-8"))
    return frozenset(node.name for node in ast.walk(tree) if isinstance(node, ast.FunctionDef))


@pytest.mark.parametrize("row", ROWS, ids=lambda row: f"{row.seed} {row.item}")
def test_row(row: Row) -> None:
    assert row.functions, "no function"
    assert row.steps, "no step of a notebook"
    assert row.tests, "no test"
    for function in row.functions:
        module, name = function.split(":")
        assert getattr(importlib.import_module(module), name), function
    for step in row.steps:
        assignment, cell = step.split("/")
        assert cell in cells_of(assignment), step
    for test in row.tests:
        file, name = test.split("::")
        assert name in functions_in(file), test


NUMBERED = {
    "UNSW": {"Fig": {*"12345678", "A1", "A2"}},
    "Reading": {
        "Fig": {str(number) for number in range(1, 18)},
        "Table": {"1", "2", "3"},
        "Example": {"2-1", "2-2", "2-3", "2-4", "3-1", "3-2", "5-1", "5-2", "6-1", "6-2", "7-1", "7-2", "8-1"},
    },
    "SUSTech": {"Example": {"1", "2"}},
}
"""The figures, tables and examples of each seed by their printed numbers."""


def numbers_in(item: str, kind: str) -> set[str]:
    """What "Examples 2-1, 2-2 and 2-4", "Fig. 9 and 10" or "Table 1" speaks of."""
    number = r"A?\d+(?:-\d)?"
    lists = re.findall(rf"{kind}s?\.? ((?:{number}(?:, | and )?)+)", item)
    return {found for numbers in lists for found in re.findall(number, numbers)}


@pytest.mark.parametrize(("seed", "kind"), [(seed, kind) for seed, kinds in NUMBERED.items() for kind in kinds])
def test_everything_that_a_seed_numbers_has_a_row(seed: str, kind: str) -> None:
    found = set().union(*(numbers_in(row.item, kind) for row in ROWS if row.seed == seed))
    assert found >= NUMBERED[seed][kind]


NAMED = {
    "Reading": (
        "shift operator; z-transform; five steps; linear and time-invariant; definiteness; both derivations; "
        "ARX, AR, ARMAX, ARMA and FIR; Systems 1 and 2; derivation of RLS; matrix inversion lemma; forgetting factor; "
        "online use; unbiasedness; covariance; consistency; five input signals; persistent excitation; "
        "pseudo-linear regression; RELS; loss against order; over-parameterisation; residual tests; "
        "instrumental variables; recursive IV; maximum likelihood; rank; condition number; adjoint; Cayley-Hamilton; "
        "eigenvalues; SVD; pseudo-inverse; first MATLAB program; second MATLAB program; third MATLAB program; "
        "partitioned product; orthogonal and skew; A (I + A)^-1 = (I + A)^-1 A; 2x2 formulas; function table; acronyms"
    ),
    "SUSTech": (
        "gradient of the cost; normal equations; rank-deficient solutions; minimum-norm; projection; "
        "line and quadratic fit; y = b e^(ax) through the logarithm; y = b e^(ax) as min; ARX(p, q); regressor and H; "
        "one-step predictor; derivatives of Ax, x'Ax and (x'x) x; directional derivatives; constraint set; "
        "range measurement; Gauss-Newton; Levenberg-Marquardt; coding example; state space"
    ),
}
"""What "Seed coverage" names in the lectures without a number."""


@pytest.mark.parametrize(
    ("seed", "item"), [(seed, item) for seed, items in NAMED.items() for item in items.split("; ")]
)
def test_everything_that_the_lectures_name_has_a_row(seed: str, item: str) -> None:
    assert any(item in row.item for row in ROWS if row.seed == seed)


def test_the_table_is_whole() -> None:
    """Every automatic question stands in some row, but for what the project has on top of the lab and the lectures."""
    spoken_of = {step.split("/")[0] for row in ROWS for step in row.steps}
    assignments = {path.stem for path in (ROOT / "notebooks").glob("*/*.md") if path.stem == path.parent.name}
    assert spoken_of == assignments - {"several-signals", "sim-to-real-gap"}
    in_rows = {step for row in ROWS for step in row.steps}
    missing = [
        f"{assignment}/{cell}"
        for assignment in sorted(spoken_of)
        for cell in sorted(question_ids(assignment))
        if f"{assignment}/{cell}" not in in_rows
    ]
    assert missing == []


def question_ids(assignment: str) -> set[str]:
    from labsid.checks.notebook import load_assignment

    return {question.id for question in load_assignment(assignment).questions}
