"""Several records of one rig: shared dynamics, own offsets and initial states, each record left out in turn."""

import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from gap_search import searched
from scipy.signal import lfilter

from labsid._arrays import FloatArray
from labsid.cli.commands import main
from labsid.gap.diagnosis import Diagnosis, diagnose
from labsid.gap.dynamics.record_start import LEAST_START
from labsid.gap.effects.families import EFFECTS_BY_KEY
from labsid.gap.effects.play import Play
from labsid.gap.effects.restarts import PlayByRecord, in_one_record, in_records
from labsid.gap.fits.fitting import Problem
from labsid.gap.fits.hypothesis import Hypothesis
from labsid.gap.fits.linear_fits import fit_baseline
from labsid.gap.model_file import export_model, from_json_dict
from labsid.gap.reports.html_report import page_content
from labsid.gap.reports.text_report import format_report
from labsid.gap.simulations.baseline import linear_structure, make_baseline, with_restarts
from labsid.gap.simulations.long_record import shorten_records
from labsid.gap.verdict.held_out_errors import hold_out
from labsid.gap.verdict.several_records import join_records
from labsid.records.record import Record

pytestmark = pytest.mark.usefixtures("without_limits")

MakeRecord = Callable[..., Record]
OFFSETS = (0.0, 0.6, -0.4)
NOISE = 0.05


def run_of(seed: int, offset: float, limit: float = np.inf, noise: float = NOISE, samples: int = 400) -> Record:
    """A run of two lags in a row, from another state than rest."""
    rng = np.random.default_rng(seed)
    u = np.repeat(rng.uniform(1.0, 4.0, samples // 20), 20)
    w = np.minimum(u, limit)
    state = rng.uniform(-1.0, 1.0)
    y = w[0] + lfilter([0.0, 0.01], np.poly([0.95, 0.8]), w - w[0], zi=[state, -0.8 * state])[0]
    y = y + offset + noise * rng.standard_normal(samples)
    return Record(0.5 * np.arange(samples, dtype=float), u, y, 0.5, name=f"run{seed}")


def runs(**options: Any) -> list[Record]:
    return [run_of(seed, offset, **options) for seed, offset in enumerate(OFFSETS, 1)]


@pytest.fixture(scope="module")
def limited() -> tuple[Diagnosis, list[Record]]:
    """Three runs of a rig whose actuator goes no higher than 3.1, by a search for few effects."""
    records = runs(limit=3.1)
    with searched("input-saturation", "input-nonlinearity", "output-saturation", "output-nonlinearity", "load-step"):
        return diagnose(records), records


def rms(e: FloatArray) -> float:
    return float(np.sqrt(np.mean(e[LEAST_START:] ** 2)))


def test_records_with_other_offsets_and_initial_states_have_the_poles_of_one() -> None:
    records = runs(noise=0.0)
    data = join_records(records).data()
    fit = fit_baseline(data, with_restarts(linear_structure(2), data))
    poles = np.sort(np.exp(np.roots([1.0, *fit.rates])))
    np.testing.assert_allclose(poles, [0.8, 0.95], atol=1e-4)
    assert np.abs((data.y - fit.output)[data.rows]).max() < 1e-4
    assert fit.hypothesis.names == ()


@pytest.mark.parametrize(
    ("key", "others", "own"),
    [
        ("extra-lag", [0.6], {"log_lag": np.log(-1.0 / np.log(0.6))}),
        ("resonance", 0.99 * np.exp([0.5j, -0.5j]), {"log_frequency": np.log(np.hypot(0.5, np.log(0.99)))}),
        ("slow-mode", [0.996], {"log_slow": np.log(-1.0 / np.log(0.996))}),
    ],
)
def test_every_pole_has_an_initial_state_in_each_record(key: str, others: list[complex], own: dict[str, float]) -> None:
    """A mode would otherwise ring on from one record into the next one."""
    poles, rng, records = np.array([0.95, 0.8, *others]), np.random.default_rng(4), []
    zeros = np.real(np.poly(poles[:-1] - 0.05))
    for record in runs():
        state = rng.standard_normal(poles.size)
        y = lfilter([0.0, *zeros], np.real(np.poly(poles)), record.u - record.u[0], zi=state)[0]
        records.append(replace(record, y=y))
    data = join_records(records).data()
    hypothesis = with_restarts(linear_structure(2), data).plus(EFFECTS_BY_KEY[key])
    rates = {"log_c": np.log(-np.log(0.95 * 0.8)), "log_k": np.log(np.log(0.95) * np.log(0.8))}
    damping = {"log_damping": np.log(-np.log(0.99)) - own.get("log_frequency", 0.0)}
    theta = np.array([(rates | damping | own).get(one.name, 0.0) for one in hypothesis.parameters])
    point = Problem(data, hypothesis).point(theta)
    assert point is not None
    assert np.abs(point.error).max() < 1e-4


def test_between_two_records_nothing_counts_and_the_input_is_that_of_the_next() -> None:
    records = runs()
    joined = join_records(records)
    (_, first), (second, _) = joined.pieces[:2]
    assert first < second
    assert not joined.data().rows[first:second].any()
    np.testing.assert_array_equal(joined.u[first:second], records[1].u[0])
    for (start, stop), record in zip(joined.pieces, records, strict=True):
        np.testing.assert_array_equal(joined.record.y[start:stop], record.y)


def test_a_left_out_record_does_not_change_its_own_simulation() -> None:
    """Its errors grow with a gross error of it, by no more than that error, and those of the others with their fits."""
    data = join_records(runs()).data()
    held_out = hold_out(data, None)
    output = held_out.output(fit_baseline(data, with_restarts(linear_structure(2), data)))
    start, stop = data.pieces[2]
    bad = data.y.copy()
    bad[start + LEAST_START : stop] *= -3.0
    spoilt = replace(data, y=bad)
    again = hold_out(spoilt, None).output(fit_baseline(spoilt, with_restarts(linear_structure(2), spoilt)))
    np.testing.assert_allclose(again[start:stop], output[start:stop], atol=0.02)
    assert rms(again[:stop] - output[:stop]) > 0.1


def test_a_shared_effect_is_named_and_each_record_has_its_errors(limited: tuple[Diagnosis, list[Record]]) -> None:
    report = limited[0].report
    assert (report["verdict"], [effect["name"] for effect in report["effects"]]) == ("effect", ["input-saturation"])
    assert report["effects"][0]["parameters"]["high"]["value"] == pytest.approx(3.1, abs=0.05)
    assert [row["name"] for row in report["records"]] == ["run1", "run2", "run3"]
    for row in report["records"]:
        assert row["before"] > 1.5 * row["after"]
        assert row["after"] == pytest.approx(NOISE, rel=0.25)
        assert row["noise_floor"] == pytest.approx(NOISE, rel=0.25)
        assert row["closed"] > 0.7
    samples = [row["samples"] - LEAST_START for row in report["records"]]
    pooled = np.sqrt(np.average([row["after"] ** 2 for row in report["records"]], weights=samples))
    assert report["gap"]["after"] == pytest.approx(pooled)
    assert sum(share for *_, share in report["where"]["time"]) == pytest.approx(1.0)


@searched("input-backlash", "input-dead-zone", "output-backlash")
def test_backlash_starts_in_each_record_where_it_was_before() -> None:
    """Taken up on the one side, on the other and halfway: with one position for all, something else remained."""
    records = []
    for seed, position in enumerate((-0.5, 0.5, 0.0), 1):
        record = run_of(seed, 0.0, noise=0.02)
        w, now = np.empty(len(record)), record.u[0] + position * 1.2
        for k, u in enumerate(record.u):
            now = min(max(now, u - 0.6), u + 0.6)
            w[k] = now
        y = w[0] + lfilter([0.0, 0.01], np.poly([0.95, 0.8]), w - w[0])
        noise = 0.02 * np.random.default_rng(10 + seed).standard_normal(len(record))
        records.append(replace(record, y=y + noise))
    found = diagnose(records)
    report = found.report
    assert (report["verdict"], [effect["name"] for effect in report["effects"]]) == ("effect", ["input-backlash"])
    assert report["effects"][0]["probability"] > 0.9
    assert report["effects"][0]["parameters"]["width"]["value"] == pytest.approx(1.2, abs=0.06)
    model = from_json_dict(json.loads(json.dumps(found.model.to_json_dict())))
    for record in records:
        assert rms(record.y - model.simulate(record.u, record.y)) < 0.03


@pytest.mark.parametrize(
    "keys", [("coulomb-friction/position",), ("sqrt-outflow/both", "extra-lag"), ("quadratic-drag/speed", "resonance")]
)
def test_nonlinear_dynamics_are_simulated_anew_in_each_record(keys: tuple[str, ...]) -> None:
    data = join_records(runs()).data()
    effects = tuple(EFFECTS_BY_KEY[key] for key in keys)
    hypothesis = with_restarts(linear_structure(2), data)
    hypothesis = hypothesis.with_effects((*hypothesis.effects, *effects))
    single = Hypothesis(effects)
    given = {"log_c": -1.0, "log_k": -3.0, "log_a": -3.0, "log_b": -1.5, "friction": 0.2, "drag": 0.3, "zero": -3.0}
    theta = np.array([given.get(one.name, one.start) for one in hypothesis.parameters])
    states = hypothesis.slices["restarts"]
    assert [one.name[-2:] for one in hypothesis.parameters[states]] == [" 2", " 2", " 3", " 3"]
    before = hypothesis.design(theta.copy(), data.u)
    theta[states] = 0.3, -0.2, -0.4, 0.1
    design = hypothesis.design(theta, data.u, near=before)
    np.testing.assert_array_equal(design.columns, hypothesis.design(theta, data.u).columns)
    for place in (*range(states.start, states.stop), hypothesis.slices["plant"].start):
        other = theta + 0.1 * (np.arange(theta.size) == place)
        again = hypothesis.design(other, data.u, near=design)
        np.testing.assert_array_equal(again.columns, hypothesis.design(other, data.u).columns)
    own = np.array([given.get(one.name, one.start) for one in single.parameters])
    first = [i for i, one in enumerate(single.parameters) if one.name in ("h1", "h2", "z0", "v0", "i0")]
    for (start, stop), pair in zip(data.pieces, ([0.0, 0.0], [0.3, -0.2], [-0.4, 0.1]), strict=True):
        own[first] = pair
        alone = single.design(own, data.u[start:stop], data.samples, float(data.u[0]))
        inside = slice(start, stop - 1)  # a lag interpolates up to the next sample
        np.testing.assert_allclose(design.parts[0][inside, 0], alone.parts[0][:-1, 0], atol=1e-12)
    own[first] = 0.0
    for samples in (300, 4 * data.samples):  # a signal that is not the joined record
        step = np.repeat((0.0, 1.0), samples)
        whole, alone = (one.design(x, step).parts[0] for one, x in ((hypothesis, theta), (single, own)))
        np.testing.assert_array_equal(whole, alone)


@pytest.mark.exhaustive  # `test_reaction_forces.py` names friction on several records; above, play starts elsewhere
@searched("input-backlash", "coulomb-friction", "output-backlash")
def test_a_mass_with_friction_rests_elsewhere_before_each_record() -> None:
    records = []
    for seed, rest in enumerate((-0.25, 0.25, 0.0), 1):
        record = run_of(seed, 0.0)
        y, z, v = np.empty(len(record)), record.u[0] + rest, 0.0
        for k, u in enumerate(record.u):
            y[k] = z
            for _ in range(40):
                force = 0.05 * (u - z) - 0.3 * v
                dry = np.sign(v) * 0.015 if v else np.clip(force, -0.015, 0.015)
                new = v + (force - dry) / 40
                v = 0.0 if new * v < 0.0 else new
                z += v / 40
        noise = 0.02 * np.random.default_rng(10 + seed).standard_normal(len(record))
        records.append(replace(record, y=y + noise))
    report = diagnose(records).report
    assert (report["verdict"], [effect["name"] for effect in report["effects"]]) == ("effect", ["coulomb-friction"])
    assert report["effects"][0]["probability"] > 0.9


def test_play_by_record_is_the_play_of_each_record() -> None:
    z = np.cumsum(np.random.default_rng(5).standard_normal(90))
    own = np.array([2.0, 0.1, 0.9, 0.4])
    starts = [0, 40, 65, 90]
    effect = in_records(Play(), [(40, 60), (65, 90)])
    assert isinstance(effect, PlayByRecord)
    assert in_one_record(effect) == Play()
    np.testing.assert_array_equal(effect.apply(z[:80], own), Play().apply(z[:80], own[:2]))  # not the joined record
    assert [parameter.name for parameter in effect.parameters] == ["width", "position", "position2", "position3"]
    reading = effect.apply(z, own)
    for start, stop, position in zip(starts[:-1], starts[1:], own[1:], strict=True):
        np.testing.assert_array_equal(reading[start:stop], Play().apply(z[start:stop], np.array([2.0, position])))
    changed = z + 1e-6 * (shape := np.sin(0.1 * np.arange(90.0)))
    slope = (effect.apply(changed, own) - reading) / 1e-6
    np.testing.assert_allclose(effect.passed(shape[:, None], z, own)[:, 0], slope, atol=1e-6)


def test_the_exported_model_simulates_each_record(limited: tuple[Diagnosis, list[Record]]) -> None:
    found, records = limited
    model = from_json_dict(json.loads(json.dumps(found.model.to_json_dict())))
    for record, row in zip(records, found.report["records"], strict=True):
        assert rms(record.y - model.simulate(record.u, record.y)) == pytest.approx(row["after"], rel=0.1)


def test_the_table_of_records_is_in_both_reports(limited: tuple[Diagnosis, list[Record]]) -> None:
    report = limited[0].report
    text, page = format_report(report), page_content(report)
    assert [row[0] for row in page["records"]] == ["run1", "run2", "run3"]
    for row in page["records"]:
        assert any(line.split()[:4] == list(row[:4]) for line in text.splitlines())


def test_a_given_model_is_simulated_from_the_state_of_each_record() -> None:
    records = runs(noise=0.0)
    data = join_records(records).data()
    model = {"num": [0.01, 0.0], "den": np.poly([0.95, 0.8]).tolist(), "dt": 0.5}
    base = make_baseline(data, 0.5 * np.arange(data.samples, dtype=float), model)
    assert base.before is not None
    assert np.abs((data.y - base.before(data).output)[data.rows]).max() < 1e-6


@searched("input-saturation", "load-step")
def test_one_record_in_a_list_is_that_record() -> None:
    record = run_of(1, 0.0, samples=200)
    assert "records" not in diagnose([record]).report


def test_long_records_are_shortened_to_their_most_excited_parts() -> None:
    parts, notes = shorten_records(runs(), 600)
    assert [len(part) for part in parts] == [200, 200, 200]
    assert notes == ("The diagnosis uses 600 of the 1200 samples, at most 200 of each record.",)
    assert shorten_records(runs(), 1200)[1] == ()


def test_records_that_cannot_be_diagnosed_together() -> None:
    first, second, _ = runs()
    with pytest.raises(ValueError, match=r"run2 runs at 2 s, run1 at 0\.5 s"):
        diagnose([first, Record(4.0 * second.t, second.u, second.y, 2.0, name="run2")])
    with pytest.raises(ValueError, match="record 2 has 60 samples; a diagnosis needs at least 100"):
        diagnose([first, Record(second.t[:60], second.u[:60], second.y[:60], 0.5)])
    with pytest.raises(ValueError, match=r"u of run2 is constant \(2\)"):
        diagnose([first, Record(second.t, np.full(400, 2.0), second.y, 0.5, name="run2")])
    with pytest.raises(ValueError, match="each in turn is held out"):
        diagnose([first, second], holdout=first)
    with pytest.raises(ValueError, match="--exclude refers to the times of one record"):
        diagnose([first, second], exclude=[(0.0, 1.0)])
    with pytest.raises(ValueError, match="a simulated output belongs to one record"):
        diagnose([first, second], first.y)
    with pytest.raises(ValueError, match="there is no record"):
        diagnose([])


def test_the_command_refuses_a_simulated_output(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], write_rig_record: Callable[[Path, Record], Path]
) -> None:
    paths = [write_rig_record(tmp_path / f"{record.name}.csv", record) for record in runs()[:2]]
    series = tmp_path / "output.csv"
    series.write_text("t,y\n0,1\n")
    assert main(["gap", "diagnose", *map(str, paths), "--sim", str(series)]) == 2
    assert "a simulated output belongs to one record" in capsys.readouterr().err


def test_the_offset_of_a_model_of_several_records_is_their_mean() -> None:
    data = join_records(runs(noise=0.0)).data()
    model = export_model(data, fit_baseline(data, with_restarts(linear_structure(2), data)))
    record = run_of(9, 0.1, noise=0.0)
    assert model.offset_weight > 0.0
    assert rms(record.y - model.simulate(record.u, record.y)) < 0.01
