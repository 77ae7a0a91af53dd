"""Commands that serve a page, as processes of their own: ready when they print their address, gone with the block."""

import os
import re
import signal
import socket
import subprocess
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from threading import Thread, Timer
from urllib.parse import urlsplit

_START_SECONDS = 60
_POLL_SECONDS = 0.05
_END_SECONDS = 15  # for a server to shut down its kernels


@contextmanager
def served(command: Sequence[str], folder: Path, environment: Mapping[str, str], address: str) -> Iterator[str]:
    """Run a command until the block ends.

    Parameters
    ----------
    command : sequence of str
    folder : Path
        Its working folder.
    environment : mapping
        All of its environment variables.
    address : str
        Regular expression of the address that it prints when it can be opened.

    Yields
    ------
    str
        The address.

    Raises
    ------
    AssertionError
        If the command prints none within a minute, or ends; with what it printed.
    """
    with subprocess.Popen(
        command, cwd=folder, env=environment, encoding="utf-8", start_new_session=True,
        stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
    ) as process:  # fmt: skip
        assert process.stdout is not None
        too_late = Timer(_START_SECONDS, _signal, [process, signal.SIGKILL])
        too_late.start()
        printed: list[str] = []
        for line in process.stdout:
            printed.append(line)
            if found := re.search(address, line):
                too_late.cancel()
                break
        else:
            raise AssertionError(f"{' '.join(command)} printed no address:\n{''.join(printed)}")
        rest = Thread(target=process.stdout.read, daemon=True)  # so that the process never waits for a reader
        rest.start()
        try:
            yield found[0]
        finally:
            for number in (signal.SIGTERM, signal.SIGKILL):
                _signal(process, number)
                rest.join(_END_SECONDS)  # until every process that it started has ended
                if not rest.is_alive():
                    break


def wait_until_reachable(address: str) -> str:
    """Wait until a server accepts connections: Jupyter prints its address before it listens.

    Parameters
    ----------
    address : str
        URL.

    Returns
    -------
    str
        The same.

    Raises
    ------
    OSError
        If it does not within a minute.
    """
    parts = urlsplit(address)
    deadline = time.monotonic() + _START_SECONDS
    while True:
        try:
            socket.create_connection((parts.hostname, parts.port)).close()
        except OSError:
            if time.monotonic() > deadline:
                raise
            time.sleep(_POLL_SECONDS)
        else:
            return address


def _signal(process: "subprocess.Popen[str]", number: signal.Signals) -> None:
    """Send a signal to the command and to what it started."""
    with suppress(ProcessLookupError):
        os.killpg(process.pid, number)
