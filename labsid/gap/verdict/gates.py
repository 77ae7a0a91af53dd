"""Explain a verdict: each gate with its value and threshold, and the best combinations that were not taken.

Nothing is decided here. Values are those of the decision, or computed again by the same functions; thresholds are read
from the modules that decide by them.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from operator import attrgetter
from types import ModuleType

import numpy as np

from labsid.gap.effects.inside import MISMATCH
from labsid.gap.fits import profile, unstable_poles
from labsid.gap.fits.fitting import Fit, mean_square, rms
from labsid.gap.fits.log_rounding import log_rounding_error
from labsid.gap.fits.profile import has_size
from labsid.gap.search import beam_search, explanation
from labsid.gap.search.explanation import Explanation, is_rounding_of_log
from labsid.gap.search.sets import SETS
from labsid.gap.verdict import answer as answers
from labsid.gap.verdict import decision, held_out_errors, novelty, scores
from labsid.gap.verdict.answer import Answer
from labsid.gap.verdict.decision import Evidence, PartialEvidence
from labsid.gap.verdict.held_out_search import HeldOutSearch, Judgement

SHOWN = 3  # combinations of each size that were not taken on all samples
SHOWN_HELD_OUT = 6  # and on held-out samples


@dataclass(frozen=True, slots=True)
class Threshold:
    """A constant that decides.

    Attributes
    ----------
    value : float
    place : str
        Module within `labsid/gap`, and name: ``verdict/decision.MIN_CONFIDENCE``.
    """

    value: float
    place: str


@dataclass(frozen=True, slots=True)
class Gate:
    """One condition of the verdict.

    Attributes
    ----------
    name : str
        What is compared.
    value : float
    relation : str
        What passes: ``">"``, ``">="``, ``"<"`` or ``"<="`` the threshold.
    threshold : Threshold
    meaning : str
        What follows from its result.
    """

    name: str
    value: float
    relation: str
    threshold: Threshold
    meaning: str

    @property
    def passed(self) -> bool:
        """Whether the value satisfies the condition."""
        limit = self.threshold.value
        passes = {
            ">": self.value > limit,
            ">=": self.value >= limit,
            "<": self.value < limit,
            "<=": self.value <= limit,
        }
        return passes[self.relation]


@dataclass(frozen=True, slots=True)
class Probability:
    """A probability as the logistic function of a sum of evidence times weight.

    Attributes
    ----------
    of : str
        Name of the effect, or ``""`` for the explanation as a whole.
    value : float
        By this evidence alone; a gate says where a rule replaces it.
    prior : Threshold
        Constant of the sum.
    weights : str
        Place of the weights.
    terms : tuple of (str, float, float)
        Measure of evidence, its value, and its weight.
    """

    of: str
    value: float
    prior: Threshold
    weights: str
    terms: tuple[tuple[str, float, float], ...]

    @property
    def total(self) -> float:
        """The sum."""
        return self.prior.value + sum(value * weight for _, value, weight in self.terms)


@dataclass(frozen=True, slots=True)
class NotTaken:
    """A combination of effects that was tried and not taken.

    Attributes
    ----------
    names : tuple of str
    figures : tuple of float
        As the columns of its stage say; nan if not computed.
    reason : str
    """

    names: tuple[str, ...]
    figures: tuple[float, ...]
    reason: str


@dataclass(frozen=True, slots=True)
class Stage:
    """One question of the decision, with what answers it.

    Attributes
    ----------
    question : str
    gates : tuple of Gate
    result : str
        The answer.
    probabilities : tuple of Probability
    columns : tuple of str
        Titles of the figures of `not_taken`.
    not_taken : tuple of NotTaken
        Best first.
    """

    question: str
    gates: tuple[Gate, ...]
    result: str
    probabilities: tuple[Probability, ...] = ()
    columns: tuple[str, ...] = ()
    not_taken: tuple[NotTaken, ...] = ()


@dataclass(frozen=True, slots=True)
class Why:
    """Why a verdict is what it is.

    Attributes
    ----------
    verdict : str
    names : tuple of str
        The effects that are named.
    stages : tuple of Stage
        In the order in which they were decided.
    """

    verdict: str
    names: tuple[str, ...]
    stages: tuple[Stage, ...]


def explain_verdict(answer: Answer) -> Why:
    """State each gate of a verdict, and why the best other combinations were not taken.

    Parameters
    ----------
    answer : Answer
    """
    steps = answer.steps
    stages = [_on_all_samples(answer), _whole_truth(answer)]
    if steps.elsewhere is not None:
        stages.append(_elsewhere(answer))
    if steps.search is not None:
        stages.append(_on_held_out_samples(answer, steps.search))
    stages += _limits_of_claims(answer)
    return Why(answer.decision.verdict, answer.decision.names, tuple(stages))


def _threshold(module: ModuleType, name: str, place: int | None = None) -> Threshold:
    """A constant of a module of `labsid.gap`, or one of a tuple of them."""
    value = getattr(module, name)
    where = module.__name__.removeprefix("labsid.gap.").replace(".", "/")
    index = "" if place is None else f"[{place}]"
    return Threshold(float(value if place is None else value[place]), f"{where}.{name}{index}")


# The search on all samples --------------------------------------------------------------------------------


def _on_all_samples(answer: Answer) -> Stage:
    """Which effects the beam search accepted, by BIC on all samples."""
    found = answer.steps.searched
    gates = [*_mismatch_gates(answer), *_step_gates(found)]
    if len(found.path) > 1:
        result = f"The search accepts {joined_names(found.best.hypothesis.names)}."
    else:
        result = "The search accepts no simulated effect."
    if found.unsimulated:
        result += f" The samples themselves show {joined_names(found.unsimulated)}."
    return Stage(
        "Which effects does the BIC accept, on all samples?",
        tuple(gates),
        result,
        columns=("BIC gain", "change", "error"),
        not_taken=tuple(_not_taken_by_bic(found, set(answer.decision.names))),
    )


def _mismatch_gates(answer: Answer) -> Iterator[Gate]:
    """What other values of the parameters of a given simulation gain."""
    if answer.linear is None and len(answer.steps.searched.path) == 1:
        free = answer.steps.searched.path[0]
        yield Gate(
            "BIC gain of other values of the simulation's parameters",
            answer.before.bic - free.bic,
            ">",
            _threshold(beam_search, "BIC_MARGIN"),
            f"If it passes, the parameters are wrong ({MISMATCH}).",
        )


def _step_gates(found: Explanation) -> Iterator[Gate]:
    """The gates of the accepted explanation; without one, of the effect of lowest BIC."""
    path, data = found.path, found.data
    if len(path) > 1:
        simpler, fit, names = path[0], path[-1], joined_names(path[-1].hypothesis.names)
        meaning = f"Over no effect. If it passes, {names} may be added."
    elif len(found.levels) > 1 and found.levels[1]:
        simpler = path[0]
        fit = min(found.levels[1].values(), key=attrgetter("bic"))
        names = joined_names(fit.hypothesis.names)
        meaning = f"Over no effect, of the best one: {names}. If it passes, it may be added."
    else:
        return
    yield Gate("BIC gain", simpler.bic - fit.bic, ">", _threshold(beam_search, "BIC_MARGIN"), meaning)
    last = len(path) - 1
    in_a_set = last > 1 and set(fit.hypothesis.names) <= set().union(*(one.names for one in SETS))
    if last < 1 or in_a_set:
        limit = _threshold(beam_search, "MIN_CHANGE")
    else:
        simpler = path[-2]
        limit = _threshold(explanation, "MIN_NAMED_CHANGE", min(last, len(explanation.MIN_NAMED_CHANGE)) - 1)
    yield Gate(
        "change of the output over the rms residual",
        _change(found, simpler, fit),
        ">",
        limit,
        "If it fails, noise hides the effect, and it is not named.",
    )
    if is_rounding_of_log(data, path[0], fit):
        yield Gate(
            "mean square error before, over that of the log's rounding and noise",
            mean_square(data, path[0]) / (log_rounding_error(data, path[0]) + fit.noise.sigma2),
            ">",
            Threshold(1.0, "search/explanation.is_rounding_of_log"),
            "If it fails, the rounding of the logged input leaves the error, and there is no gap.",
        )


def _change(found: Explanation, simpler: Fit, fit: Fit) -> float:
    """The rms difference of two outputs over the rms residual of the second."""
    return beam_search.rms_difference(found.data, simpler, fit) / max(rms(found.data, fit), beam_search.ROUNDING_ERROR)


def _not_taken_by_bic(found: Explanation, named: set[str]) -> Iterator[NotTaken]:
    """The combinations of lowest BIC of each size that were not taken, up to one effect more than accepted.

    Those of effects that the verdict names are also shown, whatever their BIC.
    """
    path = found.path
    for size in range(1, min(len(path) + 1, len(found.levels))):
        taken = set(path[size].hypothesis.names) if size < len(path) else None
        simpler = path[min(size, len(path)) - 1]
        ranked = sorted(found.levels[size].items(), key=lambda item: item[1].bic)
        others = [item for item in ranked if set(item[0]) != taken]
        for names, fit in [*others[:SHOWN], *(item for item in others[SHOWN:] if set(item[0]) <= named)]:
            error = rms(found.data, fit) / max(rms(found.data, simpler), beam_search.ROUNDING_ERROR)
            figures = simpler.bic - fit.bic, _change(found, simpler, fit), error
            yield NotTaken(names, figures, _reason_of_bic(found, simpler, fit, size))


def _reason_of_bic(found: Explanation, simpler: Fit, fit: Fit, size: int) -> str:
    """The first gate that stopped a combination."""
    data, path = found.data, found.path
    gain, change = simpler.bic - fit.bic, _change(found, simpler, fit)
    accepted = path[size] if size < len(path) else None
    if beam_search.within_rounding(data, simpler):
        return "the residual without it is the rounding of the converter"
    if gain < 0.0:
        return "its BIC is worse than without it"
    if gain <= beam_search.BIC_MARGIN:
        return f"it gains too little BIC ({beam_search.BIC_MARGIN:g} needed)"
    if not beam_search.differ(data, simpler, fit, beam_search.MIN_CHANGE):
        return f"it changes the output too little ({beam_search.MIN_CHANGE:g} needed)"
    if accepted is not None and fit.bic > accepted.bic:
        return f"{joined_names(accepted.hypothesis.names)} has the lower BIC, by {fit.bic - accepted.bic:,.0f}"
    if not has_size(data, fit):
        return f"without its size the fit is worse by less than profile.MIN_SIZE_LOSS = {profile.MIN_SIZE_LOSS:g}"
    least = explanation.MIN_NAMED_CHANGE[min(size, len(explanation.MIN_NAMED_CHANGE)) - 1]
    if change <= least:
        return f"it is too small to be named (change of {least:g} needed)"
    if beam_search.residual_is_white(data, path[-1]):
        return "the accepted explanation leaves white noise: the search ended"
    if len(path) == 1 and explanation.is_nuisance(data, found.levels[1], (path[0], fit)):
        return f"it is small (change of {explanation.MIN_UNRIVALLED_CHANGE:g} needed) and others fit as well"
    if is_rounding_of_log(data, path[0], fit):
        return "the rounding of the logged input leaves as large an error"
    return "pruned: its last effect is small, redundant, or does not reduce the error on blocks left out"


# The explanation as a whole -------------------------------------------------------------------------------


def _whole_truth(answer: Answer) -> Stage:
    """Whether the explanation of the search leaves nothing but noise."""
    steps, complete = answer.steps, answer.complete
    gates = []
    if steps.discarded is not None:
        gates.append(
            Gate(
                "rms error on held-out samples with the effects over that without",
                steps.discarded.after / max(steps.discarded.before, 1e-300),
                "<",
                Threshold(1.0, "verdict/answer._complete"),
                "If it fails, the effects of the search are discarded, and no effect is examined as the whole truth.",
            )
        )
        if answer.linear is not None:
            gates.append(
                Gate(
                    "rms error without effects over the noise",
                    steps.whole.before / max(steps.whole.floor, 1e-300),
                    "<=",
                    _threshold(answers, "NO_GAP"),
                    "If it fails, a gap is left without an explanation: the next probability is set to 0.",
                )
            )
    sure = Gate(
        "probability that nothing else acts",
        complete.confidence,
        ">=",
        _threshold(decision, "MIN_CONFIDENCE"),
        "If it passes, the verdict is `effect`, or `none` without effects; if it fails, `partial` or `unknown`.",
    )
    gates.append(sure)
    if answer.corrected is not None:
        gates.append(
            Gate(
                "correction of the unstable rig over the response to the input",
                answer.corrected,
                "<=",
                _threshold(unstable_poles, "MOST_CORRECTED"),
                "If it fails, `effect` becomes `partial`: beside such a correction no cause explains everything.",
            )
        )
    effects = f"With {joined_names(complete.names)}" if complete.names else "Without effects"
    rest = "nothing but noise" if sure.passed else "more than noise"
    return Stage(
        "Does the explanation leave nothing but noise?",
        tuple(gates),
        f"{effects}, {rest} is left.",
        (_whole_probability(answer),),
    )


def _whole_probability(answer: Answer) -> Probability:
    evidence = answer.complete.evidence
    return _probability("", evidence, decision.WEIGHTS, "PRIOR", "WEIGHTS", decision.confidence_in(evidence))


def _probability(
    of: str,
    evidence: Evidence | PartialEvidence,
    weights: Evidence | PartialEvidence,
    prior: str,
    name: str,
    value: float,
) -> Probability:
    terms = tuple(
        (measure, float(one), float(weight))
        for measure, one, weight in zip(evidence._fields, evidence, weights, strict=True)
    )
    return Probability(of, value, _threshold(decision, prior), f"verdict/decision.{name}", terms)


def _elsewhere(answer: Answer) -> Stage:
    """Whether the holdout shows a gap, where the record shows none."""
    found = answer.steps.elsewhere
    assert found is not None
    certain = found.limit > scores.NO_GAP_ELSEWHERE**2 * found.noise
    limit = float(np.sqrt(found.limit / max(found.noise, 1e-300)))
    name = "CERTAIN" if certain else "NO_GAP_ELSEWHERE"
    gate = Gate(
        "rms error on the holdout over the noise",
        float(np.sqrt(found.error / max(found.noise, 1e-300))),
        "<=",
        Threshold(limit, f"verdict/scores.{name}"),
        "If it fails, the gap is on the holdout, and the verdict is `partial` or `unknown`."
        + (f" The limit is {scores.CERTAIN:g} standard errors of the noise." if certain else ""),
    )
    result = "The holdout shows no gap." if gate.passed else "The holdout shows a gap that the record does not show."
    return Stage("Does the holdout show a gap?", (gate,), result)


# The search on held-out samples ---------------------------------------------------------------------------


def _on_held_out_samples(answer: Answer, search: HeldOutSearch) -> Stage:
    """Which effects pay on held-out samples."""
    chosen = () if not search.steps else tuple(sorted(search.steps[-1].fit.hypothesis.names))
    named = answer.steps.named
    gates = [] if (MISMATCH,) not in search.judged else list(_paying_gates((MISMATCH,), search.judged[MISMATCH,]))
    example = chosen or min(
        (names for names in search.judged if names != (MISMATCH,)), key=search.totals.__getitem__, default=()
    )
    if example in search.judged:
        gates += _paying_gates(example, search.judged[example])
    if named.verdict == "partial":
        verb = "pays" if len(named.names) == 1 else "each pay"
        result = f"{joined_names(named.names)} {verb}: the verdict is `partial`."
    else:
        result = "No effect pays: the verdict is `unknown`."
    return Stage(
        "Which effects reduce the error on samples that no fit has seen?",
        tuple(gates),
        result,
        tuple(_partial_probability(name, one) for name, one in answer.evidence.items()),
        ("error", "t"),
        tuple(_not_taken_on_held_out(search, chosen)),
    )


def _paying_gates(names: tuple[str, ...], judged: Judgement) -> Iterator[Gate]:
    """Whether the effect of a combination that is missed least pays."""
    beside = [name for name in names if name != judged.weakest]
    what = f"{judged.weakest} beside {joined_names(beside)}" if beside else judged.weakest
    alternative = " alone; its set pays together" if judged.kept and not judged.reduction.pays else ""
    yield Gate(
        f"rms error with {what} over that without",
        judged.reduction.factor,
        "<",
        _threshold(held_out_errors, "MAX_FACTOR"),
        "If it fails, the effect is too small to be named." if not beside else "The effect that is missed least.",
    )
    yield Gate(
        f"t of the reduction by {judged.weakest}",
        judged.reduction.t,
        ">",
        _threshold(held_out_errors, "MIN_T"),
        f"If it fails, the reduction may be chance{alternative}.",
    )


def _not_taken_on_held_out(search: HeldOutSearch, chosen: tuple[str, ...]) -> Iterator[NotTaken]:
    """The combinations of least error on held-out samples that were not taken."""
    ranked = sorted((total, names) for names, total in search.totals.items() if names != chosen)
    least = search.totals[chosen] if chosen else 1.0
    for total, names in ranked[:SHOWN_HELD_OUT]:
        judged = search.judged.get(names)
        t = np.nan if judged is None else judged.reduction.t
        yield NotTaken(
            names, (float(np.sqrt(total)), t), _reason_on_held_out(names, judged, total, least, bool(chosen))
        )


def _reason_on_held_out(
    names: tuple[str, ...], judged: Judgement | None, total: float, least: float, any_chosen: bool
) -> str:
    if judged is not None and not judged.kept:
        gates = _paying_gates(names, judged)
        failed = [
            f"{what} {gate.value:.3g}, {gate.relation} {gate.threshold.value:g} needed"
            for what, gate in zip(("error over that without", "t"), gates, strict=True)
            if not gate.passed
        ]
        return f"{judged.weakest} does not pay in it ({'; '.join(failed)})"
    if total >= least:
        return "larger error than " + ("the named effects" if any_chosen else "without effects")
    return "not among the combinations of least error when effects were compared"


def _partial_probability(name: str, evidence: PartialEvidence) -> Probability:
    weights, value = decision.PARTIAL_WEIGHTS, decision.partial_probability(evidence)
    return _probability(name, evidence, weights, "PARTIAL_PRIOR", "PARTIAL_WEIGHTS", value)


# Limits of what may be claimed ----------------------------------------------------------------------------


def _limits_of_claims(answer: Answer) -> Iterator[Stage]:
    """The rules that raised or lowered a probability."""
    named, last = answer.steps.named, answer.decision
    data, best = answer.explanation.data, answer.explanation.best
    gates = []
    for name, evidence in answer.evidence.items():
        computed = decision.partial_probability(evidence)
        if named.probability.get(name, computed) > computed:
            gates.append(
                Gate(
                    f"probability of {name}, by its evidence",
                    computed,
                    ">=",
                    _threshold(decision, "SEEN_STOP"),
                    "The record shows the output at rest at its extreme: the probability is raised to the threshold.",
                )
            )
    at_switch = decision.without_curve_of_switch(named, data, best)
    at_spring = decision.without_stand_ins(at_switch, best)
    switch = _threshold(decision, "SWITCH_PROBABILITY")
    rules = (
        (named, at_switch, switch, "The fitted actuator only switches, which does not show the shape of a limit."),
        (at_switch, at_spring, switch, "The rig is unstable: the spring may stand for a curve of the sensor."),
        (
            at_spring,
            last,
            _threshold(novelty, "OUTSIDE"),
            "No simulated rig on which probabilities were measured (verdict/novelty.RANGES) is like this record in "
            f"{joined_names(answer.novelty.beyond)}.",
        ),
    )
    for before, after, limit, meaning in rules:
        for name, p in before.probability.items():
            if after.probability[name] < p and name in last.names:
                gates.append(
                    Gate(f"probability of {name}", p, "<=", limit, f"{meaning} It is lowered to the threshold.")
                )
    if gates:
        yield Stage("May the probabilities be claimed?", tuple(gates), "The probabilities are limited accordingly.")


def joined_names(names: tuple[str, ...] | list[str]) -> str:
    """``a, b and c``."""
    return " and ".join(filter(None, (", ".join(names[:-1]), names[-1]))) if names else ""
