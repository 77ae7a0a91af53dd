"""A check from a generator of verdicts, and slips that match an answer."""

from collections.abc import Iterator

import pytest

from labsid.checks.verdict import NoAnswer, Slip, Verdict, first_failure, judge, told_if_singular


def test_the_first_failure_is_the_verdict_and_nothing_after_it_is_run() -> None:
    run = []

    @first_failure
    def check(*passed: bool) -> Iterator[Verdict]:
        for number, one in enumerate(passed):
            run.append(number)
            yield Verdict(one, f"part {number}")

    assert check(True, False, True, False) == Verdict(False, "part 1")
    assert run == [0, 1]
    assert check(True, True) == Verdict(True, "part 1")


def test_how_to_correct_a_slip_is_told_apart_from_what_is_wrong() -> None:
    slips = [Slip("sign", "the sign.", lambda: -2, "Turn it."), Slip("half", "half of it.", lambda: 1)]
    sign, half = (judge(got, 2, lambda a, b: a == b, "right", "wrong", slips) for got in (-2, 1))
    assert (sign.reason, sign.mend, sign.whole_reason) == ("the sign.", "Turn it.", "the sign. Turn it.")
    assert half.whole_reason == half.reason == "half of it."


def test_a_slip_is_named_unless_it_gives_the_right_value_or_none() -> None:
    slips = [
        Slip("not computable", "never", lambda: int("x")),
        Slip("same as right", "never", lambda: 2),
        Slip("sign", "the sign", lambda: -2),
    ]

    def verdict(got: int) -> Verdict:
        return judge(got, 2, lambda a, b: a == b, "right", "wrong", slips)

    assert verdict(2) == Verdict(True, "right")
    assert verdict(-2) == Verdict(False, "the sign", "sign")
    assert verdict(5) == Verdict(False, "wrong")


def test_a_mistake_within_the_tolerance_is_told_from_the_right_value_by_a_closer_comparison() -> None:
    slips = [Slip("root mean square", "it is not of the mean", lambda: 2.05)]

    def verdict(got: float) -> Verdict:
        near, exactly = (lambda a, b: abs(a - b) < 0.1), (lambda a, b: abs(a - b) < 1e-9)
        return judge(got, 2.0, near, "right", "wrong", slips, exactly)

    assert verdict(2.0).passed
    assert verdict(2.05).slip == "root mean square"
    assert verdict(2.04).passed
    assert verdict(3.1) == Verdict(False, "wrong")


def test_of_two_mistakes_within_the_tolerance_the_exact_one_is_told() -> None:
    slips = [Slip("near", "near", lambda: 5.0), Slip("exact", "exact", lambda: 5.05), Slip("far", "far", lambda: 7.0)]

    def slip(got: float) -> str | None:
        near, exactly = (lambda a, b: abs(a - b) < 0.1), (lambda a, b: abs(a - b) < 1e-9)
        return judge(got, 2.0, near, "right", "wrong", slips, exactly).slip

    assert (slip(5.05), slip(5.0), slip(5.02), slip(7.05)) == ("exact", "near", "near", "far")


def test_a_singular_matrix_is_told_what_it_means_in_its_question_and_nothing_else_is() -> None:
    for stopped, told in (("LinAlgError: Singular matrix", "no inverse here"), ("ValueError: shapes", "shapes")):
        with pytest.raises(NoAnswer, match=told), told_if_singular("no inverse here", "inverse"):
            raise NoAnswer(stopped)
