"""Shared by the tests of the diagnosis: an input, an independent integrator, and small records."""

from collections.abc import Callable, Iterator
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from gap_reports import undrawn_figures
from gap_search import limits_of, searched
from scipy.integrate import solve_ivp
from scipy.signal import cont2discrete, lfilter
from signals_reports import undrawn_signal_figures

from labsid._arrays import FloatArray
from labsid.gap.record.data import scaled
from labsid.gap.search.explanation import Explanation, explain
from labsid.records.record import Record

Flow = Callable[[FloatArray, float], list[float]]
FEW = (
    "input-delay",
    "input-saturation",
    "input-dead-zone",
    "input-backlash",
    "input-rate-limit",
    "input-nonlinearity",
    "extra-lag",
    "resonance",
    "coulomb-friction",
    "slow-mode",
    "output-drift",
    "output-saturation",
    "output-nonlinearity",
    "load-step",
    "periodic-disturbance",
)
"""What the search on a small record looks for: a dead zone, its rivals, and effects unlike it."""


@pytest.fixture(scope="session")
def levels() -> FloatArray:
    """600 samples of levels between -1.5 and 1.5, each held for 8 samples."""
    return np.repeat(np.random.default_rng(3).uniform(-1.5, 1.5, 75), 8)


@pytest.fixture(scope="session")
def held() -> Callable[[FloatArray, FloatArray, Flow], FloatArray]:
    """States at the samples of state' = flow(state, w), the input held between samples; shape (N, n)."""

    def states(w: FloatArray, state: FloatArray, flow: Flow) -> FloatArray:
        found = [np.asarray(state, float)[None]]
        changes = np.flatnonzero(np.diff(w[:-1])) + 1
        for start, stop in pairwise([0, *changes, w.size - 1]):
            solved = solve_ivp(
                lambda t, x, value=w[start]: flow(x, value),
                (0, stop - start),
                found[-1][-1],
                method="DOP853",
                t_eval=np.arange(1, stop - start + 1),
                rtol=1e-8,
                atol=1e-10,
            )
            found.append(solved.y.T)
        return np.concatenate(found)

    return states


@pytest.fixture(scope="session")
def two_poles() -> Callable[..., FloatArray]:
    """Response of k / (s^2 + c s + k) from rest, the input held; the time unit is one sample."""

    def response(w: FloatArray, c: float = 0.5, k: float = 0.05) -> FloatArray:
        num, den, _ = cont2discrete(([k], [1.0, c, k]), 1.0)
        return np.asarray(lfilter(num[0], den, w - w[0]))

    return response


@pytest.fixture(scope="session")
def rig_record() -> Callable[..., Record]:
    """A record of two lags in a row at 0.5 s under levels between 1 and 4, with 1 % noise and one effect, or none."""

    def make(effect: str = "none", samples: int = 600, seed: int = 3) -> Record:
        rng = np.random.default_rng(seed)
        u = np.repeat(rng.uniform(1.0, 4.0, samples // 25 + 1), 25)[:samples]
        w = {
            "input-saturation": np.minimum(u, 3.1),
            "input-delay": np.concatenate([np.full(4, u[0]), u[:-4]]),
        }.get(effect, u)

        def lags(x: FloatArray) -> FloatArray:
            return np.asarray(lfilter([0.0, 0.01], np.poly([0.95, 0.8]), x))

        y = w[0] + lags(w - w[0])
        if effect == "load-step":
            y = y - lags(np.where(np.arange(samples) >= 0.6 * samples, 0.6, 0.0))
        if effect == "output-saturation":
            y = np.minimum(y, 3.0)
        y = y + 0.01 * np.std(y) * rng.standard_normal(samples)
        return Record(0.5 * np.arange(samples), u, y, 0.5, name=effect)

    return make


@pytest.fixture(scope="session")
def write_rig_record() -> Callable[[Path, Record], Path]:
    """Write a record as text with the header t,u,y."""

    def write(path: Path, record: Record) -> Path:
        rows = np.column_stack([record.t, record.u, record.y]).tolist()
        path.write_text("t,u,y\n" + "".join(f"{t!r},{u!r},{y!r}\n" for t, u, y in rows))
        return path

    return write


@pytest.fixture(scope="session")
def banded(levels: FloatArray, two_poles: Callable[..., FloatArray]) -> Explanation:
    """The search on a record with a dead zone from -0.4 to 0.3, 2 % noise."""
    u = levels[:480]
    y = two_poles(np.maximum(u - 0.3, 0.0) + np.minimum(u + 0.4, 0.0))
    y = y + 0.02 * y.std() * np.random.default_rng(1).standard_normal(u.size)
    with searched(*FEW):
        return explain(scaled(u, y, np.ones(u.size, bool), 1.0))


@pytest.fixture(scope="session")
def plain(levels: FloatArray, two_poles: Callable[..., FloatArray]) -> Explanation:
    """The search on a linear record with 5 % noise."""
    u = levels[:480]
    y = two_poles(u)
    y = y + 0.05 * y.std() * np.random.default_rng(2).standard_normal(u.size)
    with searched(*FEW):
        return explain(scaled(u, y, np.ones(u.size, bool), 1.0))


@pytest.fixture(scope="module")
def without_limits() -> Iterator[None]:
    """Reports without the limits of the record, for modules in which nothing depends on them."""
    with limits_of():
        yield


@pytest.fixture
def undrawn_signals(monkeypatch: pytest.MonkeyPatch) -> None:
    """Pages of several signals without the figures, for what does not depend on them."""
    monkeypatch.setattr("labsid.gap.reports.signals_page.encoded_figures", undrawn_signal_figures)


@pytest.fixture
def undrawn(monkeypatch: pytest.MonkeyPatch) -> None:
    """Pages without the figures, for what does not depend on them."""
    monkeypatch.setattr("labsid.gap.reports.html_report.encoded_figures", undrawn_figures)
