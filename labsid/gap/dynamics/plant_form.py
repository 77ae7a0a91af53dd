"""Form of the dynamics between actuator and sensor, and their parameters."""

from collections.abc import Iterable
from dataclasses import dataclass, field, replace
from typing import Self

import numpy as np

from labsid._arrays import FloatArray
from labsid.gap.dynamics.given_simulation import GivenSimulation

Named = dict[str, float]
"""Values of parameters by name."""
SLOWEST = np.log(1e-5)  # logarithm of the slowest rate of a pole, per sample; numerics
FASTEST = np.log(100.0)  # logarithm of the fastest rate of a pole, per sample; numerics
MAX_DAMPING = 0.5  # of a mode; set by hand


@dataclass(frozen=True, slots=True)
class Parameter:
    """A nonlinear parameter.

    Attributes
    ----------
    name : str
    lower, upper : float
        Bounds.
    step : float
        Step of the numerical derivative.
    leap : float
        Distance over which the error may have several minima; zero for a single minimum.
    start : float
        Start value where nothing else is known.
    """

    name: str
    lower: float
    upper: float
    step: float = 1e-4
    leap: float = 0.0
    start: float = 0.0


FREE_REACH = 1e6  # times the nominal value: largest size of a number that has no range of its own; numerics
FREE_UNIT = 1e-3  # times the nominal value: size below which a number counts as zero and may change its sign; numerics
FREE_STEP = 1e-2  # derivative step in theta, about that of the logarithm: more than the tolerance of a solver; numerics
ROUGH_STEP = 0.1  # of a simulation that is rough; numerics


@dataclass(frozen=True, slots=True)
class FreeNumber(Parameter):
    """A number of a given simulation in theta, over decades and both signs: ``number = unit sinh(theta + const)``.

    Theta is zero at the nominal value. Far from zero it is the logarithm of the number, about zero proportional to it.

    Attributes
    ----------
    nominal : float
    unit : float
        Size of the number between the two.
    """

    nominal: float = 1.0
    unit: float = 1e-3

    def number(self, theta: float) -> float:
        """The number for a value in theta."""
        return self.unit * float(np.sinh(theta + np.arcsinh(self.nominal / self.unit))) if theta else self.nominal

    def theta(self, number: float) -> float:
        """The value in theta for a number."""
        return float(np.arcsinh(number / self.unit) - np.arcsinh(self.nominal / self.unit))

    def scale(self, theta: float) -> float:
        """Derivative of the number by the value in theta."""
        return self.unit * float(np.cosh(theta + np.arcsinh(self.nominal / self.unit)))

    @property
    def given_name(self) -> str:
        """The name in the simulation."""
        return self.name.removeprefix(_FREE)


_FREE = "number "  # ahead of a name that a user has chosen


def free_number(
    name: str, nominal: float, limits: tuple[float, float] | None = None, unit: float = 1.0, rough: bool = False
) -> FreeNumber:
    """A number of a given simulation that may be fitted; `unit` is that of one that is nominally zero."""
    unit = FREE_UNIT * abs(nominal) or unit
    reach = FREE_REACH * max(abs(nominal), unit)
    shape = FreeNumber("", 0.0, 0.0, nominal=nominal, unit=unit)
    low, high = (shape.theta(end) for end in limits or (-reach, reach))
    return FreeNumber(f"{_FREE}{name}", low, high, ROUGH_STEP if rough else FREE_STEP, nominal=nominal, unit=unit)


STICKING_STEP = 1e-2  # scaled: derivative step that spans the jumps of stick-slip motion; numerics
FRICTION = Parameter("friction", 0.0, 20.0, 1e-3, leap=0.03)
LOAD_SHARE = Parameter("load_share", 0.0, 0.95, 1e-3, start=0.1)
DRIVEN_SHARE = Parameter("driven_share", 0.0, 1.0, 1e-3, start=0.6)  # of the stiffness, which is the drive's
GIVE = Parameter("log_give", -12.0, 6.0, 1e-3, start=-4.0)
GIVEN_WAY = 1.0  # start of the same for a motor: its way counts in its speed times samples; numerics
PEAK = (
    Parameter("peak", 0.0, 1.5, 1e-3, start=0.05),
    Parameter("log_decay", -5.0, -1.0, 1e-3, start=-2.0),
)
FRICTION_LAWS = {
    "": (),
    "sharp": (FRICTION,),
    "smooth": (
        FRICTION,
        Parameter("log_smooth", -5.0, 0.0, 1e-3, start=-2.3),
    ),
    "peak": (FRICTION, *PEAK),
    "load": (FRICTION, LOAD_SHARE),
    "drive": (FRICTION, LOAD_SHARE),
    "give": (FRICTION, GIVE),
    "load-give": (FRICTION, LOAD_SHARE, GIVE),
    "peak-give": (FRICTION, *PEAK, GIVE),
}
"""Parameters of friction, and of its law: logarithms of small speeds over the one that a unit of the drive gives, the
excess of the break-away friction over the sliding one, the share of the transmitted force by which it grows, that of
all forces ("load") or of the drive alone ("drive"), and the logarithm of the way before it slides (Dahl)."""
SPRING = Parameter("spring", -50.0, 50.0)  # scaled: force at the input of a given simulation over its output cubed
NO_SPRING = -22.0  # logarithm of a stiffness, per squared sample, that no record shows; numerics
GRAVITY = (  # scaled: radians per position, angle in radians
    Parameter("torque", 0.0, 50.0, 1e-3),
    Parameter("log_turn", -8.0, 10.0, 1e-3),
    Parameter("angle", -60.0, 60.0, 1e-3, leap=0.3),
)
LIMIT = Parameter("limit", 1e-3, 50.0, 1e-3, leap=0.05)  # scaled: error at which a loop saturates
SPRUNG_SHARE = Parameter("sprung_share", 0.2, 1.0, 1e-3, start=0.95)  # of the stiffness, which the loop gives
DAMPED_SHARE = Parameter("damped_share", 0.0, 1.0, 1e-3, start=0.9)  # of the damping, which the loop gives
WEIR = Parameter("log_weir", -3.0, 9.0, 1e-3, start=3.0)  # scaled: logarithm of the flow over a weir at a head of one
REBOUND = Parameter("rebound", 0.0, 0.9, 1e-3, start=0.3)  # speed after a hit over that before
DRAG = Parameter("drag", 0.0, 200.0, 1e-3)  # scaled
ONSET = Parameter("onset", 0.0, 1.0, 2e-4, leap=0.004)  # as a share of the record
STATES = {
    "tanks": (Parameter("h1", -50.0, 50.0), Parameter("h2", -50.0, 50.0)),
    "mechanics": (
        Parameter("z0", -50.0, 50.0, STICKING_STEP, leap=0.05),
        Parameter("v0", -50.0, 50.0, STICKING_STEP),
    ),
    "speed": (Parameter("v0", -50.0, 50.0, STICKING_STEP), Parameter("i0", -50.0, 50.0, STICKING_STEP)),
}
"""Initial states of nonlinear dynamics, about the equilibrium at the first input."""
RATE_OF = {"upper": "log_a", "lower": "log_b"}
LEVEL_OF = {"upper": "h1", "lower": "h2"}
"""The rate and the initial level of each tank, by their names in theta."""
LEVELS = (Parameter("h1", -2e4, 2e4), Parameter("h2", -2e4, 2e4))
"""Those of tanks with root outflow: the level is the square of the flow, which may be 200 at its mean."""


def _nothing(w: FloatArray, numbers: dict[str, float]) -> FloatArray:
    return np.full(w.size, np.nan)


NOT_GIVEN = GivenSimulation(_nothing)
CYCLES = Parameter("cycles", 2.2, 1e7, 1e-3)  # in the record; a slower sinusoid is a drift


@dataclass(frozen=True, slots=True)
class PlantForm:
    """Form of the dynamics: two poles, and the additions of the effects of a hypothesis.

    Attributes
    ----------
    kind : str
        "linear", "tanks", "mechanics", "speed", "varying" for linear dynamics with a drifting pole, "leak" for those
        whose pole steps at an instant, or "given" for an external simulation. The output is continuous across a step;
        the parameter `turn`, 0 to 1, is the share of the change that acts as a jump of the speed.
    zero : bool
        Whether linear dynamics have a numerator zero. Without it they have one gain.
    single : bool
        Whether one of the two poles of linear dynamics is too fast to matter, as in a simulation of first order.
    feedthrough : bool
        Whether the output responds within the sample in which the input changes.
    lag, mode : str
        Position of an additional real pole and of a lightly damped pair relative to a nonlinear state: "behind",
        "ahead", or for a mode "beside" (in parallel); empty without one.
    roots, brims : tuple of str
        Tanks with square-root outflow, and tanks with a brim, of "upper" and "lower".
    weir : bool
        Whether the lower tank overflows the more, the higher its level is over the brim.
    flipped : bool
        Whether a larger input means less flow.
    friction : str
        Dry friction: "sharp", "smooth" about rest, with a "peak" that breaks away, growing with the "load" or with the
        force of the "drive", with a "give" before it slides, or two of these, "load-give" or "peak-give"; empty without
        it.
    drag, cubic : bool
        Resistance with the square of the speed, cubic restoring force.
    gravity : bool
        A torque with the sine of the position.
    follows : bool
        Whether the position is in the unit of the command, which it follows: the gain is that of the units.
    limit : str
        Which loop of a drive saturates: "position" of a mass, "damped" if that gives a share of the damping, too,
        "loaded" if it gives a share of the stiffness, or "speed" of a mass or a motor; empty if none does.
    stops : tuple of str
        Mechanical stops of a mass, of "low" and "high".
    rebound : bool
        Whether the mass keeps a share of its speed at a stop.
    slow : bool
        A slow real pole in parallel.
    sampled : bool
        Whether the input may lead the held input by up to half a sample.
    unsprung : bool
        Whether a mass with friction has almost no spring, so that a constant force is no shift of its position.
    lag_first : bool
        Whether the lag of "speed" precedes the friction.
    drift_degree : int
        Degree of the slow drift of the last state's rate, or of the spring; zero without one.
    steps : bool
        Whether a drifting pole changes at an instant instead.
    load, sinusoid : str
        Where a load step and a sinusoid act: "inside", on the nonlinear state, or "ahead", on the first of two states
        in series, where a load has no leak; empty without one.
    simulation : GivenSimulation
        The simulation of the kind "given".
    reactions : tuple of str
        Forces at the input of a given simulation that react to its output: "friction" of a position, "speed" for that
        of a speed, "cubic".
    inside : tuple of str
        Changes inside a given simulation that opens, of `labsid.gap.dynamics.inside_parts.PARTS`.
    stabilised : bool
        Whether a feedback of the measured output acts on the dynamics, whose gain then is one.
    parameters : tuple of Parameter
        In their order in theta.
    """

    kind: str = "linear"
    zero: bool = True
    single: bool = False
    feedthrough: bool = False
    lag: str = ""
    mode: str = ""
    roots: tuple[str, ...] = ()
    brims: tuple[str, ...] = ()
    weir: bool = False
    flipped: bool = False
    friction: str = ""
    drag: bool = False
    cubic: bool = False
    gravity: bool = False
    follows: bool = False
    limit: str = ""
    stops: tuple[str, ...] = ()
    rebound: bool = False
    slow: bool = False
    sampled: bool = False
    unsprung: bool = False
    lag_first: bool = True
    drift_degree: int = 0
    steps: bool = False
    load: str = ""
    sinusoid: str = ""
    simulation: GivenSimulation = NOT_GIVEN
    reactions: tuple[str, ...] = ()
    inside: tuple[str, ...] = ()
    stabilised: bool = False
    parameters: tuple[Parameter, ...] = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "parameters", self._searched())

    @property
    def keeps_feedback(self) -> bool:
        """Whether the dynamics cannot invert a feedback of the measured output, and follow it without an input."""
        return not self.stabilised or self.kind in ("linear", "mechanics")

    def _searched(self) -> tuple[Parameter, ...]:
        if self.kind == "given":
            own: list[Parameter] = [FRICTION] if {"friction", "speed"} & set(self.reactions) else []
            own += [SPRING] if "cubic" in self.reactions else []
            port = self.simulation.port
            own += port.parameters(self.inside) if port is not None else ()
            return (*self.free, *own, *self._in_series())
        rates = [Parameter("log_c", -14.0, 3.5), Parameter("log_k", NO_SPRING, 4.0)]
        if self.kind in ("tanks", "speed"):
            rates = [Parameter("log_a", SLOWEST, FASTEST), Parameter("log_b", SLOWEST, FASTEST)]
        own = []
        if self.kind == "tanks":
            if self.has_root:
                own += [Parameter("zero", -200.0, 3.0)]
            if self.brims:
                own += [Parameter("brim", -5.0, 400.0, leap=0.05)]
            if "upper" in self.brims:
                own += [Parameter("share", 0.0, 1.0)]
            if len(self.brims) == 2:
                own += [Parameter("brim2", -5.0, 400.0, leap=0.05)]
            own += [WEIR] if self.weir else []
        elif self.kind == "mechanics":
            own += FRICTION_LAWS[self.friction]
            own += [DRIVEN_SHARE] if self.friction == "drive" and not self.unsprung else []
            own += [DRAG] if self.drag else []
            own += [Parameter(f"stop_{side}", -50.0, 50.0, leap=0.05) for side in self.stops]
            own += [REBOUND] if self.rebound else []
            own += GRAVITY if self.gravity else ()
            own += [LIMIT] if self.limit else []
            own += [DAMPED_SHARE] if self.limit == "damped" else [SPRUNG_SHARE] if self.limit == "loaded" else []
            if self.cubic:
                own += [Parameter("cubic", -0.3, 50.0)]
            if self.cubic or self.drift_degree or self.unsprung or self.limit == "loaded":
                own += [Parameter("centre", -8.0, 8.0)]
        elif self.kind == "speed":
            own += [
                replace(parameter, start=GIVEN_WAY) if parameter is GIVE else parameter
                for parameter in FRICTION_LAWS[self.friction]
            ]
            own += [DRAG] if self.drag else []
            own += [LIMIT] if self.limit else []
            own += [Parameter("centre", -20.0, 20.0, 1e-3)]
        own += LEVELS if self.has_root else STATES.get(self.kind, ())
        if self.drift_degree or self.kind == "leak":
            own += [Parameter("drift", -3.0, 3.0)]
        if self.kind in ("varying", "leak"):
            own += [Parameter("share_c", -3.0, 3.0), Parameter("turn", 0.0, 1.0)]
        own += [ONSET] if self.kind == "leak" or self.steps else []
        own += [Parameter(f"bend{n}", -3.0, 3.0) for n in range(1, self.drift_degree)]
        if self.load:
            own += [Parameter("load", -20.0, 20.0)]
            own += [ONSET] if self.load == "ahead" else [Parameter("leak", -0.9, 20.0), ONSET]
        if self.sinusoid:
            own += [CYCLES, Parameter("shake_cos", -20.0, 20.0), Parameter("shake_sin", -20.0, 20.0)]
        return (*rates, *own, *self._in_series())

    def _in_series(self) -> list[Parameter]:
        """Parameters of the additional lag, mode and slow mode."""
        own = [Parameter("log_lag", -4.0, 8.0)] if self.lag else []
        if self.mode:
            own += [Parameter("log_frequency", -6.0, np.log(np.pi))]
            own += [Parameter("log_damping", -7.0, np.log(MAX_DAMPING))]
        return [*own, Parameter("log_slow", 0.0, 12.0)] if self.slow else own

    @property
    def nonlinear(self) -> bool:
        """Whether a state is nonlinear, so that the order of the elements matters."""
        return self.kind in ("tanks", "mechanics", "speed")

    @property
    def changes_in_time(self) -> bool:
        """Whether a load, a sinusoid or a drift acts on the states."""
        return bool(self.drift_degree or self.load or self.sinusoid or {"load", "wave"} & set(self.inside))

    @property
    def has_root(self) -> bool:
        """Whether the outflow of a tank is that of a square root."""
        return self.kind == "tanks" and bool(self.roots)

    @property
    def abrupt(self) -> bool:
        """Whether the motion of a mass changes within a sample: by friction, drag, a stop or a limit."""
        return bool(self.friction) or self.drag or bool(self.stops) or bool(self.limit)

    @property
    def in_series(self) -> bool:
        """Whether there are two states in series, with a possible load on either."""
        return self.kind == "tanks" or (self.kind == "speed" and self.lag_first)

    @property
    def free(self) -> tuple[FreeNumber, ...]:
        """Numbers of a given simulation that may be fitted, the first ones in theta."""
        given = self.simulation
        return tuple(
            free_number(name, nominal, given.ranges.get(name), given.units.get(name, 1.0), given.rough)
            for name, nominal in given.nominal.items()
        )

    def numbers(self, theta: Iterable[float]) -> dict[str, float]:
        """The free numbers of a given simulation, by their names in it, and the changes inside it."""
        values, free = list(theta), self.free
        found = {one.given_name: one.number(value) for one, value in zip(free, values, strict=False)}
        port = self.simulation.port
        return found if port is None else found | port.numbers(self.inside, values[len(free) :])

    @property
    def states(self) -> tuple[Parameter, ...]:
        """Initial states that are parameters."""
        port = self.simulation.port
        return STATES.get(self.kind, ()) if port is None else port.states(self.inside)

    def brim_name(self, tank: str) -> str:
        """Name of the parameter of a tank's brim."""
        return "brim2" if tank == "lower" and "upper" in self.brims else "brim"

    def index(self, name: str) -> int:
        """Index of a parameter in theta."""
        return [parameter.name for parameter in self.parameters].index(name)

    def modified(self, **changes: object) -> Self:
        """A copy with some attributes changed."""
        return replace(self, **changes)  # type: ignore[arg-type]
