"""The definitions in a cell: what is there for later cells though the cell is not run."""

import pytest

from autograder.course.definitions import defined_functions, definitions_in
from autograder.course.layout import Course, read_template


@pytest.mark.parametrize(
    ("source", "expected"),
    [
        ("import numpy as np", "import numpy as np"),
        ("from numpy import linalg", "from numpy import linalg"),
        ("inv = np.linalg.inv", "inv = np.linalg.inv"),
        ("slope, sigma = 0.01, -1.0", "slope, sigma = (0.01, -1.0)"),
        ("name = other = 'text'", "name = other = 'text'"),
        ("def f(x):\n    y = x\n    return y", "def f(x):\n    y = x\n    return y"),
        ("class A:\n    pass", "class A:\n    pass"),
        ("%matplotlib inline\nN = 3", "N = 3"),
        ("!ls\nN = 3", "N = 3"),
        ("theta = 0.0\nfor k in range(3):\n    theta = k", ""),
        ("n = 0\nn += 1", ""),
        ("i = 1\nfor i in range(3):\n    pass", ""),
        ("x = np.zeros(3)\nx[0] = 1", ""),
        ("history = []", ""),
        ("print(f(3))", ""),
        ("if True:\n    import numpy", ""),
    ],
)
def test_definitions(source: str, expected: str) -> None:
    assert definitions_in(source) == expected


def test_defined_functions() -> None:
    source = "def f():\n    def inner():\n        pass\nx = 1\ndef g():\n    pass"
    assert defined_functions(source) == ("f", "g")


def test_the_helpers_that_demonstrations_hand_over(course: Course) -> None:
    cells = [cell for name in course.assignments() for cell in read_template(course, name).cells]
    sources = [definitions_in(cell.source) for cell in cells if cell.kind == "demonstration"]
    found = {name for source in sources for name in defined_functions(source)}
    assert {"delay", "numerical_jacobian", "autocorrelation", "armax_columns"} <= found
    assert "inv = np.linalg.inv" in sources
