"""A record without a gap, and a holdout that the simulation of it does not fit."""

from typing import Any

import numpy as np
import pytest
from gap_search import searched
from representatives import mostly_exhaustive
from scipy.signal import lfilter

from labsid._arrays import FloatArray
from labsid.gap.diagnosis import Diagnosis, diagnose
from labsid.gap.reports.html_report import page_content, render_html
from labsid.gap.reports.sentences import headline, look_sentence
from labsid.records.record import Record

pytestmark = pytest.mark.usefixtures("without_limits")

NOISE = 0.01
BEFORE = 400  # samples, in which the rig moves before a record
TIMES = (8.0, 20.0)  # samples
FEW = ("load-step", "output-drift", "output-nonlinearity")


def made(
    seed: int,
    samples: int = 600,
    gain: float = 1.0,
    offset: float = 0.0,
    times: tuple[float, float] = TIMES,
    noise: float = NOISE,
    hold: int = 15,
    size: float = 1.0,
    colour: float = 0.0,
) -> Record:
    """Two poles, random levels of the input."""
    rng = np.random.default_rng(seed)
    count = samples + BEFORE
    u = size * np.repeat(rng.uniform(-1.0, 1.0, count // hold + 1), hold)[:count]
    poles = np.exp(-1.0 / np.array(times))
    e = lfilter([np.sqrt(1.0 - colour**2)], [1.0, -colour], rng.standard_normal(count))
    y = gain * lfilter([0.0, np.prod(1.0 - poles)], np.poly(poles), u) + offset + noise * e
    return Record(0.1 * np.arange(samples), u[BEFORE:], y[BEFORE:], 0.1)


OTHER_RIGS: dict[str, dict[str, Any]] = {
    "another gain": {"gain": 1.3},
    "an offset": {"offset": 0.3},
    "other dynamics": {"times": (16.0, 20.0)},
}


@pytest.fixture(scope="module", params=mostly_exhaustive(OTHER_RIGS, ["an offset", "other dynamics"]))
def other_rig(request: pytest.FixtureRequest) -> tuple[str, Diagnosis]:
    """By name, the diagnosis of a rig with a holdout of one that differs."""
    with searched("parameter-drift", "extra-lag", *FEW):
        return request.param, diagnose(made(1), holdout=made(2, **OTHER_RIGS[request.param]))


def test_the_holdout_has_a_gap_that_no_effect_explains(other_rig: tuple[str, Diagnosis]) -> None:
    report = other_rig[1].report
    gap, only = report["gap"], report["only_on_holdout"]
    assert (report["verdict"], report["effects"]) == ("unknown", [])
    assert gap["noise_floor"] == pytest.approx(NOISE, rel=0.1)
    assert gap["before"] > 3.0 * NOISE
    assert only["on_record"] == pytest.approx(NOISE, rel=0.1)
    assert report["explanation"]["confidence"] > 0.5  # of the record, that nothing acts


@pytest.mark.usefixtures("undrawn")
def test_every_report_says_so_first(other_rig: tuple[str, Diagnosis]) -> None:
    found = other_rig[1]
    said = headline(found.report)
    assert said.startswith("The record shows no gap beyond noise, the holdout does: the rms error")
    assert "no gap beyond noise, the holdout does" in " ".join(str(found).split())[:80]
    page = render_html(found.report)
    assert said.split(":")[0] in page
    assert "There is no gap" not in page + str(found)
    assert "differed between the record and the holdout" in str(look_sentence(found.report))


def test_what_is_left_and_where_are_those_of_the_holdout(other_rig: tuple[str, Diagnosis]) -> None:
    kind, found = other_rig
    report = found.report
    left, where = report["unexplained"], report["where"]
    assert left["whiteness_p"] < 0.01
    assert (left["input_correlation_p"] < 0.01) == (kind != "an offset")
    assert left["path"] == {"an offset": None}.get(kind, "dynamics")
    first, last = where["time"][0][0], where["time"][-1][1]
    assert (first, last) == (pytest.approx(0.1 * report["holdout_unscored"]), pytest.approx(60.0))
    assert sum(share for *_, share in where["time"]) == pytest.approx(1.0)
    assert "These are the errors on the holdout." in page_content(report)["residual"]
    assert not any("of the record" in text for text in page_content(report)["where"])


def test_an_offset_is_called_one(other_rig: tuple[str, Diagnosis]) -> None:
    kind, found = other_rig
    offset = found.report["only_on_holdout"]["offset"]
    assert (abs(offset - 0.3) < 0.03) == (kind == "an offset")
    assert ("is an offset of 0." in headline(found.report)) == (kind == "an offset")


@searched(*FEW)
@pytest.mark.parametrize("kind", mostly_exhaustive(OTHER_RIGS, ["other dynamics"]))
def test_a_given_simulation_is_judged_alike(kind: str) -> None:
    poles = np.exp(-1.0 / np.array(TIMES))
    model = {"num": [float(np.prod(1.0 - poles)), 0.0], "den": np.poly(poles).tolist(), "dt": 0.1}
    report = diagnose(made(1), model, holdout=made(2, **OTHER_RIGS[kind])).report
    assert report["verdict"] == "unknown"
    assert "of your simulation is" in headline(report)


@searched(*FEW)
@pytest.mark.parametrize(
    ("record", "holdout"),
    [
        ({}, {}),
        ({}, {"hold": 4}),
        pytest.param({}, {"size": 3.0}, marks=pytest.mark.exhaustive),
        ({}, {"samples": 90}),
        pytest.param({"noise": 0.1, "samples": 250}, {"noise": 0.1}, marks=pytest.mark.exhaustive),
        ({"noise": 0.05, "colour": 0.8}, {"noise": 0.05, "colour": 0.8}),
    ],
    ids=["alike", "faster", "larger", "short", "noisy", "coloured noise"],
)
def test_another_run_of_the_same_rig_has_no_gap(record: dict[str, Any], holdout: dict[str, Any]) -> None:
    found = diagnose(made(5, **record), holdout=made(6, **holdout))
    assert found.verdict == "none"
    assert "only_on_holdout" not in found.report
    assert str(found).startswith("There is no gap beyond noise")


@searched(*FEW)
def test_an_error_that_noise_reaches_by_chance_is_said_to() -> None:
    report = diagnose(made(5, noise=0.1), holdout=made(6, noise=0.1)).report
    gap: FloatArray = report["gap"]
    said = headline(report | {"gap": gap | {"before": 0.2, "noise_floor": 0.1}})
    assert said.endswith("is 0.200 on the holdout, which noise of 0.100 reaches by chance.")
