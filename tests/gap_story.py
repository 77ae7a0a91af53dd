"""What two sentences, or a sentence and a number, of one report say differently."""

import re
from typing import Any

from labsid.gap.reports.text_report import format_report

_PERCENT = r"(\d+(?:\.\d+)?) %"
_APART = 1.5  # percentage points between two roundings of one share


def disagreements(report: dict[str, Any]) -> list[str]:
    """Each pair of statements of a report, in its text and its numbers, that cannot both be true.

    Parameters
    ----------
    report : dict
        As ``--json`` writes it.
    """
    text = re.sub(r"\s+", " ", format_report(report))
    gap, left, named = report["gap"], report["unexplained"], report["effects"]
    closed, kinds = gap["closed"], left["kinds"]
    white = "Only white noise remains" in text
    found = {
        "no gap, and a cause": report["verdict"] == "none" and bool(named),
        "no gap, and a part of it that is left": report["verdict"] == "none" and left["share"] != 0.0,
        "a cause without a gap": bool(named) and "There is no gap" in text,
        "only white noise, and something else": white and "Something else remains" in text,
        "only white noise, and a residual that is none": white and "The residual is autocorrelated" in text,
        "white noise that past inputs foretell": white and "It depends on past inputs" in text,
        "noise alone, and an error above it": "leaving noise alone" in text and left["share"] > 0.1,
        "a larger error with the effects than before": bool(named) and gap["after"] > gap["before"],
        "nothing that inputs predict, and a repetition with them": "repeats when the input repeats" in text
        and kinds is not None
        and kinds["disturbance"] > 0.5,
        "kinds of the rest that are not all of it": kinds is not None and abs(sum(kinds.values()) - 1.0) > 0.01,
    }
    told = [what for what, is_so in found.items() if is_so]
    for share in re.findall(rf"{_PERCENT} of the gap remains", text):
        if closed is not None and abs(float(share) - 100.0 * (1.0 - closed)) > _APART:
            told.append(f"{share} % of the gap remains, and {100.0 * closed:.0f} % are closed")
    for share in re.findall(rf"explains(?: only)? {_PERCENT}", text):
        if closed is None or abs(float(share) - 100.0 * closed) > _APART:
            told.append(f"{share} % are explained, and {closed} are closed")
    for share in re.findall(rf"Something else remains: {_PERCENT}", text):
        if kinds is None or abs(float(share) - 100.0 * max(kinds.values())) > _APART:
            told.append(f"{share} % of the rest are of the main kind, and the kinds are {kinds}")
    for share in re.findall(_PERCENT, text.split(" where ")[-1].split(" residual ")[0] if " where " in text else ""):
        if float(share) > 100.0:
            told.append(f"{share} % of the gap at one place")
    steps = [one["closed"] for one in named if one.get("closed") is not None]
    if steps and closed is not None and abs(max(steps) - closed) > 0.01 * _APART and steps[-1] == max(steps):
        told.append(f"{steps} closed with the effects one after the other, and {closed} in all")
    return told
