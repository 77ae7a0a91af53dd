"""From everything that was tried to an answer: which names, how sure, what cannot be told apart, or `unknown`."""

from dataclasses import dataclass

import numpy as np

from labsid.gap.fitting import Fit, power
from labsid.gap.leftover import SLOW, Leftover, is_noise
from labsid.gap.which import Explained, worth

TEMPERATURE = 4.0  # BIC counts for less than theory says: models are never exactly true
TOLD_APART = 0.03  # probability below which a rival is left out of the set
MOST_RIVALS = 3
UNKNOWN_LEFT = 0.7  # of the noise: what may be left that is no noise
UNKNOWN_CLOSED = 0.6  # of the gap: what a known cause closes at least
MISMATCH = "parameter-mismatch"


@dataclass(frozen=True, slots=True, eq=False)
class Decision:
    """The answer.

    Attributes
    ----------
    verdict : str
        "none", "effect" or "unknown".
    names : tuple of str
        The effects in the order in which they were added.
    probability : dict
        By name.
    ambiguous : tuple of str
        Names that the record cannot tell from the ones above.
    weights : dict
        Probability of every combination that was tried at the accepted level, by names.
    closed : float
        Share of the gap that the explanation closes on the fitted samples.
    """

    verdict: str
    names: tuple[str, ...]
    probability: dict[str, float]
    ambiguous: tuple[str, ...]
    weights: dict[tuple[str, ...], float]
    closed: float


def decide(explained: Explained, left: Leftover, given: Fit | None) -> Decision:
    """Weigh the candidates of the accepted level against each other, and the explanation against what it leaves.

    Parameters
    ----------
    explained : Explained
    left : Leftover
        Of the accepted hypothesis.
    given : Fit or None
        The simulation that was given, as it is.
    """
    level = len(explained.best.hypothesis.names)
    weights = _weights(explained, level)
    simulated = explained.best.hypothesis.names
    holds, closed = holds_up(explained, left)
    trust = 1.0 if holds else 0.3
    probability = {name: trust * sum(w for names, w in weights.items() if name in names) for name in simulated}
    probability |= dict.fromkeys(explained.added, 0.97 * trust)
    rivals: dict[str, float] = {}
    for names, weight in weights.items():
        for name in names:
            if name not in simulated:
                rivals[name] = rivals.get(name, 0.0) + weight
    ambiguous = [name for name, p in sorted(rivals.items(), key=lambda item: -item[1]) if p > TOLD_APART]
    names = explained.names
    if given is not None and not simulated and worth(explained.data, given, explained.path[0]):
        names = (MISMATCH, *names)
        probability[MISMATCH] = trust * mismatch_weight(given, explained.path[0])
    verdict = "unknown" if not holds else "effect" if names else "none"
    if verdict == "unknown":
        ambiguous = [*names, *ambiguous]
        names = ()
    return Decision(verdict, names, probability, tuple(ambiguous[:MOST_RIVALS]), weights, closed)


def _weights(explained: Explained, level: int) -> dict[tuple[str, ...], float]:
    """Probabilities of the combinations of `level` names, from their BIC."""
    fits = explained.levels[level]
    best = explained.best.bic
    raw = {names: float(np.exp(-max(fit.bic - best, 0.0) / (2.0 * TEMPERATURE))) for names, fit in fits.items()}
    total = sum(raw.values())
    return {names: weight / total for names, weight in raw.items()}


def holds_up(explained: Explained, left: Leftover) -> tuple[bool, float]:
    """Whether what is left is noise, or little enough beside the gap; and the share of the gap that is closed.

    Noise of a sensor may be coloured, but forgets itself within a few samples, and the input has no part in it.
    """
    path = explained.path
    before = power(explained.data, path[0])
    after, white = left.rms**2, path[-1].noise.sigma2
    noise = is_noise(left, "output-quantization" in explained.added)
    coloured = after - white if not noise or (left.slow > SLOW and "coloured-noise" not in explained.added) else 0.0
    structure = max(max(left.explained, left.repeats) * after if not noise else 0.0, coloured)
    gap = max(before - (after - structure), 1e-300)
    closed = 1.0 - float(np.sqrt(min(max(structure, 0.0) / gap, 1.0)))
    much = np.sqrt(max(structure, 0.0) / white) > UNKNOWN_LEFT
    # Two effects explain a rig; three that still leave something slow are a patchwork over an unknown one.
    patchwork = len(path) > 3 and (coloured > 0.0 or "coloured-noise" in explained.added)
    return not ((much and closed < UNKNOWN_CLOSED) or patchwork), closed


def mismatch_weight(given: Fit, free: Fit) -> float:
    """Probability that the numbers of the given simulation are wrong, against that it is right as it is."""
    return float(1.0 / (1.0 + np.exp(-max(given.bic - free.bic, 0.0) / (2.0 * TEMPERATURE))))
