"""Errors on samples that no fit has used, and their comparison part by part."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from labsid._arrays import FloatArray
from labsid.gap.dynamics.record_start import LEAST_START
from labsid.gap.record.holdout import held_out_samples
from labsid.gap.search.explanation import Explanation
from labsid.gap.verdict.held_out_errors import MAX_FACTOR, PARTS, Reduction, compare_errors, hold_out

ERRORS = st.lists(st.floats(1e-6, 1e3), min_size=PARTS, max_size=PARTS).map(np.array)
FACTORS = st.floats(1e-2, 1e2)


@given(ERRORS)
def test_equal_errors_are_no_reduction(errors: FloatArray) -> None:
    same = compare_errors(errors, errors)
    assert (same.factor, same.t) == (pytest.approx(1.0), 0.0)
    assert not same.pays


@given(ERRORS, ERRORS, FACTORS)
def test_a_comparison_does_not_depend_on_the_unit(before: FloatArray, after: FloatArray, unit: float) -> None:
    one, two = compare_errors(before, after), compare_errors(unit**2 * before, unit**2 * after)
    assert two.factor == pytest.approx(one.factor)
    assert two.t == pytest.approx(one.t, rel=1e-6, abs=1e-6)


@given(ERRORS, ERRORS, st.permutations(range(PARTS)))
def test_a_comparison_does_not_depend_on_the_order_of_the_parts(
    before: FloatArray, after: FloatArray, order: list[int]
) -> None:
    one, two = compare_errors(before, after), compare_errors(before[order], after[order])
    assert two.factor == pytest.approx(one.factor)
    assert two.t == pytest.approx(one.t, rel=1e-6, abs=1e-6)


@given(ERRORS, ERRORS)
def test_the_reverse_comparison_is_the_reciprocal(before: FloatArray, after: FloatArray) -> None:
    forth, back = compare_errors(before, after), compare_errors(after, before)
    assert forth.factor * back.factor == pytest.approx(1.0)
    assert not (forth.pays and back.pays)


@given(ERRORS, st.floats(0.01, 0.89))
def test_a_reduction_of_every_part_by_one_factor_pays(errors: FloatArray, factor: float) -> None:
    found = compare_errors(errors, factor**2 * errors)
    assert found.factor == pytest.approx(factor)
    assert found.pays
    assert not compare_errors(factor**2 * errors, errors).pays


def test_a_reduction_by_less_than_a_tenth_is_too_small_to_be_named() -> None:
    errors = np.linspace(1.0, 2.0, PARTS)
    assert not compare_errors(errors, (1.01 * MAX_FACTOR) ** 2 * errors).pays
    assert compare_errors(errors, (0.99 * MAX_FACTOR) ** 2 * errors).pays


def test_a_reduction_in_a_single_part_is_chance() -> None:
    before = np.ones(PARTS)
    before[3] = 100.0
    after = np.ones(PARTS)
    found = compare_errors(before, after)
    assert found.factor < 0.4
    assert found.t == pytest.approx(1.0, abs=1e-3)  # one of PARTS ratios differs from zero
    assert not found.pays


def test_parts_without_error_do_not_decide() -> None:
    """Where both errors are far below that of the others, their ratio does not count."""
    before, after = np.ones(PARTS), np.ones(PARTS)
    before[:6], after[:6] = 1e-14, 1e-16
    assert compare_errors(before, after).factor == pytest.approx(1.0)
    assert not compare_errors(before, after).pays


def test_a_simulation_that_diverges_loses() -> None:
    finite, diverged = np.ones(PARTS), np.full(PARTS, np.inf)
    assert compare_errors(finite, diverged) == Reduction(np.inf, -np.inf)
    assert compare_errors(diverged, finite) == Reduction(0.0, np.inf)
    assert not compare_errors(finite, diverged).pays
    assert compare_errors(diverged, finite).pays
    assert not compare_errors(diverged, diverged).pays


def test_blocks_of_the_record_are_scored_and_not_fitted(banded: Explanation) -> None:
    held_out = hold_out(banded.data, None)
    np.testing.assert_array_equal(held_out.scored, held_out_samples(banded.data.samples))
    np.testing.assert_array_equal(held_out.data.rows, ~held_out.scored)
    again = held_out.refit(banded.best)
    assert again.noise.rows < (~held_out.scored).sum()
    assert again.hypothesis == banded.best.hypothesis
    np.testing.assert_array_equal(held_out.output(again), again.output)
    e = (banded.data.y - again.output)[held_out.scored]
    assert held_out.errors(again).shape == (PARTS,)
    np.testing.assert_allclose(held_out.errors(again), [np.mean(part**2) for part in np.array_split(e, PARTS)])


def test_excluded_samples_are_neither_fitted_nor_scored(banded: Explanation) -> None:
    rows = np.arange(banded.data.samples) > 200
    held_out = hold_out(replace(banded.data, rows=rows), None)
    assert not (held_out.scored | held_out.data.rows)[:201].any()
    assert not (held_out.scored & held_out.data.rows).any()


def test_an_onset_is_not_held_out(banded: Explanation) -> None:
    held_out = hold_out(banded.data, None, 0.55)
    at = round(0.55 * banded.data.samples)
    assert not held_out.scored[at - 1 : at + 2].any()


def test_another_record_is_scored_after_its_first_samples(
    banded: Explanation, two_poles: Callable[..., FloatArray]
) -> None:
    """Nothing is refitted, and the first samples determine the initial state."""
    data = banded.data
    u = np.repeat(np.random.default_rng(9).uniform(-1.5, 1.5, 40), 8)
    y = two_poles(np.maximum(u - 0.3, 0.0) + np.minimum(u + 0.4, 0.0))
    # two_poles counts from its own first input; the model from the first one of the record of the fit.
    first = [np.maximum(x - 0.3, 0.0) + np.minimum(x + 0.4, 0.0) for x in (u[0], data.u_scale.back(data.u[0]))]
    y = y + first[0] - first[1]
    held_out = hold_out(data, (u, y))
    assert held_out.refit(banded.best) is banded.best
    assert held_out.scored.tolist() == [False] * LEAST_START + [True] * (u.size - LEAST_START)
    np.testing.assert_array_equal(held_out.data.rows, data.rows)
    np.testing.assert_allclose(data.y_scale.back(held_out.measured), y)
    assert np.sqrt(np.mean(held_out.errors(banded.best))) * data.y_scale.unit < 0.02
    assert compare_errors(held_out.errors(banded.path[0]), held_out.errors(banded.best)).pays


def test_a_diverging_output_has_infinite_errors(banded: Explanation) -> None:
    held_out = hold_out(banded.data, None)
    e = np.zeros(banded.data.samples)
    e[np.flatnonzero(held_out.scored)[0]] = 1e200
    assert np.isinf(held_out.in_parts(e)[0])
    assert not held_out.in_parts(e)[1:].any()
