"""The simulated examples of the Reading lectures: records with their true model and noise."""

from dataclasses import dataclass

import numpy as np

from labsid._arrays import FloatArray, freeze
from labsid.model_structures.input_signals import sinusoids, uniform_noise
from labsid.model_structures.prediction import free_run
from labsid.model_structures.structures import PolynomialModel


@dataclass(frozen=True, slots=True, eq=False)
class LectureRecord:
    """A simulated record with its true model and noise.

    Attributes
    ----------
    u : ndarray, shape (N,)
        Input; zero for a system without one.
    y : ndarray, shape (N,)
        Output.
    e : ndarray, shape (N,)
        White noise. e(0) and therefore y(0) are zero, as in the printed programs.
    noise_free : ndarray, shape (N,)
        Output without noise.
    model : PolynomialModel
        The system.
    sigma : float
        Standard deviation of the noise.
    """

    u: FloatArray
    y: FloatArray
    e: FloatArray
    noise_free: FloatArray
    model: PolynomialModel
    sigma: float

    def __post_init__(self) -> None:
        freeze(self, u=self.u, y=self.y, e=self.e, noise_free=self.noise_free)


@dataclass(frozen=True, slots=True, eq=False)
class ChangingRecord:
    """A simulated record of a system whose parameters change.

    Attributes
    ----------
    u, y, e : ndarray, shape (N,)
        Input, output and white noise.
    theta : ndarray, shape (N, p)
        True ``[a1, ..., b1, ...]`` at every sample.
    change : int
        First sample of the second system.
    """

    u: FloatArray
    y: FloatArray
    e: FloatArray
    theta: FloatArray
    change: int

    def __post_init__(self) -> None:
        freeze(self, u=self.u, y=self.y, e=self.e, theta=self.theta)


def system_1(rng: np.random.Generator, samples: int = 1000) -> LectureRecord:
    """Simulate System 1, ``y(t) - 0.8 y(t-1) = u(t-1) + e(t)``, with an input uniform in [-2, 2].

    Parameters
    ----------
    rng : numpy.random.Generator
    samples : int

    Returns
    -------
    LectureRecord

    Notes
    -----
    Reading lectures, L3, Example 3-1 (Fig. 6 to 8, Table 1) and Table 2 of Example 6-2.
    """
    return _simulate(rng, _model([1, -0.8], [1.0], [1.0]), uniform_noise(rng, samples))


def system_2(rng: np.random.Generator, samples: int = 1000) -> LectureRecord:
    """Simulate System 2, ``x(t) - 0.8 x(t-1) = u(t-1)``, ``y = x + e``, with an input uniform in [-2, 2].

    Parameters
    ----------
    rng : numpy.random.Generator
    samples : int

    Returns
    -------
    LectureRecord
        Its model is the ARMAX form, ``c1 = a1 = -0.8``: the output noise is white, the equation error coloured.

    Notes
    -----
    Reading lectures, L3 and Example 6-2 (Table 3, Fig. 11). Errata: the listing of Example 6-2 titled "system 1"
    generates System 2.
    """
    return _simulate(rng, _model([1, -0.8], [1.0], [1, -0.8]), uniform_noise(rng, samples))


def example_3_2(rng: np.random.Generator, samples: int = 50, level: float = 2.0) -> LectureRecord:
    """Make noisy measurements of a constant, ``y(t) = b + e(t)``.

    Parameters
    ----------
    rng : numpy.random.Generator
    samples : int
    level : float
        The constant b; the lectures give no value.

    Returns
    -------
    LectureRecord
        The input is 1, without delay; unlike in the other examples, y(0) is noisy.

    Notes
    -----
    Reading lectures, Examples 3-2 and 5-1.
    """
    e = rng.standard_normal(samples)
    u = np.ones(samples)
    return LectureRecord(u, level + e, e, level * u, _model([1.0], [level], [1.0], delay=0), 1.0)


def example_6_1(rng: np.random.Generator, samples: int = 1000) -> ChangingRecord:
    """Simulate a second-order system whose parameters change halfway.

    Parameters
    ----------
    rng : numpy.random.Generator
    samples : int

    Returns
    -------
    ChangingRecord
        ``theta = [a1, a2, b1]``: ``[-0.8, 0, 1]``, then ``[-1.1, 0.3, 2]``.

    Notes
    -----
    Reading lectures, Example 6-1 (Fig. 9 and 10): 500 samples of each system, input uniform in [-2, 2], unit noise.
    """
    u = uniform_noise(rng, samples)
    e = _noise(rng, samples)
    change = samples // 2
    theta = np.where(np.arange(samples)[:, np.newaxis] < change, [-0.8, 0.0, 1.0], [-1.1, 0.3, 2.0])
    y = np.zeros(samples)
    for t in range(1, samples):
        y_2 = y[t - 2] if t > 1 else 0.0
        y[t] = -theta[t, 0] * y[t - 1] - theta[t, 1] * y_2 + theta[t, 2] * u[t - 1] + e[t]
    return ChangingRecord(u, y, e, theta, change)


def example_7_1(rng: np.random.Generator, samples: int = 1000) -> LectureRecord:
    """Simulate ``y(t) - 0.9 y(t-1) = u(t-1) + 0.3 e(t-1) + e(t)`` with two strong sinusoids as input.

    Parameters
    ----------
    rng : numpy.random.Generator
    samples : int

    Returns
    -------
    LectureRecord

    Notes
    -----
    Reading lectures, Example 7-1 (Fig. 12 to 14): ``u = 2 sin(pi t / 50 + pi / 3) + sin(pi t / 30)``.
    """
    u = sinusoids(samples, [2.0, 1.0], [np.pi / 50, np.pi / 30], [np.pi / 3, 0.0])
    return _simulate(rng, _model([1, -0.9], [1.0], [1, 0.3]), u)


def example_7_2(rng: np.random.Generator, samples: int = 1000, a: float = -0.9, c: float = 0.3) -> LectureRecord:
    """Simulate the ARMA process ``y(t) + a y(t-1) = e(t) + c e(t-1)``.

    Parameters
    ----------
    rng : numpy.random.Generator
    samples : int
    a, c : float
        The lectures give no values; the defaults are those of Example 7-1.

    Returns
    -------
    LectureRecord
        With the true e, the columns ``y, y, e, e`` of a model one order too high are exactly dependent.

    Notes
    -----
    Reading lectures, Example 7-2.
    """
    return _simulate(rng, _model([1, a], [], [1, c]), np.zeros(samples))


def example_8_1(rng: np.random.Generator, samples: int = 1000) -> LectureRecord:
    """Simulate the system of Example 7-1 with two sinusoids weaker than the noise as input.

    Parameters
    ----------
    rng : numpy.random.Generator
    samples : int

    Returns
    -------
    LectureRecord

    Notes
    -----
    Reading lectures, Example 8-1 (Fig. 16 and 17): ``u = 0.1 sin(pi t / 50 + pi / 3) + 0.2 sin(pi t / 30)``.
    """
    u = sinusoids(samples, [0.1, 0.2], [np.pi / 50, np.pi / 30], [np.pi / 3, 0.0])
    return _simulate(rng, _model([1, -0.9], [1.0], [1, 0.3]), u)


def _model(a: list[float], b: list[float], c: list[float], delay: int = 1) -> PolynomialModel:
    return PolynomialModel(np.array(a), np.array(b), np.array(c), delay)


def _noise(rng: np.random.Generator, samples: int) -> FloatArray:
    e = rng.standard_normal(samples)
    e[:1] = 0.0
    return e


def _simulate(rng: np.random.Generator, model: PolynomialModel, u: FloatArray) -> LectureRecord:
    e = _noise(rng, u.size)
    y, noise_free = free_run(model, u, e), free_run(model, u)
    return LectureRecord(u, y, e, noise_free, model, 1.0)
