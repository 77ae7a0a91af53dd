"""UNSW lab, appendix, Fig. A2: comparison of a second-order system with its first-order approximation."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from labsid._arrays import FloatArray, as_signal, freeze
from labsid.lab.step_response import StepResponseFit, first_order_response, fit_step_response


@dataclass(frozen=True, slots=True, eq=False)
class SecondOrderPlant:
    """``G(s) = K / ((tau1 s + 1) (tau2 s + 1))`` with two different time constants.

    Attributes
    ----------
    K : float
        Gain.
    tau1, tau2 : float
        Time constants in seconds.
    """

    K: float
    tau1: float
    tau2: float

    @property
    def num(self) -> FloatArray:
        """Numerator in descending powers of s."""
        return np.array([self.K])

    @property
    def den(self) -> FloatArray:
        """Denominator in descending powers of s."""
        return np.array([self.tau1 * self.tau2, self.tau1 + self.tau2, 1.0])


@dataclass(frozen=True, slots=True, eq=False)
class StepComparison:
    """Comparison of a system with its first-order approximation (Fig. A2).

    Attributes
    ----------
    plant : SecondOrderPlant
    fit : StepResponseFit
    t : ndarray, shape (N,)
        Time since the step, in seconds.
    y_original, y_approximate : ndarray, shape (N,)
        Step responses of the plant and of ``fit.model``.
    mse : float
        Mean squared difference.
    largest_error : float
        Largest absolute difference, as a share of the final level.
    """

    plant: SecondOrderPlant
    fit: StepResponseFit
    t: FloatArray
    y_original: FloatArray
    y_approximate: FloatArray
    mse: float
    largest_error: float

    def __post_init__(self) -> None:
        freeze(self, t=self.t, y_original=self.y_original, y_approximate=self.y_approximate)


def second_order_example() -> SecondOrderPlant:
    """Return the plant of Fig. A2(a). Its coefficients are an assumption; the lab does not print them.

    Returns
    -------
    SecondOrderPlant
        ``G(s) = 3 / ((5 s + 1) (s + 1)) = 3 / (5 s^2 + 6 s + 1)``.

    Notes
    -----
    UNSW lab, appendix. One time constant is five times the other, so that the faster lag resembles a delay
    and the first-order approximation is as close as the lab states.
    """
    return SecondOrderPlant(K=3.0, tau1=5.0, tau2=1.0)


def second_order_response(plant: SecondOrderPlant, t: ArrayLike, amplitude: float) -> FloatArray:
    """Evaluate the step response of the second-order plant in closed form.

    Parameters
    ----------
    plant : SecondOrderPlant
    t : array_like, shape (N,)
        Time since the step, in seconds.
    amplitude : float
        Size of the step.

    Returns
    -------
    y : ndarray, shape (N,)
        Zero until t = 0.

    Notes
    -----
    ``K amplitude (1 - (tau1 e^(-t/tau1) - tau2 e^(-t/tau2)) / (tau1 - tau2))``.
    """
    t = np.maximum(as_signal("t", t), 0.0)
    decay = plant.tau1 * np.exp(-t / plant.tau1) - plant.tau2 * np.exp(-t / plant.tau2)
    response: FloatArray = plant.K * amplitude * (1 - decay / (plant.tau1 - plant.tau2))
    return response


def compare_with_approximation(plant: SecondOrderPlant, t: ArrayLike, amplitude: float) -> StepComparison:
    """Approximate the plant from its step response and compare the two responses.

    Parameters
    ----------
    plant : SecondOrderPlant
    t : array_like, shape (N,)
        Time since the step, in seconds, from zero.
    amplitude : float
        Size of the step; 2 in the lab.

    Returns
    -------
    StepComparison

    Raises
    ------
    ValueError
        As `fit_step_response`.

    Notes
    -----
    UNSW lab, appendix, Fig. A2(b).
    """
    t = as_signal("t", t)
    y_original = second_order_response(plant, t, amplitude)
    fit = fit_step_response(t, y_original, amplitude)
    y_approximate = first_order_response(fit.model, t, amplitude)
    error = y_original - y_approximate
    return StepComparison(
        plant=plant,
        fit=fit,
        t=t,
        y_original=y_original,
        y_approximate=y_approximate,
        mse=float(np.mean(error**2)),
        largest_error=float(np.max(np.abs(error)) / abs(plant.K * amplitude)),
    )
