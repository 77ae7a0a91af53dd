"""Recursive estimators: the worked examples, the batch estimate, an independent filter, and what goes wrong."""

import subprocess
import sys
import tracemalloc
from pathlib import Path

import numba
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.signal import lfilter

from labsid import _compiled
from labsid.estimation import _loops
from labsid.estimation.monte_carlo import run_monte_carlo
from labsid.estimation.recursion import RecursiveState, diffuse_start
from labsid.estimation.recursive import (
    recursive_armax,
    recursive_instrumental,
    recursive_least_squares,
    unsymmetrised_rls,
)
from labsid.least_squares.solve import solve_least_squares
from labsid.model_structures.lecture_systems import (
    example_3_2,
    example_6_1,
    example_7_1,
    example_8_1,
    system_1,
    system_2,
)
from labsid.model_structures.structures import Structure, build_equations

ARX = Structure(1, 1)
ARMAX = Structure(1, 1, 1)


def state(theta, P, trace_bound=np.inf):
    return RecursiveState(np.array(theta, float), np.array(P, float), trace_bound, np.empty(0))


def lectures_form(Phi, Y, forgetting, theta, P):
    """Eq. of L5 as printed, with numpy: the oracle for the compiled loop."""
    history = []
    for phi, y in zip(Phi, Y, strict=True):
        error = y - phi @ theta
        P = (P - np.outer(P @ phi, phi @ P) / (forgetting + phi @ P @ phi)) / forgetting
        theta = theta + P @ phi * error
        history.append(theta)
    return np.array(history), P


def regression(n=300, p=3, seed=0):
    rng = np.random.default_rng(seed)
    Phi = rng.standard_normal((n, p))
    return Phi, Phi @ np.arange(1.0, p + 1) + rng.standard_normal(n)


# Hand-worked examples


def test_example_3_2_the_recursive_mean():
    y = example_3_2(np.random.default_rng(0)).y
    run = recursive_least_squares(np.ones((50, 1)), y, start=diffuse_start(1, large=1e7))
    np.testing.assert_allclose(run.theta[:, 0], np.cumsum(y) / np.arange(1, 51), rtol=1e-6)
    # theta(n) = theta(n-1) + (y(n) - theta(n-1)) / n, worked by hand for 1, 2, 6: means 1, 1.5, 3.
    by_hand = recursive_least_squares(np.ones((3, 1)), [1.0, 2.0, 6.0], start=diffuse_start(1, large=1e7))
    np.testing.assert_allclose(by_hand.theta[:, 0], [1, 1.5, 3], rtol=2e-7)
    np.testing.assert_allclose(by_hand.error, [1, 1, 4.5], rtol=2e-7)


@pytest.mark.parametrize("large", [1.0, 100.0, 1e6])
def test_example_5_1_the_gain_is_one_over_n_only_for_a_diffuse_start(large):
    """Errata: P^-1(n) = n needs P^-1(0) = 0; with P(0) = LN it is n + 1 / LN."""
    run = recursive_least_squares(np.ones((40, 1)), np.zeros(40), start=diffuse_start(1, large))
    n = np.arange(1, 41)
    np.testing.assert_allclose(1 / run.P_trace, n + 1 / large, rtol=1e-9)
    assert (np.max(np.abs(run.P_trace * n - 1)) < 1e-5) == (large == 1e6)


def test_example_5_2_with_the_numbers_of_the_errata():
    run = recursive_least_squares([[0.6, 0.4]], [0.4], start=state([0.8, 0.1], 1000 * np.eye(2)))
    assert run.error[0] == pytest.approx(-0.12, abs=1e-15)
    P = run.state.P
    np.testing.assert_allclose(P, [[309.0211, -460.6526], [-460.6526, 692.8983]], atol=5e-5)
    np.testing.assert_allclose(P @ [0.6, 0.4], [1.15163, 0.76775], atol=5e-6)
    np.testing.assert_allclose(run.theta[0], [0.66180, 0.00787], atol=5e-6)
    # The print took 360000 for the last entry of the outer product and so b = 18.434.
    assert abs(run.theta[0, 1] - 18.434) > 18


# Derivation


@pytest.mark.parametrize("forgetting", [1.0, 0.95])
def test_the_inversion_lemma_step_by_step(forgetting):
    """P^-1(n) = lambda P^-1(n-1) + phi phi' and theta(n) - theta(n-1) = P(n) phi(n) epsilon(n), eq. (7), (12), (14)."""
    Phi, Y = regression(20)
    at = state(np.zeros(3), 10 * np.eye(3))
    for phi, y in zip(Phi, Y, strict=True):
        run = recursive_least_squares(phi[None], [y], forgetting, at)
        information = forgetting * np.linalg.inv(at.P) + np.outer(phi, phi)
        np.testing.assert_allclose(run.state.P, np.linalg.inv(information), rtol=1e-9, atol=1e-12)
        np.testing.assert_allclose(run.theta[0] - at.theta, run.state.P @ phi * run.error[0], rtol=1e-8, atol=1e-12)
        at = run.state


@pytest.mark.parametrize("forgetting", [1.0, 0.99, 0.9])
def test_the_compiled_loop_is_the_lectures_form(forgetting):
    Phi, Y = regression()
    run = recursive_least_squares(Phi, Y, forgetting, state(np.zeros(3), 1e3 * np.eye(3)))
    history, P = lectures_form(Phi, Y, forgetting, np.zeros(3), 1e3 * np.eye(3))
    np.testing.assert_allclose(run.theta, history, rtol=1e-8, atol=1e-10)
    np.testing.assert_allclose(run.state.P, P, rtol=1e-9)
    np.testing.assert_allclose(run.P_trace[-1], np.trace(P), rtol=1e-9)


def test_the_last_row_is_the_weighted_batch_estimate():
    Phi, Y = regression()
    w = np.sqrt(0.97 ** np.arange(299, -1, -1))
    run = recursive_least_squares(Phi, Y, 0.97)
    np.testing.assert_allclose(run.theta[-1], solve_least_squares(Phi * w[:, None], Y * w).theta, rtol=1e-8)


# The batch estimate, also over a million samples


def test_a_million_samples_give_the_batch_estimate_to_1e_8():
    n = 10**6
    rng = np.random.default_rng(1)
    u, e = rng.standard_normal((2, n))
    y = lfilter([0, 1, 0.5], [1, -1.5, 0.7], u) + lfilter([0.3], [1, -1.5, 0.7], e)
    equations = build_equations(Structure(2, 2), u, y, start=0)
    batch = np.linalg.lstsq(equations.Phi, equations.Y, rcond=None)[0]
    run = recursive_least_squares(equations.Phi, equations.Y)
    np.testing.assert_allclose(run.theta[-1], batch, atol=1e-8, rtol=0)
    assert np.array_equal(run.state.P, run.state.P.T)
    online = recursive_armax(Structure(2, 2), u, y)
    np.testing.assert_allclose(online.theta[-1], batch, atol=1e-8, rtol=0)


@given(st.integers(1, 5), st.integers(0, 10**6), st.floats(1e-3, 1e3))
@settings(max_examples=60, deadline=None)
def test_the_batch_estimate_and_scaling(p, seed, factor):
    Phi, Y = regression(60, p, seed)
    run = recursive_least_squares(Phi, Y, start=diffuse_start(p, 1e9))
    np.testing.assert_allclose(run.theta[-1], solve_least_squares(Phi, Y).theta, rtol=1e-6, atol=1e-6)
    scaled = recursive_least_squares(Phi, factor * Y, start=diffuse_start(p, 1e9))
    np.testing.assert_allclose(scaled.theta, factor * run.theta, rtol=1e-6, atol=1e-6 * factor)


@given(st.integers(1, 40), st.integers(0, 10**6))
@settings(max_examples=40, deadline=None)
def test_a_shift_in_time_changes_nothing(rest, seed):
    """Waiting at rest before the experiment: nothing is learnt, and then everything as before."""
    r = example_7_1(np.random.default_rng(seed), 200)
    u, y = np.concatenate([np.zeros(rest), r.u]), np.concatenate([np.zeros(rest), r.y])
    for structure in (ARX, ARMAX):
        now, later = recursive_armax(structure, r.u, r.y), recursive_armax(structure, u, y)
        assert np.array_equal(later.theta[rest:], now.theta)
        assert not np.any(later.theta[:rest])
    now, later = (
        recursive_instrumental(ARX, r.u, r.y, warm_up=50),
        recursive_instrumental(ARX, u, y, warm_up=50 + rest),
    )
    assert np.array_equal(later.theta[rest:], now.theta)


def test_the_whole_history_agrees_with_statsmodels():
    models = pytest.importorskip("statsmodels.regression.recursive_ls", reason="statsmodels is not installed")
    Phi, Y = regression()
    oracle = models.RecursiveLS(Y, Phi).fit().recursive_coefficients.filtered.T
    run = recursive_least_squares(Phi, Y, start=diffuse_start(3, 1e8))
    np.testing.assert_allclose(run.theta[10:], oracle[10:], rtol=1e-6)


# Online use and memory


@pytest.mark.parametrize("forgetting", [1.0, 0.98])
def test_one_sample_at_a_time_is_the_same_run(forgetting):
    Phi, Y = regression(100)
    whole = recursive_least_squares(Phi, Y, forgetting)
    at = None
    for k in range(100):
        step = recursive_least_squares(Phi[k : k + 1], Y[k : k + 1], forgetting, at)
        np.testing.assert_allclose(step.theta[0], whole.theta[k], rtol=1e-7, atol=1e-9)
        at = step.state
    np.testing.assert_allclose(at.P, whole.state.P, rtol=1e-7)
    assert np.array_equal(at.P, at.P.T)


@pytest.mark.parametrize("cuts", [[1, 2, 3], [150], [7, 101, 400]])
def test_armax_and_iv_go_on_bit_for_bit_where_they_stopped(cuts):
    r = example_7_1(np.random.default_rng(3), 500)
    for whole, go_on in (
        (recursive_armax(ARMAX, r.u, r.y, 0.99), lambda u, y, at: recursive_armax(ARMAX, u, y, 0.99, at)),
        (
            recursive_instrumental(ARX, r.u, r.y, warm_up=cuts[0]),
            lambda u, y, at: recursive_instrumental(ARX, u, y, warm_up=cuts[0], start=at),
        ),
    ):
        at, pieces = None, []
        for u, y in zip(np.split(r.u, cuts), np.split(r.y, cuts), strict=True):
            run = go_on(u, y, at)
            at = run.state
            pieces.append(run.theta)
        assert np.array_equal(np.vstack(pieces), whole.theta)


def test_memory_of_the_streaming_path_does_not_grow_with_the_record():
    rng = np.random.default_rng(0)

    def peak(chunks):
        at = recursive_armax(ARMAX, np.zeros(10), np.zeros(10)).state  # compiles outside the measurement
        tracemalloc.start()
        for _ in range(chunks):
            at = recursive_armax(ARMAX, rng.standard_normal(1000), rng.standard_normal(1000), start=at).state
        top = tracemalloc.get_traced_memory()[1]
        tracemalloc.stop()
        return top

    assert peak(100) < 1.2 * peak(5)


def test_results_are_read_only_and_inputs_may_be():
    Phi, Y = regression()
    Phi.setflags(write=False)
    run = recursive_least_squares(Phi, Y)
    for array in (run.theta, run.error, run.P_trace, run.state.theta, run.state.P):
        assert not array.flags.writeable
    assert Y.flags.writeable
    np.testing.assert_array_equal(recursive_least_squares(np.asfortranarray(Phi), Y).theta, run.theta)


# Numerical soundness


def worst(theta, truth=(-0.8, 1)):
    """Largest deviation from the truth; infinite where the estimate is not a number."""
    deviation = np.abs(theta - np.array(truth))
    return np.max(np.where(np.isfinite(deviation), deviation, np.inf))


def test_the_unsymmetrised_variant_diverges_and_the_house_form_does_not():
    r = system_1(np.random.default_rng(0), 40_000)
    equations = build_equations(ARX, r.u, r.y)
    Phi, Y = equations.Phi, equations.Y
    good = recursive_least_squares(Phi, Y, 0.99)
    bad = unsymmetrised_rls(Phi[:6000], Y[:6000], 0.99)
    np.testing.assert_allclose(bad[:2000], good.theta[:2000], atol=1e-6)
    assert worst(bad[2000:]) > 100
    assert worst(good.theta[100:]) < 1
    slower = unsymmetrised_rls(Phi, Y, 0.999)
    assert worst(slower[100:20_000]) < 0.3
    assert worst(slower[20_000:]) > 100
    assert worst(unsymmetrised_rls(Phi, Y, 1.0)[20_000:]) < 0.05


@pytest.mark.parametrize("forgetting", [0.9, 0.99, 0.999])
def test_p_stays_symmetric_and_positive_definite_for_long(forgetting):
    rng = np.random.default_rng(2)
    Phi = rng.standard_normal((300_000, 4)) * [1, 10, 0.1, 1]
    run = recursive_least_squares(Phi, Phi @ [1.0, 2, 3, 4] + 0.1 * rng.standard_normal(len(Phi)), forgetting)
    assert np.array_equal(run.state.P, run.state.P.T)
    assert np.linalg.eigvalsh(run.state.P)[0] > 0
    assert np.all(np.abs(run.theta[-1] - [1, 2, 3, 4]) < [0.3, 0.1, 3, 0.3])


def quiet_then_busy(forgetting=0.98, trace_bound=None):
    """A constant input for 5000 samples, then noise again: System 1, with the estimate followed throughout."""
    rng = np.random.default_rng(4)
    u = np.concatenate([rng.uniform(-2, 2, 500), np.ones(5000), rng.uniform(-2, 2, 300)])
    y = lfilter([0, 1], [1, -0.8], u) + 0.1 * lfilter([1], [1, -0.8], rng.standard_normal(u.size))
    return recursive_armax(ARX, u, y, forgetting, diffuse_start(2, 1e6, trace_bound))


def test_covariance_winds_up_under_a_constant_input_without_a_bound():
    rng = np.random.default_rng(4)
    Phi = np.concatenate([rng.standard_normal((200, 2)), np.ones((2000, 2))])
    Y = Phi @ [1.0, 2.0]
    wound = recursive_least_squares(Phi, Y, 0.9, diffuse_start(2, trace_bound=np.inf))
    assert wound.P_trace[199] < 1
    # In the direction [1, -1], which a constant does not excite, P grows by 1 / lambda a sample.
    assert np.log(wound.P_trace[800] / wound.P_trace[700]) == pytest.approx(-100 * np.log(0.9), rel=1e-3)
    assert wound.P_trace[-1] > 1e60
    bounded = recursive_least_squares(Phi, Y, 0.9, diffuse_start(2, trace_bound=10.0))
    assert 8 < bounded.P_trace[-1] <= 10
    np.testing.assert_allclose(bounded.theta[-1], [1, 2], atol=1e-6)
    default = recursive_least_squares(Phi, Y, 0.9)
    assert np.max(default.P_trace) <= 4e6


def test_a_bound_keeps_the_estimate_through_a_quiet_stretch():
    free, tight = quiet_then_busy(trace_bound=np.inf), quiet_then_busy(trace_bound=1.0)
    assert worst(free.theta[500:5500]) > 0.5  # thrown off by noise that P takes for news
    assert worst(tight.theta[500:5500]) < 0.15
    assert np.max(tight.P_trace[100:]) <= 1
    np.testing.assert_allclose(tight.theta[-1], [-0.8, 1], atol=0.05)


@pytest.mark.parametrize("bound", [0.5, 5.0, 40.0])
def test_forgetting_pauses_for_exactly_the_samples_that_would_pass_the_bound(bound):
    """The rule as printed, with numpy, against both compiled loops, from the rows and from the signals."""
    rng = np.random.default_rng(6)
    u = np.concatenate([rng.uniform(-2, 2, 60), np.ones(150), rng.uniform(-2, 2, 40)])
    equations = build_equations(Structure(0, 2), u, np.zeros(u.size), start=0)
    Phi, Y = equations.Phi, equations.Phi @ [1.0, 2.0] + 0.1 * rng.standard_normal(u.size)
    theta, P, expected, paused = np.zeros(2), 10 * np.eye(2), [], 0
    for phi, y in zip(Phi, Y, strict=True):
        forgetting = 0.9 if np.trace(P) / 0.9 <= bound else 1.0
        paused += forgetting == 1.0
        history, P = lectures_form(phi[None], [y], forgetting, theta, P)
        theta = history[0]
        expected.append([*theta, np.trace(P)])
    assert 20 < paused < 230
    start = state(np.zeros(2), 10 * np.eye(2), bound)
    for run in (recursive_least_squares(Phi, Y, 0.9, start), recursive_armax(Structure(0, 2), u, Y, 0.9, start)):
        np.testing.assert_allclose(np.column_stack([run.theta, run.P_trace]), expected, rtol=1e-7, atol=1e-9)


def test_a_bound_that_is_not_reached_changes_nothing():
    Phi, Y = regression()
    free = recursive_least_squares(Phi, Y, 0.98, diffuse_start(3, trace_bound=np.inf))
    assert np.array_equal(free.theta, recursive_least_squares(Phi, Y, 0.98, diffuse_start(3)).theta)


def test_winding_up_for_ever_is_reported_as_diverged():
    start = diffuse_start(2, trace_bound=np.inf)
    run = recursive_least_squares(np.ones((40_000, 2)), np.ones(40_000), 0.9, start)
    assert run.status == "diverged"
    assert recursive_least_squares(np.ones((40_000, 2)), np.ones(40_000), 0.9).status == "finite"


# The lectures' simulations


def test_example_6_1_forgetting_follows_the_change_and_lambda_1_does_not():
    """Fig. 9 and 10, over 40 records: mean absolute error at the end and scatter before the change."""
    structure, ends = Structure(2, 1), {1.0: [], 0.99: []}
    scatter = {1.0: [], 0.99: []}
    for seed in range(40):
        r = example_6_1(np.random.default_rng(seed))
        for forgetting in ends:
            theta = recursive_armax(structure, r.u, r.y, forgetting).theta
            ends[forgetting].append(theta[-1] - r.theta[-1])
            scatter[forgetting].append(np.std(theta[300:500], axis=0))
    error = {forgetting: np.sqrt(np.mean(np.square(e), axis=0)) for forgetting, e in ends.items()}
    assert np.all(error[1.0][[0, 2]] > 2 * error[0.99][[0, 2]])
    assert error[1.0][2] > 0.3  # b1 ends half-way between 1 and 2
    assert np.all(error[0.99] < 0.15)
    assert np.all(np.mean(scatter[0.99], axis=0) > 2 * np.mean(scatter[1.0], axis=0))  # the price of following


def test_example_7_1_rels_is_consistent_where_rls_is_biased():
    def repeat(structure, truth, samples):
        def estimate(rng):
            r = example_7_1(rng, samples)
            return recursive_armax(structure, r.u, r.y).theta[-1]

        return run_monte_carlo(estimate, truth, 100, seed=7)

    short, long = (repeat(ARMAX, [-0.9, 1.0, 0.3], samples) for samples in (1000, 16_000))
    assert np.all(np.abs(long.bias[:2]) < 4 * long.bias_stderr[:2])
    assert abs(long.bias[2]) < 0.6 * abs(short.bias[2]) < 0.06  # c is learnt from errors that were wrong at first
    plain = repeat(ARX, [-0.9, 1.0], 16_000)
    assert np.all(np.abs(plain.bias) > 10 * plain.bias_stderr)


def test_rels_reduces_to_rls_without_noise_terms_and_takes_no_input():
    r = system_1(np.random.default_rng(5), 400)
    equations = build_equations(ARX, r.u, r.y, start=0)
    np.testing.assert_allclose(
        recursive_armax(ARX, r.u, r.y, 0.99).theta,
        recursive_least_squares(equations.Phi, equations.Y, 0.99).theta,
        rtol=1e-8,
        atol=1e-10,
    )
    ar = recursive_armax(Structure(1, 0), None, lfilter([1], [1, -0.8], r.e))
    assert ar.theta[-1, 0] == pytest.approx(-0.8, abs=0.1)


def test_example_8_1_recursive_iv_beats_rls_on_strong_inputs_and_says_when_it_held_back():
    """On Example 7-1's strong input the bias of least squares shows; on 8-1's own, noise rules every single record."""

    def strong(rng):
        r = example_7_1(rng, 3000)
        return recursive_instrumental(ARX, r.u, r.y).theta[-1]

    iv = run_monte_carlo(strong, [-0.9, 1.0], 150, seed=8)
    assert iv.failed == 0
    assert np.all(np.abs(iv.bias) < 4 * iv.bias_stderr + 1e-3)
    ends, held = [], []
    for seed in range(100):
        r = example_8_1(np.random.default_rng(seed))
        run = recursive_instrumental(ARX, r.u, r.y)
        ends.append(run.theta[-1])
        held.append(run.kept_back)
        assert run.status == "finite"
    assert np.median(ends, axis=0) == pytest.approx([-0.9, 1.0], abs=0.1)
    assert 0 in held
    assert max(held) > 0


def test_recursive_iv_is_consistent_on_system_2():
    def estimate(rng):
        r = system_2(rng, 4000)
        return recursive_instrumental(ARX, r.u, r.y).theta[-1]

    iv = run_monte_carlo(estimate, [-0.8, 1.0], 150, seed=9)
    # The least-squares start of 100 samples is forgotten as 1 / n; least squares itself stays at -0.63.
    assert np.all(np.abs(iv.bias) < [0.01, 0.01])


@pytest.mark.parametrize(("a", "stable"), [([0.5], True), ([-1.0], False), ([-1.5, 0.7], True), ([-2.1, 1.2], False)])
def test_the_stability_test_of_the_instruments(a, stable):
    assert _loops.roots_inside(np.array(a), len(a), np.empty(len(a))) == stable


@given(st.lists(st.floats(-2, 2), min_size=1, max_size=5))
@settings(max_examples=200, deadline=None)
def test_the_stability_test_agrees_with_the_roots(a):
    radius = np.max(np.abs(np.roots([1.0, *a])), initial=0.0)
    if abs(radius - 1) > 1e-6:
        assert _loops.roots_inside(np.array(a), len(a), np.empty(len(a))) == (radius < 1)


# Compilation


def test_without_a_folder_to_cache_in_it_compiles_all_the_same(monkeypatch):
    def njit_of_a_read_only_machine(cache=False, **options):
        def decorate(function):
            if cache:
                raise RuntimeError("cannot cache function: no locator available")  # as numba does
            return numba.njit(**options)(function)

        return decorate

    monkeypatch.setattr(_compiled, "njit", njit_of_a_read_only_machine)
    double = _compiled.compiled("contract")(lambda x: 2 * x)
    assert double(3.0) == 6.0


def test_importing_the_package_and_the_module_does_not_load_numba():
    program = "import sys, labsid, labsid.estimation.recursive, labsid.lab.long_arx; assert 'numba' not in sys.modules"
    subprocess.run([sys.executable, "-c", program], check=True, cwd=Path(__file__).parent)


# Bad input


@pytest.mark.parametrize("forgetting", [0, -0.5, 1.01, np.nan])
def test_forgetting_outside_its_range(forgetting):
    with pytest.raises(ValueError, match=r"forgetting must lie in \(0, 1\]; got"):
        recursive_least_squares(np.ones((3, 1)), np.ones(3), forgetting)
    with pytest.raises(ValueError, match=r"forgetting must lie in"):
        recursive_armax(ARX, np.ones(3), np.ones(3), forgetting)
    with pytest.raises(ValueError, match=r"forgetting must lie in"):
        unsymmetrised_rls(np.ones((3, 1)), np.ones(3), forgetting)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: recursive_least_squares(np.ones((4, 2)), np.ones(3)), r"got shapes \(4, 2\) and \(3,\)"),
        (lambda: recursive_least_squares(np.ones(4), np.ones(4)), "one row per sample"),
        (lambda: recursive_least_squares([[1.0], [np.nan]], [1, 2]), "Phi must be finite; got nan"),
        (lambda: recursive_least_squares([[1.0], [1.0]], [1, np.inf]), "Y must be finite; got inf at sample 1"),
        (lambda: recursive_least_squares(np.ones((4, 2)), np.ones(4), start=diffuse_start(3)), "with 2 parameters"),
        (lambda: recursive_armax(ARX, [1, 2, 3], [1, 2]), "u and y must have equal length; got 3 and 2"),
        (lambda: recursive_armax(ARX, [1, np.nan], [1, 2]), "u must be finite"),
        (lambda: recursive_armax(ARX, None, [1, 2]), "u must be given: the ARX"),
        (lambda: recursive_armax(Structure(1, 1, delay=2), [1, 2], [1, 2]), "delay of 1 here; got 2. Shift"),
        (lambda: recursive_armax(ARX, [1, 2], [1, 2], start=diffuse_start(3)), "2 parameters and 2 remembered"),
        (lambda: recursive_instrumental(ARMAX, [1, 2], [1, 2]), "structure must be ARX"),
        (lambda: recursive_instrumental(ARX, [1, 2], [1, 2], warm_up=-1), "warm_up zero or more"),
        (lambda: recursive_instrumental(ARX, [1, 2, 3], [1, 2]), "equal length; got 3 and 2"),
        (lambda: diffuse_start(0), "p must be at least 1"),
        (lambda: diffuse_start(2, large=-1), "large must be a positive number; got -1"),
        (lambda: diffuse_start(2, trace_bound=0), "trace_bound must be positive; got 0"),
    ],
)
def test_bad_input_says_what_is_wrong(call, message):
    with pytest.raises(ValueError, match=message):
        call()


INTERPRETED = """
import sys
import numpy as np
from labsid.estimation.recursive import recursive_armax, recursive_instrumental, recursive_least_squares
from labsid.model_structures.structures import Structure

def estimates():
    rng = np.random.default_rng(3)
    Phi = rng.standard_normal((150, 3))
    u, y = rng.standard_normal((2, 150))
    return np.column_stack([
        recursive_least_squares(Phi, Phi @ [1.0, 2.0, 3.0] + y, 0.95).theta,
        recursive_armax(Structure(1, 1, 1), u, y).theta,
        recursive_instrumental(Structure(1, 1), u, y, 30).theta,
    ])

interpreted = estimates()
assert "numba" not in sys.modules
recursive_least_squares(np.ones((3000, 1)), np.ones(3000))
assert "numba" in sys.modules
assert np.array_equal(interpreted, estimates())
"""


def test_short_records_need_no_compiler_and_give_the_same():
    subprocess.run([sys.executable, "-W", "error", "-c", INTERPRETED], check=True)
