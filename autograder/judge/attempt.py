"""One judging of an answer, and the order in which attempts are told to the student."""

from collections.abc import Iterable
from dataclasses import dataclass, replace

from autograder.judge.ask import error_text
from autograder.judge.execution import ExecutedCell
from autograder.judge.stopped import explained
from autograder.sandbox.isolation import StudentProcessError
from labsid.checks.verdict import Verdict


@dataclass(frozen=True, slots=True)
class Attempt:
    """One judging of an answer.

    Attributes
    ----------
    verdict : Verdict or None
        None if the student's process ended.
    failure : StudentProcessError or None
        How it ended.
    stopped : bool
        Whether an error stopped one of the answer's cells or functions, or something is missing.
    broken : bool
        Whether the check itself failed.
    """

    verdict: Verdict | None
    failure: StudentProcessError | None = None
    stopped: bool = False
    broken: bool = False

    @property
    def passed(self) -> bool:
        """Whether the answer is right."""
        return self.verdict is not None and self.verdict.passed

    @property
    def rank(self) -> tuple[bool, bool, bool, bool]:
        """Order of attempts: the right one, then those that tell the student more."""
        named = self.verdict is None or self.verdict.slip is not None
        return self.passed, not self.broken, named, not self.stopped

    def noted(self, passing: str, failing: str) -> "Attempt":
        """The attempt with a note after the reason of a right answer, or before that of a wrong one."""
        if self.verdict is None:
            return self
        note, reason = (passing if self.passed else failing), self.verdict.reason
        parts = (reason, note) if self.passed else (note, reason)
        return replace(self, verdict=replace(self.verdict, reason=" ".join(filter(None, parts))))


def judged(verdict: Verdict, cells: Iterable[ExecutedCell], got_nothing: bool = False, broken: bool = False) -> Attempt:
    """An attempt with a verdict; the error that stopped a cell is told first, because it has to be corrected first."""
    verdict = replace(verdict, reason=verdict.whole_reason, mend="")
    stopped = next((done for done in cells if done.reply.error is not None), None)
    error = None if stopped is None else stopped.reply.error
    if stopped is not None and error is not None and not verdict.passed:
        line = f" in line {error['line']}" if error.get("line") else ""
        why = explained(error, stopped.cell.source)
        text = " ".join(filter(None, (f"Your cell stopped{line} with {error_text(error)}.", why, verdict.reason)))
        verdict = replace(verdict, reason=text)
    return Attempt(verdict, stopped=got_nothing or error is not None, broken=broken)
