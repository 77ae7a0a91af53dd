"""What the code of an answer holds: numbers, calls, and where its functions end."""

import pytest

from labsid.checks.answer_code import AnswerCode, code_of, ended_early, function_in, nothing_returned


class Asked:
    """Knows the code of one function, or nothing."""

    def __init__(self, text: str) -> None:
        self.text = text

    def source_of(self, name: str = "") -> str:
        return self.text


def test_numbers_and_calls_are_read() -> None:
    code = AnswerCode("tau = 2 / 3 * (t[np.argmax(y >= 0.632)] - t_28) / 1.5 + 1 / 0\n")
    assert {0.632, 2 / 3, 1 / 1.5, 2.0, 3.0, 1.5} <= code.numbers
    assert code.calls == {"argmax"}
    assert code.has(0.63, within=0.02)
    assert not code.has(0.5, within=0.02)
    assert code.reads("t_28")
    assert not code.reads("tau")


@pytest.mark.parametrize("text", ["t = (", "%matplotlib inline", "x = 1" + "0" * 400])
def test_code_that_cannot_be_read_holds_nothing(text: str) -> None:
    assert not AnswerCode(text).has(1.0)
    assert not AnswerCode(text).has_loop


@pytest.mark.parametrize(
    ("body", "loop"),
    [
        ("    while u[n] == u[0]:\n        n += 1\n        return n\n", "while u[n] == u[0]"),
        ("    for k in range(3):  # rows\n        return k\n", "for k in range(3)"),
        ("    for k in range(3):\n        if k:\n            return k\n", ""),
        ("    for k in range(3):\n        if k:\n            continue\n        return k\n", ""),
        ("    for k in range(3):\n        n += k\n    return n\n", ""),
    ],
)
def test_a_loop_that_ends_in_its_first_pass_is_told(body: str, loop: str) -> None:
    text = f"def f(u):\n    n = 1\n{body}"
    assert AnswerCode(text).ends_in_first_pass == loop
    assert (f"the loop `{loop}`" in ended_early("f", text)) is bool(loop)


@pytest.mark.parametrize(
    ("body", "said"),
    [
        ("n = 1", "returns nothing: end it with `return` and theta."),
        ("for k in u: n = k", "returns nothing: end it with `return` and theta, after its loops."),
        ("return print(u)", "hands back what `print` returns, and `print` returns None"),
        ("for k in u:\n        return k", "`return k` stands inside the loop `for k in u`"),
        ("if u:\n        return u", "inside a condition or a loop, and was not reached"),
        ("return u.get('x')", "what its `return u.get('x')` hands back is None"),
    ],
)
def test_why_a_function_returns_nothing_is_told(body: str, said: str) -> None:
    refused = nothing_returned(Asked(f"def f(u):\n    {body}\n"), "f", "theta", "nothing")
    assert said in str(refused)
    assert refused.slip == "nothing"


def test_without_the_code_no_cause_is_named() -> None:
    assert code_of(object(), "f") is None
    assert str(nothing_returned(object(), "f")) == (
        "`f` returns nothing: end it with `return` and the result, after its loops."
    )


def test_the_last_function_of_a_name_is_found() -> None:
    source = "def f(x):\n    return 1\n\n\ndef g(x):\n    return 2\n\n\ndef f(x):\n    return 3\n"
    assert function_in(source, "f") == "def f(x):\n    return 3"
    assert function_in(source, "h") == ""
    assert function_in("def f(", "f") == ""
