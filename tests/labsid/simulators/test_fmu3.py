"""Co-simulation FMUs of FMI 3.0, compiled here: the exact output of their equations, and what is said of others."""

import json
from pathlib import Path

import numpy as np
import pytest
from fmu_rigs import build_oscillator, compiler
from gap_search import searched
from scipy.signal import cont2discrete, lfilter

from labsid._arrays import FloatArray
from labsid.cli.commands import main
from labsid.simulators.process import open_in_process
from labsid.simulators.simulator import one_of_each

pytest.importorskip("fmpy", reason="pip install 'labsid[fmu]'")
pytestmark = pytest.mark.skipif(compiler() is None, reason="no C compiler, which builds the FMU")

TS = 0.05
T = TS * np.arange(401)
U = np.repeat(np.random.default_rng(1).uniform(-1, 1, 41), 10)[:401]


def exact(u: FloatArray = U, gain: float = 2.0, frequency: float = 3.0, damping: float = 0.4) -> FloatArray:
    """Output of the same rig with its input held, from its exact sampled transfer function."""
    continuous = [gain * frequency**2], [1.0, 2.0 * damping * frequency, frequency**2]
    num, den, _ = cont2discrete(continuous, TS)
    return np.asarray(lfilter(num[0], den, u))


@pytest.fixture(scope="module")
def rig(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return build_oscillator(tmp_path_factory.mktemp("fmi3") / "rig.fmu")


def test_it_simulates_with_the_numbers_that_are_asked_for(rig: Path) -> None:
    simulate = open_in_process(str(rig))
    assert simulate.nominal == {"gain": 2.0, "frequency": 3.0, "damping": 0.4}
    np.testing.assert_allclose(simulate(T, U), exact(), atol=1e-9)
    np.testing.assert_allclose(simulate(T, U, {"frequency": 4.0}), exact(frequency=4.0), atol=1e-9)
    np.testing.assert_allclose(simulate(T, U, {"damping": 0.1}), exact(damping=0.1), atol=1e-9)
    np.testing.assert_allclose(simulate(7.0 + T, U), exact(), atol=1e-9)  # nothing is kept, and no time has a meaning
    with pytest.raises(ValueError, match=r"rig\.fmu stopped with FMICallException: fmi3SetFloat64 failed"):
        simulate(T, np.where(T < 1.0, U, np.inf))
    np.testing.assert_allclose(simulate(T, U), exact(), atol=1e-9)  # it can go on


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"kind": '<ModelExchange modelIdentifier="oscillator"/>'}, "rig.fmu is for model exchange only"),
        ({"kind": '<ScheduledExecution modelIdentifier="oscillator"/>'}, "rig.fmu is for scheduled execution only"),
        ({"force": '><Dimension start="3"/></Float64>'}, "the input force of rig.fmu is an array, expected one number"),
        (
            {"more": '<Float64 name="load" valueReference="9" causality="input" start="0"/>'},
            r"rig.fmu has 2 \(force, load\) as real input, expected one",
        ),
        ({"folder": "elsewhere"}, "rig.fmu has no binary for .*, only for elsewhere. Export it for this platform"),
        ({"more": "<Float64 name="}, "rig.fmu is not an FMU that can be read"),
    ],
)
def test_what_cannot_be_played_is_said_in_one_line(tmp_path: Path, change: dict[str, str], said: str) -> None:
    with pytest.raises(ValueError, match=said) as raised:
        one_of_each(open_in_process(str(build_oscillator(tmp_path / "rig.fmu", **change))))
    assert "\n" not in str(raised.value)


def test_an_array_among_its_parameters_is_no_number(tmp_path: Path) -> None:
    table = (
        '<Float64 name="table" valueReference="9" causality="parameter" variability="fixed" start="1 2 3">'
        '<Dimension start="3"/></Float64>'
    )
    simulate = open_in_process(str(build_oscillator(tmp_path / "rig.fmu", more=table)))
    assert list(simulate.nominal) == ["gain", "frequency", "damping"]


@pytest.mark.slow
@searched("extra-lag", "parameter-mismatch")
def test_it_is_diagnosed_with_free_numbers_exported_and_played(
    rig: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(rig.parent)
    noise = 0.01 * np.random.default_rng(2).standard_normal(T.size)
    y = exact(frequency=3.6, damping=0.25) + noise
    np.savetxt("run.csv", np.column_stack([T, U, y]), delimiter=",", header="t,u,y", comments="")
    command = ["gap", "diagnose", "run.csv", "--sim", "rig.fmu", "--free", "frequency,damping"]
    assert main([*command, "--evaluations", "300", "--json", "report.json", "--export", "better.json"]) == 0
    report = json.loads(Path("report.json").read_text(encoding="utf-8"))
    (effect,) = report["effects"]
    assert effect["name"] == "parameter-mismatch"
    for name, true in (("frequency", 3.6), ("damping", 0.25)):
        fitted = effect["parameters"][name]
        assert abs(fitted["value"] - true) < 4.0 * fitted["stderr"] < 0.02 * true
    assert "the limit of 300 runs of your simulation" in " ".join(capsys.readouterr().out.split())
    assert main(["gap", "simulate", "better.json", "run.csv"]) == 0
    assert float(capsys.readouterr().out.split("rmse ")[1].split()[0]) == pytest.approx(0.01, rel=0.1)
    assert main([*command[:-1], "stiffness"]) == 2
    assert "rig.fmu has no number 'stiffness' that could be free; it has gain, frequency, damping" in (
        capsys.readouterr().err
    )
