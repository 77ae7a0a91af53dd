"""MCAP files, with mcap: messages in JSON, in protobuf, and those of ROS 1 and 2 (with rosbags)."""

import json
from collections.abc import Callable, Iterator, Sequence
from itertools import islice
from pathlib import Path
from typing import Any

from labsid.records.column import Log
from labsid.records.messages import FIRST, message_log

_SEARCHED = 100_000  # messages in which the first ones of each topic are looked for


def open_log(path: Path) -> Log:
    """Open an MCAP file.

    Raises
    ------
    ValueError
        If no topic can be decoded, or none holds numbers.
    """
    from mcap.reader import make_reader

    decoders = _Decoders()

    def encoded(topics: Sequence[str]) -> Iterator[tuple[str, int, Callable[[bytes], Any], bytes]]:
        with path.open("rb") as file:
            for schema, channel, message in make_reader(file).iter_messages(topics=topics or None):
                decode = decoders.of(schema, channel)
                if decode is not None:
                    yield channel.topic, message.log_time, decode, message.data

    def messages(topics: Sequence[str]) -> Iterator[tuple[str, int, Any]]:
        return ((topic, logged, decode(data)) for topic, logged, decode, data in encoded(topics))

    first: dict[str, list[Any]] = {}
    for topic, _, decode, data in islice(encoded([]), _SEARCHED):
        decoded = first.setdefault(topic, [])
        if len(decoded) < FIRST:
            decoded.append(decode(data))
    if not first:
        encodings = ", ".join(sorted(decoders.unknown)) or "there are none"
        raise ValueError(
            f"it has no messages in JSON, in protobuf or of ROS (encodings: {encodings}). Convert it to one of these."
        )
    notes = [f"topics in {encoding} left out" for encoding in sorted(decoders.unknown)]
    return message_log(((topic, message) for topic, decoded in first.items() for message in decoded), messages, notes)


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
    if encoding == "protobuf":
        from mcap_protobuf.decoder import DecoderFactory

        parse = DecoderFactory().decoder_for(encoding, schema)
        return parse and (lambda data: _as_dict(parse(data)))
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


def _as_dict(message: Any) -> dict[str, Any]:
    """The fields of a message of protobuf; None for one that may be absent and is."""
    return {
        field.name: None
        if field.has_presence and not message.HasField(field.name)
        else _plain(getattr(message, field.name))
        for field in message.DESCRIPTOR.fields
    }


def _plain(value: Any) -> Any:
    if isinstance(value, bool | int | float | str | bytes):
        return value
    if hasattr(value, "DESCRIPTOR"):
        return _as_dict(value)
    if hasattr(value, "items"):
        return {str(key): _plain(inner) for key, inner in value.items()}
    return [_plain(inner) for inner in value]
