"""Whether the output responds within the sample in which the input changes: a test that assumes no model order."""

from dataclasses import dataclass

import numpy as np

from labsid._arrays import FloatArray, lagged_columns, left_by
from labsid.gap.dynamics import _kernels
from labsid.gap.record.controllers import FEEDBACK_F
from labsid.gap.record.data import Data, complete_rows
from labsid.records.direction import feedback_statistic

LAGS = 12  # of both signals; set by hand
RATES = 8  # of filters of the input, from one over the record to one per sample, beyond the lags; set by hand
DEPENDENT = 1e-8  # singular value of a regressor over the largest, below which it repeats others; numerics
SIGNIFICANT = 5.0  # standard errors; measured: rigs without a direct term, 2 of 130 beyond 3, all with smooth inputs
DECISIVE = 0.05
"""Standard error of the term, over the gain of standard deviations, below which the test decides; set by hand."""
JUMP = 3.0  # times the median size of what the past does not foretell of the input; set by hand


@dataclass(frozen=True, slots=True)
class DirectTerm:
    """Coefficient of the present input in a long autoregression of the output, both scaled to unit variance.

    Attributes
    ----------
    value : float
    stderr : float
        Infinity if the past of the input foretells its present value.
    """

    value: float
    stderr: float

    @property
    def decides(self) -> bool:
        """Whether the record shows the coefficient well enough to be told from zero."""
        return self.stderr < DECISIVE

    @property
    def present(self) -> bool:
        """Whether the output responds within the sample, beyond doubt."""
        return self.decides and abs(self.value) > SIGNIFICANT * self.stderr


def estimate_direct_term(data: Data) -> DirectTerm:
    """Estimate the direct term of a record without a model of its dynamics.

    What the past does not foretell of the input predicts what it does not foretell of the output only through a direct
    term. In a closed loop it would, too, as the input responds to the output: where a controller shows, the
    estimate is zero with an infinite error, and where the input jumps, only its jumps count, which are no response to
    noise.

    Parameters
    ----------
    data : Data

    Returns
    -------
    DirectTerm
    """
    new_u, new_y, free = innovations(data)
    power = float(new_u @ new_u)
    if power < DEPENDENT * new_u.size or free < LAGS or feedback_statistic(*data.sampled) > FEEDBACK_F:
        return DirectTerm(0.0, np.inf)
    jumps = np.abs(new_u) > JUMP * np.median(np.abs(new_u))
    if np.sum(new_u[jumps] ** 2) > 0.5 * power:
        new_u, new_y, free = new_u[jumps], new_y[jumps], max(int(jumps.sum()) - 1, 1)
        power = float(new_u @ new_u)
    value = float(new_u @ new_y) / power
    left = new_y - value * new_u
    return DirectTerm(value, float(np.sqrt((left @ left) / free / power)))


def innovations(data: Data) -> tuple[FloatArray, FloatArray, int]:
    """What the past of both signals does not foretell of either, by linear regression.

    The regressors are `LAGS` past samples of both signals and the past input behind `RATES` first-order filters.

    Returns
    -------
    u, y : ndarray, shape (n,)
        Scaled, at the n samples that follow `LAGS` samples that count.
    free : int
        n less the number of regressors; not positive if the record is too short.
    """
    u, y = data.u, data.y
    at = np.flatnonzero(complete_rows(data.rows, LAGS))
    if at.size <= 2 * LAGS + RATES + 1:
        return u[at], y[at], 0
    before = np.concatenate([u[:1], u[:-1]]) - u[0]
    filters = [_kernels.first_order(before, float(np.exp(-rate))) for rate in np.geomspace(2.0 / u.size, 1.0, RATES)]
    past = np.column_stack(
        [lagged_columns(u, at, LAGS), lagged_columns(y, at, LAGS), np.ones(at.size), np.column_stack(filters)[at]]
    )
    new, count = left_by(past, np.column_stack([u[at], y[at]]), DEPENDENT)
    return new[:, 0], new[:, 1], at.size - count - 1
