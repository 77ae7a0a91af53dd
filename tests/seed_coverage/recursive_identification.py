"""What the assignment `recursive-identification` covers of the lectures, line by line."""

from seed_coverage.row import VARIANT, Row

_TESTS = "tests/labsid/estimation/test_recursive.py::"

ROWS = (
    Row(
        "Reading",
        "L3: Example 3-2, a constant estimated recursively",
        ("labsid.model_structures.lecture_systems:example_3_2", "labsid.estimation.recursive:recursive_least_squares"),
        ("recursive-identification/ri-1-mean", "recursive-identification/ri-1-figure-mean"),
        (_TESTS + "test_example_3_2_the_recursive_mean", VARIANT),
    ),
    Row(
        "Reading",
        "L4: the sums of eq. (7) and (8), with the errata of (8) to (10)",
        ("labsid.estimation.recursive:recursive_least_squares",),
        ("recursive-identification/ri-2-information", "recursive-identification/ri-2-figure-bands"),
        (_TESTS + "test_the_inversion_lemma_step_by_step", VARIANT),
    ),
    Row(
        "Reading",
        "L4-5: derivation of RLS, matrix inversion lemma",
        ("labsid.least_squares.matrix_inverse:inversion_lemma", "labsid.estimation.recursive:recursive_least_squares"),
        ("recursive-identification/ri-3-step", "recursive-identification/ri-3-example-5-2"),
        (
            "tests/labsid/least_squares/test_matrix_inverse.py::test_inversion_lemma_gives_the_p_of_example_5_2_though_bcd_is_singular",
            _TESTS + "test_the_compiled_loop_is_the_lectures_form",
            VARIANT,
        ),
    ),
    Row(
        "Reading",
        "L5: Example 5-1, the start with a large number LN",
        ("labsid.estimation.recursion:diffuse_start",),
        ("recursive-identification/ri-3-example-5-1",),
        (_TESTS + "test_example_5_1_the_gain_is_one_over_n_only_for_a_diffuse_start",),
    ),
    Row(
        "Reading",
        "L5: Example 5-2, with the corrected numbers",
        ("labsid.estimation.recursive:recursive_least_squares",),
        ("recursive-identification/ri-3-example-5-2",),
        (_TESTS + "test_example_5_2_with_the_numbers_of_the_errata",),
    ),
    Row(
        "Reading",
        "L5: RLS with lambda 1 and a diffuse start is batch least squares",
        ("labsid.estimation.recursive:recursive_least_squares", "labsid.least_squares.solve:solve_least_squares"),
        ("recursive-identification/ri-5-batch",),
        (
            _TESTS + "test_a_million_samples_give_the_batch_estimate_to_1e_8",
            _TESTS + "test_the_batch_estimate_and_scaling",
        ),
    ),
    Row(
        "Reading",
        "L5: RLS with a forgetting factor",
        ("labsid.estimation.recursive:recursive_least_squares",),
        ("recursive-identification/ri-5-forgetting", "recursive-identification/ri-5-batch"),
        (_TESTS + "test_the_last_row_is_the_weighted_batch_estimate", VARIANT),
    ),
    Row(
        "Reading",
        "L5: summary of the algorithm, online use",
        ("labsid.estimation.recursive:recursive_armax", "labsid.estimation.recursion:RecursiveState"),
        ("recursive-identification/ri-7-online", "recursive-identification/ri-7-online-run"),
        (
            _TESTS + "test_one_sample_at_a_time_is_the_same_run",
            _TESTS + "test_memory_of_the_streaming_path_does_not_grow_with_the_record",
            VARIANT,
        ),
    ),
    Row(
        "Reading",
        "L6: Example 6-1, regressors of a changing system",
        ("labsid.model_structures.lecture_systems:example_6_1", "labsid.model_structures.structures:build_equations"),
        ("recursive-identification/ri-4-regressors", "recursive-identification/ri-4-record"),
        ("tests/labsid/model_structures/test_structures.py::test_example_2_3_rows_from_rest", VARIANT),
    ),
    Row(
        "Reading",
        "L6: Example 6-1 with lambda 1 and 0.99, Fig. 9 and 10, fault detection",
        ("labsid.model_structures.lecture_systems:example_6_1", "labsid.estimation.recursive:recursive_armax"),
        ("recursive-identification/ri-6-figures", "recursive-identification/ri-6-fault"),
        (_TESTS + "test_example_6_1_forgetting_follows_the_change_and_lambda_1_does_not", VARIANT),
    ),
    Row(
        "Reading",
        "L5: tracking a parameter that drifts",
        ("labsid.estimation.recursive:recursive_least_squares",),
        ("recursive-identification/ri-8-drift", "recursive-identification/ri-8-figure-drift"),
        (_TESTS + "test_example_6_1_forgetting_follows_the_change_and_lambda_1_does_not", VARIANT),
    ),
    Row(
        "Reading",
        "RLS in operation: covariance wind-up under a constant input, handled",
        ("labsid.estimation.recursive:recursive_armax", "labsid.estimation.recursion:diffuse_start"),
        ("recursive-identification/ri-9-windup", "recursive-identification/ri-9-figure-windup"),
        (
            _TESTS + "test_covariance_winds_up_under_a_constant_input_without_a_bound",
            _TESTS + "test_a_bound_keeps_the_estimate_through_a_quiet_stretch",
            VARIANT,
        ),
    ),
    Row(
        "Reading",
        "RLS in operation: P left unsymmetric diverges, shown and measured",
        ("labsid.estimation.recursive:unsymmetrised_rls",),
        ("recursive-identification/ri-10-careless", "recursive-identification/ri-10-figure-careless"),
        (_TESTS + "test_the_unsymmetrised_variant_diverges_and_the_house_form_does_not", VARIANT),
    ),
)
