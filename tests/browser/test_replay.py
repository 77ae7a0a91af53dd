"""Exported simulations in a browser and in Python: every effect that the diagnosis can add."""

from typing import TYPE_CHECKING, Any

import numpy as np
import pytest

from labsid.gap.effects.families import EFFECTS_BY_KEY
from labsid.gap.fits.hypothesis import Hypothesis
from labsid.gap.reports.javascript.models import script, structure

if TYPE_CHECKING:
    from playwright.sync_api import BrowserContext

REFERENCE = 0.2
TYPICAL = {
    "cycles": 7.3,
    "friction": 0.2,
    "brim": 0.7,
    "brim2": 0.9,
    "zero": -3.0,
    "delay": 2.3,
    "onset": 0.41,
    "log_lag": 1.0,
    "log_frequency": -0.7,
    "log_damping": -2.3,
    "log_slow": 3.0,
    "log_rate": -1.0,
    "low": -0.7,
    "high": 0.8,
    "stop_low": -0.5,
    "stop_high": 0.6,
    "position": 0.3,
    "width": 0.4,
    "share": 0.5,
    "peak": 0.3,
    "log_decay": -2.0,
    "log_smooth": -2.0,
    "cubic": 0.3,
    "drag": 0.5,
    "centre": 0.1,
    "load": 0.3,
    "limit": 0.4,
    "load_share": 0.2,
    "torque": 0.5,
    "log_turn": 0.3,
    "angle": 0.4,
    "leak": 0.2,
    "drift": 0.2,
    "fold": -0.3,
    "log_share": -1.0,
}
NONLINEAR = ("coulomb-friction/position", "sqrt-outflow/both", "coulomb-friction/speed", "cubic-stiffness")
PLACED = ("inside", "ahead", "beside", "extra-lag", "resonance", "slow-mode")
_PLAY = """
([u, cases]) => {
  %s
  const bound = (effects) => effects.map((one) => ({ ...one, run: RUN[one.run] }));
  return cases.map(({ model, theta, gains }) => {
    for (const part of ["inputs", "outputs", "additive"]) model[part] = bound(model[part]);
    return Array.from(simulate(model, Float64Array.from(theta), Float64Array.from(gains), Float64Array.from(u)));
  });
}
"""


def combinations() -> list[Hypothesis]:
    """Every effect alone, and with a nonlinear state those whose place then matters."""
    alone = [Hypothesis((effect,)) for effect in EFFECTS_BY_KEY.values()]
    placed = [effect for key, effect in EFFECTS_BY_KEY.items() if any(part in key for part in PLACED)]
    return alone + [Hypothesis((EFFECTS_BY_KEY[one], effect)) for one in NONLINEAR for effect in placed]


def parameters(hypothesis: Hypothesis, rng: np.random.Generator) -> np.ndarray:
    """Parameters with which every effect acts."""
    theta = np.array([TYPICAL.get(p.name, p.start + 0.1 * rng.standard_normal()) for p in hypothesis.parameters])
    plant = hypothesis.slices["plant"]
    theta[plant.start : plant.start + 2] = hypothesis.plant.starts(0.5, 0.05)[0][:2]
    return np.clip(theta, *hypothesis.bounds)


def test_every_effect_plays_in_a_browser_as_in_python(context: "BrowserContext") -> None:
    rng = np.random.default_rng(1)
    u = np.repeat(rng.uniform(-1.5, 1.5, 50), 8)
    hypotheses, cases, outputs = combinations(), [], []
    for hypothesis in hypotheses:
        theta = parameters(hypothesis, rng)
        design = hypothesis.design(theta, u, u.size, REFERENCE)
        gains = rng.normal(0.0, 0.5, design.columns.shape[1])
        outputs.append(hypothesis.sensor(theta, gains, design))
        model = structure(hypothesis, u.size, REFERENCE)
        cases.append({"model": model, "theta": theta.tolist(), "gains": gains.tolist()})
    page = context.new_page()
    played: list[Any] = page.evaluate(_PLAY % script(hypotheses), [u.tolist(), cases])
    page.close()
    assert len(played) > len(EFFECTS_BY_KEY)
    errors = {
        "+".join(hypothesis.keys): float(np.abs(np.array(y, float) - expected).max() / np.ptp(expected))
        for hypothesis, y, expected in zip(hypotheses, played, outputs, strict=True)
    }
    assert errors == pytest.approx(dict.fromkeys(errors, 0.0), abs=1e-6)
