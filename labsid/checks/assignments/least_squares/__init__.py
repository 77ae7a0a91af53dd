"""The least-squares lecture: quadratic forms, derivations, examples, geometry, all solutions, weights, confidence."""

from labsid.checks.assignments.least_squares.constraints import constrained, known_parameter, weighted
from labsid.checks.assignments.least_squares.forms_and_derivatives import delays, derivatives, kind
from labsid.checks.assignments.least_squares.geometry import all_solutions, projector
from labsid.checks.assignments.least_squares.inference import cayley_hamilton, confidence
from labsid.checks.assignments.least_squares.sums_of_powers import figure_5, fits, right_fits
from labsid.checks.question import Assignment, Question

_FITS = "ls-4-fits"

ASSIGNMENT = Assignment(
    "least-squares",
    (
        Question("ls-1-kind", kind),
        Question("ls-2-delays", delays),
        Question("ls-3-derivatives", derivatives),
        Question(_FITS, fits, right_fits),
        Question("ls-4-figure-5", figure_5, uses=(_FITS,)),
        Question("ls-5-projector", projector),
        Question("ls-6-all-solutions", all_solutions),
        Question("ls-7-known", known_parameter),
        Question("ls-8-weighted", weighted),
        Question("ls-9-constrained", constrained),
        Question("ls-10-confidence", confidence),
        Question("ls-11-cayley-hamilton", cayley_hamilton),
    ),
)
