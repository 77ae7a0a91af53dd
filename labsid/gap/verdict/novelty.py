"""How far a record is from the simulated rigs on which the probabilities were measured."""

from dataclasses import dataclass

import numpy as np

from labsid.gap.dynamics.responses import real_rates
from labsid.gap.fits.direct_term import innovations
from labsid.gap.fits.fitting import Fit, mean_square
from labsid.gap.record.data import Data

RANGES: dict[
    str, tuple[float, float]
] = {  # by feature; measured: extremes of the `dev` records of `labsid.blind.calibration`
    "samples": (300.0, 5000.0),
    "changes": (6e-4, 1.0),
    "noise": (4e-3, 0.16),
    "gap": (0.0, 25.0),
    "fastest": (4e-3, 8.0),
    "direct": (0.0, 0.0),
    "unstable": (0.0, 0.0),
}
OUTSIDE = 0.89  # largest probability outside of them; set by hand


@dataclass(frozen=True, slots=True)
class Novelty:
    """Features of a record, fixed before any effect is tried.

    Attributes
    ----------
    features : dict
        By name: ``samples``; ``changes``, the share of the samples at which the input changes; ``noise``, the rms of
        what the past does not foretell of the output, over its standard deviation; ``gap``, the rms error of the
        simulation before over that; ``fastest``, the fastest rate of the linear dynamics per sample; ``direct``, 1 for
        a direct term; ``unstable``, 1 for a simulation that a feedback of the output stabilises.
    beyond : tuple of str
        Those that no rig of `RANGES` had.
    """

    features: dict[str, float]
    beyond: tuple[str, ...]

    @property
    def reference(self) -> str:
        """Whether the record is ``inside`` or ``outside`` of what the probabilities were measured on."""
        return "outside" if self.beyond else "inside"

    def capped(self, probability: float) -> float:
        """The probability that may be claimed of an effect."""
        return min(probability, OUTSIDE) if self.beyond else probability


def measure_novelty(data: Data, before: Fit) -> Novelty:
    """Compare a record with the simulated rigs.

    Parameters
    ----------
    data : Data
    before : Fit
        The fit to which effects are added.
    """
    _, new, free = innovations(data)
    noise = float(np.sqrt(new @ new / max(free, 1)))
    features = {
        "samples": float(data.longest),
        "changes": float(np.mean(np.diff(data.u) != 0.0)),
        "noise": noise,
        "gap": float(np.sqrt(mean_square(data, before))) / max(noise, np.finfo(float).tiny),
        "fastest": real_rates(*before.rates)[1],
        "direct": float(before.hypothesis.plant.feedthrough),
        "unstable": float(before.hypothesis.plant.stabilised),
    }
    beyond = [name for name, (low, high) in RANGES.items() if not low <= features[name] <= high]
    return Novelty(features, tuple(beyond))
