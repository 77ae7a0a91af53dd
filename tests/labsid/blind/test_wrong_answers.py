"""The list of wrong answers; the diagnosis is replaced by a short program."""

import json
from pathlib import Path

import pytest

from labsid.blind import runner
from labsid.blind.runner import run_batch
from labsid.blind.suite import make_cases
from labsid.blind.wrong_answers import main
from labsid.rig.ordinary.kinds import KINDS

UNKNOWN = """
import json, pathlib, sys
result = {"verdict": "partial", "effects": [{"name": "resonance", "probability": 0.7}], "ambiguous": ["extra-lag"]}
if sys.argv[2] == "batch":
    records, out = pathlib.Path(sys.argv[3]), pathlib.Path(sys.argv[5])
    out.mkdir(exist_ok=True)
    for path in records.glob("*.csv"):
        if not path.name.endswith(".sim.csv"):
            (out / (path.stem + ".json")).write_text(json.dumps(result))
else:
    assert sys.argv[2] == "diagnose" and pathlib.Path(sys.argv[3]).exists() and sys.argv[4] == "--sim"
    if "--free" in sys.argv:
        sys.exit("labsid: the numbers cannot be fitted")
    pathlib.Path(sys.argv[sys.argv.index("--json") + 1]).write_text(json.dumps(result))
"""
SOME = ("direct-gain", "itself-json", "itself-function", "free-pair")


@pytest.fixture
def short_program(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(runner, "_MAIN", UNKNOWN)


@pytest.mark.usefixtures("short_program")
def test_each_wrong_record_is_listed_with_its_answer_and_its_command(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    kinds = [word for kind in SOME for word in ("--kind", kind)]
    main(["--per-row", str(len(KINDS)), *kinds, "--jobs", "1", "--keep", str(tmp_path)])
    lines = capsys.readouterr().out.splitlines()
    labels = json.loads((tmp_path / "labels.json").read_text(encoding="utf-8"))
    names = {label["truth"]["kind"]: name for name, label in labels.items()}
    assert set(names) == set(SOME)
    at = lines.index(f"honest {list(KINDS).index('direct-gain')} direct-gain: {names['direct-gain']}")
    assert lines[at + 1].split() == ["right:", "none", "answer:", "partial", "resonance", "0.70", "or", "extra-lag"]
    assert lines[at + 2].strip() == f"labsid gap diagnose {names['direct-gain']}.csv"
    pair = names["free-pair"]
    at = lines.index(f"honest {list(KINDS).index('free-pair')} free-pair: {pair}")
    assert "answer: error: labsid: the numbers cannot be fitted" in lines[at + 1]
    assert lines[at + 2].startswith("    numbers: {} instead of")
    free = labels[pair]["options"][-1]
    assert lines[at + 3].strip() == f"labsid gap diagnose {pair}.csv --sim {pair}.py:simulate --free {free}"
    assert any(line.startswith("honest: 0 of 4 right") for line in lines)
    assert "ordinary records: a wrong name above 0.5: 75.0 % [30.1-95.4 %] of 4" in lines
    assert not any(line.startswith("faint") for line in lines)
    assert lines[-1].split()[:3] == ["all", "4", "0"]
    assert (tmp_path / "records" / f"{pair}.py").exists()


@pytest.mark.usefixtures("short_program")
def test_kept_reports_of_single_records_are_not_made_again(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (case,) = [case for case in make_cases("dev", len(KINDS), ["honest"]) if getattr(case, "kind", "") == "free-far"]
    first, _ = run_batch([case], 1, keep=tmp_path)
    monkeypatch.setattr(runner, "_MAIN", "raise SystemExit('never run')")
    assert run_batch([case], 1, keep=tmp_path)[0] == first
    assert first[case.name]["message"] == "labsid: the numbers cannot be fitted"


def test_a_single_record_that_takes_too_long_has_no_result(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(runner, "_MAIN", "import time\ntime.sleep(600)")
    monkeypatch.setattr(runner, "SECONDS_A_RECORD", 0.1)
    monkeypatch.setattr(runner, "SECONDS_TO_START", 0.5)
    (case,) = [case for case in make_cases("dev", len(KINDS), ["honest"]) if getattr(case, "kind", "") == "free-far"]
    assert run_batch([case], 1)[0] == {}
