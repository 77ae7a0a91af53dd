"""End stop, quadratic drag, slow mode and play of the sensor, against scipy and by hand; named on records of each."""

from collections.abc import Callable

import numpy as np
import pytest
from gap_search import searched
from scipy.integrate import solve_ivp
from scipy.signal import cont2discrete, lfilter

from labsid._arrays import FloatArray
from labsid.gap.diagnosis import diagnose
from labsid.gap.dynamics import _states
from labsid.gap.dynamics.responses import section
from labsid.gap.effects import dynamics, motion, play
from labsid.gap.effects.base import Fitted, Value
from labsid.gap.effects.input import Backlash
from labsid.gap.fits import parameter_estimates
from labsid.gap.fits.fitting import Problem
from labsid.gap.fits.hypothesis import Hypothesis
from labsid.gap.fits.linear_fits import fit_baseline, fit_highpass
from labsid.gap.fits.parameter_estimates import estimate_parameters
from labsid.gap.model_file import from_json_dict
from labsid.gap.record.data import scaled
from labsid.gap.search.candidates import best_fit, trial_fits
from labsid.records.record import Record

pytestmark = pytest.mark.usefixtures("without_limits")

FEW = (
    "input-delay",
    "input-saturation",
    "input-backlash",
    "extra-lag",
    "cubic-stiffness",
    "end-stop",
    "quadratic-drag",
    "slow-mode",
    "output-drift",
    "output-saturation",
    "output-nonlinearity",
    "output-backlash",
)
"""The effects tested here, and those with which they may be confused."""

TS = 0.05
STIFFNESS, DAMPING = 9.0, 1.8


@pytest.fixture(scope="module")
def u() -> FloatArray:
    """Levels from -1 to 1, each held for 8 to 30 samples."""
    rng = np.random.default_rng(4)
    return np.repeat(rng.uniform(-1.0, 1.0, 40), rng.integers(8, 31, 40))[:600]


def states(u: FloatArray, start: list[float], flow: Callable[..., list[float]], steps: int = 1) -> FloatArray:
    """States at the samples, by scipy, of x' = flow(t, x, u) with the input held; `steps` restarts in each sample."""
    found = [np.array(start)]
    for value in u[:-1]:
        x = found[-1]
        for _ in range(steps):
            x = solve_ivp(flow, (0.0, TS / steps), x, args=(value,), rtol=1e-8, atol=1e-10).y[:, -1]
        found.append(x)
    return np.array(found)


def pushed(t: float, x: FloatArray, value: float) -> list[float]:
    """Acceleration of the mass without other effects."""
    return [x[1], STIFFNESS * (value - x[0]) - DAMPING * x[1]]


def stopped(u: FloatArray, low: float, high: float, share: float = 0.0, fine: int = 400) -> FloatArray:
    """The mass between two stops, where it keeps a share of its speed, by Euler's method with 400 steps a sample."""
    x, v, found = 0.0, 0.0, []
    for value in u.tolist():
        found.append(x)
        for _ in range(fine):
            v += (STIFFNESS * (value - x) - DAMPING * v) * TS / fine
            x += v * TS / fine
            if not low <= x <= high:
                x, v = min(max(x, low), high), -share * v
    return np.array(found)


@pytest.fixture(scope="module")
def signals(u: FloatArray) -> dict[str, FloatArray]:
    """Output of a rig with each of the effects."""
    mass = states(u, [0.0, 0.0], pushed)[:, 0]
    b, a, _ = cont2discrete(([1.0], [6.0, 1.0]), TS)
    centre = float(mass[0])
    held = []
    for z in mass:
        centre = min(max(centre, z - 0.15), z + 0.15)
        held.append(centre)

    def dragged(t: float, x: FloatArray, value: float) -> list[float]:
        return [x[1], pushed(t, x, value)[1] - 1.5 * x[1] * abs(x[1])]

    return {
        "end-stop": stopped(u, -0.5, 0.45),
        "end-stop with a rebound": stopped(u, -2.0, 0.45, 0.4),
        "quadratic-drag": states(u, [0.0, 0.0], dragged)[:, 0],
        "slow-mode": mass + 0.4 * lfilter(b.ravel(), a, u),
        "output-backlash": np.array(held),
    }


@pytest.mark.parametrize(
    ("name", "parameters"),
    [
        ("end-stop", {"low": -0.5, "high": 0.45}),
        ("end-stop with a rebound", {"high": 0.45, "rebound": 0.4}),
        ("quadratic-drag", {"drag": 1.5 / STIFFNESS}),
        ("slow-mode", {"tau": 6.0, "share": 0.4 / 1.4}),
        ("output-backlash", {"width": 0.3}),
    ],
)
def test_each_is_named_with_its_parameters_and_its_export_plays(
    u: FloatArray, signals: dict[str, FloatArray], name: str, parameters: dict[str, float]
) -> None:
    y = signals[name]
    record = Record(TS * np.arange(u.size), u, y + 0.004 * np.random.default_rng(1).standard_normal(u.size), TS)
    with searched(*FEW):
        found = diagnose(record)
    (effect,) = found.report["effects"]
    assert (found.report["verdict"], effect["name"]) == ("effect", name.partition(" ")[0])
    assert effect["parameters"].keys() == parameters.keys()
    for parameter, expected in parameters.items():
        assert effect["parameters"][parameter]["value"] == pytest.approx(expected, rel=0.1)
    assert found.report["gap"]["closed"] > 0.9
    played = from_json_dict(found.model.to_json_dict()).simulate(record.u, record.y)
    assert np.std(played - y) < 0.08 * np.std(y)


def test_a_mass_between_stops(u: FloatArray) -> None:
    scale = TS * TS
    found = _states.simulate_mass(
        STIFFNESS * scale * u, DAMPING * TS, STIFFNESS * scale, 0.0, 0.0, 0.0, 0.0, 12, stops=(-0.5, 0.45, 0.0)
    )
    expected = stopped(u, -0.5, 0.45)
    np.testing.assert_allclose(found[:, 0], expected, atol=0.01)
    held = np.isin(found[:, 0], (-0.5, 0.45))
    assert 50 < held.sum() < 500
    np.testing.assert_array_equal(found[held, 1] * np.sign(found[held, 0]) <= 0.0, True)  # it never moves on


@pytest.mark.parametrize("drag", [0.5, 5.0])
def test_a_mass_with_drag(u: FloatArray, drag: float) -> None:
    def flow(t: float, x: FloatArray, value: float) -> list[float]:
        return [x[1], pushed(t, x, value)[1] - drag * x[1] * abs(x[1])]

    scale = TS * TS
    found = _states.simulate_mass(
        STIFFNESS * scale * u, DAMPING * TS, STIFFNESS * scale, 0.0, 0.0, 0.0, 0.0, 8, drag=drag
    )
    np.testing.assert_allclose(found[:, 0], states(u, [0.0, 0.0], flow)[:, 0], atol=2e-3)


@pytest.mark.parametrize("lag_first", [True, False])
@pytest.mark.parametrize("drag", [0.8, 6.0])
def test_a_motor_with_drag(u: FloatArray, drag: float, lag_first: bool) -> None:
    a, b = 3.0, 8.0

    def flow(t: float, x: FloatArray, value: float) -> list[float]:
        v, i = x
        drive = i if lag_first else value
        return [a * (drive - v - drag * v * abs(v)), b * ((value if lag_first else v) - i)]

    found = _states.simulate_motor(u, a * TS, b * TS, 0.0, lag_first, 0.0, 0.0, 3, drag=drag)
    expected = states(u, [0.0, 0.0], flow)[:, 0 if lag_first else 1]
    np.testing.assert_allclose(found[:, 0], expected, atol=4e-3)


def test_the_derivatives_of_a_played_sensor_by_the_gains() -> None:
    """Where the reading rests, it keeps the derivatives of the sample at which it last moved."""
    rng = np.random.default_rng(3)
    w = np.repeat(rng.uniform(-1.0, 1.0, 30), 10)
    data = scaled(w, np.convolve(w, np.ones(9) / 9)[: w.size], np.ones(w.size, bool), 1.0)
    hypothesis = Hypothesis((play.Play(),))
    theta = np.zeros(len(hypothesis.parameters))
    theta[hypothesis.slices["plant"]] = np.log((0.8, 0.2))
    theta[hypothesis.slices["output-backlash"]] = 0.4, 0.3
    problem = Problem(data, hypothesis, np.zeros(0))
    gains = np.array([0.12, 0.07, 0.2, 0.1, 0.0, 0.05])
    design = hypothesis.design(theta, data.u)
    at = problem.point(theta, gains, design)
    assert at is not None
    J = problem.jacobian(at)
    assert J is not None
    for i in range(gains.size):
        step = 1e-6 * np.eye(gains.size)[i]
        ends = [hypothesis.sensor(theta, at.gains + sign * step, design) for sign in (1.0, -1.0)]
        np.testing.assert_allclose(J[:, theta.size + i], (ends[0] - ends[1]) / 2e-6, atol=1e-5)
    moved = np.diff(hypothesis.sensor(theta, at.gains, design)) != 0.0
    assert 0.2 < moved.mean() < 0.95


@pytest.mark.parametrize(
    ("numerator", "parallel"),
    [
        ([1.0], False),  # three lags in series
        ([4.0, 1.0], True),  # a zero near the slowest pole: a share of 0.36
        ([8.5, 1.0], True),  # a share of -0.4: the output creeps back
    ],
)
def test_a_slow_mode_is_told_from_a_lag_by_the_share_of_the_slowest_pole(
    u: FloatArray, numerator: list[float], parallel: bool
) -> None:
    denominator = np.polymul(np.polymul([6.0, 1.0], [0.5, 1.0]), [0.3, 1.0])
    b, a, _ = cont2discrete((numerator, denominator), TS)
    y = lfilter(b.ravel(), a, u) + 0.002 * np.random.default_rng(5).standard_normal(u.size)
    data = scaled(u, y, np.ones(u.size, bool), TS)
    base = fit_baseline(data)
    highpass = fit_highpass(data, base)
    lag = best_fit(data, trial_fits(data, base, (dynamics.ExtraLag(),), highpass))
    slow = best_fit(data, trial_fits(data, base, (dynamics.SlowMode(),), highpass))
    assert (slow is not None) == parallel
    assert lag is None or not parallel or lag.bic > slow.bic + 12.0


def test_the_share_of_a_slow_mode_is_that_of_the_dynamics(u: FloatArray) -> None:
    """Behind a backlash that a step of one does not cross it was infinite, and the report no JSON."""
    data = scaled(u, u, np.ones(u.size, bool), TS)
    shares = []
    for ahead in ((), (Backlash(),)):
        hypothesis = Hypothesis((*ahead, dynamics.SlowMode()))
        given = {"width": 2.5, "position": 0.5, "log_c": 0.0, "log_k": np.log(0.25), "log_slow": np.log(40.0)}
        theta = np.array([given.get(parameter.name, 0.0) for parameter in hypothesis.parameters])
        gains = np.zeros(hypothesis.design(theta, data.u).columns.shape[1])
        gains[[0, hypothesis.plant.slow_column]] = 1.0, 0.5
        values = dynamics.SlowMode().values(Fitted(hypothesis, theta, gains, data))
        shares.append(values["share"].value)
    step = section(1.0, 0.25, np.ones(2000))[-1, 0]  # static gain of the first column
    assert shares == pytest.approx([0.5 / (step + 0.5)] * 2, rel=1e-6)


def test_a_value_that_is_not_finite_is_left_out(u: FloatArray, monkeypatch: pytest.MonkeyPatch) -> None:
    data = scaled(u, u, np.ones(u.size, bool), TS)
    fit = fit_baseline(data)
    values = {"tau": Value(2.0, "s"), "share": Value(np.inf, "1")}
    monkeypatch.setattr(dynamics.SlowMode, "values", lambda self, fit: values)
    size = fit.theta.size + fit.gains.size
    monkeypatch.setattr(parameter_estimates, "covariance", lambda data, fit: np.full((size, size), np.nan))
    found = estimate_parameters(data, fit, dynamics.SlowMode())
    assert found == {"tau": {"value": 2.0, "stderr": 0.0, "unit": "s"}}


def test_a_stop_that_is_never_reached_is_not_named(u: FloatArray) -> None:
    data = scaled(u, u, np.ones(u.size, bool), TS)
    effect = motion.EndStop("low")
    hypothesis = Hypothesis((effect,))
    theta = np.zeros(len(hypothesis.parameters))
    own = theta[hypothesis.slices["plant"]]
    own[:2] = np.log((0.8, 0.2))
    gains = np.array([1.0, 0.0])
    reached = {}
    for stop in (-0.6, -40.0):
        own[hypothesis.plant.index("stop_low")] = stop
        reached[stop] = effect.is_plausible(Fitted(hypothesis, theta, gains, data))
    assert reached == {-0.6: True, -40.0: False}
