"""The summary of an assignment: marks by question, by part and in total."""

from decimal import Decimal

from labsid.checks.cells import Cell
from labsid.checks.summary import BY_HAND, FAILED, NOT_DONE, PASSED, SKIPPED, states_of, summary_html, summary_text


def question(name: str, points: str, part: str, kind: str = "question") -> Cell:
    return Cell(name, kind, "*Your answer here*", True, Decimal(points), f"Step <{name}>", part)


CELLS = (
    question("a", "0.1", "1. Data"),
    question("b", "0.2", "1. Data"),
    question("c", "0.30", "2. Model"),
    question("d", "0.3", "2. Model"),
    question("e", "0.1", "2. Model", "manual"),
)
FOUND = {"a": PASSED, "b": FAILED, "c": SKIPPED}


def test_the_states() -> None:
    states = states_of(CELLS, FOUND, {"e": "Because it starts from rest."})
    assert [one.state for one in states] == [PASSED, FAILED, SKIPPED, NOT_DONE, BY_HAND]
    assert states_of(CELLS, FOUND, {})[-1].state == NOT_DONE
    assert states_of(CELLS, FOUND, {"b-answer": "# Your code here\npass"})[1].state == NOT_DONE
    assert states_of(CELLS, FOUND, {"b-answer": "y = 3"})[1].state == FAILED


def test_the_text() -> None:
    lines = summary_text("Tiny:", states_of(CELLS, FOUND, {"e": "Rest."})).splitlines()
    assert [" ".join(line.split()) for line in lines] == [
        "Tiny:",
        "1. Data: 0.1 of 0.3 marks",
        "✓ a 0.1 of 0.1 right Step <a>",
        "✗ b 0 of 0.2 not right Step <b>",
        "2. Model: 0 of 0.7 marks; 0.1 of them are given by hand",
        "– c 0 of 0.3 skipped Step <c>",
        "· d 0 of 0.3 not done Step <d>",
        "✎ e up to 0.1 marked by hand Step <e>",
        "Total: 0.1 of 1 marks; 0.1 of them are given by hand",
    ]


def test_the_html_says_the_same() -> None:
    html = summary_html("Tiny:", states_of(CELLS, FOUND, {}))
    assert html.count("<tr>") == 8
    for part in ("Step &lt;a&gt; <code>a</code>", "0.1 of 0.3 marks", "0.1 of 1 marks", ">✗</span>", "skipped"):
        assert part in html
