"""The table seed item -> function -> step of a notebook -> test; `test_seed_coverage.py` holds it to the code."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Row:
    """One line of "Seed coverage".

    Attributes
    ----------
    seed : str
        "UNSW", "Reading" or "SUSTech".
    item : str
        What the seed asks for.
    functions : tuple of str
        Where the reference computes or draws it, ``module:name``.
    steps : tuple of str
        Cells of the notebooks in which it is done or shown, ``assignment/cell id``.
    tests : tuple of str
        ``file::function``.
    """

    seed: str
    item: str
    functions: tuple[str, ...]
    steps: tuple[str, ...]
    tests: tuple[str, ...]


SINUSOID = "tests/labsid/test_sinusoid.py::"
OFFSET = "tests/labsid/test_offset.py::"
PHI = "tests/labsid/test_regressor.py::"
LS = "tests/labsid/test_least_squares.py::"
ARX = "tests/labsid/test_arx.py::"
SIM = "tests/labsid/test_simulation.py::"
VAL = "tests/labsid/test_validation.py::"
STEP = "tests/labsid/test_step_response.py::"
LOOP = "tests/labsid/test_loop.py::"
EXC = "tests/labsid/test_excitation.py::"
IDENT = "tests/labsid/test_identify.py::"
PLOT = "tests/labsid/plots/"
VARIANT = "tests/autograder/test_variants.py::test_variant"

UNSW = (
    Row(
        "UNSW",
        "pre-lab 1: time as a column vector",
        ("labsid.sinusoid:make_sinusoids",),
        ("prelab-sinusoids/prelab-1-time",),
        (SINUSOID + "test_time_is_a_column_from_0_to_100_s_in_steps_of_a_tenth", VARIANT),
    ),
    Row(
        "UNSW",
        "pre-lab 2: sine and cosine with uniform noise of ±0.2",
        ("labsid.sinusoid:make_sinusoids",),
        ("prelab-sinusoids/prelab-2-noise",),
        (SINUSOID + "test_the_sinusoids_have_a_period_of_100_s_and_uniform_noise_within_the_bound", VARIANT),
    ),
    Row(
        "UNSW",
        "pre-lab 3: first 200 samples cut off, time from zero",
        ("labsid.sinusoid:cut_off",),
        ("prelab-sinusoids/prelab-3-cut", "prelab-sinusoids/prelab-4-function"),
        (SINUSOID + "test_cut_off_drops_200_samples_and_time_starts_from_zero", VARIANT),
    ),
    Row(
        "UNSW",
        "pre-lab 4: data_new by concatenation",
        ("labsid.sinusoid:cut_off",),
        ("prelab-sinusoids/prelab-4-matrix",),
        (SINUSOID + "test_data_new_holds_the_three_columns_side_by_side", VARIANT),
    ),
    Row(
        "UNSW",
        "pre-lab 5: Fig. 1(a), limits, Greek letters, colours",
        ("labsid.plots:figure_1",),
        ("prelab-sinusoids/prelab-5-original",),
        (PLOT + "test_lab.py::test_fig_1_limits_titles_labels_grid_and_legend", VARIANT),
    ),
    Row(
        "UNSW",
        "pre-lab 6: Fig. 1(b), the cosine in [0.6 0.7 0.8]",
        ("labsid.plots:figure_1",),
        ("prelab-sinusoids/prelab-6-cut-off",),
        (PLOT + "test_lab.py::test_fig_1_cosine_is_the_grey_blue_in_both_panels_and_a_stair", VARIANT),
    ),
    Row(
        "UNSW",
        "1a: load LogData, extract t, y_act, y_actm, u_act",
        ("labsid.record:load_record", "labsid.formats:read_raw"),
        ("lab-identification/lab-1a-extract",),
        ("tests/labsid/test_record.py::test_the_real_records_load", VARIANT),
    ),
    Row(
        "UNSW",
        "1a: sampling time",
        ("labsid.record:load_record",),
        ("lab-identification/lab-1a-sampling-time",),
        ("tests/labsid/test_record.py::test_sampling_time_is_exact", VARIANT),
    ),
    Row(
        "UNSW",
        "1b: Fig. 5",
        ("labsid.plots:figure_5",),
        ("lab-identification/lab-1b-figure-5",),
        (PLOT + "test_lab.py::test_fig_5_shows_both_outputs_and_the_input_as_stairs", VARIANT),
    ),
    Row(
        "UNSW",
        "1c: length of the first period with a while loop",
        ("labsid.offset:first_period_length",),
        ("lab-identification/lab-1c-loop",),
        (OFFSET + "test_first_period_by_hand", VARIANT),
    ),
    Row(
        "UNSW",
        "1c: output offset as mean of the first period, input offset as its first value",
        ("labsid.offset:mean_of_first_period", "labsid.offset:remove_offsets"),
        ("lab-identification/lab-1c-offsets",),
        (OFFSET + "test_mean_of_first_period_by_hand", OFFSET + "test_removing_the_offsets_leaves_zero_at_the_start"),
    ),
    Row(
        "UNSW",
        "1c, erratum: the settled part of the first period",
        ("labsid.offset:find_offsets",),
        ("lab-identification/lab-1c-empty-tank",),
        (OFFSET + "test_the_runs_from_an_empty_tank_are_averaged_where_they_have_settled",),
    ),
    Row(
        "UNSW",
        "1c: Fig. 6",
        ("labsid.plots:figure_6",),
        ("lab-identification/lab-1c-figure-6",),
        (PLOT + "test_lab.py::test_fig_6_begins_from_zero", VARIANT),
    ),
    Row(
        "UNSW",
        "middle of the input range against the first value",
        ("labsid.offset:mid_range",),
        ("lab-identification/lab-1c-offsets",),
        (OFFSET + "test_mid_range_is_not_the_first_value_when_the_range_is_not_symmetric",),
    ),
    Row(
        "UNSW",
        "2a: Phi from the first half, eq. (6)",
        ("labsid.regressor:build_phi",),
        ("lab-identification/lab-2a-phi",),
        (PHI + "test_rows_by_hand", PHI + "test_rows_equal_the_definition_written_out_as_a_loop", VARIANT),
    ),
    Row(
        "UNSW",
        "2a: choice of the start k, values before the record",
        ("labsid.regressor:build_phi",),
        ("lab-identification/lab-2a-phi",),
        (PHI + "test_start_1_is_the_printed_first_row_with_rest_before_the_record",),
    ),
    Row(
        "UNSW",
        "2b: eq. (8), beside the sound solution",
        ("labsid.least_squares:normal_equations", "labsid.least_squares:least_squares"),
        ("lab-identification/lab-2b-theta",),
        (LS + "test_the_lesson_and_the_sound_solution_agree_on_a_well_conditioned_problem", VARIANT),
    ),
    Row(
        "UNSW",
        "2b: theta holds -a: the sign",
        ("labsid.arx:arx_from_theta",),
        ("lab-identification/lab-2b-parameters",),
        (ARX + "test_the_sign_of_a_is_the_one_stated", VARIANT),
    ),
    Row(
        "UNSW",
        "covariance and standard errors",
        ("labsid.least_squares:least_squares",),
        ("lab-identification/lab-2b-excitation",),
        (LS + "test_covariance_and_standard_errors_agree_with_an_independent_regression",),
    ),
    Row(
        "UNSW",
        "persistent excitation: what it asks of Phi'Phi, conditioning",
        ("labsid.excitation:persistent_excitation", "labsid.excitation:excitation_order"),
        ("lab-identification/lab-2b-excitation",),
        (
            EXC + "test_dependent_columns_and_too_few_rows_are_not_positive_definite",
            EXC + "test_order_of_known_signals",
        ),
    ),
    Row(
        "UNSW",
        "recommended inputs: PRBS, square wave, sum of sinusoids",
        ("labsid.excitation:prbs", "labsid.excitation:square_wave", "labsid.excitation:sum_of_sinusoids"),
        ("lab-identification/lab-2b-excitation",),
        (EXC + "test_prbs_has_two_levels_its_period_and_the_correlation_of_white_noise",),
    ),
    Row(
        "UNSW",
        "2c: transfer function, eq. (1), displayed",
        ("labsid.arx:to_tf",),
        ("lab-identification/lab-2c-transfer-function",),
        (ARX + "test_transfer_function_and_state_space_are_displayed_as_the_lab_asks", VARIANT),
    ),
    Row(
        "UNSW",
        "2c: state space in the controllable canonical form of eq. (2)",
        ("labsid.arx:to_ss", "labsid.arx:canonical_form"),
        ("lab-identification/lab-2c-state-space",),
        (ARX + "test_the_canonical_form_of_eq_2", VARIANT),
    ),
    Row(
        "UNSW",
        "3a: simulate the second half, from rest",
        ("labsid.simulation:simulate", "labsid.validation:verify"),
        ("lab-identification/lab-3a-second-half",),
        (SIM + "test_free_run_equals_python_control_and_scipy", VARIANT),
    ),
    Row(
        "UNSW",
        "3a: simulate everything",
        ("labsid.simulation:simulate", "labsid.validation:verify"),
        ("lab-identification/lab-3a-all",),
        (IDENT + "test_order_2_gives_the_worked_values_to_their_last_digit", VARIANT),
    ),
    Row(
        "UNSW",
        "simulation is not one-step prediction",
        ("labsid.simulation:predict_one_step",),
        ("lab-identification/lab-3a-all",),
        (SIM + "test_one_step_prediction_is_not_simulation", VARIANT),
    ),
    Row(
        "UNSW",
        "mean squared error",
        ("labsid.validation:mse",),
        ("lab-identification/lab-3a-mse",),
        (VAL + "test_mse_by_hand", VARIANT),
    ),
    Row(
        "UNSW",
        "Fig. 7",
        ("labsid.plots:figure_7",),
        ("lab-identification/lab-3a-figure-7",),
        (PLOT + "test_verification.py::test_fig_7_compares_the_second_half_and_the_whole", VARIANT),
    ),
    Row(
        "UNSW",
        "3b: why the second half does not start at the same point",
        ("labsid.plots:figure_7_initial_state",),
        ("lab-identification/lab-3b-start", "lab-identification/lab-3b-three-starts"),
        (PLOT + "test_verification.py::test_fig_7_a_starts_from_zero_while_the_output_does_not",),
    ),
    Row(
        "UNSW",
        "3b: the state estimated at the half is the remedy",
        ("labsid.simulation:estimate_initial_state",),
        ("lab-identification/lab-3b-initial-state",),
        (SIM + "test_the_initial_state_is_recovered_as_far_as_the_output_shows_it", VARIANT),
    ),
    Row(
        "UNSW",
        "post-lab 1: first order, eq. (9)",
        ("labsid.arx:fit_arx",),
        (
            "postlab-model-order/postlab-1-phi",
            "postlab-model-order/postlab-1-theta",
            "postlab-model-order/postlab-1-transfer-function",
            "postlab-model-order/postlab-2-fit-order",
        ),
        (IDENT + "test_order_1_gives_the_worked_values_to_their_last_digit", PHI + "test_first_order_is_eq_9", VARIANT),
    ),
    Row(
        "UNSW",
        "post-lab 2: both orders simulated",
        ("labsid.validation:verify",),
        ("postlab-model-order/postlab-2-simulation",),
        (VARIANT,),
    ),
    Row(
        "UNSW",
        "post-lab 3: Fig. 8 with the two errors in its corner",
        ("labsid.plots:figure_8",),
        ("postlab-model-order/postlab-3-figure-8", "postlab-model-order/postlab-3-mse"),
        (PLOT + "test_verification.py::test_fig_8_errors_stand_in_the_top_left_corner_clear_of_everything", VARIANT),
    ),
    Row(
        "UNSW",
        "post-lab 3: which model for control, and why",
        ("labsid.loop:offset_compensated_loop",),
        ("postlab-model-order/postlab-3-choice",),
        (LOOP + "test_the_closed_loop_is_the_textbook_one",),
    ),
    Row(
        "UNSW",
        "Fig. 2 drawn",
        ("labsid.plots:figure_2",),
        ("lab-identification/lab-2-figure-2",),
        (PLOT + "test_block_diagrams.py::test_fig_2_takes_u_and_y_into_the_regression_of_n_equations",),
    ),
    Row(
        "UNSW",
        "Fig. 3 drawn",
        ("labsid.plots:figure_3",),
        ("lab-identification/lab-1c-figure-3",),
        (PLOT + "test_block_diagrams.py::test_fig_3_adds_the_input_offset_and_subtracts_the_output_offset",),
    ),
    Row(
        "UNSW",
        "Fig. 3 run: offset compensation in operation",
        ("labsid.loop:offset_compensated_loop", "labsid.loop:run_on_process"),
        ("lab-identification/lab-4-figure-3-run",),
        (LOOP + "test_the_loop_follows_the_set_point_about_the_operating_point",),
    ),
    Row(
        "UNSW",
        "Fig. 4 drawn",
        ("labsid.plots:figure_4",),
        ("lab-identification/lab-3-figure-4",),
        (PLOT + "test_block_diagrams.py::test_fig_4_compares_process_and_model_on_the_same_input",),
    ),
    Row(
        "UNSW",
        "Fig. 4 as verification on another record",
        ("labsid.record_verification:verify_on_record",),
        ("lab-identification/lab-4-other-record",),
        (
            "tests/labsid/test_record_verification.py::test_the_model_of_the_lab_file_holds_on_the_other_runs_of_the_rig",
        ),
    ),
    Row(
        "UNSW",
        "the optional Simulink run as a block diagram",
        ("labsid.loop:simulation_diagram", "labsid.loop:simulate_diagram"),
        ("lab-identification/lab-4-block-diagram",),
        (LOOP + "test_the_block_diagram_equals_the_simulation",),
    ),
    Row(
        "UNSW",
        "appendix: K, tau, t_d from a step of 2, Fig. A1",
        ("labsid.step_response:fit_step_response", "labsid.plots:figure_a1"),
        ("step-response/step-1-read", "step-response/step-5-function"),
        (STEP + "test_the_reading_of_a_clean_response_of_amplitude_2", VARIANT),
    ),
    Row(
        "UNSW",
        "appendix: original against approximate, Fig. A2",
        ("labsid.step_comparison:compare_with_approximation", "labsid.plots:figure_a2"),
        ("step-response/step-2-response", "step-response/step-3-figure", "step-response/step-3-mse"),
        ("tests/labsid/test_step_comparison.py::test_the_approximation_is_close_as_fig_a2_shows", VARIANT),
    ),
    Row(
        "UNSW",
        "appendix: a response that oscillates wants another model",
        ("labsid.step_response:fit_step_response",),
        ("step-response/step-4-oscillation",),
        (STEP + "test_an_oscillating_response_says_that_it_wants_a_higher_order",),
    ),
    Row(
        "UNSW",
        "appendix: step response of real data",
        ("labsid.step_response:cut_held_step",),
        ("step-response/step-6-cut", "step-response/step-6-model"),
        (STEP + "test_the_steps_of_the_lab_file_agree_on_gain_and_time_constant", VARIANT),
    ),
    Row(
        "UNSW",
        "(A1), (A2): two equations, determinant",
        ("labsid.least_squares:two_equations",),
        ("step-response/step-7-two",),
        (LS + "test_two_equations_by_hand", LS + "test_dependent_equations_have_no_single_solution", VARIANT),
    ),
    Row(
        "UNSW",
        "(A3), (A4): more equations than unknowns, the error vector",
        ("labsid.least_squares:least_squares",),
        ("step-response/step-8-error",),
        (LS + "test_three_equations_by_hand", VARIANT),
    ),
    Row(
        "UNSW",
        "(A5): the loss V(theta)",
        ("labsid.least_squares:loss",),
        ("step-response/step-8-loss",),
        (LS + "test_loss_by_hand", VARIANT),
    ),
    Row(
        "UNSW",
        "(A6): the gradient and its zero",
        ("labsid.least_squares:loss_gradient",),
        ("step-response/step-8-gradient", "step-response/step-9-minimum"),
        (LS + "test_the_gradient_is_the_slope_of_the_loss", VARIANT),
    ),
    Row(
        "UNSW",
        "appendix, erratum: unique exactly when Phi has full column rank",
        ("labsid.least_squares:least_squares",),
        ("step-response/step-9-unique",),
        (LS + "test_rank_deficiency_is_a_status_with_the_shortest_solution", VARIANT),
    ),
    Row(
        "UNSW",
        "the whole procedure from the shell",
        ("labsid.identify:identify", "labsid.console:identification_text"),
        ("lab-identification/lab-3a-mse",),
        (IDENT + "test_order_2_gives_the_worked_values_to_their_last_digit",),
    ),
)

LECTURES = (
    Row(
        "Reading",
        "L2: quadratic forms and definiteness, Fig. 3 and 4",
        ("labsid.quadratic_form:definiteness", "labsid.quadratic_form:surface"),
        ("least-squares/ls-1-kind", "least-squares/ls-1-figures-3-and-4"),
        (
            "tests/labsid/test_quadratic_form.py::test_kinds",
            "tests/labsid/test_quadratic_form.py::test_surface_spans_the_eigenvalues_and_is_zero_in_the_middle",
            "tests/autograder/test_variants.py::test_variant",
        ),
    ),
    Row(
        "Reading",
        "L2: Examples 2-1 to 2-3, rows with delays",
        ("labsid.structures:build_equations",),
        ("least-squares/ls-2-delays",),
        (
            "tests/labsid/test_structures.py::test_example_2_3_rows_from_rest",
            "tests/autograder/test_variants.py::test_variant",
        ),
    ),
    Row(
        "Reading",
        "L2: Examples 2-1, 2-2 and 2-4, line and parabola",
        ("labsid.curve_fit:fit_powers",),
        ("least-squares/ls-4-fits",),
        (
            "tests/labsid/test_curve_fit.py::test_worked_values",
            "tests/labsid/test_curve_fit.py::test_the_regressors_of_example_2_4_and_its_normal_equations",
            "tests/autograder/test_variants.py::test_variant",
        ),
    ),
    Row(
        "Reading",
        "L2: Fig. 5, the first MATLAB program",
        ("labsid.curve_fit:fit_powers",),
        ("least-squares/ls-4-figure-5",),
        ("tests/labsid/test_curve_fit.py::test_polyfit_agrees", "tests/autograder/test_variants.py::test_variant"),
    ),
    Row(
        "Reading",
        "L2: both derivations of the normal equations",
        ("labsid.projection:completed_square", "labsid.least_squares:loss_gradient"),
        ("least-squares/ls-3-two-derivations",),
        ("tests/labsid/test_projection.py::test_the_completed_square_adds_up",),
    ),
    Row(
        "Reading",
        "L6: covariance of the estimate, confidence intervals",
        ("labsid.intervals:confidence_intervals",),
        ("least-squares/ls-10-confidence", "least-squares/ls-10-coverage"),
        (
            "tests/labsid/test_intervals.py::test_intervals_are_those_of_statsmodels",
            "tests/autograder/test_variants.py::test_variant",
        ),
    ),
    Row(
        "Reading",
        "appendix: rank, condition number, SVD, pseudo-inverse",
        ("labsid.linear_algebra:singular_values", "labsid.linear_algebra:pseudo_inverse"),
        ("least-squares/ls-11-singular-values", "least-squares/ls-6-conditioning"),
        (
            "tests/labsid/test_linear_algebra.py::test_pseudo_inverse_obeys_the_four_conditions_of_penrose",
            "tests/labsid/test_linear_algebra.py::test_singular_values_by_hand",
        ),
    ),
    Row(
        "Reading",
        "appendix: inverse by adjoint and by Cayley-Hamilton",
        ("labsid.matrix_inverse:inverse_by_cayley_hamilton", "labsid.matrix_inverse:characteristic_polynomial"),
        ("least-squares/ls-11-adjoint", "least-squares/ls-11-cayley-hamilton"),
        (
            "tests/labsid/test_matrix_inverse.py::test_every_matrix_satisfies_its_characteristic_equation",
            "tests/autograder/test_variants.py::test_variant",
        ),
    ),
    Row(
        "Reading",
        "appendix: eigenvalues and the 2x2 formulas",
        ("labsid.linear_algebra:eigenvalues_2x2",),
        ("least-squares/ls-11-adjoint",),
        ("tests/labsid/test_linear_algebra.py::test_eigenvalues_2x2_have_the_trace_and_determinant",),
    ),
    Row(
        "Reading",
        "appendix: matrix inversion lemma, A (I + A)^-1 = (I + A)^-1 A",
        ("labsid.matrix_inverse:inversion_lemma",),
        ("least-squares/ls-11-identities",),
        (
            "tests/labsid/test_matrix_inverse.py::test_inversion_lemma_is_the_inverse_of_the_sum",
            "tests/labsid/test_matrix_inverse.py::test_interesting_identity",
        ),
    ),
    Row(
        "Reading",
        "appendix: partitioned product",
        ("labsid.linear_algebra:partitioned_product",),
        ("least-squares/ls-11-blocks",),
        ("tests/labsid/test_linear_algebra.py::test_partitioned_product_is_a_sum_and_not_a_stack",),
    ),
    Row(
        "Reading",
        "appendix: orthogonal and skew matrices",
        ("labsid.linear_algebra:symmetric_and_skew",),
        ("least-squares/ls-11-kinds-of-matrices",),
        ("tests/labsid/test_linear_algebra.py::test_every_matrix_is_symmetric_plus_skew_and_the_form_sees_the_first",),
    ),
    Row(
        "Reading",
        "function table, MATLAB beside numpy, and acronyms",
        (
            "labsid.glossary:FUNCTIONS",
            "labsid.glossary:ACRONYMS",
        ),
        ("least-squares/ls-11-identities",),
        (
            "tests/labsid/test_glossary.py::test_every_python_expression_runs_and_is_what_the_matlab_one_is",
            "tests/labsid/test_glossary.py::test_the_acronyms_of_the_notes_are_there",
        ),
    ),
    Row(
        "SUSTech",
        "derivatives of Ax, x'Ax and (x'x) x, directional derivatives",
        (
            "labsid.gradients:jacobian_linear",
            "labsid.gradients:gradient_quadratic",
            "labsid.gradients:jacobian_cubic",
            "labsid.gradients:directional_derivative",
        ),
        ("least-squares/ls-3-derivatives",),
        (
            "tests/labsid/test_gradients.py::test_derivatives_are_the_finite_differences",
            "tests/labsid/test_gradients.py::test_directional_derivative_is_the_gradient_along_the_direction_length_included",
            "tests/autograder/test_variants.py::test_variant",
        ),
    ),
    Row(
        "SUSTech",
        "line and quadratic fit",
        ("labsid.curve_fit:fit_powers",),
        ("least-squares/ls-4-fits", "least-squares/ls-4-sustech-points"),
        ("tests/labsid/test_curve_fit.py::test_worked_values", "tests/autograder/test_variants.py::test_variant"),
    ),
    Row(
        "SUSTech",
        "projection and residual orthogonality",
        ("labsid.projection:projection_matrix", "labsid.projection:project"),
        ("least-squares/ls-5-projector", "least-squares/ls-5-figure-projection"),
        (
            "tests/labsid/test_projection.py::test_projection_is_symmetric_idempotent_and_leaves_a_right_angle",
            "tests/autograder/test_variants.py::test_variant",
        ),
    ),
    Row(
        "SUSTech",
        "rank-deficient solutions and the minimum-norm one",
        ("labsid.projection:solution_set",),
        ("least-squares/ls-6-all-solutions", "least-squares/ls-6-figure-trough"),
        (
            "tests/labsid/test_projection.py::test_all_solutions_have_the_same_loss_and_the_given_one_is_the_shortest",
            "tests/autograder/test_variants.py::test_variant",
        ),
    ),
    Row(
        "SUSTech",
        "Example 1: a known coefficient moves to the left side",
        ("labsid.constrained:fit_with_known",),
        ("least-squares/ls-7-known",),
        (
            "tests/labsid/test_constrained.py::test_sustech_example_1_rows_and_recovery",
            "tests/autograder/test_variants.py::test_variant",
        ),
    ),
    Row(
        "SUSTech",
        "Example 2",
        ("labsid.constrained:fit_with_known",),
        ("least-squares/ls-7-gain",),
        ("tests/labsid/test_constrained.py::test_sustech_example_2",),
    ),
    Row(
        "SUSTech",
        "weighted least squares",
        ("labsid.weighted:weighted_least_squares",),
        ("least-squares/ls-8-weighted",),
        ("tests/labsid/test_weighted.py::test_statsmodels_agrees", "tests/autograder/test_variants.py::test_variant"),
    ),
    Row(
        "SUSTech",
        "least squares over a constraint set",
        ("labsid.constrained:least_squares_with_equations",),
        ("least-squares/ls-9-constrained", "least-squares/ls-9-figure-constrained"),
        (
            "tests/labsid/test_constrained.py::test_equations_hold_and_nothing_within_them_is_better",
            "tests/autograder/test_variants.py::test_variant",
        ),
    ),
)

ROWS = UNSW + LECTURES
