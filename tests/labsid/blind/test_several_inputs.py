"""The best linear model of several inputs, against models whose numbers are known."""

import control
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from labsid.blind.output_error import fit_linear
from labsid.blind.several_inputs import linear_error


def signals(seed: int, n: int = 600) -> np.ndarray:
    rng = np.random.default_rng(seed)
    return np.column_stack([np.repeat(rng.uniform(-1, 1, n // 20), 20) for _ in range(2)])


def response(poles: list[complex], u: np.ndarray, seed: int) -> np.ndarray:
    """Output of a system of two inputs with these poles and numerators of full degree."""
    rng = np.random.default_rng(seed)
    a = np.real(np.poly(poles))
    y = np.zeros(u.shape[0])
    for one in u.T:
        G = control.tf(rng.uniform(0.2, 1.0, len(poles)), a, 1.0)
        y += control.forced_response(G, U=one).outputs
    return y


@pytest.mark.parametrize("poles", [[0.9, 0.7], [0.9 + 0.2j, 0.9 - 0.2j, 0.8], [0.95, 0.9, 0.8, 0.5], [0.9]])
def test_a_system_of_its_order_is_found_exactly_from_other_poles(poles: list[complex]) -> None:
    u = signals(1)
    y = response([complex(p) for p in poles], u, 2)
    start = [complex(0.97 * p) for p in poles]
    assert linear_error(u, y, start) < 1e-4 * np.std(y)


@settings(deadline=None, max_examples=20)
@given(offset=st.floats(-10.0, 10.0), scale=st.floats(0.01, 100.0))
def test_an_offset_changes_nothing_and_a_scale_scales(offset: float, scale: float) -> None:
    u = signals(3)
    y = np.tanh(response([0.9, 0.8], u, 4))
    poles = [0.9 + 0j, 0.8 + 0j]
    assert linear_error(u, offset + scale * y, poles) == pytest.approx(scale * linear_error(u, y, poles), rel=1e-3)


def test_with_one_input_it_is_the_error_of_the_model_of_one_input() -> None:
    u = signals(5)
    y = np.tanh(3 * response([0.9, 0.8], u[:, :1], 6))
    poles = [0.9 + 0j, 0.8 + 0j]
    assert linear_error(u[:, :1], y, poles) == pytest.approx(fit_linear(u[:, 0], y, poles).rmse, rel=1e-3)


def test_a_delay_is_reproduced_by_numerator_coefficients_for_it() -> None:
    u = signals(7)
    late = np.vstack([np.repeat(u[:1], 3, axis=0), u[:-3]])
    y = response([0.9, 0.8], late, 8)
    poles = [0.9 + 0j, 0.8 + 0j]
    assert linear_error(u, y, poles) > 0.005 * np.std(y)
    assert linear_error(u, y, poles, delay=3) < 1e-4 * np.std(y)
