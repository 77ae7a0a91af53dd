"""The recursive lecture: from a running mean to RLS with forgetting, online use, and what goes wrong with it."""

from labsid.checks.assignments.recursive_identification.basics import check_information, check_mean, check_step
from labsid.checks.assignments.recursive_identification.forgetting_runs import (
    check_figures,
    check_forgetting,
    check_regressors,
    new_histories,
    right_histories,
    right_regressors,
)
from labsid.checks.assignments.recursive_identification.limits import check_careless, check_windup
from labsid.checks.assignments.recursive_identification.online_use import check_drift, check_online
from labsid.checks.assignments.recursive_identification.stages import STAGES
from labsid.checks.question import Assignment, FollowsFrom, Question

_REGRESSORS, _FORGETTING = "ri-4-regressors", "ri-5-forgetting"

ASSIGNMENT = Assignment(
    "recursive-identification",
    (
        Question("ri-1-mean", check_mean),
        Question("ri-2-information", check_information),
        Question("ri-3-step", check_step),
        Question(_REGRESSORS, check_regressors, right_regressors, follows_from=FollowsFrom.TEXT),
        Question(_FORGETTING, check_forgetting, right_histories, uses=(_REGRESSORS,), follows_from=FollowsFrom.TEXT),
        Question(
            "ri-6-figures", check_figures, uses=(_FORGETTING,), follows_from=FollowsFrom.TEXT, instance=new_histories
        ),
        Question("ri-7-online", check_online),
        Question("ri-8-drift", check_drift),
        Question("ri-9-windup", check_windup),
        Question("ri-10-careless", check_careless),
    ),
    stages=STAGES,
)
