"""Simulated outputs: identified to their digits where a linear model made them, resampled where their times differ."""

import numpy as np
import pytest
from gap_search import searched
from scipy.signal import cont2discrete, lfilter

from labsid.gap.diagnosis import diagnose
from labsid.gap.simulations.simulated_output import identify_output, resample
from labsid.gap.simulations.simulation_files import load_simulation
from labsid.records.record import Record, load_record

pytestmark = pytest.mark.usefixtures("without_limits")

FEW = ("input-delay", "input-saturation", "input-nonlinearity", "extra-lag", "output-saturation", "output-nonlinearity")

Ts = 0.1
STEPS = np.repeat(np.random.default_rng(5).uniform(-1.0, 1.5, 60), 20)
PRINTED = ("%.17g", "%.10g", "%.6g", "%.3f")
RIGS = {
    "gain": ([2.0], [1.0], 0),
    "lag": ([1.0], [1.0, 1.0], 1),
    "oscillator": ([1.0], [1.0, 0.4, 4.0], 2),
    "two lags": ([1.0], [1.0, 0.5, 0.05], 2),
    "motor": ([1.0], [1.0, 1.0, 0.0], 2),
    "lead": ([1.0, 1.0], [0.2, 1.0], 1),
    "washout": ([1.0, 0.0], [1.0, 1.0], 1),
}


def discrete(name):
    num, den, order = RIGS[name]
    b, a, _ = cont2discrete((num, den), Ts) if order else (num, den, 0)
    return np.ravel(b), np.ravel(a), order


def printed(y, form):
    return np.array([float(form % value) for value in y])


@pytest.mark.parametrize("form", PRINTED)
@pytest.mark.parametrize("late", [0, 7])
@pytest.mark.parametrize("name", RIGS)
def test_a_linear_simulation_is_identified_to_its_digits(name, late, form):
    b, a, order = discrete(name)
    past = np.zeros(late)  # the simulation starts at rest, not at the first input
    y = lfilter(b, a, np.concatenate([past, STEPS])[: STEPS.size]) + 4.0
    model = identify_output(STEPS, printed(y, form), Ts)
    assert model is not None
    assert model.error * np.std(y) < {"%.17g": 1e-9, "%.10g": 3e-9, "%.6g": 1e-4, "%.3f": 5e-4}[form]
    if form != "%.3f":
        samples = late + (name not in ("gain", "lead", "washout"))  # before the output responds
        assert (model.order, model.dead_time) == (order, max(samples - 1, 0))
    step = model.function.response(np.repeat([0.0, 1.0], 300)) - model.function.response(np.zeros(600))
    true = lfilter(b, a, np.concatenate([past, np.repeat([0.0, 1.0], 300)])[:600])
    np.testing.assert_allclose(step[300:], true[300:], atol=0.02 * np.abs(true).max())


def test_the_level_is_that_of_the_input_of_an_integrator_and_of_the_output_of_a_washout():
    for name, level in (("motor", "u0"), ("washout", "y0")):
        b, a, _ = discrete(name)
        offset = 0.3 if level == "u0" else 0.0
        model = identify_output(STEPS, lfilter(b, a, STEPS - offset) + 2.0 * (level == "y0"), Ts)
        assert getattr(model.function, level) == pytest.approx(0.3 if level == "u0" else 2.0, rel=1e-4)


@pytest.mark.parametrize(
    "output",
    [
        pytest.param(lambda y: np.minimum(y, 0.7), id="a clip"),
        pytest.param(lambda y: y + 0.05 * y**2, id="a curve"),
        pytest.param(lambda y: y + 0.01 * np.random.default_rng(1).standard_normal(y.size), id="noise"),
        pytest.param(lambda y: np.full(y.size, 3.0), id="a constant"),
    ],
)
def test_what_no_linear_model_reproduces_has_none(output):
    b, a, _ = discrete("lag")
    assert identify_output(STEPS, output(lfilter(b, a, STEPS)), Ts) is None


def test_small_errors_of_a_solver_are_stated():
    b, a, _ = discrete("oscillator")
    y = lfilter(b, a, STEPS)
    rough = y + 3e-4 * np.std(y) * np.sin(np.arange(y.size) ** 1.5)
    model = identify_output(STEPS, rough, Ts)
    assert model is not None
    assert 5e-5 < model.error < 1e-3


def test_a_model_of_a_long_record_reproduces_all_of_it():
    """It is identified from a part: a limit that acts elsewhere shows."""
    b, a, _ = discrete("lag")
    u = np.concatenate([2.0 * STEPS, *[STEPS] * 6])
    assert identify_output(u, lfilter(b, a, u), Ts).error < 1e-9
    late = u + 0.5 * (np.arange(u.size) > 6000)
    assert identify_output(u, lfilter(b, a, late), Ts) is None


# Other times ----------------------------------------------------------------------------------------------


def test_a_smooth_output_is_interpolated_by_a_spline_and_one_with_jumps_linearly():
    t, at = np.linspace(0.0, 20.0, 401), np.linspace(0.0, 20.0, 201) * 0.999
    smooth = resample(t, np.sin(t), at)
    assert smooth.resampled == "by a cubic spline"
    np.testing.assert_allclose(smooth.y, np.sin(at), atol=1e-6)
    jumps = resample(t, np.sign(np.sin(t)), at)
    assert jumps.resampled == "linearly"
    assert np.abs(jumps.y).max() == pytest.approx(1.0)
    few = resample(t[:3], t[:3], t[:3])
    np.testing.assert_allclose(few.y, t[:3])


def test_an_output_on_a_finer_grid_is_opened_and_said_to_be_resampled(tmp_path):
    b, a, _ = discrete("oscillator")
    record = Record(Ts * np.arange(STEPS.size), STEPS, lfilter(b, a, STEPS), Ts)
    fine, den, _ = cont2discrete(RIGS["oscillator"][:2], Ts / 4)
    y = lfilter(np.ravel(fine), den, np.repeat(STEPS, 4))
    path = tmp_path / "sim.csv"
    rows = zip((Ts / 4 * np.arange(y.size)).tolist(), y.tolist(), strict=True)
    path.write_text("t,y\n" + "".join(f"{t!r},{value!r}\n" for t, value in rows))
    output = load_simulation(path, record)
    assert output.resampled
    model = identify_output(record.u, output.y, Ts)
    assert model is not None
    assert model.order == 2


# The records of `shared/data/found` -----------------------------------------------------------------------


@searched(*FEW)
def test_the_limit_of_the_actuator_is_found_from_a_simulated_output(shared_data):
    path = shared_data / "found" / "simulated-output-limit.csv"
    record = load_record(path)
    found = diagnose(record, load_simulation(path.with_suffix(".sim.csv"), record))
    (effect,) = found.report["effects"]
    assert (effect["name"], found.report["verdict"]) == ("input-saturation", "effect")
    assert effect["parameters"]["low"]["value"] == pytest.approx(-0.5, abs=0.005)
    assert effect["parameters"]["high"]["value"] == pytest.approx(0.55, abs=0.005)
    assert found.report["simulation"]["output"]["model"]["order"] == 2
    assert found.model.to_json_dict()["effects"] == ["input-saturation/both"]


@searched(*FEW)
def test_the_right_simulated_output_leaves_no_gap(shared_data):
    path = shared_data / "found" / "simulated-output-none.csv"
    record = load_record(path)
    assert diagnose(record, load_simulation(path.with_suffix(".sim.csv"), record)).report["verdict"] == "none"
