"""The appendix: step-response modelling (Fig. A1, A2), a step of the real tanks, and linear least squares."""

from labsid.checks.assignments.step_response.example_step import (
    check_approximation,
    check_comparison,
    check_function,
    check_read,
    new_approximation,
    right_approximation,
    right_reading,
)
from labsid.checks.assignments.step_response.formula import check_response
from labsid.checks.assignments.step_response.least_squares_appendix import (
    check_error_vector,
    check_gradient,
    check_loss_function,
    check_minimum,
    check_solve_two,
    check_unique,
    unique_by_rank,
)
from labsid.checks.assignments.step_response.recorded_step import (
    check_held_step,
    check_tank_model,
    give_held_step,
    give_tank_model,
)
from labsid.checks.assignments.step_response.stages import STAGES
from labsid.checks.practice_records import signals_of, tank_record
from labsid.checks.question import Assignment, FollowsFrom, Question

ASSIGNMENT = Assignment(
    "step-response",
    (
        Question("step-1-read", check_read, gives=right_reading, follows_from=FollowsFrom.EYE),
        Question("step-2-response", check_response),
        Question(
            "step-3-mse",
            check_approximation,
            gives=right_approximation,
            uses=("step-1-read",),
            follows_from=FollowsFrom.TEXT,
        ),
        Question(
            "step-3-figure",
            check_comparison,
            uses=("step-3-mse",),
            follows_from=FollowsFrom.TEXT,
            instance=new_approximation,
        ),
        Question("step-5-function", check_function),
        Question("step-6-cut", check_held_step, gives=give_held_step),
        Question("step-6-model", check_tank_model, gives=give_tank_model, uses=("step-6-cut",)),
        Question("step-7-two", check_solve_two),
        Question("step-8-error", check_error_vector),
        Question("step-8-loss", check_loss_function),
        Question("step-8-gradient", check_gradient),
        Question("step-9-minimum", check_minimum),
        Question("step-9-unique", check_unique, reference=unique_by_rank),
    ),
    record_file="SysIdenData_StudentVersion.mat",
    stages=STAGES,
    practice_record=tank_record,
    practice_given=signals_of,
)
