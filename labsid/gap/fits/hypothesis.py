"""A hypothesis: the linear structure with a set of effects."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from labsid._arrays import FloatArray, beside
from labsid.gap.dynamics import _kernels
from labsid.gap.dynamics.plant_form import Parameter
from labsid.gap.dynamics.plants import Plant
from labsid.gap.effects.base import AdditiveEffect, Effect, InputEffect, OutputEffect
from labsid.gap.effects.further_inputs import FurtherInput, SameEntry
from labsid.gap.effects.output_feedback import OutputFeedback
from labsid.gap.effects.restarts import Restarts
from labsid.gap.record.data import Data

NUISANCE_DELAY = 0.5  # samples: a shorter delay is attributed to sampling, not to the rig; definition
DELAY = Parameter("delay", 0.0, NUISANCE_DELAY, 0.02)
# An input that is sampled rather than held may lead by half a sample.
SAMPLED_DELAY = Parameter("delay", -NUISANCE_DELAY, NUISANCE_DELAY, 0.02)
FRICTION_DELAY = Parameter("delay", 0.0, NUISANCE_DELAY, 0.02, leap=0.1)  # friction can hide a delay


@dataclass(frozen=True, slots=True, eq=False)
class Design:
    """Regressor columns of a hypothesis at one theta.

    Attributes
    ----------
    columns : ndarray, shape (N, m + q)
    n_sensed : int
        m: number of leading columns that pass through the sensor, including the constant.
    theta : ndarray
        Nonlinear parameters of the columns.
    actuator : tuple of ndarray, shape (N,), and float
        The signal that reaches the dynamics, and the fraction of each sample at which it changes.
    parts : tuple of ndarray
        Columns of the dynamics and of each additive effect.
    """

    columns: FloatArray
    n_sensed: int
    theta: FloatArray
    actuator: tuple[FloatArray, float]
    parts: tuple[FloatArray, ...]

    @property
    def sensed(self) -> FloatArray:
        """Columns that pass through the sensor, shape (N, m)."""
        return self.columns[:, : self.n_sensed]

    @property
    def added(self) -> FloatArray:
        """Columns added between the curve and the limits of the sensor, shape (N, q)."""
        return self.columns[:, self.n_sensed :]


@dataclass(frozen=True, slots=True)
class Hypothesis:
    """Effects in the order in which they were added.

    The nonlinear parameters theta are ordered: delay, input effects, plant, output effects, additive effects.

    Attributes
    ----------
    effects : tuple of Effect
    n_given : int
        Number of leading effects that are part of the given simulation, not findings.
    given : Plant or None
        Dynamics of the given simulation; the linear ones if None.
    plant : Plant
        The dynamics with all plant effects.
    inputs : tuple of InputEffect
        In the order of the actuator's chain.
    outputs : tuple of OutputEffect
        In the order of the sensor's chain.
    additive : tuple of AdditiveEffect
        Effects that add columns, those at the load first.
    parameters : tuple of Parameter
        Parameters in theta.
    slices : dict
        Slice of theta of the "plant", and of each effect by its key.
    bounds : tuple of ndarray
        Lower and upper bounds of theta.
    """

    effects: tuple[Effect, ...] = ()
    n_given: int = 0
    given: Plant | None = None
    plant: Plant = field(init=False, repr=False, compare=False)
    inputs: tuple[InputEffect, ...] = field(init=False, repr=False, compare=False)
    outputs: tuple[OutputEffect, ...] = field(init=False, repr=False, compare=False)
    additive: tuple[AdditiveEffect, ...] = field(init=False, repr=False, compare=False)
    parameters: tuple[Parameter, ...] = field(init=False, repr=False, compare=False)
    slices: dict[str, slice] = field(init=False, repr=False, compare=False)
    bounds: tuple[FloatArray, FloatArray] = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        plant = self.given or Plant()
        for effect in self.effects:
            plant = effect.extend(plant)
        inputs = sorted((e for e in self.effects if isinstance(e, InputEffect)), key=lambda e: e.order)
        outputs = sorted((e for e in self.effects if isinstance(e, OutputEffect)), key=lambda e: e.position)
        additive = [e.beside(plant) for e in self.effects if isinstance(e, AdditiveEffect)]
        nuisance = FRICTION_DELAY if plant.friction else SAMPLED_DELAY if plant.sampled else DELAY
        parameters: list[Parameter] = [] if any(e.name == "input-delay" for e in inputs) else [nuisance]
        places = {}
        parts: list[tuple[str, tuple[Parameter, ...]]] = [(e.key, e.parameters) for e in inputs]
        parts += [("plant", plant.parameters)]
        parts += [(e.key, e.parameters) for e in (*outputs, *additive)]
        for key, own in parts:
            places[key] = slice(len(parameters), len(parameters) + len(own))
            parameters += own
        bounds = np.array([p.lower for p in parameters]), np.array([p.upper for p in parameters])
        if self.feedback is not None:
            bounds = self.feedback.limited([parameter.name for parameter in parameters], *bounds)
        derived: dict[str, object] = {
            "plant": plant,
            "inputs": tuple(inputs),
            "outputs": tuple(outputs),
            "additive": tuple(sorted(additive, key=lambda e: not e.at_load)),
            "parameters": tuple(parameters),
            "slices": places,
            "bounds": bounds,
        }
        for name, value in derived.items():
            object.__setattr__(self, name, value)

    @property
    def found(self) -> tuple[Effect, ...]:
        """The effects that are findings."""
        return self.effects[self.n_given :]

    @property
    def names(self) -> tuple[str, ...]:
        """Unique names of the effects found."""
        return tuple(dict.fromkeys(effect.name for effect in self.found))

    @property
    def keys(self) -> tuple[str, ...]:
        """Keys of the effects found."""
        return tuple(effect.key for effect in self.found)

    def plus(self, effect: Effect) -> "Hypothesis":
        """The hypothesis with one more effect."""
        return self.with_effects((*self.effects, effect))

    def with_effects(self, effects: tuple[Effect, ...]) -> "Hypothesis":
        """The hypothesis with other effects."""
        return Hypothesis(effects, self.n_given, self.given)

    def with_signals(self, signals: Mapping[str, FloatArray]) -> "Hypothesis":
        """The hypothesis whose further inputs have other scaled signals, by their names."""
        changed = (
            replace(effect, signal=signals[effect.variant]) if isinstance(effect, FurtherInput | SameEntry) else effect
            for effect in self.effects
        )
        given = self.given
        if given is not None:
            given = replace(given, simulation=given.simulation.with_signals(signals))
        return Hypothesis(tuple(changed), self.n_given, given)

    def beside_output(self, y: FloatArray) -> "Hypothesis":
        """The hypothesis with the feedback of another scaled output; as it is, if it has none."""
        changed = (effect.on(y) if isinstance(effect, OutputFeedback) else effect for effect in self.effects)
        return self if self.feedback is None else self.with_effects(tuple(changed))

    @property
    def feedback(self) -> OutputFeedback | None:
        """What stabilises the simulation of an unstable rig."""
        return next((effect for effect in self.effects if isinstance(effect, OutputFeedback)), None)

    @property
    def delay_is_an_effect(self) -> bool:
        """Whether the delay is an effect rather than a nuisance parameter."""
        return any(e.name == "input-delay" for e in self.inputs)

    def completed(self, theta: FloatArray, data: Data) -> tuple[FloatArray, int]:
        """Theta, the parameters that the input of the record does not determine set by convention; and how many."""
        full, undetermined = theta.copy(), 0
        for effect in self.inputs:
            place = self.slices[effect.key]
            full[place], count = effect.completed(theta[place], data)
            undetermined += count
        return full, undetermined

    def actuator(self, theta: FloatArray, u: FloatArray) -> FloatArray:
        """The signal that reaches the dynamics: the input after all actuator effects, interpolated to its delay."""
        w, late = self._delayed_input(theta, u, u.size)
        return _kernels.delayed(w, 0, late)

    def driven(self, theta: FloatArray, u: FloatArray) -> FloatArray:
        """The signal that drives the dynamics: that of the actuator, with the feedback of an unstable rig."""
        w, feedback = self.actuator(theta, u), self.feedback
        return w if feedback is None else np.asarray(w + feedback.added(w.size))

    def _delayed_input(self, theta: FloatArray, u: FloatArray, span: int) -> tuple[FloatArray, float]:
        """The actuator's signal delayed by whole samples, and the remaining fraction of a sample."""
        w = u
        delay, offset = None, 0.0
        for effect in self.inputs:
            own = theta[self.slices[effect.key]]
            if effect.name == "input-delay":
                delay, offset = float(own[0]), float(own[1:].sum())
            else:
                w = effect.apply(w, own, span)
        delay = float(theta[0]) if delay is None else delay
        whole = math.floor(delay)
        return _kernels.delayed(w, whole, 0.0, offset), delay - whole

    def design(
        self,
        theta: FloatArray,
        u: FloatArray,
        span: int | None = None,
        reference: float | None = None,
        near: Design | None = None,
    ) -> Design:
        """Columns at `theta` for the input `u`, shape (N,); `span` and `reference` are those of the fit's record.

        `near`, a design for the same input at another theta, provides the columns that have not changed.
        """
        return self.assembled(theta, *self._parts(theta, u, span or u.size, reference, near))

    def assembled(self, theta: FloatArray, actuator: tuple[FloatArray, float], parts: tuple[FloatArray, ...]) -> Design:
        """The design of an actuator's signal and of the columns of the dynamics and of each additive effect."""
        columns = beside([parts[0], np.ones((parts[0].shape[0], 1)), *parts[1:]])
        n_sensed = columns.shape[1] - sum(effect.width for effect in self.additive if not effect.at_load)
        return Design(columns, n_sensed, theta, actuator, parts)

    def output_near(self, theta: FloatArray, gains: FloatArray, u: FloatArray, near: Design) -> FloatArray:
        """Sensor output at `theta` from what changes of the columns of a design for the same input."""
        _, parts = self._parts(theta, u, u.size, None, near)
        return self._sensed(theta, gains, parts)

    def _parts(
        self, theta: FloatArray, u: FloatArray, span: int, reference: float | None, near: Design | None
    ) -> tuple[tuple[FloatArray, float], tuple[FloatArray, ...]]:
        """The signal of the actuator, and the columns of the dynamics and of each additive effect."""
        at, now = self.slices["plant"], theta.tolist()
        then = [None] * len(now) if near is None else near.theta.tolist()
        same_input = near is not None and now[: at.start] == then[: at.start]
        actuator = near.actuator if near is not None and same_input else self._delayed_input(theta, u, span)
        plant, own = self.plant, theta[at]
        same_rates = now[at] == then[at]
        same_plant = same_rates and now[self._restarted] == then[self._restarted]
        if near is not None and same_input and same_plant:
            parts = [near.parts[0]]
        else:
            parts = [self._dynamics(theta, *actuator, span, reference, near if same_input and same_rates else None)]
        for i, effect in enumerate(self.additive, 1):
            part = self.slices[effect.key]
            if near is not None and now[part] == then[part] and (same_plant or not effect.uses_plant):
                parts.append(near.parts[i])
            else:
                parts.append(effect.columns(theta[part], u.size, span, plant, own))
        return actuator, tuple(parts)

    @property
    def _restarted(self) -> slice:
        """Place in theta of the initial states of nonlinear dynamics in further records."""
        return self.slices.get(Restarts.name, slice(0, 0))

    def _dynamics(
        self,
        theta: FloatArray,
        w: FloatArray,
        late: float,
        span: int,
        reference: float | None,
        near: Design | None,
    ) -> FloatArray:
        """Columns of the dynamics, in one run or one for each record; `near` differs in their initial states only."""
        plant, own, at = self.plant, theta[self.slices["plant"]], self._restarted
        if at.start == at.stop:
            feedback = self.feedback
            return plant.columns(own, w, span, reference, late, None if feedback is None else feedback.added(w.size))
        restarts = next(effect for effect in self.additive if isinstance(effect, Restarts))
        reference = float(w[0]) if reference is None else reference
        before = None if near is None else (near.parts[0], near.theta[at])
        return restarts.dynamics(plant, own, theta[at], w, span, reference, late, before)

    def gains_of(self, gains: FloatArray, effect: AdditiveEffect) -> FloatArray:
        """Gains of one additive effect."""
        at = gains.size - sum(other.width for other in self.additive[self.additive.index(effect) :])
        return gains[at : at + effect.width]

    def sensor(self, theta: FloatArray, gains: FloatArray, design: Design) -> FloatArray:
        """Sensor output for the columns of a design."""
        return self._sensed(theta, gains, design.parts)

    def _sensed(self, theta: FloatArray, gains: FloatArray, parts: tuple[FloatArray, ...]) -> FloatArray:
        """Sensor output for the columns of the dynamics and of each additive effect."""
        z = self._before_limits(theta, gains, parts)
        for effect, own in self._sensor_part(theta, limits=True):
            z = effect.apply(z, own)
        return z

    def undone(self, theta: FloatArray, y: FloatArray, design: Design, rows: np.ndarray) -> FloatArray:
        """Readings `y` from which the gains of a design can be estimated by linear least squares."""
        for effect in self.outputs:
            y = effect.undone(y, theta[self.slices[effect.key]], design.columns, rows)
        return y

    def reading(self, theta: FloatArray, gains: FloatArray, level: float) -> float:
        """Sensor reading at the steady state `level`, without the limits of the sensor."""
        return float(self._curved(theta, gains[:1] * level + gains[1])[0])

    def _before_limits(self, theta: FloatArray, gains: FloatArray, parts: tuple[FloatArray, ...]) -> FloatArray:
        at = parts[0].shape[1]
        z, added, at = parts[0] @ gains[:at] + gains[at], [], at + 1
        for effect, part in zip(self.additive, parts[1:], strict=True):
            own = part @ gains[at : at + part.shape[1]]
            at += part.shape[1]
            if effect.at_load:
                z += own
            else:
                added.append(own)
        z = self._curved(theta, z)
        return z + sum(added) if added else z

    def _curved(self, theta: FloatArray, z: FloatArray) -> FloatArray:
        for effect, own in self._sensor_part(theta, limits=False):
            z = effect.apply(z, own)
        return z

    def _sensor_part(self, theta: FloatArray, limits: bool) -> list[tuple[OutputEffect, FloatArray]]:
        """The limits of the sensor, or the effects ahead of them, with their parameters."""
        return [(one, theta[self.slices[one.key]]) for one in self.outputs if one.is_limit == limits]

    def sensed_columns(self, theta: FloatArray, gains: FloatArray, design: Design) -> FloatArray:
        """Derivatives of `sensor` by the gains, shape (N, m + q)."""
        z = design.sensed @ gains[: design.n_sensed]
        columns = design.columns.copy(order="F")
        for effect, own in self._sensor_part(theta, limits=False):
            columns[:, : design.n_sensed] = effect.passed(columns[:, : design.n_sensed], z, own)
            z = effect.apply(z, own)
        if gains.size > design.n_sensed:
            z = z + design.added @ gains[design.n_sensed :]
        for effect, own in self._sensor_part(theta, limits=True):
            columns = effect.passed(columns, z, own)
            z = effect.apply(z, own)
        return columns

    def within_limits(self, theta: FloatArray, gains: FloatArray, design: Design) -> np.ndarray:
        """The samples at which no limit of the sensor holds the reading."""
        z = self._before_limits(theta, gains, design.parts)
        moves = np.ones(z.size, bool)
        for effect, own in self._sensor_part(theta, limits=True):
            moves &= effect.slope(z, own) > 0.0
            z = effect.apply(z, own)
        return moves

    def output(
        self,
        theta: FloatArray,
        gains: FloatArray,
        u: FloatArray,
        span: int | None = None,
        reference: float | None = None,
    ) -> FloatArray:
        """Free-run output for the input `u`."""
        return self.sensor(theta, gains, self.design(theta, u, span, reference))
