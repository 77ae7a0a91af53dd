"""Sentences of the text and HTML reports, made from the JSON report alone."""

import re
from typing import Any

from labsid.gap.effect_texts import STOP_EFFECTS, UNSIMULATED, clause, noun
from labsid.gap.quantities import closed_percent, number, p_value, percent, probability

PLACES = {
    "input": "between the command and the process",
    "dynamics": "in the process",
    "output": "between the process and the record",
    "disturbance": "outside the signal path, independent of the command",
    "parameters": "in the parameters of the simulation, not in its structure",
}
SURE, LIKELY = 0.9, 0.6  # probabilities from which an effect is stated without qualification, and as probable
SIGNIFICANT = 0.01  # p-value below which a residual test is reported as significant
RELIABLE_MARGIN = 20.0  # margin of an experiment from which its decision was right in 995 of 1000 trials
NO_GAP = 1.1  # rms error over noise, up to which there is no gap
HALF = 0.5  # closed share below which "only" is written
TIME_VARYING = {"load-step", "parameter-drift"}
MAX_UNACCOUNTED = 0.3  # of the variation between plateaus, that an explanation of it may leave


def verdict_sentence(report: dict[str, Any]) -> str:
    """The verdict in one sentence."""
    if report["verdict"] == "effect":
        return _effect_sentence(report)
    return _none_sentence(report) if report["verdict"] == "none" else _unknown_sentence(report)


def _effect_sentence(report: dict[str, Any]) -> str:
    effects, gap = report["effects"], report["gap"]
    several = len(effects) > 1
    clauses = [_qualified(effect) + (f" ({noun(effect['name'])})" if several else "") for effect in effects]
    causes = joined([clauses[0], *(uncapitalised(text) for text in clauses[1:])], comma=True)
    if unnamed_effects(report):
        return _partial_sentence(report, causes)
    subject = "together they" if several else noun(effects[0]["name"])
    s = "" if several else "s"
    before, closed = number(gap["before"]), gap["closed"]
    if all(effect["name"] in UNSIMULATED for effect in effects):
        name = "" if several else f": {subject}"
        if gap["before"] <= NO_GAP * gap["noise_floor"]:
            return f"{causes}{name}; apart from this, there is no gap beyond noise."
        noise = number(gap["noise_floor"])
        return f"{causes}{name}; apart from this, the rms simulation error is {before}, and the noise alone is {noise}."
    if closed is None and gap["after"] < gap["before"] and _is_mismatch(report):
        return (
            f"{causes}: {subject}. Refitting reduces the rms simulation error from {before} to {number(gap['after'])}."
        )
    if closed is None:
        return f"{causes}: {subject} reduce{s} the error on the fitted samples, but held-out samples show no gap."
    share = closed_percent(closed, gap["ci95"])
    if closed <= 0.0:
        return f"{causes}: {subject} improve{s} the fit, but close{s} none of the gap on held-out samples ({share})."
    only = "only " if closed < HALF else ""
    doubt = ", possibly none of it" if gap["ci95"] is not None and gap["ci95"][0] <= 0.0 else ""
    return f"{causes}: {subject} explain{s} {only}{share} of the gap{doubt}."


def _partial_sentence(report: dict[str, Any], causes: str) -> str:
    """Verdict that names only a part of the explanation: a visible stop, or the effect that reduces the gap most."""
    gap, names = report["gap"], joined([noun(effect["name"]) for effect in report["effects"]])
    stops = all(effect["name"] in STOP_EFFECTS for effect in report["effects"])
    evidence = "the output rests at this limit" if stops else "no other single effect reduces the gap as much"
    if gap["closed"] is None or gap["closed"] <= 0.0:
        share = "none of the gap on held-out samples"
    else:
        share = f"{closed_percent(gap['closed'], gap['ci95'])} of the gap"
    rest = joined([noun(name) for name in unnamed_effects(report)])
    return (
        f"{causes}: {names}; {evidence}. It is not the only cause: "
        f"the best candidate, which adds {rest}, closes {share}."
    )


def _qualified(effect: dict[str, Any]) -> str:
    """The clause of an effect, with "probably" or "possibly" according to its probability."""
    p = effect["probability"]
    if p >= SURE:
        return clause(effect)
    return f"{'Probably' if p >= LIKELY else 'Possibly'} {uncapitalised(clause(effect))}"


def _none_sentence(report: dict[str, Any]) -> str:
    gap = report["gap"]
    which = "your simulation" if report["simulation"]["given"] else "a linear model fitted to the record"
    return (
        f"There is no gap beyond noise: the rms error of {which} is {number(gap['before'])}, "
        f"and the noise alone is {number(gap['noise_floor'])}."
    )


def _unknown_sentence(report: dict[str, Any]) -> str:
    gap, tried = report["gap"], len(effects_tried(report))
    start = f"None of the {tried} effects tried explains the gap"
    if plateaus_matter(report):
        return f"{start}: for the same input, the output settles at different levels."
    if not best_candidate(report):
        return f"{start}: none reduces it by more than chance."
    best = joined([noun(name) for name in best_candidate(report)])
    if gap["closed"] is None or gap["closed"] <= 0.0:
        return f"{start}: the best candidate, {best}, does not reduce it on held-out samples."
    only = "only " if gap["closed"] < HALF else ""
    return (
        f"{start}: the best candidate, {best}, closes {only}{closed_percent(gap['closed'], gap['ci95'])} of it, "
        "and the remaining error exceeds the noise."
    )


def best_candidate(report: dict[str, Any]) -> list[str]:
    """Names of the best explanation of an unexplained gap; empty if none reduces the gap."""
    if not report["ranking"] or is_unchanged(report):
        return []
    return list(report["ranking"][0]["name"].split("+"))


def is_unchanged(report: dict[str, Any]) -> bool:
    """Whether the simulations before and after are the same."""
    return report["verdict"] == "none" or report["gap"]["after"] == report["gap"]["before"]


def unnamed_effects(report: dict[str, Any]) -> list[str]:
    """Effects of the simulation after that are not named as causes, although others are."""
    return list(report.get("beside", []))


def is_incomplete(report: dict[str, Any]) -> bool:
    """Whether the simulation after contains effects that are not named as causes."""
    return report["verdict"] == "unknown" or bool(unnamed_effects(report))


def _is_mismatch(report: dict[str, Any]) -> bool:
    return [effect["name"] for effect in report["effects"]] == ["parameter-mismatch"]


def correction(report: dict[str, Any]) -> str:
    """What distinguishes the simulation after from the one before, as a gerund."""
    if is_incomplete(report):
        return "adding the best candidate"
    if _is_mismatch(report):
        return "refitting the parameters"
    return "adding the causes" if len(report["effects"]) > 1 else "adding the cause"


def effects_tried(report: dict[str, Any]) -> list[str]:
    """Every effect that was tried on this record; those detected in the samples come last."""
    names = {name for row in report["ranking"] for name in row["name"].split("+")}
    return [*sorted(names - set(UNSIMULATED)), *UNSIMULATED]


def ambiguity_sentence(report: dict[str, Any]) -> str | None:
    """Alternatives that the record does not rule out."""
    rivals = joined([noun(name) for name in report["ambiguous"]], "or")
    if not rivals or (report["verdict"] == "unknown" and set(report["ambiguous"]) <= set(best_candidate(report))):
        return None
    if report["verdict"] == "unknown":
        return f"The best fits include {rivals}, but none is accepted as the cause."
    if report["verdict"] == "none":
        return f"The record does not rule out {rivals}."
    if unnamed_effects(report):
        return f"The additional cause is uncertain: {rivals} fits best."
    chances = joined([f"{noun(e['name'])} {probability(e['probability'])}" for e in report["effects"]])
    return f"The record does not rule out {rivals} instead. Probability: {chances}."


def plateaus_matter(report: dict[str, Any]) -> bool:
    """Whether levels that do not repeat make up much of the gap."""
    return any(finding["topic"] == "plateaus" for finding in report["record_findings"])


def record_sentences(report: dict[str, Any]) -> list[str]:
    """Findings from the record itself, one string a finding."""
    texts = []
    for finding in report["record_findings"]:
        text = re.sub(r"(?<=\d)%", " %", capitalised(re.sub("^y ", "the output ", finding["text"])))
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
    which = "best candidate" if seen["left"] > MAX_UNACCOUNTED or is_incomplete(report) else "cause"
    rest = f"With the {which} added, this variation is {left}."
    return f"{size} No effect tried explains this. {rest}" if seen["left"] > MAX_UNACCOUNTED else f"{size} {rest}"


def other_causes_sentence(report: dict[str, Any]) -> str:
    """How far the ranking is accepted, and the probability that it leaves for other causes."""
    left = max(1.0 - sum(row["probability"] for row in report["ranking"]), 0.0)
    if report["verdict"] == "none":
        return "On this record none is needed."
    if unnamed_effects(report):
        return "Of the first row, only the effect named above is established; the rest is the best candidate."
    if report["verdict"] == "effect":
        return ""
    other = f" The remaining {probability(left)} is for causes that are not in the table." if left > 0.005 else ""
    return f"On this record none is accepted: the first row is only the best candidate.{other}"


def gap_sentence(report: dict[str, Any]) -> str:
    """The size of the gap before and after, and the samples on which it is scored."""
    gap = report["gap"]
    where = "held-out samples" if report["holdout_traces"] is None else "holdout record"
    end = f"the noise alone is {number(gap['noise_floor'])} (units of y, {where})."
    if is_unchanged(report):
        return f"The rms simulation error is {number(gap['before'])}; {end}"
    return (
        f"The rms simulation error is {number(gap['before'])} before and {number(gap['after'])} after "
        f"{correction(report)}; {end}"
    )


def black_box_sentence(report: dict[str, Any]) -> str | None:
    """The share of the gap that a flexible black-box model closes on the same samples."""
    box = report["gap"].get("black_box")
    if box is None:
        return None
    share = "none" if box <= 0.0 else closed_percent(box)
    return f"For comparison, a flexible black-box model of past inputs closes {share} of the gap on the same samples."


def place_sentence(report: dict[str, Any]) -> str | None:
    """Where in the control loop the causes are."""
    effects = report["effects"]
    if not effects:
        return None
    places = [PLACES.get(effect["path"], effect["path"]) for effect in effects]
    if len(set(places)) == 1:
        return f"The cause{'s are' if len(effects) > 1 else ' is'} {places[0]}."
    listed = (f"{noun(effect['name'])}: {place}" for effect, place in zip(effects, places, strict=True))
    return f"{capitalised('; '.join(listed))}."


def fitted_baseline_sentence(report: dict[str, Any]) -> str:
    """Why the gap of a fitted baseline precedes a change within the record; empty for other gaps."""
    if report["simulation"]["given"] or not {effect["name"] for effect in report["effects"]} & TIME_VARYING:
        return ""
    return (
        "The linear model was fitted to the whole record, so a change within the record causes errors on both sides "
        "of that change."
    )


def residual_sentences(report: dict[str, Any]) -> list[str]:
    """How much of the gap remains, and the results of the residual tests."""
    left = report["unexplained"]
    white, correlated = left["whiteness_p"] >= SIGNIFICANT, left["input_correlation_p"] < SIGNIFICANT
    whiteness, correlation = p_value(left["whiteness_p"]), p_value(left["input_correlation_p"])
    texts = []
    if white and not correlated:
        texts.append("Only white noise remains.")
    elif left["share"] > 0.0 and report["verdict"] != "none":
        texts.append(f"{percent(left['share'])} of the gap remains; with the noise, {number(left['rms'])} rms.")
    if white:
        texts.append(f"The residual is not autocorrelated (whiteness test, {whiteness}).")
    else:
        texts.append(
            f"The residual is autocorrelated (whiteness test, {whiteness}), as from coloured noise or a slow effect."
        )
    if correlated:
        texts.append(f"It depends on past inputs ({correlation}): part of the dynamics is missing.")
    else:
        texts.append(f"It does not depend linearly on past inputs ({correlation}).")
    if left.get("repeats", 0.0) > 0.1:
        texts.append(f"It repeats when the input repeats (correlation {left['repeats']:.2f}), unlike noise.")
    return texts


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


def joined(words: list[str], last: str = "and", comma: bool = False) -> str:
    """``a, b and c``; with `comma`, ``a, b, and c``."""
    if len(words) < 2:
        return "".join(words)
    return f"{', '.join(words[:-1])}{',' if comma else ''} {last} {words[-1]}"


def noun_without_article(name: str) -> str:
    """The noun of an effect without its article."""
    return noun(name).removeprefix("a ").removeprefix("an ")


def capitalised(text: str) -> str:
    """`text` with an upper-case first letter."""
    return text[:1].upper() + text[1:]


def uncapitalised(text: str) -> str:
    """`text` with a lower-case first letter."""
    return text[:1].lower() + text[1:]
