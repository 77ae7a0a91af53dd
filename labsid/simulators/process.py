"""Run a simulation that is a file in a process of its own, with a time limit for each call."""

import subprocess
import sys
import weakref
from collections.abc import Mapping
from contextlib import suppress
from queue import Empty, SimpleQueue
from threading import Thread
from typing import IO, Any

from labsid._arrays import FloatArray
from labsid.simulators.messages import read_message, write_message
from labsid.simulators.simulator import Simulator, SimulatorError

CALL_SECONDS = 60.0  # of one simulation
END_SECONDS = 2.0
_ENDED = object()


def open_in_process(source: str, call_seconds: float = CALL_SECONDS) -> Simulator:
    """Open a simulation in a process of its own.

    The process ends with the returned simulator. An error, an endless loop or a crash of the simulation ends neither
    the caller nor its results.

    Parameters
    ----------
    source : str
        ``FILE.py:FUNCTION`` or ``FILE.fmu``.
    call_seconds : float
        Time limit of one simulation, in seconds.

    Raises
    ------
    ValueError
        If the source cannot be opened.
    """
    process = _Process(source, call_seconds)
    return Simulator(
        process,
        process.label,
        process.nominal,
        source=source,
        joint=process.joint,
        ranges=process.ranges,
        inputs=process.inputs,
        outputs=process.outputs,
    )


class _Process:
    """The process, called like the simulation."""

    def __init__(self, source: str, call_seconds: float) -> None:
        self._seconds = call_seconds
        self._process = subprocess.Popen(
            [sys.executable, "-P", "-m", "labsid.simulators.worker", source],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
        )
        weakref.finalize(self, _end, self._process)
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        self._requests = self._process.stdin
        self._replies: SimpleQueue[Any] = SimpleQueue()
        Thread(target=_receive, args=(self._process.stdout, self._replies), daemon=True).start()
        self.label = source
        opened = self._reply("be opened")
        if isinstance(opened, str):
            raise ValueError(opened)
        self.label, self.nominal, self.joint, self.ranges, self.inputs, self.outputs = opened

    def __call__(self, t: FloatArray, u: FloatArray, numbers: Mapping[str, float]) -> FloatArray:
        try:
            write_message(self._requests, (t, u, dict(numbers)))
        except OSError:
            raise SimulatorError(f"{self.label} has ended its process. Does it call exit, or crash?", True) from None
        reply = self._reply(f"simulate {len(u)} samples")
        if isinstance(reply, str):
            raise SimulatorError(reply)
        output: FloatArray = reply
        return output

    def _reply(self, what: str) -> Any:
        try:
            reply = self._replies.get(timeout=self._seconds)
        except Empty:
            _end(self._process)
            raise SimulatorError(f"{self.label} takes more than {self._seconds:g} s to {what}.", True) from None
        if reply is _ENDED:
            raise SimulatorError(f"{self.label} has ended its process. Does it call exit, or crash?", True)
        return reply


def _receive(stream: IO[bytes], replies: "SimpleQueue[Any]") -> None:
    with stream:
        while True:
            try:
                replies.put(read_message(stream))
            except (EOFError, OSError, ValueError):
                replies.put(_ENDED)
                return


def _end(process: "subprocess.Popen[bytes]") -> None:
    """Let the process end by itself, so that it removes its files; kill it if it is busy."""
    assert process.stdin is not None
    with suppress(OSError):
        process.stdin.close()
    try:
        process.wait(END_SECONDS)
    except subprocess.TimeoutExpired:
        process.kill()
        process.wait()
