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


def test_the_table_is_whole() -> None:
    """Every automatic question of the notebooks that the table speaks of stands in some row."""
    spoken_of = {step.split("/")[0] for row in ROWS for step in row.steps}
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
