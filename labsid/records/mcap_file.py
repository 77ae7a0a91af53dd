"""MCAP files, with mcap: messages in JSON, and those of ROS 1 and 2 (with rosbags)."""

import json
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any

from labsid.records.column import Log
from labsid.records.messages import message_log

_SEARCHED = 100_000  # messages in which the first one of each topic is looked for


def open_log(path: Path) -> Log:
    """Open an MCAP file.

    Raises
    ------
    ValueError
        If no topic can be decoded, or none holds numbers.
    """
    from mcap.reader import make_reader

    decoders = _Decoders()

    def messages(topics: Sequence[str]) -> Iterator[tuple[str, int, Any]]:
        with path.open("rb") as file:
            for schema, channel, message in make_reader(file).iter_messages(topics=topics or None):
                decode = decoders.of(schema, channel)
                if decode is not None:
                    yield channel.topic, message.log_time, decode(message.data)

    first: dict[str, Any] = {}
    for number, (topic, _, message) in enumerate(messages([])):
        first.setdefault(topic, message)
        if number > _SEARCHED:
            break
    if not first:
        left = ", ".join(sorted(decoders.unknown)) or "there are none"
        raise ValueError(f"it has no messages in JSON or of ROS (encodings: {left}). Convert it to one of these.")
    notes = [f"topics in {encoding} left out" for encoding in sorted(decoders.unknown)]
    return message_log(first.items(), messages, notes)


class _Decoders:
    """One decoder for each schema, made when it is first met."""

    def __init__(self) -> None:
        self._known: dict[int, Callable[[bytes], Any] | None] = {}
        self.unknown: set[str] = set()

    def of(self, schema: Any, channel: Any) -> Callable[[bytes], Any] | None:
        """How the messages of a channel are decoded; None for an encoding that is not read here."""
        if channel.id not in self._known:
            decode = _decoder(schema, channel.message_encoding)
            if decode is None:
                self.unknown.add(channel.message_encoding or "no encoding")
            self._known[channel.id] = decode
        return self._known[channel.id]


def _decoder(schema: Any, encoding: str) -> Callable[[bytes], Any] | None:
    if encoding == "json":
        return json.loads
    if schema is None or encoding not in ("cdr", "ros1"):
        return None
    from rosbags.typesys import Stores, get_types_from_idl, get_types_from_msg, get_typestore

    store = get_typestore(Stores.ROS1_NOETIC if encoding == "ros1" else Stores.EMPTY)
    name = schema.name if "/msg/" in schema.name else schema.name.replace("/", "/msg/")
    text = schema.data.decode(errors="replace")
    types = get_types_from_idl(text) if schema.encoding == "ros2idl" else get_types_from_msg(text, name)
    store.register({key: value for key, value in types.items() if key not in store.fielddefs})
    read = store.deserialize_ros1 if encoding == "ros1" else store.deserialize_cdr
    return lambda data: read(data, name)
