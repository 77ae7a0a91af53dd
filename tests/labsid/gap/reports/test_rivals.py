"""What two explanations respond to a proposed input: as the fitted simulations do."""

import numpy as np
from gap_reports import report, with_experiment

from labsid.gap.effects.families import EFFECTS_BY_KEY
from labsid.gap.fits.hypothesis import Hypothesis
from labsid.gap.reports.rivals import rival_responses

U_SCALE, Y_SCALE = {"centre": 1.0, "unit": 2.0}, {"centre": -1.0, "unit": 0.5}
KEYS = {"input-delay": "input-delay", "extra-lag": "extra-lag"}


def _fit(name: str) -> dict:
    hypothesis = Hypothesis((EFFECTS_BY_KEY[KEYS[name]],))
    theta = np.array([parameter.start for parameter in hypothesis.parameters])
    columns = hypothesis.design(theta, np.linspace(0.0, 1.0, 50)).columns.shape[1]
    gains = np.linspace(0.2, 0.4, columns)
    return {
        "names": [name],
        "effects": [KEYS[name]],
        "theta": theta.tolist(),
        "gains": gains.tolist(),
        "span": 50,
        "reference": 0.0,
        "constant": None,
        "simulated": True,
    }


def _replayed() -> dict:
    base = with_experiment(report("input-delay", probability=0.58))
    base["next_experiment"]["separates"] = ["input-delay", "extra-lag"]
    fits = [_fit(name) for name in KEYS]
    return base | {"replay": {"u_scale": U_SCALE, "y_scale": Y_SCALE, "combinations": fits}}


def test_the_responses_are_those_of_the_fits():
    base = _replayed()
    found = rival_responses(base)
    assert list(found) == ["a transport delay", "an extra lag"]
    u = (np.array(base["next_experiment"]["u"]) - 1.0) / 2.0
    one = base["replay"]["combinations"][1]
    hypothesis = Hypothesis((EFFECTS_BY_KEY["extra-lag"],))
    y = hypothesis.output(np.array(one["theta"]), np.array(one["gains"]), u, 50, 0.0)
    np.testing.assert_allclose(found["an extra lag"], -1.0 + 0.5 * y)


def test_without_both_fits_there_are_no_responses():
    assert rival_responses(report("input-delay")) == {}
    base = _replayed()
    base["replay"]["combinations"][0]["simulated"] = False
    assert rival_responses(base) == {}
    base["replay"]["combinations"].pop(0)
    assert rival_responses(base) == {}
