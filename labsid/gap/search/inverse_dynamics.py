"""Fits of a joint from start values by its inverse dynamics.

The filtered acceleration of a joint is linear in its stiffness, damping, dry friction and weight, once the limit of its
loop is known. Least squares on it needs no simulation, and so has no local minimum: a search that adds one effect at a
time can end in one, where an arm stalls between the limit of its drive and its weight. Where a torque moves the joint
slowly, it hardly shows the inertia; then the torque in motion gives friction and weight, and several rates are tried.

Source: M. Gautier, "Dynamic identification of robots with power model", IEEE International Conference on Robotics and
Automation (1997); the filter is the same for all columns, as there.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from operator import attrgetter

import numpy as np
from numpy.typing import NDArray
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
from labsid.gap.fits.fitting import Fit, Point, Problem, descend, evaluate, mean_square
from labsid.gap.record.data import Data
from labsid.gap.search.candidates import Trial, is_compatible

CUTOFFS = (0.02, 0.05, 0.1, 0.2, 0.4, 0.8)  # of the filter, radians per sample; numerics
LIMIT_QUANTILES = (0.3, 0.45, 0.6, 0.7, 0.8, 0.9, 0.97)  # of the size of the loop's error, tried as its limit; numerics
REVERSAL = 0.05  # of the spread of the speed: width over which the sign of the speed turns; set by hand
MIN_PIECE = 60  # samples of a record, which the filter needs; set by hand
MIN_TURN = 1e-6  # radians per unit of the simulated position; numerics
LEAST_RATE = 1e-6  # per sample: stiffness and damping are positive; numerics
_LEAST = {"damping": LEAST_RATE, "friction": 0.0, "sine": -np.inf, "cosine": -np.inf}  # of each coefficient; definition
IN_LOOP: dict[str, Effect] = {one.name: one for one in (Gravity(), CoulombFriction("position"), ForceLimit("position"))}
BY_TORQUE: dict[str, Effect] = {one.name: one for one in (Gravity("unsprung"), CoulombFriction("unsprung"))}
RICHER_LAWS = ("drive", 0.0), ("load-give", 0.01), ("load-give", 0.1), ("peak-give", 0.01)  # with the way before the
# joint slides (radians): a long way makes the error smooth
FILTERS_OF_RICHER = 2
"""Filters whose starts the richer laws take, where the sharp law leaves least after the first stage; measured: on 29
joints the same answers as with all six, in 70 to 90 % of the time."""
STAGES = ((5, 1e3), (5, 30.0), (15, 30.0))
"""Iterations from the best start point of each filter, of those with an error (mean square over that of the linear
model) up to the second number; the better half goes on to the next stage; measured: what ended below half of the
linear error had at most 100 at its start and 4 after five iterations; on records of no joint, hundreds are left
then."""
STILL = 0.1  # of the spread of the speed: below, friction is not known from the direction; set by hand
MOST_STILL = 0.05  # share of such samples within the filter; set by hand
MIN_MOVING = 40  # samples in motion; set by hand
FREQUENCIES = (0.003, 0.01, 0.03, 0.1)  # radians per sample: tried rates of swings too slow to show them; numerics
DAMPINGS = (0.3, 1.0)  # the same of their dampings; numerics
LEAST_STIFFNESS = 3e-10  # per squared sample, of the spring that a joint driven by a torque does not have; numerics


def joint_trials(data: Data, base: Fit, highpass: Fit, names: Sequence[str]) -> list[Trial]:
    """Fits of a joint with the named effects from such start values, of least error first.

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
        Empty if the record is not that of a joint, or is too short for the filter. None leaves more than `base`.
    """
    context = Context(data, base, highpass)
    if base.hypothesis.found or not angle_unit(data) or min(map(len, _pieces(data))) < MIN_PIECE:
        return []
    trials: list[Trial] = []
    most = mean_square(data, base)
    for effects, starts in ((IN_LOOP, _loop_starts), (BY_TORQUE, _torque_starts)):
        chosen = [effects[name] for name in names if name in effects]
        if len(chosen) == len(names) and all(one.applies(context) and is_compatible(base, one) for one in chosen):
            at = [list(starts(context, names, cutoff)) for cutoff in CUTOFFS]
            common = {"delay": float(base.theta[0])} if not base.hypothesis.delay_is_an_effect else {}
            for laws, way in _laws(chosen):
                problem = Problem(data, base.hypothesis.with_effects((*base.hypothesis.effects, *laws)))
                best = (_best_of(problem, [common | start | _way(start, way) for start in few]) for few in at)
                begun = [_descended(Trial(problem, one), 0, most) if one is not None else None for one in best]
                trials += [one for one in begun if one is not None]
                if laws == chosen:
                    ranked = sorted((one.point.cost, n) for n, one in enumerate(begun) if one is not None)
                    at = [at[n] for _, n in ranked[:FILTERS_OF_RICHER]]
    for stage in range(1, len(STAGES)):
        trials.sort(key=attrgetter("point.cost"))
        further = (_descended(one, stage, most) for one in trials[: -(-len(trials) // 2)])
        trials = [one for one in further if one is not None]
    return sorted((one for one in trials if one.point.cost <= most), key=attrgetter("point.cost"))


def _descended(trial: Trial, stage: int, most: float) -> Trial | None:
    """The trial after a stage of the fit; None if its error before is above the stage's ratio to `most`."""
    iterations, ratio = STAGES[stage]
    if trial.point.cost > ratio * most:
        return None
    return Trial(trial.problem, descend(trial.problem, trial.point, iterations))


def _laws(chosen: list[Effect]) -> Iterator[tuple[list[Effect], float]]:
    """The effects with each law of friction, and the way before the joint slides; zero where it does not give."""
    yield chosen, 0.0
    if any(isinstance(one, CoulombFriction) for one in chosen):
        yield from (([_of_law(one, law) for one in chosen], way) for law, way in RICHER_LAWS)


def _of_law(effect: Effect, law: str) -> Effect:
    """Friction of another law, any other effect as it is."""
    return CoulombFriction(f"{effect.variant}-{law}") if isinstance(effect, CoulombFriction) else effect


def _way(start: Mapping[str, float], way: float) -> dict[str, float]:
    """The parameter of a way in radians."""
    return {"log_give": float(np.log(way)) - start["log_turn"]} if way else {}


def _theta(parameters: Sequence[Parameter], start: Mapping[str, float]) -> FloatArray:
    """Theta with the named values, within the bounds."""
    return np.array([np.clip(start.get(one.name, one.start), one.lower, one.upper) for one in parameters])


def _best_of(problem: Problem, starts: Sequence[Mapping[str, float]]) -> Point | None:
    """The start of least error; None if none can be simulated."""
    points = evaluate(problem, [_theta(problem.hypothesis.parameters, start) for start in starts])
    return min(points, key=attrgetter("cost"), default=None)


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
    rows : ndarray of bool, shape (N,)
        Samples that count, none of them between the records.
    moving : ndarray of bool, shape (N,)
        Those of `rows` at which the joint moves: where it rests, friction is any force up to its level.
    """

    data: Data
    position: FloatArray
    sections: FloatArray
    speed: FloatArray
    acceleration: FloatArray
    columns: dict[str, FloatArray]
    rows: NDArray[np.bool_]
    moving: NDArray[np.bool_]

    def filtered(self, x: FloatArray) -> FloatArray:
        """A signal behind the filter."""
        return _smooth(self.data, self.sections, x)

    def fits(self, drive: FloatArray, least: float = -np.inf) -> Iterator[dict[str, float]]:
        """Least squares on the acceleration, at all samples and in motion: coefficients by name.

        That of the filtered `drive` is at `least` so large.
        """
        columns = {"drive": drive, **self.columns}
        lower = [least if name == "drive" else _LEAST[name] for name in columns]
        for rows in (self.rows, self.moving):
            if rows.sum() >= MIN_MOVING:
                found = lsq_linear(np.column_stack([*columns.values()])[rows], self.acceleration[rows], (lower, np.inf))
                yield dict(zip(columns, map(float, found.x), strict=True))

    def slow_fits(self, torque: FloatArray, per_radian: float) -> Iterator[dict[str, float]]:
        """Coefficients as those of `fits`, from friction and weight against the filtered torque in motion.

        They are those of several rates; `per_radian` is the position of a radian.
        """
        rows = self.moving
        columns = {name: -one for name, one in self.columns.items() if name != "damping"}
        if rows.sum() < MIN_MOVING or "sine" not in columns:
            return
        lower = [_LEAST[name] for name in columns]
        found = lsq_linear(np.column_stack([*columns.values()])[rows], torque[rows], (lower, np.inf)).x
        forces = dict(zip(columns, map(float, found), strict=True))
        weight, _ = _weight(forces)
        if weight == 0.0:  # there is no torque in motion
            return
        for frequency, damping in product(FREQUENCIES, DAMPINGS):
            drive = frequency**2 * per_radian / weight
            yield {"drive": drive, "damping": 2.0 * damping * frequency} | {n: drive * x for n, x in forces.items()}

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
    rows = np.zeros(data.samples, bool)
    for piece in _pieces(data):
        rows[piece] = data.rows[piece]
    still = np.abs(speed) < STILL * np.std(speed)
    moving = rows & (_smooth(data, sections, still.astype(np.float64)) < MOST_STILL)
    acceleration = _smooth(data, sections, _slope(data, slope))
    return _Motion(data, position, sections, speed, acceleration, columns, rows, moving)


def _smooth(data: Data, sections: FloatArray, x: FloatArray) -> FloatArray:
    """A signal behind the filter, without a shift in time, in each record."""
    return by_record(x.size, data.pieces, lambda own: sosfiltfilt(sections, x[own]))


def _slope(data: Data, x: FloatArray) -> FloatArray:
    """Change per sample, in each record."""
    return by_record(x.size, data.pieces, lambda own: np.gradient(x[own]))


def _loop_starts(context: Context, names: Sequence[str], cutoff: float) -> Iterator[dict[str, float]]:
    """Parameters of a position loop, whose force is its stiffness times the error, as far as the limit."""
    data = context.data
    scale, own = data.u_scale, angle_unit(data)
    position = np.asarray(scale.of(np.asarray(data.y_scale.back(data.y))))
    error = data.u - position
    limits = np.quantile(np.abs(error[data.rows]), LIMIT_QUANTILES) if ForceLimit.name in names else [np.inf]
    motion = _motion(data, position, cutoff, names)
    for limit in limits:
        for found in motion.fits(motion.filtered(np.clip(error, -limit, limit)), LEAST_RATE):
            stiffness, damping = found["drive"], found["damping"]
            unit = force_unit(damping, stiffness)
            start = {"log_c": float(np.log(damping)), "log_k": float(np.log(stiffness)), "limit": float(limit)}
            start |= motion.initial_states(float(data.u[0]), 1.0, unit)
            start["log_turn"] = float(np.log(scale.unit / own))
            start["friction"] = found.get("friction", 0.0) / unit
            if Gravity.name in names:
                torque, rest = _weight(found)
                first = float(scale.back(data.u[0])) / own
                start |= {"torque": torque / unit, "angle": rest - first}
            yield start


def _torque_starts(context: Context, names: Sequence[str], cutoff: float) -> Iterator[dict[str, float]]:
    """Parameters of a joint that a torque drives, in the unit in which the simulation counts its position."""
    data = context.data
    per_radian = angle_unit(data) / data.y_scale.unit
    zero = -data.u_scale.centre / data.u_scale.unit  # no torque: a constant beside sine and cosine is not determined
    motion = _motion(data, data.y, cutoff, names)
    torque = motion.filtered(data.u - zero)
    for found in (*motion.fits(torque), *motion.slow_fits(torque, per_radian)):
        drive, damping = found["drive"], found["damping"]
        stiffness = _weight(found)[0] / per_radian if Gravity.name in names else context.rates[1]
        stiffness = max(stiffness * float(np.exp(SLACK_LOG_STIFFNESS)), LEAST_STIFFNESS)
        unit = force_unit(damping, stiffness)
        gain = drive / unit  # of the scaled output, per unit of the position
        turn = abs(gain) / per_radian
        if turn < MIN_TURN:
            continue
        start = {"log_c": float(np.log(damping)), "log_k": float(np.log(stiffness)), "centre": zero}
        start |= motion.initial_states(0.0, gain, unit) | {"log_turn": float(np.log(turn))}
        start["friction"] = found.get("friction", 0.0) / abs(drive)
        if Gravity.name in names:
            weight, rest = _weight(found)
            turned = rest - data.y_scale.centre / data.y_scale.unit / per_radian
            start |= {"torque": weight / abs(drive), "angle": float(np.sign(gain)) * turned}
        yield start


def _weight(found: Mapping[str, float]) -> tuple[float, float]:
    """Largest acceleration by gravity and the angle at which it vanishes, from A sin + B cos = G sin(angle - rest)."""
    sine, cosine = found["sine"], found["cosine"]
    return float(np.hypot(sine, cosine)), float(np.arctan2(-cosine, sine))
