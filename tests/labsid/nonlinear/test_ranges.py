"""Position from ranges: found where it can be, and said where it cannot."""

import numpy as np
import pytest
from scipy.optimize import least_squares as scipy_least_squares

from labsid.least_squares.gradients import numerical_jacobian
from labsid.nonlinear.ranges import BEACONS, TARGET, coding_example, locate, ranges_from, ranges_jacobian

LINE = np.array([[0.0, 0], [10, 0], [4, 0]])


def turned(points, angle=0.7, shift=(3.0, -2.0)):
    c, s = np.cos(angle), np.sin(angle)
    return np.atleast_2d(points) @ [[c, s], [-s, c]] + shift


def test_ranges_by_hand_and_their_jacobian():
    np.testing.assert_allclose(ranges_from([[0, 0], [3, 0]], [3, 4]), [5, 4])
    np.testing.assert_allclose(ranges_jacobian([[0, 0], [3, 0]], [3, 4]), [[0.6, 0.8], [0, 1]])
    np.testing.assert_allclose(
        ranges_jacobian(BEACONS, TARGET), numerical_jacobian(lambda th: ranges_from(BEACONS, th), TARGET), atol=1e-9
    )
    np.testing.assert_array_equal(ranges_jacobian([[1, 1]], [1, 1]), [[0, 0]])


@pytest.mark.parametrize("seed", range(40))
def test_exact_ranges_give_the_position_within_and_far_outside_the_beacons(seed):
    rng = np.random.default_rng(seed)
    beacons, target = rng.uniform(-10, 10, (rng.integers(3, 7), 2)), rng.uniform(-30, 30, 2)
    fix = locate(beacons, ranges_from(beacons, target))
    assert fix.status == "unique"
    np.testing.assert_allclose(fix.position, target, atol=1e-6)
    assert np.all(np.isnan(fix.mirror))


@pytest.mark.parametrize("seed", range(40))
def test_no_start_of_scipys_finds_a_better_place(seed):
    rng = np.random.default_rng(seed)
    beacons, target = rng.uniform(-10, 10, (rng.integers(3, 7), 2)), rng.uniform(-15, 15, 2)
    ranges = np.abs(ranges_from(beacons, target) + rng.choice([0.1, 1, 4]) * rng.standard_normal(len(beacons)))
    fix = locate(beacons, ranges)
    starts = rng.uniform(-20, 20, (8, 2))
    best = min(2 * scipy_least_squares(lambda th: ranges - ranges_from(beacons, th), start).cost for start in starts)
    assert fix.sse <= best * (1 + 1e-6)


@pytest.mark.parametrize("seed", [3, 4, 6, 9, 16, 20])
def test_beacons_near_a_line_want_a_start_on_either_side(seed):
    # Layouts for which leaving out the start on one side or the other ends in the worse minimum, or hides it.
    rng = np.random.default_rng(seed)
    beacons = np.column_stack([rng.uniform(-10, 10, 3), rng.uniform(-1.5, 1.5, 3)])
    target = rng.uniform(-15, 15, 2)
    ranges = np.abs(ranges_from(beacons, target) + rng.choice([0.1, 1]) * rng.standard_normal(3))
    starts = np.random.default_rng(0).uniform(-20, 20, (30, 2))
    others = [scipy_least_squares(lambda th: ranges - ranges_from(beacons, th), start, xtol=1e-12) for start in starts]
    fix = locate(beacons, ranges)
    best = min(other.cost for other in others)
    assert fix.sse <= 2 * best * (1 + 1e-6) + 1e-12
    variance = 2 * best
    rivals = [other.x for other in others if 2 * other.cost - 2 * best <= 5.99 * variance]
    apart = max(np.linalg.norm(rival - fix.position) for rival in rivals)
    assert (fix.status == "ambiguous") == (apart > 0.01)


def test_coding_example_lies_within_its_error_and_the_dilution_foretells_it():
    errors = []
    for seed in range(300):
        example = coding_example(np.random.default_rng(seed))
        fix = locate(example.beacons, example.ranges)
        assert fix.status == "unique"
        errors.append(fix.position - example.target)
    spread = np.sqrt(np.mean(np.sum(np.square(errors), axis=1)))
    assert spread == pytest.approx(0.1 * fix.dilution, rel=0.1)
    np.testing.assert_allclose(np.mean(errors, axis=0), 0, atol=0.02)


@pytest.mark.parametrize("beacons", [LINE, LINE[:2]])
def test_beacons_on_a_line_leave_a_mirror_image(beacons):
    for target in ([3, 4], [12, -1], [-8, 0.5]):
        fix = locate(turned(beacons), ranges_from(beacons, target))
        assert fix.status == "mirror"
        expected = turned([target, [target[0], -target[1]]])
        found = np.array([fix.position, fix.mirror])
        order = np.argsort([np.linalg.norm(place - expected[0]) for place in found])
        np.testing.assert_allclose(found[order], expected, atol=1e-6)
        for place in found:
            np.testing.assert_allclose(ranges_from(turned(beacons), place), ranges_from(beacons, target), atol=1e-6)


def test_a_target_on_the_line_is_its_own_mirror_image():
    fix = locate(LINE, ranges_from(LINE, [3, 0]))
    assert fix.status == "on the line"
    np.testing.assert_allclose(fix.position, [3, 0], atol=1e-6)
    assert fix.dilution == np.inf
    # So is the best place for ranges that are too short to meet: between the two circles.
    apart = locate([[0, 0], [10, 0]], [3, 4])
    assert apart.status == "on the line"
    np.testing.assert_allclose(apart.position, [4.5, 0], atol=1e-6)


def test_nearly_on_a_line_the_noise_decides_whether_the_side_can_be_told():
    beacons = np.array([[0.0, 0], [10, 0], [4, 0.1], [7, -0.1]])
    exact = ranges_from(beacons, [3, 4])
    assert locate(beacons, exact).status == "unique"
    noisy = exact + 0.3 * np.array([1, -1, 0.5, 1])
    fix = locate(beacons, noisy)
    assert fix.status == "ambiguous"
    assert fix.position[1] * fix.mirror[1] < 0
    assert np.hypot(*(fix.mirror - fix.position * [1, -1])) < 1


def test_beacons_in_one_place_leave_a_circle():
    fix = locate([[1, 2], [1, 2], [1, 2]], [3.0, 3.2, 2.8])
    assert fix.status == "undetermined"
    assert np.all(np.isnan(fix.position))
    assert fix.fit is None
    assert fix.sse == pytest.approx(0.08)


def test_the_layout_and_not_the_place_on_the_map_decides():
    example = coding_example(np.random.default_rng(3))
    fix, moved = locate(example.beacons, example.ranges), locate(turned(example.beacons), example.ranges)
    np.testing.assert_allclose(moved.position, turned(fix.position)[0], atol=1e-6)
    assert moved.dilution == pytest.approx(fix.dilution, rel=1e-6)
    thousand = locate(1000 * example.beacons, 1000 * example.ranges)
    np.testing.assert_allclose(thousand.position, 1000 * fix.position, rtol=1e-6)


def test_beacons_far_to_one_side_dilute():
    near, far = ranges_from(BEACONS, [5, 4]), ranges_from(BEACONS, [200, 4])
    assert locate(BEACONS, near).dilution < 1
    assert locate(BEACONS, far).dilution > 10


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: locate([[0, 0]], [1]), "beacons must be at least two: one range leaves a whole circle"),
        (
            lambda: locate([[0, 0], [1, 1]], [1]),
            r"beacons must have shape \(1, 2\), a row for each range; got \(2, 2\)",
        ),
        (lambda: locate([[0, 0, 0], [1, 1, 1]], [1, 2]), r"got \(2, 3\)"),
        (lambda: locate([[0, 0], [1, 1]], [1, -2]), "ranges must not be negative; got -2 from beacon 1"),
        (lambda: ranges_from([[0, 0, 0]], [1, 2]), r"shape \(m, 2\) and position two coordinates; got \(1, 3\) and 2"),
        (lambda: ranges_jacobian([[0, 0]], [1]), r"position two coordinates; got \(1, 2\) and 1"),
        (lambda: coding_example(np.random.default_rng(0), -1), "sigma must be zero or more; got -1"),
    ],
)
def test_what_does_not_fit(call, message):
    with pytest.raises(ValueError, match=message):
        call()
