"""What the assignment `nonlinear-least-squares` covers of the lectures, line by line."""

from seed_coverage.row import VARIANT, Row

ROWS = (
    Row(
        "SUSTech",
        "y = b e^(ax) through the logarithm (erratum: the third sample is negative, the label is the other method's)",
        ("labsid.nonlinear.exponential:fit_exponential_by_logarithm",),
        ("nonlinear-least-squares/nl-1-logarithm", "nonlinear-least-squares/nl-1-sustech-points"),
        (
            "tests/labsid/nonlinear/test_exponential.py::test_the_printed_data_have_no_logarithm",
            "tests/labsid/nonlinear/test_exponential.py::test_without_the_third_point_the_logarithm_works_and_is_not_the_least_squares_curve",
            VARIANT,
        ),
    ),
    Row(
        "SUSTech",
        "y = b e^(ax) as min |y - b e^(ax)|^2",
        ("labsid.nonlinear.exponential:fit_exponential",),
        ("nonlinear-least-squares/nl-5-exponential", "nonlinear-least-squares/nl-4-figure-paths"),
        (
            "tests/labsid/nonlinear/test_exponential.py::test_worked_value_on_the_printed_data",
            "tests/labsid/nonlinear/test_exponential.py::test_scipy_finds_the_same_with_the_same_covariance",
            VARIANT,
        ),
    ),
    Row(
        "SUSTech",
        "the problem min |y - g(theta)|^2, its Jacobian and the gradient of the cost",
        ("labsid.least_squares.gradients:numerical_jacobian", "labsid.nonlinear.exponential:evaluate_exponential"),
        ("nonlinear-least-squares/nl-2-jacobian", "nonlinear-least-squares/nl-2-differences"),
        (
            "tests/labsid/least_squares/test_gradients.py::test_numerical_jacobian_is_scipys",
            "tests/labsid/nonlinear/test_solve.py::test_scipy_finds_the_same",
            VARIANT,
        ),
    ),
    Row(
        "SUSTech",
        "numerical optimisation: Gauss-Newton, and where it diverges",
        ("labsid.nonlinear.solve:gauss_newton",),
        ("nonlinear-least-squares/nl-3-gauss-newton", "nonlinear-least-squares/nl-3-figure-divergence"),
        (
            "tests/labsid/nonlinear/test_solve.py::test_gauss_newton_overshoots_where_levenberg_marquardt_shortens_the_step",
            VARIANT,
        ),
    ),
    Row(
        "SUSTech",
        "numerical optimisation: Levenberg-Marquardt, starting values and local minima",
        ("labsid.nonlinear.solve:levenberg_marquardt",),
        (
            "nonlinear-least-squares/nl-4-damping",
            "nonlinear-least-squares/nl-6-frequency",
            "nonlinear-least-squares/nl-6-figure-valleys",
        ),
        (
            "tests/labsid/nonlinear/test_solve.py::test_levenberg_marquardt_arrives_from_afar_downhill_all_the_way",
            "tests/labsid/nonlinear/test_solve.py::test_rosenbrock",
            VARIANT,
        ),
    ),
    Row(
        "SUSTech",
        "navigation by range measurement, with layouts that cannot tell",
        ("labsid.nonlinear.ranges:locate", "labsid.nonlinear.ranges:ranges_jacobian"),
        ("nonlinear-least-squares/nl-7-locate", "nonlinear-least-squares/nl-7-layout"),
        (
            "tests/labsid/nonlinear/test_ranges.py::test_no_start_of_scipys_finds_a_better_place",
            "tests/labsid/nonlinear/test_ranges.py::test_beacons_on_a_line_leave_a_mirror_image",
            "tests/labsid/nonlinear/test_ranges.py::test_beacons_in_one_place_leave_a_circle",
            VARIANT,
        ),
    ),
    Row(
        "SUSTech",
        "coding example (empty in the text: chosen), and how the layout magnifies the noise",
        ("labsid.nonlinear.ranges:coding_example",),
        ("nonlinear-least-squares/nl-7-figure-layouts", "nonlinear-least-squares/nl-8-figure-scatter"),
        (
            "tests/labsid/nonlinear/test_ranges.py::test_coding_example_lies_within_its_error_and_the_dilution_foretells_it",
            "tests/labsid/nonlinear/test_ranges.py::test_beacons_far_to_one_side_dilute",
        ),
    ),
    Row(
        "UNSW",
        "step response (Fig. A1) fitted over all samples, with standard errors from J'J",
        ("labsid.lab.step_response:fit_step_response", "labsid.nonlinear.solve:levenberg_marquardt"),
        ("nonlinear-least-squares/nl-8-step", "nonlinear-least-squares/nl-8-figure-rig"),
        (
            "tests/labsid/lab/test_step_response.py::test_the_refinement_recovers_a_known_truth",
            "tests/labsid/nonlinear/test_solve.py::test_standard_errors_are_the_scatter_of_the_estimates",
            VARIANT,
        ),
    ),
    Row(
        "Reading",
        "L3, System 2: output error as nonlinear least squares against the one-step fit",
        ("labsid.model_structures.prediction:free_run", "labsid.model_structures.lecture_systems:system_2"),
        ("nonlinear-least-squares/nl-9-output-error", "nonlinear-least-squares/nl-9-figure-bias"),
        (
            "tests/labsid/model_structures/test_prediction.py::test_prediction_leans_on_the_measurements_and_simulation_does_not",
            "tests/labsid/model_structures/test_lecture_systems.py::test_system_2_is_the_printed_program_and_white_noise_on_the_output",
            VARIANT,
        ),
    ),
)
