"""Explain which effects the beam search accepted, and why the others of lowest BIC were not taken."""

from collections.abc import Iterator
from operator import attrgetter

from labsid._texts import joined
from labsid.gap.effects.inside import MISMATCH
from labsid.gap.fits import profile
from labsid.gap.fits.fitting import Fit, mean_square, rms
from labsid.gap.fits.log_rounding import log_rounding_error
from labsid.gap.fits.profile import has_size
from labsid.gap.search import beam_search, explanation
from labsid.gap.search.explanation import Explanation, is_rounding_of_log
from labsid.gap.search.sets import SETS
from labsid.gap.verdict.answer import Answer
from labsid.gap.verdict.gates import Gate, NotTaken, Stage, Threshold, threshold_of

SHOWN = 3  # combinations of each size that were not taken; set by hand


def explain_search(answer: Answer) -> Stage:
    """Which effects the beam search accepted, by BIC on all samples."""
    found = answer.steps.searched
    gates = [*_mismatch_gates(answer), *_step_gates(found)]
    if len(found.path) > 1:
        result = f"The search accepts {joined(found.best.hypothesis.names)}."
    else:
        result = "The search accepts no simulated effect."
    if found.unsimulated:
        result += f" The samples themselves show {joined(found.unsimulated)}."
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
            threshold_of(beam_search, "BIC_MARGIN"),
            f"If it passes, the parameters are wrong ({MISMATCH}).",
        )


def _step_gates(found: Explanation) -> Iterator[Gate]:
    """The gates of the accepted explanation; without one, of the effect of lowest BIC."""
    path, data = found.path, found.data
    if len(path) > 1:
        simpler, fit, names = path[0], path[-1], joined(path[-1].hypothesis.names)
        meaning = f"Over no effect. If it passes, {names} may be added."
    elif len(found.levels) > 1 and found.levels[1]:
        simpler = path[0]
        fit = min(found.levels[1].values(), key=attrgetter("bic"))
        names = joined(fit.hypothesis.names)
        meaning = f"Over no effect, of the best one: {names}. If it passes, it may be added."
    else:
        return
    yield Gate("BIC gain", simpler.bic - fit.bic, ">", threshold_of(beam_search, "BIC_MARGIN"), meaning)
    last = len(path) - 1
    in_a_set = last > 1 and set(fit.hypothesis.names) <= set().union(*(one.names for one in SETS))
    if last < 1 or in_a_set:
        limit = threshold_of(beam_search, "MIN_CHANGE")
    else:
        simpler = path[-2]
        limit = threshold_of(explanation, "MIN_NAMED_CHANGE", explanation.change_place(last))
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
        return f"{joined(accepted.hypothesis.names)} has the lower BIC, by {fit.bic - accepted.bic:,.0f}"
    if not has_size(data, fit):
        return f"without its size the fit is worse by less than profile.MIN_SIZE_LOSS = {profile.MIN_SIZE_LOSS:g}"
    least = explanation.MIN_NAMED_CHANGE[explanation.change_place(size)]
    if change <= least:
        return f"it is too small to be named (change of {least:g} needed)"
    if beam_search.residual_is_white(data, path[-1]):
        return "the accepted explanation leaves white noise: the search ended"
    if len(path) == 1 and explanation.is_nuisance(data, found.levels[1], (path[0], fit)):
        return f"it is small (change of {explanation.MIN_UNRIVALLED_CHANGE:g} needed) and others fit as well"
    if is_rounding_of_log(data, path[0], fit):
        return "the rounding of the logged input leaves as large an error"
    return "pruned: its last effect is small, redundant, or does not reduce the error on blocks left out"
