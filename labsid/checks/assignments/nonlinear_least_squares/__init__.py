"""The nonlinear lecture: exponentials, Gauss-Newton, Levenberg-Marquardt, starting values, ranges, output error."""

from labsid.checks.assignments.nonlinear_least_squares.exponential_fits import (
    check_exponential_fit,
    check_jacobian,
    check_logarithm,
)
from labsid.checks.assignments.nonlinear_least_squares.iterations import check_damping, check_gauss_newton
from labsid.checks.assignments.nonlinear_least_squares.recorded_fits import check_output_error, check_step
from labsid.checks.assignments.nonlinear_least_squares.stages import STAGES
from labsid.checks.assignments.nonlinear_least_squares.starts_and_positions import (
    check_frequency,
    check_layout,
    check_locate,
    right_layout,
)
from labsid.checks.question import Assignment, FollowsFrom, Question

ASSIGNMENT = Assignment(
    "nonlinear-least-squares",
    (
        Question("nl-1-logarithm", check_logarithm),
        Question("nl-2-jacobian", check_jacobian),
        Question("nl-3-gauss-newton", check_gauss_newton),
        Question("nl-4-damping", check_damping),
        Question("nl-5-exponential", check_exponential_fit, follows_from=FollowsFrom.TEXT),
        Question("nl-6-frequency", check_frequency),
        Question("nl-7-locate", check_locate),
        Question("nl-7-layout", check_layout, reference=right_layout),
        Question("nl-8-step", check_step),
        Question("nl-9-output-error", check_output_error),
    ),
    stages=STAGES,
)
