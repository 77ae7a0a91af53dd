"""The text of a notebook for the course's own rig: each passage on the tanks is replaced by one on the rig.

The passages stand in ``notebooks/<assignment>/own-rig.toml``. A text in double braces in them stands for:

``rig``, ``sentence``, ``picture``, ``simulated``
    The description in ``course.toml``; the last is a sentence where the record is made with a model, else empty.
``input``, ``input.name``, ``input.unit``, the same of ``output``, ``output.unit^2``, ``gain.unit``
    The signals; ``input`` is the name with the symbol.
``u.rest``, ``u.low``, ``u.high``, ``y.rest``
    Levels of the record that all students share.
``tau``, ``settling``, ``condition``, ``rms``, ``share``, ``start.factor``, ``signs``, ``step``
    What the lab finds of it: time constant and four of them (s), condition number of Phi, error of the simulation, as a
    share of the range of y, and how much the right initial state saves; what the signs of its signals are; a tenth of
    the range of y.
``order1.pole``, ``order1.tau``, ``mse1``, ``mse2``, ``rms1``, ``rms2``, ``saving``
    Of the models of first and second order: pole and time constant of the first, errors of both, and a sentence on what
    the second saves.
``step.K``, ``step.tau``, ``step.td``
    First-order model with delay of the first step.
"""

import base64
import re
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import jupytext
import numpy as np

from autograder.course.own_rig import PICTURES, OwnRig, rig_log
from labsid.lab.identification import identify
from labsid.lab.step_response import cut_held_step, fit_step_response
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
    return RigWords(values | _numbers(rig), picture)


def _numbers(rig: OwnRig) -> dict[str, str]:
    """The numbers of the record; `ValueError` if the lab cannot be carried out on it."""
    record = log_to_record(rig_log(rig))
    first, second = identify(record, 1), identify(record, 2)
    t, y, amplitude = cut_held_step(record.u, record.y, record.Ts, 0, before=min(first.offsets.first_period, 20))
    step = fit_step_response(t, y, amplitude).reading
    span = float(np.ptp(record.y))
    slowest = float(max(abs(pole) for pole in second.model.poles))
    pole = float(first.model.poles[0].real)
    if not (0 < slowest < 1 and 0 < pole < 1):
        raise ValueError("the models of the record do not settle")
    tau, tau_1 = (-record.Ts / float(np.log(one)) for one in (slowest, pole))
    mse_1, errors = first.verification.mse_all, second.verification
    both = min(second.u.min(), second.y.min()) < -0.05 * min(np.ptp(second.u), np.ptp(second.y))
    numbers = {
        "u.rest": second.model.u_offset,
        "u.low": float(record.u.min()),
        "u.high": float(record.u.max()),
        "y.rest": second.model.y_offset,
        "tau": tau,
        "settling": 4 * tau,
        "condition": second.fit.condition_number,
        "rms": np.sqrt(errors.mse_all),
        "start.factor": errors.mse_second_half / errors.mse_second_half_carried,
        "step": 0.1 * span,
        "order1.tau": tau_1,
        "rms1": np.sqrt(mse_1),
        "rms2": np.sqrt(errors.mse_all),
        "step.K": step.K,
        "step.tau": step.tau,
        "step.td": step.td,
    }
    digits = dict.fromkeys(("u.rest", "u.low", "u.high", "y.rest"), 4)
    return {key: _short(value, digits.get(key, 2)) for key, value in numbers.items()} | {
        "share": f"{np.sqrt(errors.mse_all) / span:.1%}".replace("%", " %"),
        "signs": "; both now take positive and negative values" if both else "",
        "order1.pole": f"{pole:.3f}",
        "mse1": f"{mse_1:.3g}",
        "mse2": f"{errors.mse_all:.3g}",
        "saving": _saving(1 - errors.mse_all / mse_1),
    }


def _saving(share: float) -> str:
    if share > 0:
        return f"On the course's record the step from order 1 to 2 saves {100 * share:.0f} %."
    return "On the course's record the step from order 1 to 2 saves nothing."


def _short(value: float, digits: int) -> str:
    """A number with few digits, without a power of ten where it can be."""
    rounded = float(f"{value:.{digits}g}")
    return f"{rounded:.0f}" if 10**digits <= abs(rounded) < 1e6 else f"{rounded:g}"


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
