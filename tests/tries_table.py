"""Print the first tries at each question, as they were judged: ``python tests/tries_table.py``.

"Named in the variants" are the wrong answers of `tests/variants` whose mistake is named by a slip.
"""

from collections import Counter

from tries import ACCEPTED, ASSIGNMENTS, MISLEADING, TAUGHT, TICK, VAGUE, fault_of, said_to, solve, tries_of
from variants import Wrong, variants_of

GRADES = (TAUGHT, VAGUE, MISLEADING, TICK, ACCEPTED)


def main() -> None:
    """Try all, and print a line for each question and the sums."""
    total: Counter[str] = Counter()
    print(f"{'question':32}{'tried':>6}{''.join(f'{grade:>12}' for grade in GRADES)}{'named in the variants':>24}")
    for name in ASSIGNMENTS:
        solved = solve(name)
        named = Counter(one.question for one in variants_of(name) if isinstance(one, Wrong) and one.slip)
        for question in solved.assignment.questions:
            tries = [one for one in tries_of(name) if one.question == question.id]
            outcomes = [(one, said_to(one, solved)) for one in tries]
            grades = Counter(
                TICK if said.ticked and one.grade != ACCEPTED else VAGUE if fault_of(one, said) else one.grade
                for one, said in outcomes
            )
            total += grades
            counts = "".join(f"{grades[grade]:12}" for grade in GRADES)
            print(f"{question.id:32}{len(tries):6}{counts}{named[question.id]:24}")
    print(f"{'all':32}{sum(total.values()):6}{''.join(f'{total[grade]:12}' for grade in GRADES)}")


if __name__ == "__main__":
    main()
