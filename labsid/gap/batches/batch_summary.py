"""The summary of a batch as CSV and as text, from the JSON reports alone."""

from collections import Counter
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from labsid._files import csv_text

COLUMNS = ("stem", "verdict", "effects", "probability", "closed", "error")
MAX_ERRORS = 5  # in the printed summary


def csv_summary(reports: Mapping[str, dict[str, Any]]) -> str:
    """One row for each report, in order of the stems, with the header `COLUMNS`."""
    return csv_text(COLUMNS, (_row(stem, reports[stem]) for stem in sorted(reports)))


def _row(stem: str, report: dict[str, Any]) -> Iterator[str]:
    effects = report.get("effects", [])
    probability = effects[0]["probability"] if effects else None
    closed = report.get("gap", {}).get("closed")
    yield from (stem, report["verdict"], "+".join(effect["name"] for effect in effects))
    yield from ("" if value is None else f"{value:.6g}" for value in (probability, closed))
    yield report.get("message", "")


def text_summary(reports: Mapping[str, dict[str, Any]], kept: int, table: Path, noun: str = "records") -> str:
    """Number of reports by verdict and by effects, and the first errors.

    Parameters
    ----------
    reports : mapping of str to dict
        By stem.
    kept : int
        Number of reports from an earlier run.
    table : Path
        The summary as CSV, to be named.
    noun : str
        What several of them are called.
    """
    verdicts = Counter(report["verdict"] for report in reports.values())
    counts = ", ".join(f"{verdict} {verdicts[verdict]}" for verdict in sorted(verdicts))
    earlier = f" ({kept} from an earlier run)" if kept else ""
    lines = [f"{len(reports)} {noun}: {counts}{earlier}"]
    named = [report["effects"] for report in reports.values() if report.get("effects")]
    names = Counter("+".join(effect["name"] for effect in effects) for effects in named)
    lines += [f"  {count:4d}  {name}" for name, count in names.most_common()]
    errors = [f"  {stem}: {reports[stem]['message']}" for stem in sorted(reports) if "message" in reports[stem]]
    lines += errors[:MAX_ERRORS]
    if len(errors) > MAX_ERRORS:
        lines.append(f"  and {len(errors) - MAX_ERRORS} more errors")
    return "\n".join([*lines, f"Summary: {table}"])
