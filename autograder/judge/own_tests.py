"""Test cells of nbgrader: they run in the student's process, and the question is right if the cell raises nothing.

Student code runs before them in the same process and can change what they use. So every reason says where they ran.
The tests that students see run in their place, because later cells may use what they import. A cell with hidden tests
runs once more, as a whole, after the last cell, so that no output can tell what is hidden.
"""

import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from decimal import Decimal

from autograder.judge.attempt import judged
from autograder.judge.execution import ExecutedCell, Execution
from autograder.judge.outcome import QuestionResult
from autograder.sandbox.isolation import Limits, StudentProcessError
from labsid.checks.verdict import Verdict

WHERE = "(Checked in the student's process.)"
HIDDEN = "A test that is not shown failed."
MAX_MESSAGE_CHARACTERS = 500


@dataclass(slots=True)
class OwnTests:
    """A question with a test cell of nbgrader, in one submission.

    Attributes
    ----------
    key : int
        The key under which the variables at the question are saved.
    points : Decimal
    visible : ExecutedCell
        The tests that students see, as they ran.
    cells : sequence of ExecutedCell
        The cells of the answer.
    with_hidden : str
        The whole cell; empty if no test is hidden.
    problem : str
        What failed; empty if nothing did.
    failure : StudentProcessError or None
        How the process ended.
    seconds : float
        Time so far.
    """

    key: int
    points: Decimal
    visible: ExecutedCell
    cells: Sequence[ExecutedCell]
    with_hidden: str = ""
    problem: str = ""
    failure: StudentProcessError | None = None
    seconds: float = 0.0

    def read_visible(self, execution: Execution) -> None:
        """Note how the visible tests ended, and save the variables if there are hidden ones to be run."""
        self.failure = next((done.failure for done in (*self.cells, self.visible) if done.failure is not None), None)
        if self.visible.reply.error is not None:
            self.problem = message_of(self.visible.reply.error, self.visible.cell.source)
        elif self.failure is None and self.with_hidden:
            execution.save_variables(self.key)

    def run_hidden(self, execution: Execution, limits: Limits) -> None:
        """Run the whole cell after the last cell of the notebook, on the variables as they were at the question."""
        if not self.with_hidden or self.problem or self.failure is not None:
            return
        start = time.monotonic()
        execution.extend_deadline(limits.cell_seconds)
        if execution.process.lost:
            execution.restart()
        try:
            if execution.restore_variables(self.key):  # changed in place by later cells
                process = execution.replayed(self.key)
                try:
                    reply = process.run(self.with_hidden)
                finally:
                    process.close()
            else:
                reply = execution.process.run(self.with_hidden)
            self.problem = HIDDEN if reply.error is not None else ""
        except StudentProcessError as failure:
            self.failure = failure
            if execution.process.lost:
                execution.restart()
        self.seconds += time.monotonic() - start

    def result(self) -> QuestionResult:
        """The result of the question."""
        status = "graded" if self.failure is None else self.failure.status
        if self.failure is not None:
            verdict = Verdict(False, f"Your code for this step did not finish: {self.failure}.")
        else:
            verdict = Verdict(not self.problem, f"{self.problem or 'All tests passed.'} {WHERE}")
            verdict = judged(verdict, self.cells).verdict or verdict
        return QuestionResult(
            self.visible.cell.id or "",
            self.points if verdict.passed else Decimal(0),
            self.points,
            status,
            verdict.reason,
            answer="\n\n".join(done.cell.source for done in self.cells),
            output="".join(done.reply.stdout for done in self.cells),
            seconds=self.seconds,
        )


def message_of(error: Mapping[str, object], source: str) -> str:
    """What to tell of an error in the visible tests: the message of an assertion, or the assertion without one."""
    text = " ".join(str(error.get("text") or "").split())[:MAX_MESSAGE_CHARACTERS]
    kind, number, lines = error.get("kind"), error.get("line"), source.splitlines()
    if kind != "AssertionError":
        return f"The tests stopped with {kind}: {text}".rstrip(": .") + "."
    if text:
        return text if text.endswith((".", "!", "?")) else f"{text}."
    line = lines[number - 1].strip() if isinstance(number, int) and 0 < number <= len(lines) else ""
    return f"This test failed: {line}" if line.startswith("assert") else "A test failed."
