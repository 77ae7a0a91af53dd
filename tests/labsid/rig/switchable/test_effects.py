"""Every effect of the table, and those outside it: visible, adjustable, absent at strength 0."""

import numpy as np
import pytest

from labsid.blind.output_error import discrete_poles, fit_linear
from labsid.rig.switchable.effects import EFFECTS, FAMILIES, draw_effect, effect_context, supports_effect
from labsid.rig.switchable.inputs import draw_input
from labsid.rig.switchable.plants import RIGS, Scales, draw_rig, draw_scales, time_scale
from labsid.rig.switchable.simulation import Noise, poles, simulate_setup
from labsid.rig.switchable.truth import true_parameters
from labsid.rig.switchable.unlisted import UNLISTED_EFFECTS, draw_unlisted_effect, supports_unlisted_effect

GAP_TABLE = {
    *("input-delay", "input-saturation", "input-dead-zone", "input-backlash", "input-rate-limit"),
    *("input-nonlinearity", "extra-lag", "resonance", "sqrt-outflow", "overflow", "coulomb-friction"),
    *("cubic-stiffness", "parameter-drift", "output-drift", "output-saturation", "output-nonlinearity"),
    *("output-quantization", "output-outliers", "output-dropout", "load-step", "periodic-disturbance"),
    *("coloured-noise", "end-stop", "quadratic-drag", "slow-mode", "output-backlash"),
}
QUIET = Noise(0.0)


def on_some_rig(seed: int, allowed, samples: int = 1500):
    rng = np.random.default_rng(seed)
    rigs = tuple(rig for rig in RIGS if allowed(draw_rig(np.random.default_rng(0), samples, (rig,))))
    setup = draw_rig(rng, samples, rigs)
    v = draw_input(rng, "levels", samples, time_scale(setup), from_rest=True)
    return rng, setup, effect_context(setup, v)


def test_the_table_is_complete() -> None:
    assert {*EFFECTS, *FAMILIES} == GAP_TABLE
    assert not set(EFFECTS) & set(FAMILIES)


@pytest.mark.parametrize("effect", [*EFFECTS, *FAMILIES])
def test_an_effect_vanishes_at_strength_zero_and_grows_with_strength(effect: str) -> None:
    for seed in range(3):
        # beside the zero of a near sensor a lag may cancel: there a longer one need not show more
        rng, setup, at = on_some_rig(seed, lambda s: supports_effect(s, effect) and s.rig != "heater, near sensor")
        apply = draw_effect(rng, effect, at)
        assert apply(setup, 0.0) == setup
        left = [
            fit_linear(
                at.v, simulate_setup(apply(setup, s), at.v, QUIET).clean, discrete_poles(poles(setup.motion))
            ).rmse
            for s in (0.02, 0.2, 0.9)
        ]
        spread = np.std(at.y)
        assert left[0] < 0.15 * spread
        assert left[1] > left[0]
        assert left[2] > (0.002 if effect == "extra-lag" else 0.02) * spread


@pytest.mark.parametrize("effect", UNLISTED_EFFECTS)
def test_an_effect_outside_the_table_is_visible(effect: str) -> None:
    for seed in range(3):
        rng, setup, at = on_some_rig(seed, lambda s: supports_unlisted_effect(s, effect))
        apply = draw_unlisted_effect(rng, effect, at)
        assert apply(setup, 0.0).motion == setup.motion
        left = [
            fit_linear(
                at.v, simulate_setup(apply(setup, s), at.v, QUIET).clean, discrete_poles(poles(setup.motion))
            ).rmse
            for s in (0.1, 0.9)
        ]
        assert left[1] > max(left[0], 0.02 * np.std(at.y))


def test_there_are_at_least_six_families_outside_the_table() -> None:
    assert len(set(UNLISTED_EFFECTS) - GAP_TABLE) >= 6


@pytest.mark.parametrize("effect", [*EFFECTS, *FAMILIES])
def test_parameters_scale_with_the_units_of_the_record(effect: str) -> None:
    rng, setup, at = on_some_rig(5, lambda s: supports_effect(s, effect))
    entered = draw_effect(rng, effect, at)(setup, 0.5)
    one = true_parameters(effect, entered, Scales(Ts=1.0, u0=0.0, us=1.0, y0=0.0, ys=1.0), 1500)
    big = true_parameters(effect, entered, Scales(Ts=0.1, u0=0.0, us=1000.0, y0=0.0, ys=1000.0), 1500)
    powers = {
        **dict.fromkeys(("low", "high", "width", "friction", "level", "step", "zero", "size", "amplitude"), 1000.0),
        **{"delay": 0.1, "tau": 0.1, "onset": 0.1, "rate": 10_000.0, "frequency": 10.0},
        **{"c2": 1e-3, "c3": 1e-6, "cubic": 1e-6},
        "drag": 1e-3 if setup.rig == "motor, speed" else 1e-5,  # of a speed in y, or in y per second
    }
    for name, value in one.items():
        if isinstance(value, float):
            assert big[name] == pytest.approx(value * powers.get(name, 1.0)), name


def test_a_sign_flip_swaps_the_limits() -> None:
    rng, setup, at = on_some_rig(2, lambda s: supports_effect(s, "output-saturation"))
    for _ in range(20):
        entered = draw_effect(rng, "output-saturation", at)(setup, 0.5)
        there = true_parameters("output-saturation", entered, Scales(1.0, 0.0, 1.0, 0.0, 2.0), 1500)
        back = true_parameters("output-saturation", entered, Scales(1.0, 0.0, 1.0, 0.0, -2.0), 1500)
        assert sorted(there.values()) == sorted(-value for value in back.values())
        assert {"low": "high", "high": "low"}[next(iter(there))] in back


def test_the_rest_position_is_between_the_end_stops() -> None:
    for seed in range(20):
        rng, setup, at = on_some_rig(seed, lambda s: supports_effect(s, "end-stop"))
        motion = draw_effect(rng, "end-stop", at)(setup, 1.0).motion
        assert motion.stop_low < 0.0 < motion.stop_high
        assert motion.stop_low > at.y.min() or motion.stop_high < at.y.max()


def test_a_slow_mode_is_slower_than_the_rig_and_faster_than_the_record() -> None:
    for seed in range(20):
        rng, setup, at = on_some_rig(seed, lambda s: True)
        motion = draw_effect(rng, "slow-mode", at)(setup, 1.0).motion
        longest = 375.001  # a quarter of 1500 samples
        assert min(6.0 * at.time, 374.999) <= motion.slow_time <= longest
        assert abs(motion.slow_share) == pytest.approx(0.6)


def test_names_outside_the_table_and_impossible_rigs_are_refused() -> None:
    rng, setup, at = on_some_rig(0, lambda s: s.rig == "motor, speed")
    with pytest.raises(ValueError, match="name must be an effect of the table; got 'gremlin'"):
        draw_effect(rng, "gremlin", at)
    with pytest.raises(ValueError, match="a motor, speed cannot have overflow"):
        draw_effect(rng, "overflow", at)
    with pytest.raises(ValueError, match="a motor, speed cannot have end-stop"):
        draw_effect(rng, "end-stop", at)
    with pytest.raises(ValueError, match="name must be an effect outside the table"):
        draw_unlisted_effect(rng, "overflow", at)
    with pytest.raises(ValueError, match="name must be an effect of the table"):
        true_parameters("gremlin", setup, draw_scales(rng), 100)
    _, _, mass = on_some_rig(0, lambda s: s.rig == "mass on a spring")
    with pytest.raises(ValueError, match="a mass on a spring cannot have switching-pole"):
        draw_unlisted_effect(rng, "switching-pole", mass)
