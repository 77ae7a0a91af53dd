"""The smallest sizes, against refits, by hand, and as they follow the noise."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.signal import lfilter

from labsid.gap.diagnosis import find_limits
from labsid.gap.effects.dynamics import CoulombFriction
from labsid.gap.effects.input import Delay
from labsid.gap.effects.tanks import SqrtOutflow
from labsid.gap.fits.fitting import fit_from, mean_square, rms
from labsid.gap.fits.linear_fits import fit_baseline
from labsid.gap.limits.distances import Refit
from labsid.gap.limits.planning import planned_record, with_planted
from labsid.gap.limits.planting import plantations
from labsid.gap.limits.smallest_sizes import find_smallest_sizes
from labsid.gap.record.data import scaled
from labsid.records.record import Record

POLE = np.exp(-1.0 / 15.0)
LEVELS = np.random.default_rng(3).uniform(1.0, 5.0, 200)


def first_order(u, late=0):
    """Output of a first-order rig at rest at first, later by some samples."""
    w = np.concatenate([np.full(late, u[0]), u[: u.size - late]])
    return u[0] + lfilter([0.0, 1.0 - POLE], [1.0, -POLE], w - u[0])


def record(samples=600, noise=0.05, seed=0, u=None):
    """A first-order rig with white noise, scaled, and its fit."""
    u = np.repeat(LEVELS, 20)[:samples] if u is None else u
    y = first_order(u) + noise * np.random.default_rng(seed).standard_normal(u.size)
    data = scaled(u, y, np.ones(u.size, bool), 0.1)
    return data, fit_baseline(data)


@pytest.fixture(scope="module")
def plain():
    return record()


@pytest.fixture(scope="module")
def found(plain):
    data, fit = plain
    return {(one.name, one.parameter): one for one in find_smallest_sizes(data, fit, rms(data, fit))}


def test_an_error_of_the_gain_an_offset_and_a_pole_leave_nothing(plain):
    data, fit = plain
    refit = Refit.about(data, fit, rms(data, fit))
    other = first_order(data.u)
    slower = np.concatenate([[0.0], lfilter([1.0], [1.0, -1e-3 - POLE], other)[:-1]])
    for change in (0.5 * fit.output, np.full(data.samples, 0.7)):
        vector, size = refit.left(change)
        assert vector @ vector < 1e-6 * (change @ change) / refit.sigma**2
        assert size < 1e-3
    vector, _ = refit.left(slower - lfilter([0.0, 1.0], [1.0, -POLE], other))
    assert np.isfinite(vector).all()


def test_a_delay_is_as_far_away_as_a_refit_of_it_says(plain):
    """The linearized refit leaves what the refit itself leaves of a rig that is late."""
    data, fit = plain
    late = 4
    refit = Refit.about(data, fit, rms(data, fit))
    delay = next(one for one in plantations(data, fit) if isinstance(one.effect, Delay))
    (change,) = delay.changes(late / delay.fit.slowest_time)
    expected = data.y_scale.of(first_order(np.asarray(data.u_scale.back(data.u)), late))
    assert np.std(fit.output + change - expected) < 0.02
    exact = replace(data, y=fit.output + change)
    left = mean_square(exact, fit_from(exact, fit.hypothesis, fit.theta, iterations=40))
    vector, size, _ = refit.left_exactly(change)
    assert vector @ vector == pytest.approx(data.samples * left / refit.sigma**2, rel=0.05)
    assert size == pytest.approx(np.sqrt(left) / rms(data, fit), rel=0.05)
    linearized, _ = refit.left(change)
    assert not refit.is_linear_at(change, linearized)


def test_the_linearized_refit_is_right_about_a_static_curve(plain):
    """And exact refits are not made, because it is."""
    data, fit = plain
    refit = Refit.about(data, fit, rms(data, fit))
    curve = next(one for one in plantations(data, fit) if one.effect.key == "input-nonlinearity")
    change = curve.changes(0.03)[0]
    vector, size = refit.left(change)
    exact, exact_size, _ = refit.left_exactly(change)
    assert vector @ vector == pytest.approx(exact @ exact, rel=0.05)
    assert size == pytest.approx(exact_size, rel=0.05)
    assert refit.is_linear_at(change, vector)


def test_a_first_order_rig_hides_a_lag_as_the_second_pole_of_the_model(found):
    lag = found["extra-lag", "tau"]
    assert lag.detect is None
    assert lag.reason == "hidden"


def test_the_size_is_that_of_the_planted_rig_in_its_units(plain):
    data, fit = plain
    by_name = {one.effect.key: one for one in plantations(data, fit)}
    share, u_range = 0.25, np.ptp(data.u_scale.back(data.u))
    sizes = {
        "input-backlash": share * u_range,
        "input-dead-zone": share * u_range,
        "input-saturation/high": float(np.max(data.u_scale.back(data.u))) - share * u_range,
        "coulomb-friction/position": share * u_range,
        "slow-mode": share,
        "parameter-drift/gain-1": pytest.approx((1.0 + share / 2.0) / (1.0 - share / 2.0) - 1.0),
    }
    for key, size in sizes.items():
        assert by_name[key].size(by_name[key].places(share)[0]).value == pytest.approx(size), key


def test_every_family_is_asked_for_and_in_the_order_of_the_search(found):
    names = list(dict.fromkeys(name for name, _ in found))
    assert names[:6] == [
        *("input-delay", "input-saturation", "input-dead-zone", "input-backlash", "input-rate-limit"),
        "input-nonlinearity",
    ]
    assert {"load-step", "periodic-disturbance", "coulomb-friction", "sqrt-outflow"} <= set(names)
    assert all(
        one.detect is None or one.named is None or one.shares["named"] >= 0.99 * one.shares["detect"]
        for one in found.values()
    )


@pytest.mark.parametrize("factor", [0.5, 0.25])
def test_limits_shrink_with_the_noise(plain, found, factor):
    """Of what is proportional to its size exactly; the refit is the same."""
    data, fit = plain
    quiet = replace(fit, noise=replace(fit.noise, sigma2=factor**2 * fit.noise.sigma2))
    less = {(one.name, one.parameter): one for one in find_smallest_sizes(data, quiet, factor * rms(data, fit), False)}
    for key in (("load-step", "size"), ("output-drift", "amplitude"), ("periodic-disturbance", "amplitude")):
        assert less[key].detect == pytest.approx(factor * found[key].detect, rel=1e-3)
        assert less[key].excluded is None
    for key, one in less.items():
        assert one.shares["detect"] is None or one.shares["detect"] <= 1.1 * (found[key].shares["detect"] or np.inf), (
            key
        )


def test_the_distance_grows_with_the_length_of_the_record_so_limits_shrink_with_its_root():
    powers = []
    for samples in (800, 3200):
        data, fit = record(samples, u=np.tile(np.repeat(LEVELS[:20], 20), samples // 400))
        refit = Refit.about(data, fit, rms(data, fit))
        play = next(one for one in plantations(data, fit) if one.effect.key == "output-backlash")
        vector, _ = refit.left(play.changes(0.02)[0])
        powers.append(float(vector @ vector) * refit.sigma**2 / np.ptp(fit.output) ** 2)
    assert powers[1] / powers[0] == pytest.approx(4.0, rel=0.15)


@pytest.mark.exhaustive  # the coverage of 24 intervals, each from a search of its own
def test_a_planted_effect_below_what_is_excluded_is_rarely_excluded():
    """The upper end of the profile likelihood covers the true size in 95 % of records."""
    rng, missed, tried = np.random.default_rng(5), 0, 0
    data, fit = record(seed=7)
    for one in find_smallest_sizes(data, fit, rms(data, fit)):
        if (one.name, one.parameter) not in {("input-backlash", "width"), ("output-backlash", "width")}:
            continue
        share = 0.4 * one.shares["detect"]
        for _ in range(12):
            y = data.y_scale.of(with_planted(data, fit, one, share, rng))
            again = replace(data, y=y)
            refitted = fit_from(again, fit.hypothesis, fit.theta)
            rows = find_smallest_sizes(again, refitted, rms(again, refitted))
            told = next(row for row in rows if (row.name, row.parameter) == (one.name, one.parameter))
            tried += 1
            missed += told.shares["excluded_above"] < share
    assert tried == 24
    assert missed <= 4


def test_two_levels_show_no_static_curve_and_say_why():
    data, fit = record(u=np.repeat(np.tile([1.0, 2.0], 15), 20))
    rows = {one.name: one for one in find_smallest_sizes(data, fit, rms(data, fit))}
    for name in ("input-dead-zone", "input-backlash", "input-nonlinearity", "input-saturation"):
        assert rows[name].reason == "levels"
        assert rows[name].detect is rows[name].named is rows[name].excluded is None
    assert rows["input-delay"].detect is not None


def test_a_planned_input_that_hardly_moves_shows_less(plain, found):
    data, fit = plain
    slow = 3.0 + 0.5 * np.sin(2.0 * np.pi * np.arange(600) / 300.0)
    planned, simulated = planned_record(data, fit, slow)
    assert np.allclose(data.u_scale.back(planned.u), slow)
    assert np.abs(np.asarray(data.y_scale.back(simulated.output))[100:] - first_order(slow)[100:]).max() < 0.05
    rows = {(one.name, one.parameter): one for one in find_smallest_sizes(planned, simulated, rms(data, fit), False)}
    delay = rows["input-delay", "delay"]
    assert delay.named is None or delay.named > 2.0 * found["input-delay", "delay"].named
    assert all(one.excluded is None for one in rows.values())


def test_effects_that_do_not_fit_beside_the_tanks_found_are_not_those_of_a_closed_simulation():
    data, linear = record(samples=200)
    tanks = linear.hypothesis.plus(SqrtOutflow("lower"))
    theta = np.array([parameter.start for parameter in tanks.parameters])
    found = fit_from(data, tanks, theta)
    rows = find_smallest_sizes(data, found, rms(data, found))
    reasons = {one.name: one.reason for one in rows}
    assert reasons["cubic-stiffness"] == reasons["end-stop"] == "beside"
    assert "closed" not in reasons.values()


def test_effects_of_no_size_change_nothing_in_a_record_with_hardly_any_noise():
    """The simulation of a mass with friction or a stop differs from linear dynamics by more than their size then."""
    u = np.repeat(LEVELS, 20)[:600]
    y = lfilter([0.0, 0.02, 0.018], [1.0, -1.70, 0.738], u - u[0]) + 1e-5 * np.random.default_rng(4).normal(size=600)
    data = scaled(u, y, np.ones(600, bool), 0.1)
    fit = fit_baseline(data)
    refit = Refit.about(data, fit, rms(data, fit))
    planted = [one for one in plantations(data, fit) if one.form.plant.kind == "mechanics"]
    assert {one.effect.name for one in planted} >= {"coulomb-friction", "end-stop", "quadratic-drag"}
    for plantation in planted:
        for change in plantation.changes(1e-8):
            vector, _ = refit.left(change)
            assert vector @ vector < 0.01, plantation.effect.key


def test_beside_the_friction_of_a_motor_the_limits_of_other_effects_are_found():
    data, linear = record(samples=300)
    motor = linear.hypothesis.plus(CoulombFriction("speed"))
    found = fit_from(data, motor, np.array([parameter.start for parameter in motor.parameters]))
    names = {one.name for one in find_smallest_sizes(data, found, rms(data, found))}
    assert {"input-backlash", "input-nonlinearity"} <= names
    assert "coulomb-friction" not in names


@pytest.mark.slow
@pytest.mark.parametrize("seed", [1, 2, 3])
def test_friction_of_a_motor_that_hides_in_its_gain_and_pole_is_not_excluded(seed):
    """Substeps of 2 ms; the size is a third of what the report says is visible."""
    rng = np.random.default_rng(seed)
    u = np.repeat(rng.uniform(-1.2, 1.2, 60), 15)
    gain, time_constant, friction, step = 8.0, 0.4, 0.008, 0.002
    speed, y = 0.0, np.empty(u.size)
    for n, command in enumerate(u):
        y[n] = speed
        for _ in range(10):
            speed += step * (gain * command - speed) / time_constant
            most = step * gain * friction / time_constant
            speed -= float(np.clip(speed, -most, most))
    data = scaled(u, y + 0.06 * rng.standard_normal(u.size), np.ones(u.size, bool), 0.02)
    fit = fit_baseline(data)
    rows = {one.name: one for one in find_smallest_sizes(data, fit, rms(data, fit))}
    dry = rows["coulomb-friction"]
    assert dry.excluded is not None
    assert friction < dry.excluded < dry.detect


def test_a_form_that_is_hidden_does_not_hide_the_others():
    """Drag of a motor shows in its speed, and hardly if the output is taken for a position."""
    rng = np.random.default_rng(9126)
    t = 0.02 * np.arange(1000)
    u = sum(np.sin(2 * np.pi * f * t + rng.uniform(0, 6.28)) for f in np.linspace(0.1, 2.0, 15))
    u *= 0.5 / np.std(u)
    speed, y = 0.0, np.empty(u.size)
    for n, command in enumerate(u):
        y[n] = speed
        for _ in range(30):
            speed += 0.02 / 30 * (8.0 * command - speed - 0.02 * speed * abs(speed)) / 0.4
    run = Record(t, u, y + 0.02 * np.std(y) * rng.standard_normal(t.size), 0.02)
    found = find_limits(run)
    drag = next(row for row in found["limits"] if row["name"] == "quadratic-drag")
    assert (found["verdict"], drag["unit"], drag["why"]) == ("none", "u/y^2", None)
    assert 0.0 < drag["detect"] < 0.01
