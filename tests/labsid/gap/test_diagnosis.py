"""From a record to the report: simulated rigs with known effect and parameters; the layout of the report."""

import json
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from gap_search import searched
from representatives import mostly_exhaustive
from scipy.integrate import solve_ivp
from scipy.signal import cont2discrete, lfilter
from threadpoolctl import threadpool_info, threadpool_limits

from labsid._arrays import FloatArray
from labsid.gap.diagnosis import Diagnosis, diagnose
from labsid.gap.reports.quantities import with_units
from labsid.records.record import Record

pytestmark = pytest.mark.usefixtures("without_limits")

TS, SAMPLES, NOISE = 0.5, 480, 0.01
Response = Callable[..., FloatArray]
FEW = ("input-saturation", "input-dead-zone", "extra-lag", "output-saturation", "load-step")


def record_of(u: FloatArray, y: FloatArray, name: str) -> Record:
    """Signals from time 10 on."""
    return Record(10.0 + TS * np.arange(u.size), u, y, TS, name=name)


@pytest.fixture(scope="module")
def u() -> FloatArray:
    """Levels between 1.5 and 4.5 that are held for 4 to 16 samples, the first one, 3, for 20."""
    rng = np.random.default_rng(21)
    blocks = [np.full(20, 3.0)]
    while sum(block.size for block in blocks) < SAMPLES:
        blocks.append(np.full(rng.integers(4, 17), rng.uniform(1.5, 4.5)))
    return np.concatenate(blocks)[:SAMPLES]


@pytest.fixture(scope="module")
def diagnosed(u: FloatArray, two_poles: Response) -> Callable[[str], tuple[Diagnosis, Record]]:
    """The diagnosis of a simulated record, each made once."""
    done: dict[str, tuple[Diagnosis, Record]] = {}

    def signal(name: str) -> FloatArray:
        if name == "input-dead-zone":
            return 10.0 + two_poles(np.maximum(u - 3.3, 0.0) + np.minimum(u - 2.6, 0.0))
        if name == "input-saturation":
            return 10.0 + two_poles(np.minimum(u, 3.8))
        if name == "input-delay":
            return 10.0 + two_poles(np.concatenate([np.full(3, u[0]), u[:-3]]))
        if name == "sqrt-outflow":
            return torricelli(u)
        if name == "load-step":
            load = two_poles((np.arange(SAMPLES) >= 260).astype(float))
            return 10.0 + two_poles(u) - 0.4 * load
        if name == "output-drift":
            along = np.linspace(-1.0, 1.0, SAMPLES)
            return 10.0 + two_poles(u) + 0.3 * along - 0.2 * along**2
        return 10.0 + two_poles(u)

    def diagnosis(name: str) -> tuple[Diagnosis, Record]:
        if name not in done:
            y = signal(name) + NOISE * np.random.default_rng(7).standard_normal(SAMPLES)
            if name == "output-quantization":
                y = np.round(y / 0.1) * 0.1
            record = record_of(u, y, name)
            done[name] = (diagnose(record), record)
        return done[name]

    return diagnosis


def torricelli(u: FloatArray) -> FloatArray:
    """Lower level of two tanks whose outflow goes with the root; u = 1 is no flow."""

    def filling(t: float, h: FloatArray, flow: float) -> list[float]:
        upper, lower = np.sqrt(np.maximum(h, 0.0))
        return [0.9 * (flow - upper), 0.5 * (upper - lower)]

    state = np.full(2, (u[0] - 1.0) ** 2)
    levels = []
    for value in u:
        levels.append(state[1])
        state = solve_ivp(filling, (0.0, 1.0), state, args=(value - 1.0,), rtol=1e-8).y[:, -1]
    return np.array(levels)


def numbers(report: dict[str, Any]) -> dict[str, dict[str, Any]]:
    """The parameters of the first effect."""
    parameters: dict[str, dict[str, Any]] = report["effects"][0]["parameters"]
    return parameters


EXPECTED = {
    "input-dead-zone": {"low": (2.6, "u"), "high": (3.3, "u")},
    "input-saturation": {"high": (3.8, "u")},
    "input-delay": {"delay": (3 * TS, "s")},
    "sqrt-outflow": {"zero": (1.0, "u")},
    "load-step": {"onset": (10.0 + 260 * TS, "s"), "size": (-0.4, "y")},
    "output-drift": {"amplitude": (0.3, "y")},
    "output-quantization": {"step": (0.1, "y")},
}
# What a number may be off beyond four standard errors: half a sample for the nuisance delay, one for an onset, and
# what the wander of a polynomial or the zero of a root leaves open.
SLACK = {"delay": 0.5 * TS, "onset": TS, "zero": 0.2, "amplitude": 0.03, "step": 1e-9, "size": 0.01}


ONE_OF_EACH_PATH = ("input-dead-zone", "input-saturation", "load-step", "output-drift", "output-quantization")
"""Diagnosed everywhere, and a record without an effect. The square-root outflow is named in the README's diagnosis, a
delay in the hair dryer and in `test_invariance.py`."""


@pytest.mark.parametrize("name", mostly_exhaustive(EXPECTED, ONE_OF_EACH_PATH))
def test_effects_and_parameters_are_recovered(diagnosed: Callable[[str], tuple[Diagnosis, Record]], name: str) -> None:
    report = diagnosed(name)[0].report
    assert report["verdict"] == "effect"
    assert [effect["name"] for effect in report["effects"]] == [name]
    assert report["effects"][0]["probability"] > 0.8
    for parameter, (value, unit) in EXPECTED[name].items():
        found = numbers(report)[parameter]
        assert found["unit"] == unit
        assert abs(found["value"] - value) < 4.0 * found["stderr"] + SLACK.get(parameter, 0.0), (parameter, found)
        assert found["stderr"] < 0.25 * max(abs(value), 1.0)


def test_a_record_without_an_effect_gets_none(diagnosed: Callable[[str], tuple[Diagnosis, Record]]) -> None:
    report = diagnosed("none")[0].report
    assert report["verdict"] == report["where"]["path"] == "none"
    assert report["effects"] == report["ambiguous"] == []
    assert report["next_experiment"] is None
    assert report["gap"]["after"] == pytest.approx(NOISE, rel=0.25)


@pytest.mark.parametrize(
    "name",
    mostly_exhaustive([name for name in EXPECTED if name != "output-quantization"], ONE_OF_EACH_PATH[:-1]),
)
def test_the_gap_closes_to_the_noise_floor(diagnosed: Callable[[str], tuple[Diagnosis, Record]], name: str) -> None:
    gap = diagnosed(name)[0].report["gap"]
    assert gap["before"] > 1.5 * gap["after"]
    assert gap["noise_floor"] == pytest.approx(NOISE, rel=0.3)
    assert gap["closed"] > 0.8
    low, high = gap["ci95"]
    assert low <= gap["closed"] <= high <= 1.0


@pytest.mark.parametrize("name", ["none", "output-quantization"])
def test_no_closure_is_reported_for_none_and_quantization(
    diagnosed: Callable[[str], tuple[Diagnosis, Record]], name: str
) -> None:
    report = diagnosed(name)[0].report
    gap = report["gap"]
    assert gap["closed"] is gap["ci95"] is None
    assert gap["after"] == gap["before"]
    assert [effect["closed"] for effect in report["effects"]] == [None] * len(report["effects"])


def test_a_time_segment_starts_at_the_onset_of_a_load(diagnosed: Callable[[str], tuple[Diagnosis, Record]]) -> None:
    report, record = diagnosed("load-step")[0].report, diagnosed("load-step")[1]
    onset = numbers(report)["onset"]["value"]
    starts = [start for start, _, _ in report["where"]["time"]]
    assert min(abs(start - onset) for start in starts) <= TS
    assert starts[0] == record.t[0]


def number(value: object) -> bool:
    return isinstance(value, float) and np.isfinite(value)


def check_layout(report: dict[str, Any], samples: int) -> None:
    """Check the layout of a report, key by key."""
    assert report["schema"] == "labsid.gap/4"
    assert report["verdict"] in ("none", "effect", "partial", "unknown")
    told = [*(finding["text"] for finding in report["record_findings"]), *report["screen"]]
    assert [finding["text"] for finding in report["findings"]] == told
    assert all(set(finding) == {"kind", "signal", "text"} for finding in report["findings"])
    assert bool(report["effects"]) == (report["verdict"] in ("effect", "partial"))
    for effect in report["effects"]:
        assert {"name", "path", "parameters", "probability", "closed"} <= set(effect)
        assert isinstance(effect["name"], str)
        assert effect["path"] in ("input", "dynamics", "output", "disturbance", "parameters")
        assert number(effect["probability"])
        assert 0.0 <= effect["probability"] <= 1.0
        assert effect["closed"] is None or (number(effect["closed"]) and effect["closed"] <= 1.0)
        for parameter in effect["parameters"].values():
            assert set(parameter) == {"value", "stderr", "unit"}
            assert number(parameter["value"])
            assert number(parameter["stderr"])
            assert parameter["stderr"] >= 0.0
            assert isinstance(parameter["unit"], str)
    assert len(report["ambiguous"]) <= 3
    assert all(isinstance(name, str) for name in report["ambiguous"])
    assert not set(report["ambiguous"]) & {effect["name"] for effect in report["effects"]}
    assert report["ranking"]
    for row in report["ranking"]:
        assert {"name", "probability", "rmse", "closed"} <= set(row)
        assert number(row["probability"])
        assert number(row["rmse"])
        assert row["closed"] is None or (number(row["closed"]) and row["closed"] <= 1.0)
    probabilities = [row["probability"] for row in report["ranking"]]
    assert probabilities == sorted(probabilities, reverse=True)
    where = report["where"]
    assert set(where) >= {"path", "time", "band_hz", "operating"}
    expected = report["effects"][0]["path"] if report["effects"] else report["verdict"]
    assert where["path"] == expected
    for shares in (where["time"], where["band_hz"]):
        assert all(len(row) == 3 and all(map(number, row)) and row[0] < row[1] for row in shares)
        assert sum(row[2] for row in shares) == pytest.approx(1.0)
    assert sum(cell["share"] for cell in where["operating"]) == pytest.approx(1.0)
    for cell in where["operating"]:
        assert set(cell) >= {"signal", "low", "high", "share"}
        assert cell["signal"] in ("u", "y", "dy")
        assert cell["low"] <= cell["high"]
    gap = report["gap"]
    assert {"before", "after", "noise_floor", "closed", "ci95", "holdout"} <= set(gap)
    assert all(number(gap[key]) and gap[key] >= 0.0 for key in ("before", "after", "noise_floor"))
    assert (gap["closed"] is None) == (gap["ci95"] is None)
    if gap["closed"] is not None:
        assert number(gap["closed"])
        assert gap["closed"] <= 1.0
        assert len(gap["ci95"]) == 2
        assert gap["ci95"][0] <= gap["ci95"][1]
    assert sum(stop - start for start, stop in gap["holdout"]) >= 0.3 * samples * TS
    unexplained = report["unexplained"]
    assert {"share", "whiteness_p", "input_correlation_p"} <= set(unexplained)
    assert all(0.0 <= unexplained[key] <= 1.0 for key in ("share", "whiteness_p", "input_correlation_p"))
    kinds = unexplained["kinds"]
    assert (kinds is None) == (unexplained["path"] is None)
    assert kinds is None or report["verdict"] != "none"
    if kinds is not None:
        assert list(kinds) == ["linear", "input", "output", "nonlinear", "time", "disturbance"]
        assert sum(kinds.values()) == pytest.approx(1.0)
        assert all(number(share) and share >= 0.0 for share in kinds.values())
        assert unexplained["path"] in ("input", "dynamics", "output", "time", "disturbance")
    model = report["simulation"]["model"]
    assert (model is None) == report["simulation"]["given"]
    assert model is None or set(model) == {"method", "observed", "errors"}
    following = report["next_experiment"]
    if following is not None:
        assert {"separates", "why", "t", "u", "margin"} <= set(following)
        assert len(following["separates"]) >= 2
        assert len(following["t"]) == len(following["u"])
        assert number(following["margin"])


@pytest.mark.parametrize("name", mostly_exhaustive([*EXPECTED, "none"], [*ONE_OF_EACH_PATH, "none"]))
def test_the_report_has_the_documented_layout(diagnosed: Callable[[str], tuple[Diagnosis, Record]], name: str) -> None:
    report = diagnosed(name)[0].report
    check_layout(json.loads(json.dumps(report, allow_nan=False)), SAMPLES)
    check_layout(report, SAMPLES)


def test_the_exported_model_reproduces_the_reported_error(diagnosed: Callable[[str], tuple[Diagnosis, Record]]) -> None:
    found, record = diagnosed("input-saturation")
    error = record.y - found.model.simulate(record.u, record.y)
    assert np.sqrt(np.mean(error[50:] ** 2)) == pytest.approx(NOISE, rel=0.25)


@searched(*FEW)
def test_excluded_stretches_are_neither_fitted_nor_scored(u: FloatArray, two_poles: Response) -> None:
    """40 faulty samples are excluded: no effect is found, and no held-out block overlaps them."""
    y = 10.0 + two_poles(u) + NOISE * np.random.default_rng(7).standard_normal(SAMPLES)
    y[200:240] += 3.0
    start, stop = 10.0 + 200 * TS, 10.0 + 240 * TS
    report = diagnose(record_of(u, y, "spoilt"), exclude=[(start, stop)]).report
    assert report["verdict"] == "none"
    assert all(b <= start or a >= stop for a, b in report["gap"]["holdout"])


def test_records_that_cannot_be_diagnosed_are_rejected(u: FloatArray, two_poles: Response) -> None:
    y = 10.0 + two_poles(u)
    with pytest.raises(ValueError, match="the record has 40 samples; a diagnosis needs at least 100"):
        diagnose(record_of(u[:40], y[:40], ""))
    with pytest.raises(ValueError, match=r"u of the record is constant \(3\)"):
        diagnose(record_of(np.full(SAMPLES, 3.0), y, ""))
    with pytest.raises(ValueError, match=r"y of the record is constant \(1\)"):
        diagnose(record_of(u, np.ones(SAMPLES), ""))
    with pytest.raises(ValueError, match="the holdout has 50 samples; it needs at least"):
        diagnose(record_of(u, y, ""), holdout=record_of(u[:50], y[:50], ""))
    with pytest.raises(ValueError, match=r"the range of u of the record must be between 1e-50 and 1e\+50; got .*e-200"):
        diagnose(record_of(u * 1e-200, y, ""))
    with pytest.raises(
        ValueError, match=r"the range of y of the record must be between .*e\+6.\. Give it in another unit"
    ):
        diagnose(record_of(u, y * 1e60, ""))
    with pytest.raises(ValueError, match="the sampling time of the record must be between 1e-50 and"):
        diagnose(Record(np.arange(SAMPLES) * 1e-60, u, y, 1e-60))
    slower = Record(np.arange(SAMPLES) * 2.0, u, y, 2.0)
    with pytest.raises(ValueError, match=r"the holdout runs at 2 s, the record at 0.5 s\. Resample one of them"):
        diagnose(record_of(u, y, ""), holdout=slower)
    with pytest.raises(ValueError, match="--exclude leaves 20 samples; at least 100 are needed"):
        diagnose(record_of(u, y, ""), exclude=[(20.0, 1e9)])


@searched(*FEW)
def test_a_record_that_is_given_twice_is_said(u: FloatArray, two_poles: Response) -> None:
    y = 10.0 + two_poles(u) + NOISE * np.random.default_rng(1).standard_normal(SAMPLES)
    one = record_of(u, y, "run")
    for found, text in (
        (diagnose(one, holdout=one), "the holdout holds the samples of the record: "),
        (diagnose([one, one]), "the record run (2) holds the samples of the record run (1): "),
    ):
        (finding,) = (one for one in found.report["record_findings"] if one["topic"] == "samples")
        assert finding["text"].startswith(text)


def blas_threads() -> set[int]:
    return {int(pool["num_threads"]) for pool in threadpool_info() if pool["user_api"] == "blas"}


def test_blas_uses_one_thread_and_as_many_as_before_afterwards(u: FloatArray, two_poles: Response) -> None:
    during = []

    def stop(step: str, share: float) -> None:
        during.append(blas_threads())
        raise RuntimeError(step)

    with threadpool_limits(2, "blas"):
        before = blas_threads()
        with pytest.raises(RuntimeError):
            diagnose(record_of(u, two_poles(u), "any"), progress=stop)
        assert blas_threads() == before
    assert during == [{1}]
    assert before == {2}


@searched(*FEW)
@pytest.mark.parametrize(
    ("limit", "named"), [pytest.param(np.inf, [], marks=pytest.mark.exhaustive), (0.5, ["input-saturation"])]
)
def test_a_rig_that_responds_within_the_sample(limit: float, named: list[str]) -> None:
    """The acceleration of a mass on a spring, which the force changes at once."""
    rng = np.random.default_rng(7)
    u = np.repeat(rng.uniform(-1.0, 1.0, SAMPLES // 10), 10)
    num, den, _ = cont2discrete(([1.0, 0.0, 0.0], [1.0, 0.1, 0.2]), 1.0)
    y = lfilter(num[0], den, np.clip(u, -limit, limit)) + NOISE * rng.standard_normal(u.size)
    found = diagnose(record_of(u, y, "acceleration"))
    assert [effect["name"] for effect in found.report["effects"]] == named
    assert found.report["verdict"] == ("effect" if named else "none")
    assert found.report["gap"]["after"] < 1.1 * NOISE
    assert "direct feedthrough" in found.report["screen"][0]
    model = {"num": num[0].tolist(), "den": den.tolist(), "dt": TS, "u0": 0.0, "y0": 0.0}
    given = diagnose(record_of(u, y, "acceleration"), model).report
    again = diagnose(record_of(u, y, "acceleration"), found.model.to_json_dict()).report
    assert [effect["name"] for effect in given["effects"]] == named
    assert given["gap"]["after"] < 1.1 * NOISE
    assert again["verdict"] == "none"


@pytest.mark.exhaustive  # `test_baseline_choice.py` diagnoses such a rig, with its noise
@pytest.mark.parametrize("poles", [[1.0, -1.8, 0.8], [1.0, -1.0]])
def test_a_rig_that_integrates_its_input_has_no_gap(u: FloatArray, poles: list[float]) -> None:
    x = lfilter([0.0, 0.1], poles, u - u.mean())
    noise = NOISE * x.std() * np.random.default_rng(7).standard_normal(SAMPLES)
    report = diagnose(record_of(u, x + noise, "position")).report
    assert report["verdict"] == "none"
    assert report["gap"]["before"] == pytest.approx(noise.std(), rel=0.1)


@searched(*FEW)
def test_the_units_of_the_record_are_those_of_the_report_until_others_are_given(u, two_poles) -> None:
    y = 10.0 + two_poles(np.minimum(u, 3.8))
    y = y + 0.01 * np.random.default_rng(3).standard_normal(y.size)
    record = Record(np.arange(200.0), u[:200], y[:200], 1.0, units=("V", "mm"))
    report = diagnose(record).report
    assert report["units"] == {"u": "V", "y": "mm"}
    (effect,) = report["effects"]
    assert effect["parameters"]["high"] | {"value": 0.0, "stderr": 0.0} == {
        "value": 0.0,
        "stderr": 0.0,
        "unit": "V",
        "of": "u",
    }
    other = with_units(report, "A", "cm")
    assert other["units"] == {"u": "A", "y": "cm"}
    high = other["effects"][0]["parameters"]["high"]
    assert (high["unit"], high["of"]) == ("A", "u")
