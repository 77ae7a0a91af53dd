"""The text report for the terminal, made from the JSON report alone."""

import textwrap
from collections.abc import Sequence
from typing import Any

from labsid._texts import joined, line_width
from labsid.gap.reports import sentences
from labsid.gap.reports.effect_texts import noun, parameter_rows
from labsid.gap.reports.limit_rows import COLUMNS, NOT_SHOWN, hidden_sentences, limit_cells, limits_sentence
from labsid.gap.reports.location_text import location_sentences
from labsid.gap.reports.page_parts import error_bars
from labsid.plots.signal_names import fitted, pair_of_effect

WIDTH = 96  # characters of a line, or those of the terminal if it is narrower
LEAST_NAME = 12  # characters of a name in a table, however narrow the terminal
BAR, LEAST_BAR = 24, 6  # characters of the longest bar
INDENT = 11  # characters of the column of titles
RECORD_COLUMNS = ("rms error on", "before", "after", "noise", "closed")


def format_report(report: dict[str, Any]) -> str:
    """Format the report as text.

    Parameters
    ----------
    report : dict
        In the layout ``labsid.gap/4``.

    Returns
    -------
    str
        Lines of at most 96 characters: the verdict; the causes with their parameters and standard errors; findings from
        the record; alternatives; the gap before and after; its location; the residual; faults in the samples; and the
        next experiment or the part of the rig to inspect.
    """
    lines = [*titled_lines("", sentences.verdict_sentence(report), indent=0), ""]
    for effect in report["effects"]:
        lines += effect_lines(report, effect)
    for number, finding in enumerate(sentences.record_sentences(report)):
        lines += titled_lines("" if number else "record", printable(finding))
    rows = [
        ("ambiguous", [sentences.ambiguity_sentence(report), sentences.reference_sentence(report)]),
        (
            "gap",
            [sentences.gap_sentence(report), sentences.start_sentence(report), sentences.baseline_sentence(report)],
        ),
        ("where", [sentences.place_sentence(report), *location_sentences(report)]),
        ("residual", [*sentences.residual_sentences(report), sentences.kinds_sentence(report)]),
        ("samples", report["screen"]),
        ("next", [_experiment(report), sentences.look_sentence(report)]),
    ]
    if report["verdict"] == "none":
        rows = [row for row in rows if row[0] != "where"]  # the location of noise is not informative
    if report["verdict"] == "unknown":
        tried = joined([sentences.noun_without_article(name) for name in sentences.effects_tried(report)])
        rows.insert(1, ("tried", [f"{sentences.capitalised(tried)}."]))
    for title, texts in rows:
        lines += titled_lines(title, " ".join(printable(text) for text in texts if text))
        lines += [*bar_lines(report), *_records(report)] if title == "gap" else []
    if report["verdict"] in ("none", "unknown"):
        lines += limits_lines(report)
    return "\n".join(lines)


def format_limits(found: dict[str, Any]) -> str:
    """Format the result of `find_limits` as text.

    Parameters
    ----------
    found : dict
    """
    record, verdict = found["record"], found["verdict"]
    what = "a record with the planned input" if found["planned"] else "the record"
    name = printable(record["name"] or "record")
    lines = titled_lines("", f"{name}: {record['samples']} samples, verdict {verdict}. What {what} can show:", indent=0)
    return "\n".join([*lines, *limits_lines(found)])


def limits_lines(report: dict[str, Any]) -> list[str]:
    """What the record could have shown of each effect, in words and columns."""
    return [*titled_lines("limits", limits_sentence(report) or ""), *limits_table_lines(report)]


def limits_table_lines(report: dict[str, Any]) -> list[str]:
    """The sizes from which on the record would have shown each effect, in columns, and why it shows others at none."""
    table, lines = [COLUMNS, *limit_cells(report, str)], []
    columns = [i for i in range(len(COLUMNS)) if any(row[i] != NOT_SHOWN for row in table[1:])]
    if len(table) > 1:
        lines += ["", *_in_columns([[printable(row[i]) for i in columns] for row in table]), ""]
    return [*lines, *(line for text in hidden_sentences(report) for line in titled_lines("", printable(text)))]


def effect_lines(report: dict[str, Any], effect: dict[str, Any], place: str = "") -> list[str]:
    """One cause, with its `place` among several signals, and with its parameters in columns below."""
    title = "cause" if sentences.is_probable(effect) else "possible"
    said = f"{noun(effect['name'])} ({effect['name']}), {sentences.chance_of(effect)}"
    lines = titled_lines(title, f"{said}; {place}" if place else said)
    return lines + _in_columns(parameter_rows(effect, pair_of_effect(report, effect)), INDENT + 2)


def _in_columns(rows: Sequence[Sequence[str]], indent: int = 0) -> list[str]:
    """Rows of a table; where they are wider than a line, the last cells stand on further lines, indented by 4."""
    if not rows:
        return []
    wide = [max(len(row[i]) for row in rows) for i in range(len(rows[0]))]
    lines = []
    for row in rows:
        line, rest = " " * indent, [f"{cell:<{width}}" for cell, width in zip(row, wide, strict=True)]
        begun = False
        for cell in rest:
            if begun and len(line) + 2 + len(cell.rstrip()) > _width():
                lines.append(line.rstrip())
                line, begun = " " * (indent + 4), False
            line, begun = f"{line}  {cell}" if begun else f"{line}{cell}", True
        lines.append(line.rstrip())
    return [line for line in lines if line]


def bar_lines(report: dict[str, Any]) -> list[str]:
    """The errors before and after beside the noise, as bars."""
    rows = error_bars(report)
    label, value = (max(len(row[key]) for row in rows) for key in ("label", "value"))
    longest = max(min(BAR, _width() - INDENT - label - value - 4), LEAST_BAR)
    lengths = [max(round(0.01 * longest * float(row["width"])), 1) for row in rows]
    return [
        f"{' ' * INDENT}{printable(row['label']):<{label}}  {'#' * length:<{longest}}  {row['value']}"
        for row, length in zip(rows, lengths, strict=True)
    ]


def _records(report: dict[str, Any]) -> list[str]:
    """The gap on each of several records, in columns."""
    rows = sentences.record_rows(report)
    if not rows:
        return []
    table = [RECORD_COLUMNS, *(tuple(printable(cell) for cell in row) for row in rows)]
    return [*titled_table("records", table), *titled_lines("", sentences.records_sentence(report) or "")]


def titled_table(title: str, table: Sequence[Sequence[str]]) -> list[str]:
    """Rows of a name and numbers in columns behind a title; names too long for a line are shortened."""
    wide = [max(len(row[i]) for row in table) for i in range(len(table[0]))]
    room = max(_width() - INDENT - sum(wide[1:]) - 2 * len(wide[1:]), LEAST_NAME)
    names = [row[0] if len(row[0]) <= room else fitted(row[0], room, 1)[0] for row in table]
    wide[0] = max(len(name) for name in names)
    return [
        "  ".join(
            [f"{'' if count else title:<{INDENT}}{name:<{wide[0]}}"]
            + [f"{cell:>{width}}" for cell, width in zip(row[1:], wide[1:], strict=True)]
        )
        for count, (name, row) in enumerate(zip(names, table, strict=True))
    ]


def _experiment(report: dict[str, Any]) -> str | None:
    text = sentences.experiment_sentence(report)
    return None if text is None else f"Apply the input that --json writes as next_experiment. {text}"


def titled_lines(title: str, text: str, indent: int = INDENT) -> list[str]:
    """Lines of a text behind its title, broken at the width of the report."""
    if not text:
        return []
    for unit in "%±":  # no line break between a number and its unit
        text = text.replace(f" {unit}", f"\u00a0{unit}")
    begun = f"{title:<{indent}}"
    lines = textwrap.wrap(text, _width(), initial_indent=begun, subsequent_indent=" " * indent, break_on_hyphens=False)
    return [line.replace("\u00a0", " ") for line in lines]


def _width() -> int:
    """Characters of a line: those of the terminal, within limits."""
    return line_width(WIDTH)


def printable(text: str) -> str:
    """`text` with control characters replaced by spaces: a file must not control the terminal."""
    return "".join(c if c.isprintable() else " " for c in text)
