"""Decide on the effects to name, with their probabilities and rivals, or on the verdict `unknown`."""

from collections import defaultdict
from collections.abc import Iterable, Sequence, Set
from dataclasses import dataclass, replace
from operator import attrgetter
from typing import NamedTuple

import numpy as np

from labsid.gap.effects.command_faults import Off
from labsid.gap.effects.detected import UNSIMULATED
from labsid.gap.effects.disturbance import PassingLoad
from labsid.gap.effects.drifts import GainDrift
from labsid.gap.effects.dynamics import MOST_DAMPING, ExtraLag, Resonance
from labsid.gap.effects.families import DESCRIPTIONS, magnitudes_of, names_where, places_of
from labsid.gap.effects.input import RateLimit
from labsid.gap.effects.inside import MISMATCH
from labsid.gap.fits.fitting import Fit, fit_from, mean_square
from labsid.gap.fits.parameter_estimates import has_place, is_told_from_nothing
from labsid.gap.fits.profile import loss_at
from labsid.gap.fits.residual_tests import SLOW_CORRELATION, ResidualMeasures, is_noise
from labsid.gap.fits.switching import has_equal_steps, only_switches
from labsid.gap.record.controllers import has_controller
from labsid.gap.record.data import Data
from labsid.gap.record.sweep import sweeps_once
from labsid.gap.search.beam_search import BIC_MARGIN, is_improvement
from labsid.gap.search.explanation import Explanation
from labsid.gap.search.forms import transfer_theta
from labsid.gap.verdict.held_out_errors import Reduction
from labsid.gap.verdict.held_out_search import HeldOutSearch, Step
from labsid.gap.verdict.products import product_instead

TEMPERATURE = 4.0  # divides BIC differences: models are never exact; set by hand
MIN_RIVAL_PROBABILITY = 0.03  # of an alternative to be reported as ambiguous; set by hand
MAX_RIVALS = 3  # alternatives; definition: the report has three at most
MAX_UNREPEATED = 0.15  # share of the scatter between plateaus left open; measured: hundredths by true drifts and loads
MIN_CONFIDENCE = 0.5  # below which the verdict is `unknown`; definition: more likely than not
RIVAL_FACTOR = 1.1  # rms error of a rival over that of the chosen effect, below which it is ambiguous; set by hand
SEEN_STOP = 0.8
"""Probability of an effect that stops the output, if it pays and the record shows the limit; set by hand."""
MIN_PART = 0.05  # of the rms gap: an effect that adds less to others may be an error of their laws; set by hand
SWITCH_PROBABILITY = 0.4  # of an effect that the record does not tell from others, whatever its fit; set by hand
RIVAL_ITERATIONS = 25  # of the fit of a load in the place of a command that is not applied; numerics
PULSE_PARTS = (1.0, 0.4, 0.15)  # of the time in which it is not applied: a pulse may be shorter, and larger; numerics
LEVEL_RANGE = 0.1  # of the range of the command: what the level of a drive must be told from; set by hand
LIKELY_LOSS = 4.0  # twice the loss of log likelihood; statistics: two standard errors
UNLIKELY_LOSS = 9.0  # twice the loss of log likelihood; statistics: three standard errors
MAX_REDUCTION = 1.5  # logarithm of a reduction of the rms error: more is no more certain; set by hand
MAX_MARGIN = 0.5
"""Logarithm of the rms error of the best rival over that of the effect: more is no more certain; set by hand."""


class Evidence(NamedTuple):
    """Evidence for and against an explanation; zero means none.

    Attributes
    ----------
    colour : float
        Logarithm of the standard deviation of the residual over that of its innovations; reduced if the residual is
        independent of the input, and without effects counted for a slow residual only.
    repeats : float
        Square root of the share of the residual that repeats with the input, or that past inputs predict.
    activity : float
        The same for the magnitude of the residual.
    tails : float
        Logarithm of the kurtosis over that of normal noise.
    short : float
        Share of the gap left open on held-out samples, beyond chance.
    several : float
        Number of effects beyond the first: each is one more that chance may have found.
    coloured : float
        1 for coloured noise beside effects, else 0: an effect outside the table often leaves a residual like it.
    reduction : float
        Logarithm of the rms error before over that after, at most `MAX_FIT_REDUCTION`.
    unrepeated : float
        1 if levels do not repeat at the same input, and the explanation leaves more than `MAX_UNREPEATED` of that, else
        0. Rounding and slow noise keep levels from repeating, too.
    dependent : float
        1 if the residual beside effects depends on past inputs beyond `CHANCE_DEPENDENCE`, else 0: effects that only
        imitate an unknown cause leave a part of it.
    """

    colour: float = 0.0
    repeats: float = 0.0
    activity: float = 0.0
    tails: float = 0.0
    short: float = 0.0
    several: float = 0.0
    coloured: float = 0.0
    reduction: float = 0.0
    unrepeated: float = 0.0
    dependent: float = 0.0


PRIOR = 3.5  # constant of the logistic function of the evidence; fitted: with `WEIGHTS`
WEIGHTS = Evidence(
    colour=-5.2,
    repeats=-6.0,
    activity=-3.0,
    tails=-4.0,
    short=-4.0,
    several=-1.7,
    coloured=-1.5,
    reduction=0.33,
    unrepeated=-6.0,
    dependent=-6.0,
)
"""Weights of that function; fitted: `python -m labsid.blind.calibration`, to the explanations of `dev` records."""
MAX_FIT_REDUCTION = 4.0  # logarithm of the reduction on the fitted samples: more is no more certain; set by hand
CHANCE_SHORTFALL = 0.1  # share of the gap left open by chance; set by hand
CHANCE_PREDICTION = 0.07  # share of coloured noise that past inputs may predict by chance; set by hand
CHANCE_DEPENDENCE = 1e-4
"""P-value of the correlation with past inputs; measured: none of 500 right explanations is below."""
CHANCE_BLACK_BOX = 0.15  # the same for all black boxes together; set by hand


@dataclass(frozen=True, slots=True, eq=False)
class Decision:
    """Verdict and named effects.

    Attributes
    ----------
    verdict : str
        "none", "effect", "partial" or "unknown".
    names : tuple of str
        The effects, in the order in which they were added.
    probability : dict
        By name.
    ambiguous : tuple of str
        Alternatives that the record cannot exclude.
    weights : dict
        Probability of every combination tried with as many effects; the remainder is for other causes.
    closed : float
        Share of the gap closed on the fitted samples.
    product : str
        By what the input is rather multiplied, "output" or "wave", which explains as much with fewer numbers.
    """

    verdict: str
    names: tuple[str, ...]
    probability: dict[str, float]
    ambiguous: tuple[str, ...]
    weights: dict[tuple[str, ...], float]
    closed: float
    product: str = ""


def decide(explanation: Explanation, left: ResidualMeasures, given: Fit | None, confidence: float) -> Decision:
    """Compare the candidates of the accepted level with each other and with an unknown cause.

    With too little confidence nothing is named.

    Parameters
    ----------
    explanation : Explanation
    left : ResidualMeasures
        Of the accepted fit.
    given : Fit or None
        The given simulation, not refitted.
    confidence : float
        Probability that the explanation is right.
    """
    simulated = explanation.best.hypothesis.names
    weights = _weights(explanation, len(simulated))
    noise = is_noise(left, "output-quantization" in explanation.unsimulated)
    # A residual that repeats with the input is not sensor noise, however slow it is.
    added = tuple(name for name in explanation.unsimulated if noise or name != "coloured-noise")
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
        ambiguous = _ahead(explanation)
    named = names if confidence >= MIN_CONFIDENCE else ()
    ambiguous = [*(name for name in names if name not in named), *ambiguous]
    verdict = "effect" if named else "unknown" if confidence < MIN_CONFIDENCE else "none"
    weights = {combination: confidence * weight for combination, weight in weights.items()}
    closed = closed_on_fit(explanation, left, added)
    return Decision(verdict, named, probability, tuple(ambiguous[:MAX_RIVALS]), weights, closed)


def _ahead(explanation: Explanation) -> list[str]:
    """Single effects that explain more than other parameters alone, by too small a change to be found, best first."""
    singles = explanation.levels[1].values() if len(explanation.levels) > 1 else ()
    ahead = [fit for fit in singles if fit.bic < explanation.path[0].bic - BIC_MARGIN]
    return [name for fit in sorted(ahead, key=attrgetter("bic")) for name in fit.hypothesis.names]


def limit_claims(
    named: Decision, explanation: Explanation, regulated: bool, closed: tuple[float, float] | None
) -> list[tuple[str, Decision]]:
    """What may be claimed of a decision, in the order of the rules that limit it.

    Parameters
    ----------
    named : Decision
    explanation : Explanation
    regulated : bool
        Whether a controller with a constant reference gives the input.
    closed : (float, float), optional
        95 % interval of the share of the gap that is closed on held-out samples.

    Returns
    -------
    list of (str, Decision)
        The reason of each rule in a sentence, and the decision after it.
    """
    data, best = explanation.data, explanation.best
    steps = []
    for reason, rule in (
        (
            "The fitted actuator only switches, which does not show the shape of a limit.",
            lambda one: without_curve_of_switch(one, data, best),
        ),
        (
            "The input sweeps its frequency once: what changes with time is not told from what changes with frequency.",
            lambda one: without_drift_of_sweep(one, data),
        ),
        ("Several lags move alike.", lambda one: without_lags_as_others(one, data, best)),
        (
            "Each of its sizes is within two standard errors of zero, or its place is not known.",
            lambda one: without_sizeless(one, data, best),
        ),
        (
            "A load that comes and goes does the same while the command rests.",
            lambda one: without_pulses_as_offs(one, data, best),
        ),
        (
            "It adds hardly anything to the other effects, whose laws are approximations.",
            lambda one: without_small_additions(one, explanation),
        ),
        (
            "A gain that changes with the output or oscillates explains as much with fewer numbers, or more.",
            lambda one: without_imitated_product(one, explanation),
        ),
        (
            "On held-out samples it may explain nothing.",
            lambda one: without_doubtful_parts(one, closed),
        ),
        (
            "In a loop noise biases the fit, and on held-out samples there is no gap.",
            lambda one: without_biased_fits(one, data, best, closed),
        ),
        (
            "A controller with a constant reference gives the input.",
            lambda one: of_regulated_record(one) if regulated else one,
        ),
        (
            "The rig is unstable: the spring may stand for a curve of the sensor.",
            lambda one: without_stand_ins(one, best),
        ),
    ):
        named = rule(named)
        steps.append((reason, named))
    return steps


def without_curve_of_switch(decision: Decision, data: Data, fit: Fit) -> Decision:
    """The decision with no limit or curve of the actuator more likely than not, if that only switches.

    Its two values fit a limit, a dead zone, a coarse step and a curve alike. Its hysteresis is that of a play.
    """
    named = set(decision.names) & names_where("shape_of_input")
    if not named or not only_switches(data, fit):
        return decision
    return _less_likely_than_not(decision, named)


def without_drift_of_sweep(decision: Decision, data: Data) -> Decision:
    """The decision with no drift of the rig more likely than not, if the input sweeps its frequency once.

    Dynamics that the simulation lacks then show in the part of the record that has their frequency, as a drift does.
    """
    if GainDrift.name not in decision.names or not sweeps_once(data.u):
        return decision
    return _less_likely_than_not(decision, {GainDrift.name})


def without_lags_as_others(decision: Decision, data: Data, fit: Fit) -> Decision:
    """The decision with nothing more likely than not that further lags are taken for.

    A rate limit, if the steps of the command have one size: an actuator that takes a constant time for each of them, as
    a moving average or several lags do, moves alike. A mode that is not lightly damped: it is a pair of lags.
    """
    parameters = [parameter.name for parameter in fit.hypothesis.parameters]
    damped = "log_damping" in parameters and np.exp(fit.theta[parameters.index("log_damping")]) > MOST_DAMPING
    other = {RateLimit.name: has_equal_steps(data), Resonance.name: damped}
    lags = {name for name in decision.names if other.get(name, False)}
    return _less_likely_than_not(decision, lags, (ExtraLag.name,)) if lags else decision


def without_sizeless(decision: Decision, data: Data, fit: Fit) -> Decision:
    """The decision with no effect more likely than not whose every size is within its error of none.

    Nor one of which no place on the axis of its signal is known to the range of that signal, nor others that act beside
    it on the same path: it only lends them its parameters.
    """
    likely = [one for one in fit.hypothesis.found if decision.probability.get(one.name, 0.0) > SWITCH_PROBABILITY]
    sizeless = {one.name for one in likely if not is_told_from_nothing(data, fit, one, magnitudes_of(one.name))}
    nowhere = {DESCRIPTIONS[one.name].path for one in likely if not has_place(data, fit, one, places_of(one.name))}
    sizeless |= {name for name in decision.names if name in DESCRIPTIONS and DESCRIPTIONS[name].path in nowhere}
    return _less_likely_than_not(decision, sizeless) if sizeless else decision


def without_pulses_as_offs(decision: Decision, data: Data, fit: Fit) -> Decision:
    """The decision with no command that is not applied for a while more likely than not, if a load explains as much.

    While the command rests, a load does what another command does, and few commands change within a short time. A
    level that a drive has tells them apart: zero, or the command before.
    """
    found = fit.hypothesis
    off = next((one for one in found.found if isinstance(one, Off) and one.variant == "while"), None)
    if off is None or off.name not in decision.names or _has_level_of_drive(data, fit, off):
        return decision
    load = PassingLoad("ends")
    other = found.with_effects(tuple(load if one is off else one for one in found.effects))
    start, length, _ = fit.theta[found.slices[off.key]]

    def explains_as_much(part: float) -> bool:
        theta = transfer_theta(fit, other)
        theta[other.slices[load.key]] = start, start + part * length
        rival = fit_from(data, other, theta, iterations=RIVAL_ITERATIONS)
        return rival is not None and rival.bic - fit.bic <= BIC_MARGIN

    if not any(map(explains_as_much, PULSE_PARTS)):
        return decision
    return _less_likely_than_not(decision, {off.name}, (load.name,))


def _has_level_of_drive(data: Data, fit: Fit, off: Off) -> bool:
    """Whether the level of a command that is not applied is clearly zero, or clearly that of the command before."""
    place = fit.hypothesis.slices[off.key]
    level, near = place.stop - 1, LEVEL_RANGE * float(np.ptp(data.u))
    before = max(int(fit.theta[place.start] * data.samples) - 1, 0)
    usual = data.zero_command, float(data.u[before])
    return any(
        loss_at(data, fit, level, at) < LIKELY_LOSS
        and min(loss_at(data, fit, level, at + side) for side in (-near, near)) > UNLIKELY_LOSS
        for at in usual
    )


def without_small_additions(decision: Decision, explanation: Explanation) -> Decision:
    """The decision with no effect more likely than not that hardly adds to others.

    The law of an effect is an approximation, and what it leaves looks like another effect. True pairs: at least 0.35 of
    the gap; second names that were wrong: at most 0.03.
    """
    data, best = explanation.data, explanation.best
    left, names = mean_square(data, best), set(best.hypothesis.names)
    gap = mean_square(data, explanation.path[0]) - left
    if decision.verdict != "effect" or len(names) < 2 or gap <= 0.0:
        return decision
    small = set()
    for name in names & set(decision.names):
        without = [fit for key, fit in explanation.levels[len(names) - 1].items() if set(key) == names - {name}]
        added = min((mean_square(data, fit) for fit in without), default=np.inf) - left
        small |= {name} if added < MIN_PART**2 * gap else set()
    return _less_likely_than_not(decision, small) if small else decision


def without_imitated_product(decision: Decision, explanation: Explanation) -> Decision:
    """The decision with no effect more likely than not, where these imitate a product with the input."""
    product = product_instead(explanation) if decision.names else ""
    if not product:
        return decision
    return replace(_less_likely_than_not(decision, set(decision.names)), verdict="partial", product=product)


def without_doubtful_parts(decision: Decision, closed: tuple[float, float] | None) -> Decision:
    """The decision with no simulated effect more likely than not, if it may close no part, or enlarges the gap."""
    if closed is None or (closed[0] > 0.0 if decision.verdict == "partial" else closed[1] >= 0.0):
        return decision
    return _less_likely_than_not(decision, set(decision.names) - set(UNSIMULATED))


def without_biased_fits(decision: Decision, data: Data, fit: Fit, closed: tuple[float, float] | None) -> Decision:
    """The decision with no simulated effect more likely than not in a loop whose held-out samples show no gap.

    The input of a loop contains the noise of the output, so that a fit gains by dynamics that the rig does not have.
    """
    simulated = set(decision.names) & {effect.name for effect in fit.hypothesis.found}
    if decision.verdict != "effect" or closed is not None or not simulated or not has_controller(*data.sampled):
        return decision
    return _less_likely_than_not(decision, simulated)


def of_regulated_record(decision: Decision) -> Decision:
    """The decision `unknown`, but for disturbances: where a controller with a constant reference gives the input.

    Nothing moves such a record on purpose, and the law of the controller explains it as well as the rig does.
    """
    if decision.names and set(decision.names) <= names_where("of_one_record"):
        return decision
    return replace(decision, verdict="unknown", names=(), probability={}, ambiguous=())


def without_stand_ins(decision: Decision, fit: Fit) -> Decision:
    """The decision with no spring more likely than not, where it may stand for a curve or limit of the sensor.

    The feedback of an unstable rig takes the reading for the position. Beside it, a curve of the reading acts like one
    of the restoring force, and is fitted worse.
    """
    named = set(decision.names) & names_where("spring")
    if decision.verdict != "partial" or not named or fit.hypothesis.feedback is None:
        return decision
    return _less_likely_than_not(decision, named, sorted(names_where("bends_reading")))


def _less_likely_than_not(decision: Decision, limited: Set[str], rivals: Sequence[str] = ()) -> Decision:
    """The decision with some names less likely than not, and what they may stand for as the first rivals."""
    capped = {name: min(p, SWITCH_PROBABILITY) if name in limited else p for name, p in decision.probability.items()}
    if not rivals:
        return replace(decision, probability=capped)
    others = [name for name in (*rivals, *decision.ambiguous) if name not in decision.names]
    return replace(decision, probability=capped, ambiguous=tuple(dict.fromkeys(others))[:MAX_RIVALS])


def decide_partial(search: HeldOutSearch, unknown: Decision, at_stop: bool = False) -> Decision:
    """Name the effects that each reduce the error on held-out samples.

    Parameters
    ----------
    search : HeldOutSearch
    unknown : Decision
        The decision if nothing is named.
    at_stop : bool
        Whether the record shows the output at rest at its extreme.
    """
    probability = {name: partial_probability(evidence) for name, evidence in evidence_by_name(search).items()}
    if not probability:
        return unknown
    if at_stop:
        probability |= {name: max(p, SEEN_STOP) for name, p in probability.items() if name in names_where("stops")}
    rivals = [name for step in search.steps for name, ratio in step.rivals if ratio < RIVAL_FACTOR]
    return replace(
        unknown,
        verdict="partial",
        names=tuple(probability),
        probability=probability,
        ambiguous=tuple(dict.fromkeys(name for name in rivals if name not in probability))[:MAX_RIVALS],
        weights={tuple(sorted(probability)): min(probability.values())},
    )


class PartialEvidence(NamedTuple):
    """Evidence for an effect that explains a part of the gap.

    Attributes
    ----------
    alone : float
        Logarithm of the rms error of the simulation before over that with this effect alone, on held-out samples; at
        most `MAX_REDUCTION`. Curves that imitate an effect outside the table pay together, but little alone.
    lead : float
        The same for the best other effect alone over this one alone; between -`MAX_MARGIN` and `MAX_MARGIN`.
    margin : float
        The same for the explanation with the best rival in the place of this effect over the explanation; at most
        `MAX_MARGIN`.
    agreement : float
        1 if the beam search, which ranks by BIC on all samples, found this effect, too; -1 if it found others, 0 if it
        found none.
    others : float
        Number of other effects, without those of a set that is tried together.
    together : float
        1 if the effect belongs to such a set, all of whose effects are in the explanation, else 0. `alone` and `lead`
        are then those of the set: its effects belong to one kind of rig, and each alone explains little.
    missed : float
        Logarithm of the rms error of the explanation without this effect over that with it; at most `MAX_REDUCTION`.
    smooth : float
        1 if the law of the effect is a smooth curve, which imitates any other smooth law, else 0; 0 in a set that is
        tried together, whose kind of rig has that law.
    """

    alone: float
    lead: float
    margin: float
    agreement: float
    others: float
    together: float = 0.0
    missed: float = 0.0
    smooth: float = 0.0


PARTIAL_PRIOR = -3.4
"""The same of the effects of a partial explanation; measured: one of 36 rigs whose effect is outside the table gets a
name above 0.5, and nine with the fitted -2.6."""
PARTIAL_WEIGHTS = PartialEvidence(
    alone=1.2, lead=0.4, margin=1.2, agreement=1.2, others=-0.1, together=1.9, missed=2.0, smooth=-1.8
)
"""Weights of that function; fitted: to 180 named effects of `dev` records by the regression of
`labsid.blind.calibration`, but for `others` and `together` (README)."""


def evidence_by_name(search: HeldOutSearch) -> dict[str, PartialEvidence]:
    """Evidence for each effect of a partial explanation, parameters of a given simulation first."""
    steps, mismatch = search.steps, search.mismatch
    found = {}
    if mismatch is not None:  # every fit of the beam search has free parameters
        gain = _gain(mismatch)
        found[MISMATCH] = PartialEvidence(gain, 0.0, 0.0, agreement=1.0, others=float(len(steps)), missed=gain)
    others = len(steps) - 1.0 + len(found)
    for step in steps:
        margin = min((float(np.log(ratio)) for _, ratio in step.rivals), default=MAX_MARGIN)
        lead = float(np.clip(np.log(max(step.lead, 1e-6)), -MAX_MARGIN, MAX_MARGIN))
        alone = 0.0 if step.alone is None else _gain(step.alone)
        if step.together is not None:
            lead = float(np.clip(lead + _gain(step.together) - alone, -MAX_MARGIN, MAX_MARGIN))
            alone = _gain(step.together)
        beside = others - len(step.mates)
        agreement, together = float(step.agreement), float(step.together is not None)
        missed = float(np.clip(-np.log(max(step.missed, 1e-6)), 0.0, MAX_REDUCTION))
        smooth, margin = float(_is_smooth(step)), min(margin, MAX_MARGIN)
        found[step.name] = PartialEvidence(alone, lead, margin, agreement, beside, together, missed, smooth)
    return found


def _is_smooth(step: Step) -> bool:
    """Whether the law of an effect, as fitted, is a smooth curve that no set of its kind of rig supports."""
    forms = [effect for effect in step.fit.hypothesis.effects if effect.name == step.name]
    given = step.together is not None or any(form.has_corner for form in forms)
    return step.name in names_where("smooth_law") and not given


def _gain(reduction: Reduction) -> float:
    return float(np.clip(-np.log(max(reduction.factor, 1e-6)), 0.0, MAX_REDUCTION))


def partial_probability(evidence: PartialEvidence) -> float:
    """Probability that an effect acts that is found beside others; fitted by `labsid.blind.calibration`."""
    return _logistic(PARTIAL_PRIOR + _weighted(PARTIAL_WEIGHTS, evidence))


def _logistic(score: float) -> float:
    return float(1.0 / (1.0 + np.exp(-score)))


def _weights(explanation: Explanation, level: int) -> dict[tuple[str, ...], float]:
    """Probabilities of the combinations of `level` effects, from their BIC."""
    fits = explanation.levels[level]
    best = explanation.best.bic
    raw = {names: float(np.exp(-max(fit.bic - best, 0.0) / (2.0 * TEMPERATURE))) for names, fit in fits.items()}
    total = sum(raw.values())
    return {names: weight / total for names, weight in raw.items()}


def evidence_in(
    explanation: Explanation,
    left: ResidualMeasures,
    closed: float | None = None,
    predictable: float = 0.0,
    unrepeated: float = 0.0,
) -> Evidence:
    """Evidence for and against the accepted explanation, possibly no effect.

    The right explanation leaves white noise, or sensor noise that is correlated over a few samples and independent of
    the input. Effects that imitate an unknown cause leave a slow residual, or one that repeats with the input.

    Parameters
    ----------
    explanation : Explanation
    left : ResidualMeasures
        Of the accepted fit.
    closed : float, optional
        Share of the gap closed on held-out samples.
    predictable : float
        Share of the residual that black boxes predict from past inputs, if it is taken for coloured noise.
    unrepeated : float
        If the gap is mainly in levels that do not repeat at the same input: the share of it that the explanation leaves
        open, else 0.
    """
    path = explanation.path
    steps = len(path) - 1
    before, after = (mean_square(explanation.data, fit) for fit in (path[0], path[-1]))
    reduction = float(np.clip(0.5 * np.log(before / max(after, 1e-300)), 0.0, MAX_FIT_REDUCTION))
    evidence = Evidence(several=float(max(steps - 1, 0)), reduction=reduction)
    if "output-quantization" in explanation.unsimulated:
        return evidence  # rounding repeats with the input, and jumps
    colour = float(np.log(max(left.colour, 1.0)))
    if not steps:
        colour *= 0.5 * max(left.slow, 0.0)
    quiet = is_noise(left, converted=False) and left.activity_z < 3.0
    quiet &= steps > 0 or predictable < CHANCE_BLACK_BOX
    colour *= 0.4 if quiet else 1.0  # noise that is independent of the input
    coloured = quiet and (not steps or "coloured-noise" in explanation.unsimulated)
    beyond = predictable if steps and predictable > CHANCE_BLACK_BOX else 0.0
    predicted = left.explained if not quiet or left.explained > CHANCE_PREDICTION else 0.0
    return evidence._replace(
        colour=colour,
        repeats=float(np.sqrt(max(left.repeats if left.repeats_z > 2.0 else 0.0, predicted, beyond, 0.0))),
        activity=float(np.sqrt(max(left.activity, 0.0))) if left.activity_z > 3.0 else 0.0,
        tails=float(np.log(max(left.tails, 3.0) / 3.0)),
        short=_shortfall(explanation, closed),
        coloured=float(coloured and steps > 0),
        unrepeated=float(unrepeated > MAX_UNREPEATED and not coloured),
        dependent=float(steps > 0 and left.input_p < CHANCE_DEPENDENCE),
    )


def confidence_in(evidence: Evidence) -> float:
    """Probability that an explanation is right; its constants are fitted by `labsid.blind.calibration`."""
    return _logistic(PRIOR + _weighted(WEIGHTS, evidence))


def _weighted(weights: Iterable[float], evidence: Iterable[float]) -> float:
    return sum(weight * value for weight, value in zip(weights, evidence, strict=True))


def _shortfall(explanation: Explanation, closed: float | None) -> float:
    """Share of the gap left open beyond chance; zero with coloured noise, whose floor is unknown."""
    if closed is None or len(explanation.path) == 1 or "coloured-noise" in explanation.unsimulated:
        return 0.0
    return float(np.clip(1.0 - closed - CHANCE_SHORTFALL, 0.0, 1.0))


def closed_on_fit(explanation: Explanation, left: ResidualMeasures, added: tuple[str, ...]) -> float:
    """Share of the gap closed on the fitted samples; the structured part of the residual counts as open."""
    path = explanation.path
    before = mean_square(explanation.data, path[0])
    after, white = left.rms**2, path[-1].noise.sigma2
    noise = is_noise(left, "output-quantization" in added)
    coloured = after - white if not noise or (left.slow > SLOW_CORRELATION and "coloured-noise" not in added) else 0.0
    structure = max(max(left.explained, left.repeats) * after if not noise else 0.0, coloured)
    gap = max(before - (after - structure), 1e-300)
    return 1.0 - float(np.sqrt(min(max(structure, 0.0) / gap, 1.0)))


def mismatch_probability(given: Fit, free: Fit) -> float:
    """Probability that the parameters of the given simulation are wrong."""
    return _logistic(max(given.bic - free.bic, 0.0) / (2.0 * TEMPERATURE))
