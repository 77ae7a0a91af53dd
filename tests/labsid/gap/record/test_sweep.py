"""A chirp is seen as one; other inputs are not."""

import numpy as np
import pytest
from scipy.signal import chirp, max_len_seq

from labsid.gap.record.sweep import sweeps_once

K = np.arange(2000)


@pytest.mark.parametrize("method", ["linear", "logarithmic"])
@pytest.mark.parametrize("reverse", [False, True])
@pytest.mark.parametrize("offset", [-3.0, 0.0, 100.0])
def test_a_chirp_sweeps_up_or_down_in_any_unit(method, reverse, offset):
    u = offset + 2.5 * chirp(K, 0.002, K.size, 0.1, method)
    assert sweeps_once(u[::-1] if reverse else u)


@pytest.mark.parametrize(
    "u",
    [
        np.sin(0.1 * K),
        np.repeat(np.random.default_rng(0).uniform(-1.0, 1.0, 40), 50),
        max_len_seq(11)[0][: K.size].astype(float),
        np.random.default_rng(1).standard_normal(K.size),
        K.astype(float),
        np.r_[np.zeros(1000), np.ones(1000)],
        np.r_[chirp(K[:1000], 0.002, 1000, 0.1), chirp(K[:1000], 0.002, 1000, 0.1)],
        np.sum([np.sin(2.0 * np.pi * f * K / K.size + f**2) for f in range(1, 30, 3)], axis=0),
    ],
    ids=["sine", "levels", "binary", "noise", "ramp", "step", "twice", "multisine"],
)
def test_other_inputs_do_not_sweep(u):
    assert not sweeps_once(u)
