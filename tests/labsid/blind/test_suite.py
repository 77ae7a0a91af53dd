"""The cases follow the rules of their rows."""

import json
from collections.abc import Callable
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.signal import lfilter

from labsid.blind import suite as suite_module
from labsid.blind.closure import closed_share, held_out_samples, pooled_closure, refit_true_structure
from labsid.blind.experiment import Case, input_signal, redraw, run_experiment, to_record
from labsid.blind.output_error import discrete_poles, fit_linear
from labsid.blind.rows import DEFAULT_ROWS, EFFECTS_BESIDE_UNLISTED, ROWS, TIME_INVARIANT_EFFECTS
from labsid.blind.strength import CLEAR_RATIOS, HARD_RATIOS, linear_model_gap
from labsid.blind.suite import label_dict, make_cases, write_case, write_suite
from labsid.records.record import load_record
from labsid.rig.switchable.effects import EFFECTS, FAMILIES
from labsid.rig.switchable.simulation import poles
from labsid.rig.switchable.truth import true_linear_model
from labsid.rig.switchable.unlisted import UNLISTED_EFFECTS
from labsid.rig.switchable.variants import VARIANTS

COUNTS = {
    "single-clear": 12,
    "single-hard": 3,
    "short": 2,
    "pair": 3,
    "none": 6,
    "unknown": 9,
    "with-sim": 6,
    "partial": 4,
    "families": len(FAMILIES),
    "variants": 6,
    "runs": 2,
    "faint": 2,
}


@pytest.fixture(scope="module")
def some(dev_cases: Callable[[str, int], list[Case]]) -> list[Case]:
    return [case for row, count in COUNTS.items() for case in dev_cases(row, count)]


def of_row(some: list[Case], row: str) -> list[Case]:
    found = [case for case in some if case.row == row]
    assert len(found) == COUNTS[row]
    return found


def left_by_linear(case: Case) -> float:
    """Residual of the best linear model on the noise-free record, over the noise."""
    clean = to_record(run_experiment(case.experiment), case.experiment.scales, "", clean=True)
    start = discrete_poles(poles(case.experiment.plain.motion))
    return fit_linear(clean.u, clean.y, start).rmse / case.sigma


def test_rows_cycle_through_all_effects(some: list[Case]) -> None:
    for row in ("single-clear", "single-hard", "short", "faint"):
        assert [case.labels for case in of_row(some, row)] == [(effect,) for effect in EFFECTS][: COUNTS[row]]
    assert [case.labels[0] for case in of_row(some, "pair")] == list(EFFECTS[: COUNTS["pair"]])
    assert {case.truth["kind"] for case in of_row(some, "unknown")} == set(UNLISTED_EFFECTS)


@pytest.mark.parametrize(("row", "between"), [("single-clear", CLEAR_RATIOS), ("single-hard", HARD_RATIOS)])
def test_the_residual_of_a_linear_model_is_in_the_range_of_the_row(
    some: list[Case], row: str, between: tuple[float, float]
) -> None:
    for case in of_row(some, row):
        left = left_by_linear(case)
        assert between[0] * 0.95 < left < between[1] * 1.05, case.labels
        assert left == pytest.approx(case.ratio, rel=0.05)
        assert case.level == row.removeprefix("single-")
        assert 1200 <= len(case.record) <= 5000


def test_the_gap_of_a_faint_effect_is_between_a_tenth_of_the_noise_and_that_of_a_hard_one(some: list[Case]) -> None:
    for case in of_row(some, "faint"):
        assert 0.1 * 0.95 < left_by_linear(case) < HARD_RATIOS[0] * 1.05
        assert len(case.labels) == 1
        assert case.level == "faint"


def test_the_families_are_clear_and_exercised(some: list[Case]) -> None:
    cases = of_row(some, "families")
    assert [case.labels for case in cases] == [(name,) for name in FAMILIES]
    for case in cases:
        assert case.level == "clear"
        assert CLEAR_RATIOS[0] * 0.95 < left_by_linear(case) < CLEAR_RATIOS[1] * 1.05
        clean = to_record(run_experiment(case.experiment), case.experiment.scales, "", clean=True).y
        motion, true = case.experiment.setup.motion, case.truth[case.labels[0]]
        if case.labels == ("end-stop",):
            reached = [np.mean(np.isclose(clean, stop, rtol=1e-9)) for stop in true.values()]
            assert reached
            assert all(share >= 0.01 for share in reached)
            assert all(np.isclose(clean.min(), true["low"]) for _ in true if "low" in true)
            assert sum(reached) >= 0.02
        elif case.labels == ("slow-mode",):
            assert true["tau"] >= 6.0 * case.experiment.time * case.record.Ts
            assert 0.15 <= abs(true["share"]) <= 0.6
        elif case.labels == ("output-backlash",):
            assert 0.0 < true["width"] < np.ptp(clean) + true["width"]
        else:
            assert motion.drag > 0.0


def test_the_variants_are_clear_but_for_the_stops_that_are_not_reached(some: list[Case]) -> None:
    *clear, unreached = of_row(some, "variants")
    assert [case.truth["kind"] for case in clear] == list(VARIANTS)
    for case in clear:
        assert case.labels == (VARIANTS[case.truth["kind"]],)
        assert CLEAR_RATIOS[0] * 0.95 < left_by_linear(case) < CLEAR_RATIOS[1] * 1.05
        assert case.level == "clear"
    assert unreached.labels == ()
    assert unreached.truth == {"kind": "not exercised", "hidden": "end-stop"}
    assert np.isfinite(unreached.experiment.setup.motion.stop_high)
    assert left_by_linear(unreached) <= 0.1


def test_the_noise_is_between_half_a_percent_and_five(some: list[Case]) -> None:
    for case in some:
        undisturbed = to_record(
            run_experiment(case.experiment, case.experiment.plain), case.experiment.scales, "", clean=True
        )
        assert 0.004 < case.sigma / np.std(undisturbed.y) < 0.06


def test_short_records_are_short_noisy_and_of_few_levels(some: list[Case]) -> None:
    for case in of_row(some, "short"):
        assert 300 <= len(case.record) <= 600
        assert case.experiment.input in ("staircase", "two-level")
        assert case.experiment.noise.share > 0
        assert np.unique(case.record.u).size < 20
        assert case.experiment.plain.motion.actuator_lag > 0


def test_cases_labelled_none_have_no_visible_gap(some: list[Case]) -> None:
    for case in of_row(some, "none"):
        assert case.labels == ()
        assert case.level == "none"
        part_of_a_sample = case.truth["kind"] == "part of a sample"
        assert (
            linear_model_gap(case.experiment, case.experiment.setup, 3 if part_of_a_sample else 2)
            <= 0.1 * case.experiment.noise.sd
        )
        assert case.experiment.setup.actuator.delay < 0.5


def test_hidden_effects_are_in_the_rig_but_not_in_the_record(dev_cases: Callable[[str, int], list[Case]]) -> None:
    unexercised = [case for case in dev_cases("none", 18) if case.truth["kind"] == "not exercised"]
    assert len(unexercised) == 3
    assert len({case.truth["hidden"] for case in unexercised}) >= 2
    assert all(case.experiment.setup != case.experiment.plain for case in unexercised)


def test_the_sensors_own_noise_is_only_mildly_coloured(some: list[Case]) -> None:
    for case in some:
        noise = case.experiment.noise
        if case.row not in ("short", "runs") and noise.share:
            assert np.sqrt(1 - noise.colour**2) >= 0.7


def test_both_effects_of_a_pair_change_the_output(some: list[Case]) -> None:
    for case in of_row(some, "pair"):
        assert len(set(case.labels)) == 2
        assert set(case.truth) == set(case.labels)
        assert case.ratio >= CLEAR_RATIOS[0]


def test_a_partial_case_has_a_listed_effect_and_a_smaller_one_outside_the_table(some: list[Case]) -> None:
    cases = of_row(some, "partial")
    assert [case.labels for case in cases] == [(name,) for name in EFFECTS_BESIDE_UNLISTED[: len(cases)]]
    for case in cases:
        assert case.level == "clear"
        assert case.truth["kind"] in UNLISTED_EFFECTS
        assert case.sim is None
        assert 1200 <= len(case.record) <= 3000
        assert left_by_linear(case) > CLEAR_RATIOS[0]  # both effects together


def test_effects_of_the_samples_are_not_combined_with_one_outside_the_table() -> None:
    left_out = {"output-quantization", "output-outliers", "output-dropout", "coloured-noise"}
    assert set(EFFECTS_BESIDE_UNLISTED) == set(EFFECTS) - left_out


def test_the_simulation_of_a_case_matches_its_label(some: list[Case]) -> None:
    kinds = set()
    for case in of_row(some, "with-sim"):
        assert case.sim is not None
        scales = case.experiment.scales
        undisturbed = replace(case.experiment, setup=case.experiment.plain, start=(0.0, 0.0))
        clean = to_record(run_experiment(undisturbed), scales, "", clean=True)
        run = scales.y0 + lfilter(case.sim["num"], case.sim["den"], clean.u - case.sim["u0"])
        away = np.sqrt(np.mean((run - clean.y) ** 2)) / case.sigma
        kinds.add(case.labels[0] if case.labels == ("parameter-mismatch",) else bool(case.labels))
        if case.labels == ("parameter-mismatch",):
            assert away > 4.0
        elif not case.labels:
            assert away <= 0.1 + 1e-9
        else:
            assert away < 1e-6
        assert case.sim["dt"] == case.record.Ts
        assert len(case.sim["num"]) == len(case.sim["den"]) == 3
    assert kinds == {"parameter-mismatch", True, False}


def test_cases_repeat_in_other_processes_and_a_shorter_suite_is_the_start_of_a_longer_one(some: list[Case]) -> None:
    again = list(make_cases("dev", 2, ["single-hard", "unknown"], jobs=2))
    before = [*of_row(some, "single-hard")[:2], *of_row(some, "unknown")[:2]]
    for one, two in zip(again, before, strict=True):
        assert one.name == two.name
        np.testing.assert_array_equal(one.record.y, two.record.y)
        assert label_dict(one) == label_dict(two)


def test_record_names_do_not_reveal_the_label(some: list[Case]) -> None:
    assert len({case.name for case in some}) == len(some)
    assert all(len(case.name) == 11 and case.record.name == case.name for case in some)


def test_the_seeds_of_final_follow_the_sources(tmp_path, monkeypatch) -> None:
    gap_folder, blind = tmp_path / "gap", tmp_path / "blind"
    gap_folder.mkdir()
    (gap_folder / "a.py").write_text("one = 1\n")
    monkeypatch.setattr(suite_module, "__file__", str(blind / "suite.py"))
    draw = {"none": lambda rng, i, name: SimpleNamespace(name=name, drawn=rng.random())}
    monkeypatch.setattr(suite_module, "ROWS", dict.fromkeys(ROWS) | draw)

    def numbers(suite: str) -> tuple[str, float]:
        (case,) = make_cases(suite, 1, ["none"])
        return case.name, case.drawn

    first, dev, same = (numbers(suite) for suite in ("final", "dev", "final"))
    (gap_folder / "a.py").write_text("one = 2\n")
    changed = numbers("final")
    assert first == same
    assert not set(first) & {*changed, *dev}
    assert dev == numbers("dev")


@pytest.mark.usefixtures("drawn_once")
def test_a_suite_is_written_without_its_labels(some: list[Case], tmp_path) -> None:
    labels_path = write_suite(tmp_path / "records", "dev", 4, ["single-clear", "with-sim"])
    assert labels_path == tmp_path / "records.labels.json"
    labels = json.loads(labels_path.read_text())
    made = [*of_row(some, "single-clear")[:4], *of_row(some, "with-sim")[:4]]
    assert set(labels) == {case.name for case in made}
    files = {path.name for path in (tmp_path / "records").iterdir()}
    expected = {f"{case.name}.csv" for case in made}
    expected |= {f"{case.name}.sim.json" for case in made if case.sim}
    expected |= {f"{case.name}.holdout.csv" for case in made if case.holdout}
    assert files == expected
    text = "".join(path.read_text() for path in (tmp_path / "records").iterdir())
    assert not any(effect in text for effect in EFFECTS)
    record = load_record(tmp_path / "records" / f"{made[0].name}.csv")
    np.testing.assert_allclose(record.y, made[0].record.y, rtol=1e-8)
    assert record.Ts == pytest.approx(made[0].record.Ts)


def test_unknown_suites_and_rows_are_refused() -> None:
    with pytest.raises(ValueError, match="suite must be dev or final; got 'test'"):
        next(make_cases("test"))
    with pytest.raises(ValueError, match="rows must be of single-clear"):
        next(make_cases("dev", 1, ["triples"]))


def test_a_fresh_record_has_the_same_rig_and_other_noise_and_input(some: list[Case]) -> None:
    case = of_row(some, "single-clear")[9]
    again = redraw(case.experiment, 3)
    assert replace(again.setup, sensor=case.experiment.setup.sensor) == case.experiment.setup
    assert np.any(input_signal(again) != input_signal(case.experiment))
    assert again != redraw(case.experiment, 4)


def test_the_true_structure_refitted_leaves_the_noise(some: list[Case]) -> None:
    cases = [of_row(some, "single-clear")[i] for i in (1, 4, 8, 10)]
    for case in [*cases, *of_row(some, "families")[:4], *of_row(some, "variants")[:5]]:
        counts = np.ones(len(case.record), dtype=bool)
        counts[len(case.record) // 2 : len(case.record) * 3 // 4] = False
        run = refit_true_structure(case, counts)
        left = np.sqrt(np.mean((run - case.record.y)[~counts] ** 2)) / case.sigma
        assert left < 1.15, case.labels


def test_closure_is_worked_by_hand() -> None:
    assert closed_share(5.0, 3.0, 3.0) == 1.0
    assert closed_share(5.0, 5.0, 3.0) == 0.0
    assert closed_share(np.sqrt(17.0), np.sqrt(5.0), 1.0) == pytest.approx(0.5)
    assert closed_share(1.0, 0.5, 1.0) is None
    clean = [np.zeros(100), np.zeros(100)]
    assert pooled_closure(clean, [np.full(100, 2.0)] * 2, [np.full(100, 0.5)] * 2) == pytest.approx(0.75)


def test_held_out_blocks_are_read_from_the_result(some: list[Case]) -> None:
    case = next(case for case in some if case.holdout is None)
    t = case.record.t
    blocks = [[float(t[10]), float(t[210])], [float(t[500]), float(t[900])]]
    found = held_out_samples(case, {"gap": {"holdout": blocks}})
    np.testing.assert_array_equal(np.flatnonzero(found), [*range(10, 210), *range(500, 900)])
    assert held_out_samples(case, {"gap": {"holdout": []}}) is None
    assert held_out_samples(case, {}) is None


def test_rows_are_those_of_the_bars() -> None:
    old = ["single-clear", "single-hard", "short", "pair", "none", "unknown", "with-sim", "partial"]
    default = [*old, "families", "variants", "runs", "honest", "faint", "joints", "several"]
    assert list(ROWS) == [*default, "signals", "signals-hard", "signals-none", "loop"]
    assert list(DEFAULT_ROWS) == default


def test_rows_on_request_are_made_if_they_are_named(monkeypatch) -> None:
    drawn = {row: lambda rng, i, name, row=row: SimpleNamespace(row=row) for row in ROWS}
    monkeypatch.setattr(suite_module, "ROWS", drawn)
    assert [case.row for case in make_cases("dev", 1)] == list(DEFAULT_ROWS)
    assert [case.row for case in make_cases("dev", 1, ["loop", "signals"])] == ["signals", "loop"]


def test_the_runs_of_a_rig_have_its_effect_with_other_inputs_and_noise(some: list[Case], tmp_path) -> None:
    for case in of_row(some, "runs"):
        assert len(case.others) == 2
        assert set(case.labels) <= TIME_INVARIANT_EFFECTS
        for record in case.others:
            assert len(record) == len(case.record)
            assert np.any(record.u != case.record.u)
        assert case.level == "hard"
    write_case(tmp_path, case)
    assert {path.name for path in tmp_path.iterdir()} == {case.name, f"{case.name}-alone.csv"}
    runs = [load_record(tmp_path / case.name / f"{number}.csv") for number in (1, 2, 3)]
    for run, record in zip(runs, (case.record, *case.others), strict=True):
        np.testing.assert_allclose(run.y, record.y, rtol=1e-8)


def test_the_simulation_is_in_the_records_units(some: list[Case]) -> None:
    case = of_row(some, "with-sim")[1]
    model = true_linear_model(case.experiment.plain, case.experiment.scales)
    gain = sum(model["num"]) / sum(model["den"])
    step = case.experiment.scales.ys / case.experiment.scales.us
    assert 0.1 < gain / step < 10
