"""Sentences of the report about faulty samples."""

from dataclasses import replace

import numpy as np
import pytest

from labsid.gap.record.sample_faults import SampleFaults
from labsid.gap.reports.report import screen_sentences
from labsid.gap.search.explanation import Explanation


@pytest.mark.parametrize(
    ("spikes", "said"),
    [
        (1, "1 sample is an outlier; the fits exclude it."),
        (2, "2 samples are outliers; the fits exclude them."),
    ],
)
def test_excluded_samples_are_counted(plain: Explanation, spikes: int, said: str) -> None:
    assert screen_sentences(plain) == []
    none = np.zeros(plain.data.samples, bool)
    faults = SampleFaults(none, (), np.arange(none.size) < spikes, None)
    assert screen_sentences(replace(plain, faults=faults)) == [said]
    held = SampleFaults(np.arange(none.size) < 48, ((0, 24), (24, 48))[:spikes], none, 0.5)
    stretches = "1 stretch" if spikes == 1 else "2 stretches"
    lattice, repeats = screen_sentences(replace(plain, faults=held))
    assert lattice.startswith("All output values are multiples of ")
    assert repeats == f"The output repeats its last value in {stretches}, 10 % of the record."
