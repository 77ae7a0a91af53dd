"""Choose the linear model of a record: least squares, or output error of first or of the given order."""

from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import minimize_scalar

from labsid._arrays import FloatArray
from labsid.gap.dynamics import _kernels
from labsid.gap.dynamics.responses import real_rates, single_pole
from labsid.gap.fits.fitting import Fit, Problem, finish
from labsid.gap.fits.hypothesis import Hypothesis
from labsid.gap.fits.linear_fits import LINEAR, linear_structure_of
from labsid.gap.record.data import Data
from labsid.gap.verdict.held_out_errors import HeldOut, Refit

OBSERVED_TIME_CONSTANTS = 6.0  # in the record: a slower pole is not identified; set by hand
INTEGRATOR_SHARE = 0.25  # of the error of every other model: a pole too slow to be seen is an integrator's; set by hand
PREFERENCE = 0.97  # error of another model over that of output error, from which it is chosen; set by hand
AS_GOOD = 1.05  # mean square error of a first-order fit over a second-order one, that is as good; set by hand
FASTEST_RATE = 3.0  # per sample; set by hand
LEAST_SQUARES, FIRST_ORDER, OUTPUT_ERROR = "least squares", "output error of first order", "output error"


@dataclass(frozen=True, slots=True, eq=False)
class LinearModel:
    """A linear model of a record.

    Attributes
    ----------
    method : str
        How it was fitted.
    fit : Fit
    observed : bool
        Whether the record is long enough to show the slowest pole of the output-error fit of the given order.
    errors : dict
        Rms free-run error on the held-out samples of every method tried.
    """

    method: str
    fit: Fit
    observed: bool
    errors: dict[str, float]


def choose_linear_model(held_out: HeldOut, output_error: Fit, leaves_noise: bool = False) -> LinearModel:
    """Choose the linear model with the smallest free-run error on held-out samples.

    Output error of the given order is kept unless another model is clearly better. A model whose slowest pole has a
    time constant of more than a sixth of the record is not chosen, because the record is too short to show that pole;
    unless every other model leaves several times its error, as for a rig that integrates its input, or the held-out
    samples are in records that no fit has seen: there a pole that stands for a drift does not predict. Where the model
    leaves nothing but noise, no drift is there for a pole to stand for.

    Parameters
    ----------
    held_out : HeldOut
    output_error : Fit
        Output-error fit of the given order to the rows that are not held out.
    leaves_noise : bool
        Whether that fit to all rows leaves white noise.
    """
    data = held_out.data
    methods: dict[str, Refit | None] = {OUTPUT_ERROR: None, FIRST_ORDER: fit_first_order, LEAST_SQUARES: fit_arx_poles}
    if output_error.hypothesis.feedback is not None:  # an unstable rig has two poles; noise in its loop biases the last
        methods = {OUTPUT_ERROR: None}
    fits = {name: output_error if fit is None else fit(data, output_error) for name, fit in methods.items()}
    errors = {name: float(np.sqrt(np.mean(held_out.errors(fit, methods[name])))) for name, fit in fits.items()}
    observed = {method: is_observed(data, fit) for method, fit in fits.items()}

    def order(method: str) -> tuple[bool, float]:
        return not (observed[method] or held_out.elsewhere or leaves_noise), errors[method] * (
            PREFERENCE if method == OUTPUT_ERROR else 1.0
        )

    best = min(fits, key=order)
    if errors[OUTPUT_ERROR] < INTEGRATOR_SHARE * errors[best]:
        best = OUTPUT_ERROR
    return LinearModel(best, fits[best], observed[OUTPUT_ERROR], errors)


def is_observed(data: Data, fit: Fit) -> bool:
    """Whether the record is long enough to show the slowest pole of a linear fit."""
    return shows(data.longest, *fit.rates)


def without_unseen_pole(data: Data, fit: Fit) -> Fit:
    """A linear fit of first order in the place of one whose slower pole the record is too short to show, if as good.

    A zero cancels such a pole; a load that is not cancelled would seem to be integrated.
    """
    if is_observed(data, fit) or fit.hypothesis.plant.feedthrough or fit.hypothesis.feedback is not None:
        return fit
    first = fit_first_order(data, fit)
    return first if first.cost < AS_GOOD * fit.cost else fit


def shows(samples: int, c: float, k: float) -> bool:
    """Whether so many samples show the slower pole of s^2 + c s + k; of a pair its natural frequency counts."""
    slowest = real_rates(c, k)[0] if 0.25 * c * c > k else np.sqrt(k)  # per sample
    return bool(slowest * samples >= OBSERVED_TIME_CONSTANTS)


def fit_first_order(data: Data, like: Fit | None = None) -> Fit:
    """Output-error fit of one pole that the record is long enough to show.

    `like` states what belongs to each of several records.
    """
    structure = LINEAR if like is None else linear_structure_of(like)
    problem = Problem(data, structure)
    slowest = np.log(OBSERVED_TIME_CONSTANTS / data.longest)
    grid = np.linspace(slowest, np.log(FASTEST_RATE), 20)

    def cost(log_rate: float) -> float:
        point = problem.point(_theta(structure, *single_pole(float(np.exp(log_rate)))))
        return np.inf if point is None else point.cost

    best = grid[int(np.argmin([cost(rate) for rate in grid]))]
    step = grid[1] - grid[0]
    bounds = (max(best - step, slowest), best + step)
    rate = minimize_scalar(cost, bounds=bounds, method="bounded", options={"xatol": 1e-4}).x
    return _fit_at(data, structure, _theta(structure, *single_pole(float(np.exp(rate)))))


def fit_arx_poles(data: Data, like: Fit | None = None) -> Fit:
    """Least squares on ``y(k) = phi(k)' theta`` of second order (UNSW lab, eq. 8), as a simulation.

    A pole on the negative real axis has no equivalent in continuous time; it is replaced by a fast one. `like` states
    what belongs to each of several records.
    """
    structure = LINEAR if like is None else linear_structure_of(like)
    u, y = data.u, data.y
    used = data.rows[2:] & data.rows[1:-1] & data.rows[:-2]
    Phi = np.column_stack([y[1:-1], y[:-2], u[1:-1], u[:-2], np.ones(u.size - 2)])
    theta = np.linalg.lstsq(Phi[used], y[2:][used], rcond=None)[0]
    poles = np.roots([1.0, -theta[0], -theta[1]])
    rates = -np.log(np.where(np.abs(poles) > 1e-3, poles, 1e-3).astype(complex))
    if np.isreal(poles).all():
        rates = np.where(np.real(poles) > 1e-3, np.real(rates), FASTEST_RATE)
    c, k = float(np.real(rates.sum())), float(np.real(rates.prod()))
    at = _theta(structure, max(c, 1e-6), max(k, 1e-9))
    with np.errstate(over="ignore", invalid="ignore"):  # poles of least squares may be unstable
        output = _kernels.section(u - u[0], -theta[0], -theta[1])[:, :2] @ theta[2:4]
    if not (np.isfinite(output).all() and np.abs(output).max() < 1e6):
        return _fit_at(data, structure, at)
    gains = Problem(replace(data, y=output), structure).point(at)
    free = Problem(data, structure).point(at)
    if gains is None or free is None:
        return _fit_at(data, structure, at)
    # The numerator is that of least squares; constant and initial state are those of the free run.
    columns = free.design.columns
    fixed, kept = columns[:, :2] @ gains.gains[:2], slice(2, None)
    rest = np.linalg.lstsq(columns[data.rows, kept], (data.y - fixed)[data.rows], rcond=None)[0]
    own = np.concatenate([gains.gains[:2], rest])
    simulated = columns @ own
    error = (data.y - simulated)[data.rows]
    return finish(
        data, structure, replace(free, gains=own, output=simulated, error=error, cost=float(np.mean(error**2)))
    )


def _theta(structure: Hypothesis, c: float, k: float) -> FloatArray:
    """Parameters of a linear structure without delay, further inputs at the start values of their rates."""
    theta = np.zeros(len(structure.parameters))
    first = structure.slices["plant"].start
    theta[first : first + 2] = np.log(c), np.log(k)
    return np.clip(theta, *structure.bounds)


def _fit_at(data: Data, structure: Hypothesis, theta: FloatArray) -> Fit:
    """The best gains at fixed poles."""
    point = Problem(data, structure).point(theta)
    if point is None:
        raise ValueError("no linear model can be simulated on this record. Check the signals.")
    return finish(data, structure, point)
