"""Keep the answers of the diagnosis as data, and compare those of a changed one: ``python -m labsid.blind.frozen``.

``keep FILE`` diagnoses the first `dev` records of every row, and the measured records of a folder, and writes what was
answered. ``compare FILE`` diagnoses the same records again and prints what differs; its exit status is 1 if fewer
records of a row are answered rightly, or if other effects are asserted on a measured record.
"""

import argparse
import json
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from labsid.blind.metrics import CaseOutcome
from labsid.blind.right_answers import is_right
from labsid.blind.rows import DEFAULT_ROWS, ROWS
from labsid.blind.runner import run_batch, run_folder
from labsid.blind.suite import label_dict, make_cases
from labsid.rig.ordinary.kinds import KINDS

MEASURED = "measured"
SUFFIXES = (".csv", ".mat")
RECORDS = {"honest": len(KINDS), "joints": 6, "several": 6}
"""Records of a row of which not 12 are kept: more of many kinds, fewer of those that take half a minute each."""
Answer = dict[str, Any]
Answers = dict[str, dict[str, Any]]


def answer_of(result: Mapping[str, Any] | None, right: bool | None = None) -> Answer:
    """What is kept of a diagnosis.

    Parameters
    ----------
    result : dict or None
        In the layout ``labsid.gap/4``; None if there is none.
    right : bool, optional
        Whether it agrees with the label of a simulated record.

    Returns
    -------
    dict
        ``verdict``, ``effects`` (probability by name), ``closed`` (share of the gap) and ``right``.
    """
    if result is None or result["verdict"] == "error":
        return {"verdict": "error", "effects": {}, "closed": None, "right": None if right is None else False}
    closed = result["gap"]["closed"]
    return {
        "verdict": result["verdict"],
        "effects": {effect["name"]: round(float(effect["probability"]), 4) for effect in result["effects"]},
        "closed": None if closed is None else round(float(closed), 4),
        "right": right,
    }


def simulated_answers(row: str, per_row: int, jobs: int) -> dict[str, Any]:
    """Diagnose the first `dev` records of a row.

    Returns
    -------
    dict
        ``seconds`` (per record and core) and ``answers`` by the number of the record.
    """
    cases = list(make_cases("dev", per_row, [row], jobs))
    results, seconds = run_batch(cases, jobs)
    outcomes = [CaseOutcome(label_dict(case), results.get(case.name)) for case in cases]
    answers = {str(i): answer_of(one.result, is_right(one)) for i, one in enumerate(outcomes)}
    return {"seconds": round(seconds, 2), "answers": answers}


def measured_answers(folder: Path, jobs: int) -> dict[str, Any]:
    """Diagnose every record below a folder, with the second record of its rig where there is one.

    Returns
    -------
    dict
        As of `simulated_answers`, by the path of the record.
    """
    folders = sorted({path.parent for path in folder.rglob("*") if path.suffix in SUFFIXES})
    answers: dict[str, Answer] = {}
    spent = 0.0
    for one in folders:
        results, seconds = run_folder(one, jobs)
        spent += seconds * len(results)
        answers |= {f"{one.relative_to(folder).as_posix()}/{name}": answer_of(r) for name, r in results.items()}
    return {"seconds": round(spent / max(len(answers), 1), 2), "answers": answers}


def compare_answers(kept: Answers, found: Answers) -> tuple[list[str], bool]:
    """Compare two sets of answers.

    Parameters
    ----------
    kept, found : dict
        By row: ``seconds`` and ``answers``, as of `simulated_answers`.

    Returns
    -------
    lines : list of str
        A line for each row, and one for each record on which other effects are asserted.
    accepted : bool
        Whether no row has fewer right answers and no other effects are asserted on a measured record.
    """
    lines, changes, accepted = [], [], True
    for row, before in kept.items():
        after = found[row]
        pairs = [
            (name, old, after["answers"].get(name, answer_of(None, old["right"])))
            for name, old in before["answers"].items()
        ]
        changed = [pair for pair in pairs if _asserted(pair[1]) != _asserted(pair[2])]
        right = [sum(bool(pair[side]["right"]) for pair in pairs) for side in (1, 2)]
        accepted &= not changed if row == MEASURED else right[1] >= right[0]
        lines.append(
            f"{row:14}{len(pairs):4} records   right {right[0]:3} -> {right[1]:3}   "
            f"other effects {len(changed):3}   probability within {_largest(pairs, _probability):.4f}   "
            f"closed within {_largest(pairs, _closed):.4f}   seconds {before['seconds']:.2f} -> {after['seconds']:.2f}"
        )
        changes += [f"  {row} {name}: {_text(old)} -> {_text(new)}" for name, old, new in changed]
    return lines + changes, accepted


def _asserted(answer: Answer) -> tuple[str, list[str]]:
    """Verdict, and the effects that are more likely than not."""
    return answer["verdict"], sorted(name for name, p in answer["effects"].items() if p > 0.5)


def _text(answer: Answer) -> str:
    effects = ", ".join(f"{name} {p:.2f}" for name, p in answer["effects"].items())
    return f"{answer['verdict']} [{effects}]" + {None: "", True: " right", False: " wrong"}[answer["right"]]


def _probability(old: Answer, new: Answer) -> float:
    """Largest difference in the probability of an effect that both name."""
    both = old["effects"].keys() & new["effects"].keys()
    return max((abs(old["effects"][name] - new["effects"][name]) for name in both), default=0.0)


def _closed(old: Answer, new: Answer) -> float:
    return 0.0 if None in (old["closed"], new["closed"]) else abs(old["closed"] - new["closed"])


def _largest(pairs: Sequence[tuple[str, Answer, Answer]], difference: Any) -> float:
    return float(np.max([difference(old, new) for _, old, new in pairs], initial=0.0))


def main(arguments: Sequence[str] | None = None) -> int:
    """Keep or compare answers; returns the exit status."""
    parser = argparse.ArgumentParser(prog="python -m labsid.blind.frozen", description=__doc__)
    parser.add_argument("action", choices=("keep", "compare"))
    parser.add_argument("file", type=Path)
    parser.add_argument("--per-row", type=int, help="records of each row (keep); default: 12, and of honest each kind")
    parser.add_argument("--row", action="append", choices=[*ROWS, MEASURED], help="only this row; may be repeated")
    parser.add_argument("--records", type=Path, help="folder of measured records")
    parser.add_argument("--jobs", type=int, default=2, help="processes")
    chosen = parser.parse_args(arguments)
    rows = chosen.row or [*DEFAULT_ROWS, MEASURED]
    kept: Answers = json.loads(chosen.file.read_text(encoding="utf-8")) if chosen.action == "compare" else {}
    found: Answers = {}
    for row in rows:
        print(f"{row} ...", file=sys.stderr, flush=True)
        if row != MEASURED:
            count = len(kept[row]["answers"]) if kept else chosen.per_row or RECORDS.get(row, 12)
            found[row] = simulated_answers(row, count, chosen.jobs)
        elif chosen.records is not None:
            found[row] = measured_answers(chosen.records, chosen.jobs)
    if not kept:
        chosen.file.write_text(json.dumps(found, indent=1) + "\n", encoding="utf-8")
        return 0
    lines, accepted = compare_answers({row: kept[row] for row in kept if row in found}, found)
    print("\n".join(lines))
    print("accepted" if accepted else "not accepted: fewer right answers in a row, or other ones on a measured record")
    return int(not accepted)


if __name__ == "__main__":
    sys.exit(main())
