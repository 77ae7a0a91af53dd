"""Verdicts of checks, and the known mistakes that an answer may match."""

from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass, field
from functools import wraps
from typing import Generic, ParamSpec, TypeVar

import numpy as np

from labsid.checks.mended_functions import Mend
from labsid.checks.relations import relation

Answer = TypeVar("Answer")
P = ParamSpec("P")


PYTHON_ERROR = "Python error"
"""The slip of an answer that Python stopped."""

RUNS_AWAY = "estimate runs away"
"""The slip of an answer that grows without limit: what is seen of a mistake that is not named."""

SINGLE_PRECISION = "single precision"
"""The slip of an answer whose numbers have too few digits to be compared."""


@dataclass(frozen=True, slots=True)
class Verdict:
    """The outcome of one question.

    Attributes
    ----------
    passed : bool
        Whether the answer is right.
    reason : str
        One or two sentences for the student; never contains the right answer or a hidden input.
    slip : str or None
        Name of the known mistake that the answer matches.
    mend : str
        How to correct it, where `reason` says only what is wrong. The notebook shows it as the last hint; at grading it
        is part of the reason.
    noted : bool
        Whether an answer that passes is only noted: what is right, grading alone can tell.
    is_shaped : bool
        Whether an answer that does not pass is known to have the shape of the right one.
    """

    passed: bool
    reason: str
    slip: str | None = None
    mend: str = ""
    noted: bool = False
    is_shaped: bool = field(default=False, compare=False)

    @property
    def whole_reason(self) -> str:
        """The reason, and how to correct it."""
        return f"{self.reason} {self.mend}".rstrip()


def first_failure(check: Callable[P, Iterator[Verdict]]) -> Callable[P, Verdict]:
    """Make a check from a generator of verdicts: the first that fails, or the last if all pass.

    Nothing after the first failure is run, so a check needs no ``return`` after yielding one.
    """

    @wraps(check)
    def run(*args: P.args, **kwargs: P.kwargs) -> Verdict:
        for verdict in check(*args, **kwargs):
            if not verdict.passed:
                break
        return verdict

    return run


BEYOND_RESULTS = "call beyond the results at hand"
"""`slip` of a function that cannot be called again, as in practice, where one result is handed over."""


class NoAnswer(Exception):
    """There is nothing to compare: the value is missing, of the wrong kind, or could not be obtained.

    Its text addresses the student; `slip` names the known mistake, if it is one. Where an error stopped a function,
    ``told(outcome)`` is the text with the repairs that `outcome` has found to be right; see `Stop`.
    """

    def __init__(
        self, text: str, slip: str | None = None, told: Callable[[Callable[[Mend], str]], str] | None = None
    ) -> None:
        super().__init__(text)
        self.slip = slip
        self.told = told


@contextmanager
def told_if_singular(text: str, slip: str) -> Iterator[None]:
    """Say `text` where a student's function stops at a matrix without an inverse."""
    try:
        yield
    except NoAnswer as stopped:
        if "singular matrix" in str(stopped).lower():
            raise NoAnswer(text, slip) from None
        raise


@dataclass(frozen=True, slots=True)
class Slip(Generic[Answer]):
    """A known mistake, with the value that it gives on this record.

    Attributes
    ----------
    name : str
        Short name, as it appears in feedback and in the instructor's report.
    hint : str
        What to check, with the step of the lab; never the answer.
    wrong : callable
        Computes the value that this mistake gives; called only if an answer is wrong.
    mend : str
        How to correct it, where the hint alone would leave something to find out; see `Verdict`.
    """

    name: str
    hint: str
    wrong: Callable[[], Answer]
    mend: str = ""


_ARE_NAMED: ContextVar[bool] = ContextVar("mistakes are named", default=True)


@contextmanager
def unnamed() -> Iterator[None]:
    """Judge without naming mistakes, where only passing or not is asked for: their values are not computed."""
    token = _ARE_NAMED.set(False)
    try:
        yield
    finally:
        _ARE_NAMED.reset(token)


def are_named() -> bool:
    """Whether the mistakes of wrong answers are looked for; see `unnamed`."""
    return _ARE_NAMED.get()


def judge(
    got: Answer,
    right: Answer,
    same: Callable[[Answer, Answer], bool],
    praise: str,
    otherwise: str,
    slips: Iterable[Slip[Answer]] = (),
    exactly: Callable[[Answer, Answer], bool] | None = None,
    of: str | None = "",
) -> Verdict:
    """Compare an answer with the right value and, if it differs, with the value of each known mistake.

    Parameters
    ----------
    got, right : object
        The student's value and the reference's, of the same kind.
    same : callable
        ``same(a, b)`` says whether two values agree within the tolerance of the question.
    praise, otherwise : str
        Reasons for a right answer, and for a wrong one that matches no known mistake.
    slips : iterable of Slip
        Tried in order, only if the answer is not right. A mistake that cannot be computed on this record, or that gives
        the right value, is skipped.
    exactly : callable, optional
        A closer comparison, for answers whose tolerance is wider than the distance between a mistake and the right
        value: an answer that is exactly what a mistake gives, and not exactly right, is that mistake. Of several
        mistakes within the tolerance, too, one that gives the answer exactly comes first.
    of : str or None, optional
        What `got` is called, where it is made of what the student has returned, or is only a part of that: how it is
        related to the right value is said of it by this name. None where it has no name; then nothing is said of it.

    Returns
    -------
    Verdict
    """
    if same(got, right) and (exactly is None or exactly(got, right)):
        return Verdict(True, praise)
    if not are_named() and not same(got, right):
        return Verdict(False, otherwise)
    alike = same if exactly is None or not same(got, right) else exactly
    found: list[Slip[Answer]] = []
    for slip in slips:
        try:
            # a mistake may divide by zero or overflow; students see no warnings of the checks
            with np.errstate(all="ignore"):
                wrong = slip.wrong()
        except (ValueError, LookupError, ArithmeticError):
            continue
        if alike(got, wrong) and not alike(wrong, right):
            found.append(slip)
            if exactly is None or exactly(got, wrong):
                return Verdict(False, slip.hint, slip.name, slip.mend, is_shaped=_are_alike(got, right))
    if found:
        return Verdict(False, found[0].hint, found[0].name, found[0].mend, is_shaped=_are_alike(got, right))
    if same(got, right):
        return Verdict(True, praise)
    said = " ".join(filter(None, (otherwise, "" if of is None else relation(got, right, same, of))))
    return Verdict(False, said, is_shaped=_are_alike(got, right))


def _are_alike(got: object, right: object) -> bool:
    """Whether two arrays or numbers have the same shape."""
    kinds = (int, float, np.ndarray, np.number)
    return isinstance(got, kinds) and isinstance(right, kinds) and np.shape(got) == np.shape(right)
