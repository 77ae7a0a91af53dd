"""Fork servers and judge's processes that the next run takes over, for tests: each takes a second to start.

A run that ends regularly leaves both as good as new: all processes of its students have ended, and a call leaves
nothing in the process of the judge. Those of a run that was stopped at work are ended with it.
"""

import contextlib
import os
import socket
from collections.abc import Iterator
from dataclasses import dataclass, field

import pytest

from autograder.batch.judge_process import JudgePool, JudgeProcess
from autograder.sandbox import process_launchers
from autograder.sandbox.confine import ProcessSettings
from autograder.sandbox.limits import Limits

_StartedForkServer = process_launchers._ForkServer


@dataclass
class Kept:
    """The idle processes of this session."""

    fork_servers: list[_StartedForkServer] = field(default_factory=list)
    judges: list[JudgeProcess] = field(default_factory=list)

    @contextlib.contextmanager
    def used(self) -> Iterator[None]:
        """Every launcher and every grading run on this machine uses them."""
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(process_launchers, "_ForkServer", lambda limits: _ForkServer(self, limits))
            patch.setattr("autograder.batch.grade.JudgePool", lambda: _JudgePool(self))
            yield

    def end(self) -> None:
        for server in self.fork_servers:
            server.close()
        for judge in self.judges:
            judge.end()


class _ForkServer:
    """A fork server in the hands of one launcher."""

    def __init__(self, kept: Kept, limits: Limits) -> None:
        self._kept = kept
        self._server = kept.fork_servers.pop() if kept.fork_servers else _StartedForkServer(limits)
        self._server._control.settimeout(limits.start_seconds)
        self._unfinished = 0  # requests, and processes that have not ended
        self._closed = False
        self.allowed, self.pid = self._server.allowed, self._server.pid

    def fork(self, settings: ProcessSettings, channel: socket.socket) -> int:
        if self._closed:
            raise OSError("closed")
        self._unfinished += 1
        return self._server.fork(settings, channel)

    def end(self, pid: int) -> tuple[int, str]:
        if self._closed:
            raise OSError("closed")
        self._unfinished += 1
        ended = self._server.end(pid)
        self._unfinished -= 2
        return ended

    def close(self) -> None:
        if self._closed:
            return
        self._closed = True
        if self._unfinished or self._server._process.poll() is not None:
            self._server.close()
        else:
            self._kept.fork_servers.append(self._server)


class _JudgePool(JudgePool):
    """The judge's processes in the hands of one run, in its working folder."""

    def __init__(self, kept: Kept) -> None:
        super().__init__()
        self._kept = kept
        self._idle, kept.judges = kept.judges, []
        for judge in self._idle:
            judge.call(os.chdir, os.getcwd())

    def close(self) -> None:
        with self._lock:
            if not self._closed.is_set():  # those that come back after it are ended
                self._kept.judges += self._idle
                self._idle = []
        super().close()
