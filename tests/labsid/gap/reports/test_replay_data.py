"""What a page replays: a fit without what only another program can simulate, and without what joins several records."""

import pickle
from dataclasses import replace

import numpy as np
import pytest

from labsid._arrays import FloatArray
from labsid.gap.dynamics.given_simulation import GivenSimulation
from labsid.gap.dynamics.plants import Plant
from labsid.gap.effects.families import EFFECTS_BY_KEY
from labsid.gap.effects.restarts import Restarts, in_records
from labsid.gap.fits.fitting import Fit
from labsid.gap.fits.hypothesis import Hypothesis
from labsid.gap.fits.noise_model import Noise
from labsid.gap.record.data import Data, scaled
from labsid.gap.reports.replay_data import PlayedPart, ReplayData, played_part

SAMPLES = 300
RNG = np.random.default_rng(7)
LEVELS = np.repeat(RNG.uniform(-2.0, 2.0, SAMPLES // 10), 10)
RECORD = scaled(LEVELS, RNG.standard_normal(SAMPLES), np.ones(SAMPLES, bool), 0.5)
ADDED = tuple(EFFECTS_BY_KEY[key] for key in ("load-step", "output-drift/3", "output-saturation/high"))


def fit_of(data: Data, hypothesis: Hypothesis) -> Fit:
    """A fit with parameters of which every effect acts."""
    acting = {"onset": 0.4, "high": 0.6, "log_c": np.log(0.5), "log_k": np.log(0.05)}
    theta = np.array([acting.get(one.name, one.start) for one in hypothesis.parameters])
    gains = np.random.default_rng(2).uniform(0.1, 0.3, hypothesis.design(theta, data.u).columns.shape[1])
    noise = Noise(np.zeros(0), 1.0, 0.0, SAMPLES)
    return Fit(hypothesis, theta, gains, hypothesis.output(theta, gains, data.u), 1.0, noise, 0.0)


def replayed(played: PlayedPart, simulated: bool) -> FloatArray:
    """The output as a page makes it."""
    hypothesis = Hypothesis(played.effects)
    design = hypothesis.design(played.theta, RECORD.u)
    first = 0 if simulated else design.parts[0].shape[1]
    columns = design.columns[:, first:]
    sensed = design.n_sensed - first
    z = columns[:, :sensed] @ played.gains[:sensed] + (0.0 if played.constant is None else played.constant)
    z = z + columns[:, sensed:] @ played.gains[sensed:]
    for effect in hypothesis.outputs:
        z = effect.apply(z, played.theta[hypothesis.slices[effect.key]])
    return z


def test_a_fit_of_one_record_is_replayed_whole() -> None:
    fit = fit_of(RECORD, Hypothesis(ADDED))
    played = played_part(RECORD, fit)
    assert played.constant is None
    assert played.theta == pytest.approx(fit.theta)
    assert played.gains == pytest.approx(fit.gains)
    assert replayed(played, simulated=True) == pytest.approx(fit.output)


def test_the_output_of_a_given_simulation_is_a_constant() -> None:
    """And what acts on its input is in it."""
    simulation = GivenSimulation(lambda w, numbers: np.cumsum(w), (0.4, 0.03), takes_input=True)
    given = Plant(kind="given", simulation=simulation)
    before = (EFFECTS_BY_KEY["input-backlash"], EFFECTS_BY_KEY["extra-lag"])
    fit = fit_of(RECORD, Hypothesis((*before, *ADDED), given=given))
    played = played_part(RECORD, fit)
    assert played.effects == ADDED
    assert replayed(played, simulated=False) == pytest.approx(fit.output)
    own = Hypothesis(played.effects)
    old = fit.hypothesis.slices["load-step"]
    assert played.theta_from[own.slices["load-step"]].tolist() == list(range(old.start, old.stop))
    assert set(played.theta_from[own.slices["plant"]]) == {-1}


def test_what_joins_several_records_is_a_constant() -> None:
    """Their offsets and initial states; what is found keeps its place among the gains."""
    restarts = Restarts(records=((100, 180), (200, 300)))
    fit = fit_of(RECORD, Hypothesis((restarts, *ADDED), 1))
    played = played_part(RECORD, fit)
    assert played.effects == ADDED
    assert played.gains.size == fit.gains.size - restarts.width
    assert played.constant is not None
    assert np.all(played.constant[:100] == 0.0)
    assert replayed(played, simulated=True) == pytest.approx(fit.output)


def test_play_that_starts_anew_in_each_record_is_that_of_the_first_one_and_a_constant() -> None:
    """In front of linear dynamics: the page knows one record."""
    records = ((100, 180), (200, 300))
    backlash = EFFECTS_BY_KEY["input-backlash"]
    fit = fit_of(RECORD, Hypothesis((Restarts(records=records), in_records(backlash, records), *ADDED), 1))
    theta = fit.theta.copy()
    theta[fit.hypothesis.slices["input-backlash"]] = 1.5, 0.1, 0.9, 0.2
    fit = replace(fit, theta=theta, output=fit.hypothesis.output(theta, fit.gains, RECORD.u))
    played = played_part(RECORD, fit)
    assert played.effects == (backlash, *ADDED)
    assert played.theta[Hypothesis(played.effects).slices["input-backlash"]] == pytest.approx([1.5, 0.1])
    assert replayed(played, simulated=True) == pytest.approx(fit.output)


def test_replay_data_are_made_once_and_pickled_as_made() -> None:
    """A process that gets them back has no fits of which to make them."""
    made = []

    def make() -> dict[str, int]:
        made.append(1)
        return {"combinations": len(made)}

    data = ReplayData(make)
    assert pickle.loads(pickle.dumps(data))() == data() == {"combinations": 1}
    assert made == [1]
    assert ReplayData(None)() is None
