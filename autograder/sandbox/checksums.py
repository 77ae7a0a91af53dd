"""Checksums of a student's variables that reveal changes in place, at a cost that no value can raise.

Nothing of the student's runs: no ``repr``, no method of a subclass. Values of ordinary size are read in whole, larger
ones at places spread over them. Of other objects, such as instances of a student's class, only the identity counts.
"""

import marshal
import sys
import zlib
from collections.abc import Mapping
from itertools import islice
from typing import Any

import numpy as np

MOST_BYTES = 16 * 1024**2
"""Bytes of arrays, and of numbers in lists, that are read of one variable: 2 million floats, in 0.02 s."""

MOST_ITEMS, MOST_ITEMS_IN_ALL, FEWEST_ITEMS = 10_000, 100_000, 100
"""Items that are looked at of one variable, of all together, and of each in any case; 100,000 take 0.2 s."""

_MOST_PLACES = 65_536  # at which a larger array is read
_CONTAINERS = (list, tuple, dict, set, frozenset)
_NUMBERS = frozenset((int, float, complex, bool, type(None)))
_FLOATS = frozenset((float, np.float64))
_SCALARS = frozenset(one for one in np.sctypeDict.values() if one is not np.object_)
_NUMBER_BYTES = 8  # of a number in a list
_MOST_BITS = 10_000  # of an integer that is read


def checksums_of(variables: Mapping[str, Any]) -> dict[str, int]:
    """The checksum of each variable that can be changed in place: arrays, lists, dicts and sets."""
    found: dict[str, int] = {}
    left = MOST_ITEMS_IN_ALL
    for name, value in list(variables.items()):
        if not name.startswith("_") and name not in ("In", "Out") and _can_change(value):
            reading = _Reading(max(min(MOST_ITEMS, left), FEWEST_ITEMS))
            found[name] = reading.checksum(value)
            left -= reading.looked_at
    return found


def _can_change(value: Any) -> bool:
    # not `isinstance`, which asks an object for its `__class__`
    return issubclass(type(value), (np.ndarray, list, dict, set))


class _Reading:
    """One reading of one variable.

    Parameters
    ----------
    items : int
        How many items may be looked at.
    """

    def __init__(self, items: int) -> None:
        self.looked_at = 0
        self._items = items
        self._bytes = MOST_BYTES
        self._sum = 0
        self._seen: dict[int, int] = {}

    def checksum(self, value: Any) -> int:
        """The checksum of a value, and of what is in it."""
        waiting = [value]
        while waiting and self.looked_at < self._items:
            item = waiting.pop()
            self.looked_at += 1
            kind = type(item)
            if issubclass(kind, np.ndarray):
                waiting += self._read_array(np.ndarray.view(item, np.ndarray))
            elif issubclass(kind, _CONTAINERS):
                if id(item) in self._seen:  # again, or within itself
                    self._add(b"again %d" % self._seen[id(item)])
                    continue
                self._seen[id(item)] = len(self._seen)
                waiting += self._read_container(item, kind)
            else:
                self._add(_state(item, kind))
        return self._sum

    def _add(self, data: bytes) -> None:
        self._sum = zlib.crc32(data, self._sum)

    def _read_array(self, array: np.ndarray[Any, Any]) -> list[Any]:
        """Add an array; returns the objects in it."""
        self._add(f"{array.dtype.str} {array.shape}".encode())
        if array.dtype == object:
            return list(array.flat[:: self._step(array.size)])
        if array.dtype.hasobject:
            return []
        if array.nbytes <= self._bytes:
            self._bytes -= array.nbytes
            self._add(array.tobytes())
        else:
            read = array.flat[:: array.size // _MOST_PLACES + 1].tobytes()
            self._bytes = max(self._bytes - len(read), 0)
            self._add(read[:MOST_BYTES])
        return []

    def _read_container(self, one: Any, kind: type) -> list[Any]:
        """Add the size of a container, or all of its numbers; returns the other items."""
        base = next(base for base in _CONTAINERS if issubclass(kind, base))
        size = base.__len__(one)
        self._add(b"%d" % size)
        if base in (list, tuple):
            step = size * _NUMBER_BYTES // max(self._bytes, 1) + 1
            if size and type(base.__getitem__(one, 0)) in _NUMBERS | _FLOATS:
                numbers = base.__getitem__(one, slice(None, None, step))
                data = _as_bytes(list(numbers))
                if data is not None:
                    self._bytes = max(self._bytes - _NUMBER_BYTES * len(numbers), 0)
                    self._add(data)
                    return []
            return list(base.__getitem__(one, slice(None, None, self._step(size))))
        if base is dict:
            pairs = islice(dict.items(one), None, None, self._step(2 * size))
            return [part for pair in pairs for part in pair]
        return list(islice(base.__iter__(one), None, None, self._step(size)))

    def _step(self, size: int) -> int:
        """Distance of the items that are looked at, so that they do not exceed what is left."""
        return size // max(self._items - self.looked_at, 1) + 1


def _as_bytes(numbers: list[Any]) -> bytes | None:
    """The bytes of a list of Python's own numbers, which are of no subclass and not very large; otherwise None."""
    kinds = set(map(type, numbers))
    if kinds <= _FLOATS:
        return np.fromiter(numbers, float, len(numbers)).tobytes()
    if not kinds <= _NUMBERS or (int in kinds and sum(map(sys.getsizeof, numbers)) > 8 * MOST_BYTES):
        return None
    return marshal.dumps(numbers, 2)


def _state(one: Any, kind: type) -> bytes:
    """What tells a value that is no container from another one."""
    if kind in _SCALARS:
        return bytes(one.tobytes())
    if kind in (str, bytes):
        return b"%d" % hash(one)
    if kind in _NUMBERS and (kind is not int or one.bit_length() <= _MOST_BITS):
        return marshal.dumps(one, 2)
    if kind is bytearray:
        return bytes(one[:MOST_BYTES])
    return b"%d" % id(one)
