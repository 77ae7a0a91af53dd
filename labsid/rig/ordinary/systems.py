"""Linear systems in continuous time, with a sample as the unit of time, and their exact responses."""

from dataclasses import dataclass

import numpy as np
from scipy.signal import cont2discrete, lfilter

from labsid._arrays import FloatArray


@dataclass(frozen=True, slots=True)
class System:
    """A transfer function ``num(s) / den(s)``, without a pole at 0 unless it integrates.

    Attributes
    ----------
    num, den : tuple of float
        Coefficients in descending powers of s; equally many where y moves together with u.
    time : float
        Slowest time constant in samples, to which the pace of the input is drawn.
    """

    num: tuple[float, ...]
    den: tuple[float, ...]
    time: float

    @property
    def integrates(self) -> bool:
        """Whether there is a pole at 0."""
        return len(self.den) > 1 and self.den[-1] == 0.0


def discretised(system: System, between: str = "held") -> tuple[FloatArray, FloatArray]:
    """Numerator and denominator in powers of 1/z.

    Parameters
    ----------
    system : System
    between : {"held", "linear"}
        What the input does between its samples.

    Returns
    -------
    tuple of ndarray
    """
    if len(system.den) == 1:
        return np.array([system.num[0] / system.den[0]]), np.ones(1)
    num, den, _ = cont2discrete((system.num, system.den), 1.0, {"held": "zoh", "linear": "foh"}[between])
    return num.ravel(), den


def response(system: System, u: FloatArray, settled: bool = False, delay: int = 0, between: str = "held") -> FloatArray:
    """Output at the samples.

    Parameters
    ----------
    system : System
    u : ndarray, shape (N,)
    settled : bool
        Whether the rig starts in the steady state of the first input, and not in that of 0.
    delay : int
        Samples by which the input acts late.
    between : {"held", "linear"}

    Returns
    -------
    ndarray, shape (N,)
    """
    b, a = discretised(system, between)
    u_before = u[0] if settled and not system.integrates else 0.0
    acting = np.concatenate([np.full(delay, u_before), u[: u.size - delay]])
    rest = u_before * np.sum(b) / np.sum(a) if u_before else 0.0
    return np.asarray(rest + lfilter(b, a, acting - u_before))


def draw_first_order(rng: np.random.Generator, slowest: float = 45.0) -> System:
    """One lag."""
    T = _time(rng, slowest)
    return System((_gain(rng),), (T, 1.0), T)


def draw_second_order(rng: np.random.Generator, slowest: float = 45.0) -> System:
    """Two lags or an oscillation, strictly proper."""
    if rng.random() < 0.5:
        T = _time(rng, slowest)
        fast = T * rng.uniform(0.15, 0.8)
        return System((_gain(rng),), (T * fast, T + fast, 1.0), T)
    omega, damping = 1.0 / _time(rng, slowest / 3), rng.uniform(0.12, 1.1)
    return System((_gain(rng) * omega**2,), (1.0, 2 * damping * omega, omega**2), max(damping, 1 / damping) / omega)


def draw_integrating(rng: np.random.Generator) -> System:
    """An integrator, alone or behind a lag."""
    gain, T = _gain(rng) / 10.0, _time(rng, 30.0)
    return System((gain,), (1.0, 0.0), T) if rng.random() < 0.35 else System((gain,), (T, 1.0, 0.0), T)


def draw_pure_gain(rng: np.random.Generator) -> System:
    """A gain without dynamics, under inputs of any pace."""
    return System((_gain(rng),), (1.0,), _time(rng, 40.0))


def draw_lead(rng: np.random.Generator) -> System:
    """A zero slower than the pole."""
    T, gain = _time(rng, 40.0), _gain(rng)
    return System((gain * T * rng.uniform(1.5, 9.0), gain), (T, 1.0), T)


def draw_washout(rng: np.random.Generator) -> System:
    """A high-pass filter."""
    T = _time(rng, 60.0)
    return System((_gain(rng) * T, 0.0), (T, 1.0), T)


def draw_filtered_derivative(rng: np.random.Generator) -> System:
    """A proportional and derivative controller with a filter."""
    T, gain = rng.uniform(1.0, 8.0), _gain(rng)
    return System((gain * (T + rng.uniform(2.0, 30.0)), gain), (T, 1.0), T)


def draw_acceleration(rng: np.random.Generator) -> System:
    """The acceleration of a mass on a spring."""
    omega, damping = 1.0 / _time(rng, 25.0), rng.uniform(0.08, 0.9)
    return System((_gain(rng), 0.0, 0.0), (1.0, 2 * damping * omega, omega**2), 1.0 / (damping * omega))


def draw_proper_second_order(rng: np.random.Generator) -> System:
    """Two poles and two zeros."""
    poles = draw_second_order(rng)
    omega, damping = rng.uniform(0.4, 2.5) / poles.time, rng.uniform(0.1, 1.5)
    gain = _gain(rng)
    return System((gain, 2 * gain * damping * omega, gain * omega**2), poles.den, poles.time)


def _time(rng: np.random.Generator, slowest: float) -> float:
    """A time constant between 3 samples and `slowest`, uniform in its logarithm."""
    return float(np.exp(rng.uniform(np.log(3.0), np.log(slowest))))


def _gain(rng: np.random.Generator) -> float:
    return float(np.exp(rng.uniform(np.log(0.05), np.log(50.0))) * rng.choice([1.0, 1.0, 1.0, -1.0]))
