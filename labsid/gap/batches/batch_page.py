"""The summary of a batch as one HTML page, made from the JSON reports alone, and the pages of its records."""

import json
import math
import os
from collections import Counter
from collections.abc import Iterable, Mapping
from contextlib import closing
from pathlib import Path
from typing import TYPE_CHECKING, Any
from urllib.parse import quote

from labsid._files import write_text
from labsid.gap.batches.workers import run_tasks, serve
from labsid.gap.reports.html_report import write_html_report
from labsid.gap.reports.page_parts import TEMPLATES, digest, load_template
from labsid.gap.reports.quantities import closed_percent, counted, number, probability
from labsid.gap.reports.sentences import capitalised, noun_without_article

if TYPE_CHECKING:
    from labsid.gap.search.beam_search import Progress

VERDICTS = {
    "unknown": ("Not explained", "before"),
    "partial": ("Partly explained", "after"),
    "effect": ("Explained", "after"),
    "none": ("Without a gap", "floor"),
    "error": ("Not diagnosed", "error"),
}  # labels and colours, in the order of the page
RECORD = ("record", "records")


def write_batch_page(
    path: Path, name: str, reports: Mapping[str, dict[str, Any]], nouns: tuple[str, str] = RECORD
) -> None:
    """Write the summary page of a batch, with links to the pages of its records, or to reports that have no page.

    Parameters
    ----------
    path : Path
        In the folder of the reports.
    name : str
        Of the folder of records.
    reports : mapping of str to dict
        Reports in the layout ``labsid.gap/4`` by stem; those with the verdict "error" have a message instead.
    nouns : tuple of str
        What one and several of them are called.

    Raises
    ------
    OSError
        If the file cannot be written.
    """
    links = {stem: f"{stem}.html" if _has_page(path.parent, stem) else f"{stem}.json" for stem in reports}
    write_text(path, render_batch_page(name, reports, links, nouns))


def render_batch_page(
    name: str, reports: Mapping[str, dict[str, Any]], links: Mapping[str, str], nouns: tuple[str, str] = RECORD
) -> str:
    """The summary page as HTML that loads nothing. The largest error remaining, relative to the noise, is first."""
    script = (TEMPLATES / "sort.js").read_text(encoding="utf-8")
    page = batch_page_content(name, reports, links, nouns)
    return load_template("batch.html.j2").render(page=page, script=script, digest=digest(script))


def batch_page_content(
    name: str, reports: Mapping[str, dict[str, Any]], links: Mapping[str, str], nouns: tuple[str, str] = RECORD
) -> dict[str, Any]:
    """The content of the page as plain text, by the names that the template uses."""
    verdicts = Counter(report["verdict"] for report in reports.values())
    effects = Counter(effect["name"] for report in reports.values() for effect in report.get("effects", ()))
    hrefs = {stem: quote(os.fsencode(link), safe="") for stem, link in links.items()}
    errors = {stem: report["message"] for stem, report in reports.items() if report["verdict"] == "error"}
    rows = [_row(stem, report) | {"href": hrefs[stem]} for stem, report in reports.items() if stem not in errors]
    return {
        "name": name,
        "count": counted(len(reports), *nouns),
        "one": nouns[0],
        "several": nouns[1],
        "headline": ", ".join(f"{verdicts[key]} {VERDICTS[key][0].lower()}" for key in VERDICTS if verdicts[key]),
        "verdicts": _bars((*VERDICTS[key], verdicts[key]) for key in VERDICTS if verdicts[key]),
        "effects": _bars((_title(effect), "after", count) for effect, count in effects.most_common()),
        "rows": sorted(rows, key=_rank),
        "errors": [{"stem": stem, "href": hrefs[stem], "message": errors[stem]} for stem in sorted(errors)],
    }


def _bars(counts: Iterable[tuple[str, str, int]]) -> list[dict[str, Any]]:
    """Counts as bars, with lengths in per cent of the longest."""
    rows = list(counts)
    longest = max((count for *_, count in rows), default=1)
    return [
        {"label": label, "colour": colour, "value": count, "width": f"{100.0 * count / longest:.1f}"}
        for label, colour, count in rows
    ]


def _row(stem: str, report: dict[str, Any]) -> dict[str, Any]:
    """A row of the table: numbers for sorting, and texts."""
    gap, effects = report["gap"], report["effects"]
    closed = gap["closed"]
    ratios = {name: gap[name] / gap["noise_floor"] if gap["noise_floor"] else None for name in ("before", "after")}
    chance = effects[0]["probability"] if effects else None
    return {
        "stem": stem,
        "runs": len(report.get("records", ())),
        "verdict": VERDICTS[report["verdict"]][0],
        "colour": VERDICTS[report["verdict"]][1],
        "severity": list(VERDICTS).index(report["verdict"]),
        "effects": [capitalised(_at_signal(effect)) for effect in effects],
        "ambiguous": [
            _at_signal(rival if isinstance(rival, dict) else {"name": rival}) for rival in report["ambiguous"]
        ],
        "probability": (chance, "–" if chance is None else probability(chance)),
        "closed": (closed, "–" if closed is None else closed_percent(closed)),
        "interval": "" if closed is None else closed_percent(closed, gap["ci95"]).partition(" %")[2],
        "width": None if closed is None else f"{100.0 * min(max(closed, 0.0), 1.0):.0f}",
        **{name: (ratio, "–" if ratio is None else number(ratio)) for name, ratio in ratios.items()},
    }


def _at_signal(effect: dict[str, Any]) -> str:
    """The noun of an effect, with the signal at which it acts if there are several."""
    signal = effect.get("signal")
    return noun_without_article(effect["name"]) + (f" at {signal}" if signal else "")


def _rank(row: dict[str, Any]) -> tuple[float, float, str]:
    """Sort key: the largest remaining error relative to the noise first, of equal ones the lowest closed share."""
    after, closed = row["after"][0], row["closed"][0]
    return math.inf if after is None else -after, math.inf if closed is None else closed, row["stem"]


def _title(name: str) -> str:
    return capitalised(noun_without_article(name))


# Pages of the records -------------------------------------------------------------------------------------


def write_record_pages(
    out: Path, reports: Mapping[str, dict[str, Any]], jobs: int, progress: "Progress | None" = None
) -> dict[str, str]:
    """Write ``<stem>.html`` beside each ``<stem>.json`` that has no page yet.

    Parameters
    ----------
    out : Path
        Folder of the JSON reports.
    reports : mapping of str to dict
        By stem. Those with the verdict "error" have no page.
    jobs : int
        Number of processes.
    progress : callable, optional
        Called with a description of the current step and the completed share.

    Returns
    -------
    dict of str to str
        Reasons why pages could not be written, by stem.
    """
    stems = sorted(stem for stem, report in reports.items() if report["verdict"] != "error")
    todo = [stem for stem in stems if not _has_page(out, stem)]
    failed: dict[str, str] = {}
    kept = len(stems) - len(todo)
    tasks = [{"report": str(out / f"{stem}.json"), "page": str(out / f"{stem}.html")} for stem in todo]
    with closing(run_tasks(__name__, tasks, jobs)) as results:
        for done, (task, result) in enumerate(results, kept + 1):
            reason = "its process was killed" if result is None else result["error"]
            if reason is not None:
                failed[todo[task]] = reason
            if progress is not None:
                progress(f"{done} of {len(stems)} pages", done / len(stems))
    return failed


def _has_page(out: Path, stem: str) -> bool:
    """Whether the page of a report exists and is not older than the report."""
    page, report = out / f"{stem}.html", out / f"{stem}.json"
    return page.is_file() and page.stat().st_mtime_ns >= report.stat().st_mtime_ns


def run_worker() -> None:
    """Main function of a worker process of `run_tasks`."""
    serve(_write_record_page)


def _write_record_page(task: dict[str, Any]) -> dict[str, Any]:
    try:
        write_html_report(Path(task["page"]), json.loads(Path(task["report"]).read_text(encoding="utf-8")))
    except Exception as error:  # the other pages are written
        return {"error": " ".join(f"{type(error).__name__}: {error}".split())}
    return {"error": None}
