"""The bars of the grading: what reaches them, what misses them, and the table. What is measured has its own tests."""

from decimal import Decimal

import pytest
from bars_grading_figures import Figure, at_least, at_most, every, markdown, none


@pytest.mark.parametrize(
    ("figure", "reached"),
    [
        (at_most("t", 0.2, 0.5, 0.2, "s"), "aim"),
        (at_most("t", 0.5, 0.5, 0.2, "s"), "must"),
        (at_most("t", 0.51, 0.5, 0.2, "s"), "missed"),
        (at_least("x", 25.0, 10, 25, "times"), "aim"),
        (at_least("x", 10.0, 10, 25, "times"), "must"),
        (at_least("x", 9.9, 10, 25, "times"), "missed"),
        (every("n", 7, 7), "aim"),
        (every("n", 6, 7), "missed"),
        (every("n", 0, 0), "missed"),
        (none("n", 0, 0, Decimal("0.0")), "aim"),
        (none("n", 0, Decimal("0.05")), "missed"),
    ],
)
def test_a_figure_stands_beside_its_bars(figure: Figure, reached: str) -> None:
    assert figure.reached == reached


def test_the_table_in_markdown() -> None:
    figures = [none("attacks: points / files", Decimal("0.05"), 0), at_most("a check", 0.1234, 0.5, 0.2, "s")]
    assert markdown(figures).splitlines() == [
        "| figure | measured | must | aim | reached |",
        "| --- | --- | --- | --- | --- |",
        "| attacks: points / files | 0.05 / 0 | 0 / 0 | 0 / 0 | missed |",
        "| a check | 0.123 s | 0.5 s | 0.2 s | aim |",
    ]
