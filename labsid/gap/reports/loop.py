"""The control loop of a page: the way of the signal, with the causes in the blocks where they act."""

from typing import Any

from labsid._texts import cause_word, joined
from labsid.gap.record.record_findings import BY_LAW, BY_RELAY
from labsid.gap.reports import sentences
from labsid.gap.reports.effect_texts import place_at
from labsid.gap.verdict.black_boxes import PATHS
from labsid.plots.signal_names import name_of

BLOCKS = (
    ("input", "Actuator", "command to process"),
    ("dynamics", "Process", "dynamics of the rig"),
    ("output", "Sensor", "process to record"),
    ("disturbance", "Environment", "loads and noise"),
    ("parameters", "Simulation", "its parameters"),
)
LONGEST_END = 18  # characters of the names at an end of the loop; more are counted


def control_loop(report: dict[str, Any]) -> dict[str, Any]:
    """The loop as plain text.

    Parameters
    ----------
    report : dict
        Of one input and one output, or of several signals.

    Returns
    -------
    dict
        `blocks`, the simulation among them only if it was given; `ends`, the names of inputs and outputs; `closed`,
        whether a controller gives the input.
    """
    possible = {effect["path"]: effect["probability"] for effect in sorted(report["effects"], key=_probability)}
    kind = sentences.main_kind(report) if report["verdict"] in ("partial", "unknown") else None
    rest = None if kind is None else PATHS[kind]
    where = f" in {report['unexplained']['output']}" if "signals" in report else ""
    main = f"main part of the {'rest' if possible else 'error'}{where}"
    blocks = [
        {
            "path": path,
            "title": title,
            "what": what,
            "share": f"{100.0 * possible.get(path, 0.0):.0f}",
            "tags": [*_causes_at(path, report["effects"]), *([main] if path == rest else [])],
        }
        for path, title, what in BLOCKS
        if path != "parameters" or report["simulation"]["given"]
    ]
    return {"blocks": blocks, "ends": (_end(report, "input"), _end(report, "output")), "closed": _is_closed(report)}


def _causes_at(path: str, effects: list[dict[str, Any]]) -> list[str]:
    """The causes in one block of the loop; apart from them those that are less probable than not, and improbable."""
    named: dict[str, list[str]] = {}
    for effect in effects:
        if effect["path"] == path:
            seen = "" if place_at(effect) or not effect.get("outputs") else f" in {joined(effect['outputs'])}"
            named.setdefault(cause_word(effect["probability"]), []).append(f"{sentences.placed_noun(effect)}{seen}")
    return [f"{title}: {joined(names)}" for title, names in named.items()]


def _end(report: dict[str, Any], side: str) -> str:
    """The names of the inputs or of the outputs, or how many they are."""
    if "signals" not in report:
        return name_of(report, {"input": "u", "output": "y"}[side])
    names = [one["name"] for one in report["signals"][f"{side}s"]]
    said = ", ".join(names)
    return said if len(names) == 1 or len(said) <= LONGEST_END else f"{len(names)} {side}s"


def _is_closed(report: dict[str, Any]) -> bool:
    """Whether a controller gives the input of the record: as its findings say, or because the rig falls without one."""
    if "signals" in report:  # there, "stabilised" is beside measured outputs
        return False
    said = [finding["text"] for finding in report["record_findings"] if finding["topic"] == "feedback"]
    return report["gap"].get("mode") == "stabilised" or any(text.startswith((BY_RELAY, BY_LAW)) for text in said)


def _probability(effect: dict[str, Any]) -> float:
    return float(effect["probability"])
