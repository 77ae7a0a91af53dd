"""Simulations as a person writes them: a Python function of the times, the input and some numbers."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from labsid._arrays import FloatArray

_FIRST_ORDER = """\
import numpy as np
from scipy.signal import lfilter


def simulate(t, u, {numbers}):
    pole = np.exp(-(t[1] - t[0]) / max(tau, 1e-12))
    return lfilter([0.0, {gain} * (1.0 - pole)], [1.0, -pole], {input})
"""

_SECOND_ORDER = """\
from scipy.signal import cont2discrete, lfilter


def simulate(t, u, {numbers}):
    num, den, _ = cont2discrete(([{gain} * omega**2], [1.0, 2.0 * zeta * omega, omega**2]), t[1] - t[0])
    return lfilter(num.ravel(), den, {input})
"""

_TANK = """\
import numpy as np


def simulate(t, u, {numbers}):
    step, level, y = t[1] - t[0], 0.0, np.zeros(len(u))
    for k in range(len(u)):
        y[k] = level
        level = max(level + step * (pump * max(u[k], 0.0) - outlet * np.sqrt(level)), 0.0)
    return y
"""


@dataclass(frozen=True, slots=True)
class WrittenFunction:
    """The text of a simulation, without the values of its numbers.

    Attributes
    ----------
    template : str
    gain, input : str
        Expressions for the static gain and for the input that acts.
    """

    template: str
    gain: str = "gain"
    input: str = "u"

    def text(self, numbers: dict[str, float]) -> str:
        """The module, with `numbers` as nominal values.

        Parameters
        ----------
        numbers : dict
            In the order of the parameters.
        """
        nominal = ", ".join(f"{name}={value!r}" for name, value in numbers.items())
        return self.template.format(numbers=nominal, gain=self.gain, input=self.input)

    def run(self, numbers: dict[str, float], t: FloatArray, u: FloatArray) -> FloatArray:
        """Output of the text itself, so that record and file agree to the last digit."""
        module: dict[str, Any] = {}
        exec(self.text(numbers), module)
        return np.asarray(module["simulate"](t, u), dtype=np.float64)


FIRST_ORDER = WrittenFunction(_FIRST_ORDER)
SECOND_ORDER = WrittenFunction(_SECOND_ORDER)
LIMITED = WrittenFunction(_FIRST_ORDER, input="np.clip(u, -limit, limit)")
PRODUCT = WrittenFunction(_FIRST_ORDER, gain="ka * kb")
RATIO = WrittenFunction(_FIRST_ORDER, gain="force / stiffness")
TANK = WrittenFunction(_TANK)


def draw_numbers(rng: np.random.Generator, function: WrittenFunction, Ts: float) -> dict[str, float]:
    """Draw gain and time constants of `FIRST_ORDER` or `SECOND_ORDER`.

    Parameters
    ----------
    rng : Generator
    function : WrittenFunction
    Ts : float
        Sampling time (s).
    """
    gain = _digits(np.exp(rng.uniform(np.log(0.1), np.log(30.0))))
    time = Ts * float(np.exp(rng.uniform(np.log(4.0), np.log(30.0))))
    if function is SECOND_ORDER:
        return {"gain": gain, "omega": _digits(1.0 / time), "zeta": _digits(rng.uniform(0.15, 0.9))}
    return {"gain": gain, "tau": _digits(time)}


def _digits(value: float) -> float:
    return float(f"{value:.5g}")
