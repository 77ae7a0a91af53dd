"""A relay with hysteresis between the command and a rig: its play is named, and no limit or curve of the actuator."""

import numpy as np
import pytest
from gap_search import searched
from scipy.signal import lfilter

from labsid._arrays import FloatArray
from labsid.gap.diagnosis import Diagnosis, diagnose
from labsid.gap.effects.families import EFFECTS_BY_KEY
from labsid.gap.fits.fitting import fit_from
from labsid.gap.fits.hypothesis import Hypothesis
from labsid.gap.fits.switching import only_switches
from labsid.gap.record.data import scaled
from labsid.gap.verdict.decision import SWITCH_PROBABILITY
from labsid.records.record import Record

WIDTH = 0.4  # of the hysteresis
POLES = np.exp([-1 / 6, -1 / 20])


def switched(command: FloatArray, width: float) -> FloatArray:
    """-1 or 1: changes where the command passes half the width beyond zero."""
    state, found = -1.0, []
    for value in command:
        state = 1.0 if value > 0.5 * width else -1.0 if value < -0.5 * width else state
        found.append(state)
    return np.array(found)


def rig(width: float | None, seed: int = 1) -> Record:
    """Two poles behind a relay, or behind a limited actuator if `width` is None."""
    rng = np.random.default_rng(seed)
    u = np.repeat(rng.uniform(-1.0, 1.0, 50), 20)
    w = np.clip(u, -0.5, 0.5) if width is None else switched(u, width)
    y = lfilter([0.0, np.prod(1.0 - POLES)], np.poly(POLES), w) + 0.005 * rng.standard_normal(u.size)
    return Record(np.arange(1000.0), u, y, 1.0)


@pytest.fixture(scope="module")
def relay() -> Diagnosis:
    """The diagnosis of a rig behind a relay."""
    with searched("input-saturation", "input-backlash", "input-dead-zone"):
        return diagnose(rig(WIDTH))


def test_the_hysteresis_is_named_and_the_limit_is_not(relay: Diagnosis) -> None:
    found = {effect["name"]: effect for effect in relay.report["effects"]}
    assert set(found) == {"input-saturation", "input-backlash"}
    assert found["input-backlash"]["probability"] > 0.8
    assert found["input-backlash"]["parameters"]["width"]["value"] == pytest.approx(WIDTH, abs=0.1)
    assert found["input-saturation"]["probability"] <= SWITCH_PROBABILITY


def test_the_report_says_that_the_actuator_only_switches(relay: Diagnosis) -> None:
    said = " ".join(str(relay).split())
    assert "the actuator only switches between two values" in said
    assert "possibly the actuator" in said.lower()


@pytest.mark.parametrize(("width", "switches"), [(WIDTH, True), (None, False)])
def test_a_limit_that_the_command_often_stays_within_is_no_switch(width: float | None, switches: bool) -> None:
    record = rig(width)
    data = scaled(record.u, record.y, np.ones(1000, bool), 1.0)
    hypothesis = Hypothesis((EFFECTS_BY_KEY["input-saturation/both"],))
    limits = (-0.01, 0.01) if width else (-0.5, 0.5)
    start = np.zeros(len(hypothesis.parameters))
    start[hypothesis.slices["input-saturation/both"]] = data.u_scale.of(np.array(limits))
    start[hypothesis.slices["plant"]] = np.log([1 / 6 + 1 / 20, 1 / 120])
    fit = fit_from(data, hypothesis, start, 0)
    assert fit is not None
    assert only_switches(data, fit) == switches
