"""The kinds of models that could reduce the error of a fit, on synthetic errors of each kind."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from scipy.signal import lfilter

from labsid._arrays import FloatArray
from labsid.gap.fits.fitting import Fit
from labsid.gap.fits.linear_fits import fit_baseline
from labsid.gap.record.data import Data, scaled
from labsid.gap.verdict.black_boxes import KINDS, PATHS, RemainingError, kinds_of_error, predictable_share
from labsid.gap.verdict.decision import CHANCE_BLACK_BOX

SAMPLES = 1000
Error = Callable[[FloatArray, FloatArray], FloatArray]


def rig(x: FloatArray) -> FloatArray:
    """Two poles, driven by the samples before."""
    return np.asarray(lfilter([0.0, 0.03, 0.02], np.poly([0.9, 0.7]), x))


def lag(x: FloatArray, pole: float) -> FloatArray:
    return np.asarray(lfilter([0.0, 1.0 - pole], [1.0, -pole], x))


def noise(seed: int) -> FloatArray:
    return np.random.default_rng(seed).standard_normal(SAMPLES)


def play(u: FloatArray, width: float) -> FloatArray:
    """The output of a play of the given width."""
    out, state = np.empty(u.size), 0.0
    for k, value in enumerate(u):
        state = min(max(state, value - 0.5 * width), value + 0.5 * width)
        out[k] = state
    return out


def stuck(u: FloatArray, band: float) -> FloatArray:
    """The output of a valve that follows only changes by more than a band."""
    out, at = np.empty(u.size), u[0]
    for k, value in enumerate(u):
        at = value if abs(value - at) > band else at
        out[k] = at
    return out


def data_with(error: Error, seed: int = 0) -> tuple[Data, Fit]:
    """A linear rig with an additional term of a third of its size and 2 % noise, and the linear model fitted to it."""
    u = np.repeat(np.random.default_rng(seed).uniform(-1.0, 1.0, SAMPLES // 10), 10)
    y = rig(u)
    added = error(u, y)
    y = y / y.std() + 0.3 * (added - added.mean()) / (added.std() or 1.0) + 0.02 * noise(50 + seed)
    data = scaled(u, y, np.ones(SAMPLES, bool), 1.0)
    return data, fit_baseline(data)


def kinds_with(error: Error, seed: int = 0) -> RemainingError:
    found = kinds_of_error(*data_with(error, seed))
    assert found is not None
    assert tuple(found.kinds) == KINDS
    assert sum(found.kinds.values()) == pytest.approx(1.0)
    assert min(found.kinds.values()) >= 0.0
    assert found.path in PATHS.values()
    return found


ERRORS: dict[str, tuple[str, Error]] = {
    "a static curve ahead": ("input", lambda u, y: rig(np.maximum(u, 0.2))),
    "a play ahead": ("input", lambda u, y: rig(play(u, 0.8))),
    "a sticking valve ahead": ("input", lambda u, y: rig(stuck(u, 0.37))),
    "a static curve behind": ("output", lambda u, y: y**2),
    "a clip behind": ("output", lambda u, y: np.minimum(y, 0.5 * y.std())),
    "a product of two states": ("nonlinear", lambda u, y: y * np.gradient(y)),
    "a gain that changes slowly": ("time", lambda u, y: rig(np.cos(np.linspace(0.0, 3.0, u.size)) * u)),
    "coloured noise": ("disturbance", lambda u, y: lag(noise(9), 0.9)),
    "a wave": ("disturbance", lambda u, y: np.sin(0.05 * np.arange(y.size))),
}


@pytest.mark.parametrize("seed", range(2))
@pytest.mark.parametrize("name", ERRORS)
def test_the_path_and_the_largest_kind_are_those_of_the_error(name: str, seed: int) -> None:
    kind, error = ERRORS[name]
    found = kinds_with(error, seed)
    assert found.path == PATHS[kind]
    assert max(found.kinds, key=lambda k: found.kinds[k]) == kind
    assert found.kinds[kind] > 0.5


@pytest.mark.parametrize(
    ("name", "low", "high"), [("coloured noise", 0.0, CHANCE_BLACK_BOX), ("a play ahead", 0.7, 1.0)]
)
def test_noise_cannot_be_predicted_from_past_inputs(name: str, low: float, high: float) -> None:
    assert low <= predictable_share(*data_with(ERRORS[name][1])) <= high


def test_a_slow_course_in_time_is_not_predicted(monkeypatch: pytest.MonkeyPatch) -> None:
    shares = dict(zip(KINDS, (0.05, 0.1, 0.15, 0.2, 0.4, 0.1), strict=True))
    found: list[RemainingError | None] = [RemainingError(shares, "time"), None]
    monkeypatch.setattr("labsid.gap.verdict.black_boxes.kinds_of_error", lambda data, fit: found.pop(0))
    data, fit = data_with(ERRORS["a wave"][1])
    assert predictable_share(data, fit) == pytest.approx(0.5)
    assert predictable_share(data, fit) == 0.0  # white noise


def test_a_longer_filter_is_linear_dynamics() -> None:
    """A mode that the linear model lacks; the model is not refitted, so that it cannot imitate the mode."""
    data, fit = data_with(lambda u, y: 0.0 * y)
    u = np.asarray(data.u)
    for pole in (0.6, 0.98):
        found = kinds_of_error(replace(data, y=data.y + 0.3 * lag(u, pole)), fit)
        assert found is not None
        assert found.path == "dynamics"
        assert found.kinds["linear"] > 0.8


@pytest.mark.parametrize("seed", range(3))
def test_white_noise_is_of_no_kind(seed: int) -> None:
    data, fit = data_with(lambda u, y: 0.0 * y, seed)
    found = kinds_of_error(data, fit)
    if found is not None:  # the little that a noise model of low order predicts by chance
        assert found.kinds["disturbance"] > 0.95
    assert kinds_of_error(replace(data, y=fit.output + 0.0 * data.y), fit) is None


def test_excluded_samples_do_not_count() -> None:
    data, fit = data_with(ERRORS["a static curve behind"][1])
    rows = np.arange(SAMPLES) % 100 != 0
    spoilt = np.where(rows, data.y, 1e3)
    found = kinds_of_error(replace(data, y=spoilt, rows=rows), fit)
    assert found is not None
    assert found.kinds["output"] > 0.5


def test_the_unit_of_the_output_does_not_matter() -> None:
    u = np.repeat(np.random.default_rng(0).uniform(-1.0, 1.0, SAMPLES // 10), 10)
    y = rig(u) + 0.1 * rig(u) ** 2 + 0.01 * noise(1)
    found = []
    for unit in (1.0, 1000.0):
        data = scaled(u, unit * y, np.ones(SAMPLES, bool), 1.0)
        found.append(kinds_of_error(data, fit_baseline(data)))
    assert found[0] is not None
    assert found[1] is not None
    assert found[0].kinds == pytest.approx(found[1].kinds, abs=1e-3)
