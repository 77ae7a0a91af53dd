"""The simulation under test: transfer functions with python-control's conventions, and the other kinds accepted."""

import control
import numpy as np
import pytest
from gap_search import searched
from scipy.signal import lfilter

from labsid.gap.diagnosis import diagnose
from labsid.gap.record.data import scaled
from labsid.gap.simulations.baseline import as_simulation, check_bounded, linear_structure, make_baseline
from labsid.gap.simulations.model_json import read_transfer_function
from labsid.gap.simulations.simulated_output import SimulatedOutput
from labsid.records.record import Record
from labsid.simulators.simulator import function_simulator

pytestmark = pytest.mark.usefixtures("without_limits")

DEN = np.poly([0.95, 0.8]).tolist()
TRUE = {"num": [0.01, 0.0], "den": DEN, "dt": 0.5}


@pytest.fixture(scope="module")
def record(rig_record):
    return rig_record("none", 300)


@pytest.fixture(scope="module")
def data(record):
    return scaled(record.u, record.y, np.ones(len(record), bool), record.Ts)


@pytest.fixture(scope="module")
def true(record):
    """The rig's transfer function about the first sample of the record."""
    return TRUE | {"u0": float(record.u[0]), "y0": float(record.u[0])}


def left(data, fit):
    return float(np.sqrt(np.mean((data.y - fit.output) ** 2)))


# MODEL.json -----------------------------------------------------------------------------------------------


@pytest.mark.parametrize("num", [[0.3, 0.1], [0.0, 0.0, 0.3, 0.1], [0.2, 0.3, 0.1], [0.4]])
def test_powers_of_z_descend_as_in_python_control(num, levels):
    model = read_transfer_function({"num": num, "den": [2.0, -1.9, 0.5], "dt": 0.5, "u0": 0.7, "y0": -3.0}, 0.5)
    system = control.tf(num, [2.0, -1.9, 0.5], 0.5)
    expected = control.forced_response(system, inputs=levels - 0.7).outputs - 3.0
    np.testing.assert_allclose(model.response(levels), expected, atol=1e-10)


def test_the_initial_state_is_estimated_from_the_measured_output(levels):
    model = read_transfer_function(TRUE, 0.5)
    measured = model.response(levels) + 2.0 * 0.95 ** np.arange(levels.size) - 0.8 ** np.arange(levels.size)
    np.testing.assert_allclose(model.simulate(levels, measured), measured, atol=1e-9)
    static = read_transfer_function({"num": 3.0, "den": 2.0, "dt": 0.5}, 0.5)
    np.testing.assert_allclose(static.simulate(levels, levels), 1.5 * levels)


@pytest.mark.parametrize(
    ("changed", "words"),
    [
        ({"num": None}, "num and den must be lists of"),
        ({"num": []}, "lists of finite numbers"),
        ({"den": [[1.0, 0.5]]}, "lists of finite numbers"),
        ({"num": [10**400]}, "lists of numbers in descending powers of z"),
        ({"num": ["a"]}, "lists of numbers in descending powers of z"),
        ({"num": [1.0, np.inf]}, "lists of finite numbers"),
        ({"u0": "x"}, "lists of numbers in descending powers of z; dt, u0 and y0 must be numbers"),
        ({"den": [0.0, 1.0]}, "den must begin with the highest power of z"),
        ({"num": [1.0, 0.0, 0.0, 0.0]}, "num has degree 3, den 2: the model must be proper"),
        ({"dt": 0.25}, r"the record's sampling time 0\.5 s; got 0\.25 s"),
    ],
)
def test_models_that_are_none(changed, words):
    with pytest.raises(ValueError, match=words):
        read_transfer_function(TRUE | changed, 0.5)


@pytest.mark.parametrize("key", ["num", "den", "dt"])
def test_keys_that_are_needed(key):
    with pytest.raises(ValueError, match=f"the model has no '{key}'"):
        read_transfer_function({name: value for name, value in TRUE.items() if name != key}, 0.5)


# Every kind of simulation ---------------------------------------------------------------------------------


def test_every_kind_of_the_true_simulation_leaves_the_noise(data, record, true):
    function = read_transfer_function(true, 0.5)
    kinds = {
        "model": true,
        "series": SimulatedOutput(function.response(record.u) + 5.0),  # an offset is nuisance
        "callable": function_simulator(lambda t, u: function.response(u)[:, None]),
    }
    for name, simulation in kinds.items():
        base = make_baseline(data, record.t, simulation)
        assert base.given, name
        assert left(data, base.before(data)) == pytest.approx(0.01, rel=0.2), name
        assert not base.output_only, name
        assert base.simulate_record is not None, name
        assert (base.model is not None) == (name == "series")


def test_a_wrong_simulation_is_taken_as_it_is(data, record, true):
    base = make_baseline(data, record.t, true | {"num": [0.02, 0.0]})
    assert left(data, base.before(data)) > 0.3


def test_a_given_simulation_plays_on_another_record(data, record, true, rig_record):
    other = rig_record("none", 200, seed=9)
    function = read_transfer_function(true, 0.5)
    series = SimulatedOutput(function.response(record.u))
    for simulation in (true, function_simulator(lambda t, u: function.response(u)), series):
        simulate_record = make_baseline(data, record.t, simulation).simulate_record
        error = (other.y - simulate_record(other))[120:]  # only a model's initial state can be estimated
        assert np.std(error) < 0.03 * np.std(other.y)


def test_a_simulated_output_that_no_linear_model_reproduces_stays_closed(data, record, true):
    output = read_transfer_function(true, 0.5).response(record.u)
    for closed in (np.minimum(output, np.median(output)), np.zeros(len(record))):
        base = make_baseline(data, record.t, SimulatedOutput(closed))
        assert (base.model, base.output_only, base.simulate_record) == (None, True, None)


def test_a_dead_time_of_the_simulation_is_no_finding(record, true):
    """Of a model and of a simulated output: the rig has it, too."""
    late = true | {"den": [*true["den"], 0.0, 0.0, 0.0, 0.0]}
    function = read_transfer_function(late, 0.5)
    y = function.response(record.u) + 0.01 * np.random.default_rng(3).standard_normal(len(record))
    data = scaled(record.u, y, np.ones(len(record), bool), record.Ts)
    for simulation in (late, SimulatedOutput(function.response(record.u))):
        base = make_baseline(data, record.t, simulation)
        assert base.structure.names == ()
        assert base.start is not None
        assert base.start[base.structure.slices["input-delay"]] == pytest.approx(4.0, abs=0.5)


def test_the_poles_for_loads_are_those_of_the_simulation(record, true):
    """A load step would make those of a linear model of the record slower or faster."""
    y = record.y + np.where(np.arange(len(record)) > 120, 0.8, 0.0)
    data = scaled(record.u, y, np.ones(len(record), bool), record.Ts)
    simulator = function_simulator(lambda t, u: read_transfer_function(true, record.Ts).response(u))
    c, k = make_baseline(data, record.t, simulator).structure.plant.simulation.rates
    np.testing.assert_allclose(np.exp(np.roots([1.0, c, k])), [0.8, 0.95], rtol=1e-3)


def test_without_one_it_is_the_labs_structure(data, record):
    base = make_baseline(data, record.t, None)
    assert base.before is None
    assert (base.given, base.output_only, base.simulate_record) == (False, False, None)
    assert base.structure.parameters == linear_structure(2).parameters


@pytest.mark.parametrize(
    ("order", "names"), [(1, ()), (2, ()), (3, ("log_lag",)), (4, ("log_frequency", "log_damping"))]
)
def test_orders(order, names):
    structure = linear_structure(order)
    assert tuple(parameter.name for parameter in structure.parameters) == ("delay", "log_c", "log_k", *names)
    assert structure.names == ()  # its poles are no finding


@pytest.mark.parametrize(
    ("simulation", "order", "words"),
    [
        (None, 0, "--order must be at least 1; got 0"),
        (None, 5, "--order must be at most 4; got 5"),
        (SimulatedOutput(np.zeros(10)), 2, "must have the record's 300 samples; got 10"),
        (SimulatedOutput(np.full(300, np.nan)), 2, "the simulation is unstable on this record"),
        (function_simulator(lambda t, u: u[:-1], "rig"), 2, "rig returns 299 numbers for 300 samples"),
        (TRUE | {"den": [1.0, -2.5, 1.0]}, 2, "the simulation is unstable on this record"),
    ],
)
def test_simulations_that_do_not_fit(data, record, simulation, order, words):
    with pytest.raises(ValueError, match=words):
        make_baseline(data, record.t, simulation, order)


def test_bounded():
    measured = np.array([1.0, 3.0])
    np.testing.assert_array_equal(check_bounded(np.array([2e6, 0.0]), measured), [2e6, 0.0])
    with pytest.raises(ValueError, match="its output diverges"):
        check_bounded(np.array([2e6, 3e6]), measured)


@pytest.mark.parametrize("value", [0.0, 3.3])
def test_a_simulated_output_that_never_moves_is_refused(value):
    with pytest.raises(ValueError, match=f"the simulated output is {value:.4g} throughout"):
        as_simulation(SimulatedOutput(np.full(300, value)), 0.1, ())


FIRST_ORDER = {"num": [0.0, 0.04], "den": [1.0, -0.95], "dt": 0.1}  # .8 / (1.95 s + 1)


@pytest.mark.parametrize(
    ("poles", "cause"), [((0.95, 0.8), "extra-lag"), ((0.93,), "parameter-mismatch"), ((0.95,), None)]
)
@searched("input-delay", "extra-lag", "slow-mode", "parameter-mismatch", "output-drift")
def test_a_pole_that_a_simulation_of_first_order_lacks_is_no_mismatch(poles, cause):
    """The faster one is further: the other is that of the simulation."""
    rng = np.random.default_rng(3)
    u = np.repeat(rng.uniform(0.0, 10.0, 45), 20)
    den = np.poly(poles)
    y = lfilter([0.0, 0.8 * den.sum()], den, u)
    y = y + 0.01 * np.std(y) * rng.standard_normal(u.size)
    report = diagnose(Record(0.1 * np.arange(u.size), u, y, 0.1), FIRST_ORDER).report
    assert [one["name"] for one in report["effects"]] == ([cause] if cause else [])
    if cause == "extra-lag":
        assert report["effects"][0]["parameters"]["tau"]["value"] == pytest.approx(-0.1 / np.log(0.8), rel=0.1)


@searched("output-drift", "load-step")
def test_a_simulated_output_at_another_level_is_shifted_and_that_is_said():
    rng = np.random.default_rng(6)
    u = np.repeat(rng.uniform(0.0, 10.0, 45), 20)
    simulated = lfilter([0.0, 0.04], [1.0, -0.95], u)
    y = simulated + 3.0 + 0.02 * rng.standard_normal(u.size)
    run = Record(0.1 * np.arange(u.size), u, y, 0.1)
    report = diagnose(run, simulated).report
    assert report["verdict"] == "none"
    (said,) = [text for text in report["screen"] if "shifted" in text]
    assert said.startswith("The output of your simulation is on average 3.00 below that of the record")
    level = diagnose(Record(run.t, u, y - 3.0, 0.1), simulated).report
    assert not [text for text in level["screen"] if "shifted" in text]
