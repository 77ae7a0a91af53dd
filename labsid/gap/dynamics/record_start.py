"""The first samples of another record of the rig: they determine its initial state, and are not scored."""

from dataclasses import dataclass

import numpy as np

from labsid.gap.dynamics.responses import decay_rates, free_responses

LEAST_START = 50  # samples at the start of a record that are not scored; definition
TIME_CONSTANTS = 2.0  # slowest ones, after which a wrong initial state has decayed to 14 %; definition
MOST_SHARE = 0.25  # of the record, at most, that is not scored; definition
MAX_EXTRA = 0.1  # mean square error by the error of the state over that of the noise: 5 % of the rms error; set by hand
NEGLIGIBLE = 1e-9  # singular value over the largest one, below which a state has no influence; numerics


@dataclass(frozen=True, slots=True)
class RecordStart:
    """How many samples determine the initial state of a record, from the slowest fitted time constant.

    Attributes
    ----------
    rates : tuple of float or None
        c and k of the two slowest poles, s^2 + c s + k, in samples; None if they are unknown, as in files of earlier
        versions: 50 samples then, whatever the length.
    every : float
        Samples from one reading of the sensor to the next.
    """

    rates: tuple[float, float] | None = None
    every: float = 1.0

    def samples(self, length: int) -> int:
        """Two of the slowest time constants, at most a quarter of a record of `length` samples, at least 50 samples."""
        if self.rates is None:
            return LEAST_START
        settled = min(TIME_CONSTANTS / decay_rates(*self.rates)[0], MOST_SHARE * length)
        return max(int(np.ceil(settled)), LEAST_START)

    def is_refitted(self, length: int) -> bool:
        """Whether these samples say too little about the state: it is then estimated from the whole record.

        With white noise of variance 1, and the free responses F1 of the first samples, F2 of the others, an estimate
        from the first samples adds F2 (F1' F1)^-1 F2' to the variance of the error.
        """
        count = self.samples(length)
        if self.rates is None or length <= count:
            return False
        F = free_responses(length, *self.rates)
        _, sizes, V = np.linalg.svd(F[:count], full_matrices=False)
        known = sizes > NEGLIGIBLE * sizes[0]
        extra = (F[count:] @ V[known].T / sizes[known]) ** 2
        return bool(self.every * extra.sum(axis=1).mean() > MAX_EXTRA)

    def used(self, length: int) -> int:
        """How many samples the state is estimated from: the first ones, or all."""
        return length if self.is_refitted(length) else min(self.samples(length), length)
