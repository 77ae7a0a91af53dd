"""The least-squares lecture: quadratic forms, derivations, examples, geometry, all solutions, weights, confidence."""

from labsid.checks.assignments.least_squares.constraints import check_constrained, check_known_parameter, check_weighted
from labsid.checks.assignments.least_squares.forms_and_derivatives import (
    check_delays,
    check_derivatives,
    check_kind,
    kind_of_form,
)
from labsid.checks.assignments.least_squares.geometry import check_all_solutions, check_projector
from labsid.checks.assignments.least_squares.inference import check_cayley_hamilton, check_confidence
from labsid.checks.assignments.least_squares.stages import STAGES
from labsid.checks.assignments.least_squares.sums_of_powers import check_figure_5, check_fits, new_models, right_fits
from labsid.checks.question import Assignment, FollowsFrom, Question

_FITS = "ls-4-fits"

ASSIGNMENT = Assignment(
    "least-squares",
    (
        Question("ls-1-kind", check_kind, reference=kind_of_form),
        Question("ls-2-delays", check_delays),
        Question("ls-3-derivatives", check_derivatives),
        Question(_FITS, check_fits, right_fits, follows_from=FollowsFrom.TEXT),
        Question("ls-4-figure-5", check_figure_5, uses=(_FITS,), follows_from=FollowsFrom.TEXT, instance=new_models),
        Question("ls-5-projector", check_projector),
        Question("ls-6-all-solutions", check_all_solutions),
        Question("ls-7-known", check_known_parameter),
        Question("ls-8-weighted", check_weighted),
        Question("ls-9-constrained", check_constrained),
        Question("ls-10-confidence", check_confidence),
        Question("ls-11-cayley-hamilton", check_cayley_hamilton),
    ),
    stages=STAGES,
)
