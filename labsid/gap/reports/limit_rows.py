"""What a record could have shown of each effect: rows of the report, and the table made from them."""

from collections import Counter
from collections.abc import Callable, Sequence
from typing import Any

from labsid._texts import joined
from labsid.gap.effects.families import DESCRIPTIONS
from labsid.gap.limits.smallest_sizes import Limits
from labsid.gap.reports.effect_texts import noun
from labsid.gap.reports.quantities import number, unit_in_words
from labsid.gap.reports.sentences import capitalised, noun_without_article, uncapitalised

SIGNALS = {"input": "u", "output": "y"}
COLUMNS = ("effect", "visible from", "named from", "excluded", "nearest other")
NOT_SHOWN = "–"


def as_rows(limits: Sequence[Limits]) -> list[dict[str, Any]]:
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
            "signal": SIGNALS.get(DESCRIPTIONS[one.name].path),
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
    needed = DESCRIPTIONS[one.name].excited_by
    if one.reason == "levels":
        return f"The input has too few levels. Needed: {needed}"
    if one.reason == "closed":
        return "The simulation can only be run as a whole, so this effect cannot be put into it."
    if one.reason == "beside":
        return "It cannot be combined with the dynamics of what was found."
    if one.reason == "stabilised":
        return "The rig is unstable; beside the correction of its simulation, this effect is not tried."
    if one.reason:
        return f"A refit of the simulation hides it here, at every size that was tried. Needed: {needed}"
    if one.named is None:
        other = f"It looks like {noun(one.rival)} here" if one.rival else "It is not told from others here"
        return f"{other}, at every size that was tried. Needed: {needed}"
    return None


def limit_cells(report: dict[str, Any], titles: Callable[[str], str]) -> list[tuple[str, ...]]:
    """The cells of the table of limits, one tuple of `COLUMNS` for each effect that the record can show at some size.

    Parameters
    ----------
    report : dict
        With `limits`, and `units` if they are known.
    titles : callable
        Title of an effect by its name.
    """
    return [
        (
            title,
            _sized(report, row),
            *(_share(row, which) for which in ("named", "excluded_above")),
            titles(row["rival"]) if row["rival"] else NOT_SHOWN,
        )
        for title, row in titled_rows(report, titles)
    ]


def titled_rows(report: dict[str, Any], titles: Callable[[str], str]) -> list[tuple[str, dict[str, Any]]]:
    """The rows with a visible size, each with its title; of an effect with several, with the parameter."""
    return _titled([row for row in report["limits"] if row["detect"] is not None], titles)


def _titled(
    rows: list[dict[str, Any]], titles: Callable[[str], str], form: str = "{}, {}"
) -> list[tuple[str, dict[str, Any]]]:
    names = Counter(row["name"] for row in rows)
    both = (row["parameter"] if names[row["name"]] > 1 else None for row in rows)
    return [
        (form.format(titles(row["name"]), part) if part else titles(row["name"]), row)
        for row, part in zip(rows, both, strict=True)
    ]


def limits_content(report: dict[str, Any]) -> dict[str, Any] | None:
    """The table of limits for a page, open if the verdict names nothing, and what cannot be shown; None without limits.

    Parameters
    ----------
    report : dict
        Of one input and one output.
    """
    text = limits_sentence(report)
    if text is None:
        return None
    return {
        "text": text,
        "columns": [capitalised(title) for title in COLUMNS],
        "rows": limit_cells(report, short_noun),
        "hidden": hidden_sentences(report),
        "open": report["verdict"] in ("none", "unknown"),
    }


def titled_limits(report: dict[str, Any]) -> list[dict[str, Any]]:
    """The rows with a visible size, each with its `title`, for the figure of a page."""
    return [row | {"title": title} for title, row in titled_rows(report, short_noun)]


def limits_sentence(report: dict[str, Any]) -> str | None:
    """What the table of limits says; None without limits."""
    if not report["limits"]:
        return None
    if any(row["excluded_above"] is not None for row in report["limits"]):
        last = "A larger size than the last one is excluded at 95 %."
    elif report.get("planned"):
        last = "The input is not applied yet: the noise is that of the record."
    else:
        last = "Nothing is excluded, because more than noise is left: the sizes hold beside what is left."
    return (
        "The smallest size of each effect, alone in the fitted simulation, that is visible in nine of ten such "
        f"records, and the smallest that is told from every other effect. {last} Shares are of the range of the "
        "input for effects at it, of the range of the output for those there, of the slowest time constant for times, "
        "and of the gain."
    )


def hidden_sentences(report: dict[str, Any]) -> list[str]:
    """The effects that the record cannot show or tell from others, and why."""
    reasons: dict[str, list[str]] = {}
    for title, row in _titled(report["limits"], noun_without_article, "{} ({})"):
        if row["why"]:
            reasons.setdefault(row["why"], []).append(title)
    return [
        f"{capitalised(joined(list(dict.fromkeys(names))))}: {uncapitalised(why)}" for why, names in reasons.items()
    ]


def short_noun(name: str) -> str:
    """The noun of an effect without its article, as a title."""
    return capitalised(noun_without_article(name))


def _sized(report: dict[str, Any], row: dict[str, Any]) -> str:
    """The smallest visible size with its unit, and as a share."""
    is_known = "units" in report or "names" in report
    unit = unit_in_words(row["unit"], report) if is_known else row["unit"]
    return _share(row, "detect") if unit == "1" else f"{number(row['detect'])} {unit} ({_share(row, 'detect')})"


def _share(row: dict[str, Any], which: str) -> str:
    share = row["share"][which]
    return NOT_SHOWN if share is None else f"{number(100.0 * share, 2)} %"
