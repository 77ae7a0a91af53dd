"""Right-but-different and plausible wrong answers to every automatic question, one module an assignment."""

from collections.abc import Mapping
from dataclasses import dataclass
from importlib import import_module

from autograder.judge.outcome import QuestionResult


@dataclass(frozen=True)
class Right:
    """An answer that differs from the model solution and must earn full points, here and in all later questions."""

    question: str
    name: str
    code: dict[str, str]


@dataclass(frozen=True)
class Wrong:
    """An answer that must fail its question, with that slip named or that hint given, and spoil no other question."""

    question: str
    name: str
    code: dict[str, str]
    says: str
    slip: str | None = None


def right(question: str, name: str, code: str, more: dict[str, str] | None = None) -> Right:
    """A right answer to `question`; `more` holds answers to other questions that belong to it."""
    return Right(question, name, {f"{question}-answer": code} | {f"{q}-answer": c for q, c in (more or {}).items()})


def wrong(question: str, name: str, code: str, slip: str | None, says: str) -> Wrong:
    """A wrong answer to `question`, with the slip and the hint that it must get."""
    return Wrong(question, name, {f"{question}-answer": code}, says=says, slip=slip)


def define(head: str, body: str) -> str:
    """Source of a function."""
    return f"def {head}:\n" + "".join(f"    {line}\n" for line in body.splitlines())


def variants_of(assignment: str) -> list[Right | Wrong]:
    """The answers to the questions of an assignment."""
    return list(import_module(f"variants.{assignment.replace('-', '_')}").VARIANTS)


def questions_lost(results: Mapping[str, QuestionResult]) -> dict[str, str]:
    """The automatic questions without full points, and the reasons."""
    return {key: r.reason for key, r in results.items() if r.status != "manual" and r.score != r.max_score}
