"""Sentences of the report about faulty samples, and its test of the residual."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.signal import lfilter

from labsid._arrays import FloatArray
from labsid.gap.record.data import scaled
from labsid.gap.record.sample_faults import SampleFaults
from labsid.gap.reports.report import _whiteness, screen_sentences
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


def _share_called_coloured(rng: np.random.Generator, size: FloatArray, pole: float = 0.0) -> float:
    """How often the test of the residual says at 1 % that noise of this size is not white."""
    k = np.arange(size.size, dtype=float)
    data = scaled(k, k, np.ones(size.size, bool), 1.0)
    noise = (lfilter([1.0], [1.0, -pole], size * rng.standard_normal(size.size)) for _ in range(400))
    return float(np.mean([_whiteness(e, data) < 0.01 for e in noise]))


def test_white_noise_whose_size_grows_is_white() -> None:
    """The test of Ljung and Box calls a quarter of it coloured."""
    rng = np.random.default_rng(7)
    assert _share_called_coloured(rng, np.linspace(0.2, 3.0, 800)) < 0.03
    assert _share_called_coloured(rng, np.ones(800)) < 0.03
    assert _share_called_coloured(rng, np.ones(800), pole=0.25) > 0.9
