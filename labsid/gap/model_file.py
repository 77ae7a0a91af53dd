"""Exported simulations: a fitted hypothesis as JSON and as a callable."""

import json
from collections.abc import Callable, Sequence
from dataclasses import astuple, dataclass, field, replace
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np

from labsid._arrays import FloatArray
from labsid.gap.dynamics.given_simulation import GivenSimulation
from labsid.gap.dynamics.inside_parts import port_from_json
from labsid.gap.dynamics.plants import Plant
from labsid.gap.dynamics.record_start import LEAST_START, RecordStart
from labsid.gap.effects.base import Effect
from labsid.gap.effects.families import EFFECTS_BY_KEY
from labsid.gap.effects.further_inputs import FurtherInput, SameEntry
from labsid.gap.effects.output_feedback import OutputFeedback
from labsid.gap.effects.restarts import Restarts, in_one_record
from labsid.gap.fits.fitting import Fit
from labsid.gap.fits.hypothesis import Hypothesis
from labsid.gap.record.data import Data, Scale
from labsid.records.record import bridge_gaps
from labsid.simulators.process import open_in_process
from labsid.simulators.simulator import Simulator

SCHEMA = "labsid.model/1"
SETTLING_SAMPLES = 5000  # at constant input before a simulation from rest
BEFORE_ANY_CHANGE = 10**9  # samples: with a record so long, loads and drifts do not change within SETTLING_SAMPLES
STATE_OFFSETS = (0.0, -0.5, 0.5, -1.0, 1.0, -2.0, 2.0, -3.0, 3.0)  # scaled start values of initial states
INPUT_PARTS = 16  # of a record
STATE_STEP = 1e-3  # scaled: of the derivative by an initial state
STATE_ITERATIONS = 12
SAME_INPUT = 1e-6  # scaled: numbers in text files have ten digits
OFFSET_SPREAD = 0.3  # scaled: expected difference of the offsets of two records of a rig, as if seen on one record
_OF_ONE_RECORD = (
    "load",
    "leak",
    "drift",
    "bend",
    "shape",
    "shake_",
    "off_",
)  # sizes of loads, drifts, sinusoids; times
LEAST = RecordStart()
SETTLED_FILTER = 3.0  # time constants of a lag ahead of nonlinear dynamics, whose state is not estimated
MOST_UNKNOWN = 0.5  # of the samples that determine a state, with an input that depends on what was before the record
SAME_DRIVE = 1e-3  # scaled
PASSING = {"width": 0.0, "delay": 0.0, "log_rate": 3.0}  # play, delay and rate limit that do nothing
STATES = ("h1", "h2", "z0", "v0", "i0", "position", "before")


@dataclass(frozen=True, slots=True, eq=False)
class ExportedModel:
    """A fitted hypothesis that can be simulated: written by `--export`, run by `labsid gap simulate`.

    Attributes
    ----------
    hypothesis : Hypothesis
    theta, gains : ndarray
    Ts : float
    span : int
        Length of the fitted record, the time unit of slow changes.
    reference : float
        Actuator's signal at the start of that record, the operating point of linear dynamics.
    u_scale, y_scale : Scale
    input_means : ndarray
        Scaled means of the input of the fitted record over parts of it, by which that record is recognised; empty if
        unknown. On another record, loads, sinusoids and drifts are left out: they belong to the fitted one.
    elsewhere : ExportedModel or None
        The simulation of other records, if it is not this one without its loads, sinusoids and drifts.
    offset_weight : float
        Weight of the offset's distance from that of the model, relative to one sample, in the estimate of a record's
        offset and initial state. Zero, after a fit to one record: the offset is that of the model.
    start : RecordStart
        Which samples of a record determine its initial state.
    """

    hypothesis: Hypothesis
    theta: FloatArray
    gains: FloatArray
    Ts: float
    span: int
    reference: float
    u_scale: Scale
    y_scale: Scale
    input_means: FloatArray = field(default_factory=lambda: np.zeros(0))
    elsewhere: "ExportedModel | None" = None
    offset_weight: float = 0.0
    start: RecordStart = LEAST

    def simulate(self, u: FloatArray, y: FloatArray | None = None, of_record: bool | None = None) -> FloatArray:
        """Free-run output for an input in the record's unit.

        Parameters
        ----------
        u : ndarray, shape (N,)
        y : ndarray, shape (N,), optional
            Its first samples determine the initial state, but for missing ones (NaN); without it the simulation starts
            from rest. All of it acts on the simulation of an unstable rig, which is not bounded otherwise.
        of_record : bool, optional
            Whether loads, sinusoids and drifts of the fitted record act; by default, if `u` is the input of that
            record.

        Returns
        -------
        ndarray, shape (N,)

        Raises
        ------
        ValueError
            If the rig is unstable and `y` is not given.
        """
        of_record = self._fitted_to(u) if of_record is None else of_record
        model = (self if of_record else (self.elsewhere or self)._without_time_courses())._at_rest()._beside(y)
        w = model.u_scale.of(u)
        output = model._from_rest(w) if y is None else model._started(w, model.y_scale.of(y))._output(w)
        return np.asarray(model.y_scale.back(output))

    def settled(self, u: FloatArray) -> FloatArray:
        """Free-run output that begins with dynamics at zero, without loads, sinusoids and drifts.

        It is that from rest once `u` has held its first value for `SETTLING_SAMPLES`.

        Parameters
        ----------
        u : ndarray, shape (N,)
        """
        model = (self.elsewhere or self)._without_time_courses()._at_rest()
        return np.asarray(model.y_scale.back(model._output(model.u_scale.of(u))))

    def started_on(self, u: FloatArray, y: FloatArray) -> "ExportedModel":
        """The model with which another record of the rig is simulated: without loads, sinusoids and drifts, and with
        the initial state estimated from its first samples.

        Parameters
        ----------
        u, y : ndarray, shape (N,)
        """
        return self._without_time_courses()._at_rest()._beside(y)._started(self.u_scale.of(u), self.y_scale.of(y))

    def _beside(self, y: FloatArray | None) -> "ExportedModel":
        """The model of an unstable rig with the feedback of a measured output; others as they are."""
        if self.hypothesis.feedback is None:
            return self
        if y is None:
            raise ValueError(
                "the rig is unstable: beside the input alone, its simulation grows without bound. Give the measured "
                "output as well."
            )
        return replace(self, hypothesis=self.hypothesis.beside_output(self.y_scale.of(bridge_gaps(y))))

    def _fitted_to(self, u: FloatArray) -> bool:
        """Whether `u` is the input of the fitted record, as far as known."""
        if not self.input_means.size:
            return True
        return u.size == self.span and np.allclose(_means(self.u_scale.of(u)), self.input_means, atol=SAME_INPUT)

    def _without_time_courses(self) -> "ExportedModel":
        theta, gains = self.theta.copy(), self.gains.copy()
        for i, parameter in enumerate(self.hypothesis.parameters):
            if parameter.name.startswith(_OF_ONE_RECORD):
                theta[i] = 0.0
        at = gains.size
        for effect in reversed(self.hypothesis.additive):
            at -= effect.width
            if not effect.lasting:
                gains[at : at + effect.width] = 0.0
        return replace(self, theta=theta, gains=gains)

    def _from_rest(self, u: FloatArray) -> FloatArray:
        """Output after a long time at the first input; loads, sinusoids and drifts begin with `u`."""
        hypothesis, theta = self.hypothesis, self.theta
        rest = np.full(SETTLING_SAMPLES, u[0])
        if any(
            theta[i] for i, parameter in enumerate(hypothesis.parameters) if parameter.name.startswith(_OF_ONE_RECORD)
        ):
            level = hypothesis.output(theta, self.gains, rest, BEFORE_ANY_CHANGE, self.reference)[-1]
            return self._started(rest, np.full(SETTLING_SAMPLES, level))._output(u)
        design = hypothesis.design(theta, np.concatenate([rest, u]), self.span, self.reference)
        if hypothesis.additive:
            own = hypothesis.design(theta, u, self.span, self.reference).parts[1:]
            added = (np.concatenate([np.repeat(part[:1], SETTLING_SAMPLES, axis=0), part]) for part in own)
            design = hypothesis.assembled(theta, design.actuator, (design.parts[0], *added))
        return hypothesis.sensor(theta, self.gains, design)[SETTLING_SAMPLES:]

    def _output(self, u: FloatArray) -> FloatArray:
        return self.hypothesis.output(self.theta, self.gains, u, self.span, self.reference)

    def _states(self) -> tuple[list[int], list[int]]:
        """Indices of the initial state in theta and in the gains."""
        names = [parameter.name for parameter in self.hypothesis.parameters]
        in_theta = [i for i, name in enumerate(names) if name in STATES]
        in_gains = list(self.hypothesis.plant.state_columns)
        at = self._offset + 1
        for effect in self.hypothesis.additive:
            in_gains += [at + column for column in effect.state_columns]
            at += effect.width
        return in_theta, [*in_gains, self._offset] if self.offset_weight else in_gains

    @property
    def _offset(self) -> int:
        """Index of the offset in the gains."""
        return self.gains.size - sum(effect.width for effect in self.hypothesis.additive) - 1

    def _at_rest(self) -> "ExportedModel":
        theta, gains = self.theta.copy(), self.gains.copy()
        in_theta, in_gains = self._states()
        for i in in_theta:
            theta[i] = 0.5 if self.hypothesis.parameters[i].name == "position" else 0.0
        gains[in_gains] = 0.0
        gains[self._offset] = self.gains[self._offset]
        return replace(self, theta=theta, gains=gains)

    def _started(self, u: FloatArray, y: FloatArray) -> "ExportedModel":
        """The model with the initial state that fits the first samples best; with the offset, if it is estimated.

        The minimization starts from the best point of a grid: at a brim, a limit or in friction the error has several
        minima.
        """
        in_theta, in_gains = self._states()
        if not in_theta and not in_gains:
            return self
        used = self.start.used(u.size)
        u, y = u[:used], y[:used]
        first = self._unknown_samples(u)
        known = ~np.isnan(y[first:])

        def with_state(x: FloatArray) -> ExportedModel:
            theta, gains = self.theta.copy(), self.gains.copy()
            theta[in_theta], gains[in_gains] = np.split(x, [len(in_theta)])
            return replace(self, theta=theta, gains=gains)

        def error(x: FloatArray) -> FloatArray:
            """Error of the output, and the weighted distance of an estimated offset from that of this model."""
            model = with_state(x)
            away = self.offset_weight * (self.gains[self._offset] - model.gains[self._offset])
            e = (y - model._output(u))[first:][known]
            return np.append(e, away) if self.offset_weight else e

        state, linear = self.theta[in_theta], self.gains[in_gains]
        lower, upper = (end[in_theta] for end in self.hypothesis.bounds)
        units = np.array([self._grid_unit(i) for i in in_theta])
        offsets = (np.multiply(offset, units) for offset in product(STATE_OFFSETS, repeat=len(in_theta)))
        grid = (np.append(np.clip(state + offset, lower, upper), linear) for offset in offsets)
        start = min(grid, key=lambda x: _power(error(x)))
        free = np.full(len(in_gains), np.inf)
        return with_state(minimize_state(error, start, np.append(lower, -free), np.append(upper, free)))

    def _unknown_samples(self, u: FloatArray) -> int:
        """Samples in which the dynamics are driven by what was before the record: in a delay, or on the way of an
        actuator with limited rate or a lag. After them, the initial state stands for what that drive has left.
        """
        hypothesis, theta = self.hypothesis, self.theta.copy()
        if self.start.rates is None:
            return 0
        for effect in hypothesis.inputs:
            if any(parameter.name in STATES for parameter in effect.parameters):  # they are estimated
                theta[hypothesis.slices[effect.key].start] = PASSING[effect.parameters[0].name]
        constants = (np.full(SETTLING_SAMPLES, end) for end in (u.min(), u.max()))
        low, high = (
            hypothesis.actuator(theta, np.concatenate([constant, u]))[SETTLING_SAMPLES:] for constant in constants
        )
        unknown = int(np.flatnonzero(np.append(True, np.abs(high - low) > SAME_DRIVE))[-1])
        if hypothesis.plant.nonlinear and hypothesis.plant.lag_ahead:
            lag = theta[hypothesis.slices["plant"]][hypothesis.plant.index("log_lag")]
            unknown += int(np.ceil(SETTLED_FILTER * np.exp(lag)))
        return min(unknown, int(MOST_UNKNOWN * u.size))

    def _grid_unit(self, at: int) -> float:
        """Distance by which an initial state, at the index `at` of theta, is varied first."""
        name, plant = self.hypothesis.parameters[at].name, self.hypothesis.plant
        if plant.kind == "tanks" and name in ("h1", "h2"):
            return plant.level_slopes(self.theta[self.hypothesis.slices["plant"]])[name == "h2"]
        return 0.25 if name == "position" else 1.0

    def to_json_dict(self) -> dict[str, Any]:
        """Return the JSON object that `--export` writes.

        Raises
        ------
        ValueError
            If it contains a given simulation that is no file.
        """
        plant = self.hypothesis.plant
        feedback, further = self.hypothesis.feedback, further_to_json(self.hypothesis.effects)
        content: dict[str, Any] = {
            "schema": SCHEMA,
            **({"further": further} if further else {}),
            "effects": [effect.key for effect in self.hypothesis.effects if effect is not feedback],
            "parameters": [parameter.name for parameter in self.hypothesis.parameters],
            "theta": self.theta.tolist(),
            "gains": self.gains.tolist(),
            "Ts": self.Ts,
            "span": self.span,
            "reference": self.reference,
            "input_means": self.input_means.tolist(),
            "offset_weight": self.offset_weight,
            "start_rates": None if self.start.rates is None else list(self.start.rates),
            "u_scale": {"centre": self.u_scale.centre, "unit": self.u_scale.unit},
            "y_scale": {"centre": self.y_scale.centre, "unit": self.y_scale.unit},
        }
        if feedback is not None:
            about = {"gains": list(feedback.gains), "closed": list(feedback.closed), "about": feedback.about}
            content["feedback"] = about
        if plant.kind == "given":
            if not plant.simulation.source:
                raise ValueError(
                    "the given simulation cannot be exported: it is no file that can be run again, and no output of a "
                    "linear model. Give a model, FILE.py:FUNCTION or FILE.fmu instead."
                )
            given = plant.simulation
            free = {
                name: {"nominal": value, "unit": given.units.get(name, 1.0), "range": given.ranges.get(name)}
                for name, value in given.nominal.items()
            }
            content["simulator"] = {"source": given.source, "free": free, "rates": list(given.rates)}
            if given.port is not None:
                content["simulator"]["port"] = given.port.to_json_dict()
        return content if self.elsewhere is None else content | {"elsewhere": self.elsewhere.to_json_dict()}


def _power(e: FloatArray) -> float:
    """Sum of squares; infinity where a simulation diverges."""
    return float(e @ e) if np.isfinite(e).all() else np.inf


def minimize_state(
    error: Callable[[FloatArray], FloatArray], x: FloatArray, lower: FloatArray, upper: FloatArray
) -> FloatArray:
    """Minimize the sum of squares of `error` from x, within bounds, by Levenberg-Marquardt."""
    best, damping = error(x), 1e-6
    for _ in range(STATE_ITERATIONS if np.isfinite(best).all() else 0):
        steps = np.where(x + STATE_STEP <= upper, STATE_STEP, -STATE_STEP)
        J = np.column_stack([(best - error(x + step)) / step.sum() for step in np.diag(steps)])
        gram = J.T @ J
        gram[np.diag_indices_from(gram)] += damping * (1e-9 + np.diag(gram))
        new = np.clip(x + np.linalg.lstsq(gram, J.T @ best, rcond=None)[0], lower, upper)
        e = error(new)
        if _power(e) < _power(best) * (1.0 - 1e-9):
            x, best, damping = new, e, max(damping / 10.0, 1e-9)
        else:
            damping = max(damping, 1e-6) * 30.0
            if damping > 1e6:
                break
    return x


def export_model(data: Data, fit: Fit, elsewhere: Fit | None = None, start: RecordStart = LEAST) -> ExportedModel:
    """Convert a fit to a simulation, and another one for other records, if there is one.

    `start` states which samples of a record determine its initial state.

    A fit to several records becomes a simulation with the mean of their offsets.
    """
    reference = float(fit.hypothesis.actuator(fit.theta, data.u)[0])
    hypothesis, theta, gains, weight = fit.hypothesis, fit.theta, fit.gains, 0.0
    restarts = next((effect for effect in hypothesis.additive if isinstance(effect, Restarts)), None)
    if restarts is not None:
        hypothesis, theta, gains, weight = _without_restarts(data, fit, restarts)
    scales = data.u_scale, data.y_scale
    return ExportedModel(
        hypothesis,
        theta,
        gains,
        data.Ts,
        data.samples,
        reference,
        *scales,
        _means(data.u),
        None if elsewhere is None else export_model(data, elsewhere, start=start),
        weight,
        start,
    )


def _without_restarts(data: Data, fit: Fit, restarts: Restarts) -> tuple[Hypothesis, FloatArray, FloatArray, float]:
    """Hypothesis, theta, gains and weight of the offset without what belongs to each of several records.

    The weight is the standard deviation of what is slow in the residual over that of the offsets of the records.
    """
    effects = tuple(in_one_record(effect) for effect in fit.hypothesis.effects if not isinstance(effect, Restarts))
    hypothesis = Hypothesis(effects, fit.hypothesis.n_given - 1, fit.hypothesis.given)
    lasting = {parameter.name for parameter in hypothesis.parameters}
    theta = fit.theta[[parameter.name in lasting for parameter in fit.hypothesis.parameters]]
    width = sum(effect.width for effect in fit.hypothesis.additive)
    first = fit.gains.size - width  # the restarts are in the structure, ahead of every effect found
    gains = np.delete(fit.gains, np.s_[first : first + restarts.width])
    own = fit.gains[first : first + restarts.width : restarts.per_record]
    offsets = fit.gains[first - 1] + np.concatenate([[0.0], own])
    offsets = offsets[[bool(data.rows[start:stop].any()) for start, stop in data.pieces]]
    gains[first - 1] = np.mean(offsets)
    deviations = float(np.sum((offsets - np.mean(offsets)) ** 2))
    spread = np.sqrt((deviations + OFFSET_SPREAD**2) / offsets.size)
    e = (data.y - fit.output)[data.rows]
    slow = fit.noise.sigma2 / max(1.0 - float(np.sum(fit.noise.ar)), 1e-3) ** 2
    slow = float(np.clip(slow, fit.noise.sigma2, LEAST_START * np.mean(e**2)))
    return hypothesis, theta, gains, float(np.sqrt(slow) / spread)


def _means(u: FloatArray) -> FloatArray:
    """Means over parts of the record."""
    return np.array([part.mean() for part in np.array_split(u, INPUT_PARTS)])


def further_to_json(effects: Sequence[Effect]) -> list[dict[str, Any]]:
    """The further inputs among effects, without their signals."""
    return [
        {
            "name": one.variant,
            "same_entry": isinstance(one, SameEntry),
            "reference": one.reference,
            **({"about": list(one.about), "shared": one.shared} if isinstance(one, FurtherInput) else {}),
        }
        for one in effects
        if isinstance(one, FurtherInput | SameEntry)
    ]


def further_from_json(content: Sequence[dict[str, Any]]) -> dict[str, Effect]:
    """The further inputs that `further_to_json` wrote, by their keys; their signals are those of a record."""
    found: list[Effect] = []
    for one in content:
        name, reference = str(one["name"]), float(one["reference"])
        if one["same_entry"]:
            found.append(SameEntry(name, reference))
        else:
            about = float(one["about"][0]), float(one["about"][1])
            found.append(FurtherInput(name, about, reference, bool(one["shared"])))
    return {effect.key: effect for effect in found}


ReadGiven = Callable[[Any, tuple[Scale, Scale], float], Plant]


def from_json_dict(content: dict[str, Any], read_given: ReadGiven | None = None) -> ExportedModel:
    """Read a JSON object written by `to_json_dict`.

    Parameters
    ----------
    content : dict
    read_given : callable, optional
        ``read_given(content, scales, Ts) -> Plant`` opens the given simulation in it; by default one of one input and
        one output.

    Raises
    ------
    ValueError
        If it is not an exported simulation.
    """
    wrong = "not an exported simulation: {}. Export it again."
    try:
        keys, written = [str(key) for key in content["effects"]], content["parameters"]
        theta, gains = np.array(content["theta"], float), np.array(content["gains"], float)
        elsewhere = None if content.get("elsewhere") is None else from_json_dict(content["elsewhere"], read_given)
        table = EFFECTS_BY_KEY | further_from_json(content.get("further", []))
        means = np.array(content.get("input_means", []), float)  # files of earlier versions have none
        weight = float(content.get("offset_weight", 0.0))
        rates = content.get("start_rates")
        start = LEAST if rates is None else RecordStart((float(rates[0]), float(rates[1])))
        feedback = () if content.get("feedback") is None else (_read_feedback(content["feedback"]),)
        Ts, span, reference = float(content["Ts"]), int(content["span"]), float(content["reference"])
        u_scale, y_scale = (
            Scale(float(content[name]["centre"]), float(content[name]["unit"])) for name in ("u_scale", "y_scale")
        )
    except KeyError as error:
        raise ValueError(wrong.format(f"{error} is missing")) from None
    except (TypeError, ValueError, OverflowError, IndexError):
        raise ValueError(wrong.format("a value has the wrong type")) from None
    unknown = [key for key in keys if key not in table]
    if unknown:
        raise ValueError(f"the simulation contains unknown effects: {', '.join(map(repr, unknown))}. Update labsid.")
    read_given = read_given or _read_given
    given = None if content.get("simulator") is None else read_given(content["simulator"], (u_scale, y_scale), Ts)
    hypothesis = Hypothesis((*feedback, *(table[key] for key in keys)), given=given)
    lower, upper = hypothesis.bounds
    names = [parameter.name for parameter in hypothesis.parameters]
    if written != names:
        raise ValueError(wrong.format(f"its parameters must be {', '.join(names)}"))
    if theta.shape != lower.shape or not np.all((theta >= lower) & (theta <= upper)):
        raise ValueError(wrong.format(f"theta must hold {lower.size} numbers within their bounds"))
    numbers = [*gains.ravel(), *means.ravel(), Ts, reference, weight, *astuple(u_scale), *astuple(y_scale)]
    if not np.isfinite(numbers).all() or min(Ts, span, u_scale.unit, y_scale.unit) <= 0 or weight < 0.0:
        raise ValueError(wrong.format("its numbers must be finite; Ts, span and the units must be positive"))
    if not all(np.isfinite(rate) and rate > 0.0 for rate in start.rates or ()):
        raise ValueError(wrong.format("start_rates must be two positive numbers"))
    design = hypothesis.design(theta, np.zeros(LEAST_START), span, reference)
    expected = design.columns.shape[1]
    if gains.shape != (expected,):
        raise ValueError(wrong.format(f"gains must hold {expected} numbers; got {gains.size}"))
    if means.shape not in ((0,), (INPUT_PARTS,)):
        raise ValueError(wrong.format(f"input_means must hold {INPUT_PARTS} numbers"))
    return ExportedModel(
        hypothesis, theta, gains, Ts, span, reference, u_scale, y_scale, means, elsewhere, weight, start
    )


def _read_feedback(content: dict[str, Any]) -> OutputFeedback:
    """The feedback of an unstable rig.

    Raises
    ------
    ValueError
        If its numbers are not finite, or its rates not positive.
    """
    position, speed = map(float, content["gains"])
    c, k = map(float, content["closed"])
    feedback = OutputFeedback(gains=(position, speed), closed=(c, k), about=float(content["about"]))
    if not np.isfinite([*feedback.gains, *feedback.closed, feedback.about]).all() or min(feedback.closed) <= 0.0:
        raise ValueError("the feedback must have finite gains and positive rates")
    return feedback


def with_sources(content: dict[str, Any], change: Callable[[str], str]) -> dict[str, Any]:
    """An exported simulation, the source of each given simulation in it changed."""
    changed = dict(content)
    if content.get("simulator") is not None:
        changed["simulator"] = content["simulator"] | {"source": change(content["simulator"]["source"])}
    if content.get("elsewhere") is not None:
        changed["elsewhere"] = with_sources(content["elsewhere"], change)
    return changed


def in_folder(content: dict[str, Any], folder: Path) -> dict[str, Any]:
    """An exported simulation whose files are named relative to `folder`."""
    return with_sources(content, lambda source: str(folder / source))


def opened_given(
    content: Any, opened: Callable[[str], Simulator]
) -> tuple[Simulator, tuple[float, float], dict[str, float], dict[str, tuple[float, float]]]:
    """The simulator of an exported simulation, its rates, and the units and ranges of its free numbers."""
    try:
        source, rates = str(content["source"]), (float(content["rates"][0]), float(content["rates"][1]))
        free = {str(name): dict(number) for name, number in content["free"].items()}
        nominal = {name: float(number["nominal"]) for name, number in free.items()}
        units = {name: float(number["unit"]) for name, number in free.items()}
        ranges = {
            name: (float(number["range"][0]), float(number["range"][1]))
            for name, number in free.items()
            if number["range"]
        }
    except (KeyError, IndexError, TypeError, ValueError, AttributeError):
        raise ValueError('not an exported simulation: its "simulator" has the wrong form. Export it again.') from None
    simulate = opened(source).with_free(list(nominal))
    changed = [name for name, value in nominal.items() if simulate.nominal[name] != value]
    if changed:
        raise ValueError(
            f"{source} has changed: {changed[0]} is {simulate.nominal[changed[0]]:g}, and was {nominal[changed[0]]:g} "
            "when the simulation was exported. Export it again."
        )
    return simulate, rates, units, ranges


def _read_given(content: Any, scales: tuple[Scale, Scale], Ts: float) -> Plant:
    """Open the simulator of an exported simulation of one input and one output."""
    simulate, rates, units, ranges = opened_given(content, open_in_process)
    given = replace(GivenSimulation.of(simulate, scales, Ts, rates), units=units, ranges=ranges)
    if content.get("port") is not None:
        given = replace(given, port=port_from_json(content["port"]))
    return Plant(kind="given", simulation=given)


def read_exported_model(content: dict[str, Any], Ts: float) -> ExportedModel:
    """Read an exported simulation for a record with the sampling time Ts.

    Raises
    ------
    ValueError
        If it is not an exported simulation, or has another sampling time.
    """
    model = from_json_dict(content)
    if abs(model.Ts - Ts) > 1e-6 * Ts:
        raise ValueError(f"the simulation runs at {model.Ts:g} s, the record at {Ts:g} s. Resample the record.")
    return model


def load_model(path: Path) -> dict[str, Any]:
    """Read a JSON object from a file.

    Raises
    ------
    ValueError
        If the file contains no JSON object.
    """
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
    except (ValueError, RecursionError) as error:
        raise ValueError(f"{path}: not JSON ({error}). Give a MODEL.json or a file written by --export.") from None
    if not isinstance(content, dict):
        raise ValueError(f"{path}: must hold a JSON object; got {type(content).__name__}.")
    return content
