"""Branches that the tests take, by room: `make coverage`.

A room is a folder of `labsid` or `autograder`, or of the diagnosis. A room with fewer than `ENOUGH` of
its branches taken is listed with its reason and its files; without a reason in `REASONS` the exit status is 1. Compiled
functions are left out: they run as machine code, in which nothing is traced, and are held to other computations by
tests.
"""

import json
import sys
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

ENOUGH = 0.9  # of the branches of a room
WIDEST = 3  # files that are listed of a room below that: those with the most branches that are not taken

REASONS: dict[str, str] = {}
"""Why fewer branches of a room are taken."""


@dataclass(frozen=True, slots=True)
class Counts:
    """Statements and branches of a room or a file, and how many of them no test runs.

    Attributes
    ----------
    statements, branches : int
    missing_statements, missing_branches : int
    """

    statements: int = 0
    branches: int = 0
    missing_statements: int = 0
    missing_branches: int = 0

    @property
    def share(self) -> float:
        """Of the branches that are taken; of the statements, where there are no branches."""
        if self.branches:
            return 1.0 - self.missing_branches / self.branches
        return 1.0 - self.missing_statements / max(self.statements, 1)

    def __add__(self, other: "Counts") -> "Counts":
        return Counts(
            self.statements + other.statements,
            self.branches + other.branches,
            self.missing_statements + other.missing_statements,
            self.missing_branches + other.missing_branches,
        )


def counts_by_file(report: Mapping[str, Any]) -> dict[str, Counts]:
    """The counts of each file in a JSON report of the package coverage, by its path with slashes."""
    return {
        path.replace("\\", "/"): Counts(
            one["summary"]["num_statements"],
            one["summary"]["num_branches"],
            one["summary"]["missing_lines"],
            one["summary"]["missing_branches"],
        )
        for path, one in report["files"].items()
    }


def room_of(path: str) -> str:
    """The room of a file, as ``labsid/checks`` of ``labsid/checks/assignments/least_squares/constraints.py``."""
    folders = path.split("/")[:-1]
    return "/".join(folders[: 3 if folders[:2] == ["labsid", "gap"] else 2])


def by_room(files: Mapping[str, Counts]) -> dict[str, Counts]:
    """The sums of the files of each room."""
    rooms: dict[str, Counts] = {}
    for path, counts in sorted(files.items()):
        rooms[room_of(path)] = rooms.get(room_of(path), Counts()) + counts
    return rooms


def table(files: Mapping[str, Counts], reasons: Mapping[str, str]) -> tuple[str, bool]:
    """The table of the rooms, and the rooms below `ENOUGH`; whether each of those has a reason."""
    rooms = by_room(files)
    lines = ["room                      statements  branches   taken"]
    lines += [
        f"{room:25}{counts.statements:11}{counts.branches:10}{100 * counts.share:7.1f} %"
        for room, counts in [*rooms.items(), ("all", sum(rooms.values(), Counts()))]
    ]
    few = {room: counts for room, counts in rooms.items() if counts.share < ENOUGH}
    for room, counts in few.items():
        lines += ["", f"{room}, {100 * counts.share:.1f} %: {reasons.get(room, 'no reason is given')}"]
        inside = [(path, one) for path, one in files.items() if room_of(path) == room and one.missing_branches]
        for path, one in sorted(inside, key=lambda item: -item[1].missing_branches)[:WIDEST]:
            lines.append(f"    {path}: {one.missing_branches} of {one.branches} branches are not taken")
    return "\n".join(lines), few.keys() <= reasons.keys()


def main(file: str) -> int:
    """Print the table of a JSON report; returns the exit status."""
    report = json.loads(Path(file).read_text(encoding="utf-8"))
    text, explained = table(counts_by_file(report), REASONS)
    print(text)
    return int(not explained)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
