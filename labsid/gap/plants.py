"""The dynamics between actuator and sensor: linear, or with one of the nonlinear states of the table.

Time is counted in samples. A plant turns the actuator's signal w into columns, and the output is a linear combination
of them: gains, the numerator's zeros and the linear initial state never have to be searched.
"""

from dataclasses import dataclass

import numpy as np

from labsid._arrays import FloatArray, beside
from labsid.gap import _kernels
from labsid.gap.plant_form import PlantForm
from labsid.gap.responses import denominator, lag_mean, lag_output, mode_mean, real_rates, response, section

SHORTEST_MEMORY = 12  # of a lag's time constants in a record
LEAST_FLOW = 0.25  # scaled: mean flow for which the rates of tanks with roots are told


@dataclass(frozen=True, slots=True)
class Plant(PlantForm):
    """Dynamics that can be simulated: columns, speeds and linear rates at given parameters."""

    def columns(
        self, theta: FloatArray, w: FloatArray, span: int, reference: float | None = None, late: float = 0.0
    ) -> FloatArray:
        """Responses whose combinations are the output, one a column; NaN where the simulation diverges.

        Parameters
        ----------
        theta : ndarray, shape (len(parameters),)
        w : ndarray, shape (N,)
            The actuator's signal in its scaled unit.
        span : int
            Length of the record by which slow changes are counted: that of the fit.
        reference : float, optional
            Value of w from which a linear plant counts: that with which the record of the fit began, and this one
            unless given.
        late : float
            How far into each sample w changes, 0 to 1.

        Returns
        -------
        ndarray, shape (N, m)
        """
        own = self._by_name(theta)
        start = float(w[0]) if reference is None else reference
        if late and (not self.nonlinear or self._lag_ahead or (self.mode and self._mode_place == "ahead")):
            w, late = _kernels.delayed(w, 0, late), 0.0  # the mean over each sample
        driven = w
        if self.lag:  # a slower one would be a drift: its free motion bends the whole record
            tau = float(min(np.exp(own["log_lag"]), span / SHORTEST_MEMORY))
            pole = float(np.exp(-1.0 / tau))
            if self._lag_ahead:
                driven = lag_mean(driven, tau)
        if self.mode:
            frequency, damping = np.exp(own["log_frequency"]), np.exp(own["log_damping"])
            if self._mode_place == "ahead":
                driven = mode_mean(driven, frequency, damping)
        columns = response(self, own, driven, span, start, late)
        slope = columns[:, 1] if self.kind == "mechanics" else None
        if self.kind in ("mechanics", "speed"):
            columns = columns[:, :1].copy()
        parts: list[FloatArray] = [columns]
        moved = w - start if self.kind == "linear" else columns[:, 0].copy()
        if self.lag and not self._lag_ahead:
            if self.kind == "linear":
                parts.append(_kernels.first_order(moved, pole)[:, None])
            else:
                columns[:, 0] = lag_output(moved, np.gradient(moved) if slope is None else slope, tau)
            parts.append(np.asarray(pole ** np.arange(w.size), np.float64)[:, None])
        if self.mode and self._mode_place != "ahead":
            drive = moved if self._mode_place == "behind" else _kernels.delayed(w - start, 0, late)
            parts.append(section(2.0 * damping * frequency, frequency**2, drive))
        return beside(parts) if len(parts) > 1 else columns

    @property
    def _lag_ahead(self) -> bool:
        return self.lag_upstream and self.nonlinear

    @property
    def _mode_place(self) -> str:
        return self.mode_place if self.nonlinear else "behind"

    def _by_name(self, theta: FloatArray) -> dict[str, float]:
        return {parameter.name: value for parameter, value in zip(self.parameters, theta, strict=True)}

    @property
    def state_columns(self) -> tuple[int, ...]:
        """Which columns hold the initial state; the gains of the others belong to the rig."""
        if self.kind == "linear":
            width = 5 if self.zero else 4
            own: tuple[int, ...] = (width - 3, width - 2)
        elif self.kind == "varying":
            width = 6 if self.course == "step" else 8
            own = (width - 2, width - 1)
        else:
            own, width = (), 1
        if self.lag and not self._lag_ahead:
            width += 2 if self.kind == "linear" else 1
            own = (*own, width - 1)
        if self.mode and self._mode_place != "ahead":
            own = (*own, width + 2, width + 3)
        return own

    def speed(self, theta: FloatArray, w: FloatArray) -> FloatArray:
        """The speed against which friction acts, shape (N,)."""
        own = self._by_name(theta)
        return response(self, own, w, w.size, float(w[0]))[:, 1]

    def load_response(self, theta: FloatArray, signal: FloatArray) -> FloatArray:
        """What an unmeasured load `signal` that enters the dynamics does to the output, linearised; shape (N, 2)."""
        c, k = self.linear_rates(theta)
        a1, a2 = denominator(c, k)
        x = _kernels.second_order(signal, a1, a2)
        return np.column_stack([x, np.concatenate([[0.0], x[:-1]])])

    def linear_rates(self, theta: FloatArray) -> tuple[float, float]:
        """The coefficients c and k of s^2 + c s + k, of the linear part or near the middle of the record."""
        if self.kind == "given":
            return self.given_rates
        first, second = np.exp(theta[0]), np.exp(theta[1])
        if self.kind in ("tanks", "speed"):
            upper, lower = self.level_slopes(theta)
            a, b = first / upper, second / lower
            return float(a + b), float(a * b)
        return float(first), float(second)

    def root_slope(self, theta: FloatArray) -> float:
        """By how much a level with a root at its outflow changes with the flow, near the mean flow."""
        return 2.0 * max(-float(theta[self.index("zero")]), LEAST_FLOW)

    def level_slopes(self, theta: FloatArray) -> tuple[float, float]:
        """The same of the upper and of the lower tank; one where the outflow goes with the level."""
        upper, lower = (self.root_slope(theta) if root else 1.0 for root in (self.upper_root, self.lower_root))
        return upper, lower

    def starts(self, c: float, k: float) -> list[FloatArray]:
        """Where the search of the rates begins, given those of a linear fit; the effects add their own numbers."""
        if self.kind == "given":
            return [np.zeros(0)]
        with_defaults = []
        for rates in self._rates(c, k):
            theta = np.zeros(len(self.parameters))
            theta[:2] = rates
            with_defaults.append(theta)
        return with_defaults

    def _rates(self, c: float, k: float) -> list[tuple[float, float]]:
        if self.kind not in ("tanks", "speed"):
            return [(np.log(c), np.log(k))]
        slow, fast = real_rates(c, k)
        return [(np.log(slow), np.log(fast)), (np.log(fast), np.log(slow))]
