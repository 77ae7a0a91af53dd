"""The transfer function of a plant: its response is that of the columns of the plant."""

import numpy as np
import pytest
from scipy.signal import lfilter

from labsid.gap.dynamics.linear_part import denominator_of, numerator_of
from labsid.gap.dynamics.plants import Plant

SPAN = 400


@pytest.mark.parametrize(
    ("more", "values"),
    [
        ({"zero": True}, {}),
        ({"zero": False}, {}),
        ({"zero": True, "lag": "behind"}, {"log_lag": 1.2}),
        ({"zero": True, "mode": "behind"}, {"log_frequency": -0.7, "log_damping": -2.0}),
        ({"zero": True, "slow": True}, {"log_slow": 4.0}),
        ({"zero": True, "feedthrough": True}, {}),
    ],
)
@pytest.mark.parametrize("rates", [(-0.7, -3.0), (-3.0, -2.5)])
def test_the_response_is_that_of_the_plant(more, values, rates):
    plant = Plant(**more)
    values = {"log_c": rates[0], "log_k": rates[1], **values}
    theta = np.array([values[parameter.name] for parameter in plant.parameters])
    w = np.repeat(np.random.default_rng(0).standard_normal(SPAN // 4), 4)
    columns = plant.columns(theta, w, SPAN, reference=0.0) - plant.columns(theta, 0.0 * w, SPAN, reference=0.0)
    gains = np.random.default_rng(1).standard_normal(columns.shape[1])
    den, num = denominator_of(plant, theta, SPAN), numerator_of(plant, theta, gains, SPAN)
    assert den.size == num.size - 1 == plant.n_poles + 1
    assert num[-1] == 0.0
    expected = columns @ gains
    np.testing.assert_allclose(lfilter(num, den, w), expected, atol=1e-7 * np.abs(expected).max())


def test_a_part_of_a_sample_is_a_zero_of_its_own():
    plant = Plant(zero=True)
    theta, gains = np.array([-0.7, -3.0]), np.array([1.0, 0.5, 0.0, 0.0, 0.0])
    w = np.random.default_rng(0).standard_normal(SPAN)
    w[0] = 0.0
    columns = plant.columns(theta, w, SPAN, reference=0.0, late=0.3) - plant.columns(
        theta, 0.0 * w, SPAN, reference=0.0
    )
    num = numerator_of(plant, theta, gains, SPAN, 0.3)
    np.testing.assert_allclose(lfilter(num, denominator_of(plant, theta, SPAN), w), columns @ gains, atol=1e-9)


def test_the_poles_of_tanks_are_those_about_the_mean_level():
    plant = Plant(kind="tanks")
    theta = np.zeros(len(plant.parameters))
    theta[:2] = np.log([0.1, 0.02])
    assert np.sort(np.roots(denominator_of(plant, theta, SPAN))) == pytest.approx(np.exp([-0.1, -0.02]))
