"""The lecture on model structures: shift operator, forms of a model, prediction, excitation, order, residuals."""

from labsid.checks.assignments.model_structures.model_choice import (
    check_autocorrelation,
    check_cancel,
    check_excitation,
)
from labsid.checks.assignments.model_structures.model_forms import check_equations, check_state_space
from labsid.checks.assignments.model_structures.order_choice import check_order
from labsid.checks.assignments.model_structures.signals import check_shift, check_simulate
from labsid.checks.assignments.model_structures.stages import STAGES
from labsid.checks.assignments.model_structures.systems_1_and_2 import (
    check_example_3_1,
    check_figure_8,
    check_predict,
    new_outputs,
    right_outputs,
    right_tables,
)
from labsid.checks.question import Assignment, FollowsFrom, Question
from labsid.lab.excitation import excitation_order

_TABLE, _PREDICT = "ms-5-example-3-1", "ms-6-predict"

ASSIGNMENT = Assignment(
    "model-structures",
    (
        Question("ms-2-shift", check_shift),
        Question("ms-3-state-space", check_state_space),
        Question("ms-4-equations", check_equations),
        Question("ms-5-simulate", check_simulate),
        Question(_TABLE, check_example_3_1, right_tables, follows_from=FollowsFrom.TEXT),
        Question(_PREDICT, check_predict, right_outputs, uses=(_TABLE,), follows_from=FollowsFrom.TEXT),
        Question(
            "ms-6-figure-8", check_figure_8, uses=(_PREDICT,), follows_from=FollowsFrom.TEXT, instance=new_outputs
        ),
        Question("ms-7-excitation", check_excitation, reference=excitation_order),
        Question("ms-8-order", check_order),
        Question("ms-9-cancel", check_cancel),
        Question("ms-10-autocorrelation", check_autocorrelation),
    ),
    stages=STAGES,
)
