"""The answer in a few lines for the terminal: a pure function of the report."""

import textwrap
from typing import Any

from labsid.gap import sentences
from labsid.gap.effect_texts import noun, parameter_label, parameter_value
from labsid.gap.location_text import location_sentences
from labsid.gap.quantities import probability

WIDTH = 96
INDENT = 11


def format_report(report: dict[str, Any]) -> str:
    """Say the verdict in one sentence, and in a few lines what it rests on.

    Parameters
    ----------
    report : dict
        In the layout ``labsid.gap/1``.

    Returns
    -------
    str
        Lines of at most 96 characters: the sentence; the causes with their parameters and standard errors; the gap
        before and after; where it lies; what cannot be told apart; what is left; what the record and its raw samples
        show; and the next experiment.
    """
    lines = [*_row("", sentences.verdict_sentence(report), indent=0), ""]
    for effect in report["effects"]:
        lines += _effect(effect)
    for number, said_of_it in enumerate(sentences.record_sentences(report)):
        lines += _row("" if number else "record", _plain(said_of_it))
    rows = [
        ("unsure", [sentences.ambiguity_sentence(report)]),
        ("gap", [sentences.gap_sentence(report), sentences.black_box_sentence(report)]),
        ("where", [sentences.place_sentence(report), *location_sentences(report)]),
        ("left", sentences.residual_sentences(report)),
        ("samples", report["screen"]),
        ("next", [_experiment(report)]),
    ]
    if report["verdict"] == "none":
        rows = [row for row in rows if row[0] != "where"]  # where noise lies says nothing
    if report["verdict"] == "unknown":
        tried = sentences.joined([sentences.noun_without_article(name) for name in sentences.effects_tried(report)])
        rows.insert(1, ("tried", [f"{sentences.capitalised(tried)}."]))
    for title, said in rows:
        lines += _row(title, " ".join(_plain(text) for text in said if text))
    return "\n".join(lines)


def _effect(effect: dict[str, Any]) -> list[str]:
    """One cause and, below it, its parameters in columns."""
    chance = probability(effect["probability"])
    lines = _row("cause", f"{noun(effect['name'])} ({effect['name']}), probability {chance}")
    rows = [
        (parameter_label(effect["name"], name, entry["unit"]), *parameter_value(effect["name"], name, entry))
        for name, entry in effect["parameters"].items()
    ]
    wide = [max((len(row[i]) for row in rows), default=0) for i in range(2)]
    blank = " " * INDENT
    return lines + [f"{blank}  {a:<{wide[0]}}  {b:<{wide[1]}}  {c}".rstrip() for a, b, c in rows]


def _experiment(report: dict[str, Any]) -> str | None:
    said = sentences.experiment_sentence(report)
    return None if said is None else f"Play the input that --json writes as next_experiment. {said}"


def _row(title: str, text: str, indent: int = INDENT) -> list[str]:
    if not text:
        return []
    for unit in "%±":  # never apart from their number
        text = text.replace(f" {unit}", f"\u00a0{unit}")
    lines = textwrap.wrap(text, WIDTH, initial_indent=f"{title:<{indent}}", subsequent_indent=" " * indent)
    return [line.replace("\u00a0", " ") for line in lines]


def _plain(text: str) -> str:
    """Without control characters: a file's content must not steer the terminal."""
    return "".join(c if c.isprintable() else " " for c in text)
