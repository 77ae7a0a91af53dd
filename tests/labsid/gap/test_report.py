"""What the answer says of the raw samples: counted in words."""

from dataclasses import replace

import numpy as np
import pytest

from labsid.gap.explanation import Explanation
from labsid.gap.report import _screen_sentences
from labsid.gap.sample_faults import SampleFaults


@pytest.mark.parametrize(
    ("spikes", "said"),
    [
        (1, "1 isolated sample stands far from its neighbours; the fits leave it out."),
        (2, "2 isolated samples stand far from their neighbours; the fits leave them out."),
    ],
)
def test_what_is_left_out_is_counted_in_words(plain: Explanation, spikes: int, said: str) -> None:
    none = np.zeros(plain.data.samples, bool)
    faults = SampleFaults(none, (), np.arange(none.size) < spikes, None)
    assert _screen_sentences(replace(plain, faults=faults)) == [said]
    held = SampleFaults(np.arange(none.size) < 48, ((0, 24), (24, 48))[:spikes], none, 0.5)
    stretches = "1 stretch" if spikes == 1 else "2 stretches"
    lattice, repeats = _screen_sentences(replace(plain, faults=held))
    assert lattice.startswith("The output lies on a lattice of ")
    assert repeats == f"The output repeats its last value over {stretches}, 10 % of the record."
