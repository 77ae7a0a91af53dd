"""The text of a notebook for the course's own rig: each passage on the tanks is replaced by one on the rig.

The passages stand in ``notebooks/<assignment>/own-rig.toml``. A text in double braces in them stands for:

``rig``, ``sentence``, ``picture``, ``simulated``
    The description in ``course.toml``; the last is a sentence where the record is made with a model, else empty.
``input``, ``input.name``, ``input.unit``, the same of ``output``, ``output.unit^2``, ``gain.unit``
    The signals; ``input`` is the name with the symbol.
others
    Numbers of the record that all students share: `autograder.course.rig_numbers`.
"""

import base64
import re
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import jupytext

from autograder.course.own_rig import PICTURES, OwnRig, rig_log
from autograder.course.rig_numbers import numbers_of_record
from labsid.rig.lab.log import log_to_record

PASSAGES_FILE = "own-rig.toml"

_SIMULATED = " The course's record is simulated with a model that was identified from a log of this rig."

_PLACE = re.compile(r"\{\{([a-z0-9.^K]+)\}\}")


@dataclass(frozen=True, slots=True)
class RigWords:
    """What the passages say of a rig.

    Attributes
    ----------
    values : mapping
        What stands for each text in double braces.
    picture : mapping
        The attachment of the cell that shows the picture; empty without one.
    """

    values: Mapping[str, str]
    picture: Mapping[str, Any]


def rig_words(rig: OwnRig) -> RigWords:
    """Describe a rig, with the numbers of the record that all students share."""
    values = {
        "rig": rig.name,
        "sentence": rig.sentence,
        "picture": "",
        "simulated": _SIMULATED if rig.simulated else "",
        "gain.unit": f"{_bracketed(rig.output.unit)}/{_bracketed(rig.input.unit)}",
        "output.unit^2": f"{_bracketed(rig.output.unit)}^2",
    }
    for key, one in (("input", rig.input), ("output", rig.output)):
        values |= {key: one.called, f"{key}.name": one.name, f"{key}.unit": one.unit}
    picture: dict[str, Any] = {}
    if rig.picture is not None:
        name = f"rig{rig.picture.suffix.lower()}"
        values["picture"] = f"![{rig.name}](attachment:{name})"
        content = base64.b64encode(rig.picture.read_bytes()).decode("ascii")
        picture = {name: {PICTURES[rig.picture.suffix.lower()]: content}}
    return RigWords(values | numbers_of_record(log_to_record(rig_log(rig)), rig.output.unit), picture)


def _bracketed(unit: str) -> str:
    return f"({unit})" if re.search(r"[/·^ ]", unit) else unit


def read_for_rig(path: Path, words: RigWords) -> Any:
    """Read a text notebook for a rig.

    Parameters
    ----------
    path : Path
        A text notebook; without a file of passages beside it, it is read as it is.
    words : RigWords

    Raises
    ------
    ValueError
        If a passage is not in the text, or has an unknown text in double braces.
    """
    source = path.with_name(PASSAGES_FILE)
    text = path.read_text(encoding="utf-8")
    if not source.is_file():
        return jupytext.reads(text, fmt="md:myst")
    content = tomllib.loads(source.read_text(encoding="utf-8"))
    for passage in content.get("passage", []):
        text = _replaced(text, passage["tanks"], passage["rig"], words.values, source)
    notebook = jupytext.reads(text, fmt="md:myst")
    left_out = set(content.get("left-out", []))
    ids = {cell.metadata.get("nbgrader", {}).get("grade_id") for cell in notebook.cells}
    if not left_out <= ids:
        raise ValueError(f"{source}: there is no cell {min(left_out - ids)!r}.")
    notebook.cells = [
        cell for cell in notebook.cells if cell.metadata.get("nbgrader", {}).get("grade_id") not in left_out
    ]
    for cell in notebook.cells:
        if cell.cell_type == "markdown" and "](attachment:rig." in cell.source:
            cell.attachments = dict(words.picture)
    return notebook


def _replaced(text: str, passage: str, other: str, values: Mapping[str, str], source: Path) -> str:
    unknown = [key for key in _PLACE.findall(other) if key not in values]
    if unknown:
        raise ValueError(f"{source}: {unknown[0]!r} in double braces is not known; there are {', '.join(values)}.")
    pattern = r"\s+".join(map(re.escape, passage.split()))
    filled = _PLACE.sub(lambda place: values[place[1]], other.strip("\n"))
    text, count = re.subn(pattern, lambda _: filled, text)
    if not count:
        raise ValueError(f"{source}: the notebook does not say {' '.join(passage.split())!r}.")
    return text
