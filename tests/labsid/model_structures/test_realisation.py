"""Transfer function, difference equation, state space: python-control agrees, responses coincide."""

import control
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from labsid.lab.arx import ArxModel, canonical_form
from labsid.model_structures.prediction import free_run
from labsid.model_structures.realisation import (
    controllable_form,
    input_ss,
    input_tf,
    model_from_transfer_function,
    noise_tf,
    transfer_function,
)
from labsid.model_structures.structures import PolynomialModel

MODELS = [
    PolynomialModel([1, -1.2, 0.5], [0.3, -0.4, 0.7], [1, 0.2], delay=3, Ts=0.5),
    PolynomialModel([1, -0.6, 0.1], [2.0], [1], delay=1),
    PolynomialModel([1, -0.6], [2.0, 1.0], [1, 0.5, 0.2], delay=0),
    PolynomialModel([1], [1.0, 0.5, 0.25], [1], delay=1),
]


def test_sustech_example_1_by_hand():
    # (z^2 + b)/(z^3 + a z) = (z^-1 + b z^-3)/(1 + a z^-2), here with a = 0.5, b = 0.7.
    model = model_from_transfer_function([1, 0, 0.7], [1, 0, 0.5, 0])
    assert (model.a.tolist(), model.b.tolist(), model.delay) == ([1, 0, 0.5, 0], [1, 0, 0.7], 1)
    # y(k) + a y(k-2) = u(k-1) + b u(k-3)
    u = np.random.default_rng(0).standard_normal(12)
    y = free_run(model, u)
    for k in range(3, 12):
        assert y[k] + 0.5 * y[k - 2] == pytest.approx(u[k - 1] + 0.7 * u[k - 3])


def test_sustech_example_2_has_a_direct_path():
    # (z - 1)/(z - 0.9) = 1 - 0.1/(z - 0.9)
    G, H, C, D = controllable_form([1, -1], [1, -0.9])
    assert (G.item(), H.item(), C.item(), D.item()) == (0.9, 1, pytest.approx(-0.1), 1)


def test_leading_zeros_and_factors_do_not_matter():
    model = model_from_transfer_function([0, 0, 4], [0, 2, -1])
    assert (model.a.tolist(), model.b.tolist(), model.delay) == ([1, -0.5], [2], 1)


@pytest.mark.parametrize("model", MODELS)
def test_python_control_answers_as_the_difference_equation_does(model):
    u = np.random.default_rng(1).standard_normal(40)
    y = free_run(model, u)
    for system in (input_tf(model), input_ss(model)):
        response = control.forced_response(system, inputs=u)
        np.testing.assert_allclose(response.outputs, y, atol=1e-10)
        assert system.dt == model.Ts
    noise = control.forced_response(noise_tf(model), inputs=u).outputs
    np.testing.assert_allclose(noise, free_run(model, np.zeros(40), u), atol=1e-10)


@pytest.mark.parametrize("model", MODELS)
def test_there_and_back(model):
    back = model_from_transfer_function(*transfer_function(model), Ts=model.Ts)
    u = np.random.default_rng(2).standard_normal(30)
    np.testing.assert_allclose(free_run(back, u), free_run(model, u), atol=1e-10)
    assert back.delay == model.delay


@given(st.lists(st.floats(-3, 3), min_size=1, max_size=4), st.lists(st.floats(-3, 3), min_size=1, max_size=3))
@settings(max_examples=60, deadline=None)
def test_the_state_space_has_the_transfer_function(num, den):
    num, den = num[: len(den) + 1], [2.0, *den]
    G, H, C, D = controllable_form(num, den)
    for z in (4.0, 3j, -2.5 + 4j):
        through_states = (C @ np.linalg.solve(z * np.eye(len(den) - 1) - G, H) + D).item()
        assert through_states == pytest.approx(np.polyval(num, z) / np.polyval(den, z), rel=1e-9, abs=1e-12)


def test_without_a_direct_path_it_is_the_labs_canonical_form():
    lab = canonical_form(ArxModel([1, -1.3, 0.4], [0.2, 0.1], 1.0))
    for ours, labs in zip(controllable_form([0.2, 0.1], [1, -1.3, 0.4]), lab, strict=True):
        np.testing.assert_array_equal(ours, labs)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: model_from_transfer_function([1, 0, 0], [1, 0]), "no higher degree than den; got degrees 2 and 1"),
        (lambda: model_from_transfer_function([1], [0, 0]), "den must not be zero"),
        (lambda: model_from_transfer_function([0], [1, 0]), "num must not be zero"),
        (lambda: controllable_form([1], [2]), "den must be of degree 1 or more; got a constant"),
        (lambda: input_tf(PolynomialModel([1, 0.5], [], [1])), "the model must have an input"),
    ],
)
def test_what_is_no_system(call, message):
    with pytest.raises(ValueError, match=message):
        call()
