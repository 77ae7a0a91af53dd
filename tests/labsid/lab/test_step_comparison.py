"""The plant of Fig. A2 beside its first-order approximation."""

import control
import numpy as np
import pytest

from labsid.lab.step_comparison import compare_with_approximation, second_order_example, second_order_response


def test_the_example_plant_is_the_documented_one_and_its_response_exact():
    plant = second_order_example()
    np.testing.assert_array_equal(plant.num, [3])
    np.testing.assert_array_equal(plant.den, [5, 6, 1])
    t = np.linspace(0, 40, 200)
    oracle = control.forced_response(control.tf(plant.num, plant.den), t, np.full(200, 2.0)).outputs
    np.testing.assert_allclose(second_order_response(plant, t, 2.0), oracle, atol=1e-9)
    np.testing.assert_array_equal(second_order_response(plant, [-1, 0], 2.0), [0, 0])


def test_the_approximation_is_close_as_fig_a2_shows():
    comparison = compare_with_approximation(second_order_example(), np.linspace(0, 40, 801), 2.0)
    assert comparison.fit.status == "settled"
    assert pytest.approx(3, rel=0.01) == comparison.fit.model.K
    assert 5 < comparison.fit.model.tau < 6
    assert 0.5 < comparison.fit.model.td < 1
    assert comparison.largest_error < 0.05
    assert comparison.mse < 2e-3
    np.testing.assert_allclose(
        np.max(np.abs(comparison.y_original - comparison.y_approximate)), 6 * comparison.largest_error
    )
