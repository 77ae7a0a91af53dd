"""The page of a record of several signals: one self-contained file without scripts, made from the JSON report alone."""

from functools import partial
from typing import TYPE_CHECKING, Any

from labsid._texts import joined
from labsid.gap.reports import sentences
from labsid.gap.reports.effect_texts import place_at
from labsid.gap.reports.page_parts import (
    effect_content,
    effect_pictures,
    first_screen,
    has_holdout,
    in_base64,
    input_file,
    load_template,
    overview,
    simulation_sentence,
)
from labsid.gap.reports.quantities import counted
from labsid.gap.reports.signals_details import detail_figures, output_details
from labsid.gap.reports.signals_text import (
    ambiguity_sentence,
    coupling_sentence,
    finding_sentences,
    gap_sentence,
    headline,
    of_worst_output,
    output_rows,
    remaining_sentence,
    verdict_sentence,
    where_sentences,
)

if TYPE_CHECKING:
    from labsid.plots.page_figures import PageFigure


def render_signals(report: dict[str, Any]) -> str:
    """The report of several signals as HTML without external resources.

    Parameters
    ----------
    report : dict
        In the layout ``labsid.gap/4``.

    Returns
    -------
    str
        Verdict, effects, figures, gap by output, couplings, location, next step and findings.
    """
    content = {"page": page_content(report), "pictures": encoded_figures(report)}
    return load_template("signals.html.j2").render(content)


def page_content(report: dict[str, Any]) -> dict[str, Any]:
    """The content of the page as plain text, by the names that the template uses."""
    signals, probable = report["signals"], [one for one in report["effects"] if sentences.is_probable(one)]
    drawn = of_worst_output(report)
    return overview(report, drawn) | {
        "first": first_screen(report, drawn, headline(report), remaining_sentence(report)),
        "signals": f"{counted(len(signals['inputs']), 'input', 'inputs')} and "
        f"{counted(len(signals['outputs']), 'output', 'outputs')}",
        "sentence": verdict_sentence(report),
        "simulation": simulation_sentence(report),
        "gap": gap_sentence(report),
        "effects": [_effect(report, effect) for effect in report["effects"]],
        "parameters": any(effect["parameters"] for effect in report["effects"]),
        "alternatives": ambiguity_sentence(report),
        "places": joined(list(dict.fromkeys(_place(effect) for effect in probable))),
        "table": _table(report),
        "couplings": coupling_sentence(report),
        "not_drawn": _not_drawn(report),
        "where": where_sentences(report),
        "main": drawn["names"]["u"],
        "worst": report["where"]["output"],
        "rest": report["unexplained"]["output"],
        "look": sentences.look_sentence(report),
        "experiment": _experiment(report),
        "findings": finding_sentences(report),
        "outputs": output_details(report),
        "all_outputs": len(report["outputs"]),
        "stabilised": report["gap"]["mode"] == "stabilised",
        "holdout": has_holdout(report),
    }


def _table(report: dict[str, Any]) -> list[tuple[str, ...]]:
    """The gap by output, with its titles; without what a correction closes if nothing was corrected."""
    rows = [("Output", "Before", "After", "Noise", "Gap closed"), *output_rows(report)]
    if not sentences.is_unchanged(report):
        return rows
    return [("Output", "Simulation", "Noise"), *((name, before, noise) for name, before, _, noise, _ in rows[1:])]


def _effect(report: dict[str, Any], effect: dict[str, Any]) -> dict[str, Any]:
    """An effect with its signal in the title, and the outputs in which it is seen."""
    return effect_content(report, effect) | {
        "title": sentences.capitalised(sentences.placed_noun(effect)),
        "place": f"seen in {joined(effect['outputs'])}",
        "closed": None,  # of all effects together only
    }


def _place(effect: dict[str, Any]) -> str:
    """Where to look for the cause of an effect."""
    return place_at(effect) or f"in the dynamics of {joined(effect['outputs'])}"


def _not_drawn(report: dict[str, Any]) -> str:
    """The inputs whose samples are not in the report."""
    from labsid.plots.signals import inputs_shown

    shown = inputs_shown(report)
    return joined([one["name"] for one in report["signals"]["inputs"] if one["name"] not in shown])


def _experiment(report: dict[str, Any]) -> dict[str, Any] | None:
    """The sentence on the proposed inputs, and the inputs as a file."""
    planned = report["next_experiment"]
    if planned is None:
        return None
    return {
        "text": sentences.experiment_sentence(report),
        "header": ",".join(["t", *planned["u"]]),
        "csv": input_file(planned["t"], planned["u"]),
    }


def with_titles(report: dict[str, Any]) -> dict[str, Any]:
    """The report with the title of each effect, as the figures show it."""
    titled = [one | {"title": sentences.noun_without_article(one["name"])} for one in report["effects"]]
    return report | {"effects": titled}


def encoded_figures(report: dict[str, Any]) -> dict[str, dict[str, str]]:
    """The figures as PNG in base64, each for a wide and for a narrow screen."""
    from labsid.plots.couplings import figure_couplings
    from labsid.plots.gap import figure_first, figure_location
    from labsid.plots.page_figures import in_both_widths
    from labsid.plots.signals import figure_planned_inputs, figure_signals

    of_worst: dict[str, PageFigure] = {"first": figure_first}
    figures: dict[str, PageFigure] = {"signals": figure_signals}
    if report["couplings"]:
        figures["couplings"] = figure_couplings
    if report["verdict"] != "none":
        figures["zoom"] = partial(figure_signals, zoom=True)
        of_worst["where"] = figure_location
    if has_holdout(report):
        figures["holdout"] = partial(figure_signals, traces="holdout_traces")
    if report["next_experiment"] is not None:
        figures["experiment"] = figure_planned_inputs
    drawn = in_both_widths(figures, with_titles(report)) | in_both_widths(of_worst, of_worst_output(report))
    return in_base64(drawn | effect_pictures(report) | detail_figures(report))
