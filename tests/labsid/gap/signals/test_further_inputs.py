"""The responses to further inputs against python-control."""

import control as ct
import numpy as np

from labsid.gap.dynamics.plants import Plant
from labsid.gap.effects.further_inputs import FurtherInput, SameEntry
from labsid.gap.fits.hypothesis import Hypothesis


def test_the_columns_span_the_response_of_second_order_dynamics() -> None:
    c, k = 0.3, 0.02
    u = np.repeat(np.random.default_rng(0).uniform(-1.0, 1.0, 30), 10)
    effect = FurtherInput("u2", (c, k), signal=u)
    columns = effect.columns(np.zeros(2), u.size, u.size, Plant(), np.zeros(2))
    held = ct.c2d(ct.ss([[-c, -k], [1.0, 0.0]], [[1.0], [0.0]], [[0.0, 1.0]], 0.0), 1.0)
    exact = ct.forced_response(held, np.arange(u.size), u).outputs
    rest = exact - columns @ np.linalg.lstsq(columns, exact, rcond=None)[0]
    assert np.abs(rest).max() < 1e-9 * np.abs(exact).max()


def test_a_signal_holds_its_last_value_past_its_end() -> None:
    effect = FurtherInput("u2", signal=np.array([0.0, 1.0, 2.0]))
    longer = FurtherInput("u2", signal=np.array([0.0, 1.0, 2.0, 2.0, 2.0]))
    columns = [one.columns(np.zeros(2), 5, 5, Plant(), np.zeros(2)) for one in (effect, longer)]
    assert np.array_equal(*columns)


def test_a_lead_is_undone_by_the_lag_with_the_same_pole() -> None:
    u = np.random.default_rng(1).standard_normal(200)
    entry = SameEntry("u2", signal=u, reference=float(u[0]))
    added = entry.apply(np.zeros(200), np.array([2.0, 0.8, 0.8, 0.0]), 200)
    assert np.allclose(added, 2.0 * (u - u[0]))


def test_other_signals_take_the_place_of_those_of_the_fit() -> None:
    old = Hypothesis((FurtherInput("u2", signal=np.zeros(3)), SameEntry("u3", signal=np.zeros(3))), 2)
    new = old.with_signals({"u2": np.ones(4), "u3": np.arange(4.0)})
    assert [effect.signal.tolist() for effect in new.effects] == [[1.0] * 4, [0.0, 1.0, 2.0, 3.0]]
    assert new == old  # the same structure
