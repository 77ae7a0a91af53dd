"""The post-lab: a first-order model beside the second-order one, and which to take."""

from labsid.checks.assignments.postlab_model_order.first_order_model import (
    check_errors,
    check_figure_8,
    check_fit_order,
    check_phi,
    check_simulations,
    check_theta,
    check_transfer_function,
    right_errors,
    right_phi,
    right_second_order,
    right_simulations,
    right_theta,
    right_transfer_function,
)
from labsid.checks.assignments.postlab_model_order.stages import STAGES
from labsid.checks.practice_records import offset_free_signals_of, tank_record
from labsid.checks.question import Assignment, Question

_PHI, _THETA, _FIT = "postlab-1-phi", "postlab-1-theta", "postlab-2-fit-order"
_RUNS, _MSE = "postlab-2-simulation", "postlab-3-mse"

ASSIGNMENT = Assignment(
    "postlab-model-order",
    (
        Question(_PHI, check_phi, right_phi),
        Question(_THETA, check_theta, right_theta, (_PHI,)),
        Question("postlab-1-transfer-function", check_transfer_function, right_transfer_function, (_THETA,)),
        Question(_FIT, check_fit_order, right_second_order),
        Question(_RUNS, check_simulations, right_simulations, (_THETA, _FIT)),
        Question(_MSE, check_errors, right_errors, (_RUNS,)),
        Question("postlab-3-figure-8", check_figure_8, uses=(_RUNS, _MSE)),
    ),
    record_file="SysIdenData_StudentVersion.mat",
    stages=STAGES,
    practice_record=tank_record,
    practice_given=offset_free_signals_of,
)
