"""Values of the tables in ``course.toml``; each refusal names the key, what was got and what was expected."""

from collections.abc import Callable, Mapping, Sequence
from datetime import datetime
from pathlib import Path
from typing import Any


def refuse_unknown(table: Mapping[str, Any], known: Sequence[str], where: str) -> None:
    """Refuse a table with a key that is not known."""
    unknown = [key for key in table if key not in known]
    if unknown:
        raise ValueError(f"{where} has the unknown key {unknown[0]!r}; expected one of {', '.join(known)}.")


def value_of(table: Mapping[str, Any], key: str, convert: Callable[[Any], Any], where: str = "") -> Any:
    """A value of a table, converted; None if it is missing."""
    if key not in table:
        return None
    try:
        return convert(table[key])
    except TypeError as error:
        raise ValueError(f"{key}{where and f' in {where}'} must be {error}, got {table[key]!r}.") from None


def text(value: Any) -> str:
    """A text that is not empty; `TypeError` says what was expected, as for the other types."""
    if not isinstance(value, str) or not value.strip():
        raise TypeError("text in quotation marks")
    return value


def moment(value: Any) -> datetime:
    """A date and time."""
    if not isinstance(value, datetime):
        raise TypeError("a date and time such as 2026-11-30T23:59:00, without quotation marks")
    return value


def switch(value: Any) -> bool:
    """True or false."""
    if not isinstance(value, bool):
        raise TypeError("true or false")
    return value


def absolute_path(value: Any) -> Path:
    """A path from the root, which is the same for everybody on a machine."""
    if not isinstance(value, str) or not value.startswith("/"):
        raise TypeError("a path in quotation marks that begins with /")
    return Path(value)
