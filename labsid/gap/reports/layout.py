"""The layout of the JSON report, and the entries that reports of one signal and of several have in common."""

from collections.abc import Iterable
from typing import Any

from labsid.lab.findings import Finding

SCHEMA = "labsid.gap/4"


def listed_findings(
    findings: Iterable[Finding], screen: Iterable[str], signal: str | None = None
) -> list[dict[str, Any]]:
    """What the record itself shows, before and beside any effect.

    Parameters
    ----------
    findings : iterable of Finding
        Of the whole record.
    screen : iterable of str
        What its samples show, and what was done to them; of one signal, if it is given.
    signal : str, optional

    Returns
    -------
    list of dict
        ``{kind, signal, text}``; the signal is None for what belongs to no single one.
    """
    return [
        *({"kind": finding.topic, "signal": None, "text": finding.text} for finding in findings),
        *({"kind": "samples", "signal": signal, "text": text} for text in screen),
    ]
