"""Effects inside a class that is stepped: what is named at its port, and the mended simulation."""

import json
import re
from pathlib import Path

import numpy as np
import pytest
from gap_search import searched
from stepped_rigs import Pendulum, built_in, command

from labsid.cli.commands import main
from labsid.gap.diagnosis import diagnose
from labsid.gap.effects.context import Context
from labsid.gap.effects.inside import FAMILIES, woken_numbers
from labsid.gap.fits.fitting import fit_from
from labsid.gap.record.data import scaled
from labsid.gap.reports.inside_texts import inside_clause
from labsid.gap.simulations.baseline import make_baseline
from labsid.records.record import Record
from labsid.simulators.stepper import stepper_simulator

pytestmark = pytest.mark.usefixtures("without_limits")

TS, NOISE = 0.005, 0.01
SOURCE = Path(__file__).parents[3] / "stepped_rigs.py"


def measured(seed: int = 1, samples: int = 600, **changes: float) -> Record:
    """A record of the pendulum with changes in it, and noise of 1 % of the output."""
    u = command(seed, samples)
    y = built_in(u, **changes)
    noise = NOISE * np.std(y) * np.random.default_rng(seed).standard_normal(samples)
    return Record(TS * np.arange(samples), u, y + noise, TS, name="run")


def saved(record: Record, path: Path) -> None:
    rows = np.column_stack([record.t, record.u, record.y])
    np.savetxt(path, rows, delimiter=",", header="t,u,y", comments="", fmt="%.9g")


@pytest.fixture(autouse=True)
def _in_a_folder_of_its_own(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("rig.py").write_text(SOURCE.read_text(encoding="utf-8"), encoding="utf-8")


@searched("coulomb-friction", "parameter-mismatch", "input-dead-zone")
def test_friction_is_named_at_the_port_and_is_in_what_is_exported(capsys) -> None:
    saved(measured(friction=15.0), Path("run.csv"))
    saved(measured(2, friction=15.0), Path("other.csv"))
    arguments = [
        "gap",
        "diagnose",
        "run.csv",
        "--sim",
        "rig.py:Pendulum",
        "--json",
        "run.json",
        "--export",
        "better.json",
    ]
    assert main(arguments) == 0
    report = json.loads(Path("run.json").read_text(encoding="utf-8"))
    (effect,) = report["effects"]
    assert (effect["name"], effect["port"]) == ("coulomb-friction", "rig.py:Pendulum")
    friction = effect["parameters"]["friction"]
    assert friction["unit"] == "units of force"
    assert abs(friction["value"] - 15.0) < 4.0 * friction["stderr"] < 1.5
    text = " ".join(capsys.readouterr().out.split())
    assert re.search(r"At the port of rig\.py:Pendulum, dry friction of 1\d\.\d+ units of force opposes", text)
    assert "friction that grows with the load cannot be tried: they need the force of the drive" in text
    assert main(["gap", "simulate", "better.json", "other.csv"]) == 0
    other = measured(2, friction=15.0)
    assert float(re.findall(r"rmse (\S+)", capsys.readouterr().out)[0]) < 1.2 * NOISE * np.std(other.y)
    assert main(["gap", "diagnose", "run.csv", "--sim", "better.json", "--json", "again.json"]) == 0
    assert json.loads(Path("again.json").read_text(encoding="utf-8"))["verdict"] == "none"


@searched("coulomb-friction", "parameter-mismatch", "input-dead-zone")
def test_nothing_is_named_where_nothing_is_missing() -> None:
    assert diagnose(measured(), Pendulum).verdict == "none"


@searched("coulomb-friction", "parameter-mismatch", "end-stop")
@pytest.mark.parametrize(
    ("changes", "name", "values"),
    [
        ({"damping": 6.0}, "parameter-mismatch", {"damping": 6.0}),
        pytest.param({"high": 0.45}, "end-stop", {"high": 0.45}, marks=pytest.mark.exhaustive),
    ],
)
def test_other_changes_are_named_with_their_sizes(changes, name, values) -> None:
    (effect,) = diagnose(measured(**changes), Pendulum).report["effects"]
    assert effect["name"] == name
    for key, value in values.items():
        assert effect["parameters"][key]["value"] == pytest.approx(value, rel=0.05)


@searched("coulomb-friction")
def test_numbers_of_a_class_are_free() -> None:
    found = diagnose(measured(d=14.0), Pendulum, free=["d"])
    (effect,) = found.report["effects"]
    assert effect["name"] == "parameter-mismatch"
    assert effect["parameters"]["d"]["value"] == pytest.approx(14.0, abs=0.5)


def test_a_limit_that_nothing_reaches_is_tried_where_it_acts() -> None:
    """It has no derivative, and may act once friction is there."""
    u = 0.3 * command(1, 400)
    data = scaled(u, built_in(u, friction=10.0, limit=40.0), np.ones(u.size, bool), TS, 0.0)
    base = make_baseline(data, TS * np.arange(u.size), stepper_simulator(Pendulum).with_free(["k", "limit"]))
    fit = fit_from(data, base.structure, base.start, 3)
    assert fit is not None
    (found,) = woken_numbers(Context(data, fit)).items()
    limit = fit.hypothesis.plant.free[1]
    assert found[0] == limit.name
    assert 20.0 < limit.number(found[1]) < 120.0


class OnlyPosition:
    """The pendulum without motion(), begun at a position."""

    def __init__(self, d: float = 10.0) -> None:
        self.inner = Pendulum(d=d)

    def reset(self, y0: float) -> float:
        """Begin at rest."""
        return self.inner.reset(y0, 0.0)

    def step(self, u: float, force: float) -> float:
        """One sample."""
        return self.inner.step(u, force)


@searched("parameter-mismatch", "coulomb-friction")
def test_a_class_without_motion_tells_what_it_does_not_try() -> None:
    found = diagnose(measured(damping=6.0), OnlyPosition)
    (effect,) = found.report["effects"]
    assert effect["name"] == "parameter-mismatch"
    assert effect["parameters"]["damping"]["value"] == pytest.approx(6.0, abs=1.0)
    assert "Without motion() -> (position, speed), neither can dry friction" in " ".join(str(found).split())
    assert "coulomb-friction" not in {row["name"] for row in found.report["ranking"]}


def test_friction_needs_a_trial_or_the_mobility_in_long_samples() -> None:
    class Unsolved(Pendulum):
        save = restore = None  # type: ignore[assignment]

    with searched("coulomb-friction"):
        text = " ".join(str(diagnose(measured(friction=15.0), Unsolved)).split())
    assert "Without save() and restore(state), or mobility(), neither can dry friction and stops at a sampling" in text


def test_each_effect_has_its_clause_at_a_port() -> None:
    values = dict.fromkeys(
        ("friction", "drag", "stiffness", "torque", "angle", "high", "tau", "onset", "frequency"), 2.0
    )
    for family in FAMILIES:
        name = "damping" if family.name == "parameter-mismatch" else None
        parameters = {name: 2.0} if name else values
        entries = {key: {"value": x, "stderr": 0.1, "unit": "units of force"} for key, x in parameters.items()}
        text = inside_clause({"name": family.name, "port": "rig.py:Rig", "parameters": entries})
        assert "rig.py:Rig" in text
        assert text[0].isupper()
        assert "joint" not in text


@pytest.mark.parametrize(
    ("change", "words", "status"),
    [
        (lambda y: y, "The record and the model agree in sign, units and time.", 0),
        (lambda y: -y, "moves against the output of rig.py:Pendulum. --match y=-1 mends it", 1),
        (np.degrees, "the log seems to be in degrees. --match y=57.2958 mends it", 1),
    ],
)
def test_check_compares_a_class_with_a_record(change, words, status, capsys) -> None:
    record = measured()
    saved(Record(record.t, record.u, change(record.y), TS), Path("run.csv"))
    assert main(["gap", "check", "run.csv", "--sim", "rig.py:Pendulum"]) == status
    printed = capsys.readouterr().out
    assert printed.startswith("600 samples; effects act at the port of rig.py:Pendulum")
    assert words in printed


def test_errors_on_the_command_line_are_one_line(capsys) -> None:
    saved(measured(), Path("run.csv"))
    for arguments, words in (
        (["check", "run.csv", "--sim", "rig.py:command"], "cannot be called as command(t, u)"),
        (["diagnose", "run.csv", "--sim", "rig.py:Pendulum", "--free", "mass"], "it has k, d, g, limit"),
        (["diagnose", "run.csv", "--sim", "rig.py:Arm"], "has no function 'Arm'; it has Pendulum"),
    ):
        assert main(["gap", *arguments]) == 2
        said = capsys.readouterr().err
        assert words in said or words.replace("cannot be called as command(t, u)", "is a function") in said
        assert said.count("\n") == 1
