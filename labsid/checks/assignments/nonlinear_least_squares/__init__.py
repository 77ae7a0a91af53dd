"""The nonlinear lecture: exponentials, Gauss-Newton, Levenberg-Marquardt, starting values, ranges, output error."""

from labsid.checks.assignments.nonlinear_least_squares.exponential_fits import exponential_fit, jacobian, logarithm
from labsid.checks.assignments.nonlinear_least_squares.iterations import damping, gauss_newton
from labsid.checks.assignments.nonlinear_least_squares.recorded_fits import output_error, step
from labsid.checks.assignments.nonlinear_least_squares.starts_and_positions import frequency, layout, locate
from labsid.checks.question import Assignment, Question

ASSIGNMENT = Assignment(
    "nonlinear-least-squares",
    (
        Question("nl-1-logarithm", logarithm),
        Question("nl-2-jacobian", jacobian),
        Question("nl-3-gauss-newton", gauss_newton),
        Question("nl-4-damping", damping),
        Question("nl-5-exponential", exponential_fit),
        Question("nl-6-frequency", frequency),
        Question("nl-7-locate", locate),
        Question("nl-7-layout", layout),
        Question("nl-8-step", step),
        Question("nl-9-output-error", output_error),
    ),
)
