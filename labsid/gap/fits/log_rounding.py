"""What the coarse log of an input leaves through a simulation: the rig acted on finer values than the log has."""

import numpy as np

from labsid._arrays import FloatArray
from labsid.gap.fits.fitting import Fit
from labsid.gap.record.data import Data
from labsid.records.signal_quality import lattice_step, runs

MAX_STEPS = 1000  # of the log in the range of the input, from which its rounding is not looked at; set by hand
MIN_LEVELS = 20  # of the input: fewer are those of a staircase, not of a coarse log; set by hand
FEWEST_LEVELS = 8  # the same where it jumps by several steps of its lattice, as a staircase does not; set by hand
REFUTED = 4.0  # times the mean square error of a fit, which is then too small for a rounded log; set by hand
REFUTED_SMOOTH = 16.0  # the same of an input that moves smoothly, whose rounding errors repeat with it; set by hand
JUMP = 3.0  # steps of the log in the median change of the input, from which its rounding errors are random; set by hand
DRAWS = 8  # of the digits that the log of the input has lost; numerics
SEED = 0  # of these draws; numerics


def log_rounding_error(data: Data, fit: Fit, best: Fit | None = None, leaves_noise: bool = False) -> float:
    """Mean square error of a fit that the rounding of the log of its input explains; zero if the log is fine.

    The rounding errors are drawn at random, one for each stretch of constant input. No simulation foretells them where
    the input jumps: an error that is much smaller then shows that the values of the log acted, as set points in whole
    numbers do. Of an input that moves smoothly an effect may imitate a part of them, and all but noise in none.

    Parameters
    ----------
    data : Data
    fit : Fit
    best : Fit, optional
        The one with the smallest error; by default `fit`.
    leaves_noise : bool
        Whether that leaves nothing but noise.
    """
    u = data.u
    step = lattice_step(u)
    if step is None or np.ptp(u) > MAX_STEPS * step:
        return 0.0
    jumps = np.abs(np.diff(u))
    at_random = np.median(jumps[jumps > 0.0]) > JUMP * step  # not the slow motion of a smooth input
    if np.unique(u).size <= (FEWEST_LEVELS if at_random else MIN_LEVELS):
        return 0.0
    rng = np.random.default_rng(SEED)
    lengths = runs(u)[1]
    powers = [_power(data, fit, np.repeat(rng.uniform(-0.5, 0.5, lengths.size) * step, lengths)) for _ in range(DRAWS)]
    power, left = float(np.mean(powers)), (best or fit).output - data.y
    refuted = REFUTED if at_random else REFUTED_SMOOTH if leaves_noise else np.inf
    return 0.0 if power > refuted * float(np.var(left[data.rows])) else power


def _power(data: Data, fit: Fit, error: FloatArray) -> float:
    """Mean square of the change of the output by a change of the input, less its mean."""
    change = fit.hypothesis.output(fit.theta, fit.gains, data.u + error) - fit.output
    return float(np.var(change[data.rows]))
