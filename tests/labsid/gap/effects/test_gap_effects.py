"""The effects of the table: names, paths, parameters, what each does to a signal, its numbers in record units."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from numpy.polynomial.chebyshev import chebval
from scipy.interpolate import CubicSpline
from scipy.signal import cont2discrete, lfilter

from labsid._arrays import FloatArray
from labsid.gap.dynamics.plants import Plant
from labsid.gap.effects import curves, disturbance, drifts, dynamics, input, output, periodic, tanks
from labsid.gap.effects.base import AdditiveEffect, Effect, Fitted, InputEffect, OutputEffect, PlantEffect
from labsid.gap.effects.context import Context
from labsid.gap.effects.families import CANDIDATES, DESCRIPTIONS, LATE
from labsid.gap.effects.inside import Inside
from labsid.gap.fits.fitting import finish, minimize
from labsid.gap.fits.hypothesis import Hypothesis
from labsid.gap.fits.linear_fits import LINEAR, fit_baseline
from labsid.gap.record.data import Data, Scale, scaled
from labsid.gap.reports.quantities import UNITS

TABLE = {
    "input-delay": "input",
    "input-saturation": "input",
    "input-dead-zone": "input",
    "input-backlash": "input",
    "input-rate-limit": "input",
    "input-nonlinearity": "input",
    "input-off": "input",
    "input-quantization": "input",
    "extra-lag": "dynamics",
    "resonance": "dynamics",
    "sqrt-outflow": "dynamics",
    "overflow": "dynamics",
    "coulomb-friction": "dynamics",
    "cubic-stiffness": "dynamics",
    "end-stop": "dynamics",
    "quadratic-drag": "dynamics",
    "gravity": "dynamics",
    "force-limit": "dynamics",
    "slow-mode": "dynamics",
    "parameter-drift": "dynamics",
    "output-drift": "output",
    "output-saturation": "output",
    "output-nonlinearity": "output",
    "output-backlash": "output",
    "output-quantization": "output",
    "output-outliers": "output",
    "output-dropout": "output",
    "load-step": "disturbance",
    "periodic-disturbance": "disturbance",
    "coloured-noise": "disturbance",
    "coupling": "dynamics",
    "parameter-mismatch": "parameters",
}
PARAMETERS = {
    "input-delay": {"delay"},
    "input-saturation": {"low", "high"},
    "input-dead-zone": {"low", "high"},
    "input-backlash": {"width"},
    "input-rate-limit": {"rate"},
    "input-nonlinearity": {"c2", "c3", "centre"},
    "input-off": {"onset", "end", "level"},
    "input-quantization": {"step"},
    "extra-lag": {"tau"},
    "resonance": {"frequency", "damping"},
    "sqrt-outflow": {"zero", "empty"},
    "overflow": {"level", "caught"},
    "coulomb-friction": {"friction"},
    "cubic-stiffness": {"cubic"},
    "end-stop": {"low", "high"},
    "quadratic-drag": {"drag"},
    "gravity": {"torque", "angle", "per_radian"},
    "force-limit": {"limit"},
    "slow-mode": {"tau", "share"},
    "parameter-drift": {"drift", "pole", "onset"},
    "output-drift": {"amplitude"},
    "output-saturation": {"low", "high"},
    "output-nonlinearity": {"c2", "c3", "centre", "fold"},
    "output-backlash": {"width"},
    "load-step": {"onset", "end", "size"},
    "periodic-disturbance": {"frequency", "amplitude"},
}
ALL = [effect for group in (*CANDIDATES, LATE) for effect in group if not getattr(effect, "only_given", False)]
SAMPLES, TS = 100, 0.2
Response = Callable[..., FloatArray]


def data_of(u: FloatArray, y: FloatArray | None = None) -> Data:
    """Already scaled signals; one unit is 0.5 of the record's input about 2, and 3 of its output about 10."""
    y = np.zeros(u.size) if y is None else y
    return Data(u, y, np.ones(u.size, bool), TS, Scale(2.0, 0.5), Scale(10.0, 3.0), start=4.0)


def fitted(
    effect: Effect, gains: FloatArray | None = None, plant: dict[str, float] | None = None, *own: float
) -> Fitted:
    """A fit of one effect with its own numbers and those of the plant; the rates are those of 0.5 and 0.05."""
    hypothesis = Hypothesis((effect,))
    theta = np.zeros(len(hypothesis.parameters))
    if own:
        theta[hypothesis.slices[effect.key]] = own
    at = hypothesis.slices["plant"].start
    theta[at : at + 2] = np.log([0.5, 0.05])
    for name, value in (plant or {}).items():
        theta[at + hypothesis.plant.index(name)] = value
    u = np.linspace(-1.5, 1.5, SAMPLES)
    return Fitted(hypothesis, theta, np.zeros(20) if gains is None else gains, data_of(u, u))


def values(fit: Fitted) -> dict[str, tuple[float, str]]:
    """What the effect reports of the fit: value and unit by name."""
    return {name: (value.value, value.unit) for name, value in fit.hypothesis.effects[0].values(fit).items()}


def test_names_and_paths_are_those_of_the_table() -> None:
    assert {name: guide.path for name, guide in DESCRIPTIONS.items()} == TABLE
    assert {effect.name for effect in ALL} <= TABLE.keys()
    around = [group[0].name for group in CANDIDATES if not all(isinstance(effect, Inside) for effect in group)]
    assert around == list(dict.fromkeys(effect.name for effect in ALL))
    assert {effect.name for effect in LATE} <= set(around)
    inside = {effect.name for group in CANDIDATES for effect in group if isinstance(effect, Inside)}
    assert inside <= TABLE.keys()


def test_a_key_names_one_effect() -> None:
    """Exports refer to effects by their keys."""
    keys = [effect.key for effect in ALL]
    assert len(set(keys)) == len(keys)
    assert all(key == name or key.startswith(f"{name}/") for key, name in ((e.key, e.name) for e in ALL))


@pytest.mark.parametrize("effect", ALL, ids=lambda effect: effect.key)
def test_every_effect_starts_inside_its_bounds_and_reports_the_agreed_parameters(
    effect: Effect, levels: FloatArray
) -> None:
    """On a record of two poles with a little noise: starts, columns, values and units."""
    rng = np.random.default_rng(2)
    data = scaled(levels[:300], np.convolve(levels, np.ones(6) / 6)[:300] + 0.1 * rng.standard_normal(300), ROWS, 1.0)
    parent = fit_baseline(data)
    context = Context(data, parent, parent)
    hypothesis = LINEAR.plus(effect)
    own = hypothesis.plant.parameters
    names = {parameter.name for parameter in own}
    if isinstance(effect, PlantEffect):
        starts = effect.plant_starts(context)
        assert starts
        assert {name.rstrip("+") for start in starts for name in start} <= names
        elsewhere = effect.variant in {"ahead", "beside", "inside"} or effect.key.endswith("-inside")
        elsewhere |= effect.variant.startswith("joint")
        slow = effect.variant.endswith("unsprung") and effect.name != "gravity"  # which only a slow pole may be
        quick = slow or effect.key == "force-limit/speed"
        assert effect.applies(context) != (elsewhere or quick)  # the parent is linear
    else:
        starts = effect.starts(context)
        assert starts
        for start in starts:
            assert len(start) == len(effect.parameters)
            assert all(p.lower <= x <= p.upper for p, x in zip(effect.parameters, start, strict=True))
    theta = np.clip(np.concatenate([[0.2] * (not hypothesis.delay_is_an_effect), np.zeros(60)]), None, None)
    theta = np.clip(theta[: len(hypothesis.parameters)], *hypothesis.bounds)
    theta[hypothesis.slices["plant"]][:2] = hypothesis.plant.starts(*parent.rates)[0][:2]
    design = hypothesis.design(theta, data.u)
    gains = np.linspace(0.5, 1.0, design.sensed.shape[1] + design.added.shape[1])
    found = effect.values(Fitted(hypothesis, theta, gains, data))
    assert found
    assert set(found) <= PARAMETERS[effect.name]
    assert {value.unit for value in found.values()} <= {"s", "Hz", *UNITS}
    assert all(np.isfinite(value.value) for value in found.values())
    acts = effect.active_samples(Fitted(hypothesis, theta, gains, data))
    assert acts.shape == (300,)
    assert acts.dtype == bool


ROWS = np.ones(300, bool)
SPLINE = [0.3, -0.5, 0.2, 0.6, -0.4, 0.1, -0.2]
W = np.array([-2.0, -1.0, -0.2, 0.0, 0.5, 1.0, 2.0])


@pytest.mark.parametrize(
    ("effect", "own", "expected"),
    [
        (input.Saturation("low"), [-0.5], [-0.5, -0.5, -0.2, 0.0, 0.5, 1.0, 2.0]),
        (input.Saturation("high"), [0.7], [-2.0, -1.0, -0.2, 0.0, 0.5, 0.7, 0.7]),
        (input.Saturation("both"), [-0.5, 0.7], [-0.5, -0.5, -0.2, 0.0, 0.5, 0.7, 0.7]),
        (input.Saturation("both"), [0.7, -0.5], [-0.5, -0.5, -0.2, 0.0, 0.5, 0.7, 0.7]),
        (input.DeadZone(), [-0.4, 0.5], [-1.6, -0.6, 0.0, 0.0, 0.0, 0.5, 1.5]),
        (input.DeadZone(), [0.5, -0.4], [-1.6, -0.6, 0.0, 0.0, 0.0, 0.5, 1.5]),
        (input.Backlash(), [1.0, 0.5], [-2.0, -1.5, -0.7, -0.5, 0.0, 0.5, 1.5]),
        (input.RateLimit(), [np.log(0.5)], [-2.0, -1.75, -1.25, -0.75, -0.25, 0.25, 0.75]),
        # a 48th is moved on where the ramp begins
        (input.RateLimit("timed"), [np.log(0.5)], [-97 / 48, -85 / 48, -1.25, -0.75, -0.25, 0.25, 37 / 48]),
        (input.RateLimit("switched"), [np.log(0.5), 3.0], [0.75, 0.25, -0.16, -0.04, 0.25, 0.75, 1.25]),
        (input.Nonlinearity(), [0.5, 0.25], [-2.0, -0.75, -0.182, 0.0, 0.65625, 1.75, 6.0]),
        (input.Delay(), [3.0], W),
        # w + (w - 1) c with c from -0.5 to 0.5: neutral at 1, on either way round
        (drifts.GainDrift("1"), [2**0.5 / 2, -np.pi / 4], [-0.5, -1 / 3, 0.0, 0.0, 5 / 12, 1.0, 2.5]),
        (drifts.GainDrift("1"), [-(2**0.5) / 2, 0.75 * np.pi], [-0.5, -1 / 3, 0.0, 0.0, 5 / 12, 1.0, 2.5]),
        (drifts.GainDrift("1"), [0.5, 0.5 * np.pi], W + np.linspace(-0.5, 0.5, 7)),
    ],
    ids=lambda value: value.key if isinstance(value, Effect) else None,
)
def test_actuator_effects_by_hand(effect: InputEffect, own: list[float], expected: list[float]) -> None:
    np.testing.assert_allclose(effect.apply(W, np.array(own, float), W.size), expected, atol=1e-12)


@pytest.mark.parametrize(
    ("effect", "own", "expected"),
    [
        (output.Saturation("low"), [-0.5], [-0.5, -0.5, -0.2, 0.0, 0.5, 1.0, 2.0]),
        (output.Saturation("high"), [0.7], [-2.0, -1.0, -0.2, 0.0, 0.5, 0.7, 0.7]),
        (output.Saturation("both"), [-0.5, 0.7], [-0.5, -0.5, -0.2, 0.0, 0.5, 0.7, 0.7]),
        (output.Nonlinearity(), [0.5, 0.25], [-2.0, -0.75, -0.182, 0.0, 0.65625, 1.75, 6.0]),
    ],
    ids=lambda value: value.key if isinstance(value, Effect) else None,
)
def test_sensor_effects_by_hand(effect: OutputEffect, own: list[float], expected: list[float]) -> None:
    np.testing.assert_allclose(effect.apply(W, np.array(own)), expected, atol=1e-12)


@pytest.mark.parametrize(
    ("effect", "own"),
    [
        (output.Saturation("low"), [-0.51]),
        (output.Saturation("high"), [0.71]),
        (output.Saturation("both"), [-0.51, 0.71]),
        (output.Nonlinearity(), [0.5, -0.25]),
        (output.Nonlinearity("rich"), SPLINE),
    ],
    ids=lambda value: value.key if isinstance(value, Effect) else None,
)
def test_slope_is_the_derivative_of_bend(effect: OutputEffect, own: list[float]) -> None:
    z, h = np.linspace(-3.0, 3.0, 61), 1e-6
    numbers = np.array(own)
    numerical = (effect.apply(z + h, numbers) - effect.apply(z - h, numbers)) / (2.0 * h)
    np.testing.assert_allclose(effect.slope(z, numbers), numerical, atol=1e-6)


@pytest.mark.parametrize("curve", [input.Nonlinearity("rich"), output.Nonlinearity("rich")])
def test_a_rich_curve_is_a_natural_spline_of_slope_one_at_zero(curve: InputEffect | OutputEffect) -> None:
    def bent(x: FloatArray) -> FloatArray:
        own = np.array(SPLINE)
        return curve.apply(x, own, x.size) if isinstance(curve, InputEffect) else curve.apply(x, own)

    assert len(curve.parameters) == len(SPLINE) == curves.KNOTS.size - 2
    expected = CubicSpline(curves.KNOTS, bent(curves.KNOTS), bc_type="natural")
    inside = np.linspace(curves.KNOTS[0], curves.KNOTS[-1], 301)
    np.testing.assert_allclose(bent(inside), expected(inside), atol=1e-9)
    assert np.abs(expected(inside, 2)).max() > 0.1
    np.testing.assert_allclose([expected(0.0), expected(0.0, 1)], [0.0, 1.0], atol=1e-9)
    for end, way in ((curves.KNOTS[0], -1.0), (curves.KNOTS[-1], 1.0)):  # straight on
        np.testing.assert_allclose(
            bent(end + way * np.arange(4.0)), expected(end) + way * np.arange(4.0) * expected(end, 1)
        )


def test_spline_coefficients_approximate_a_cubic() -> None:
    own = curves.spline_coefficients(np.array([0.3, -0.09]))
    x = np.linspace(-2.2, 2.2, 50)
    np.testing.assert_allclose(curves.evaluate(x, own), x + 0.3 * x**2 - 0.09 * x**3, atol=0.05)
    found = values(fitted(output.Nonlinearity("rich"), None, None, *own))
    assert found == {
        "c2": (pytest.approx(0.1, rel=0.02), "1/y"),
        "c3": (pytest.approx(-0.01, rel=0.02), "1/y^2"),
        "centre": (10.0, "y"),
    }


def columns(effect: AdditiveEffect, own: list[float], samples: int, span: int) -> FloatArray:
    """Its columns beside a plant of two poles."""
    return effect.columns(np.array(own), samples, span, Plant(), np.log([0.5, 0.05]))


def test_columns_of_a_drift() -> None:
    x = np.linspace(-1.0, 1.0, 9)
    expected = np.column_stack([x, 2.0 * x**2 - 1.0, 4.0 * x**3 - 3.0 * x])
    np.testing.assert_allclose(columns(output.Drift("3"), [], 9, 9), expected, atol=1e-12)
    longer = columns(output.Drift("3"), [], 12, 9)
    np.testing.assert_allclose(longer[9:], 1.0)  # behind the fit's record it stays
    settling = columns(output.Drift("settle"), [np.log(0.5)], 8, 10)
    np.testing.assert_allclose(settling[:, 0], np.exp(-np.arange(8) / 5.0))
    assert output.Drift("settle").width == 1
    assert output.Drift("10").width == 10


def test_columns_of_a_sinusoid_count_cycles_in_the_span() -> None:
    phase = 2.0 * np.pi * 3.0 * np.arange(20) / 12.0
    expected = np.column_stack([np.cos(phase), np.sin(phase)])
    np.testing.assert_allclose(columns(periodic.Periodic(), [3.0], 20, 12), expected, atol=1e-12)


def test_columns_of_a_load_are_the_step_response_from_its_onset() -> None:
    step = columns(disturbance.LoadStep(), [0.25], 100, 100)
    from_rest = Plant().load_response(np.log([0.5, 0.05]), np.ones(75))
    assert np.all(step[:26] == 0.0)
    np.testing.assert_allclose(step[25:], from_rest, atol=1e-12)


def test_widths_are_the_numbers_of_columns() -> None:
    for effect in ALL:
        if isinstance(effect, AdditiveEffect):
            own = [2.5] * len(effect.parameters) if effect.name != "load-step" else [0.5, 0.8][: len(effect.parameters)]
            assert columns(effect, own, 40, 40).shape == (40, effect.width)


@pytest.mark.parametrize(
    ("effect", "own", "expected"),
    [
        (input.Delay(), [3.5], {"delay": (0.7, "s")}),
        (input.Saturation("both"), [-1.0, 1.2], {"low": (1.5, "u"), "high": (2.6, "u")}),
        (input.DeadZone(), [0.4, -0.6], {"low": (1.7, "u"), "high": (2.2, "u")}),
        (input.Backlash(), [0.8, 0.3], {"width": (0.4, "u")}),
        (input.RateLimit(), [np.log(0.4)], {"rate": (1.0, "u/s")}),
        (input.Nonlinearity(), [0.2, 0.1], {"c2": (0.4, "1/u"), "c3": (0.4, "1/u^2"), "centre": (2.0, "u")}),
        (output.Saturation("high"), [0.5], {"high": (11.5, "y")}),
        (output.Nonlinearity(), [0.3, 0.9], {"c2": (0.1, "1/y"), "c3": (0.1, "1/y^2"), "centre": (10.0, "y")}),
        (drifts.GainDrift("1"), [0.2, 0.0], {"drift": (0.5, "1")}),
    ],
    ids=lambda value: value.key if isinstance(value, Effect) else None,
)
def test_values_are_in_the_units_of_the_record(
    effect: Effect, own: list[float], expected: dict[str, tuple[float, str]]
) -> None:
    found = values(fitted(effect, None, None, *own))
    assert {name: unit for name, (_, unit) in found.items()} == {name: unit for name, (_, unit) in expected.items()}
    for name, (value, _) in expected.items():
        assert found[name][0] == pytest.approx(value)


@pytest.mark.parametrize(
    ("effect", "plant", "expected"),
    [
        (dynamics.ExtraLag(), {"log_lag": np.log(4.0)}, {"tau": (0.8, "s")}),
        (
            dynamics.Resonance(),
            {"log_frequency": np.log(0.5), "log_damping": np.log(0.1)},
            {"frequency": (0.5 / (2.0 * np.pi * 0.2), "Hz"), "damping": (0.1, "1")},
        ),
        (dynamics.CoulombFriction("position"), {"friction": 0.3}, {"friction": (0.15, "u")}),
        (dynamics.CoulombFriction("speed"), {"friction": 0.3}, {"friction": (0.15, "u")}),
        (tanks.SqrtOutflow("both"), {"zero": -3.0}, {"zero": (0.5, "u"), "empty": (7.0, "y")}),
        (tanks.SqrtOutflow("both-flipped"), {"zero": -3.0}, {"zero": (3.5, "u"), "empty": (7.0, "y")}),
        (tanks.Overflow("lower"), {"brim": 1.5}, {"level": (16.0, "y")}),
        (tanks.Overflow("upper"), {"brim": 1.5, "share": 0.3}, {"level": (16.0, "y"), "caught": (0.3, "1")}),
        (
            tanks.Overflow("both"),
            {"brim": 2.0, "brim2": 1.5, "share": 0.3},
            {"level": (16.0, "y"), "upper": (19.0, "y"), "caught": (0.3, "1")},
        ),
        # A spring whose force is x + 0.2 x^3 in scaled input; the output is 2 x of 3 units: per y that is 0.2 / 36.
        (dynamics.CubicStiffness(), {"cubic": 0.2}, {"cubic": (0.2 / 36.0, "1/y^2")}),
        (
            disturbance.Leak("leak"),
            {"onset": 0.25, "drift": 0.2},
            {"onset": (9.0, "s"), "size": (0.2214, "1")},
        ),
    ],
    ids=lambda value: value.key if isinstance(value, Effect) else None,
)
def test_values_of_the_dynamics_are_in_the_units_of_the_record(
    effect: Effect, plant: dict[str, float], expected: dict[str, tuple[float, str]]
) -> None:
    found = values(fitted(effect, np.array([2.0, -1.0, 0.0, 0.0]), plant))
    assert set(found) == set(expected)
    for name, (value, unit) in expected.items():
        assert found[name][0] == pytest.approx(value, rel=1e-4)
        assert found[name][1] == unit


@pytest.mark.parametrize(("share", "faster"), [(0.0, np.exp(0.4)), (1.0, 1.0)])
@pytest.mark.parametrize("degree", ["1", "4"])
def test_a_drift_of_the_rates_is_reported_by_what_it_changes(degree: str, share: float, faster: float) -> None:
    """Its speed by the mean delay of z'' + c z' + k z = w, which is c/k, and its gain, here (3 + course)/k."""
    effect = drifts.PoleDrift(degree)
    hypothesis = Hypothesis((effect,))
    numbers = {"drift": 0.2, "share_c": share, "log_c": np.log(0.6), "log_k": np.log(0.05)}
    theta = np.array([numbers.get(parameter.name, 0.0) for parameter in hypothesis.parameters])
    gains = np.array([3.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0])
    found = effect.values(Fitted(hypothesis, theta, gains, data_of(np.arange(1800.0))))
    assert found["pole"].value == pytest.approx(faster - 1.0, abs=1e-6)
    assert found["drift"].value == pytest.approx(3.2 / 2.8 * np.exp(-0.4) - 1.0, rel=1e-6)


def test_a_drift_of_a_pole_is_planted_both_ways() -> None:
    """It has a row of its own in the table of limits, beside that of the gain."""
    planted = drifts.PoleDrift("1").planted(
        Fitted(Hypothesis(), np.zeros(0), np.zeros(0), data_of(np.arange(180.0))), 0.5
    )
    assert [one.parameter for one in planted] == ["pole", "pole"]
    sizes = [one.size.value for one in planted if one.size is not None]
    assert sizes == pytest.approx([0.5, 1.0 / 1.5 - 1.0])
    assert [2.0 * one.values["drift"] for one in planted] == pytest.approx(np.log1p(sizes))


def test_a_pole_drift_on_a_nonlinear_state_is_reported_as_on_linear_dynamics() -> None:
    numbers = {"drift": 0.2, "bend1": 0.5, "bend2": -0.1}
    effect = drifts.InnerPoleDrift("4")
    hypothesis = Hypothesis((dynamics.CoulombFriction("speed"), effect))
    assert hypothesis.names == ("coulomb-friction", "parameter-drift")
    theta = np.array([numbers.get(parameter.name, 0.0) for parameter in hypothesis.parameters])
    found = effect.values(Fitted(hypothesis, theta, np.array([2.0, -1.0]), data_of(np.arange(180.0))))
    assert {name: (value.value, value.unit) for name, value in found.items()} == {
        "pole": (pytest.approx(np.exp(0.2) - 1.0, rel=1e-4), "1")
    }


@pytest.mark.parametrize(
    ("effect", "plant", "answer"),
    [  # of one unit of the input that swings, at the output of the plant
        (
            dynamics.CubicStiffness(),
            {"log_c": np.log(0.5), "log_k": np.log(0.05)},
            lambda s: 0.05 / (s * (s + 0.5) + 0.05),
        ),
        (dynamics.CoulombFriction("speed"), {"log_a": np.log(0.6), "log_b": np.log(0.3)}, lambda s: 0.6 / (s + 0.6)),
        (
            tanks.Overflow("lower"),
            {"log_a": np.log(0.6), "log_b": np.log(0.3), "brim": 99.0},
            lambda s: 0.3 / (s + 0.3),
        ),
    ],
)
def test_a_periodic_load_is_reported_by_its_amplitude_at_the_output(
    effect: Effect, plant: dict[str, float], answer: Callable[[complex], complex]
) -> None:
    wave = periodic.InnerPeriodic("inside")
    hypothesis = Hypothesis((effect, wave))
    assert hypothesis.names == (effect.name, "periodic-disturbance")
    u, cycles = np.repeat(np.random.default_rng(5).uniform(-1.5, 1.5, 200), 8), 50.0
    numbers = plant | {"cycles": cycles, "shake_cos": 0.3, "shake_sin": -0.4}
    theta = np.array([numbers.get(parameter.name, 0.0) for parameter in hypothesis.parameters])
    found = wave.values(Fitted(hypothesis, theta, np.array([2.0, -1.0]), data_of(u)))
    assert {name: value.unit for name, value in found.items()} == {"frequency": "Hz", "amplitude": "y"}
    assert found["frequency"].value == pytest.approx(cycles / (u.size * TS))
    expected = 3.0 * 2.0 * 0.5 * abs(answer(2j * np.pi * cycles / u.size))
    assert found["amplitude"].value == pytest.approx(expected, rel=0.02)


def test_a_wave_at_the_load_is_bent_by_the_curve_of_the_sensor(levels: FloatArray, two_poles: Response) -> None:
    x = two_poles(levels) + 0.3 * np.sin(2.0 * np.pi * 23.4 / levels.size * np.arange(levels.size) + 0.4)
    data = scaled(levels, x + 0.25 * x**2 - 0.05 * x**3, np.ones(levels.size, bool), 1.0)
    missed = []
    for wave in (periodic.Periodic("load"), periodic.Periodic()):
        hypothesis = Hypothesis((output.Nonlinearity(), wave))
        numbers = {"log_c": np.log(0.5), "log_k": np.log(0.05), "c2": 0.1, "cycles": 23.4}
        theta = np.array([numbers.get(parameter.name, 0.0) for parameter in hypothesis.parameters])
        point = minimize(data, hypothesis, theta, iterations=60, tolerance=1e-12)
        assert point is not None
        missed.append(float(np.sqrt(point.cost)))
    assert missed[0] < 1e-9
    assert missed[1] > 0.01


def test_the_size_of_a_load_is_its_final_change_of_the_output() -> None:
    effect = disturbance.LoadStep()
    gains = np.array([0.0, 0.0, 0.0, 0.0, 0.0, 0.03, 0.01])
    fit = fitted(effect, gains, None, 0.25)
    found = values(fit)
    assert found["onset"] == (pytest.approx(0.25 * SAMPLES * TS + 4.0), "s")
    step = columns(effect, [0.0], 400, 400) @ gains[-2:]
    assert found["size"][0] == pytest.approx(3.0 * step[-1], rel=1e-6)
    np.testing.assert_array_equal(effect.active_samples(fit), np.arange(SAMPLES) >= 25)


def test_a_load_step_without_final_change_is_implausible() -> None:
    effect = disturbance.LoadStep()
    for second, onset, expected in ((0.01, 0.5, True), (-0.0299, 0.5, False), (-0.03, 0.5, False), (0.01, 0.0, False)):
        gains = np.array([0.0, 0.0, 0.0, 0.0, 0.0, 0.03, second])
        assert effect.is_plausible(fitted(effect, gains, None, onset)) is expected


def test_amplitudes_of_additive_effects() -> None:
    wave = values(fitted(periodic.Periodic(), np.array([0.0, 0.0, 0.3, 0.4]), None, 5.0))
    assert wave == {"frequency": (pytest.approx(5.0 / (SAMPLES * TS)), "Hz"), "amplitude": (pytest.approx(1.5), "y")}
    gains = np.array([0.0, 0.0, 0.4, -0.3, 0.2])
    found = values(fitted(output.Drift("3"), gains))
    course = chebval(np.linspace(-1.0, 1.0, SAMPLES), [0.0, 0.4, -0.3, 0.2])
    assert found["amplitude"] == (pytest.approx(1.5 * np.ptp(course)), "y")


def test_where_limits_act() -> None:
    fit = fitted(input.Saturation("high"), None, None, 0.75)
    np.testing.assert_array_equal(fit.hypothesis.effects[0].active_samples(fit), fit.data.u > 0.75)
    fit = fitted(input.DeadZone(), None, None, -0.4, 0.3)
    inside = (fit.data.u >= -0.4) & (fit.data.u <= 0.3)
    np.testing.assert_array_equal(fit.hypothesis.effects[0].active_samples(fit), inside)
    gains = np.array([0.0, 0.0, 0.0, 0.0, 0.0, 1.0])
    fit = fitted(output.Saturation("high"), gains, None, 0.5)
    assert fit.hypothesis.effects[0].active_samples(fit).all()
    fit = fitted(output.Saturation("high"), gains, None, 1.5)
    assert not fit.hypothesis.effects[0].active_samples(fit).any()


def context_of(u: FloatArray, y: FloatArray) -> Context:
    """About the fitted linear structure."""
    data = scaled(u, y, np.ones(u.size, bool), 1.0)
    parent = fit_baseline(data)
    return Context(data, parent, parent)


@pytest.mark.parametrize(("rate", "applies"), [(0.003, True), (0.05, True), (0.2, False)])
def test_a_mass_is_tried_without_its_spring_where_the_record_hardly_sees_one(
    levels: FloatArray, rate: float, applies: bool
) -> None:
    context = linear_context(rate + 0.5, 0.5 * rate, 1.0, levels)
    assert dynamics.CoulombFriction("unsprung").applies(context) == applies
    assert dynamics.CoulombFriction("position").applies(context)


@pytest.mark.parametrize(("damped", "applies"), [(0.05, True), (0.8, True), (1.2, False), (3.0, False)])
def test_only_a_mass_that_swings_is_tried_on_an_input_that_is_not_held(
    levels: FloatArray, damped: float, applies: bool
) -> None:
    context = linear_context(2.0 * damped * 0.3, 0.3**2, 1.0, levels)
    assert dynamics.CubicStiffness("sampled").applies(context) == applies
    assert dynamics.CubicStiffness().applies(context)


def linear_context(c: float, k: float, gain: float, levels: FloatArray) -> Context:
    """About two known poles."""
    numerator, denominator, _ = cont2discrete(([gain * k], [1.0, c, k]), 1.0)
    hypothesis = Hypothesis()
    theta = np.array([0.0, np.log(c), np.log(k)])
    data = data_of(levels, lfilter(numerator[0], denominator, levels - levels[0]))
    point = minimize(data, hypothesis, theta, iterations=0)
    assert point is not None
    return Context(data, finish(data, hypothesis, point))


@pytest.mark.parametrize(("c", "k", "gain"), [(0.5, 0.05, 1.0), (0.2, 0.01, -3.0), (0.1, 0.04, 0.5)])
def test_gain_and_settling_of_two_poles(levels: FloatArray, c: float, k: float, gain: float) -> None:
    """The area above the step response of k / (s^2 + c s + k) is c / k, real poles or not."""
    context = linear_context(c, k, gain, levels)
    assert context.gain == pytest.approx(gain, rel=1e-3)
    assert context.response_time == pytest.approx(c / k, rel=0.02, abs=0.2)


def test_dynamics_without_static_gain_do_not_settle(levels: FloatArray) -> None:
    context = linear_context(0.5, 0.05, 1.0, levels)
    still = Context(context.data, replace(context.parent, gains=np.zeros(context.parent.gains.size)))
    assert (still.gain, still.response_time) == (0.0, 0.0)


def test_a_two_level_input_shows_no_input_nonlinearity(levels: FloatArray) -> None:
    two = np.sign(levels[:300])
    context = context_of(two, np.convolve(two, np.ones(6) / 6)[:300])
    blind = [effect.key for effect in ALL if not effect.applies(context)]
    assert {"input-dead-zone", "input-backlash", "input-nonlinearity", "input-saturation/both"} <= set(blind)
    assert "input-delay" not in blind
    assert "input-rate-limit" not in blind


def test_a_dead_band_at_the_end_of_the_range_is_a_limit_unless_the_rig_rests_there() -> None:
    effect, fit = input.DeadZone(), fitted(input.DeadZone(), None, None, -0.3, 0.4)
    assert effect.is_plausible(fit)
    assert not effect.is_plausible(fitted(effect, None, None, -1.6, 0.4))
    assert not effect.is_plausible(fitted(effect, None, None, 0.1, 0.1))
    low = Fitted(fit.hypothesis, fitted(effect, None, None, -1.6, 0.4).theta, fit.gains, data_of(np.full(100, -1.5)))
    low.data.u[50:] = 1.5
    assert effect.is_plausible(low)


@pytest.mark.parametrize(
    ("least", "most", "band", "expected"),
    [
        (0.0, 5.0, (-0.8, 0.8), True),
        (-0.5, 5.0, (-0.8, 0.8), True),
        (-5.0, 0.3, (-0.8, 0.9), True),
        (-3.0, 5.0, (-3.5, 0.8), False),  # about zero it would be left at -0.8
        (0.15, 5.0, (-0.8, 0.8), True),
        (0.3, 5.0, (-0.9, 0.8), False),  # the command does not reach zero
        (0.0, 5.0, (-1.0, 6.0), False),
    ],
)
def test_a_dead_band_at_the_end_of_the_range_may_be_one_about_the_command_zero(
    least: float, most: float, band: tuple[float, float], expected: bool
) -> None:
    u = np.random.default_rng(1).permutation(np.linspace(least, most, 200))
    data = scaled(u, u, np.ones(u.size, bool), TS)
    hypothesis = Hypothesis((input.DeadZone(),))
    theta = np.zeros(len(hypothesis.parameters))
    theta[hypothesis.slices["input-dead-zone"]] = data.u_scale.of(np.array(band))
    assert hypothesis.effects[0].is_plausible(Fitted(hypothesis, theta, np.zeros(6), data)) is expected
    theta, undetermined = hypothesis.completed(theta, data)
    ends = data.u_scale.back(theta[hypothesis.slices["input-dead-zone"]])
    assert undetermined == expected
    assert (abs(ends.sum()) < 1e-9) == expected


@pytest.mark.parametrize(
    ("variant", "rates", "expected"),
    [  # of the upper and of the lower tank, a sample
        ("lower", (0.3, 0.9), True),
        ("lower", (0.3, 1.1), False),
        ("lower", (8.0, 0.9), True),
        ("upper", (1.1, 0.3), False),
        ("upper", (0.9, 8.0), True),
        ("both", (0.9, 0.9), True),
        ("both", (1.1, 0.9), False),
        ("both-flipped", (0.9, 1.1), False),
    ],
)
@pytest.mark.parametrize("root", [None, "both", "upper", "lower"])
def test_a_tank_faster_than_the_sampling_is_implausible(
    variant: str, rates: tuple[float, float], expected: bool, root: str | None
) -> None:
    """About the mean flow, here four: there the root of the level runs off an eighth as fast as the level."""
    side = "-flipped" if variant.endswith("flipped") else ""
    effect, beside = tanks.Overflow(variant), () if root is None else (tanks.SqrtOutflow(root + side),)
    hypothesis = Hypothesis((*beside, effect))
    factors = [8.0 if root in ("both", which) else 1.0 for which in ("upper", "lower")]
    numbers = dict(zip(("log_a", "log_b"), np.log(np.multiply(rates, factors)), strict=True)) | {"zero": -4.0}
    theta = np.array([numbers.get(p.name, 0.0) for p in hypothesis.parameters])
    assert effect.is_plausible(Fitted(hypothesis, theta, np.zeros(9), data_of(W))) is expected


def test_friction_without_a_turn_is_no_friction() -> None:
    effect = dynamics.CoulombFriction("speed")
    fit = fitted(effect, None, {"friction": 0.1, "log_a": np.log(0.4), "log_b": np.log(0.4), "centre": 0.0})
    assert effect.is_plausible(fit)
    one_way = fitted(effect, None, {"friction": 0.1, "log_a": np.log(0.4), "log_b": np.log(0.4), "centre": -3.0})
    assert not effect.is_plausible(one_way)


def test_a_lag_has_to_pass_the_input_on(levels: FloatArray) -> None:
    effect = dynamics.ExtraLag()
    hypothesis = Hypothesis((effect,))
    u = levels[:300]
    theta = np.array([0.0, np.log(0.5), np.log(0.05), np.log(5.0)])
    passing, free = np.zeros(8), np.zeros(8)
    passing[5], free[6] = 1.0, 1.0
    assert effect.is_plausible(Fitted(hypothesis, theta, passing, data_of(u)))
    assert not effect.is_plausible(Fitted(hypothesis, theta, free, data_of(u)))


def test_peaks_finds_a_wave_in_the_residual(levels: FloatArray, two_poles: Response) -> None:
    y = two_poles(levels) + 0.1 * np.sin(0.37 * np.arange(levels.size))
    context = context_of(levels, y + 0.01 * np.random.default_rng(1).standard_normal(levels.size))
    found = dynamics.peaks(context, 0.02)
    assert found[0] == pytest.approx(0.37, abs=2.0 * np.pi / levels.size)
    assert min(abs(a - b) for i, a in enumerate(found) for b in found[:i]) > 0.02


def test_onsets_finds_where_a_load_begins(levels: FloatArray, two_poles: Response) -> None:
    load = two_poles((np.arange(levels.size) >= 220).astype(float))
    context = context_of(levels, two_poles(levels) + 0.5 * load)
    found = disturbance.load_onsets(context, 4)
    assert len(found) == 4
    assert found[0] == pytest.approx(220 / levels.size, abs=0.02)


def test_start_away_is_how_far_the_record_begins_from_rest(levels: FloatArray, two_poles: Response) -> None:
    y = two_poles(levels) + 0.8 * np.exp(-0.14 * np.arange(levels.size))
    context = context_of(levels, y)
    assert dynamics.initial_offset(context) == pytest.approx(0.8 / context.data.u_scale.unit, abs=0.3)
    assert abs(dynamics.initial_offset(context_of(levels, two_poles(levels)))) < 0.2


def test_every_effect_can_be_searched_for(levels: FloatArray, two_poles: Response) -> None:
    """One search from one start each lowers the error, or keeps it, and stays finite."""
    y = two_poles(levels) + 0.05 * np.random.default_rng(4).standard_normal(levels.size)
    context = context_of(levels, y)
    for effect in ALL:
        hypothesis = LINEAR.plus(effect)
        theta = np.zeros(len(hypothesis.parameters))
        own = hypothesis.plant.starts(*context.rates)[0]
        if isinstance(effect, PlantEffect):
            for name, value in effect.plant_starts(context)[0].items():
                own[hypothesis.plant.index(name.rstrip("+"))] = value
        else:
            theta[hypothesis.slices[effect.key]] = effect.starts(context)[0]
        theta[hypothesis.slices["plant"]] = own
        before = minimize(context.data, hypothesis, theta, iterations=0)
        after = minimize(context.data, hypothesis, theta, iterations=2)
        assert before is not None
        assert after is not None
        assert after.cost <= before.cost
        lower, upper = hypothesis.bounds
        assert np.all((lower <= after.theta) & (after.theta <= upper))


def starts_of(effect: PlantEffect, u: FloatArray) -> set[tuple[float, ...]]:
    """Numbers with which a search of friction begins."""
    return {tuple(start.values()) for start in effect.plant_starts(context_of(u, np.convolve(u, np.ones(6) / 6)[:300]))}


@pytest.mark.parametrize("variant", ["speed", "speed-lag"])
def test_of_a_mirrored_record_the_search_of_friction_begins_at_the_mirrored_numbers(
    levels: FloatArray, variant: str
) -> None:
    u = np.exp(levels[:300])  # off the middle: median, first value and range differ
    effect = dynamics.CoulombFriction(variant)
    mirrored = {(friction, -centre) for friction, centre in starts_of(effect, u)}
    assert len(mirrored) == 8
    assert starts_of(effect, -u) == mirrored


def test_pole_and_output_drifts_include_high_degrees(levels: FloatArray) -> None:
    """Courses of four and of sixteen degrees are among the candidates."""
    assert {"parameter-drift/pole-4", "output-drift/16"} <= {effect.key for effect in ALL}
    slow = drifts.PoleDrift("4").extend(Plant())
    assert [p.name for p in slow.parameters][2:] == ["drift", "share_c", "turn", "bend1", "bend2", "bend3"]
    assert output.Drift("16").width == 16
    x = np.linspace(-1.0, 1.0, 400)
    wander = np.cos(16.0 * np.arccos(x))
    left = [
        np.linalg.lstsq(columns(output.Drift(degree), [], 400, 400), wander, rcond=None)[1][0]
        for degree in ("10", "16")
    ]
    assert left[1] < 1e-18 < 100.0 < left[0]


@pytest.mark.parametrize(
    "effect",
    [disturbance.LoadStep(), periodic.Periodic(), output.Drift("1")],
    ids=lambda effect: effect.key,
)
def test_nothing_is_larger_than_the_record_could_show(effect: AdditiveEffect) -> None:
    """The record ranges over 3 scaled units."""
    own = [0.5] if effect.parameters else []
    for size, expected in ((0.5, True), (50.0, False)):
        gains = np.zeros(5 + effect.width)
        fit = fitted(effect, gains, None, *own)
        columns = Hypothesis((effect,)).design(fit.theta, fit.data.u).columns[:, -effect.width :]
        gains = np.concatenate([np.zeros(5), [size / float(np.abs(columns[:, 0]).max())], np.zeros(effect.width - 1)])
        assert effect.is_plausible(fitted(effect, gains, None, *own)) is expected


def test_a_load_on_slow_dynamics_is_reported_as_far_as_the_record_shows_it() -> None:
    effect = disturbance.LoadStep()
    slow = {"log_c": float(np.log(0.5)), "log_k": float(np.log(1e-5))}
    start = fitted(effect, None, slow, 0.25)
    columns = Hypothesis((effect,)).design(start.theta, start.data.u).columns
    gains = np.concatenate([np.zeros(columns.shape[1] - 2), [0.001, 0.001]])
    fit = fitted(effect, gains, slow, 0.25)
    response = fit.hypothesis.output(fit.theta, gains, fit.data.u)
    assert abs(effect.change(fit)) > 50.0 * np.ptp(response)
    assert effect.values(fit)["size"].value == pytest.approx(3.0 * (response[-1] - response[0]))


def test_a_delay_longer_than_a_quarter_of_the_record_is_implausible() -> None:
    effect = input.Delay()
    assert effect.is_plausible(fitted(effect, None, None, 10.0))
    assert not effect.is_plausible(fitted(effect, None, None, 30.0))


def test_no_initial_state_hides_behind_a_limit_of_the_sensor() -> None:
    sensor, own = output.Saturation("low"), np.array([-1.0])
    z = np.array([-100.0, -15.0, -1.5, 0.5])
    np.testing.assert_array_equal(sensor.apply(z, own), [-80.0, -1.0, -1.0, 0.5])
    np.testing.assert_array_equal(sensor.slope(z, own), [1.0, 0.0, 0.0, 1.0])


def test_a_limit_that_a_rig_at_rest_exceeds_is_a_dead_zone() -> None:
    """The zero command is at the end of the range, and below the limit."""
    u = np.repeat([0.0, 1.0, 2.0, 0.5], 20)
    for start, expected in ((0.0, False), (0.3, True)):
        data = scaled(u + start, u, np.ones(u.size, bool), TS)
        limit = data.u_scale.of(np.array([0.7 + start]))
        hypothesis = Hypothesis((input.Saturation("low"),))
        theta = np.zeros(len(hypothesis.parameters))
        theta[hypothesis.slices["input-saturation/low"]] = limit
        assert hypothesis.effects[0].is_plausible(Fitted(hypothesis, theta, np.zeros(6), data)) is expected


@pytest.mark.parametrize(("first", "expected"), [(0.0, False), (0.4, True)])
def test_a_rig_that_is_off_and_reads_zero_is_not_beyond_the_limit_of_its_sensor(first: float, expected: bool) -> None:
    u = np.repeat([0.0, 1.0, 2.0, 0.5], 20)
    y = np.maximum(u - 0.7, 0.0) + first
    data = scaled(u, y, np.ones(u.size, bool), TS)
    hypothesis = Hypothesis((output.Saturation("low"),))
    theta = np.zeros(len(hypothesis.parameters))
    theta[hypothesis.slices["output-saturation/low"]] = data.y[0]
    gains = np.append(np.zeros(5), data.y[0] - 1.0)  # the last one is the constant: always below the limit
    found = hypothesis.effects[0].is_plausible(Fitted(hypothesis, theta, gains, data))
    assert found is expected


def test_a_tank_does_not_overflow_while_off() -> None:
    """A reversed tank is full at the zero command."""
    u = np.repeat([0.0, 1.0, 2.0, 0.5], 20)
    for start, expected in ((0.0, False), (0.3, True)):
        data = scaled(u + start, u, np.ones(u.size, bool), TS)
        hypothesis = Hypothesis((tanks.Overflow("lower-flipped"),))
        theta = np.zeros(len(hypothesis.parameters))
        at = hypothesis.slices["plant"].start
        theta[at : at + 2] = np.log([0.5, 0.1])
        theta[at + hypothesis.plant.index("brim")] = 0.5
        assert hypothesis.effects[0].is_plausible(Fitted(hypothesis, theta, np.zeros(2), data)) is expected


@pytest.mark.parametrize("size", [1.0, 1e6])
def test_the_energy_of_columns_in_proportion_is_that_of_one_of_them(size: float) -> None:
    """As of a load whose response only one counted row shows, and that is large because the dynamics integrate."""
    e = np.array([0.3, -0.2, 0.5])
    columns = size * np.array([[0.0, 0.0], [0.0, 0.0], [3.0, 2.0]])
    found = disturbance.explained_energies((columns.T @ columns)[None], (columns.T @ e)[None])
    assert found == pytest.approx([0.25], rel=1e-6)
