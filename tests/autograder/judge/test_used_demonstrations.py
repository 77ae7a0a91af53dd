"""Demonstrations are run as a whole where an answer uses what they compute."""

import pytest

from autograder.intake.submission import NotebookCell
from autograder.judge.used_demonstrations import MAX_CHARACTERS, with_used_demonstrations

DEMONSTRATION = "inv = np.linalg.inv\ntable = inv(np.eye(2))\nfig, ax = plt.subplots()"


def kinds(*cells: tuple[str, str]) -> list[str]:
    made = [NotebookCell(str(k), kind, source, True) for k, (kind, source) in enumerate(cells)]
    return [cell.kind for cell in with_used_demonstrations(made)]


@pytest.mark.parametrize(
    ("answer", "run"),
    [
        ("a = table[0]", True),
        ("def f():\n    return table", True),
        ("a = 3", False),
        ("a = inv(b)", False),
        ("table = 1\na = table", False),
        ("def f(table):\n    return table", False),
        ("fig, ax = plt.subplots()\nax.plot(t)", False),
        ("a = table[", False),
        ("a = table #" + "x" * MAX_CHARACTERS, False),
    ],
)
def test_a_demonstration_is_run_where_its_values_are_used(answer: str, run: bool) -> None:
    kind = "given" if run else "demonstration"
    assert kinds(("demonstration", DEMONSTRATION), ("answer", answer)) == [kind, "answer"]


def test_what_a_given_cell_sets_needs_no_demonstration() -> None:
    cells = ("given", "table = 1"), ("demonstration", DEMONSTRATION), ("answer", "a = table")
    assert kinds(*cells) == ["given", "demonstration", "answer"]


def test_a_demonstration_that_another_one_goes_on_from() -> None:
    cells = ("demonstration", DEMONSTRATION), ("demonstration", "double = 2 * table"), ("extra", "a = double")
    assert kinds(*cells) == ["given", "given", "extra"]
