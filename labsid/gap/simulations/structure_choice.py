"""Search for the explanation of a record, with a direct term of the linear structure where it fits better."""

from labsid.gap.fits.floor import with_floor
from labsid.gap.fits.hypothesis import Hypothesis
from labsid.gap.fits.linear_fits import fit_baseline
from labsid.gap.record.data import Data
from labsid.gap.search.beam_search import BIC_MARGIN, Progress, residual_is_white
from labsid.gap.search.explanation import MOST_EFFECTS, Explanation, explain
from labsid.gap.simulations.baseline import Baseline

UNDECIDED_TERM = (
    "This record does not tell a response within the sample from dynamics as fast as the sampling: both fit it. Larger "
    "steps of the input or a shorter sampling time would."
)


def explain_record(
    data: Data, base: Baseline, progress: Progress | None, largest: int = MOST_EFFECTS
) -> tuple[Explanation, bool]:
    """The explanation of a record by strictly proper dynamics, or by those with a direct term if they alone fit better.

    Where the record does not decide on a direct term, it competes with every effect, in the score of the search.

    Parameters
    ----------
    data : Data
    base : Baseline
    progress : callable, optional
    largest : int
        Number of effects, at most.

    Returns
    -------
    Explanation
    undecided : bool
        Whether the two explain the record about equally well.
    """
    if base.alternative is None:
        return explain(data, base.structure, base.start, largest, progress), False
    most = min(largest, 1) if _leaves_noise(with_floor(data), base.structure, base.alternative) else largest
    explanation = explain(data, base.structure, base.start, most, progress)
    direct = fit_baseline(explanation.data, base.alternative)
    gain = explanation.best.whitened_bic - direct.whitened_bic
    undecided = abs(gain) < BIC_MARGIN
    if gain > 0.0:
        return explain(data, base.alternative, None, largest, progress), undecided
    if most < largest and len(explanation.path) > most:
        explanation = explain(data, base.structure, base.start, largest, progress)
    return explanation, undecided


def _leaves_noise(data: Data, proper: Hypothesis, alternative: Hypothesis) -> bool:
    """Whether the structure with a direct term leaves white noise, and the strictly proper one clearly more."""
    fits = [fit_baseline(data, structure) for structure in (alternative, proper)]
    return fits[0].bic < fits[1].bic - BIC_MARGIN and residual_is_white(data, fits[0])
