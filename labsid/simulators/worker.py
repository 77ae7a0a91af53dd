"""The process of a simulator: ``python -m labsid.simulators.worker SOURCE``; it answers each request with an output.

What the simulator prints is discarded.
"""

import os
import sys
from typing import Any

from labsid.simulators.messages import read_message, write_message
from labsid.simulators.simulator import SimulatorError
from labsid.simulators.sources import open_source


def main() -> None:
    """Open the source that the command line names, and simulate until the other side ends."""
    requests, replies = os.fdopen(os.dup(0), "rb"), os.fdopen(os.dup(1), "wb")
    null = os.open(os.devnull, os.O_RDWR)
    for stream in (0, 1, 2):
        os.dup2(null, stream)
    try:
        simulator = open_source(sys.argv[1])
    except (ValueError, OSError) as error:
        write_message(replies, str(error))
        return
    ports = simulator.inputs, simulator.outputs
    write_message(replies, (simulator.label, simulator.nominal, simulator.joint, simulator.ranges, *ports))
    while True:
        try:
            t, u, numbers = read_message(requests)
        except EOFError:
            return
        reply: Any
        try:
            reply = simulator(t, u, numbers)
        except SimulatorError as error:
            reply = str(error)
        write_message(replies, reply)


if __name__ == "__main__":
    main()
