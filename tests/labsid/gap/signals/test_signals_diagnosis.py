"""Records of two inputs and two outputs: effect and signal are named, and what cannot be used is refused by name."""

import json
from dataclasses import replace

import numpy as np
import pytest
from gap_search import searched
from two_by_two import dead_zone_at_second, two_by_two

from labsid.gap.diagnosis import diagnose
from labsid.gap.signals.result import SignalsDiagnosis
from labsid.records.record import Record

pytestmark = pytest.mark.usefixtures("without_limits")

FEW = ("input-saturation", "input-dead-zone", "output-saturation", "output-nonlinearity", "load-step")


@pytest.fixture(scope="module")
def dead_zone() -> SignalsDiagnosis:
    with searched(*FEW):
        found = diagnose(two_by_two(at_inputs=dead_zone_at_second))
    assert isinstance(found, SignalsDiagnosis)
    return found


def test_an_effect_at_an_input_is_named_once_with_its_signal_and_the_outputs_that_it_changes(
    dead_zone: SignalsDiagnosis,
) -> None:
    (effect,) = dead_zone.report["effects"]
    assert (effect["name"], effect["signal"]) == ("input-dead-zone", "u2")
    assert set(effect["outputs"]) == {"y1", "y2"}
    assert effect["probability"] > 0.9
    assert effect["parameters"]["high"]["value"] == pytest.approx(0.25, abs=0.01)
    assert effect["parameters"]["high"]["unit"] == "%"  # of the second input


def test_the_gap_is_given_by_output_and_closes(dead_zone: SignalsDiagnosis) -> None:
    gap = dead_zone.report["gap"]
    assert gap["mode"] == "free"
    assert set(gap["outputs"]) == {"y1", "y2"}
    for one in gap["outputs"].values():
        assert one["after"] < 1.1 * one["noise_floor"]
        assert one["before"] > 2.0 * one["noise_floor"]
    assert gap["closed"] > 0.9
    assert gap["before"] > 2.0
    assert gap["noise_floor"] == 1.0  # in units of each output's noise
    assert sum(dead_zone.report["where"]["outputs"].values()) == pytest.approx(1.0)


def test_the_report_is_json_and_its_text_names_the_signal(dead_zone: SignalsDiagnosis) -> None:
    assert json.loads(json.dumps(dead_zone.report))["schema"] == "labsid.gap/4"
    text = str(dead_zone)
    assert text.startswith("At u2: the actuator does not move between")
    assert max(map(len, text.splitlines())) <= 96
    assert repr(dead_zone).startswith("<SignalsDiagnosis: effect: input-dead-zone at u2")


@searched(*FEW)
def test_a_plain_rig_has_no_gap() -> None:
    found = diagnose(two_by_two(1))
    assert found.verdict == "none"
    assert not found.report["effects"]
    moved = {(one["from"], one["to"]) for one in found.report["couplings"]}
    assert moved == {(u, y) for u in ("u1", "u2") for y in ("y1", "y2")}


@searched(*FEW)
def test_a_limit_of_one_sensor_is_at_that_output_alone() -> None:
    def clipped(y: np.ndarray) -> np.ndarray:
        y[:, 1] = np.clip(y[:, 1], -0.4, 0.45)
        return y

    (effect,) = diagnose(two_by_two(at_outputs=clipped)).report["effects"]
    assert (effect["name"], effect["signal"], effect["outputs"]) == ("output-saturation", "y2", ["y2"])


@searched(*FEW)
def test_a_second_record_is_scored_with_its_own_inputs() -> None:
    record = two_by_two(at_inputs=dead_zone_at_second)
    other = two_by_two(7, at_inputs=dead_zone_at_second)
    found = diagnose(record, holdout=other)
    assert [(one["name"], one["signal"]) for one in found.report["effects"]] == [("input-dead-zone", "u2")]
    for one in found.report["gap"]["outputs"].values():
        assert one["after"] < 1.3 * one["noise_floor"] < one["before"]


@searched(*FEW)
def test_an_output_that_never_moves_is_left_out_and_named_and_so_is_what_was_done_in_reading() -> None:
    record = replace(two_by_two(1), notes=("one row was dropped",))
    still = replace(record, y=np.column_stack([record.y[:, 0], np.full(len(record), 3.0)]))
    found = diagnose(still)
    assert list(found.report["gap"]["outputs"]) == ["y1"]
    assert any("y2" in finding["text"] for finding in found.report["findings"])
    assert "one row was dropped." in [finding["text"] for finding in found.report["findings"]]


def _changed(**columns: np.ndarray) -> Record:
    record = two_by_two(1)
    u, y = record.u.copy(), record.y.copy()
    for name, values in columns.items():
        (u if name[0] == "u" else y)[:, int(name[1]) - 1] = values
    return replace(record, u=u, y=y)


@pytest.mark.parametrize(
    ("record", "named"),
    [
        pytest.param(lambda: _changed(u2=np.full(700, 2.0)), "u2 of the record never moves", id="constant input"),
        pytest.param(lambda: _changed(u2=3.0 * two_by_two(1).u[:, 0] + 1.0), "u1 and u2", id="in proportion"),
        pytest.param(lambda: _changed(y1=two_by_two(1).u[:, 1]), "the output y1 holds the values of", id="an input"),
        pytest.param(
            lambda: _changed(y2=np.round(5.0 - 2.0 * two_by_two(1).y[:, 0], 5)),
            "the outputs y1 and y2 move in proportion",
            id="one output twice",
        ),
        pytest.param(lambda: two_by_two(1, 90), "90 samples", id="too short"),
    ],
)
def test_signals_that_cannot_be_used_are_named(record: object, named: str) -> None:
    with pytest.raises(ValueError, match=named):
        diagnose(record())  # type: ignore[operator]


def test_a_holdout_without_one_of_the_signals_is_refused_by_name() -> None:
    record = two_by_two(1)
    with pytest.raises(ValueError, match="no signal u2"):
        diagnose(record, holdout=replace(record, inputs=("u1", "valve")))


def test_what_is_not_there_for_several_signals_is_said_in_one_line() -> None:
    record = two_by_two(1)
    with pytest.raises(ValueError, match="2 records of several signals"):
        diagnose([record, record])
    with pytest.raises(ValueError, match="needs a simulation of all of them"):
        diagnose(record, {"num": [1.0], "den": [1.0, -0.5], "dt": record.Ts})
