"""Start points from a growing part of the record, where a simulation loses its phase within the whole of it.

A pendulum with a slightly wrong number turns over once more than the rig, and the error over the whole record has many
minima. Over its beginning it has one; each longer part then starts near its minimum.
"""

from collections.abc import Iterable, Iterator
from dataclasses import replace

import numpy as np

from labsid._arrays import FloatArray
from labsid.gap.fits.fitting import Fit, Problem, descend, mean_square
from labsid.gap.fits.hypothesis import Hypothesis
from labsid.gap.record.data import Data

SHARES = (0.1, 0.4)  # of the record; numerics
ITERATIONS = 4  # of a fit to such a share; numerics
LOST = 0.3**2  # mean square error over the variance of the output, of a simulation that has lost its phase; set by hand


def loses_phase(data: Data, parent: Fit) -> bool:
    """Whether effects are added to a simulation that opens and whose error is as large as the motion itself."""
    plant = parent.hypothesis.plant
    return plant.simulation.port is not None and mean_square(data, parent) > LOST * float(np.var(data.y[data.rows]))


def grown_starts(data: Data, hypothesis: Hypothesis, starts: Iterable[FloatArray]) -> Iterator[FloatArray]:
    """Parameters fitted to a growing part of the record, from each start."""
    before = data.times
    parts = [replace(data, rows=data.rows & (before < share * (before.max() + 1))) for share in SHARES]
    problems = [Problem(part, hypothesis) for part in parts if part.rows.sum() > 4 * len(hypothesis.parameters)]
    for theta in starts:
        for problem in problems:
            at = problem.start(theta)
            if at is None:
                break
            theta = descend(problem, at, ITERATIONS, tolerance=1e-2).theta
        yield theta
