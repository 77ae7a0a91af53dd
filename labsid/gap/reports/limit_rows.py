"""What a record could have shown of each effect: rows of the report, and the table made from them."""

from collections import Counter
from collections.abc import Sequence
from typing import Any

from labsid.gap.limits.smallest_sizes import Limits
from labsid.gap.reports.effect_guide import EFFECT_GUIDE
from labsid.gap.reports.effect_texts import noun
from labsid.gap.reports.quantities import in_units, number

SIGNALS = {"input": "u", "output": "y"}
COLUMNS = ("effect", "visible from", "named from", "excluded beyond", "nearest other")
NOT_SHOWN = "–"


def limit_rows(limits: Sequence[Limits]) -> list[dict[str, Any]]:
    """Rows of `limits` in the report.

    Parameters
    ----------
    limits : sequence of Limits

    Returns
    -------
    list of dict
        JSON-ready. `share` holds the sizes as shares `of` a whole, and `at` the other parameters of the planted effect.
        `tested` is filled by the command ``limits`` only.
    """
    return [
        {
            "name": one.name,
            "signal": SIGNALS.get(EFFECT_GUIDE[one.name].path),
            "parameter": one.parameter or None,
            "unit": one.unit or None,
            "detect": one.detect,
            "named": one.named,
            "rival": one.rival,
            "excluded_above": one.excluded,
            "why": _why(one),
            "tested": None,
            "share": one.shares or None,
            "of": one.whole or None,
            "at": one.at,
        }
        for one in limits
    ]


def _why(one: Limits) -> str | None:
    """Why an effect cannot be shown or not be named; None if it can."""
    needed = EFFECT_GUIDE[one.name].excited_by
    if one.reason == "levels":
        return f"The input has too few levels. Needed: {needed}"
    if one.reason == "closed":
        return "The simulation can only be run as a whole, so this effect cannot be put into it."
    if one.reason:
        return f"A refit of the simulation hides it here, at any size. Needed: {needed}"
    if one.named is None:
        other = f"It looks like {noun(one.rival)} here" if one.rival else "It is not told from others here"
        return f"{other}, at any size. Needed: {needed}"
    return None


def limit_cells(report: dict[str, Any]) -> list[tuple[str, ...]]:
    """The cells of the table of limits, one tuple of `COLUMNS` for each effect that the record can show at some size.

    Parameters
    ----------
    report : dict
        With `limits`, and `units` if they are known.
    """
    rows = [row for row in report["limits"] if row["detect"] is not None]
    several = Counter(row["name"] for row in rows)
    return [
        (
            _title(row["name"]) + (f", {row['parameter']}" if several[row["name"]] > 1 else ""),
            *(_sized(report, row, which) for which in ("detect", "named", "excluded_above")),
            _title(row["rival"]) if row["rival"] else NOT_SHOWN,
        )
        for row in rows
    ]


def limits_sentence(report: dict[str, Any]) -> str | None:
    """What the table of limits says; None without limits."""
    if not report["limits"]:
        return None
    excluded = (
        "A size beyond the third is excluded at 95 %."
        if any(row["excluded_above"] is not None for row in report["limits"])
        else "A simulation that leaves more than noise excludes nothing: the sizes hold beside what is left."
    )
    return (
        "One effect at a time, added to the fitted simulation: from the first size on it is seen in nine of ten such "
        f"records, from the second on it is also told from every other effect. {excluded} In brackets, the size as a "
        "share: of the range of u for effects at the input, of the range of y at the output, of the slowest time "
        "constant for times, and of the gain."
    )


def hidden_sentences(report: dict[str, Any]) -> list[str]:
    """The effects that the record cannot show or tell from others, and why."""
    reasons: dict[str, list[str]] = {}
    for row in report["limits"]:
        if row["why"]:
            reasons.setdefault(row["why"], []).append(_title(row["name"]))
    return [f"{_capitalised(' and '.join(dict.fromkeys(names)))}: {why}" for why, names in reasons.items()]


def _title(name: str) -> str:
    return noun(name).removeprefix("a ").removeprefix("an ")


def _capitalised(text: str) -> str:
    return text[:1].upper() + text[1:]


def _sized(report: dict[str, Any], row: dict[str, Any], which: str) -> str:
    """A size with its unit, and as a share."""
    value, share = row[which], f"{number(100.0 * row['share'][which], 2)} %" if row["share"].get(which) else ""
    if value is None:
        return NOT_SHOWN
    if row["unit"] == "1":
        return share
    unit = in_units(row["unit"], **report["units"]) if "units" in report else row["unit"]
    return f"{number(value)} {unit} ({share})"
