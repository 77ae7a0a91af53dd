"""A kernel that runs the cells of a notebook as Jupyter does, each within a limit of time."""

import json
import os
import time
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from queue import Empty
from subprocess import DEVNULL
from typing import Any

_START_SECONDS = 60.0
_INTERRUPT_SECONDS = 5.0
_POLL_SECONDS = 0.5
_FOLLOW_RULES = """
import labsid.checks.grading_rules, labsid.hand_in.limited_process
labsid.hand_in.limited_process.limit_process(get_ipython().user_ns)
labsid.checks.grading_rules.follow_rules(get_ipython())
del labsid
"""
_SAY_FILES = """
(lambda get: get("builtins").print(get("json").dumps(get("labsid.hand_in.limited_process").files_elsewhere())))(
    __import__("sys").modules.__getitem__
)
"""


@dataclass(frozen=True, slots=True)
class CellOutcome:
    """How a cell ended.

    Attributes
    ----------
    error : str
        Kind of the error that stopped it; empty if it ran to its end.
    text : str
        Text of that error.
    printed : str
        What it printed and displayed, as text.
    outcomes : tuple of mapping
        What the checks in it found: each with the keys "question" and "state".
    lost : bool
        Whether the kernel ended, and every variable with it.
    """

    error: str = ""
    text: str = ""
    printed: str = ""
    outcomes: tuple[Mapping[str, str], ...] = ()
    lost: bool = False


class NotebookKernel:
    """A Python kernel in a folder; close it, or use it in a `with` statement.

    Parameters
    ----------
    folder : Path
        Its working folder.
    as_graded : bool
        Whether the cells follow the rules of grading.

    Raises
    ------
    ValueError
        If Jupyter is not installed, or the kernel does not start.
    """

    def __init__(self, folder: Path, as_graded: bool = False) -> None:
        try:
            from jupyter_client.manager import KernelManager
        except ModuleNotFoundError:
            raise ValueError('Jupyter is not installed. Run: pip install "labsid[notebooks]"') from None
        environment = {name: value for name, value in os.environ.items() if name != "JPY_SESSION_NAME"}
        self._manager = KernelManager()
        self._manager.start_kernel(cwd=str(folder), env=environment, stdout=DEVNULL, stderr=DEVNULL)
        self._client = self._manager.blocking_client()
        self._client.start_channels()
        try:
            self._client.wait_for_ready(timeout=_START_SECONDS)
        except RuntimeError as error:
            self.close()
            raise ValueError(f"the notebook's kernel does not start: {error}") from None
        if as_graded:
            self.run(_FOLLOW_RULES, None, _START_SECONDS)

    def __enter__(self) -> "NotebookKernel":
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """End the kernel."""
        self._client.stop_channels()
        self._manager.shutdown_kernel(now=True)
        self._manager.cleanup_resources()

    def files_elsewhere(self) -> list[str]:
        """The files that cells, run as graded, have opened where grading has none."""
        try:
            found = json.loads(self.run(_SAY_FILES, None, _START_SECONDS).printed)
        except ValueError:  # the notebook has taken away what is needed to tell
            return []
        return [str(path) for path in found] if isinstance(found, list) else []

    def run(self, source: str, cell_id: str | None, seconds: float) -> CellOutcome:
        """Run a cell; it is interrupted when its time is over, and the kernel ended if that does not help."""
        session = self._client.session
        content = {
            "code": source,
            "silent": False,
            "store_history": True,
            "user_expressions": {},
            "allow_stdin": False,
            "stop_on_error": False,
        }
        message = session.msg("execute_request", content, metadata={} if cell_id is None else {"cellId": cell_id})
        self._client.shell_channel.send(message)
        return self._outcome(message["header"]["msg_id"], time.monotonic() + seconds)

    def _outcome(self, request: str, deadline: float) -> CellOutcome:
        error, text, interrupted = "", "", False
        printed: list[str] = []
        outcomes: list[Mapping[str, str]] = []
        while True:
            if time.monotonic() > deadline:
                if interrupted:
                    return CellOutcome("Timeout", "it could not be interrupted", "".join(printed), lost=True)
                self._manager.interrupt_kernel()
                interrupted, deadline = True, time.monotonic() + _INTERRUPT_SECONDS
            try:
                reply: dict[str, Any] = self._client.get_iopub_msg(timeout=_POLL_SECONDS)
            except Empty:
                if not self._manager.is_alive():
                    return CellOutcome("DeadKernel", "it ended the kernel", "".join(printed), lost=True)
                continue
            if reply["parent_header"].get("msg_id") != request:
                continue
            content = reply["content"]
            match reply["msg_type"]:
                case "stream":
                    printed.append(content["text"])
                case "display_data" | "execute_result":
                    printed.append(content["data"].get("text/plain", "") + "\n")
                    outcomes += [outcome] if (outcome := content["metadata"].get("labsid")) else []
                case "error":
                    error, text = content["ename"], content["evalue"]
                case "status" if content["execution_state"] == "idle":
                    return CellOutcome(error, text, "".join(printed), tuple(outcomes))
