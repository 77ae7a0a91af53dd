"""The lecture on model structures: shift operator, forms of a model, prediction, excitation, order, residuals."""

from labsid.checks.assignments.model_structures.model_choice import autocorrelation, cancel, excitation
from labsid.checks.assignments.model_structures.model_forms import equations, state_space
from labsid.checks.assignments.model_structures.order_choice import order
from labsid.checks.assignments.model_structures.signals import shift, simulate
from labsid.checks.assignments.model_structures.systems_1_and_2 import (
    example_3_1,
    figure_8,
    predict,
    right_outputs,
    right_tables,
)
from labsid.checks.question import Assignment, Question

_TABLE, _PREDICT = "ms-5-example-3-1", "ms-6-predict"

ASSIGNMENT = Assignment(
    "model-structures",
    (
        Question("ms-2-shift", shift),
        Question("ms-3-state-space", state_space),
        Question("ms-4-equations", equations),
        Question("ms-5-simulate", simulate),
        Question(_TABLE, example_3_1, right_tables),
        Question(_PREDICT, predict, right_outputs, uses=(_TABLE,)),
        Question("ms-6-figure-8", figure_8, uses=(_PREDICT,)),
        Question("ms-7-excitation", excitation),
        Question("ms-8-order", order),
        Question("ms-9-cancel", cancel),
        Question("ms-10-autocorrelation", autocorrelation),
    ),
)
