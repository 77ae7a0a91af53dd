"""What the first screen of a page says beside the verdict: the closed share, the probability, and what to do next."""

from typing import Any

from labsid._texts import joined
from labsid.gap.effects.detected import UNSIMULATED
from labsid.gap.reports import sentences
from labsid.gap.reports.quantities import closed_percent, probability

MOST_HIDDEN = 4  # effects that a record could not have shown, named in a sentence; more are counted


def on_track(closed: float | None, ci95: list[float] | None) -> dict[str, str]:
    """A closed share with its interval as text, and their places on a track of the whole gap in per cent."""
    if closed is None:
        return {"closed": "–", "at": "", "low": "", "span": ""}
    at = f"{100.0 * min(max(closed, 0.0), 1.0):.1f}"
    if ci95 is None:
        return {"closed": closed_percent(closed), "at": at, "low": "", "span": ""}
    low, high = (min(max(end, 0.0), 1.0) for end in ci95)
    return {
        "closed": closed_percent(closed, ci95),
        "at": at,
        "low": f"{100.0 * low:.1f}",
        "span": f"{100.0 * (high - low):.1f}",
    }


def chances_sentence(report: dict[str, Any]) -> str | None:
    """The probability of the causes, once if it is the same for all; None if none is more probable than not."""
    effects = report["effects"]
    chances = [one.get("chance", probability(one["probability"])) for one in effects]
    if not any(sentences.is_probable(one) for one in effects):
        return None
    if len(set(chances)) == 1:
        return f"Probability of the cause{'s' * (len(effects) > 1)}: {chances[0]}."
    nouns = [sentences.placed_noun(one) for one in effects]
    return f"Probability: {', '.join(f'{noun} {chance}' for noun, chance in zip(nouns, chances, strict=True))}."


def shown_sentence(report: dict[str, Any]) -> str | None:
    """Of how many effects the record would have shown an occurrence; None with a gap, or without limits."""
    names = dict.fromkeys(row["name"] for row in report.get("limits", ()))
    if report["verdict"] != "none" or not names:
        return None
    seen = {row["name"] for row in report["limits"] if row["detect"] is not None}
    hidden = [sentences.noun_without_article(name) for name in names if name not in seen]
    if not hidden:
        return f"The record would have shown each of {len(names)} effects, from the sizes below on."
    listed = joined(hidden, "or") if len(hidden) <= MOST_HIDDEN else f"the {len(hidden)} others"
    could = f"The record would have shown {len(seen)} of {len(names)} effects, from the sizes below on."
    return f"{could} It could not have shown {listed}."


def next_step(report: dict[str, Any]) -> str:
    """What to do after this diagnosis, in one or two sentences."""
    verdict, planned = report["verdict"], report["next_experiment"]
    if planned is not None:
        return "Apply the proposed input. It distinguishes {} from {}.".format(
            *sentences.distinguishing_effects(planned["separates"])
        )
    if verdict == "none":
        return "No further experiment is needed for this record."
    if "signals" not in report and sentences.plateaus_matter(report):
        return "Apply the same input again, and see whether the output settles at other levels once more."
    if verdict == "effect" and report["ambiguous"]:
        return (
            "Take a longer record, of a wider range or with a further sensor. No input within this range was found "
            "that distinguishes the alternatives."
        )
    if verdict == "effect":
        return _of_causes(report)
    return sentences.look_sentence(report) or "Inspect the rig under the conditions in which the gap is largest."


def _of_causes(report: dict[str, Any]) -> str:
    """Where to look for the causes, and what repairs the simulation."""
    if sentences.is_mismatch(report):
        return "Give your simulation the fitted values, which --export FILE writes."
    simulated = [one for one in report["effects"] if one["name"] not in UNSIMULATED]
    nouns = joined([sentences.placed_noun(one, article=True) for one in report["effects"]])
    if "signals" in report or not simulated:
        return f"Check the rig for {nouns}."
    return f"Check the rig for {nouns}, or use the corrected simulation, which --export FILE writes."
