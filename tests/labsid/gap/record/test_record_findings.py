"""Findings from the record alone: the lab's logs, and levels that do not repeat."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from gap_search import searched
from scipy.signal import lfilter

from labsid._arrays import FloatArray
from labsid.gap.diagnosis import diagnose
from labsid.gap.record.controllers import switches_on_output
from labsid.gap.record.record_findings import (
    PlateauGap,
    about_controller,
    clock_slip,
    filter_length,
    findings_from_errors,
    findings_from_record,
    plateau_gap,
)
from labsid.gap.reports.text_report import format_report
from labsid.records.record import Record, load_record

pytestmark = pytest.mark.usefixtures("without_limits")

MATTERS = PlateauGap(repeat=False, largest=0.1, scatter=0.05, missed=0.05, of_gap=0.9, left=1.0)


def steps(ends: list[float]) -> tuple[FloatArray, FloatArray]:
    """Two levels in turn, 60 samples each; the output is at its end at once."""
    noise = 0.01 * np.random.default_rng(0).standard_normal(60 * len(ends))
    return np.repeat(np.arange(len(ends)) % 2, 60).astype(float), np.repeat(ends, 60) + noise


def record_of(u: FloatArray, y: FloatArray, **more: FloatArray) -> Record:
    return Record(np.arange(u.size) * 0.5, u, y, 0.5, **more)


def topics(record: Record, plateau: PlateauGap | None = None) -> list[str]:
    return [finding.topic for finding in findings_from_record(record, plateau)]


@pytest.mark.parametrize("name", ["SysIdenData_StudentVersion", "SysIdenData_4", "SysIdenData_8"])
def test_the_tanks_do_not_repeat_their_levels_and_average_five_samples(shared_data: Path, name: str) -> None:
    record = load_record(shared_data / "unsw-water-tank" / f"{name}.mat")
    assert filter_length(record) == 5
    found = {finding.topic: finding.text for finding in findings_from_record(record, MATTERS)}
    assert "does not come back to the same level at the same input" in found["plateaus"]
    assert "exactly the mean of the last 5 samples" in found["noise reduction"]
    assert "not part of the gap" in found["noise reduction"]
    assert ("rest" in found) == (name != "SysIdenData_StudentVersion")  # the others start from an empty tank


def test_the_shares_of_the_gap_and_of_the_residual() -> None:
    u, y = steps([1.0, 3.0, 1.2, 3.0, 1.4, 3.2])
    counted = np.ones(u.size, bool)
    linear = 1.2 + 1.8 * u
    found = plateau_gap(u, y, linear, linear + 0.5 * (y - linear), counted)
    assert found is not None
    assert found.largest == pytest.approx(0.4, abs=0.01)
    squares = 2 * 0.2**2 + 2 * (0.2 / 3) ** 2 + (0.4 / 3) ** 2
    assert found.scatter == pytest.approx(np.sqrt(squares / 4), rel=0.02)
    assert found.missed == pytest.approx(found.scatter, rel=1e-6)  # one level for each input: it misses all of it
    assert found.of_gap == pytest.approx(found.missed / np.sqrt(np.mean((y - linear) ** 2)))
    assert found.left == pytest.approx(0.5, rel=1e-3)  # hardly less: y rests on its levels
    assert found.matters


def test_levels_that_the_simulation_follows_are_not_reported() -> None:
    u, y = steps([1.0, 3.0, 1.4, 3.0])
    followed = plateau_gap(u, y, y + 0.01 * np.sin(np.arange(u.size)), y, np.ones(u.size, bool))
    assert followed is not None
    assert not followed.repeat
    assert not followed.matters
    assert "plateaus" not in topics(record_of(u, y), followed)
    assert "plateaus" in topics(record_of(u, y), MATTERS)
    assert "plateaus" not in topics(record_of(u, y), replace(MATTERS, of_gap=0.1))


def test_an_input_that_never_rests_has_no_plateaus(rig_record: Callable[..., Record]) -> None:
    record = rig_record("none", 3000)
    assert plateau_gap(record.u, record.y, record.y, record.y, np.ones(3000, bool)) is None
    assert topics(record) == []


@searched("input-delay", "sqrt-outflow", "overflow", "output-drift")
def test_the_answer_on_the_tanks_carries_both_and_how_much_of_the_gap_they_are(shared_data: Path) -> None:
    report = diagnose(load_record(shared_data / "unsw-water-tank" / "SysIdenData_StudentVersion.mat")).report
    assert {"plateaus", "noise reduction"} <= {finding["topic"] for finding in report["record_findings"]}
    assert report["plateaus"]["repeat"] is False
    assert 0.3 < report["plateaus"]["of_gap"] < 1.2
    said = " ".join(format_report(report).split())
    assert "The output does not come back to the same level at the same input: 1.160, 1.172 at u = 1.6" in said
    assert "mean of the last 5 samples" in said


def test_a_stop_is_said_with_its_value(rig_record: Callable[..., Record]) -> None:
    record = rig_record("output-saturation")
    clipped = record_of(record.u, np.minimum(record.y, 2.9))
    (found,) = findings_from_record(clipped, None)
    assert found.topic == "clipping"
    assert "stuck at its highest value 2.9" in found.text


def test_the_filter_counts_only_where_the_output_went_through_it() -> None:
    rng = np.random.default_rng(0)
    u, raw = np.repeat(rng.uniform(0, 1, 20), 10), rng.standard_normal(200)
    mean = np.convolve(np.concatenate([np.full(3, raw[0]), raw]), np.full(4, 0.25), mode="valid")
    both = {"y_measured": raw, "y_noise_reduced": mean}
    assert filter_length(record_of(u, mean, **both)) == 4
    assert filter_length(record_of(u, raw, **both)) == 1
    assert filter_length(record_of(u, mean)) == 1
    assert "noise reduction" not in topics(record_of(u, raw, **both))


def test_an_output_that_does_not_follow_the_input_is_said_so(rig_record: Callable[..., Record]) -> None:
    record, rng = rig_record("none"), np.random.default_rng(1)
    everywhere = np.ones(len(record), bool)
    near = record.y + 0.01 * rng.standard_normal(len(record))
    assert findings_from_errors(record.u, record.y, near, near, everywhere) == []
    noise = rng.standard_normal(len(record))
    flat = 0.03 * noise
    (found,) = findings_from_errors(record.u, noise, flat, flat, everywhere)
    assert (found.level, found.topic) == ("warning", "excitation")
    assert "is 97% of the standard deviation of the output" in found.text


def test_an_input_that_answers_to_the_noise_is_a_closed_loop() -> None:
    """y(k) = 0.9 y(k-1) + 0.1 u(k-1) + e(k), the input open, or from a proportional controller."""
    rng = np.random.default_rng(0)
    set_point, e = np.repeat(rng.uniform(0.0, 1.0, 40), 20), 0.05 * rng.standard_normal(800)
    for gain in (0.0, 3.0):
        u, y, without = set_point.copy(), np.zeros(800), np.zeros(800)
        for k in range(1, 800):
            y[k] = 0.9 * y[k - 1] + 0.1 * u[k - 1] + e[k]
            without[k] = 0.9 * without[k - 1] + 0.1 * u[k - 1]
            u[k] -= gain * y[k]
        found = findings_from_errors(u, y, without, without, np.ones(800, bool))
        topics = [finding.topic for finding in (*found, *about_controller(u, y))]
        assert ("feedback" in topics) == (gain > 0.0)


@pytest.mark.parametrize("slip", [-4.0, 0.0, 0.5, 4.0])
def test_a_steadily_growing_delay_indicates_two_clocks(rig_record: Callable[..., Record], slip: float) -> None:
    record = rig_record("none", 2000)
    k, counted = np.arange(2000.0), np.ones(2000, bool)
    late = np.interp(k * (1.0 - slip / 2000.0), k, record.y)
    found = clock_slip(late, record.y, counted)
    if abs(slip) < 1.0:
        assert found is None
        return
    assert found == pytest.approx(slip, rel=0.15)
    (said,) = findings_from_errors(record.u, late, record.y, record.y, counted)
    assert said.topic == "clocks"
    assert f"{'lags' if slip > 0 else 'leads'} increasingly" in said.text


def test_a_delay_that_jumps_is_no_clock(rig_record: Callable[..., Record]) -> None:
    record = rig_record("none", 2000)
    jumped = np.concatenate([record.y[:1000], record.y[996:1996]])
    assert clock_slip(jumped, record.y, np.ones(2000, bool)) is None


def _relay(noise: float, seed: int) -> tuple[np.ndarray, np.ndarray]:
    """A relay without hysteresis on a strictly proper rig of two lags; the set point moves twice."""
    rng = np.random.default_rng(seed)
    target = np.repeat([0.3, 0.6, 0.4], 300)
    u, y, slow, fast = np.zeros(900), np.zeros(900), 0.0, 0.0
    for k in range(900):
        y[k] = slow + noise * rng.standard_normal()
        u[k] = float(y[k] < target[k])
        slow, fast = slow + 0.05 * (fast - slow), fast + 0.2 * (u[k] - fast)
    return u, y


@searched("input-saturation", "input-backlash", "input-dead-zone")
@pytest.mark.parametrize("noise", [0.001, 0.01])
def test_a_relay_is_seen_and_no_direct_term_is_claimed(noise: float) -> None:
    u, y = _relay(noise, 4)
    assert switches_on_output(u, y)
    (finding,) = about_controller(u, y)
    assert "relay" in finding.text
    report = diagnose(Record(0.1 * np.arange(900), u, y, 0.1)).report
    assert not any("direct feedthrough" in text for text in report["screen"])


@pytest.mark.parametrize("direct", [0.0, 1.0])
@pytest.mark.parametrize("held", [1, 5, 20])
@pytest.mark.parametrize("noise", [0.01, 0.2])
def test_a_rig_that_follows_a_switched_input_is_no_relay(direct: float, held: int, noise: float) -> None:
    rng = np.random.default_rng(held)
    u = np.repeat(rng.choice([0.0, 1.0], 900), held)[:900]
    y = lfilter([0.0, 0.1], [1.0, -0.9], u) + direct * u
    assert not switches_on_output(u, y + noise * np.std(y) * rng.standard_normal(900))


@searched("input-nonlinearity", "output-drift")
def test_one_straight_line_is_a_static_rig_or_a_controller() -> None:
    rng = np.random.default_rng(8)
    u = np.cumsum(rng.standard_normal(600))
    run = Record(0.1 * np.arange(600), u, -1.7 * u + 12.0, 0.1)
    (said,) = about_controller(run.u, run.y)
    assert "a static rig with a gain of -1.7, or from a controller with a gain of 0.588" in said.text
    report = diagnose(run).report
    assert (report["verdict"], report["effects"]) == ("none", [])
