"""A bilinear rig, or one whose gain oscillates, is none of the effects: what imitates it is not claimed."""

from collections.abc import Callable

import numpy as np
import pytest
from gap_search import searched
from scipy.integrate import solve_ivp
from scipy.signal import lfilter

from labsid._arrays import FloatArray
from labsid.gap.diagnosis import Diagnosis, diagnose
from labsid.gap.reports.text_report import format_report
from labsid.records.record import Record

pytestmark = pytest.mark.usefixtures("without_limits")

CURVES = ("input-nonlinearity", "input-saturation", "output-nonlinearity", "output-saturation", "extra-lag")
"""What a product of input and output may be taken for."""


def record_of(flow: Callable[[float, FloatArray, float], list[float]], start: list[float]) -> Record:
    """The first state, by scipy, of x' = flow(t, x, u) with levels of u from 0.4 to 3 that are held; noise of 1 %."""
    rng = np.random.default_rng(6)
    u = np.repeat(rng.uniform(0.4, 3.0, 24), rng.integers(20, 70, 24))[:800]
    x, y = np.array(start), []
    for value in u:
        y.append(x[0])
        x = solve_ivp(flow, (0.0, 1.0), x, args=(value,), rtol=1e-8, atol=1e-10).y[:, -1]
    noisy = np.array(y) + 0.01 * np.std(y) * rng.standard_normal(u.size)
    return Record(np.arange(u.size, dtype=float), u, noisy, 1.0)


def diagnosed(flow: Callable[[float, FloatArray, float], list[float]], start: list[float]) -> Diagnosis:
    """The diagnosis of such a record."""
    found = diagnose(record_of(flow, start))
    assert isinstance(found, Diagnosis)
    return found


@searched(*CURVES)
def test_a_flow_that_multiplies_a_temperature_is_no_pair_of_curves() -> None:
    """A heat exchanger: T' = (0.5 u (T_in - T) - 0.2 T) / 10."""
    report = diagnosed(lambda t, x, u: [((3.0 - x[0]) * u * 0.5 - 0.2 * x[0]) / 10.0], [1.5]).report
    assert (report["verdict"], report["product"]) == ("partial", "output")
    assert all(effect["probability"] <= 0.4 for effect in report["effects"])
    text = " ".join(format_report(report).split())
    assert "The cause is not known" in text
    assert "A gain that changes with the output, a product of input and output, explains the record" in text
    assert "equal small steps about several levels of the output" in text


@pytest.mark.parametrize("multiplied", [True, False])
@searched("periodic-disturbance", "load-step", "parameter-drift", *CURVES)
def test_a_gain_that_oscillates_is_no_periodic_disturbance(multiplied: bool) -> None:
    """The input has two levels, on which the oscillation of the gain has two sizes."""
    rng = np.random.default_rng(3)
    u = np.repeat(np.where(rng.integers(0, 2, 100) > 0, 3.0, 1.0), 12)
    wave = 0.3 * np.sin(2.0 * np.pi * np.arange(u.size) / 130.0)
    drive = u * (1.0 + wave) if multiplied else u + 2.0 * wave
    y = lfilter([0.0, 0.2], [1.0, -0.8], drive - 1.0)
    y += 0.02 * y.std() * rng.standard_normal(u.size)
    found = diagnose(Record(0.01 * np.arange(u.size), u, y, 0.01))
    assert isinstance(found, Diagnosis)
    report = found.report
    probability = {effect["name"]: effect["probability"] for effect in report["effects"]}
    if multiplied:
        assert (report["verdict"], report["product"]) == ("partial", "wave")
        assert max(probability.values()) <= 0.4
        assert "does the oscillation grow with the command?" in " ".join(format_report(report).split())
    else:
        assert (report["verdict"], report["product"]) == ("effect", "")
        assert list(probability) == ["periodic-disturbance"]


@pytest.mark.parametrize(
    ("name", "flow"),
    [
        ("sqrt-outflow", lambda t, x, u: [0.1 * (u - 1.5 * np.sqrt(max(x[0], 0.0)))]),
        ("cubic-stiffness", lambda t, x, u: [x[1], 0.05 * (u - 1.7 - x[0] - 0.5 * x[0] ** 3) - 0.3 * x[1]]),
    ],
)
def test_a_true_law_is_no_product(name: str, flow: Callable[[float, FloatArray, float], list[float]]) -> None:
    with searched(name, *CURVES):
        report = diagnosed(flow, [1.0] if name == "sqrt-outflow" else [0.0, 0.0]).report
    (effect,) = report["effects"]
    assert (report["verdict"], report["product"], effect["name"]) == ("effect", "", name)
    assert effect["probability"] > 0.8
