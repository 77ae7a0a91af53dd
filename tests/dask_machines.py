"""A Dask scheduler and its workers on loopback, each a process of its own."""

import json
import os
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path


class Machines:
    """A scheduler and its workers, each a process of its own."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.workers: list[subprocess.Popen[bytes]] = []
        self.scheduler: subprocess.Popen[bytes] | None = None
        self.address = ""

    def start(self, workers: int = 0, allowed_failures: int = 3) -> "Machines":
        self.scheduler = self._run(
            "scheduler", "--port", "0", "--no-show", "--scheduler-file", "scheduler.json",
            DASK_DISTRIBUTED__SCHEDULER__ALLOWED_FAILURES=str(allowed_failures),
        )  # fmt: skip
        described = self.folder / "scheduler.json"
        wait_for(lambda: described.is_file() and described.read_bytes().endswith(b"}"))
        self.address = json.loads(described.read_text(encoding="utf-8"))["address"]
        for _ in range(workers):
            self.add_worker()
        return self

    def add_worker(self, *options: str, **environment: str) -> None:
        self.workers.append(self._run("worker", self.address, "--nthreads", "1", "--no-nanny", *options, **environment))

    def stop(self) -> None:
        for process in filter(None, (*self.workers, self.scheduler)):
            process.kill()
            process.wait()

    def said(self) -> bytes:
        """All that is on these machines' disks: logs, and what workers keep."""
        return b"".join(path.read_bytes() for path in self.folder.rglob("*") if path.is_file())

    def _run(self, *command: str, **environment: str) -> "subprocess.Popen[bytes]":
        log = (self.folder / f"log-{len(self.workers)}").open("ab")
        kept = {"--host": "127.0.0.1"} | ({"--local-directory": str(self.folder)} if command[0] == "worker" else {})
        options = [word for pair in kept.items() for word in pair]
        with log:
            return subprocess.Popen(
                [sys.executable, "-P", "-m", "dask", *command, *options, "--no-dashboard"],
                cwd=self.folder,
                env=os.environ | environment,
                stdout=log,
                stderr=log,
            )


def wait_for(done: Callable[[], bool], seconds: float = 60) -> None:
    until = time.monotonic() + seconds
    while not done():
        assert time.monotonic() < until, "it takes too long"
        time.sleep(0.02)


@contextmanager
def machines_in(folder: Path) -> Iterator[Machines]:
    """Machines with their files in a new folder; all of them end with the context."""
    folder.mkdir(parents=True)
    running = Machines(folder)
    try:
        yield running
    finally:
        running.stop()
