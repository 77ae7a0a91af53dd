"""The lecture on coloured noise: bias and its limit, ARMAX by pseudo-linear regression, instruments, likelihood."""

from labsid.checks.assignments.armax_and_instruments.extended_least_squares import figure_14, rels, right_history
from labsid.checks.assignments.armax_and_instruments.instruments import iterated, recursive
from labsid.checks.assignments.armax_and_instruments.many_records import bias, right_tables, tables
from labsid.checks.assignments.armax_and_instruments.pseudo_linear_regression import armax
from labsid.checks.assignments.armax_and_instruments.theory import covariance, likelihood, limit
from labsid.checks.question import Assignment, Question

_RELS = "ai-6-rels"

ASSIGNMENT = Assignment(
    "armax-and-instruments",
    (
        Question("ai-1-tables", tables, right_tables),
        Question("ai-2-bias", bias),
        Question("ai-3-limit", limit),
        Question("ai-4-covariance", covariance),
        Question("ai-5-armax", armax),
        Question(_RELS, rels, right_history),
        Question("ai-6-figure-14", figure_14, uses=(_RELS,)),
        Question("ai-7-iterated", iterated),
        Question("ai-8-recursive", recursive),
        Question("ai-9-likelihood", likelihood),
    ),
)
