"""Poles and zeros of the linear dynamics of the simulations before and after, for the report."""

from collections.abc import Callable, Iterable
from typing import Any

import numpy as np

from labsid._arrays import FloatArray
from labsid._texts import joined
from labsid.gap.dynamics.linear_part import LINEARISED, denominator_of, numerator_of
from labsid.gap.fits.fitting import Fit, covariance
from labsid.gap.record.data import Data
from labsid.gap.reports.quantities import number
from labsid.gap.reports.sentences import is_unchanged
from labsid.gap.simulations.baseline import Baseline
from labsid.gap.verdict.answer import Answer
from labsid.model_structures.roots import Root, roots_with_errors

ABSENT = 1e-3  # magnitude: a smaller pole decays within a sample, and stands for none
STEP = 1e-5  # of a parameter, or of one: for the derivatives
LARGEST_ERROR = 0.5  # of a root: the record does not tell where it lies


def linear_dynamics(answer: Answer, base: Baseline) -> dict[str, Any] | None:
    """Poles and zeros of the simulations before and after, as far as they are linear; None of both.

    Parameters
    ----------
    answer : Answer
    base : Baseline

    Returns
    -------
    dict or None
        ``before`` and ``after``, each None or ``{poles, zeros, linearised}``, without whole samples of a dead time.
    """
    data = answer.explanation.data
    given = base.transfer_function
    before = _of_fit(data, answer.before) if given is None else _content(given.den, given.num)
    after = _of_fit(data, answer.explanation.best)
    return None if before is None and after is None else {"before": before, "after": after}


def drawn_dynamics(report: dict[str, Any]) -> dict[str, tuple[tuple[Root, ...], tuple[Root, ...]]] | None:
    """Poles and zeros for the figure of the page, of the simulations "before" and "after"; None if there are none.

    Parameters
    ----------
    report : dict
        Those written by earlier versions have no poles.
    """
    found = {
        name: (_roots(own["poles"]), _roots(own["zeros"] or ()))
        for name, own in (report.get("dynamics") or {}).items()
        if own is not None and own["poles"]
    }
    return found or None


def poles_sentence(report: dict[str, Any]) -> str:
    """The slowest pole before and after, and what the figure leaves out."""
    dynamics = {name: own for name, own in (report.get("dynamics") or {}).items() if own is not None and own["poles"]}
    if not dynamics:
        return ""
    Ts, same = report["record"]["Ts"], is_unchanged(report)
    times = {name: _longest_time(own, Ts) for name, own in dynamics.items() if not (same and name == "after")}
    said = [f"{number(time)} s{'' if same else f' {name}'}" for name, time in times.items() if time is not None]
    texts = [f"The longest time constant of the linear dynamics is {joined(said)}."] if said else []
    texts.append("Shaded areas are 95 % regions; a pole or zero without one is given, or its place is not known.")
    if any(own["linearised"] for own in dynamics.values()):
        texts.append("Of nonlinear dynamics, the poles are those about the mean level, and no zeros are drawn.")
    return " ".join([*texts, "Whole samples of a dead time, which are poles at zero, are left out."])


def _longest_time(own: dict[str, Any], Ts: float) -> float | None:
    """In seconds; None if a pole does not decay."""
    largest = max(abs(complex(*row["value"])) for row in own["poles"])
    return -Ts / float(np.log(largest)) if largest < 1.0 else None


def _roots(rows: Iterable[dict[str, Any]]) -> tuple[Root, ...]:
    unknown = np.full((2, 2), np.nan)
    return tuple(
        Root(complex(*row["value"]), unknown if row["covariance"] is None else row["covariance"]) for row in rows
    )


def _of_fit(data: Data, fit: Fit) -> dict[str, Any] | None:
    """Poles and zeros of a fit; None of a simulation that is run, and of an unstable rig beside its measured output."""
    hypothesis, plant = fit.hypothesis, fit.hypothesis.plant
    if plant.kind == "given" or hypothesis.feedback is not None:
        return None
    span, at = data.samples, hypothesis.slices["plant"]
    width = plant.columns(fit.plant_theta, np.zeros(3), span, reference=0.0).shape[1]
    delays = (hypothesis.slices[effect.key].start for effect in hypothesis.inputs if effect.name == "input-delay")
    delay = next(delays, 0)
    places = np.array([delay, *range(at.start, at.stop), *range(fit.theta.size, fit.theta.size + width)])
    spread = covariance(data, fit)[np.ix_(places, places)]
    point = np.concatenate([fit.theta, fit.gains])[places]
    own, gains = slice(1, 1 + at.stop - at.start), slice(1 + at.stop - at.start, None)
    whole = np.floor(point[0])

    def denominator(x: FloatArray) -> FloatArray:
        return denominator_of(plant, x[own], span)

    def numerator(x: FloatArray) -> FloatArray:
        return numerator_of(plant, x[own], x[gains], span, float(x[0] - whole))

    den = denominator(point), _spread(denominator, point, spread)
    if plant.kind in LINEARISED:
        return _content(den[0], None, den[1])
    return _content(den[0], numerator(point), den[1], _spread(numerator, point, spread))


def _spread(function: Callable[[FloatArray], FloatArray], point: FloatArray, covariance: FloatArray) -> FloatArray:
    """Covariance of the values of a function, to first order."""
    steps = STEP * np.maximum(np.abs(point), 1.0)
    moves = [(function(point + step) - function(point - step)) / 2.0 for step in np.diag(steps)]
    slopes = np.array(moves).T / steps
    return np.asarray(slopes @ covariance @ slopes.T)


def _content(
    den: FloatArray, num: FloatArray | None, den_spread: FloatArray | None = None, num_spread: FloatArray | None = None
) -> dict[str, Any]:
    """Roots as they stand in the report."""
    return {
        "poles": [_row(root) for root in roots_with_errors(den, den_spread) if abs(root.value) > ABSENT],
        "zeros": None
        if num is None
        else [_row(root) for root in roots_with_errors(num, num_spread) if abs(root.value) > ABSENT],
        "linearised": num is None,
    }


def _row(root: Root) -> dict[str, Any]:
    known = np.isfinite(root.covariance).all() and float(np.trace(root.covariance)) < LARGEST_ERROR**2
    return {
        "value": [float(root.value.real), float(root.value.imag)],
        "covariance": root.covariance.tolist() if known else None,
    }
