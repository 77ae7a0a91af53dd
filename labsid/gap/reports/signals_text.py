"""The text report of a record of several signals, made from the JSON report alone."""

from typing import Any

from labsid._texts import joined
from labsid.gap.reports import sentences
from labsid.gap.reports.effect_texts import clause, noun, place_at
from labsid.gap.reports.glance import next_step
from labsid.gap.reports.limit_rows import limits_sentence
from labsid.gap.reports.location_text import location_sentences
from labsid.gap.reports.quantities import closed_percent, number, percent
from labsid.gap.reports.text_report import (
    bar_lines,
    effect_lines,
    limits_table_lines,
    printable,
    titled_lines,
    titled_table,
)
from labsid.gap.verdict.scores import NO_GAP_RMS
from labsid.plots.signal_names import pair_of

COLUMNS = ("rms error of", "before", "after", "noise", "closed")
MIN_COUPLING = 0.005  # share of an output's response, from which an input is listed


def format_signals(report: dict[str, Any]) -> str:
    """Format the report of several signals as text.

    Parameters
    ----------
    report : dict
        In the layout ``labsid.gap/4``.

    Returns
    -------
    str
        Lines of at most 96 characters: the verdict; the causes, each with the signal at which it acts; the gap by
        output; what moves what; where the gap of the worst output lies; the next experiment; findings; without a
        known cause, what the record could have shown in each output.
    """
    lines = [*titled_lines("", verdict_sentence(report), indent=0), ""]
    for effect in report["effects"]:
        lines += effect_lines(report, effect, place_of(effect))
    lines += titled_lines("ambiguous", ambiguity_sentence(report))
    lines += titled_lines("gap", gap_sentence(report))
    lines += titled_table("outputs", [COLUMNS, *(tuple(map(printable, row)) for row in output_rows(report))])
    drawn = of_worst_output(report)
    lines += [*titled_lines("largest", f"Rms error of {drawn['names']['y']}:"), *bar_lines(drawn)]
    lines += titled_lines("signals", coupling_sentence(report))
    if report["verdict"] != "none":
        lines += titled_lines("where", " ".join(where_sentences(report)))
    if report["next_experiment"] is not None:
        said = sentences.experiment_sentence(report)
        lines += titled_lines("next", f"Apply the inputs that --json writes as next_experiment. {said}")
    else:
        lines += titled_lines("next", next_step(report))
    for count, finding in enumerate(finding_sentences(report)):
        lines += titled_lines("" if count else "record", printable(finding))
    if report["verdict"] in ("none", "unknown"):
        views = [of_output(report, name) for name in report["outputs"]]
        lines += titled_lines("limits", next((said for said in map(limits_sentence, views) if said), ""))
        for view in views:
            table = limits_table_lines(view)
            lines += [*titled_lines("", f"In {printable(view['names']['y'])}:"), *table] if table else []
    return "\n".join(printable(line) for line in lines)


def verdict_sentence(report: dict[str, Any]) -> str:
    """The verdict: each cause with its signal, and what remains."""
    return " ".join(text for text in (headline(report), remaining_sentence(report)) if text)


def headline(report: dict[str, Any]) -> str:
    """The verdict without what remains: each cause with its signal, and the share of the gap that is explained."""
    gap, effects = report["gap"], report["effects"]
    if not effects:
        size = _over_noise(gap, "before")
        if report["verdict"] == "none":
            before = "the simulation" if report["simulation"]["given"] else "a linear model fitted to the record"
            return f"There is no gap beyond noise: the rms error of {before} is {size}."
        before = "simulation" if report["simulation"]["given"] else "linear model"
        return f"None of the effects tried explains the gap: the rms error of the {before} is {size}."
    explain = _gain(gap)
    probable = [effect for effect in effects if sentences.is_probable(effect)]
    if not probable:
        added = "what was added to the simulation"
        return f"The cause of the gap is not known: {added} {explain}, but may only imitate it."
    clauses = [f"{sentences.capitalised(f'{_placed(effect)}{_qualified(effect)}')}." for effect in probable]
    named = sentences.acting(probable)
    said = f"{named}." if named else " ".join(clauses)
    subject = noun(effects[0]["name"]) if len(effects) == 1 else "together this"
    return f"{said} {sentences.capitalised(subject)} {explain}."


def _gain(gap: dict[str, Any]) -> str:
    """The share of the gap that is explained, or what is reduced where there is none on held-out samples."""
    if gap["closed"] is None and gap["before"] <= NO_GAP_RMS * gap["noise_floor"]:
        return "reduces the error on the fitted samples, but held-out samples show no gap"
    if gap["closed"] is None:
        return f"reduces the rms error from {number(gap['before'])} to {number(gap['after'])}"
    return f"explains {closed_percent(gap['closed'], gap['ci95'])} of the gap"


def of_worst_output(report: dict[str, Any]) -> dict[str, Any]:
    """What is known of the output with the largest gap; see `of_output`."""
    return of_output(report, report["where"]["output"])


def of_output(report: dict[str, Any], name: str) -> dict[str, Any]:
    """What is known of an output, as a report of one input and one output.

    Its verdict and effects are those of all outputs.
    """
    own = report["outputs"][name]
    common = {"verdict": report["verdict"], "effects": [effect | {"closed": None} for effect in report["effects"]]}
    limits = [row for row in report["limits"] if row.get("output") == name]
    common |= {"record": report["record"], "limits": limits}
    return {"holdout_traces": None} | own | common | pair_of(report, own["main"], name)


def ambiguity_sentence(report: dict[str, Any]) -> str:
    """The effects that the record does not rule out, each with its signal; empty if there are none."""
    rivals = [f"{noun(one['name'])}{_at(one['signal'] or one.get('joint'))}" for one in report["ambiguous"]]
    return f"The record does not rule out {joined(rivals, 'or')}." if rivals else ""


def finding_sentences(report: dict[str, Any]) -> list[str]:
    """What was found in the samples of the record, with the signal."""
    return [
        f"{one['signal']}: {one['text']}" if one["signal"] and one["signal"] not in one["text"] else str(one["text"])
        for one in report["findings"]
    ]


def _placed(effect: dict[str, Any]) -> str:
    """``At u2: ``, ``from u2 to y1: `` or ``In the dynamics of y1: ``; empty for an effect that names its joint."""
    if effect.get("joint"):
        return ""
    if effect.get("from"):
        return f"from {effect['from']} to {effect['to']}: "
    if effect["signal"]:
        return f"at {effect['signal']}: "
    what = "Beside" if effect["path"] == "disturbance" else "In the dynamics of"
    return f"{sentences.uncapitalised(what)} {joined(effect['outputs'])}: "


def _qualified(effect: dict[str, Any]) -> str:
    """The clause of an effect, with a qualification according to its probability."""
    text = sentences.uncapitalised(clause(effect))
    if effect["probability"] >= sentences.SURE:
        return text
    return f"{'probably' if sentences.is_probable(effect) else 'possibly'} {text}"


def place_of(effect: dict[str, Any]) -> str:
    """Where an effect acts, and on which outputs."""
    seen = f"seen in {joined(effect['outputs'])}"
    return ", ".join(text for text in (place_at(effect), "" if effect.get("from") else seen) if text)


def _at(signal: str | None) -> str:
    return f" at {signal}" if signal else ""


def remaining_sentence(report: dict[str, Any]) -> str | None:
    """What remains, and in which output most of it is; None if no cause is named, or if noise alone remains."""
    if report.get("product"):
        outputs = [name for name, one in report["outputs"].items() if one.get("product")]
        return f"In {joined(outputs)}: {sentences.uncapitalised(sentences.PRODUCTS[report['product']][0])}"
    if report["verdict"] != "partial" or not any(sentences.is_probable(effect) for effect in report["effects"]):
        return None
    return f"Something else remains, most of it in {report['unexplained']['output']}."


def _over_noise(gap: dict[str, Any], key: str) -> str:
    """An error beside the noise."""
    if "over_sd" not in gap:
        return f"{number(gap[key])}, and the noise alone is {number(gap['noise_floor'])}"
    return f"{number(gap[key])} times the noise of each output"


def gap_sentence(report: dict[str, Any]) -> str:
    """The size of the gap over all outputs."""
    gap = report["gap"]
    other = any(one.get("holdout_traces") is not None for one in report["outputs"].values())
    where = "on the holdout" if other else "on held-out samples"
    after = "" if gap["after"] == gap["before"] else f" before and {number(gap['after'])} after"
    if "over_sd" not in gap:
        return f"The rms error is {number(gap['before'])}{after}, {where}."
    beside = " Each output was simulated beside the others as measured." if gap["mode"] == "stabilised" else ""
    sd = gap["over_sd"]
    relative = f"{percent(sd['before'])} of the standard deviation"
    size = f"{number(gap['before'])}{after}, in units of each output's noise"
    return f"Rms over all outputs {where}: {size}; {'before, ' if after else ''}that is {relative}.{beside}"


def output_rows(report: dict[str, Any]) -> list[tuple[str, ...]]:
    """The gap of each output: its name with its unit, errors before and after, the noise, and the closed share."""
    units = {one["name"]: one["unit"] for one in report["signals"]["outputs"]}
    return [
        (
            f"{name} ({units[name]})" if units.get(name) else name,
            *(number(row[key]) for key in ("before", "after", "noise_floor")),
            "–" if row["closed"] is None else closed_percent(row["closed"]),
        )
        for name, row in report["gap"]["outputs"].items()
    ]


def coupling_sentence(report: dict[str, Any]) -> str:
    """Which inputs move each output, the strongest first."""
    texts: list[str] = []
    if not report["couplings"]:
        return ""
    for output in (one["name"] for one in report["signals"]["outputs"]):
        own = sorted((one for one in report["couplings"] if one["to"] == output), key=lambda one: -one["share"])
        listed = [f"{one['from']} {percent(one['share'])}" for one in own if one["share"] >= MIN_COUPLING]
        said = joined(listed) or "no input"
        texts.append(f"{output}: {said}." if texts else f"{output} is moved by {said} (shares of its response).")
    return " ".join(texts)


def where_sentences(report: dict[str, Any]) -> list[str]:
    """The outputs with the gap, and where it lies in the worst one."""
    where = report["where"]
    shares = {name: share for name, share in where["outputs"].items() if share >= MIN_COUPLING}
    texts = []
    if len(where["outputs"]) > 1:
        listed = [f"{name} {percent(share)}" for name, share in sorted(shares.items(), key=lambda item: -item[1])]
        of_all = f"Of the gap, each in units of its noise: {joined(listed)}. " if listed else ""
        texts.append(f"{of_all}In {where['output']}:")
    return [*texts, *location_sentences(report)]
