"""The pre-lab exercise: two noisy sinusoids as column vectors, cut off and stored in one matrix."""

from dataclasses import dataclass

import numpy as np

from labsid._arrays import FloatArray, freeze

NOISE_BOUND = 0.2


@dataclass(frozen=True, slots=True, eq=False)
class Sinusoids:
    """The original data of Fig. 1(a), as column vectors.

    Attributes
    ----------
    t : ndarray, shape (1001, 1)
        Time in seconds, 0 to 100 in steps of 0.1.
    y1, y2 : ndarray, shape (1001, 1)
        ``sin(0.02 pi t)`` and ``cos(0.02 pi t)``, each with uniform noise within +-0.2.
    """

    t: FloatArray
    y1: FloatArray
    y2: FloatArray

    def __post_init__(self) -> None:
        freeze(self, t=self.t, y1=self.y1, y2=self.y2)


@dataclass(frozen=True, slots=True, eq=False)
class CutOff:
    """The cut-off data of Fig. 1(b), as column vectors and as one matrix.

    Attributes
    ----------
    t_new : ndarray, shape (m, 1)
        Time in seconds, starting from zero again.
    y1_new, y2_new : ndarray, shape (m, 1)
        The remaining samples of the sinusoids.
    data_new : ndarray, shape (m, 3)
        ``[t_new y1_new y2_new]``.
    """

    t_new: FloatArray
    y1_new: FloatArray
    y2_new: FloatArray
    data_new: FloatArray

    def __post_init__(self) -> None:
        freeze(self, t_new=self.t_new, y1_new=self.y1_new, y2_new=self.y2_new, data_new=self.data_new)


def make_sinusoids(rng: np.random.Generator) -> Sinusoids:
    """Make the two noisy sinusoids with a period of 100 seconds.

    Parameters
    ----------
    rng : numpy.random.Generator
        Source of the noise.

    Returns
    -------
    Sinusoids

    Notes
    -----
    UNSW lab, pre-lab exercise, steps 1 and 2.
    """
    t = np.linspace(0, 100, 1001).reshape(-1, 1)
    y1 = np.sin(0.02 * np.pi * t) + rng.uniform(-NOISE_BOUND, NOISE_BOUND, t.shape)
    y2 = np.cos(0.02 * np.pi * t) + rng.uniform(-NOISE_BOUND, NOISE_BOUND, t.shape)
    return Sinusoids(t, y1, y2)


def cut_off(sinusoids: Sinusoids, n: int = 200) -> CutOff:
    """Drop the first samples, restart time at zero, and store the three columns in one matrix.

    Parameters
    ----------
    sinusoids : Sinusoids
    n : int
        Samples to drop.

    Returns
    -------
    CutOff

    Raises
    ------
    ValueError
        If `n` is negative or no sample remains.

    Notes
    -----
    UNSW lab, pre-lab exercise, steps 3 and 4.
    """
    samples = sinusoids.t.shape[0]
    if not 0 <= n < samples:
        raise ValueError(f"n must lie between 0 and {samples - 1}, to leave a sample; got {n}.")
    t_new = sinusoids.t[n:] - sinusoids.t[n]
    y1_new, y2_new = sinusoids.y1[n:], sinusoids.y2[n:]
    return CutOff(t_new, y1_new, y2_new, np.hstack([t_new, y1_new, y2_new]))
