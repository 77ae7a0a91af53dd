"""The model solution's functions, in a process of their own without student code.

A student's process whose function is replaced asks the judge for each call. The judge checks whether the function is
served there, and passes plain arguments and values on between the two processes.
"""

from collections.abc import Container, Mapping
from pathlib import Path
from typing import Any

from autograder.course.definitions import defined_functions, definitions_in
from autograder.sandbox.channel import ChannelError, encode
from autograder.sandbox.isolation import ProcessLauncher, StudentProcess, StudentProcessError
from autograder.sandbox.served_calls import checked_argument, is_plain
from autograder.sandbox.student_process import REFUSED, Reply
from labsid.checks.cells import Template

MAX_CALLS = 5000
"""Calls that are served for one question. The plain answer to `ri-5-forgetting` needs 2,053: two runs over the 998 rows
of Example 6-1, and the hidden inputs. A student who tries two more forgetting factors stays below. 5,000 calls take
less than 3 s (0.53 ms each), a tenth of a cell's time; an optimizer that does not end meets this limit first."""

MAX_DEPTH = 8
"""Calls within calls: a served function calls a function of the student's, which calls a served one."""


class RightFunctions:
    """The functions of the model solution of one assignment, and what of them is served.

    Parameters
    ----------
    template : Template
    functions : mapping
        Source of the functions, by the question that asks for them.
    launcher : ProcessLauncher
    folder : Path
        The files of the work folder.
    """

    def __init__(
        self, template: Template, functions: Mapping[str, str], launcher: ProcessLauncher, folder: Path
    ) -> None:
        given = [cell.source for cell in template.cells if cell.kind == "given" and cell.code]
        shown = [definitions_in(cell.source) for cell in template.cells if cell.kind == "demonstration" and cell.code]
        self._cells = (*given, *shown, *functions.values())
        self._names = {question: defined_functions(source) for question, source in functions.items()}
        self._launcher = launcher
        self._folder = folder
        self._process: StudentProcess | None = None
        self._calls = 0
        self._depth = 0

    def names(self, question_id: str) -> tuple[str, ...]:
        """The functions that a question asks for."""
        return self._names.get(question_id, ())

    def start_question(self) -> None:
        """Count the calls anew."""
        self._calls = 0

    def reply(self, message: Mapping[str, Any], student: StudentProcess, served: Container[str]) -> dict[str, Any]:
        """The reply to a call from a student's process in which these functions are served.

        Raises
        ------
        StudentProcessError
            If the student's process ends while one of its own functions is called.
        """
        try:
            asks = message["asks"]
            name, keywords = asks["name"], asks["keywords"].items()
            arguments = [checked_argument(argument) for argument in asks["arguments"]]
            encoded = {str(key): checked_argument(argument) for key, argument in keywords}
        except (KeyError, TypeError, AttributeError, ChannelError):
            return REFUSED
        if not isinstance(name, str) or name not in served:
            return REFUSED
        self._calls += 1
        if self._calls > MAX_CALLS:
            return _failed(f"`{name}` is replaced by the grader, which serves {MAX_CALLS} calls for a question")
        if self._depth >= MAX_DEPTH:
            return _failed(f"`{name}` calls itself through other functions more than {MAX_DEPTH} times")
        try:
            return self._call(name, arguments, encoded, student)
        except StudentProcessError as failure:
            self.close()
            if student.lost:
                raise
            return _failed(f"`{name}` did not finish: {failure}")

    def close(self) -> None:
        """End the process."""
        if self._process is not None:
            self._process.close()
            self._process = None

    def _call(
        self, name: str, arguments: list[Any], keywords: Mapping[str, Any], student: StudentProcess
    ) -> dict[str, Any]:
        process = self._opened()
        outer, process.server = process.server, lambda message: self._call_back(message, student)
        self._depth += 1
        try:
            reply = process.call_encoded(name, arguments, keywords)
        finally:
            process.server = outer
            self._depth -= 1
        if reply.error is not None:
            return {"ok": False, "error": dict(reply.error)}
        if not is_plain(reply.value):
            return _failed(f"`{name}` returns what cannot be passed on")
        return {"ok": reply.ok, "value": encode(reply.value)}

    def _call_back(self, message: Mapping[str, Any], student: StudentProcess) -> dict[str, Any]:
        """Call a function that the student's process has passed as an argument."""
        asks = message["asks"]
        self._calls += 1
        if self._calls > MAX_CALLS:
            return _failed(f"the grader serves {MAX_CALLS} calls for a question")
        reply: Reply = student.call_back(asks["key"], asks["arguments"])
        if reply.error is not None:
            return {"ok": False, "error": dict(reply.error)}
        return {"ok": reply.ok, "value": encode(reply.value)}

    def _opened(self) -> StudentProcess:
        if self._process is None:
            self._process = self._launcher.start(self._folder)
            for source in self._cells:
                self._process.run(source)
        return self._process


def _failed(text: str) -> dict[str, Any]:
    return {"ok": False, "error": {"kind": "RuntimeError", "text": text}}
