"""Corrected simulations as FMUs: played by fmpy and by labsid, and what cannot be written."""

import zipfile
from pathlib import Path

import numpy as np
import pytest
from fmu_rigs import build_tank
from gap_search import searched

from labsid._arrays import FloatArray
from labsid.cli.commands import main
from labsid.gap.model_file import from_json_dict
from labsid.gap.sampled_run import SampledRun
from labsid.gap.simulations.fmu_export import read_fmu_content, write_fmu
from labsid.simulators.fmu import input_and_output

fmpy = pytest.importorskip("fmpy", reason="pip install 'labsid[fmu]'")
pytest.importorskip("pythonfmu", reason="pip install 'labsid[fmu]'")

TS = 0.5
LIMITED = {
    "schema": "labsid.model/1",
    "effects": ["input-saturation/high", "load-step"],
    "parameters": ["delay", "high", "log_c", "log_k", "onset"],
    "theta": [0.2, 0.8, np.log(0.5), np.log(0.05), 0.4],
    "gains": [0.02, 0.03, 0.0, 0.0, 0.0, 0.4, 0.1, 0.1],
    "Ts": TS,
    "span": 600,
    "reference": 0.1,
    "u_scale": {"centre": 2.0, "unit": 3.0},
    "y_scale": {"centre": -1.0, "unit": 5.0},
}
FUNCTION = """
from scipy.signal import lfilter
{more}
def simulate(t, u, pole=0.9):
    return lfilter([0.0, 1.0 - pole], [1.0, -pole], u)
"""
AROUND_FUNCTION = LIMITED | {
    "effects": ["input-saturation/high"],
    "parameters": ["delay", "high"],
    "theta": [0.0, 0.2],
    "gains": [1.0, 0.0, 0.0, 0.3],
}


def played(path: Path, u: FloatArray, start: float = 0.0, every: int = 1, **numbers: object) -> FloatArray:
    """Output of an FMU with a communication step of `every` times the sampling time."""
    driven, seen = input_and_output(path)
    t = start + TS * np.arange(u.size)
    signals = np.array(list(zip(t, u, strict=True)), dtype=[("time", float), (driven, float)])
    step = every * TS
    result = fmpy.simulate_fmu(
        str(path), start_time=t[0], stop_time=t[-1], step_size=step, output_interval=step, input=signals,
        output=[seen], start_values=numbers,
    )  # fmt: skip
    return np.asarray(result[seen])


@pytest.fixture(scope="module")
def limited(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("limited") / "2 better.fmu"
    write_fmu(path, LIMITED)
    return path


def test_it_plays_step_by_step_what_the_simulation_plays_as_a_whole(limited: Path, levels: FloatArray) -> None:
    model, u = from_json_dict(LIMITED), 2.0 + 3.0 * levels[:300]
    np.testing.assert_allclose(played(limited, u), model.simulate(u, of_record=False), atol=1e-9)
    np.testing.assert_allclose(played(limited, u, start=7.0, of_record=True), model.simulate(u), atol=1e-9)
    assert np.abs(model.simulate(u) - model.simulate(u, of_record=False)).max() > 0.1  # the load is at 240 samples
    assert read_fmu_content(limited) == LIMITED


def test_the_input_is_read_at_the_samples_of_the_model(levels: FloatArray) -> None:
    model, u = from_json_dict(LIMITED), 2.0 + 3.0 * levels[:60]
    whole = model.simulate(u, of_record=False)
    fine, coarse = (
        SampledRun(lambda u: model.simulate(u[:, 0], of_record=False)[:, np.newaxis], TS, 0.0) for _ in range(2)
    )
    for k in range(59):
        for part in range(1, 4):  # three steps a sample; the input between two samples is not read
            fine.advance(TS * (k + part / 3.0), float(u[k]) if part == 1 else 99.0)
            expected = whole[k + part // 3]
            assert fine.output(float(u[k + part // 3])) == pytest.approx(expected, abs=1e-9)
    held = np.repeat(u[::2], 2)
    for k in range(0, 58, 2):
        coarse.advance(TS * (k + 2), float(held[k]))
        expected = model.simulate(held[: k + 3], of_record=False)[-1]
        assert coarse.output(float(held[k + 2])) == pytest.approx(expected, abs=1e-9)


def test_it_holds_the_file_of_a_given_simulation(tmp_path: Path, levels: FloatArray) -> None:
    (tmp_path / "rig.py").write_text(FUNCTION.format(more=""), encoding="utf-8")
    source = {"source": str(tmp_path / "rig.py:simulate"), "free": {}, "rates": [0.5, 0.05]}
    write_fmu(tmp_path / "better.fmu", AROUND_FUNCTION | {"simulator": source})
    (tmp_path / "rig.py").unlink()
    content = read_fmu_content(tmp_path / "better.fmu")
    assert content is not None
    u = 2.0 + 3.0 * levels[:200]
    np.testing.assert_allclose(
        played(tmp_path / "better.fmu", u), from_json_dict(content).simulate(u, of_record=False), atol=1e-9
    )
    write_fmu(tmp_path / "again.fmu", content)  # from the one that holds it
    assert played(tmp_path / "again.fmu", u).std() > 0.1


def test_a_function_that_needs_other_files_is_refused_in_one_line(tmp_path: Path) -> None:
    (tmp_path / "rig.py").write_text(FUNCTION.format(more="import beside"), encoding="utf-8")
    (tmp_path / "beside.py").write_text("", encoding="utf-8")
    source = {"source": str(tmp_path / "rig.py:simulate"), "free": {}, "rates": [0.5, 0.05]}
    with pytest.raises(
        ValueError, match=r"better.fmu cannot hold the simulation: .*No module named 'beside'.*one file"
    ):
        write_fmu(tmp_path / "better.fmu", AROUND_FUNCTION | {"simulator": source})
    assert not (tmp_path / "better.fmu").exists()


def test_without_its_packages_it_says_how_to_get_them(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    command = ["gap", "diagnose", str(tmp_path / "none.csv"), "--export", str(tmp_path / "better.fmu")]
    assert main(command) == 2  # before the record is read
    assert capsys.readouterr().err.endswith('writing an FMU needs pythonfmu. Run: pip install "labsid[fmu]"\n')


def test_other_files_hold_no_exported_simulation(tmp_path: Path) -> None:
    (tmp_path / "text.fmu").write_text("no zip", encoding="utf-8")
    assert read_fmu_content(tmp_path / "text.fmu") is None
    with zipfile.ZipFile(tmp_path / "other.fmu", "w") as other:
        other.writestr("modelDescription.xml", "<fmiModelDescription/>")
    assert read_fmu_content(tmp_path / "other.fmu") is None


@searched("input-saturation", "extra-lag")
def test_an_fmu_is_diagnosed_exported_as_an_fmu_and_then_has_no_gap(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    build_tank(tmp_path / "rig")
    monkeypatch.chdir(tmp_path)
    rng = np.random.default_rng(2)
    u = np.repeat(rng.uniform(-1.0, 1.0, 20), 10)
    y = played(Path("rig/Tank.fmu"), np.clip(u, -0.5, 0.6))
    y += 0.01 * np.std(y) * rng.standard_normal(u.size)
    rows = np.column_stack([TS * np.arange(u.size), u, y])
    np.savetxt("run.csv", rows, delimiter=",", header="t,u,y", comments="")
    command = ["gap", "diagnose", "run.csv", "--evaluations", "150", "--sim"]  # a run of an FMU takes long
    assert main([*command, "rig/Tank.fmu", "--export", "better.fmu"]) == 0
    assert "a limit of the actuator" in capsys.readouterr().out
    assert input_and_output(Path("better.fmu")) == ("inflow", "level")
    error = (played(Path("better.fmu"), u) - y)[100:]  # the tank was empty at the start, not at rest at u[0]
    assert rms(error) < 0.02 * np.std(y)
    assert main(["gap", "simulate", "better.fmu", "run.csv"]) == 0
    assert "rmse 0.00" in capsys.readouterr().out
    assert main(["gap", "simulate", "rig/Tank.fmu", "run.csv"]) == 0
    assert "rmse 0.2" in capsys.readouterr().out
    assert main([*command, "better.fmu"]) == 0
    assert "There is no gap beyond noise" in capsys.readouterr().out


def rms(e: FloatArray) -> float:
    return float(np.sqrt(np.mean(e**2)))
