"""What the assignment `armax-and-instruments` covers of the lectures, line by line."""

from seed_coverage.row import VARIANT, Row

_MONTE_CARLO = "tests/labsid/estimation/test_monte_carlo.py"
_INSTRUMENTAL = "tests/labsid/estimation/test_instrumental.py"
_RECURSIVE = "tests/labsid/estimation/test_recursive.py"

ROWS = (
    Row(
        "Reading",
        "the third MATLAB program, Systems 1 and 2 side by side (Fig. 11)",
        ("labsid.model_structures.lecture_systems:system_1", "labsid.model_structures.lecture_systems:system_2"),
        ("armax-and-instruments/ai-1-systems",),
        (
            "tests/labsid/model_structures/test_lecture_systems.py::test_system_1_is_the_printed_program",
            "tests/labsid/model_structures/test_lecture_systems.py::test_system_2_is_the_printed_program_and_white_noise_on_the_output",
        ),
    ),
    Row(
        "Reading",
        "L6: Example 6-2, Tables 2 and 3 by Monte Carlo",
        ("labsid.estimation.monte_carlo:run_monte_carlo", "labsid.model_structures.structures:fit_structure"),
        ("armax-and-instruments/ai-1-tables", "armax-and-instruments/ai-1-figure-tables"),
        (
            f"{_MONTE_CARLO}::test_tables_1_and_2_least_squares_on_system_1",
            f"{_MONTE_CARLO}::test_table_3_least_squares_on_system_2",
            VARIANT,
        ),
    ),
    Row(
        "Reading",
        "L6: bias with its standard error, unbiasedness and consistency told apart",
        ("labsid.estimation.monte_carlo:MonteCarlo",),
        (
            "armax-and-instruments/ai-2-bias",
            "armax-and-instruments/ai-2-figure-consistency",
            "armax-and-instruments/ai-2-consistent",
        ),
        (
            f"{_MONTE_CARLO}::test_the_standard_error_covers_the_truth_as_often_as_it_should",
            f"{_MONTE_CARLO}::test_least_squares_on_system_1_is_consistent_but_not_unbiased",
            VARIANT,
        ),
    ),
    Row(
        "Reading",
        "L6, L7: E([Phi'Phi]^-1 Phi'v), the bias computed",
        ("labsid.model_structures.structures:fit_structure",),
        ("armax-and-instruments/ai-3-limit", "armax-and-instruments/ai-3-figure-limit"),
        (f"{_MONTE_CARLO}::test_table_3_least_squares_on_system_2", VARIANT),
    ),
    Row(
        "Reading",
        "L6: Lemma 1, covariance of the estimate; L8, inputs alone in phi",
        ("labsid.least_squares.intervals:parameter_covariance",),
        ("armax-and-instruments/ai-4-covariance", "armax-and-instruments/ai-4-lemma-1"),
        ("tests/labsid/least_squares/test_intervals.py::test_intervals_are_those_of_statsmodels", VARIANT),
    ),
    Row(
        "Reading",
        "L7: Fig. 12, autocorrelation of white and of coloured noise",
        ("labsid.model_structures.residuals:autocorrelation",),
        ("armax-and-instruments/ai-5-figure-12",),
        ("tests/labsid/model_structures/test_residuals.py::test_statsmodels_agrees_on_every_lag",),
    ),
    Row(
        "Reading",
        "L7: pseudo-linear regression over a whole record",
        ("labsid.estimation.armax:fit_armax", "labsid.model_structures.prediction:prediction_errors"),
        ("armax-and-instruments/ai-5-armax", "armax-and-instruments/ai-5-figure-rounds"),
        (
            "tests/labsid/estimation/test_armax.py::test_the_solution_regresses_on_its_own_prediction_errors",
            "tests/labsid/estimation/test_armax.py::test_it_finds_the_noise_model_over_many_records",
            VARIANT,
        ),
    ),
    Row(
        "Reading",
        "L7: RELS, pseudo-linear regression sample by sample, Example 7-1 (Fig. 13 and 14)",
        ("labsid.estimation.recursive:recursive_armax", "labsid.model_structures.lecture_systems:example_7_1"),
        (
            "armax-and-instruments/ai-5-figure-13",
            "armax-and-instruments/ai-6-rels",
            "armax-and-instruments/ai-6-figure-14",
            "armax-and-instruments/ai-6-bias",
        ),
        (f"{_RECURSIVE}::test_example_7_1_rels_is_consistent_where_rls_is_biased", VARIANT),
    ),
    Row(
        "Reading",
        "L8: instrumental variables",
        ("labsid.estimation.instrumental:instrumental_variables", "labsid.estimation.instrumental:fit_instrumental"),
        ("armax-and-instruments/ai-7-iterated", "armax-and-instruments/ai-7-figure-iv"),
        (
            f"{_INSTRUMENTAL}::test_iv_is_consistent_on_system_2_where_least_squares_is_not",
            f"{_INSTRUMENTAL}::test_it_agrees_with_statsmodels",
            "tests/test_notebook_statements.py::test_instruments_need_noise_of_mean_zero",
            VARIANT,
        ),
    ),
    Row(
        "Reading",
        "L8: recursive IV, Example 8-1 (Fig. 16 and 17)",
        ("labsid.estimation.recursive:recursive_instrumental", "labsid.model_structures.lecture_systems:example_8_1"),
        (
            "armax-and-instruments/ai-8-recursive",
            "armax-and-instruments/ai-8-figures-16-and-17",
            "armax-and-instruments/ai-8-one-record",
        ),
        (
            f"{_RECURSIVE}::test_recursive_iv_is_consistent_on_system_2",
            f"{_INSTRUMENTAL}::test_example_8_1_the_median_is_right_and_a_single_record_is_not",
            VARIANT,
        ),
    ),
    Row(
        "Reading",
        "L8: maximum likelihood, and its equivalence to least squares",
        ("labsid.estimation.likelihood:log_likelihood", "labsid.estimation.likelihood:maximise_likelihood"),
        ("armax-and-instruments/ai-9-likelihood", "armax-and-instruments/ai-9-figure-likelihood"),
        ("tests/labsid/estimation/test_likelihood.py::test_the_top_of_the_likelihood_is_least_squares", VARIANT),
    ),
    Row(
        "Reading",
        "L8: maximum likelihood of ARMAX by prediction errors, the four estimators side by side",
        ("labsid.estimation.likelihood:fit_likelihood",),
        ("armax-and-instruments/ai-9-all-four",),
        ("tests/labsid/estimation/test_likelihood.py::test_armax_by_likelihood_agrees_with_a_general_optimiser",),
    ),
)
