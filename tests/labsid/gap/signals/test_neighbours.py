"""Two masses that pull at each other: an effect at one of them, and the free run of both together."""

import numpy as np
import pytest
from gap_search import searched
from two_by_two import random_steps

from labsid.gap.diagnosis import diagnose
from labsid.records.record import Record

pytestmark = pytest.mark.usefixtures("without_limits")

FRICTION = 0.15
FEW = ("input-dead-zone", "input-backlash", "coulomb-friction", "quadratic-drag", "cubic-stiffness", "end-stop")


def _two_masses(seed: int = 0, samples: int = 600, friction: float = FRICTION) -> Record:
    """Masses on springs with a spring between them, dry friction at the first; small steps of a semi-implicit rule."""
    rng = np.random.default_rng(seed)
    u = np.column_stack([random_steps(rng, samples) for _ in range(2)])
    position, speed, y = np.zeros(2), np.zeros(2), np.zeros((samples, 2))
    steps = 40
    for n in range(samples):
        y[n] = position
        for _ in range(steps):
            pull = 0.012 * (position[1] - position[0])
            force = 0.05 * u[n] + [pull, -pull] - [0.03, 0.05] * position - [0.08, 0.12] * speed
            new = speed + force / steps
            limit = 0.05 * friction / steps  # the friction of this step
            new[0] -= np.clip(new[0], -limit, limit)
            speed = new
            position = position + speed / steps
    y += 0.004 * y.std(axis=0) * rng.standard_normal(y.shape)
    return Record(np.arange(samples) * 0.1, u, y, 0.1, inputs=("torque1", "torque2"), outputs=("angle1", "angle2"))


@searched(*FEW)
def test_friction_at_one_of_two_coupled_masses_is_named_and_both_are_simulated_together() -> None:
    report = diagnose(_two_masses()).report
    probable = [(one["name"], one["signal"]) for one in report["effects"] if one["probability"] > 0.5]
    assert probable == [("coulomb-friction", None)]
    assert report["effects"][0]["outputs"][0] == "angle1"
    assert report["gap"]["mode"] in ("free", "stabilised")
    first = report["gap"]["outputs"]["angle1"]
    assert first["after"] < 0.5 * first["before"]


@pytest.mark.exhaustive  # above, friction is all that is named; `test_signals_diagnosis.py` has a rig without a gap
@searched(*FEW)
def test_two_coupled_masses_without_friction_have_no_gap() -> None:
    assert diagnose(_two_masses(1, friction=0.0)).verdict == "none"
