"""Notebooks that lost their metadata, as by conversion or another program: which cell is which, by the given cells.

Nothing in such a notebook says which cell answers which question. The given cells and the checks are still there, with
their text, in the order of the release; what stands between two of them, where the release has the place for an answer,
is the answer. Where that leaves a choice, nothing is chosen.
"""

import re
from bisect import bisect_left
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from difflib import SequenceMatcher
from itertools import pairwise
from typing import Any

from labsid.checks.cells import CODE_STUB, TEXT_STUB, Place, Template

FEWEST = 0.8
"""Share of the released given cells and texts that must be found."""

_NEAR = 0.9
_SHORTEST_NEAR, _LONGEST_NEAR = 40, 10_000  # characters of a text that may have changed a little
_MOST_COMPARISONS = 400
_MOST_NAMED = 3
_STUB_LINES = frozenset((*CODE_STUB.splitlines(), TEXT_STUB, "..."))


class AmbiguousError(ValueError):
    """It cannot be told which cell is which; the text says why."""


@dataclass(frozen=True, slots=True)
class Alignment:
    """The cells with the grade_ids that they had.

    Attributes
    ----------
    cells : list of dict
        As `cells_of` reads them, with ids.
    found, known : int
        How many released cells and texts were found, of how many.
    """

    cells: list[dict[str, Any]]
    found: int
    known: int

    @property
    def note(self) -> str:
        """What to say about it."""
        return (
            "the notebook had lost its metadata: its cells were told apart by the text of the given cells, of which "
            f"{self.found} of {self.known} were found; check that each answer is at its question"
        )


def align_by_text(cells: Sequence[Mapping[str, Any]], template: Template) -> Alignment:
    """Give the cells of a notebook without metadata the grade_ids of the release.

    Parameters
    ----------
    cells : sequence of mapping
        As `cells_of` reads them, none with a grade_id of the release.
    template : Template

    Returns
    -------
    Alignment

    Raises
    ------
    AmbiguousError
        If too few given cells are found, or more than one cell stands where an answer is expected.
    """
    places, own = template.places, {cell.id for cell in template.cells if cell.kind in ("answer", "manual")}
    anchors = [index for index, place in enumerate(places) if place.cell_id not in own and _plain(place.text)]
    matched = _match_exactly(cells, places, anchors)
    matched |= _match_nearly(cells, places, anchors, matched)
    if not matched or len(matched) < FEWEST * len(anchors):
        raise AmbiguousError(
            "the notebook has no metadata of the course, "
            f"and only {len(matched)} of {len(anchors)} given cells are in it"
        )
    texts = {place.cell_id: place.text for place in places}
    ids = {matched[index]: places[index].cell_id for index in anchors if index in matched}
    given = {"", *(_plain(places[index].text) for index in anchors)}
    unclear: list[str] = []
    bounds = [-1, *sorted(matched), len(places)]
    for first, last in pairwise(bounds):
        start, end = matched.get(first, -1) + 1, matched.get(last, len(cells))
        free = [at for at in range(start, end) if _plain(cells[at]["source"]) not in given]
        for is_code in (True, False):
            expected = [
                place.cell_id for place in places[first + 1 : last] if place.cell_id in own and place.code == is_code
            ]
            there = [at for at in free if bool(cells[at]["code"]) == is_code]
            if len(expected) == 1 and len(there) > 1:  # cells of the student's own beside the answer
                there = [at for at in there if _keeps_what_is_given(cells[at]["source"], texts[expected[0]])] or there
            if len(expected) == 1 and len(there) == 1:
                ids[there[0]] = expected[0]
            elif expected and there:
                unclear += expected
    if unclear:
        named = ", ".join(unclear[:_MOST_NAMED]) + (" and others" if len(unclear) > _MOST_NAMED else "")
        raise AmbiguousError(
            f"the notebook has no metadata of the course, and it is not clear which cell is the answer to {named}: "
            "several stand where one is expected"
        )
    aligned = [{**cell, "id": ids.get(at) or None} for at, cell in enumerate(cells)]
    at_place = {at: places[index] for index, at in matched.items()}
    of_answers = {place.cell_id: place for place in places if place.cell_id}
    for at, cell in enumerate(aligned):
        place = at_place.get(at) or of_answers.get(cell["id"] or "")
        if place is not None and (not place.cell_id or _plain(cell["source"]) == _plain(place.text)):
            cell["source"] = place.text  # as released, but for what the conversion changed
    return Alignment(aligned, len(matched), len(anchors))


def share_of_given_cells(cells: Sequence[Mapping[str, Any]], template: Template) -> float:
    """The share of the released given cells and texts that are in a notebook as they are, whatever its metadata say."""
    places, own = template.places, {cell.id for cell in template.cells if cell.kind in ("answer", "manual")}
    anchors = [index for index, place in enumerate(places) if place.cell_id not in own and _plain(place.text)]
    return len(_match_exactly(cells, places, anchors)) / len(anchors) if anchors else 0.0


def _match_exactly(
    cells: Sequence[Mapping[str, Any]], places: Sequence[Place], anchors: Sequence[int]
) -> dict[int, int]:
    """The cell of each anchor whose text is there once, in the release and here; without those out of order."""
    here = [(bool(cell["code"]), _plain(cell["source"])) for cell in cells]
    there = {index: (places[index].code, _plain(places[index].text)) for index in anchors}
    counts, released = Counter(here), Counter(there.values())
    position = {text: at for at, text in enumerate(here)}
    pairs = [(index, position[text]) for index, text in there.items() if counts[text] == 1 == released[text]]
    return dict(_longest_rising(pairs))


def _longest_rising(pairs: Sequence[tuple[int, int]]) -> list[tuple[int, int]]:
    """The longest part of pairs, sorted by the first number, whose second numbers rise."""
    ends: list[int] = []
    last: list[int] = []
    predecessors: list[int | None] = []
    for index, (_, at) in enumerate(pairs):
        length = bisect_left(ends, at)
        ends[length : length + 1] = [at]
        last[length : length + 1] = [index]
        predecessors.append(last[length - 1] if length else None)
    rising: list[tuple[int, int]] = []
    index_now = last[-1] if last else None
    while index_now is not None:
        rising.append(pairs[index_now])
        index_now = predecessors[index_now]
    return rising[::-1]


def _match_nearly(
    cells: Sequence[Mapping[str, Any]], places: Sequence[Place], anchors: Sequence[int], matched: Mapping[int, int]
) -> dict[int, int]:
    """Anchors whose text changed a little, each between its neighbours; never a check, whose text is short."""
    nearly: dict[int, int] = {}
    taken = set(matched.values())
    comparisons = 0
    for index in anchors:
        text = _plain(places[index].text)
        if index in matched or not _SHORTEST_NEAR <= len(text) <= _LONGEST_NEAR:
            continue
        known = {**matched, **nearly}
        start = max((at for place, at in known.items() if place < index), default=-1) + 1
        end = min((at for place, at in known.items() if place > index), default=len(cells))
        near = []
        for at in range(start, end):
            cell_text = _plain(cells[at]["source"])
            if at in taken or bool(cells[at]["code"]) != places[index].code or len(cell_text) > _LONGEST_NEAR:
                continue
            comparisons += 1
            if comparisons > _MOST_COMPARISONS:
                return nearly
            if _is_near(text, cell_text):
                near.append(at)
        if len(near) == 1:
            nearly[index] = near[0]
            taken.add(near[0])
    return nearly


def _is_near(text: str, other: str) -> bool:
    matcher = SequenceMatcher(None, text, other, autojunk=False)
    return matcher.real_quick_ratio() >= _NEAR and matcher.quick_ratio() >= _NEAR and matcher.ratio() >= _NEAR


def _keeps_what_is_given(source: str, released: str) -> bool:
    """Whether a cell has all lines that the release gives for the answer, such as the head of a function."""
    kept = {line.strip() for line in source.splitlines()}
    lines = [line.strip() for line in _plain(released).splitlines() if line.strip() not in _STUB_LINES]
    return bool(lines) and all(line in kept for line in lines)


def _plain(text: str) -> str:
    """A text without what conversion changes: blanks at the ends of lines, empty lines, and the kind of line end."""
    lines = (re.sub(r"[ \t\u00a0]+", " ", line.rstrip()) for line in text.splitlines())
    return "\n".join(line for line in lines if line.strip())
