"""A given simulation of two inputs and two outputs: diagnosed, exported, and run again."""

import json
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from gap_search import searched
from scipy.signal import lfilter

from labsid import diagnose
from labsid._arrays import FloatArray
from labsid.cli.commands import main
from labsid.gap.signals.couplings import couplings_of
from labsid.gap.signals.given import as_system
from labsid.gap.signals.result import SignalsDiagnosis
from labsid.gap.signals.roles import Signals
from labsid.gap.simulations.fmu_export import read_fmu_content
from labsid.gap.system_file import system_from_json
from labsid.records.record import Record

control = pytest.importorskip("control")
pytestmark = [pytest.mark.slow, pytest.mark.usefixtures("without_limits")]

NOISE, TS, DEAD = 0.01, 0.1, 0.25
PAIRS = (((2.0, 0.9, 0.6), (0.7, 0.93, 0.7)), ((0.5, 0.93, 0.7), (1.5, 0.88, 0.5)))
"""Static gain and two poles of each pair, by output and input."""
MODEL = """
import numpy as np
from scipy.signal import lfilter

PAIRS = {pairs}


def response(K, p, q, u):
    return lfilter([0, K * (1 - p) * (1 - q)], np.convolve([1, -p], [1, -q]), u)


def simulate(t, u, gain=1.0):
    return gain * np.column_stack([sum(response(*one, v) for one, v in zip(row, u.T)) for row in PAIRS])


def one_output(t, u):
    return u[:, 0]


def too_short(t, u):
    return np.zeros((3, 2))


def ragged(t, u):
    return [[1], [2, 3]]
"""


def response(K: float, p: float, q: float, u: FloatArray) -> FloatArray:
    return np.asarray(lfilter([0, K * (1 - p) * (1 - q)], np.convolve([1, -p], [1, -q]), u))


def simulate(t: FloatArray, u: FloatArray, gain: float = 1.0) -> FloatArray:
    return gain * np.column_stack([sum(response(*one, v) for one, v in zip(row, u.T, strict=True)) for row in PAIRS])


def without_coupling(t: FloatArray, u: FloatArray) -> FloatArray:
    y = simulate(t, u)
    return np.column_stack([response(*PAIRS[0][0], u[:, 0]), y[:, 1]])


FEW = ("input-delay", "input-saturation", "input-dead-zone")


@cache
def rig(seed: int = 0, dead: float = 0.0, samples: int = 800) -> Record:
    """A record of the rig that `simulate` describes, with a dead zone at u2."""
    rng = np.random.default_rng(seed)
    u = np.column_stack([np.repeat(rng.uniform(-1, 1, samples // hold), hold) for hold in (25, 40)])
    acting = np.column_stack([u[:, 0], np.sign(u[:, 1]) * np.maximum(np.abs(u[:, 1]) - dead, 0.0)])
    t = TS * np.arange(samples)
    y = simulate(t, acting) + NOISE * rng.standard_normal((samples, 2))
    return Record(t, u, y, TS, inputs=("u1", "u2"), outputs=("y1", "y2"))


def matrix(lacking: bool = False) -> "control.TransferFunction":
    """The rig as a matrix of transfer functions."""
    gains = [[K * (1 - p) * (1 - q) for K, p, q in row] for row in PAIRS]
    gains[0][1] *= not lacking
    den = [[np.convolve([1, -p], [1, -q]).tolist() for _, p, q in row] for row in PAIRS]
    return control.tf([[[gain, 0.0] for gain in row] for row in gains], den, TS)


@cache
def with_dead_zone() -> SignalsDiagnosis:
    with searched(*FEW):
        found = diagnose(rig(0, DEAD), simulate)
    assert isinstance(found, SignalsDiagnosis)
    return found


def errors(system: object, record: Record) -> FloatArray:
    y = system.simulate(record.u, record.y)  # type: ignore[attr-defined]
    return np.asarray(np.sqrt(np.mean((y - record.y)[60:] ** 2, axis=0)))


@searched(*FEW)
def test_the_right_function_has_no_gap() -> None:
    found = diagnose(rig(), simulate)
    assert found.verdict == "none"
    assert found.report["simulation"]["given"]
    assert "the rms error of the simulation is" in str(found)


def test_a_dead_zone_is_found_at_its_input_by_both_outputs() -> None:
    (effect,) = with_dead_zone().report["effects"]
    assert (effect["name"], effect["signal"]) == ("input-dead-zone", "u2")
    assert set(effect["outputs"]) == {"y1", "y2"}
    assert effect["parameters"]["high"]["value"] == pytest.approx(DEAD, abs=0.01)
    assert with_dead_zone().report["gap"]["closed"] > 0.95


def dragged(t: FloatArray, u: FloatArray) -> FloatArray:
    """A response to the first input, and the speed of a mass with quadratic drag that the second one drives."""
    speed, found = 0.5, np.empty(t.size)
    for k in range(t.size):
        found[k] = speed
        for _ in range(4):
            speed += TS / 4 * (u[k, 1] - 2.0 * speed * abs(speed) - 0.3 * speed)
    return np.column_stack([response(*PAIRS[0][0], u[:, 0]), found])


@searched("input-dead-zone", "input-saturation", "output-nonlinearity")
def test_a_dead_zone_is_one_about_zero_where_the_mean_of_the_input_is_not() -> None:
    rng = np.random.default_rng(6)
    t = TS * np.arange(600)
    u = np.column_stack([np.repeat(rng.uniform(-1, 1, 24), 25), np.repeat(rng.uniform(-1, 3, 30), 20)])
    acting = np.column_stack([u[:, 0], np.maximum(u[:, 1] - 0.5, 0.0) + np.minimum(u[:, 1] + 0.3, 0.0)])
    y = dragged(t, acting)
    y += 0.01 * np.std(y, axis=0) * rng.standard_normal(y.shape)
    (effect,) = diagnose(Record(t, u, y, TS, inputs=("u1", "u2"), outputs=("y1", "y2")), dragged).report["effects"]
    assert (effect["name"], effect["signal"]) == ("input-dead-zone", "u2")
    ends = [effect["parameters"][side]["value"] for side in ("low", "high")]
    np.testing.assert_allclose(ends, [-0.3, 0.5], atol=0.02)


@searched(*FEW)
@pytest.mark.parametrize(
    "simulation",
    [
        pytest.param(without_coupling, id="function"),
        pytest.param(matrix(lacking=True), id="matrix", marks=pytest.mark.exhaustive),
    ],
)
def test_a_path_that_the_simulation_lacks_is_a_coupling(simulation: object) -> None:
    found = diagnose(rig(), simulation)
    (effect,) = found.report["effects"]
    assert (effect["name"], effect["from"], effect["to"]) == ("coupling", "u2", "y1")
    assert effect["path"] == "dynamics"
    assert effect["signal"] is None
    assert effect["outputs"] == ["y1"]
    assert effect["parameters"]["gain"]["value"] == pytest.approx(PAIRS[0][1][0], rel=0.02)
    assert found.report["gap"]["outputs"]["y1"]["closed"] > 0.95
    assert list(found.effects) == [("coupling", "u2 -> y1")]
    assert "From u2 to y1: the input moves the output, and in the simulation it does not" in str(found)


@searched(*FEW)
def test_the_right_systems_of_python_control_have_no_gap() -> None:
    blocks = [control.ss(control.tf([K * (1 - p) * (1 - q), 0], np.convolve([1, -p], [1, -q]), TS)) for row in PAIRS
              for K, p, q in row]  # fmt: skip
    A, B = np.zeros((8, 8)), np.zeros((8, 2))
    C, D = np.zeros((2, 8)), np.zeros((2, 2))
    for n, block in enumerate(blocks):
        at = slice(2 * n, 2 * n + 2)
        A[at, at], B[at, n % 2 : n % 2 + 1], C[n // 2 : n // 2 + 1, at] = block.A, block.B, block.C
    for system in (matrix(), control.ss(A, B, C, D, TS)):
        assert diagnose(rig(), system).verdict == "none"


@searched(*FEW)
def test_free_numbers_are_found() -> None:
    found = diagnose(rig(), lambda t, u, gain=0.8: simulate(t, u, gain), free=["gain"])
    (effect,) = found.report["effects"]
    assert effect["name"] == "parameter-mismatch"
    assert effect["parameters"]["gain"]["value"] == pytest.approx(1.0, abs=0.005)


@searched(*FEW)
def test_a_holdout_is_run_with_its_own_inputs() -> None:
    found = diagnose(rig(0, DEAD), simulate, holdout=rig(9, DEAD))
    for one in found.report["gap"]["outputs"].values():
        assert one["after"] == pytest.approx(NOISE, rel=0.1)


def test_an_exported_simulation_leaves_the_noise_on_another_record() -> None:
    system = with_dead_zone().system
    assert system is not None
    other = rig(21, DEAD)
    assert errors(system, other) == pytest.approx([NOISE, NOISE], rel=0.1)
    with pytest.raises(ValueError, match="a column for each of u1, u2"):
        system.simulate(other.u[:, :1])
    with pytest.raises(ValueError, match=r"y must have the shape \(800, 2\)"):
        system.simulate(other.u, other.y[:, :1])
    with pytest.raises(ValueError, match="cannot be exported"):
        system.to_json_dict()


@searched("input-dead-zone")
def test_a_fitted_system_is_the_same_from_json() -> None:
    found = diagnose(rig(0, DEAD))
    assert isinstance(found, SignalsDiagnosis)
    assert found.system is not None
    again = system_from_json(json.loads(json.dumps(found.system.to_json_dict())))
    other = rig(21, DEAD)
    assert errors(again, other) == pytest.approx(errors(found.system, other), rel=1e-6)
    assert errors(again, other) == pytest.approx([NOISE, NOISE], rel=0.1)
    whole = np.concatenate([np.repeat(other.u[:1], 400, axis=0), other.u])
    assert again.simulate(whole)[400:] == pytest.approx(again.simulate(other.u), abs=1e-6)  # both from rest
    for broken in ({}, {"inputs": [], "outputs": [], "simulated": []}, {"inputs": 3}):
        with pytest.raises(ValueError, match="not an exported simulation of several signals"):
            system_from_json(broken)


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    (tmp_path / "model.py").write_text(MODEL.format(pairs=PAIRS), encoding="utf-8")
    for name, record in (("rig", rig(0, DEAD)), ("other", rig(21, DEAD))):
        rows = np.column_stack([record.t, record.u, record.y])
        np.savetxt(tmp_path / f"{name}.csv", rows, fmt="%.9g", delimiter=",", header="t,u1,u2,y1,y2", comments="")
    monkeypatch.chdir(tmp_path)
    return tmp_path


@searched("input-dead-zone")
def test_the_command_writes_and_runs_a_corrected_simulation(
    folder: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """As each kind of file; a record is diagnosed once."""
    fmpy = pytest.importorskip("fmpy", reason="pip install 'labsid[fmu]'")
    made: dict[str, object] = {}

    def once(records: list[Record], *arguments: object, **options: object) -> object:
        (record,) = records
        if record.name not in made:
            made[record.name] = diagnose(records, *arguments, **options)  # type: ignore[arg-type]
        return made[record.name]

    monkeypatch.setattr("labsid.gap.diagnosis.diagnose", once)
    for name in ("better.json", "better.py", "better.fmu"):
        assert main(["gap", "diagnose", "rig.csv", "--sim", "model.py:simulate", "--export", name]) == 0
        assert "At u2: the actuator does not move" in capsys.readouterr().out
        assert main(["gap", "simulate", name, "other.csv", "--out", "replay.csv"]) == 0
        said = capsys.readouterr().out
        assert "free run: rmse y1 0.0" in said
        replay = np.genfromtxt(folder / "replay.csv", delimiter=",", names=True)
        assert replay.dtype.names == ("t", "u1", "u2", "y1", "y2", "y1_sim", "y2_sim")
        assert np.std((replay["y2_sim"] - replay["y2"])[60:]) == pytest.approx(NOISE, rel=0.1)
    for name in ("better.json", "better.fmu"):
        assert main(["gap", "diagnose", "other.csv", "--sim", name]) == 0
        assert "There is no gap beyond noise" in capsys.readouterr().out
        made.clear()
    other = rig(21, DEAD)
    rows = [(t, *u) for t, u in zip(other.t.tolist(), other.u.tolist(), strict=True)][:200]
    played = fmpy.simulate_fmu(
        "better.fmu", stop_time=rows[-1][0], step_size=TS, output_interval=TS, output=["y1", "y2"],
        input=np.array(rows, [("time", float), ("u1", float), ("u2", float)]),
    )  # fmt: skip
    content = read_fmu_content(folder / "better.fmu")
    assert content is not None
    whole = system_from_json(content).simulate(other.u[:200])
    np.testing.assert_allclose(np.column_stack([played["y1"], played["y2"]]), whole, atol=1e-6)


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (["diagnose", "rig.csv", "--sim", "model.py:one_output"], "returns one output for y1, y2; it must return"),
        (["diagnose", "rig.csv", "--sim", "model.py:too_short"], "returns an array of shape (3, 2) for 800 samples"),
        (["diagnose", "rig.csv", "--sim", "model.py:ragged"], "returns rows of different lengths"),
        (["diagnose", "rig.csv", "--sim", "model.json"], "needs a simulation of all of them"),
        (["diagnose", "rig.csv", "--sim", "model.py:simulate", "--free", "mass"], "no number 'mass'"),
        (["diagnose", "rig.csv", "--export", "better.xml"], "is exported as .json, .py or .fmu; got better.xml"),
        (["simulate", "model.json", "rig.csv"], "model.json is no simulation of several signals"),
    ],
)
def test_one_line_says_what_is_wrong(
    folder: Path, arguments: list[str], says: str, capsys: pytest.CaptureFixture[str]
) -> None:
    (folder / "model.json").write_text('{"num": [1], "den": [1, -0.5], "dt": 0.1}', encoding="utf-8")
    assert main(["gap", *arguments]) == 2
    (said,) = capsys.readouterr().err.splitlines()
    assert says in said


def test_signals_are_taken_by_name_or_in_their_order() -> None:
    system = matrix()
    named = control.tf(system.num, system.den, TS, inputs=["u2", "u1"], outputs=["y1", "y2"])
    record = rig()
    for given, columns in ((system, [0, 1]), (named, [1, 0])):
        read = as_system(given, record, record.outputs)
        assert read is not None
        assert read.simulator(record.t, record.u) == pytest.approx(
            simulate(record.t, record.u[:, columns] - record.u[0, columns])
        )
    with pytest.raises(ValueError, match=r"has 1 outputs \(y\[0\]\); the record has 2 \(y1, y2\)"):
        as_system(system[0, :], record, record.outputs)
    with pytest.raises(ValueError, match="free"):
        as_system(system, record, record.outputs, ["gain"])


def test_a_simulation_with_all_paths_lacks_none() -> None:
    record = rig()
    signals = Signals(record.t, record.u, record.y, np.ones(record.y.shape, bool), TS, record.inputs, record.outputs)
    given = as_system(simulate, record, record.outputs)
    assert given is not None
    assert given.paths.all()
    assert couplings_of(replace(signals, given=given), 0) == ()
