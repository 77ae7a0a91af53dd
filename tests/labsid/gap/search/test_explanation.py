"""The explanation: levels, path, and the size from which an effect is named."""

from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from gap_search import searched
from scipy.signal import lfilter

from labsid._arrays import FloatArray
from labsid.gap.effects.families import CANDIDATES
from labsid.gap.fits.fitting import Fit, mean_square
from labsid.gap.record.data import scaled
from labsid.gap.record.sample_faults import SampleFaults
from labsid.gap.reports.report import screen_sentences
from labsid.gap.search import beam_search
from labsid.gap.search.beam_search import Levels, is_improvement, rather_a_set, residual_is_white, search_effects
from labsid.gap.search.explanation import Explanation, explain, is_nuisance, unsimulated_effects, without_small_steps


def test_the_path_adds_one_effect_at_a_time(banded: Explanation) -> None:
    assert banded.names == banded.best.hypothesis.names == ("input-dead-zone",)
    assert [len(fit.hypothesis.effects) for fit in banded.path] == list(range(len(banded.path)))
    assert all(b.bic < a.bic for a, b in pairwise(banded.path))
    assert banded.path[0] is banded.levels[0][()]


def test_levels_hold_the_best_fit_of_every_combination(banded: Explanation) -> None:
    for number, level in enumerate(banded.levels):
        for names, fit in level.items():
            assert len(names) == number
            assert names == tuple(sorted(fit.hypothesis.names))
            assert np.isfinite(fit.bic)
    assert min(banded.levels[1].values(), key=lambda fit: fit.bic) is banded.best


def test_a_linear_record_has_no_effect(plain: Explanation) -> None:
    assert plain.names == ()
    assert len(plain.path) == 1
    assert residual_is_white(plain.data, plain.best)
    assert not (plain.faults.held | plain.faults.spikes).any()
    assert plain.faults.lattice is None
    assert plain.data.lattice == 0.0


def test_the_residual_is_white_only_with_the_effect(banded: Explanation) -> None:
    assert not residual_is_white(banded.data, banded.path[0])
    assert residual_is_white(banded.data, banded.best)


def test_an_improvement_requires_a_bic_gain_and_a_visible_change(banded: Explanation) -> None:
    data, base, best = banded.data, banded.path[0], banded.best
    assert is_improvement(data, base, best)
    assert not is_improvement(data, best, base)
    assert not is_improvement(data, base, replace(best, bic=base.bic - 1.0))
    assert not is_improvement(data, base, replace(best, output=base.output + 1e-4))


def test_progress_is_reported_and_the_number_of_effects_is_limited(banded: Explanation) -> None:
    told: list[float] = []
    again = explain(banded.data, most=1, progress=lambda what, share: told.append(share))
    assert len(again.levels) == 2
    assert again.names == ("input-dead-zone",)
    assert told[0] == 0.0
    assert told == sorted(told)
    assert told[-1] < 1.0


def spoilt(fit: Fit, explained: Explanation, faults: SampleFaults, y: np.ndarray) -> tuple[str, ...]:
    """`unsimulated_effects` with other samples."""
    data = replace(explained.data, y=y)
    return unsimulated_effects(data, replace(data, rows=data.rows & ~faults.held & ~faults.spikes), faults, (fit,))


def test_sample_faults_are_effects_if_they_cause_the_gap(plain: Explanation) -> None:
    fit, nothing = plain.best, np.zeros(plain.data.samples, bool)
    assert spoilt(fit, plain, SampleFaults(nothing, (), nothing, None), plain.data.y) == ()
    y, spikes = plain.data.y.copy(), nothing.copy()
    spikes[[50, 150, 333]] = True
    y[spikes] += 3.0
    assert spoilt(fit, plain, SampleFaults(nothing, (), spikes, None), y) == ("output-outliers",)
    y, single = plain.data.y.copy(), nothing.copy()
    single[50] = True
    y[single] += 3.0
    assert spoilt(fit, plain, SampleFaults(nothing, (), single, None), y) == ()  # one sample may be anything
    y, held = plain.data.y.copy(), nothing.copy()
    held[100:140] = True
    y[held] = y[99] + 1.0
    assert spoilt(fit, plain, SampleFaults(held, ((100, 140),), nothing, None), y) == ("output-dropout",)


def test_a_converter_step_as_large_as_the_noise_is_quantization(plain: Explanation) -> None:
    nothing = np.zeros(plain.data.samples, bool)
    sd = np.sqrt(plain.best.noise.sigma2)
    coarse = SampleFaults(nothing, (), nothing, float(sd * np.sqrt(12.0)))
    assert spoilt(plain.best, plain, coarse, plain.data.y) == ("output-quantization",)
    fine = SampleFaults(nothing, (), nothing, float(0.1 * sd))
    assert spoilt(plain.best, plain, fine, plain.data.y) == ()


@pytest.mark.parametrize(("size", "dropped"), [(2.0, False), (4.0, True)])
def test_held_values_within_a_converter_step_are_no_dropout(plain: Explanation, size: float, dropped: bool) -> None:
    sd = float(np.sqrt(plain.best.noise.sigma2))
    held = np.arange(plain.data.samples) % 100 < 40
    y = np.where(held, plain.best.output + size * sd * (-1.0) ** np.arange(held.size), plain.data.y)
    faults = SampleFaults(held, ((0, 40),), np.zeros_like(held), sd * np.sqrt(12.0))
    assert ("output-dropout" in spoilt(plain.best, plain, faults, y)) == dropped


@pytest.mark.parametrize(("pole", "names"), [(0.5, ()), (0.97, ("coloured-noise",))])
def test_only_slow_noise_is_an_effect(plain: Explanation, pole: float, names: tuple[str, ...]) -> None:
    """Sensor noise is uncorrelated after a few samples, and the noise of a rig after a fraction of its response."""
    e = lfilter([1.0], [1.0, -pole], 0.05 * np.random.default_rng(3).standard_normal(plain.data.samples))
    data = replace(plain.data, y=plain.best.output + e)
    fit = replace(plain.best, noise=replace(plain.best.noise, ar=np.array([pole]), sigma2=0.05**2))
    nothing = np.zeros(data.samples, bool)
    assert unsimulated_effects(data, data, SampleFaults(nothing, (), nothing, None), (fit,)) == names


@pytest.mark.parametrize(("size", "names"), [(0.02, ()), (0.2, ("coloured-noise",))])
def test_beside_effects_coloured_noise_is_a_share_of_the_gap(
    banded: Explanation, size: float, names: tuple[str, ...]
) -> None:
    """What a law that is not quite right leaves of an effect is slow, too."""
    base, best = banded.path[0], banded.best
    gap = float(np.sqrt(np.mean((banded.data.y - base.output) ** 2)))
    white = 0.3 * size * gap
    e = lfilter([1.0], [1.0, -0.97], np.random.default_rng(3).standard_normal(base.output.size))
    e *= size * gap / np.std(e)
    data = replace(banded.data, y=best.output + e)
    fit = replace(best, noise=replace(best.noise, ar=np.array([0.97]), sigma2=white**2))
    nothing = np.zeros(data.samples, bool)
    faults = SampleFaults(nothing, (), nothing, None)
    assert unsimulated_effects(data, data, faults, (base, fit)) == names
    assert unsimulated_effects(data, data, faults, (fit,)) == ("coloured-noise",)


def test_a_set_wins_over_what_is_left_of_a_longer_path(banded: Explanation, monkeypatch: pytest.MonkeyPatch) -> None:
    data, base, best = banded.data, banded.path[0], banded.best
    monkeypatch.setattr(beam_search, "polish", lambda _, fit: fit)
    (alone,) = (fit for names, fit in banded.levels[1].items() if names == ("input-dead-zone",))
    both = best.hypothesis.plus(next(one for group in CANDIDATES for one in group if one.name == "input-nonlinearity"))
    noise = np.sqrt(np.mean((data.y - best.output) ** 2))
    wave = np.sin(0.1 * np.arange(data.samples)) * np.sqrt(2.0) * noise
    other = replace(base, bic=best.bic + 40.0, output=best.output + wave)
    better = replace(best, hypothesis=both, bic=best.bic - 40.0)
    names = tuple(sorted(both.names))
    levels = (banded.levels[0], {("input-dead-zone",): alone}, {names: better})
    monkeypatch.setattr(beam_search, "has_size", lambda *_: True)
    assert rather_a_set(data, levels, (base, other)) == (base, alone, better)
    as_good = (base, replace(other, bic=better.bic))
    assert rather_a_set(data, levels, as_good) is as_good


def test_small_steps_are_dropped_only_at_the_end_of_the_path(banded: Explanation) -> None:
    data, base, best = banded.data, banded.path[0], banded.best
    noise = np.sqrt(np.mean((data.y - best.output) ** 2))
    wave = np.sin(0.1 * np.arange(data.samples)) * np.sqrt(2.0) * noise
    small = replace(best, output=best.output + 0.3 * wave)
    large = replace(best, output=best.output + 8.0 * wave)
    assert without_small_steps(data, (base, best, small)) == (base, best)
    assert without_small_steps(data, (base, best, small, best)) == (base, best)
    assert without_small_steps(data, (base, large, best)) == (base, large, best)
    assert without_small_steps(data, (base,)) == (base,)


def test_a_second_effect_below_the_minimum_share_of_the_gap_is_dropped(banded: Explanation) -> None:
    """Also if the noise is much smaller."""
    data, base, best = banded.data, banded.path[0], banded.best
    gap = float(np.sqrt(np.mean((data.y - base.output)[data.rows] ** 2)))
    quiet = replace(data, y=best.output + 1e-4 * np.random.default_rng(5).standard_normal(data.samples))
    wave = np.sin(0.1 * np.arange(data.samples)) * np.sqrt(2.0) * gap
    for share, kept in ((0.03, False), (0.15, True)):
        further = replace(best, output=best.output)
        before = replace(best, output=best.output - share * wave)
        assert without_small_steps(quiet, (base, before, further)) == (
            (base, before, further) if kept else (base, before)
        )


@searched("input-delay", "extra-lag", "slow-mode", "output-drift", "output-nonlinearity", "output-backlash")
def test_slow_motion_within_a_converter_step_is_no_dropout() -> None:
    """Slow motion on a coarse converter repeats values; a logger that holds values lags behind the motion."""
    k = np.arange(1500)
    u = np.repeat(np.random.default_rng(3).uniform(-1.0, 1.0, 10), 150)
    y = lfilter([0.0, 0.02], [1.0, -0.98], u) + 0.002 * np.random.default_rng(4).standard_normal(k.size)
    coarse = np.round(y / 0.06) * 0.06
    rows = np.ones(k.size, bool)
    assert explain(scaled(u, coarse, rows, 1.0)).names == ("output-quantization",)

    u = np.repeat(np.random.default_rng(3).uniform(-1.0, 1.0, 60), 25)
    y = np.round(lfilter([0.0, 0.1], [1.0, -0.9], u) / 0.06) * 0.06
    for start in (210, 760, 1110):
        y[start : start + 45] = y[start]
    found = explain(scaled(u, y, rows, 1.0))
    assert set(found.names) == {"output-quantization", "output-dropout"}
    assert len(found.faults.stretches) == 3
    assert found.data.lattice * found.data.y_scale.unit == pytest.approx(0.06)


def test_a_small_effect_with_a_rival_is_a_nuisance(banded: Explanation) -> None:
    data, base, best = banded.data, banded.path[0], banded.best
    noise = np.sqrt(np.mean((data.y - best.output) ** 2))
    wave = np.sin(0.1 * np.arange(data.samples)) * np.sqrt(2.0) * noise
    small = replace(base, output=best.output + 0.4 * wave)
    near, far = replace(best, bic=best.bic + 3.0), replace(best, bic=best.bic + 30.0)
    assert is_nuisance(data, {("a",): best, ("b",): near}, (small, best))
    assert not is_nuisance(data, {("a",): best, ("b",): far}, (small, best))
    assert not is_nuisance(data, {("a",): best, ("b",): near}, (base, best))


@pytest.fixture
def searches(monkeypatch: pytest.MonkeyPatch) -> list[tuple[Fit, ...]]:
    """The accepted paths of the searches that `explain` runs."""
    paths: list[tuple[Fit, ...]] = []

    def search(*arguments: Any) -> tuple[Levels, tuple[Fit, ...]]:
        levels, path = search_effects(*arguments)
        paths.append(path)
        return levels, path

    monkeypatch.setattr("labsid.gap.search.explanation.search_effects", search)
    return paths


@searched(
    "input-dead-zone",
    "input-nonlinearity",
    "slow-mode",
    "parameter-drift",
    "output-drift",
    "output-nonlinearity",
    "load-step",
    "periodic-disturbance",
)
def test_a_drift_beside_an_input_curve_is_accepted_if_the_residual_is_white(
    levels: FloatArray, two_poles: Callable[..., FloatArray], searches: list[tuple[Fit, ...]]
) -> None:
    """A search by innovations finds neither effect: the drift is predictable from its last values."""
    k, rng = np.arange(levels.size), np.random.default_rng(2)
    waves = [size * np.sin(2.0 * np.pi * cycles * k / k.size + at) for size, cycles, at in slow_waves(rng)]
    y = two_poles(levels + 0.25 * levels**2) + 0.25 * np.sum(waves, axis=0) + 0.01 * rng.standard_normal(k.size)
    data = scaled(levels, y, np.ones(k.size, bool), 1.0)
    found = explain(data, most=2)
    assert len(searches[0]) == 1
    assert found.names == ("output-drift", "input-nonlinearity")
    assert mean_square(found.data, found.best) < 1.1 * found.best.noise.sigma2
    assert mean_square(found.data, found.best) * data.y_scale.unit**2 == pytest.approx(0.01**2, rel=0.2)


def slow_waves(rng: np.random.Generator) -> list[tuple[float, float, float]]:
    """Sizes, cycles in the record and phases of six slow waves."""
    return list(zip(rng.uniform(0.5, 1.0, 6), rng.uniform(1.0, 6.0, 6), rng.uniform(0.0, 6.0, 6), strict=True))


@searched("extra-lag", "slow-mode", "parameter-drift", "output-drift", "load-step", "periodic-disturbance")
def test_slow_noise_is_not_identified_as_a_drift(
    levels: FloatArray, two_poles: Callable[..., FloatArray], searches: list[tuple[Fit, ...]]
) -> None:
    y = two_poles(levels)
    e = lfilter([1.0], [1.0, -0.985], np.random.default_rng(4).standard_normal(levels.size + 300))[300:]
    data = scaled(levels, y + 0.3 * np.std(y) * e / np.std(e), np.ones(levels.size, bool), 1.0)
    assert explain(data, most=1).names == ("coloured-noise",)
    by_free_run = searches[-1]
    assert "output-drift" in by_free_run[-1].hypothesis.names
    assert mean_square(data, by_free_run[-1]) < 0.5 * mean_square(data, by_free_run[0])


@searched("input-delay", "extra-lag", "slow-mode", "output-drift", "output-backlash", "load-step")
def test_a_rest_without_noise_before_a_jump_is_no_fault_of_samples() -> None:
    """A first-order rig with a delay, four digits: the second pole of the simulation costs .03 samples at each jump."""
    u = np.repeat([0.6, -3.6, 0.7, -3.9, 1.2, -4.4], 240)
    y = np.concatenate([np.zeros(34), lfilter([0.0, 0.00605815], [1.0, -0.97196709], u)[:-34]])
    y = np.array([float(f"{value:.4g}") for value in y])
    found = explain(scaled(u, y, np.ones(u.size, bool), 0.002))
    assert found.best.hypothesis.names == ("input-delay",)
    assert found.unsimulated == ()


@searched("input-delay", "extra-lag", "output-drift")
def test_the_noise_that_is_added_to_an_exact_record_is_said() -> None:
    u = np.repeat(np.random.default_rng(5).uniform(-1.0, 1.0, 20), 20)
    y = lfilter([0.0, 0.05, 0.04], [1.0, -1.5, 0.56], u)
    exact = explain(scaled(u, y, np.ones(u.size, bool), 0.1))
    assert exact.floor == pytest.approx(1e-4, rel=0.1)
    (said,) = screen_sentences(exact)
    assert said.startswith("The record has hardly any noise of its own.")
    noisy = explain(scaled(u, y + 0.01 * np.random.default_rng(6).standard_normal(u.size), np.ones(u.size, bool), 0.1))
    assert screen_sentences(noisy) == []


@searched("slow-mode", "output-drift")
@pytest.mark.parametrize(("creep", "warming", "name"), [(0.4, 0.0, "slow-mode"), (0.0, 2.5, "output-drift")])
def test_creep_of_an_unsettled_rig_is_told_from_a_sensor_that_warms_up(creep: float, warming: float, name: str) -> None:
    """A record begins far from where a slow mode would rest: most of its motion does not depend on the input."""
    rng = np.random.default_rng(17)
    k = np.arange(2000)
    u = np.repeat(rng.uniform(5.0, 10.0, 50), 40)
    fast = lfilter([0.0, 0.08, 0.07], np.poly([0.8 * np.exp(0.3j), 0.8 * np.exp(-0.3j)]).real, u - u[0])
    slow = creep * lfilter([0.0, 1.0 / 800.0], [1.0, -1.0 + 1.0 / 800.0], u) - warming * np.exp(-k / 800.0)
    found = explain(scaled(u, fast + slow + 0.1 * rng.standard_normal(k.size), np.ones(k.size, bool), 1.0))
    assert found.names == (name,)
