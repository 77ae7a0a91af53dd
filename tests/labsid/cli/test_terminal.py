"""Texts in a terminal: nothing is cut or broken within a word, and the headline is bold there alone."""

import io
import re
import sys

import pytest
from gap_reports import report
from signals_reports import signals_report

from labsid.blind.metrics import KindCounts, Metric, Scores
from labsid.blind.table import print_scores
from labsid.cli.console import print_contents, print_report
from labsid.cli.gap_tables import print_effects, print_rigs
from labsid.cli.progress import shown_progress
from labsid.gap.reports.signals_text import format_signals
from labsid.gap.reports.text_report import format_report
from labsid.gap.rigs import RigResult
from labsid.records.contents import ColumnSummary

LONGEST = "periodic-disturbance"
RIGS = [
    RigResult(
        "emps-axis-with-a-name",
        "partial",
        (("coulomb-friction", 0.97), (LONGEST, 0.61)),
        1.0,
        0.4,
        2.0,
        "process",
        12.3,
    ),
    RigResult("tank", "refused", (), 0.0, 0.0, 0.0, None, 0.1, "the record is too short for a holdout of its own"),
]

SCORES = Scores(
    (Metric("probability of the second and third names, ECE", 0.985, 220, 0.96, 0.995, 0.95, 0.98),),
    {"several-signals-of-one-rig": {LONGEST: {LONGEST: 12, "input-nonlinearity": 3, "coulomb-friction": 1}}},
    ((0.95, 0.97, 40),),
    (KindCounts("tank with an overflow and a leak", 220, 200, 10, 5, 5),),
)


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


@pytest.fixture
def terminal(monkeypatch):
    """Function: a terminal of so many columns in the place of stdout and stderr."""

    def opened(columns: int) -> Terminal:
        out = Terminal()
        for name in ("stdout", "stderr"):
            monkeypatch.setattr(sys, name, out)
        monkeypatch.setenv("COLUMNS", str(columns))
        monkeypatch.setenv("TERM", "xterm")
        for name in ("NO_COLOR", "FORCE_COLOR"):
            monkeypatch.delenv(name, raising=False)
        return out

    return opened


@pytest.mark.parametrize("columns", [60, 80, 120])
def test_the_table_of_effects_and_that_of_columns_never_cut_a_word(terminal, columns):
    out = terminal(columns)
    print_effects()
    print_contents("log.csv", [ColumnSummary("torque_of_the_motor", "N m", 1201, 0.005, -1.75, 1.75, 0.1, "input", "")])
    shown = re.sub("\033\\[[0-9;]*m", "", out.getvalue())
    for word in ("output-nonlinearity", "torque_of_the_motor", "10.0%", "missing"):
        assert word in shown
    assert "…" not in shown


@pytest.mark.parametrize("columns", [60, 80, 120])
def test_the_tables_of_the_sealed_check_fit_a_terminal(terminal, columns):
    out = terminal(columns)
    print_scores(SCORES, "labsid gap blind --suite dev: 1 record")
    lines = re.sub("\033\\[[0-9;]*m", "", out.getvalue()).splitlines()
    assert max(map(len, lines)) <= columns
    shown = " ".join(" ".join(line.strip("│┃ ").split()) for line in lines)
    for text in ("stated probability", "--suite dev: 1 record", "200 (86-94 %)", LONGEST, "98.5 %", "target"):
        assert text in shown
    assert "…" not in shown


def test_a_table_without_a_terminal_is_as_wide_as_it_needs(capsys, monkeypatch):
    monkeypatch.setenv("COLUMNS", "80")
    print_scores(SCORES, "title")
    lines = capsys.readouterr().out.splitlines()
    assert max(map(len, lines)) > 80
    names = (LONGEST, "input-nonlinearity", "coulomb-friction")
    assert any(all(name in line for name in names) for line in lines)


@pytest.mark.parametrize("columns", [60, 80, 120])
def test_a_report_of_several_signals_fits_and_names_the_place_of_an_effect(monkeypatch, columns):
    monkeypatch.setenv("COLUMNS", str(columns))
    names = [("temperature of the upper tank at the wall of the second room", "K"), ("level", "")]
    lines = format_signals(signals_report(("input-delay", "valve"), outputs=names)).splitlines()
    assert all(len(line) <= columns for line in lines)
    text = " ".join(" ".join(lines).split())
    assert "; at valve, seen in level" in text
    assert "largest Rms error of level: Before ####" in text
    (row,) = [line for line in lines if line.rstrip().endswith("97 %") and "level" not in line]
    assert "second room" in row or columns > 110


@pytest.mark.parametrize("columns", [60, 80, 120, 200])
def test_the_name_of_an_effect_is_never_cut(terminal, columns):
    out = terminal(columns)
    print_rigs(RIGS)
    shown = re.sub("\033\\[[0-9;]*m", "", out.getvalue())
    for word in ("coulomb-friction", LONGEST, "emps-axis-with-a-name", "(0.61)"):
        assert word in shown
    assert all(len(line) <= columns for line in shown.splitlines())
    assert "…" not in shown
    assert max(map(len, shown.splitlines())) <= columns


def test_the_headline_is_bold_in_a_terminal_only(terminal, capsys, monkeypatch):
    text = format_report(report("input-delay"))
    print_report(text)
    assert capsys.readouterr().out == f"{text}\n"
    out = terminal(80)
    print_report(text)
    headline, _, rest = text.partition("\n\n")
    assert out.getvalue() == f"\033[1m{headline}\033[0m\n\n{rest}\n"
    monkeypatch.setenv("NO_COLOR", "1")
    out.truncate(0)
    out.seek(0)
    print_report(text)
    assert out.getvalue() == f"{text}\n"


@pytest.mark.parametrize("columns", [60, 80])
@pytest.mark.parametrize("verdict", ["none", "unknown", "effect"])
def test_no_line_of_a_report_is_wider_than_the_terminal(monkeypatch, columns, verdict):
    monkeypatch.setenv("COLUMNS", str(columns))
    shown = report(*(["input-saturation"] if verdict == "effect" else []), verdict=verdict)
    lines = format_report(shown).splitlines()
    assert max(map(len, lines)) <= columns


def test_the_bar_of_a_search_is_one_over_its_stages_with_the_time_that_has_passed(terminal):
    out = terminal(80)
    with shown_progress(stages=True) as progress:
        for share in (0.5, 1.0, 0.1):
            progress("two effects", share)
    assert "0:00:0" in out.getvalue()
    assert "-:--" not in out.getvalue()
