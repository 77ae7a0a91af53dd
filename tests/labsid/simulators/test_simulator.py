"""Functions, files and systems as simulations: what they are called with, and what is said of those that fail."""

import textwrap
from pathlib import Path

import control as ct
import numpy as np
import pytest
from scipy.signal import lfilter

from labsid.simulators.control_systems import is_control_system, read_control_system
from labsid.simulators.process import open_in_process
from labsid.simulators.simulator import Simulator, SimulatorError, function_simulator

T = 0.1 * np.arange(200)
U = np.sign(np.sin(0.7 * T))

RIG = """
import os
from math import sqrt
import beside

def simulate(t, u, gain=2, pole=0.9, quiet=True, name="rig"):
    print("simulating")
    return beside.play(u, gain, pole)

def bare(t, u):
    return u

def forever(t, u):
    while True:
        pass

def stops(t, u, k=0.0):
    return u / k if k else sqrt(-1)

def leaves(t, u):
    os._exit(3)

def alone(t):
    return t
"""
BESIDE = """
from scipy.signal import lfilter

def play(u, gain, pole):
    return lfilter([0, gain * (1 - pole)], [1, -pole], u)
"""


@pytest.fixture(scope="module")
def rig(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("rig")
    (folder / "beside.py").write_text(BESIDE, encoding="utf-8")
    path = folder / "rig.py"
    path.write_text(textwrap.dedent(RIG), encoding="utf-8")
    return path


def test_a_function_in_a_file_runs_in_its_own_process_with_the_numbers_that_are_asked_for(rig: Path) -> None:
    simulate = open_in_process(f"{rig}:simulate")
    assert simulate.nominal == {"gain": 2.0, "pole": 0.9}  # neither a switch nor a text
    np.testing.assert_allclose(simulate(T, U), lfilter([0, 0.2], [1, -0.9], U))
    np.testing.assert_allclose(simulate(T, U, {"gain": 3.0}), lfilter([0, 0.3], [1, -0.9], U))
    assert simulate.with_free(["pole", "pole"]).free == ("pole",)
    ranged = simulate.with_free(["gain = 0:5", "pole"])
    assert (ranged.free, ranged.ranges) == (("gain", "pole"), {"gain": (0.0, 5.0)})
    with pytest.raises(ValueError, match=r"rig.py:simulate has no number 'tau' .* it has gain, pole"):
        simulate.with_free(["tau"])
    for text, words in (
        ("gain=0", "must be LOW:HIGH with LOW < HIGH; got '0'. Write gain=0:5"),
        ("gain=5:0", "got '5:0'"),
        ("gain=0:inf", "got '0:inf'"),
        ("gain=:", "got ':'"),
        ("gain=3:5", "3 to 5, must contain its nominal value 2"),
    ):
        with pytest.raises(ValueError, match=words):
            simulate.with_free([text])


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("stops", r"rig.py:stops stopped with ValueError: math domain error \(rig.py, line 18\)"),
        ("leaves", "rig.py:leaves has ended its process"),
        ("forever", "rig.py:forever takes more than 1 s to simulate 200 samples"),
    ],
)
def test_a_simulation_that_fails_costs_one_line(rig: Path, name: str, said: str) -> None:
    simulate = open_in_process(f"{rig}:{name}", 30.0)
    if name == "forever":
        simulate.run._seconds = 1.0  # type: ignore[attr-defined]
    with pytest.raises(SimulatorError, match=said) as raised:
        simulate(T, U)
    assert raised.value.ended == (name != "stops")
    if name == "stops":
        np.testing.assert_array_equal(simulate(T, U, {"k": 2.0}), U / 2.0)  # it can go on


@pytest.mark.parametrize(
    ("source", "said"),
    [
        ("{rig}:other", "has no function 'other'; it has simulate, bare, forever, stops, leaves, alone"),
        ("{rig}:alone", r"cannot be called as alone\(t, u\)"),
        ("{folder}/no.py:simulate", "no.py does not exist"),
        ("{folder}/broken.py:simulate", r"broken.py stopped with SyntaxError when it was imported"),
    ],
)
def test_a_source_that_cannot_be_opened_is_said_in_one_line(rig: Path, source: str, said: str) -> None:
    (rig.parent / "broken.py").write_text("def simulate(:\n", encoding="utf-8")
    with pytest.raises(ValueError, match=said):
        open_in_process(source.format(rig=rig, folder=rig.parent))


def test_a_function_with_the_input_first_is_refused() -> None:
    """It would take the times for the input, and run."""
    with pytest.raises(ValueError, match=r"rig takes \(u, Ts\), .* Write it as rig\(t, u\)"):
        function_simulator(lambda u, Ts, gain=1.0: gain * u, "rig")
    for right in (lambda t, u: u, lambda time, voltage, u=1.0: voltage, lambda x, t: x, lambda *signals: signals[1]):
        np.testing.assert_array_equal(function_simulator(right)(T, U), U if right(0, 1) == 1 else T)


@pytest.mark.parametrize(
    ("returned", "said"),
    [
        (None, "returns nothing"),
        ((x for x in U), "returns a generator"),
        (U[:-1], "returns 199 numbers for 200 samples"),
        (np.where(T < 1.0, U, np.nan), "returns numbers that are not finite; the first is sample 10"),
        ({"y": U}, "returns a dict that is not numbers"),
        (1j * U, "returns complex numbers; it must return the output, 200 real numbers"),
    ],
)
def test_what_is_no_output_is_refused(returned: object, said: str) -> None:
    def simulate(t: object, u: object) -> object:
        return returned

    with pytest.raises(SimulatorError, match=f"^simulate {said}"):
        function_simulator(simulate)(T, U)


def test_columns_and_lists_are_outputs() -> None:
    for shape in (lambda u: u[:, None], lambda u: u[None, :], list):
        np.testing.assert_array_equal(function_simulator(lambda t, u, shape=shape: shape(u))(T, U), U)


def test_a_linear_system_becomes_its_sampled_transfer_function() -> None:
    for system in (ct.tf([2.0], [3.0, 1.0, 1.0]), ct.ss(ct.tf([2.0], [3.0, 1.0, 1.0])), ct.tf([0.1], [1, -0.9], 0.1)):
        model = read_control_system(system, 0.1)
        assert isinstance(model, dict)
        played = ct.forced_response(ct.tf(model["num"], model["den"], 0.1), T, U).outputs
        held = ct.c2d(system, 0.1) if system.isctime() else system
        np.testing.assert_allclose(played, ct.forced_response(held, T, U).outputs, atol=1e-9)


def test_the_input_of_a_continuous_nonlinear_system_is_held() -> None:
    system = ct.NonlinearIOSystem(
        lambda t, x, u, p: [x[1], (p["gain"] * u[0] - x[0] - x[1]) / 3.0],
        lambda t, x, u, p: x[0],
        states=2, inputs=1, outputs=1, params={"gain": 2.0},
    )  # fmt: skip
    assert is_control_system(system)
    simulate = read_control_system(system, 0.1)
    assert isinstance(simulate, Simulator)
    assert simulate.nominal == {"gain": 2.0}
    held = ct.c2d(ct.tf([2.0], [3.0, 1.0, 1.0]), 0.1)
    np.testing.assert_allclose(simulate(T, U), ct.forced_response(held, T, U).outputs, atol=1e-4)
    np.testing.assert_allclose(simulate(5.0 + T, U, {"gain": 4.0}), 2.0 * simulate(T, U), atol=1e-3)


def test_systems_that_do_not_fit_are_refused() -> None:
    with pytest.raises(ValueError, match=r"2 inputs and 1 outputs, expected one of each"):
        read_control_system(ct.rss(2, 1, 2), 0.1)
    with pytest.raises(ValueError, match=r"dt = 0.2 s, the record 0.1 s"):
        read_control_system(ct.tf([1], [1, -0.5], 0.2), 0.1)
    assert not is_control_system(np.zeros(3))
