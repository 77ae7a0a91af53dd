"""Rigs with a withheld effect: drawn from secret and ID, detectable, and described correctly."""

from collections import Counter

import numpy as np
import pytest

from labsid.checks.assignments.sim_to_real_gap.linear_model import nearest_free_run
from labsid.lab.arx import arx_from_theta
from labsid.lab.simulation import simulate
from labsid.records.record import load_record
from labsid.rig.lab.plan import student_plan
from labsid.rig.seeds import student_entropy
from labsid.rig.switchable.withheld import (
    AT_REST,
    SENSOR_NOISE,
    TS,
    WithheldRig,
    withheld_record,
    withheld_record_bytes,
    withheld_rig,
    withheld_validation_data,
)
from labsid.rig.switchable.withheld_effects import EFFECT_PARAMETERS, EFFECT_PATHS

SECRET = b"a secret of the tests"
IDS = [f"z{5000000 + i}" for i in range(160)]


@pytest.fixture(scope="module")
def rigs() -> list[WithheldRig]:
    return [withheld_rig(student, SECRET) for student in IDS]


def of(rigs: list[WithheldRig], effect: str, count: int = 2) -> list[WithheldRig]:
    return [rig for rig in rigs if rig.effect == effect][:count]


def test_every_effect_is_about_as_frequent(rigs):
    counts = Counter(rig.effect for rig in rigs)
    assert set(counts) == set(EFFECT_PATHS)
    assert min(counts.values()) > 0.5 * len(IDS) / len(EFFECT_PATHS)


def test_the_effect_hangs_on_the_secret_and_not_on_the_id_alone(rigs):
    others = [withheld_rig(student, SECRET + b"!") for student in IDS]
    same = sum(one.effect == other.effect for one, other in zip(rigs, others, strict=True))
    assert same < 2.2 * len(IDS) / len(EFFECT_PATHS)
    again = withheld_rig(IDS[0], SECRET)
    assert (again.effect, again.parameters, again.setup) == (rigs[0].effect, rigs[0].parameters, rigs[0].setup)


def test_the_public_rig_does_not_reveal_the_withheld_effect():
    assert student_entropy("z1", SECRET, "sim-to-real-gap") != student_entropy("z1", SECRET)
    assert student_entropy("z1", SECRET) == student_plan("z1", SECRET).entropy
    with pytest.raises(ValueError, match="secret must have at least 16 bytes"):
        withheld_rig("z1", b"short")


@pytest.mark.parametrize("effect", EFFECT_PATHS)
def test_the_linear_model_leaves_at_least_five_times_the_noise(effect, rigs):
    for rig in of(rigs, effect, 4):
        record = withheld_record(rig)
        u, y, half = record.u - record.u[0], record.y - record.y[:AT_REST].mean(), len(record) // 2
        theta = nearest_free_run(u[:half], y[:half], TS)
        left = (y - simulate(arx_from_theta(theta, TS), u))[half:]
        assert np.sqrt(np.mean(left**2)) > 5 * SENSOR_NOISE


@pytest.mark.parametrize("effect", EFFECT_PATHS)
def test_record_and_trial_are_of_one_rig_from_rest(effect, rigs):
    for rig in of(rigs, effect):
        record = withheld_record(rig)
        u, y = withheld_validation_data(rig)
        assert len(record) == y.size == u.size
        assert (record.u[:AT_REST] == record.u[0]).all()
        assert u[0] == record.u[0] != record.u[AT_REST]
        assert np.std(record.y[:AT_REST]) == pytest.approx(SENSOR_NOISE, rel=0.25)
        assert record.y[:AT_REST].mean() == pytest.approx(y[0], abs=4 * SENSOR_NOISE / np.sqrt(AT_REST))
        assert not np.array_equal(u, record.u)
        assert rig.path == EFFECT_PATHS[effect]
        assert set(rig.parameters) == set(EFFECT_PARAMETERS[effect])


def test_levels_are_where_the_label_says(rigs):
    for rig in of(rigs, "output-saturation"):
        _, y = withheld_validation_data(rig)
        assert (y.min(), y.max()) == pytest.approx((rig.parameters["low"], rig.parameters["high"]))
    for rig in of(rigs, "overflow"):
        _, y = withheld_validation_data(rig)
        assert y.max() == pytest.approx(rig.parameters["level"])
    for rig in of(rigs, "input-dead-zone"):
        u, y = withheld_validation_data(rig)
        start = int(np.argmax((u < rig.parameters["low"]) | (u > rig.parameters["high"])))
        assert np.ptp(y[: start + 1]) < 1e-9
        assert np.ptp(y[: start + 20]) > 1e-3
    for rig in of(rigs, "input-delay"):
        u, y = withheld_validation_data(rig)
        answer = int(np.argmax(np.abs(y - y[0]) > 1e-9))
        assert answer - AT_REST == round(rig.parameters["delay"] / TS) + 1
    for rig in of(rigs, "sqrt-outflow"):
        _, y = withheld_validation_data(rig)
        assert rig.parameters["empty"] < y.min()


def test_the_file_contains_only_the_record(tmp_path, rigs):
    path = tmp_path / "WithheldRig.csv"
    path.write_bytes(withheld_record_bytes(IDS[0], SECRET))
    read, made = load_record(path), withheld_record(rigs[0])
    np.testing.assert_allclose(read.t, made.t)
    np.testing.assert_allclose(read.u, made.u)
    np.testing.assert_allclose(read.y, made.y)
    assert path.read_text().splitlines()[0] == "t,u,y"
    assert set(path.read_text().partition("\n")[2]) <= set("0123456789.,-\n")
