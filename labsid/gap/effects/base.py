"""Base classes of effects: name, path, parameters and start values."""

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import chain
from typing import Any, ClassVar, Self

import numpy as np

from labsid._arrays import FloatArray
from labsid.gap.dynamics.plant_form import Parameter
from labsid.gap.dynamics.plants import Plant
from labsid.gap.dynamics.responses import real_rates
from labsid.gap.effects.context import Context, ParentFit, Structure
from labsid.gap.effects.description import Description
from labsid.gap.record.controllers import has_controller
from labsid.gap.record.data import Data

MAX_RANGES = 1.5  # of the output: largest signal that an effect may add, as no record shows a larger one; set by hand
REST_SAMPLES = 5  # leading samples with equal input of a rig at rest; set by hand
ZERO = 1e-6  # of the spread of a signal: smaller values are zero; numerics
RARE = 0.03  # share of the samples beyond the start value of a second limit, stop or brim; numerics
RICHER_FORM_BIC = 12.0  # smallest BIC gain of a richer form over a simpler one; set by hand


@dataclass(frozen=True, slots=True)
class Effect:
    """A cause of the gap that a linear simulation lacks.

    Attributes
    ----------
    name : str
        From the table of effects.
    description : Description or None
        What is said of it; on one class of each name.
    key_form : str
        Of the variant in the key.
    variants : tuple of str
        Forms that the search adds to a simulation.
    further, richer : dict
        By variant, the other ones that are tried once it is found; `richer` ones must gain `RICHER_FORM_BIC`.
    places : tuple of str
        Variants that differ in their position in the chain only, where `place_matters`.
    late : bool
        Whether it is tried only after a search with the others.
    sizes : tuple of str
        Parameters that are zero where the effect does nothing, of effects whose dynamics differ from linear ones in
        more than these; empty if an effect that does nothing leaves the hypothesis as it was.
    planted_variants : tuple of str
        Forms whose smallest visible size is reported.
    whole : str
        Of what the size of a planted effect is a share: the range of "u" or "y", the slowest "time" constant, "gain".
    has_corner : bool
        Whether this form has a corner where the law of its name is smooth (`Description.smooth_law`).
    variant : str
        Form of the effect, if there are several.
    """

    name: ClassVar[str]
    description: ClassVar[Description | None] = None
    key_form: ClassVar[str] = "{}"
    variants: ClassVar[tuple[str, ...]] = ("",)
    further: ClassVar[Mapping[str, tuple[str, ...]]] = {}
    richer: ClassVar[Mapping[str, tuple[str, ...]]] = {}
    places: ClassVar[tuple[str, ...]] = ()
    late: ClassVar[bool] = False
    sizes: ClassVar[tuple[str, ...]] = ()
    planted_variants: ClassVar[tuple[str, ...]] = ()
    whole: ClassVar[str] = "u"
    has_corner: ClassVar[bool] = False
    variant: str = ""

    @classmethod
    def searched(cls) -> tuple[Self, ...]:
        """The forms that the search adds to a simulation."""
        return tuple(cls(variant) for variant in cls.variants)

    @classmethod
    def forms(cls) -> tuple[Self, ...]:
        """All forms."""
        others = chain(*cls.further.values(), *cls.richer.values(), cls.places)
        return tuple(cls(variant) for variant in dict.fromkeys((*cls.variants, *others)))

    @property
    def key(self) -> str:
        """Name and variant, as ranking and export write them."""
        return f"{self.name}/{self.key_form.format(self.variant)}" if self.variant else self.name

    @property
    def parameters(self) -> tuple[Parameter, ...]:
        """Parameters of the effect; those of a plant effect belong to the plant."""
        return ()

    @property
    def instants(self) -> tuple[str, ...]:
        """Parameters that are instants or lengths of time, as shares of the record."""
        return ()

    @property
    def bic_penalty(self) -> float:
        """Smallest BIC gain over a simpler form; zero for the simplest one."""
        plain = self.plain_form
        return 0.0 if plain is None else RICHER_FORM_BIC + plain.bic_penalty

    @property
    def plain_form(self) -> "Effect | None":
        """The form that this one makes richer; None if it is none of the richer ones."""
        plain = (variant for variant, richer in self.richer.items() if self.variant in richer)
        return next((type(self)(variant) for variant in plain), None)

    def alternatives(self, hypothesis: Structure) -> list["Effect"]:
        """Other forms of this effect in a hypothesis that contains it."""
        others = (*self.further.get(self.variant, ()), *self.richer.get(self.variant, ()))
        if self.variant in self.places and self.place_matters(hypothesis):
            others += tuple(place for place in self.places if place != self.variant)
        return [type(self)(variant) for variant in others]

    def place_matters(self, hypothesis: Structure) -> bool:
        """Whether `places` differ in a hypothesis: beside a nonlinear state."""
        return hypothesis.plant.nonlinear

    def inner_forms(self) -> tuple["Effect", ...]:
        """Forms of this effect that are tried beside a nonlinear state."""
        return (self,)

    def outer_form(self) -> "Effect":
        """Form of this effect on linear dynamics."""
        return self

    def carry_over(self, fit: ParentFit, hypothesis: Structure, theta: FloatArray) -> None:
        """Set in `theta` of a hypothesis with this effect, in place, what a fit with another form of it tells."""

    def grown_forms(self, hypothesis: Structure) -> list["Effect"]:
        """The alternatives that are tried as soon as this form is fitted, not only for the best fits."""
        return []

    def grown_starts(self, fit: ParentFit, hypothesis: Structure, theta: FloatArray) -> list[FloatArray]:
        """Start values of a hypothesis whose last effect has grown into this one; `theta` is carried over."""
        return [theta]

    def inner_start(self, context: Context) -> dict[str, float]:
        """Start values of the plant's parameters where the parent's effect becomes an inner form."""
        return {}

    def with_linear_gains(self, data: Data, hypothesis: Any, theta: FloatArray) -> FloatArray:
        """Theta with the nonlinear parameters of a new effect set that are nearly linear."""
        return theta

    def extend(self, plant: Plant) -> Plant:
        """The plant with this effect."""
        return plant

    def applies(self, context: Context) -> bool:
        """Whether the record can identify this effect."""
        return True

    def starts(self, context: Context) -> list[FloatArray]:
        """Start values of `parameters`."""
        return [np.zeros(0)]

    def rates(self, context: Context) -> list[tuple[float, float]]:
        """Rates c and k of linear dynamics to start from, in addition to those of the parent."""
        return []

    def is_plausible(self, fit: "Fitted") -> bool:
        """Whether the fitted parameters are plausible; otherwise the effect imitates another one."""
        return True

    def active_samples(self, fit: "Fitted") -> np.ndarray:
        """Mask of the samples at which the effect acts, shape (N,); all False if it acts everywhere."""
        return np.zeros(fit.data.samples, bool)

    def values(self, fit: "Fitted") -> "dict[str, Value]":
        """Parameters in the record's units, for the report."""
        return {}

    def planted(self, fit: "Fitted", share: float) -> "list[Planted]":
        """This effect at a size, for each place at which it may act; the first one is reported.

        Parameters
        ----------
        fit : Fitted
            The simulation without the effect; of a plant effect, in its form with size zero.
        share : float
            Of `whole`, up to 1.
        """
        return []


@dataclass(frozen=True, slots=True)
class Value:
    """A value with its unit.

    Attributes
    ----------
    value : float
    unit : str
        "u" and "y" are the units of the record.
    """

    value: float
    unit: str


@dataclass(frozen=True, slots=True, eq=False)
class Planted:
    """An effect at one size and place.

    Attributes
    ----------
    parameter : str
        The one of its `values` that states the size.
    values : dict
        Own parameters by name, in the units of the search.
    gains : tuple of float
        Of the columns that the effect adds.
    size : Value or None
        The size, if it is none of the `values`.
    """

    parameter: str
    values: Mapping[str, float]
    gains: tuple[float, ...] = ()
    size: Value | None = None


@dataclass(frozen=True, slots=True, eq=False)
class Fitted:
    """A hypothesis with parameters, at which effects evaluate their values.

    Attributes
    ----------
    hypothesis : Structure
    theta, gains : ndarray
        Nonlinear and linear parameters.
    data : Data
    """

    hypothesis: Structure
    theta: FloatArray
    gains: FloatArray
    data: Data

    @classmethod
    def of(cls, fit: ParentFit, data: Data) -> Self:
        """A fit and its record."""
        return cls(fit.hypothesis, fit.theta, fit.gains, data)

    @property
    def plant_theta(self) -> FloatArray:
        """The plant's part of theta."""
        return self.theta[self.hypothesis.slices["plant"]]

    @property
    def actuator(self) -> FloatArray:
        """The signal that reaches the dynamics, shape (N,)."""
        return self.hypothesis.driven(self.theta, self.data.u)

    @property
    def output(self) -> FloatArray:
        """Free-run output, shape (N,)."""
        return self.hypothesis.output(self.theta, self.gains, self.data.u)

    def theta_of(self, effect: Effect) -> FloatArray:
        """Part of theta that belongs to an effect."""
        return self.theta[self.hypothesis.slices[effect.key]]

    def value(self, name: str) -> float:
        """Value of a parameter whose name no other effect has."""
        return float(self.theta[[parameter.name for parameter in self.hypothesis.parameters].index(name)])

    def instant(self, share: float) -> Value:
        """The time at a share of the record."""
        return Value(float(share) * self.data.samples * self.data.Ts + self.data.start, "s")

    @property
    def command_unit(self) -> float:
        """Size in the record's unit of a command that drives the dynamics by one."""
        feedback = self.hypothesis.feedback
        gain = 1.0 if feedback is None else abs(float(self.theta_of(feedback)[0])) or 1.0
        return float(self.data.u_scale.unit / gain)

    @property
    def own_spring(self) -> float:
        """Restoring force of the rig itself over that of the simulated dynamics, negative of one that falls over."""
        feedback = self.hypothesis.feedback
        return 1.0 if feedback is None else 1.0 - float(feedback.gains[0])

    @property
    def state_per_output(self) -> float:
        """Nonlinear state per unit of the record's output."""
        return 1.0 / (float(self.gains[0]) * self.data.y_scale.unit or 1.0)

    def change_by(self, *names: str) -> FloatArray:
        """Change of the output by the named plant parameters, shape (N,)."""
        place = self.hypothesis.slices["plant"].start
        without = self.theta.copy()
        for name in names:
            if name in [parameter.name for parameter in self.hypothesis.plant.parameters]:
                without[place + self.hypothesis.plant.index(name)] = 0.0
        outputs = [self.hypothesis.output(theta, self.gains, self.data.u) for theta in (self.theta, without)]
        return np.subtract(*outputs)

    @property
    def range(self) -> float:
        """Range of the scaled output over the rows that count."""
        return float(np.ptp(self.data.y[self.data.rows]))

    def could_show(self, size: float, added: FloatArray) -> bool:
        """Whether a signal of this size that is added to the output is not larger than what the record shows.

        Against a controller, the output shows less of it than the input does, whose response compensates it.
        """
        if size < MAX_RANGES * self.range:
            return True
        if not has_controller(*self.data.sampled):
            return False
        rest = (self.output - added)[self.data.rows]
        return size < MAX_RANGES * float(np.ptp(rest))

    @property
    def input_range(self) -> float:
        """Range of the scaled input."""
        return float(np.ptp(self.data.u))

    @property
    def slowest_time(self) -> float:
        """Slowest time constant of the linear dynamics in samples, at most a quarter of the record."""
        slow = real_rates(*self.hypothesis.plant.linear_rates(self.plant_theta))[0]
        return float(min(1.0 / slow, 0.25 * self.data.samples))

    @property
    def starts_at_rest(self) -> bool:
        """Whether the record starts with a zero command, which is an end of its range: the rig is off."""
        u = self.data.u
        zero = abs(self.u(float(u[0]))) < ZERO * self.data.u_scale.unit
        return bool(zero and np.all(u[:REST_SAMPLES] == u[0]) and u[0] in (u.min(), u.max()))

    def u(self, scaled: float) -> float:
        """An input in the record's unit."""
        return float(self.data.u_scale.back(scaled))

    def y(self, scaled: float) -> float:
        """An output in the record's unit."""
        return float(self.data.y_scale.back(scaled))


class InputEffect(Effect):
    """An effect that transforms the command before it reaches the dynamics.

    It needs `least_levels` of the input: gain and offset absorb a static curve of two, and backlash leaves two or one.
    """

    least_levels: ClassVar[int] = 1
    position: ClassVar[int] = 0
    variant_positions: ClassVar[dict[str, int]] = {}

    @property
    def order(self) -> int:
        """Position of the variant in the actuator's chain."""
        return self.variant_positions.get(self.variant, self.position)

    def applies(self, context: Context) -> bool:
        """Whether the input has enough levels."""
        return context.levels.size >= self.least_levels

    def place_matters(self, hypothesis: Structure) -> bool:
        """Whether `places` differ in a hypothesis: beside another input effect that is no delay."""
        return sum(effect.name != "input-delay" for effect in hypothesis.inputs) > 1

    def apply(self, w: FloatArray, own: FloatArray, span: int) -> FloatArray:
        """Transform the signal `w`, shape (N,); `span` is the length of the fitted record."""
        raise NotImplementedError

    def completed(self, own: FloatArray, data: Data) -> tuple[FloatArray, int]:
        """Own parameters, those that the input of the record does not determine set by convention; and how many."""
        return own, 0


class PlantEffect(Effect):
    """An effect that changes the dynamics.

    Some can act on the input of a given simulation instead (`before_given`), some of them only there (`only_given`);
    others need a nonlinear state (`only_inner`). `absent` are values without effect of parameters that zero does not
    switch off.
    """

    absent: ClassVar[Mapping[str, float]] = {}
    before_given: ClassVar[bool] = False
    only_given: ClassVar[bool] = False
    only_inner: ClassVar[bool] = False

    def applies(self, context: Context) -> bool:
        """Whether the parent has a nonlinear state, if it is needed."""
        return context.parent.hypothesis.plant.nonlinear or not self.only_inner

    def extend(self, plant: Plant) -> Plant:
        """The plant with this effect."""
        raise NotImplementedError

    def plant_starts(self, context: Context) -> list[dict[str, float]]:
        """Start values of the additional plant parameters, by name."""
        return [{}]


class OutputEffect(Effect):
    """An effect that transforms the output in the sensor; limits (`is_limit`) also clip signals added there."""

    position: ClassVar[int] = 0
    is_limit: ClassVar[bool] = False

    def apply(self, z: FloatArray, own: FloatArray) -> FloatArray:
        """Sensor reading of z, shape (N,)."""
        raise NotImplementedError

    def slope(self, z: FloatArray, own: FloatArray) -> FloatArray:
        """Derivative of the reading by z, of an effect without memory."""
        raise NotImplementedError

    def passed(self, columns: FloatArray, z: FloatArray, own: FloatArray) -> FloatArray:
        """Derivatives of the reading, from the derivatives of z in `columns`, shape (N, m)."""
        return columns * self.slope(z, own)[:, None]

    def undone(self, y: FloatArray, own: FloatArray, columns: FloatArray, rows: np.ndarray) -> FloatArray:
        """Readings from which gains of the `columns`, shape (N, m), can be estimated by linear least squares."""
        return y


class AdditiveEffect(Effect):
    """An effect that adds signals independent of the input; their amplitudes are linear parameters."""

    @property
    def at_load(self) -> bool:
        """Whether the signals are added before the sensor."""
        return False

    @property
    def width(self) -> int:
        """Number of columns."""
        return 2

    @property
    def uses_plant(self) -> bool:
        """Whether the signals depend on the dynamics."""
        return self.at_load

    @property
    def lasting(self) -> bool:
        """Whether the signals act in every record of the rig, not only in the fitted one."""
        return False

    @property
    def state_columns(self) -> tuple[int, ...]:
        """Indices of the columns whose gains are an initial state."""
        return ()

    def beside(self, plant: Plant) -> "AdditiveEffect":
        """The form of this effect beside these dynamics."""
        return self

    def columns(self, own: FloatArray, samples: int, span: int, plant: Plant, rates: FloatArray) -> FloatArray:
        """The signals, shape (samples, q)."""
        raise NotImplementedError

    def added(self, fit: "Fitted") -> FloatArray:
        """What this effect adds to the scaled output, shape (N,)."""
        samples = fit.data.samples
        columns = self.columns(fit.theta_of(self), samples, samples, fit.hypothesis.plant, fit.plant_theta)
        return np.asarray(columns @ fit.hypothesis.gains_of(fit.gains, self), np.float64)

    def is_plausible(self, fit: "Fitted") -> bool:
        """Reject a signal that is larger than the record could show."""
        added = self.added(fit)
        return fit.could_show(0.5 * float(np.ptp(added[fit.data.rows])), added) and super().is_plausible(fit)
