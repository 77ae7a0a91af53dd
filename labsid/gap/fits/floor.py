"""The floor of a gap: what the printed digits of a record, and the errors of simulations, hide."""

from dataclasses import replace

import numpy as np

from labsid._arrays import FloatArray
from labsid.gap.fits.direct_term import innovations
from labsid.gap.record.data import Data

SIMULATION_ERROR = 1e-4
"""Of the spread of y: step errors of usual simulators, and of those of the diagnosis; set by hand."""
MOST_DIGITS = 9  # significant digits or decimals that are looked for: more are as good as exact; set by hand
ROUND_TRIP = 1e-5  # of a digit: distance from it that is rounding of binary numbers; numerics
NEARLY_ALL = 0.999  # of the samples; set by hand
PRINTED = 1e-3
"""Of the range: a smaller decimal step is that of the printed numbers, a larger one may be a converter's; set by
hand."""
DITHER = 1.5  # steps: standard deviation of noise that hides a rounding error but for 4 % of its power; set by hand
NOISY = 3.0
"""Rms of what the past does not foretell over the step of the digits, from which they do not matter; set by hand."""
SEED = 0  # of the white noise that is added; numerics


def digit_steps(values: FloatArray) -> FloatArray:
    """Step of the decimal digits with which each value of a signal is printed.

    Parameters
    ----------
    values : ndarray, shape (N,)

    Returns
    -------
    ndarray, shape (N,)
        In the unit of the signal: the same everywhere for a fixed number of decimals (``%.3f``), and in proportion to
        the decade of the value for one of significant digits (``%.6g``); 0 for numbers with more than `MOST_DIGITS` of
        both, and where such a value is zero.
    """
    there = values != 0.0
    found = [np.zeros(values.size)]
    decades = np.floor(np.log10(np.abs(values[there])))
    for digits in range(1, MOST_DIGITS + 1) if there.any() else ():
        significant = np.zeros(values.size)
        significant[there] = 10.0 ** (decades - digits + 1.0)
        decimals = np.full(values.size, 10.0 ** (float(decades.max()) - digits + 1.0))
        for steps in (significant, decimals):
            places = np.abs(values[there]) / steps[there]
            if np.mean(np.abs(places - np.round(places)) < ROUND_TRIP) >= NEARLY_ALL:
                found.append(steps)
    return max(found, key=lambda steps: _rms(steps[there]))


def digit_step(values: FloatArray) -> float:
    """Rms of the `digit_steps` of the values that are not zero."""
    return _rms(digit_steps(values)[values != 0.0])


def _rms(x: FloatArray) -> float:
    return float(np.sqrt(np.mean(x**2))) if x.size else 0.0


def is_printed(step: float, values: FloatArray) -> bool:
    """Whether a step of a signal is that of its printed digits, so that no converter has to explain it."""
    decimal = np.log10(step)
    return bool(step < PRINTED * np.ptp(values) and abs(decimal - np.round(decimal)) < ROUND_TRIP)


def with_floor(data: Data) -> Data:
    """The record with noise of the size below which an error is no gap.

    The errors of exact records have no distribution: a residual of 1e-15 may depend on the input, and every test of it
    would say so. White noise of the size of the errors of simulations, and of the last printed digit if the record has
    no more noise of its own, settles all of these tests at once.

    Parameters
    ----------
    data : Data
        As read.

    Returns
    -------
    Data
    """
    digits = 0.0
    for signal, scale in ((data.u, data.u_scale), (data.readings(data.y), data.y_scale)):
        values = np.asarray(scale.back(signal))
        step = digit_step(values)
        digits += (step / scale.unit) ** 2 if step < PRINTED * np.ptp(values) else 0.0
    present, new, free = innovations(data.at_readings())
    if present.any():  # a jump of the input that acts within the sample is no noise
        new = new - present * float(present @ new) / float(present @ present)
    if free <= 0 or new @ new > free * NOISY**2 * digits:
        digits = 0.0
    floor = float(np.hypot(SIMULATION_ERROR, DITHER * np.sqrt(digits)))
    turned = np.sign(data.y[np.argmax(np.abs(data.y))])  # a sensor of the other sign changes no answer
    return replace(data, y=data.y + turned * floor * np.random.default_rng(SEED).standard_normal(data.samples))
