"""The record of the cells that have been run."""

import time
from typing import Any

import pytest
from IPython.core.interactiveshell import InteractiveShell

from labsid.checks.cell_runs import runs_in, shell_of


@pytest.fixture
def shell() -> Any:
    return InteractiveShell()


def test_a_run_is_recorded_with_what_it_assigned(shell: Any) -> None:
    runs = runs_in(shell)
    assert runs_in(shell) is runs
    shell.run_cell("a = 1\n_hidden = 2", cell_id="one")
    shell.run_cell("b = [a]\nb[0] = 3\nc = undefined", cell_id="two")
    shell.run_cell("a = = 1", cell_id="three")
    shell.run_cell("b[0] = 4", cell_id="one")
    assert [run.cell_id for run in runs.runs] == ["one", "two", "three", "one"]
    assert [set(run.assigned) for run in runs.runs] == [{"a"}, {"b"}, set(), {"b"}]
    assert [run.error.split(":")[0] for run in runs.runs] == ["", "NameError", "SyntaxError", ""]
    assert runs.cell_ids == {"one", "two", "three"}
    last = runs.last("one")
    assert last is not None
    assert last.source == "b[0] = 4"
    assert runs.last("four") is None
    assert len(runs.assigning("b")) == 2


def test_variables_from_before_the_record_are_known_as_such(shell: Any) -> None:
    shell.run_cell("early = 1")
    runs = runs_in(shell)
    shell.run_cell("late = 1")
    assert "early" in runs.first_names
    assert "late" not in runs.first_names
    assert runs.cell_ids == set()


def test_a_long_run_is_warned_of_and_a_short_one_is_not(
    shell: Any, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("labsid.checks.cell_runs.CELL_SECONDS", 0.2)
    runs_in(shell)
    shell.run_cell("import time\ntime.sleep(0.5)")
    assert "This cell has been running for 0.2 seconds; grading stops a cell then." in capsys.readouterr().err
    shell.run_cell("a = 1")
    time.sleep(0.4)
    assert capsys.readouterr().err == ""


def test_the_shell_is_known_by_its_variables(shell: Any) -> None:
    assert shell_of(shell.user_ns) is shell
    assert shell_of({}) is None
    assert shell_of(dict(shell.user_ns)) is None
