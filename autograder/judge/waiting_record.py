"""The second record, drawn while a notebook runs on the student's own, and the process that waits for the run on it.

The sandbox of the first run sees neither. Where the level of isolation is lower, its code could find a file or a
process of the second run: there the record is kept in memory, and the process started later.
"""

from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from pathlib import Path
from types import TracebackType

from autograder.sandbox.isolation import ProcessLauncher, StudentProcess
from autograder.sandbox.limits import Limits
from autograder.sandbox.workdirs import make_workdir, remove_folder


class WaitingRecord:
    """Draws a record in a thread; use it in a `with` statement, which ends what was not used.

    Parameters
    ----------
    draw : callable
        Returns the content of the data file, or raises `ValueError`.
    name : str
        Name of that file.
    launcher : ProcessLauncher

    Attributes
    ----------
    folder : Path
        Folder with the file, once `content` has returned.
    """

    def __init__(self, draw: Callable[[], bytes], name: str, launcher: ProcessLauncher) -> None:
        self.folder = make_workdir()
        self._name = name
        self._draw = draw
        self._launcher = launcher
        self._is_hidden = launcher.level == "namespaces"
        self._threads = ThreadPoolExecutor(1)
        self._content = self._threads.submit(self._drawn)
        self._waiting = _WithWaiting(launcher, self._threads.submit(self._started)) if self._is_hidden else None

    def __enter__(self) -> "WaitingRecord":
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        if self._waiting is not None:
            self._waiting.close()
        self._threads.shutdown()
        remove_folder(self.folder)

    def content(self) -> bytes:
        """The content of the file, which is in the folder from now on; raises what drawing it has raised."""
        content = self._content.result()
        if not self._is_hidden:
            (self.folder / self._name).write_bytes(content)
        return content

    def launcher(self) -> ProcessLauncher:
        """A launcher whose first process is the one that waits."""
        return self._launcher if self._waiting is None else self._waiting

    def _drawn(self) -> bytes:
        content = self._draw()
        if self._is_hidden:
            (self.folder / self._name).write_bytes(content)
        return content

    def _started(self) -> StudentProcess:
        self._content.result()
        return self._launcher.start(self.folder)


class _WithWaiting:
    """Starts processes as another launcher does; the first has been started."""

    def __init__(self, launcher: ProcessLauncher, waiting: Future[StudentProcess]) -> None:
        self._launcher = launcher
        self._waiting: Future[StudentProcess] | None = waiting

    @property
    def level(self) -> str:
        """The isolation level."""
        return self._launcher.level

    @property
    def limits(self) -> Limits:
        """The limits of a process."""
        return self._launcher.limits

    def start(self, folder: Path) -> StudentProcess:
        """The process that waits, then others."""
        waiting, self._waiting = self._waiting, None
        return self._launcher.start(folder) if waiting is None else waiting.result()

    def close(self) -> None:
        """End the process that waits, if it was not used."""
        waiting, self._waiting = self._waiting, None
        if waiting is not None and waiting.exception() is None:
            waiting.result().close()
