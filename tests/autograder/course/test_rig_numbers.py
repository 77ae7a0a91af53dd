"""What the passages on a rig say of its record: each phrase is compared with what the notebook's own cell does."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
import pytest
from own_rigs import HOLD, LEVELS, MOTOR, write_csv

from autograder.course.own_rig import OwnRig, Quantity, rig_log
from autograder.course.rig_findings import about_rig
from autograder.course.rig_texts import RigWords, read_for_rig, rig_words
from labsid.checks.other_records.rig_model import RigModel, make_rig_log
from labsid.lab.identification import Identification, identify
from labsid.rig.lab.log import log_to_record

ROOT = Path(__file__).resolve().parents[3]
LAB = ROOT / "notebooks" / "lab-identification" / "lab-identification.md"
UP = 4.0, 6.0, 8.0, 5.0, 7.0, 6.0
DOWN = 8.0, 6.0, 4.0, 7.0, 5.0, 6.0


def described(folder: Path, levels: tuple[float, ...], model: RigModel) -> tuple[RigWords, Identification]:
    """The words of a rig, and what the lab finds of its record."""
    model = replace(model, u_rest=levels[0])
    log = make_rig_log(model, np.repeat(levels, HOLD), np.random.SeedSequence(1), "motor", ("V", "rpm"))
    rig = OwnRig(
        write_csv(folder / "log.csv", log), "the motor", "It turns.", Quantity("u", "V"), Quantity("speed", "rpm")
    )
    return rig_words(rig), identify(log_to_record(rig_log(rig)))


@pytest.mark.parametrize(
    ("levels", "y_rest", "gain", "change", "wrong"),
    [
        (LEVELS, 75.0, 30.0, "raises", "goes to its lower limit"),
        (UP, 75.0, 30.0, "raises", "stays at its lower limit"),
        (DOWN, 200.0, 30.0, "lowers", "goes to its lower limit"),
        (LEVELS, 200.0, -30.0, "raises", "goes to its upper limit"),
        (DOWN, 200.0, -30.0, "raises", "stays at its upper limit"),
        (LEVELS, -200.0, 30.0, "raises", "goes to its upper limit"),
        (LEVELS, 30.0, 30.0, "raises", "leads the output itself to"),
    ],
)
def test_the_loop_does_what_the_text_says(
    levels: tuple[float, ...], y_rest: float, gain: float, change: str, wrong: str, tmp_path: Path
) -> None:
    words, found = described(tmp_path, levels, replace(MOTOR, gain=gain, y_rest=y_rest, y_start=y_rest))
    assert words.values["loop.change"].startswith(f"{change} the output by ")
    assert wrong in words.values["loop.wrong"]
    cells = {cell.metadata.get("nbgrader", {}).get("grade_id"): cell.source for cell in read_for_rig(LAB, words).cells}
    model = found.model
    variables: dict[str, Any] = {"np": np, "plt": plt, "Ts": model.Ts}
    variables |= {"y_offset": model.y_offset, "u_offset": model.u_offset}
    variables |= {"a1": model.a[1], "a2": model.a[2], "b1": model.b[0], "b2": model.b[1]}
    exec(cells["lab-4-figure-3-run"], variables)
    plt.close("all")
    run_loop, step = variables["run_loop"], float(words.values["loop.step"])
    y, _ = run_loop(model.y_offset, samples=1500)
    assert y[-1] == pytest.approx(model.y_offset + step, abs=0.01 * abs(step))
    y, u = run_loop(0.0, samples=1500)
    low, high = float(words.values["u.low"]), float(words.values["u.high"])
    if "leads" in wrong:
        assert y[-1] == pytest.approx(step, abs=0.01 * abs(step))
        assert low < u[-1] < high
    else:
        assert u[-1] == (low if "lower" in wrong else high)
        assert np.all(u == u[-1]) == ("stays" in wrong)


@pytest.mark.parametrize(
    ("levels", "is_said"), [(LEVELS, True), (UP, False), (DOWN, False), ((4.0, 3.8, 8.0, 5.0, 7.0, 6.0), False)]
)
def test_both_signs_are_said_where_both_signals_have_them(
    levels: tuple[float, ...], is_said: bool, tmp_path: Path
) -> None:
    words, _ = described(tmp_path, levels, MOTOR)
    assert ("both now take positive and negative values" in words.values["signs"]) == is_said


def test_what_the_initial_state_saves_is_that_of_the_record(tmp_path: Path) -> None:
    words, found = described(tmp_path, LEVELS, MOTOR)
    errors = found.verification
    factor = errors.mse_second_half / errors.mse_second_half_carried
    assert f"by a factor of about {float(f'{factor:.2g}'):.0f}." in words.values["start"]
    assert "second half" not in {one.topic for one in about_rig(found.record)}
    words, found = described(tmp_path, (4.0, 2.0, 4.0, 6.0, 5.0, 7.0), MOTOR)  # the half begins at the rest
    errors = found.verification
    assert errors.mse_second_half < 2 * errors.mse_second_half_carried
    assert "hardly changes the error" in words.values["start"]
    (warned,) = (one for one in about_rig(found.record) if one.topic == "second half")
    assert (warned.level, "question 3b" in warned.text) == ("warning", True)


@pytest.mark.parametrize("name", ["lab-identification", "postlab-model-order", "step-response"])
def test_an_expected_figure_follows_a_cell_that_draws(name: str, tmp_path: Path) -> None:
    words, _ = described(tmp_path, LEVELS, MOTOR)
    cells = read_for_rig(ROOT / "notebooks" / name / f"{name}.md", words).cells
    expected = [at for at, cell in enumerate(cells) if cell.source.startswith("**Expected figure.**")]
    assert expected
    assert [cells[at].source for at in expected if cells[at - 1].cell_type != "code"] == []
    assert not any("\n**Expected figure.**" in cell.source for cell in cells)
