"""Format numbers for the report: standard errors, percentages, units."""

import math
import re
from dataclasses import dataclass
from typing import Any

from labsid.plots.signal_names import unit_of

UNITS = {
    "u": "units of u",
    "y": "units of y",
    "u/s": "units of u a second",
    "y/u": "units of y for a unit of u",
    "y/s": "units of y a second",
    "1/u": "per unit of u",
    "1/y": "per unit of y",
    "1/u^2": "per (unit of u)²",
    "1/y^2": "per (unit of y)²",
    "u/y^2": "units of u per (unit of y)²",
    "u s^2/y^2": "units of u per (unit of y a second)²",
    "force s/y": "units of force per (unit of y a second)",
    "force s^2/y^2": "units of force per (unit of y a second)²",
    "force/y": "units of force for a unit of y",
    "force/y^3": "units of force per (unit of y)³",
    "1": "",
}
LIKELY, POSSIBLE = 0.5, 0.2  # probabilities from which an effect is called so in words
LEAST_SHOWN = 1e-9  # of a value: standard errors below it are those of the fit alone, not of the model
EXACT = 1e-8  # of a value: with a smaller standard error the fit is exact, and further digits say nothing
OFFSET = 1000.0  # a larger value may be mostly an offset
MIN_PLAIN, MAX_PLAIN = 1e-4, 1e6  # range of magnitudes without an exponent


@dataclass(frozen=True, slots=True)
class Quantity:
    """A number with its standard error, formatted for sentences.

    The format ``%`` gives a percentage. The default adds the unit, unless it is only known as that of u or y.
    """

    value: float
    stderr: float
    unit: str

    def __format__(self, how: str) -> str:
        if how == "%":
            return percent(self.value)
        text = number(self.value, significant_digits(self.value, self.stderr))
        if self.unit in ("u/s", "y/s"):
            return f"{text} units a second"
        return text if self.unit in UNITS else f"{text} {self.unit}"


def with_units(report: dict[str, Any], u: str, y: str) -> dict[str, Any]:
    """A copy of the report that states its parameters in the units of the record, such as "V" and "mm".

    Each parameter keeps its former unit, in terms of u and y, as `of`.
    """
    effects = [effect | {"parameters": _with_units(effect["parameters"], u, y)} for effect in report["effects"]]
    return report | {"effects": effects, "units": {"u": u, "y": y}}


def with_names(report: dict[str, Any], u: str, y: str) -> dict[str, Any]:
    """A copy of the report with the names of the columns of input and output, if they are not called u and y."""
    return report if (u, y) == ("u", "y") else report | {"names": {"u": u, "y": y}}


def in_units(unit: str, u: str, y: str) -> str:
    """A unit in terms of u and y, in the units of the record."""
    if unit not in UNITS:
        return unit
    return re.sub("[uy]", lambda signal: {"u": u, "y": y}[signal[0]], unit.replace("^2", "²").replace("^3", "³"))


def unit_in_words(unit: str, pair: dict[str, Any]) -> str:
    """A unit in terms of u and y, in the units and with the names of the columns, as far as `pair` states them."""
    stated = pair.get("units", {})
    if len(stated) == 2 and unit != "1":
        return in_units(unit, **stated)
    words = re.sub(
        r"\bunit(s?) of ([uy])\b", lambda found: _signal_unit(pair, found[2], found[1]), UNITS.get(unit, unit)
    )
    return re.sub(r"\((\w+)\)", r"\1", words)


def _signal_unit(pair: dict[str, Any], signal: str, plural: str) -> str:
    text = unit_of(pair, signal)
    return text if plural or signal in pair.get("units", {}) else text.replace("units of", "unit of", 1)


def _with_units(parameters: dict[str, dict[str, Any]], u: str, y: str) -> dict[str, dict[str, Any]]:
    former = {name: entry.get("of", entry["unit"]) for name, entry in parameters.items()}
    return {
        name: entry | {"unit": in_units(former[name], u, y), "of": former[name]} for name, entry in parameters.items()
    }


def number(value: float, digits: int = 3) -> str:
    """Format `value` with the given number of significant digits."""
    if value == 0.0 or not math.isfinite(value):
        return f"{value:g}"
    exponent = math.floor(math.log10(abs(float(f"{value:.{digits - 1}e}"))))
    if not MIN_PLAIN <= abs(value) < MAX_PLAIN:
        return f"{value:.{digits - 1}e}"
    return f"{value:.{max(digits - 1 - exponent, 0)}f}"


def significant_digits(value: float, stderr: float) -> int:
    """Number of significant digits of `value` given its standard error: 2 to 5, or 3 without one.

    A value that is mostly an offset, such as a number of counts, has up to 8.
    """
    if value == 0.0 or not math.isfinite(stderr) or stderr <= 0.0:
        return 3
    kept = math.floor(math.log10(abs(value))) - math.floor(math.log10(stderr)) + 1
    return min(max(kept, 2), 8 if abs(value) > OFFSET and stderr > EXACT * abs(value) else 5)


def with_error(value: float, stderr: float | None) -> str:
    """Format ``value ± stderr`` with two significant digits of the error.

    A value without an error, or with one below its fifth digit, stands alone.
    """
    if stderr is None or not _is_shown(value, stderr):
        return _without_error(value, stderr)
    value_text, error_text, exponent = _in_common_digits(value, stderr)
    text = f"{value_text} ± {error_text}"
    return f"({text}){exponent}" if exponent else text


def rounded(value: float, stderr: float | None) -> str:
    """Format the value as `with_error` does, without the error."""
    if stderr is None or not _is_shown(value, stderr) or value == 0.0:
        return _without_error(value, stderr)
    value_text, _, exponent = _in_common_digits(value, stderr)
    return value_text + exponent


def _is_shown(value: float, stderr: float) -> bool:
    return math.isfinite(stderr) and stderr > 0.0 and stderr >= LEAST_SHOWN * abs(value)


def _without_error(value: float, stderr: float | None) -> str:
    return number(value, 5 if stderr is not None and 0.0 < stderr < LEAST_SHOWN * abs(value) else 4)


def _in_common_digits(value: float, stderr: float) -> tuple[str, str, str]:
    """A value and its error, with two significant digits of the error, and the exponent of both."""
    size = max(abs(value), stderr)
    power = 0 if MIN_PLAIN <= size < MAX_PLAIN else math.floor(math.log10(size))
    value, stderr = value / 10.0**power, stderr / 10.0**power
    decimals = min(max(1 - math.floor(math.log10(stderr)), 0), 9)
    text = f"{value:.{decimals}f}"
    return text if float(text) else text.lstrip("-"), f"{stderr:.{decimals}f}", f"e{power:+03d}" if power else ""


def percent(share: float) -> str:
    """Format a share in per cent, small ones with two significant digits."""
    size = 100.0 * share
    text = f"{size:.0f}" if abs(size) >= 9.95 else f"{size:.2g}" if abs(size) >= 0.005 else "0"
    return f"{text} %"


def counted(count: int, one: str, more: str) -> str:
    """Format a count with its noun."""
    return f"{count} {one if count == 1 else more}"


def closed_percent(closed: float, ci95: list[float] | None = None) -> str:
    """Format the closed share of the gap with its 95 % interval: ``97 % [94, 100]``, which begins at zero or above."""
    text = f"{_whole_percent(closed)} %"
    if ci95 is None:
        return text
    low = ci95[0] if closed < 0.0 else max(ci95[0], 0.0)
    return f"{text} [{_whole_percent(low)}, {_whole_percent(ci95[1])}]"


def _whole_percent(share: float) -> str:
    return f"{100.0 * share + 0.0:.0f}".replace("-0", "0") if abs(share) < 0.005 else f"{100.0 * share:.0f}"


def probability(p: float) -> str:
    """Format a probability in per cent, between "under 1 %" and "over 99 %"."""
    if p >= 0.995:
        return "over 99 %"
    return "under 1 %" if p < 0.005 else f"{100.0 * p:.0f} %"


def chance(p: float, reference: str) -> str:
    """Format a probability in per cent, or in words where nothing like the record is among the `reference` rigs."""
    if reference == "inside":
        return probability(p)
    return "likely" if p >= LIKELY else "possible" if p >= POSSIBLE else "unlikely"


def p_value(p: float) -> str:
    """Format the p-value of a test."""
    return "p < 0.001" if p < 0.001 else "p > 0.99" if p > 0.99 else f"p = {p:.2g}"


def between(low: float, high: float) -> tuple[str, str]:
    """Format the ends of a range to about a hundredth of its width."""
    width = abs(high - low)
    if width == 0.0 or not MIN_PLAIN <= max(abs(low), abs(high)) < MAX_PLAIN:
        return f"{low:.3g}", f"{high:.3g}"
    decimals = max(1 - math.floor(math.log10(width)), 0)
    return _without_zeros(low, decimals), _without_zeros(high, decimals)


def _without_zeros(value: float, decimals: int) -> str:
    text = f"{value:.{decimals}f}"
    text = text.rstrip("0").rstrip(".") if "." in text else text
    return "0" if text == "-0" else text
