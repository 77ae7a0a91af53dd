"""Start values of a joint from its motion, by the inverse dynamics.

The filtered acceleration of a joint is linear in its stiffness, damping, dry friction and weight, once the limit of its
loop is known. Least squares on it needs no simulation, and so has no local minimum: a search that adds one effect at a
time can end in one, where an arm stalls between the limit of its drive and its weight.

Source: M. Gautier, "Dynamic identification of robots with power model", IEEE International Conference on Robotics and
Automation (1997); the filter is the same for all columns, as there.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from operator import attrgetter

import numpy as np
from scipy.optimize import lsq_linear
from scipy.signal import butter, sosfiltfilt

from labsid._arrays import FloatArray
from labsid.gap.dynamics.given_simulation import by_record
from labsid.gap.dynamics.plant_form import Parameter
from labsid.gap.dynamics.responses import force_unit
from labsid.gap.effects.base import Effect
from labsid.gap.effects.context import Context
from labsid.gap.effects.dynamics import SLACK_LOG_STIFFNESS, CoulombFriction
from labsid.gap.effects.force_limit import ForceLimit
from labsid.gap.effects.gravity import Gravity, angle_unit
from labsid.gap.fits.fitting import Fit, Problem, evaluate
from labsid.gap.record.data import Data
from labsid.gap.search.candidates import Trial, is_compatible

CUTOFFS = (0.02, 0.05, 0.1, 0.2, 0.4, 0.8)  # of the filter, radians per sample
LIMIT_QUANTILES = (0.3, 0.45, 0.6, 0.7, 0.8, 0.9, 0.97)  # of the size of the loop's error, tried as its limit
REVERSAL = 0.05  # of the spread of the speed: width over which the sign of the speed turns
MIN_PIECE = 60  # samples of a record, which the filter needs
MIN_TURN = 1e-6  # radians per unit of the simulated position
LEAST_RATE = 1e-6  # per sample: stiffness and damping are positive
_LEAST = {"damping": LEAST_RATE, "friction": 0.0, "sine": -np.inf, "cosine": -np.inf}
IN_LOOP: dict[str, Effect] = {one.name: one for one in (Gravity(), CoulombFriction("position"), ForceLimit("position"))}
BY_TORQUE: dict[str, Effect] = {one.name: one for one in (Gravity("unsprung"), CoulombFriction("unsprung"))}


def joint_trials(data: Data, base: Fit, highpass: Fit, names: Sequence[str]) -> list[Trial]:
    """Start points of a joint with the named effects, of least error first.

    Parameters
    ----------
    data : Data
    base : Fit
        The linear model to which the effects are added.
    highpass : Fit
        A linear fit to the high-pass filtered record.
    names : sequence of str
        Of `gravity`, `coulomb-friction` and `force-limit`.

    Returns
    -------
    list of Trial
        Empty if the record is not that of a joint, or is too short for the filter.
    """
    context = Context(data, base, highpass)
    if base.hypothesis.found or not angle_unit(data) or min(map(len, _pieces(data))) < MIN_PIECE:
        return []
    trials: list[Trial] = []
    for effects, starts in ((IN_LOOP, _loop_starts), (BY_TORQUE, _torque_starts)):
        chosen = [effects[name] for name in names if name in effects]
        if len(chosen) == len(names) and all(one.applies(context) and is_compatible(base, one) for one in chosen):
            hypothesis = base.hypothesis.with_effects((*base.hypothesis.effects, *chosen))
            problem = Problem(data, hypothesis)
            common = {"delay": float(base.theta[0])} if not base.hypothesis.delay_is_an_effect else {}
            thetas = [_theta(hypothesis.parameters, common | start) for start in starts(context, names)]
            trials += [Trial(problem, point) for point in evaluate(problem, thetas)]
    return sorted(trials, key=attrgetter("point.cost"))


def _theta(parameters: Sequence[Parameter], start: Mapping[str, float]) -> FloatArray:
    """Theta with the named values, within the bounds."""
    return np.array([np.clip(start.get(one.name, one.start), one.lower, one.upper) for one in parameters])


def _pieces(data: Data) -> list[range]:
    """Samples of each record."""
    return [range(start, stop) for start, stop in data.pieces or ((0, data.samples),)]


@dataclass(frozen=True, slots=True, eq=False)
class _Motion:
    """Motion of a joint behind one filter; time in samples.

    Attributes
    ----------
    data : Data
    position : ndarray, shape (N,)
        In the unit of the simulated position.
    sections : ndarray
        Of the filter.
    speed, acceleration : ndarray, shape (N,)
        Filtered.
    columns : dict
        By coefficient, what its multiples add to the acceleration, filtered.
    """

    data: Data
    position: FloatArray
    sections: FloatArray
    speed: FloatArray
    acceleration: FloatArray
    columns: dict[str, FloatArray]

    def fit(self, drive: FloatArray, least: float = -np.inf) -> dict[str, float]:
        """Least squares on the acceleration: coefficients by name, that of the `drive` at `least` so large."""
        rows = np.zeros(self.data.samples, bool)
        for piece in _pieces(self.data):  # not between the records
            rows[piece] = self.data.rows[piece]
        columns = {"drive": _smooth(self.data, self.sections, drive), **self.columns}
        lower = [least if name == "drive" else _LEAST[name] for name in columns]
        found = lsq_linear(np.column_stack([*columns.values()])[rows], self.acceleration[rows], (lower, np.inf))
        return dict(zip(columns, map(float, found.x), strict=True))

    def initial_states(self, offset: float, gain: float, unit: float) -> dict[str, float]:
        """Initial states of each record, of positions over `gain` from `offset`."""
        found: dict[str, float] = {}
        for number, piece in enumerate(_pieces(self.data), 1):
            place = f" {number}" if number > 1 else ""
            found[f"z0{place}"] = float(self.position[piece.start] / gain - offset)
            found[f"v0{place}"] = float(self.speed[piece.start] / gain / np.sqrt(unit))
        return found


def _motion(data: Data, position: FloatArray, cutoff: float, names: Sequence[str]) -> _Motion:
    """The motion behind a filter without what is faster than `cutoff` (radians per sample)."""
    sections = butter(2, cutoff / np.pi, output="sos")
    slope = _slope(data, position)
    speed = _smooth(data, sections, slope)
    columns = {"damping": -speed}
    if CoulombFriction.name in names:
        columns["friction"] = -_smooth(data, sections, np.tanh(speed / (REVERSAL * np.std(speed))))
    if Gravity.name in names:
        angle = np.asarray(data.y_scale.back(data.y)) / angle_unit(data)
        columns |= {"sine": -_smooth(data, sections, np.sin(angle)), "cosine": -_smooth(data, sections, np.cos(angle))}
    return _Motion(data, position, sections, speed, _smooth(data, sections, _slope(data, slope)), columns)


def _smooth(data: Data, sections: FloatArray, x: FloatArray) -> FloatArray:
    """A signal behind the filter, without a shift in time, in each record."""
    return by_record(x.size, data.pieces, lambda own: sosfiltfilt(sections, x[own]))


def _slope(data: Data, x: FloatArray) -> FloatArray:
    """Change per sample, in each record."""
    return by_record(x.size, data.pieces, lambda own: np.gradient(x[own]))


def _loop_starts(context: Context, names: Sequence[str]) -> Iterator[dict[str, float]]:
    """Parameters of a position loop, whose force is its stiffness times the error, as far as the limit."""
    data = context.data
    scale, own = data.u_scale, angle_unit(data)
    position = np.asarray(scale.of(np.asarray(data.y_scale.back(data.y))))
    error = data.u - position
    limits = np.quantile(np.abs(error[data.rows]), LIMIT_QUANTILES) if ForceLimit.name in names else [np.inf]
    for cutoff in CUTOFFS:
        motion = _motion(data, position, cutoff, names)
        for limit in limits:
            found = motion.fit(np.clip(error, -limit, limit), LEAST_RATE)
            stiffness, damping = found["drive"], found["damping"]
            unit = force_unit(damping, stiffness)
            start = {"log_c": float(np.log(damping)), "log_k": float(np.log(stiffness)), "limit": float(limit)}
            start |= motion.initial_states(float(data.u[0]), 1.0, unit)
            start["friction"] = found.get("friction", 0.0) / unit
            if Gravity.name in names:
                torque, rest = _weight(found)
                first = float(scale.back(data.u[0])) / own
                start |= {"torque": torque / unit, "log_turn": float(np.log(scale.unit / own)), "angle": rest - first}
            yield start


def _torque_starts(context: Context, names: Sequence[str]) -> Iterator[dict[str, float]]:
    """Parameters of a joint that a torque drives, in the unit in which the simulation counts its position."""
    data, own = context.data, angle_unit(context.data)
    stiffness = context.rates[1] * float(np.exp(SLACK_LOG_STIFFNESS))
    zero = -data.u_scale.centre / data.u_scale.unit  # no torque: a constant beside sine and cosine is not determined
    for cutoff in CUTOFFS:
        motion = _motion(data, data.y, cutoff, names)
        found = motion.fit(data.u - zero)
        drive, damping = found["drive"], found["damping"]
        unit = force_unit(damping, stiffness)
        gain = drive / unit  # of the scaled output, per unit of the position
        if abs(gain) * data.y_scale.unit / own < MIN_TURN:
            continue
        start = {"log_c": float(np.log(damping)), "log_k": float(np.log(stiffness)), "centre": zero}
        start |= motion.initial_states(0.0, gain, unit)
        start["friction"] = found.get("friction", 0.0) / abs(drive)
        if Gravity.name in names:
            torque, rest = _weight(found)
            turned = rest - data.y_scale.centre / own
            start |= {"torque": torque / abs(drive), "angle": float(np.sign(gain)) * turned}
            start["log_turn"] = float(np.log(abs(gain) * data.y_scale.unit / own))
        yield start


def _weight(found: Mapping[str, float]) -> tuple[float, float]:
    """Largest acceleration by gravity and the angle at which it vanishes, from A sin + B cos = G sin(angle - rest)."""
    sine, cosine = found["sine"], found["cosine"]
    return float(np.hypot(sine, cosine)), float(np.arctan2(-cosine, sine))
