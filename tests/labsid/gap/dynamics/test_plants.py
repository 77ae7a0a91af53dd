"""Every kind of dynamics as columns: against python-control's sampled systems and scipy's integrators."""

from collections.abc import Callable
from itertools import compress

import control
import numpy as np
import pytest
from scipy.signal import lsim

from labsid._arrays import FloatArray
from labsid.gap.dynamics.given_simulation import GivenSimulation
from labsid.gap.dynamics.plants import Plant
from labsid.gap.dynamics.responses import lag_mean, section
from labsid.gap.fits.fast_least_squares import solve_least_squares

Held = Callable[[FloatArray, FloatArray, Callable[[FloatArray, float], list[float]]], FloatArray]

C, K = 0.5, 0.05
KINDS = [
    Plant(),
    Plant(zero=False),
    Plant(zero=False, lag="behind"),
    Plant(lag="behind"),
    Plant(mode="behind"),
    Plant(lag="behind", mode="behind"),
    Plant(kind="tanks"),
    Plant(kind="tanks", roots=("upper", "lower"), brims=("upper",)),
    Plant(kind="tanks", roots=("lower",), brims=("lower",), lag="behind"),
    Plant(kind="mechanics", friction="sharp"),
    Plant(kind="mechanics", cubic=True, mode="behind"),
    Plant(kind="mechanics", cubic=True, mode="beside"),
    Plant(kind="mechanics", friction="sharp", mode="ahead", lag="ahead"),
    Plant(kind="speed", friction="sharp", lag_first=False),
    Plant(kind="varying", drift_degree=3),
    Plant(kind="leak"),
    Plant(kind="tanks", roots=("upper",), load="inside"),
    Plant(kind="given", simulation=GivenSimulation(lambda w, numbers: 2.0 * w)),
]


def theta_of(plant: Plant, **values: float) -> FloatArray:
    """The named parameters of the plant; the others are zero."""
    return np.array([values.pop(parameter.name, 0.0) for parameter in plant.parameters])


def left(columns: FloatArray, y: FloatArray) -> float:
    """Largest distance of y from the span of the columns."""
    return float(np.abs(y - columns @ np.linalg.lstsq(columns, y, rcond=None)[0]).max())


def sampled(num: list[float], den: list[float], w: FloatArray, state: float = 0.0) -> FloatArray:
    """Response of python-control's sampled system, every state beginning at `state`."""
    system = control.c2d(control.ss(control.tf(num, den)), 1.0)
    return np.asarray(control.forced_response(system, np.arange(w.size), w, np.full(system.nstates, state)).outputs)


@pytest.mark.parametrize("state", [0.0, 0.7])
@pytest.mark.parametrize(("c", "k"), [(C, K), (0.2, 0.3)])
def test_linear_columns_span_the_sampled_system(levels: FloatArray, c: float, k: float, state: float) -> None:
    columns = Plant().columns(np.log([c, k]), levels, levels.size, 0.0)
    assert columns.shape == (levels.size, 5)
    assert not columns[:, 4].any()  # it comes to rest
    assert left(columns, sampled([0.3, k], [1.0, c, k], levels, state)) < 1e-9


@pytest.mark.parametrize("state", [0.0, 0.7])
def test_a_further_lag_and_a_further_mode_are_in_the_span(levels: FloatArray, state: float) -> None:
    lag, mode = np.polymul([1.0, C, K], [4.0, 1.0]), [1.0, 0.06, 0.36]
    plant = Plant(lag="behind")
    columns = plant.columns(theta_of(plant, log_c=np.log(C), log_k=np.log(K), log_lag=np.log(4.0)), levels, 600, 0.0)
    assert left(columns, sampled([K], list(lag), levels, state)) < 1e-9
    plant = Plant(mode="behind")
    numbers = {"log_frequency": np.log(0.6), "log_damping": np.log(0.05)}
    columns = plant.columns(theta_of(plant, log_c=np.log(C), log_k=np.log(K), **numbers), levels, 600, 0.0)
    assert left(columns, sampled([K], list(np.polymul([1.0, C, K], mode)), levels, state)) < 1e-9


def test_linear_columns_are_relative_to_the_first_input_by_default(levels: FloatArray) -> None:
    theta = np.log([C, K])
    own = Plant().columns(theta, levels, levels.size)
    np.testing.assert_array_equal(own, Plant().columns(theta, levels, levels.size, float(levels[0])))
    assert np.all(own[:8, :2] == 0.0)


@pytest.mark.parametrize("roots", [(True, True), (True, False), (False, True)])
@pytest.mark.parametrize("flipped", [False, True])
def test_tanks_start_at_the_equilibrium_of_their_first_flow(
    levels: FloatArray, held: Held, roots: tuple[bool, bool], flipped: bool
) -> None:
    plant = Plant(kind="tanks", roots=tuple(compress(("upper", "lower"), roots)), flipped=flipped)
    w, side = levels[:160], -1.0 if flipped else 1.0
    flow = side * w + 2.5
    start = np.array([flow[0] ** 2 if root else flow[0] for root in roots])

    def filling(h: FloatArray, value: float) -> list[float]:
        out = [np.sqrt(level) if root else level for level, root in zip(h, roots, strict=True)]
        return [0.3 * (value - out[0]), 0.2 * (out[0] - out[1])]

    theta = theta_of(plant, log_a=np.log(0.3), log_b=np.log(0.2), zero=-2.5, h1=0.2, h2=-0.1)
    level = plant.columns(theta, w, w.size)[:, 0]
    np.testing.assert_allclose(level, held(flow, start + np.array([0.2, -0.1]), filling)[:, 1], atol=4e-3)
    still = plant.columns(theta_of(plant, log_a=-1.2, log_b=-1.6, zero=-2.5), np.full(50, 0.4), 50)[:, 0]
    np.testing.assert_allclose(still, still[0])


def test_the_brim_of_the_lower_tank_is_the_highest_level(levels: FloatArray) -> None:
    plant = Plant(kind="tanks", brims=("lower",))
    free = theta_of(plant, log_a=np.log(0.3), log_b=np.log(0.2), brim=400.0)
    cut = theta_of(plant, log_a=np.log(0.3), log_b=np.log(0.2), brim=0.5)
    full = plant.columns(free, levels, levels.size)[:, 0]
    level = plant.columns(cut, levels, levels.size)[:, 0]
    first = int(np.argmax(full > 0.5))
    assert first > 20
    np.testing.assert_array_equal(level[:first], full[:first])
    assert level.max() == 0.5


def test_overflow_of_the_upper_tank_is_lost_or_enters_the_lower_one(levels: FloatArray) -> None:
    """Caught in full, the lower tank gets the whole flow; its level lies between."""
    plant = Plant(kind="tanks", brims=("upper",))
    heights = []
    for share in (0.0, 0.5, 1.0):
        theta = theta_of(plant, log_a=np.log(0.3), log_b=np.log(0.2), brim=0.5, share=share)
        heights.append(plant.columns(theta, levels, levels.size)[:, 0])
    assert np.all(heights[0] <= heights[1] + 1e-12)
    assert np.all(heights[1] <= heights[2] + 1e-12)
    assert heights[2].max() > heights[0].max() + 0.1
    np.testing.assert_allclose(heights[1], 0.5 * (heights[0] + heights[2]), atol=1e-12)  # the lower one is linear
    still = plant.columns(theta_of(plant, log_a=-1.2, log_b=-1.6, brim=0.5, share=0.6), np.repeat([0.2, 1.0], 200), 400)
    assert still[-1, 0] == pytest.approx(0.5 + 0.6 * 0.5, abs=1e-6)


@pytest.mark.parametrize("cubic", [0.4, -0.05])
def test_a_cubic_spring_in_units_of_its_linear_deflection(levels: FloatArray, held: Held, cubic: float) -> None:
    """x = k z: x'' / k + (c / k) x' + x + cubic x^3 = w, and it begins at rest under the first input."""
    plant = Plant(kind="mechanics", cubic=True)
    w = levels[:160]
    theta = theta_of(plant, log_c=np.log(0.3), log_k=np.log(0.2), cubic=cubic)
    roots = np.roots([cubic, 0.0, 1.0, -w[0]])
    rest = roots[np.abs(roots.imag) < 1e-9].real
    start = rest[np.argmin(np.abs(rest - w[0]))]

    def spring(x: FloatArray, value: float) -> list[float]:
        return [x[1], 0.2 * (value - x[0] - cubic * x[0] ** 3) - 0.3 * x[1]]

    expected = held(w, np.array([start, 0.0]), spring)[:, 0]
    np.testing.assert_allclose(plant.columns(theta, w, w.size)[:, 0], expected, atol=0.02)
    np.testing.assert_allclose(expected[:8], start, atol=1e-6)


def test_a_mass_sticks_within_the_friction_band() -> None:
    plant = Plant(kind="mechanics", friction="sharp")
    theta = theta_of(plant, log_c=np.log(0.3), log_k=np.log(0.2), friction=0.4)
    w = np.concatenate([np.zeros(20), np.full(40, 0.35), np.full(120, 1.4), np.full(60, 1.1)])
    x = plant.columns(theta, w, w.size, 0.0)[:, 0]
    assert np.all(x[:61] == 0.0)
    assert 1.0 <= x[179] <= 1.4 + 0.4  # where it comes to rest: within the band about the new balance
    assert np.all(x[200:] == x[179])
    speed = plant.motion(theta, w)[:, 1]
    assert np.all(speed[:61] == 0.0)
    assert speed[65] > 0.0


@pytest.mark.parametrize("lag_first", [True, False])
def test_speed_settles_at_the_drive_less_the_friction(lag_first: bool) -> None:
    plant = Plant(kind="speed", friction="sharp", lag_first=lag_first)
    theta = theta_of(plant, log_a=np.log(0.3), log_b=np.log(0.5), friction=0.2, centre=0.1)
    w = np.repeat([0.1, 1.1, -0.9, 0.2], 80)
    v = plant.columns(theta, w, w.size)[:, 0]
    np.testing.assert_allclose(v[[79, 159, 239, 319]], [0.0, 0.8, -0.8, 0.0], atol=1e-3)


def test_a_lag_behind_a_nonlinear_state_takes_its_place(levels: FloatArray) -> None:
    bare, lagged = Plant(kind="tanks"), Plant(kind="tanks", lag="behind")
    numbers = {"log_a": np.log(0.3), "log_b": np.log(0.2)}
    columns = lagged.columns(theta_of(lagged, log_lag=np.log(4.0), **numbers), levels, levels.size)
    start = bare.columns(theta_of(bare, **numbers), levels[:1], 1)[0, 0]
    chain = np.array([[-0.3, 0.0, 0.0], [0.2, -0.2, 0.0], [0.0, 0.25, -0.25]])
    system = (chain, np.array([[0.3], [0.0], [0.0]]), np.array([[0.0, 0.0, 1.0]]), np.zeros((1, 1)))
    _, expected, _ = lsim(system, levels, np.arange(levels.size), X0=[levels[0], start, 0.0], interp=False)
    np.testing.assert_allclose(columns[:, 0], expected, atol=5e-3)
    np.testing.assert_allclose(columns[:, 1], np.exp(-0.25 * np.arange(levels.size)), atol=1e-12)


def fine_response(system: tuple[list[float], list[float]], levels: FloatArray) -> FloatArray:
    """The mean over each sample of what a system from rest makes of the held levels, by a hundred steps a sample."""
    fine = np.repeat(levels - levels[0], 100)
    _, response, _ = lsim(system, np.append(fine, fine[-1]), np.arange(fine.size + 1) / 100.0, interp=False)
    return levels[0] + 0.5 * (response[:-1] + response[1:]).reshape(-1, 100).mean(axis=1)


def test_a_lag_ahead_of_a_nonlinear_state_drives_it_with_its_mean(levels: FloatArray) -> None:
    bare, lagged = Plant(kind="tanks"), Plant(kind="tanks", lag="ahead")
    numbers = {"log_a": np.log(0.3), "log_b": np.log(0.2)}
    driven = fine_response(([1.0], [4.0, 1.0]), levels)
    expected = bare.columns(theta_of(bare, **numbers), driven, levels.size)
    columns = lagged.columns(theta_of(lagged, log_lag=np.log(4.0), **numbers), levels, levels.size)
    np.testing.assert_allclose(columns, expected, atol=2e-4)
    assert lagged.state_columns == ()


def test_a_mode_ahead_of_a_nonlinear_state_drives_it_with_its_mean(levels: FloatArray) -> None:
    bare, swinging = Plant(kind="tanks"), Plant(kind="tanks", mode="ahead")
    numbers = {"log_a": np.log(0.3), "log_b": np.log(0.2)}
    driven = fine_response(([0.09], [1.0, 2 * 0.1 * 0.3, 0.09]), levels)
    expected = bare.columns(theta_of(bare, **numbers), driven, levels.size)
    mode = {"log_frequency": np.log(0.3), "log_damping": np.log(0.1)}
    columns = swinging.columns(theta_of(swinging, **mode, **numbers), levels, levels.size)
    np.testing.assert_allclose(columns, expected, atol=0.01)


def test_a_mode_beside_a_nonlinear_state_answers_the_input(levels: FloatArray) -> None:
    plant = Plant(kind="tanks", mode="beside")
    mode = {"log_frequency": np.log(0.3), "log_damping": np.log(0.1)}
    columns = plant.columns(theta_of(plant, log_a=np.log(0.3), log_b=np.log(0.2), **mode), levels, levels.size)
    np.testing.assert_allclose(columns[:, 1:], section(2 * 0.1 * 0.3, 0.09, levels - levels[0]), atol=1e-12)
    assert plant.state_columns == (3, 4)


def test_a_given_simulation_is_one_column(levels: FloatArray) -> None:
    plant = Plant(kind="given", simulation=GivenSimulation(lambda w, numbers: 2.0 * w, (0.7, 0.1)))
    assert plant.parameters == ()
    np.testing.assert_array_equal(plant.columns(np.zeros(0), levels, levels.size), 2.0 * levels[:, None])
    assert plant.linear_rates(np.zeros(0)) == (0.7, 0.1)
    assert [start.size for start in plant.starts(0.5, 0.05)] == [0]


def test_a_given_simulation_that_can_be_run_has_responses_to_its_initial_state(levels: FloatArray) -> None:
    given = GivenSimulation(
        lambda w, numbers: numbers["tau"] * w + numbers["bias"],
        (0.7, 0.1),
        takes_input=True,
        nominal={"tau": 2.0, "bias": 0.0},
    )
    plant = Plant(kind="given", simulation=given, lag="behind")
    theta = np.array([plant.free[0].theta(0.5), plant.free[1].theta(0.25), np.log(3.0)])
    columns = plant.columns(theta, levels, levels.size)
    np.testing.assert_allclose(columns[:, 0], 0.5 * lag_mean(levels, 3.0) + 0.25)  # the lag acts on its input
    np.testing.assert_allclose(columns[:, 1:3], section(0.7, 0.1, np.zeros(levels.size))[:, 2:])
    np.testing.assert_allclose(columns[:, 3], np.exp(-np.arange(levels.size) / 3.0))
    assert plant.state_columns == (1, 2, 3)
    assert plant.has_fixed_gain
    tau, bias = plant.free
    assert (tau.number(0.0), bias.number(0.0)) == (2.0, 0.0)
    assert tau.number(0.5) == pytest.approx(2.0 * np.exp(0.5), rel=1e-6)  # the logarithm, far from zero
    assert bias.number(1e-3) == pytest.approx(1e-3)
    assert tau.number(tau.lower) == pytest.approx(-2e6)  # either sign
    assert tau.number(tau.theta(-0.3)) == pytest.approx(-0.3)
    slope = (tau.number(0.5 + 1e-6) - tau.number(0.5 - 1e-6)) / 2e-6
    assert tau.scale(0.5) == pytest.approx(slope)
    assert [one.given_name for one in plant.free] == ["tau", "bias"]


@pytest.mark.parametrize("plant", [plant for plant in KINDS if plant.kind in ("linear", "varying", "leak")])
def test_state_columns_are_those_that_move_without_an_input(plant: Plant) -> None:
    numbers = {
        "log_c": np.log(C),
        "log_k": np.log(K),
        "log_lag": 1.0,
        "log_frequency": -0.5,
        "log_damping": -2.0,
        "onset": 1.0,
    }
    named = {name: value for name, value in numbers.items() if name in [p.name for p in plant.parameters]}
    columns = plant.columns(theta_of(plant, **named), np.full(300, 0.4), 300)
    # A slow course also gives answers to a constant; only an initial state dies out.
    moves = np.abs(columns).max(axis=0) > 0.0
    dies = np.abs(columns[-1]) < 1e-3 * np.abs(columns).max(axis=0)
    assert tuple(np.flatnonzero(moves & dies)) == plant.state_columns


LEAKS = {
    "of the lower tank": (lambda x, u, leak: [0.3 * (u - x[0]), 0.2 * (x[0] - x[1] - leak * (x[1] + 2.0))], 0.4, 1.0),
    "of the upper tank": (lambda x, u, leak: [0.3 * (u - x[0] - leak * (x[0] + 2.0)), 0.2 * (x[0] - x[1])], 0.6, 0.0),
    "on a spring": (lambda x, u, leak: [x[1], 0.06 * (u - x[0] - leak * (x[0] + 2.0)) - 0.5 * x[1]], 0.0, 0.0),
}


@pytest.mark.parametrize("place", LEAKS)
@pytest.mark.parametrize("leak", [0.6, -0.3])
def test_a_leak_found_on_one_record_is_that_of_another_one(
    levels: FloatArray, held: Held, place: str, leak: float
) -> None:
    """It begins in another state there: the gains of the rig carry over, against scipy's integrator."""
    flow, share_c, turn = LEAKS[place]
    onset, other = 200, 0.8 - levels[::-1][:400]
    found, fresh = (
        np.concatenate(
            [
                before := held(w[: onset + 1], np.zeros(2), lambda x, u: flow(x, u, 0.0)),
                held(w[onset:], before[-1], lambda x, u: flow(x, u, leak))[1:],
            ]
        )[:, 0 if place == "on a spring" else 1]
        for w in (levels[:400], other)
    )
    plant = Plant(kind="leak")
    rates = {"log_c": np.log(0.5), "log_k": np.log(0.06), "onset": 0.5, "drift": np.log1p(leak)}
    theta = theta_of(plant, **rates, share_c=share_c, turn=turn)
    columns = plant.columns(theta, levels[:400], 400, 0.0)
    gains = solve_least_squares(columns, found)
    np.testing.assert_allclose(columns @ gains, found, atol=1e-6)
    np.testing.assert_allclose(plant.columns(theta, other, 400, 0.0) @ gains, fresh, atol=1e-6)


def test_state_columns_behind_a_nonlinear_state() -> None:
    assert Plant(kind="tanks").state_columns == ()
    assert Plant(kind="tanks", lag="behind").state_columns == (1,)
    assert Plant(kind="mechanics", cubic=True, mode="behind").state_columns == (3, 4)
    for plant in KINDS:
        numbers = np.clip(np.zeros(len(plant.parameters)), [p.lower for p in plant.parameters], None)
        width = plant.columns(numbers, np.linspace(0.0, 1.0, 40), 40).shape[1]
        assert all(0 <= column < width for column in plant.state_columns)


def test_a_load_goes_through_the_poles() -> None:
    step = np.ones(200)
    through = Plant().load_response(np.log([C, K]), step)
    assert left(through, sampled([K], [1.0, C, K], step)) < 1e-9
    np.testing.assert_array_equal(through[1:, 1], through[:-1, 0])


@pytest.mark.parametrize("plant", KINDS[4:6])
def test_linear_rates_of_tanks_are_those_of_small_motions(plant: Plant) -> None:
    theta = theta_of(plant, log_a=np.log(1.2), log_b=np.log(0.9), zero=-3.0, brim=400.0)
    c, k = plant.linear_rates(theta)
    small = 1e-3 * np.repeat(np.random.default_rng(1).uniform(-1.0, 1.0, 40), 8)
    small[:8] = 0.0
    level = plant.columns(theta, small, small.size)[:, 0]
    columns = np.hstack([Plant().columns(np.log([c, k]), small, small.size), np.ones((small.size, 1))])
    assert left(columns, level) < 0.02 * level.std()


@pytest.mark.parametrize("plant", KINDS[:-1])
def test_starts_carry_the_rates_of_a_linear_fit(plant: Plant) -> None:
    starts = plant.starts(C, K)
    assert all(start.size == len(plant.parameters) for start in starts)
    for start in starts:
        if plant.kind in ("tanks", "speed"):
            assert np.exp(start[:2]).sum() == pytest.approx(C)
            assert np.exp(start[:2]).prod() == pytest.approx(K)
        else:
            np.testing.assert_allclose(np.exp(start[:2]), [C, K])


@pytest.mark.parametrize("plant", KINDS)
def test_parameters_are_named_once_and_bounded(plant: Plant) -> None:
    names = [parameter.name for parameter in plant.parameters]
    assert len(set(names)) == len(names)
    assert all(parameter.lower < parameter.upper for parameter in plant.parameters)
    assert all(parameter.step > 0.0 and parameter.leap >= 0.0 for parameter in plant.parameters)
    assert all(plant.index(name) == place for place, name in enumerate(names))


def test_changing_a_plant_updates_its_parameters() -> None:
    plant = Plant(lag="behind").modified(mode="behind")
    assert plant == Plant(lag="behind", mode="behind")
    assert plant.parameters == Plant(lag="behind", mode="behind").parameters
    assert "log_damping" in [parameter.name for parameter in plant.parameters]


def test_without_a_zero_the_exact_answer_to_held_levels_is_one_column(levels: FloatArray) -> None:
    plant = Plant(zero=False)
    columns = plant.columns(theta_of(plant, log_c=np.log(C), log_k=np.log(K)), levels, levels.size)
    sampled = control.sample_system(control.tf([K], [1.0, C, K]), 1.0, "zoh")
    expected = control.forced_response(sampled, inputs=levels - levels[0]).outputs
    np.testing.assert_allclose(columns[:, 0], expected, atol=1e-9)
    assert columns.shape[1] == 4
    assert plant.state_columns == (1, 2)


@pytest.mark.parametrize(("c", "k", "den"), [(0.3, 1e-9, [1.0, 0.3, 0.0]), (1e-5, 1e-9, [1.0, 0.0, 0.0])])
def test_an_offset_of_the_input_of_an_integrator_is_in_the_span(
    levels: FloatArray, c: float, k: float, den: list[float]
) -> None:
    columns = np.column_stack([Plant().columns(np.log([c, k]), levels, levels.size, 0.0), np.ones(levels.size)])
    expected = sampled([1.0], den, levels + 0.7)

    def missed(columns: FloatArray) -> float:  # by the fits' own normal equations
        return float(np.abs(expected - columns @ solve_least_squares(columns, expected)).max())

    assert missed(columns) < 1e-3 * np.std(expected)
    assert missed(np.delete(columns, 4, axis=1)) > 3.0 * missed(columns)


@pytest.mark.parametrize("tau", [0.3, 1.1, 4.6, 40.0])
def test_a_lag_behind_a_mass_follows_its_position_between_the_samples(tau: float) -> None:
    """The position is curved within a sample."""
    w = np.repeat(np.random.default_rng(1).normal(size=20), 6)
    plant = Plant(kind="mechanics", cubic=True, lag="behind")
    numbers = {"log_c": np.log(0.3), "log_k": np.log(0.2), "log_lag": np.log(tau)}
    found = plant.columns(theta_of(plant, **numbers), w, w.size * 100)[:, 0]
    chain = np.array([[0.0, 1.0, 0.0], [-0.2, -0.3, 0.0], [1.0 / tau, 0.0, -1.0 / tau]])
    system = (chain, np.array([[0.0], [0.2], [0.0]]), np.array([[0.0, 0.0, 1.0]]), np.zeros((1, 1)))
    _, expected, _ = lsim(system, w, np.arange(w.size), X0=[w[0], 0.0, 0.0], interp=False)
    np.testing.assert_allclose(found, expected, atol=5e-4)


def test_a_mass_on_a_weak_spring_starts_at_its_own_position() -> None:
    """The equilibrium of such a weak spring at another input is out of reach."""
    plant = Plant(kind="mechanics", friction="sharp")
    theta = theta_of(plant, log_c=np.log(0.3), log_k=np.log(1e-9), friction=0.1, z0=0.2)
    w = np.full(50, 0.5)
    same, other = (plant.columns(theta, w, w.size, reference)[:, 0] for reference in (0.5, 0.45))
    assert same[0] == other[0] == pytest.approx(0.2)


@pytest.mark.parametrize("roots", [("upper",), ("lower",), ("upper", "lower")])
def test_a_flatter_outflow_keeps_the_linearized_dynamics(roots: tuple[str, ...], levels: FloatArray) -> None:
    plant = Plant(kind="tanks", roots=roots)
    theta = theta_of(plant, log_a=-0.5, log_b=1.0, zero=-9.0, h1=3.0, h2=-2.0)
    step = theta_of(plant, zero=1e-6)
    np.testing.assert_allclose((plant.stepped(theta, step) - theta) * 1e6, plant.flatter(theta), rtol=1e-5)
    half = plant.stepped(theta, theta_of(plant, zero=0.5))
    assert half[plant.index("zero")] == pytest.approx(-18.0)  # half of the curvature
    np.testing.assert_allclose(plant.linear_rates(half), plant.linear_rates(theta))
    outputs = [plant.columns(at, levels, levels.size)[:, 0] for at in (theta, half)]
    affine = np.column_stack([outputs[1], np.ones(levels.size)])
    assert left(affine, outputs[0]) < 0.02 * np.ptp(outputs[0])
    near_zero = theta_of(plant, zero=-0.1)
    np.testing.assert_array_equal(plant.stepped(near_zero, step), near_zero + step)
    np.testing.assert_array_equal(plant.flatter(near_zero), theta_of(plant, zero=1.0))
