"""The table of the branches that the tests take: sums of rooms, and the reason of each that is below the limit."""

from pathlib import Path
from typing import Any

import pytest
from coverage_by_room import REASONS, Counts, by_room, counts_by_file, room_of, table

ROOT = Path(__file__).resolve().parent.parent
FILES = {
    "labsid/lab/arx.py": Counts(100, 20, 0, 0),
    "labsid/lab/offset.py": Counts(50, 20, 5, 1),
    "labsid/plots/gap.py": Counts(80, 10, 20, 4),
    "labsid/plots/lab.py": Counts(80, 10, 0, 0),
    "labsid/_files.py": Counts(10, 0, 1, 0),
}


@pytest.mark.parametrize(
    ("path", "room"),
    [
        ("labsid/lab/arx.py", "labsid/lab"),
        ("labsid/checks/assignments/least_squares/constraints.py", "labsid/checks"),
        ("labsid/gap/diagnosis.py", "labsid/gap"),
        ("labsid/gap/reports/javascript/expressions.py", "labsid/gap/reports"),
        ("labsid/_files.py", "labsid"),
    ],
)
def test_the_room_of_a_file_is_its_folder(path: str, room: str) -> None:
    assert room_of(path) == room


def test_the_counts_of_a_room_are_the_sums_of_its_files() -> None:
    rooms = by_room(FILES)
    assert rooms["labsid/lab"] == Counts(150, 40, 5, 1)
    assert rooms["labsid/lab"].share == 1.0 - 1 / 40
    assert rooms["labsid"].share == 0.9  # of the statements: there are no branches


def test_a_room_below_the_limit_is_listed_with_its_reason_and_its_files() -> None:
    text, explained = table(FILES, {"labsid/plots": "figures of arms are drawn by no test."})
    assert explained
    lines = text.splitlines()
    assert lines[1:5] == [
        "labsid                            10         0   90.0 %",
        "labsid/lab                       150        40   97.5 %",
        "labsid/plots                     160        20   80.0 %",
        "all                              320        60   91.7 %",
    ]
    assert lines[-2:] == [
        "labsid/plots, 80.0 %: figures of arms are drawn by no test.",
        "    labsid/plots/gap.py: 4 of 10 branches are not taken",
    ]


def test_a_room_below_the_limit_without_a_reason_is_not_accepted() -> None:
    text, explained = table(FILES, {})
    assert not explained
    assert "labsid/plots, 80.0 %: no reason is given" in text


def test_the_report_is_read() -> None:
    summary = {
        "num_statements": 4,
        "num_branches": 2,
        "missing_lines": 1,
        "missing_branches": 1,
        "percent_covered": 70.0,
    }
    report: dict[str, Any] = {"files": {"labsid\\lab\\arx.py": {"summary": summary}}}
    assert counts_by_file(report) == {"labsid/lab/arx.py": Counts(4, 2, 1, 1)}


def test_every_folder_and_every_shared_module_of_the_tests_is_on_their_page() -> None:
    page = (ROOT / "tests" / "README.md").read_text(encoding="utf-8")
    folders = [path.name for path in (ROOT / "tests").iterdir() if path.is_dir() and any(path.glob("*.py"))]
    rooms = [f"labsid/{path.name}" for path in (ROOT / "tests/labsid").iterdir() if any(path.rglob("test_*.py"))]
    assert [name for name in folders if f"{name}/" not in page] == []
    assert [room for room in rooms if f"`{room}`" not in page] == []
    modules = [path.name for path in (ROOT / "tests").glob("test_*.py")]
    assert [name for name in modules if name not in page] == []


def test_a_reason_belongs_to_a_room() -> None:
    assert all((ROOT / room).is_dir() for room in REASONS)
