"""What a hidden run may leave out: cells on which nothing depends, and figures drawn of values that are judged."""

import pytest

from autograder.intake.submission import NotebookCell
from autograder.judge.needed_cells import cells_needed, draws_known_values


def notebook(*cells: tuple[str, str, str]) -> list[NotebookCell]:
    return [NotebookCell(cell_id, kind, source, kind != "text") for cell_id, kind, source in cells]


CELLS = notebook(
    ("setup", "given", "import numpy as np"),
    ("load", "given", "record = load('x')\nu, y = record.u, record.y"),
    ("look", "given", "fig = plt.figure()"),
    ("a-answer", "answer", "a = np.mean(y)"),
    ("a", "question", "check('a')"),
    ("b-answer", "answer", "b = 3"),
    ("b", "question", "check('b')"),
    ("", "extra", "helper = lambda x: x * scale\nscale = 2"),
    ("c-answer", "answer", "c = helper(a)"),
    ("c", "question", "check('c')"),
    ("d-answer", "answer", "d = c"),
    ("d", "question", "check('d')"),
)


@pytest.mark.parametrize(
    ("asked", "left"),
    [
        ({"a"}, ["setup", "load", "a-answer", "a"]),
        ({"b"}, ["b-answer", "b"]),
        ({"c"}, ["setup", "load", "a-answer", "", "c-answer", "c"]),
        ({"a", "d"}, ["setup", "load", "a-answer", "a", "", "c-answer", "d-answer", "d"]),
    ],
)
def test_cells_on_which_no_question_depends_are_left_out(asked: set[str], left: list[str]) -> None:
    names = {one: (one,) for one in "abcd"}
    assert [cell.id for cell in cells_needed(CELLS, asked, names)] == left


def test_a_value_that_is_changed_by_an_assignment_is_seen() -> None:
    cells = notebook(("", "given", "y = [1, 2]"), ("", "extra", "y[0] = 5"), ("q", "question", "check('q')"))
    assert len(cells_needed(cells, {"q"}, {"q": ("y",)})) == 3


PLOT = "fig, ax = plt.subplots(2, 1, figsize=(8, 6))\nax[0].plot(t, y, label='Output, second order')"


@pytest.mark.parametrize(
    ("before", "answer", "is_drawn"),
    [
        ("", PLOT, True),
        ("scale = 2", f"{PLOT}\nax[0].plot(t, scale * y)", True),
        ("from numpy import ravel", f"{PLOT}\nax[0].plot(t, ravel(y))", True),
        ("", f"{PLOT}\nax[0].text(0.02, 0.97, f'MSE {{np.mean(y):.3e}}')", True),
        ("", f"{PLOT}\nax[0].text(0.02, 0.97, 'MSE 1.053e-3')", False),
        ("", f"{PLOT}\nax[0].plot(t, {list(range(50))})", False),
        ("saved = " + repr([0.5] * 60), f"{PLOT}\nax[0].plot(t, saved)", False),
        ("saved = 'x" + "a" * 200 + "'", f"{PLOT}\nax[0].plot(t, decoded(saved))", False),
        ("def f():\n    return eval('y')", f"{PLOT}\nax[0].plot(t, f())", False),
        ("", f"{PLOT}\nax[0].plot(t, globals()['y'])", False),
        ("import pickle", f"{PLOT}\nax[0].plot(t, pickle.loads(y))", False),
        ("n = " + "9" * 40, f"{PLOT}\nax[0].plot(t, n)", False),
        ("", "fig = (", False),
    ],
)
def test_a_figure_is_left_out_only_if_nothing_typed_in_is_drawn(before: str, answer: str, is_drawn: bool) -> None:
    cells = notebook(
        ("setup", "given", "import numpy as np\nimport matplotlib.pyplot as plt"),
        ("", "extra", before),
        ("y-answer", "answer", "t, y = compute(12)"),
        ("y", "question", "check('y')"),
        ("f-answer", "answer", answer),
        ("f", "question", "check('f')"),
    )
    assert draws_known_values(cells, "f", {"t", "y"}) is is_drawn
