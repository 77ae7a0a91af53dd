"""An exported simulation whose input becomes known sample by sample, as a co-simulation needs it."""

import json
import math
from pathlib import Path

import numpy as np

from labsid.gap.model_file import ExportedModel, from_json_dict, in_folder

CONTENT = "labsid.json"  # in the resources of an FMU
AHEAD = 500  # samples simulated beyond the present one, with the input as it is: valid until the input changes
_SAME_TIME = 1e-6  # samples


class SampledRun:
    """A run from rest at the first input.

    Between two samples of the model its output stays as it is. Every change of the input simulates the run from its
    start, because an exported simulation has no state that could be kept.
    """

    def __init__(self, model: ExportedModel, start: float, of_record: bool = False) -> None:
        """Begin a run.

        Parameters
        ----------
        model : ExportedModel
        start : float
            Time of the first sample, in seconds.
        of_record : bool
            Whether loads, sinusoids and drifts of the fitted record act, at their times after `start`.
        """
        self._model, self._start, self._of_record = model, start, of_record
        self._inputs: list[float] = []
        self._index = 0  # of the sample whose output is the present one
        self._simulated = self._outputs = np.zeros(0)

    def advance(self, end: float, u: float) -> None:
        """Hold the input `u` from the present time to the time `end`, in seconds."""
        samples = (end - self._start) / self._model.Ts
        self._index = math.floor(samples + _SAME_TIME)
        self._inputs += [u] * (math.ceil(samples - _SAME_TIME) - len(self._inputs))

    def output(self, u: float) -> float:
        """The present output, with the input `u` if a sample is due at the present time."""
        known = np.array([*self._inputs, u][: self._index + 1])
        if not np.array_equal(self._simulated[: known.size], known):
            self._simulated = np.concatenate([known, np.full(AHEAD, known[-1])])
            self._outputs = self._model.simulate(self._simulated, of_record=self._of_record)
        return float(self._outputs[self._index])


def open_sampled_run(resources: Path, start: float, of_record: bool) -> SampledRun:
    """Begin a run of the simulation in the resources of an FMU; see `SampledRun`."""
    content = json.loads((resources / CONTENT).read_text(encoding="utf-8"))
    return SampledRun(from_json_dict(in_folder(content, resources)), start, of_record)
