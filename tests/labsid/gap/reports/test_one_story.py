"""What finds contradictions in a report finds them, and none in reports that have none."""

import copy

import pytest
from gap_reports import PARAMETERS, UNSIMULATED, report, with_rest
from gap_story import disagreements

from labsid.gap.verdict.black_boxes import KINDS

WHITE = {"whiteness_p": 0.4, "input_correlation_p": 0.6, "share": 0.03, "kinds": None}


def changed(base, **parts):
    """The report with other numbers in some of its parts."""
    other = copy.deepcopy(base)
    for name, values in parts.items():
        other[name] = other[name] | values if isinstance(values, dict) else values
    return other


@pytest.mark.parametrize("name", sorted(set(PARAMETERS) - set(UNSIMULATED)))
def test_a_report_of_one_effect_has_one_story(name):
    assert disagreements(changed(report(name), unexplained=WHITE)) == []


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("verdict", ["partial", "unknown"])
def test_a_report_of_a_rest_has_one_story(verdict, kind):
    base = with_rest(report("input-delay", verdict=verdict), kind)
    closed = base["gap"]["closed"]
    assert disagreements(changed(base, unexplained={"share": 1.0 - (closed or 0.0)})) == []


DELAY = changed(report("input-delay"), unexplained=WHITE)


@pytest.mark.parametrize(
    ("told", "found"),
    [
        (changed(DELAY, gap={"after": 2.0 * DELAY["gap"]["before"]}), "a larger error with the effects than before"),
        (changed(DELAY, gap={"closed": 0.6}), "[0.97] closed with the effects one after the other, and 0.6 in all"),
        (
            changed(DELAY, unexplained={"share": 0.13, "whiteness_p": 0.0}),
            "13 % of the gap remains, and 97 % are closed",
        ),
        (changed(report(verdict="none"), unexplained={"share": 1.0}), "no gap, and a part of it that is left"),
        (
            changed(
                with_rest(report("input-delay", verdict="partial"), "time"), effects=DELAY["effects"], verdict="none"
            ),
            "no gap, and a cause",
        ),
    ],
)
def test_two_statements_that_cannot_both_be_true_are_found(told, found):
    assert found in disagreements(told)
