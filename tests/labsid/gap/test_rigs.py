"""`labsid gap rigs` on folders with a rig that cannot be diagnosed."""

from pathlib import Path

import numpy as np
import pytest
from gap_search import searched

from labsid.cli.commands import main
from labsid.gap.rigs import check_rigs, find_rigs

pytestmark = pytest.mark.usefixtures("without_limits")


def write_rig(folder: Path, name: str, constant: bool = False) -> None:
    """Two records of a first-order rig; its input may not move."""
    for number, ending in enumerate(("", ".holdout")):
        rng = np.random.default_rng(number)
        u = np.full(300, 0.5) if constant else np.repeat(rng.uniform(-1.0, 1.0, 30), 10)
        y = np.zeros(300)
        for k in range(299):
            y[k + 1] = 0.8 * y[k] + 0.4 * u[k]
        table = np.column_stack([0.1 * np.arange(300), u, y + 0.01 * rng.standard_normal(300)])
        np.savetxt(folder / f"{name}{ending}.csv", table, delimiter=",", header="t,u,y", comments="")


@searched("input-delay", "load-step")
def test_the_rig_after_one_with_a_constant_input_is_diagnosed(tmp_path: Path) -> None:
    write_rig(tmp_path, "a-still", constant=True)
    write_rig(tmp_path, "b-moving")
    still, moving = check_rigs(find_rigs(tmp_path))
    assert still.verdict == "error"
    assert "constant" in still.message
    assert moving.verdict == "none"
    assert moving.after < 0.02


@searched("input-delay", "load-step")
def test_the_table_names_the_rig_and_the_exit_status_is_1(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    write_rig(tmp_path, "a-still", constant=True)
    write_rig(tmp_path, "b-moving")
    assert main(["gap", "rigs", str(tmp_path)]) == 1
    said = capsys.readouterr().out
    assert all(word in said for word in ("a-still", "error", "constant", "b-moving"))
    alone = tmp_path / "alone"
    alone.mkdir()
    write_rig(alone, "b-moving")
    assert main(["gap", "rigs", str(alone)]) == 0


@searched("input-delay", "load-step")
def test_a_second_record_with_missing_outputs_is_scored_where_it_has_some(tmp_path: Path) -> None:
    write_rig(tmp_path, "gaps")
    path = tmp_path / "gaps.holdout.csv"
    lines = path.read_text().splitlines()
    for row in (1, 2, 60, 150):
        lines[row] = lines[row].rpartition(",")[0] + ","
    path.write_text("\n".join(lines) + "\n")
    (one,) = check_rigs(find_rigs(tmp_path))
    assert one.message == ""
    assert 0.0 < one.after < 0.02
