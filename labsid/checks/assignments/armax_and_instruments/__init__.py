"""The lecture on coloured noise: bias and its limit, ARMAX by pseudo-linear regression, instruments, likelihood."""

from labsid.checks.assignments.armax_and_instruments.extended_least_squares import (
    check_figure_14,
    check_rels,
    new_history,
    right_history,
)
from labsid.checks.assignments.armax_and_instruments.instruments import check_iterated, check_recursive
from labsid.checks.assignments.armax_and_instruments.many_records import check_bias, check_tables, right_tables
from labsid.checks.assignments.armax_and_instruments.pseudo_linear_regression import check_armax
from labsid.checks.assignments.armax_and_instruments.stages import STAGES
from labsid.checks.assignments.armax_and_instruments.theory import check_covariance, check_likelihood, check_limit
from labsid.checks.question import Assignment, FollowsFrom, Question

_RELS = "ai-6-rels"

ASSIGNMENT = Assignment(
    "armax-and-instruments",
    (
        Question("ai-1-tables", check_tables, right_tables, follows_from=FollowsFrom.TEXT),
        Question("ai-2-bias", check_bias),
        Question("ai-3-limit", check_limit),
        Question("ai-4-covariance", check_covariance),
        Question("ai-5-armax", check_armax),
        Question(_RELS, check_rels, right_history, follows_from=FollowsFrom.TEXT),
        Question("ai-6-figure-14", check_figure_14, uses=(_RELS,), follows_from=FollowsFrom.TEXT, instance=new_history),
        Question("ai-7-iterated", check_iterated),
        Question("ai-8-recursive", check_recursive),
        Question("ai-9-likelihood", check_likelihood),
    ),
    stages=STAGES,
)
