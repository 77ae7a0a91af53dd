"""Two mistakes at once: pairs of edits, factors of terms, and the recursion that an output obeys."""

import numpy as np
import pytest
from scipy.signal import lfilter

from labsid.checks.double_mistakes import FACTORS, TWO, Edit, pairs_of, told_factors, with_factors
from labsid.checks.recursions import RECURSION, Factor, terms_of, told_of_terms, with_recursion
from labsid.checks.verdict import Verdict

RNG = np.random.default_rng(49)
U, E = RNG.standard_normal((2, 40))
A, B, C = np.array([1.0, -1.2, 0.5]), np.array([0.0, 0.8, -0.3]), np.array([1.0, 0.4])
ASKED = {
    ("y", 1): Factor("-a1", 1.2),
    ("y", 2): Factor("-a2", -0.5),
    ("u", 1): Factor("b1", 0.8),
    ("u", 2): Factor("b2", -0.3),
}
REFUSED = Verdict(False, "not the free run")


def made(first: float = 2.0, second: float = 3.0, power: float = 1.0) -> float:
    return (first + second) ** power


def test_a_pair_is_named_by_both_and_by_no_other() -> None:
    edits = (Edit("first", 5.0, "first is 5"), Edit("second", 7.0, "second is 7"), Edit("power", 2.0, "squared"))
    slips = {round(slip.wrong(), 9): slip for slip in pairs_of("`f`", edits, made)}
    assert set(slips) == {12.0, 64.0, 81.0}
    assert slips[12.0].hint == "`f` has two mistakes: first is 5; second is 7."
    assert {slip.name for slip in slips.values()} == {TWO}


def test_pairs_that_give_one_value_are_not_told() -> None:
    edits = (Edit("first", 5.0, "a"), Edit("first", 6.0, "b"), Edit("second", 7.0, "c"), Edit("second", 6.0, "d"))
    assert sorted(slip.wrong() for slip in pairs_of("`f`", edits, made)) == [11.0, 13.0]  # 12 is made in two ways


@pytest.mark.parametrize(("first", "power"), [(-3.0, -1.0), (-5.0, 0.5), (np.inf, 2.0)])
def test_a_pair_that_gives_no_real_number_is_left_out(first: float, power: float) -> None:
    edits = (Edit("first", first, "a"), Edit("power", power, "b"))
    assert list(pairs_of("`f`", edits, made)) == []


def test_factors_of_terms_are_told_and_right_ones_are_not() -> None:
    x, y = RNG.standard_normal((2, 4))
    terms, asked = {"A x": x, "A'x": y}, {"A x": 1.0, "A'x": 1.0}
    assert told_factors("`g`", x + 2 * y, terms, asked) == "`g` is A x + 2 A'x; asked for is A x + A'x."
    assert told_factors("`g`", -y, terms, asked) == "`g` is -A'x; asked for is A x + A'x."
    assert told_factors("`g`", 0 * y, terms, asked) == "`g` is zero; asked for is A x + A'x."
    assert told_factors("`g`", x + y, terms, asked) == ""
    assert told_factors("`g`", x * y, terms, asked) == ""
    assert told_factors("`g`", x[:2], {"A x": x[:2], "A'x": y[:2]}, asked) == ""  # any two numbers are such a sum


def test_factors_are_told_where_no_mistake_is_named() -> None:
    x, y = RNG.standard_normal((2, 4))
    terms, asked = {"x": x, "y": y}, {"x": 1.0, "y": 1.0}
    assert with_factors(REFUSED, "`g`", x - y, terms, asked).slip == FACTORS
    named = Verdict(False, "the sign", "sign")
    assert with_factors(named, "`g`", x - y, terms, asked) is named
    assert with_factors(REFUSED, "`g`", x * y, terms, asked) is REFUSED


@pytest.mark.parametrize(
    ("y", "said"),
    [
        (lfilter(B, A * [1, -1, -1], U), "the sign of a1 and a2 is the other one."),
        (lfilter(B[1:], np.r_[1, A[:0:-1]], U), "a1 and a2 are exchanged; u is one sample early."),
        (lfilter(np.r_[0, B], A, U), "u is one sample late."),
        (lfilter([0, 0.8], A, U), r"u(k-2) is missing."),
        (lfilter([0, 0.8, 1.2], A, U), "the factor of u(k-2) is -a1 and not b2."),
        (lfilter([0.7, 0.8, -0.3], A, U), "u(k) does not belong into it."),
        (-lfilter(B, A, U), "it is right but for its sign."),
    ],
)
def test_the_recursion_of_an_output_is_found_and_told(y: np.ndarray, said: str) -> None:
    verdict = with_recursion(REFUSED, ("y", y), {"u": U}, ASKED)
    assert verdict.slip == RECURSION
    assert verdict.reason.startswith("What you computed obeys y(k) = ")
    assert verdict.reason.endswith(said)


def test_measured_outputs_in_a_recursion_are_told() -> None:
    y = lfilter(B, A, U) + 0.1 * E
    predicted = np.r_[0, 0, 1.2 * y[1:-1] - 0.5 * y[:-2] + 0.8 * U[1:-1] - 0.3 * U[:-2]]
    asked = {("s" if name == "y" else name, lag): factor for (name, lag), factor in ASKED.items()}
    verdict = with_recursion(REFUSED, ("s", predicted), {"u": U, "y": y}, asked, "y")
    assert "the past outputs in it are the *measured* ones, `y`" in verdict.reason


@pytest.mark.parametrize(
    "y",
    [
        lfilter(B, A, U),  # right
        lfilter(B, A, U) + E,  # no recursion of u
        lfilter([0.3, 0.1], [1, -0.7, 0.2], U),  # another model altogether
        np.full(40, np.nan),
        lfilter(B, A, U)[:8],
        np.zeros(40),
    ],
)
def test_nothing_is_told_of_other_outputs(y: np.ndarray) -> None:
    assert with_recursion(REFUSED, ("y", y), {"u": U[: y.size]}, ASKED) is REFUSED


def test_terms_are_found_with_their_factors() -> None:
    found = terms_of(("y", lfilter(B, A, U) + lfilter(C, A, E)), {"u": U, "e": E}, 3)
    assert found == pytest.approx(
        {("y", 1): 1.2, ("y", 2): -0.5, ("u", 1): 0.8, ("u", 2): -0.3, ("e", 0): 1.0, ("e", 1): 0.4}
    )


def test_a_signal_that_is_missing_or_does_not_belong_is_told() -> None:
    assert told_of_terms("y", {("y", 1): 1.2, ("y", 2): -0.5}, ASKED).endswith("u is missing.")
    found = {key: factor.value for key, factor in ASKED.items()} | {("e", 0): 2.0}
    assert told_of_terms("y", found, ASKED).endswith("+ 2 e(k): e does not belong into it.")
