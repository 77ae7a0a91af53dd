"""Kept answers of the diagnosis, and their comparison with those of a changed one: ``labsid gap compare``.

Kept are the answers on the first `dev` records of every row, and on the measured records of a folder, in a JSON file:
by row ``seconds`` (per record and core), ``cases`` (a hash of each case, by its number or path) and ``answers``.
A case that is no longer the one that was kept is refused: another effect in a family shifts the draws of its row.
"""

import hashlib
import json
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from textwrap import fill
from typing import Any

import numpy as np

from labsid._files import check_writable, write_file
from labsid.blind.experiment import Case, OrdinaryCase
from labsid.blind.limits import ROW as LIMITS
from labsid.blind.metrics import CaseOutcome
from labsid.blind.right_answers import is_right
from labsid.blind.rows import DEFAULT_ROWS, ROWS
from labsid.blind.runner import run_batch, run_folder
from labsid.blind.suite import label_dict, make_cases, write_case
from labsid.rig.ordinary.kinds import KINDS

MEASURED = "measured"
"""The row of the measured records."""
SUFFIXES = (".csv", ".mat")
PER_ROW = 12
RECORDS = {"honest": len(KINDS), "joints": 6, "several": 6}
"""Records of a row of which not `PER_ROW` are kept: more of many kinds, fewer of those that take half a minute each."""
WIDTH = 80  # characters of a line
Answer = dict[str, Any]
Answers = dict[str, dict[str, Any]]

_NUMBER = re.compile(r"[-+]?\d+(?:\.\d*)?(?:[eE][-+]?\d+)?")
_TITLES = (
    "                                 other    largest change of",
    "row          records     right  effects  probability   closed  seconds a record",
)


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


def keep_answers(
    file: Path,
    rows: Sequence[str] | None = None,
    per_row: int | None = None,
    records: Path | None = None,
    jobs: int = 1,
    progress: Callable[[str, float], None] | None = None,
) -> None:
    """Diagnose the first `dev` records of each row and write the answers to a file; its other rows stay as they are.

    Parameters
    ----------
    file : Path
        JSON; created if missing. It is written after each row.
    rows : sequence of str, optional
        By default those that `labsid gap blind` runs, and the measured records if there is a folder of them.
    per_row : int, optional
        Records of each row; by default `RECORDS`, and `PER_ROW` of the other rows.
    records : Path, optional
        Folder of measured records.
    jobs : int
        Number of parallel processes.
    progress : callable, optional
        Called with the row and the share of all rows that is done.

    Raises
    ------
    ValueError
        If a row does not exist, measured records are asked for without a folder, or the file holds something else.
    """
    check_writable(file)
    wanted = list(rows or (*DEFAULT_ROWS, *([] if records is None else [MEASURED])))
    _check_rows(wanted)
    folder = _folder(records) if MEASURED in wanted else Path()
    kept = read_answers(file) if file.exists() else {}
    for number, row in enumerate(wanted):
        if progress is not None:
            progress(row, number / len(wanted))
        if row == MEASURED:
            kept[row] = measured_answers(folder, jobs)
        else:
            cases = list(make_cases("dev", per_row or RECORDS.get(row, PER_ROW), [row], jobs))
            kept[row] = simulated_answers(cases, jobs)
        write_file(file, (json.dumps(kept, indent=1) + "\n").encode())


def compare_with_kept(
    file: Path,
    rows: Sequence[str] | None = None,
    records: Path | None = None,
    jobs: int = 1,
    progress: Callable[[str, float], None] | None = None,
) -> tuple[str, bool]:
    """Diagnose the records of the kept answers again, and compare.

    Parameters
    ----------
    file : Path
        Written by `keep_answers`.
    rows : sequence of str, optional
        By default all rows of the file, without the measured records if there is no folder of them.
    records : Path, optional
        Folder of the measured records.
    jobs : int
        Number of parallel processes.
    progress : callable, optional
        Called with the row and the share of all rows that is done.

    Returns
    -------
    text : str
        The table, and a line for each record on which other effects are asserted.
    accepted : bool
        As of `compare_answers`.

    Raises
    ------
    ValueError
        If a row does not exist or is not kept, or a case is no longer the one that was kept.
    """
    kept = read_answers(file)
    wanted = list(rows or (row for row in kept if row != MEASURED or records is not None))
    _check_rows(wanted)
    absent = [row for row in wanted if row not in kept]
    if absent:
        raise ValueError(
            f"{file} has no answers of the row {absent[0]}, only of {', '.join(kept)}. "
            f"Keep them: labsid gap compare {file} --keep --row {absent[0]}"
        )
    folder = _folder(records) if MEASURED in wanted else Path()
    cases: dict[str, list[Case | OrdinaryCase]] = {}
    changed: dict[str, list[str]] = {}
    for row in wanted:
        if row == MEASURED:
            hashes = measured_hashes(folder, kept[row]["answers"])
        else:
            cases[row] = list(make_cases("dev", len(kept[row]["answers"]), [row], jobs))
            hashes = case_hashes(cases[row])
        changed[row] = changed_cases(kept[row], hashes)
    if any(changed.values()):
        raise ValueError(_refusal(file, changed))
    answers: Answers = {}
    for number, row in enumerate(wanted):
        if progress is not None:
            progress(row, number / len(wanted))
        answers[row] = measured_answers(folder, jobs) if row == MEASURED else simulated_answers(cases[row], jobs)
    lines, accepted = compare_answers({row: kept[row] for row in wanted}, answers)
    if MEASURED in kept and MEASURED not in wanted and rows is None:
        lines.append("The measured records are not compared; name their folder with --records.")
    lines.append("accepted" if accepted else "not accepted: fewer right answers, or other ones on a measured record")
    return "\n".join(lines), accepted


def read_answers(file: Path) -> Answers:
    """Read a file that `keep_answers` wrote.

    Parameters
    ----------
    file : Path

    Returns
    -------
    dict
        ``seconds``, ``cases`` and ``answers`` by row.

    Raises
    ------
    ValueError
        If the file holds something else.
    """
    try:
        kept = json.loads(file.read_text(encoding="utf-8"))
        complete = all(set(answers["cases"]) == set(answers["answers"]) for answers in kept.values())
    except (ValueError, AttributeError, TypeError, KeyError):
        complete = False
    if not complete:
        raise ValueError(f"{file} is no file of kept answers. Write one: labsid gap compare FILE --keep")
    return kept


def row_meanings() -> str:
    """The name of each row and what its records are, as text."""
    meanings = {row: (draw.__doc__ or "").splitlines()[0] for row, draw in ROWS.items()}
    meanings[LIMITS] = "Effects of the sizes that `labsid gap limits` states, planted (labsid gap blind)."
    meanings[MEASURED] = "The records of a folder, with --records (labsid gap compare)."
    return "\n".join(fill(f"{row:14}{meaning}", WIDTH, subsequent_indent=" " * 14) for row, meaning in meanings.items())


def simulated_answers(cases: Sequence[Case | OrdinaryCase], jobs: int) -> dict[str, Any]:
    """Diagnose the cases of a row.

    Parameters
    ----------
    cases : sequence of Case or OrdinaryCase
    jobs : int
        Number of parallel processes.

    Returns
    -------
    dict
        ``seconds`` (per record and core), and ``cases`` and ``answers`` by the number of the record.
    """
    results, seconds = run_batch(cases, jobs)
    outcomes = [CaseOutcome(label_dict(case), results.get(case.name)) for case in cases]
    answers = {str(i): answer_of(outcome.result, is_right(outcome)) for i, outcome in enumerate(outcomes)}
    return {"seconds": round(seconds, 2), "cases": case_hashes(cases), "answers": answers}


def measured_answers(folder: Path, jobs: int) -> dict[str, Any]:
    """Diagnose every record below a folder, with the second record of its rig where there is one.

    Parameters
    ----------
    folder : Path
    jobs : int
        Number of parallel processes.

    Returns
    -------
    dict
        As of `simulated_answers`, by the path of the record.
    """
    folders = sorted({path.parent for path in folder.rglob("*") if path.suffix in SUFFIXES})
    answers: dict[str, Answer] = {}
    spent = 0.0
    for rigs in folders:
        results, seconds = run_folder(rigs, jobs)
        spent += seconds * len(results)
        answers |= {f"{rigs.relative_to(folder).as_posix()}/{name}": answer_of(r) for name, r in results.items()}
    return {
        "seconds": round(spent / max(len(answers), 1), 2),
        "cases": measured_hashes(folder, answers),
        "answers": answers,
    }


def case_hashes(cases: Sequence[Case | OrdinaryCase]) -> dict[str, str]:
    """A hash of the record and the label of each case, by its number in the row.

    Parameters
    ----------
    cases : sequence of Case or OrdinaryCase

    Notes
    -----
    The last digits of a simulation differ from one processor to the next. Six digits of the numbers of the label count,
    and of a file the text between its numbers, how many they are, and six digits of two of their means.
    """
    return {str(number): _case_hash(case) for number, case in enumerate(cases)}


def _case_hash(case: Case | OrdinaryCase) -> str:
    label = json.dumps(label_dict(case), sort_keys=True)
    digest = hashlib.sha256(_NUMBER.sub(lambda match: f"{float(match[0]):.6g}", label).encode())
    with TemporaryDirectory(prefix="labsid-blind-") as scratch:
        write_case(Path(scratch), case)
        for path in sorted(path for path in Path(scratch).rglob("*") if path.is_file()):
            text = path.read_text(encoding="utf-8")
            sizes = np.array([abs(float(number)) for number in _NUMBER.findall(text)])
            means = f"{sizes.mean():.6g} {np.log1p(sizes).mean():.6g}" if sizes.size else ""
            digest.update(f"\n{path.name} {sizes.size} {means} {_NUMBER.sub('', text)}".encode())
    return digest.hexdigest()[:12]


def measured_hashes(folder: Path, names: Iterable[str]) -> dict[str, str]:
    """A hash of the files of each measured record that is there: the record, its second record and its simulation.

    Parameters
    ----------
    folder : Path
    names : iterable of str
        Paths below the folder, without the ending of the file.
    """
    hashes = {}
    for name in names:
        record = folder / name
        files = [path for path in _files_below(record.parent) if path.name.split(".")[0] == record.name.split(".")[0]]
        files += _files_below(record)
        if files:
            digest = hashlib.sha256()
            for path in files:
                digest.update(f"{path.name}\n".encode() + path.read_bytes())
            hashes[name] = digest.hexdigest()[:12]
    return hashes


def _files_below(folder: Path) -> list[Path]:
    return sorted(path for path in folder.iterdir() if path.is_file()) if folder.is_dir() else []


def changed_cases(kept: Mapping[str, Any], hashes: Mapping[str, str]) -> list[str]:
    """Names of the kept cases that are not there any more, or that are others now.

    Parameters
    ----------
    kept : dict
        ``cases`` of a row.
    hashes : dict
        Hash of each case that is there now.
    """
    return [name for name, known in kept["cases"].items() if hashes.get(name) != known]


def _refusal(file: Path, changed: Mapping[str, Sequence[str]]) -> str:
    """What is refused, and the command that keeps these rows again."""
    rows = {row: names for row, names in changed.items() if names}
    listed = [
        f"{row}: {'case ' if row != MEASURED else ''}{', '.join(names[:3])}"
        + (f" and {len(names) - 3} more" if len(names) > 3 else "")
        for row, names in rows.items()
    ]
    return (
        f"these records or what is right for them are no longer those of the kept answers: {'; '.join(listed)}. "
        f"Keep their rows again: labsid gap compare {file} --keep {' '.join(f'--row {row}' for row in rows)}"
    )


def _check_rows(rows: Sequence[str]) -> None:
    known = (*ROWS, MEASURED)
    for row in rows:
        if row not in known:
            raise ValueError(f"--row must be one of {', '.join(known)}; got {row!r}. `--rows` says what each is.")


def _folder(records: Path | None) -> Path:
    if records is None:
        raise ValueError("the measured records are in a folder of yours. Name it with --records DIR.")
    return records


def compare_answers(kept: Answers, found: Answers) -> tuple[list[str], bool]:
    """Compare two sets of answers.

    Parameters
    ----------
    kept, found : dict
        By row: ``seconds`` and ``answers``, as of `simulated_answers`.

    Returns
    -------
    lines : list of str
        A table with a line for each row, and one for each record on which other effects are asserted.
    accepted : bool
        Whether no row has fewer right answers and no other effects are asserted on a measured record.
    """
    lines, changes, accepted = list(_TITLES), [], True
    for row, earlier in kept.items():
        now = found[row]
        pairs = [
            (name, old, now["answers"].get(name, answer_of(None, old["right"])))
            for name, old in earlier["answers"].items()
        ]
        changed = [pair for pair in pairs if _asserted(pair[1]) != _asserted(pair[2])]
        right = [sum(bool(pair[side]["right"]) for pair in pairs) for side in (1, 2)]
        accepted &= not changed if row == MEASURED else right[1] >= right[0]
        lines.append(
            f"{row:13}{len(pairs):7}{'-' if row == MEASURED else f'{right[0]} -> {right[1]}':>10}{len(changed):9}"
            f"{_largest(pairs, _probability):13.4f}{_largest(pairs, _closed):9.4f}"
            f"{earlier['seconds']:8.2f} -> {now['seconds']:.2f}"
        )
        changes += [_change_text(row, *pair) for pair in changed]
    return lines + changes, accepted


def _asserted(answer: Answer) -> tuple[str, list[str]]:
    """Verdict, and the effects that are more likely than not."""
    return answer["verdict"], sorted(name for name, p in answer["effects"].items() if p > 0.5)


def _change_text(row: str, name: str, old: Answer, new: Answer) -> str:
    return fill(f"{row} {name}: {_text(old)} -> {_text(new)}", WIDTH, initial_indent="  ", subsequent_indent="      ")


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
