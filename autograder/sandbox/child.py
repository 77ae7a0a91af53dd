"""The student process: runs the cells of one submission and answers the judge's requests with plain values.

It never receives a check, a right value or another submission. `autograder.sandbox.fork_server` forks it; on systems
without fork it is a new Python process, which connects to the judge on a loopback address.
"""

import contextlib
import copy
import importlib
import io
import json
import os
import socket
import sys
import traceback
from importlib.abc import MetaPathFinder
from typing import Any

from autograder.sandbox.allowed_paths import allowed_modules
from autograder.sandbox.channel import (
    MAX_OUTPUT_CHARACTERS,
    ChannelClosed,
    ChannelError,
    decode,
    encode,
    receive,
    send,
)
from autograder.sandbox.checksums import checksums_of
from autograder.sandbox.confine import make_syscall_filter, set_rlimits
from autograder.sandbox.replacing import Replacement, in_event_loop, run_replacing, set_right
from autograder.sandbox.served_calls import ServedCalls
from labsid.checks.grading_rules import follow_rules
from labsid.checks.permitted import is_reference
from labsid.checks.stops import packed, stop_of
from labsid.checks.values import plain, unchanged

_CALLS: list[ServedCalls] = []  # one, once the channel is open
_SAVED: dict[int, tuple[dict[str, Any], dict[str, int]]] = {}


class ReferenceFinder(MetaPathFinder):
    """Import hook that blocks the reference: an exercise requires the student's own function."""

    def find_spec(self, fullname: str, path: Any = None, target: Any = None) -> None:
        """Raise `ImportError` for modules of the reference and the grader."""
        if is_reference(fullname):
            raise ImportError(
                f"{fullname} is the reference: it cannot be used in an exercise that is being graded. "
                "Write the step yourself."
            )


def serve(sock: socket.socket, shell: Any) -> None:
    """Answer the judge's requests until it closes the channel."""
    _CALLS.append(ServedCalls(sock, lambda request: _answer(shell, request)))
    follow_rules(shell)
    while True:
        try:
            request = receive(sock)
        except ChannelError:
            return
        reply = _answer(shell, request)
        try:
            send(sock, reply)
        except ChannelClosed:
            return
        except ChannelError as error:
            send(sock, {"ok": False, "error": describe_error(ValueError(f"it is too large: {error}"))})


def _answer(shell: Any, request: dict[str, Any]) -> dict[str, Any]:
    try:
        return _HANDLERS[request["op"]](shell, request)
    except BaseException as error:
        return {"ok": False, "error": describe_error(error, shell.user_ns)}


def block_reference() -> None:
    """Remove the reference from this process, and replace the notebook's checks by ones that do nothing."""
    import labsid
    import labsid.checks

    labsid.checks.notebook_checks = NoChecks  # type: ignore[assignment, misc]
    for name in [name for name in sys.modules if name.startswith("labsid.") or name.split(".")[0] == "autograder"]:
        if is_reference(name):
            del sys.modules[name]
            if name.count(".") == 1:
                vars(labsid).pop(name.split(".")[1], None)
    sys.meta_path.insert(0, ReferenceFinder())


class NoChecks:
    """Replacement of ``notebook_checks`` while grading: the judge checks instead, and nothing is skipped."""

    __module__ = "labsid.checks.notebook"  # cells may import it, and nothing of the grader

    def __init__(self, assignment: str, variables: Any, record: Any = None) -> None:
        self.tries = NoTries()

    def __call__(self, question_id: str) -> None:
        """Do nothing."""

    def skip(self, question_id: str) -> None:
        """Do nothing: the reference's values are not in this process."""

    def hint(self, question_id: str | None = None) -> None:
        """Do nothing: hints are for the notebook."""

    def practice(self, question_id: str | None = None) -> None:
        """Do nothing: practice is for the notebook."""

    def predict(self, prediction_id: str) -> None:
        """Do nothing: predictions are for the notebook."""

    def summary(self) -> None:
        """Do nothing."""


class NoTries:
    """Replacement of the kept tries while grading."""

    __module__ = "labsid.checks.notebook_tries"

    def __call__(self) -> None:
        """Do nothing."""

    def keep(self) -> None:
        """Do nothing: tries are kept in the student's notebook alone."""

    def delete(self) -> None:
        """Do nothing."""


def describe_error(error: BaseException, variables: Any = None, source: str = "") -> dict[str, Any]:
    """Kind, text and line of an error in the student's code, and what stands in that line."""
    # Python 3.13 raises private kinds such as _IncompleteInputError: report the public base class
    kind = next(kind.__name__ for kind in type(error).__mro__ if not kind.__name__.startswith("_"))[:100]
    stop = None
    with contextlib.suppress(BaseException):
        stop = packed(stop_of(error, {} if variables is None else variables, source))
    if isinstance(error, SyntaxError):
        return {"kind": kind, "text": str(error.msg)[:500], "line": error.lineno, "stop": stop}
    line = None
    for frame in traceback.extract_tb(error.__traceback__):
        if "ipython-input" in frame.filename or frame.filename.startswith("<cell"):
            line = frame.lineno
    text = ""
    with contextlib.suppress(BaseException):
        text = str(error)
    return {"kind": kind, "text": text[:500], "line": line, "stop": stop}


def open_shell() -> Any:
    """Import the packages that notebooks use, and create the IPython shell that runs their cells."""
    os.environ["MPLBACKEND"] = "Agg"
    import control  # noqa: F401
    import matplotlib.pyplot
    import scipy.io
    import scipy.signal  # noqa: F401
    from IPython.core.history import HistoryManager
    from IPython.core.interactiveshell import InteractiveShell

    for module in allowed_modules():
        importlib.import_module(module)
    HistoryManager.enabled = False  # type: ignore[assignment]

    class ZMQInteractiveShell(InteractiveShell):
        """Named as Jupyter's own, for code that asks whether it runs in a notebook."""

    shell: Any = ZMQInteractiveShell.instance()
    # ignore %matplotlib: there is no display
    shell.register_magic_function(lambda line: None, magic_name="matplotlib")
    matplotlib.pyplot.switch_backend("Agg")
    # the judge receives the error itself; formatting a terminal traceback would take longer than most cells
    shell.showtraceback = shell.showsyntaxerror = lambda *args, **kwargs: None
    return shell


def _run(shell: Any, request: dict[str, Any]) -> dict[str, Any]:
    from IPython.utils.capture import capture_output

    replacements = [_decode_replacement(encoded) for encoded in request.get("replacements", ())]
    with capture_output() as captured:
        result = run_replacing(shell, request["source"], replacements, _CALLS[0].function)
    if "matplotlib.pyplot" in sys.modules:
        sys.modules["matplotlib.pyplot"].close("all")  # as Jupyter does after each cell
    error = result.error_before_exec or result.error_in_exec
    reply: dict[str, Any] = {
        "ok": error is None,
        "stdout": captured.stdout[:MAX_OUTPUT_CHARACTERS],
    }
    if error is not None:
        reply["error"] = describe_error(error, shell.user_ns, request["source"])
    return reply


def _value(shell: Any, request: dict[str, Any]) -> dict[str, Any]:
    name = request["name"]
    if name not in shell.user_ns:
        return {"ok": False}
    return {"ok": True, "value": encode(plain(shell.user_ns[name]))}


def _call(shell: Any, request: dict[str, Any]) -> dict[str, Any]:
    if not callable(shell.user_ns.get(request["name"])):
        return {"ok": False}
    arguments = [_CALLS[0].argument(argument) for argument in request["arguments"]]
    keywords = {name: _CALLS[0].argument(argument) for name, argument in request.get("keywords", {}).items()}
    return _call_with(shell, request["name"], arguments, keywords)


def _call_with(shell: Any, name: str, arguments: list[Any], keywords: dict[str, Any]) -> dict[str, Any]:
    function = shell.user_ns.get(name)
    if not callable(function):
        return {"ok": False}
    try:
        with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):
            value = in_event_loop(lambda: function(*arguments, **keywords))
    finally:
        sys.modules["matplotlib.pyplot"].close("all")  # figures of hidden inputs must not reach the next cell
    return {"ok": True, "value": encode(plain(value))}


def _changes(shell: Any, request: dict[str, Any]) -> dict[str, Any]:
    """Call a function, and say whether it has changed an array that it was given."""
    given = [_CALLS[0].argument(argument) for argument in request["arguments"]]
    before = copy.deepcopy(given)
    called = _call_with(shell, request["name"], given, {})
    return {"ok": called["ok"], "value": not unchanged(given, before)}


def _call_back(shell: Any, request: dict[str, Any]) -> dict[str, Any]:
    """Call a function that this process has passed to one that the judge serves."""
    value = in_event_loop(lambda: _CALLS[0].called_back(request["key"], request["arguments"]))
    return {"ok": True, "value": encode(plain(value))}


def _set(shell: Any, request: dict[str, Any]) -> dict[str, Any]:
    set_right(shell.user_ns, _decode_replacement(request["replacement"]), _CALLS[0].function)
    return {"ok": True}


def _decode_replacement(encoded: dict[str, Any]) -> Replacement:
    return Replacement(
        right={name: decode(value) for name, value in encoded["right"].items()},
        wrong={name: decode(value) for name, value in encoded["wrong"].items()},
        functions=tuple(encoded["functions"]),
        kept=frozenset(encoded["kept"]),
    )


def _save(shell: Any, request: dict[str, Any]) -> dict[str, Any]:
    """Save the variables, with checksums that reveal changes in place."""
    _SAVED[request["key"]] = dict(shell.user_ns), checksums_of(shell.user_ns)
    return {"ok": True}


def _restore(shell: Any, request: dict[str, Any]) -> dict[str, Any]:
    """Restore the variables; the value is whether any of them was modified in place."""
    variables, saved = _SAVED[request["key"]]
    shell.user_ns.clear()
    shell.user_ns.update(variables)
    return {"ok": True, "value": checksums_of(variables) != saved}


_HANDLERS = {
    "run": _run,
    "value": _value,
    "call": _call,
    "changes": _changes,
    "call back": _call_back,
    "set": _set,
    "save": _save,
    "restore": _restore,
}


def main() -> None:
    """Connect to the judge at ``host:port`` (first argument), send its token, and serve."""
    host, port = sys.argv[1].rsplit(":", 1)
    settings = json.loads(sys.stdin.readline())
    sys.path.insert(0, os.getcwd())
    shell = open_shell()  # before the connection: the import has its own time-out
    block_reference()
    with socket.create_connection((host, int(port))) as sock:
        set_rlimits(settings["limits"])
        syscall_filter = make_syscall_filter((os.getppid(),))
        if syscall_filter is not None:
            syscall_filter.load()
        send(sock, {"token": settings["token"]})
        serve(sock, shell)


if __name__ == "__main__":
    main()
