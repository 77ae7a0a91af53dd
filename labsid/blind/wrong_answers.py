"""Diagnose simulated records and list the wrong answers: ``python -m labsid.blind.wrong_answers``.

With ``--keep DIR`` the records stay in ``DIR/records``, their labels in ``DIR/labels.json`` and the reports in a folder
for each version of the diagnosis. A second run then continues an interrupted one, and the command line of each wrong
record can be run again in ``DIR/records``.
"""

import argparse
import json
import shlex
from collections.abc import Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from labsid.blind.experiment import Case, OrdinaryCase
from labsid.blind.honest import count_kinds, found_numbers, has_right_numbers, honest_metrics
from labsid.blind.metrics import CaseOutcome
from labsid.blind.placed_effects import SIGNAL_ROWS
from labsid.blind.right_answers import is_right
from labsid.blind.rows import ROWS
from labsid.blind.runner import diagnose_words, run_batch
from labsid.blind.suite import diagnosis_hash, label_dict, make_cases, write_case
from labsid.blind.table import metric_cells, print_kinds
from labsid.rig.ordinary.kinds import KINDS


def answer_text(case: CaseOutcome) -> str:
    """The answer with its probabilities, or the message of an error.

    Parameters
    ----------
    case : CaseOutcome
    """
    if case.result is None:
        return "no result within the time"
    if case.result["verdict"] == "error":
        return f"error: {case.result.get('message', '')}"
    named = [f"{_placed(effect)} {effect['probability']:.2f}" for effect in case.result["effects"]]
    rest = [f"or {', '.join(map(_placed, case.result['ambiguous']))}"] if case.result.get("ambiguous") else []
    return " ".join([case.result["verdict"], *named, *rest])


def _placed(one: str | dict[str, Any]) -> str:
    """Name of a stated or true effect, with its signal if it has one."""
    if isinstance(one, str):
        return one
    return f"{one['name']} at {one['signal']}" if one.get("signal") else str(one["name"])


def true_text(label: dict[str, Any]) -> str:
    """The right answers of a label."""
    if label.get("row") in SIGNAL_ROWS:
        return "+".join(map(_placed, label["truth"]["effects"])) or "none"
    answers = label.get("answers") or [label["labels"]]
    return " | ".join("+".join(answer) or "none" for answer in answers)


def wrong_text(number: int, case: Case | OrdinaryCase, outcome: CaseOutcome) -> str:
    """Three lines on a wrong answer: which record it is, what is right and what was answered, how to repeat it.

    Parameters
    ----------
    number : int
        Number of the record in its row, from which it is drawn.
    case : Case or OrdinaryCase
    outcome : CaseOutcome
    """
    label = outcome.label
    kind = label["truth"].get("kind") or "+".join(label["labels"])
    lines = [
        f"{case.row} {number} {kind}: {case.name}",
        f"    right: {true_text(label)}    answer: {answer_text(outcome)}",
        f"    {shlex.join(['labsid', *diagnose_words(case)])}",
    ]
    if not has_right_numbers(outcome):
        lines.insert(2, f"    numbers: {found_numbers(outcome.result)} instead of {label['numbers']}")
    return "\n".join(lines)


def main(arguments: Sequence[str] | None = None) -> None:
    """Make the records, diagnose them, and print each wrong answer and the counts."""
    parser = argparse.ArgumentParser(prog="python -m labsid.blind.wrong_answers", description=__doc__)
    parser.add_argument("--row", action="append", choices=list(ROWS), help="row; may be repeated; default: honest")
    parser.add_argument(
        "--kind", action="append", choices=list(KINDS), help="only this kind of honest; may be repeated"
    )
    parser.add_argument("--per-row", type=int, default=len(KINDS), help="records of each row, before --kind")
    parser.add_argument("--suite", choices=("dev", "final"), default="dev")
    parser.add_argument("--jobs", type=int, default=2, help="processes")
    parser.add_argument("--keep", type=Path, metavar="DIR", help="keep records, labels and reports here")
    chosen = parser.parse_args(arguments)
    made = make_cases(chosen.suite, chosen.per_row, chosen.row or ["honest"], chosen.jobs)
    numbered = [(n % chosen.per_row, case) for n, case in enumerate(made)]
    numbered = [(n, case) for n, case in numbered if not chosen.kind or getattr(case, "kind", None) in chosen.kind]
    cases = [case for _, case in numbered]
    with TemporaryDirectory(prefix="labsid-blind-") as scratch:
        folder = Path(scratch) if chosen.keep is None else chosen.keep
        records = folder / "records"
        records.mkdir(parents=True, exist_ok=True)
        for case in cases:
            write_case(records, case)
        labels = {case.name: label_dict(case) for case in cases}
        (folder / "labels.json").write_text(json.dumps(labels, indent=1), encoding="utf-8")
        results, seconds = run_batch(cases, chosen.jobs, keep=folder / f"reports-{diagnosis_hash():x}")
    outcomes = [CaseOutcome(labels[case.name], results.get(case.name)) for case in cases]
    for (number, case), outcome in zip(numbered, outcomes, strict=True):
        if not (is_right(outcome) and has_right_numbers(outcome)):
            print(wrong_text(number, case, outcome))
    for row in dict.fromkeys(case.row for case in cases):
        of_row = [outcome for outcome in outcomes if outcome.label["row"] == row]
        print(f"{row}: {sum(map(is_right, of_row))} of {len(of_row)} right, {seconds:.1f} s a record and core")
    honest, faint = ([outcome for outcome in outcomes if outcome.label["row"] == row] for row in ("honest", "faint"))
    for metric in honest_metrics(honest, faint):
        if metric.count:
            name, value, between, count, *_ = metric_cells(metric)
            print(f"{name.strip()}: {value} [{between}] of {count}")
    if honest:
        print_kinds(count_kinds(honest))


if __name__ == "__main__":
    main()
