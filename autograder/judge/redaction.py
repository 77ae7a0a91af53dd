"""Redaction of student output that could reveal hidden inputs or reference values.

A student's process receives hidden inputs, and the reference values after a wrong answer. Its code can put either into
an error message, a type name or a returned text, as digits or as letters. Only words of the notebook's own source and
common words of Python and numpy are shown; anything else is replaced by `REDACTED`.
"""

import builtins
import re
from collections.abc import Callable, Container, Iterator, Mapping
from dataclasses import fields, replace
from functools import wraps
from typing import Any

from labsid.checks.values import Unreadable, Value
from labsid.plots.figure_values import AxesValue, CurveValue, FigureValue

REDACTED = "…"

MAX_QUOTED_CHARACTERS = 200
MAX_SEARCHED_CHARACTERS = 100_000_000
"""Longer texts are redacted without looking for them in the notebook, and so are others once as many characters have
been searched for one value: a thousand times a notebook of 100 kB. A hostile text takes up to 1 s."""

MAX_REASON_CHARACTERS = 1000
MAX_NEW_NUMBERS = 2
_SHORT_DIGITS, _NEW_DIGITS = 2, 3
_NUMBER = re.compile(r"(?<![\w.])(?<![A-Za-z]-)(?P<digits>\d+(?:\.\d+)?)(?:e[+-]?\d+)?(?![\w-])")

_MESSAGES = re.compile(
    r"name '(?P<name>\w+)' is not defined|no attribute '(?P<attribute>\w+)'|unexpected keyword argument"
    r"|missing \d required positional arguments?|takes \d positional arguments? but \d (was|were) given"
    r"|not associated with a value|object is not (callable|subscriptable|iterable)|unsupported operand type"
    r"|operands could not be broadcast together|could not broadcast input array|mismatch in its core dimension"
    r"|not aligned|out of bounds|index out of range|too many indices|cannot reshape array|must match exactly"
    r"|same number of dimensions|[Ss]ingular matrix|must be square|Incompatible dimensions|division by zero"
    r"|arrays can be converted to Python scalars|cannot be interpreted as an integer|are valid indices"
    r"|(not enough|too many) values to unpack|too large|truth value of an array|did not converge"
)
_TYPES = re.compile(
    r"function|method|module|generator|NoneType|ufunc|array of object|array of <U\d{1,3}|(list|tuple) of \d{1,9} items"
    r"|deeply nested data|int of too many digits|(TransferFunction|StateSpace)(Continuous|Discrete)?|OptimizeResult"
    r"|TimeResponseData|Figure|Axes|Line2D|Polynomial|poly1d|DataFrame|Series|LinAlgError"
)


class _RedactedText(str):
    """A text that a check can read and compare, but not quote: whatever is made of it by its methods is redacted."""

    __slots__ = ()

    def __repr__(self) -> str:
        return repr(REDACTED)

    def __str__(self) -> str:
        return self

    def __format__(self, spec: str) -> str:
        return REDACTED

    def __iter__(self) -> Iterator[str]:
        return map(_RedactedText, super().__iter__())


def _redacting(method: Callable[..., Any]) -> Callable[..., Any]:
    """A method of `str` whose texts are redacted."""

    @wraps(method)
    def call(*args: Any, **kwargs: Any) -> Any:
        made = method(*args, **kwargs)
        return _RedactedText(made) if isinstance(made, str) else type(made)(map(_RedactedText, made))

    return call


for _name in (
    "__add__", "__getitem__", "__mod__", "__mul__", "__rmul__", "capitalize", "casefold", "center", "expandtabs",
    "format", "format_map", "join", "ljust", "lower", "lstrip", "partition", "removeprefix", "removesuffix", "replace",
    "rjust", "rpartition", "rsplit", "rstrip", "split", "splitlines", "strip", "swapcase", "title", "translate",
    "upper", "zfill",
):  # fmt: skip
    setattr(_RedactedText, _name, _redacting(getattr(str, _name)))


def redact_reason(reason: str, known: Container[str]) -> str:
    """A reason for the student without numbers that could be hidden inputs or right values, and cut to a length.

    A student's process chooses shapes, sizes and positions, which checks quote, so that these can tell digits. Shown
    are the known numbers, numbers of at most two digits, and the first `MAX_NEW_NUMBERS` others of at most three.

    Parameters
    ----------
    reason : str
    known : container of str
        The numbers in the notebook, as they are written there, and sizes of the record.

    Returns
    -------
    str
    """
    shown = 0

    def show(number: re.Match[str]) -> str:
        nonlocal shown
        digits = len(number["digits"].replace(".", "").strip("0"))
        if number[0] in known or (digits <= _SHORT_DIGITS and "." not in number[0]):
            return number[0]
        shown += 1
        return number[0] if digits <= _NEW_DIGITS and shown <= MAX_NEW_NUMBERS else REDACTED

    redacted = _NUMBER.sub(show, reason[: 2 * MAX_REASON_CHARACTERS])
    return redacted if len(redacted) <= MAX_REASON_CHARACTERS else redacted[: MAX_REASON_CHARACTERS - 1] + REDACTED


def numbers_in(*texts: str) -> set[str]:
    """The numbers in texts, as they are written there."""
    return {number[0] for text in texts for number in _NUMBER.finditer(text)}


def redact_error(error: Mapping[str, Any], source: str) -> dict[str, str]:
    """Kind and message of an error, redacted for the author of `source`."""
    kind, text = str(error.get("kind")), str(error.get("text", "")).strip()
    found = _MESSAGES.search(text)
    if text not in source:
        named = [] if found is None else [name for name in found.groupdict().values() if name]
        text = found[0] if found and all(name in source for name in named) else REDACTED
    return {"kind": kind if _is_known(kind, source) else "an error", "text": text}


class _Source:
    """The text of a notebook, in which short texts are looked for within a limit."""

    def __init__(self, text: str) -> None:
        self._text = text
        self._left = MAX_SEARCHED_CHARACTERS

    def __contains__(self, text: str) -> bool:
        if len(text) > MAX_QUOTED_CHARACTERS or self._left < len(self._text):
            return False
        self._left -= len(self._text)
        return text in self._text


def redact(value: Value, source: str) -> Value:
    """A value whose texts and type names are redacted for the author of `source` wherever a check quotes them."""
    return _redact(value, _Source(source))


def _redact(value: Value, source: _Source) -> Value:
    if isinstance(value, Unreadable):
        return value if _is_known(value.kind, source) else Unreadable(REDACTED)
    if isinstance(value, str):
        return value if value in source else _RedactedText(value)
    if isinstance(value, (tuple, list)):
        return tuple(_redact(item, source) for item in value)
    if isinstance(value, Mapping):
        return {_redact_key(key, source): _redact(item, source) for key, item in value.items()}
    if isinstance(value, (FigureValue, AxesValue, CurveValue)):
        parts: dict[str, Any] = {field.name: _redact(getattr(value, field.name), source) for field in fields(value)}
        return replace(value, **parts)
    return value


def _redact_key(key: str, source: _Source) -> str:
    return key if key in source else _RedactedText(key)


def _is_known(name: str, source: str | _Source) -> bool:
    return hasattr(builtins, name) or name in source or _TYPES.fullmatch(name) is not None
