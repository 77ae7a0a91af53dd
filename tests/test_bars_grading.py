"""The bars of the grading: what reaches them, what misses them, and the table. What is measured has its own tests."""

from decimal import Decimal

import pytest
from attacks.figures import Figures
from bars_grading_figures import Metric, at_least, at_most, every, markdown, none
from bars_grading_parts import of_attacks


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


@pytest.mark.parametrize(
    ("found", "measured", "status"),
    [
        (Figures("landlock", tried=93), "0 / 0 / 0", "target"),
        (Figures("landlock", tried=93, undeserved=0.15), "0.15 / 0 / 0", "missed"),
        (Figures("landlock", tried=93, touched=("gradebook",)), "0 / 0 / 1", "missed"),
        (Figures("landlock", problem="stopped", aborted=True), "- / 1 / -", "missed"),
        (Figures("landlock", problem="not on this machine"), "- / 0 / -", "not tried"),
    ],
)
def test_attacks(found: Figures, measured: str, status: str) -> None:
    (metric,) = of_attacks(found, "landlock", lambda text: None)
    assert (metric.measured, metric.status) == (measured, status)


def test_attacks_that_only_a_sandbox_stops_have_no_bar() -> None:
    closed, opened = of_attacks(Figures("none", tried=85, open=8, open_undeserved=0.9), "none", lambda text: None)
    assert closed.status == "target"
    assert (opened.measured, opened.status) == ("0.9", "warned when grading")
