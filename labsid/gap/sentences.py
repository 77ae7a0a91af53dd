"""The report in sentences: what terminal and page both say. Pure functions of the report."""

import re
from typing import Any

from labsid.gap.effect_texts import STOP_EFFECTS, UNSIMULATED, clause, noun
from labsid.gap.quantities import closed_percent, number, p_value, percent, probability

PLACES = {
    "input": "on the way in, between the command and the process",
    "dynamics": "in the process itself",
    "output": "on the way out, between the process and the record",
    "disturbance": "from outside, not by way of the command",
    "parameters": "in the numbers of the simulation, not in its structure",
}
SURE, LIKELY = 0.9, 0.6  # probabilities from which an effect is stated, and from which it is called probable
SIGNIFICANT = 0.01  # p-value under which a residual test speaks
SAFE = 20.0  # margin of an experiment from which its decision was right in 995 of 1000
NO_GAP = 1.1  # times the noise
HALF = 0.5
TIME_VARYING = {"load-step", "parameter-drift"}
MAX_UNACCOUNTED = 0.3  # of the scatter of the levels: what an explanation of them leaves at most


def verdict_sentence(report: dict[str, Any]) -> str:
    """The whole answer in one sentence."""
    if report["verdict"] == "effect":
        return _effect_sentence(report)
    return _none_sentence(report) if report["verdict"] == "none" else _unknown_sentence(report)


def _effect_sentence(report: dict[str, Any]) -> str:
    effects, gap = report["effects"], report["gap"]
    several = len(effects) > 1
    clauses = [_qualified(effect) + (f" ({noun(effect['name'])})" if several else "") for effect in effects]
    said = joined([clauses[0], *(uncapitalised(text) for text in clauses[1:])], comma=True)
    if unnamed_effects(report):
        return _partial_sentence(report, said)
    who = "together they" if several else noun(effects[0]["name"])
    explain = "explain" if several else "explains"
    closed = gap["closed"]
    if all(effect["name"] in UNSIMULATED for effect in effects):
        what = "" if several else f": {who}"
        if gap["before"] <= NO_GAP * gap["noise_floor"]:
            return f"{said}{what}; that aside, the simulation leaves no gap beyond noise."
        missed = f"{number(gap['before'])} rms, where the noise alone is {number(gap['noise_floor'])}"
        return f"{said}{what}; that aside, the simulation misses the record by {missed}."
    if closed is None:
        return f"{said}: {who} {explain} what was fitted, though the samples held back show no gap to close."
    share = closed_percent(closed, gap["ci95"])
    if closed <= 0.0:
        return f"{said}: {who} {explain} what was fitted, but nothing of the gap on samples held back ({share})."
    only = "only " if closed < HALF else ""
    doubt = ", and possibly nothing of it" if gap["ci95"] is not None and gap["ci95"][0] <= 0.0 else ""
    return f"{said}: {who} {explain} {only}{share} of the gap{doubt}."


def _partial_sentence(report: dict[str, Any], said: str) -> str:
    """Only a part of the explanation is named: a stop that the record shows, or what leads all others by far."""
    gap, causes = report["gap"], joined([noun(effect["name"]) for effect in report["effects"]])
    stands = all(effect["name"] in STOP_EFFECTS for effect in report["effects"])
    shown = "at which the output is seen to stand" if stands else "which by itself shrinks the gap as nothing else does"
    if gap["closed"] is None or gap["closed"] <= 0.0:
        share = "nothing of the gap on samples held back"
    else:
        share = f"{closed_percent(gap['closed'], gap['ci95'])} of the gap"
    rest = joined([noun(name) for name in unnamed_effects(report)])
    return (
        f"{said}: {causes}, {shown}. It is not all that acts: "
        f"with {rest} beside it, the nearest that was tried, the simulation closes {share}."
    )


def _qualified(effect: dict[str, Any]) -> str:
    """What the rig does, called probable or possible where it is no more than that."""
    p = effect["probability"]
    if p >= SURE:
        return clause(effect)
    return f"{'Probably' if p >= LIKELY else 'Possibly'} {uncapitalised(clause(effect))}"


def _none_sentence(report: dict[str, Any]) -> str:
    gap = report["gap"]
    which = "your simulation" if report["simulation"]["given"] else "a linear model fitted to the record"
    return (
        f"There is no gap beyond noise: {which} misses the record by {number(gap['before'])} rms, "
        f"and the noise alone is {number(gap['noise_floor'])}."
    )


def _unknown_sentence(report: dict[str, Any]) -> str:
    gap, tried = report["gap"], len(effects_tried(report))
    start = f"There is a gap that none of the {tried} causes tried explains"
    if plateaus_matter(report):
        return f"{start}: at the same input, the output does not come back to the same level."
    if not nearest_effects(report):
        return f"{start}: none of them shrinks it by more than chance would."
    nearest = joined([noun(name) for name in nearest_effects(report)])
    if gap["closed"] is None or gap["closed"] <= 0.0:
        return f"{start}: the nearest, {nearest}, does not shrink it on samples held back."
    only = "only " if gap["closed"] < HALF else ""
    return (
        f"{start}: the nearest, {nearest}, closes {only}{closed_percent(gap['closed'], gap['ci95'])} of it, "
        "and what it leaves is more than noise."
    )


def nearest_effects(report: dict[str, Any]) -> list[str]:
    """Names of the best explanation of a gap that is not explained; empty where nothing shrank it."""
    if not report["ranking"] or is_unchanged(report):
        return []
    return list(report["ranking"][0]["name"].split("+"))


def is_unchanged(report: dict[str, Any]) -> bool:
    """Whether nothing was added to the simulation that counts, so that before and after are one."""
    return report["verdict"] == "none" or report["gap"]["after"] == report["gap"]["before"]


def unnamed_effects(report: dict[str, Any]) -> list[str]:
    """Effects that the simulation after holds without their being named as causes, where others are."""
    return list(report.get("beside", []))


def is_incomplete(report: dict[str, Any]) -> bool:
    """Whether the simulation after holds what is not named as a cause."""
    return report["verdict"] == "unknown" or bool(unnamed_effects(report))


def effects_tried(report: dict[str, Any]) -> list[str]:
    """Every effect that was tried on this record, those seen in the raw samples last."""
    names = {name for row in report["ranking"] for name in row["name"].split("+")}
    return [*sorted(names - set(UNSIMULATED)), *UNSIMULATED]


def ambiguity_sentence(report: dict[str, Any]) -> str | None:
    """What the record cannot tell apart."""
    rivals = joined([noun(name) for name in report["ambiguous"]], "or")
    if not rivals or (report["verdict"] == "unknown" and set(report["ambiguous"]) <= set(nearest_effects(report))):
        return None
    if report["verdict"] == "unknown":
        return f"{capitalised(rivals)}: these come nearest, but none of them is put forward as the cause."
    if report["verdict"] == "none":
        return f"The record does not rule out {rivals}."
    if unnamed_effects(report):
        return f"What else acts is not certain: {rivals} comes nearest."
    chances = joined([f"{noun(e['name'])} {probability(e['probability'])}" for e in report["effects"]])
    return f"It could also be {rivals}: this record cannot tell. Probability: {chances}."


def plateaus_matter(report: dict[str, Any]) -> bool:
    """Whether levels that do not repeat are a good part of the gap."""
    return any(finding["topic"] == "plateaus" for finding in report["record_findings"])


def record_sentences(report: dict[str, Any]) -> list[str]:
    """What the record itself shows, and how much of the gap that is."""
    said = []
    for finding in report["record_findings"]:
        text = re.sub(r"(?<=\d)%", " %", capitalised(re.sub("^y ", "the output ", finding["text"])))
        said.append(f"{text} {_plateaus(report)}" if finding["topic"] == "plateaus" else text)
    return said


def _plateaus(report: dict[str, Any]) -> str:
    seen = report["plateaus"]
    missed, whole = seen["missed"], seen["missed"] / seen["of_gap"]
    size = f"The simulation misses these levels by {number(missed)} rms; its whole error is {number(whole)} rms."
    left = f"{number(seen['left'] * missed)} rms" if seen["left"] else "no more than noise may do"
    left += " is left of it"
    if seen["left"] > MAX_UNACCOUNTED:
        return f"{size} Nothing that was tried accounts for that: with the nearest explanation added, {left}."
    return f"{size} With the {'nearest explanation' if is_incomplete(report) else 'cause'} added, {left}."


def other_causes_sentence(report: dict[str, Any]) -> str:
    """What the probabilities of the ranking leave for a cause that is not in it."""
    left = max(1.0 - sum(row["probability"] for row in report["ranking"]), 0.0)
    if report["verdict"] == "none":
        return "Here none of them is needed."
    if unnamed_effects(report):
        return (
            "Of the first one only the part that is named above is sure; the rest of it is the nearest that was tried."
        )
    if report["verdict"] == "effect":
        return ""
    kept = f" That leaves {probability(left)} for a cause that is not in the table." if left > 0.005 else ""
    return f"Here none of them holds, so the first one is the nearest and not the right one.{kept}"


def gap_sentence(report: dict[str, Any]) -> str:
    """How large the gap is, before and after, and on which samples."""
    gap = report["gap"]
    where = "on samples that no fit has seen" if report["holdout_traces"] is None else "on the record held back"
    floor = f"the noise alone is {number(gap['noise_floor'])}"
    if is_unchanged(report):
        return f"The simulation misses the record by {number(gap['before'])} rms, and {floor}: in units of y, {where}."
    size = f"{number(gap['before'])} rms before and {number(gap['after'])} after"
    return f"The simulation misses the record by {size}, and {floor}: in units of y, {where}."


def black_box_sentence(report: dict[str, Any]) -> str | None:
    """What a flexible black box reaches on the same samples."""
    box = report["gap"].get("black_box")
    if box is None:
        return None
    if box <= 0.0:
        return "As a yardstick: a flexible black-box model of the input's past closes nothing on these samples."
    return (
        f"As a yardstick: a flexible black-box model of the input's past closes {closed_percent(box)} on these samples."
    )


def place_sentence(report: dict[str, Any]) -> str | None:
    """Where in the loop the causes sit."""
    effects = report["effects"]
    if not effects:
        return None
    places = [PLACES.get(effect["path"], effect["path"]) for effect in effects]
    if len(set(places)) == 1:
        return f"{capitalised(places[0])}."
    said = (f"{noun(effect['name'])}: {place}" for effect, place in zip(effects, places, strict=True))
    return f"{capitalised('; '.join(said))}."


def fitted_baseline_sentence(report: dict[str, Any]) -> str:
    """Why a gap lies ahead of what causes it, where it does."""
    if report["simulation"]["given"] or not {effect["name"] for effect in report["effects"]} & TIME_VARYING:
        return ""
    return "The simulation before is fitted to the whole record, so it is off on both sides of what changes in it."


def residual_sentences(report: dict[str, Any]) -> list[str]:
    """What is left unexplained, and what the residual tests say of it, in plain words."""
    left = report["unexplained"]
    white, linked = left["whiteness_p"], left["input_correlation_p"] < SIGNIFICANT
    link = p_value(left["input_correlation_p"])
    said = []
    if white >= SIGNIFICANT and not linked:
        said.append("What is left looks like noise and nothing else.")
    elif left["share"] > 0.0 and report["verdict"] != "none":
        said.append(f"{percent(left['share'])} of the gap is left, {number(left['rms'])} rms with the noise.")
    if white >= SIGNIFICANT:
        said.append(f"Its samples say nothing about the next ones (whiteness, {p_value(white)}).")
    else:
        said.append(
            f"Its samples remember each other (whiteness, {p_value(white)}): coloured noise does that, and so does "
            "whatever acts slowly."
        )
    if linked:
        said.append(f"It still follows the input ({link}): part of the dynamics is missing.")
    else:
        said.append(f"It has no linear link with the input ({link}).")
    if left.get("repeats", 0.0) > 0.1:
        said.append(
            f"It comes back when the same input comes back (correlation {left['repeats']:.2f}), and noise does not."
        )
    return said


def experiment_sentence(report: dict[str, Any]) -> str | None:
    """What to play on the rig next, and what that would settle."""
    planned = report["next_experiment"]
    if planned is None:
        return None
    ours, rival = distinguishing_effects(planned["separates"])
    why = str(planned["why"])
    for name in sorted(planned["separates"], key=len, reverse=True):
        why = why.replace(name, ours if name == planned["separates"][0] else rival)
    margin = planned["margin"]
    safe = "safe" if margin >= SAFE else "likely right"
    return f"It would tell {ours} from {rival}. {why} Expected margin {margin:.0f}: the decision would be {safe}."


def distinguishing_effects(separates: list[str]) -> tuple[str, str]:
    """Two explanations by what only one of them holds."""
    first, second = (name.split("+") for name in separates[:2])
    ours, rival = [n for n in first if n not in second], [n for n in second if n not in first]
    return joined([noun(n) for n in ours or first]), joined([noun(n) for n in rival or second])


def joined(words: list[str], last: str = "and", comma: bool = False) -> str:
    """``a, b and c``; whole clauses with a comma before the last."""
    if len(words) < 2:
        return "".join(words)
    return f"{', '.join(words[:-1])}{',' if comma else ''} {last} {words[-1]}"


def noun_without_article(name: str) -> str:
    """What an effect is called, without its article."""
    return noun(name).removeprefix("a ").removeprefix("an ")


def capitalised(text: str) -> str:
    """With a capital to begin with."""
    return text[:1].upper() + text[1:]


def uncapitalised(text: str) -> str:
    """With a small letter to begin with."""
    return text[:1].lower() + text[1:]
