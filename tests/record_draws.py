"""Draw other records many times: a typed-in value must be wrong on each of them, and every right style right.

`python -P tests/record_draws.py --draws 200` is the bar; the tests draw a few.
"""

import argparse
import sys
import time
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
sys.path.insert(0, str(Path(__file__).resolve().parent.parent))

from one_answer import Solved, own_record, quietly, solve
from typed_in import IMPORTS, literal_line, typed_in, values_of
from variants import Right, variants_of

from labsid.checks.notebook import assignment_names, load_assignment
from labsid.checks.other_records import another_record, can_be_drawn
from labsid.checks.question import FollowsFrom

NOT_OF_THE_RIG = {
    "t": "the sampling time and the number of samples stay the same",
    "Ts": "it stays the same",
    "td_tank": "a delay of two seconds cannot differ by three tolerances of two seconds",
}
"""Names whose value alone may be typed in, and why."""


PASSES = "typed in, passes:"


@dataclass(frozen=True)
class Drawn:
    """What was wrong with one draw, and how much was tried."""

    passed: tuple[str, ...]
    refused: tuple[str, ...]
    tried: int


def with_record() -> list[str]:
    """The assignments that are run on another record."""
    return [name for name in assignment_names() if can_be_drawn(load_assignment(name).record_file or "")]


@cache
def typed_variants(name: str, student: str) -> dict[str, list[tuple[str, dict[str, str]]]]:
    """Typed-in answers to each question that follows from the data: all values of its cells, and each one alone."""
    solved = solve(name, student)
    typed = typed_in(solved)
    ids = list(solved.cells)
    found: dict[str, list[tuple[str, dict[str, str]]]] = {}
    for question in asked(solved):
        cells = [cell for cell in solved.answer_cells(question) if cell in typed]
        if not cells:
            continue
        read = solved.names_read(question)
        if not any(set(values_of(solved, cell, ids[ids.index(cell) + 1])) & read for cell in cells):
            continue  # its check only calls functions
        found[question] = [("all values", {cell: typed[cell] for cell in cells})]
        for cell in cells:
            values = values_of(solved, cell, ids[ids.index(cell) + 1])
            for one in sorted(set(values) & read - set(NOT_OF_THE_RIG)):
                line = literal_line(one, values[one])
                found[question].append((one, {cell: f"{solved.cells[cell]}\n{IMPORTS}\n{line}"}))
    return found


def asked(solved: Solved) -> list[str]:
    """The questions that follow from the data."""
    return [one.id for one in solved.assignment.questions if one.follows_from is FollowsFrom.DATA]


def draw(name: str, student: str, entropy: int) -> Drawn:
    """Judge a student's typed-in values, and every right variant, on a record drawn in the place of the student's."""
    typed = typed_variants(name, student)
    own = own_record(name, student)
    assert own is not None
    other = solve(name, student, another_record(load_assignment(name).record_file or "", own, entropy))
    passed, refused = [], []
    tried = 0
    for question in asked(other):
        verdict = other.judge(question, {})
        if not verdict.passed:
            refused.append(f"{question}, model solution: {verdict.reason}")
        for what, code in typed.get(question, []):
            tried += 1
            if other.judge(question, code).passed:
                passed.append(f"{question}: {what}")
    for variant in right_variants(name, tuple(asked(other))):
        tried += 1
        verdict = other.judge(variant.question, variant.code)
        if not verdict.passed:
            refused.append(f"{variant.question}, {variant.name}: {verdict.reason}")
    return Drawn(tuple(passed), tuple(refused), tried)


@cache
def right_variants(name: str, questions: tuple[str, ...]) -> tuple[Right, ...]:
    """The right answers in other styles that are right on the student's own record in this process, too."""
    own = solve(name)
    return tuple(
        variant
        for variant in variants_of(name)
        if isinstance(variant, Right)
        and variant.question in questions
        and own.judge(variant.question, variant.code).passed
    )


def draws(name: str, count: int, first: int = 0) -> Iterator[Drawn]:
    """Several draws, each in the place of another student's record."""
    with quietly():
        for number in range(first, first + count):
            yield draw(name, f"z{number % 20:07d}", 7919 * number + 1)


def counted(name: str, first: int, count: int) -> tuple[list[str], int]:
    """A line for each kind of answer that was not judged as it should be, and the number of answers."""
    found: dict[str, int] = {}
    tried = 0
    for one in draws(name, count, first):
        tried += one.tried
        for line in (*(f"{PASSES} {text}" for text in one.passed), *one.refused):
            found[line] = found.get(line, 0) + 1
    return [f"{line} ({times} times)" for line, times in sorted(found.items(), key=lambda one: -one[1])], tried


def main() -> int:
    options = argparse.ArgumentParser(description=__doc__)
    options.add_argument("--draws", type=int, default=200)
    options.add_argument("--only", choices=with_record(), action="append")
    chosen = options.parse_args()
    wrong = 0
    for name in chosen.only or with_record():
        began = time.monotonic()
        lines, tried = counted(name, 0, chosen.draws)
        wrong += len(lines)
        print(f"{name}: {chosen.draws} draws, {tried} answers, {time.monotonic() - began:.0f} s", flush=True)
        print("".join(f"  {line}\n" for line in lines), end="", flush=True)
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
