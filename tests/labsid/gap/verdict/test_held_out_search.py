"""Effects are kept if they reduce the error on samples that no fit has used."""

from dataclasses import replace

import numpy as np
import pytest

from labsid._arrays import FloatArray
from labsid.gap.effects.families import names_where
from labsid.gap.search.explanation import Explanation
from labsid.gap.verdict.held_out_errors import HeldOut, compare_errors, hold_out
from labsid.gap.verdict.held_out_search import HeldOutSearch, search_held_out


def searched(explained: Explanation) -> tuple[HeldOutSearch, HeldOut, FloatArray]:
    """The search, its samples, and the errors of the linear model there."""
    held_out = hold_out(explained.data, None)
    start = held_out.refit(explained.path[0])
    before = held_out.errors(start)
    return search_held_out(held_out, explained, start, before), held_out, before


@pytest.fixture(scope="module")
def found(banded: Explanation) -> tuple[HeldOutSearch, HeldOut, FloatArray]:
    return searched(banded)


def test_only_the_effect_that_pays_is_kept(found: tuple[HeldOutSearch, HeldOut, FloatArray]) -> None:
    search, held_out, before = found
    (step,) = search.steps
    assert step.name == "input-dead-zone"
    assert step.fit.hypothesis.names == ("input-dead-zone",)
    assert step.fit.noise.rows < held_out.data.rows.sum()  # fitted without the held-out samples
    np.testing.assert_allclose(step.errors, held_out.errors(step.fit))
    assert step.alone is not None
    assert step.alone == compare_errors(before, step.errors)
    assert step.alone.pays
    assert step.alone.factor < 0.2


def test_all_combinations_tried_are_reported(
    banded: Explanation, found: tuple[HeldOutSearch, HeldOut, FloatArray]
) -> None:
    search = found[0]
    assert search.tried[("input-dead-zone",)] == pytest.approx(np.mean(search.steps[0].errors))
    assert set(banded.levels[1]) <= set(search.tried)
    assert any(len(names) == 2 for names in search.tried)  # a second effect was tried, and did not pay
    assert () not in search.tried
    assert all(names == tuple(sorted(names)) for names in search.tried)


def test_rivals_are_single_effects_in_its_place_best_first(found: tuple[HeldOutSearch, HeldOut, FloatArray]) -> None:
    search = found[0]
    rivals = search.steps[0].rivals
    assert {name for name, _ in rivals} == {names[0] for names in search.tried if len(names) == 1} - {"input-dead-zone"}
    ratios = [ratio for _, ratio in rivals]
    assert ratios == sorted(ratios)
    own = search.tried["input-dead-zone",]
    for name, ratio in rivals:
        assert ratio == pytest.approx(np.sqrt(search.tried[name,] / own))


def test_noise_alone_keeps_nothing(plain: Explanation) -> None:
    search, _, before = searched(plain)
    assert search.steps == ()
    # A smaller error is possible by chance, but never one that pays.
    assert min(search.tried.values()) > 0.8 * np.mean(before)


def test_beside_a_simulation_that_is_better_nothing_pays(banded: Explanation) -> None:
    held_out = hold_out(banded.data, None)
    start = held_out.refit(banded.path[0])
    best = held_out.errors(held_out.refit(banded.best))
    assert search_held_out(held_out, banded, start, 0.5 * best).steps == ()


def test_an_effect_that_a_fit_uses_on_its_own_record_only_is_not_kept(banded: Explanation) -> None:
    """The held-out samples show another rig, without the dead zone."""
    held_out = hold_out(banded.data, None)
    start = held_out.refit(banded.path[0])
    y = np.where(held_out.scored, start.output, banded.data.y)
    swapped = replace(held_out, data=replace(held_out.data, y=y))
    search = search_held_out(swapped, banded, start, swapped.errors(start) + 1e-6)
    assert "input-dead-zone" not in [step.name for step in search.steps]


def test_the_effects_of_one_record_are_those_with_a_time_course() -> None:
    assert names_where("of_one_record") == {
        "input-off",
        "load-step",
        "output-drift",
        "parameter-drift",
        "periodic-disturbance",
    }


def test_an_effect_must_pay_beside_fitted_parameters_of_a_given_simulation(banded: Explanation) -> None:
    held_out = hold_out(banded.data, None)
    start = held_out.refit(banded.path[0])
    refitted = held_out.errors(start)
    wrong = 9.0 * refitted  # of the simulation as given
    search = search_held_out(held_out, banded, start, wrong, given=True)
    assert search.mismatch == compare_errors(wrong, refitted)
    (step,) = search.steps
    assert step.alone == compare_errors(refitted, step.errors)
    right = 0.9 * refitted
    search = search_held_out(held_out, banded, start, right, given=True)
    assert search.mismatch is None
    assert search.steps[0].alone == compare_errors(right, search.steps[0].errors)
