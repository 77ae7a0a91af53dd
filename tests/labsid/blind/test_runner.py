"""The diagnosis runs in a separate process, replaced here by a short program."""

import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from gap_search import FEW_IN_ONE_PROCESS

from labsid.blind import check, runner
from labsid.blind.check import evaluate_replays, is_repeatable, run_sealed_check
from labsid.blind.experiment import Case, redraw, run_experiment, to_record
from labsid.blind.runner import run_batch, run_replays

BATCH = """
import json, pathlib, sys
assert sys.argv[1:3] == ["gap", "batch"] and sys.argv[4] == "--out" and sys.argv[6] == "--jobs"
records, out = pathlib.Path(sys.argv[3]), pathlib.Path(sys.argv[5])
out.mkdir()
here = sorted(path.name for path in records.parent.iterdir())
for path in sorted(records.glob("*.csv")):
    if ".holdout" in path.name:
        continue
    sim = path.with_suffix(".sim.json")
    (out / (path.stem + ".json")).write_text(json.dumps({
        "verdict": "none", "effects": [], "sim": sim.exists(), "header": path.open().readline().strip(),
        "files": sorted(p.name for p in records.iterdir()), "here": here}))
"""

PLAY = """
import json, pathlib, sys
import numpy as np
lines = json.load(sys.stdin)
assert lines[0][:2] == ["gap", "diagnose"]
record = pathlib.Path(lines[0][2])
assert sorted(p.suffix for p in pathlib.Path().iterdir() if "other" not in p.name) == [".csv"]
t, u, y = np.loadtxt(record, delimiter=",", skiprows=1).T
json.dump({"verdict": "none", "effects": [], "gap": {"ci95": [-10, 1], "before": 1.0, "after": 1.0,
    "holdout": [[t[100], t[300]]]}}, open(lines[0][lines[0].index("--json") + 1], "w"))
for line in lines[1:]:
    assert line[:3] == ["gap", "simulate", "better.json"]
    t, u, y = np.loadtxt(line[3], delimiter=",", skiprows=1).T
    np.savetxt(line[5], np.column_stack([t, y, 0 * y]), delimiter=",", header="t,y_sim,z", comments="")
"""


@pytest.fixture(scope="module")
def some(dev_cases: Callable[[str, int], list[Case]]) -> list[Case]:
    return [case for row in ("single-clear", "none", "with-sim") for case in dev_cases(row, 3)]


def test_the_batch_process_has_access_to_the_records_only(some: list[Case], monkeypatch) -> None:
    monkeypatch.setattr(runner, "_MAIN", BATCH)
    sensor_output: list[int] = []
    results, seconds = run_batch(some, jobs=1, on_progress=sensor_output.append)
    assert set(results) == {case.name for case in some}
    assert seconds > 0
    assert sensor_output == sorted(sensor_output)
    expected = {f"{case.name}.csv" for case in some}
    expected |= {f"{case.name}.sim.json" for case in some if case.sim is not None}
    expected |= {f"{case.name}.holdout.csv" for case in some if case.holdout is not None}
    for case in some:
        assert set(results[case.name]["files"]) == expected
        assert results[case.name]["here"] == ["records"]
        assert results[case.name]["header"] == "t,u,y"


def test_a_program_that_fails_or_writes_nonsense_gives_no_results(some: list[Case], monkeypatch) -> None:
    monkeypatch.setattr(runner, "_MAIN", "raise SystemExit(3)")
    assert run_batch(some, jobs=1)[0] == {}
    lines = ["import pathlib, sys", "out = pathlib.Path(sys.argv[5])", "out.mkdir()"]
    lines.append(f"(out / '{some[0].name}.json').write_text('{{not json')")
    monkeypatch.setattr(runner, "_MAIN", "\n".join(lines))
    assert run_batch(some, jobs=1)[0] == {}


def test_a_program_that_hangs_is_stopped(some: list[Case], monkeypatch) -> None:
    monkeypatch.setattr(runner, "_MAIN", "import time\ntime.sleep(600)")
    monkeypatch.setattr(runner, "SECONDS_A_RECORD", 0.1)
    monkeypatch.setattr(runner, "SECONDS_TO_START", 0.5)
    assert run_batch(some[:1], jobs=1)[0] == {}


def test_an_exported_simulation_is_played_on_fresh_records(some: list[Case], monkeypatch) -> None:
    monkeypatch.setattr(runner, "_SEVERAL", PLAY)
    case = next(case for case in some if is_repeatable(case))
    others = [to_record(run_experiment(redraw(case.experiment, i)), case.experiment.scales, "") for i in range(2)]
    (replay,) = run_replays([(case, others)], jobs=1)
    assert replay.result is not None
    for output, other in zip(replay.outputs, others, strict=True):
        assert output is not None
        np.testing.assert_allclose(output, other.y, rtol=1e-8)


def test_a_simulation_that_follows_to_the_noise_closes_nearly_all(some: list[Case], monkeypatch) -> None:
    monkeypatch.setattr(runner, "_SEVERAL", PLAY)
    monkeypatch.setattr(check, "FRESH_RECORDS", 3)
    case = next(case for case in some if is_repeatable(case))
    (outcomes,) = evaluate_replays([case], jobs=1)
    # the stand-in gives back the measured output: what is left is the noise, the gap is `ratio` times that
    assert outcomes.fresh_closure == pytest.approx(1 - 1 / case.ratio, abs=0.1)


@pytest.mark.usefixtures("drawn_once")
def test_the_whole_check_prints_its_table(tmp_path: Path, monkeypatch, capsys) -> None:
    monkeypatch.setattr(runner, "_MAIN", BATCH)
    monkeypatch.setattr(runner, "_SEVERAL", PLAY)
    monkeypatch.setattr(check, "FRESH_RECORDS", 2)
    report = tmp_path / "table.md"
    status = run_sealed_check("dev", per_row=2, rows=["single-clear", "none"], jobs=1, replays=1, report=report)
    assert status == 1  # nothing was named in the records that hold an effect
    printed = capsys.readouterr().out
    assert "labsid gap blind --suite dev: 4 records" in printed
    text = report.read_text()
    assert "| right effect named, one effect, clear | 0.0 % |" in text
    assert "| no effect: none reported | 100.0 % |" in text
    assert "| 95 % interval of the closed share covers fresh records | 100.0 % |" in text


def test_fewer_than_one_job_is_refused() -> None:
    with pytest.raises(ValueError, match="jobs must be at least 1; got 0"):
        run_sealed_check("dev", per_row=1, jobs=0)


def test_results_of_the_batch_are_json(some: list[Case], monkeypatch) -> None:
    monkeypatch.setattr(runner, "_MAIN", BATCH)
    results, _ = run_batch(some[:1], jobs=1)
    assert json.loads(json.dumps(results)) == results


def test_results_that_are_kept_are_not_made_again(
    short_cases: list[Case], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(runner, "_MAIN", FEW_IN_ONE_PROCESS)
    first, _ = run_batch(short_cases[:1], jobs=1, keep=tmp_path)
    (kept,) = tmp_path.glob("*.json")
    made = kept.stat().st_mtime_ns
    both, _ = run_batch(short_cases, jobs=1, keep=tmp_path)
    assert kept.stat().st_mtime_ns == made
    assert set(both) == {short_cases[0].name, short_cases[1].name}
    assert both[short_cases[0].name] == first[short_cases[0].name]
