"""Right-but-different and plausible wrong answers to every automatic question, one module an assignment."""

from dataclasses import dataclass


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
