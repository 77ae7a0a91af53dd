"""What differs from student to student, and what an ID and a secret may be."""

import hashlib
import hmac
from dataclasses import asdict, astuple
from itertools import product

import numpy as np
import pytest

from labsid.rig.lab.individual import STAND_IN, read_secret, staircase, student_plan
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


def test_a_composed_letter_is_the_same_id():
    assert student_plan("Zo\u00eb", SECRET) == student_plan("Zoe\u0308", SECRET)


@pytest.mark.parametrize("student", ["", " ", "\t\n"])
def test_an_empty_id_is_refused(student):
    with pytest.raises(ValueError, match="student must be an ID; got an empty one"):
        student_plan(student, SECRET)


@pytest.mark.parametrize("student", [" z1", "z1\n", "z1\r"])
def test_white_space_around_an_id_is_refused(student):
    with pytest.raises(ValueError, match="student must have no white space at its ends; got '"):
        student_plan(student, SECRET)


@pytest.mark.parametrize("character", ["\0", "\n", "\t", "\x7f", "\u200b", "\u202e", "\ud800", "\u2028"])
def test_control_characters_in_an_id_are_refused(character):
    with pytest.raises(ValueError, match="student must hold no control characters; got '") as error:
        student_plan(f"z1{character}2", SECRET)
    assert str(error.value).isprintable()


@pytest.mark.parametrize("secret", [b"", b"fifteen bytes.."])
def test_a_short_secret_is_refused(secret):
    with pytest.raises(ValueError, match=f"secret must have at least 16 bytes; got {len(secret)}. Make one"):
        student_plan("z1", secret)


def test_a_secret_is_read_without_the_white_space_that_editors_add(tmp_path):
    for number, content in enumerate([SECRET, SECRET + b"\n", SECRET + b"\r\n", b"  " + SECRET + b" \n"]):
        path = tmp_path / f"{number}.txt"
        path.write_bytes(content)
        assert read_secret(path) == SECRET


@pytest.mark.parametrize("content", [b"", b"\n" * 40, b"short\n"])
def test_a_secret_file_without_a_secret_is_refused(tmp_path, content):
    path = tmp_path / "course.txt"
    path.write_bytes(content)
    with pytest.raises(ValueError, match=r"the secret in course\.txt must have at least 16 bytes; got [05]"):
        read_secret(path)


def test_a_secret_file_that_is_not_there_is_an_os_error(tmp_path):
    with pytest.raises(FileNotFoundError):
        read_secret(tmp_path / "none.txt")
