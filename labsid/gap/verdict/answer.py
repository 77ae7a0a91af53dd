"""From the fits of a record to the answer: the simulation before, the verdict, and the effects that improve it."""

from dataclasses import dataclass, replace

import numpy as np

from labsid._arrays import FloatArray
from labsid.gap.dynamics.record_start import RecordStart
from labsid.gap.effects.base import AdditiveEffect
from labsid.gap.effects.further_inputs import FurtherInput, SameEntry
from labsid.gap.effects.output_feedback import OutputFeedback
from labsid.gap.fits.fitting import Fit
from labsid.gap.fits.noise_model import noise_of
from labsid.gap.fits.residual_tests import ResidualMeasures, measure_residual
from labsid.gap.fits.unstable_poles import MOST_CORRECTED, corrected_share
from labsid.gap.record.data import Data
from labsid.gap.record.record_findings import plateau_gap
from labsid.gap.search.beam_search import Progress, residual_is_white
from labsid.gap.search.explanation import Explanation, is_rounding_of_log
from labsid.gap.simulations.baseline import Baseline, check_bounded
from labsid.gap.verdict.baseline_choice import OUTPUT_ERROR, LinearModel, choose_linear_model
from labsid.gap.verdict.black_boxes import RemainingError, kinds_of_error, predictable_share
from labsid.gap.verdict.decision import (
    MIN_CONFIDENCE,
    Decision,
    Evidence,
    PartialEvidence,
    confidence_in,
    decide,
    decide_partial,
    evidence_by_name,
    evidence_in,
    limit_claims,
)
from labsid.gap.verdict.held_out_errors import HeldOut, hold_out
from labsid.gap.verdict.held_out_search import HeldOutSearch, search_held_out
from labsid.gap.verdict.novelty import Novelty, measure_novelty
from labsid.gap.verdict.scores import (
    NO_GAP_RMS,
    ErrorElsewhere,
    GapScore,
    closed_share,
    error_elsewhere,
    score_fits,
)
from labsid.lab.findings import about_clipping
from labsid.records.record import Record

COLOURED = 2.0  # samples: correlation time of a residual with more than the colour of a sensor; set by hand
MOSTLY = 0.5  # of the mean square error on a holdout: a larger offset is most of the gap; definition


@dataclass(frozen=True, slots=True)
class Complete:
    """The explanation that the beam search accepted, whether or not the verdict names it.

    Attributes
    ----------
    names : tuple of str
        Its effects.
    confidence : float
        Probability that nothing else acts.
    evidence : Evidence
        From which it is computed.
    """

    names: tuple[str, ...]
    confidence: float
    evidence: Evidence


@dataclass(frozen=True, slots=True, eq=False)
class DecisionSteps:
    """What the verdict was decided from, in this order; `labsid.gap.verdict.why` explains it.

    Attributes
    ----------
    searched : Explanation
        Result of the beam search.
    discarded : GapScore or None
        Its score, if it was discarded because it does not reduce the error on held-out samples.
    whole : GapScore
        Score of the explanation whose confidence was computed: without effects if that of the search was discarded.
    elsewhere : ErrorElsewhere or None
        Error on the holdout, if the record shows no gap.
    search : HeldOutSearch or None
        The effects that pay on held-out samples, if the explanation as a whole was not accepted.
    named : Decision
        Before the limits of what may be claimed.
    regulated : bool
        Whether a controller with a constant reference gives the input.
    """

    searched: Explanation
    discarded: GapScore | None
    whole: GapScore
    elsewhere: ErrorElsewhere | None
    search: HeldOutSearch | None
    named: Decision
    regulated: bool


@dataclass(frozen=True, slots=True, eq=False)
class Answer:
    """The answer to a record.

    Attributes
    ----------
    explanation : Explanation
        Its path holds the simulation before, and one more effect at each step.
    complete : Complete
    decision : Decision
    novelty : Novelty
        How far the record is from those on which the probabilities were measured; they are capped accordingly.
    score : GapScore
    left : ResidualMeasures
        Of the accepted fit.
    remaining : RemainingError or None
        What could reduce the error that is left.
    before : Fit
        The simulation before, on the record.
    linear : LinearModel or None
        How the linear model was chosen; None for a given simulation.
    tried : dict
        By names: mean square error on held-out samples of every combination tried, if that decided.
    evidence : dict
        By name: evidence for each effect of a partial explanation.
    closed : tuple of float or None
        Share of the gap that is closed after each step of the path.
    elsewhere : Fit or None
        The simulation of other records, if it is another one.
    share_left : float
        Share of the gap that is left.
    fits : dict
        By sorted names: the fit of every combination tried.
    start : RecordStart
        Which samples of another record determine its initial state.
    corrected : float or None
        Rms of what the correction of an unstable rig moves the output, over that of what the input moves it.
    steps : DecisionSteps
        What the verdict was decided from.
    on_other : tuple of (Data, Fit, Fit), or None
        If the record shows no gap and the holdout does: the holdout, with the simulations before and after. `remaining`
        and `left` are then those on the holdout.
    """

    explanation: Explanation
    complete: Complete
    decision: Decision
    novelty: Novelty
    score: GapScore
    left: ResidualMeasures
    remaining: RemainingError | None
    before: Fit
    linear: LinearModel | None
    tried: dict[tuple[str, ...], float]
    evidence: dict[str, PartialEvidence]
    closed: tuple[float | None, ...]
    elsewhere: Fit | None
    share_left: float
    fits: dict[tuple[str, ...], Fit]
    start: RecordStart
    corrected: float | None
    steps: DecisionSteps
    on_other: tuple[Data, Fit, Fit] | None = None

    @property
    def only_elsewhere(self) -> bool:
        """Whether the record shows no gap, and the holdout does."""
        return self.on_other is not None

    @property
    def outputs(self) -> tuple[FloatArray, FloatArray]:
        """Outputs before and after on the record, in its unit."""
        return _outputs(self.explanation.data, self.before, self.explanation.best)


@dataclass(frozen=True, slots=True, eq=False)
class _Setting:
    """What all comparisons of a record share: a given simulation, its output on the holdout, and the holdout."""

    record: Record
    base: Baseline
    given: Fit | None
    other: tuple[FloatArray, FloatArray] | None
    given_output: FloatArray | None
    rng: np.random.Generator
    measured: np.ndarray | None
    start: RecordStart
    further: dict[str, FloatArray] | None = None

    @property
    def one_input(self) -> bool:
        """Whether the output has one input, whose levels then tell whether it repeats; it does not in a loop."""
        kinds = FurtherInput | SameEntry | OutputFeedback
        return not any(isinstance(effect, kinds) for effect in self.base.structure.effects)


@dataclass(frozen=True, slots=True, eq=False)
class _Before:
    """The simulation before with its output, and the fit to which effects are added, without the held-out samples."""

    held_out: HeldOut
    start: Fit
    linear: LinearModel | None
    fit: Fit
    output: FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class _Comparison:
    """The simulations before and after, compared on the same held-out samples."""

    explanation: Explanation
    before: _Before
    score: GapScore
    left: ResidualMeasures
    discarded: GapScore | None = None


def answer_from(
    record: Record,
    explanation: Explanation,
    base: Baseline,
    holdout: Record | None,
    rng: np.random.Generator,
    progress: Progress | None = None,
    measured: np.ndarray | None = None,
    further: dict[str, FloatArray] | None = None,
) -> Answer:
    """Decide what causes the gap.

    An explanation of everything but noise is an effect, or none. Otherwise, effects that each reduce the error on
    held-out samples are a partial explanation, and without such effects the cause is unknown. An explanation that does
    not reduce that error is discarded.

    Parameters
    ----------
    record : Record
    explanation : Explanation
        Result of the beam search.
    base : Baseline
    holdout : Record or None
        Another record of the rig.
    rng : Generator
    progress : callable, optional
    measured : ndarray of bool, optional
        Samples of the holdout that have an output; by default all.
    further : dict, optional
        Further inputs of the holdout by name, scaled.
    """
    start = RecordStart(explanation.path[0].slowest_rates, explanation.data.every)  # the same for every fit
    given = None
    if holdout is not None and base.simulate_record is not None:
        given = explanation.data.y_scale.of(check_bounded(base.simulate_record(holdout, start), holdout.y))
    other = None if holdout is None else (holdout.u, holdout.y)
    fitted = None if base.before is None else base.before(explanation.data)
    if explanation.data.pieces and fitted is not None:
        given = fitted.output  # of several records; nothing but their offsets and initial states is fitted
    setting = _Setting(record, base, fitted, other, given, rng, measured, start, further)
    whole = _whole(setting, explanation)
    complete = _complete(setting, whole)
    decision = decide(whole.explanation, whole.left, setting.given, complete.confidence)
    outside = _error_elsewhere(setting, explanation) if decision.verdict == "none" and other is not None else None
    elsewhere = outside is not None and outside.is_gap
    if elsewhere:
        decision = replace(decision, verdict="unknown", ambiguous=())
    elif decision.verdict == "unknown" and is_rounding_of_log(explanation.data, explanation.path[0], explanation.best):
        decision = replace(decision, verdict="none", ambiguous=())
    if decision.verdict == "unknown":
        part, search = _partial(setting, explanation, progress, elsewhere)
        decision = decide_partial(search, decision, bool(about_clipping(record.y)))
        steps = DecisionSteps(explanation, whole.discarded, whole.score, outside, search, decision, base.regulated)
        found = _answer(part, complete, steps)
        return _on_other(found, part) if elsewhere else found
    steps = DecisionSteps(explanation, whole.discarded, whole.score, outside, None, decision, base.regulated)
    if len(whole.explanation.path) == 1:  # no simulated effect was added
        whole = replace(whole, score=replace(whole.score, closed=None, ci95=None))
    return _answer(whole, complete, steps)


def _whole(setting: _Setting, explanation: Explanation) -> _Comparison:
    """The explanation as a whole, compared with the simulation before; without effects if they gain nothing."""
    before, score = _scored(setting, explanation)
    discarded = None
    if len(explanation.path) > 1 and score.after >= score.before and _acts_in_every_record(explanation):
        explanation, discarded = replace(explanation, path=explanation.path[:1]), score
        before, score = _scored(setting, explanation)
    left = measure_residual(explanation.data, explanation.best)
    return _Comparison(explanation, before, score, left, discarded)


def _scored(setting: _Setting, explanation: Explanation) -> tuple[_Before, GapScore]:
    """The simulation before, and the score of the explanation after it."""
    before = _before(setting, explanation, explanation.best.onset)
    unchanged = before.linear is not None and len(explanation.path) == 1
    after = before.fit if unchanged else before.held_out.refit(explanation.best)
    return before, score_fits(before.held_out, before.output, after, setting.rng)


def _complete(setting: _Setting, whole: _Comparison) -> Complete:
    """The probability that nothing else acts; 0 if effects are discarded and a gap is left without them."""
    explanation, score = whole.explanation, whole.score
    outputs = _outputs(explanation.data, setting.given or explanation.path[0], explanation.best)
    rows = explanation.data.rows
    plateau = plateau_gap(setting.record.u, setting.record.y, *outputs, rows) if setting.one_input else None
    unrepeated = plateau.left if plateau is not None and plateau.matters else 0.0
    evidence = evidence_in(explanation, whole.left, score.closed, _predictable(explanation), unrepeated)
    gap = whole.discarded is not None and not setting.base.given and score.before > NO_GAP_RMS * score.floor
    return Complete(explanation.names, 0.0 if gap else confidence_in(evidence), evidence)


def _predictable(explanation: Explanation) -> float:
    """Share that past inputs predict of a residual that is taken for coloured noise, alone or beside effects."""
    alone = len(explanation.path) == 1 and explanation.best.noise.correlation_time > COLOURED
    if not alone and "coloured-noise" not in explanation.unsimulated:
        return 0.0
    return predictable_share(explanation.data, explanation.best)


def _error_elsewhere(setting: _Setting, explanation: Explanation) -> ErrorElsewhere:
    """The error on the holdout, where the record shows no gap."""
    before = _before(setting, explanation, as_fitted=True)
    return error_elsewhere(before.held_out, before.output, explanation.path[0])


def _partial(
    setting: _Setting, explanation: Explanation, progress: Progress | None, as_fitted: bool = False
) -> tuple[_Comparison, HeldOutSearch]:
    """The effects that each reduce the error on held-out samples."""
    before = _before(setting, explanation, as_fitted=as_fitted)
    held_out = before.held_out
    errors = held_out.in_parts(held_out.measured - before.output)
    with setting.base.meter.searching():
        search = search_held_out(held_out, explanation, before.start, errors, before.linear is None, progress)
    first = explanation.path[0] if before.linear is None else before.fit  # a given simulation cannot be exported
    partly = replace(explanation, path=(first, *(step.fit for step in search.steps)))
    after = before.start if before.linear is None and not search.steps else partly.best
    score = score_fits(held_out, before.output, after, setting.rng)
    return _Comparison(partly, before, score, measure_residual(partly.data, partly.best)), search


def _before(
    setting: _Setting, explanation: Explanation, onset: float | None = None, as_fitted: bool = False
) -> _Before:
    """The simulation before. A linear model is that of least error on held-out samples, or `as_fitted` to the record:
    where that leaves only noise, another one is better elsewhere by chance.
    """
    held_out = hold_out(explanation.data, setting.other, onset, setting.measured, setting.start, setting.further)
    start = held_out.refit(explanation.path[0])
    linear = None
    if not setting.base.given:
        alone = len(explanation.path) == 1 and residual_is_white(explanation.data, explanation.best)
        linear = choose_linear_model(held_out, start, alone)
    if as_fitted and linear is not None:
        linear = replace(linear, method=OUTPUT_ERROR, fit=start)
    fit = setting.given or (start if linear is None else linear.fit)
    output = held_out.output(fit) if setting.given_output is None else setting.given_output
    return _Before(held_out, start, linear, fit, output)


def _acts_in_every_record(explanation: Explanation) -> bool:
    """Whether held-out samples must show the effects: a disturbance of one record cannot be predicted there."""
    return not any(isinstance(effect, AdditiveEffect) for effect in explanation.best.hypothesis.found)


def _answer(found: _Comparison, complete: Complete, steps: DecisionSteps) -> Answer:
    explanation, score, search = found.explanation, found.score, steps.search
    novelty = measure_novelty(explanation.data, explanation.path[0])
    _, decision = limit_claims(steps.named, explanation, steps.regulated, score.ci95)[-1]
    corrected = corrected_share(explanation.data, explanation.best)
    if decision.verdict == "effect" and corrected is not None and corrected > MOST_CORRECTED:
        decision = replace(decision, verdict="partial")
    capped = {name: novelty.capped(p) for name, p in decision.probability.items()}
    return Answer(
        explanation=explanation,
        complete=complete,
        decision=replace(decision, probability=capped),
        novelty=novelty,
        score=score,
        left=found.left,
        remaining=None
        if decision.verdict == "none" or (steps.regulated and not decision.names)
        else kinds_of_error(explanation.data, _asserted(found, decision)),
        before=found.before.fit,
        linear=found.before.linear,
        tried={} if search is None else search.tried,
        evidence={} if search is None else evidence_by_name(search),
        elsewhere=_elsewhere(found, decision, search),
        closed=_closed_by_step(found, search),
        share_left=_share_left(decision, search, score),
        fits=dict(item for level in explanation.levels for item in level.items()) if search is None else search.fits,
        start=found.before.held_out.start,
        corrected=corrected,
        steps=steps,
    )


def _share_left(decision: Decision, search: HeldOutSearch | None, score: GapScore) -> float:
    """Share of the gap that is left: on held-out samples, unless the fitted ones show nothing but noise."""
    if decision.verdict == "none" or (search is None and decision.closed == 1.0):
        return 0.0
    if search is None and score.closed is None:
        return 1.0 - decision.closed
    return 1.0 - (score.closed or 0.0)


def _on_other(answer: Answer, found: _Comparison) -> Answer:
    """The answer with what is left on the holdout, as the record has no gap."""
    held_out = found.before.held_out
    data, after = held_out.on_other(found.score.after_fit)
    output = found.before.output
    before = replace(after, output=output, noise=noise_of(data, data.y - output))
    asserted = after if any(p > MIN_CONFIDENCE for p in answer.decision.probability.values()) else before
    e = (data.y - before.output)[data.rows]
    constant = np.mean(e) ** 2 > MOSTLY * np.mean(e**2)  # an offset, which no kind of model is about
    left, remaining = measure_residual(data, after), None if constant else kinds_of_error(data, asserted)
    return replace(answer, on_other=(data, before, after), left=left, remaining=remaining)


def _elsewhere(found: _Comparison, decision: Decision, search: HeldOutSearch | None) -> Fit | None:
    """The simulation of other records: the simulation before, unless all effects of a better one are likely."""
    if search is None or search.elsewhere is None:
        return None
    likely = {name for name, p in decision.probability.items() if p > MIN_CONFIDENCE}
    names = set(search.elsewhere.hypothesis.names)
    plain = found.before.start if found.before.linear is None else found.before.fit
    return search.elsewhere if names and names <= likely else plain


def _asserted(found: _Comparison, decision: Decision) -> Fit:
    """The explanation if at least one effect is more likely than not, else the simulation before."""
    asserted = decision.verdict == "effect" or any(p > MIN_CONFIDENCE for p in decision.probability.values())
    return found.explanation.best if asserted else found.before.fit


def _closed_by_step(found: _Comparison, search: HeldOutSearch | None) -> tuple[float | None, ...]:
    """Share of the gap on the held-out samples that each fit on the path to the accepted one closes."""
    path, score, held_out = found.explanation.path, found.score, found.before.held_out
    if score.closed is None:
        return (None,) * len(path)
    mismatch = None if search is None else search.mismatch
    left = [1.0 if mismatch is None else mismatch.factor**2]
    for number, fit in enumerate(path[1:-1]):
        errors = held_out.errors(held_out.refit(fit)) if search is None else search.steps[number].errors
        left.append(float(np.mean(errors)) / score.before**2)
    closed = [closed_share(score.before**2, share * score.before**2, score.floor**2) for share in left]
    return tuple([*closed, score.closed][-len(path) :])


def _outputs(data: Data, before: Fit, after: Fit) -> tuple[FloatArray, FloatArray]:
    """Outputs of two fits in the unit of the record."""
    back = data.y_scale.back
    return np.asarray(back(before.output)), np.asarray(back(after.output))
