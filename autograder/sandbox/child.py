"""The student's process: runs the cells of one submission and answers the judge's questions with plain values.

It never sees a check, a right answer or another submission. Where the system can fork, `autograder.sandbox.fork_server`
forks it; elsewhere it is started on its own. It then connects to the judge on a loopback address.
"""

import contextlib
import io
import json
import os
import socket
import sys
import traceback
import zlib
from importlib.abc import MetaPathFinder
from typing import Any

import numpy as np

from autograder.sandbox.allowed_paths import is_reference
from autograder.sandbox.channel import (
    MAX_OUTPUT_CHARACTERS,
    ChannelError,
    Gone,
    decode,
    encode,
    receive,
    send,
)
from autograder.sandbox.confine import make_call_filter, take_limits
from labsid.checks.values import plain

_PINS: dict[int, tuple[dict[str, Any], dict[str, int]]] = {}
_MOST_MARKED = 100_000


class ReferenceFinder(MetaPathFinder):
    """Refuses the taught functions of labsid: an exercise asks for the student's own."""

    def find_spec(self, fullname: str, path: Any = None, target: Any = None) -> None:
        """Refuse ``labsid.<taught module>``, the right values of the checks, and everything of the autograder."""
        if is_reference(fullname):
            raise ImportError(
                f"{fullname} is the reference: it cannot be used in an exercise that is being graded. "
                "Write the step yourself."
            )


def serve(sock: socket.socket, shell: Any) -> None:
    """Answer the judge until it hangs up."""
    keep_reference_out_of_reach()
    while True:
        try:
            request = receive(sock)
        except ChannelError:
            return
        try:
            reply = _ANSWERS[request["op"]](shell, request)
        except BaseException as error:
            reply = {"ok": False, "error": describe_error(error)}
        try:
            send(sock, reply)
        except Gone:
            return
        except ChannelError as error:
            send(sock, {"ok": False, "error": describe_error(ValueError(f"it is too large: {error}"))})


def keep_reference_out_of_reach() -> None:
    """Take the taught modules out of this process and put nothing-doing checks in the place of the notebook's."""
    import labsid
    import labsid.checks

    labsid.checks.notebook_checks = _no_checks  # type: ignore[assignment, misc]
    for name in [name for name in sys.modules if name.startswith("labsid.") or name.split(".")[0] == "autograder"]:
        if is_reference(name):
            del sys.modules[name]
            if name.count(".") == 1:
                vars(labsid).pop(name.split(".")[1], None)
    sys.meta_path.insert(0, ReferenceFinder())


def _no_checks(assignment: str, variables: Any, record: Any = None) -> Any:
    """What ``notebook_checks`` is while grading: the judge does the checking."""
    return lambda question_id: None


def describe_error(error: BaseException) -> dict[str, Any]:
    """Kind, text and line of an error in the student's code."""
    # Python 3.13 has kinds that are not for the public, such as _IncompleteInputError: what they derive from is
    kind = next(kind.__name__ for kind in type(error).__mro__ if not kind.__name__.startswith("_"))[:100]
    if isinstance(error, SyntaxError):
        return {"kind": kind, "text": str(error.msg)[:500], "line": error.lineno}
    line = None
    for frame in traceback.extract_tb(error.__traceback__):
        if "ipython-input" in frame.filename or frame.filename.startswith("<cell"):
            line = frame.lineno
    text = ""
    with contextlib.suppress(BaseException):
        text = str(error)
    return {"kind": kind, "text": text[:500], "line": line}


def open_shell() -> Any:
    """Import what notebooks use, and open the IPython shell in which their cells run."""
    os.environ["MPLBACKEND"] = "Agg"
    import control  # noqa: F401
    import matplotlib.pyplot
    import scipy.io
    import scipy.signal  # noqa: F401
    from IPython.core.history import HistoryManager
    from IPython.core.interactiveshell import InteractiveShell

    import labsid.checks
    import labsid.plots
    import labsid.rig  # noqa: F401

    HistoryManager.enabled = False  # type: ignore[assignment]
    shell: Any = InteractiveShell.instance()
    # there is no screen here, whatever backend a notebook asks for
    shell.register_magic_function(lambda line: None, magic_name="matplotlib")
    matplotlib.pyplot.switch_backend("Agg")
    # an error goes to the judge as it is; drawing its traceback for a terminal would take longer than most cells
    shell.showtraceback = shell.showsyntaxerror = lambda *args, **kwargs: None
    return shell


def _run(shell: Any, request: dict[str, Any]) -> dict[str, Any]:
    from IPython.utils.capture import capture_output

    with capture_output() as captured:
        result = shell.run_cell(request["source"], store_history=False)
    if "matplotlib.pyplot" in sys.modules:
        sys.modules["matplotlib.pyplot"].close("all")  # as a notebook does when the cell ends
    error = result.error_before_exec or result.error_in_exec
    reply: dict[str, Any] = {
        "ok": error is None,
        "stdout": captured.stdout[:MAX_OUTPUT_CHARACTERS],
    }
    if error is not None:
        reply["error"] = describe_error(error)
    return reply


def _value(shell: Any, request: dict[str, Any]) -> dict[str, Any]:
    name = request["name"]
    if name not in shell.user_ns:
        return {"ok": False}
    return {"ok": True, "value": encode(plain(shell.user_ns[name]))}


def _call(shell: Any, request: dict[str, Any]) -> dict[str, Any]:
    function = shell.user_ns.get(request["name"])
    if not callable(function):
        return {"ok": False}
    arguments = [decode(argument) for argument in request["arguments"]]
    try:
        with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):
            value = function(*arguments)
    finally:
        sys.modules["matplotlib.pyplot"].close("all")  # what it drew of the judge's inputs is not the next cell's
    return {"ok": True, "value": encode(plain(value))}


def _set(shell: Any, request: dict[str, Any]) -> dict[str, Any]:
    for name, value in request["values"].items():
        shell.user_ns[name] = _as_student_object(decode(value))
    return {"ok": True}


def _pin(shell: Any, request: dict[str, Any]) -> dict[str, Any]:
    """Keep the variables, and what would tell that one of them was changed in place."""
    _PINS[request["key"]] = dict(shell.user_ns), _marks(shell.user_ns)
    return {"ok": True}


def _put_back(shell: Any, request: dict[str, Any]) -> dict[str, Any]:
    """Put the variables back; tell whether something in them was changed in place since."""
    variables, marks = _PINS[request["key"]]
    shell.user_ns.clear()
    shell.user_ns.update(variables)
    return {"ok": True, "value": _marks(variables) != marks}


def _marks(variables: dict[str, Any]) -> dict[str, int]:
    marks = {}
    for name, value in list(variables.items()):
        if name.startswith("_") or name in ("In", "Out"):
            continue
        if isinstance(value, np.ndarray) and not value.dtype.hasobject:
            marks[name] = zlib.crc32(np.ascontiguousarray(value).tobytes())
        elif isinstance(value, (list, dict, set)):
            marks[name] = zlib.crc32(repr(value)[:_MOST_MARKED].encode(errors="replace"))
    return marks


def _as_student_object(value: Any) -> Any:
    """A reference value as the object that a student would hold: systems as python-control's own."""
    import control

    from labsid.checks.values import StateSpaceValue, TransferFunctionValue

    if isinstance(value, TransferFunctionValue):
        return control.tf(value.num, value.den, value.dt)
    if isinstance(value, StateSpaceValue):
        return control.ss(value.A, value.B, value.C, value.D, value.dt)
    return value


_ANSWERS = {"run": _run, "value": _value, "call": _call, "set": _set, "pin": _pin, "put back": _put_back}


def main() -> None:
    """Serve the judge that listens at ``host:port`` (first argument), greeting it with the token it passed on."""
    host, port = sys.argv[1].rsplit(":", 1)
    orders = json.loads(sys.stdin.readline())
    sys.path.insert(0, os.getcwd())
    shell = open_shell()  # before the greeting: coming up has a time limit of its own
    with socket.create_connection((host, int(port))) as sock:
        take_limits(orders["limits"])
        call_filter = make_call_filter((os.getppid(),))
        if call_filter is not None:
            call_filter.load()
        send(sock, {"token": orders["token"]})
        serve(sock, shell)


if __name__ == "__main__":
    main()
