"""Friction and a spring at the input of a simulation that runs as a whole, beside fine integrations of the rigs."""

from collections.abc import Callable

import numpy as np
import pytest
from gap_search import searched
from scipy.signal import cont2discrete, lfilter

from labsid._arrays import FloatArray
from labsid.gap.diagnosis import diagnose
from labsid.gap.dynamics.reaction_forces import Reaction, is_collocated, output_with
from labsid.gap.reports.text_report import format_report
from labsid.records.record import Record

pytestmark = pytest.mark.usefixtures("without_limits")

FEW = ("input-dead-zone", "input-backlash", "extra-lag", "coulomb-friction", "cubic-stiffness", "output-nonlinearity")

TS, FINE, SAMPLES = 0.02, 100, 600
MASS, DAMPING, STIFFNESS = 0.025, 0.15, 2.0
FRICTION, CUBIC = 0.08, 6.0


def steps(seed: int) -> FloatArray:
    rng = np.random.default_rng(seed)
    return np.repeat(rng.uniform(-1.0, 1.0, SAMPLES // 20), 20)


def arm(t: FloatArray, u: FloatArray, damping: float = DAMPING) -> FloatArray:
    """Angle of an arm on a spring for a held torque, exact."""
    num, den, _ = cont2discrete(([1.0], [MASS, damping, STIFFNESS]), TS)
    return np.asarray(lfilter(num[0], den, u))


def motor(t: FloatArray, u: FloatArray) -> FloatArray:
    """Speed of a motor for a held torque, exact."""
    keep = np.exp(-DAMPING / MASS * TS)
    return np.asarray(lfilter([0.0, (1.0 - keep) / DAMPING], [1.0, -keep], u))


def finely(
    u: FloatArray, friction: float = 0.0, cubic: float = 0.0, stiffness: float = STIFFNESS, drag: float = 0.0
) -> tuple[FloatArray, FloatArray]:
    """Angle and speed with the effects, by small steps: friction ends the motion where it can."""
    x = v = 0.0
    angles, speeds = np.empty(u.size), np.empty(u.size)
    h = TS / FINE
    most = h * friction / MASS
    for k, torque in enumerate(u.tolist()):
        angles[k], speeds[k] = x, v
        for _ in range(FINE):
            v += h / MASS * (torque - stiffness * x - cubic * x**3 - DAMPING * v - drag * abs(v) * v)
            v -= min(max(v, -most), most)
            x += h * v
    return angles, speeds


def around(simulate: Callable[..., FloatArray], u: FloatArray, reaction: Reaction) -> FloatArray:
    """Output of a simulation with a reaction at its input."""

    def run(w: FloatArray) -> FloatArray:
        return simulate(TS * np.arange(w.size), w)

    first = (np.arange(u.size) == 0).astype(float)
    return output_with(run, u, run(first) - run(np.zeros(u.size)), reaction)


def left(simulated: FloatArray, true: FloatArray, without: FloatArray) -> float:
    """Error of a simulation over that without the effect."""
    return float(np.std(simulated - true) / np.std(without - true))


def test_without_a_force_the_output_is_that_of_the_simulation() -> None:
    u = steps(1)
    np.testing.assert_allclose(around(arm, u, Reaction()), arm(TS * np.arange(u.size), u), atol=1e-12)


@pytest.mark.parametrize(
    ("reaction", "effects"),
    [
        (Reaction(friction=FRICTION), {"friction": FRICTION}),
        (Reaction(cubic=CUBIC), {"cubic": CUBIC}),
        (Reaction(friction=FRICTION, cubic=CUBIC), {"friction": FRICTION, "cubic": CUBIC}),
    ],
)
def test_an_arm_moves_as_with_the_effect_inside(reaction: Reaction, effects: dict[str, float]) -> None:
    for seed in (1, 2):
        u = steps(seed)
        found = around(arm, u, reaction)
        assert left(found, finely(u, **effects)[0], arm(TS * np.arange(u.size), u)) < 0.02


def test_the_speed_of_a_motor_stands_where_friction_holds_it() -> None:
    u = 0.3 * steps(3)
    found = around(motor, u, Reaction(friction=FRICTION, at_rest=True))
    true = finely(u, friction=FRICTION, stiffness=0.0)[1]
    assert left(found, true, motor(TS * np.arange(u.size), u)) < 0.02
    held = np.abs(true) < 1e-9
    assert held.mean() > 0.1
    assert np.abs(found[held]).max() < 0.02 * np.std(true)


def test_a_simulation_that_is_not_linear_is_run_until_both_agree() -> None:
    u = steps(4)
    runs = []

    def dragged(t: FloatArray, w: FloatArray) -> FloatArray:
        runs.append(w)
        return finely(w, drag=0.05)[0]

    found = around(dragged, u, Reaction(friction=FRICTION))
    true = finely(u, friction=FRICTION, drag=0.05)[0]
    assert left(found, true, dragged(u, u)) < 0.03
    assert 4 < len(runs) < 11  # two for the response to a pulse, one without friction, and then at least two


def test_only_a_force_that_moves_the_output_at_once_can_react_to_it() -> None:
    t = TS * np.arange(100)
    first = (np.arange(100) == 0).astype(float)
    assert is_collocated(arm(t, first))
    assert is_collocated(motor(t, first))
    assert not is_collocated(np.concatenate([[0.0, 0.0, 0.0], arm(t, first)[:-3]]))  # a delay
    assert not is_collocated(first)  # a static gain
    assert not is_collocated(np.full(100, np.nan))
    assert not is_collocated(np.zeros(2))


def record(u: FloatArray, y: FloatArray, seed: int) -> Record:
    noise = 0.01 * np.std(y) * np.random.default_rng(seed).standard_normal(y.size)
    return Record(TS * np.arange(u.size), u, y + noise, TS)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "effects", "parameter", "true"),
    [
        ("coulomb-friction", {"friction": FRICTION}, "friction", FRICTION),
        ("cubic-stiffness", {"cubic": CUBIC}, "cubic", CUBIC / STIFFNESS),
    ],
)
@searched(*FEW)
def test_the_effect_is_named_and_closes_the_gap_on_a_second_record(
    name: str, effects: dict[str, float], parameter: str, true: float
) -> None:
    u, other = steps(1), steps(2)
    found = diagnose(record(u, finely(u, **effects)[0], 5), arm)
    (effect,) = found.report["effects"]
    assert effect["name"] == name
    assert effect["probability"] > 0.9
    assert effect["parameters"][parameter]["value"] == pytest.approx(true, rel=0.02)
    assert "as a force at its input that reacts to its output" in " ".join(format_report(found.report).split())
    second = record(other, finely(other, **effects)[0], 6)
    error = np.sqrt(np.mean((second.y - found.model.simulate(second.u, second.y))[50:] ** 2))
    assert error < 1.1 * 0.01 * np.std(second.y)


@pytest.mark.slow
@searched(*FEW)
def test_friction_is_named_on_several_records_each_of_them_at_rest_at_first() -> None:
    runs = [steps(seed)[:300] for seed in (1, 2, 3)]
    found = diagnose([record(u, finely(u, friction=FRICTION)[0], seed) for seed, u in enumerate(runs)], arm)
    (effect,) = found.report["effects"]
    assert effect["name"] == "coulomb-friction"
    assert effect["parameters"]["friction"]["value"] == pytest.approx(FRICTION, rel=0.03)
    assert found.report["gap"]["closed"] > 0.95
