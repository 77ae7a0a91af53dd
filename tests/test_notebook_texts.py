"""What the texts of the notebooks promise: hours, marks, prerequisites, sittings; and the errata beside them."""

import re
from functools import cache
from pathlib import Path
from statistics import median

import pytest

from labsid.checks.notebook import load_assignment
from labsid.checks.question import PEN

NOTEBOOKS = Path(__file__).resolve().parent.parent / "notebooks"
NAMES = sorted(path.stem for path in NOTEBOOKS.glob("*/*.md") if path.stem == path.parent.name)

WORDS_PER_MINUTE = 130 / 2  # technical text is read twice
MINUTES_OF = {
    r"solution: true": 7,
    r'"manual": true': 10,
    r"tags: \[demonstration\]": 2,
}
TOLERANCE = 0.25

LONGEST_READING, MEDIAN_READING = 400, 200  # words: two minutes and one, read once


@cache
def text_of(name: str) -> str:
    return (NOTEBOOKS / name / f"{name}.md").read_text(encoding="utf-8")


def prose_of(name: str) -> str:
    """What a student reads: without code, metadata and the model answers to the questions marked by hand."""
    text = text_of(name).split("---\n", 2)[2]
    text = re.sub(r"```\{code-cell\}.*?```\n", "", text, flags=re.DOTALL)
    return re.sub(r"\+\+\+ \{\"nbgrader\".*?(?=\n\+\+\+|\Z)", "", text, flags=re.DOTALL)


def estimated_minutes(name: str) -> float:
    steps = sum(minutes * len(re.findall(mark, text_of(name))) for mark, minutes in MINUTES_OF.items())
    return len(prose_of(name).split()) / WORDS_PER_MINUTE + steps


def stated_hours(name: str) -> float:
    return float(re.search(r"^\*\*Time:\*\* about ([\d.]+) hours?[.,:]", text_of(name), re.MULTILINE)[1])


@pytest.mark.parametrize("name", NAMES)
def test_the_hours_are_those_of_words_and_steps(name: str) -> None:
    assert 60 * stated_hours(name) == pytest.approx(estimated_minutes(name), rel=TOLERANCE)


@pytest.mark.parametrize("name", NAMES)
def test_the_first_lines_say_what_is_assumed_and_how_many_marks_there_are(name: str) -> None:
    start = prose_of(name)[:800]
    assert "**Assumes:**" in start
    points = sum(
        round(1000 * float(each)) for each in re.findall(r'grade_id"?: "?[\w-]+"?, "?points"?: ([\d.]+)', text_of(name))
    )
    assert points == 1000 * int(re.search(r"\*\*Marks:\*\* (\d)\.", start)[1])


def readings(name: str) -> dict[str, int]:
    """Words before each thing to do: answer, prediction or prompt "(no marks)". A formula is a word, a fold none."""
    text = text_of(name).split("---\n", 2)[2]
    text = re.sub(r"<details>.*?</details>", "", text, flags=re.DOTALL)
    by_hand = r'\+\+\+ \{"nbgrader": \{"grade_id": "([\w-]+)".*?(?=\n\+\+\+|\n```\{|\Z)'
    text = re.sub(by_hand, "\0\\1\0", text, flags=re.DOTALL)
    text = re.sub(r"```\{code-cell\}\n:nbgrader: \{grade_id: ([\w-]+)(.*?)\n```\n", what_to_do, text, flags=re.DOTALL)
    text = re.sub(r"\$\$.*?\$\$|\$[^$]*\$", "formula", text, flags=re.DOTALL)
    text = re.sub(r"\(no marks\): ([^\n]+)", "\\1\0\\1\0", text)
    parts = text.split("\0")
    return {do: len(re.findall(r"\S*\w\S*", prose)) for prose, do in zip(parts[::2], parts[1::2], strict=False)}


def what_to_do(cell: re.Match[str]) -> str:
    """The mark of a code cell in which the student does something."""
    return f"\0{cell[1]}\0" if re.search(r"solution: true|check\.predict\(", cell[2]) else ""


def test_there_is_something_to_do_after_two_minutes_of_reading_and_mostly_after_one() -> None:
    words = {(name, do): number for name in NAMES for do, number in readings(name).items()}
    assert {where: number for where, number in words.items() if number > LONGEST_READING} == {}
    assert median(words.values()) <= MEDIAN_READING


@pytest.mark.parametrize("name", [name for name in NAMES if estimated_minutes(name) > 180])
def test_more_than_three_hours_are_divided(name: str) -> None:
    text = text_of(name)
    parts = [float(hours) for hours in re.findall(r"^# Part [AB] \(([\d.]+) h\)", text, re.MULTILINE)]
    if not parts:  # the lab, with its checkpoints
        assert len(re.findall(r"^\*\*Checkpoint \d, at ", text, re.MULTILINE)) == 3
        return
    assert len(parts) == 2
    assert sum(parts) == stated_hours(name)
    assert max(parts) <= 1.75
    before, after = text.split("a good place to stop")
    assert "# Part A" in before
    assert after.splitlines()[2].startswith("# Part B")


def test_the_readme_has_the_same_hours() -> None:
    readme = (NOTEBOOKS / "README.md").read_text(encoding="utf-8")
    rows = dict(re.findall(r"^\| \d+ \| `([\w-]+)` \| [^|]+ \| ([\d.]+)", readme, re.MULTILINE))
    assert {name: float(hours) for name, hours in rows.items()} == {name: stated_hours(name) for name in NAMES}


@pytest.mark.parametrize("name", NAMES)
def test_no_text_speaks_of_a_source_that_students_do_not_have(name: str) -> None:
    assert re.findall(r"Errat\w+|\bthe notes\b|\bthe lab (?:asks|says|calls|states|prints)\b", prose_of(name)) == []


def test_every_erratum_names_steps_that_are_there() -> None:
    table = (NOTEBOOKS / "ERRATA.md").read_text(encoding="utf-8")
    rows = re.findall(r"^\| (`[\w-]+`(?:, `[\w-]+`)*) \| ([^|]+) \|", table, re.MULTILINE)
    assert len(rows) >= 33
    for assignments, steps in rows:
        names = re.findall(r"`([\w-]+)`", assignments)
        numbers = re.findall(r"(?:^|; )(\d+[a-c]?)", steps)
        assert numbers, steps
        for name, number in zip(names, numbers * len(names) if len(numbers) == 1 else numbers, strict=False):
            assert re.search(rf"^#+ {number}\. ", text_of(name), re.MULTILINE), (name, number)


@pytest.mark.parametrize("name", NAMES)
def test_the_texts_speak_of_steps_and_not_of_identifiers(name: str) -> None:
    ids = re.findall(r"grade_id\"?: \"?([\w-]+)", text_of(name))
    assert [each for each in ids if re.search(rf"(?<![\w-]){re.escape(each)}(?![\w-])", prose_of(name))] == []


@pytest.mark.parametrize("name", NAMES)
def test_the_first_lines_say_that_typed_numbers_do_not_count(name: str) -> None:
    start = " ".join(prose_of(name)[:1500].split())
    assert f"**Compute it:** a number that you type counts only where the pen {PEN} stands" in start
    record = load_assignment(name).record_file
    assert ("under the same file name" in start) == (record is not None)


@pytest.mark.parametrize("name", NAMES)
def test_no_sentence_invites_to_type_what_follows_from_the_data(name: str) -> None:
    inviting = r"[Rr]ead [^.]{0,60}off `|off `theta_hat`|[Ll]ook at your Fig|, 2\.0 V on|within\s0\.75 s"
    assert re.findall(inviting, prose_of(name)) == []
