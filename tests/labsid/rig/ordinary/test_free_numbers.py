"""Simulations with wrong numbers: what the record determines, and what it does not."""

from collections.abc import Callable
from itertools import islice

import numpy as np
import pytest
from scipy.optimize import least_squares

from labsid.rig.ordinary.free_numbers import draw_free_far, draw_free_idle, draw_free_pair
from labsid.rig.ordinary.functions import FIRST_ORDER, LIMITED, PRODUCT, RATIO, SECOND_ORDER, TANK, WrittenFunction
from labsid.rig.ordinary.record_files import OrdinaryRecord

Draw = Callable[[np.random.Generator], OrdinaryRecord | None]


def drawn(draw: Draw, count: int = 5) -> list[OrdinaryRecord]:
    rngs = (np.random.default_rng([3, number]) for number in range(200))
    return list(islice((made for made in map(draw, rngs) if made is not None), count))


def table(made: OrdinaryRecord) -> np.ndarray:
    return np.loadtxt(made.files[".csv"].splitlines()[1:], delimiter=",").T


def simulate(made: OrdinaryRecord) -> Callable[..., np.ndarray]:
    module: dict[str, Callable[..., np.ndarray]] = {}
    exec(made.files[".py"], module)
    return module["simulate"]


@pytest.mark.parametrize("draw", [draw_free_far, draw_free_pair, draw_free_idle])
def test_a_fit_from_the_truth_stays_within_5_percent_and_the_nominal_values_do_not_fit(draw: Draw) -> None:
    for made in drawn(draw):
        assert made.answers == (("parameter-mismatch",),)
        assert made.numbers is not None
        t, u, y = table(made)
        run, true = simulate(made), made.numbers.determined
        start = np.array(list(true.values()))
        others = {}
        if made.numbers.combination:
            one, two = made.numbers.undetermined
            others = {one: made.numbers.value, two: 1.0}
            assert made.numbers.combination in (f"{one}*{two}", f"{one}/{two}")
        elif made.numbers.undetermined:
            others = {"limit": 10.0 * float(np.max(np.abs(u)))}

        def residual(x: np.ndarray, run=run, true=true, others=others, start=start, t=t, u=u, y=y) -> np.ndarray:
            return (y - run(t, u, **dict(zip(true, x * start, strict=True)), **others)) / np.std(y)

        found = least_squares(residual, np.ones(start.size), x_scale="jac").x
        np.testing.assert_allclose(found, 1.0, atol=0.05)
        nominal = np.sqrt(np.mean((y - run(t, u)) ** 2))
        assert nominal > 5.0 * np.std(y) * np.sqrt(np.mean(residual(found) ** 2))


def test_far_is_at_least_three_times_away() -> None:
    for made in drawn(draw_free_far):
        assert made.numbers is not None
        for name, true in made.numbers.determined.items():
            factor = abs(made.truth["nominal"][name] / true)
            assert 2.9 < max(factor, 1.0 / factor) < 41.0


def test_an_idle_limit_is_never_reached() -> None:
    for made in drawn(draw_free_idle):
        assert made.numbers is not None
        assert made.numbers.undetermined == ("limit",)
        assert made.truth["nominal"]["limit"] > 1.5 * np.max(np.abs(table(made)[1]))


@pytest.mark.parametrize(
    ("function", "numbers", "gain"),
    [
        (FIRST_ORDER, {"gain": 2.5, "tau": 0.7}, 2.5),
        (SECOND_ORDER, {"gain": -2.5, "omega": 3.0, "zeta": 0.8}, -2.5),
        (PRODUCT, {"ka": 2.0, "kb": 1.25, "tau": 0.7}, 2.5),
        (RATIO, {"force": 5.0, "stiffness": 2.0, "tau": 0.7}, 2.5),
        (LIMITED, {"gain": 5.0, "tau": 0.7, "limit": 0.5}, 2.5),
        (TANK, {"pump": 1.5, "outlet": 1.5}, 1.0),
    ],
)
def test_a_simulation_settles_at_its_gain(function: WrittenFunction, numbers: dict[str, float], gain: float) -> None:
    t = 0.1 * np.arange(400)
    assert function.run(numbers, t, np.ones(t.size))[-1] == pytest.approx(gain, rel=1e-3)
