"""Forces that react to the motion of a given simulation: friction and a spring at its input.

A given simulation runs as a whole, so a force that depends on its motion cannot be computed within it. Its response to
a pulse of the input tells how the force at one sample moves the later ones. With it, force and motion are solved sample
by sample, and the simulation is run with the input less this force. For a linear simulation that run has the motion of
the solution; for another one the solution is repeated about the last run until both agree.

Source: waveform Newton methods, as in E. Lelarasmee, A. Ruehli, A. Sangiovanni-Vincentelli, "The waveform relaxation
method for time-domain analysis of large scale integrated circuits", IEEE Trans. CAD 1 (1982) 131-145.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from labsid._arrays import FloatArray
from labsid._compiled import compiled

ROUNDS = 6  # of a run and a solution of the forces, until both agree; numerics
AGREEMENT = 2e-3  # rms difference of run and solution over the standard deviation of the output; numerics
MIN_FIRST = 0.1  # response after one sample over that after two: less is a delay of the input; set by hand
SETTLED = 1e-7  # of the largest value of a pulse response, below which it has decayed; numerics
DIRECT = 1e-6  # response at once over that after one sample, above which the force acts on itself; numerics


class Reaction(NamedTuple):
    """A force that is subtracted from the input, in scaled units.

    Attributes
    ----------
    friction : float
        Largest dry friction; it holds the output, or with `at_rest` holds it at `centre`, where it can.
    at_rest : bool
        Whether the output is a speed, which friction holds at `centre`; otherwise it is a position.
    cubic : float
        Force of a spring over the cube of the distance of the output from `centre`.
    centre : float
        Output of the unloaded spring, or of standstill.
    """

    friction: float = 0.0
    at_rest: bool = False
    cubic: float = 0.0
    centre: float = 0.0


def is_collocated(pulse: FloatArray) -> bool:
    """Whether a force at the input moves the output within one sample, and not at once.

    Parameters
    ----------
    pulse : ndarray, shape (N,)
        Response to a unit pulse of the input at sample 0.
    """
    if pulse.size < 3 or not np.isfinite(pulse).all():
        return False
    return bool(abs(pulse[1]) > MIN_FIRST * abs(pulse[2]) > 0.0 and abs(pulse[0]) < DIRECT * abs(pulse[1]))


def output_with(
    run: Callable[[FloatArray], FloatArray], w: FloatArray, pulse: FloatArray, reaction: Reaction
) -> FloatArray:
    """Output of a simulation with a reaction at its input; NaN if none is found that agrees with it.

    Parameters
    ----------
    run : callable
        ``run(w) -> y``, both of shape (N,).
    w : ndarray, shape (N,)
    pulse : ndarray, shape (N,)
        Response of the simulation to a unit pulse of the input at sample 0.
    reaction : Reaction
    """
    if not is_collocated(pulse):
        return np.full(w.size, np.nan)
    output, force = run(w), np.zeros(w.size)
    for _ in range(ROUNDS):
        if not np.isfinite(output).all():
            break
        wanted, force = _solve(w, output, force, pulse, *reaction)
        if not np.isfinite(wanted).all():
            break
        output = run(w - force)
        if np.sqrt(np.mean((output - wanted) ** 2)) < AGREEMENT * max(float(np.std(output)), 1e-12):
            return output
    return np.full(w.size, np.nan)


@compiled()
def _solve(
    w: FloatArray,
    output: FloatArray,
    contained: FloatArray,
    pulse: FloatArray,
    friction: float,
    at_rest: bool,
    cubic: float,
    centre: float,
) -> tuple[FloatArray, FloatArray]:
    """Motion and force for the input `w`, if `output` is the motion with the force `contained`.

    The force is constant within a sample: the means there of the spring's force and of friction. Time is in samples.
    """
    size = output.size
    y, force = output.copy(), np.zeros(size)
    spring, y_before = 0.0, output[0]
    reach = _memory(pulse)
    for k in range(size - 1):
        # One and two samples ahead without a force from now on, and with the input held.
        free = output[k + 1] + pulse[1] * contained[k]
        later = free
        for j in range(max(k - reach, 0), k):
            free -= pulse[k + 1 - j] * (force[j] - contained[j])
        if k + 2 < size:
            later = output[k + 2] + pulse[2] * contained[k] + pulse[1] * (contained[k + 1] - w[k + 1] + w[k])
            for j in range(max(k - reach, 0), k):
                later -= pulse[k + 2 - j] * (force[j] - contained[j])
        if cubic != 0.0:
            end = free - pulse[1] * (force[k - 1] if k else 0.0)
            middle = (3.0 * end + 6.0 * y[k] - y_before) / 8.0
            spring = cubic * ((y[k] - centre) ** 3 + 4.0 * (middle - centre) ** 3 + (end - centre) ** 3) / 6.0
        force[k] = spring
        if friction > 0.0:
            first = free - pulse[1] * spring - y[k]
            second = later - (pulse[1] + pulse[2]) * spring - y[k]
            if at_rest:
                speed, rate, unit = y[k] - centre, first, pulse[1]
            elif k + 2 < size:
                speed, rate, unit = 2.0 * first - 0.5 * second, second - 2.0 * first, 2.0 * pulse[1]
            else:
                speed, rate, unit = first, 0.0, 2.0 * pulse[1]
            force[k] += _mean_friction(speed / unit, rate / unit, friction)
        y_before = y[k]
        y[k + 1] = free - pulse[1] * force[k]
    return y, force


@compiled()
def _memory(pulse: FloatArray) -> int:
    """Samples after which a pulse response has decayed."""
    least = SETTLED * np.abs(pulse).max()
    last = pulse.size - 1
    while last > 0 and abs(pulse[last]) <= least:
        last -= 1
    return last


@compiled()
def _mean_friction(speed: float, drive: float, friction: float) -> float:
    """Mean over a sample of the dry friction on a unit mass with an initial speed and a constant driving force."""
    slides = friction if speed > 0.0 else -friction
    held = min(max(drive, -friction), friction)  # from standstill on
    if speed == 0.0:
        return held
    if (drive - slides) * speed >= 0.0:  # it does not become slower
        return slides
    time = min(-speed / (drive - slides), 1.0)
    return time * slides + (1.0 - time) * held
