"""What the pages of the reports share: templates, error bars, effects, files and the command."""

import base64
import csv
import hashlib
import html
import io
import math
import re
import shlex
from collections.abc import Mapping, Sequence
from itertools import groupby, pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Any

from labsid._texts import joined
from labsid.gap.effects.detected import UNSIMULATED
from labsid.gap.effects.families import DESCRIPTIONS
from labsid.gap.reports import sentences
from labsid.gap.reports.effect_curves import effect_curve
from labsid.gap.reports.effect_texts import parameter_rows
from labsid.gap.reports.glance import chances_sentence, next_step, on_track, shown_sentence
from labsid.gap.reports.loop import control_loop
from labsid.gap.reports.quantities import closed_percent, number
from labsid.plots.signal_names import name_of, pair_of_effect, unit_of
from labsid.plots.style import STYLE_SHEETS

if TYPE_CHECKING:
    import jinja2

TEMPLATES = Path(__file__).parent / "templates"
_UNBREAKABLE = r" %( \[-?\d+, -?\d+\])?|(?<=\d) (s|Hz)\b|\bp [=<>] (?=\d)"
_FRAME = (
    '<iframe srcdoc="{}" style="width: 100%; height: 48rem; border: 0" title="Diagnosis of the gap"'
    ' sandbox="allow-scripts allow-downloads"></iframe>'
)  # the scripts of the page have no access to the notebook


def simulation_sentence(report: dict[str, Any]) -> str:
    """The simulation that was compared with the record."""
    if not report["simulation"]["given"]:
        return "No simulation was given, so a linear model fitted to the record takes its place."
    if report["simulation"].get("output") is not None or report["simulation"]["output_only"]:
        return "Only the output of your simulation was given."
    return "The record is compared with the simulation that you gave, unchanged."


def overview(report: dict[str, Any], drawn: dict[str, Any]) -> dict[str, Any]:
    """What every page shows: the record, and how to make the report again; `drawn` is as in `first_screen`."""
    record = report["record"]
    return {
        "verdict": report["verdict"],
        "name": record["name"] or "record",
        "samples": record["samples"],
        "Ts": f"{record['Ts']:.6g}",
        "duration": f"{record['samples'] * record['Ts']:.4g}",
        "next": next_step(report),
        "at_most": "noise" if sentences.is_noise_alone(drawn) else "noise, with what no model predicts,",
        "command": command(report),
        "exact": "command" in report,
    }


def first_screen(report: dict[str, Any], drawn: dict[str, Any], headline: str, remaining: str | None) -> dict[str, Any]:
    """What the first screen shows beside the figure, as plain text.

    Parameters
    ----------
    report : dict
        Of one input and one output, or of several signals.
    drawn : dict
        The report of the output in the figure: `report` itself where there is only one.
    headline, remaining : str
        The verdict, and what remains.
    """
    shares = _closed_shares(report, drawn)
    return {
        "headline": headline,
        "remaining": remaining,
        "unit": unit_of(drawn),
        "bars": error_bars(drawn),
        "shares": shares,
        "of_all": len(shares) > 1,
        "chances": chances_sentence(report),
        "shown_effects": shown_sentence(report),
        "loop": control_loop(report),
    }


def _closed_shares(report: dict[str, Any], drawn: dict[str, Any]) -> list[dict[str, str]]:
    """The closed share of the gap as a bar; of several outputs, that of the output in the figure, and that of all."""
    several = len(report.get("outputs", ())) > 1
    named = [(f"Gap closed in {name_of(drawn, 'y')}", drawn), ("In all outputs", report)]
    return [
        {"label": label} | on_track(one["gap"]["closed"], one["gap"]["ci95"])
        for label, one in (named if several else [("Gap closed", report)])
        if one["gap"]["closed"] is not None and not sentences.is_unchanged(one)
    ]


def error_bars(report: dict[str, Any]) -> list[dict[str, Any]]:
    """Rms errors as bars, with lengths in per cent of the longest: before, with each effect, after, and the noise."""
    gap = report["gap"]
    if sentences.is_unchanged(report):
        rows = [("Simulation", gap["before"], "before")]
    else:
        steps = [(label, size, "step") for label, size in _steps(report)]
        after = (f"After {sentences.correction(report)}", gap["after"], "after")
        rows = [("Before", gap["before"], "before"), *steps, after]
    rows += _noise_rows(report)
    longest = max(value for _, value, _ in rows) or 1.0
    return [
        {"label": text, "value": number(value), "width": f"{100.0 * value / longest:.1f}", "colour": colour}
        for text, value, colour in rows
    ]


def _noise_rows(report: dict[str, Any]) -> list[tuple[str, float, str]]:
    """The noise; where something else remains, what no model predicts, and the white noise in it apart."""
    from labsid.plots.gap_curves import noise_band

    floor = report["gap"]["noise_floor"]
    if sentences.is_noise_alone(report):
        return [("Noise alone", floor, "floor")]
    rest = [("Noise and what no model predicts", floor, "rest")]
    if has_probabilities(report):
        return rest
    return [*rest, ("White noise", 0.5 * noise_band(report)[0], "floor")]


def _steps(report: dict[str, Any]) -> list[tuple[str, float]]:
    """The error with the effects of each step but the last one, from the shares of the gap that are closed so far."""
    gap = report["gap"]
    if any(effect["closed"] is None or effect["name"] in UNSIMULATED for effect in report["effects"]):
        return []
    floor, before = gap["noise_floor"] ** 2, max(gap["before"] ** 2 - gap["noise_floor"] ** 2, 0.0)
    steps = [(closed, list(added)) for closed, added in groupby(report["effects"], lambda effect: effect["closed"])]
    return [
        (
            f"{'And with' if k else 'With'} {joined([sentences.noun_without_article(one['name']) for one in added])}",
            math.sqrt(floor + before * (1.0 - closed) ** 2),
        )
        for k, (closed, added) in enumerate(steps[:-1])
    ]


def has_probabilities(report: dict[str, Any]) -> bool:
    """Whether the candidates are compared by their probabilities, not by their errors on held-out samples."""
    return report["verdict"] in ("none", "effect")


def effects_content(report: dict[str, Any]) -> list[dict[str, Any]]:
    """The effects as text; of those that were added in one step, the last one has the share that all of them close."""
    effects = report["effects"]
    last = [one["closed"] != then["closed"] for one, then in pairwise(effects)] + [True]
    return [
        effect_content(report, one | {"closed": one["closed"] if shown else None})
        for one, shown in zip(effects, last, strict=False)
    ]


def effect_content(report: dict[str, Any], effect: dict[str, Any]) -> dict[str, Any]:
    """An effect with its explanation and its parameters as text."""
    text = DESCRIPTIONS.get(effect["name"])
    closed = effect["closed"]
    return {
        "title": sentences.capitalised(sentences.noun_without_article(effect["name"])),
        "name": effect["name"],
        "meaning": "" if text is None else text.meaning,
        "chance": sentences.chance_of(effect),
        "place": "",
        "closed": None if closed is None or effect["name"] in UNSIMULATED else closed_percent(closed),
        "parameters": parameter_rows(effect, pair_of_effect(report, effect)),
    }


def effect_pictures(report: dict[str, Any]) -> dict[str, dict[str, bytes]]:
    """The curve of each effect that has one as PNG, by the place of the effect, for a wide and for a narrow screen."""
    from labsid.plots.gap_details import figure_effect
    from labsid.plots.page_figures import in_both_widths

    found = {f"effect {i}": effect_curve(report, effect) for i, effect in enumerate(report["effects"], 1)}
    curves = {name: curve for name, curve in found.items() if curve is not None}
    return {name: in_both_widths({name: figure_effect}, curve)[name] for name, curve in curves.items()}


def has_holdout(report: dict[str, Any]) -> bool:
    """Whether the gap is scored on another record."""
    outputs = report["outputs"].values() if "signals" in report else [report]
    return any(one.get("holdout_traces") is not None for one in outputs)


def input_file(t: Sequence[float], inputs: Mapping[str, Sequence[float]]) -> str:
    """Inputs over time as a CSV file in base64; its header is ``t`` and their names."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(["t", *inputs])
    writer.writerows(zip(t, *inputs.values(), strict=True))
    return base64.b64encode(text.getvalue().encode()).decode("ascii")


def in_base64(figures: Mapping[str, Mapping[str, bytes]]) -> dict[str, dict[str, str]]:
    """Pictures in base64, by figure and screen."""
    return {
        name: {screen: base64.b64encode(png).decode("ascii") for screen, png in screens.items()}
        for name, screens in figures.items()
    }


def command(report: dict[str, Any]) -> str:
    """The command that reproduces this page, for a POSIX shell."""
    given = report.get("command")
    if given:
        return str(given)
    names = [row["name"] for row in report.get("records", ())] or [report["record"]["name"] or "RECORD"]
    words = ["labsid", "gap", "diagnose", *names]
    for direction, own in report.get("signals", {}).items():
        words += [f"--{direction}", ",".join(one["name"] for one in own)]
    if report["simulation"]["given"]:
        words += ["--sim", "MODEL"]
    if has_holdout(report):
        words += ["--holdout", "RECORD2"]
    return shlex.join([*words, "--json", "report.json", "--html", "report.html"])


def digest(script: str) -> str:
    """The digest by which a security policy allows an inline script."""
    return base64.b64encode(hashlib.sha256(script.encode()).digest()).decode("ascii")


def in_frame(page: str) -> str:
    """A page as an element of a notebook."""
    return _FRAME.format(html.escape(page))


def load_template(name: str) -> "jinja2.Template":
    """A template of this package; values are escaped, and numbers stay on one line with their units."""
    import jinja2

    loader = jinja2.FileSystemLoader([TEMPLATES, STYLE_SHEETS])
    environment = jinja2.Environment(
        loader=loader, autoescape=True, undefined=jinja2.StrictUndefined, trim_blocks=True, finalize=_no_break
    )
    return environment.get_template(name)


def _no_break(value: Any) -> Any:
    """Keep numbers with their units and intervals on one line."""
    if not isinstance(value, str) or hasattr(value, "__html__"):  # markup: its parts have been processed already
        return value
    return re.sub(_UNBREAKABLE, lambda found: found[0].replace(" ", "\u00a0"), value)
