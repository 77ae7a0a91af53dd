"""Where an error stopped a student's code: the line, the part of it, and the shapes of what stands in it.

Nothing of the student's is run to find this out.
"""

import ast
import difflib
import linecache
import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from types import CodeType, FrameType, TracebackType
from typing import Any

import numpy as np

from labsid.checks.line_values import MOST_PARTS, Thing, parsed_line, things_in
from labsid.checks.mended_functions import Mend

_LARGEST_SIZE = 10**7
_KINDS = ("array", "list", "tuple", "number", "text", "dictionary", "function", "module", "nothing", "object")
_LONGEST_LINE = 300
_MOST_MADE, _MOST_STEPS, _MOST_LINES = 12, 2, 100
"""Variables whose origin is told, how many assignments back, and from how many lines above."""
_INNER = ("<listcomp>", "<genexpr>", "<setcomp>", "<dictcomp>", "<lambda>")
_NAME = re.compile(r"(?<![\w.\"'])[A-Za-z_]\w*")
_ASSIGNS = re.compile(r"\s*(?:for\s+(?P<each>[^=\[\]]+?)\s+in\b|(?P<name>[^=\[\]#'\"]+?)\s*=(?!=))")

RIGHT, SHAPED, OTHERWISE = "right", "shaped", "otherwise"
"""What becomes of an answer when a line is mended: it is right; it is wrong, but has the shape that is asked; neither,
or this is not known."""


@dataclass(frozen=True, slots=True)
class Stop:
    """An error in a student's code.

    Attributes
    ----------
    kind, text : str
        As Python gives them: "ValueError", and its message.
    number : int, optional
        Line in the cell or in the function's cell.
    line : str
        That line; empty if it is not known.
    part : str
        The expression in it that failed.
    things : mapping
        By the text of an expression in the line, what it is.
    arguments : tuple of str
        Arguments of the function in which it stopped; empty in a cell.
    near : str
        For a name that is not defined, one that is and is spelt nearly like it.
    outside : tuple of str
        Names in the line of a function that are variables of the notebook.
    made : mapping
        By the name of a variable in the line, or in one of these lines, the line that gave it its value; by that of a
        function of the notebook that the line calls, its only `return`.
    call : str
        The student's line that called the function in which it stopped; empty if another called it, and in a cell.
    outcome : callable, optional
        ``outcome(mend)`` says what becomes of the answer when a line is mended so: `RIGHT`, `SHAPED` or `OTHERWISE`.
        None where a mend cannot be tried.
    """

    kind: str
    text: str
    number: int | None = None
    line: str = ""
    part: str = ""
    things: Mapping[str, Thing] = field(default_factory=dict)
    arguments: tuple[str, ...] = ()
    near: str = ""
    outside: tuple[str, ...] = ()
    made: Mapping[str, str] = field(default_factory=dict)
    call: str = ""
    outcome: Callable[[Mend], str] | None = field(default=None, compare=False)

    def shape(self, node: ast.expr) -> tuple[int, ...] | None:
        """Shape of an array that stands in the line."""
        thing = self.things.get(ast.unparse(node))
        return thing.shape if thing is not None and thing.kind == "array" else None

    def expressions(self) -> Iterator[ast.AST]:
        """The parts of the expression that failed, or of the line if that is not known, outermost first."""
        for text in (self.part, self.line):
            tree = parsed_line(text)
            if tree is not None:
                yield from ast.walk(tree)
                return

    def operations(self, *kinds: type[ast.operator]) -> Iterator[ast.BinOp]:
        """The operations of these kinds among them."""
        for node in self.expressions():
            if isinstance(node, ast.BinOp) and isinstance(node.op, kinds):
                yield node


def packed(stop: Stop) -> dict[str, Any]:
    """A stop as plain data for a message between processes, without the values of numbers."""
    things = [
        [name, thing.kind, list(thing.shape or ()), thing.shape is not None, thing.is_whole]
        for name, thing in stop.things.items()
    ]
    return {
        "line": stop.line,
        "part": stop.part,
        "things": things,
        "arguments": list(stop.arguments),
        "near": stop.near,
        "outside": list(stop.outside),
        "made": dict(stop.made),
        "call": stop.call,
    }


def unpacked(message: Any, kind: str, text: str, is_known: Callable[[str], bool]) -> Stop:
    """A stop from another process, which is not trusted: only what `is_known` says of the notebook is taken over.

    Parameters
    ----------
    message : object
        What `packed` made, or anything else.
    kind, text : str
        Kind and message of the error, redacted.
    is_known : callable
        Whether a text stands in the student's notebook.
    """
    if not isinstance(message, dict):
        return Stop(kind, text)
    things: dict[str, Thing] = {}
    sent = message.get("things")
    for one in sent[:MOST_PARTS] if isinstance(sent, list) else []:
        if isinstance(one, list) and len(one) in (4, 5) and isinstance(one[0], str) and one[1] in _KINDS:
            sizes = one[2] if isinstance(one[2], list) else []
            shape = tuple(int(size) for size in sizes if type(size) is int and 0 <= size < _LARGEST_SIZE)
            things[one[0]] = Thing(str(one[1]), shape if one[3] is True else None, is_whole=one[4:] == [True])
    line, part, near, call = (str(message.get(key, "")) for key in ("line", "part", "near", "call"))
    line = line if is_known(line) else ""
    arguments, outside = (
        tuple(str(name) for name in names) if isinstance(names := message.get(key), list) else ()
        for key in ("arguments", "outside")
    )
    lines = message.get("made")
    made = {str(name): str(made) for name, made in list(lines.items())[:_MOST_MADE]} if isinstance(lines, dict) else {}
    return Stop(
        kind,
        text,
        None,
        line,
        part if is_known(part) else "",
        {name: thing for name, thing in things.items() if is_known(name) or name in line},
        arguments if all(map(is_known, arguments)) else (),
        near if is_known(near) else "",
        outside if all(map(is_known, outside)) else (),
        {name: made_by for name, made_by in made.items() if is_known(name) and is_known(made_by)},
        call if is_known(call) else "",
    )


def stop_of(error: BaseException, variables: Mapping[str, Any], source: str = "") -> Stop:
    """Describe an error in a student's code.

    Parameters
    ----------
    error : BaseException
    variables : mapping
        The notebook's variables; frames whose global names these are belong to the student.
    source : str
        The cell that was run, where Python does not keep it.
    """
    kind = next(one.__name__ for one in type(error).__mro__ if not one.__name__.startswith("_"))
    if isinstance(error, SyntaxError):
        lines = source.splitlines()
        number = error.lineno
        known = lines[number - 1] if number and number <= len(lines) else str(error.text or "")
        return Stop(kind, str(error.msg), number, known.strip()[:_LONGEST_LINE])
    try:
        text = str(error)
    except Exception:
        text = ""
    found = _last_frame(error.__traceback__, variables)
    if found is None:
        return Stop(kind, text)
    frame, trace = found
    names = _visible(frame)
    line, part = _line_and_part(frame, trace, source)
    code = frame.f_code
    arguments = code.co_varnames[: code.co_argcount] if code.co_name != "<module>" else ()
    near = ""
    if isinstance(error, NameError) and error.name:
        near = _near(error.name, line, {**frame.f_globals, **frame.f_locals}, _source_of(frame, source))
    made = {**_returns(line, frame, source), **_made(line, frame, trace.tb_lineno, source)}
    is_inner = code.co_name in _INNER
    things = things_in(line, names, is_inner)
    for other in dict.fromkeys(made.values()):
        things = {**things_in(other, names, is_inner), **things}
    is_function = code.co_name != "<module>"
    outside = tuple(name for name in things if is_function and name in frame.f_globals and name not in frame.f_locals)
    call = _caller(error.__traceback__, frame, variables, source) if is_function and code.co_name not in _INNER else ""
    return Stop(kind, text, trace.tb_lineno, line, part, things, arguments, near, outside, made, call)


def _near(unknown: str, line: str, names: Mapping[str, Any], source: str) -> str:
    """The variable that an unknown name may mean: spelt nearly alike, or with that name as a part; empty if none fits.

    What is called must be callable, and what is indexed must not. Of several that have the name as a part, those of
    the length of another array in the line are meant, and then those in the same cell or function.
    """
    is_called = re.search(rf"\b{unknown}\s*\(", line) is not None
    is_indexed = re.search(rf"\b{unknown}\s*\[", line) is not None
    own = [
        name
        for name, value in names.items()
        if not name.startswith("_") and (not is_called or callable(value)) and not (is_indexed and callable(value))
    ]
    alike = [name for name in own if name.lower() == unknown.lower()]
    close = alike or difflib.get_close_matches(unknown, own, 1, 0.75)
    if close:
        return close[0]
    longer = [name for name in own if unknown in name.split("_") or name.startswith(f"{unknown}_")]
    sizes = {names[name].shape for name in _NAME.findall(line) if isinstance(names.get(name), np.ndarray)}
    fitting = [name for name in longer if isinstance(names[name], np.ndarray) and names[name].shape in sizes - {()}]
    longer = fitting or longer
    here = [name for name in longer if re.search(rf"\b{name}\b", source)]
    return longer[0] if len(longer) == 1 else here[0] if len(here) == 1 else ""


def _source_of(frame: FrameType, source: str) -> str:
    """The text of the cell in which a frame's code stands."""
    return "".join(linecache.getlines(frame.f_code.co_filename)) or source


def _visible(frame: FrameType) -> Mapping[str, Any]:
    """The variables that the code of a frame can mean: its own, and of the notebook's those that it reads.

    In a lambda or a comprehension within a function, a name of that function is not known, and must not be taken for
    the notebook's variable of the same name.
    """
    code = frame.f_code
    is_cell = code.co_name == "<module>" or (code.co_name in _INNER and "<locals>" not in code.co_qualname)
    read = set(frame.f_globals) if is_cell else _names_read(code)
    return {**{name: value for name, value in frame.f_globals.items() if name in read}, **frame.f_locals}


def _names_read(code: CodeType) -> set[str]:
    """The names that are no variables of a function's own, in it and in the functions within it."""
    found, waiting = set(code.co_names), [code]
    while waiting:
        inner = [one for one in waiting.pop().co_consts if isinstance(one, CodeType)]
        found.update(name for one in inner for name in one.co_names)
        waiting += inner
    return found


def _made(line: str, frame: FrameType, number: int, source: str) -> dict[str, str]:
    """The nearest lines above, in the same function or cell, that give the variables of a line their values."""
    lines = linecache.getlines(frame.f_code.co_filename) or source.splitlines(keepends=True)
    first = 1 if frame.f_code.co_name in _INNER else frame.f_code.co_firstlineno
    above = [one.strip()[:_LONGEST_LINE] for one in lines[max(first, number - _MOST_LINES) - 1 : number - 1]]
    if frame.f_code.co_name in _INNER:  # Python 3.11 runs a comprehension in a frame of its own
        heads = [i for i, one in enumerate(above) if one.startswith("def ")]
        above = above[heads[-1] :] if heads else above
    assigned = [(one, _assigned(one)) for one in reversed(above)]
    found: dict[str, str] = {}
    asked = [line]
    for _ in range(_MOST_STEPS):
        names = dict.fromkeys(name for one in asked for name in _NAME.findall(one) if name not in found)
        asked = []
        for name in names:
            made_by = [one for one, heads in assigned if name in heads]
            begun = (one for one in made_by if name not in _NAME.findall(one.partition("=")[2]))
            made = next(begun, made_by[0] if made_by else "")
            if re.search(r"=\s*(\[\]|list\(\))$", made):
                made = next((one for one, _ in assigned if one.startswith(f"{name}.append(")), made)
            if made and len(found) < _MOST_MADE:
                found[name] = made
                asked.append(made)
    return found


def _returns(line: str, frame: FrameType, source: str) -> dict[str, str]:
    """The `return` of each function in the line that is defined in the notebook and has only one."""
    found: dict[str, str] = {}
    for name in dict.fromkeys(_NAME.findall(line)):
        code = getattr(frame.f_globals.get(name), "__code__", None)
        if not isinstance(code, CodeType) or getattr(frame.f_globals[name], "__globals__", None) is not frame.f_globals:
            continue
        lines = linecache.getlines(code.co_filename) or source.splitlines(keepends=True)
        numbers = {number for _, _, number in code.co_lines() if number is not None and number <= len(lines)}
        ends = [one for i in sorted(numbers) if (one := lines[i - 1].strip()).startswith("return")]
        if len(ends) == 1 and parsed_line(ends[0]) is not None:
            found[name] = ends[0][:_LONGEST_LINE]
    return found


def _assigned(line: str) -> list[str]:
    """The variables that a line gives a value."""
    head = _ASSIGNS.match(line)
    return [] if head is None else _NAME.findall(head["each"] or head["name"])


def _last_frame(trace: TracebackType | None, variables: Mapping[str, Any]) -> tuple[FrameType, TracebackType] | None:
    found = None
    while trace is not None:
        if trace.tb_frame.f_globals is variables:
            found = trace.tb_frame, trace
        trace = trace.tb_next
    return found


def _caller(trace: TracebackType | None, called: FrameType, variables: Mapping[str, Any], source: str) -> str:
    """The student's line that called the function of a frame; empty if a library or a check called it."""
    while trace is not None and trace.tb_next is not None:
        if trace.tb_next.tb_frame is called:
            is_own = trace.tb_frame.f_globals is variables and trace.tb_frame is not called
            return _line_and_part(trace.tb_frame, trace, source)[0] if is_own else ""
        trace = trace.tb_next
    return ""


def _line_and_part(frame: FrameType, trace: TracebackType, source: str) -> tuple[str, str]:
    """The statement's first line as written, and the expression that Python was evaluating."""
    lines = linecache.getlines(frame.f_code.co_filename) or source.splitlines(keepends=True)
    if not 0 < trace.tb_lineno <= len(lines):
        return "", ""
    line = lines[trace.tb_lineno - 1].strip()[:_LONGEST_LINE]
    places = list(frame.f_code.co_positions())
    first, last, begin, end = places[trace.tb_lasti // 2] if trace.tb_lasti // 2 < len(places) else (None,) * 4
    if first is None or last is None or begin is None or end is None or last > len(lines):
        return line, ""
    if first != last:
        return " ".join(part.strip() for part in lines[first - 1 : last])[:_LONGEST_LINE], ""
    return line, lines[first - 1].encode()[begin:end].decode(errors="replace")
