"""The table ``[rig]`` of ``course.toml``."""

import re
from collections.abc import Mapping
from dataclasses import fields
from decimal import Decimal
from pathlib import Path
from typing import Any

from autograder.course.own_rig import LARGEST_PICTURE, PICTURES, OwnRig, Quantity
from autograder.course.toml_values import refuse_unknown, switch, text, value_of
from labsid.records.reading import Reading

_RIG_KEYS = ("record", "name", "sentence", "input", "output", "picture", "reading", "simulated")
_QUANTITY_KEYS = ("name", "unit", "symbol")
_READING_KEYS = {"from": "since", "to": "until", "LogData": "output", "time-unit": "time_unit"}
"""Keys of a reading that `labsid.records.reading.Reading` calls otherwise; they are the names of the options."""
_READING_TYPES: Mapping[str, Any] = {
    **dict.fromkeys(("from", "to", "Ts", "resample"), (int, float)),
    **dict.fromkeys(("select", "decimate"), int),
}


def to_own_rig(table: Any, root: Path) -> OwnRig:
    """Read the description of a rig; its files are paths from `root`. `ValueError` names the key that is wrong."""
    if not isinstance(table, dict):
        raise ValueError(f"[rig] must be a table with {', '.join(_RIG_KEYS)}, got {table!r}.")
    refuse_unknown(table, _RIG_KEYS, "[rig]")
    record, name, sentence, picture = (
        value_of(table, key, text, "[rig]") for key in ("record", "name", "sentence", "picture")
    )
    for key, value in (("record", record), ("name", name), ("sentence", sentence)):
        if value is None:
            raise ValueError(f"[rig] needs {key}.")
    return OwnRig(
        root / record,
        name,
        sentence,
        _quantity(table, "input"),
        _quantity(table, "output"),
        None if picture is None else _picture(root / picture),
        _reading(table.get("reading", {})),
        value_of(table, "simulated", switch, "[rig]") is True,
    )


def _quantity(table: Mapping[str, Any], key: str) -> Quantity:
    where = f"{key} of [rig]"
    given = table.get(key)
    if not isinstance(given, dict):
        raise ValueError(f'{where} must be a table such as {{ name = "speed", unit = "rpm" }}, got {given!r}.')
    refuse_unknown(given, _QUANTITY_KEYS, where)
    name, unit, symbol = (value_of(given, one, text, where) for one in _QUANTITY_KEYS)
    if name is None or unit is None:
        raise ValueError(f"{where} needs {'name' if name is None else 'unit'}.")
    if len(unit) > 12 or re.search(r"[\"'`{}$\\<>|*_\s]", unit):
        raise ValueError(
            f"the unit of {where} must be as on an axis, such as m/s or °C, of at most 12 characters, "
            f"without spaces, quotation marks and commands of LaTeX; got {unit!r}."
        )
    return Quantity(name, unit, (symbol or "").strip("$ "))


def _picture(path: Path) -> Path:
    if path.suffix.lower() not in PICTURES:
        raise ValueError(f"picture of [rig] must be {', '.join(PICTURES)}, got {path.name!r}.")
    if not path.is_file():
        raise ValueError(f"picture of [rig]: there is no {path}.")
    if path.stat().st_size > LARGEST_PICTURE:
        raise ValueError(f"picture of [rig]: {path.name} has more than {LARGEST_PICTURE / 1e6:g} MB. Make it smaller.")
    return path


def _reading(table: Any) -> Reading:
    names = {one.name for one in fields(Reading)}
    known = [*_READING_KEYS, *(name for name in names if name not in _READING_KEYS.values())]
    if not isinstance(table, dict):
        raise ValueError(f"reading of [rig] must be a table with {', '.join(sorted(known))}, got {table!r}.")
    refuse_unknown(table, sorted(known), "reading of [rig]")
    values: dict[str, Any] = {
        key: float(value) if isinstance(value, Decimal) else value for key, value in table.items()
    }
    for key, value in values.items():
        expected = _READING_TYPES.get(key, str)
        if isinstance(value, bool) or not isinstance(value, expected):
            what = "text in quotation marks" if expected is str else "a number without quotation marks"
            raise ValueError(f"{key} in reading of [rig] must be {what}, got {value!r}.")
    return Reading(**{_READING_KEYS.get(key, key): value for key, value in values.items()})
