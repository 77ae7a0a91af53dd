"""What a function of the student's reads, its arguments and variables of the notebook, and whether it returns."""

import dis
import linecache
import re
from collections.abc import Container, Iterable, Iterator, Mapping
from inspect import getblock
from textwrap import dedent
from types import CodeType, FunctionType
from typing import Any

import numpy as np

_MOST_NAMES, _FEWEST_UNREAD = 3, 2
_SHORTEST_DATA, _SHORTEST_SIGNAL = 2, 20
"""Entries; parameters that a step has estimated are fewer than those of a signal, and a function may use them."""

_GIVES = re.compile(r"\breturn[ \t]*[^\s#]|\byield\b")
_MAKES_A_FIGURE = re.compile(r"(\w+)(?:\s*,[^=\n]*)?\s*=\s*plt\.(?:subplots|figure)\(")


def reads_beside(name: str, function: object, variables: Mapping[str, Any]) -> str:
    """A sentence if a function reads data of the notebook in place of an argument, or no argument at all; or nothing.

    Parameters
    ----------
    name : str
        Name of the function.
    function : object
        Whatever the notebook has under that name.
    variables : mapping
        The notebook's variables.
    """
    if not isinstance(function, FunctionType):
        return ""
    code = function.__code__
    used = set(_names_in(code, "LOAD"))
    unread = [argument for argument in code.co_varnames[: code.co_argcount] if argument not in used]
    read = dict.fromkeys(_names_in(code, "LOAD_GLOBAL"))
    least = _SHORTEST_DATA if unread else _SHORTEST_SIGNAL
    data = [variable for variable in read if _entries(variables.get(variable)) >= least][:_MOST_NAMES]
    if not data:
        again = next(filter(None, (_set_anew(argument, code) for argument in code.co_varnames[: code.co_argcount])), "")
        if again:
            return f"`{name}` {again}"
        is_constant = len(unread) == code.co_argcount >= _FEWEST_UNREAD
        return f"`{name}` reads none of its arguments, {_listed(unread)}." if is_constant else ""
    never = f"never reads its argument{'s' * (len(unread) > 1)} {_listed(unread)}, but" if unread else "reads"
    return (
        f"`{name}` {never} {_listed(data)} of the notebook. It is called with other data: use its arguments in their "
        "place."
    )


def numbers_beside(name: str, function: object, variables: Mapping[str, Any]) -> str:
    """A sentence if a function reads numbers of the notebook, such as a result of an earlier step; or nothing.

    Whole numbers do not count: they are sizes and orders. The parameters are those of `reads_beside`.
    """
    if not isinstance(function, FunctionType):
        return ""
    read = dict.fromkeys(_names_in(function.__code__, "LOAD_GLOBAL"))
    numbers = [variable for variable in read if isinstance(variables.get(variable), float | np.floating)]
    if not numbers:
        return ""
    what = "which is no argument, but a number" if len(numbers) == 1 else "which are no arguments, but numbers"
    return f"`{name}` reads {_listed(numbers[:_MOST_NAMES])}, {what} of the notebook."


def _set_anew(argument: str, code: CodeType) -> str:
    """That a function sets an argument before it has read it; empty if it does not, or where that is not certain."""
    for one in dis.get_instructions(code):
        names = one.argval if isinstance(one.argval, tuple) else (one.argval,)
        if "FAST" in one.opname and argument in names:
            first = one.opname == "STORE_FAST"
            return f"sets its argument `{argument}` before it reads it: what is handed over is not used." * first
        if "JUMP" in one.opname or "FOR_ITER" in one.opname or argument in code.co_cellvars:
            return ""
    return ""


def made_without_return(name: str, sources: Iterable[str], variables: Mapping[str, Any]) -> str:
    """A sentence if a variable is what a function of the notebook without `return` gives; or nothing.

    Parameters
    ----------
    name : str
        Name of the variable.
    sources : iterable of str
        The cells that made it.
    variables : mapping
        The notebook's variables.
    """
    for source in sources:
        called = re.findall(rf"^{re.escape(name)}\s*=\s*(\w+)\(", source, re.MULTILINE)
        function = variables.get(called[-1]) if called else None
        written = function_text(function)
        if written and variables.get(name) is None and not _GIVES.search(written):
            made = _MAKES_A_FIGURE.search(written)
            return (
                f"`{called[-1]}`, which makes it, returns nothing: end it with `return {made[1] if made else '...'}`."
            )
    return ""


def function_text(function: object) -> str:
    """The text of a function of the notebook; empty of anything else, and where Python does not keep it."""
    if not isinstance(function, FunctionType):
        return ""
    lines = linecache.getlines(function.__code__.co_filename)
    return dedent("".join(getblock(lines[function.__code__.co_firstlineno - 1 :]))) if lines else ""


def length_beside(
    name: str,
    function: object,
    variables: Mapping[str, Any],
    arguments: Iterable[object],
    counts: Container[int | None],
) -> str:
    """A sentence if a function reads the length of the notebook's data, and was called with data of another length.

    Parameters
    ----------
    name : str
        Name of the function.
    function : object
    variables : mapping
        The notebook's variables.
    arguments : iterable of object
        What it was called with.
    counts : container of int
        The numbers in the line that stopped; the length must be one of them.
    """
    sizes = [len(argument) for argument in arguments if isinstance(argument, np.ndarray) and argument.ndim]
    if not isinstance(function, FunctionType) or not sizes:
        return ""
    code = function.__code__
    lengths = {_entries(array) for array in variables.values() if isinstance(array, np.ndarray)}
    of_data = {part for size in lengths if size >= _SHORTEST_SIGNAL for part in (size, size // 2, -(-size // 2))}
    for variable in dict.fromkeys(_names_in(code, "LOAD_GLOBAL")):
        value = variables.get(variable)
        if type(value) is int and value in of_data and value in counts and value not in sizes:
            data = ", ".join(f"`{argument}`" for argument in code.co_varnames[: code.co_argcount])
            return (
                f"`{name}` uses `{variable}` of the notebook, {value}, and was called with data of another length, "
                f"{sizes[0]}. Take every length from its arguments ({data}), as `len(...)` gives it."
            )
    return ""


def _entries(value: object) -> int:
    """How many entries an array or a list has; none for anything else."""
    return value.size if isinstance(value, np.ndarray) else len(value) if type(value) is list else 0


def _names_in(code: CodeType, kind: str) -> Iterator[str]:
    """The names that instructions of a kind read, also in functions inside the function."""
    for one in dis.get_instructions(code):
        if kind in one.opname:
            yield from (str(part) for part in (one.argval if isinstance(one.argval, tuple) else (one.argval,)))
    for inner in code.co_consts:
        if isinstance(inner, CodeType):
            yield from _names_in(inner, kind)


def _listed(names: list[str]) -> str:
    *first, last = (f"`{one}`" for one in names)
    return f"{', '.join(first)} and {last}" if first else last
