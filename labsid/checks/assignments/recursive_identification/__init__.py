"""The recursive lecture: from a running mean to RLS with forgetting, online use, and what goes wrong with it."""

from labsid.checks.assignments.recursive_identification.basics import information, mean, step
from labsid.checks.assignments.recursive_identification.forgetting_runs import (
    figures,
    forgetting,
    regressors,
    right_histories,
    right_regressors,
)
from labsid.checks.assignments.recursive_identification.limits import careless, windup
from labsid.checks.assignments.recursive_identification.online_use import drift, online
from labsid.checks.question import Assignment, Question

_REGRESSORS, _FORGETTING = "ri-4-regressors", "ri-5-forgetting"

ASSIGNMENT = Assignment(
    "recursive-identification",
    (
        Question("ri-1-mean", mean),
        Question("ri-2-information", information),
        Question("ri-3-step", step),
        Question(_REGRESSORS, regressors, right_regressors),
        Question(_FORGETTING, forgetting, right_histories, uses=(_REGRESSORS,)),
        Question("ri-6-figures", figures, uses=(_FORGETTING,)),
        Question("ri-7-online", online),
        Question("ri-8-drift", drift),
        Question("ri-9-windup", windup),
        Question("ri-10-careless", careless),
    ),
)
