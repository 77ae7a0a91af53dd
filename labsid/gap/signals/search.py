"""The effects at every signal: each output is explained through its inputs, one after the other."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from labsid._arrays import FloatArray
from labsid.estimation.subspace import fit_subspace
from labsid.gap.effects.base import InputEffect
from labsid.gap.effects.families import names_where
from labsid.gap.fits.fitting import Fit, fit_from, mean_square
from labsid.gap.fits.linear_fits import fit_baseline
from labsid.gap.fits.residual_tests import explained_share
from labsid.gap.record.data import Data
from labsid.gap.search.beam_search import BIC_MARGIN, Progress, is_improvement, residual_is_white
from labsid.gap.search.candidates import is_plausible
from labsid.gap.search.explanation import MOST_EFFECTS, Explanation, unsimulated_effects
from labsid.gap.search.forms import transfer_theta
from labsid.gap.signals.input_responses import LinearParts, linear_parts
from labsid.gap.signals.neighbours import Coupled, own_input, simulate_together, with_neighbours
from labsid.gap.signals.roles import Role, Signals, make_role
from labsid.gap.signals.shared_poles import coupled_starts, have_poles_in_common, may_be_coupled
from labsid.gap.simulations.structure_choice import explain_record
from labsid.model_structures.state_space import simulate_states

_OTHER_KIND = {"apart": "same entry", "same entry": "apart"}
SAME = 1.2  # rms error of one model over that of another one, up to which they are the same; set by hand
FAINT = 1.5  # rms error without a pole over that with it, below which it may be one of the rig's own; set by hand
DEPENDENT = 0.01  # share of a residual that functions of an input predict: more is searched there; set by hand


@dataclass(frozen=True, slots=True, eq=False)
class AtInput:
    """Effects that were found at one input.

    Attributes
    ----------
    role : Role
    fit : Fit
        With these effects.
    """

    role: Role
    fit: Fit

    @property
    def effects(self) -> tuple[InputEffect, ...]:
        """In the order in which they were found."""
        return tuple(one for one in self.fit.hypothesis.found if isinstance(one, InputEffect))

    def applied(self, u: FloatArray) -> FloatArray:
        """The scaled input after these effects, shape (N,)."""
        return self.fit.hypothesis.actuator(self.fit.theta, u)


@dataclass(frozen=True, slots=True, eq=False)
class Through:
    """An output explained through one input, the effects at other inputs given.

    Attributes
    ----------
    role : Role
    explanation : Explanation
    others : tuple of AtInput
        Effects at other inputs that act in it.
    """

    role: Role
    explanation: Explanation
    others: tuple[AtInput, ...] = ()

    @property
    def found(self) -> AtInput | None:
        """The effects at the input, if there are any."""
        at = AtInput(self.role, self.explanation.best)
        return at if at.effects else None

    @property
    def white(self) -> bool:
        """Whether nothing but noise is left."""
        return residual_is_white(self.explanation.data, self.explanation.best)

    @property
    def mean_square(self) -> float:
        """Of the free-run error, in the output's own unit."""
        data = self.explanation.data
        return mean_square(data, self.explanation.best) * data.y_scale.unit**2

    @property
    def score(self) -> float:
        """BIC of the free-run error."""
        return free_run_bic(self.explanation.data, self.explanation.best)


@dataclass(frozen=True, slots=True, eq=False)
class OutputSearch:
    """How one output is searched.

    Attributes
    ----------
    signals : Signals
        Those of the record, or the output with its measured neighbours.
    parts : LinearParts
    output : int
        In `signals`.
    order : int
        Of the linear model.
    progress : callable or None
    kind : {"apart", "coupled", "same entry"}
        As of `others_beside`.
    start : ndarray or None
        Parameters of the linear structure.
    beside : tuple of AtInput
        Effects at inputs whose path to the output the given simulation lacks, which other outputs have shown.
    """

    signals: Signals
    parts: LinearParts
    output: int
    order: int
    progress: Progress | None
    kind: str = "apart"
    start: FloatArray | None = None
    beside: tuple[AtInput, ...] = ()

    def role(self, main: int, others: Sequence[AtInput] = ()) -> Role:
        """The output seen through an input, with effects at others."""
        inputs = self.signals.scaled_inputs()
        applied = {one.role.main: one.applied(inputs[:, one.role.main]) for one in (*self.beside, *others)}
        return make_role(self.signals, self.output, main, self.parts, self.order, self.kind, self.start, applied)

    def through(self, main: int, others: Sequence[AtInput], most: int) -> Through:
        """The output explained through an input; the first fit of its path has no effects, at other inputs neither.

        A single effect in the dynamics or at the output is searched through the strongest input only.
        """
        role = self.role(main, others)
        only = most == 1 and main != self.seen[0]
        explanation = explain_record(replace(role.data, at_input=only), role.base, self.progress, most)[0]
        explanation = replace(explanation, data=replace(explanation.data, at_input=False))
        if others or self.beside:
            plain = replace(self, beside=()).through(main, (), 0).explanation.best
            explanation = replace(explanation, path=(plain, *(explanation.path[1:] or explanation.path)))
        return Through(role, explanation, (*self.beside, *others))

    @property
    def seen(self) -> list[int]:
        """Inputs at which an effect can be seen, the strongest first."""
        return [int(i) for i in np.argsort(-self.parts.strength) if self.parts.seen[i]] or [self.parts.strongest]


@dataclass(frozen=True, slots=True, eq=False)
class ExplainedOutput:
    """One output and the effects that explain it.

    Attributes
    ----------
    output : int
        In the record.
    search : OutputSearch
    through : tuple of Through
        By each input at which effects were found; the last one explains everything that was found.
    """

    output: int
    search: OutputSearch
    through: tuple[Through, ...]

    @property
    def white(self) -> bool:
        """Whether nothing but noise is left."""
        return self.through[-1].white

    @property
    def last(self) -> tuple[Data, Fit]:
        """The fit that explains everything that was found."""
        explanation = self.through[-1].explanation
        return explanation.data, explanation.best


def explain_outputs(signals: Signals, order: int = 2, progress: Progress | None = None) -> list[ExplainedOutput]:
    """Explain every output by effects at its inputs, in its dynamics and at itself.

    An effect at an input that explains one output is tried at once in the others.

    Parameters
    ----------
    signals : Signals
    order : int
        Of the linear model.
    progress : callable, optional

    Returns
    -------
    list of ExplainedOutput
        In the order of the outputs.
    """
    nu, ny = len(signals.inputs), len(signals.outputs)
    parts = [linear_parts([signals.data(i, j) for i in range(nu)]) for j in range(ny)]
    if signals.given is not None and not signals.given.linear:
        parts = [_with_paths(own, signals.given.paths[j]) for j, own in enumerate(parts)]
        closed = [_linear(signals, j, own, order, "given") for j, own in enumerate(parts)]
        return [_deepened(output) for output in _explained(signals, parts, order, progress, closed)]
    plain = [_linear(signals, j, own, order, "apart") for j, own in enumerate(parts)]
    apart = [
        _likeliest(signals, j, own, order, search) for j, (own, search) in enumerate(zip(parts, plain, strict=True))
    ]
    if not may_be_coupled(signals, parts) or all(residual_is_white(*search.fitted) for search in apart):
        found = [_deepened(output) for output in _explained(signals, parts, order, progress, apart)]
        return _own_poles(signals, found) if any(own.moves.sum() > 1 for own in parts) else found
    starts = coupled_starts(signals, parts, order, [search.fitted[1] for search in plain])
    coupled = [_linear(signals, j, parts[j], order, "coupled", start) for j, start in enumerate(starts)]
    better = bool(coupled) and _total(coupled) < _total(apart) - BIC_MARGIN
    if better and have_poles_in_common([search.fitted for search in coupled]):
        return [_deepened(output) for output in _explained(signals, parts, order, progress, coupled)]
    searches = _beside_neighbours(signals, parts, order, progress) if signals.given is None else []
    likely = any(
        residual_is_white(*_linear_fit(search)) and not residual_is_white(*apart[j].fitted)
        for j, search in enumerate(searches)
    )
    beside = _explained_beside(searches) if likely else []
    if beside and all(output.white for output in beside):
        return beside
    with_own_poles = _explained(signals, parts, order, progress, apart)
    if all(output.white for output in with_own_poles):
        return _own_poles(signals, with_own_poles)
    options = [with_own_poles]
    if searches:
        options.append(beside or _explained_beside(searches))
    if coupled:
        with_common_poles = _explained(signals, parts, order, progress, coupled)
        options += [with_common_poles] if have_poles_in_common([output.last for output in with_common_poles]) else []
    best = min(options, key=lambda option: _rank(signals, option))
    return _own_poles(signals, [_deepened(output) for output in best])


def _with_paths(parts: LinearParts, paths: np.ndarray) -> LinearParts:
    """The responses of an output; effects are searched at inputs that move it in the simulation, too."""
    return replace(parts, seen=parts.seen & paths) if np.any(parts.seen & paths) else parts


def _rank(signals: Signals, option: Sequence[ExplainedOutput]) -> tuple[int, float]:
    """By outputs of which more than noise is left, then by the free-run error, of coupled outputs together."""
    left = sum(not one.white for one in option)
    if option[0].search.signals is not signals:
        together = simulate_together(signals, [Coupled(one.search.signals, *one.last) for one in option])
        if together is None:
            return left, np.inf
        errors = [np.mean((signals.y - together)[rows, j] ** 2) for j, rows in enumerate(signals.rows.T)]
    else:
        errors = [one.through[-1].mean_square for one in option]
    return left, float(np.sum(np.log(errors)))


def _own_poles(signals: Signals, found: list[ExplainedOutput]) -> list[ExplainedOutput]:
    """The outputs, poles that were found counted as the rig's own where a coupled rig of the usual order has them.

    A response of second order from each input to each output has fewer states than coupled systems of second order, one
    for each output. The poles are no effects if a state-space model of that order leaves no more error, or if the error
    without them is hardly larger.
    """
    names = {
        name for output in found for through in output.through for name in through.explanation.best.hypothesis.names
    }
    if len(found) < 2 or not names or not names <= names_where("adds_poles"):
        return found
    ends = [(output.through[-1].explanation.data, output.through[-1].explanation) for output in found]
    larger = max(mean_square(data, how.path[0]) / mean_square(data, how.best) for data, how in ends)
    if larger > FAINT**2 and not _is_of_usual_order(signals, found):
        return found
    return [replace(output, through=tuple(_as_given(through) for through in output.through)) for output in found]


def _is_of_usual_order(signals: Signals, found: Sequence[ExplainedOutput]) -> bool:
    """Whether a state-space model with two states for each output leaves no more error than what was found."""
    u, y = signals.scaled_inputs(), np.array(signals.y)
    middle, spread = y.mean(axis=0), y.std(axis=0)
    try:
        fitted = fit_subspace(u, (y - middle) / spread, signals.Ts, 2 * y.shape[1], measured=signals.rows)
        simulated = simulate_states(fitted.model, u, fitted.x0)
    except ValueError:
        return False
    for j, output in enumerate(found):
        explanation, rows = output.through[-1].explanation, signals.rows[:, j]
        e = ((y - middle) / spread - simulated)[rows, j]
        left_rms = float(np.std(e)) * spread[j] / explanation.data.y_scale.unit
        if left_rms > SAME * np.sqrt(mean_square(explanation.data, explanation.best)):
            return False
    return True


def _as_given(through: Through) -> Through:
    """An explanation whose effects are part of the structure."""
    explanation = through.explanation
    best = explanation.best
    own = replace(best.hypothesis, n_given=len(best.hypothesis.effects))
    fit = replace(best, hypothesis=own)
    return replace(through, explanation=replace(explanation, levels=({(): fit},), path=(fit,)))


def _beside_neighbours(
    signals: Signals, parts: Sequence[LinearParts], order: int, progress: Progress | None
) -> list[OutputSearch]:
    """Every output through its own input, beside the measured other outputs; empty if one has no own input."""
    searches = []
    for j, main in enumerate(own_input(parts) or []):
        seen = with_neighbours(signals, j, main)
        own = linear_parts([seen.data(i, 0) for i in range(len(seen.inputs))])
        alone = replace(own, seen=np.arange(len(seen.inputs)) == 0)
        searches.append(OutputSearch(seen, alone, 0, order, progress, "same entry"))
    return searches


def _linear_fit(search: OutputSearch) -> tuple[Data, Fit]:
    """The linear fit of an output through the first input at which an effect may be seen."""
    return _fitted(search.role(search.seen[0]))


def _explained_beside(searches: Sequence[OutputSearch]) -> list[ExplainedOutput]:
    """Every output explained beside its measured neighbours."""
    return [replace(_explain_output(one, []), output=j) for j, one in enumerate(searches)]


class _Linear(NamedTuple):
    """The linear fit of an output through its strongest input: how further inputs act in it, and where it started."""

    kind: str
    start: FloatArray | None
    fitted: tuple[Data, Fit]


def _linear(
    signals: Signals, j: int, parts: LinearParts, order: int, kind: str, start: FloatArray | None = None
) -> _Linear:
    role = make_role(signals, j, parts.strongest, parts, order, kind, start)
    return _Linear(kind, start, _fitted(role))


def _fitted(role: Role) -> tuple[Data, Fit]:
    return role.data, fit_baseline(role.data, role.base.structure, role.base.start)


def _likeliest(signals: Signals, j: int, parts: LinearParts, order: int, apart: _Linear) -> _Linear:
    """Whether all inputs of an output act at the same place, or each has dynamics of its own."""
    if parts.moves.sum() < 2:
        return apart
    return min(apart, _linear(signals, j, parts, order, "same entry"), key=lambda one: free_run_bic(*one.fitted))


def _total(linear: Sequence[_Linear]) -> float:
    """BIC of the free-run errors of all outputs."""
    return sum(free_run_bic(*one.fitted) for one in linear)


def free_run_bic(data: Data, fit: Fit) -> float:
    """BIC of the free-run error: the innovations of a slow residual say little of which input is concerned."""
    count = int(data.rows.sum())
    return float(count * np.log(mean_square(data, fit)) + fit.n_free * np.log(count))


def _explained(
    signals: Signals,
    parts: Sequence[LinearParts],
    order: int,
    progress: Progress | None,
    linear: Sequence[_Linear],
) -> list[ExplainedOutput]:
    """Explain every output, those with the largest gap first."""
    ny = len(parts)
    searches = [
        OutputSearch(signals, own, j, order, _of_output(progress, j, ny), search.kind, search.start)
        for j, (own, search) in enumerate(zip(parts, linear, strict=True))
    ]
    gaps = [_gap(search.fitted[1]) for search in linear]
    by_output: dict[int, ExplainedOutput] = {}
    known: list[AtInput] = []
    for search in sorted(searches, key=lambda search: -gaps[search.output]):
        search = _with_known(search, known)
        explained = _explain_output(search, known)
        other_kind = _OTHER_KIND.get(search.kind)
        if other_kind and not explained.white and search.parts.moves.sum() > 1:
            again = _explain_output(replace(search, kind=other_kind), known)
            explained = min(explained, again, key=lambda result: result.through[-1].score)
        by_output[search.output] = explained
        at_inputs = (through.found for through in explained.through)
        known += [at for at in at_inputs if at is not None and not _has(known, at)]
    return [by_output[j] for j in range(ny)]


def _with_known(search: OutputSearch, known: Sequence[AtInput]) -> OutputSearch:
    """The search of an output, with the effects at inputs that move it by paths that the given simulation lacks."""
    given = search.signals.given
    if given is None or search.kind != "given" or not given.couplings:
        return search
    lacking = {one.input for one in given.couplings[search.output]}
    return replace(search, beside=tuple(at for at in known if at.role.main in lacking))


def _of_output(progress: Progress | None, j: int, ny: int) -> Progress | None:
    if progress is None:
        return None
    return lambda what, share: progress(f"output {j + 1} of {ny}, {what}", share)


def _gap(fit: Fit) -> float:
    """Free-run error of the linear model over its innovations."""
    return float(np.sqrt(fit.free_run / max(fit.noise.sigma2, np.finfo(float).tiny)))


def _has(known: list[AtInput], at: AtInput) -> bool:
    keys = {(one.role.main, effect.name) for one in known for effect in one.effects}
    return all((at.role.main, effect.name) in keys for effect in at.effects)


def _explain_output(search: OutputSearch, known: list[AtInput]) -> ExplainedOutput:
    """An output by one effect at each of its inputs, or one in its dynamics or at itself."""
    shared = _shared(search, known)
    if shared and shared[-1].white:
        return ExplainedOutput(search.output, search, shared)
    chain = shared or (min(_screened(search), key=_score),)
    return ExplainedOutput(search.output, search, _extended(search, chain))


def _deepened(one: ExplainedOutput) -> ExplainedOutput:
    """An output of which more than noise is left, searched for up to three effects."""
    if one.white:
        return one
    search, last = one.search, one.through[-1]
    full = search.through(last.role.main, last.others, MOST_EFFECTS)
    chain = (*one.through[:-1], min(last, full, key=_score))
    return replace(one, through=_extended(search, chain))


def _extended(search: OutputSearch, chain: tuple[Through, ...]) -> tuple[Through, ...]:
    """A chain with effects at further inputs, as long as they reduce the error."""
    while not chain[-1].white and len(chain) < len(search.seen) and chain[-1].found is not None:
        others = (*chain[-1].others, chain[-1].found)
        taken = [one.role.main for one in others]
        further = [i for i in search.seen if i not in taken and _fits_as_well(search.through(i, others, 0), chain[-1])]
        if not further:
            break
        following = [search.through(i, others, 1) for i in further]
        best = min(following, key=_score)
        if best.score > chain[-1].score - BIC_MARGIN or best.found is None:
            break
        chain = _in_turn(search, (*chain, best))
    return chain


def _fits_as_well(plain: Through, last: Through) -> bool:
    """Whether the same effects explain an output about as well through another input.

    If the dynamics seen through that input fit worse, one effect more at it cannot show.
    """
    return plain.mean_square <= SAME**2 * last.mean_square


def _score(through: Through) -> float:
    return through.score


def _screened(search: OutputSearch) -> list[Through]:
    """The output through each input that may have an effect, with at most one of them; the strongest input first."""
    found: list[Through] = []
    for main in search.seen:
        if found and found[0].white and not _depends(search, found[0], main):
            continue
        found.append(search.through(main, (), 1))
        if found[-1].white and len(found[-1].explanation.path) > 1:
            break
    return found


def _depends(search: OutputSearch, through: Through, main: int) -> bool:
    """Whether the residual depends on another input."""
    data, fit = through.explanation.data, through.explanation.best
    other = replace(data, u=search.signals.data(main, search.output).u)
    return explained_share(other, fit, data.y - fit.output) > DEPENDENT


def _shared(search: OutputSearch, known: list[AtInput]) -> tuple[Through, ...]:
    """The output with the effects at its inputs that other outputs have shown, where they improve it."""
    chain: tuple[Through, ...] = ()
    for at in known:
        main = at.role.main
        if main not in search.seen or main in [through.role.main for through in chain]:
            continue
        others = tuple(through.found for through in chain if through.found is not None)
        plain = search.through(main, others, 0)
        fit = _with_effects(plain, at)
        if fit is None or not is_improvement(plain.explanation.data, plain.explanation.best, fit):
            continue
        chain = (*chain, Through(plain.role, _forced(plain.role.data, plain.explanation, fit), others))
        if chain[-1].white:
            break
    return chain


def _with_effects(plain: Through, at: AtInput) -> Fit | None:
    """The linear fit of an output with the effects at an input that another output has shown."""
    base, data = plain.explanation.best, plain.explanation.data
    hypothesis = base.hypothesis.with_effects((*base.hypothesis.effects, *at.effects))
    theta = transfer_theta(base, hypothesis)
    for effect in at.effects:
        theta[hypothesis.slices[effect.key]] = at.fit.theta[at.fit.hypothesis.slices[effect.key]]
    fit = fit_from(data, hypothesis, theta, iterations=25)
    return fit if fit is not None and is_plausible(data, fit, len(at.effects)) else None


def _forced(data: Data, plain: Explanation, fit: Fit) -> Explanation:
    """An explanation by given effects, without a search."""
    names = tuple(sorted(fit.hypothesis.names))
    between: list[dict[tuple[str, ...], Fit]] = [{} for _ in names[1:]]
    path = (plain.path[0], *(fit,) * len(names))
    beside = unsimulated_effects(data, plain.data, plain.faults, path)
    levels = (plain.levels[0], *between, {names: fit})
    return replace(plain, levels=levels, path=path, unsimulated=beside)


def _in_turn(search: OutputSearch, chain: tuple[Through, ...]) -> tuple[Through, ...]:
    """A chain whose last two are found again in turn, each with the effects of the other one."""
    first, second = chain[-2:]
    for _ in range(2):
        before = tuple(known for known in first.others if known.role.main != second.role.main)
        others = before if second.found is None else (*before, second.found)
        again = search.through(first.role.main, others, max(len(first.explanation.path) - 1, 1))
        first, second = second, again
    return (*chain[:-2], first, second)
