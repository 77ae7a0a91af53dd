"""Put one effect of any size into a fitted simulation."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from labsid._arrays import FloatArray
from labsid.gap.dynamics.plant_form import STATES
from labsid.gap.effects.base import AdditiveEffect, Effect, Fitted, Planted, PlantEffect, Value
from labsid.gap.effects.context import Context
from labsid.gap.effects.dynamics import Placed
from labsid.gap.effects.families import FAMILIES
from labsid.gap.effects.restarts import in_records
from labsid.gap.fits.fitting import DIVERGED, Fit, Point, Problem
from labsid.gap.fits.hypothesis import Hypothesis
from labsid.gap.record.data import Data
from labsid.gap.search.candidates import is_compatible
from labsid.gap.search.forms import extended_hypotheses, transfer_theta

STATE_STEP = 0.1  # scaled: for the derivative by an initial state; numerics
NOTHING = 1e-9  # share of the whole: difference by a simulation of another kind at this size; numerics


@dataclass(frozen=True, slots=True, eq=False)
class Plantation:
    """One form of an effect in a fitted simulation, at any size.

    Attributes
    ----------
    effect : Effect
    fit : Fitted
        The simulation without the effect.
    form : Hypothesis
        With it.
    zero : Fitted
        The form with the effect at size zero.
    references : tuple of ndarray, shape (N,)
        Output of the effect without a size, of each place or of all: of the simulation, or of one of another kind with
        an effect of the size `NOTHING`.
    added : int
        Number of parameters that the effect adds.
    """

    effect: Effect
    fit: Fitted
    form: Hypothesis
    zero: Fitted
    references: tuple[FloatArray, ...]
    added: int

    def places(self, share: float) -> list[Planted]:
        """The effect at a size, for each place; none where it cannot have this size."""
        return self.effect.planted(self.zero if isinstance(self.effect, PlantEffect) else self.fit, share)

    def changes(self, share: float) -> list[FloatArray | None]:
        """Change of the output by the effect at a size, shape (N,), for each place; None where it diverges."""
        last = len(self.references) - 1
        return [
            None if output is None else output - self.references[min(place, last)]
            for place, output in enumerate(map(self.output, self.places(share)))
        ]

    def output(self, planted: Planted) -> FloatArray | None:
        """Output with a planted effect, shape (N,); None if the simulation diverges."""
        if isinstance(self.effect, Placed):
            passed = self.effect.passed(self.fit.data.u, planted.values)
            output: FloatArray | None = self.fit.hypothesis.output(self.fit.theta, self.fit.gains, passed)
        elif _is_of_another_kind(self.fit, self.form):
            at = _matched(self.fit, self.form, self.theta(planted))
            output = None if at is None else at.output
        else:
            output = self.form.output(self.theta(planted), self.gains(planted), self.fit.data.u)
        if output is None or not (np.abs(output) < DIVERGED).all():
            return None
        return np.asarray(output)

    def theta(self, planted: Planted) -> FloatArray:
        """Parameters of the form with a planted effect."""
        theta = self.zero.theta.copy()
        own = self.form.slices["plant" if isinstance(self.effect, PlantEffect) else self.effect.key]
        for at in range(own.start, own.stop):
            theta[at] = planted.values.get(self.form.parameters[at].name, theta[at])
        return theta

    def gains(self, planted: Planted) -> FloatArray:
        """Gains of the form with a planted effect."""
        if not planted.gains:
            return self.zero.gains
        gains = self.zero.gains.copy()
        if isinstance(self.effect, AdditiveEffect):
            index = [one.key for one in self.form.additive].index(self.effect.key)
            at = gains.size - sum(one.width for one in self.form.additive[index:])
        else:
            at = self.form.plant.slow_column
        gains[at : at + len(planted.gains)] += planted.gains
        return gains

    def size(self, planted: Planted) -> Value:
        """The size of a planted effect, in the units of the record."""
        if planted.size is not None:
            return planted.size
        found = Fitted(self.form, self.theta(planted), self.gains(planted), self.fit.data)
        return self.effect.values(found)[planted.parameter]

    def others(self, planted: Planted) -> dict[str, float]:
        """Other parameters of a planted effect, in the units of the record."""
        found = Fitted(self.form, self.theta(planted), self.gains(planted), self.fit.data)
        return {name: one.value for name, one in self.effect.values(found).items() if name != planted.parameter}

    def turns_into(self, kind: str) -> bool:
        """Whether the effect makes linear dynamics to those of another kind."""
        return _is_of_another_kind(self.fit, self.form) and self.form.plant.kind == kind

    @property
    def is_linear(self) -> bool:
        """Whether the change is proportional to the size."""
        return isinstance(self.effect, AdditiveEffect) and not self.fit.hypothesis.outputs


def plantations(data: Data, fit: Fit) -> Iterator[Plantation]:
    """Every form whose limits are reported and that the simulation and the record admit."""
    context, fitted = Context(data, fit), Fitted.of(fit, data)
    for family in FAMILIES:
        if family.name in fit.hypothesis.names:
            continue
        for variant in family.planted_variants:
            effect = in_records(family(variant), data.pieces[1:]) if data.pieces else family(variant)
            if is_compatible(fit, effect) and effect.applies(context):
                form = extended_hypotheses(fit.hypothesis, effect)[0]
                zero = _at_zero(fit, fitted, form, effect)
                if form.effects[:-1] == fit.hypothesis.effects and zero is not None:
                    added = len(form.parameters) + zero.gains.size - fit.theta.size - fit.gains.size
                    made = Plantation(effect, fitted, form, zero, (fit.output,), max(added, 1))
                    yield _against_its_own_kind(made) if _is_of_another_kind(fitted, form) else made


def _against_its_own_kind(made: Plantation) -> Plantation:
    """The plantation whose changes are those over a simulation of its own kind, with next to no effect."""
    outputs = [made.zero.output if one is None else one for one in map(made.output, made.places(NOTHING))]
    return replace(made, references=tuple(outputs) or (made.zero.output,))


def _is_of_another_kind(fit: Fitted, form: Hypothesis) -> bool:
    return form.plant.kind != fit.hypothesis.plant.kind


def _at_zero(fit: Fit, fitted: Fitted, form: Hypothesis, effect: Effect) -> Fitted | None:
    """The form with the effect at size zero; None if it cannot be simulated."""
    theta = transfer_theta(fit, form)
    if isinstance(effect, PlantEffect):
        own, names = theta[form.slices["plant"]], [parameter.name for parameter in form.plant.parameters]
        for name in set(names) & set(effect.absent):
            own[names.index(name)] = effect.absent[name]
        if _is_of_another_kind(fitted, form):
            own[:2] = form.plant.starts(*fit.rates)[0][:2]
            if form.plant.kind == "tanks":
                own[:2] += np.log(form.plant.level_slopes(own))
            theta = _with_states(fitted, form, theta) if form.plant.kind in STATES else theta
            at = _matched(fitted, form, theta)
            return None if at is None else Fitted(form, theta, at.gains, fitted.data)
    if isinstance(effect, Placed):  # its output is that behind a filtered input
        return Fitted(form, theta, fit.gains, fitted.data)
    at_place = partial(np.insert, fit.gains)
    if isinstance(effect, AdditiveEffect):
        index = [additive.key for additive in form.additive].index(effect.key)
        later = sum(additive.width for additive in form.additive[index + 1 :])
        gains = at_place(fit.gains.size - later, np.zeros(form.additive[index].width))
    else:
        columns = form.design(theta, fitted.data.u).columns.shape[1]
        gains = fit.gains
        if columns > gains.size:
            gains = at_place(form.plant.slow_column, np.zeros(columns - gains.size))
    return Fitted(form, theta, gains, fitted.data)


def _with_states(fit: Fitted, form: Hypothesis, theta: FloatArray) -> FloatArray:
    """Theta with the initial states of the simulation; at size zero the output is linear in them."""
    at = [form.slices["plant"].start + form.plant.index(state.name) for state in STATES[form.plant.kind]]
    columns = form.design(theta, fit.data.u).columns
    parts = [columns[:, :1], np.ones((fit.data.samples, 1))]
    for place in at:
        moved = theta.copy()
        moved[place] += STATE_STEP
        parts.append((form.design(moved, fit.data.u).columns[:, :1] - columns[:, :1]) / STATE_STEP)
    regressors = np.hstack(parts)
    if not np.isfinite(regressors).all():
        return theta
    gains = np.linalg.lstsq(regressors, fit.output)[0]
    lower, upper = form.bounds
    started = theta.copy()
    started[at] = np.clip(gains[2:] / (gains[0] or np.inf), lower[at], upper[at])
    return started


def _matched(fit: Fitted, form: Hypothesis, theta: FloatArray) -> Point | None:
    """The form whose gains give the output of the simulation as well as they can."""
    return Problem(replace(fit.data, y=fit.output), form).point(theta)
