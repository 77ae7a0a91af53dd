"""The part of the report from which a page replays the simulations: signals, fitted combinations and sliders.

Signals are scaled, and written in base64 as numbers of 64 or 32 bits.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from threadpoolctl import threadpool_limits

from labsid._arrays import FloatArray, stretches_of
from labsid.gap.effects.base import AdditiveEffect, Effect, OutputEffect
from labsid.gap.effects.inside import MISMATCH
from labsid.gap.effects.restarts import Restarts, in_one_record
from labsid.gap.fits.fitting import Fit
from labsid.gap.fits.hypothesis import Hypothesis
from labsid.gap.model_file import export_model
from labsid.gap.record.data import Data, Scale
from labsid.gap.record.readings import along
from labsid.gap.reports.sliders import Slider, parameter_sliders
from labsid.gap.reports.traces import packed
from labsid.gap.search.forms import remove_named_effect
from labsid.gap.verdict.answer import Answer
from labsid.records.record import Record

MOST_COMBINATIONS = 8
Names = tuple[str, ...]


class ReplayData:
    """What a page replays: made when it is first asked for, and then kept.

    Parameters
    ----------
    make : callable or None
        Returns it; called once at most, with BLAS on one thread as in `diagnose`.
    content : dict or None
        It, if it is made, or None if there is nothing to replay.
    """

    __slots__ = ("_content", "_make")

    def __init__(self, make: Callable[[], dict[str, Any]] | None, content: dict[str, Any] | None = None) -> None:
        self._make, self._content = make, content

    def __call__(self) -> dict[str, Any] | None:
        if self._make is not None:
            with threadpool_limits(1, "blas"):
                self._content = self._make()
            self._make = None  # and with it the fits of which it was made
        return self._content

    def __reduce__(self) -> tuple[Any, ...]:
        return ReplayData, (None, self())


def replay_content(
    record: Record,
    inside: np.ndarray,
    measured: tuple[np.ndarray, np.ndarray | None],
    answer: Answer,
    holdout: Record | None,
) -> dict[str, Any]:
    """Assemble what a page replays: `shown_signals`, and the combinations of effects.

    Parameters
    ----------
    record, inside, measured, answer, holdout
        As of `shown_signals`.

    Returns
    -------
    dict
        JSON-ready.

    Notes
    -----
    A saved report has it, too, as a page is made from one; a printed one has not.
    """
    combinations = _combinations(answer)
    return shown_signals(record, inside, measured, answer, holdout) | {
        "accepted": list(accepted_names(answer)),
        "combinations": [
            _combination(answer, fit, holdout) | {"names": list(names)} for names, fit in combinations.items()
        ],
    }


def shown_signals(
    record: Record,
    inside: np.ndarray,
    measured: tuple[np.ndarray, np.ndarray | None],
    answer: Answer,
    holdout: Record | None,
) -> dict[str, Any]:
    """All samples of the signals and of the simulations before and after, scaled.

    Parameters
    ----------
    record : Record
        As diagnosed.
    inside : ndarray of bool, shape (N,)
        Samples of the record; between several joined ones there are others.
    measured : tuple of ndarray of bool
        Samples that are shown with an output, of the record and of the holdout.
    answer : Answer
    holdout : Record or None
        Its output is missing (NaN) where there is none.

    Returns
    -------
    dict
        JSON-ready.
    """
    data, score = answer.explanation.data, answer.score
    before = np.where(inside, answer.before.output, np.nan)
    after = np.where(inside, score.after_fit.output, np.nan)
    y = data.y if data.at is None else along(score.after_fit.output, data.y, data.at)
    y = np.where(inside & measured[0], y, np.nan)
    return {
        "u_scale": _scale(data.u_scale),
        "y_scale": _scale(data.y_scale),
        "record": _signals(record, (data.u, y, before, after))
        | {"fitted": stretches_of(data.rows), "scored": [] if holdout or data.pieces else stretches_of(score.scored)},
        "holdout": None
        if holdout is None
        else _signals(holdout, (data.u_scale.of(holdout.u), _with_gaps(holdout, answer, measured[1]), *score.outputs))
        | {"fitted": [], "scored": stretches_of(score.scored)},
    }


def _with_gaps(holdout: Record, answer: Answer, measured: np.ndarray | None) -> FloatArray:
    y = along(answer.score.outputs[1], answer.explanation.data.y_scale.of(holdout.y))
    return np.asarray(np.where(True if measured is None else measured, y, np.nan))


def accepted_names(answer: Answer) -> Names:
    """The effects of the exported simulation."""
    found = answer.score.after_fit.hypothesis.names
    return tuple(sorted(set(found) - {MISMATCH}))


def _combinations(answer: Answer) -> dict[Names, Fit]:
    """The accepted combination, each part of it, and the first ones of the ranking."""
    accepted = accepted_names(answer)
    found = {accepted: answer.score.after_fit} if accepted else {}
    if len(accepted) > 1:
        found |= _parts(answer, accepted)
    for names, fit in _ranked(answer):
        if len(found) >= MOST_COMBINATIONS:
            break
        if names:
            found.setdefault(names, fit)
    return found


def _parts(answer: Answer, accepted: Names) -> dict[Names, Fit]:
    """Each part of the accepted combination: the fit at hand, or one without the other effects."""
    whole = {accepted: answer.score.after_fit}
    for size in range(len(accepted) - 1, 0, -1):
        for parent, fit in [item for item in whole.items() if len(item[0]) == size + 1]:
            for name in parent:
                names = tuple(other for other in parent if other != name)
                if names not in whole:
                    part = answer.fits.get(names) or remove_named_effect(answer.explanation.data, fit, name)
                    whole |= {} if part is None else {names: part}
    return {names: fit for names, fit in whole.items() if names != accepted}


def _ranked(answer: Answer) -> list[tuple[Names, Fit]]:
    """All combinations tried, best first, as in the ranking."""
    if answer.tried:
        return sorted(answer.fits.items(), key=lambda item: answer.tried.get(item[0], np.inf))
    weights = answer.decision.weights
    return sorted(answer.fits.items(), key=lambda item: (-weights.get(item[0], 0.0), item[1].bic))


@dataclass(frozen=True, slots=True, eq=False)
class PlayedPart:
    """What of a fit a page simulates: the rest of its output is constant.

    Attributes
    ----------
    effects : tuple of Effect
    theta, gains : ndarray
    theta_from, gains_from : ndarray of int
        The entries of the fit that they hold; -1 for none.
    constant : ndarray or None
        The part of the signal before the sensor that is not simulated.
    """

    effects: tuple[Effect, ...]
    theta: FloatArray
    gains: FloatArray
    theta_from: np.ndarray
    gains_from: np.ndarray
    constant: FloatArray | None


def played_part(data: Data, fit: Fit) -> PlayedPart:
    """Leave out a given simulation, which only its simulator can run, and what belongs to one of several records."""
    old = fit.hypothesis
    design = old.design(fit.theta, data.u)
    is_given = old.plant.kind == "given"
    gains_from, constant = np.arange(fit.gains.size), None
    for effect, part in zip(old.additive, design.parts[1:], strict=True):
        if isinstance(effect, Restarts):
            own = old.gains_of(gains_from.astype(float), effect).astype(int)
            constant = part @ fit.gains[own]
            gains_from = np.setdiff1d(gains_from, own)
    if is_given:
        width = design.parts[0].shape[1]
        constant = design.parts[0] @ fit.gains[:width] + (0.0 if constant is None else constant)
        gains_from = gains_from[width:]
    kinds = (OutputEffect, AdditiveEffect) if is_given else (Effect,)
    kept = (one for one in old.effects if isinstance(one, kinds) and not isinstance(one, Restarts))
    effects = tuple(in_one_record(one) for one in kept)
    new = Hypothesis(effects)
    theta = np.array([parameter.start for parameter in new.parameters])
    theta_from = np.full(theta.size, -1)
    if is_given:
        theta[new.slices["plant"]][:2] = np.log(old.plant.simulation.rates)
    else:
        theta_from[: new.slices["plant"].start] = np.arange(new.slices["plant"].start)
    for key, place in new.slices.items():
        if key != "plant" or not is_given:
            theta_from[place] = np.arange(fit.theta.size)[old.slices[key]][: place.stop - place.start]
    theta = np.where(theta_from < 0, theta, fit.theta[theta_from])
    if constant is not None and not is_given:  # by which the dynamics differ that start in each record anew
        width = design.parts[0].shape[1]
        constant = constant + (design.parts[0] - new.design(theta, data.u).parts[0]) @ fit.gains[:width]
    return PlayedPart(effects, theta, fit.gains[gains_from], theta_from, gains_from, constant)


def _combination(answer: Answer, fit: Fit, holdout: Record | None) -> dict[str, Any]:
    data, model = answer.explanation.data, export_model(answer.explanation.data, fit, start=answer.start)
    played = played_part(data, fit)
    simulated = fit.hypothesis.plant.kind != "given"
    found = [one for effect in fit.hypothesis.found for one in parameter_sliders(data, fit, effect)]
    started = None
    if holdout is not None and simulated:
        other = model.started_on(holdout.u, holdout.y)
        started = {"theta": other.theta[played.theta_from].tolist(), "gains": other.gains[played.gains_from].tolist()}
    return {
        "effects": [effect.key for effect in played.effects],
        "theta": played.theta.tolist(),
        "gains": played.gains.tolist(),
        "span": model.span,
        "reference": model.reference,
        "constant": None if played.constant is None else packed(played.constant),
        "simulated": simulated,
        "holdout": started,
        "sliders": [one for slider in found if (one := _slider(slider, played)) is not None],
    }


def _slider(slider: Slider, played: PlayedPart) -> dict[str, Any] | None:
    """A slider of entries that the page simulates; None for others."""
    theta, gains = (
        {i: float(whole[old]) for i, old in enumerate(places.tolist()) if old >= 0 and whole[old] != 0.0}
        for whole, places in ((slider.theta, played.theta_from), (slider.gains, played.gains_from))
    )
    if len(theta) + len(gains) < np.count_nonzero(slider.theta) + np.count_nonzero(slider.gains):
        return None
    return {
        "effect": slider.effect,
        "parameter": slider.parameter,
        "unit": slider.unit,
        "values": slider.values.tolist(),
        "moves": slider.moves.tolist(),
        "theta": list(theta.items()),
        "gains": list(gains.items()),
        "of_one_record": slider.of_one_record,
    }


def _signals(record: Record, signals: tuple[FloatArray, ...]) -> dict[str, Any]:
    u, *others = signals
    named = dict(zip(("y", "before", "after"), map(packed, others), strict=True))
    return {"start": float(record.t[0]), "Ts": record.Ts, "u": packed(u, "<f8")} | named


def _scale(scale: Scale) -> dict[str, float]:
    return {"centre": scale.centre, "unit": scale.unit}
