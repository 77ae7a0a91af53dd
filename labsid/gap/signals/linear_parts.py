"""The linear response of an output to each of several inputs: which of them move it, and how fast."""

from dataclasses import dataclass, replace

import numpy as np

from labsid._arrays import FloatArray
from labsid.gap.dynamics.responses import real_rates
from labsid.gap.effects.further_inputs import FurtherInput
from labsid.gap.fits.fitting import Fit
from labsid.gap.fits.linear_fits import fit_baseline
from labsid.gap.record.data import Data
from labsid.gap.verdict.baseline_choice import OBSERVED_TIME_CONSTANTS

SWEEPS = 3  # over all inputs, of fits to what the others leave
OWN_PARAMETERS = 6  # of one input: two rates, two of the numerator, two of the initial state
SEEN = 0.25  # rms of a response over that of the residual, from which an effect at its input can be seen


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
        """The input that moves the output most."""
        return int(np.argmax(self.strength))


def linear_parts(pairs: list[Data]) -> LinearParts:
    """Fit the response of one output to each input in turn, to what the others leave.

    Parameters
    ----------
    pairs : list of Data
        One input each, with the same output and rows.
    """
    y, rows = pairs[0].y, pairs[0].rows
    responses = np.zeros((y.size, len(pairs)))
    rates = [(0.2, 0.01)] * len(pairs)
    left = y - y[rows].mean()
    waiting = list(range(len(pairs)))
    while waiting:  # the input that explains most comes first
        fits = {i: fit_baseline(replace(pairs[i], y=left)) for i in waiting}
        best = min(waiting, key=lambda i: fits[i].cost)
        responses[:, best], rates[best] = _response(fits[best], pairs[best]), fits[best].rates
        left = y - responses.sum(axis=1)
        waiting.remove(best)
    for _ in range(SWEEPS - 1 if len(pairs) > 1 else 0):
        for i, pair in enumerate(pairs):
            others = y - np.delete(responses, i, axis=1).sum(axis=1)
            fit = fit_baseline(replace(pair, y=others))
            responses[:, i], rates[i] = _response(fit, pair), fit.rates
    e = y - responses.sum(axis=1)
    power = np.var(e[rows])
    without = np.var((e[:, None] + responses)[rows], axis=0)
    count = int(rows.sum())
    gains = count * np.log(without / max(power, np.finfo(float).tiny))
    strength = np.std(responses[rows], axis=0)
    moves = gains > OWN_PARAMETERS * np.log(count)
    moves[np.argmax(strength)] = True
    shown = tuple(_shown(*one, y.size) for one in rates)
    return LinearParts(moves, moves & (strength > SEEN * np.sqrt(power)), strength, shown)


def _shown(c: float, k: float, samples: int) -> tuple[float, float]:
    """The rates, a pole that is too slow for the record replaced by the slowest one that it shows."""
    slowest = OBSERVED_TIME_CONSTANTS / samples
    if 0.25 * c * c < k:
        return c, max(k, slowest**2)
    slow, fast = (max(rate, slowest) for rate in real_rates(c, k))
    return slow + fast, slow * fast


def _response(fit: Fit, pair: Data) -> FloatArray:
    """What the input moves, without offset and initial state."""
    design = fit.hypothesis.design(fit.theta, pair.u)
    return np.asarray(design.columns[:, :2] @ fit.gains[:2])


def further_inputs(parts: LinearParts, main: int, signals: FloatArray, names: tuple[str, ...]) -> list[FurtherInput]:
    """The responses to all inputs that move the output but the main one.

    Parameters
    ----------
    parts : LinearParts
    main : int
    signals : ndarray, shape (N, nu)
        Scaled inputs after their actuators.
    names : tuple of str
    """
    return [
        FurtherInput(names[i], parts.rates[i], float(signals[0, i]), np.ascontiguousarray(signals[:, i]))
        for i in np.flatnonzero(parts.moves)
        if i != main
    ]
