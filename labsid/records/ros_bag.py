"""Bags of ROS 1 and ROS 2, with rosbags."""

from collections.abc import Iterator, Sequence
from itertools import islice
from pathlib import Path
from typing import Any

from labsid.records.column import Log
from labsid.records.messages import FIRST, message_log


def open_log(path: Path) -> Log:
    """Open a ``.bag`` of ROS 1, or the folder of a bag of ROS 2.

    Raises
    ------
    ValueError
        If a ``.db3`` lies without its ``metadata.yaml``, or no topic holds numbers.
    """
    from rosbags.highlevel import AnyReader
    from rosbags.typesys import Stores, get_typestore

    if path.is_file() and path.suffix != ".bag":
        if not (path.parent / "metadata.yaml").is_file():
            raise ValueError("it is part of a bag of ROS 2. Give the bag's folder, with metadata.yaml in it.")
        path = path.parent
    store = get_typestore(Stores.LATEST)

    def messages(topics: Sequence[str]) -> Iterator[tuple[str, int, Any]]:
        with AnyReader([path], default_typestore=store) as reader:
            chosen = [connection for connection in reader.connections if connection.topic in topics]
            for connection, stamp, data in reader.messages(connections=chosen):
                yield connection.topic, stamp, reader.deserialize(data, connection.msgtype)

    first: list[tuple[str, Any]] = []
    left_out = []
    with AnyReader([path], default_typestore=store) as reader:
        for topic in sorted({connection.topic for connection in reader.connections}):
            chosen = [connection for connection in reader.connections if connection.topic == topic]
            try:
                for connection, _, data in islice(reader.messages(connections=chosen), FIRST):
                    first.append((topic, reader.deserialize(data, connection.msgtype)))
            except Exception:  # of any kind, from the description of a message that rosbags does not know
                left_out.append(topic)
    notes = [f"topics that cannot be decoded left out: {', '.join(left_out)}"] if left_out else []
    return message_log(first, messages, notes)
