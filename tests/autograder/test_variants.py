"""Every automatic question: different right answers pass, plausible wrong ones fail with the right hint."""

import random
import re
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import cache, partial

import pytest
from one_answer import solve
from variants import Right, Wrong, questions_lost, variants_of

from autograder.course.layout import Course, read_template
from autograder.judge.outcome import QuestionResult
from labsid.checks.notebook import assignment_names, load_assignment

ASSIGNMENTS = assignment_names()

Grade = Callable[[Mapping[str, str]], Mapping[str, QuestionResult]]


MOST = 2
"""Wrong variants of a question that are graded as hand-ins; further ones are judged in this process. `make bars` grades
every one as a hand-in of its own."""
MORE = ("sim-to-real-gap",)
"""Assignments of which more are graded: in this process, an answer meets the record of a rig with another effect."""


@cache
def shared_out(name: str) -> tuple[list[Right | Wrong], list[Right | Wrong]]:
    """The variants that are graded as hand-ins, and those that are judged in this process."""
    variants = variants_of(name)
    random.Random(name).shuffle(variants)
    graded: list[Right | Wrong] = []
    judged: list[Right | Wrong] = []
    most = 4 if name in MORE else MOST
    counts: Counter[tuple[str, bool]] = Counter()
    for variant in variants:
        key = variant.question, isinstance(variant, Wrong)
        counts[key] += 1
        (graded if counts[key] <= most else judged).append(variant)
    return graded, judged


@cache
def hand_ins(name: str) -> list[list[Right | Wrong]]:
    """The variants that are graded, in as few hand-ins as let every wrong question meet every other one.

    A hand-in holds at most one variant of a question, and wrong ones for at most half of the questions, so that a wrong
    answer that spoils another question is found; right variants fill the rest.
    """
    variants, _ = shared_out(name)
    wrong = [variant for variant in variants if isinstance(variant, Wrong)]
    questions = {variant.question for variant in wrong}
    fewest = max(Counter(variant.question for variant in wrong).values())
    packed = next(
        hand_ins
        for count in range(fewest, len(wrong))
        if not unmet_pairs(hand_ins := distribute(wrong, count, (len(questions) + 1) // 2), questions)
    )
    return distribute([variant for variant in variants if isinstance(variant, Right)], 0, len(questions), packed)


def distribute(
    variants: list[Right | Wrong], count: int, most: int, hand_ins: Sequence[list[Right | Wrong]] = ()
) -> list[list[Right | Wrong]]:
    """Give each variant to the shortest hand-in that can hold it, of at least `count`; add one where none can."""
    opened = [*map(list, hand_ins), *([] for _ in range(count))]
    for variant in variants:
        free = (one for one in opened if len(one) < most and all(apart(variant, other) for other in one))
        least = min(free, key=len, default=None)
        if least is None:
            opened.append(least := [])
        least.append(variant)
    return opened


def unmet_pairs(hand_ins: list[list[Right | Wrong]], questions: set[str]) -> set[tuple[str, str]]:
    """Pairs of questions of which no hand-in answers the first one wrong and the second one right."""
    wrong = [{variant.question for variant in variants if isinstance(variant, Wrong)} for variants in hand_ins]
    met = {(lost, kept) for few in wrong for lost in few for kept in questions - few}
    return {(a, b) for a in questions for b in questions if a != b} - met


def apart(one: Right | Wrong, other: Right | Wrong) -> bool:
    """Whether two variants answer different questions, and no cell differently."""
    shared = set(one.code) & set(other.code)
    return one.question != other.question and all(one.code[cell] == other.code[cell] for cell in shared)


def faults(variants: list[Right | Wrong], results: Mapping[str, QuestionResult]) -> dict[str, str]:
    """What is not as it should be in the results of a hand-in that holds these variants, by question."""
    lost = questions_lost(results)
    wrong = {variant.question: variant for variant in variants if isinstance(variant, Wrong)}
    found = {question: f"is lost: {reason}" for question, reason in lost.items() if question not in wrong}
    for question, variant in wrong.items():
        got = results[question]
        if got.score != 0 or got.slip != variant.slip or not re.search(variant.says, got.reason):
            found[question] = f"got {got.score}, slip {got.slip!r}: {got.reason}"
    return found


def lasting_faults(variants: list[Right | Wrong], grade: Grade) -> dict[str, dict[str, str]]:
    """The faults that are left when the variants in doubt are graded apart from the others, by variant.

    A wrong variant that is not judged as it should be is graded alone: the others were judged as they should be. Where
    another question is lost, any of them may be the reason, and each half is graded.
    """
    found = faults(variants, grade({cell: source for variant in variants for cell, source in variant.code.items()}))
    if len(variants) == 1 or not found:
        return {variant.name: found for variant in variants if found}
    half = len(variants) // 2
    parts = [variants[:half], variants[half:]]
    if found.keys() <= {variant.question for variant in variants if isinstance(variant, Wrong)}:
        parts = [[variant] for variant in variants if variant.question in found]
    return {name: left for part in parts for name, left in lasting_faults(part, grade).items()}


CASES = [
    pytest.param(name, variants, number % 4 == 0, id=f"{name}-{number}")
    for name in ASSIGNMENTS
    for number, variants in enumerate(hand_ins(name))
]


@pytest.mark.parametrize("name", ASSIGNMENTS)
def test_every_question_has_enough_variants(name: str) -> None:
    by_question = {question.id: [0, 0] for question in load_assignment(name).questions}
    for variant in variants_of(name):
        by_question[variant.question][isinstance(variant, Wrong)] += 1
    short = {question: counts for question, counts in by_question.items() if counts[0] < 2 or counts[1] < 3}
    assert not short, f"questions with fewer than two right or three wrong variants (right, wrong): {short}"


@pytest.mark.parametrize("name", ASSIGNMENTS)
def test_every_question_stands_right_beside_a_wrong_answer_to_every_other_one(name: str) -> None:
    assert unmet_pairs(hand_ins(name), {question.id for question in load_assignment(name).questions}) == set()


@pytest.mark.parametrize("name", ASSIGNMENTS)
def test_most_wrong_variants_are_named_by_their_slip(name: str) -> None:
    wrong = [variant for variant in variants_of(name) if isinstance(variant, Wrong)]
    assert sum(variant.slip is not None for variant in wrong) >= 0.8 * len(wrong)


def test_95_per_cent_of_all_wrong_variants_are_named_by_their_slip() -> None:
    wrong = [variant for name in ASSIGNMENTS for variant in variants_of(name) if isinstance(variant, Wrong)]
    assert sum(variant.slip is not None for variant in wrong) >= 0.95 * len(wrong)


@pytest.mark.parametrize(("name", "variants", "second_record"), CASES)
def test_variant(name: str, variants: list[Right | Wrong], second_record: bool, grade_code) -> None:
    """Right variants keep every mark, wrong ones lose their own question only; those in doubt are graded again.

    Every fourth hand-in is run on hidden records, too. On many of these, `record_draws` judges every right variant.
    """
    assert lasting_faults(variants, partial(replace(grade_code, second_record=second_record), name)) == {}


@pytest.mark.parametrize("name", [name for name in ASSIGNMENTS if shared_out(name)[1]])
def test_further_variants_are_judged_in_this_process(name: str) -> None:
    solved = solve(name)
    for variant in shared_out(name)[1]:
        verdict = solved.judge(variant.question, variant.code)
        if isinstance(variant, Right):
            assert verdict.passed, (variant.name, verdict.reason)
        else:
            assert not verdict.passed, variant.name
            if not verdict.reason.startswith("stopped with"):
                assert verdict.slip in (variant.slip, "Python error"), variant.name
                assert re.search(variant.says, f"{verdict.reason} {verdict.mend}"), (variant.name, verdict)


@pytest.mark.parametrize("name", ASSIGNMENTS)
def test_the_solution_gets_every_automatic_point(name: str, grade_code) -> None:
    assert questions_lost(grade_code(name, {})) == {}


@pytest.mark.parametrize("name", ASSIGNMENTS)
def test_the_release_gets_none(name: str, course: Course, grade_code) -> None:
    template = read_template(course, name)
    released = {cell.id: cell.source for cell in template.cells if cell.kind in ("answer", "manual")}
    results = grade_code(name, released)
    assert {key for key, r in results.items() if r.status != "manual" and r.score != 0} == set()
    assert {r.status for r in results.values()} <= {"graded", "manual"}
