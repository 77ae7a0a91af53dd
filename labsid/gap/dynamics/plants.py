"""The dynamics between actuator and sensor: linear, or with a nonlinear state.

Time is in samples. A plant maps the actuator's signal w to columns whose linear combination is the output, so that the
gain, the numerator and the linear initial state are linear parameters.
"""

from dataclasses import dataclass

import numpy as np

from labsid._arrays import FloatArray, beside
from labsid.gap.dynamics import _kernels
from labsid.gap.dynamics.plant_form import LEVEL_OF, RATE_OF, Named, PlantForm
from labsid.gap.dynamics.responses import (
    damped_share,
    decay_rates,
    force_unit,
    free_responses,
    lag_mean,
    lag_output,
    mode_mean,
    real_rates,
    response,
    section,
    sprung_share,
)

MIN_TIME_CONSTANTS = 12  # of a lag in a record: a slower lag would imitate a drift; set by hand
MIN_FLOW = 0.25  # scaled: smallest mean flow at which square-root outflow is linearized; set by hand
SMALLEST_CURVATURE = 0.1  # of that before a step: the least one after it; numerics


@dataclass(frozen=True, slots=True)
class Plant(PlantForm):
    """Dynamics with their simulation and linearization."""

    def columns(
        self,
        theta: FloatArray,
        w: FloatArray,
        span: int,
        reference: float | None = None,
        late: float = 0.0,
        feedback: FloatArray | None = None,
    ) -> FloatArray:
        """Columns whose linear combination is the output; NaN where the simulation diverges.

        Parameters
        ----------
        theta : ndarray, shape (len(parameters),)
        w : ndarray, shape (N,)
            Scaled signal of the actuator.
        span : int
            Length of the fitted record, the time unit of slow changes.
        reference : float, optional
            Operating point of w for a linear plant: the first sample of the fitted record; w[0] by default.
        late : float
            Fraction of each sample at which w changes, 0 to 1.
        feedback : ndarray, shape (N,), optional
            What drives the dynamics beside w, but no further lag or mode.

        Returns
        -------
        ndarray, shape (N, m)
        """
        own = self._by_name(theta)
        start = float(w[0]) if reference is None else reference
        if late and (feedback is not None or not self.nonlinear or self.lag_ahead or self._mode_place == "ahead"):
            w, late = _kernels.delayed(w, 0, late), 0.0  # mean over each sample
        driven = w
        if self.lag:
            tau = lag_time(own, span)
            pole = float(np.exp(-1.0 / tau))
            if self.lag_ahead:
                driven = lag_mean(driven, tau)
        if self.mode:
            frequency, damping = np.exp(own["log_frequency"]), np.exp(own["log_damping"])
            if self._mode_place == "ahead":
                driven = mode_mean(driven, frequency, damping)
        driven = driven if feedback is None else driven + feedback
        columns = response(self, own, driven, span, start, late)
        slope = columns[:, 1] if self.kind == "mechanics" else None
        if self.kind in ("mechanics", "speed"):
            columns = columns[:, :1].copy()
        parts: list[FloatArray] = [columns]
        deviation = w - start if self.kind == "linear" else columns[:, 0].copy()
        if self.lag and not self.lag_ahead:
            if self.kind == "linear":
                parts.append(_kernels.first_order(deviation, pole)[:, None])
            else:
                columns[:, 0] = lag_output(deviation, np.gradient(deviation) if slope is None else slope, tau)
        if self.lag and (self.kind == "given" or not self.lag_ahead):
            parts.append(np.exp(-np.arange(w.size) / tau)[:, None])
        if self.mode and self._mode_place != "ahead":
            drive = deviation if self._mode_place == "behind" else _kernels.delayed(w - start, 0, late)
            parts.append(section(2.0 * damping * frequency, frequency**2, drive))
        if self.slow:
            rate = float(np.exp(-own["log_slow"]))
            parts.append(_kernels.first_order(_kernels.delayed(w - start, 0, late), float(np.exp(-rate)))[:, None])
            parts.append(np.exp(-rate * np.arange(w.size))[:, None])
        if self.feedthrough:
            parts.append((w - start)[:, None])
        return beside(parts) if len(parts) > 1 else columns

    @property
    def lag_ahead(self) -> bool:
        """Whether the additional lag acts on the input of the other dynamics."""
        return self.kind == "given" or (self.lag == "ahead" and self.nonlinear)

    @property
    def _mode_place(self) -> str:
        if self.kind == "given" and self.mode == "behind":
            return "ahead"
        return self.mode if self.nonlinear or self.kind == "given" else self.mode and "behind"

    def _by_name(self, theta: FloatArray) -> Named:
        return {parameter.name: value for parameter, value in zip(self.parameters, theta, strict=True)}

    @property
    def has_fixed_gain(self) -> bool:
        """Whether the gain of the first column is known: of given numbers, of a joint, or beside a feedback."""
        return bool(self.free) or self.follows or self.stabilised or self.simulation.port is not None

    @property
    def state_columns(self) -> tuple[int, ...]:
        """Indices of the columns whose gains are the initial state."""
        own: tuple[int, ...] = ()
        width = 1
        if self.kind == "linear":
            own, width = ((2, 3), 5) if self.zero else ((1, 2), 4)
        elif self.kind == "varying":
            own, width = (6, 7), 8
        elif self.kind == "leak":
            own, width = (4, 5), 6
        elif self.kind == "given" and self.simulation.takes_input:
            own, width = ((1, 2), 3) if self.simulation.port is None else ((), 1)
        if self.lag and (self.kind == "given" or not self.lag_ahead):
            width += 2 if self.kind == "linear" else 1
            own = (*own, width - 1)
        if self.mode and self._mode_place != "ahead":
            own, width = (*own, width + 2, width + 3), width + 4
        return (*own, width + 1) if self.slow else own

    @property
    def slow_column(self) -> int:
        """Index of the column of the slow mode."""
        return self.state_columns[-1] - 1

    def motion(self, theta: FloatArray, w: FloatArray) -> FloatArray:
        """Output of a mass or a motor, and the speed against which friction acts, shape (N, 2)."""
        return response(self, self._by_name(theta), w, w.size, float(w[0]))

    def loop_error(self, theta: FloatArray, w: FloatArray) -> FloatArray:
        """Error in the loop of a drive, without its limit, in units of `w`, shape (N,)."""
        own = self._by_name(theta)
        (c, k), motion = self.linear_rates(theta), self.motion(theta, w)
        unit = force_unit(c, k)
        drive = w - own.get("centre", float(w[0]))
        error = drive - sprung_share(self, own) * k / unit * motion[:, 0]
        return np.asarray(error - damped_share(self, own) * c / unit * motion[:, 1])

    def load_response(self, theta: FloatArray, signal: FloatArray) -> FloatArray:
        """Columns of the linearized response to an unmeasured load `signal`, shape (N, 2)."""
        c, k = self.linear_rates(theta)
        return section(c, k, signal)[:, :2].copy()

    @property
    def n_poles(self) -> int:
        """Number of poles of the linearized dynamics."""
        return 2 + bool(self.lag) + 2 * bool(self.mode) + self.slow

    def free_responses(self, theta: FloatArray, samples: int, span: int) -> FloatArray:
        """Columns of the free responses of the linearized dynamics, shape (samples, n_poles)."""
        own = self._by_name(theta)
        parts = [free_responses(samples, *self.linear_rates(theta))]
        if self.lag:
            parts.append(np.exp(-np.arange(samples) / lag_time(own, span))[:, None])
        if self.mode:
            frequency, damping = np.exp(own["log_frequency"]), np.exp(own["log_damping"])
            parts.append(free_responses(samples, 2.0 * damping * frequency, frequency**2))
        if self.slow:
            parts.append(np.exp(-np.exp(-own["log_slow"]) * np.arange(samples))[:, None])
        return beside(parts)

    def linear_rates(self, theta: FloatArray) -> tuple[float, float]:
        """Coefficients c and k of s^2 + c s + k: of the linear part, or linearized at the mean flow."""
        if self.kind == "given":
            return self.simulation.rates
        first, second = np.exp(theta[0]), np.exp(theta[1])
        if self.kind in ("tanks", "speed"):
            upper, lower = self.level_slopes(theta)
            a, b = first / upper, second / lower
            return float(a + b), float(a * b)
        return float(first), float(second)

    def slowest_rates(self, theta: FloatArray, span: int) -> tuple[float, float]:
        """c and k of the two poles of the linearized dynamics that decay most slowly."""
        (c, k), own = self.linear_rates(theta), self._by_name(theta)
        main = decay_rates(c, k)
        others = [1.0 / lag_time(own, span)] if self.lag else []
        others += [float(np.exp(own["log_frequency"] + own["log_damping"]))] * 2 if self.mode else []
        others += [float(np.exp(-own["log_slow"]))] if self.slow else []
        slowest = sorted((*main, *others))[:2]
        return (c, k) if slowest == sorted(main) else (slowest[0] + slowest[1], slowest[0] * slowest[1])

    def root_slope(self, theta: FloatArray) -> float:
        """Derivative of the level by the flow at the mean flow, for square-root outflow."""
        return 2.0 * max(-float(theta[self.index("zero")]), MIN_FLOW)

    def flatter(self, theta: FloatArray) -> FloatArray:
        """Change of theta for a relative change of the curvature of root outflow; the linearized dynamics stay.

        Where the mean flow is nearly zero, that of "zero" alone.
        """
        change, at = np.zeros(theta.size), self.index("zero")
        if theta[at] >= -MIN_FLOW:
            change[at] = 1.0
            return change
        change[at] = theta[at]
        for rate, level in self._of_roots():
            change[rate], change[level] = 1.0, theta[level]
        return change

    def stepped(self, theta: FloatArray, step: FloatArray) -> FloatArray:
        """Theta after a step, whose entry for "zero" is one of `flatter`; the curvature changes by this share."""
        new, at = theta + step, self.index("zero")
        if theta[at] >= -MIN_FLOW:
            return new
        ratio = 1.0 / max(1.0 - step[at], SMALLEST_CURVATURE)
        new[at] = theta[at] * ratio
        for rate, level in self._of_roots():
            new[rate] += np.log(ratio)
            new[level] *= ratio
        return new

    def _of_roots(self) -> list[tuple[int, int]]:
        """Places of the rate and the initial level of each tank with root outflow."""
        return [(self.index(RATE_OF[tank]), self.index(LEVEL_OF[tank])) for tank in self.roots]

    def level_slopes(self, theta: FloatArray) -> tuple[float, float]:
        """Derivatives of the upper and lower levels by the flow; one for linear outflow."""
        upper, lower = (self.root_slope(theta) if tank in self.roots else 1.0 for tank in ("upper", "lower"))
        return upper, lower

    def starts(self, c: float, k: float) -> list[FloatArray]:
        """Start values of theta from the rates of a linear fit; other parameters are zero."""
        if self.kind == "given":
            return [np.zeros(len(self.parameters))]
        others = np.zeros(len(self.parameters) - 2)
        return [np.array([*rates, *others]) for rates in self._rates(c, k)]

    def _rates(self, c: float, k: float) -> list[tuple[float, float]]:
        if self.kind not in ("tanks", "speed"):
            return [(np.log(c), np.log(k))]
        slow, fast = real_rates(c, k)
        return [(np.log(slow), np.log(fast)), (np.log(fast), np.log(slow))]


def lag_time(own: Named, span: int) -> float:
    """Time constant of the additional lag."""
    return float(min(np.exp(own["log_lag"]), span / MIN_TIME_CONSTANTS))
