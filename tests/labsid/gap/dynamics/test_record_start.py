"""Which samples determine the initial state of another record, and what that leaves of the noise."""

import json
from pathlib import Path

import numpy as np
import pytest
from gap_search import searched
from scipy.signal import lfilter

from labsid.gap.diagnosis import diagnose
from labsid.gap.dynamics.plants import Plant
from labsid.gap.dynamics.record_start import LEAST_START, RecordStart
from labsid.gap.effects.input import Delay, RateLimit
from labsid.gap.fits.hypothesis import Hypothesis
from labsid.gap.model_file import ExportedModel, from_json_dict
from labsid.gap.record.data import Scale
from labsid.gap.reports.sentences import start_sentence
from labsid.gap.simulations.model_json import TransferFunction
from labsid.gap.simulations.simulation_files import replay
from labsid.records.record import Record

SLOW, FAST = 1 / 300, 1 / 4  # per sample
RATES = SLOW + FAST, SLOW * FAST
FEW = ("input-saturation", "slow-mode", "output-drift", "load-step")


@pytest.mark.parametrize(
    ("rates", "length", "count"),
    [
        (None, 5000, 50),
        (RATES, 5000, 600),
        (RATES, 1600, 400),
        (RATES, 150, 50),
        ((1.0, 0.16), 5000, 50),  # 1.25 and 5 samples
        ((0.01, 1.0), 5000, 400),  # a mode that decays in 200 samples
        ((0.5, 1e-12), 2000, 500),  # an integrator
    ],
)
def test_two_time_constants_at_least_fifty_samples_at_most_a_quarter(
    rates: tuple[float, float] | None, length: int, count: int
) -> None:
    assert RecordStart(rates).samples(length) == count


def test_a_state_that_the_first_samples_do_not_show_is_estimated_from_all() -> None:
    """Two poles of 400 samples: 50 samples hardly show the slope."""
    slow = RecordStart((2 / 400, 1 / 400**2))
    assert (slow.samples(200), slow.is_refitted(200), slow.used(200)) == (50, True, 200)
    assert (slow.is_refitted(4000), slow.used(4000)) == (False, slow.samples(4000))
    assert (RecordStart().is_refitted(200), RecordStart().used(30)) == (False, 30)


@pytest.mark.parametrize("time", [50.0, 200.0, 1000.0])
def test_the_estimate_of_the_state_adds_little_to_the_noise(time: float) -> None:
    """With 50 samples the error that it adds is larger than the noise for slow rigs."""
    rng, pole = np.random.default_rng(0), np.exp(-1 / time)
    u = np.repeat(rng.uniform(-1.0, 1.0, 40), round(6 * time / 40))
    y = lfilter([0.0, (1 - pole) ** 2], np.poly([pole, pole]), u, zi=[0.3, -0.29])[0]
    model = TransferFunction(np.array([(1 - pole) ** 2, 0.0]), np.poly([pole, pole]), 1.0, 0.0, 0.0)
    extra = []
    for _ in range(20):
        noisy = y + 0.01 * rng.standard_normal(u.size)
        extra.append((model.simulate(u, noisy) - y)[model.start.samples(u.size) :])
    assert np.sqrt(np.mean(np.square(extra))) < 0.1 * 0.01


def test_the_slowest_poles_are_those_of_all_dynamics() -> None:
    plant = Plant().modified(lag="behind", slow=True)
    own = {"log_c": np.log(0.7), "log_k": np.log(0.1), "log_lag": np.log(3.0), "log_slow": np.log(80.0)}
    theta = np.array([own[parameter.name] for parameter in plant.parameters])
    slow, fast = 1 / 80, 0.2
    assert plant.slowest_rates(theta, 5000) == pytest.approx((slow + fast, slow * fast))
    assert Plant().slowest_rates(np.log([0.01, 1.0]), 5000) == pytest.approx((0.01, 1.0))


@pytest.mark.parametrize(("effect", "own"), [(Delay(), 20.0), (RateLimit(), np.log(0.1))])
def test_the_input_before_the_record_is_unknown(effect: Delay | RateLimit, own: float) -> None:
    """What was under way in a delay, and where a slow actuator was, belongs to the initial state."""
    hypothesis = Hypothesis((effect,))
    theta = np.array([{"log_c": np.log(0.3), "log_k": np.log(0.02)}.get(p.name, 0.0) for p in hypothesis.parameters])
    theta[hypothesis.slices[effect.key]] = own
    gains = np.array([0.01, 0.01, 0.0, 0.0, 0.0, 0.1])
    rng = np.random.default_rng(3)
    u = np.repeat(rng.uniform(-2.0, 2.0, 60), 10)
    cut = 205
    measured = hypothesis.output(theta, gains, u, u.size, 0.0)[cut:]
    scales = Scale(0.0, 1.0), Scale(0.0, 1.0)
    model = ExportedModel(hypothesis, theta, gains, 1.0, 900, 0.0, *scales, start=RecordStart((0.3, 0.02)))
    error = (model.simulate(u[cut:], measured) - measured)[LEAST_START:]
    assert np.abs(error).max() < 1e-6 * np.std(measured)


def slow_rig(seed: int, samples: int, time: float = 80.0) -> Record:
    """Two equal poles, at some state at sample 0."""
    rng = np.random.default_rng(seed)
    u = np.repeat(rng.uniform(-1.0, 1.0, samples // 20 + 40), 20)
    pole = np.exp(-1 / time)
    y = lfilter([0.0, (1 - pole) ** 2], np.poly([pole, pole]), u)
    y = y + 0.02 * rng.standard_normal(y.size)
    return Record(0.1 * np.arange(samples), u[-samples:], y[-samples:], 0.1)


@searched(*FEW)
def test_the_report_the_export_and_a_simulation_of_the_holdout_agree(tmp_path: Path) -> None:
    holdout = slow_rig(2, 1000)
    found = diagnose(slow_rig(1, 1200), holdout=holdout)
    report = found.report
    count = report["holdout_unscored"]
    assert 170 < count <= 250
    assert report["holdout_state"] == "estimated"
    assert report["gap"]["holdout"] == [[pytest.approx(0.1 * count), pytest.approx(100.0)]]
    assert report["gap"]["after"] < 1.1 * report["gap"]["noise_floor"]
    assert f"The first {count} samples of the holdout" in str(start_sentence(report))
    assert f"The first {count} samples of the holdout" in " ".join(str(found).split())
    path = tmp_path / "better.json"
    path.write_text(json.dumps(found.model.to_json_dict()))
    played = replay(path, holdout)
    assert played.start == count
    assert played.rmse == pytest.approx(report["gap"]["after"])


@searched(*FEW)
def test_a_short_holdout_of_a_slow_rig_is_scored_beside_a_free_state(tmp_path: Path) -> None:
    holdout = slow_rig(4, 150, 300.0)
    found = diagnose(slow_rig(3, 3000, 300.0), holdout=holdout)
    assert (found.report["holdout_unscored"], found.report["holdout_state"]) == (50, "refitted")
    assert "beside a free initial state" in " ".join(str(found).split())
    e = holdout.y - found.model.simulate(holdout.u, holdout.y)
    assert np.sqrt(np.mean(e[50:] ** 2)) == pytest.approx(found.report["gap"]["after"])


@searched(*FEW)
def test_a_holdout_with_fewer_scored_samples_than_parts_is_scored() -> None:
    found = diagnose(slow_rig(1, 1200, 5.0), holdout=slow_rig(2, 60, 5.0))
    assert found.report["holdout_unscored"] == 50
    assert all(np.isfinite(error) for error in found.report["simulation"]["model"]["errors"].values())


def test_files_without_rates_use_fifty_samples() -> None:
    model = ExportedModel(
        Hypothesis(),
        np.zeros(3),
        np.zeros(6),
        1.0,
        900,
        0.0,
        Scale(0.0, 1.0),
        Scale(0.0, 1.0),
        start=RecordStart(RATES),
    )
    written = model.to_json_dict()
    assert from_json_dict(written).start == RecordStart(RATES)
    del written["start_rates"]
    assert from_json_dict(written).start == RecordStart()
    for wrong in ([1.0], [1.0, -1.0], "x", [np.nan, 1.0]):
        with pytest.raises(ValueError, match="not an exported simulation"):
            from_json_dict(written | {"start_rates": wrong})
