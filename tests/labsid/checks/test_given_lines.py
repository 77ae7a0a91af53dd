"""Given lines that a student deleted from a cell for answers are put back, as far as nothing replaces them."""

import pytest

from labsid.checks.given_lines import MAX_CHARACTERS, put_back

RELEASED = """u = np.array([1.0, 2])
theta = np.ones(2)
theta[1] = np.exp(theta[1])


def fit(x, y):
    # Your code here
    pass


line, sse = fit(u, u)
print("line", line)
fig"""
DONE = RELEASED.replace("    # Your code here\n    pass", "    return x, y")


@pytest.mark.parametrize(
    ("deleted", "put"),
    [
        (("print", "fig"), ()),
        (("line",), ("line, sse = fit(u, u)",)),
        (("u ",), ("u = np.array([1.0, 2])",)),
        (("theta",), ("theta = np.ones(2)", "theta[1] = np.exp(theta[1])")),
        (("theta", "line"), ("theta = np.ones(2)", "theta[1] = np.exp(theta[1])", "line, sse = fit(u, u)")),
    ],
)
def test_what_is_deleted_is_put_back_where_it_was(deleted: tuple[str, ...], put: tuple[str, ...]) -> None:
    left = [line for line in DONE.split("\n") if not line.startswith(deleted)]
    source, lines = put_back(RELEASED, "\n".join(left))
    assert lines == put
    written = [line for line in source.split("\n") if line]
    assert written == [line for line in DONE.split("\n") if line and (line in left or line in put)]


@pytest.mark.parametrize(
    "replaced",
    ["line, sse = 1, 2", "line = fit(u, u)[0]", "for line in range(2):\n    pass", "def line():\n    return 1"],
)
def test_a_line_that_is_replaced_stays_replaced(replaced: str) -> None:
    answer = DONE.replace("line, sse = fit(u, u)", replaced)
    assert put_back(RELEASED, answer) == (answer, ())


@pytest.mark.parametrize("answer", ["", RELEASED, "def fit(:", "x;" * MAX_CHARACTERS, "(" * 5000])
def test_what_is_no_answer_or_cannot_be_read_stays_as_it_is(answer: str) -> None:
    assert put_back(RELEASED, answer) == (answer, ())


def test_an_answer_in_two_parts() -> None:
    released = "def f(u):\n    # Your code here\n    pass\nn = f(u)\n# Your code here\npass"
    answer = "def f(u):\n    return 1\nplot(n)"
    assert put_back(released, answer) == ("def f(u):\n    return 1\nn = f(u)\nplot(n)", ("n = f(u)",))


def test_a_place_for_an_answer_may_be_written_as_three_dots() -> None:
    assert put_back("...\nn = f(u)", "def f(u):\n    return 1") == ("def f(u):\n    return 1\nn = f(u)", ("n = f(u)",))
