"""Explain a verdict: each gate with its value and threshold, and the best combinations that were not taken.

Nothing is decided here. Values are those of the decision, or computed again by the same functions; thresholds are read
from the modules that decide by them.
"""

from collections.abc import Iterator

import numpy as np

from labsid._texts import joined
from labsid.gap.effects.inside import MISMATCH
from labsid.gap.fits import unstable_poles
from labsid.gap.verdict import decision, held_out_errors, novelty, scores
from labsid.gap.verdict.answer import Answer
from labsid.gap.verdict.decision import Evidence, PartialEvidence
from labsid.gap.verdict.gates import Gate, NotTaken, Probability, Stage, Threshold, Why, threshold_of
from labsid.gap.verdict.gates_of_search import explain_search
from labsid.gap.verdict.held_out_search import HeldOutSearch, Judgement

SHOWN = 6  # combinations that were not taken on held-out samples; set by hand


def explain_verdict(answer: Answer) -> Why:
    """State each gate of a verdict, and why the best other combinations were not taken.

    Parameters
    ----------
    answer : Answer
    """
    steps = answer.steps
    stages = [explain_search(answer), _whole_truth(answer)]
    if steps.elsewhere is not None:
        stages.append(_elsewhere(answer))
    if steps.search is not None:
        stages.append(_on_held_out_samples(answer, steps.search))
    stages += _limits_of_claims(answer)
    return Why(answer.decision.verdict, answer.decision.names, tuple(stages))


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
                Threshold(1.0, "verdict/answer._whole"),
                "If it fails, the effects of the search are discarded, and no effect is examined as the whole truth.",
            )
        )
        if answer.linear is not None:
            gates.append(
                Gate(
                    "rms error without effects over the noise",
                    steps.whole.before / max(steps.whole.floor, 1e-300),
                    "<=",
                    threshold_of(scores, "NO_GAP_RMS"),
                    "If it fails, a gap is left without an explanation: the next probability is set to 0.",
                )
            )
    sure = Gate(
        "probability that nothing else acts",
        complete.confidence,
        ">=",
        threshold_of(decision, "MIN_CONFIDENCE"),
        "If it passes, the verdict is `effect`, or `none` without effects; if it fails, `partial` or `unknown`.",
    )
    gates.append(sure)
    if answer.corrected is not None:
        gates.append(
            Gate(
                "correction of the unstable rig over the response to the input",
                answer.corrected,
                "<=",
                threshold_of(unstable_poles, "MOST_CORRECTED"),
                "If it fails, `effect` becomes `partial`: beside such a correction no cause explains everything.",
            )
        )
    effects = f"With {joined(complete.names)}" if complete.names else "Without effects"
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
    return Probability(of, value, threshold_of(decision, prior), f"verdict/decision.{name}", terms)


def _elsewhere(answer: Answer) -> Stage:
    """Whether the holdout shows a gap, where the record shows none."""
    found = answer.steps.elsewhere
    assert found is not None
    certain = found.limit > scores.NO_GAP_RMS**2 * found.noise
    limit = float(np.sqrt(found.limit / max(found.noise, 1e-300)))
    name = "CERTAIN" if certain else "NO_GAP_RMS"
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
        result = f"{joined(named.names)} {verb}: the verdict is `partial`."
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
    what = f"{judged.weakest} beside {joined(beside)}" if beside else judged.weakest
    alternative = " alone; its set pays together" if judged.kept and not judged.reduction.pays else ""
    yield Gate(
        f"rms error with {what} over that without",
        judged.reduction.factor,
        "<",
        threshold_of(held_out_errors, "MAX_FACTOR"),
        "If it fails, the effect is too small to be named." if not beside else "The effect that is missed least.",
    )
    yield Gate(
        f"t of the reduction by {judged.weakest}",
        judged.reduction.t,
        ">",
        threshold_of(held_out_errors, "MIN_T"),
        f"If it fails, the reduction may be chance{alternative}.",
    )


def _not_taken_on_held_out(search: HeldOutSearch, chosen: tuple[str, ...]) -> Iterator[NotTaken]:
    """The combinations of least error on held-out samples that were not taken."""
    ranked = sorted((total, names) for names, total in search.totals.items() if names != chosen)
    least = search.totals[chosen] if chosen else 1.0
    for total, names in ranked[:SHOWN]:
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
    gates = []
    for name, evidence in answer.evidence.items():
        computed = decision.partial_probability(evidence)
        if named.probability.get(name, computed) > computed:
            gates.append(
                Gate(
                    f"probability of {name}, by its evidence",
                    computed,
                    ">=",
                    threshold_of(decision, "SEEN_STOP"),
                    "The record shows the output at rest at its extreme: the probability is raised to the threshold.",
                )
            )
    steps = decision.limit_claims(named, answer.explanation, answer.steps.regulated, answer.score.ci95)
    before = [named, *(after for _, after in steps)]
    switch = threshold_of(decision, "SWITCH_PROBABILITY")
    outside = (
        "No simulated rig on which probabilities were measured (verdict/novelty.RANGES) is like this record in "
        f"{joined(answer.novelty.beyond)}."
    )
    rules = [
        *((was, now, switch, reason) for was, (reason, now) in zip(before, steps, strict=False)),
        (before[-1], last, threshold_of(novelty, "OUTSIDE"), outside),
    ]
    for was, now, limit, meaning in rules:
        for name, p in was.probability.items():
            if name not in now.probability:
                gates.append(Gate(f"probability of {name}", p, "<=", limit, f"{meaning} It is not named."))
            elif now.probability[name] < p and name in last.names:
                gates.append(
                    Gate(f"probability of {name}", p, "<=", limit, f"{meaning} It is lowered to the threshold.")
                )
    if gates:
        yield Stage("May the probabilities be claimed?", tuple(gates), "The probabilities are limited accordingly.")
