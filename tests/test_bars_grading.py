"""The bars of the grading: what reaches them, what misses them, and the table. What is measured has its own tests."""

from decimal import Decimal

import pytest
from bars_grading_figures import Metric, at_least, at_most, every, markdown, none


@pytest.mark.parametrize(
    ("metric", "status"),
    [
        (at_most("t", 0.2, 0.5, 0.2, "s"), "target"),
        (at_most("t", 0.5, 0.5, 0.2, "s"), "required"),
        (at_most("t", 0.51, 0.5, 0.2, "s"), "missed"),
        (at_least("x", 25.0, 10, 25, "times"), "target"),
        (at_least("x", 10.0, 10, 25, "times"), "required"),
        (at_least("x", 9.9, 10, 25, "times"), "missed"),
        (every("n", 7, 7), "target"),
        (every("n", 6, 7), "missed"),
        (every("n", 0, 0), "missed"),
        (none("n", 0, 0, Decimal("0.0")), "target"),
        (none("n", 0, Decimal("0.05")), "missed"),
    ],
)
def test_a_figure_stands_beside_its_bars(metric: Metric, status: str) -> None:
    assert metric.status == status


def test_the_table_in_markdown() -> None:
    metrics = [none("attacks: points / files", Decimal("0.05"), 0), at_most("a check", 0.1234, 0.5, 0.2, "s")]
    assert markdown(metrics).splitlines() == [
        "| metric | measured | required | target | status |",
        "| --- | --- | --- | --- | --- |",
        "| attacks: points / files | 0.05 / 0 | 0 / 0 | 0 / 0 | missed |",
        "| a check | 0.123 s | 0.5 s | 0.2 s | target |",
    ]
