"""How far the gap is closed after each effect of an explanation, on the samples that score the whole of it."""

from dataclasses import replace

import numpy as np

from labsid.gap.explanation import Explained
from labsid.gap.fitting import Fit, refit
from labsid.gap.model_file import running_model
from labsid.gap.scores import HowMuch, closure
from labsid.records.record import Record


def closed_by_step(explained: Explained, amount: HowMuch, holdout: Record | None) -> list[float | None]:
    """The share of the gap that is closed by every fit on the way to the accepted one, which no fit has seen.

    Parameters
    ----------
    explained : Explained
    amount : HowMuch
        Score of the accepted explanation.
    holdout : Record, optional
        The record that it was scored on, where that is another one.

    Returns
    -------
    list of float or None
        One for each fit of the path; None for all where there is no gap to close.
    """
    if amount.closed is None:
        return [None] * len(explained.path)
    unit = explained.data.y_scale.unit
    closed: list[float | None] = [0.0]
    for fit in explained.path[1:-1]:
        errors = _errors(explained, amount, fit) if holdout is None else _errors_on(explained, holdout, fit) / unit
        closed.append(closure(amount.before**2, float(np.mean(errors[amount.scored] ** 2)), amount.floor**2))
    return [*closed, amount.closed][-len(explained.path) :]


def _errors(explained: Explained, amount: HowMuch, fit: Fit) -> np.ndarray:
    data = explained.data
    return data.y - refit(replace(data, rows=data.rows & ~amount.scored), fit).output


def _errors_on(explained: Explained, holdout: Record, fit: Fit) -> np.ndarray:
    return holdout.y - running_model(explained.data, fit).simulate(holdout.u, holdout.y)
