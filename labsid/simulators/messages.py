"""Messages between a simulator's process and its user's: a length of eight bytes, and a pickled object."""

import pickle
import struct
from typing import IO, Any

_LENGTH = struct.Struct("<Q")


def write_message(stream: IO[bytes], content: Any) -> None:
    """Write one object."""
    data = pickle.dumps(content, protocol=pickle.HIGHEST_PROTOCOL)
    stream.write(_LENGTH.pack(len(data)) + data)
    stream.flush()


def read_message(stream: IO[bytes]) -> Any:
    """Read one object; `EOFError` if the other side has ended."""
    return pickle.loads(_read(stream, _LENGTH.unpack(_read(stream, _LENGTH.size))[0]))


def _read(stream: IO[bytes], size: int) -> bytes:
    data = stream.read(size)
    if len(data) < size:
        raise EOFError
    return data
