"""Draw the trials of the checks anew, many times, for each planted wrong answer: none may pass by luck."""

from collections.abc import Iterable

from one_answer import Solved, quietly, solve
from variants import Right, Wrong, variants_of

from labsid.checks.time_limit import limit_time

SECONDS = 300.0


def draw(name: str, questions: Iterable[str], draws: int) -> tuple[list[str], int]:
    """Judge the planted wrong answers of some questions with several seeds.

    Parameters
    ----------
    name : str
        The assignment.
    questions : iterable of str
    draws : int
        Seeds for each answer whose check draws trials; for the others, one.

    Returns
    -------
    passed : list of str
        A line for each answer that passed, with its seeds.
    tried : int
        Verdicts in all.
    """
    solved, asked = solve(name), set(questions)
    passed: list[str] = []
    tried = 0
    for variant in variants_of(name):
        if isinstance(variant, Right) or variant.question not in asked:
            continue
        seeds, count = passing_seeds(solved, variant, draws)
        tried += count
        if seeds:
            passed.append(
                f"{variant.question}: {variant.name} passes with {len(seeds)} of {count} seeds, as {seeds[0]}"
            )
    return passed, tried


def passing_seeds(solved: Solved, variant: Wrong, draws: int) -> tuple[list[int], int]:
    """The seeds with which a wrong answer passes, and how many were tried; one that stops in its cell never passes."""
    with quietly():
        try:
            with limit_time(SECONDS):
                variables = solved.run(variant.question, variant.code)
        except Exception:
            return [], 1
        found = []
        for seed in range(draws):
            verdict, drew = solved.verdict_and_draws(variant.question, variables, seed)
            if verdict.passed:
                found.append(seed)
            if not drew:
                return found, 1
    return found, draws
