"""The output of a simulation on the record's input: brought to the record's times, and identified as a linear model.

The output holds no noise, so the model that made it shows to the last digit of the file: least squares on a difference
equation, then its coefficients refined by output error.
"""

from dataclasses import dataclass
from functools import partial

import numpy as np
from scipy.interpolate import make_interp_spline

from labsid._arrays import FloatArray
from labsid.gap.fits.floor import digit_step
from labsid.gap.simulations.model_json import TransferFunction
from labsid.records.signal_quality import lattice_step

HIGHEST_ORDER = 6  # of the models that are compared; set by hand
ENOUGH = 1e-9  # of the standard deviation: what rounding leaves of a free run; numerics
ROUNDING = 0.5  # units of the last digit, rms (pure rounding leaves 0.29); set by hand
MAX_ERROR = 1e-3  # of the standard deviation: what a solver's tolerance leaves; set by hand
MIN_GAIN = 0.7  # error of a higher order over that of a lower one, from which it is taken; set by hand
REFINED = 0.05  # of the standard deviation: a larger error of the difference equation is not refined; set by hand
EVALUATIONS = 30  # of the refinement; numerics
LONGEST = 3000  # samples from which a model is identified; it has to reproduce all; numerics
LONGEST_DEAD_TIME = 200  # samples; set by hand
DEAD_TIME_ORDER = 3  # of the difference equations that are compared for the dead time; set by hand
DIVERGED = 1e6  # size of a state from which a simulation has diverged; numerics


@dataclass(frozen=True, slots=True, eq=False)
class SimulatedOutput:
    """The output of any simulator on the record's input.

    Attributes
    ----------
    y : ndarray, shape (N,)
    resampled : str
        How it was brought to the record's times: "" if it has them, "linearly" or "by a cubic spline".
    """

    y: FloatArray
    resampled: str = ""


@dataclass(frozen=True, slots=True, eq=False)
class OutputModel:
    """A linear model of a simulated output.

    Attributes
    ----------
    function : TransferFunction
    order : int
        Number of poles, without those of a dead time.
    error : float
        Rms error of its free run over the standard deviation of the output.
    """

    function: TransferFunction
    order: int
    error: float

    @property
    def dead_time(self) -> int:
        """Dead time in samples, beyond the one of a strictly proper model."""
        return self.function.dead_time


def resample(t: FloatArray, y: FloatArray, at: FloatArray) -> SimulatedOutput:
    """Interpolate an output, linearly or by a cubic spline: whichever predicts every other sample from its neighbours
    with the smaller error.

    Parameters
    ----------
    t, y : ndarray, shape (M,)
        Ascending times that include those of the record, and the output there.
    at : ndarray, shape (N,)
        Times of the record.
    """
    methods = {"linearly": 1, "by a cubic spline": 3}
    errors = dict.fromkeys(methods, np.inf)
    if t.size > 2 * (max(methods.values()) + 1):
        inside = slice(1, t.size - 1 - t.size % 2, 2)
        for name, degree in methods.items():
            predicted = make_interp_spline(t[::2], y[::2], degree)(t[inside])
            errors[name] = float(np.mean((predicted - y[inside]) ** 2))
    best = min(errors, key=errors.__getitem__)
    within = np.clip(at, t[0], t[-1])
    return SimulatedOutput(np.asarray(make_interp_spline(t, y, methods[best])(within)), best)


def identify_output(u: FloatArray, y: FloatArray, Ts: float) -> OutputModel | None:
    """Identify the linear model that made a simulated output; None if none reproduces it.

    The lowest order, without a direct term where it needs none, that leaves nothing but the digits of the output; or,
    if all leave more, the one from which on higher orders gain little.

    Parameters
    ----------
    u, y : ndarray, shape (N,)
        Input of the record and simulated output.
    Ts : float
        Sampling time in seconds.
    """
    if np.ptp(y) == 0.0:
        return None
    scale = float(np.std(y))
    about_u, about_y = float(np.mean(u)), float(np.mean(y))
    w, z = (u - about_u) / (float(np.std(u)) or 1.0), (y - about_y) / scale
    enough = max(ENOUGH, ROUNDING * (_last_digit(u) / (float(np.std(u)) or 1.0) + _last_digit(y) / scale))
    best = _whole(w, z, _simplest_model(*_most_excited(w, z), enough))
    if best is None or best.error > max(enough, MAX_ERROR):
        return None
    return OutputModel(best.function(u, scale, about_u, about_y, Ts), best.den.size - 1, best.error)


@dataclass(frozen=True, slots=True, eq=False)
class _Equation:
    """den(z) y = z^-late (num(z) u + level), in scaled signals, with coefficients from the newest sample on."""

    num: FloatArray
    den: FloatArray
    level: float
    late: int
    error: float

    def function(self, u: FloatArray, scale: float, about_u: float, about_y: float, Ts: float) -> TransferFunction:
        """In the units of the signals. The level is that of the input or of the output, whichever is determined."""
        num = self.num * scale / (float(np.std(u)) or 1.0)
        at_u, at_y = float(num.sum()), float(self.den.sum())
        level = scale * self.level
        if abs(at_u) * np.abs(self.den).sum() > abs(at_y) * np.abs(num).sum():
            about_u -= level / at_u
        else:
            about_y += level / at_y
        size = max(num.size, self.den.size)
        num, den = (np.concatenate([one, np.zeros(size - one.size)]) for one in (num, self.den))
        return TransferFunction(
            np.trim_zeros(num, "f"), np.concatenate([den, np.zeros(self.late)]), Ts, about_u, about_y
        )


def _last_digit(x: FloatArray) -> float:
    """Unit of the last digit of a signal in a text file, rms."""
    return max(digit_step(x), lattice_step(x) or 0.0)


def _most_excited(u: FloatArray, y: FloatArray) -> tuple[FloatArray, FloatArray]:
    """The part of a long record with the largest variance of the input."""
    starts = range(0, max(u.size - LONGEST, 0) + 1, LONGEST // 2)
    first = max(starts, key=lambda start: float(np.var(u[start : start + LONGEST])))
    return u[first : first + LONGEST], y[first : first + LONGEST]


def _whole(u: FloatArray, y: FloatArray, model: _Equation | None) -> _Equation | None:
    """A model of a part of the record, with the error and the coefficients of the whole."""
    if model is None or u.size <= LONGEST:
        return model
    direct = bool(model.num[0])
    found, error = _free_run(u[: u.size - model.late], y[model.late :], direct, model.den)
    return _equation(found, error, direct, model.den, model.late)


def _simplest_model(u: FloatArray, y: FloatArray, enough: float) -> _Equation | None:
    """The model of lowest order, with a dead time where that saves poles at zero."""
    best = _best_model(u, y, 0, enough, HIGHEST_ORDER)
    if best is not None and best.error <= enough and best.den.size <= 2:
        return best
    late = _dead_time(u, y)
    if not late:
        return best
    exact = best is not None and best.error <= enough
    highest = best.den.size - 2 if best is not None and exact else HIGHEST_ORDER
    delayed = [_best_model(u, y, more, enough, highest) for more in (late, late + 1)]
    return _lowest_order([best, *delayed], enough)


def _best_model(u: FloatArray, y: FloatArray, late: int, enough: float, highest: int) -> _Equation | None:
    """The first model that leaves no more than `enough`, or else the one from which on more terms gain little.

    With a dead time the first samples, whose input is unknown, are left out.
    """
    best: _Equation | None = None
    u, y = u[: u.size - late], y[late:]
    for order in range(highest + 1):
        for direct in (False, True) if order else (True,):
            found = _model(u, y, order, direct, late, enough)
            if found is not None and (best is None or found.error < MIN_GAIN * best.error):
                best = found
            if best is not None and best.error <= enough:
                return best
    return best


def _lowest_order(models: list[_Equation | None], enough: float) -> _Equation | None:
    """The model of lowest order of those whose errors are nearly the smallest one."""
    found = [model for model in models if model is not None]
    limit = max(enough, min((model.error for model in found), default=0.0) / MIN_GAIN)
    return min((model for model in found if model.error <= limit), key=lambda model: model.den.size, default=None)


def _model(u: FloatArray, y: FloatArray, order: int, direct: bool, late: int, enough: float) -> _Equation | None:
    """A model of given order, by least squares on its difference equation and then by output error."""
    coefficients, _ = _difference_equation(u, y, order, direct)
    run = partial(_free_run, u, y, direct)
    den = np.concatenate([[1.0], -coefficients[:order]])
    found, error = run(den)
    if order and enough < _rms(error) < REFINED:
        from scipy.optimize import least_squares  # slow to import

        refined = least_squares(
            lambda a: run(np.concatenate([[1.0], a]))[1], den[1:], x_scale="jac", max_nfev=EVALUATIONS
        )
        if _rms(refined.fun) < _rms(error):
            den = np.concatenate([[1.0], refined.x])
            found, error = run(den)
    return _equation(found, error, direct, den, late)


def _equation(found: FloatArray, error: FloatArray, direct: bool, den: FloatArray, late: int) -> _Equation | None:
    """The result of a free run; None if it diverges."""
    if not np.isfinite(found).all() or _rms(error) > 1.0:
        return None
    terms = den.size - 1 + direct
    num = np.concatenate([np.zeros(int(not direct)), found[:terms]])
    return _Equation(num, den, float(found[terms]), late, _rms(error))


def _difference_equation(u: FloatArray, y: FloatArray, order: int, direct: bool) -> tuple[FloatArray, float]:
    """Coefficients of past outputs, inputs and a constant by least squares, and the rms error of the equation."""
    first = 0 if direct else 1
    terms = range(first, order + 1)
    Phi = np.column_stack(
        [*(y[order - k : y.size - k] for k in range(1, order + 1)), *(u[order - k : u.size - k] for k in terms)]
    )
    Phi = np.column_stack([Phi, np.ones(len(Phi))])
    coefficients = np.linalg.lstsq(Phi, y[order:], rcond=None)[0]
    return coefficients, _rms(y[order:] - Phi @ coefficients)


def _free_run(u: FloatArray, y: FloatArray, direct: bool, den: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Numerator, level and initial state that fit `y` best in free run with a denominator, and the error."""
    from scipy.signal import lfilter  # slow to import

    order = den.size - 1
    with np.errstate(all="ignore"):
        through, level = (np.asarray(lfilter([1.0], den, signal)) for signal in (u, np.ones(u.size)))
        lags = range(0 if direct else 1, order + 1)
        columns = [np.concatenate([np.zeros(k), through[: u.size - k]]) for k in lags] + [level]
        columns += [np.asarray(lfilter([1.0], den, np.zeros(u.size), zi=state)[0]) for state in np.eye(order)]
        design = np.column_stack(columns)
        size = np.abs(design).max(axis=0)
        if not np.isfinite(size).all() or size.max() > DIVERGED:
            return np.full(design.shape[1], np.nan), np.full(y.size, DIVERGED)
        size[size == 0.0] = 1.0
        found = np.linalg.lstsq(design / size, y, rcond=None)[0] / size
        return found, y - design @ found


def _dead_time(u: FloatArray, y: FloatArray) -> int:
    """Dead time in samples, from the errors of difference equations whose input is delayed; 0 without one."""
    errors = np.array(
        [
            _difference_equation(u[: u.size - late], y[late:], DEAD_TIME_ORDER, False)[1]
            for late in range(min(LONGEST_DEAD_TIME, u.size // 8))
        ]
    )
    return int(np.flatnonzero(errors <= errors.min() / MIN_GAIN + ENOUGH)[-1])


def _rms(e: FloatArray) -> float:
    return float(np.sqrt(np.mean(e**2)))
