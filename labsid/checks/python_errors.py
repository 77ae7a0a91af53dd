"""Python's errors, explained: what stands in the line that stopped, and what usually causes such an error here.

A cause is stated where the shapes or the text of the line prove it, else it is asked. The notebook's check, the clean
run of ``labsid submit`` and the feedback page all say what `explain` returns.
"""

import re
from collections.abc import Callable

from labsid.checks.error_table import TABLE
from labsid.checks.matlab_syntax import cause_of_syntax, cause_of_unknown_name
from labsid.checks.stops import Stop

_MOST_NAMES = 5


def told(stop: Stop, where: str, made_by: Callable[[str], str] | None = None, cause: str = "") -> str:
    """The whole message: Python's own line, where it stopped, what stands there, and the cause.

    Parameters
    ----------
    stop : Stop
    where : str
        What stopped, such as "the answer cell" or "`fit`".
    made_by : callable, optional
        For a name that is not defined, ``made_by(name)`` says which cells define it.
    cause : str, optional
        The cause, where it is known from elsewhere than the line.
    """
    line = f", in line {stop.number}" if stop.number else ""
    quoted = f": `{stop.line}`" if stop.line else ""
    first = f"{where} stopped with {f'{stop.kind}: {stop.text}'.rstrip('.: ')}{line}{quoted}."
    return f"{first} {details(stop, made_by, cause)}".rstrip()


def details(stop: Stop, made_by: Callable[[str], str] | None = None, cause: str = "") -> str:
    """What stands in the line, and the cause; empty if nothing is known."""
    present = ", ".join(f"`{name}` {thing}" for name, thing in _present(stop))
    said = (f"There {present}." if present else "", cause or explain(stop, made_by), _handed_over(stop))
    return " ".join(filter(None, said))


_OF_NUMBERS = re.compile(
    "'(?:int|float|numpy.float64)' object|invalid index to scalar|enough dimensions|unsized object"
)
"""Messages of errors that a number in the place of an array makes."""


def _handed_over(stop: Stop) -> str:
    """Which call in the cell hands over a list, a number or a text, where it may be the fault; empty if none does."""
    for name in dict.fromkeys(re.findall(r"[A-Za-z_]\w*", stop.part or stop.line)) if stop.call else ():
        thing = stop.things.get(name)
        if thing is None or name not in stop.arguments or name in stop.made:
            continue
        is_number = thing.kind == "number" and _OF_NUMBERS.search(stop.text) is not None
        is_array = thing.kind == "array" and stop.kind == "IndexError" and re.search(r"\[[^\]]*:", stop.call)
        kind = {"text": "str", "nothing": "NoneType"}.get(thing.kind, thing.kind)
        is_named = kind in ("list", "tuple", "str", "NoneType") and re.search(
            rf"'{kind}'|\b{kind}\b|sequence", stop.text
        )
        if is_named or is_number or is_array:
            return f"`{name}` is handed over by the call `{stop.call}`."
    return ""


def explain(stop: Stop, made_by: Callable[[str], str] | None = None) -> str:
    """The usual cause of an error; empty if none is known."""
    if stop.kind in ("SyntaxError", "IndentationError", "TabError"):
        return cause_of_syntax(stop)
    if stop.kind == "NameError":
        matched = re.search(r"name '(\w+)' is not defined", stop.text)
        return "" if matched is None else cause_of_unknown_name(matched[1], stop, made_by)
    for row in TABLE:
        matched = re.search(row.text, stop.text) if re.fullmatch(row.kind, stop.kind) else None
        if matched is not None:
            cause = row.cause if isinstance(row.cause, str) else row.cause(stop, matched)
            if cause is not None:
                return cause
    return ""


def _present(stop: Stop) -> list[tuple[str, str]]:
    """The variables of the line with what they are, in the order in which they stand there."""
    names = dict.fromkeys(re.findall(r"(?<![\w.\"'])[A-Za-z_]\w*", stop.line))
    shown = [
        (name, stop.things[name].said + (" (the notebook's own, no argument)" if name in stop.outside else ""))
        for name in names
        if name in stop.things and stop.things[name].kind not in ("function", "module", "object")
    ]
    return shown[:_MOST_NAMES]
