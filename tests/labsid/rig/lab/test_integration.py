"""The bench: drives, the integrator against exact solutions, chains, and every error."""

from dataclasses import replace

import numpy as np
import pytest

from labsid.rig.lab.integration import Drive, Rig, integrate, simulate_rig, zero_order_hold

TAU = 2.0
INF = float("inf")


def lag(t, x, v):
    return ((v - x[0]) / TAU,)


def one_lag(**changes):
    rig = Rig(
        derivative=lag,
        output=lambda x: x[:, 0],
        state_names=("the level",),
        lowest=(-INF,),
        highest=(10.0,),
    )
    return replace(rig, **changes)


def exact_lag(t, edges, values, x0):
    """Response of the lag to a staircase, written with exponentials only."""
    x = x0 * np.exp(-t / TAU)
    previous = 0.0
    for edge, value in zip(edges, values, strict=True):
        x = x + (value - previous) * np.where(t > edge, 1 - np.exp(-(t - edge) / TAU), 0.0)
        previous = value
    return x


def delay(seconds):
    """A block that a later rig might use: edges that fall between samples."""
    return lambda drive: Drive(np.append(drive.times[:1], drive.times[1:] + seconds), drive.values)


def test_a_drive_holds_each_value_until_the_next_begins():
    drive = zero_order_hold([1.0, 2.0, 3.0], Ts=0.5)
    assert drive.at([-1.0, 0.0, 0.49, 0.5, 0.99, 1.0, 50.0]).tolist() == [1, 1, 1, 2, 2, 3, 3]


def test_a_drive_is_read_only():
    drive = zero_order_hold([1.0, 2.0], Ts=0.5)
    with pytest.raises(ValueError, match="read-only"):
        drive.values[0] = 5.0


def test_a_lag_on_a_staircase_follows_its_exact_response():
    u = np.repeat([1.0, -0.5, 2.0], 20)
    result = simulate_rig(one_lag(), u, Ts=0.75, x0=(0.3,))
    exact = exact_lag(result.t, [0.0, 15.0, 30.0], [1.0, -0.5, 2.0], 0.3)
    np.testing.assert_allclose(result.y, exact, atol=1e-7)


def test_sample_k_is_taken_before_input_k_acts():
    result = simulate_rig(one_lag(), [0.0, 0.0, 1.0, 1.0], Ts=0.75, x0=(0.0,))
    assert result.y[2] == 0.0
    assert result.y[3] == pytest.approx(1 - np.exp(-0.75 / TAU), abs=1e-7)


def test_halving_the_step_divides_the_error_by_sixteen():
    u = np.repeat([1.0, 0.0], 8)
    exact = exact_lag(0.75 * np.arange(16), [0.0, 6.0], [1.0, 0.0], 0.0)
    errors = [
        np.abs(simulate_rig(one_lag(), u, 0.75, (0.0,), max_step=step).y - exact).max() for step in (0.375, 0.1875)
    ]
    assert errors[0] / errors[1] == pytest.approx(16, rel=0.1)


def test_an_edge_between_samples_does_not_cost_accuracy():
    u = np.repeat([0.0, 1.0], 10)
    result = simulate_rig(one_lag(actuator=(delay(0.31),)), u, Ts=0.75, x0=(0.0,))
    exact = exact_lag(result.t, [0.0, 7.5 + 0.31], [0.0, 1.0], 0.0)
    np.testing.assert_allclose(result.y, exact, atol=1e-7)
    np.testing.assert_array_equal(result.u, u)


def test_an_edge_nearer_to_a_sample_than_rounding_is_harmless():
    times = np.array([0.0, np.nextafter(0.75, 1.0)])
    states = integrate(lag, (0.0,), Drive(times, np.array([0.0, 1.0])), [0.0, 0.75, 1.5], 0.1, (-INF,))
    assert states.shape == (3, 1)
    assert states[:, 0] == pytest.approx([0.0, 0.0, 1 - np.exp(-0.75 / TAU)], abs=1e-7)


def test_the_work_grows_linearly_with_the_record():
    def calls(samples):
        count = 0

        def counted(t, x, v):
            nonlocal count
            count += 1
            return lag(t, x, v)

        simulate_rig(one_lag(derivative=counted), np.ones(samples), 0.75, (0.0,))
        return count

    assert calls(11) == 10 * 8 * 4  # ten intervals of eight steps of four stages
    assert calls(101) == 10 * calls(11)


def test_the_derivative_receives_the_time():
    drive = zero_order_hold(np.zeros(5), Ts=0.5)
    states = integrate(lambda t, x, v: (3 * t**2,), (0.0,), drive, drive.times, max_step=0.5, lowest=(0.0,))
    assert states[:, 0] == pytest.approx(drive.times**3)


def test_blocks_act_in_the_order_of_the_chains():
    def scale(drive):
        return Drive(drive.times, 2 * drive.values)

    def shift(drive):
        return Drive(drive.times, drive.values + 1)

    rig = one_lag(actuator=(scale, shift), sensor=(lambda t, y: 10 * y, lambda t, y: y + t))
    result = simulate_rig(rig, [1.0, 1.0], Ts=0.75, x0=(3.0,))  # 2 * 1 + 1 = 3: it rests there
    assert result.y.tolist() == [30.0, 30.75]
    assert result.states.tolist() == [[3.0], [3.0]]
    assert result.u.tolist() == [1.0, 1.0]


def test_a_state_stops_at_its_lowest_and_leaves_it_again():
    rig = one_lag(derivative=lambda t, x, v: (v,), lowest=(0.0,))
    result = simulate_rig(rig, np.repeat([-1.0, 1.0], 4), Ts=0.5, x0=(1.0,))
    assert result.y == pytest.approx([1, 0.5, 0, 0, 0, 0.5, 1, 1.5])


def test_a_state_beyond_the_physics_is_refused():
    with pytest.raises(ValueError, match=r"the level must stay below 10; got 1\d\.\d+ at t = 3 s\. Lower"):
        simulate_rig(one_lag(), np.full(9, 14.0), Ts=0.75, x0=(0.0,))


def test_a_state_that_is_not_a_number_is_refused():
    with pytest.raises(ValueError, match=r"the level must stay below 10; got nan at t = 0\.75 s"):
        simulate_rig(one_lag(derivative=lambda t, x, v: (float("nan"),)), [0.0, 0.0], Ts=0.75, x0=(0.0,))


def test_a_start_of_another_order_is_refused():
    with pytest.raises(ValueError, match=r"x0 must hold 1 states \(the level\); got 2"):
        simulate_rig(one_lag(), [0.0, 0.0], Ts=0.75, x0=(0.0, 0.0))


@pytest.mark.parametrize("Ts", [0.0, -0.75, float("nan")])
def test_a_sampling_time_must_be_positive(Ts):
    with pytest.raises(ValueError, match="Ts must be a positive time in seconds; got"):
        simulate_rig(one_lag(), [0.0, 0.0], Ts=Ts, x0=(0.0,))


@pytest.mark.parametrize("max_step", [0.0, -0.1, float("nan")])
def test_a_step_must_be_positive(max_step):
    with pytest.raises(ValueError, match="max_step must be a positive time in seconds; got"):
        simulate_rig(one_lag(), [0.0, 0.0], Ts=0.75, x0=(0.0,), max_step=max_step)


def test_an_input_with_a_gap_is_refused():
    with pytest.raises(ValueError, match="u must be finite; got nan at sample 1"):
        simulate_rig(one_lag(), [0.0, float("nan")], Ts=0.75, x0=(0.0,))
