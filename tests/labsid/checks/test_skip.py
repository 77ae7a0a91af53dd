"""Every question on whose values later steps build can be skipped, and the others are then right."""

import re
import shutil
from pathlib import Path

import matplotlib.pyplot as plt
import pytest
from representatives import mostly_exhaustive

from labsid.checks import CheckFailed
from labsid.checks.notebook import assignment_names, load_assignment

DATA = Path(__file__).resolve().parents[3] / "data"
ONE_OF_EACH_KIND = ("prelab-sinusoids", "lab-identification", "model-structures", "several-signals")
"""Tried everywhere: with and without a record, functions, and several signals. `test_variants.py` proves for every
assignment that what a wrong answer is replaced with fits the questions behind it."""
REGION = re.compile(r"( *)### BEGIN SOLUTION.*?### END SOLUTION", re.DOTALL)


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore")  # of given cells that meet a function without an answer
@pytest.mark.parametrize("name", mostly_exhaustive(assignment_names(), ONE_OF_EACH_KIND))
def test_nobody_is_locked_in(
    name: str, notebook_cells, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    assignment = load_assignment(name)
    if assignment.record_file is not None:
        shutil.copy(DATA / assignment.record_file, tmp_path)
    to_skip = {question.id for question in assignment.questions if question.gives is not None}
    variables: dict[str, object] = {}
    failed: set[str] = set()
    for words, source in notebook_cells(name):
        grade_id = str(words["grade_id"])
        if grade_id.removesuffix("-answer") in to_skip:
            source = REGION.sub(lambda found: f"{found[1]}pass", source)
        try:
            exec(compile(source, grade_id, "exec"), variables)
        except CheckFailed:
            failed.add(grade_id)
            variables["check"].skip(grade_id)  # type: ignore[attr-defined]
        except Exception:  # a cell that shows a result which is not there
            assert "points" not in words
        plt.close("all")
    assert failed == to_skip
    capsys.readouterr()
    variables["check"].summary()  # type: ignore[attr-defined]
    shown = {line.split()[1]: line.split()[0] for line in capsys.readouterr().out.splitlines()[1:-1]}
    noted = {question.id for question in assignment.questions if question.id.startswith("gap-8-")}
    expected = {question.id: "–" if question.id in to_skip else "✓" for question in assignment.questions}
    assert shown == {name: "○" if name in noted else sign for name, sign in expected.items()}
