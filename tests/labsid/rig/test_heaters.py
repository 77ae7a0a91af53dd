"""Two heaters beside each other: their log, and what it shows of them."""

from pathlib import Path

import numpy as np
import pytest

from labsid import load_record
from labsid.lab.system_identification import identify_system
from labsid.rig.lab.heaters import DIGITS, EXCHANGE, GAINS, SAMPLES, TEMPERATURES, heater_signals, write_heater_log


@pytest.fixture
def log(tmp_path: Path) -> Path:
    path = tmp_path / "TwoHeaters.csv"
    write_heater_log(path)
    return path


def test_the_log_holds_the_signals(log: Path) -> None:
    record = load_record(log, inputs="Q1,Q2", outputs="T1,T2")
    u, y = heater_signals()
    assert np.array_equal(record.u, u)
    assert np.array_equal(record.y, y)
    assert (record.Ts, len(record)) == (8.0, SAMPLES)


def test_it_begins_at_rest_and_each_power_moves_the_other_temperature_too() -> None:
    u, y = heater_signals()
    first, second = (int(np.argmax(column != column[0])) for column in u.T)
    assert first < second
    assert np.allclose(y[:first].mean(axis=0), TEMPERATURES, atol=10.0**-DIGITS)
    assert np.all(y[second] - y[0] > 1)


def test_the_static_gains_are_found(log: Path) -> None:
    """Two heaters with losses 1 that exchange heat e: G(1) = inv([[1 + e, -e], [-e, 1 + e]]) K."""
    found = identify_system(load_record(log, inputs="Q1,Q2", outputs="T1,T2"), order=4).model
    losses = (1 + 2 * EXCHANGE) * np.eye(2) - EXCHANGE
    assert found.static_gain == pytest.approx(np.linalg.inv(losses) @ np.diag(GAINS), abs=0.06)
