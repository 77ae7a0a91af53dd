"""Hand-ins that try to cheat the grader, to break it, or to reach what is not theirs, each with the score it must get.

An attacker's other answers are the model solution's, so an attack earns all points but those of the questions that it
spoils. What is held in the file system or by the kernel cannot hold on the level "none": then an attack says so.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

TIME, NOISE, CUT, MATRIX = "prelab-1-time", "prelab-2-noise", "prelab-3-cut", "prelab-4-matrix"
FUNCTION, FIRST, SECOND = "prelab-4-function", "prelab-5-original", "prelab-6-cut-off"
QUESTIONS = (TIME, NOISE, CUT, MATRIX, FUNCTION, FIRST, SECOND)

HandIn = Callable[[Path, dict[str, Any]], None]
"""Lays out a student's folder, which is empty, with a right notebook to start from."""


@dataclass(frozen=True)
class Attack:
    """One attack.

    `answers` are cells by the question that they answer, `extras` are cells that the student added after a question;
    both find in ``HERE`` what there is to aim at. `loses` are the questions that earn nothing, of which the first is
    told what `said` matches. `spares` names what must be as it was. `open_on_none` says why it does not hold there.
    """

    name: str
    why: str
    answers: Mapping[str, str] = field(default_factory=dict)
    extras: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    hand_in: HandIn | None = None
    loses: tuple[str, ...] = ()
    said: str = ""
    spares: str = ""
    open_on_none: str = ""
