"""Every finite record ends with a report or with one line that says why not."""

import warnings
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from labsid._arrays import FloatArray
from labsid.gap.diagnosis import diagnose
from labsid.records.record import Record

SAMPLES = 160


def levels(draw: st.DrawFn, values: st.SearchStrategy[float]) -> FloatArray:
    """A piecewise constant signal of one to eight levels."""
    parts = draw(st.lists(values, min_size=1, max_size=8))
    return np.repeat(np.array(parts, float), -(-SAMPLES // len(parts)))[:SAMPLES]


@st.composite
def signals(draw: st.DrawFn) -> tuple[FloatArray, FloatArray]:
    """Input and output: levels, ramps, noise, a function of the input, or the input itself; of any unit and digits."""
    unit = 10.0 ** draw(st.integers(-8, 8))
    numbers = st.floats(-3.0, 3.0, allow_subnormal=False)
    rng = np.random.default_rng(draw(st.integers(0, 99)))
    u = {
        "levels": lambda: levels(draw, numbers),
        "ramp": lambda: np.linspace(0.0, draw(numbers), SAMPLES),
        "noise": lambda: rng.standard_normal(SAMPLES),
        "spike": lambda: np.eye(1, SAMPLES, draw(st.integers(0, SAMPLES - 1)))[0],
    }[draw(st.sampled_from(["levels", "ramp", "noise", "spike"]))]()
    y = {
        "levels": lambda: levels(draw, numbers),
        "input": lambda: draw(numbers) * u,
        "square": lambda: u**2,
        "sum": lambda: np.cumsum(u),
        "late": lambda: np.roll(u, draw(st.integers(0, 40))),
        "noise": lambda: rng.standard_normal(SAMPLES),
    }[draw(st.sampled_from(["levels", "input", "square", "sum", "late", "noise"]))]()
    digits = draw(st.sampled_from([0, 2, 6, 17]))
    y = np.array([float(f"%.{digits}g" % value) if digits else np.float32(value) for value in y])
    return u * draw(st.sampled_from([1.0, unit])), y * unit + draw(st.sampled_from([0.0, 1e3 * unit]))


def report_or_message(record: Record) -> dict[str, Any] | str:
    try:
        return diagnose(record).report
    except ValueError as refused:
        return str(refused)


@pytest.mark.slow
@settings(max_examples=3, deadline=None, suppress_health_check=list(HealthCheck))
@given(signals())
def test_a_finite_record_ends_with_a_report_or_one_line(pair: tuple[FloatArray, FloatArray]) -> None:
    u, y = pair
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        report = report_or_message(Record(np.arange(SAMPLES) * 0.1, u, y, 0.1))
    if isinstance(report, str):
        assert "\n" not in report
        return
    assert report["verdict"] in ("none", "effect", "partial", "unknown")
    assert np.isfinite(report["gap"]["before"])
