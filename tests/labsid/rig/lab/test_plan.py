"""The individual rigs of the lab: which parameters differ between students, and within which limits."""

import hashlib
import hmac
from dataclasses import asdict, astuple
from itertools import product

import numpy as np
import pytest

from labsid.rig.lab.plan import STAND_IN, staircase, student_plan
from labsid.rig.lab.tanks import TankParameters, steady_levels

SECRET = b"a secret for the tests alone"
IDS = [f"z{5000000 + i}" for i in range(200)]


@pytest.fixture(scope="module")
def plans():
    return [student_plan(student, SECRET) for student in IDS]


def test_the_seed_is_the_hmac_of_the_id():
    by_hand = hmac.new(SECRET, b"z5000001", hashlib.sha256).hexdigest()
    assert student_plan("z5000001", SECRET).entropy == int(by_hand, 16)


def test_a_plan_depends_on_the_id_and_the_secret_only():
    plan = student_plan("z5000001", SECRET)
    assert plan == student_plan("z5000001", SECRET)
    assert plan != student_plan("z5000002", SECRET)
    assert plan != student_plan("z5000001", SECRET + b"!")
    assert plan != student_plan("Z5000001", SECRET)


def test_no_two_students_have_the_same_rig(plans):
    assert len({astuple(plan.parameters) for plan in plans}) == len(IDS)


def test_every_parameter_but_the_brims_varies(plans):
    for name, nominal in asdict(STAND_IN.parameters).items():
        values = np.array([getattr(plan.parameters, name) for plan in plans]) / nominal
        if name.endswith("height"):
            assert (values == 1).all()
        else:
            assert values.min() < 0.96 < 1.04 < values.max()
            assert np.median(values) == pytest.approx(1, abs=0.05)


def test_levels_and_hold_times_vary_within_the_lab_s_pattern(plans):
    assert len({plan.levels for plan in plans}) == 27
    assert len({plan.starts for plan in plans}) > 190
    for plan in plans:
        rest, low, high, *again = plan.levels
        assert again == [rest, low, high]
        assert 1.5 <= low < 1.75 < 1.9 < rest < 2.1 <= high <= 2.3
        assert plan.starts[0] == 0
        assert 47 <= plan.starts[1] <= 55
        assert set(np.diff(plan.starts[1:])) <= set(range(195, 206))
        assert 903 - plan.starts[-1] >= 28


def test_levels_are_whole_hundredths_of_a_volt(plans):
    for plan in plans:
        assert plan.levels == tuple(round(level, 2) for level in plan.levels)


def test_no_rig_that_could_be_drawn_empties_or_overflows(plans):
    # The extremes of every parameter at once, at the extremes of the input.
    drawn = {name: [asdict(plan.parameters)[name] for plan in plans] for name in asdict(STAND_IN.parameters)}
    corners = {name: (min(values), max(values)) for name, values in drawn.items()}
    for choice in product((0, 1), repeat=len(corners)):
        p = TankParameters(**{name: ends[i] for (name, ends), i in zip(corners.items(), choice, strict=True)})
        lowest, highest = steady_levels(p, 1.5), steady_levels(p, 2.3)
        assert lowest[0] > 2
        assert lowest[1] > 8
        assert highest[0] < 0.6 * p.upper_height
        assert highest[1] < 0.85 * p.lower_height


def test_streams_of_one_rig_are_independent():
    plan = student_plan("z5000001", SECRET)
    first, second = (np.random.PCG64(plan.seed(stream)).random_raw(4) for stream in (1, 2))
    assert (first != second).all()


def test_a_staircase_holds_its_levels():
    assert staircase((2.0, 1.6, 2.2), (0, 2, 3), 5).tolist() == [2.0, 2.0, 1.6, 2.2, 2.2]
