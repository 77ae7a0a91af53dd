"""The beam search: order of effects, replacement, pruning, integrators, quantization."""

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from gap_search import searched
from scipy.integrate import solve_ivp
from scipy.signal import lfilter

from labsid._arrays import FloatArray
from labsid.gap.effects import disturbance, dynamics, input, output
from labsid.gap.effects.base import Fitted
from labsid.gap.fits.fitting import Fit, finish, minimize, rms
from labsid.gap.fits.hypothesis import Hypothesis
from labsid.gap.fits.linear_fits import fit_baseline, fit_highpass
from labsid.gap.record.data import Data, scaled
from labsid.gap.search.beam_search import (
    Level,
    best_path,
    keep_best,
    nested_path,
    plausible_forms,
    residual_is_white,
    select_parents,
    whiter_baseline,
    with_constant_load,
    within_rounding,
)
from labsid.gap.search.candidates import is_compatible
from labsid.gap.search.explanation import Explanation, explain
from labsid.gap.search.refinement import polish

LOAD = disturbance.LoadStep()
LEAK = disturbance.Leak("leak")

Response = Callable[..., FloatArray]
RATE = 0.15  # of the input, a sample


def data_of(u: FloatArray, y: FloatArray, noise: float = 0.01, seed: int = 4) -> Data:
    y = y + noise * np.std(y) * np.random.default_rng(seed).standard_normal(y.size)
    return scaled(u, y, np.ones(u.size, bool), 1.0)


def curve(w: FloatArray) -> FloatArray:
    return w + 0.2 * w**2 - 0.1 * w**3


def slewing(w: FloatArray) -> FloatArray:
    """Rate-limited levels: the mean over each sample."""
    now, out = w[0], np.empty_like(w)
    for i, goal in enumerate(w):
        step = np.clip(goal - now, -RATE, RATE)
        reached = abs(goal - now) / RATE  # of the sample
        out[i] = now + 0.5 * step if reached >= 1.0 else goal - 0.5 * reached * step
        now += step
    return out


@pytest.mark.parametrize("first", ["curve", pytest.param("rate", marks=pytest.mark.exhaustive)])
@searched(
    "input-rate-limit",
    "input-nonlinearity",
    "input-saturation",
    "input-backlash",
    "input-dead-zone",
    "output-nonlinearity",
    "extra-lag",
    "resonance",
)
def test_a_pair_of_actuator_effects_is_found_in_either_order(
    levels: FloatArray, two_poles: Response, first: str
) -> None:
    u = levels[:320]
    w = slewing(curve(u)) if first == "curve" else curve(slewing(u))
    found = explain(data_of(u, two_poles(w)), most=2)
    assert set(found.names) == {"input-rate-limit", "input-nonlinearity"}
    assert rms(found.data, found.best) < 0.012


def test_the_input_curve_is_last_in_the_actuator_by_default() -> None:
    assert [e.name for e in Hypothesis((input.Nonlinearity(), input.RateLimit())).inputs] == [
        "input-rate-limit",
        "input-nonlinearity",
    ]
    assert [e.name for e in Hypothesis((input.RateLimit(), input.Nonlinearity("first"))).inputs] == [
        "input-nonlinearity",
        "input-rate-limit",
    ]
    behind = Hypothesis((input.RateLimit("behind"), input.DeadZone()))
    assert [e.name for e in behind.inputs] == ["input-dead-zone", "input-rate-limit"]


def test_a_level_keeps_the_better_of_two_fits_of_the_same_names(banded: Explanation) -> None:
    fit = banded.best
    level = {("input-dead-zone",): fit}
    keep_best(level, [None, replace(fit, bic=fit.bic + 1.0)])
    assert level == {("input-dead-zone",): fit}
    better = replace(fit, bic=fit.bic - 1.0)
    keep_best(level, [better])
    assert level == {("input-dead-zone",): better}


def test_every_step_of_a_path_has_the_effects_of_the_step_before(banded: Explanation) -> None:
    """Also where the search has exchanged the first effect for another one."""
    base, *_ = banded.path
    one, other, third = sorted(banded.levels[1].values(), key=lambda fit: fit.bic)[:3]
    pair = replace(other, hypothesis=other.hypothesis.plus(third.hypothesis.found[0]))
    levels = (banded.levels[0], banded.levels[1], {tuple(sorted(pair.hypothesis.names)): pair})
    assert nested_path(levels, (base, one, pair)) == (base, other, pair)
    assert nested_path(levels, (base, third, pair)) == (base, third, pair)
    assert nested_path(levels, (base,)) == (base,)


def test_the_best_path_ends_where_no_effect_is_a_significant_improvement(banded: Explanation) -> None:
    assert best_path(banded.data, banded.levels)[:2] == banded.path[:2]
    (base,) = banded.levels[0].values()
    assert best_path(banded.data, (banded.levels[0], {("nothing",): replace(base, bic=base.bic - 1.0)})) == (base,)


def bent_gain(samples: int) -> FloatArray:
    """A gain that rises until the middle of the record and falls back."""
    return 1.0 + 0.5 * (1.0 - np.linspace(-1.0, 1.0, samples) ** 2)


@searched("input-nonlinearity", "slow-mode", "parameter-drift", "output-drift", "output-nonlinearity", "load-step")
def test_a_gain_that_rises_and_falls_is_a_parameter_drift(levels: FloatArray, two_poles: Response) -> None:
    found = explain(data_of(levels, two_poles(levels * bent_gain(levels.size))))
    assert found.names == ("parameter-drift",)
    assert found.best.hypothesis.keys == ("parameter-drift/gain-4",)


@pytest.mark.parametrize(
    "poles",
    [
        pytest.param([1.0, 0.7], id="integrator", marks=pytest.mark.exhaustive),
        pytest.param([1.0, 1.0], id="double integrator"),
    ],
)
@searched("input-nonlinearity", "parameter-drift", "output-drift", "load-step", "periodic-disturbance")
def test_an_integrating_rig_with_an_offset_has_no_effect(levels: FloatArray, poles: list[float]) -> None:
    """An input offset gives a ramp after one integrator and a parabola after two; neither is a load."""
    swing = np.repeat(np.random.default_rng(5).choice([-1.0, 1.0], 150), 4) + 0.05
    if poles == [1.0, 1.0]:  # held in place by its own feedback
        swing = _steered(swing)
    y = lfilter([0.0, 0.05], np.poly(poles), swing)
    assert explain(data_of(swing, y)).names == ()


def _steered(goal: FloatArray) -> FloatArray:
    """The input by which a lead controller makes a double integrator of gain 0.05 follow a reference."""
    place, speed, command = 0.0, 0.0, np.empty(goal.size)
    for i, wanted in enumerate(goal):
        command[i] = 0.5 * (wanted - place) - 2.5 * speed
        place, speed = place + speed, speed + 0.05 * command[i]
    return command


def noisy(fit: Fit, data: Data, bic: float, error: float) -> Fit:
    """The fit with another BIC and a given free-run error."""
    wave = np.sqrt(2.0) * error * np.sin(0.05 * np.arange(data.samples))
    return replace(fit, bic=bic, output=data.y - wave)


@pytest.mark.parametrize("slow", [True, False])
def test_parents_are_the_fits_of_lowest_bic_and_for_slow_residuals_of_lowest_free_run_error(
    plain: Explanation, slow: bool
) -> None:
    errors = [0.5, 0.6, 0.4, 0.3, 0.45, 0.2, 0.9]
    level: Level = {(str(i),): noisy(plain.best, plain.data, float(i), error) for i, error in enumerate(errors)}
    innovations = 0.1 * errors[0] ** 2 if slow else 0.5 * errors[0] ** 2
    level = {names: replace(fit, noise=replace(fit.noise, sigma2=innovations)) for names, fit in level.items()}
    found = [fit.bic for fit in select_parents(plain.data, level)]
    assert found == ([0.0, 1.0, 2.0, 5.0, 3.0] if slow else [0.0, 1.0, 2.0])


@pytest.mark.parametrize(("pole", "size", "seed"), [(0.99, 0.03, 1), (0.95, 0.1, 1)])
def test_the_highpass_fit_corrects_a_baseline_biased_by_coloured_noise(
    levels: FloatArray, two_poles: Response, pole: float, size: float, seed: int
) -> None:
    noise = lfilter([1.0], [1.0, -pole], size * np.random.default_rng(seed).standard_normal(levels.size))
    data = data_of(levels, two_poles(levels) + noise, noise=0.0)
    base = polish(data, fit_baseline(data))
    found = whiter_baseline(data, base, fit_highpass(data, base))
    assert found.bic < base.bic - 20.0
    assert rms(data, found) < 1.2 * rms(data, base)
    off = [float(np.abs(np.log(np.divide(fit.rates, (0.5, 0.05)))).max()) for fit in (found, base)]
    assert off[0] < 0.2
    assert off[1] > 2.0


def test_the_baseline_is_kept_if_the_highpass_fit_is_no_better(plain: Explanation) -> None:
    data, base = plain.data, plain.best
    assert whiter_baseline(data, replace(base, bic=base.bic - 5.0), base).bic == base.bic - 5.0
    other = Hypothesis((dynamics.ExtraLag(),), n_given=1)
    third = fit_baseline(data, other)
    assert whiter_baseline(data, third, base) is third  # the highpass fit is of another structure


def coarse(y: FloatArray, steps: int) -> FloatArray:
    """Quantized to the given number of steps over the range."""
    step = np.ptp(y) / steps
    return np.round(y / step) * step


def test_quantization_residuals_are_distinguished_from_model_errors(plain: Explanation) -> None:
    data, fit, step = plain.data, plain.best, 0.2
    lattice = replace(data, y=np.round(fit.output / step) * step, lattice=step)
    assert within_rounding(lattice, fit)
    assert residual_is_white(lattice, fit)
    assert not within_rounding(replace(lattice, lattice=0.0), fit)
    wave = 2.0 * step * np.sin(0.3 * np.arange(data.samples))
    assert not within_rounding(replace(lattice, y=np.round((fit.output + wave) / step) * step), fit)
    # Refits move a fit that is nearly right within the steps; one that is far off is rejected without a refit.
    assert within_rounding(lattice, replace(fit, output=fit.output + 0.15 * step))
    assert not within_rounding(lattice, replace(fit, output=fit.output + 0.5 * step))


@pytest.mark.parametrize(("shape", "steps"), [pytest.param("square", 8, marks=pytest.mark.exhaustive), ("levels", 32)])
@searched(
    "input-delay", "input-nonlinearity", "extra-lag", "resonance", "slow-mode", "output-nonlinearity", "output-backlash"
)
def test_rounding_is_explained_by_quantization_alone(
    levels: FloatArray, two_poles: Response, steps: int, shape: str
) -> None:
    """Without noise the quantization error depends on the input, and any additional mode reduces it."""
    u = levels if shape == "levels" else np.where(np.arange(levels.size) // 40 % 2, -1.0, 1.0)
    y = coarse(two_poles(u), steps)
    found = explain(data_of(u, y, noise=0.0))
    assert found.names == ("output-quantization",)
    assert found.data.lattice * found.data.y_scale.unit == pytest.approx(np.ptp(two_poles(u)) / steps)


@searched(
    "input-saturation",
    "input-nonlinearity",
    "input-dead-zone",
    "output-saturation",
    "output-nonlinearity",
    "output-drift",
    "load-step",
    "periodic-disturbance",
)
def test_effects_larger_than_the_quantization_step_are_found(levels: FloatArray, two_poles: Response) -> None:
    u = levels[:480]
    load = two_poles((np.arange(u.size) >= 290).astype(float))
    y = two_poles(np.minimum(u, 0.7)) - 0.4 * load
    found = explain(data_of(u, coarse(y, 16), noise=0.0), most=2)
    assert set(found.names) == {"input-saturation", "load-step", "output-quantization"}
    assert rms(found.data, found.best) < 0.35 * found.data.lattice  # 0.29 is that of rounding itself


def leaking_tank(u: FloatArray, a: float, b: float, leak: float, onset: int) -> FloatArray:
    """Lower level of two tanks with Torricelli outflow; a leak in the lower one from the onset on."""
    h, out = np.full(2, (u[0] + 3.0) ** 2), []

    def flow(t: float, h: FloatArray, value: float, lost: float) -> list[float]:
        roots = np.sqrt(np.maximum(h, 0.0))
        return [a * (value + 3.0 - roots[0]), a * roots[0] - b * roots[1] - lost * h[1]]

    for k, value in enumerate(u):
        out.append(h[1])
        lost = leak if k >= onset else 0.0
        h = solve_ivp(flow, (0.0, 1.0), h, args=(value, lost), rtol=1e-8, atol=1e-10).y[:, -1]
    return np.array(out)


@searched("input-nonlinearity", "sqrt-outflow", "parameter-drift", "output-drift", "output-nonlinearity", "load-step")
def test_a_leak_in_a_torricelli_tank_is_a_load_proportional_to_the_level(levels: FloatArray) -> None:
    u, a, b, leak = levels[:360], 0.8, 1.0, 0.01
    y = leaking_tank(u, a, b, leak, 220)
    found = explain(data_of(u, y), most=2)
    assert set(found.names) == {"sqrt-outflow", "load-step"}
    assert "load-step/inside" in found.best.hypothesis.keys
    assert rms(found.data, found.best) < 0.0105
    (load,) = (effect for effect in found.best.hypothesis.effects if effect.name == "load-step")
    fitted = Fitted(found.best.hypothesis, found.best.theta, found.best.gains, found.data)
    values = load.values(fitted)
    assert values["onset"].value == pytest.approx(220.0, abs=1.5)
    np.testing.assert_array_equal(load.active_samples(fitted)[[210, 230]], [False, True])
    lost = y[-1] - leaking_tank(u, a, b, 0.0, 220)[-1]
    assert values["size"].value == pytest.approx(lost, rel=0.05)
    assert values["size"].unit == "y"


def test_a_leak_becomes_a_constant_load_before_a_nonlinear_state_is_added(
    levels: FloatArray, two_poles: Response
) -> None:
    """The nonlinear dynamics have no leak."""
    load = two_poles((np.arange(levels.size) >= 330).astype(float))
    data = data_of(levels, two_poles(levels) - 0.4 * load)
    hypothesis = Hypothesis((output.Drift("1"), LEAK, input.DeadZone()), n_given=1)
    numbers = {"log_c": np.log(0.5), "log_k": np.log(0.05), "onset": 330 / 600, "drift": 0.01, "low": -0.1, "high": 0.1}
    theta = np.array([numbers.get(p.name, 0.0) for p in hypothesis.parameters])
    point = minimize(data, hypothesis, theta, iterations=0)
    assert point is not None
    fit = finish(data, hypothesis, point)
    assert not is_compatible(fit, dynamics.CubicStiffness())
    plain = with_constant_load(data, fit)
    assert plain.hypothesis == Hypothesis((output.Drift("1"), LOAD, input.DeadZone()), n_given=1)
    assert is_compatible(plain, dynamics.CubicStiffness())
    assert plain.theta[plain.hypothesis.slices[LOAD.key]][0] == pytest.approx(330 / 600, abs=0.01)
    assert rms(data, plain) < 0.02
    assert with_constant_load(data, plain) is plain


def test_forms_with_an_implausible_effect_are_dropped(banded: Explanation, monkeypatch: pytest.MonkeyPatch) -> None:
    data = banded.data
    hypothesis = Hypothesis((output.Nonlinearity(), input.DeadZone()))
    numbers = {"log_c": np.log(0.5), "log_k": np.log(0.05), "low": -0.4, "high": 0.3}
    theta = np.array([numbers.get(p.name, 0.0) for p in hypothesis.parameters])
    point = minimize(data, hypothesis, theta, iterations=0)
    assert point is not None
    fit = finish(data, hypothesis, point)
    assert [form.hypothesis.effects[0].variant for form in plausible_forms(data, fit)] == ["", "rich", "", ""]
    monkeypatch.setattr(output.Nonlinearity, "is_plausible", lambda effect, fit: effect.variant != "rich")
    forms = plausible_forms(data, fit)
    assert [form.hypothesis.effects[0].variant for form in forms] == ["", "", ""]  # although the last effect is
    monkeypatch.undo()
    monkeypatch.setattr(input.DeadZone, "is_plausible", lambda effect, fit: False)
    assert plausible_forms(data, fit) == [fit]
    known = replace(fit, hypothesis=Hypothesis(hypothesis.effects[::-1], n_given=1))
    assert len(plausible_forms(data, known)) == 2  # the simulation's own effects are not asked


def loaded_spring(u: FloatArray, load: float, onset: int) -> FloatArray:
    """Position of a mass on a hardening spring; a force against it from the onset on."""
    state, out = np.array([-0.8, 0.0]), []

    def flow(t: float, x: FloatArray, force: float) -> list[float]:
        return [x[1], 0.06 * (force - x[0] - 0.4 * x[0] ** 3) - 0.3 * x[1]]

    for k, value in enumerate(u):
        out.append(state[0])
        force = value - (load if k >= onset else 0.0)
        state = solve_ivp(flow, (0.0, 1.0), state, args=(force,), rtol=1e-8, atol=1e-10).y[:, -1]
    return np.array(out)


def loaded_motor(u: FloatArray, load: float, onset: int) -> FloatArray:
    """Speed of a motor with dry friction and a lag ahead, by Euler's method; a torque against it from the onset on."""
    fine, friction = 100, 0.3
    speed, drive, out = 0.0, float(u[0]), []
    for k, value in enumerate(u.tolist()):
        out.append(speed)
        for _ in range(fine):
            drive += 0.8 * (value - drive) / fine
            net = drive - (load if k >= onset else 0.0)
            if speed == 0.0 and abs(net) <= friction:
                continue
            sign = math.copysign(1.0, speed or net)
            new = speed + 0.3 * (net - friction * sign - speed) / fine
            speed = 0.0 if new * sign < 0.0 else new
    return np.array(out)


@pytest.mark.parametrize(
    ("rig", "name"),
    [
        (loaded_spring, "cubic-stiffness"),
        pytest.param(loaded_motor, "coulomb-friction", marks=pytest.mark.exhaustive),
    ],
)
def test_a_large_load_on_a_nonlinear_state_is_found(levels: FloatArray, rig: Response, name: str) -> None:
    """It is found first, as a leak on linear dynamics, and moves to the state with the second effect.

    A small one is found second: the leak in a Torricelli tank, above.
    """
    u, load = levels[:320], 1.2
    y = rig(u, load, 190)
    with searched(name, "parameter-drift", "output-drift", "output-nonlinearity", "load-step"):
        found = explain(data_of(u, y), most=2)
    assert set(found.names) == {name, "load-step"}
    assert "load-step/inside" in found.best.hypothesis.keys
    assert rms(found.data, found.best) < 0.0115
    (step,) = (effect for effect in found.best.hypothesis.effects if effect.name == "load-step")
    values = step.values(Fitted(found.best.hypothesis, found.best.theta, found.best.gains, found.data))
    assert values["onset"].value == pytest.approx(190.0, abs=1.0)
    assert values["size"].value == pytest.approx((y - rig(u, 0.0, 190))[-1], rel=0.1)


@searched(
    "input-saturation",
    "sqrt-outflow",
    "overflow",
    "end-stop",
    "output-saturation",
    "output-nonlinearity",
    "load-step",
    "periodic-disturbance",
)
def test_a_disturbance_of_the_inflow_is_found_beside_an_overflow() -> None:
    """The disturbance acts ahead of the upper tank; the lower tank overflows."""
    u = np.repeat(np.random.default_rng(8).uniform(-1.0, 1.0, 36), 15)
    k, fine, first, level, out = np.arange(u.size), 40, u[0], u[0], []
    flow = u - 0.35 * np.sin(2.0 * np.pi * 9.3 / u.size * k)
    for value in flow.tolist():
        out.append(level)
        for _ in range(fine):
            first, level = first + 0.2 * (value - first) / fine, min(level + 0.06 * (first - level) / fine, 0.25)
    found = explain(data_of(u, np.array(out)), most=2)
    assert set(found.names) == {"overflow", "periodic-disturbance"}
    assert rms(found.data, found.best) < 0.0115


def axis(gain: float, friction: float, pull: float, samples: int) -> tuple[FloatArray, FloatArray]:
    """Force and position of an axis without spring in a position loop, by Euler's method with 50 steps a sample."""
    fine, x, v = 50, 0.0, 0.0
    course = 8.0 * np.sin(2.0 * np.pi * np.arange(samples) / 130.0) ** 3 + 6.0 * np.sin(np.arange(samples) / 41.0)
    force, position = np.empty(samples), np.empty(samples)
    for k, wanted in enumerate(course.tolist()):
        position[k] = x
        force[k] = gain * (wanted - x) - 2.0 * v
        for _ in range(fine):
            net = force[k] - pull
            sign = math.copysign(1.0, v or net)
            new = 0.0 if v == 0.0 and abs(net) <= friction else v + (net - friction * sign - 0.3 * v) / (8.0 * fine)
            v = 0.0 if new * sign < 0.0 else new
            x += v / fine
    return force, position


@searched("input-dead-zone", "coulomb-friction", "quadratic-drag", "output-drift", "load-step")
def test_friction_of_an_axis_without_spring_is_found_beside_a_constant_force() -> None:
    u, y = axis(gain=1.0, friction=1.0, pull=0.6, samples=600)
    found = explain(data_of(u, y), most=1)
    assert found.best.hypothesis.keys == ("coulomb-friction/unsprung",)
    (effect,) = found.best.hypothesis.effects
    values = effect.values(Fitted(found.best.hypothesis, found.best.theta, found.best.gains, found.data))
    assert values["friction"].value == pytest.approx(1.0, rel=0.05)


def tank_with_a_brim(w: FloatArray, rate: float, brim: float) -> FloatArray:
    """Level of an overflowing tank behind a fast lag, by Euler's method with 40 steps a sample."""
    fine, lagged, level, out = 40, w[0], w[0], []
    for flow in w.tolist():
        out.append(level)
        for _ in range(fine):
            lagged, level = lagged + 0.6 * (flow - lagged) / fine, min(level + rate * (lagged - level) / fine, brim)
    return np.array(out)


@searched(
    "input-saturation",
    "sqrt-outflow",
    "overflow",
    "end-stop",
    "parameter-drift",
    "output-drift",
    "output-saturation",
    "output-nonlinearity",
)
@pytest.mark.exhaustive  # above, a disturbance is found beside an overflow, and a drift of the gain alone
def test_a_parameter_drift_is_found_beside_an_overflow() -> None:
    """Drift of the gain of a pump whose zero lies far below the record."""
    u = np.repeat(np.random.default_rng(8).uniform(-1.0, 1.0, 36), 15)
    course = np.sin(np.linspace(0.0, np.pi, u.size))
    found = explain(data_of(u, tank_with_a_brim(u + 0.2 * course * (u + 2.0), 0.06, 0.25)), most=2)
    assert set(found.names) == {"overflow", "parameter-drift"}
    assert any(key.startswith("parameter-drift/gain") for key in found.best.hypothesis.keys)
