"""An exported simulation whose input becomes known sample by sample, as a co-simulation needs it."""

import json
import math
from collections.abc import Callable
from pathlib import Path

import numpy as np

from labsid._arrays import FloatArray
from labsid.gap.system_file import ExportedSystem, exported_from_json, exported_with_sources

CONTENT = "labsid.json"  # in the resources of an FMU
AHEAD = 500  # samples simulated beyond the present one, with the input as it is: valid until the input changes
_SAME_TIME = 1e-6  # samples


class SampledRun:
    """A run from rest at the first inputs.

    Between two samples of the simulation its outputs stay as they are. Every change of an input simulates the run from
    its start, because an exported simulation has no state that could be kept.
    """

    def __init__(self, simulate: Callable[[FloatArray], FloatArray], Ts: float, start: float) -> None:
        """Begin a run.

        Parameters
        ----------
        simulate : callable
            Outputs, shape (N, ny), for inputs of shape (N, nu).
        Ts : float
            Sampling time of the simulation, in seconds.
        start : float
            Time of the first sample, in seconds.
        """
        self._simulate, self._Ts, self._start = simulate, Ts, start
        self._inputs: list[tuple[float, ...]] = []
        self._index = 0  # of the sample whose outputs are the present ones
        self._simulated = self._outputs = np.zeros((0, 0))

    def advance(self, end: float, *u: float) -> None:
        """Hold the inputs `u` from the present time to the time `end`, in seconds."""
        samples = (end - self._start) / self._Ts
        self._index = math.floor(samples + _SAME_TIME)
        self._inputs += [u] * (math.ceil(samples - _SAME_TIME) - len(self._inputs))

    def outputs(self, *u: float) -> list[float]:
        """The present outputs, with the inputs `u` if a sample is due at the present time."""
        known = np.array([*self._inputs, u][: self._index + 1])
        if not np.array_equal(self._simulated[: len(known)], known):
            self._simulated = np.concatenate([known, np.repeat(known[-1:], AHEAD, axis=0)])
            self._outputs = self._simulate(self._simulated)
        present: list[float] = self._outputs[self._index].tolist()
        return present

    def output(self, u: float) -> float:
        """The present output of one input and one output, as FMUs ask for it that were written before `outputs`."""
        return self.outputs(u)[0]


def open_sampled_run(resources: Path, start: float, of_record: bool = False) -> SampledRun:
    """Begin a run of the simulation in the resources of an FMU; see `SampledRun`.

    Parameters
    ----------
    resources : Path
        Folder with the exported simulation.
    start : float
        Time of the first sample, in seconds.
    of_record : bool
        Whether loads, sinusoids and drifts of the fitted record act, at their times after `start`; only with one input
        and one output.
    """
    content = json.loads((resources / CONTENT).read_text(encoding="utf-8"))
    model = exported_from_json(exported_with_sources(content, lambda source: str(resources / source)))
    if isinstance(model, ExportedSystem):
        return SampledRun(model.simulate, model.sampling_time, start)
    return SampledRun(
        lambda u: model.simulate(np.ascontiguousarray(u[:, 0]), of_record=of_record)[:, np.newaxis], model.Ts, start
    )
