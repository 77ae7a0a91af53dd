"""Start values from the beginning of a long record, which is as informative as the whole; fits are to the whole."""

from collections.abc import Callable

import numpy as np
import pytest

from labsid._arrays import FloatArray
from labsid.gap.effects import disturbance, input
from labsid.gap.fits.fitting import Fit, rms
from labsid.gap.fits.linear_fits import fit_baseline, fit_highpass
from labsid.gap.record.data import Data, scaled
from labsid.gap.search import part
from labsid.gap.search.candidates import best_fit, trial_fits
from labsid.gap.search.part import beginning

DEAD_ZONE = ("input-dead-zone",)


@pytest.fixture(scope="module")
def long_record(two_poles: Callable[..., FloatArray]) -> Callable[[int], Data]:
    """Records of a rig with a dead zone, whose input moves less in the first samples."""

    def made(quiet: int) -> Data:
        rng = np.random.default_rng(4)
        u = np.repeat(rng.uniform(-1.0, 1.0, 500), 20)
        u[:quiet] *= 0.3
        dead = np.sign(u) * np.maximum(np.abs(u) - 0.15, 0.0)
        y = two_poles(dead)
        y = y + 0.02 * y.std() * rng.standard_normal(y.size)
        return scaled(u, y, np.ones(u.size, bool), 0.1)

    return made


def fits_of(data: Data) -> tuple[Fit, Fit]:
    base = fit_baseline(data)
    return base, fit_highpass(data, base)


def test_the_beginning_moves_as_far_as_the_whole(long_record: Callable[[int], Data]) -> None:
    for quiet, least in ((0, part.SHORTEST), (5000, 6000)):
        data = long_record(quiet)
        found = beginning(data, fit_baseline(data), DEAD_ZONE)
        assert least <= found.samples < data.samples
        assert np.ptp(found.u) > 0.95 * np.ptp(data.u)
    data = long_record(9500)
    assert beginning(data, fit_baseline(data), DEAD_ZONE) is data


def test_a_short_record_and_effects_that_belong_to_a_record_are_sought_on_all_of_it(
    long_record: Callable[[int], Data],
) -> None:
    data = long_record(0)
    base = fit_baseline(data)
    assert beginning(data, base, ("load-step",)) is data
    short = scaled(data.u[:2000], data.y[:2000], np.ones(2000, bool), 0.1)
    assert beginning(short, fit_baseline(short), DEAD_ZONE) is short


def test_fits_from_the_beginning_are_those_of_the_whole(
    long_record: Callable[[int], Data], monkeypatch: pytest.MonkeyPatch
) -> None:
    data = long_record(0)
    base, highpass = fits_of(data)
    groups = ((input.DeadZone(),), (disturbance.LoadStep(),))
    trials = [trial_fits(data, base, group, highpass) for group in groups]
    assert [few[0].problem.data.samples for few in trials] == [part.SHORTEST, data.samples]
    assert trials[0][0].score < trials[1][0].score, "scores of a part and of the whole are compared"
    found = best_fit(data, trials[0])
    monkeypatch.setattr(part, "LONG", data.samples + 1)
    whole = best_fit(data, trial_fits(data, base, groups[0], highpass))
    assert found is not None
    assert whole is not None
    assert found.output.size == data.samples
    np.testing.assert_allclose(rms(data, found), rms(data, whole), rtol=1e-5)
    np.testing.assert_allclose(found.theta, whole.theta, rtol=1e-2, atol=1e-3)
