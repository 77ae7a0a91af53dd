"""Which dynamics stand between actuator and sensor, and the numbers of them that are searched."""

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Self

import numpy as np

from labsid._arrays import FloatArray

SLOWEST, FASTEST = np.log(1e-5), np.log(100.0)
MAX_DAMPING = 0.5  # of a mode; beyond, it is two lags


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


STICKING_STEP = 1e-2  # scaled: a step of a derivative that reaches across the jumps of a motion that sticks
FRICTION = Parameter("friction", 0.0, 20.0, 1e-3, leap=0.03)
ONSET = Parameter("onset", 0.0, 1.0, 2e-4, leap=0.004)  # as a share of the record
DRIFT = Parameter("drift", -3.0, 3.0)
CYCLES = Parameter("cycles", 2.2, 1e7, 1e-3)  # of a wave in the record; a slower one is a drift


@dataclass(frozen=True, slots=True)
class PlantForm:
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
    lag_upstream : bool
        The further lag stands before a nonlinear state, not behind it.
    mode_place : str
        Where the mode stands beside a nonlinear state: "behind" it, "ahead" of it, or "beside" it.
    course : str
        How a varying pole goes along the record: "slow", or "step" at an instant, without a jump of the output: its
        speed jumps, by the searched `turn` none of it or all, where what changes is the rate of the latter lag.
    drifting : bool
        Whether the rate of the latter of two nonlinear states, or a nonlinear spring, goes along a slow course.
    extra_degrees : int
        Degrees above one of a slow course.
    has_load, has_sinusoid : bool
        Whether a load, and one that grows with the state, begins at an instant, or one swings; of nonlinear states.
    load_upstream, sinusoid_upstream : bool
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
    lag_upstream: bool = False
    mode_place: str = "behind"
    course: str = "slow"
    drifting: bool = False
    extra_degrees: int = 0
    has_load: bool = False
    has_sinusoid: bool = False
    load_upstream: bool = False
    sinusoid_upstream: bool = False
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
            if self.cubic or self.drifting or self.unsprung:
                own += [Parameter("centre", -8.0, 8.0)]
            own += [Parameter("z0", -50.0, 50.0, STICKING_STEP, leap=0.05), Parameter("v0", -50.0, 50.0, STICKING_STEP)]
        elif self.kind == "speed":
            own += [FRICTION, Parameter("centre", -20.0, 20.0, 1e-3)]
            own += [Parameter("v0", -50.0, 50.0, STICKING_STEP), Parameter("i0", -50.0, 50.0, STICKING_STEP)]
        elif self.kind == "varying":
            own += [DRIFT, Parameter("share_c", -3.0, 3.0), Parameter("turn", 0.0, 1.0)]
            own += [ONSET] if self.course == "step" else self._bent()
        if self.drifting:
            own += [DRIFT, *self._bent()]
        if self.has_load:
            own += [Parameter("load", -20.0, 20.0)]
            own += [ONSET] if self.load_upstream else [Parameter("leak", -0.9, 20.0), ONSET]
        if self.has_sinusoid:
            own += [CYCLES, Parameter("shake_cos", -20.0, 20.0), Parameter("shake_sin", -20.0, 20.0)]
        if self.lag:
            own += [Parameter("log_lag", -4.0, 8.0)]
        if self.mode:
            own += [Parameter("log_frequency", -6.0, np.log(np.pi))]
            own += [Parameter("log_damping", -7.0, np.log(MAX_DAMPING))]
        return tuple(rates + own)

    def _bent(self) -> list[Parameter]:
        return [Parameter(f"bend{n}", -3.0, 3.0) for n in range(1, self.extra_degrees + 1)]

    @property
    def nonlinear(self) -> bool:
        """Whether a state is nonlinear, so that it matters what stands before it and what behind."""
        return self.kind in ("tanks", "mechanics", "speed")

    @property
    def in_series(self) -> bool:
        """Whether there are two states in a row, and a load may enter ahead of either."""
        return self.kind == "tanks" or (self.kind == "speed" and self.lag_first)

    def index(self, name: str) -> int:
        """Place of a parameter in theta."""
        return [parameter.name for parameter in self.parameters].index(name)

    def modified(self, **changes: object) -> Self:
        """The same plant with some attributes changed."""
        return replace(self, **changes)  # type: ignore[arg-type]
