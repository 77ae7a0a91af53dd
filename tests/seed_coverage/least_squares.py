"""What the assignment `least-squares` covers of the lectures, line by line."""

from seed_coverage.row import VARIANT, Row

ROWS = (
    Row(
        "Reading",
        "L2: quadratic forms and definiteness, Fig. 3 and 4, the second MATLAB program",
        ("labsid.least_squares.quadratic_form:definiteness", "labsid.least_squares.quadratic_form:surface"),
        ("least-squares/ls-1-kind", "least-squares/ls-1-figures-3-and-4"),
        (
            "tests/labsid/least_squares/test_quadratic_form.py::test_kinds",
            "tests/labsid/least_squares/test_quadratic_form.py::test_surface_spans_the_eigenvalues_and_is_zero_in_the_middle",
            VARIANT,
        ),
    ),
    Row(
        "Reading",
        "L2: Examples 2-1, 2-2 and 2-3, rows with delays",
        ("labsid.model_structures.structures:build_equations",),
        ("least-squares/ls-2-delays",),
        (
            "tests/labsid/model_structures/test_structures.py::test_example_2_3_rows_from_rest",
            VARIANT,
        ),
    ),
    Row(
        "Reading",
        "L2: Examples 2-1, 2-2 and 2-4, line and parabola",
        ("labsid.least_squares.curve_fit:fit_powers",),
        ("least-squares/ls-4-fits",),
        (
            "tests/labsid/least_squares/test_curve_fit.py::test_worked_values",
            "tests/labsid/least_squares/test_curve_fit.py::test_the_regressors_of_example_2_4_and_its_normal_equations",
            VARIANT,
        ),
    ),
    Row(
        "Reading",
        "L2: Fig. 5, the first MATLAB program",
        ("labsid.least_squares.curve_fit:fit_powers",),
        ("least-squares/ls-4-figure-5",),
        ("tests/labsid/least_squares/test_curve_fit.py::test_polyfit_agrees", VARIANT),
    ),
    Row(
        "Reading",
        "L2: both derivations of the normal equations",
        ("labsid.least_squares.projection:completed_square", "labsid.least_squares.solve:loss_gradient"),
        ("least-squares/ls-3-two-derivations",),
        ("tests/labsid/least_squares/test_projection.py::test_the_completed_square_adds_up",),
    ),
    Row(
        "Reading",
        "L6: covariance of the estimate, confidence intervals",
        ("labsid.least_squares.intervals:confidence_intervals",),
        ("least-squares/ls-10-confidence", "least-squares/ls-10-coverage"),
        (
            "tests/labsid/least_squares/test_intervals.py::test_intervals_are_those_of_statsmodels",
            VARIANT,
        ),
    ),
    Row(
        "Reading",
        "appendix: rank, condition number, SVD, pseudo-inverse",
        ("labsid.least_squares.linear_algebra:singular_values", "labsid.least_squares.linear_algebra:pseudo_inverse"),
        ("least-squares/ls-11-singular-values", "least-squares/ls-6-conditioning"),
        (
            "tests/labsid/least_squares/test_linear_algebra.py::test_pseudo_inverse_obeys_the_four_conditions_of_penrose",
            "tests/labsid/least_squares/test_linear_algebra.py::test_singular_values_by_hand",
        ),
    ),
    Row(
        "Reading",
        "appendix: inverse by adjoint and by Cayley-Hamilton",
        (
            "labsid.least_squares.matrix_inverse:inverse_by_cayley_hamilton",
            "labsid.least_squares.matrix_inverse:characteristic_polynomial",
        ),
        ("least-squares/ls-11-adjoint", "least-squares/ls-11-cayley-hamilton"),
        (
            "tests/labsid/least_squares/test_matrix_inverse.py::test_every_matrix_satisfies_its_characteristic_equation",
            VARIANT,
        ),
    ),
    Row(
        "Reading",
        "appendix: eigenvalues and the 2x2 formulas",
        ("labsid.least_squares.linear_algebra:eigenvalues_2x2",),
        ("least-squares/ls-11-adjoint",),
        ("tests/labsid/least_squares/test_linear_algebra.py::test_eigenvalues_2x2_have_the_trace_and_determinant",),
    ),
    Row(
        "Reading",
        "appendix: matrix inversion lemma, A (I + A)^-1 = (I + A)^-1 A",
        ("labsid.least_squares.matrix_inverse:inversion_lemma",),
        ("least-squares/ls-11-identities",),
        (
            "tests/labsid/least_squares/test_matrix_inverse.py::test_inversion_lemma_is_the_inverse_of_the_sum",
            "tests/labsid/least_squares/test_matrix_inverse.py::test_interesting_identity",
        ),
    ),
    Row(
        "Reading",
        "appendix: partitioned product",
        ("labsid.least_squares.linear_algebra:partitioned_product",),
        ("least-squares/ls-11-blocks",),
        ("tests/labsid/least_squares/test_linear_algebra.py::test_partitioned_product_is_a_sum_and_not_a_stack",),
    ),
    Row(
        "Reading",
        "appendix: orthogonal and skew matrices",
        ("labsid.least_squares.linear_algebra:symmetric_and_skew",),
        ("least-squares/ls-11-kinds-of-matrices",),
        (
            "tests/labsid/least_squares/test_linear_algebra.py::test_every_matrix_is_symmetric_plus_skew_and_the_form_sees_the_first",
        ),
    ),
    Row(
        "Reading",
        "function table, MATLAB beside numpy, and acronyms",
        (
            "labsid.least_squares.glossary:FUNCTIONS",
            "labsid.least_squares.glossary:ACRONYMS",
        ),
        ("least-squares/ls-11-functions",),
        (
            "tests/labsid/least_squares/test_glossary.py::test_every_python_expression_runs_and_is_what_the_matlab_one_is",
            "tests/labsid/least_squares/test_glossary.py::test_the_acronyms_of_the_notes_are_there",
        ),
    ),
    Row(
        "SUSTech",
        "derivatives of Ax, x'Ax and (x'x) x, directional derivatives",
        (
            "labsid.least_squares.gradients:jacobian_linear",
            "labsid.least_squares.gradients:gradient_quadratic",
            "labsid.least_squares.gradients:jacobian_cubic",
            "labsid.least_squares.gradients:directional_derivative",
        ),
        ("least-squares/ls-3-derivatives",),
        (
            "tests/labsid/least_squares/test_gradients.py::test_derivatives_are_the_finite_differences",
            "tests/labsid/least_squares/test_gradients.py::test_directional_derivative_is_the_gradient_along_the_direction_length_included",
            VARIANT,
        ),
    ),
    Row(
        "SUSTech",
        "normal equations, from the gradient of the cost",
        ("labsid.least_squares.solve:normal_equations", "labsid.least_squares.solve:loss_gradient"),
        ("least-squares/ls-3-two-derivations", "least-squares/ls-4-fits"),
        (
            "tests/labsid/least_squares/test_solve.py::test_the_gradient_is_the_slope_of_the_loss",
            "tests/labsid/least_squares/test_solve.py::test_the_lesson_and_the_sound_solution_agree_on_a_well_conditioned_problem",
            VARIANT,
        ),
    ),
    Row(
        "SUSTech",
        "line and quadratic fit",
        ("labsid.least_squares.curve_fit:fit_powers",),
        ("least-squares/ls-4-fits", "least-squares/ls-4-sustech-points"),
        ("tests/labsid/least_squares/test_curve_fit.py::test_worked_values", VARIANT),
    ),
    Row(
        "SUSTech",
        "projection and residual orthogonality",
        ("labsid.least_squares.projection:projection_matrix", "labsid.least_squares.projection:project"),
        ("least-squares/ls-5-projector", "least-squares/ls-5-figure-projection"),
        (
            "tests/labsid/least_squares/test_projection.py::test_projection_is_symmetric_idempotent_and_leaves_a_right_angle",
            VARIANT,
        ),
    ),
    Row(
        "SUSTech",
        "rank-deficient solutions and the minimum-norm one",
        ("labsid.least_squares.projection:solution_set",),
        ("least-squares/ls-6-all-solutions", "least-squares/ls-6-figure-trough"),
        (
            "tests/labsid/least_squares/test_projection.py::test_all_solutions_have_the_same_loss_and_the_given_one_is_the_shortest",
            VARIANT,
        ),
    ),
    Row(
        "SUSTech",
        "Example 1: a known coefficient moves to the left side",
        ("labsid.least_squares.constrained:fit_with_known",),
        ("least-squares/ls-7-known",),
        (
            "tests/labsid/least_squares/test_constrained.py::test_sustech_example_1_rows_and_recovery",
            VARIANT,
        ),
    ),
    Row(
        "SUSTech",
        "Example 2",
        ("labsid.least_squares.constrained:fit_with_known",),
        ("least-squares/ls-7-example-2",),
        ("tests/labsid/least_squares/test_constrained.py::test_sustech_example_2",),
    ),
    Row(
        "SUSTech",
        "weighted least squares",
        ("labsid.least_squares.weighted:weighted_least_squares",),
        ("least-squares/ls-8-weighted",),
        ("tests/labsid/least_squares/test_weighted.py::test_statsmodels_agrees", VARIANT),
    ),
    Row(
        "SUSTech",
        "least squares over a constraint set",
        ("labsid.least_squares.constrained:least_squares_with_equations",),
        ("least-squares/ls-9-constrained", "least-squares/ls-9-figure-constrained"),
        (
            "tests/labsid/least_squares/test_constrained.py::test_equations_hold_and_nothing_within_them_is_better",
            VARIANT,
        ),
    ),
)
