"""Hand-ins in which values were typed in: the model solution is run, and what its answer cells assign becomes literals.

A number, an array, a text, a model and a figure are written as the literals that make them again; a figure is drawn
from typed-in curves. Functions stay as they are, because they are no values.
"""

import ast
import re
from collections.abc import Iterator, Mapping
from types import FunctionType
from typing import Any

import control as ct
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from one_answer import Solved

from autograder.course.definitions import definitions_in
from labsid.checks.cell_names import assigned_names

IMPORTS = "import control as ct\nimport matplotlib.pyplot as plt"


def typed_in(solved: Solved) -> dict[str, str]:
    """The answer cells that assign a value, with literals in the place of what they compute, by cell."""
    found: dict[str, str] = {}
    ids = list(solved.cells)
    for cell, following in zip(ids, [*ids[1:], ""], strict=True):
        if not cell.endswith("-answer"):
            continue
        values = values_of(solved, cell, following)
        if values and not _assigns_functions(solved, cell, following):
            functions = definitions_in(solved.cells[cell])
            found[cell] = "\n".join([functions, IMPORTS, *(literal_line(*one) for one in values.items())])
    return found


def values_of(solved: Solved, cell: str, following: str) -> dict[str, Any]:
    """The values that an answer cell assigns and something after it reads, by name."""
    variables = solved.run_before(following)
    names = assigned_names(solved.cells[cell])
    later = "\n".join(list(solved.cells.values())[list(solved.cells).index(cell) + 1 :])
    read = {*re.findall(r"\w+", later), *solved.names_read(cell.removesuffix("-answer"))}
    return {name: variables[name] for name in sorted(names & read) if is_value(variables.get(name))}


def _assigns_functions(solved: Solved, cell: str, following: str) -> bool:
    """Whether it computes a function, which is no literal: the best of several models."""
    variables = solved.run_before(following)
    others = assigned_names(solved.cells[cell]) - assigned_names(definitions_in(solved.cells[cell]))
    return any(isinstance(variables.get(name), FunctionType) for name in others)


def is_value(value: Any) -> bool:
    """Whether it is written as a literal."""
    kinds = (bool, int, float, str, np.ndarray, np.generic, tuple, list, dict)
    return isinstance(value, (*kinds, Figure, ct.TransferFunction, ct.StateSpace))


def literal_line(name: str, value: Any) -> str:
    """Code that assigns a typed-in value."""
    if isinstance(value, Figure):
        return "\n".join(_drawn(name, value))
    return f"{name} = {literal(value)}"


def literal(value: Any) -> str:
    """A value as one would type it, with all its digits."""
    if isinstance(value, ct.TransferFunction):
        return f"ct.tf({value.num[0][0].tolist()!r}, {value.den[0][0].tolist()!r}, {value.dt!r})"
    if isinstance(value, ct.StateSpace):
        return f"ct.ss({value.A.tolist()}, {value.B.tolist()}, {value.C.tolist()}, {value.D.tolist()}, {value.dt!r})"
    if isinstance(value, np.generic):
        value = value.item()
    if isinstance(value, np.ndarray):
        return f"np.array({value.tolist()!r})"
    if isinstance(value, tuple | list):
        inner = ", ".join(map(literal, value))
        return f"({inner},)" if isinstance(value, tuple) else f"[{inner}]"
    if isinstance(value, dict):
        return "{" + ", ".join(f"{key!r}: {literal(one)}" for key, one in value.items()) + "}"
    text = repr(value)
    ast.literal_eval(text)
    return text


def _drawn(name: str, figure: Figure) -> Iterator[str]:
    """Code that draws a figure again from typed-in curves."""
    yield f"{name}, typed_axes = plt.subplots({len(figure.axes)}, 1, squeeze=False, layout='constrained')"
    for row, axes in enumerate(figure.axes):
        yield from (f"typed_axes[{row}, 0].{call}" for call in _calls(axes))


def _calls(axes: Axes) -> Iterator[str]:
    for line in axes.lines:
        x, y = (np.asarray(data, float).tolist() for data in line.get_data())
        style: Mapping[str, Any] = {
            "label": line.get_label(),
            "drawstyle": line.get_drawstyle(),
            "linestyle": line.get_linestyle(),
            "marker": line.get_marker(),
            "color": line.get_color(),
        }
        yield f"plot({x!r}, {y!r}, {', '.join(f'{key}={value!r}' for key, value in style.items())})"
    for text in axes.texts:
        x, y = text.get_position()
        yield f"text({float(x)!r}, {float(y)!r}, {text.get_text()!r}, transform=typed_axes.flat[0].transAxes, va='top')"
    yield f"set(xlabel={axes.get_xlabel()!r}, ylabel={axes.get_ylabel()!r}, title={axes.get_title()!r})"
    yield f"set_xlim({tuple(map(float, axes.get_xlim()))!r})"
    yield f"set_ylim({tuple(map(float, axes.get_ylim()))!r})"
    if axes.get_legend() is not None:
        yield "legend()"
