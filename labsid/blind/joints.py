"""The row `joints`: joints with friction of bristles, gravity, and limits of the drive.

Of the laws of friction, the diagnosis has Dahl's and the one that grows with the load, simulated otherwise.
"""

from collections.abc import Sequence

import numpy as np

from labsid._arrays import FloatArray
from labsid.blind.experiment import OrdinaryCase
from labsid.blind.metrics import CaseOutcome, Metric, asserted_effects, rate
from labsid.blind.output_error import fit_linear
from labsid.blind.strength import CLEAR_RATIOS
from labsid.rig.ordinary.record_files import OrdinaryRecord, table_text
from labsid.rig.switchable.joints import LAWS, Joint, run_joint

KINDS = (
    "position: friction",
    "position: friction and gravity",
    "position: friction and limit",
    "position: friction, gravity and limit",
    "position: gravity",
    "position: limit",
    "speed: friction",
    "torque: friction and gravity",
    "torque: gravity",
    "position: none",
)
"""Loop and effects of the joints, which take turns."""

LIKELY = 0.5
"""Probability above which a name is asserted."""

MIN_SHARE = 0.05
"""Least share of the linear model's error that is left without an effect, for each effect of a joint."""

_EFFECT_OF = {"friction": "coulomb-friction", "gravity": "gravity", "limit": "force-limit"}
_DEGREES = 180.0 / np.pi


def draw_joint(rng: np.random.Generator, i: int, name: str) -> OrdinaryCase | None:
    """A joint with each of its effects large enough to be visible."""
    kind = KINDS[i % len(KINDS)]
    loop, _, stated = kind.partition(": ")
    effects = tuple(_EFFECT_OF[word] for word in _EFFECT_OF if word in stated)
    Ts = float(rng.choice([0.005, 0.01, 0.02]))
    samples = int(rng.integers(1000, 2501))
    joint = _draw(rng, loop, effects, Ts)
    command = _command(rng, joint, samples, Ts)
    start = joint.rest if loop == "torque" else float(command[0]) if loop == "position" else 0.0
    angle = run_joint(joint, command, Ts, start)
    y = angle[:, 1 if loop == "speed" else 0]
    if not np.isfinite(y).all() or (np.abs(angle[:, 0]).max() > 3.0 and loop != "speed"):
        return None
    sigma = float(np.std(y)) * float(np.exp(rng.uniform(np.log(0.003), np.log(0.02))))
    gap = _linear_gap(command, y, joint, Ts)
    if (effects and gap < CLEAR_RATIOS[0] * sigma) or (not effects and gap > 0.2 * sigma):
        return None
    gaps_without = {
        effect: _linear_gap(command, _without(joint, effect, command, Ts, start), joint, Ts) for effect in effects
    }
    if len(effects) > 1 and max(gaps_without.values()) > (1.0 - MIN_SHARE) * gap:
        return None
    degrees = bool(rng.random() < 0.25)
    of_u = (
        _DEGREES if degrees and loop != "torque" else float(np.exp(rng.uniform(-3.0, 1.0))) if loop == "torque" else 1.0
    )
    of_y = _DEGREES if degrees else 1.0
    t = Ts * np.arange(samples, dtype=np.float64)
    noisy = of_y * (y + sigma * rng.standard_normal(samples))
    made = OrdinaryRecord(
        answers=(effects,),
        files={".csv": table_text("t,u,y", "%.8g", t, of_u * command, noisy)},
        truth={
            "cause": min(gaps_without, key=lambda effect: gaps_without[effect]) if gaps_without else "none",
            "law": joint.law,
            "degrees": degrees,
        },
    )
    return OrdinaryCase(name=name, row="joints", kind=kind, made=made)


def names_the_cause(case: CaseOutcome) -> bool:
    """Whether the effect that causes most of the gap is named above 0.5, and nothing wrong is; or nothing, of none."""
    said, true = asserted_effects(case, LIKELY), set(case.label["labels"])
    cause = case.label["truth"]["cause"]
    return set(said) <= true and (cause in said or not true)


def invents(case: CaseOutcome) -> bool:
    """Whether a name above 0.5 is wrong."""
    return not set(asserted_effects(case, LIKELY)) <= set(case.label["labels"])


def joint_metrics(cases: Sequence[CaseOutcome]) -> list[Metric]:
    """Metrics of the row.

    Parameters
    ----------
    cases : sequence of CaseOutcome
    """
    return [
        rate("joints: the largest cause named, nothing wrong above 0.5", map(names_the_cause, cases), 0.93, 0.98),
        rate("joints: a wrong name above 0.5", map(invents, cases), 0.02, 0.005, below=True),
    ]


def _draw(rng: np.random.Generator, loop: str, effects: tuple[str, ...], Ts: float) -> Joint:
    """A joint in motion for several of its time constants."""
    rate = float(rng.uniform(0.03, 0.12)) / Ts  # of the loop, per second
    law = str(rng.choice(LAWS))
    scale = 0.5 * rate**2 if loop == "position" else 0.5 * rate  # acceleration for an error of a half
    if loop == "torque":
        rate = float(rng.uniform(2.0, 6.0))
        scale = 0.6 * rate**2
    most = 0.25 if loop == "position" and "gravity" in effects else 0.35  # more would hide gravity
    friction = scale * float(rng.uniform(0.23, 1.0) * most) if "coulomb-friction" in effects else 0.0
    gear = law == "gear" and friction > 0.0
    return Joint(
        loop=loop,
        gain={"position": rate**2, "speed": rate, "torque": 1.0}[loop],
        damping=rate * float(rng.uniform(0.6, 1.6)) if loop != "speed" else 0.05 * rate,
        gravity=scale * float(rng.uniform(0.8, 2.5)) if "gravity" in effects else 0.0,
        rest=float(rng.choice([0.0, rng.uniform(-1.5, 1.5)])),
        limit=float(rng.uniform(0.25, 0.6)) if "force-limit" in effects else np.inf,
        law=law,
        friction=0.4 * friction if gear else friction,
        excess=float(rng.uniform(0.15, 0.35)) if gear else float(rng.uniform(0.2, 0.8)) if friction > 0.0 else 0.0,
        stribeck=float(rng.uniform(0.05, 0.3)),
    )


def _command(rng: np.random.Generator, joint: Joint, samples: int, Ts: float) -> FloatArray:
    """Sums of sinusoids, steps or ramps, over a good part of the range of the joint."""
    t = Ts * np.arange(samples, dtype=np.float64)
    rate = np.sqrt(joint.gain) if joint.loop == "position" else joint.gain if joint.loop == "speed" else joint.damping
    kind = str(rng.choice(["sinusoids", "steps", "chirp"]))
    if kind == "sinusoids":
        frequencies = rate * rng.uniform(0.03, 0.35, 3)
        w = np.sin(np.outer(t, frequencies) + rng.uniform(0.0, 6.3, 3)) @ rng.uniform(0.4, 1.0, 3) / 1.5
    elif kind == "chirp":
        w = np.sin(0.02 * rate * t + 0.3 * rate * t**2 / (2.0 * t[-1])) * rng.uniform(0.7, 1.2)
    else:
        hold = max(int(rng.uniform(3.0, 9.0) / (rate * Ts)), 2)
        levels = rng.uniform(-1.1, 1.1, samples // hold + 1)
        w = np.repeat(levels, hold)[:samples]
    if joint.loop == "position" and joint.gravity:
        w = w * rng.uniform(1.2, 2.2)  # far from the angles at which the sine is a spring
    if joint.loop == "torque":
        w = w * (1.1 * joint.gravity if joint.gravity else 6.0 * joint.friction)
    return np.asarray(w, np.float64)


def _without(joint: Joint, effect: str, command: FloatArray, Ts: float, start: float) -> FloatArray:
    return run_joint(joint.without(effect), command, Ts, start)[:, 1 if joint.loop == "speed" else 0]


def _linear_gap(command: FloatArray, y: FloatArray, joint: Joint, Ts: float) -> float:
    """Error of the best linear model of second order without noise."""
    rate = np.sqrt(joint.gain) if joint.loop == "position" else joint.gain if joint.loop == "speed" else joint.damping
    poles = [np.exp(-0.6 * rate * Ts), np.exp(-1.6 * rate * Ts)]
    return fit_linear(command, y, poles, taps=3).rmse if np.isfinite(y).all() else np.inf
