"""Numbers that were typed into the texts of a figure."""

import pytest
from one_answer import solve
from tries import edited

from labsid.checks.notebook import NotebookAsk
from labsid.checks.written_numbers import numbers_in_texts, numbers_that_count, told_of_numbers

FIGURE = "postlab-3-figure-8"


@pytest.mark.parametrize(
    ("source", "numbers"),
    [
        ('ax.text(0.02, 0.97, f"MSE, first order: 1.73e-03 V$^2$ {mse_1:.3e}")', {"1.73e-03"}),
        ('ax.set_title("Fig. 8: order 1 and 2, 0.00105")', {"0.00105"}),
        ('ax.set_title(f"{0.00105}")', {"0.00105"}),
        ('ax.text(0.02, 0.97, f"order 1: {mse_1:.3g}", size=8.5)  # 1.73e-03', set()),
        ("ax.text(", set()),
    ],
)
def test_numbers_in_texts(source: str, numbers: set[str]) -> None:
    assert numbers_in_texts([source]) == numbers


def _counted(source: str) -> dict[str, list[str]]:
    solved = solve("postlab-model-order")
    question = solved.assignment.question(FIGURE)
    variables = solved.run(FIGURE, {f"{FIGURE}-answer": source})
    ask = NotebookAsk(variables, solved.record, solved.known[FIGURE], FIGURE)
    assert question.verdict(ask).passed
    return dict(numbers_that_count(question, solved.assignment, ask, {"fig_8": numbers_in_texts([source])}))


def test_errors_typed_into_a_figure() -> None:
    variables = solve("postlab-model-order").run_before(f"{FIGURE}-answer")
    one, two = (f"{variables[name]:.3g}" for name in ("mse_1", "mse_2"))
    typed = edited(FIGURE, ("{mse_1:.3e}", one), ("{mse_2:.3e}", two))
    assert _counted(typed) == {"fig_8": sorted([one, two])}
    assert _counted(edited(FIGURE, ("{mse_1:.3e}", one))) == {"fig_8": [one]}
    said = told_of_numbers(_counted(typed))
    assert not said.passed
    assert said.reason.startswith(f"{min(one, two)} and {max(one, two)} in `fig_8` are right on your record, but typed")


def test_errors_that_the_code_writes() -> None:
    assert _counted(edited(FIGURE)) == {}
    assert _counted(edited(FIGURE, ("MSE, first", "Ts = 0.75 s. MSE, first"))) == {}
