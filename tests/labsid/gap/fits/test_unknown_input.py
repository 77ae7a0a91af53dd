"""Gaps of a log in which the input may have moved: nothing that follows from a wrong input is called an effect."""

import numpy as np
import pytest
from gap_search import searched
from scipy.signal import lfilter

from labsid.gap.diagnosis import diagnose
from labsid.records.record import Record

pytestmark = pytest.mark.usefixtures("without_limits")

FEW = (
    "input-delay",
    "input-saturation",
    "input-dead-zone",
    "input-off",
    "parameter-drift",
    "output-drift",
    "load-step",
)
"""What a wrong input in a gap may be taken for."""

GAPS = (slice(300, 360), slice(700, 780))


def with_gaps(seed: int, dead: float = 0.0, hold: int = 20) -> Record:
    """A rig of second order; in the gaps the log has no rows, and the input is held in them."""
    rng = np.random.default_rng(seed)
    u = np.repeat(rng.uniform(-1.0, 1.0, -(-1500 // hold)), hold)[:1500]
    w = np.sign(u) * np.maximum(np.abs(u) - dead, 0.0)
    y = lfilter([0.0, 0.02, 0.018], np.poly([0.93, 0.8]), w)
    y = y + 0.01 * np.std(y) * rng.standard_normal(u.size)
    for gap in GAPS:
        y[gap] = np.nan
        u[gap] = u[gap.start - 1]
    return Record(0.1 * np.arange(u.size), u, y, 0.1)


@pytest.mark.parametrize("seed", [1, 2, 3])
@searched(*FEW)
def test_a_gap_is_no_command_that_is_not_applied(seed: int) -> None:
    report = diagnose(with_gaps(seed)).report
    assert (report["verdict"], report["effects"]) == ("none", [])
    (said,) = [one for one in report["screen"] if one.startswith("After")]
    assert "neither fitted nor scored" in said


@searched(*FEW)
def test_an_effect_is_found_beside_gaps() -> None:
    (cause,) = diagnose(with_gaps(4, dead=0.2)).report["effects"]
    assert cause["name"] == "input-dead-zone"
    assert cause["parameters"]["high"]["value"] == pytest.approx(0.2, abs=0.02)


@searched("input-off")
def test_nothing_is_left_out_where_the_input_rests_over_a_gap() -> None:
    rested = with_gaps(5, hold=400)  # the next change is 20 samples or more after a gap
    assert not [one for one in diagnose(rested).report["screen"] if one.startswith("After")]
