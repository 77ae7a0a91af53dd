"""What follows a gap of the log in which the input may have moved: the simulation has to forget a wrong input first."""

import numpy as np

from labsid._arrays import FloatArray, stretches_of
from labsid.gap.dynamics.responses import decay_rates
from labsid.gap.fits.linear_fits import fit_baseline
from labsid.gap.record.data import Data

SHORTEST = 3  # samples of a gap: in fewer the input moves early by next to nothing; set by hand
FORGOTTEN = 0.3  # of the noise, that is left of the largest error by a wrong input; set by hand
MOST = 0.4  # of the samples with an output, that may be left out; set by hand


def after_unknown_input(data: Data, u: FloatArray, measured: np.ndarray) -> np.ndarray:
    """Mark the samples that a simulation cannot know after gaps at whose end the input is another one.

    Parameters
    ----------
    data : Data
        With all samples that have an output among its rows.
    u : ndarray, shape (N,)
        The input as recorded, held in gaps.
    measured : ndarray of bool, shape (N,)
        Samples with an output.

    Returns
    -------
    ndarray of bool, shape (N,)
        None are marked if they were too many.
    """
    unknown = np.zeros(measured.size, bool)
    gaps = [one for one in stretches_of(~measured) if one[1] - one[0] >= SHORTEST and _may_have_moved(u, *one)]
    if not gaps:
        return unknown
    fit = fit_baseline(data)
    slow = decay_rates(*fit.rates)[0]
    noise = float(np.sqrt(fit.noise.sigma2)) / float(np.ptp(data.y[data.rows]))
    length = int(np.ceil(np.log(1.0 / (FORGOTTEN * min(noise, 1.0))) / slow + fit.theta[0])) + 1
    for _, stop in gaps:
        unknown[stop : stop + length] = True
    unknown &= measured
    return unknown if unknown.sum() <= MOST * measured.sum() else np.zeros(measured.size, bool)


def _may_have_moved(u: FloatArray, start: int, stop: int) -> bool:
    """Whether an input that is held over a gap is another one at its end."""
    return bool(start > 0 and stop < u.size and np.ptp(u[start - 1 : stop]) == 0.0 and u[stop] != u[start])


def about_unknown_input(unknown: np.ndarray, Ts: float) -> tuple[str, ...]:
    """A sentence on the samples that are left out; none without any."""
    parts = [(stop - start) * Ts for start, stop in stretches_of(unknown)]
    if not parts:
        return ()
    where = "a gap" if len(parts) == 1 else f"each of {len(parts)} gaps"
    return (
        f"After {where} of the log the input is another one than before. When it changed is unknown, so the "
        f"{max(parts):.3g} s that the rig needs to forget it are neither fitted nor scored.",
    )
