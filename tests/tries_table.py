"""Print the first tries at each question, as they were judged: ``python tests/tries_table.py [ASSIGNMENT]``.

With an assignment, print each try at it, the grade that it was given and what the check says. "Named in the variants"
are the wrong answers of `tests/variants` whose mistake is named by a slip.
"""

import argparse
from collections import Counter

from tries import ACCEPTED, ASSIGNMENTS, MISLEADING, TAUGHT, TICK, VAGUE, fault_of, said_to, solve, tries_of
from variants import Wrong, variants_of

GRADES = (TAUGHT, VAGUE, MISLEADING, TICK, ACCEPTED)


def print_messages(name: str) -> None:
    """Print what is said to each try at an assignment."""
    solved = solve(name)
    for question in solved.assignment.questions:
        print(question.id)
        for attempt in (attempt for attempt in tries_of(name) if attempt.question == question.id):
            said = said_to(attempt, solved)
            fault = f"  << {fault}" if (fault := fault_of(attempt, said)) else ""
            print(f"  {attempt.name} ({attempt.grade}): {'✓ ' * said.ticked}{said.message}{fault}")


def print_table() -> None:
    """Try all, and print a line for each question and the sums."""
    total: Counter[str] = Counter()
    print(f"{'question':32}{'tried':>6}{''.join(f'{grade:>12}' for grade in GRADES)}{'named in the variants':>24}")
    for name in ASSIGNMENTS:
        solved = solve(name)
        named = Counter(answer.question for answer in variants_of(name) if isinstance(answer, Wrong) and answer.slip)
        for question in solved.assignment.questions:
            attempts = [attempt for attempt in tries_of(name) if attempt.question == question.id]
            outcomes = [(attempt, said_to(attempt, solved)) for attempt in attempts]
            grades = Counter(
                TICK
                if said.ticked and attempt.grade != ACCEPTED
                else VAGUE
                if fault_of(attempt, said)
                else attempt.grade
                for attempt, said in outcomes
            )
            total += grades
            counts = "".join(f"{grades[grade]:12}" for grade in GRADES)
            print(f"{question.id:32}{len(attempts):6}{counts}{named[question.id]:24}")
    print(f"{'all':32}{sum(total.values()):6}{''.join(f'{total[grade]:12}' for grade in GRADES)}")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("assignment", nargs="?", choices=ASSIGNMENTS)
    chosen = parser.parse_args().assignment
    print_table() if chosen is None else print_messages(chosen)
