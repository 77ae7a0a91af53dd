"""Whether a controller computes the input from the output of the same sample."""

from dataclasses import dataclass

import numpy as np

from labsid._arrays import FloatArray
from labsid.records.direction import feedback_statistic

FEEDBACK_F = 10.0  # F statistic; measured: 11 to 130 in loops that pass on noise, at most 6 on rigs in open loop
SWITCHES = 6  # in a row, over which the set point of a relay may be constant; set by hand
JUMP = 3.0
"""Times the size of other steps of the output: those at switches, from which the output jumps with the input; set by
hand."""
MIN_SEPARATED = 0.4  # of such stretches; measured: over 0.65 of relays whose set point moves at times, none of others
PASSES = 4  # of the regression without what the law does not explain; numerics
OUTLIER = 12.0  # times the median error, of what a reference or a limit adds (noise has four times); set by hand
EXACT = 0.9999  # share of the changes of the input that the law explains, of a controller without a limit; set by hand
MOST_JUMPS = 0.2  # of the samples, at which a reference or a limit acts besides; set by hand
MOST_STILL = 0.5
"""Of the samples, at which the input keeps its value or its slope: one that does is designed; set by hand."""
STILL = 1e-4  # of its largest second difference: rounding; numerics
ONE_LINE = 1e-6  # one less the size of the correlation of input and output, of a line without noise; numerics
STATIC = 0.002  # of its largest coefficient: a law with less of the past is a gain; set by hand
SMOOTH = 0.9  # share of the changes of the input that its own past foretells, of one that is designed; set by hand
PAST = 8  # samples; set by hand
RELAY_SWITCHES = 8  # fewest of an input, from which they are told from steps by hand; set by hand
LEAST_HELD = 4  # samples between two switches, from which the way of the output between them shows; set by hand
RELAY_SCATTER = 0.25
"""Scatter of the output at switches in one direction, over its way from one to the next; set by hand."""
LEAST_LATE = 0.1  # share of that way in the last quarter of the time, of an output that has not settled; set by hand


def has_controller(u: FloatArray, y: FloatArray) -> bool:
    """Whether the input responds to the output: by a linear law, as a relay, or as far as its past shows.

    Parameters
    ----------
    u, y : ndarray, shape (N,)
    """
    return feedback_statistic(u, y) > FEEDBACK_F or is_relay(u, y) or find_control_law(u, y) is not None


def is_one_line(u: FloatArray, y: FloatArray) -> bool:
    """Whether input and output are one straight line: a static rig, or a gain as a controller, with no noise.

    Parameters
    ----------
    u, y : ndarray, shape (N,)
    """
    return bool(1.0 - abs(np.corrcoef(u, y)[0, 1]) < ONE_LINE)


def is_relay(u: FloatArray, y: FloatArray) -> bool:
    """Whether a relay gives the input, with or without hysteresis.

    Parameters
    ----------
    u, y : ndarray, shape (N,)
    """
    return switches_on_output(u, y) or switches_with_hysteresis(u, y)


@dataclass(frozen=True, slots=True)
class ControlLaw:
    """A linear law by which the input follows from the output of the same sample, as of a P, PI or PID controller.

    Attributes
    ----------
    gain : float
        Change of the input with the output of the same sample, in the units of the signals; negative.
    exact : float
        Share of the changes of the input that it explains.
    jumps : float
        Share of the samples that it does not explain, at which a reference moves or a limit acts.
    """

    gain: float
    exact: float
    jumps: float

    @property
    def has_constant_reference(self) -> bool:
        """Whether nothing but disturbances and noise moves the input."""
        return self.jumps == 0.0


def switches_on_output(u: FloatArray, y: FloatArray) -> bool:
    """Whether an input of two levels is a function of the output of the same sample, as from a relay controller.

    Between changes of its set point all outputs at one level of a relay lie beyond all outputs at the other one, with
    no jump between them. The output of a rig that only follows its input is still on the other side when it switches;
    that of one with a direct term jumps.

    Parameters
    ----------
    u, y : ndarray, shape (N,)
    """
    levels = np.unique(u)
    if levels.size != 2:
        return False
    high = u == levels[1]
    ends = np.flatnonzero(np.diff(u)) + 1
    if ends.size <= SWITCHES:
        return False
    separated = 0
    for start, stop in zip(ends[:-SWITCHES] - 1, ends[SWITCHES:], strict=True):
        ups, downs = y[start:stop][high[start:stop]], y[start:stop][~high[start:stop]]
        apart = max(ups.min() - downs.max(), downs.min() - ups.max())
        moves, stays = np.abs(np.diff(y[start:stop])), np.diff(u[start:stop]) == 0.0
        jumps = not stays.any() or np.median(moves[~stays]) > JUMP * np.median(moves[stays])
        separated += bool(apart >= 0.0 and not jumps)
    return bool(separated > MIN_SEPARATED * (ends.size - SWITCHES))


def find_control_law(u: FloatArray, y: FloatArray) -> ControlLaw | None:
    """The law of a linear controller with a constant reference for most of the record; None without one.

    What a step of the reference does not change, the second difference of the input, is regressed on the differences of
    the output of the same sample and two before. A rig with a direct term obeys such a law, too, if that dominates, if
    it is static or if it has no static gain. A controller is told from it by the jumps of its reference; without them,
    by the law of a PI controller, or by that of a P controller whose input nobody has designed.

    Parameters
    ----------
    u, y : ndarray, shape (N,)
    """
    if y.size < 4 * PAST:
        return None
    moved, changes = np.diff(u, 2)[1:], np.diff(y)
    columns = np.column_stack([changes[2:], changes[1:-1], changes[:-2]])
    rows = np.ones(moved.size, bool)
    law = np.zeros(3)
    for _ in range(PASSES):
        law = np.asarray(np.linalg.lstsq(columns[rows], moved[rows])[0], np.float64)
        error = np.abs(moved - columns @ law)
        rows = error <= max(OUTLIER * float(np.median(error)), 1e-9 * float(np.ptp(u)))
    if np.mean(np.abs(moved) <= STILL * np.abs(moved).max()) > MOST_STILL:
        return None
    residual = moved[rows] - columns[rows] @ law
    exact = 1.0 - float(residual @ residual) / float(moved[rows] @ moved[rows])
    jumps = float(np.mean(~rows))
    if law[0] >= 0.0 or exact < EXACT or jumps > MOST_JUMPS:
        return None
    integrates, differentiates = np.abs([law.sum(), law[2]]) > STATIC * abs(law[0])
    if jumps == 0.0 and (differentiates or (not integrates and _foretold(moved) > SMOOTH)):
        return None
    return ControlLaw(float(law[0]), exact, jumps)


def switches_with_hysteresis(u: FloatArray, y: FloatArray) -> bool:
    """Whether an input of two levels switches where the output reaches one of two values, as a thermostat does.

    An input that is designed switches at multiples of some samples, or the output is elsewhere each time.

    Parameters
    ----------
    u, y : ndarray, shape (N,)
    """
    if np.unique(u).size != 2:
        return False
    ends = np.flatnonzero(np.diff(u)) + 1
    if ends.size < RELAY_SWITCHES:
        return False
    ups = u[ends] > u[ends - 1]
    scatter = max(float(np.std(y[ends[direction]])) for direction in (ups, ~ups))
    lengths = np.diff(ends)
    if np.median(lengths) < LEAST_HELD:
        return False
    moved = y[ends[1:]] - y[ends[:-1]]
    late = y[ends[1:]] - y[ends[1:] - np.maximum(lengths // 4, 1)]
    way = float(np.median(np.abs(moved)))
    is_moving = float(np.median(late * np.sign(moved))) > LEAST_LATE * way  # an output at rest keeps its value, too
    has_clock = int(np.gcd.reduce(lengths)) > 1
    return bool(scatter < RELAY_SCATTER * way and is_moving and not has_clock)


def _foretold(x: FloatArray) -> float:
    """Share of a signal that its own past foretells."""
    past = np.lib.stride_tricks.sliding_window_view(x, PAST)[:-1]
    target = x[PAST:]
    left = target - past @ np.linalg.lstsq(past, target)[0]
    return 1.0 - float(left @ left) / max(float(target @ target), np.finfo(float).tiny)
