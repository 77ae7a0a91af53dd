"""Names and units of signals, as matplotlib shows them: any text, on lines of limited length."""

from textwrap import wrap
from typing import Any

LINES = 2  # of a name
UNIT = 10  # characters of a unit
LONGEST = 24  # characters of a label on one line
SYMBOLS = {"u": "Input", "y": "Output"}


def units_of(report: dict[str, Any]) -> dict[str, str]:
    """Units of all signals of a report by name; empty where unknown."""
    return {one["name"]: one["unit"] or "" for kind in ("inputs", "outputs") for one in report["signals"][kind]}


def pair_of(report: dict[str, Any], u: str, y: str) -> dict[str, dict[str, str]]:
    """Names and stated units of an input and an output among several signals, as of a record of these two."""
    names, stated = {"u": u, "y": y}, units_of(report)
    return {"names": names, "units": {symbol: stated[name] for symbol, name in names.items() if stated.get(name)}}


def pair_of_effect(report: dict[str, Any], effect: dict[str, Any]) -> dict[str, Any]:
    """Names and stated units of the signals of an effect: of one input and one output, those of the record."""
    if "signals" not in report:
        return {key: report[key] for key in ("names", "units") if key in report}
    first = effect["outputs"][0]
    inputs = [one["name"] for one in report["signals"]["inputs"]]
    return pair_of(report, effect["signal"] if effect["signal"] in inputs else report["outputs"][first]["main"], first)


def name_of(report: dict[str, Any], signal: str) -> str:
    """Name of the column of "u" or "y" in the record of one input and one output; else ``u`` or ``y``."""
    return str(report.get("names", {}).get(signal, signal))


def unit_of(report: dict[str, Any], signal: str = "y") -> str:
    """Unit of "u" or "y" as the report states it; else ``units of`` its name."""
    stated = report.get("units", {}).get(signal)
    return str(stated or f"units of {fitted(name_of(report, signal), LONGEST, 1)[0]}")


def axis_label(report: dict[str, Any], signal: str, rate: bool = False) -> str:
    """Name and unit of "u" or "y", or of its rate, for an axis: ``Output $y$ (V)``, or ``position (rad)``."""
    is_stated = bool(report.get("units", {}).get(signal))
    unit = unit_of(report, signal) + (("/s" if is_stated else " a second") if rate else "")
    if "names" not in report:
        name = f"Rate of ${signal}$" if rate else f"{SYMBOLS[signal]} ${signal}$"
        return f"{name} ({as_text_lines([unit])})"
    return one_line(f"{'rate of ' if rate else ''}{name_of(report, signal)}", unit if is_stated else "")


def plain_label(report: dict[str, Any], signal: str) -> str:
    """`axis_label` of "u" or "y" without the mathematics of matplotlib."""
    stated = report.get("units", {}).get(signal)
    if "names" not in report:
        return f"{SYMBOLS[signal]} {signal} ({unit_of(report, signal)})"
    return " ".join([*fitted(name_of(report, signal), LONGEST, 1), *_bracketed(str(stated or ""))])


def name_beside(report: dict[str, Any], width: int) -> str:
    """Name of the output with its unit below, on lines of `width` characters; ``Output $y$`` where it is not named."""
    if "names" not in report:
        return "Output $y$"
    return stacked(name_of(report, "y"), str(report.get("units", {}).get("y") or ""), width)


def one_line(name: str, unit: str = "") -> str:
    """``name (unit)``, shortened."""
    return as_text_lines([" ".join([*fitted(name, LONGEST, 1), *_bracketed(unit)])])


def stacked(name: str, unit: str, width: int) -> str:
    """The name on at most two lines of `width` characters, and its unit below."""
    return as_text_lines([*fitted(name, width, LINES), *_bracketed(unit)])


def as_text_lines(lines: list[str]) -> str:
    """Lines that matplotlib shows as they are: without control characters and without mathematics."""
    return "\n".join("".join(c if c.isprintable() else " " for c in line) for line in lines).replace("$", r"\$")


def fitted(text: str, width: int, most: int) -> list[str]:
    """At most so many lines of a text. The last one holds its end, by which long names differ, after an ellipsis."""
    lines = wrap(text, width) or [""]
    if len(lines) <= most:
        return lines
    return [*lines[: most - 1], f"…{text[1 - width :].lstrip()}"]


def _bracketed(unit: str) -> list[str]:
    return [f"({fitted(unit, UNIT, 1)[0]})"] if unit else []
