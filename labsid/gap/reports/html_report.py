"""The HTML report: one self-contained file, made from the JSON report alone."""

import base64
import gzip
from pathlib import Path
from typing import Any

from labsid._files import write_file
from labsid._texts import joined
from labsid.gap.effects.detected import UNSIMULATED
from labsid.gap.reports import sentences
from labsid.gap.reports.effect_texts import REMAINING_ERRORS
from labsid.gap.reports.glance import on_track
from labsid.gap.reports.limit_rows import limits_content, titled_limits
from labsid.gap.reports.location import share_by_record
from labsid.gap.reports.location_text import location_sentences
from labsid.gap.reports.page_parts import (
    TEMPLATES,
    digest,
    effect_pictures,
    effects_content,
    first_screen,
    has_holdout,
    has_probabilities,
    in_base64,
    input_file,
    load_template,
    overview,
    simulation_sentence,
)
from labsid.gap.reports.pole_rows import drawn_dynamics, poles_sentence
from labsid.gap.reports.quantities import number, percent, probability
from labsid.gap.reports.residual_curves import find_residual_curves
from labsid.gap.reports.response_curves import find_response_curves
from labsid.gap.reports.rivals import rival_responses
from labsid.gap.reports.signals_page import render_signals
from labsid.gap.reports.traces import record_traces, worst_of_records, worst_stretch
from labsid.plots.signal_names import name_of

VISIBLE_ROWS = 8  # rows of the ranking outside the collapsed part


def write_html_report(path: Path, report: dict[str, Any]) -> None:
    """Write the report as one HTML file without external resources.

    Parameters
    ----------
    path : Path
        An existing file is replaced.
    report : dict
        Of one input and one output, or of several signals.

    Raises
    ------
    OSError
        If the file cannot be written.
    """
    render = render_signals if "signals" in report else render_html
    write_file(path, render(report).encode())


def render_html(report: dict[str, Any]) -> str:
    """The report as HTML without external resources; its scripts replace the figure of the simulations by panels."""
    content = {"page": page_content(report), "pictures": encoded_figures(report), "scripts": scripts(report)}
    return load_template("gap.html.j2").render(content)


def page_content(report: dict[str, Any]) -> dict[str, Any]:
    """The content of the page as plain text, by the names that the template uses."""
    from labsid.plots.gap_curves import noise_band

    names = {signal: name_of(report, signal) for signal in ("u", "y")}
    first = first_screen(report, report, sentences.headline(report), sentences.remaining_sentence(report))
    return overview(report, report) | {
        "first": first,
        "names": names if "names" in report else None,
        "noise": noise_band(report)[1],
        "sentence": sentences.verdict_sentence(report),
        "simulation": simulation_sentence(report),
        "stabilised": report["gap"].get("mode") == "stabilised",
        "gap": sentences.gap_sentence(report),
        "start": sentences.start_sentence(report),
        "baseline": sentences.baseline_sentence(report),
        "records": sentences.record_rows(report),
        "records_text": sentences.records_sentence(report),
        "kinds": _kinds(report),
        "effects": effects_content(report),
        "refitted": sentences.is_mismatch(report) and not sentences.is_unchanged(report),
        "alternatives": sentences.ambiguity_sentence(report),
        "record": sentences.record_sentences(report),
        "screen": report["screen"],
        "holdout": has_holdout(report),
        "correction": sentences.correction(report),
        "plateaus": sentences.plateaus_matter(report),
        "ranking_text": sentences.ranking_sentence(report),
        "has_probabilities": has_probabilities(report),
        "place": sentences.place_sentence(report),
        "where": location_sentences(report),
        "fitted_baseline": sentences.fitted_baseline_sentence(report),
        "ranking": _ranking(report),
        "shown": VISIBLE_ROWS,
        "tried": [sentences.noun_without_article(name) for name in sentences.effects_tried(report)],
        "residual": sentences.residual_sentences(report),
        "experiment": _experiment(report),
        "look": sentences.look_sentence(report),
        "poles": poles_sentence(report),
        "limits": limits_content(report),
    }


def _ranking(report: dict[str, Any]) -> list[dict[str, Any]]:
    """Rows of the ranking; that of the accepted explanation includes its closed share on held-out samples."""
    gap = report["gap"]
    accepted = {effect["name"] for effect in report["effects"]} - {*UNSIMULATED, "parameter-mismatch"}
    rows = []
    for row in report["ranking"]:
        names, closed = row["name"].split("+"), row["closed"]
        ours = report["verdict"] in ("effect", "partial") and set(names) == accepted
        rows.append(
            {
                "name": sentences.capitalised(joined([sentences.noun_without_article(name) for name in names])),
                "probability": probability(row["probability"]),
                "chance": f"{100.0 * row['probability']:.1f}",
                **on_track(closed, gap["ci95"] if ours and not has_probabilities(report) else row.get("ci95")),
                "rmse": number(row["rmse"]),
                "accepted": ours,
                "held_out": on_track(gap["closed"], gap["ci95"])
                if ours and gap["closed"] is not None and has_probabilities(report)
                else None,
            }
        )
    return rows


def _kinds(report: dict[str, Any]) -> list[dict[str, str]]:
    """Shares of the remaining error by the kind of model that reduces it, as bars."""
    kinds = report["unexplained"]["kinds"] if sentences.has_kinds(report) else {}
    return [
        {
            "label": sentences.capitalised(REMAINING_ERRORS[name].label),
            "value": percent(share),
            "width": f"{100.0 * share:.1f}" if share > 0.0 else "",
        }
        for name, share in kinds.items()
    ]


def _experiment(report: dict[str, Any]) -> dict[str, Any] | None:
    """The sentence on the proposed input, and the input as a file."""
    planned = report["next_experiment"]
    if planned is None:
        return None
    return {"text": sentences.experiment_sentence(report), "csv": input_file(planned["t"], {"u": planned["u"]})}


def encoded_figures(report: dict[str, Any]) -> dict[str, dict[str, str]]:
    """The figures as PNG in base64, each for a wide and for a narrow screen."""
    from labsid.plots.gap import figures_as_png

    if report.get("records"):
        name, _, worst = worst_of_records(report)
        report = report | {"stretch": worst, "stretch_of": name, "record_traces": record_traces(report)}
        shares = share_by_record(report["where"]["time"], report["records"], report["record"]["Ts"])
        report = report | {"by_record": shares}
    else:
        part = "record" if report["holdout_traces"] is None else "holdout"
        report = report | {"stretch": worst_stretch(report, part)}
    more: dict[str, Any] = {
        "limits": titled_limits(report),
        "residual": find_residual_curves(report),
        "responses": find_response_curves(report)[0],
    }
    more |= {"rivals": rival_responses(report), "poles": drawn_dynamics(report)}
    figures = figures_as_png(report | more)
    return in_base64(figures | effect_pictures(report))


def scripts(report: dict[str, Any]) -> dict[str, Any]:
    """The scripts of the page, their digests for its security policy, and their data."""
    from labsid.gap.reports.replay_page import page_data, page_script
    from labsid.plots.gap_panels import panel_script

    library, own = panel_script(), page_script(report, (TEMPLATES / "replay.js").read_text(encoding="utf-8"))
    return {
        "own": own,
        "library": _packed_text(library),
        "digests": [digest(text) for text in (library, own)],
        "data": _packed_text(page_data(report)),
        "switches": bool(report.get("replay")),
    }


def _packed_text(text: str) -> str:
    """A text as the script of the page unpacks it: less than half its size."""
    return base64.b64encode(gzip.compress(text.encode(), mtime=0)).decode("ascii")
