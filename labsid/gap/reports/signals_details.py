"""What the page of several signals shows of single outputs and of pairs of signals, made from the JSON report alone."""

import base64
from typing import Any

import numpy as np

from labsid.gap.reports import sentences
from labsid.gap.reports.limit_rows import limits_content, titled_limits
from labsid.gap.reports.pole_rows import drawn_dynamics, poles_sentence
from labsid.gap.reports.residual_curves import find_residual_curves
from labsid.gap.reports.response_curves import find_response_curves
from labsid.gap.reports.signals_text import MIN_COUPLING, of_output
from labsid.plots.signal_names import pair_of

MOST_OUTPUTS = 4  # with details of their own: the page stays below 1.5 MB
MOST_PAIRS = 12  # of signals in a figure of responses


def detailed_outputs(report: dict[str, Any]) -> list[str]:
    """The outputs with details of their own, the largest gap first."""
    shares = report["where"]["outputs"]
    return sorted(report["outputs"], key=lambda name: -shares.get(name, 0.0))[:MOST_OUTPUTS]


def output_details(report: dict[str, Any]) -> list[dict[str, Any]]:
    """Texts on the residual, the poles and the limits of each output with details."""
    return [
        {
            "name": name,
            "main": view["names"]["u"],
            "residual": sentences.residual_sentences(view),
            "poles": poles_sentence(view),
            "limits": limits_content(view),
        }
        for name in detailed_outputs(report)
        for view in [of_output(report, name)]
    ]


def detail_figures(report: dict[str, Any]) -> dict[str, dict[str, bytes]]:
    """Pictures of residual, poles and limits by output, and of the responses of all pairs, for both screens.

    Their names are those of the page of one signal and the number of the output, from 1.
    """
    from labsid.plots.gap import figure_limits
    from labsid.plots.gap_details import figure_gains, figure_poles, figure_residual, figure_steps
    from labsid.plots.page_figures import in_both_widths

    found: dict[str, dict[str, bytes]] = {}
    for i, name in enumerate(detailed_outputs(report), 1):
        view = of_output(report, name)
        residual, poles = find_residual_curves(view), drawn_dynamics(view)
        limits = titled_limits(view) if report["verdict"] in ("none", "unknown") else []
        drawn = (
            ("residual", figure_residual, residual),
            ("poles", figure_poles, poles),
            ("limits", figure_limits, limits),
        )
        figures = {f"{key} {i}": figure for key, figure, content in drawn if content}
        found |= in_both_widths(figures, view | {"residual": residual, "poles": poles, "limits": limits})
    pairs = paired_responses(report)
    for key, figure in (("step", figure_steps), ("frequency", figure_gains)):
        own = [pair for pair in pairs if getattr(pair["responses"], key) is not None]
        found |= in_both_widths({key: figure}, {"pairs": own}) if own else {}
    return found


def paired_responses(report: dict[str, Any]) -> list[dict[str, Any]]:
    """Responses of the outputs to each input that moves them, those of the strongest inputs.

    Parameters
    ----------
    report : dict
        Those written by earlier versions do not hold the samples of all inputs, and have none.

    Returns
    -------
    list of dict
        By output and input, each a report of one input and one output with `responses`.
    """
    samples, shares = (
        report.get("input_samples"),
        {(one["from"], one["to"]): one["share"] for one in report["couplings"]},
    )
    if samples is None:
        return []
    strongest = sorted((pair for pair in shares if shares[pair] >= MIN_COUPLING), key=lambda pair: -shares[pair])
    found: dict[tuple[str, str], dict[str, Any]] = {}
    for output in dict.fromkeys(output for _, output in strongest[:MOST_PAIRS]):
        view = of_output(report, output)
        inputs = [view["names"]["u"], *(name for name in samples if name != view["names"]["u"])]
        further = [np.frombuffer(base64.b64decode(samples[name]), "<f8") for name in inputs[1:]]
        for name, responses in zip(inputs, find_response_curves(view, further), strict=True):
            if responses is not None:
                found[name, output] = view | pair_of(report, name, output) | {"responses": responses}
    order = [(u["name"], y["name"]) for y in report["signals"]["outputs"] for u in report["signals"]["inputs"]]
    return [found[pair] for pair in order if pair in found and pair in strongest[:MOST_PAIRS]]
