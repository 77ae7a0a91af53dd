"""The tries of a notebook, kept in a file beside it if the student chooses so; off until then."""

import time
from collections.abc import Callable
from dataclasses import replace
from html import escape
from pathlib import Path

from labsid._files import write_file
from labsid.checks.kept_tries import (
    MAX_BYTES,
    MAX_MINUTE,
    MAX_TRIES,
    OTHER,
    KeptTry,
    read_tries,
    tries_bytes,
    tries_file_name,
    tries_html,
    tries_text,
)

LONGEST_PAUSE = 30.0
"""Minutes that a longer pause between two tries counts."""

_OFF = "Your tries are not kept. check.tries.keep() begins to keep them, in the file {name} beside this notebook."
_ON = (
    "From now on the checks keep your tries in the file {name} beside this notebook: for each changed answer the "
    "question, the minutes of work since now, right or not right, and the name of the mistake. No code, no values and "
    "no times of day. The file stays on your machine, unless you answer yes when `labsid submit` asks whether to send "
    "it. No mark and no decision depends on it. check.tries() shows what is kept; check.tries.delete() deletes it and "
    "ends the keeping."
)
_GOES_ON = "Your tries are kept, as you chose: check.tries() shows them, check.tries.delete() deletes them."
_DELETED = "The tries of this notebook are deleted, and no more are kept."
_UNREADABLE = "{name} cannot be read ({why}), and no tries are kept. check.tries.delete() deletes it."


class NotebookTries:
    """The tries at the questions of one notebook.

    Calling it shows them; `keep` begins to keep them, and `delete` deletes them and ends the keeping.

    Parameters
    ----------
    assignment : str
    show : callable
        ``show(text, html)`` displays something in the notebook.
    clock : callable
        Seconds on a monotonic clock.
    """

    def __init__(
        self, assignment: str, show: Callable[[str, str], None], clock: Callable[[], float] = time.monotonic
    ) -> None:
        self._path = Path.cwd() / tries_file_name(assignment)
        self._show = show
        self._clock = clock
        self._tries: list[KeptTry] | None = None
        self._problem = ""
        self._codes: dict[str, tuple[str, ...] | None] = {}
        self._minutes, self._last = 0.0, clock()
        self._read()

    def __call__(self) -> None:
        """Show the tries that are kept."""
        if self._tries is None:
            self._tell(self._problem or _OFF)
        elif not self._tries:
            self._tell(f"No try is kept yet. {_GOES_ON}")
        else:
            self._show(tries_text(self._tries), tries_html(self._tries))

    def keep(self) -> None:
        """Begin to keep tries, in a file beside the notebook."""
        if self._tries is not None or self._problem:
            self._tell(self._problem or _GOES_ON)
            return
        self._minutes, self._last = 0.0, self._clock()
        if self._write([]):
            self._tell(_ON)

    def delete(self) -> None:
        """Delete the tries that are kept, and keep no more."""
        try:
            self._path.unlink(missing_ok=True)
        except OSError as error:
            self._tell(f"{{name}} cannot be deleted ({error.strerror}): delete it in the file browser.")
            return
        self._tries, self._problem = None, ""
        self._codes.clear()
        self._tell(_DELETED)

    def note(self, question: str, right: bool, slip: str | None = None, code: tuple[str, ...] | None = None) -> None:
        """Keep a try, if tries are kept and it is a new one.

        Parameters
        ----------
        question : str
        right : bool
        slip : str, optional
            Name of the known mistake of a wrong answer.
        code : tuple of str, optional
            The code of the answer, which is not kept. The same code again is no new try, nor is a second right answer,
            nor the mistake of before when a notebook that was opened again is run for the first time.
        """
        if self._tries is None:
            return
        last_try = next((kept_try for kept_try in reversed(self._tries) if kept_try.question == question), None)
        kept_try = KeptTry(question, 0, right, "" if right else slip or OTHER)
        is_opened = question not in self._codes
        is_same_code = code is not None and self._codes.get(question) == code
        self._codes[question] = code
        if len(self._tries) >= MAX_TRIES or (last_try is not None and last_try.right and right):
            return
        if last_try is not None and last_try.slip == kept_try.slip and (is_opened or is_same_code):
            return
        now = self._clock()
        self._minutes += min((now - self._last) / 60, LONGEST_PAUSE)
        self._last = now
        minute = min(int(self._minutes), MAX_MINUTE)
        self._write([*self._tries, replace(kept_try, minute=minute)])

    def _read(self) -> None:
        try:
            if not self._path.is_file():
                return
            with self._path.open("rb") as file:
                tries = list(read_tries(file.read(MAX_BYTES + 1)))
        except (OSError, ValueError) as error:
            self._problem = _UNREADABLE.replace("{why}", str(error))
            return
        self._tries = tries
        self._minutes = float(tries[-1].minute) if tries else 0.0
        self._tell(_GOES_ON)

    def _write(self, tries: list[KeptTry]) -> bool:
        """Write the file; where that fails, nothing more is kept, and the checks go on."""
        try:
            write_file(self._path, tries_bytes(tries))
        except OSError as error:
            self._tries = None
            self._tell(f"Your tries cannot be kept ({error.strerror}).")
            return False
        self._tries = tries
        return True

    def _tell(self, text: str) -> None:
        said = text.replace("{name}", self._path.name)
        self._show(said, escape(said))
