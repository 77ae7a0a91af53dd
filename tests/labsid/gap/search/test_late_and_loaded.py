"""Plants whose input changes within a sample, and plants on which a load begins."""

import numpy as np
import pytest

from labsid._arrays import FloatArray
from labsid.gap.dynamics._kernels import delayed
from labsid.gap.dynamics.given_simulation import GivenSimulation
from labsid.gap.dynamics.plants import Plant

LATE = 0.3  # of a sample
LINEAR_KINDS = [
    Plant(),
    Plant(zero=False, lag="behind"),
    Plant(mode="behind"),
    Plant(kind="varying", drift_degree=3),
    Plant(kind="leak"),
    Plant(kind="given", simulation=GivenSimulation(lambda w, numbers: np.cumsum(w))),
]
AHEAD = [
    Plant(kind="tanks", roots=("upper",), lag="ahead"),
    Plant(kind="mechanics", friction="sharp", mode="ahead", lag="ahead"),
]
NUMBERS = {
    "log_c": np.log(0.5),
    "log_k": np.log(0.05),
    "log_a": np.log(0.3),
    "log_b": np.log(0.2),
    "zero": -3.0,
    "brim": 3.0,
    "share": 0.4,
    "friction": 0.2,
    "cubic": 0.1,
    "log_lag": 1.0,
    "log_frequency": -1.0,
    "log_damping": -2.0,
    "onset": 0.4,
}


def some_theta(plant: Plant, **changed: float) -> FloatArray:
    """Numbers at which everything in the plant is at work."""
    return np.array([(NUMBERS | changed).get(p.name, 0.0) for p in plant.parameters])


@pytest.mark.parametrize("plant", LINEAR_KINDS)
def test_a_linear_plant_is_driven_by_the_mean_over_each_sample(plant: Plant, levels: FloatArray) -> None:
    theta = some_theta(plant)
    columns = plant.columns(theta, levels, levels.size, 0.1, LATE)
    np.testing.assert_allclose(columns, plant.columns(theta, delayed(levels, 0, LATE), levels.size, 0.1), atol=1e-12)


@pytest.mark.parametrize(
    "plant",
    [
        Plant(kind="tanks", roots=("upper", "lower"), brims=("upper",)),
        Plant(kind="mechanics", cubic=True, friction="sharp"),
        Plant(kind="mechanics", cubic=True, lag="behind"),
        Plant(kind="speed", friction="sharp", lag_first=True),
        Plant(kind="speed", friction="sharp", lag_first=False),
    ],
)
def test_a_nonlinear_state_sees_the_change_within_a_sample(plant: Plant, levels: FloatArray) -> None:
    """Against ten times as fast a clock: rates of first order by 1/10, of second order by 1/100."""
    w = levels[:200]
    quick = {name: NUMBERS[name] - np.log(10.0) for name in ("log_c", "log_a", "log_b")}
    quick |= {"log_k": NUMBERS["log_k"] - np.log(100.0), "log_lag": NUMBERS["log_lag"] + np.log(10.0)}
    fine = np.concatenate([np.full(3, w[0]), np.repeat(w, 10)])[: 10 * w.size]
    expected = plant.columns(some_theta(plant, **quick), fine, fine.size)[::10, 0]
    found = plant.columns(some_theta(plant), w, w.size, None, LATE)[:, 0]
    unknowing = plant.columns(some_theta(plant), w, w.size)[:, 0]
    scale = np.std(expected)
    assert np.abs(found - expected).max() < 0.02 * scale
    assert np.abs(unknowing - expected).max() > 3.0 * np.abs(found - expected).max()


@pytest.mark.parametrize("plant", AHEAD)
def test_a_lag_ahead_of_a_nonlinear_state_receives_the_sample_mean(plant: Plant, levels: FloatArray) -> None:
    theta = some_theta(plant)
    columns = plant.columns(theta, levels, levels.size, 0.1, LATE)
    np.testing.assert_array_equal(columns, plant.columns(theta, delayed(levels, 0, LATE), levels.size, 0.1))


@pytest.mark.parametrize(
    "plant",
    [
        Plant(kind="tanks", roots=("upper", "lower"), load="inside"),
        Plant(kind="mechanics", cubic=True, load="inside"),
        Plant(kind="speed", friction="sharp", load="inside"),
    ],
)
def test_a_load_begins_at_its_onset_and_a_leak_takes_more_where_there_is_more(plant: Plant, levels: FloatArray) -> None:
    w = np.concatenate([levels[:300], np.full(300, 2.0)])
    bare = plant.modified(load="")
    without = bare.columns(some_theta(bare), w, w.size)[:, 0]
    for own in ({"load": 0.3}, {"leak": 0.2}):
        loaded = plant.columns(some_theta(plant, **own), w, w.size)[:, 0]
        np.testing.assert_array_equal(loaded[:240], without[:240])
        assert loaded[241] != without[241]
        assert loaded[-1] < without[-1] - 0.05
        # Counted by the span of the fit's record, whatever is played.
        np.testing.assert_array_equal(plant.columns(some_theta(plant, **own), w[:280], w.size)[:, 0], loaded[:280])


@pytest.mark.parametrize(
    "plant",
    [
        Plant(kind="tanks", roots=("upper",), brims=("lower",)),
        Plant(kind="tanks", roots=("lower",), flipped=True),
        Plant(kind="speed", friction="sharp"),
    ],
)
def test_a_load_ahead_of_the_first_state_equals_less_input(plant: Plant, levels: FloatArray) -> None:
    """A load from its onset on, and a wave that begins at zero."""
    k, side = np.arange(levels.size), -1.0 if plant.flipped else 1.0
    bare = some_theta(plant)
    pulls = {
        "load": (plant.modified(load="ahead"), np.clip(k + 1.0 - 0.4 * k.size, 0.0, 1.0)),
        "shake_sin": (
            plant.modified(sinusoid="ahead"),
            np.sin(2.0 * np.pi * 9.0 / k.size * (k + 0.5)),
        ),
    }
    for name, (moved, pull) in pulls.items():
        found = moved.columns(some_theta(moved, cycles=9.0, **{name: 0.3}), levels, k.size)
        expected = plant.columns(bare, levels - side * 0.3 * pull, k.size)
        assert np.std(expected - plant.columns(bare, levels, k.size)) > 0.02
        np.testing.assert_allclose(found[150:], expected[150:], atol=2e-3)  # the first level is that of the input
