"""What changes at an instant: a load that ends, a gain or a speed of response that changes once.

Such a change at a free instant imitates a part of much that a search does not explain, so it takes no part in that
search. It replaces effects of its result where it explains more than they do, with as many effects; it is added to them
where only noise is left then.
"""

from collections.abc import Mapping, Sequence
from itertools import product
from operator import attrgetter

from labsid._cores import mapped
from labsid.gap.effects.base import Effect
from labsid.gap.effects.families import LATE, names_where
from labsid.gap.fits.fitting import Fit
from labsid.gap.record.data import Data
from labsid.gap.search.candidates import Trial, best_fit, is_plausible, refined_groups, trial_fits
from labsid.gap.search.refinement import converge, polish

FITTED = 6  # such changes beside an effect that are fitted completely: those with the best trials; set by hand
MOST_PARENTS = 3  # fits with one effect, to which such a change is added; set by hand
LEAP_GAIN = 30.0
"""BIC over the highest that counts, up to which leaps out of local minima are tried; measured: of 60 such fits within
100 of that of the search, none gained more than 8, and one below it 821."""


def fits_with_instants(
    data: Data, levels: Sequence[Mapping[tuple[str, ...], Fit]], highpass: Fit, highest: float
) -> list[Fit]:
    """Fits with a change at an instant, alone and beside the best fits with one effect.

    Parameters
    ----------
    data : Data
    levels : sequence of dict
        The best fit of every combination tried, by number of effects.
    highpass : Fit
        A linear fit to the high-pass filtered record.
    highest : float
        The highest BIC that counts.

    Returns
    -------
    list of Fit
        Empty for several records, and where the dynamics are given.
    """
    (base,) = levels[0].values()
    if data.pieces or base.hypothesis.plant.kind != "linear":
        return []
    single = sorted(levels[1].values(), key=attrgetter("bic"))[:MOST_PARENTS] if len(levels) > 1 else []
    pairs = [
        (parent, late) for parent, late in product([base, *single], LATE) if late.name not in parent.hypothesis.names
    ]
    shared = data, base

    def tried(pair: tuple[Fit, Effect]) -> list[Trial]:
        return trial_fits(data, pair[0], (pair[1],), highpass, brief=pair[0] is not base)

    groups = mapped(tried, pairs, shared)
    first = sum(parent is base for parent, _ in pairs)
    alone, beside = groups[:first], groups[first:]
    few = [*filter(None, alone), *refined_groups(beside, len(beside), FITTED)]
    fits = mapped(lambda trials: best_fit(data, trials), few, shared)
    ends = [polish(data, converge(data, fit)) for fit in fits if fit is not None and fit.bic < highest + LEAP_GAIN]
    return [fit for fit in ends if is_plausible(data, fit, len(fit.hypothesis.found))]


def may_change_at_an_instant(fit: Fit) -> bool:
    """Whether an effect of a fit varies in time, which a change at an instant may do better."""
    return not names_where("varies_in_time").isdisjoint(fit.hypothesis.names)
