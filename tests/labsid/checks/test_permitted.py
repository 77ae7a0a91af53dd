"""What grading refuses in a cell, as the checks of the notebook find it."""

import pytest

from labsid.checks.permitted import refused_lines, skipped_lines, without_magic


@pytest.mark.parametrize(
    ("lines", "named"),
    [
        ("from labsid import fit_arx", "labsid.fit_arx"),
        ("from labsid.lab.arx import fit_arx as mine", "labsid.lab.arx.fit_arx"),
        ("import labsid.lab.arx", "labsid.lab.arx"),
        ("import labsid\nlabsid.fit_arx", "labsid.fit_arx"),
        ("from labsid import plots\nplots.figure_5", "plots.figure_5"),
        ("import importlib\nimportlib.import_module('labsid.gap.diagnosis')", "labsid.gap.diagnosis"),
    ],
)
def test_a_taught_function_earns_no_tick(lines: str, named: str) -> None:
    variables: dict[str, object] = {}
    exec(lines, variables)
    (said,) = refused_lines(lines, variables)
    assert said.startswith(
        f"it uses `{named}`, which is the taught function itself. Grading refuses it: write the step"
    )


def test_what_the_notebooks_import_is_not_refused() -> None:
    lines = (
        "from labsid import load_record, plots, rig\nplots.figure_2\nrig.make_lab_record\nimport numpy as np\nnp.sin"
    )
    variables: dict[str, object] = {}
    exec(lines, variables)
    assert list(refused_lines(lines, variables)) == []


@pytest.mark.parametrize(
    "line",
    ["!pip install x", "  !ls", "files = !ls", "%pip install x", "%conda install x", "%%bash", "%sx ls", "%system ls"],
)
def test_a_line_that_starts_a_program_is_skipped(line: str) -> None:
    assert list(skipped_lines(f"a = 1\n{line}\nb = 2")) == [line.strip()]


@pytest.mark.parametrize(
    "line", ["%matplotlib inline", "a != b", "# !pip install x", "%timeit f(x)", "piped = 3 % pip"]
)
def test_other_lines_are_not(line: str) -> None:
    assert list(skipped_lines(line)) == []


def test_a_cell_with_an_error_of_syntax_is_left_to_the_kernel() -> None:
    assert list(refused_lines("from labsid import = 3", {})) == []
    assert without_magic("a = 1\n%time\nb = 2") == "a = 1\n\nb = 2"
