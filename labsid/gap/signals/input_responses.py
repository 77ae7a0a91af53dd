"""The linear response of an output to each of several inputs: which of them move it, and how fast."""

from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from labsid._arrays import FloatArray
from labsid.gap.dynamics.responses import real_rates
from labsid.gap.effects.further_inputs import FurtherInput, SameEntry
from labsid.gap.fits.fitting import Fit, fit_from
from labsid.gap.fits.hypothesis import Hypothesis
from labsid.gap.fits.linear_fits import fit_baseline
from labsid.gap.record.data import Data
from labsid.gap.verdict.baseline_choice import FASTEST_RATE, fit_first_order, is_observed, shows

OWN_PARAMETERS = 6  # of one input; definition: two rates, two of the numerator, two of the initial state
SEEN = 0.25  # rms of a response over that of the residual, from which an effect there can be seen; set by hand


@dataclass(frozen=True, slots=True, eq=False)
class LinearParts:
    """Second-order responses of one output to every input.

    Attributes
    ----------
    moves : ndarray of bool, shape (nu,)
        Whether the response to an input lowers the BIC.
    seen : ndarray of bool, shape (nu,)
        Whether it is large enough for an effect at this input to be seen.
    strength : ndarray, shape (nu,)
        Rms of each response, scaled.
    rates : tuple of (float, float)
        c and k of s^2 + c s + k of each response, in samples.
    """

    moves: np.ndarray
    seen: np.ndarray
    strength: FloatArray
    rates: tuple[tuple[float, float], ...]

    @property
    def strongest(self) -> int:
        """The input that moves the output most, of those whose effects can be seen."""
        return int(np.argmax(np.where(self.seen, self.strength, 0.0) if self.seen.any() else self.strength))


def linear_parts(pairs: list[Data]) -> LinearParts:
    """Fit the responses of one output to all inputs: one after the other, the largest first, and then together.

    Parameters
    ----------
    pairs : list of Data
        One input each, with the same output and rows.
    """
    y, rows = pairs[0].y, pairs[0].rows
    alone = [_shown(pair) for pair in pairs]
    fits = dict(enumerate(alone))
    responses, own = np.zeros((y.size, len(pairs))), [_not_too_fast(fit) for fit in alone]
    rates, order = list(own), list[int]()
    while fits:
        best = min(fits, key=lambda i: fits[i].cost)
        responses[:, best], rates[best] = _response(fits[best], pairs[best]), _not_too_fast(fits[best])
        order.append(best)
        residual = y - responses.sum(axis=1)
        fits = {i: _shown(replace(pair, y=residual)) for i, pair in enumerate(pairs) if i not in order}
    if len(pairs) > 1:
        joint = [_together(pairs, order, start) for start in (rates, own, [own[order[0]]] * len(pairs))]
        _, responses, rates, e = min(joint, key=lambda found: found.cost)
    else:
        e = y - alone[0].output
    power = np.var(e[rows])
    without_input = np.var((e[:, None] + responses)[rows], axis=0)
    count = int(rows.sum())
    gains = count * np.log(without_input / max(power, np.finfo(float).tiny))
    if len(pairs) > 1 and not all(
        shows(y.size, *pair_of_rates) for pair_of_rates in rates
    ):  # slow poles may imitate what is no response
        responses, rates = np.column_stack([_response(fit, pair) for fit, pair in zip(alone, pairs, strict=True)]), own
    strength = np.std(responses[rows], axis=0)
    moves = gains > OWN_PARAMETERS * np.log(count)
    moves[np.argmax(strength)] = True
    return LinearParts(moves, moves & (strength > SEEN * np.sqrt(power)), strength, tuple(rates))


def _shown(data: Data) -> Fit:
    """The fit of second order, or of first order if the record does not show the slowest pole."""
    fit = fit_baseline(data)
    return fit if is_observed(data, fit) else fit_first_order(data)


def _not_too_fast(fit: Fit) -> tuple[float, float]:
    """The rates of a fit, a pole without influence replaced by the fastest one that samples show."""
    c, k = fit.rates
    if 0.25 * c * c < k:
        return c, k
    slow, fast = (min(rate, FASTEST_RATE) for rate in real_rates(c, k))
    return slow + fast, slow * fast


def _response(fit: Fit, pair: Data) -> FloatArray:
    """What the input moves, without offset and initial state."""
    design = fit.hypothesis.design(fit.theta, pair.u)
    return np.asarray(design.columns[:, :2] @ fit.gains[:2])


class _Joint(NamedTuple):
    """The cost of a joint fit, the responses and their rates, and the error."""

    cost: float
    responses: FloatArray
    rates: list[tuple[float, float]]
    error: FloatArray


def _together(pairs: list[Data], order: list[int], rates: list[tuple[float, float]]) -> _Joint:
    """A fit of all responses together, started from the rates of each."""
    first, *others = order
    further = tuple(FurtherInput(str(i), rates[i], float(pairs[i].u[0]), signal=pairs[i].u) for i in others)
    structure = Hypothesis(further, len(further))
    theta = np.zeros(len(structure.parameters))
    theta[1:3] = np.log(rates[first])
    fit = fit_from(pairs[first], structure, np.clip(theta, *structure.bounds), iterations=40)
    if fit is None:
        raise ValueError("no linear model can be simulated on this record. Check the signals.")
    design = fit.hypothesis.design(fit.theta, pairs[first].u)
    responses, all_rates = np.zeros((pairs[0].samples, len(pairs))), list(rates)
    responses[:, first], all_rates[first] = design.columns[:, :2] @ fit.gains[:2], fit.rates
    for effect, columns in zip(fit.hypothesis.additive, design.parts[1:], strict=True):
        i = int(effect.variant)
        responses[:, i] = columns[:, :2] @ fit.hypothesis.gains_of(fit.gains, effect)[:2]
        c, k = np.multiply(rates[i], np.exp(fit.theta[fit.hypothesis.slices[effect.key]]))
        all_rates[i] = float(c), float(k)
    return _Joint(fit.cost, responses, all_rates, pairs[0].y - fit.output)


def others_beside(
    parts: LinearParts, main: int, signals: FloatArray, names: tuple[str, ...], kind: str = "apart"
) -> list[FurtherInput | SameEntry]:
    """The responses to all inputs that move the output but the main one.

    Parameters
    ----------
    parts : LinearParts
    main : int
    signals : ndarray, shape (N, nu)
        Scaled inputs after their actuators.
    names : tuple of str
    kind : {"apart", "coupled", "same entry"}
        With poles of their own, with those of the response to the main input, or with all its dynamics but the gain.
    """
    effects: list[FurtherInput | SameEntry] = []
    for i in np.flatnonzero(parts.moves):
        signal, first = np.ascontiguousarray(signals[:, i]), float(signals[0, i])
        if i == main:
            continue
        if kind == "same entry":
            effects.append(SameEntry(names[i], first, signal))
        else:
            effects.append(FurtherInput(names[i], parts.rates[i], first, kind == "coupled", signal))
    return effects
