"""Online estimators: the numbers of the functions over a record, bit for bit, and no bad sample that changes them."""

import copy
import pickle
import tracemalloc

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from labsid import RecursiveArmax, RecursiveInstrumental, RecursiveLeastSquares, Structure
from labsid.estimation.recursion import diffuse_start
from labsid.estimation.recursive import recursive_armax, recursive_instrumental, recursive_least_squares

VALUES = st.floats(-1e3, 1e3) | st.sampled_from([0.0, 1.0, 1e-300, 1e150])
FORGETTING = st.sampled_from([1.0, 0.99, 0.5])
STRUCTURES = st.builds(Structure, st.integers(0, 2), st.integers(1, 2), st.integers(0, 2))


def record(columns, longest=30):
    """Records of 1 to `longest` samples, any numbers."""
    return st.integers(1, longest).flatmap(lambda n: arrays(float, (n, columns), elements=VALUES))


def go(estimator, *signals):
    """Update sample by sample; return the errors and the history of theta."""
    course = [(estimator.update(*sample), estimator.theta) for sample in zip(*signals, strict=True)]
    return np.array([error for error, _ in course]), np.array([theta for _, theta in course])


def assert_the_same(estimator, signals, run):
    errors, history = go(estimator, *signals)
    assert np.array_equal(errors, run.error, equal_nan=True)
    assert np.array_equal(history, run.theta, equal_nan=True)
    assert np.array_equal(estimator.state.P, run.state.P, equal_nan=True)
    assert np.array_equal(estimator.state.memory, run.state.memory, equal_nan=True)


# The batch call


@given(st.integers(1, 3).flatmap(lambda p: record(p + 1)), FORGETTING, st.sampled_from([None, 5.0, np.inf]))
@settings(max_examples=150, deadline=None)
def test_least_squares_of_any_data_is_that_of_the_batch_call(data, forgetting, trace_bound):
    Phi, Y = np.ascontiguousarray(data[:, :-1]), data[:, -1]
    start = diffuse_start(Phi.shape[1], 10.0, trace_bound)
    run = recursive_least_squares(Phi, Y, forgetting, start)
    assert_the_same(RecursiveLeastSquares(Phi.shape[1], forgetting, start), (Phi, Y), run)


@given(record(2), STRUCTURES, FORGETTING)
@settings(max_examples=100, deadline=None)
def test_armax_of_any_data_is_that_of_the_batch_call(data, structure, forgetting):
    u, y = data.T
    run = recursive_armax(structure, u, y, forgetting)
    assert_the_same(RecursiveArmax(structure, forgetting), (u, y), run)


@given(record(2), st.integers(1, 2), st.integers(1, 2), st.integers(0, 20))
@settings(max_examples=100, deadline=None)
def test_instrumental_variables_of_any_data_are_those_of_the_batch_call(data, na, nb, warm_up):
    u, y = data.T
    run = recursive_instrumental(Structure(na, nb), u, y, warm_up)
    estimator = RecursiveInstrumental(Structure(na, nb), warm_up)
    assert_the_same(estimator, (u, y), run)
    assert estimator.kept_back == run.kept_back


@pytest.mark.parametrize("forgetting", [1.0, 0.98])
def test_a_long_record_is_that_of_the_batch_call(forgetting):
    rng = np.random.default_rng(0)
    Phi, noise = rng.standard_normal((20_000, 4)), rng.standard_normal(20_000)
    Y = Phi @ [1.0, 2.0, 3.0, 4.0] + noise
    assert_the_same(RecursiveLeastSquares(4, forgetting), (Phi, Y), recursive_least_squares(Phi, Y, forgetting))


def test_a_state_goes_from_a_record_to_an_estimator_and_back():
    u, y = np.random.default_rng(1).standard_normal((2, 300))
    structure = Structure(2, 1, 1)
    whole = recursive_armax(structure, u, y, 0.99)
    estimator = RecursiveArmax(structure, 0.99, recursive_armax(structure, u[:100], y[:100], 0.99).state)
    go(estimator, u[100:200], y[100:200])
    rest = recursive_armax(structure, u[200:], y[200:], 0.99, estimator.state)
    assert np.array_equal(rest.theta, whole.theta[200:])
    Phi = np.column_stack([u, y])
    whole = recursive_least_squares(Phi, u + y)
    at = RecursiveLeastSquares(2, start=recursive_least_squares(Phi[:100], (u + y)[:100]).state)
    go(at, Phi[100:], (u + y)[100:])
    np.testing.assert_allclose(at.theta, whole.theta[-1], rtol=1e-9)  # the sums of a new start round differently


# What an estimator holds

MAKERS = [
    pytest.param(lambda: RecursiveLeastSquares(2, 0.9), lambda k: ([k, 1.0], k + 2.0), id="least squares"),
    pytest.param(lambda: RecursiveArmax(Structure(1, 1, 1)), lambda k: (k % 3, k % 2), id="armax"),
    pytest.param(lambda: RecursiveInstrumental(Structure(1, 1), 5), lambda k: (k % 3, k % 2), id="instrumental"),
]


@pytest.mark.parametrize(("make", "sample"), MAKERS)
@pytest.mark.parametrize("duplicate", [copy.deepcopy, lambda one: pickle.loads(pickle.dumps(one))])
def test_a_copy_goes_on_as_the_original_and_apart_from_it(make, sample, duplicate):
    one = make()
    for k in range(8):
        one.update(*sample(k))
    other = duplicate(one)
    before = one.theta
    errors = [other.update(*sample(k)) for k in range(8, 16)]
    assert np.array_equal(one.theta, before)
    assert [one.update(*sample(k)) for k in range(8, 16)] == errors
    assert np.array_equal(one.theta, other.theta)
    assert np.array_equal(one.state.P, other.state.P)


@pytest.mark.parametrize(("make", "sample"), MAKERS)
def test_theta_and_state_are_copies_and_no_update_keeps_memory(make, sample):
    estimator = make()
    estimator.update(*sample(1))
    before = estimator.state
    estimator.theta[:] = np.nan
    for k in range(100):
        estimator.update(*sample(k))
    assert not np.array_equal(before.P, estimator.state.P)
    tracemalloc.start()
    for k in range(1000):
        estimator.update(*sample(k))
    kept = tracemalloc.get_traced_memory()[0]
    tracemalloc.stop()
    assert kept < 2000
    assert np.isfinite(estimator.theta).all()


def test_the_regressor_may_be_any_vector_of_numbers():
    expected = RecursiveLeastSquares(2)
    expected.update(np.array([3.0, -1.0]), 2.0)
    strided = np.array([[3.0, 0.0], [-1.0, 0.0]])[:, 0]
    for phi in ([3, -1], (3.0, -1.0), np.array([3, -1]), np.array([3, -1], np.float32), strided):
        for y in (2.0, 2, np.float64(2), np.float32(2), np.array(2.0)):
            estimator = RecursiveLeastSquares(2)
            assert estimator.update(phi, y) == 2.0
            assert np.array_equal(estimator.theta, expected.theta)


def test_after_winding_up_for_ever_the_errors_are_not_finite():
    estimator = RecursiveLeastSquares(2, 0.5, diffuse_start(2, trace_bound=np.inf))
    errors = [estimator.update([1.0, 1.0], 1.0) for _ in range(3000)]
    assert not np.isfinite(errors[-1])


# Bad input


@pytest.mark.parametrize(
    ("phi", "y"),
    [
        ([1.0], 1.0),
        ([1.0, 2.0, 3.0], 1.0),
        ([[1.0, 2.0]], 1.0),
        ([[1.0], [2.0]], 1.0),
        (np.ones((2, 2)), 1.0),
        (1.0, 1.0),
        (np.array(1.0), 1.0),
        ([], 1.0),
        (None, 1.0),
        ("12", 1.0),
        (["1", "2"], 1.0),
        ([1.0, None], 1.0),
        ({1.0, 2.0}, 1.0),
        ([1.0, 2j], 1.0),
        (np.array([1.0, 2j]), 1.0),
        ([1.0, [2.0, 3.0]], 1.0),
        ([1.0, 10**400], 1.0),
        ([1.0, np.nan], 1.0),
        (np.array([np.inf, 1.0]), 1.0),
        ([0.0, -np.inf], 1.0),
        ([1.0, 2.0], np.nan),
        ([1.0, 2.0], -np.inf),
        ([1.0, 2.0], None),
        ([1.0, 2.0], 1j),
        ([1.0, 2.0], "one"),
        ([1.0, 2.0], [1.0, 2.0]),
        ([1.0, 2.0], 10**400),
    ],
)
def test_a_bad_sample_is_refused_in_one_line_and_changes_nothing(phi, y):
    estimator, other = RecursiveLeastSquares(2), RecursiveLeastSquares(2)
    for one in (estimator, other):
        one.update([1.0, 0.5], 3.0)
    with pytest.raises(ValueError, match=r"phi must hold 2 finite real numbers, and y be one; got phi = .* Leave") as e:
        estimator.update(phi, y)
    assert "\n" not in str(e.value)
    assert estimator.update([0.0, 1.0], 1.0) == other.update([0.0, 1.0], 1.0)
    assert np.array_equal(estimator.state.P, other.state.P)


@pytest.mark.parametrize("bad", [np.nan, np.inf, None, "volt", 1j, [1.0, 2.0], 10**400])
@pytest.mark.parametrize(
    "make", [lambda: RecursiveArmax(Structure(1, 1, 1)), lambda: RecursiveInstrumental(Structure(1, 1))]
)
def test_a_bad_sample_of_a_signal_is_refused_and_changes_nothing(make, bad):
    estimator, other = make(), make()
    for one in (estimator, other):
        one.update(1.0, 0.5)
    for sample in ((bad, 1.0), (1.0, bad)):
        with pytest.raises(ValueError, match=r"u and y must be finite real numbers; got u = .* estimate a missing one"):
            estimator.update(*sample)
    for sample in ((1.0, 0.5), (0.0, 2.0), (1.0, 1.0)):
        assert estimator.update(*sample) == other.update(*sample)
    assert np.array_equal(estimator.state.P, other.state.P)
    assert np.array_equal(estimator.state.memory, other.state.memory)


@given(arrays(float, 3, elements=st.floats()), st.floats())
@settings(max_examples=100, deadline=None)
def test_a_sample_is_refused_exactly_where_it_is_not_finite(phi, y):
    estimator = RecursiveLeastSquares(3)
    if np.isfinite(phi).all() and np.isfinite(y):
        estimator.update(phi, y)
    else:
        with pytest.raises(ValueError, match="finite"):
            estimator.update(phi, y)
        assert not estimator.theta.any()


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: RecursiveLeastSquares(0), "p must be at least 1"),
        (lambda: RecursiveLeastSquares(2, 1.5), r"forgetting must lie in \(0, 1\]; got 1.5"),
        (lambda: RecursiveLeastSquares(2, start=diffuse_start(3)), "2 parameters and 0 remembered values"),
        (lambda: RecursiveArmax(Structure(1, 1, delay=2)), "delay of 1 here; got 2. Shift"),
        (lambda: RecursiveArmax(Structure(1, 1), np.nan), "forgetting must lie in"),
        (lambda: RecursiveArmax(Structure(1, 1), start=diffuse_start(3)), "2 parameters and 2 remembered"),
        (lambda: RecursiveInstrumental(Structure(1, 1, 1)), "structure must be ARX"),
        (lambda: RecursiveInstrumental(Structure(1, 1, delay=2)), "delay of 1 here; got 2. Shift"),
        (lambda: RecursiveInstrumental(Structure(1, 1), -1), "warm_up zero or more"),
        (lambda: RecursiveInstrumental(Structure(1, 1), start=diffuse_start(3)), "2 parameters and 6 remembered"),
    ],
)
def test_bad_settings_say_what_is_wrong(make, message):
    with pytest.raises(ValueError, match=message):
        make()
