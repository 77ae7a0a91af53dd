"""What the assignment `model-structures` covers of the lectures, line by line."""

from seed_coverage.row import VARIANT, Row

ROWS = (
    Row(
        "Reading",
        "L1: Fig. 1, the five steps, Fig. 2",
        (
            "labsid.plots.lecture_diagrams:figure_dynamical_system",
            "labsid.plots.lecture_diagrams:figure_five_steps",
            "labsid.plots.lecture_diagrams:figure_computer_control",
        ),
        (
            "model-structures/ms-1-figure-1",
            "model-structures/ms-1-five-steps",
            "model-structures/ms-1-figure-2",
        ),
        (
            "tests/labsid/plots/test_lecture_diagrams.py::test_figure_1_has_two_inputs_and_an_output",
            "tests/labsid/plots/test_lecture_diagrams.py::test_the_five_steps_are_in_order_and_go_back",
            "tests/labsid/plots/test_lecture_diagrams.py::test_figure_2_identifies_from_what_it_controls_with",
        ),
    ),
    Row(
        "Reading",
        "L1: shift operator, eq. (1)-(6)",
        (
            "labsid.model_structures.polynomials:shift_back",
            "labsid.model_structures.polynomials:shift_forward",
            "labsid.model_structures.polynomials:apply",
        ),
        ("model-structures/ms-2-shift",),
        (
            "tests/labsid/model_structures/test_polynomials.py::test_shifts_by_hand",
            "tests/labsid/model_structures/test_polynomials.py::test_the_operator_is_the_polynomial_with_one_coefficient",
            VARIANT,
        ),
    ),
    Row(
        "Reading",
        "L1: linear and time-invariant",
        ("labsid.model_structures.polynomials:superposition_error", "labsid.model_structures.polynomials:shift_error"),
        ("model-structures/ms-2-linear-time-invariant",),
        (
            "tests/labsid/model_structures/test_polynomials.py::test_linear_is_more_than_scaling",
            "tests/labsid/model_structures/test_polynomials.py::test_time_invariant_is_commuting_with_shifts",
        ),
    ),
    Row(
        "Reading",
        "L1: z-transform",
        (
            "labsid.model_structures.polynomials:z_transform",
            "labsid.model_structures.polynomials:z_pairs",
            "labsid.model_structures.polynomials:series",
        ),
        ("model-structures/ms-2-z-transform",),
        (
            "tests/labsid/model_structures/test_polynomials.py::test_the_sum_is_the_tabled_transform",
            "tests/labsid/model_structures/test_polynomials.py::test_a_delay_multiplies_the_transform_by_one_over_z",
            "tests/labsid/model_structures/test_polynomials.py::test_series_is_the_impulse_response_of_scipy",
        ),
    ),
    Row(
        "Reading",
        "L3: ARX, AR, ARMAX, ARMA and FIR as one family",
        (
            "labsid.model_structures.structures:Structure",
            "labsid.model_structures.structures:build_equations",
            "labsid.model_structures.prediction:free_run",
        ),
        ("model-structures/ms-4-equations", "model-structures/ms-5-simulate"),
        (
            "tests/labsid/model_structures/test_structures.py::test_kinds_and_counts",
            "tests/labsid/model_structures/test_structures.py::test_rows_are_the_sums_of_the_definition",
            "tests/labsid/model_structures/test_structures.py::test_the_errata_on_armax_with_the_true_noise_it_is_linear",
            "tests/labsid/model_structures/test_prediction.py::test_armax_by_hand",
            VARIANT,
        ),
    ),
    Row(
        "Reading",
        "L3: Systems 1 and 2, Fig. 6 and 7; L6: Fig. 11",
        (
            "labsid.model_structures.lecture_systems:system_1",
            "labsid.model_structures.lecture_systems:system_2",
            "labsid.plots.lecture_diagrams:figure_systems_1_and_2",
        ),
        (
            "model-structures/ms-5-figure-6",
            "model-structures/ms-5-figures-7-and-11",
            "model-structures/ms-5-same-system",
        ),
        (
            "tests/labsid/model_structures/test_lecture_systems.py::test_system_1_is_the_printed_program",
            "tests/labsid/model_structures/test_lecture_systems.py::test_system_2_is_the_printed_program_and_white_noise_on_the_output",
            "tests/labsid/plots/test_lecture_diagrams.py::test_figure_6_has_the_noise_inside_the_loop_and_behind_it",
        ),
    ),
    Row(
        "Reading",
        "L3: Example 3-1, Table 1",
        ("labsid.model_structures.structures:fit_structure",),
        ("model-structures/ms-5-example-3-1", "model-structures/ms-5-table-1"),
        ("tests/labsid/model_structures/test_structures.py::test_example_3_1_rows", VARIANT),
    ),
    Row(
        "Reading",
        "L3: Example 3-2, the mean",
        ("labsid.model_structures.lecture_systems:example_3_2",),
        ("model-structures/ms-4-example-3-2",),
        ("tests/labsid/model_structures/test_lecture_systems.py::test_example_3_2_is_a_constant_in_unit_noise",),
    ),
    Row(
        "Reading",
        "L3: Fig. 8, one-step prediction beside free run",
        ("labsid.model_structures.prediction:one_step_prediction", "labsid.model_structures.prediction:free_run"),
        ("model-structures/ms-6-figure-8", "model-structures/ms-6-numbers"),
        (
            "tests/labsid/model_structures/test_prediction.py::test_prediction_leans_on_the_measurements_and_simulation_does_not",
            VARIANT,
        ),
    ),
    Row(
        "Reading",
        "L6: the five input signals",
        (
            "labsid.model_structures.input_signals:step",
            "labsid.model_structures.input_signals:uniform_noise",
            "labsid.model_structures.input_signals:arma_process",
            "labsid.model_structures.input_signals:sinusoids",
            "labsid.model_structures.input_signals:feedback",
        ),
        ("model-structures/ms-7-five-inputs",),
        (
            "tests/labsid/model_structures/test_input_signals.py::test_order_of_excitation_of_sinusoids",
            "tests/labsid/model_structures/test_input_signals.py::test_a_gain_without_a_set_point_hides_the_plant_and_two_remedies",
        ),
    ),
    Row(
        "Reading",
        "L6: persistent excitation",
        ("labsid.lab.excitation:excitation_order", "labsid.lab.excitation:persistent_excitation"),
        ("model-structures/ms-7-excitation",),
        ("tests/labsid/lab/test_excitation.py::test_order_of_known_signals", VARIANT),
    ),
    Row(
        "Reading",
        "L7: loss against order, Fig. 15; AIC, BIC, FPE",
        ("labsid.model_structures.order:loss_against_order",),
        ("model-structures/ms-8-order", "model-structures/ms-8-figure-15"),
        (
            "tests/labsid/model_structures/test_order.py::test_the_loss_falls_to_the_noise_at_the_true_order_and_hardly_further",
            "tests/labsid/model_structures/test_order.py::test_criteria_are_those_of_statsmodels_but_for_their_constants",
            VARIANT,
        ),
    ),
    Row(
        "Reading",
        "L7: over-parameterisation, Example 7-2",
        ("labsid.model_structures.lecture_systems:example_7_2", "labsid.model_structures.order:pair_roots"),
        ("model-structures/ms-9-example-7-2", "model-structures/ms-9-cancel"),
        (
            "tests/labsid/model_structures/test_order.py::test_example_7_2_is_singular_with_the_true_noise_and_only_nearly_with_its_estimate",
            "tests/labsid/model_structures/test_order.py::test_an_overfitted_noisy_arx_is_not_singular_however_long_the_record",
            "tests/labsid/model_structures/test_order.py::test_the_common_factor_cancels_whatever_d_is",
            VARIANT,
        ),
    ),
    Row(
        "Reading",
        "L1, step 5: residual tests",
        (
            "labsid.model_structures.residuals:autocorrelation",
            "labsid.model_structures.residuals:cross_correlation",
            "labsid.model_structures.residuals:whiteness_test",
        ),
        ("model-structures/ms-10-autocorrelation", "model-structures/ms-10-tests"),
        (
            "tests/labsid/model_structures/test_residuals.py::test_statsmodels_agrees_on_every_lag",
            "tests/labsid/model_structures/test_residuals.py::test_ljung_box_is_that_of_statsmodels",
            VARIANT,
        ),
    ),
    Row(
        "SUSTech",
        "ARX(p, q), regressor and H",
        ("labsid.model_structures.structures:arx_pq", "labsid.model_structures.structures:build_equations"),
        ("model-structures/ms-4-equations",),
        ("tests/labsid/model_structures/test_structures.py::test_rows_are_the_sums_of_the_definition", VARIANT),
    ),
    Row(
        "SUSTech",
        "one-step predictor",
        ("labsid.model_structures.prediction:one_step_prediction",),
        ("model-structures/ms-6-predict",),
        (
            "tests/labsid/model_structures/test_prediction.py::test_arx_prediction_is_phi_theta_of_the_sustech_predictor",
            VARIANT,
        ),
    ),
    Row(
        "SUSTech",
        "transfer function to difference equation to state space",
        (
            "labsid.model_structures.realisation:model_from_transfer_function",
            "labsid.model_structures.realisation:controllable_form",
        ),
        ("model-structures/ms-3-state-space", "model-structures/ms-3-there-and-back"),
        (
            "tests/labsid/model_structures/test_realisation.py::test_sustech_example_1_by_hand",
            "tests/labsid/model_structures/test_realisation.py::test_the_state_space_has_the_transfer_function",
            VARIANT,
        ),
    ),
)
