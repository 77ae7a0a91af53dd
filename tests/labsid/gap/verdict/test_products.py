"""A bilinear rig is none of the effects: smooth laws that imitate it are not claimed, and true ones are."""

from collections.abc import Callable

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from labsid._arrays import FloatArray
from labsid.gap.diagnosis import Diagnosis, diagnose
from labsid.gap.reports.text_report import format_report
from labsid.records.record import Record

pytestmark = pytest.mark.usefixtures("without_limits")


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


def test_a_flow_that_multiplies_a_temperature_is_no_pair_of_curves() -> None:
    """A heat exchanger: T' = (0.5 u (T_in - T) - 0.2 T) / 10."""
    report = diagnosed(lambda t, x, u: [((3.0 - x[0]) * u * 0.5 - 0.2 * x[0]) / 10.0], [1.5]).report
    assert (report["verdict"], report["product"]) == ("partial", True)
    assert all(effect["probability"] <= 0.4 for effect in report["effects"])
    text = " ".join(format_report(report).split())
    assert "The cause is not known" in text
    assert "A gain that changes with the output, a product of input and output, explains the record" in text
    assert "equal small steps about several levels of the output" in text


@pytest.mark.parametrize(
    ("name", "flow"),
    [
        ("sqrt-outflow", lambda t, x, u: [0.1 * (u - 1.5 * np.sqrt(max(x[0], 0.0)))]),
        ("cubic-stiffness", lambda t, x, u: [x[1], 0.05 * (u - 1.7 - x[0] - 0.5 * x[0] ** 3) - 0.3 * x[1]]),
    ],
)
def test_a_true_law_is_no_product(name: str, flow: Callable[[float, FloatArray, float], list[float]]) -> None:
    report = diagnosed(flow, [1.0] if name == "sqrt-outflow" else [0.0, 0.0]).report
    (effect,) = report["effects"]
    assert (report["verdict"], report["product"], effect["name"]) == ("effect", False, name)
    assert effect["probability"] > 0.8
