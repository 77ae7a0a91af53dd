"""What the coarse log of an input leaves through a simulation: the rig acted on finer values than the log has."""

import numpy as np

from labsid._arrays import FloatArray
from labsid.gap.fits.fitting import Fit
from labsid.gap.record.data import Data
from labsid.records.signal_quality import lattice_step, runs

MAX_STEPS = 1000  # of the log in the range of the input, from which its rounding is not looked at
MIN_LEVELS = 20  # of the input: fewer are those of a staircase, not of a coarse log
DRAWS = 8  # of the digits that the log of the input has lost
SEED = 0  # of these draws


def log_rounding_error(data: Data, fit: Fit) -> float:
    """Mean square error of a fit that the rounding of the log of its input explains; zero if the log is fine.

    The rounding errors are drawn at random, one for each stretch of constant input.

    Parameters
    ----------
    data : Data
    fit : Fit
    """
    u = data.u
    step = lattice_step(u)
    if step is None or np.ptp(u) > MAX_STEPS * step or np.unique(u).size <= MIN_LEVELS:
        return 0.0
    rng = np.random.default_rng(SEED)
    lengths = runs(u)[1]
    powers = [_power(data, fit, np.repeat(rng.uniform(-0.5, 0.5, lengths.size) * step, lengths)) for _ in range(DRAWS)]
    return float(np.mean(powers))


def _power(data: Data, fit: Fit, error: FloatArray) -> float:
    """Mean square of the change of the output by a change of the input, less its mean."""
    change = fit.hypothesis.output(fit.theta, fit.gains, data.u + error) - fit.output
    return float(np.var(change[data.rows]))
