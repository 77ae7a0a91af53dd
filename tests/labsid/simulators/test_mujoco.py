"""The MuJoCo model that the README of labsid.gap shows: its motion, and rigs in MuJoCo with an effect that it lacks."""

import json
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("mujoco", reason="pip install 'labsid[mujoco]'")

from gap_search import searched
from mujoco_rigs import EFFECTS, NOISE, SAMPLES, TS, Effect, angles, example, load_example, measured, torques
from scipy.signal import cont2discrete, lfilter

from labsid.cli.commands import main

T = TS * np.arange(SAMPLES)
SHORT = 400  # samples of a record that is diagnosed


def test_the_model_moves_as_an_arm_on_a_spring() -> None:
    model = load_example()
    length, radius, mass = 0.3, 0.02, 0.8  # of the capsule, about one end: a cylinder and two half balls
    cylinder = length / (length + 4.0 / 3.0 * radius)
    ball = 1.0 - cylinder
    inertia = cylinder * (length**2 / 12 + radius**2 / 4) + ball * (
        0.4 * radius**2 + (length / 2) ** 2 + 0.375 * length * radius
    )
    inertia = mass * (inertia + (length / 2) ** 2)
    u = torques(1)
    num, den, _ = cont2discrete(([1.0], [inertia, 0.15, 2.0]), TS)
    exact = lfilter(num[0], den, u)
    assert np.std(model.simulate(T, u) - exact) < 0.03 * np.std(exact)  # its steps are of 2.5 ms
    np.testing.assert_allclose(model.simulate(T, u), angles(model, u, Effect("none")), atol=1e-9)
    held = model.simulate(T, u, frictionloss=0.08)
    np.testing.assert_allclose(model.simulate(T, u, frictionloss=0.0), model.simulate(T, u))  # nothing is kept
    assert np.std(held - model.simulate(T, u)) > 0.05 * np.std(held)


@pytest.mark.slow
@searched("input-saturation", "extra-lag", "resonance", "coulomb-friction", "cubic-stiffness", "load-step")
def test_friction_that_the_model_lacks_is_named_and_closed_on_a_second_record(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As a force around the model, and as a number of it."""
    monkeypatch.chdir(tmp_path)
    Path("arm.py").write_text(example(), encoding="utf-8")
    y = np.zeros(0)
    for name, seed in (("run", 1), ("other", 2)):
        u = torques(seed)[:SHORT]
        y = angles(load_example(), u, EFFECTS["friction"])
        rows = np.column_stack([T[:SHORT], u, measured(y, seed)])
        np.savetxt(f"{name}.csv", rows, delimiter=",", header="t,u,y", comments="")
    command = ["gap", "diagnose", "run.csv", "--sim", "arm.py:simulate", "--json", "report.json"]
    for more, cause, number in (
        (["--evaluations", "800"], "coulomb-friction", "friction"),
        (["--evaluations", "200", "--free", "frictionloss"], "parameter-mismatch", "frictionloss"),
    ):
        assert main([*command, *more, "--export", "better.json"]) == 0
        (effect,) = json.loads(Path("report.json").read_text(encoding="utf-8"))["effects"]
        assert effect["name"] == cause
        assert effect["parameters"][number]["value"] == pytest.approx(0.08, rel=0.05)
        assert main(["gap", "simulate", "better.json", "other.csv", "--out", "played.csv"]) == 0
        played = np.genfromtxt("played.csv", delimiter=",", names=True)["y_sim"]
        assert np.std(played - y) < np.sqrt(1.1**2 - 1.0) * NOISE * np.std(y)  # with the noise, 1.1 times the noise
