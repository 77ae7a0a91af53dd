"""Diagnosis with a simulation of the user's own: a function, a file, a system of python-control."""

import json
import re
import runpy
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import control as ct
import numpy as np
import pytest
from gap_search import searched
from scipy.signal import cont2discrete, lfilter

from labsid._arrays import FloatArray
from labsid.cli.commands import main
from labsid.gap.diagnosis import Diagnosis, diagnose
from labsid.gap.reports.text_report import format_report
from labsid.gap.simulations.python_export import write_python_module
from labsid.records.record import Record

pytestmark = pytest.mark.usefixtures("without_limits")

SAMPLES, TS, FINE = 960, 0.1, 20
FEW = ("input-delay", "input-saturation", "extra-lag", "output-saturation", "load-step")
SOURCE = """
from functools import lru_cache
from scipy.signal import cont2discrete, lfilter

@lru_cache(maxsize=100)
def _sampled(tau, zeta, Ts):
    num, den, _ = cont2discrete(([1.0], [tau**2, 2 * zeta * tau, 1.0]), Ts)
    return num[0], den

def simulate(t, u, tau=1.0, zeta=0.7, gain=2.0, bias=0.0):
    num, den = _sampled(tau, zeta, t[1] - t[0])
    return gain * lfilter(num, den, u) + bias
"""
_namespace: dict[str, Callable[..., FloatArray]] = {}
exec(SOURCE, _namespace)
simulate = _namespace["simulate"]


@pytest.fixture(scope="module")
def u() -> FloatArray:
    return np.repeat(np.random.default_rng(3).uniform(-1.0, 1.0, SAMPLES // 24), 24)


def measured(u: FloatArray, **numbers: float) -> Record:
    """The rig on its driven signal, which may be given with `FINE` values for each sample."""
    every = u.size // SAMPLES
    t = TS / every * np.arange(u.size)
    y = simulate(t, u, **numbers)[::every]
    rng = np.random.default_rng(5)
    return Record(t[::every], u[::every], y + 0.01 * np.std(y) * rng.standard_normal(y.size), TS)


def named(report: dict) -> list[str]:
    return [effect["name"] for effect in report["effects"]]


@pytest.fixture(scope="module")
def right(u: FloatArray) -> Diagnosis:
    """The diagnosis of a simulation that is right."""
    with searched(*FEW):
        return diagnose(measured(u), simulate)


@pytest.fixture(scope="module")
def limited(u: FloatArray) -> Record:
    """A record of the rig whose actuator stops at -0.5 and 0.6."""
    record = measured(np.clip(u, -0.5, 0.6))
    return Record(record.t, u, record.y, TS)


def test_a_right_simulation_has_no_gap(right: Diagnosis) -> None:
    report = right.report
    assert report["verdict"] == "none"
    assert report["gap"]["before"] < 1.1 * report["gap"]["noise_floor"]


@searched(*FEW)
def test_a_rig_that_is_not_at_rest_at_the_start_is_no_gap(u: FloatArray) -> None:
    whole = measured(u)
    late = slice(100, None)
    assert diagnose(Record(whole.t[late], whole.u[late], whole.y[late], TS), simulate).report["verdict"] == "none"


@searched(*FEW)
def test_a_limit_of_the_actuator_is_found_around_the_simulation(limited: Record) -> None:
    report = diagnose(limited, simulate).report
    assert named(report) == ["input-saturation"]
    assert report["effects"][0]["parameters"]["high"]["value"] == pytest.approx(0.6, abs=0.01)
    assert report["gap"]["closed"] > 0.97


@searched(*FEW)
def test_a_lag_is_found_at_the_input_of_the_simulation(u: FloatArray) -> None:
    fine = np.repeat(u, FINE)
    keep = np.exp(-TS / FINE / 0.5)
    record = measured(lfilter([0.0, 1.0 - keep], [1.0, -keep], fine))
    report = diagnose(Record(record.t, u, record.y, TS), simulate).report
    assert named(report) == ["extra-lag"]
    assert report["effects"][0]["parameters"]["tau"]["value"] == pytest.approx(0.5, rel=0.03)


@searched("resonance", "slow-mode", "periodic-disturbance", *FEW)
def test_a_mode_is_found_beside_the_simulation(u: FloatArray) -> None:
    fine = np.repeat(u, FINE)
    step = TS / FINE
    num, den, _ = cont2discrete(([0.6 * 4.0**2], [1.0, 2 * 0.05 * 4.0, 4.0**2]), step)
    mode = lfilter(num[0], den, fine)[::FINE]
    record = measured(u)
    report = diagnose(Record(record.t, u, record.y + mode, TS), simulate).report
    assert named(report) == ["resonance"]
    found = report["effects"][0]["parameters"]
    assert found["frequency"]["value"] == pytest.approx(4.0 / (2 * np.pi), rel=0.01)
    assert found["damping"]["value"] == pytest.approx(0.05, abs=0.01)


@searched(*FEW)
def test_free_numbers_that_are_wrong_are_a_parameter_mismatch(u: FloatArray) -> None:
    report = diagnose(measured(u, tau=1.3, gain=2.4), simulate, free=["tau", "gain"]).report
    assert named(report) == ["parameter-mismatch"]
    fitted = report["effects"][0]["parameters"]
    assert {name: entry["nominal"] for name, entry in fitted.items()} == {"tau": 1.0, "gain": 2.0}
    for name, true in (("tau", 1.3), ("gain", 2.4)):
        assert abs(fitted[name]["value"] - true) < 4.0 * fitted[name]["stderr"] < 0.02


def with_rounded_output(t: FloatArray, u: FloatArray, tau: float = 1.0, gain: float = 2.0) -> FloatArray:
    return np.round(simulate(t, u, tau=tau, gain=gain), 2)


def with_rounded_numbers(t: FloatArray, u: FloatArray, tau: float = 1.0, gain: float = 2.0) -> FloatArray:
    return simulate(t, u, tau=round(tau, 1), gain=round(gain, 1))


@searched(*FEW)
@pytest.mark.parametrize(
    "rough", [pytest.param(with_rounded_output, marks=pytest.mark.exhaustive), with_rounded_numbers]
)
def test_numbers_of_a_simulation_that_has_no_derivatives_are_found(
    u: FloatArray, rough: Callable[..., FloatArray]
) -> None:
    report = diagnose(measured(u, tau=1.3, gain=2.4), rough, free=["tau", "gain"]).report
    assert named(report) == ["parameter-mismatch"]
    fitted = report["effects"][0]["parameters"]
    assert fitted["tau"]["value"] == pytest.approx(1.3, abs=0.051)
    assert fitted["gain"]["value"] == pytest.approx(2.4, abs=0.051)
    assert all(0.0 < entry["stderr"] < 0.1 for entry in fitted.values())
    assert report["gap"]["after"] < 1.1 * report["gap"]["noise_floor"]


@searched(*FEW)
def test_a_search_without_derivatives_leaves_runs_for_the_others(u: FloatArray) -> None:
    report = diagnose(
        measured(u, tau=1.3, gain=2.4), with_rounded_numbers, free=["tau", "gain"], evaluations=400
    ).report
    assert report["simulation"]["evaluations"]["spent"]
    assert named(report) == ["parameter-mismatch"]


@searched(*FEW)
def test_a_free_number_that_is_nominally_zero_can_be_fitted(u: FloatArray) -> None:
    report = diagnose(measured(u, zeta=0.9, bias=0.3), simulate, free=["zeta"]).report
    assert named(report) == ["parameter-mismatch"]  # an offset is none: it is estimated in any case
    assert report["effects"][0]["parameters"]["zeta"]["value"] == pytest.approx(0.9, abs=0.01)


@searched(*FEW)
def test_an_effect_is_found_beside_free_numbers(u: FloatArray) -> None:
    record = measured(np.clip(u, -0.5, 0.6), tau=1.3)
    report = diagnose(Record(record.t, u, record.y, TS), simulate, free=["tau", "gain"]).report
    assert named(report) == ["input-saturation"]
    assert report["gap"]["closed"] > 0.97
    assert {one["name"]: one["value"] for one in report["numbers"]}["tau"] == pytest.approx(1.3, rel=0.01)


@searched(*FEW)
def test_a_system_of_python_control_is_a_simulation(limited: Record) -> None:
    system = ct.tf([2.0], [1.0, 1.4, 1.0])
    assert named(diagnose(limited, system).report) == ["input-saturation"]


def test_free_numbers_that_nothing_has_are_refused(u: FloatArray) -> None:
    record = measured(u)
    with pytest.raises(ValueError, match="the fitted model has none by name"):
        diagnose(record, free=["tau"])
    with pytest.raises(ValueError, match="simulate has no number 'k' that could be free; it has tau, zeta, gain, bias"):
        diagnose(record, simulate, free=["k"])


class Runs:
    """A simulation that counts its runs; from the run `sound` on, it fails."""

    def __init__(self, sound: float = float("inf")) -> None:
        self.count, self.sound = 0, sound

    def __call__(self, t: FloatArray, u: FloatArray, tau: float = 1.0) -> FloatArray:
        self.count += 1
        if self.count > self.sound:
            raise RuntimeError("the solver diverged")
        return simulate(t, u, tau=tau)


@pytest.mark.parametrize("evaluations", [1, 12, 150])
@searched(*FEW)
def test_a_budget_ends_the_search_with_what_it_has_found(limited: Record, evaluations: int) -> None:
    runs, said = Runs(), []
    report = diagnose(limited, runs, evaluations=evaluations, progress=lambda what, share: said.append(what)).report
    counted = report["simulation"]["evaluations"]
    assert counted["spent"]
    assert counted["budget"] == evaluations
    assert counted["runs"] == runs.count - 1  # the first one checks the simulation, before the search
    assert runs.count < evaluations + 50
    assert f"the limit of {evaluations} runs of your simulation" in format_report(report).replace("\n           ", " ")
    if evaluations >= 150:
        assert named(report) == ["input-saturation"]
    assert any(re.fullmatch(r"one effect, \d+ simulations, \d+ % of the time", what) for what in said)


@searched(*FEW)
def test_a_budget_that_is_not_reached_changes_nothing(limited: Record) -> None:
    free, held = (diagnose(limited, Runs(), evaluations=most).report for most in (None, 50_000))
    assert free["simulation"]["evaluations"]["budget"] is None
    assert held["simulation"]["evaluations"]["spent"] is False
    assert held["limits"] == []  # they would cost runs of their own
    for report in (free, held):
        report["simulation"].pop("evaluations")
        report.pop("limits")
    assert free == held


def test_budgets_that_cannot_be_are_said(u: FloatArray) -> None:
    record = measured(u)
    with pytest.raises(ValueError, match="must be at least 1; got 0"):
        diagnose(record, simulate, evaluations=0)
    with pytest.raises(ValueError, match="got 5 evaluations, but no simulation that is run"):
        diagnose(record, evaluations=5)
    with pytest.raises(ValueError, match="got 5 evaluations, but no simulation that is run"):
        diagnose(record, record.y, evaluations=5)
    with pytest.raises(ValueError, match="2 evaluations are too few to fit the simulation"):
        diagnose([record, measured(u), measured(u)], simulate, evaluations=2)


@searched(*FEW)
def test_a_simulation_that_begins_to_fail_is_said(limited: Record) -> None:
    report = diagnose(limited, Runs(sound=100)).report
    runs = report["simulation"]["evaluations"]
    assert runs["failed"] == runs["runs"] - 99
    assert "of your simulation failed; the first: Runs stopped with RuntimeError: the solver diverged" in (
        format_report(report).replace("\n           ", " ")
    )
    with pytest.raises(ValueError, match="Runs stopped with RuntimeError: the solver diverged"):
        diagnose(limited, Runs(sound=1))  # in the first run all is well


@searched("input-saturation", "extra-lag")
def test_a_file_is_diagnosed_exported_played_and_then_has_no_gap(
    u: FloatArray, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("rig.py").write_text(SOURCE, encoding="utf-8")
    record = measured(np.clip(u, -0.5, 0.6), tau=1.3)
    rows = np.column_stack([record.t, u, record.y])
    np.savetxt("run.csv", rows, delimiter=",", header="t,u,y", comments="")
    command = ["gap", "diagnose", "run.csv"]
    budget = ["--evaluations", "600"]
    arguments = [*command, *budget, "--sim", "rig.py:simulate", "--free", "tau, gain", "--export", "better.json"]
    assert main(arguments) == 0
    said = capsys.readouterr().out
    assert "a limit of the actuator" in said
    assert "tau = 1.3" in said
    content = json.loads(Path("better.json").read_text(encoding="utf-8"))
    assert content["simulator"]["source"] == "rig.py:simulate"
    assert main(["gap", "simulate", "rig.py", "run.csv"]) == 0  # the function of that name
    assert "rmse" in capsys.readouterr().out
    assert main(["gap", "simulate", "better.json", "run.csv"]) == 0
    assert "rmse 0.00" in capsys.readouterr().out
    assert main([*command, *budget, "--sim", "better.json"]) == 0
    assert "There is no gap beyond noise" in capsys.readouterr().out
    Path("rig.py").write_text(SOURCE.replace("tau=1.0", "tau=1.1"), encoding="utf-8")
    assert main(["gap", "simulate", "better.json", "run.csv"]) == 2
    assert "rig.py:simulate has changed: tau is 1.1, and was 1" in capsys.readouterr().err
    assert main([*command, "--sim", "rig.py:simulate", "--json", "rig.py"]) == 2
    assert "rig.py is named twice" in capsys.readouterr().err
    for evaluations in ("0", "-1", "many"):
        assert main([*command, "--sim", "rig.py:simulate", "--evaluations", evaluations]) == 2
        assert "Invalid value for '--evaluations'" in capsys.readouterr().err
    assert main([*command, "--sim", "rig.py:missing"]) == 2
    assert "rig.py has no function 'missing'; it has simulate." in capsys.readouterr().err


@searched("input-saturation", "extra-lag")
def test_an_exported_module_runs_by_itself_and_as_a_simulation(
    limited: Record, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """With the function's file in another folder, also after both have moved."""
    here = tmp_path / "project"
    for folder in ("rigs", "out"):
        (here / folder).mkdir(parents=True)
    (here / "rigs" / "rig.py").write_text(SOURCE, encoding="utf-8")
    rows = np.column_stack([limited.t, limited.u, limited.y])
    np.savetxt(here / "run.csv", rows, delimiter=",", header="t,u,y", comments="")
    monkeypatch.chdir(here)
    command = ["gap", "diagnose", "run.csv", "--evaluations", "500", "--sim"]
    assert main([*command, "rigs/rig.py:simulate", "--export", "out/better.py"]) == 0
    assert '"source": "../rigs/rig.py:simulate"' in Path("out/better.py").read_text(encoding="utf-8")
    assert main([*command, "out/better.py:simulate"]) == 0
    assert "There is no gap beyond noise" in capsys.readouterr().out
    monkeypatch.chdir(tmp_path)
    moved = here.rename(tmp_path / "moved")
    code = "import sys, numpy as np; sys.path.insert(0, sys.argv[1]); import better; t = 0.1 * np.arange(1200)\n"
    code += "print(float(np.abs(better.simulate(t, np.full(1200, 1.0))).max()))"
    done = subprocess.run(
        [sys.executable, "-c", code, str(moved / "out")], cwd="/", capture_output=True, text=True, check=True
    )
    assert float(done.stdout) == pytest.approx(2.0 * 0.6, rel=0.1)  # the actuator goes no higher than 0.6, gain 2
    (moved / "rigs" / "rig.py").unlink()
    done = subprocess.run([sys.executable, "-c", code, str(moved / "out")], cwd="/", capture_output=True, text=True)
    assert "rig.py does not exist" in done.stderr


@searched(*FEW)
def test_a_model_without_a_file_of_its_own_is_exported_as_a_module_too(u: FloatArray, tmp_path: Path) -> None:
    found = diagnose(measured(u))
    write_python_module(tmp_path / "plain.py", found.model.to_json_dict())
    namespace = runpy.run_path(str(tmp_path / "plain.py"))
    record = measured(u)
    np.testing.assert_allclose(namespace["simulate"](record.t, record.u, record.y), found.model.simulate(u, record.y))


def test_a_function_that_is_no_file_is_diagnosed_and_not_exported(right: Diagnosis) -> None:
    with pytest.raises(ValueError, match=r"it is no file that can be run again"):
        right.model.to_json_dict()


def dragged(t: FloatArray, u: FloatArray) -> FloatArray:
    """Speed of a mass with quadratic drag, which no offset of its input leaves as it is."""
    speed, found = 0.5, np.empty(t.size)
    for k in range(t.size):
        found[k] = speed
        for _ in range(4):
            speed += TS / 4 * (u[k] - 2.0 * speed * abs(speed) - 0.3 * speed)
    return found


@searched("input-dead-zone", "input-saturation", "output-nonlinearity")
def test_a_dead_zone_is_one_about_zero_where_the_mean_of_the_input_is_not() -> None:
    rng = np.random.default_rng(5)
    t, u = TS * np.arange(600), np.repeat(rng.uniform(-1.0, 3.0, 30), 20)
    y = dragged(t, np.maximum(u - 0.5, 0.0) + np.minimum(u + 0.3, 0.0))
    noise = 0.01 * np.std(y) * rng.standard_normal(t.size)
    (cause,) = diagnose(Record(t, u, y + noise, TS), dragged).report["effects"]
    assert cause["name"] == "input-dead-zone"
    ends = [cause["parameters"][side]["value"] for side in ("low", "high")]
    np.testing.assert_allclose(ends, [-0.3, 0.5], atol=0.01)
    right = diagnose(Record(t, u, dragged(t, u) + noise, TS), dragged).report
    assert (right["verdict"], right["screen"]) == ("none", [])  # neither a gap nor a level that is another one
