"""Share of the gap that is closed after each effect of an explanation."""

from dataclasses import replace

import numpy as np

from labsid.gap.explanation import Explanation
from labsid.gap.fitting import Fit, refit
from labsid.gap.model_file import export_model
from labsid.gap.scores import GapScore, closed_share
from labsid.records.record import Record


def closed_by_step(explanation: Explanation, score: GapScore, holdout: Record | None) -> list[float | None]:
    """Share of the gap that each fit on the path to the accepted one closes, on samples not used in its fit.

    Parameters
    ----------
    explanation : Explanation
    score : GapScore
        Score of the accepted explanation.
    holdout : Record, optional
        The separate record of the score.

    Returns
    -------
    list of float or None
        One for each fit of the path; all None without a gap.
    """
    if score.closed is None:
        return [None] * len(explanation.path)
    unit = explanation.data.y_scale.unit
    closed: list[float | None] = [0.0]
    for fit in explanation.path[1:-1]:
        errors = _errors(explanation, score, fit) if holdout is None else _errors_on(explanation, holdout, fit) / unit
        closed.append(closed_share(score.before**2, float(np.mean(errors[score.scored] ** 2)), score.floor**2))
    return [*closed, score.closed][-len(explanation.path) :]


def _errors(explanation: Explanation, score: GapScore, fit: Fit) -> np.ndarray:
    data = explanation.data
    return data.y - refit(replace(data, rows=data.rows & ~score.scored), fit).output


def _errors_on(explanation: Explanation, holdout: Record, fit: Fit) -> np.ndarray:
    return holdout.y - export_model(explanation.data, fit).simulate(holdout.u, holdout.y)
