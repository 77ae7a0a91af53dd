"""Fig. 3 run, and the block diagram of the optional Simulink run."""

import control
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from labsid.lab.arx import ArxModel
from labsid.lab.diagrams import (
    PIController,
    model_as_process,
    offset_compensated_diagram,
    offset_compensated_loop,
    pi_by_cancellation,
    run_on_process,
    simulate_diagram,
    simulation_diagram,
)
from labsid.lab.identification import identify
from labsid.lab.simulation import simulate
from labsid.records.record import load_record

MODEL = ArxModel([1, -1.377, 0.392], [-0.0067, 0.0514], 0.75, u_offset=2.0, y_offset=2.33)
REFERENCE = np.where(np.arange(400) < 150, 0.3, -0.2)


def test_pi_by_hand():
    # Pole e^(-0.75/30), gain 2: Kp = 30 / (2 * 10), Ki = Kp / 30.
    pole = np.exp(-0.75 / 30)
    controller = pi_by_cancellation(ArxModel([1, -pole], [2 * (1 - pole)], 0.75), 10.0)
    assert controller.Kp == pytest.approx(1.5)
    assert controller.Ki == pytest.approx(0.05)
    assert controller.Ts == 0.75


def test_the_loop_follows_the_set_point_about_the_operating_point():
    run = offset_compensated_loop(MODEL, pi_by_cancellation(MODEL, 10.0), REFERENCE)
    assert run.y_m[0] == 2.33  # the process rests at its operating point
    assert run.y[149] == pytest.approx(0.3, abs=1e-3)
    assert run.y[-1] == pytest.approx(-0.2, abs=1e-3)
    np.testing.assert_allclose(run.y, run.y_m - 2.33, atol=1e-12)
    np.testing.assert_allclose(run.u_in, run.u + 2.0, atol=1e-12)
    assert run.u[-1] == pytest.approx(-0.2 / MODEL.static_gain, abs=1e-3)
    np.testing.assert_array_equal(run.t, 0.75 * np.arange(400))


def test_at_rest_nothing_moves():
    run = offset_compensated_loop(MODEL, pi_by_cancellation(MODEL, 10.0), np.zeros(50))
    np.testing.assert_allclose(run.y_m, 2.33, atol=1e-12)
    np.testing.assert_allclose(run.u_in, 2.0, atol=1e-12)


def test_python_control_and_the_loop_sample_by_sample_agree():
    controller = pi_by_cancellation(MODEL, 10.0)
    diagram = offset_compensated_loop(MODEL, controller, REFERENCE)
    by_hand = run_on_process(model_as_process(MODEL), 2.33, controller, REFERENCE, 2.0, 2.33)
    for name in ("t", "reference", "y_m", "y", "u", "u_in"):
        np.testing.assert_allclose(getattr(by_hand, name), getattr(diagram, name), atol=1e-10)


def test_the_closed_loop_is_the_textbook_one():
    """Oracle: the transfer function of the feedback loop, without any offset."""
    controller = PIController(0.7, 0.03, 0.75)
    C = control.tf([0.7, 0.03 * 0.75 - 0.7], [1, -1], 0.75)  # Kp + Ki Ts / (z - 1)
    G = control.tf(MODEL.b, MODEL.a, 0.75)
    oracle = control.forced_response(control.feedback(C * G), inputs=REFERENCE).outputs
    np.testing.assert_allclose(offset_compensated_loop(MODEL, controller, REFERENCE).y, oracle, atol=1e-9)


def test_without_compensation_a_proportional_controller_is_off():
    """What Fig. 3 is for: leave the offsets out and the same controller holds another level."""
    controller = PIController(2.0, 0.0, 0.75)
    zero = np.zeros(400)
    compensated = run_on_process(model_as_process(MODEL), 2.33, controller, zero, 2.0, 2.33)
    bare = run_on_process(model_as_process(MODEL), 2.33, controller, zero + 2.33, 0.0, 0.0)
    np.testing.assert_allclose(compensated.y_m, 2.33, atol=1e-12)
    assert abs(bare.y_m[-1] - 2.33) > 0.5


def test_a_process_that_is_not_the_model_is_controlled_too():
    level = 2.33

    def tank(u_in):  # square-root outflow, at rest at 2.0 V and 2.33 V
        nonlocal level
        level += 0.06 * (u_in - 2.0) - 0.06 * (np.sqrt(level / 2.33) - 1)
        return level

    run = run_on_process(tank, level, pi_by_cancellation(MODEL, 20.0), REFERENCE, 2.0, 2.33)
    assert run.y[149] == pytest.approx(0.3, abs=0.02)
    assert run.y[-1] == pytest.approx(-0.2, abs=0.02)


def test_the_diagrams_carry_the_names_of_fig_3():
    diagram = offset_compensated_diagram(MODEL, PIController(1.0, 0.1, 0.75))
    assert diagram.input_labels == ["reference", "u_offset", "y_offset", "process_u0", "process_y0"]
    assert diagram.output_labels == ["y_m", "y", "u", "u_in"]
    assert simulation_diagram(MODEL).input_labels == ["u_in", "process_u0", "process_y0"]


@given(
    st.lists(st.floats(-0.95, 0.95), min_size=1, max_size=3),
    st.integers(0, 1000),
    st.floats(-3, 3),
    st.floats(-3, 3),
)
@settings(max_examples=20, deadline=None)
def test_the_block_diagram_equals_the_simulation(poles, seed, u_offset, y_offset):
    rng = np.random.default_rng(seed)
    model = ArxModel(np.poly(poles), rng.uniform(-1, 1, len(poles)), 0.5, u_offset, y_offset)
    u_act = rng.standard_normal(40)
    expected = simulate(model, u_act - u_offset) + y_offset
    np.testing.assert_allclose(simulate_diagram(model, u_act), expected, atol=1e-9)


def test_the_block_diagram_equals_the_simulation_on_the_lab_file(shared_data):
    result = identify(load_record(shared_data / "unsw-water-tank" / "SysIdenData_StudentVersion.mat"))
    y_act = simulate_diagram(result.model, result.record.u)
    np.testing.assert_allclose(y_act - result.offsets.y_offset, result.verification.y_all, atol=1e-9)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: pi_by_cancellation(MODEL, 0.0), "closed_loop_tau must be a positive number of seconds; got 0"),
        (
            lambda: pi_by_cancellation(ArxModel([1, -1.5, 0.7], [1, 0], 1.0), 5.0),
            "must have a real slowest pole between 0 and 1 and a gain; got pole 0.75-0.37",
        ),
        (lambda: pi_by_cancellation(ArxModel([1, -1], [1], 1.0), 5.0), r"got pole 1\+0j and gain inf"),
        (lambda: pi_by_cancellation(ArxModel([1, -0.5], [0], 1.0), 5.0), "and gain 0. Choose the controller"),
        (
            lambda: offset_compensated_loop(MODEL, PIController(1, 1, 0.5), REFERENCE),
            "controller and model must have one sampling time; got 0.5 s and 0.75 s",
        ),
        (
            lambda: offset_compensated_loop(MODEL, PIController(1, 1, 0.75), [1.0]),
            "reference must have at least 2 samples; got 1",
        ),
        (lambda: simulate_diagram(MODEL, [1.0]), "u_act must have at least 2 samples; got 1"),
    ],
)
def test_arguments_that_do_not_fit(call, message):
    with pytest.raises(ValueError, match=message):
        call()
