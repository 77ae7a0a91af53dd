"""Every other form of an effect: of an effect of the table, visible, absent at strength 0, stated in the truth."""

import numpy as np
import pytest

from labsid.blind.output_error import discrete_poles, fit_linear
from labsid.rig.switchable.effects import EFFECTS, effect_context, supports_effect
from labsid.rig.switchable.inputs import draw_input
from labsid.rig.switchable.plants import RIGS, Scales, draw_rig, time_scale
from labsid.rig.switchable.simulation import Noise, poles, simulate_setup
from labsid.rig.switchable.truth import true_parameters
from labsid.rig.switchable.variants import VARIANTS, draw_variant

EXTRA = {
    "friction, another value each way": {"friction_back"},
    "friction, break-away peak": {"break_away", "speed"},
    "friction, smooth about rest": {"speed"},
    "dead zone, with a jump": {"jump"},
    "sensor, absolute value": {"fold"},
}


@pytest.mark.parametrize("name", VARIANTS)
def test_a_form_is_visible_and_vanishes_at_strength_zero(name: str) -> None:
    assert VARIANTS[name] in EFFECTS
    for seed in range(3):
        rng = np.random.default_rng(seed)
        rigs = [
            rig for rig in RIGS if supports_effect(draw_rig(np.random.default_rng(0), 1500, (rig,)), VARIANTS[name])
        ]
        setup = draw_rig(rng, 1500, tuple(rigs))
        v = draw_input(rng, "levels", 1500, time_scale(setup), from_rest=True)
        apply = draw_variant(rng, name, effect_context(setup, v))
        assert apply(setup, 0.0) == setup
        runs = [simulate_setup(apply(setup, s), v, Noise(0.0)).clean for s in (0.05, 0.9)]
        left = [fit_linear(v, y, discrete_poles(poles(setup.motion))).rmse for y in runs]
        assert left[1] > max(left[0], 0.02 * np.std(runs[1]))


@pytest.mark.parametrize("name", VARIANTS)
def test_the_truth_states_what_the_form_adds(name: str) -> None:
    rng = np.random.default_rng(1)
    setup = draw_rig(rng, 1500, ("motor, speed",))
    v = draw_input(rng, "levels", 1500, time_scale(setup), from_rest=True)
    with_effect = draw_variant(rng, name, effect_context(setup, v))(setup, 0.6)
    one, big, flipped = (
        true_parameters(VARIANTS[name], with_effect, Scales(1.0, 0.0, 1000.0**power, 0.0, ys), 1500)
        for power, ys in ((0, 1.0), (1, 1000.0), (0, -1.0))
    )
    assert EXTRA[name] <= set(one)
    for key, value in one.items():
        assert big[key] == pytest.approx(value if key == "jump" else 1000.0 * value), key
    if name == "friction, another value each way":
        assert (flipped["friction"], flipped["friction_back"]) == (one["friction_back"], one["friction"])


def test_an_unknown_form_is_refused() -> None:
    setup = draw_rig(np.random.default_rng(0), 1500, ("motor, speed",))
    context = effect_context(setup, np.ones(50))
    with pytest.raises(ValueError, match="name must be a form of an effect; got 'gremlin'"):
        draw_variant(np.random.default_rng(0), "gremlin", context)
