"""Numbers that were written into the texts of a figure, in the place of the values of variables."""

import ast
import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace
from typing import Any

from labsid.checks.cell_names import parse_python
from labsid.checks.other_records import can_be_drawn
from labsid.checks.permitted import without_magic
from labsid.checks.question import Ask, Assignment, FollowsFrom, Question
from labsid.checks.syntax_trees import constant_text
from labsid.checks.values import Value
from labsid.checks.verdict import Verdict
from labsid.plots.figure_values import FigureValue

_MEASURED = re.compile(r"\d+\.\d+(?:[eE][-+]?\d+)?|\d+[eE][-+]?\d+")
"""A number that follows from data: with decimals, or with a power of ten. Orders and figure numbers have neither."""


def numbers_in_texts(sources: Iterable[str]) -> frozenset[str]:
    """The numbers that stand in the texts of cells, or between the braces of an f-string.

    Parameters
    ----------
    sources : iterable of str

    Returns
    -------
    frozenset of str
    """
    return frozenset(number for source in sources for text in _texts(source) for number in _MEASURED.findall(text))


def _texts(source: str) -> Iterator[str]:
    try:
        nodes = list(ast.walk(parse_python(without_magic(source))))
    except (SyntaxError, ValueError, RecursionError):
        return
    for node in nodes:
        if isinstance(node, ast.Constant) and isinstance(node.value, str):
            yield node.value
        elif isinstance(node, ast.FormattedValue) and isinstance(node.value, ast.Constant):
            yield constant_text(node.value.value)


def numbers_that_count(
    question: Question, assignment: Assignment, ask: Ask, written: Mapping[str, Iterable[str]]
) -> Mapping[str, list[str]]:
    """The written numbers without which a figure would not be right, by the name of the figure.

    Parameters
    ----------
    question : Question
        It has been answered rightly.
    assignment : Assignment
    ask : Ask
    written : mapping
        For each name that the question reads, the numbers that were written in the cells that made it.

    Returns
    -------
    mapping
        Empty where a typed-in value counts, and where none of the numbers does.
    """
    name = assignment.record_file
    if question.follows_from is not FollowsFrom.DATA or name is None or not can_be_drawn(name):
        return {}
    found: dict[str, list[str]] = {}
    for figure, numbers in written.items():
        value = ask.value(figure) if numbers else None
        if isinstance(value, FigureValue):
            shown = [one for one in sorted(set(numbers)) if without_numbers(value, [one]) is not value]
            less = _AskWith(ask, {figure: without_numbers(value, shown)})
            if shown and not question.verdict(less).passed:
                found[figure] = shown
    return found


def without_numbers(figure: FigureValue, numbers: Iterable[str]) -> FigureValue:
    """The figure without these numbers in its texts; the same one if it has none of them."""
    any_of_them = "|".join(map(re.escape, numbers))
    pattern = re.compile(rf"(?<![\d.])(?:{any_of_them})(?!\d)")

    def cut(texts: tuple[str, ...]) -> tuple[str, ...]:
        return tuple(pattern.sub("", text) for text in texts)

    axes = tuple(
        replace(one, title=cut((one.title,))[0], texts=cut(one.texts), legend=cut(one.legend)) for one in figure.axes
    )
    before, after = ([(one.title, one.texts, one.legend) for one in axes] for axes in (figure.axes, axes))
    return figure if before == after else FigureValue(axes)


class _AskWith:
    """Asks the same work, with other values under these names."""

    def __init__(self, ask: Ask, values: Mapping[str, Value]) -> None:
        self._ask = ask
        self._values = values

    def value(self, name: str) -> Value:
        return self._values[name] if name in self._values else self._ask.value(name)

    def __getattr__(self, name: str) -> Any:
        return getattr(self._ask, name)


def told_of_numbers(found: Mapping[str, list[str]]) -> Verdict:
    """What a check says of numbers that were written into a figure."""
    figure, numbers = next(iter(found.items()))
    those = " and ".join(numbers)
    are = "are" if len(numbers) > 1 else "is"
    return Verdict(
        False,
        f"{those} in `{figure}` {are} right on your record, but typed in, and wrong on another one. Grading also runs "
        "your notebook on another record, so this would earn nothing: let the code write the values of your variables, "
        'in braces after an `f`, as in f"{x:.3g}".',
        "typed in",
    )
