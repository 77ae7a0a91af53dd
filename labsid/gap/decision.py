"""From everything that was tried to an answer: which names, how sure, what cannot be told apart, or `unknown`."""

from collections import defaultdict
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from labsid.gap.beam_search import is_improvement
from labsid.gap.effect_texts import STOP_EFFECTS
from labsid.gap.explanation import Explanation
from labsid.gap.fitting import Fit, power
from labsid.gap.leftover import SLOW, Leftover, is_noise

TEMPERATURE = 4.0  # BIC counts for less than theory says: models are never exactly true
MIN_RIVAL_PROBABILITY = 0.03  # probability below which a rival is left out of the set
MAX_RIVALS = 3
MAX_UNREPEATED = 0.15  # of the scatter of the levels: a true drift or load leaves a few hundredths
UNREPEATED_FACTOR = 0.4  # how far an explanation is to be trusted that leaves more
MIN_CONFIDENCE = 0.5  # probability below which the answer is `unknown`
MISMATCH = "parameter-mismatch"
DIRECT_EVIDENCE = (
    0.8  # probability of a stop that the output is seen to stand against, or of what leads, whatever else acts
)
LEADING_REDUCTION = 5.0  # times that an effect by itself shrinks the error, where it leads
LEADING_CLOSED = 0.8  # of the gap that is then closed, whatever else acts
LEADING_MARGIN = 3.0  # times the error that every other effect by itself leaves, there


class Evidence(NamedTuple):
    """What speaks against an explanation, each zero where nothing does.

    Attributes
    ----------
    colour : float
        Logarithm of the residual's spread over that of its innovations; less of it where the input has no part in it,
        and without an effect only that of a slow one.
    repeats : float
        Root of the share of the residual that comes back with the input, or that a function of its past predicts.
    activity : float
        The same of its magnitude.
    tails : float
        Logarithm of the kurtosis over that of normal noise.
    short : float
        How much of the gap the explanation leaves open on samples that no fit has seen, beyond what chance does.
    """

    colour: float = 0.0
    repeats: float = 0.0
    activity: float = 0.0
    tails: float = 0.0
    short: float = 0.0


PRIOR = 3.5
EVIDENCE_WEIGHTS = Evidence(colour=-5.2, repeats=-6.0, activity=-3.0, tails=-4.0, short=-4.0)
SEVERAL_EFFECTS = -1.7  # by two effects or more
ERROR_REDUCTION = 0.33
CHANCE_SHORTFALL = 0.1  # of the gap
CHANCE_PREDICTION = 0.07  # share of coloured noise that a function of the input's past may seem to predict


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
        Probability of every combination that was tried at the accepted level, by names; the rest is for other causes.
    closed : float
        Share of the gap that the explanation closes on the fitted samples.
    beside : tuple of str
        Effects of the accepted hypothesis that are not named, where others of it are.
    """

    verdict: str
    names: tuple[str, ...]
    probability: dict[str, float]
    ambiguous: tuple[str, ...]
    weights: dict[tuple[str, ...], float]
    closed: float
    beside: tuple[str, ...] = ()


def decide(
    explanation: Explanation, left: Leftover, given: Fit | None, confidence: float, at_stop: bool = False
) -> Decision:
    """Weigh the candidates of the accepted level against each other, and against other causes.

    An explanation that is not to be trusted names nothing, but for a stop that the record itself shows, and for an
    effect that by itself shrinks the error as none of the others does: neither depends on what else acts.

    Parameters
    ----------
    explanation : Explanation
    left : Leftover
        Of the accepted hypothesis.
    given : Fit or None
        The simulation that was given, as it is.
    confidence : float
        Probability that the explanation is the right one.
    at_stop : bool
        Whether the record shows the output standing against a stop.
    """
    level = len(explanation.best.hypothesis.names)
    weights = _weights(explanation, level)
    simulated = explanation.best.hypothesis.names
    noise = is_noise(left, "output-quantization" in explanation.unsimulated)
    # What repeats itself with the input is no noise of the sensor, however slow it is.
    added = (
        explanation.unsimulated
        if noise
        else tuple(name for name in explanation.unsimulated if name != "coloured-noise")
    )
    shares: defaultdict[str, float] = defaultdict(float)
    for tried, weight in weights.items():
        for name in tried:
            shares[name] += weight
    probability = {name: confidence * shares[name] for name in simulated}
    probability |= dict.fromkeys(added, confidence)
    rivals = {name: share for name, share in shares.items() if name not in simulated}
    ambiguous = [name for name, p in sorted(rivals.items(), key=lambda item: -item[1]) if p > MIN_RIVAL_PROBABILITY]
    names = (*simulated, *added)
    if given is not None and not simulated and is_improvement(explanation.data, given, explanation.path[0]):
        names = (MISMATCH, *names)
        probability[MISMATCH] = confidence * mismatch_probability(given, explanation.path[0])
    named = names
    if confidence < MIN_CONFIDENCE:
        lead = leading_effect(explanation) if closed_on_fit(explanation, left, added) > LEADING_CLOSED else None
        seen = (*(STOP_EFFECTS if at_stop else ()), lead)
        probability |= {name: DIRECT_EVIDENCE * shares[name] for name in simulated if name in seen}
        named = tuple(name for name in names if name in seen and probability[name] > MIN_CONFIDENCE)
    rest = tuple(name for name in names if name not in named)
    ambiguous = [*rest, *ambiguous]
    verdict = "effect" if named else "unknown" if confidence < MIN_CONFIDENCE else "none"
    weights = {combination: confidence * weight for combination, weight in weights.items()}
    closed = closed_on_fit(explanation, left, added)
    beside = rest if named else ()
    return Decision(verdict, named, probability, tuple(ambiguous[:MAX_RIVALS]), weights, closed, beside)


def leading_effect(explanation: Explanation) -> str | None:
    """The effect that by itself shrinks the error many times, as none of the others does; None where there is none."""
    data, alone = explanation.data, explanation.levels[1] if len(explanation.levels) > 1 else {}
    left = sorted((power(data, fit), names[0]) for names, fit in alone.items() if len(names) == 1)
    if len(left) < 2:
        return None
    (least, name), (next_best, _) = left[:2]
    far = power(data, explanation.path[0]) > LEADING_REDUCTION**2 * least and next_best > LEADING_MARGIN**2 * least
    return name if far else None


def _weights(explanation: Explanation, level: int) -> dict[tuple[str, ...], float]:
    """Probabilities of the combinations of `level` names, from their BIC."""
    fits = explanation.levels[level]
    best = explanation.best.bic
    raw = {names: float(np.exp(-max(fit.bic - best, 0.0) / (2.0 * TEMPERATURE))) for names, fit in fits.items()}
    total = sum(raw.values())
    return {names: weight / total for names, weight in raw.items()}


def confidence_in(
    explanation: Explanation, left: Leftover, closed: float | None = None, unrepeated: float = 0.0
) -> float:
    """Probability that the accepted explanation, `none` included, is the right one, by what it leaves.

    A logistic regression on the `dev` records of the sealed check. The right explanation leaves white noise, or that of
    a sensor, which forgets itself within a few samples and in which the input has no part; a patchwork over something
    unknown leaves a slow residual, or one that comes back with the input.

    Parameters
    ----------
    explanation : Explanation
    left : Leftover
        Of the accepted hypothesis.
    closed : float, optional
        Share of the gap that the explanation closes on samples that no fit has seen.
    unrepeated : float
        Where most of the gap is that the output does not come back to its levels at the same input: how much of that
        the accepted explanation leaves, zero for all explanation.
    """
    path = explanation.path
    steps = len(path) - 1
    converted = "output-quantization" in explanation.unsimulated
    wandering = False  # noise so slow that levels do not come back for it
    if converted:
        evidence = Evidence()  # rounding repeats itself with the input, and jumps
    else:
        colour = float(np.log(max(left.colour, 1.0)))
        if not steps:
            colour *= 0.5 * max(left.slow, 0.0)
        quiet = steps > 0 and is_noise(left, converted=False) and left.activity_z < 3.0
        colour *= 0.4 if quiet else 1.0  # noise beside an effect, with no sign of the input in it
        wandering = quiet and "coloured-noise" in explanation.unsimulated
        foretold = left.explained if not quiet or left.explained > CHANCE_PREDICTION else 0.0
        evidence = Evidence(
            colour=colour,
            repeats=float(np.sqrt(max(left.repeats if left.repeats_z > 2.0 else 0.0, foretold, 0.0))),
            activity=float(np.sqrt(max(left.activity, 0.0))) if left.activity_z > 3.0 else 0.0,
            tails=float(np.log(max(left.tails, 3.0) / 3.0)),
            short=_shortfall(explanation, closed),
        )
    shrunk = 0.5 * float(np.log(power(explanation.data, path[0]) / max(power(explanation.data, path[-1]), 1e-300)))
    score = PRIOR + SEVERAL_EFFECTS * (steps >= 2) + ERROR_REDUCTION * min(max(shrunk, 0.0), 4.0)
    score += sum(weight * seen for weight, seen in zip(EVIDENCE_WEIGHTS, evidence, strict=True))
    confidence = float(1.0 / (1.0 + np.exp(-score)))
    return (
        confidence * UNREPEATED_FACTOR if unrepeated > MAX_UNREPEATED and not (converted or wandering) else confidence
    )


def _shortfall(explanation: Explanation, closed: float | None) -> float:
    """What stays open of the gap, beyond chance; of coloured noise nobody knows the floor."""
    if closed is None or len(explanation.path) == 1 or "coloured-noise" in explanation.unsimulated:
        return 0.0
    return float(np.clip(1.0 - closed - CHANCE_SHORTFALL, 0.0, 1.0))


def closed_on_fit(explanation: Explanation, left: Leftover, added: tuple[str, ...]) -> float:
    """Share of the gap that the explanation closes on the fitted samples: what is left of it is no noise."""
    path = explanation.path
    before = power(explanation.data, path[0])
    after, white = left.rms**2, path[-1].noise.sigma2
    noise = is_noise(left, "output-quantization" in added)
    coloured = after - white if not noise or (left.slow > SLOW and "coloured-noise" not in added) else 0.0
    structure = max(max(left.explained, left.repeats) * after if not noise else 0.0, coloured)
    gap = max(before - (after - structure), 1e-300)
    return 1.0 - float(np.sqrt(min(max(structure, 0.0) / gap, 1.0)))


def mismatch_probability(given: Fit, free: Fit) -> float:
    """Probability that the numbers of the given simulation are wrong, against that it is right as it is."""
    return float(1.0 / (1.0 + np.exp(-max(given.bic - free.bic, 0.0) / (2.0 * TEMPERATURE))))
