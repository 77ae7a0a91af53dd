"""Directions in which the parameters of an effect are moved one at a time, for the sliders of a page."""

from dataclasses import dataclass

import numpy as np
from scipy.interpolate import PchipInterpolator

from labsid._arrays import FloatArray
from labsid.gap.effects.base import AdditiveEffect, Effect, Fitted
from labsid.gap.effects.families import names_where
from labsid.gap.fits.fitting import Fit
from labsid.gap.fits.hypothesis import Hypothesis
from labsid.gap.fits.parameter_estimates import value_slopes
from labsid.gap.model_file import STATES
from labsid.gap.record.data import Data

STEPS = 20  # positions of a slider on either side of the fitted value
EVALUATED = 5  # of them, at which the value is computed; between them it is interpolated
SIGNAL_SHARE = 0.3  # of the range of a signal, by which a level of it is moved
RECORD_SHARE = 0.25  # of the record, by which an instant is moved
CYCLES = 2.0  # in the record, by which the frequency of a sinusoid is moved
LEVELS = {"low", "high", "level", "upper", "zero", "empty", "fold"}  # readings or commands, not sizes
NO_INFLUENCE = 1e-9  # relative
PROPORTIONAL = 1e-3  # error of the derivative of a size by the signal in proportion to it
LEAST_WEIGHT = 1e-3  # of an entry that is zero


@dataclass(frozen=True, slots=True, eq=False)
class Slider:
    """Positions of one parameter of a fit; at the move 0 it is the fitted value.

    Attributes
    ----------
    effect, parameter : str
    unit : str
        "u" and "y" are the units of the record.
    values : ndarray, shape (P,)
        The parameter at each position.
    moves : ndarray, shape (P,)
        Multiples of `theta` and `gains` to add to those of the fit.
    theta, gains : ndarray
        The direction.
    of_one_record : bool
        Whether the effect belongs to the fitted record alone.
    """

    effect: str
    parameter: str
    unit: str
    values: FloatArray
    moves: FloatArray
    theta: FloatArray
    gains: FloatArray
    of_one_record: bool


def parameter_sliders(data: Data, fit: Fit, effect: Effect) -> list[Slider]:
    """The parameters of an effect that change the simulation, each with the others of the effect held."""
    at = effect.values(Fitted.of(fit, data))
    slopes = value_slopes(data, fit, effect)
    own, entries = _own_entries(fit, effect), np.concatenate([fit.theta, fit.gains])
    found = []
    for name, value in at.items():
        direction = _in_proportion(fit, effect, slopes, name, value.value)
        direction = _direction(slopes, name, own, entries) if direction is None else direction
        if direction is None:
            continue
        reach = _reach(data, effect, name, value.unit, value.value)
        moves = _moves(fit, direction, reach)
        few = moves[:: STEPS // EVALUATED]
        reached = [_values(data, fit, effect, move * direction) for move in few]
        computed = np.array([one.get(name, np.nan) for one in reached])
        kept = _increasing(few, computed)
        if kept.sum() < 2:
            continue
        few, computed = few[kept], computed[kept]
        moves = np.unique(np.clip(moves, few[0], few[-1]))
        values = PchipInterpolator(few, computed)(moves)
        theta, gains = np.split(direction, [fit.theta.size])
        lasting = not (isinstance(effect, AdditiveEffect) or effect.name in names_where("of_one_record"))
        found.append(Slider(effect.name, name, value.unit, values, moves, theta, gains, not lasting))
    return found


def _values(data: Data, fit: Fit, effect: Effect, change: FloatArray) -> dict[str, float]:
    """The parameters of the effect after a change of theta and gains; none if its limits have changed places."""
    theta, gains = np.split(np.concatenate([fit.theta, fit.gains]) + change, [fit.theta.size])
    at = Fitted(fit.hypothesis, np.clip(theta, *fit.hypothesis.bounds), gains, data)
    if [one.name for one in effect.parameters[:2]] == ["low", "high"]:
        width, fitted = (np.diff(whole[fit.hypothesis.slices[effect.key]][:2]) for whole in (at.theta, fit.theta))
        if width * fitted < 0.0:
            return {}
    return {name: one.value for name, one in effect.values(at).items()}


def _increasing(moves: FloatArray, values: FloatArray) -> np.ndarray:
    """The run of positions, with the middle one in it, over which the values increase with the moves."""
    middle = moves.size // 2
    rises = (np.diff(moves) > 0.0) & (np.diff(values) > 0.0)
    behind = np.logical_and.accumulate(rises[:middle][::-1])[::-1]
    return np.concatenate([behind, [True], np.logical_and.accumulate(rises[middle:])])


def _own_entries(fit: Fit, effect: Effect) -> np.ndarray:
    """Mask of the entries of theta and gains, in this order, that only this effect has; without initial states."""
    old = fit.hypothesis
    own = np.zeros(fit.theta.size + fit.gains.size, bool)
    if effect.key in old.slices:
        own[old.slices[effect.key]] = True
    else:
        rest = tuple(other for other in old.effects if other != effect)
        others = {one.name for one in Hypothesis(rest, given=old.given).plant.parameters}
        for i, one in enumerate(old.parameters[old.slices["plant"]], old.slices["plant"].start):
            own[i] = one.name not in others
    for i, one in enumerate(old.parameters):
        own[i] &= one.name not in STATES
    if isinstance(effect, AdditiveEffect):
        own[fit.theta.size + old.gains_of(np.arange(float(fit.gains.size)), effect).astype(int)] = True
    return own


def _in_proportion(
    fit: Fit, effect: Effect, slopes: dict[str, FloatArray], name: str, value: float
) -> FloatArray | None:
    """The gains of an added signal per unit of its size; None for other parameters."""
    if not isinstance(effect, AdditiveEffect) or value == 0.0:
        return None
    direction = np.zeros(fit.theta.size + fit.gains.size)
    marks = fit.hypothesis.gains_of(np.arange(float(fit.gains.size)), effect).astype(int)
    direction[fit.theta.size + marks] = fit.gains[marks] / value
    changes = {other: float(slope @ direction) for other, slope in slopes.items()}
    is_size = abs(changes.pop(name) - 1.0) < PROPORTIONAL and not any(changes.values())
    return direction if is_size else None


def _direction(slopes: dict[str, FloatArray], name: str, own: np.ndarray, at: FloatArray) -> FloatArray | None:
    """The change of theta and gains per unit of a parameter that leaves the others of the effect as they are.

    It is small where the entries are small. None for a parameter without influence.
    """
    rows = np.array([slopes[name], *(slope for other, slope in slopes.items() if other != name)])
    if not np.isfinite(rows).all():
        return None
    for entries in (own, np.ones_like(own)):
        J = np.where(entries, rows, 0.0)
        if np.abs(J[0]).max(initial=0.0) <= NO_INFLUENCE * max(np.abs(rows[0]).max(initial=0.0), 1e-300):
            continue
        weight = np.abs(at) + LEAST_WEIGHT
        J = J * weight
        scale = np.maximum(np.linalg.norm(J, axis=1), 1e-300)
        target = np.eye(len(J))[0] / scale
        held = np.linalg.lstsq(J / scale[:, None], target, rcond=1e-6)[0]
        if abs(float(J[0] @ held) - 1.0) > 1e-3:  # the others cannot be held
            held = J[0] / float(J[0] @ J[0])
        return np.asarray(held * weight)
    return None


def _reach(data: Data, effect: Effect, name: str, unit: str, value: float) -> float:
    """How far a parameter is moved, in its unit."""
    if name in LEVELS and unit in ("u", "y"):
        signal, scale = (data.u, data.u_scale) if unit == "u" else (data.y, data.y_scale)
        return SIGNAL_SHARE * float(np.ptp(signal)) * scale.unit
    if name in ("onset", "end"):
        return RECORD_SHARE * data.samples * data.Ts
    if name == "frequency" and effect.name in names_where("of_one_record"):
        return CYCLES / (data.samples * data.Ts)
    return abs(value)


def _moves(fit: Fit, direction: FloatArray, reach: float) -> FloatArray:
    """Positions from -reach to +reach, as far as the bounds of theta allow."""
    lower, upper = fit.hypothesis.bounds
    change = direction[: fit.theta.size]
    with np.errstate(divide="ignore", invalid="ignore"):
        ends = np.stack([(lower - fit.theta) / change, (upper - fit.theta) / change])
    ends = ends[:, np.abs(change) > 0.0]
    down = max([-reach, *ends.min(axis=0)])
    up = min([reach, *ends.max(axis=0)])
    return np.concatenate([np.linspace(min(down, 0.0), 0.0, STEPS + 1), np.linspace(0.0, max(up, 0.0), STEPS + 1)[1:]])
