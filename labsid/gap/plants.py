"""The dynamics between actuator and sensor: linear, or with one of the nonlinear states of the table.

Time is counted in samples. A plant turns the actuator's signal w into columns, and the output is a linear combination
of them: gains, the numerator's zeros and the linear initial state never have to be searched.
"""

from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np

from labsid._arrays import FloatArray, beside
from labsid.gap import _kernels
from labsid.gap.responses import denominator, lagging, real_rates, response, section, through_lag, through_mode

SLOWEST, FASTEST = np.log(1e-5), np.log(100.0)
SHORTEST_MEMORY = 12  # of a lag's time constants in a record
LEAST_FLOW = 0.25  # scaled: mean flow for which the rates of tanks with roots are told
MOST_DAMPING = 0.5  # of a mode; beyond, it is two lags


@dataclass(frozen=True, slots=True)
class Parameter:
    """One searched number.

    Attributes
    ----------
    name : str
    lower, upper : float
        Its bounds.
    step : float
        Of its numerical derivative.
    leap : float
        Distance over which the error may have several minima, zero where it has not.
    """

    name: str
    lower: float
    upper: float
    step: float = 1e-4
    leap: float = 0.0


ACROSS = 1e-2  # scaled: a step of a derivative that reaches across the jumps of a motion that sticks
FRICTION = Parameter("friction", 0.0, 20.0, 1e-3, leap=0.03)
ONSET = Parameter("onset", 0.0, 1.0, 2e-4, leap=0.004)  # as a share of the record
DRIFT = Parameter("drift", -3.0, 3.0)
CYCLES = Parameter("cycles", 2.2, 1e7, 1e-3)  # of a wave in the record; a slower one is a drift


@dataclass(frozen=True, slots=True)
class Plant:
    """Which dynamics: two poles, plus what the effects of a hypothesis put in.

    Attributes
    ----------
    kind : str
        "linear", "tanks", "mechanics", "speed", "varying", or "given": a simulation that is not ours.
    zero : bool
        Whether linear dynamics have one: two gains, not one, of the exact response to held levels.
    lag, mode : bool
        One more real pole; one more lightly damped pair.
    upper_root, lower_root : bool
        Torricelli outflow of the upper and of the lower tank.
    brim : int
        0 none, 1 the upper tank's, 2 the lower tank's, 3 both.
    flipped : bool
        The input counts outflow: more u means less flow.
    friction, cubic : bool
        Dry friction, cubic restoring force.
    sampled : bool
        Whether the input may be sampled, and not held: then it comes up to half a sample early.
    unsprung : bool
        Whether what rubs has next to no spring: a constant force is then no shift of its position.
    lag_first : bool
        The lag of the speed stands before the friction, not behind it.
    lag_ahead : bool
        The further lag stands before a nonlinear state, not behind it.
    mode_place : str
        Where the mode stands beside a nonlinear state: "behind" it, "ahead" of it, or "beside" it.
    course : str
        How a varying pole goes along the record: "slow", or "step" at an instant, without a jump of the output: its
        speed jumps, by the searched `turn` none of it or all, where what changes is the rate of the latter lag.
    fading : bool
        Whether the rate of the latter of two nonlinear states, or a nonlinear spring, goes along a slow course.
    bends : int
        Degrees above one of a slow course.
    loaded, shaken : bool
        Whether a load, and one that grows with the state, begins at an instant, or one swings; of nonlinear states.
    load_ahead, shaken_ahead : bool
        It enters ahead of the former of two states in a row, not of the latter one, and does not grow.
    run : callable, optional
        ``run(w) -> y`` of a given simulation, in scaled units.
    takes_input : bool
        Whether that simulation can be run on another input.
    given_rates : tuple of float
        c and k of a linear model of the same record, for loads that pass through the dynamics.
    parameters : tuple of Parameter
        The searched numbers, in their order in theta.
    """

    kind: str = "linear"
    zero: bool = True
    lag: bool = False
    mode: bool = False
    upper_root: bool = False
    lower_root: bool = False
    brim: int = 0
    flipped: bool = False
    friction: bool = False
    cubic: bool = False
    sampled: bool = False
    unsprung: bool = False
    lag_first: bool = True
    lag_ahead: bool = False
    mode_place: str = "behind"
    course: str = "slow"
    fading: bool = False
    bends: int = 0
    loaded: bool = False
    shaken: bool = False
    load_ahead: bool = False
    shaken_ahead: bool = False
    run: Callable[[FloatArray], FloatArray] | None = field(default=None, compare=False)
    takes_input: bool = False
    given_rates: tuple[float, float] = (0.5, 0.05)
    parameters: tuple[Parameter, ...] = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "parameters", self._searched())

    def _searched(self) -> tuple[Parameter, ...]:
        if self.kind == "given":
            return ()
        rates = [Parameter("log_c", -14.0, 3.5), Parameter("log_k", -22.0, 4.0)]
        if self.kind in ("tanks", "speed"):
            rates = [Parameter("log_a", SLOWEST, FASTEST), Parameter("log_b", SLOWEST, FASTEST)]
        own: list[Parameter] = []
        if self.kind == "tanks":
            if self.upper_root or self.lower_root:
                own += [Parameter("zero", -200.0, 3.0)]
            if self.brim:
                own += [Parameter("brim", -5.0, 400.0, leap=0.05)]
            if self.brim != 2 and self.brim:
                own += [Parameter("share", 0.0, 1.0)]
            if self.brim == 3:
                own += [Parameter("brim2", -5.0, 400.0, leap=0.05)]
            own += [Parameter("h1", -50.0, 50.0), Parameter("h2", -50.0, 50.0)]
        elif self.kind == "mechanics":
            if self.friction:
                own += [FRICTION]
            if self.cubic:
                own += [Parameter("cubic", -0.3, 50.0)]
            if self.cubic or self.fading or self.unsprung:
                own += [Parameter("centre", -8.0, 8.0)]
            own += [Parameter("z0", -50.0, 50.0, ACROSS, leap=0.05), Parameter("v0", -50.0, 50.0, ACROSS)]
        elif self.kind == "speed":
            own += [FRICTION, Parameter("centre", -20.0, 20.0, 1e-3)]
            own += [Parameter("v0", -50.0, 50.0, ACROSS), Parameter("i0", -50.0, 50.0, ACROSS)]
        elif self.kind == "varying":
            own += [DRIFT, Parameter("share_c", -3.0, 3.0), Parameter("turn", 0.0, 1.0)]
            own += [ONSET] if self.course == "step" else self._bent()
        if self.fading:
            own += [DRIFT, *self._bent()]
        if self.loaded:
            own += [Parameter("load", -20.0, 20.0)]
            own += [ONSET] if self.load_ahead else [Parameter("leak", -0.9, 20.0), ONSET]
        if self.shaken:
            own += [CYCLES, Parameter("shake_cos", -20.0, 20.0), Parameter("shake_sin", -20.0, 20.0)]
        if self.lag:
            own += [Parameter("log_lag", -4.0, 8.0)]
        if self.mode:
            own += [Parameter("log_frequency", -6.0, np.log(np.pi))]
            own += [Parameter("log_damping", -7.0, np.log(MOST_DAMPING))]
        return tuple(rates + own)

    def _bent(self) -> list[Parameter]:
        return [Parameter(f"bend{n}", -3.0, 3.0) for n in range(1, self.bends + 1)]

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
                driven = through_lag(driven, tau)
        if self.mode:
            frequency, damping = np.exp(own["log_frequency"]), np.exp(own["log_damping"])
            if self._mode_place == "ahead":
                driven = through_mode(driven, frequency, damping)
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
                columns[:, 0] = lagging(moved, np.gradient(moved) if slope is None else slope, tau)
            parts.append(np.asarray(pole ** np.arange(w.size), np.float64)[:, None])
        if self.mode and self._mode_place != "ahead":
            drive = moved if self._mode_place == "behind" else _kernels.delayed(w - start, 0, late)
            parts.append(section(2.0 * damping * frequency, frequency**2, drive))
        return beside(parts) if len(parts) > 1 else columns

    @property
    def nonlinear(self) -> bool:
        """Whether a state is nonlinear, so that it matters what stands before it and what behind."""
        return self.kind in ("tanks", "mechanics", "speed")

    @property
    def in_a_row(self) -> bool:
        """Whether there are two states in a row, and a load may enter ahead of either."""
        return self.kind == "tanks" or (self.kind == "speed" and self.lag_first)

    @property
    def _lag_ahead(self) -> bool:
        return self.lag_ahead and self.nonlinear

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

    def through(self, theta: FloatArray, signal: FloatArray) -> FloatArray:
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

    def index(self, name: str) -> int:
        """Place of a parameter in theta."""
        return [parameter.name for parameter in self.parameters].index(name)

    def but(self, **changes: object) -> "Plant":
        """The same plant with some attributes changed."""
        return replace(self, **changes)  # type: ignore[arg-type]
