"""Verdicts of checks, and the known slips that an answer may match."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import wraps
from typing import Generic, ParamSpec, TypeVar

Answer = TypeVar("Answer")
P = ParamSpec("P")


@dataclass(frozen=True, slots=True)
class Verdict:
    """The outcome of one question.

    Attributes
    ----------
    passed : bool
        Whether the answer is right.
    reason : str
        One or two sentences for the student; never holds the right answer or a hidden input.
    slip : str or None
        Name of the known slip that the answer matches.
    """

    passed: bool
    reason: str
    slip: str | None = None


def first_failure(check: Callable[P, Iterator[Verdict]]) -> Callable[P, Verdict]:
    """Make a check out of a generator of verdicts: the first that fails, or the last if all pass.

    Nothing after the first failure is run, so a check needs no ``return`` after yielding one.
    """

    @wraps(check)
    def run(*args: P.args, **kwargs: P.kwargs) -> Verdict:
        for verdict in check(*args, **kwargs):
            if not verdict.passed:
                break
        return verdict

    return run


class NoAnswer(Exception):
    """There is nothing to compare: the value is missing, of the wrong kind, or asking for it failed.

    Its text is written for the student; `slip` names the known slip where it is one.
    """

    def __init__(self, text: str, slip: str | None = None) -> None:
        super().__init__(text)
        self.slip = slip


@dataclass(frozen=True, slots=True)
class Slip(Generic[Answer]):
    """A mistake that students are known to make, with what it would have given on this very record.

    Attributes
    ----------
    name : str
        Short name, as it appears in feedback and in the instructor's report.
    hint : str
        What to look at, with the step of the lab; never the answer.
    wrong : callable
        Makes the value that this slip gives; only called when an answer is wrong.
    """

    name: str
    hint: str
    wrong: Callable[[], Answer]


def judge(
    got: Answer,
    right: Answer,
    same: Callable[[Answer, Answer], bool],
    praise: str,
    otherwise: str,
    slips: Sequence[Slip[Answer]] = (),
) -> Verdict:
    """Compare an answer with the right value and, where it differs, with what each known slip gives.

    Parameters
    ----------
    got, right : object
        The student's value and the reference's, of the same kind.
    same : callable
        ``same(a, b)`` says whether two values agree within the tolerance of the question.
    praise, otherwise : str
        Reason when right, and when wrong without matching a known slip.
    slips : sequence of Slip
        Tried in order. A slip that cannot be computed on this record, or that gives the right value on it, is passed
        over.

    Returns
    -------
    Verdict
    """
    if same(got, right):
        return Verdict(True, praise)
    for slip in slips:
        try:
            wrong = slip.wrong()
        except (ValueError, IndexError, ArithmeticError):
            continue
        if same(got, wrong) and not same(wrong, right):
            return Verdict(False, slip.hint, slip.name)
    return Verdict(False, otherwise)
