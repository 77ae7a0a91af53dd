"""Hold the diagnosis to account on measured rigs: diagnose one record of each, and simulate a second one."""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from time import process_time

import numpy as np

from labsid.gap.diagnosis import diagnose
from labsid.gap.record.record_findings import filtered_input
from labsid.gap.reports.result import Diagnosis
from labsid.gap.verdict.baseline_choice import FIRST_ORDER, LEAST_SQUARES
from labsid.records.record import between_outputs, load_record
from labsid.records.several_signals import one_signal_each

HOLDOUT = ".holdout"
ERROR = "error"  # verdict of a rig that cannot be diagnosed
WORSE = 1.02  # error of the exported simulation over that of the linear model, above which it is worse
POOR_BASELINE = 1.1  # error of the linear model over that of the better of two simple ones, above which it is poor


@dataclass(frozen=True, slots=True, eq=False)
class RigResult:
    """Diagnosis of one rig, checked on a second record.

    Attributes
    ----------
    name : str
        File name of the record without its suffix.
    verdict : str
        Of the report, or "error" for a rig that cannot be diagnosed; its errors are then not numbers.
    effects : tuple of (str, float)
        Names and probabilities.
    before, after : float
        Rms free-run errors of the linear model and of the exported simulation on the second record, in the unit of y.
    simple : float
        The smaller error of least squares and of output error of first order.
    remaining : str or None
        Path of what is left.
    seconds : float
        Processor time.
    message : str
        Why the rig cannot be diagnosed; empty if it can.
    """

    name: str
    verdict: str
    effects: tuple[tuple[str, float], ...]
    before: float
    after: float
    simple: float
    remaining: str | None
    seconds: float
    message: str = ""

    @property
    def is_worse(self) -> bool:
        """Whether the exported simulation is worse than the linear model; False without one."""
        return self.after > WORSE * self.before

    @property
    def is_poor_baseline(self) -> bool:
        """Whether the linear model is worse than a simple one."""
        return self.before > POOR_BASELINE * self.simple


def find_rigs(folder: Path) -> list[tuple[Path, Path]]:
    """Pairs of a record ``NAME.csv`` and a second record of the same rig, ``NAME.holdout.csv``, sorted by name.

    Raises
    ------
    ValueError
        If there are none.
    """
    pairs = [(path.with_name(path.name.replace(HOLDOUT, "")), path) for path in sorted(folder.glob(f"*{HOLDOUT}.csv"))]
    pairs = [(record, holdout) for record, holdout in pairs if record.is_file()]
    if not pairs:
        raise ValueError(f"{folder}: no NAME.csv with a NAME{HOLDOUT}.csv beside it. Put both records of a rig there.")
    return pairs


def check_rigs(pairs: list[tuple[Path, Path]], order: int = 2, seed: int = 0) -> Iterator[RigResult]:
    """Diagnose the first record of each rig with the second one as holdout.

    A rig whose records cannot be read or diagnosed has the verdict "error", and the next one follows.

    Parameters
    ----------
    pairs : list of (Path, Path)
        From `find_rigs`.
    order : int
        Order of the linear model.
    seed : int
    """
    for path, second in pairs:
        start = process_time()
        try:
            yield _checked(path, second, order, seed)
        except (OSError, ValueError) as error:
            nan = float("nan")
            yield RigResult(path.stem, ERROR, (), nan, nan, nan, None, process_time() - start, str(error))


def _checked(path: Path, second: Path, order: int, seed: int) -> RigResult:
    """Diagnosis of one rig, and the error of its exported simulation on the second record."""
    record = one_signal_each(load_record(path), "the table of rigs")
    holdout = between_outputs(one_signal_each(load_record(second), "the table of rigs"))
    start = process_time()
    diagnosed = diagnose(record, holdout=holdout, order=order, seed=seed)
    seconds = process_time() - start
    assert isinstance(diagnosed, Diagnosis)
    report = diagnosed.summary
    errors = report["simulation"]["model"]["errors"]
    e = holdout.y - diagnosed.model.simulate(filtered_input(holdout), holdout.y)
    return RigResult(
        name=path.stem,
        verdict=report["verdict"],
        effects=tuple((effect["name"], effect["probability"]) for effect in report["effects"]),
        before=report["gap"]["before"],
        after=float(np.sqrt(np.nanmean(e[report["holdout_unscored"] :] ** 2))),
        simple=min(errors[FIRST_ORDER], errors[LEAST_SQUARES]),
        remaining=report["unexplained"]["path"],
        seconds=seconds,
    )
