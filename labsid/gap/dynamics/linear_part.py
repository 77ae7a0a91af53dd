"""Discrete transfer function of linear dynamics, without their dead time."""

import numpy as np

from labsid._arrays import FloatArray
from labsid.gap.dynamics.plants import Plant, lag_time
from labsid.gap.dynamics.responses import denominator

LINEARISED = ("tanks", "mechanics", "speed", "varying", "leak")
"""Kinds whose poles are those about the mean level, or on average, and whose zeros are not computed."""


def denominator_of(plant: Plant, theta: FloatArray, span: int) -> FloatArray:
    """Coefficients of the denominator in descending powers of z, shape (n + 1,).

    Parameters
    ----------
    plant : Plant
        Not given.
    theta : ndarray, shape (len(plant.parameters),)
    span : int
        Samples of the fitted record.
    """
    own = {parameter.name: float(value) for parameter, value in zip(plant.parameters, theta, strict=True)}
    c, k = plant.linear_rates(theta)
    parts = [np.array([1.0, *denominator(c, k)])]
    if plant.lag:
        parts.append(np.array([1.0, -np.exp(-1.0 / lag_time(own, span))]))
    if plant.mode:
        frequency, damping = np.exp(own["log_frequency"]), np.exp(own["log_damping"])
        parts.append(np.array([1.0, *denominator(2.0 * damping * frequency, frequency**2)]))
    if plant.slow:
        parts.append(np.array([1.0, -np.exp(-np.exp(-own["log_slow"]))]))
    product = np.ones(1)
    for part in parts:
        product = np.convolve(product, part)
    return product


def numerator_of(plant: Plant, theta: FloatArray, gains: FloatArray, span: int, late: float = 0.0) -> FloatArray:
    """Coefficients of the numerator of a linear plant in descending powers of z, shape (n + 2,).

    With a part of a sample by which the input is late, one of the poles is at zero.

    Parameters
    ----------
    plant : Plant
        Of the kind "linear".
    theta : ndarray, shape (len(plant.parameters),)
    gains : ndarray, shape (m,)
        Of its columns; the first of the gains of a fit.
    span : int
        Samples of the fitted record.
    late : float
        Fraction of each sample at which the input changes, 0 to 1.
    """
    den = denominator_of(plant, theta, span)
    impulse = np.zeros(den.size + 1)
    still, impulse[1] = impulse.copy(), 1.0
    moved, unmoved = (plant.columns(theta, w, span, reference=0.0) for w in (impulse, still))
    response = (moved - unmoved) @ gains[: moved.shape[1]]
    return np.convolve(np.convolve(den, response[1:])[: den.size], [1.0 - late, late])
