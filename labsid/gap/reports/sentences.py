"""Sentences of the text and HTML reports, made from the JSON report alone."""

import re
from typing import Any

from labsid._texts import joined
from labsid.gap.effects.detected import UNSIMULATED
from labsid.gap.effects.families import names_where
from labsid.gap.reports.effect_texts import REMAINING_ERRORS, clause, noun, place_at
from labsid.gap.reports.quantities import (
    closed_percent,
    counted,
    number,
    p_value,
    percent,
    probability,
    rounded,
    with_error,
)
from labsid.gap.verdict.scores import NO_GAP_RMS
from labsid.plots.signal_names import unit_of

PLACES = {
    "input": "between the command and the process",
    "dynamics": "in the process",
    "output": "between the process and the record",
    "disturbance": "outside the signal path, independent of the command",
    "parameters": "in the parameters of the simulation, not in its structure",
}
NOVELTIES = {
    "samples": "its length",
    "changes": "how seldom its input changes",
    "noise": "the size of its noise",
    "gap": "the size of the gap",
    "fastest": "the rates of its dynamics",
    "direct": "its response within the sample",
    "unstable": "its unstable dynamics",
}  # by the names of `novelty.RANGES`
PRODUCTS = {
    "output": (
        "A gain that changes with the output, a product of input and output, explains the record as well or better "
        "with fewer numbers: no effect of the list is that.",
        "Apply equal small steps about several levels of the output: do the gain and the time constant change with the "
        "level? Look for an input that multiplies a state, as a flow does a temperature, or a field current a speed.",
    ),
    "wave": (
        "A gain that oscillates explains the record as well or better with fewer numbers: no effect of the list is "
        "that.",
        "Apply constant commands of several sizes: does the oscillation grow with the command? Look for what turns or "
        "ripples and scales the command: a supply voltage, an eccentric wheel, a shaft that is not straight.",
    ),
}  # what explains a record in place of effects, and how to find it on the rig
SURE = 0.9  # probability from which an effect is stated without qualification
SIGNIFICANT = 0.01  # p-value below which a residual test is reported as significant
DEPENDENT = 1e-3  # p-value below which a record without a named cause is said to have a gap
RELIABLE_MARGIN = 20.0  # margin of an experiment from which its decision was right in 995 of 1000 trials
HALF = 0.5  # of a share or a probability
MOST = 0.8  # of a share
CLEARLY_MORE = 1.5  # times the noise: an error on held-out samples that is not noise alone
LEAST_LEFT = 0.05  # of the gap: what remains is then said to be in the noise
SHOWN_SHARE = 0.005  # of the gap, that is printed as more than 0 %
OUTPUT_ERROR, FIRST_ORDER = "output error", "output error of first order"  # methods of `baseline_choice`
NAMED = 0.1  # probability from which a headline names an effect
MOST_NUMBERS = 2  # of a given simulation, that a headline states
MOST_CLAUSES = 2  # of causes in a headline, which has two lines; more are named without their numbers
TWO_ERRORS = 2.0  # standard errors, about a 95 % interval: a number further from its nominal value differs from it
MIN_KIND = 0.05  # share of the remaining error from which a kind is mentioned
MAX_UNACCOUNTED = 0.3  # of the variation between plateaus, that an explanation of it may leave


def verdict_sentence(report: dict[str, Any]) -> str:
    """The verdict in one sentence, and what remains in another one."""
    return " ".join(text for text in (headline(report), remaining_sentence(report)) if text)


def headline(report: dict[str, Any]) -> str:
    """The verdict without what remains."""
    if report["verdict"] == "effect":
        return _effect_sentence(report)
    if report["verdict"] == "partial":
        text = _partial_sentence(report)
        return f"{_holdout_sentence(report)} {text}" if only_on_holdout(report) else text
    return _none_sentence(report) if report["verdict"] == "none" else _unknown_sentence(report)


def _effect_sentence(report: dict[str, Any]) -> str:
    effects, gap = report["effects"], report["gap"]
    several = len(effects) > 1
    clauses = [_qualified(effect) + (f" ({noun(effect['name'])})" if several else "") for effect in effects]
    causes = acting(effects) or joined([clauses[0], *(uncapitalised(text) for text in clauses[1:])], comma=True)
    subject = "together they" if several else noun(effects[0]["name"])
    s = "" if several else "s"
    before, closed = number(gap["before"]), gap["closed"]
    if all(effect["name"] in UNSIMULATED for effect in effects):
        name = "" if several else f": {subject}"
        if gap["before"] <= NO_GAP_RMS * gap["noise_floor"]:
            return f"{causes}{name}; apart from this, there is no gap beyond noise."
        noise = number(gap["noise_floor"])
        return f"{causes}{name}; apart from this, the rms simulation error is {before}, and the noise alone is {noise}."
    if closed is None and gap["after"] < gap["before"] and is_mismatch(report):
        moved = moved_numbers(report)
        sure = effects[0]["probability"] >= SURE
        said = (
            f"{'N' if sure else 'Probably n'}umbers of your simulation are wrong: {moved}"
            if moved
            else f"{causes}: {subject}"
        )
        return f"{said}. Refitting reduces the rms simulation error from {before} to {number(gap['after'])}."
    if closed is None:
        return f"{causes}: {subject} reduce{s} the error on the fitted samples, but held-out samples show no gap."
    share = closed_percent(closed, gap["ci95"])
    if closed <= 0.0:
        return f"{causes}: {subject} improve{s} the fit, but close{s} none of the gap on held-out samples ({share})."
    only = "only " if closed < HALF else ""
    return f"{causes}: {subject} explain{s} {only}{share} of the gap{_doubt(gap)}."


def moved_numbers(report: dict[str, Any]) -> str:
    """The fitted numbers of a given simulation that differ from their nominal values; empty without such numbers."""
    numbers = [one for one in report.get("numbers", []) if one["determined"] and _is_moved(one)]
    if not numbers:
        return ""
    most = sorted(numbers, key=lambda one: -abs(one["value"] - one["nominal"]) / (one["stderr"] or 1.0))[:MOST_NUMBERS]
    said = joined(
        [
            f"{one['name']} is {rounded(one['value'], one['stderr'])} (nominally {number(one['nominal'])})"
            for one in most
        ]
    )
    others = len(numbers) - len(most)
    further = f", and {others} further differ{'s' * (others == 1)}" if others else ""
    return f"{said}{further}"


def _is_moved(one: dict[str, Any]) -> bool:
    """Whether a fitted number differs from its nominal value by more than its error."""
    return bool(abs(one["value"] - one["nominal"]) > TWO_ERRORS * (one["stderr"] or 0.0))


def _doubt(gap: dict[str, Any]) -> str:
    """Said where the interval of the closed share begins at zero or below."""
    return ", possibly none" if gap["ci95"] is not None and gap["ci95"][0] <= 0.0 else ""


def _partial_sentence(report: dict[str, Any]) -> str:
    """Verdict that explains a part of the gap: its causes and their share.

    Effects that are less probable than not are listed after the causes.
    """
    effects, gap = report["effects"], report["gap"]
    causes = [effect for effect in effects if is_probable(effect)]
    others = [effect for effect in effects if not is_probable(effect)]
    is_share = gap["closed"] is not None and (causes or not _doubt(gap))
    gain = (
        f"explain* {closed_percent(gap['closed'], gap['ci95'])} of the gap{_doubt(gap)}"
        if is_share
        else f"reduce* the rms simulation error from {number(gap['before'])} to {number(gap['after'])}"
    )
    one, several = gain.replace("*", "s"), gain.replace("*", "")
    if not causes:
        tried = joined(_named_or_counted(others))
        return f"The cause is not known: {tried} {one if len(others) == 1 else several}, but may only imitate it."
    if len(effects) == 1:
        return f"{_qualified(causes[0])}: {noun(causes[0]['name'])} {one}."
    clauses = [_named_clause(effect) for effect in causes]
    said = acting(causes) or joined([clauses[0], *(uncapitalised(text) for text in clauses[1:])], comma=True)
    if not others:
        return f"{said}. Together they {several}."
    listed = joined(_named_or_counted(others, after=True))
    subject = f"this {one}" if len(causes) == 1 else f"they {several}"
    return f"{said}. Together with {listed}, less certain, {subject}."


def acting(causes: list[dict[str, Any]]) -> str:
    """That these causes act, by their names alone, if clauses of them all fill more than two lines; else empty."""
    if len(causes) <= MOST_CLAUSES:
        return ""
    chances = [one.get("chance", probability(one["probability"])) for one in causes]
    named = [
        placed_noun(one, article=True) + (f" ({chance})" if one["probability"] < SURE else "")
        for one, chance in zip(causes, chances, strict=True)
    ]
    return f"{capitalised(joined(named))} act"


def _named_or_counted(effects: list[dict[str, Any]], after: bool = False) -> list[str]:
    """The effects with their probabilities; those that are hardly probable without their names, `after` others."""
    named = [_with_chance(effect) for effect in effects if effect["probability"] >= NAMED]
    count, further = len(effects) - len(named), " further" if named or after else " improbable"
    return [*named, *([f"one{further} effect" if count == 1 else f"{count}{further} effects"] if count else [])]


def is_probable(effect: dict[str, Any]) -> bool:
    """Whether an effect is more probable than not."""
    return bool(effect["probability"] >= HALF)


def chance_of(effect: dict[str, Any]) -> str:
    """``probability 97 %``, or in words where nothing like the record is among the rigs that it was measured on."""
    text = effect.get("chance", probability(effect["probability"]))
    return f"probability {text}" if text.endswith("%") else str(text)


def reference_sentence(report: dict[str, Any]) -> str | None:
    """Why the probabilities are given in words."""
    beyond = report.get("novelty", {}).get("beyond", [])
    if not beyond or not report["effects"]:
        return None
    differs = joined([NOVELTIES[name] for name in beyond])
    return (
        f"No simulated rig on which probabilities were measured is like this record in {differs}: they are given in "
        "words."
    )


def _with_chance(effect: dict[str, Any]) -> str:
    """The noun of an effect, with its probability if it is not stated without qualification."""
    p, text = effect["probability"], effect.get("chance", probability(effect["probability"]))
    if p >= SURE:
        return noun(effect["name"])
    return f"{noun(effect['name'])}, {text}" if p >= HALF else f"{noun(effect['name'])} ({text})"


def _named_clause(effect: dict[str, Any]) -> str:
    """The clause of a cause with its noun, unless it holds that, and with its probability if that is in per cent."""
    text, in_words = _qualified(effect), not chance_of(effect).endswith("%")
    if in_words and noun_without_article(effect["name"]) in text:
        return text
    return f"{text} ({noun(effect['name']) if in_words else _with_chance(effect)})"


def remaining_sentence(report: dict[str, Any]) -> str | None:
    """The main part of the error that no named effect explains; None if all but noise is explained."""
    from labsid.plots.gap_curves import noise_band

    if report["verdict"] not in ("partial", "unknown"):
        return None
    if report.get("product"):
        return PRODUCTS[report["product"]][0]
    kind, partial = main_kind(report), report["verdict"] == "partial"
    closed = report["unexplained"]["share"] < SHOWN_SHARE
    closed = closed and report["gap"]["noise_floor"] < CLEARLY_MORE * 0.5 * noise_band(report)[0]
    left = "What remains is as small as the noise, but not white" if closed else "Something else remains"
    if kind is None:
        return f"{left}." if partial else None
    share = percent(report["unexplained"]["kinds"][kind])
    start = f"{left}: of" if partial and closed else "Of"
    remains = " that remains" if partial and not closed else ""
    return f"{start} the error beyond white noise{remains}, {share} {REMAINING_ERRORS[kind].what}."


def main_kind(report: dict[str, Any]) -> str | None:
    """The kind of model that closes the largest share of the remaining error; None if noise or a product is left."""
    kinds = {} if report.get("product") else report["unexplained"]["kinds"]
    return max(kinds, key=lambda kind: float(kinds[kind])) if kinds else None


def _qualified(effect: dict[str, Any]) -> str:
    """The clause of an effect, with "probably" or "possibly" according to its probability."""
    if effect["probability"] >= SURE:
        return clause(effect)
    return f"{'Probably' if is_probable(effect) else 'Possibly'} {uncapitalised(clause(effect))}"


def only_on_holdout(report: dict[str, Any]) -> bool:
    """Whether the record shows no gap, and the holdout does."""
    return "only_on_holdout" in report


def _simulation_before(report: dict[str, Any]) -> str:
    return "your simulation" if report["simulation"]["given"] else "a linear model fitted to the record"


def _none_sentence(report: dict[str, Any]) -> str:
    gap, which = report["gap"], _simulation_before(report)
    if "holdout_unscored" in report and gap["before"] > NO_GAP_RMS * gap["noise_floor"]:
        return (
            f"There is no gap beyond noise: the rms error of {which} is {number(gap['before'])} on the holdout, which "
            f"noise of {number(gap['noise_floor'])} reaches by chance."
        )
    sizes = f"the rms error of {which} is {number(gap['before'])}, and the noise alone is {number(gap['noise_floor'])}."
    if report["unexplained"]["input_correlation_p"] < DEPENDENT:
        return f"The gap is too small for its cause to be named: {sizes}"
    return f"There is no gap beyond noise: {sizes}"


def _holdout_sentence(report: dict[str, Any]) -> str:
    """The gap on a holdout whose record shows none."""
    gap, only = report["gap"], report["only_on_holdout"]
    before, offset = gap["before"], only["offset"]
    text = (
        f"The record shows no gap beyond noise, the holdout does: the rms error of {_simulation_before(report)} is "
        f"{number(before)} on the holdout and {number(only['on_record'])} on the record, and the noise alone is "
        f"{number(gap['noise_floor'])}."
    )
    constant = offset**2 > HALF * before**2
    return f"{text} Most of the error on the holdout is an offset of {number(offset)}." if constant else text


def _unknown_sentence(report: dict[str, Any]) -> str:
    if only_on_holdout(report):
        tried = f"None of the {len(effects_tried(report))} effects tried reduces this error by more than chance."
        return f"{_holdout_sentence(report)} {tried}"
    start = f"None of the {len(effects_tried(report))} effects tried explains the gap"
    reason = "none reduces it on held-out samples by more than chance"
    if plateaus_matter(report):
        reason = "for the same input, the output settles at different levels"
    return f"{start}: {reason}."


def is_unchanged(report: dict[str, Any]) -> bool:
    """Whether the simulations before and after are the same."""
    return report["verdict"] in ("none", "unknown") or report["gap"]["after"] == report["gap"]["before"]


def is_mismatch(report: dict[str, Any]) -> bool:
    """Whether the cause is in the numbers of the given simulation alone."""
    return [effect["name"] for effect in report["effects"]] == ["parameter-mismatch"]


def correction(report: dict[str, Any]) -> str:
    """What distinguishes the simulation after from the one before, as a gerund."""
    if is_mismatch(report):
        return "refitting the parameters"
    return f"adding the {_added(report)}"


def _added(report: dict[str, Any]) -> str:
    """The effects of a report, as its sentences call them."""
    noun_of_one = "effect" if report["verdict"] == "partial" else "cause"
    return f"{noun_of_one}{'s' if len(report['effects']) > 1 else ''}"


def effects_tried(report: dict[str, Any]) -> list[str]:
    """Every effect that was tried on this record; those detected in the samples come last."""
    names = {name for row in report["ranking"] for name in row["name"].split("+")}
    return [*sorted(names - set(UNSIMULATED)), *UNSIMULATED]


def ambiguity_sentence(report: dict[str, Any]) -> str | None:
    """Alternatives that the record does not rule out."""
    rivals = joined([noun(name) for name in report["ambiguous"]], "or")
    if not rivals:
        return None
    if not report["effects"]:
        return f"The record does not rule out {rivals}."
    several = report["verdict"] == "partial" and len(report["effects"]) > 1
    instead = "in the place of one of the effects" if several else "instead"
    return f"The record does not rule out {rivals} {instead}. {_chances(report)}{_other_side(report)}"


def _chances(report: dict[str, Any]) -> str:
    """The probabilities of the effects, by numbers or in words; by numbers also those of rivals of a single cause."""
    effects = report["effects"]
    chances = {one["name"]: one.get("chance", probability(one["probability"])) for one in effects}
    if not all(chance.endswith("%") for chance in chances.values()):
        return f"{capitalised(joined([f'{noun(name)} is {chance}' for name, chance in chances.items()]))}."
    if len(effects) == 1 and report["verdict"] == "effect":
        ranked = {row["name"]: probability(p) for row in report["ranking"] if (p := row["probability"]) >= NAMED}
        chances |= {name: ranked[name] for name in report["ambiguous"] if name in ranked}
    return f"Probability: {joined([f'{noun(name)} {chance}' for name, chance in chances.items()])}."


def _other_side(report: dict[str, Any]) -> str:
    """What tells a dead zone of which one edge is seen from a limit of the actuator; empty for others."""
    one_edge = {e["name"] for e in report["effects"] if len({"low", "high"} & e["parameters"].keys()) == 1}
    pair = {"input-dead-zone", "input-saturation"}
    if not one_edge & pair or not pair <= one_edge | set(report["ambiguous"]):
        return ""
    return (
        " Commands on the other side of zero tell them apart: beyond a dead zone they act, beyond a limit they do not."
    )


def plateaus_matter(report: dict[str, Any]) -> bool:
    """Whether levels that do not repeat make up much of the gap."""
    return any(finding["topic"] == "plateaus" for finding in report["record_findings"])


def record_sentences(report: dict[str, Any]) -> list[str]:
    """Findings from the record itself, one string a finding."""
    texts = []
    for finding in report["record_findings"]:
        of_one = any(finding["text"].startswith(f"{row['name']}: ") for row in report.get("records", ()))
        text = finding["text"] if of_one else capitalised(re.sub("^y ", "the output ", finding["text"]))
        text = re.sub(r"(?<=\d)%", " %", text)
        texts.append(f"{text} {_plateaus(report)}" if finding["topic"] == "plateaus" else text)
    return texts


def _plateaus(report: dict[str, Any]) -> str:
    """How much of the simulation error is variation between plateaus of the same input, before and after."""
    seen = report["plateaus"]
    size = (
        f"Between these levels the simulation error varies by {number(seen['missed'])} rms; "
        f"over the whole record it is {number(seen['missed'] / seen['of_gap'])} rms."
    )
    left = f"{number(seen['left'] * seen['missed'])} rms" if seen["left"] else "no larger than noise"
    rest = "" if is_unchanged(report) else f" After {correction(report)}, this variation is {left}."
    return f"{size} No effect tried explains this.{rest}" if seen["left"] > MAX_UNACCOUNTED else f"{size}{rest}"


def ranking_sentence(report: dict[str, Any]) -> str:
    """How the candidates were compared, and which are accepted."""
    if report["verdict"] in ("none", "effect"):
        start = "Each candidate was added to the simulation, and all parameters were refitted."
        end = " On this record none is needed." if report["verdict"] == "none" else ""
        return f"{start} The probabilities compare the candidates with each other.{end}"
    where = "the holdout record" if report["holdout_traces"] is not None else "held-out samples"
    start = (
        f"Each candidate was added to the simulation, and all parameters were refitted; its error is that on {where}."
    )
    if report["verdict"] == "unknown":
        return f"{start} None reduces this error by more than chance."
    every = "Each of the accepted effects reduces" if len(report["effects"]) > 1 else "The accepted effect reduces"
    names = {effect["name"] for effect in report["effects"]}
    accepted = min((row["rmse"] for row in report["ranking"] if set(row["name"].split("+")) == names), default=0.0)
    less = any(row["rmse"] < accepted for row in report["ranking"])
    except_for = " Candidates with a smaller error contain an effect that does not." if less else ""
    return f"{start} {every} this error by more than chance.{except_for}"


def is_noise_alone(report: dict[str, Any]) -> bool:
    """Whether what is left beside the effects, or beside none, is the noise, and nothing that a part of the gap is."""
    if report["verdict"] == "effect":
        return bool(report["unexplained"]["share"] < LEAST_LEFT)
    return report["verdict"] == "none" or only_on_holdout(report)


def gap_sentence(report: dict[str, Any]) -> str:
    """The size of the gap before and after, and the samples on which it is scored."""
    gap = report["gap"]
    where = "held-out samples" if report["holdout_traces"] is None else "holdout record"
    where = "each record left out in turn" if report.get("records") else where
    unit = unit_of(report)
    noise = "noise alone" if is_noise_alone(report) else "noise, with what no model predicts,"
    end = f"the {noise} is {number(gap['noise_floor'])} ({unit}, {where})."
    if is_unchanged(report):
        return f"The rms simulation error is {number(gap['before'])}; {end}"
    return (
        f"The rms simulation error is {number(gap['before'])} before and {number(gap['after'])} after "
        f"{correction(report)}; {end}"
    )


def start_sentence(report: dict[str, Any]) -> str | None:
    """Which samples of a holdout are not scored, and how its initial state is estimated; None without a holdout."""
    count = report.get("holdout_unscored")
    if count is None:
        return None
    if report["holdout_state"] == "estimated":
        return f"The first {count} samples of the holdout determine its initial state and are not scored."
    return (
        f"The first {count} samples of the holdout are not scored. They say too little about its initial state, which "
        "is therefore fitted to the whole holdout: the errors are those beside a free initial state."
    )


def has_kinds(report: dict[str, Any]) -> bool:
    """Whether the report attributes a remaining error to kinds of models."""
    explained = report["verdict"] in ("none", "effect") and (_is_white(report) or is_noise_alone(report))
    return main_kind(report) is not None and not explained


def kinds_sentence(report: dict[str, Any]) -> str | None:
    """Shares of the remaining error by the kind of model that reduces it."""
    if not has_kinds(report):
        return None
    kinds = report["unexplained"]["kinds"]
    large = sorted((item for item in kinds.items() if item[1] >= MIN_KIND), key=lambda item: -item[1])
    parts = joined([f"{REMAINING_ERRORS[name].label} {percent(share)}" for name, share in large])
    return f"The error beyond white noise by kind: {parts}."


def look_sentence(report: dict[str, Any]) -> str | None:
    """Where on the rig to look for the cause of the remaining error."""
    if only_on_holdout(report):
        return (
            "Find out in what the rig, its load or its wiring differed between the record and the holdout. Diagnose "
            "the holdout by itself, and both as runs of one rig."
        )
    if report.get("product"):
        return PRODUCTS[report["product"]][1]
    kind = main_kind(report)
    return None if kind is None or report["verdict"] in ("none", "effect") else REMAINING_ERRORS[kind].look


def baseline_sentence(report: dict[str, Any]) -> str | None:
    """How the linear model was fitted, if not as asked; the fitted numbers of a given simulation, and its limits."""
    if report["simulation"]["given"]:
        return _given_sentence(report)
    model = report["simulation"].get("model")
    if model is None or (model["method"] == OUTPUT_ERROR and model["observed"]):
        return None
    if not model["observed"]:
        return _unobserved_sentence(report, model["method"])
    if model["method"] == FIRST_ORDER:
        return (
            "The record does not support a linear model of the order asked for: one of first order has the smaller "
            "error on held-out samples."
        )
    return (
        f"The linear model was fitted by {model['method']}, one step ahead: on held-out samples its free run has a "
        "smaller error than that of the output-error fit."
    )


def _unobserved_sentence(report: dict[str, Any], method: str) -> str:
    """Which linear model is used where the slowest pole of the one that was asked for cannot be identified."""
    without = "" if is_unchanged(report) else f"without the {_added(report)}, "
    slow = capitalised(
        f"{without}the record does not determine the slowest pole of a linear model of the order asked for"
    )
    if method == OUTPUT_ERROR:
        return f"{slow}: the rig may be of lower order, or may integrate its input."
    used = "of first order" if method == FIRST_ORDER else f"fitted by {method}, one step ahead"
    return f"{slow}. The model used is {used}."


def _given_sentence(report: dict[str, Any]) -> str | None:
    """The fitted numbers of a given simulation, and which effects could not be tried within it."""
    simulation, texts = report["simulation"], output_sentences(report)
    numbers = report.get("numbers", [])
    if numbers and not is_mismatch(report):
        fitted = joined(
            [
                f"{one['name']} = {with_error(one['value'], one['stderr'])} (nominally {number(one['nominal'])})"
                for one in numbers
            ]
        )
        texts.append(f"Numbers of your simulation that were fitted: {fitted}.")
    texts += number_sentences(numbers, levelled=bool(simulation.get("closed")))
    if simulation.get("closed") and report["verdict"] != "none" and not simulation["output_only"]:
        texts.append(_limits_sentence({name for row in report["ranking"] for name in row["name"].split("+")}))
    texts += _evaluation_sentences(simulation.get("evaluations"))
    return " ".join(texts) or None


def number_sentences(numbers: list[dict[str, Any]], levelled: bool = False) -> list[str]:
    """Which fitted numbers the record does not determine, and which ended at their limits.

    The output of a simulation is `levelled` if it is shifted to the record.
    """
    texts = [
        f"{one['name']} ended at its limit, {number(one['limit'])}: the record asks for more. Give it a wider range, "
        "or look for what it makes up for."
        for one in numbers
        if one["at_limit"] and one["determined"]
    ]
    groups = dict.fromkeys((tuple(one["group"]), one["combination"]) for one in numbers if one["group"])
    for names, combination in groups:
        what = combination.replace(", ", " and ") if combination else "a combination of them"
        texts.append(f"The record does not determine {joined(list(names))}, only {what}.")
    alone = [one["name"] for one in numbers if not one["determined"] and not one["group"]]
    if alone:
        but = "but for its level, which is shifted to the record, " if levelled else ""
        texts.append(f"The record does not determine {joined(alone)}: {but}the output hardly depends on it.")
    return texts


def output_sentences(report: dict[str, Any]) -> list[str]:
    """How a simulated output was read; empty if a model was given."""
    output = report["simulation"].get("output")
    if output is None:
        return []
    texts = [f"Your simulated output was interpolated {output['resampled']}, at the times of the record."]
    model = output["model"]
    if model is None:
        texts.append(
            "No linear model reproduces your simulated output, so only effects at the output could be tried. Give the "
            "model itself, or a function, to try the others."
        )
    else:
        late = f" and a dead time of {counted(model['dead_time'], 'sample', 'samples')}" if model["dead_time"] else ""
        texts.append(
            f"A linear model of order {model['order']}{late} reproduces your simulated output to {model['error']:.1g} "
            "of its standard deviation, so all effects could be tried in it."
        )
    return texts if output["resampled"] else texts[1:]


def _limits_sentence(tried: set[str]) -> str:
    """What could be tried around a given simulation, and what could not."""
    inside = ["friction"] * ("coulomb-friction" not in tried) + ["a spring"] * ("cubic-stiffness" not in tried)
    outside = [what for what in ("friction", "a spring") if what not in inside]
    reacting = f"; {joined(outside)} as a force at its input that reacts to its output" if outside else ""
    return (
        "Your simulation can only be run as a whole: a delay, a lag and a mode were tried at its input, a mode beside "
        f"it, too{reacting}; {joined([*inside, 'outflow', 'drag', 'stops', 'drifts'])} within it could not be tried."
    )


def _evaluation_sentences(runs: dict[str, Any] | None) -> list[str]:
    """Whether a limit of the runs of a given simulation has ended the search, and how many of them failed."""
    texts = []
    if runs is not None and runs["spent"]:
        texts.append(
            f"The search was ended by the limit of {runs['budget']:,} runs of your simulation, a quarter of which is "
            f"kept for the error on held-out samples; {runs['runs']:,} were used. What is not in the ranking may "
            "not have been tried. Allow more runs."
        )
    if runs is not None and runs["failed"]:
        share = f"{runs['failed']:,} of {runs['runs']:,}"
        texts.append(f"{share} runs of your simulation failed; the first: {runs['failure']}")
    return texts


def record_rows(report: dict[str, Any]) -> list[tuple[str, str, str, str, str]]:
    """Name, error before and after, noise and closed share of each of several records; empty for one."""
    return [
        (
            row["name"],
            number(row["before"]),
            number(row["after"]),
            number(row["noise_floor"]),
            "–" if row["closed"] is None else closed_percent(row["closed"]),
        )
        for row in report.get("records", [])
    ]


def records_sentence(report: dict[str, Any]) -> str | None:
    """How several records were treated."""
    if not report.get("records"):
        return None
    counts = sorted({row["unscored"] for row in report["records"]})
    first = str(counts[0]) if len(counts) == 1 else f"{counts[0]} to {counts[-1]}"
    dated = any("onset" in effect["parameters"] for effect in report["effects"])
    return (
        "The records share the parameters and the effects; each has its own offset and initial state. Each record was "
        f"simulated with fits to the others, its offset and initial state estimated from its first {first} samples, "
        f"which are not scored.{' Times run on from one record to the next.' if dated else ''}"
    )


def place_sentence(report: dict[str, Any]) -> str | None:
    """Where in the control loop the causes are; None without an effect that is more probable than not."""
    effects = [effect for effect in report["effects"] if is_probable(effect)]
    if not effects:
        return None
    places = [PLACES.get(effect["path"], effect["path"]) for effect in effects]
    if len(set(places)) == 1 and len(effects) == len(report["effects"]):
        return f"The cause{'s are' if len(effects) > 1 else ' is'} {places[0]}."
    listed = (f"{noun(effect['name'])}: {place}" for effect, place in zip(effects, places, strict=True))
    return f"{capitalised('; '.join(listed))}."


def fitted_baseline_sentence(report: dict[str, Any]) -> str:
    """Why the gap of a fitted baseline precedes a change within the record; empty for other gaps."""
    names = {effect["name"] for effect in report["effects"]}
    if report["simulation"]["given"] or not names & names_where("varies_in_time"):
        return ""
    return (
        "The linear model was fitted to the record before and after the change, so it has errors on both sides of it."
    )


def residual_sentences(report: dict[str, Any]) -> list[str]:
    """How much of the gap remains, and the results of the residual tests."""
    left, gap = report["unexplained"], report["gap"]
    white, correlated = left["whiteness_p"] >= SIGNIFICANT, left["input_correlation_p"] < SIGNIFICANT
    whiteness, correlation = p_value(left["whiteness_p"]), p_value(left["input_correlation_p"])
    texts = ["These are the errors on the holdout."] if only_on_holdout(report) else []
    if _is_white(report) and report["verdict"] in ("none", "effect"):
        beyond = not is_unchanged(report) and gap["after"] > CLEARLY_MORE * gap["noise_floor"]
        texts.append(f"Only white noise remains{' on the samples that were fitted' * beyond}.")
    elif left["share"] > 0.0 and report["verdict"] != "none" and gap["before"] > gap["noise_floor"]:
        texts.append(f"{percent(left['share'])} of the gap remains; with the noise, {number(left['rms'])} rms.")
    if white:
        texts.append(f"The residual is not autocorrelated (whiteness test, {whiteness}).")
    else:
        texts.append(
            f"The residual is autocorrelated (whiteness test, {whiteness}), as from coloured noise or a slow effect."
        )
    if not correlated:
        texts.append(f"It does not depend linearly on past inputs ({correlation}).")
    elif has_kinds(report) and left["kinds"]["disturbance"] > HALF:
        part = "a small part" if left["kinds"]["disturbance"] > MOST else "a part"
        texts.append(f"It depends on past inputs ({correlation}), but they predict only {part} of it.")
    else:
        missing = "a small part of the dynamics may be" if is_noise_alone(report) else "part of the dynamics is"
        texts.append(f"It depends on past inputs ({correlation}): {missing} missing.")
    if left.get("repeats", 0.0) > 0.1 and not (has_kinds(report) and left["kinds"]["disturbance"] > HALF):
        texts.append(f"After like inputs it is alike (correlation {left['repeats']:.2f}), unlike noise.")
    return texts


def _is_white(report: dict[str, Any]) -> bool:
    """Whether the residual is neither autocorrelated nor correlated with past inputs."""
    left = report["unexplained"]
    return bool(left["whiteness_p"] >= SIGNIFICANT and left["input_correlation_p"] >= SIGNIFICANT)


def experiment_sentence(report: dict[str, Any]) -> str | None:
    """Which explanations the proposed input distinguishes, and how reliably."""
    planned = report["next_experiment"]
    if planned is None:
        return None
    ours, rival = distinguishing_effects(planned["separates"])
    why = str(planned["why"])
    for name in sorted(planned["separates"], key=len, reverse=True):
        why = why.replace(name, ours if name == planned["separates"][0] else rival)
    margin = planned["margin"]
    quality = "reliable" if margin >= RELIABLE_MARGIN else "probably correct"
    return f"It distinguishes {ours} from {rival}. {why} Expected margin {margin:.0f}: the decision would be {quality}."


def distinguishing_effects(separates: list[str]) -> tuple[str, str]:
    """The effects of each of two explanations that the other does not contain."""
    first, second = (name.split("+") for name in separates[:2])
    ours, rival = [n for n in first if n not in second], [n for n in second if n not in first]
    return joined([noun(n) for n in ours or first]), joined([noun(n) for n in rival or second])


def noun_without_article(name: str) -> str:
    """The noun of an effect without its article."""
    return noun(name).removeprefix("a ").removeprefix("an ")


def placed_noun(effect: dict[str, Any], article: bool = False) -> str:
    """The noun of an effect, of several signals with its place."""
    named = noun(effect["name"]) if article else noun_without_article(effect["name"])
    return f"{named} {place_at(effect)}".strip()


def capitalised(text: str) -> str:
    """`text` with an upper-case first letter."""
    return text[:1].upper() + text[1:]


def uncapitalised(text: str) -> str:
    """`text` with a lower-case first letter."""
    return text[:1].lower() + text[1:]
