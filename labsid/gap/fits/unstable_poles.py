"""Whether the rig itself is unstable, and the weakest feedback beside which its simulation stays bounded."""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg import lstsq, pinvh

from labsid._arrays import FloatArray
from labsid.gap.dynamics.responses import denominator, section
from labsid.gap.effects.output_feedback import OutputFeedback
from labsid.gap.fits.fitting import Fit
from labsid.gap.record.controllers import FEEDBACK_F, is_relay
from labsid.gap.record.data import Data
from labsid.records.direction import gain_from_past
from labsid.records.signal_quality import stuck_at_extreme

START_RATES = 0.01, 0.03, 0.1, 0.3  # per sample: of the filters with which the search begins; numerics
ITERATIONS = 12  # of the filter and the dynamics fitted behind it; numerics
SLOWEST = 3.0  # poles of a filter decay by the exponential of at least this along the record; set by hand
GROWTH = 3.0  # an unstable pole that grows by less than the exponential of this is no matter; set by hand
MOST_CORRECTED = 0.3  # of what the input moves the output; definition: `partial` at most beside a larger correction
MOST_DIRECT = 0.5
"""Of the mean square error, left by a direct term; measured: 0.9 and more in loops, 0.33 and less elsewhere."""
MOST_STUCK = 0.1  # of the readings, at a limit of the sensor; set by hand
SIGNIFICANT = 6.0  # standard errors: the error of the filtered equation is not white; set by hand


@dataclass(frozen=True, slots=True, eq=False)
class FilteredEquation:
    """Second-order dynamics fitted to input and output behind one filter each, which may be unstable.

    With the filter's denominator D, the dynamics A y = B u are y = (D - A)/D y + B/D u + c, which is linear in A and B.

    Attributes
    ----------
    poles : ndarray of complex, shape (2,)
        Of the dynamics, per sample.
    filter : (float, float)
        c and k of the filter's s^2 + c s + k, in samples.
    gain : float
        Of B/D at standstill.
    stderr : float
        Of the pole that grows fastest; without a meaning for a complex pair.
    error : float
        Mean square error of the equation.
    """

    poles: np.ndarray
    filter: tuple[float, float]
    gain: float
    stderr: float
    error: float

    @property
    def fastest_growth(self) -> float:
        """Rate of the real pole that grows fastest, per sample; minus infinity for a complex pair."""
        return float(self.poles.real.max()) if np.isreal(self.poles).all() else -np.inf


def find_stabilising_feedback(data: Data) -> tuple[OutputFeedback, float] | None:
    """The weakest feedback of the output that keeps a simulation of the rig bounded; None for a stable rig.

    The dynamics are fitted behind a filter whose poles are those of the dynamics, the growing ones mirrored at the
    imaginary axis, until both agree (Steiglitz and McBride, IEEE Transactions on Automatic Control 10 (1965) 461-464,
    with a stable filter). Feedback that mirrors them needs the least energy of all that stabilise the rig (Kwakernaak
    and Sivan, Linear Optimal Control Systems, 1972, section 3.8).

    Parameters
    ----------
    data : Data

    Returns
    -------
    OutputFeedback
    gain : float
        Of the actuator, to the output at rest with the feedback; both are scaled.
    """
    u, y = data.sampled
    if gain_from_past(y, u) < FEEDBACK_F or is_relay(u, y):
        return None  # without a controller an unstable rig would have run away, and a relay hardly holds one
    if sum(stuck_at_extreme(y, extreme)[0] for extreme in (y.min(), y.max())) > MOST_STUCK * y.size:
        return None  # a controller does not hold a rig whose reading stays at a limit
    best = _best_equation(data)
    if best is None:
        return None
    growth = best.fastest_growth
    if growth * data.longest < GROWTH or growth < SIGNIFICANT * best.stderr or best.gain == 0.0:
        return None
    if _error_with_direct_term(data, *best.filter) < MOST_DIRECT * best.error:
        return None  # a rig that responds within the sample, to an input that is as smooth as the output
    if not all(map(_grows, _halves(data))):
        return None  # the gain or the speed of a stable rig changes
    (c, k), (a1, a0) = best.filter, np.poly(best.poles).real[1:]
    gains = float(1.0 - a0 / k), float((c - a1) / k)
    feedback = OutputFeedback(gains=gains, closed=(c, k), about=float(data.y[0]))
    return feedback.on(data.y), best.gain


def _best_equation(data: Data) -> FilteredEquation | None:
    """The equation of least error, from filters of several rates; None if none has a solution."""
    fits = [fit for rate in START_RATES if (fit := _fitted(data, rate)) is not None]
    return min(fits, key=lambda fit: fit.error, default=None)


def _grows(data: Data) -> bool:
    """Whether the best equation has a growing pole."""
    best = _best_equation(data)
    return best is not None and best.fastest_growth > 0.0


def _halves(data: Data) -> Iterator[Data]:
    """The record with the rows of either half alone."""
    first = np.arange(data.samples) < data.samples // 2
    for half in (first, ~first):
        yield replace(data, rows=data.rows & half)


def corrected_share(data: Data, fit: Fit) -> float | None:
    """Rms of what the feedback of the error moves the output, over that of what the input moves it; None without one.

    A simulation with a large correction follows the measured output, whatever its dynamics.
    """
    feedback = fit.hypothesis.feedback
    if feedback is None:
        return None
    w = fit.hypothesis.actuator(fit.theta, data.u)
    parts = (w - np.mean(w), feedback.of(data.y) - feedback.of(fit.output))
    moved, corrected = (section(*fit.rates, part)[data.rows, 0] for part in parts)
    return float(np.std(corrected) / max(np.std(moved), np.finfo(float).tiny))


def _fitted(data: Data, rate: float) -> FilteredEquation | None:
    """The equation from filters of a rate; None if it has no solution in continuous time."""
    found, (c, k) = None, (2.0 * rate, rate**2)
    for _ in range(ITERATIONS):
        found = _equation(data, c, k)
        if found is None:
            return None
        slowest = SLOWEST / data.longest
        mirrored = [complex(-max(abs(pole.real), slowest), pole.imag) for pole in found.poles]
        c, k = map(float, np.poly(mirrored).real[1:])
    return found


def _columns(data: Data, c: float, k: float) -> tuple[FloatArray, FloatArray]:
    """Regressors and target of the equation behind the filter s^2 + c s + k."""
    u, y = section(c, k, data.u - data.u[0]), section(c, k, data.y - data.y[0])
    X = np.column_stack([y[:, :2], u[:, :2], u[:, 2:], np.ones(data.samples)])[data.rows]
    return X, (data.y - data.y[0])[data.rows]


def _error_with_direct_term(data: Data, c: float, k: float) -> float:
    """Mean square error of the equation that also has the input of the same sample."""
    X, target = _columns(data, c, k)
    X = np.column_stack([X, (data.u - data.u[0])[data.rows]])
    return _solved(X, target)[1]


def _solved(X: FloatArray, target: FloatArray) -> tuple[FloatArray, float]:
    """The least-squares solution, and the mean square of its error by the degrees of freedom."""
    theta = lstsq(X, target, lapack_driver="gelsy")[0]
    error = target - X @ theta
    return theta, float(error @ error) / max(target.size - X.shape[1], 1)


def _equation(data: Data, c: float, k: float) -> FilteredEquation | None:
    """The filtered equation with the filter s^2 + c s + k, by least squares."""
    X, target = _columns(data, c, k)
    theta, square = _solved(X, target)
    d1, d2 = denominator(c, k)
    z = np.roots([1.0, d1 - theta[0], d2 - theta[1]])
    if not np.isfinite(z).all() or np.any(np.isreal(z) & (z.real <= 0.0)) or np.any(z == 0.0):
        return None
    largest = z[np.argmax(z.real)]
    slope = np.array([largest, 1.0]) / (2.0 * largest + d1 - theta[0]) / largest  # of log z by the two numbers
    covariance = pinvh(X.T @ X)[:2, :2] * square
    variance = float(np.real(slope @ covariance @ slope))
    gain = float(theta[2] + theta[3]) / (1.0 + d1 + d2)
    return FilteredEquation(np.log(z.astype(complex)), (c, k), gain, np.sqrt(max(variance, 0.0)), square)
